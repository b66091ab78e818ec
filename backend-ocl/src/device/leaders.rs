//! Cells that begin with what bounds others far off (`kernels/README.md`).

use super::Device;
use super::schedule::Todo;
use crate::builds::{Stage, Way};
use crate::grid::GROUP;
use crate::interface::data::{ALL_TURNS, Counters, MOST_KEPT};
use crate::interface::kernels::ChooseLeaders;
use laguerre_core::cell::FACETS;
use laguerre_core::cell::search_store::WIDTH;
use laguerre_core::{Error, Result};
use std::ops::Range;

/// Cells that are all completed by their vertices, from which on most wait for the first of their block, and the sites that have to bound these far off, on average, for the others
/// to begin with them: of a million sites on a bumpy surface 14, scanned 10; of a Lévy flight 6, on a line 3, in a plane none, all of which take longer so. In tests
/// nearly all do.
const WORTH_SHOWING: usize = if IN_TESTS { 1 << 7 } else { 1 << 19 };
const MANY_FAR: u32 = if IN_TESTS { 1 } else { 8 };
const IN_TESTS: bool = cfg!(feature = "test-util");

impl Device {
    /// Runs the kernel over `turns` of the given cells, or of every `stride`th of them, and reads the counters. Where the device
    /// finds only now that it lacks memory, nothing has run, and its error is given.
    ///
    /// Where all of many cells are completed by their vertices the first of each block of leaves comes first. Where many sites bound these far off the others begin with
    /// them (`kernels/README.md`).
    pub(super) fn run(
        &mut self,
        way: Way,
        cells: &Todo,
        stride: usize,
        turns: Range<usize>,
        interior_only: bool,
    ) -> Result<Option<Error>> {
        let Way::Together(lanes, Stage::Far) = way else {
            return self.launch(way, cells, stride, turns, interior_only, ALL_TURNS);
        };
        let are_many = turns.len() >= WORTH_SHOWING && (IN_TESTS || matches!(cells, Todo::Sorted(_)));
        let params = &self.shared.params;
        // (In a domain not measured. With facets batches, and room for records, would decide which cells do.)
        let may_show = params.equal_weights != 0 && params.flags & FACETS == 0 && self.domain.is_none();
        if !(are_many && may_show && stride == 1 && self.choose_leaders(cells, turns.clone())?) {
            return self.launch(way, cells, stride, turns, interior_only, ALL_TURNS);
        }
        if let Some(late) = self.launch(way, cells, stride, turns.clone(), interior_only, 0)? {
            return Ok(Some(late));
        }
        let Counters { showing, shown, .. } = self.counters;
        (self.counters.showing, self.counters.shown) = (0, 0);
        let show_many = showing > 0 && shown >= MANY_FAR * showing;
        let others = if show_many { Way::Together(lanes, Stage::Sweep) } else { way };
        self.launch(others, cells, stride, turns, interior_only, 1)?.map_or(Ok(None), Err)
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
