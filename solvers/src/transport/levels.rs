//! The way from few sites to all of them: first weights that hardly depend on where the sites are.
//!
//! Sites are put together to groups by place, halves of halves. A group is a site at the mean of its members, and is to have what they are
//! to have together. From the weights of a level follow those of the next finer one. Where `ψ(p) = (‖p‖² − w)/2` is the potential, a
//! convex function whose gradient at a site is in its cell, `P` a group's site, `b` the barycenter of its cell, the members at `p` have
//! `ψ(P) + b·(p − P) + h/2 ‖p − P‖²`: among themselves they have the Voronoi diagram of the points `b + h(p − P)`, and `h` makes these as
//! wide as the cell is. At the border of a group that is not quite right, and a cell may be empty, which is mended (`mend.rs`).
//!
//! With groups of eight the levels cost a seventh of the last step, not as much as it; but from groups of two the last level began with half as many
//! empty cells, and 3,000 sites in the box of a trefoil knot took 9 steps and 8 s, not 15 and 21 s.

use std::ops::ControlFlow::Continue;
use std::ops::Range;
use std::time::Instant;

use laguerre_core::{Error, ErrorKind, Result};

use super::newton::{Problem, State};
use super::sparse::center;
use super::{End, Options, mend};
use crate::vectors::{distance2, for_each, inner};

/// Residual that a level is left with.
const ENOUGH: f64 = 0.25;
/// Newton steps of a level at most; the next can do with what there is then.
const MOST_STEPS: usize = 30;

/// The groups at some depth of halving, as sites.
#[derive(Default)]
struct Level {
    depth: u32,
    positions: Vec<[f64; 3]>,
    targets: Vec<f64>,
}

/// A state of `problem` that is near the one sought, with the cells of all groups of sites found first. A cell may be empty where there was
/// no mending.
///
/// # Errors
/// `Interrupted` where someone wants this to stop, and what the backend says.
pub(super) fn state(problem: &mut Problem<'_>) -> Result<State> {
    let n = problem.positions.len();
    let depth = (0..).find(|depth| n <= 2 << depth).unwrap_or(0);
    let order = halved(&problem.positions, depth);
    let mut coarse: Option<(Level, State)> = None;
    for depth in 0..=depth {
        let level = Level::new(problem, &order, depth);
        let parents: Vec<u32> = (0..level.positions.len() as u32).collect();
        let weights = refined(coarse.as_ref(), depth, &level, &parents);
        if let Some(state) = solved(problem, &level, weights)? {
            coarse = Some((level, state));
        }
    }
    // Each site is a member of the group that its place in the order is in.
    let mut parents = vec![0; n];
    for part in 0..1 << depth {
        order[bounds(n, depth, part)].iter().for_each(|&i| parents[i as usize] = part as u32);
    }
    let (positions, targets) = (std::mem::take(&mut problem.positions), std::mem::take(&mut problem.targets));
    let all = Level { depth, positions, targets };
    let weights = refined(coarse.as_ref(), depth, &all, &parents);
    (problem.positions, problem.targets) = (all.positions, all.targets);
    let state = problem.evaluate(weights)?;
    mend::mended(problem, state)
}

/// The state of a level near the targets; `None` where two of its sites coincide, or a cell stays empty, so that the next is to begin from the one before.
fn solved(problem: &mut Problem<'_>, level: &Level, weights: Vec<f64>) -> Result<Option<State>> {
    let options = Options::default().of(problem.density).until(MOST_STEPS, ENOUGH);
    let targets = level.targets.iter().map(|target| target * problem.unit).collect();
    let mut diagram = problem.diagram.clone();
    let first = diagram.set_sites(&level.positions, &weights).and_then(|()| {
        let mut solver = Problem::new(problem.backend, &mut diagram, targets, &options)?;
        let state = solver.evaluate(weights)?;
        Ok((mend::mended(&mut solver, state)?, solver))
    });
    let (state, mut solver) = match first {
        Ok(first) => first,
        Err(error) if error.kind() == ErrorKind::Input => return Ok(None),
        Err(error) => return Err(error),
    };
    if state.least <= 0.0 {
        return Ok(None);
    }
    let mut seconds = 0.0;
    let (state, end) = solver.run(state, Instant::now(), MOST_STEPS, &mut |iteration| {
        seconds += iteration.diagram_seconds;
        Continue(())
    })?;
    problem.seconds += seconds + solver.seconds;
    if end == End::Interrupted {
        return Err(Error::new(ErrorKind::Interrupted, "interrupted before there are first weights"));
    }
    Ok(Some(state))
}

