//! The linear system of a Newton step.

use super::conjugate_gradient::{self, Found};
use super::limited::Limits;
use super::multigrid::Multigrid;
use super::sparse::Matrix;

/// A mass is not sought closer than to this part of the tolerance.
const ENOUGH: f64 = 0.1;

/// What a step is to come to. Rows are in the order of the sites along a curve.
pub(super) struct Aim {
    /// What the step is to add to each mass.
    pub(super) missing: Vec<f64>,
    pub(super) targets: Vec<f64>,
    pub(super) tolerance: f64,
    /// The part of `missing` that may be left.
    pub(super) relative: f64,
    /// By which part of itself the error falls at the beginning of Newton's step.
    pub(super) slope: f64,
}

/// A solved system.
pub(super) struct System {
    pub(super) multigrid: Multigrid,
    pub(super) limits: Limits,
    pub(super) aim: Aim,
    pub(super) newton: Found,
}

impl Aim {
    /// What solves the system with the matrix of `multigrid`, or comes as near as that does.
    pub(super) fn solve(&self, multigrid: &mut Multigrid) -> Found {
        let enough = ENOUGH * self.tolerance;
        let is_enough = |residual: &[f64]| residual.iter().zip(&self.targets).all(|(r, t)| r.abs() <= enough * t);
        conjugate_gradient::solve(multigrid, self.missing.clone(), self.relative, is_enough)
    }
}

impl System {
    /// What solves it with another matrix, whose entries stand where those of the first do.
    pub(super) fn solve_for(&mut self, matrix: Matrix) -> Found {
        self.multigrid.renew(matrix);
        let found = self.aim.solve(&mut self.multigrid);
        if found.is_solved || !self.multigrid.is_of_another() {
            return found;
        }
        self.multigrid.make_anew();
        self.aim.solve(&mut self.multigrid)
    }
}
