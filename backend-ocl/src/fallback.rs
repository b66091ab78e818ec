//! The cells that a device hands back: exact arithmetic and all the room there is, by the CPU backend.

use laguerre_core::assemble::Assembler;
use laguerre_core::diagram::Prepared;
use laguerre_core::{Result, Watched};
use rayon::prelude::*;
use std::collections::HashSet;

/// Computes the cells of some sites (the caller's indices).
pub(crate) fn compute(
    prepared: &Prepared,
    request: &Watched<'_>,
    sites: &[u32],
    assembler: &mut Assembler<'_>,
) -> Result<()> {
    let wanted: HashSet<u32> = sites.iter().copied().collect();
    let order = prepared.sites.order();
    let sorted = (0..order.len() as u32).into_par_iter().filter(|&i| wanted.contains(&order[i as usize])).collect();
    laguerre_cpu::compute_cells(prepared, request, sorted, assembler)
}