/// Weights of sites whose groups, at `depth` of halving, `parents` tells, from what those groups or coarser ones have; equal where there are none.
fn refined(coarse: Option<&(Level, State)>, depth: u32, level: &Level, parents: &[u32]) -> Vec<f64> {
    let (positions, mut weights) = (&level.positions, vec![0.0; level.positions.len()]);
    let Some((upper, state)) = coarse else { return weights };
    let group = |i: usize| (parents[i] >> (depth - upper.depth)) as usize;
    let mut spread = vec![0.0; upper.positions.len()];
    for (i, p) in positions.iter().enumerate() {
        spread[group(i)] += level.targets[i] / upper.targets[group(i)] * distance2(*p, upper.positions[group(i)]);
    }
    let width = |g: usize| {
        let trace = state.output.second_moment().map_or(0.0, |m| m[g][0] + m[g][1] + m[g][2]);
        trace / state.output.volume()[g]
    };
    for_each(&mut weights, |i, w| {
        let g = group(i);
        let (p, q, b) = (positions[i], upper.positions[g], state.output.barycenter()[g]);
        let way = std::array::from_fn(|k| p[k] - q[k]);
        let from = std::array::from_fn(|k| (p[k] - b[k]) + (q[k] - b[k]));
        let h = if spread[g] > 0.0 { (width(g).max(0.0) / spread[g]).sqrt() } else { 0.0 };
        *w = state.weights[g] + inner(way, from) - h * inner(way, way);
    });
    center(&mut weights);
    weights
}

impl Level {
    /// The parts at a depth of halving.
    fn new(problem: &Problem<'_>, order: &[u32], depth: u32) -> Self {
        let members = |part: usize| order[bounds(order.len(), depth, part)].iter().map(|&i| i as usize);
        let target = |part: usize| members(part).map(|i| problem.targets[i]).sum::<f64>();
        let mean = |part: usize| {
            let total = target(part);
            let share = |i: usize, k: usize| problem.targets[i] / total * problem.positions[i][k];
            std::array::from_fn(|k| members(part).map(|i| share(i, k)).sum())
        };
        Self { depth, positions: (0..1 << depth).map(mean).collect(), targets: (0..1 << depth).map(target).collect() }
    }
}

/// Where a part of `n` things at a depth of halving begins and ends.
fn bounds(n: usize, depth: u32, part: usize) -> Range<usize> {
    (n * part) >> depth..(n * (part + 1)) >> depth
}

/// The sites so that each part, down to a depth of halving, is a range: halves along the axis that they are widest in.
fn halved(positions: &[[f64; 3]], depth: u32) -> Vec<u32> {
    fn halve(positions: &[[f64; 3]], order: &mut [u32], n: usize, part: usize, depth: u32, most: u32) {
        if depth == most {
            return;
        }
        let along = |k: usize| order.iter().map(move |&i| positions[i as usize][k]);
        let width = |k: usize| along(k).fold(f64::NEG_INFINITY, f64::max) - along(k).fold(f64::INFINITY, f64::min);
        let axis = (0..3).max_by(|&a, &b| width(a).total_cmp(&width(b))).unwrap_or(0);
        let middle = bounds(n, depth + 1, 2 * part).len();
        let at = |i: u32| positions[i as usize][axis];
        order.select_nth_unstable_by(middle, |&i, &j| at(i).total_cmp(&at(j)).then(i.cmp(&j)));
        let (left, right) = order.split_at_mut(middle);
        rayon::join(
            || halve(positions, left, n, 2 * part, depth + 1, most),
            || halve(positions, right, n, 2 * part + 1, depth + 1, most),
        );
    }
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    halve(positions, &mut order, positions.len(), 0, 0, depth);
    order
}
