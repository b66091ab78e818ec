//! What cells need: the counts `K`, `P`, `V`, `T` of single cells (paper §6.1), and the capacities that most of them are content
//! with.

use crate::cell::{self, CellStore, CellSums, PlainStore};
use crate::diagram::{Container, Prepared};
use crate::passes::Capacities;
use crate::request::Request;
use crate::search::Search;
use crate::{PowerDiagram, Result};
use rayon::prelude::*;

/// The share of the cells that the first pass is to have room for (paper §6.1).
pub const FIRST_PASS_SHARE: f64 = 0.95;

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

/// The counts of some sorted sites of a diagram, in their order, on the calling thread's pool. `K` is that of the search on the host.
pub fn count_cells(prepared: &Prepared, request: &Request, sites: &[u32]) -> Vec<CellCounts> {
    sites.par_iter().map_init(Search::default, |search, &site| count_cell(search, prepared, request, site)).collect()
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

/// Room for [`FIRST_PASS_SHARE`] of the cells, from a sample of them: a few milliseconds, and one look at every position. The same
/// diagram has the same.
///
/// # Errors
/// As [`PowerDiagram::prepare`].
pub fn first_capacities(diagram: &PowerDiagram, request: &Request) -> Result<Capacities> {
    let found = sufficient(&count_sample(diagram, request)?, FIRST_PASS_SHARE);
    Ok(Capacities { planes: found.planes, vertices: found.vertices })
}

/// Sites up to which a diagram is its own sample.
const FEW: usize = 16_384;
/// Cells of a sample.
const SAMPLE: usize = 256;
/// Windows of a sample of a larger diagram, and the sites wanted and kept in each: those that may cut the cells in its middle.
const WINDOWS: usize = 8;
const SITES_IN_WINDOW: usize = 1_500;
const MOST_IN_WINDOW: usize = 6_000;
/// Sites that are worth a task of their own.
const SITES_AT_ONCE: usize = 16_384;
/// Sites that the width of a window is estimated from, and the fewest of them that it holds.
const ESTIMATE: usize = 32_768;
const FEWEST_OF_ESTIMATE: usize = 8;

/// The counts of a sample of the cells. Of a large diagram not even the grid is made: whole windows of sites stand for it, about sites
/// taken at random, and the cells in their middle are counted. What a heavy site far away does to them is missed.
pub fn count_sample(diagram: &PowerDiagram, request: &Request) -> Result<Vec<CellCounts>> {
    let positions = diagram.positions();
    if positions.len() <= FEW {
        let prepared = diagram.prepare()?;
        let sites: Vec<u32> = spread(prepared.sites.len(), SAMPLE).map(|i| i as u32).collect();
        return Ok(count_cells(&prepared, request, &sites));
    }
    let windows = windows(positions);
    let mut wanted = Vec::new();
    let mut kept = Vec::new();
    for mut inside in sites_in(positions, &windows) {
        inside.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        wanted.extend(inside.iter().take(SAMPLE / WINDOWS).map(|&(_, site)| site));
        kept.extend(inside.iter().take(MOST_IN_WINDOW).map(|&(_, site)| site));
    }
    for sites in [&mut wanted, &mut kept] {
        sites.sort_unstable();
        sites.dedup();
    }
    let part: Vec<[f64; 3]> = kept.iter().map(|&i| positions[i as usize]).collect();
    let weights: Vec<f64> = kept.iter().filter_map(|&i| diagram.weights().get(i as usize).copied()).collect();
    let part = PowerDiagram::new(&part, &weights)?;
    let part = match diagram.container()? {
        Container::Domain(domain) => part.restricted_to(&domain),
        Container::Box(lo, hi) => part.in_box(lo, hi)?,
    };
    let prepared = part.prepare()?;
    let is_wanted = |&sorted: &u32| {
        let site = kept[prepared.sites.order()[sorted as usize] as usize];
        wanted.binary_search(&site).is_ok()
    };
    let sites: Vec<u32> = (0..prepared.sites.len() as u32).filter(is_wanted).collect();
    Ok(count_cells(&prepared, request, &sites))
}

/// What the cell of sorted site `site` needs.
fn count_cell(search: &mut Search, prepared: &Prepared, request: &Request, site: u32) -> CellCounts {
    let [x, y, z, _] = prepared.sites.sites()[site as usize];
    let mut store = PlainStore::new([x, y, z], prepared.domain_grid());
    let outcome = search.complete(&mut store, prepared, None, site, request.epsilon);
    let mut planes = store.most_planes().max(BOX_PLANES);
    if outcome.status == cell::COMPLETE {
        cell::integrate_cell(&mut store, cell::flags_of(request), 0, &mut CellSums::default());
        if store.triangles_tried() > 0 {
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

/// `count` of the numbers below `n` (all, if they are not more), spread so evenly that no period of theirs shows: multiples of the golden
/// ratio.
fn spread(n: usize, count: usize) -> impl Iterator<Item = usize> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let all = n <= count;
    (0..n.min(count)).map(move |i| if all { i } else { ((i as f64 * GOLDEN).fract() * n as f64) as usize })
}

/// A cube: its centre, and half its width.
type Window = ([f64; 3], f64);

/// Windows about sites, each of about `SITES_IN_WINDOW` sites.
fn windows(positions: &[[f64; 3]]) -> Vec<Window> {
    let n = positions.len();
    let few: Vec<[f64; 3]> = spread(n, ESTIMATE).map(|i| positions[i]).collect();
    let rank = (few.len() * SITES_IN_WINDOW / n).max(FEWEST_OF_ESTIMATE);
    let around = |center: [f64; 3]| {
        let mut distances: Vec<f64> = few.iter().map(|&p| distance(p, center)).collect();
        (center, *distances.select_nth_unstable_by(rank, f64::total_cmp).1)
    };
    // The centres are spread over the few, so that they are not the first of them.
    spread(few.len(), WINDOWS).map(|i| around(few[i])).collect()
}

/// For each window the sites within, with their distance from its centre.
fn sites_in(positions: &[[f64; 3]], windows: &[Window]) -> Vec<Vec<(f64, u32)>> {
    // Most sites are in no window, and for nearly all of those one coordinate tells.
    let near = |p: [f64; 3], &(center, half): &Window| (p[0] - center[0]).abs() <= half && distance(p, center) <= half;
    let found: Vec<(usize, f64, u32)> = positions
        .par_chunks(SITES_AT_ONCE)
        .enumerate()
        .flat_map_iter(|(chunk, positions)| {
            let mut found = Vec::new();
            for (i, &p) in positions.iter().enumerate() {
                for (w, window) in windows.iter().enumerate().filter(|(_, window)| near(p, window)) {
                    found.push((w, distance(p, window.0), (chunk * SITES_AT_ONCE + i) as u32));
                }
            }
            found
        })
        .collect();
    let mut sites = vec![Vec::new(); windows.len()];
    found.into_iter().for_each(|(w, distance, site)| sites[w].push((distance, site)));
    sites
}

/// The largest difference of two points' coordinates.
fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - q[k]).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::icosphere;

    /// Points that fill the cube [−1, 1]³ with no pattern: the fractions of multiples of irrational numbers.
    fn points(n: usize) -> Vec<[f64; 3]> {
        let at = |i: usize, step: f64| 2.0 * ((i * i) as f64 * step).fract() - 1.0;
        let points = (1..=n).map(|i| [2_f64, 3.0, 5.0].map(|x| at(i, x.sqrt())));
        points.collect()
    }

    /// The status of a cell that has so much room.
    fn status_within(prepared: &Prepared, request: &Request, site: u32, planes: u32, vertices: u32) -> u32 {
        let [x, y, z, _] = prepared.sites.sites()[site as usize];
        let mut store = PlainStore::new([x, y, z], prepared.domain_grid()).with_room(planes, vertices);
        let outcome = Search::default().complete(&mut store, prepared, None, site, None);
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

    #[test]
    fn a_sample_of_windows_stands_for_the_whole() {
        let diagram = PowerDiagram::new(&points(40_000), &[]).unwrap().restricted_to(&icosphere(2).domain());
        let request = Request::moments();
        let prepared = diagram.prepare().unwrap();
        let all: Vec<u32> = (0..prepared.sites.len() as u32).collect();
        let whole = sufficient(&count_cells(&prepared, &request, &all), FIRST_PASS_SHARE);
        let first = first_capacities(&diagram, &request).unwrap();
        assert!(first.planes.abs_diff(whole.planes) <= 3, "{first:?} for {whole:?}");
        assert!(first.vertices.abs_diff(whole.vertices) <= 6, "{first:?} for {whole:?}");
        assert_eq!(first, first_capacities(&diagram, &request).unwrap());
    }
}
