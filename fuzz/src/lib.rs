//! What the fuzz targets share: structured cases of `evaluate` ([`tied`]), and what every parser owes ([`files`]).
#![forbid(unsafe_code)]

pub mod files;
pub mod tied;
