//! Steps on which no facet goes far: the way to where Newton's steps are good, when slivers are at the start.
//!
//! A Newton step is linear in the weights, which holds while no facet moves by more than the cells on its sides are deep. Where a surface has
//! cut off slivers, a few cells in a thousand would be run over by a neighbour, and to shorten the whole step for their sake takes the
//! more steps the more cells there are. Here a facet that would go too far counts as larger by as much. That leaves a Laplacian, so that
//! the step still ascends the concave function, and all the other cells go their way.
//!
//! There is a number of such steps at most, and none empties a cell: from where they end Newton's converge as from any start.

use laguerre_core::{ErrorKind, Facet, Result};
use rayon::prelude::*;

use super::mend;
use super::newton::{Problem, State};
use super::sparse::{Matrix, center};
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

/// Weight by which a site may rise above its neighbour before their facet, as the site sees it, is too far in the neighbour's cell. `sizes` are
/// the cube roots of the cells' volumes, as these would be at the mean density.
pub(super) fn limit(problem: &Problem<'_>, state: &State, sizes: &[f64], site: usize, facet: &Facet) -> f64 {
    let (other, distance) = (facet.neighbor, facet.distance);
    let (p, q, b) = (problem.positions[site], problem.positions[other], state.output.barycenter()[other]);
    let depth = (0..3).map(|k| (b[k] - facet.barycenter[k]) * (q[k] - p[k])).sum::<f64>() / distance;
    // The facet goes by the weights' difference over twice the distance.
    2.0 * distance * REACH * depth.max(FLATTEST * sizes[other])
}

/// What a limited step came to: the state after it, if there is one, which part of it was gone, and the iterations.
pub(super) struct Limited {
    pub(super) reached: Option<(f64, State)>,
    pub(super) iterations: usize,
}

/// Whether a limited step is to be tried: Newton's goes too far somewhere, and there were not enough of them yet.
pub(super) fn is_to_be(problem: &Problem<'_>, system: &System) -> bool {
    problem.limited_steps < MOST_STEPS
        && goes_too_far(system.multigrid.finest(), &system.limits, &system.newton.solution)
}

/// A limited step in place of Newton's.
pub(super) fn step(problem: &mut Problem<'_>, state: &State, system: &mut System) -> Result<Limited> {
    let mut iterations = 0;
    problem.limited_steps += 1;
    let mut stiff = system.multigrid.finest().clone();
    let mirror = mirror(&stiff);
    let mut solution = system.newton.solution.clone();
    for _ in 0..ROUNDS {
        if !stiffen(&mut stiff, &system.limits, &mirror, &solution) {
            break;
        }
        let found = system.solve_for(stiff.clone());
        iterations += found.iterations;
        solution = found.solution;
    }
    let enough = -TURNED * ascent(problem, &solution, &state.masses);
    for halvings in 0..LENGTHS {
        let length = 0.5_f64.powi(halvings);
        let mut weights = state.weights.clone();
        for_each(&mut weights, |site, w| *w += length * solution[problem.place[site] as usize]);
        center(&mut weights);
        match mend::step(problem, weights) {
            Ok(next) if next.least >= problem.bound && ascent(problem, &solution, &next.masses) >= enough => {
                return Ok(Limited { reached: Some((length, next)), iterations });
            }
            Ok(_) => {}
            // Weights out of range: much too far.
            Err(error) if error.kind() == ErrorKind::Input => {}
            Err(error) => return Err(error),
        }
    }
    Ok(Limited { reached: None, iterations })
}

/// How steeply the concave function rises along a step where the cells have these masses.
fn ascent(problem: &Problem<'_>, step: &[f64], masses: &[f64]) -> f64 {
    let lacking = |site: usize| problem.targets[site] - masses[site];
    sum(step.len(), |row| lacking(problem.order[row] as usize) * step[row])
}

/// Whether weights `x` move some facet too far.
fn goes_too_far(matrix: &Matrix, limits: &[f64], x: &[f64]) -> bool {
    let too_far = |i: usize| {
        let entries = matrix.offsets[i]..matrix.offsets[i + 1];
        matrix.columns[entries.clone()].iter().zip(&limits[entries]).any(|(&j, limit)| x[i] - x[j as usize] > *limit)
    };
    (0..matrix.rows()).into_par_iter().any(too_far)
}

/// For each entry of a symmetric matrix where its mirror image stands.
fn mirror(matrix: &Matrix) -> Vec<usize> {
    let row = |i: usize| matrix.offsets[i]..matrix.offsets[i + 1];
    let image = |i: usize, k: usize| {
        let there = row(matrix.columns[k] as usize);
        there.start + matrix.columns[there.clone()].iter().position(|&back| back as usize == i).unwrap_or(0)
    };
    (0..matrix.rows()).into_par_iter().flat_map_iter(|i| row(i).map(move |k| image(i, k))).collect()
}

/// Makes the facets larger that weights `x` move too far, by as much as that is; whether there are any.
fn stiffen(matrix: &mut Matrix, limits: &[f64], mirror: &[usize], x: &[f64]) -> bool {
    let mut factors = vec![1.0; matrix.entries()];
    let row_of = |k: usize| matrix.columns[mirror[k]] as usize;
    // Both entries of a facet have the same factor, to the last bit.
    for_each(&mut factors, |k, factor| {
        let rise = x[row_of(k)] - x[matrix.columns[k] as usize];
        *factor = (rise / limits[k]).max(-rise / limits[mirror[k]]).max(1.0);
    });
    for_each(&mut matrix.values, |k, value| *value *= factors[k]);
    let diagonals: Vec<f64> = (0..matrix.rows())
        .into_par_iter()
        .map(|i| -matrix.values[matrix.offsets[i] + 1..matrix.offsets[i + 1]].iter().sum::<f64>())
        .collect();
    for (i, diagonal) in diagonals.into_iter().enumerate() {
        matrix.values[matrix.offsets[i]] = diagonal;
    }
    factors.par_iter().any(|factor| *factor > 1.0)
}
