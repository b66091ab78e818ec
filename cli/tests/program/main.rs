//! The program as its users meet it: what it reads, prints, writes and exits with.

mod bad_meshes;
mod bad_sites;
mod command_line;
mod formats;
mod outputs;
mod results;
mod support;
