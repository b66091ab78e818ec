//! Cells that end with one look at all that can still cut them, of which some begin with what bounds others far off (`kernels/README.md`).

use super::cells::Todo;
use super::room::LONGEST_SWEPT;
use super::{Device, IN_TESTS};
use crate::builds::{Lanes, Stage, Way};
use crate::grid::GROUP;
use crate::interface::data::{ALL_TURNS, MOST_KEPT};
use crate::interface::kernels::ChooseLeaders;
use laguerre_core::cell::FACETS;
use laguerre_core::cell::search_store::WIDTH;
use laguerre_core::passes::Cells as _;
use laguerre_core::{Error, Result};
use std::ops::Range;

/// Cells that are completed by their vertices, as most of a call are, from which on all but the first of their block begin with what bounds that far off. (Of 20,000 sites on a bumpy
/// surface that takes 3.5 ms, of 100,000 23 instead of 44, scanned 28 and 41, on a line 14 and 21, in a plane 8.0 and 9.2, on a jittered sphere 61 and 60; of 200,000 41 and 88, 80 and
/// 98, 31 and 51, 13 and 17, 89 and 102. One NVIDIA H200.)
const WORTH_SHOWING: usize = if IN_TESTS { 1 << 7 } else { 1 << 14 };
/// Cells that the first stage did not complete from which on they are swept. (45,000 of a Lévy flight took 7 instead of 9.5 ms, and 22,000 took 7.5 instead of 5.5, before what was begun was
/// gone on with.)
const WORTH_SWEEPING: usize = if IN_TESTS { 1 << 6 } else { 1 << 15 };
/// Cells that are swept at a time, at first, and the share of the device's memory that their records may take. (Half as many: a million sites of a Lévy flight 65.5 instead of 64.2 ms, on a
/// bumpy surface 155 instead of 153; one NVIDIA H200.)
const SWEPT_AT_ONCE: usize = if IN_TESTS { 1 << 9 } else { 1 << 19 };
const SHARE_OF_SWEPT: u64 = 32;
/// Fewer are not tried where memory lacks: they would not fill a large GPU.
const FEWEST_SWEPT: usize = if IN_TESTS { 1 << 5 } else { 1 << 14 };

/// Cells that are swept at a time, at first, where the device has so much memory.
pub(super) fn swept_at_first(memory: u64) -> usize {
    let fit = (memory / SHARE_OF_SWEPT) as usize / (LONGEST_SWEPT * size_of::<[u32; 4]>());
    fit.clamp(FEWEST_SWEPT, SWEPT_AT_ONCE)
}

impl Device {
    /// Runs the kernel over `turns` of the given cells, or of every `stride`th of them, and reads the counters. Where the device
    /// finds only now that it lacks memory, nothing has run, and its error is given.
    ///
    /// Where most of many cells are completed by their vertices the first of each block of leaves comes first, and the others begin with the sites that bound it far off
    /// (`kernels/README.md`).
    pub(super) fn run(
        &mut self,
        way: Way,
        cells: &Todo,
        stride: usize,
        turns: Range<usize>,
        interior_only: bool,
    ) -> Result<Option<Error>> {
        let lanes = match way {
            Way::Together(lanes, Stage::Sweep) => {
                debug_assert!(stride == 1 && !interior_only, "swept cells are not sampled, and have no domain");
                return self.run_swept(lanes, cells, turns, ALL_TURNS).map(|()| None);
            }
            Way::Together(lanes, Stage::Far) => lanes,
            _ => return self.launch(way, cells, stride, turns, interior_only, ALL_TURNS),
        };
        let are_many =
            turns.len() >= WORTH_SHOWING && (IN_TESTS || 2 * cells.count() > self.most_cells) && !self.was_swept;
        if !(are_many && self.may_sweep() && stride == 1 && self.choose_leaders(cells, turns.clone())?) {
            return self.launch(way, cells, stride, turns, interior_only, ALL_TURNS);
        }
        if let Some(late) = self.launch(way, cells, stride, turns.clone(), interior_only, 0)? {
            return Ok(Some(late));
        }
        self.run_swept(lanes, cells, turns, 1).map(|()| None)
    }

    /// Sweeps cells, so many at a time that there is room for the record of each, and then has their integrals.
    fn run_swept(&mut self, lanes: Lanes, cells: &Todo, turns: Range<usize>, turn_of: u32) -> Result<()> {
        debug_assert!(self.counters.surface == 0, "swept cells have the room of records for themselves");
        let mut begin = turns.start;
        while begin < turns.end {
            let count = self.swept_at_once.min(turns.end - begin);
            let room = count * LONGEST_SWEPT;
            let may_halve = self.swept_at_once > FEWEST_SWEPT;
            if !self.memory.given.grow_if_possible(&self.context, room)? {
                if may_halve {
                    self.swept_at_once /= 2;
                    continue;
                }
                self.give_begun_up();
            }
            self.memory.given.grow(&self.context, room)?;
            self.shared.params.given_room = room as u32;
            self.counters.given = 0;
            let swept = Way::Together(lanes, Stage::Sweep);
            if let Some(late) = self.launch(swept, cells, 1, begin..begin + count, false, turn_of)? {
                if may_halve {
                    self.swept_at_once /= 2;
                } else if !self.give_begun_up() {
                    return Err(late);
                }
                self.memory.given.free();
                continue;
            }
            begin += count;
            let given = self.counters.surface as usize;
            if given > 0 {
                self.at_once(lanes, Stage::Integrals, given)?;
            }
        }
        Ok(())
    }

    /// Whether cells may be completed by one look at all that can cut them. (In a domain not measured. With facets batches, and room for records, would decide which
    /// cells are.)
    pub(super) fn may_sweep(&self) -> bool {
        let params = &self.shared.params;
        params.equal_weights != 0 && params.flags & FACETS == 0 && self.domain.is_none()
    }

    /// The stage of so many cells that the first stage did not complete, by the tree.
    pub(super) fn stage_of_far(&self, cells: usize) -> Stage {
        if self.may_sweep() && cells >= WORTH_SWEEPING { Stage::Sweep } else { Stage::Far }
    }

    /// Finds the first of some cells in each block of leaves of the tree, where there is room for what bounds them; says whether.
    fn choose_leaders(&mut self, cells: &Todo, turns: Range<usize>) -> Result<bool> {
        let Self { context, queue, memory, grid_kernels, shared, .. } = self;
        let blocks = (shared.params.tree_sites as usize).div_ceil((WIDTH * WIDTH) as usize);
        let room = blocks * MOST_KEPT as usize;
        if !memory.leaders.grow_if_possible(context, blocks)? || !memory.kept.grow_if_possible(context, room)? {
            return Ok(false);
        }
        memory.leaders.fill_with(context, queue, u32::MAX, blocks)?;
        memory.kept.fill_with(context, queue, 0, room)?;
        let (has_list, start) = cells.place();
        let (list, leaders) = (&memory.todo, &memory.leaders);
        let (first, count) = ((start + turns.start) as u32, turns.len() as u32);
        let arguments = ChooseLeaders { list, has_list, first, count, leaders };
        grid_kernels.choose_leaders.run(queue, turns.len(), GROUP, arguments).map(|()| true)
    }
}
