//! What cells need: the counts `K`, `P`, `V`, `T` of single cells (paper §6.1), and the capacities that most of them are content
//! with.

use crate::cell::{self, CellSums, PlainStore, Polytope};
use crate::diagram::Prepared;
use crate::parallel;
use crate::request::Request;
use crate::search::Search;
use std::ops::Range;

/// The share of the cells that capacities are proposed for (paper §6.1).
pub const PROPOSED_SHARE: f64 = 0.95;

/// Cells that one task counts.
const AT_ONCE: usize = 64;

/// Half-spaces of the box that a cell begins as.
const BOX_PLANES: u32 = 6;

/// Half-spaces of a truncated cone, for which a cell near the surface needs room beside its own.
const CONE_PLANES: u32 = 4;

/// What one cell needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellCounts {
    /// `K`: sites visited before the cell is known to be complete or empty.
    pub neighbors: u32,
    /// `P`: the fewest half-spaces that there must be room for.
    pub planes: u32,
    /// `V`: the fewest vertices that there must be room for.
    pub vertices: u32,
    /// `T`: triangles of the domain that are tried.
    pub triangles: u32,
}

/// The counts of some sorted sites of a diagram, in their order, on the calling thread's pool. `K` is that of the search on the host, of each cell by itself.
pub fn count_cells(prepared: &Prepared, request: &Request, sites: &[u32]) -> Vec<CellCounts> {
    let count = |range: Range<usize>| -> Vec<CellCounts> {
        let mut search = Search::new(prepared);
        sites[range].iter().map(|&site| count_cell(&mut search, prepared, request, site)).collect()
    };
    parallel::chunks(sites.len(), AT_ONCE, count).concat()
}

/// For each count the least number that the given share (0 to 1) of the cells is content with; zeros where there is no cell.
pub fn sufficient(counts: &[CellCounts], share: f64) -> CellCounts {
    let of = |count: fn(&CellCounts) -> u32| {
        let mut numbers: Vec<u32> = counts.iter().map(count).collect();
        let last = numbers.len().checked_sub(1)?;
        let rank = ((share * numbers.len() as f64).ceil() as usize).clamp(1, numbers.len()) - 1;
        Some(*numbers.select_nth_unstable(rank.min(last)).1)
    };
    CellCounts {
        neighbors: of(|cell| cell.neighbors).unwrap_or(0),
        planes: of(|cell| cell.planes).unwrap_or(0),
        vertices: of(|cell| cell.vertices).unwrap_or(0),
        triangles: of(|cell| cell.triangles).unwrap_or(0),
    }
}

/// What the cell of sorted site `site` needs.
fn count_cell(search: &mut Search<'_>, prepared: &Prepared, request: &Request, site: u32) -> CellCounts {
    let [x, y, z, _] = prepared.sites.site(site);
    let mut store = PlainStore::new([x, y, z], prepared.domain_grid());
    let outcome = search.complete(&mut store, site, request.epsilon());
    let mut planes = store.most_planes().max(BOX_PLANES);
    if outcome.status == cell::COMPLETE {
        cell::integrate_cell(&mut store, cell::flags_of(request), 0, &mut CellSums::default());
        if store.was_saved() {
            planes = planes.max(store.planes() + CONE_PLANES);
        }
    }
    CellCounts {
        neighbors: outcome.visited,
        planes,
        vertices: store.most_vertices(),
        triangles: store.triangles_tried(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PowerDiagram;
    use crate::shapes::icosphere;

    /// Points that fill the cube [−1, 1]³ with no pattern: the fractions of multiples of irrational numbers.
    fn points(n: usize) -> Vec<[f64; 3]> {
        let at = |i: usize, step: f64| 2.0 * ((i * i) as f64 * step).fract() - 1.0;
        let points = (1..=n).map(|i| [2_f64, 3.0, 5.0].map(|x| at(i, x.sqrt())));
        points.collect()
    }

    /// The status of a cell that has so much room.
    fn status_within(prepared: &Prepared, request: &Request, site: u32, planes: u32, vertices: u32) -> u32 {
        let [x, y, z, _] = prepared.sites.site(site);
        let mut store = PlainStore::new([x, y, z], prepared.domain_grid()).with_room(planes, vertices);
        let outcome = Search::new(prepared).complete(&mut store, site, None);
        match outcome.status {
            cell::COMPLETE => cell::integrate_cell(&mut store, cell::flags_of(request), 0, &mut CellSums::default()),
            other => other,
        }
    }

    #[test]
    fn the_counts_suffice_and_nothing_less_does() {
        let positions = points(400);
        let weights: Vec<f64> = (0..400).map(|i| 0.02 * (f64::from(i) * 0.618).fract()).collect();
        let sphere = icosphere(2).domain();
        for diagram in [
            PowerDiagram::new(&[[0.3; 3]], &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap(),
            PowerDiagram::new(&positions, &[]).unwrap().in_box([-1.0; 3], [1.0; 3]).unwrap(),
            PowerDiagram::new(&positions, &[]).unwrap().restricted_to(&sphere),
            PowerDiagram::new(&positions, &weights).unwrap().restricted_to(&sphere),
        ] {
            let prepared = diagram.prepare().unwrap();
            for request in [Request::moments(), Request::moments().with_facets()] {
                let sites: Vec<u32> = (0..prepared.sites.len() as u32).collect();
                let counts = count_cells(&prepared, &request, &sites);
                assert!(diagram.domain().is_none() || counts.iter().any(|cell| cell.triangles > 0));
                for (site, cell) in counts.iter().enumerate() {
                    let within = |p, v| status_within(&prepared, &request, site as u32, p, v);
                    let enough = within(cell.planes, cell.vertices);
                    assert!(matches!(enough, cell::COMPLETE | cell::EMPTY), "{site}: {cell:?} ends with {enough}");
                    assert_eq!(within(cell.planes - 1, cell.vertices), cell::P_FULL, "{site}: {cell:?}");
                    let tight = within(cell.planes, cell.vertices - 1);
                    assert!(matches!(tight, cell::V_FULL | cell::P_FULL), "{site}: {cell:?} ends with {tight}");
                }
            }
        }
    }

    #[test]
    fn shares_are_shares() {
        let cells: Vec<CellCounts> =
            (1..=100).map(|n| CellCounts { neighbors: 101 - n, planes: n, vertices: 7, triangles: n % 2 }).collect();
        assert_eq!(sufficient(&cells, 0.95), CellCounts { neighbors: 95, planes: 95, vertices: 7, triangles: 1 });
        assert_eq!(sufficient(&cells, 0.5).triangles, 0);
        assert_eq!((sufficient(&cells, 0.0).planes, sufficient(&cells, 1.0).planes), (1, 100));
        assert_eq!(sufficient(&[], 0.95), CellCounts::default());
    }
}
