//! What the host and the kernels share: constants, structs and the kernels' parameters. Each is stated here and nowhere else.
//!
//! `cargo xtask codegen` makes `kernels/generated/interface.cl` of `data.rs`, `kernels.rs`, `algebra.rs` and `parity.rs`, and `single_interface.cl` there of
//! `single.rs`.

pub(crate) mod algebra;
pub(crate) mod data;
pub(crate) mod kernels;
#[cfg(feature = "test-util")]
pub(crate) mod parity;
pub(crate) mod single;
mod table;
