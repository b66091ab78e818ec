//! The linear system of a Newton step.

use super::conjugate_gradient::{self, Found};
use super::multigrid::Multigrid;
use super::sparse::Matrix;

/// A mass is not sought closer than to this part of the tolerance.
const ENOUGH: f64 = 0.1;

/// Its rows in `order`, and what it gives.
pub(super) struct System {
    pub(super) matrix: Matrix,
    /// For each entry the weight by which the row's site may rise above the column's.
    pub(super) limits: Vec<f64>,
    /// What the step is to add to each mass.
    missing: Vec<f64>,
    targets: Vec<f64>,
    tolerance: f64,
    /// The part of `missing` that may be left.
    relative: f64,
    pub(super) newton: Found,
    /// By which part of itself the error falls at the beginning of Newton's step.
    pub(super) slope: f64,
}

impl System {
    /// The system of a matrix, and its solution.
    pub(super) fn solved(
        mut multigrid: Multigrid,
        limits: Vec<f64>,
        missing: Vec<f64>,
        targets: Vec<f64>,
        relative: f64,
        tolerance: f64,
        slope: f64,
    ) -> Self {
        let newton = Found { solution: Vec::new(), iterations: 0 };
        let matrix = Matrix::default();
        let mut system = Self { matrix, limits, missing, targets, tolerance, relative, newton, slope };
        system.newton = system.solve(&mut multigrid);
        system.matrix = multigrid.into_finest();
        system
    }

    /// What solves it with the matrix of `multigrid`.
    pub(super) fn solve(&self, multigrid: &mut Multigrid) -> Found {
        let enough = ENOUGH * self.tolerance;
        let is_enough = |residual: &[f64]| residual.iter().zip(&self.targets).all(|(r, t)| r.abs() <= enough * t);
        conjugate_gradient::solve(multigrid, self.missing.clone(), self.relative, is_enough)
    }
}
