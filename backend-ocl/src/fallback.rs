//! The cells that a device hands back: exact arithmetic and all the room there is, on the host.

use laguerre_core::assemble::{Assembler, CellRecord, FacetRecords};
use laguerre_core::cell::{self, CellSums, PlainStore};
use laguerre_core::diagram::Prepared;
use laguerre_core::integrand::FramedIntegrand;
use laguerre_core::search::Search;
use laguerre_core::{CellStatus, Error, Result, Watched};
use rayon::prelude::*;
use std::collections::HashSet;

/// Computes the cells of some sites (the caller's indices).
pub(crate) fn compute(
    prepared: &Prepared,
    request: &Watched<'_>,
    sites: &[u32],
    assembler: &mut Assembler<'_>,
) -> Result<()> {
    let integrand = request.integral().map(|f| f.framed(&prepared.container.frame)).transpose()?;
    let wanted: HashSet<u32> = sites.iter().copied().collect();
    let order = prepared.sites.order();
    let sorted: Vec<u32> =
        (0..order.len() as u32).into_par_iter().filter(|&i| wanted.contains(&order[i as usize])).collect();
    let cells: Result<Vec<_>> = sorted
        .par_iter()
        .map_init(
            || Search::new(prepared),
            |search, &site| {
                let cell = compute_cell(search, prepared, request, integrand.as_ref(), site)?;
                request.advance(1)?;
                Ok(cell)
            },
        )
        .collect();
    for (cell, facets) in cells? {
        let count = facets.records.len() as u32;
        assembler.add(&[cell], facets, &[count]);
    }
    Ok(())
}

fn compute_cell(
    search: &mut Search<'_>,
    prepared: &Prepared,
    request: &Watched<'_>,
    integrand: Option<&FramedIntegrand>,
    site: u32,
) -> Result<(CellRecord, FacetRecords)> {
    let order = prepared.sites.order();
    let [x, y, z, _] = prepared.sites.site(site);
    let mut store = PlainStore::new([x, y, z], prepared.domain_grid()).with_integrand(integrand);
    let outcome = search.complete(&mut store, site, request.epsilon());
    let mut sums = CellSums::default();
    let flags = cell::flags_of(request);
    let status = match outcome.status {
        cell::COMPLETE => cell::integrate_cell(&mut store, flags, 0, &mut sums),
        other => other,
    };
    let status = match status {
        cell::COMPLETE if outcome.uncertified => CellStatus::Uncertified,
        cell::COMPLETE => CellStatus::Complete,
        cell::EMPTY => CellStatus::Empty,
        _ => return Err(Error::undecided("cell", order[site as usize])),
    };
    let mut facets = FacetRecords::default();
    if request.needs_facets() && status != CellStatus::Empty {
        facets.collect(&store, flags, order);
    }
    Ok((CellRecord { site: order[site as usize], status, sums }, facets))
}
