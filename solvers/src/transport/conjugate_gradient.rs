//! The conjugate gradient for the singular systems of transport, preconditioned.

use super::multigrid::Multigrid;
use super::sparse::{center, dot, norm};
use crate::vectors::for_each;

/// Iterations after which the solution is taken as it is; some 10 to 30 are usual.
const MOST_ITERATIONS: usize = 300;
/// The same of a multigrid that was made for another matrix: to make one costs as much as some 15.
const MOST_WHILE_IT_SERVES: usize = 25;

/// What was found.
pub(super) struct Found {
    pub(super) solution: Vec<f64>,
    pub(super) iterations: usize,
    /// Whether there is nothing left to do; else the iterations did not suffice.
    pub(super) is_solved: bool,
}

/// Solves `A x = b` with the finest matrix of `multigrid`, whose kernel is the constants: `b` is taken less its mean, and so is `x`.
/// Ends when `‖b − A x‖ ≤ relative·‖b‖`, or `is_enough` says so of the residual.
pub(super) fn solve(
    multigrid: &mut Multigrid,
    mut b: Vec<f64>,
    relative: f64,
    is_enough: impl Fn(&[f64]) -> bool,
) -> Found {
    let n = b.len();
    center(&mut b);
    let target = relative * norm(&b);
    let mut residual = b;
    let mut solution = vec![0.0; n];
    let mut direction = vec![0.0; n];
    let mut image = vec![0.0; n];
    let mut better = vec![0.0; n];
    let mut slope = 0.0;
    let most = if multigrid.is_of_another() { MOST_WHILE_IT_SERVES } else { MOST_ITERATIONS };
    let mut iterations = 0;
    let is_solved = loop {
        if norm(&residual) <= target || is_enough(&residual) {
            break true;
        }
        if iterations == most {
            break false;
        }
        multigrid.apply(&residual, &mut better);
        let new_slope = dot(&residual, &better);
        let beta = if iterations == 0 { 0.0 } else { new_slope / slope };
        slope = new_slope;
        for_each(&mut direction, |i, d| *d = better[i] + beta * *d);
        multigrid.finest().apply(&direction, &mut image, |_, ad, _| ad);
        let curvature = dot(&direction, &image);
        // Nothing but rounding is left where this is not positive.
        if !(curvature > 0.0 && slope > 0.0) {
            break !multigrid.is_of_another();
        }
        let alpha = slope / curvature;
        for_each(&mut solution, |i, x| *x += alpha * direction[i]);
        for_each(&mut residual, |i, r| *r -= alpha * image[i]);
        // Rounding must not let the residual drift out of the range of `A`.
        center(&mut residual);
        iterations += 1;
    };
    center(&mut solution);
    Found { solution, iterations, is_solved }
}
