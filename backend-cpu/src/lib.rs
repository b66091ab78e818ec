//! The CPU backend of `laguerre`: rayon over the sites in grid order, SIMD inside a cell.
//!
//! Storage is `store.rs`, the search for neighbours `search.rs`; the geometry is `laguerre_core::cell`.
#![forbid(unsafe_code)]

mod clusters;
mod evaluate;
mod search;
mod store;

pub use evaluate::Cpu;
