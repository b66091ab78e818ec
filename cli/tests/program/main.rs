//! The program as its users meet it: what it reads, prints, writes and exits with.

mod bad_meshes;
mod bad_sites;
mod command_line;
#[cfg(feature = "ocl")]
mod devices;
mod fluid;
mod formats;
mod lloyd;
mod measures;
#[cfg(target_os = "linux")]
mod memory;
mod outputs;
mod results;
mod support;
mod transport;
