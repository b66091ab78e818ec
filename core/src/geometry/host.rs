//! The geometry of all cells of a diagram by the host alone, for backends that compute elsewhere.

use super::{Geometry, GeometryAssembler, Shaper, Shapes};
use crate::cell::{self, CellSums, PlainStore};
use crate::search::Search;
use crate::{CellStatus, Error, PowerDiagram, Result, Watched, parallel};

/// Cells that one task computes, and those that are computed before they are put together.
const CHUNK: usize = 256;
const WAVE: usize = 32 * CHUNK;

/// The geometry of all cells, where the request that they are computed for has it; those that have been found to be empty have none. (Where bisectors
/// meet in one point, a cell of no volume is empty by one order of cuts and not by another.)
///
/// # Errors
/// `Input` where sites are out of range of the container.
pub fn on_host(diagram: &PowerDiagram, request: &Watched<'_>, status: &[CellStatus]) -> Result<Option<Geometry>> {
    if !request.geometry() {
        return Ok(None);
    }
    let prepared = diagram.prepare()?;
    let (order, frame) = (prepared.sites.order(), &prepared.container.frame);
    let mut geometry = GeometryAssembler::new(diagram.positions().len(), frame, request.solids());
    let all: Vec<u32> = (0..prepared.sites.len() as u32).collect();
    for wave in all.chunks(WAVE) {
        let compute = |chunk: &[u32]| {
            let (mut search, mut shaper, mut shapes) =
                (Search::new(&prepared), Shaper::new(request.solids()), Shapes::default());
            let is_empty = |site: u32| status.get(order[site as usize] as usize) == Some(&CellStatus::Empty);
            for &site in chunk.iter().filter(|&&site| !is_empty(site)) {
                let [x, y, z, _] = prepared.sites.site(site);
                let mut store = PlainStore::new([x, y, z], prepared.domain_grid());
                let mut sums = CellSums::default();
                let mut status = search.complete(&mut store, site, request.epsilon()).status;
                if status == cell::COMPLETE {
                    status = cell::integrate_cell(&mut store, cell::VOLUME_ONLY, 0, &mut sums);
                }
                if status == cell::COMPLETE {
                    status = shaper.add(&store, site, sums.volume, order, frame, &mut shapes);
                }
                if status != cell::COMPLETE && status != cell::EMPTY {
                    return Err(Error::undecided("geometry", order[site as usize]));
                }
            }
            // These cells are counted; who watches may still end it.
            request.advance(0)?;
            Ok(shapes)
        };
        let made: Vec<Result<Shapes>> = parallel::chunks(wave.len(), CHUNK, |range| compute(&wave[range]));
        for shapes in made {
            geometry.add(&shapes?);
        }
    }
    geometry.finish().map(Some)
}
