//! The program as its users meet it: what it reads, prints, writes and exits with.

#[cfg(feature = "ocl")]
mod auto;
mod bad_meshes;
mod bad_sites;
mod command_line;
#[cfg(feature = "ocl")]
mod devices;
mod fluid;
mod formats;
mod integrals;
mod lloyd;
mod manual;
mod measures;
#[cfg(target_os = "linux")]
mod memory;
mod numpy;
mod outputs;
mod page;
mod results;
mod standard_output;
mod support;
mod transport;
