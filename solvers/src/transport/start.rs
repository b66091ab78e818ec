//! First weights for which no cell is empty.

use laguerre_core::site_tree::SiteTree;
use laguerre_core::{Error, Result};

use super::newton::{Problem, State};
use super::sparse::center;
use super::{levels, mend};
use crate::vectors::{count, distance2};

/// Checks that no two sites coincide: of those, all cells but one are empty whatever the weights.
pub(super) fn check_coincident(positions: &[[f64; 3]], sorted: &SiteTree) -> Result<()> {
    let Some(&i) = sorted.coincident().iter().min() else { return Ok(()) };
    let p = positions[i as usize];
    // The nearest, not the equal one: positions that differ by less than a rounding of the domain's coordinates coincide too.
    let (other, _) = nearest(positions, i as usize);
    Err(Error::input(format!(
        "sites {} and {} are at the same place {p:?}: one of their cells is empty whatever the weights; move or remove one",
        other.min(i as usize),
        other.max(i as usize)
    ))
    .of_site(i as usize))
}

/// Of the mass asked for: cells with less are tiny.
const TINY: f64 = 1e-3;
/// Weights are good to start from where no more than one cell, or one in so many, is tiny or empty, and none has more than so many times what it is
/// to have (of white noise some 5). (With one in 10, 6,833 cells of the bunny's box, of which it cuts slivers, took 15 steps and 25 diagrams from there; from few
/// sites to all 7 and 9.) Weights that were given may be near those sought where more are.
const ONE_IN: usize = 1000;
const ONE_IN_OF_GIVEN: usize = 10;
const LARGEST: f64 = 10.0;

/// A state without empty cells: that of the diagram's own weights, or of the Voronoi diagram, if hardly any of its cells are tiny; else one that is found
/// from few sites to all (`levels.rs`). Both then take 5 steps for 6,000 sites in the bunny, and the Voronoi diagram half the time; for sites that
/// are not spread as the domain is, it takes tens, or does not end.
pub(super) fn first(problem: &mut Problem<'_>) -> Result<State> {
    let n = problem.diagram.positions().len();
    let mut given = problem.diagram.weights().to_vec();
    let are_equal = given.iter().all(|w| *w == given[0]);
    given.resize(n, 0.0);
    center(&mut given);
    let mut state = problem.evaluate(given)?;
    let mut one_in = if are_equal { ONE_IN } else { ONE_IN_OF_GIVEN };
    if !is_good(problem, &state, one_in) && !are_equal {
        state = problem.evaluate(vec![0.0; n])?;
        one_in = ONE_IN;
    }
    if is_good(problem, &state, one_in) {
        state = mend::mended(problem, state)?;
    }
    if !is_good(problem, &state, one_in) || state.least <= 0.0 {
        state = levels::state(problem)?;
    }
    if state.least > 0.0 {
        return Ok(state);
    }
    let is_empty = |mass: &f64| *mass <= 0.0;
    let (empty, count) =
        (state.masses.iter().position(is_empty).unwrap_or(0), state.masses.iter().filter(|m| is_empty(m)).count());
    let place = problem.diagram.positions()[empty];
    let (other, away) = nearest(problem.diagram.positions(), empty);
    Err(Error::input(format!(
        "no first weights were found that leave no cell empty: {count} of {n} are, first that of site {empty} at {place:?}, to which the nearest \
         is site {other}, at a distance of {away:.1e}; give weights that leave none empty, or move or remove such sites"
    ))
    .of_site(empty))
}

/// The site nearest to another, and its distance.
fn nearest(positions: &[[f64; 3]], site: usize) -> (usize, f64) {
    let others = positions.iter().enumerate().filter(|&(j, _)| j != site);
    let distances = others.map(|(j, q)| (j, distance2(*q, positions[site])));
    let (other, away2) = distances.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((site, 0.0));
    (other, away2.sqrt())
}

fn is_good(problem: &Problem<'_>, state: &State, one_in: usize) -> bool {
    let tiny = count(state.masses.len(), |i| state.masses[i] < TINY * problem.targets[i]);
    tiny.saturating_sub(1) * one_in <= state.masses.len() && state.residual <= LARGEST
}
