//! The CPU backend of `laguerre`: rayon over the sites in the order of their curve, SIMD inside a cell.
//!
//! Storage is `store.rs`; the geometry is `laguerre_core::cell`, the search for neighbours `laguerre_core::search`.
#![forbid(unsafe_code)]

mod evaluate;
mod minors;
mod store;

pub use evaluate::{Cpu, compute_cells};
