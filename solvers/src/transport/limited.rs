//! Steps on which no facet goes far: the way to where Newton's steps are good, when slivers are at the start.
//!
//! A Newton step is linear in the weights, which holds while no facet moves by more than the cells on its sides are deep. Where a surface has
//! cut off slivers, a few cells in a thousand would be run over by a neighbour, and to shorten the whole step for their sake takes the
//! more steps the more cells there are. Here a facet that would go too far counts as larger by as much. That leaves a Laplacian, so that
//! the step still ascends the concave function, and all the other cells go their way.
//!
//! There is a number of such steps at most, and none empties a cell: from where they end Newton's converge as from any start.

use laguerre_core::Result;
use laguerre_core::algebra::{Algebra, CELL, Held};

use super::mend;
use super::newton::{Problem, State, is_out_of_range};
use super::sparse::center;
use super::system::System;
use crate::vectors::{for_each, sum};

/// Steps of this kind at most; some 15 are usual.
const MOST_STEPS: usize = 40;
/// How far a facet may go into a cell, in parts of the way to its barycenter. Measured: with a half, steps are too short, with all of it
/// cells are run over.
const REACH: f64 = 0.7;
/// Cells flatter than this part of their size count as that deep: they grow with the step themselves.
const FLATTEST: f64 = 0.1;
/// Times that facets are made stiffer for one step. Not all that go too far are found then, but nearly all.
const ROUNDS: usize = 3;
/// Lengths of a step that are tried, each half of the last.
const LENGTHS: i32 = 3;
/// A step ascends enough where the ascent at its end is not turned around by more than this part of that at its beginning: along a
/// parabola, the end is then higher than the beginning.
const TURNED: f64 = 0.5;

/// What tells how far the facets of a state may go: of each cell, in the order of the matrix's rows, its site, weight, barycenter, and the cube root of its
/// volume, as that would be at the mean density.
pub(super) struct Limits(Held);

impl Limits {
    pub(super) fn new(problem: &Problem<'_>, state: &State, algebra: &dyn Algebra) -> Result<Self> {
        if let Some(kept) = state.output.kept()
            && let Some(cells) = algebra.cells(kept, problem.mean_density)?
        {
            return Ok(Self(cells));
        }
        let mut cells = vec![[0.0; CELL]; problem.order.len()];
        for_each(&mut cells, |row, cell| {
            let i = problem.order[row] as usize;
            let ([x, y, z], [a, b, c]) = (problem.diagram.positions()[i], state.output.barycenter()[i]);
            let size = (state.output.volume()[i] / problem.mean_density).cbrt();
            *cell = [x, y, z, state.weights[i], a, b, c, size];
        });
        algebra.vector(cells.as_flattened()).map(Self)
    }
}

/// What a limited step came to: the state after it, if there is one, which part of it was gone, and the iterations.
pub(super) struct Limited {
    pub(super) reached: Option<(f64, State)>,
    pub(super) iterations: usize,
}

/// Whether a limited step is to be tried: Newton's goes too far somewhere, and there were not enough of them yet.
pub(super) fn is_to_be(problem: &Problem<'_>, system: &System<'_>) -> Result<bool> {
    Ok(problem.limited_steps < MOST_STEPS && goes_too_far(system)?)
}

/// Whether a facet goes too far by the system's solution.
fn goes_too_far(System { multigrid, limits, newton, .. }: &System<'_>) -> Result<bool> {
    multigrid.algebra().rises_too_far(multigrid.finest(), &newton.held, &limits.0, REACH, FLATTEST)
}

/// A limited step in place of Newton's; and the system, solved for that.
pub(super) fn step<'a>(
    problem: &mut Problem<'a>,
    state: &State,
    mut system: System<'a>,
) -> Result<(Limited, System<'a>)> {
    let algebra = system.multigrid.algebra();
    let mut iterations = 0;
    problem.limited_steps += 1;
    for _ in 0..ROUNDS {
        if !goes_too_far(&system)? {
            break;
        }
        let (matrix, solution) = (system.multigrid.finest(), &system.newton.held);
        let stiff = algebra.stiffened(matrix, solution, &system.limits.0, REACH, FLATTEST)?;
        system = system.solved_for(stiff)?;
        iterations += system.newton.iterations;
    }
    let solution = &system.newton.solution;
    let enough = -TURNED * ascent(problem, solution, &state.masses);
    for halvings in 0..LENGTHS {
        let length = 0.5_f64.powi(halvings);
        let mut weights = state.weights.clone();
        for_each(&mut weights, |site, w| *w += length * solution[problem.place[site] as usize]);
        center(&mut weights);
        match mend::step(problem, weights) {
            Ok(next) if next.least >= problem.bound && ascent(problem, solution, &next.masses) >= enough => {
                return Ok((Limited { reached: Some((length, next)), iterations }, system));
            }
            Ok(_) => {}
            // Weights out of range: much too far.
            Err(error) if is_out_of_range(&error) => {}
            Err(error) => return Err(error),
        }
    }
    Ok((Limited { reached: None, iterations }, system))
}

/// How steeply the concave function rises along a step where the cells have these masses.
fn ascent(problem: &Problem<'_>, step: &[f64], masses: &[f64]) -> f64 {
    let lacking = |site: usize| problem.targets[site] - masses[site];
    sum(step.len(), |row| lacking(problem.order[row] as usize) * step[row])
}
