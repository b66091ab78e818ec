//! The way from few sites to all of them: first weights that hardly depend on where the sites are.
//!
//! Sites are put together to groups by place, halves of halves. A group is a site at the mean of its members, and is to have what they are
//! to have together. From the weights of a level follow those of the next finer one: the potential `ψ(p) = (‖p‖² − w)/2` at a site p is on the highest
//! of the planes that touch it at the groups (`tangents.rs`), and above that by `c σ |p − P|`, where `P` is the group of that plane and `σ` the standard
//! deviation, along `p − P`, of the points of its cell. So the site has less power than the group had beyond a plane across the cell, `c σ` from
//! its barycenter.
//!
//! It is the highest of all planes that matters, not that of the site's own group: a member near the crowd, of a group whose others are far from it, was so
//! far too low that its cell took a tenth of the domain. 10,000 sites of a Plummer cluster then took 69 diagrams with weights in which a cell took ten
//! times as long as others; now they take 8, and with 100,000 the first weights come after 10 s on two cores, not after 20 min.
//!
//! A cell may yet be empty, which is mended (`mend.rs`).

use std::ops::ControlFlow::Continue;
use std::ops::Range;
use std::time::Instant;

use laguerre_core::{Error, ErrorKind, Result};

use super::newton::{Problem, State, is_out_of_range};
use super::sparse::center;
use super::tangents::Tangents;
use super::{End, Options, mend};
use crate::vectors::map;

/// Groups are halved so often from level to level. (Once takes a quarter longer, three times as long.)
const HALVINGS: u32 = 2;
/// Residual that a level is left with. (With 0.25 and 1 it takes a tenth longer.)
const ENOUGH: f64 = 0.5;
/// That `c` is √12 / 8: of cells side by side, each between two parallel planes, the members of groups of two have halves of it.
const DEVIATIONS: f64 = 0.433;
/// Newton steps of a level at most; the next can do with what there is then.
const MOST_STEPS: usize = 30;

/// The groups at some depth of halving, as sites.
struct Level {
    positions: Vec<[f64; 3]>,
    targets: Vec<f64>,
}

/// A state of `problem` that is near the one sought, with the cells of all groups of sites found first. A cell may be empty where there was
/// no mending.
///
/// # Errors
/// `Interrupted` where someone wants this to stop, and what the backend says.
pub(super) fn state(problem: &mut Problem<'_>) -> Result<State> {
    let n = problem.diagram.positions().len();
    let finest = (0..).find(|depth| n <= 1 << HALVINGS << depth).unwrap_or(0);
    let order = halved(problem.diagram.positions(), finest);
    let parts = moments_of_parts(problem, &order, finest);
    let mut coarse: Option<(Level, State)> = None;
    for depth in (finest % HALVINGS..=finest).step_by(HALVINGS as usize) {
        let level = Level::new(&parts, depth);
        let weights = refined(coarse.as_ref(), &level.positions, &(0..1 << depth).collect::<Vec<_>>());
        if let Some(state) = solved(problem, &level, weights)? {
            coarse = Some((level, state));
        }
    }
    let weights = refined(coarse.as_ref(), problem.diagram.positions(), &order);
    let state = problem.evaluate(weights)?;
    mend::mended(problem, state)
}

