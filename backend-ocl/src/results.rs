//! What comes back from a device, kept from call to call.

use crate::interface::data::{
    ALL_SUMS, FEW_SUMS, MOMENT_SUMS, NOT_COMPUTED, OUTCOME_EXACT, OUTCOME_STATUS, OUTCOME_UNCERTIFIED,
};
use laguerre_core::CellStatus;
use laguerre_core::assemble::{Assembler, FacetRecords, Row};
use laguerre_core::cell::{self, CellSums, v3};
use rayon::prelude::*;

/// How the cells ended, their sums, and where their facets stand: all in the caller's order.
#[derive(Default)]
pub(crate) struct Results {
    pub(crate) outcomes: Vec<u32>,
    /// `width` numbers for each cell.
    pub(crate) sums: Vec<f64>,
    pub(crate) width: usize,
    pub(crate) rows: Vec<[u64; 2]>,
    /// Records of all batches, one after the other, up to `facet_count`.
    pub(crate) facets: FacetRecords,
    pub(crate) facet_count: usize,
}

impl Results {
    /// Hands over all cells, without their facets.
    pub(crate) fn assemble(&self, assembler: &mut Assembler<'_>) {
        assembler.add_all(|i, sums| {
            let status = status_of(self.outcomes[i])?;
            self.put_sums(i, sums);
            Some(status)
        });
    }

    /// The facets of the cell of site `i`; none where this device did not compute it.
    pub(crate) fn facets_of(&self, i: usize) -> Row<'_> {
        match (status_of(self.outcomes[i]), self.rows.get(i)) {
            (Some(CellStatus::Complete | CellStatus::Uncertified), Some(&[begin, count])) => {
                self.facets.row(begin as usize, (begin + count) as usize)
            }
            _ => Row::default(),
        }
    }

    /// Cells that double precision did not suffice for.
    pub(crate) fn exact_cells(&self) -> usize {
        self.outcomes.par_iter().filter(|&&outcome| outcome != NOT_COMPUTED && outcome & OUTCOME_EXACT != 0).count()
    }

    /// Those of its sums that were asked for; others stay what they are.
    fn put_sums(&self, i: usize, sums: &mut CellSums) {
        let numbers = &self.sums[i * self.width..][..self.width];
        let vector = |at: usize| v3(numbers[at], numbers[at + 1], numbers[at + 2]);
        (sums.volume, sums.first) = (numbers[0], vector(1));
        if self.width == FEW_SUMS as usize {
            return;
        }
        (sums.second_diagonal, sums.second_mixed) = (vector(4), vector(7));
        if self.width == MOMENT_SUMS as usize {
            return;
        }
        (sums.boundary_area, sums.boundary_moment) = (numbers[10], vector(11));
        (sums.boundary_vector, sums.boundary_flux) = (vector(14), numbers[17]);
        sums.integral = numbers.get(ALL_SUMS as usize).copied().unwrap_or(0.0);
    }
}

/// How a cell ended; `None` where it was not computed.
fn status_of(outcome: u32) -> Option<CellStatus> {
    if outcome == NOT_COMPUTED {
        return None;
    }
    Some(match outcome & OUTCOME_STATUS {
        cell::EMPTY => CellStatus::Empty,
        _ if outcome & OUTCOME_UNCERTIFIED != 0 => CellStatus::Uncertified,
        _ => CellStatus::Complete,
    })
}
