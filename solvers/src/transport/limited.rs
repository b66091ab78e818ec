//! Steps on which no facet goes far: the way to where Newton's steps are good, when slivers are at the start.
//!
//! A Newton step is linear in the weights, which holds while no facet moves by more than the cells on its sides are deep. Where a surface has
//! cut off slivers, a few cells in a thousand would be run over by a neighbour, and to shorten the whole step for their sake takes the
//! more steps the more cells there are. Here a facet that would go too far counts as larger by as much. That leaves a Laplacian, so that
//! the step still ascends the concave function, and all the other cells go their way.
//!
//! There is a number of such steps at most, and none empties a cell: from where they end Newton's converge as from any start.

use laguerre_core::{ErrorKind, Result};
use rayon::prelude::*;

use super::mend;
use super::newton::{Problem, State};
use super::sparse::{Matrix, center};
use super::system::System;
use crate::vectors::{for_each, inner, sum};

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

/// What tells how far the facets of a state may go: of each cell, in the order of the matrix's rows.
pub(super) struct Limits(Vec<Cell>);

/// A site, its weight, the barycenter of its cell, and the cube root of the cell's volume, as that would be at the mean density.
struct Cell {
    site: [f64; 3],
    weight: f64,
    barycenter: [f64; 3],
    size: f64,
}

impl Limits {
    pub(super) fn new(problem: &Problem<'_>, state: &State) -> Self {
        let cell = |&i: &u32| {
            let i = i as usize;
            Cell {
                site: problem.positions[i],
                weight: state.weights[i],
                barycenter: state.output.barycenter()[i],
                size: (state.output.volume()[i] / problem.mean_density).cbrt(),
            }
        };
        Self(problem.order.par_iter().map(cell).collect())
    }

    /// Weight by which the site of a row may rise above that of another before their facet is too far in the other's cell.
    fn of(&self, row: usize, other: usize) -> f64 {
        let (own, other) = (&self.0[row], &self.0[other]);
        let way: [f64; 3] = std::array::from_fn(|k| other.site[k] - own.site[k]);
        let distance = inner(way, way).sqrt();
        // The facet is in the plane where the two powers are equal, and goes by the weights' difference over twice the distance.
        let facet = (distance * distance + (own.weight - other.weight)) / (2.0 * distance);
        let middle = std::array::from_fn(|k| other.barycenter[k] - own.site[k]);
        let depth = inner(middle, way) / distance - facet;
        2.0 * distance * REACH * depth.max(FLATTEST * other.size)
    }
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
fn goes_too_far(matrix: &Matrix, limits: &Limits, x: &[f64]) -> bool {
    let rises = |i: usize, j: usize| x[i] > x[j] && x[i] - x[j] > limits.of(i, j);
    (0..matrix.rows()).into_par_iter().any(|i| matrix.row(i).any(|(j, _)| rises(i, j)))
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
fn stiffen(matrix: &mut Matrix, limits: &Limits, mirror: &[usize], x: &[f64]) -> bool {
    let mut factors = vec![1.0; matrix.entries()];
    // Both entries of a facet have the same factor, to the last bit.
    for_each(&mut factors, |k, factor| {
        let (row, column) = (matrix.columns[mirror[k]] as usize, matrix.columns[k] as usize);
        let rise = x[row] - x[column];
        if rise != 0.0 {
            let limit = if rise > 0.0 { limits.of(row, column) } else { limits.of(column, row) };
            *factor = (rise.abs() / limit).max(1.0);
        }
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
