//! The conjugate gradient for the singular systems of transport, preconditioned.

use laguerre_core::Result;
use laguerre_core::algebra::Held;

use super::multigrid::{Enough, Multigrid};

/// Iterations after which the solution is taken as it is; some 10 to 30 are usual.
const MOST_ITERATIONS: usize = 300;
/// The same of a multigrid that was made for another matrix: to make one costs as much as some 15.
const MOST_WHILE_IT_SERVES: usize = 25;

/// Room for the roundings of a norm.
const ROOM: f64 = 1.0 + 1e-6;

/// What was found.
pub(super) struct Found {
    pub(super) solution: Vec<f64>,
    /// The same where the matrix is.
    pub(super) held: Held,
    pub(super) iterations: usize,
    /// Whether there is nothing left to do; else the iterations did not suffice.
    pub(super) is_solved: bool,
}

/// Solves `A x = b` with the finest matrix of `multigrid`, whose kernel is the constants: `b` is taken less its mean, and so is `x`.
/// Ends when `‖b − A x‖ ≤ relative·‖b‖`, or no number of the residual is more than `factor` times its bound, where the multigrid has these.
pub(super) fn solve(multigrid: &mut Multigrid<'_>, b: &[f64], relative: f64, factor: f64) -> Result<Found> {
    let algebra = multigrid.algebra();
    let mut residual = algebra.vector(b)?;
    let mut norm = algebra.center(&mut residual)?.sqrt();
    let zeros = || algebra.zeros(b.len());
    let (mut solution, mut direction, mut image) = (zeros()?, zeros()?, zeros()?);
    let target = relative * norm;
    let mut slope = 0.0;
    let most = if multigrid.is_of_another() { MOST_WHILE_IT_SERVES } else { MOST_ITERATIONS };
    let mut iterations = 0;
    let is_solved = loop {
        // (Each number is within its bound only where the norm is within that of all bounds, which costs no question.)
        let is_enough = || match multigrid.enough() {
            Some(Enough { bounds, norm: all, .. }) if norm <= all * factor * ROOM => {
                algebra.is_within(&residual, factor, bounds)
            }
            _ => Ok(false),
        };
        if norm <= target || is_enough()? {
            break true;
        }
        if iterations == most {
            break false;
        }
        let better = multigrid.apply(&residual)?;
        let new_slope = algebra.dot(&residual, better)?;
        let beta = if iterations == 0 { 0.0 } else { new_slope / slope };
        slope = new_slope;
        algebra.combine(1.0, better, beta, &mut direction)?;
        algebra.multiply(multigrid.finest(), &direction, &mut image)?;
        let curvature = algebra.dot(&direction, &image)?;
        // Nothing but rounding is left where this is not positive.
        if !(curvature > 0.0 && slope > 0.0) {
            break !multigrid.is_of_another();
        }
        let alpha = slope / curvature;
        algebra.combine(alpha, &direction, 1.0, &mut solution)?;
        algebra.combine(-alpha, &image, 1.0, &mut residual)?;
        // Rounding must not let the residual drift out of the range of `A`.
        norm = algebra.center(&mut residual)?.sqrt();
        iterations += 1;
    };
    algebra.center(&mut solution)?;
    Ok(Found { solution: algebra.read(&solution)?, held: solution, iterations, is_solved })
}
