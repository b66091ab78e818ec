//! The linear system of a Newton step.

use laguerre_core::Result;
use laguerre_core::algebra::Held;

use super::conjugate_gradient::{self, Found};
use super::limited::Limits;
use super::multigrid::Multigrid;

/// A mass is not sought closer than to this part of the tolerance.
const ENOUGH: f64 = 0.1;

/// What a step is to come to. Rows are in the order of the sites along a curve.
pub(super) struct Aim {
    /// What the step is to add to each mass.
    pub(super) missing: Vec<f64>,
    pub(super) tolerance: f64,
    /// The part of `missing` that may be left.
    pub(super) relative: f64,
    /// By which part of itself the error falls at the beginning of Newton's step.
    pub(super) slope: f64,
}

/// A solved system.
pub(super) struct System<'a> {
    pub(super) multigrid: Multigrid<'a>,
    pub(super) limits: Limits,
    pub(super) aim: Aim,
    pub(super) newton: Found,
}

impl Aim {
    /// The multigrid, with coarse levels of its matrix's own where others do not serve, and what solves the system with that matrix, or comes as near as that does.
    pub(super) fn solved<'a>(&self, mut multigrid: Multigrid<'a>) -> Result<(Multigrid<'a>, Found)> {
        let found = conjugate_gradient::solve(&mut multigrid, &self.missing, self.relative, ENOUGH * self.tolerance)?;
        Ok((multigrid, found))
    }
}

impl<'a> System<'a> {
    /// The same with what solves it with another matrix, whose entries stand where those of the first do.
    pub(super) fn solved_for(self, matrix: Held) -> Result<Self> {
        let Self { multigrid, limits, aim, .. } = self;
        let (mut multigrid, mut newton) = aim.solved(multigrid.renewed(matrix)?)?;
        if !newton.is_solved && multigrid.is_of_another() {
            (multigrid, newton) = aim.solved(multigrid.made_anew()?)?;
        }
        Ok(Self { multigrid, limits, aim, newton })
    }
}
