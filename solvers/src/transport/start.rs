//! First weights for which no cell is empty.
//!
//! The power diagram of sites `p_i` with weights `(1 − s)‖p_i − c‖²` is the Voronoi diagram of `c + s(p_i − c)`, the sites drawn towards
//! `c`: the power distance less what all sites share, times `s`, is that Voronoi diagram's. With `c` in the interior of the domain and
//! `s` small enough all of those are inside, and each in its own cell; `s = 1` is the Voronoi diagram of the sites themselves.

use laguerre_core::diagram::Container;
use laguerre_core::site_tree::SiteTree;
use laguerre_core::{Backend, Domain, Error, Output, PowerDiagram, Request, Result};

use super::sparse::center;
use super::{Problem, State};
use crate::vectors::{distance2, for_each};

/// Sites are drawn together to this part of their extent at most: what is closer could not be told apart.
const SMALLEST_SHARE: f64 = 1.0 / (1_u64 << 24) as f64;

/// Checks that no two sites coincide: of those, all cells but one are empty whatever the weights.
pub(super) fn check_coincident(positions: &[[f64; 3]], sorted: &SiteTree) -> Result<()> {
    let Some(&i) = sorted.coincident().iter().min() else { return Ok(()) };
    let p = positions[i as usize];
    // The nearest, not the equal one: positions that differ by less than a rounding of the domain's coordinates coincide too.
    let others = positions.iter().enumerate().filter(|&(j, _)| j != i as usize);
    let other = others.min_by(|a, b| distance2(*a.1, p).total_cmp(&distance2(*b.1, p))).map_or(0, |(j, _)| j);
    Err(Error::input(format!(
        "sites {} and {} are at the same place {p:?}: one of their cells is empty whatever the weights; move or remove one",
        other.min(i as usize),
        other.max(i as usize)
    ))
    .of_site(i as usize))
}

/// A state without empty cells: that of the diagram's own weights, else of the Voronoi diagram, where few are empty lifted, else of sites
/// drawn together.
pub(super) fn first(problem: &mut Problem<'_>) -> Result<State> {
    let n = problem.positions.len();
    let mut given = problem.diagram.weights().to_vec();
    let are_equal = given.iter().all(|w| *w == given[0]);
    given.resize(n, 0.0);
    center(&mut given);
    let mut state = problem.evaluate(given)?;
    if state.least <= 0.0 && !are_equal {
        state = problem.evaluate(vec![0.0; n])?;
    }
    state = lifted(problem, state)?;
    if state.least > 0.0 {
        return Ok(state);
    }
    let middle = match problem.diagram.container()? {
        Container::Box(lo, hi) => Some(std::array::from_fn(|k| lo[k] + (hi[k] - lo[k]) / 2.0)),
        Container::Domain(domain) => interior_point(problem.backend, &domain)?,
    };
    if let Some(middle) = middle {
        let mut share = 0.5;
        while share >= SMALLEST_SHARE {
            let mut weights = vec![0.0; n];
            for_each(&mut weights, |i, w| *w = (1.0 - share) * distance2(problem.positions[i], middle));
            center(&mut weights);
            state = problem.evaluate(weights)?;
            if state.least > 0.0 {
                return Ok(state);
            }
            share /= 2.0;
        }
    }
    let empty = state.masses.iter().position(|&m| m <= 0.0).unwrap_or(0);
    Err(Error::input(format!(
        "no first weights were found that leave no cell empty (site {empty} at {:?} has none): give some, or move sites that are nearly \
         at one place or far from the domain",
        problem.positions[empty]
    ))
    .of_site(empty))
}

/// Cells are lifted where no more than one in so many is empty.
const ONE_IN: usize = 100;
/// Times that they are, each twice as far as the last; the last is the square of a cell's size.
const LIFTS: i32 = 9;

