//! What restricted power diagrams are for: centroidal tessellations, semi-discrete optimal transport, incompressible fluid. Everything
//! here sees the trait [`Backend`](laguerre_core::Backend) alone, and so runs on any.
#![forbid(unsafe_code)]

pub mod density;
pub mod derivatives;
pub mod fluid;
pub mod lloyd;
pub mod transport;
mod vectors;
