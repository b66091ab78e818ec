//! Cells that a stage has found and gives to another as records, which has their integrals: `Surface`, or where facets are asked for `Integrals`.

use super::cells::Todo;
use super::room::RECORD_LENGTH;
use super::{Device, IN_TESTS};
use crate::builds::{Lanes, Stage, Way};
use crate::interface::data::Counters;
use laguerre_core::output::Substep;
use laguerre_core::{Result, Watched};

/// Cells that reach far outside the domain, as most of those that the table of offsets has not completed do, from which on they are `Far`'s, whose text is shorter than `Exact`'s, and what
/// is finished another stage's: of a million white sites inside the bunny 24,000, 10 instead of 18 ms, of blue ones 46,000, 9 instead of 19; of 100,000 blue ones 9,900, no gain, but with facets 12.1
/// instead of 16.8 ms for the diagram. Of fewer it gains less than the 0.03 s that a process loses, which has another build to load. (One NVIDIA H200.)
const WORTH_GIVING: usize = if IN_TESTS { 1 << 5 } else { 1 << 13 };

impl Counters {
    /// Whether most of those for later reach far.
    pub(super) fn most_reach_far(&self) -> bool {
        2 * self.beyond > self.later
    }
}

impl Device {
    /// Whether what a stage has left is for one that gives its finished cells, too, and there is room for these: all are then finished together. (A launch over few takes as long as its
    /// slowest cell. What `Surface` leaves open goes to `Exact` then, and not to `Far` before.)
    pub(super) fn goes_on_giving(&self, way: Way) -> bool {
        let Counters { full, later, given, .. } = self.counters;
        let is_first = matches!(way, Way::Together(_, Stage::Single | Stage::First));
        let cells = later as usize;
        let has_room = given as usize + cells * RECORD_LENGTH <= self.shared.params.given_room as usize;
        let is_given = self.is_tree() || self.is_worth_giving(cells, self.counters.most_reach_far());
        is_first && full == 0 && later > 0 && has_room && is_given
    }

    /// Whether so many cells, of which most reach far or do not, are `Far`'s.
    pub(super) fn is_worth_giving(&self, cells: usize, most_reach_far: bool) -> bool {
        most_reach_far && self.domain.is_some() && cells >= WORTH_GIVING
    }

    /// Cells in the lists of what has not ended. (What one work-item leaves is the host's, which tells of it.)
    pub(super) fn unended(&self) -> usize {
        let Counters { surface, later, full, left, .. } = self.counters;
        (surface + later + full + left) as usize
    }

    /// Brings facets to the host where not all stay on the device.
    pub(super) fn make_room_for_facets(&mut self, request: &Watched<'_>) -> Result<()> {
        let fit = self.counters.facets <= self.shared.params.facet_room;
        if request.needs_facets() && !(self.facets_are_kept && fit) {
            self.read_facets(request)?;
        }
        Ok(())
    }

    /// Finishes the cells whose records stages have given.
    pub(super) fn finish(&mut self, request: &Watched<'_>, way: Way, second: &mut Substep) -> Result<()> {
        let given = self.counters.surface as usize;
        if let (Way::Together(lanes, _), 1..) = (way, given) {
            let before = self.unended();
            let (cut, seconds) = match request.needs_facets() {
                true => self.finish_with_facets(request, lanes, given)?,
                false => (given, self.at_once(lanes, Stage::Surface, given)?),
            };
            second.cells += cut;
            second.seconds += seconds;
            request.advance(before.saturating_sub(self.unended()))?;
        }
        self.counters.given = 0;
        Ok(())
    }

    /// The same where all cells have been given. Those whose facets had no room are done again, when the others' are with the host. How many the surface cuts, and the seconds that these took.
    fn finish_with_facets(&mut self, request: &Watched<'_>, lanes: Lanes, given: usize) -> Result<(usize, f64)> {
        // (What is full there are records, and no sites.)
        let full = std::mem::take(&mut self.counters.full);
        if full > 0 {
            self.memory.aside.grow(&self.context, self.most_cells)?;
            std::mem::swap(&mut self.memory.full, &mut self.memory.aside);
        }
        let (mut all, mut left) = (Ok((0, 0.0)), given);
        while let (Ok((cut, seconds)), 1..) = (&all, left) {
            self.shared.params.facet_base = self.results.facet_count as u64;
            let summed = self.sum_facets(lanes, left).and_then(|cut| self.make_room_for_facets(request).map(|()| cut));
            all = summed.map(|(more_cut, more_seconds)| (cut + more_cut, seconds + more_seconds));
            left = std::mem::take(&mut self.counters.full) as usize;
            std::mem::swap(&mut self.memory.full, &mut self.memory.surface);
        }
        if full > 0 {
            std::mem::swap(&mut self.memory.full, &mut self.memory.aside);
        }
        self.counters.full = full;
        all
    }

    /// Sums up the cells whose records stand in the list `surface`, and their facets (`Stage::Integrals`); those that the surface cuts in the stage for them, while
    /// their records are there. How many these are, and the seconds that they took.
    fn sum_facets(&mut self, lanes: Lanes, given: usize) -> Result<(usize, f64)> {
        if self.domain.is_none() {
            return self.at_once(lanes, Stage::Integrals, given).map(|_| (0, 0.0));
        }
        // (What is left there are records, and no sites.)
        let kept = std::mem::take(&mut self.counters.left);
        std::mem::swap(&mut self.memory.left, &mut self.memory.cut);
        let summed = self.at_once(lanes, Stage::Integrals, given);
        std::mem::swap(&mut self.memory.left, &mut self.memory.cut);
        let cut = std::mem::replace(&mut self.counters.left, kept) as usize;
        summed?;
        if cut == 0 {
            return Ok((0, 0.0));
        }
        std::mem::swap(&mut self.memory.cut, &mut self.memory.surface);
        Ok((cut, self.at_once(lanes, Stage::Surface, cut)?))
    }

    /// Runs a stage over the cells of a batch, or their records, that stand in the list `surface`; returns the seconds it took.
    pub(super) fn at_once(&mut self, lanes: Lanes, stage: Stage, count: usize) -> Result<f64> {
        let begin = self.seconds;
        // (The list of all cells is for later batches.)
        std::mem::swap(&mut self.memory.todo, &mut self.memory.surface);
        self.counters.surface = 0;
        let ran = self.run(Way::Together(lanes, stage), &Todo::Listed(count), 1, 0..count, false);
        std::mem::swap(&mut self.memory.todo, &mut self.memory.surface);
        ran?.map_or(Ok(self.seconds - begin), Err)
    }
}
