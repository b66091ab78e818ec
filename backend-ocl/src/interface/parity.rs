//! The kernels of tests, which call single functions on random words.

use super::data::Params;
use super::table::kernels;

kernels! {
    /// All that `parity.cl` has: the words of each of `count` calls stand in a row; `table` begins with where its parts do.
    kernel Parity = parity {
        input params: Params,
        input domain_vertices: [f64; 3],
        input table: u32,
        input integrand: f64,
        input inputs: u64,
        value input_width: u32,
        output outputs: u64,
        value output_width: u32,
        value count: u32,
    }
}
