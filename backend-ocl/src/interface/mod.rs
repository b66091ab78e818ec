//! What the host and the kernels share: constants, structs and the kernels' parameters. Each is stated here and nowhere else.
//!
//! `cargo xtask codegen` makes `kernels/interface.cl` of `data.rs` and `kernels.rs`, and `kernels/single_interface.cl` of `single.rs`.

pub(crate) mod data;
pub(crate) mod single;