/// Raises the weights of the cells that are empty until none is, where they are few: slivers, that are no more than their own rounding.
fn lifted(problem: &mut Problem<'_>, mut state: State) -> Result<State> {
    let sites = state.masses.len();
    let size2 = (state.output.volume().iter().sum::<f64>() / sites as f64).powf(2.0 / 3.0);
    for halvings in (0..LIFTS).rev() {
        let empty: Vec<usize> = (0..sites).filter(|&i| state.masses[i] <= 0.0).collect();
        if empty.is_empty() || empty.len() > sites / ONE_IN {
            break;
        }
        let mut weights = std::mem::take(&mut state.weights);
        empty.into_iter().for_each(|i| weights[i] += size2 * 0.5_f64.powi(halvings));
        center(&mut weights);
        state = problem.evaluate(weights)?;
    }
    Ok(state)
}

/// Points of a lattice along each axis.
const LATTICE: u32 = 16;
/// Times that a lattice is put into one cell of the last; each divides it by 16, down to where coordinates end.
const MOST_LATTICES: usize = 8;

/// A point in the interior of a domain, deep inside where the domain is thicker than a few cells of a lattice; `None` where it is so
/// thin that there is none in sight.
fn interior_point(backend: &dyn Backend, domain: &Domain) -> Result<Option<[f64; 3]>> {
    let (mut lo, mut hi) = domain.bounding_box();
    for _ in 0..MOST_LATTICES {
        let width: [f64; 3] = std::array::from_fn(|k| (hi[k] - lo[k]) / f64::from(LATTICE));
        let at = |k: usize, i: u32| lo[k] + (f64::from(i) + 0.5) * width[k];
        let ticks = 0..LATTICE;
        let lattice: Vec<[f64; 3]> = ticks
            .clone()
            .flat_map(|z| ticks.clone().flat_map(move |y| (0..LATTICE).map(move |x| [x, y, z])))
            .map(|[x, y, z]| [at(0, x), at(1, y), at(2, z)])
            .collect();
        let diagram = PowerDiagram::new(&lattice, &[])?.restricted_to(domain);
        let output = backend.evaluate(&diagram, &Request::moments().with_facets())?;
        if let Some(cell) = deepest(&output) {
            return Ok(Some(output.barycenter()[cell]));
        }
        // All cells meet the surface: look closer at the fullest of those that are no larger than a voxel.
        let share = |i: &usize| output.volume()[*i];
        let inner = |i: &usize| {
            let b = output.barycenter()[*i];
            output.volume()[*i] > 0.0 && (0..3).all(|k| (b[k] - lattice[*i][k]).abs() <= width[k] / 2.0)
        };
        let Some(full) = (0..lattice.len()).filter(inner).max_by(|i, j| share(i).total_cmp(&share(j))) else {
            return Ok(None);
        };
        let site = lattice[full];
        lo = std::array::from_fn(|k| site[k] - width[k] / 2.0);
        hi = std::array::from_fn(|k| site[k] + width[k] / 2.0);
    }
    Ok(None)
}

/// The cell that is most facets away from those that meet the surface, of equals the largest; `None` where all do. It is convex, and
/// with its barycenter inside the domain.
fn deepest(output: &Output) -> Option<usize> {
    let (facets, boundary) = (output.facets()?, output.boundary()?);
    let mut is_reached: Vec<bool> =
        (0..output.volume().len()).map(|i| output.volume()[i] <= 0.0 || boundary[i].area > 0.0).collect();
    let mut front: Vec<usize> = (0..is_reached.len()).filter(|&i| is_reached[i]).collect();
    loop {
        let mut next = Vec::new();
        for &i in &front {
            for j in facets.of(i).map(|facet| facet.neighbor) {
                if !std::mem::replace(&mut is_reached[j], true) {
                    next.push(j);
                }
            }
        }
        if next.is_empty() {
            let inside = front.into_iter().filter(|&i| output.volume()[i] > 0.0 && boundary[i].area == 0.0);
            return inside.max_by(|&i, &j| output.volume()[i].total_cmp(&output.volume()[j]));
        }
        front = next;
    }
}
