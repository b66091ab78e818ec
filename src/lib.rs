//! Restricted power diagrams: Laguerre-Voronoi cells of weighted sites, cut by a triangulated domain, and integrals over
//! them. Fast, and right for every input.
//!
//! ```
//! use laguerre::{Domain, PowerDiagram, Request, Selection};
//!
//! # fn main() -> laguerre::Result<()> {
//! // A tetrahedron, and two sites in it.
//! let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let domain = Domain::new(&vertices, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
//! let diagram = PowerDiagram::new(&[[0.1, 0.1, 0.1], [0.5, 0.2, 0.2]], &[0.0, 0.01])?.restricted_to(&domain);
//! let cells = laguerre::open(Selection::Auto)?.evaluate(&diagram, &Request::moments().with_facets())?;
//! assert!((cells.volume[0] + cells.volume[1] - domain.volume()).abs() < 1e-15);
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]

pub use laguerre_core::*;

/// Which backend to open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Selection {
    /// The fastest one that is there.
    #[default]
    Auto,
    /// The CPU, with the given number of threads or one for each core.
    Cpu {
        /// Number of threads; `None` for one a core.
        threads: Option<usize>,
    },
    /// OpenCL.
    Ocl,
}

/// Opens a backend.
///
/// # Errors
/// `Unavailable` where the backend was not built or has no device.
pub fn open(selection: Selection) -> Result<Box<dyn Backend>> {
    let missing = |what: &str| Err(Error::new(ErrorKind::Unavailable, what));
    match selection {
        #[cfg(feature = "cpu")]
        Selection::Auto => Ok(Box::new(laguerre_cpu::Cpu::new(None)?)),
        #[cfg(feature = "cpu")]
        Selection::Cpu { threads } => Ok(Box::new(laguerre_cpu::Cpu::new(threads)?)),
        #[cfg(not(feature = "cpu"))]
        Selection::Auto => missing("no backend was built: build with the feature `cpu`"),
        #[cfg(not(feature = "cpu"))]
        Selection::Cpu { .. } => missing("backend cpu was not built: build with the feature `cpu`"),
        Selection::Ocl => missing("backend ocl is not part of this build: use --backend cpu"),
    }
}
