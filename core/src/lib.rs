//! Everything of `laguerre` that does not depend on where the code runs: the words (sites, domain, diagram, request,
//! output), the one text of the algorithm ([`cell`]), and the [`Backend`] trait that runs it somewhere.
//!
//! Users depend on the facade crate `laguerre`, which re-exports what they need.
#![forbid(unsafe_code)]

pub mod algebra;
pub mod assemble;
pub mod backend;
pub mod capacities;
pub mod cell;
pub mod diagram;
pub mod domain;
pub mod domain_grid;
pub mod error;
pub mod exact;
pub mod facets;
pub mod frame;
pub mod geometry;
pub mod inside;
pub mod integrand;
pub mod io;
pub mod laplacian;
pub mod memory;
pub mod narrow;
#[cfg(any(test, feature = "oracle"))]
pub mod oracle;
pub mod output;
pub mod parallel;
pub mod passes;
pub mod power_octree;
pub mod request;
#[cfg(any(test, feature = "test-util"))]
pub mod required;
pub mod rows;
pub mod search;
pub mod session;
#[cfg(any(test, feature = "shapes"))]
pub mod shapes;
pub mod site_tree;
pub mod summation;

pub use backend::{Backend, BackendInfo, Capabilities, DeviceChoice, DeviceInfo, Observer, Precision, Watched};
pub use diagram::{Container, MergedSites, PowerDiagram};
pub use domain::Domain;
pub use error::{Error, ErrorKind, Place, Result};
pub use facets::{Boundary, Facet, FacetArrays, Facets};
pub use geometry::Geometry;
pub use integrand::Integrand;
pub use laplacian::Laplacian;
pub use output::{CellStatus, Output, OutputArrays, PassReport, Report, Substep};
pub use request::Request;
pub use session::{Resident, Session, Totals};
