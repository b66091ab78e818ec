//! Restricted power diagrams: Laguerre-Voronoi cells of weighted sites, cut by a triangulated domain, and integrals over
//! them. Fast, and right for every input.
//!
//! ```
//! use laguerre::{Domain, PowerDiagram, Report, Request, Selection};
//!
//! # fn main() -> laguerre::Result<()> {
//! // A tetrahedron, and two sites in it.
//! let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let domain = Domain::new(&vertices, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
//! let diagram = PowerDiagram::new(&[[0.1, 0.1, 0.1], [0.5, 0.2, 0.2]], &[0.0, 0.01])?.restricted_to(&domain);
//! let cells = laguerre::open(Selection::Auto)?.evaluate(&diagram, &Request::moments().with_facets())?;
//! assert!((cells.volume()[0] + cells.volume()[1] - domain.volume()).abs() < 1e-15);
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]

mod auto;

/// What README.md shows, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

#[cfg(feature = "oracle")]
pub use laguerre_core::oracle;
#[cfg(feature = "shapes")]
pub use laguerre_core::shapes;
pub use laguerre_core::{
    Backend, BackendInfo, Boundary, Capabilities, CellStatus, Container, DeviceChoice, DeviceInfo, Domain, Error,
    ErrorKind, Facet, FacetArrays, Facets, Geometry, Integrand, Laplacian, MergedSites, Observer, Output, OutputArrays,
    PassReport, Place, PowerDiagram, Precision, Report, Request, Resident, Result, Session, Substep, Totals, algebra,
    io, summation,
};
/// What the geometry of cells is made of.
pub mod geometry {
    pub use laguerre_core::geometry::{Beyond, Face, Geometry};
}
/// What is accepted.
pub mod limits {
    pub use laguerre_core::diagram::{FARTHEST_SITE, LARGEST_COORDINATE, LARGEST_WEIGHT_SPREAD};
    pub use laguerre_core::domain::MOST_TRIANGLES;
    pub use laguerre_core::integrand::LARGEST_DEGREE;
}
/// The machine room, for this project's own program, tests and benches: what is in it changes without a word.
#[doc(hidden)]
pub use laguerre_core as engine;
/// What the diagrams are for, on any backend.
#[cfg(feature = "solvers")]
pub use laguerre_solvers as solvers;

/// Which backend to open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Selection {
    /// The fastest that is there: the first OpenCL GPU that can be used, if the feature `ocl` is built and one is found, with the CPU for what no
    /// device can do (functions of the caller's); else the CPU. Without the feature `cpu`, any OpenCL device. Doubles in each case.
    #[default]
    Auto,
    /// The CPU, with the given number of threads or one for each core.
    Cpu {
        /// Number of threads; `None` for one a core.
        threads: Option<usize>,
    },
    /// OpenCL.
    Ocl {
        /// Which devices.
        devices: DeviceChoice,
        /// What they compute with.
        precision: Precision,
    },
}

/// Opens a backend.
///
/// # Errors
/// `Unavailable` where the backend was not built or has no device; `Input` for a number of threads that cannot be; `Device` where threads or a device
/// cannot be started.
pub fn open(selection: Selection) -> Result<Box<dyn Backend>> {
    match selection {
        Selection::Auto => auto::open(),
        Selection::Cpu { threads } => open_cpu(threads),
        Selection::Ocl { devices, precision } => open_ocl(devices, precision),
    }
}

#[cfg(feature = "cpu")]
fn open_cpu(threads: Option<usize>) -> Result<Box<dyn Backend>> {
    Ok(Box::new(laguerre_cpu::Cpu::new(threads)?))
}

#[cfg(not(feature = "cpu"))]
fn open_cpu(_threads: Option<usize>) -> Result<Box<dyn Backend>> {
    Err(Error::new(ErrorKind::Unavailable, "backend cpu was not built: build with the feature `cpu`"))
}

#[cfg(feature = "ocl")]
fn open_ocl(devices: DeviceChoice, precision: Precision) -> Result<Box<dyn Backend>> {
    laguerre_ocl::open(&devices, precision)
}

/// The OpenCL backend with cells computed by the kernel for work-items that share a cell, where the first device would not choose it.
///
/// # Errors
/// `Unavailable` where there is no device, or it does so anyway.
#[cfg(all(feature = "ocl", feature = "test-util"))]
pub fn open_sharing_cells(precision: Precision) -> Result<Box<dyn Backend>> {
    Ok(Box::new(laguerre_ocl::Ocl::sharing_cells(&DeviceChoice::First, precision)?))
}

/// The same where the sub-groups of a device share a cell.
///
/// # Errors
/// `Unavailable` where no device has any.
#[cfg(all(feature = "ocl", feature = "test-util"))]
pub fn open_sharing_in_sub_groups() -> Result<Box<dyn Backend>> {
    Ok(Box::new(laguerre_ocl::Ocl::sharing_in_sub_groups()?))
}

#[cfg(not(feature = "ocl"))]
fn open_ocl(_devices: DeviceChoice, _precision: Precision) -> Result<Box<dyn Backend>> {
    Err(Error::new(ErrorKind::Unavailable, NOT_BUILT))
}

/// The OpenCL devices of this machine, usable or not.
///
/// # Errors
/// `Unavailable` where there is none, or the backend was not built.
pub fn devices() -> Result<Vec<DeviceInfo>> {
    #[cfg(feature = "ocl")]
    return laguerre_ocl::devices();
    #[cfg(not(feature = "ocl"))]
    Err(Error::new(ErrorKind::Unavailable, NOT_BUILT))
}

#[cfg(not(feature = "ocl"))]
const NOT_BUILT: &str = "backend ocl is not part of this build: build with the feature `ocl`, or use the CPU";
