//! The backends that were built, and those that must be there.

use laguerre_core::{Backend, Result};

use crate::Verdict;

/// Something a backend must fulfil.
pub type Check = fn(&dyn Backend) -> Verdict;

/// Every backend that was built, by name: opened, or the reason why it could not be.
pub fn built() -> Vec<(&'static str, Result<Box<dyn Backend>>)> {
    NAMES.iter().filter_map(|&name| Some((name, open(name, None)?))).collect()
}

/// The backend of the given name with the given number of host threads (its own choice where `None`); `None` where it was
/// not built.
pub fn open(name: &str, threads: Option<usize>) -> Option<Result<Box<dyn Backend>>> {
    let _ = threads;
    match name {
        #[cfg(feature = "cpu")]
        "cpu" => Some(laguerre::open(laguerre::Selection::Cpu { threads })),
        #[cfg(feature = "ocl")]
        "ocl" => Some(laguerre::open(laguerre::Selection::Ocl {
            devices: laguerre::DeviceChoice::First,
            precision: laguerre::Precision::F64,
        })),
        // The other of the OpenCL backend's two kernels.
        #[cfg(feature = "ocl")]
        "ocl-sharing" => Some(laguerre::open_sharing_cells(laguerre::Precision::F64)),
        // The same, begun in single precision.
        #[cfg(feature = "ocl")]
        "ocl-single" => Some(laguerre::open_sharing_cells(laguerre::Precision::F32)),
        // The same in double precision with lanes that talk, where a device has sub-groups.
        #[cfg(feature = "ocl")]
        "ocl-lanes" => Some(laguerre::open_sharing_in_sub_groups()),
        _ => None,
    }
}

/// Whether the work-items that share a cell are a loop on a CPU, not optimised, where a site takes a millisecond: large inputs have fewer.
pub(crate) fn are_lanes_emulated(backend: &dyn Backend) -> bool {
    backend.info().backend == "ocl-lanes"
}

/// The backends that `LAGUERRE_REQUIRE` names, separated by commas.
pub fn required() -> Vec<String> {
    let list = std::env::var("LAGUERRE_REQUIRE").unwrap_or_default();
    list.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

/// The names that this suite knows.
const NAMES: [&str; 5] = ["cpu", "ocl", "ocl-sharing", "ocl-single", "ocl-lanes"];
