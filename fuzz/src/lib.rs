//! What the fuzz targets share: structured cases ([`case`]), of ties ([`tied`]) and of uneven sites ([`uneven`]), and what every parser owes
//! ([`files`]).
#![forbid(unsafe_code)]

pub mod case;
pub mod files;
pub mod tied;
pub mod uneven;