/// The state of a level near the targets; `None` where two of its sites coincide, or a cell stays empty, so that the next is to begin from the one before.
fn solved(problem: &mut Problem<'_>, level: &Level, weights: Vec<f64>) -> Result<Option<State>> {
    // (A function is integrated by the same degree, though cells are larger: with as many nodes for all cells as at the end, first weights took three times
    // as long, and steps after them were as many.)
    let options = Options::default().of(problem.density.clone()).until(MOST_STEPS, ENOUGH);
    let targets = level.targets.iter().map(|target| target * problem.unit).collect();
    let diagram = problem.diagram.of_other_sites(&level.positions, &weights);
    let Some(mut diagram) = in_range(diagram)? else { return Ok(None) };
    let first = Problem::new(problem.backend, &mut diagram, targets, &options).and_then(|mut solver| {
        // (Of which the next level makes its weights.)
        solver.request = solver.request.with_second_moments();
        let state = solver.evaluate(weights)?;
        Ok((mend::mended(&mut solver, state)?, solver))
    });
    let Some((state, mut solver)) = in_range(first)? else { return Ok(None) };
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

/// What a level came to; `None` where its weights were out of range.
fn in_range<T>(result: Result<T>) -> Result<Option<T>> {
    match result {
        Err(error) if is_out_of_range(&error) => Ok(None),
        result => result.map(Some),
    }
}

/// Weights of sites from what groups of them have; equal where there are none. In `order` neighbors are together.
fn refined(coarse: Option<&(Level, State)>, positions: &[[f64; 3]], order: &[u32]) -> Vec<f64> {
    let mut weights = vec![0.0; positions.len()];
    let Some((level, State { weights: coarse, output, .. })) = coarse else { return weights };
    let rows: Vec<u32> = (0..coarse.len() as u32).collect();
    let tangents = Tangents::new(&level.positions, coarse, output, &rows, positions.len());
    let moments = output.second_moment().unwrap_or_default();
    let points = map(order.len(), |k| positions[order[k] as usize]);
    let highest = tangents.highest(&points);
    let found = map(order.len(), |place| {
        let (p, (weight, group)) = (points[place], highest[place]);
        let [x, y, z]: [f64; 3] = std::array::from_fn(|k| p[k] - level.positions[group][k]);
        let [xx, yy, zz, xy, xz, yz] = moments.get(group).copied().unwrap_or_default();
        let moment = xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z);
        weight - 2.0 * DEVIATIONS * (moment.max(0.0) / output.volume()[group]).sqrt()
    });
    order.iter().zip(found).for_each(|(&i, weight)| weights[i as usize] = weight);
    center(&mut weights);
    weights
}

/// The mass of each part at a depth of halving, and of that the moments.
fn moments_of_parts(problem: &Problem<'_>, order: &[u32], depth: u32) -> Vec<[f64; 4]> {
    map(1 << depth, |part| {
        let mut sums = [0.0; 4];
        for &i in &order[bounds(order.len(), depth, part)] {
            let (mass, [x, y, z]) = (problem.targets[i as usize], problem.diagram.positions()[i as usize]);
            [1.0, x, y, z].iter().zip(&mut sums).for_each(|(x, sum)| *sum += mass * x);
        }
        sums
    })
}

impl Level {
    /// The parts at a depth of halving, of which each is so many of these.
    fn new(parts: &[[f64; 4]], depth: u32) -> Self {
        let of_each = parts.len() >> depth;
        let sums = map(1 << depth, |part| {
            let own = &parts[part * of_each..][..of_each];
            own.iter().fold([0.0; 4], |sum, one| std::array::from_fn(|k| sum[k] + one[k]))
        });
        let position = |&[mass, x, y, z]: &[f64; 4]| [x / mass, y / mass, z / mass];
        Self { positions: sums.iter().map(position).collect(), targets: sums.iter().map(|sums| sums[0]).collect() }
    }
}

/// Where a part of `n` things at a depth of halving begins and ends.
fn bounds(n: usize, depth: u32, part: usize) -> Range<usize> {
    (n * part) >> depth..(n * (part + 1)) >> depth
}

/// The sites so that each part, down to a depth of halving, is a range: halves along the axis that they are widest in.
pub(super) fn halved(positions: &[[f64; 3]], depth: u32) -> Vec<u32> {
    fn halve(positions: &[[f64; 3]], order: &mut [u32], n: usize, part: usize, depth: u32, most: u32) {
        if depth == most {
            return;
        }
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &i in &*order {
            for k in 0..3 {
                lo[k] = lo[k].min(positions[i as usize][k]);
                hi[k] = hi[k].max(positions[i as usize][k]);
            }
        }
        let axis = (0..3).max_by(|&a, &b| (hi[a] - lo[a]).total_cmp(&(hi[b] - lo[b]))).unwrap_or(0);
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
