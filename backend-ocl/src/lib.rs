//! The OpenCL backend of `laguerre`: the cells of `laguerre_core::cell`, generated as OpenCL C, on any number of devices.
//!
//! The loader is found at run time: this builds, and says what is missing, on a machine without OpenCL.

mod again;
mod ahead;
mod algebra;
mod believed;
mod buffer;
mod builds;
mod device;
mod devices;
mod evaluate;
mod facets;
mod fallback;
mod fresh;
mod grid;
mod handle;
mod interface;
mod lanes;
mod laplacian;
mod launch;
mod octree;
mod params;
#[cfg(feature = "test-util")]
pub mod parity;
mod platform;
mod program;
mod queue;
mod resident;
mod results;
mod shells;
mod single;
mod sources;
mod voxels;
#[cfg(feature = "test-util")]
pub mod warp_texts;

pub use evaluate::{Ocl, open};
pub use platform::devices;
