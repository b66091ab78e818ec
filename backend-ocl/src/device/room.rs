//! Room on a device: for the results of all cells, for the facets and records of a batch, and for the lists of cells.

use super::{Device, Memory};
use crate::interface::data::{Counters, NOT_COMPUTED, VAST_WORDS};
use laguerre_core::assemble::FacetRecord;
use laguerre_core::cell::FacetSecond;
use laguerre_core::{Request, Result, Watched};

/// Facets of a cell that a batch has room for, on average: a Voronoi cell of random sites has 15.5.
const FACETS_PER_CELL: usize = 18;

/// Facets of a cell at most, of those that are computed on a device (`LANES_P` of `lanes_store.cl`).
const MOST_FACETS: usize = 512;

/// Cells of a batch at most, the share of the device's memory that its facets may take, that which those of all cells may where they stay there (a fourth is
/// what OpenCL gives at a time: of 74 million sites on 80 GB), and the smallest batch that is tried where even that is not to be had.
pub(super) const MOST_CELLS: usize = 1 << 21;
const SHARE_OF_MEMORY: u64 = 8;
const SHARE_OF_KEPT: u64 = 4;
pub(super) const FEWEST_CELLS: usize = 1024;

/// Cells at most that are computed at a time where they are too large for local memory: on a large GPU eight for each of its processors. (With four the 537 of a million scanned
/// sites took 31 instead of 20 ms, one NVIDIA H200.)
const MOST_VAST: u64 = 1024;

/// Room for the record of a cell near the surface, of which half the cells need less, in units of 16 bytes; on average for those of all cells, of which white
/// sites take 42; and for any: 64 vertices and half-spaces, 16 of them caps (`lanes_records.cl`). A cell that has no room is tried again with an empty one.
const MEAN_RECORD: usize = 40;
pub(super) const RECORD_LENGTH: usize = 56;
const LONGEST_RECORD: usize = 1 + 64 + (64 + 64) / 4 + 2 * 16;
/// For any that was swept: 64 vertices and 40 half-spaces (`LANES_P`, `lanes_store.cl`).
pub(super) const LONGEST_SWEPT: usize = 1 + 64 + (64 + 40) / 4;

/// Cells of a batch near the surface that there is room for at a time. Of few cells all may be.
fn near_cells(share: usize) -> usize {
    share.min(MOST_CELLS).min((share.min(MOST_CELLS) / 4).max(1 << 16))
}

impl Device {
    /// Makes room for the results of `sites` sites and for lists of `share` cells; nothing is computed yet.
    pub(super) fn clear(&mut self, request: &Watched<'_>, sites: usize, share: usize) -> Result<()> {
        let Self { context, queue, memory, shared, results, domain, together, .. } = self;
        memory.outcome.fill_with(context, queue, NOT_COMPUTED, sites)?;
        memory.sums.grow(context, sites * shared.params.sums_width as usize)?;
        memory.rows.grow(context, if request.needs_facets() { sites } else { 1 })?;
        let leaves_cut = domain.is_some() && together.is_some() && request.needs_facets();
        memory.cut.grow(context, if leaves_cut { share } else { 1 })?;
        for list in [&mut memory.todo, &mut memory.surface, &mut memory.later, &mut memory.full, &mut memory.left] {
            list.grow(context, share)?;
        }
        if !request.needs_facets() {
            let gives_cells = domain.is_some() && together.is_some();
            let records = if gives_cells { (near_cells(share) * MEAN_RECORD).max(LONGEST_RECORD) } else { 1 };
            memory.given.grow(context, records)?;
            shared.params.given_room = records as u32;
        }
        results.rows.clear();
        results.facet_count = 0;
        self.facets_are_kept = false;
        self.counters = Counters::default();
        memory.counters.fill(context, queue, &[self.counters])
    }

    /// Reads the records of facets back, for which the device then has room again.
    pub(crate) fn read_facets(&mut self, request: &Request) -> Result<()> {
        let Self { queue, memory, results, counters, facets_are_kept, .. } = self;
        // Beyond the room there is nothing; a gap at its end belongs to no row.
        let written = counters.facets.min(self.shared.params.facet_room) as usize;
        memory.facets.read_at(queue, written, &mut results.facets.records, results.facet_count)?;
        if request.facets() {
            memory.facet_moments.read_at(queue, written, &mut results.facets.moments, results.facet_count)?;
        }
        if request.facet_second_moments() {
            memory.facet_seconds.read_at(queue, written, &mut results.facets.seconds, results.facet_count)?;
        }
        results.facet_count += written;
        *facets_are_kept = false;
        counters.facets = 0;
        Ok(())
    }

    /// The same at the end, with where those of each cell stand, if they have stayed on the device.
    pub(crate) fn read_kept_facets(&mut self, request: &Request, sites: usize) -> Result<()> {
        if !self.facets_are_kept {
            return Ok(());
        }
        self.read_facets(request)?;
        self.memory.rows.read(&self.queue, sites, &mut self.results.rows)
    }

    /// Makes room for the records of so many cells that a stage keeps for another, where stages do; of fewer, or none, where memory lacks. (Where it
    /// does not suffice, or a cell has no record, cells are begun anew.)
    pub(super) fn make_room_for_begun(&mut self, cells: usize) -> Result<()> {
        let Self { context, queue, memory, shared, domain, memory_size, .. } = self;
        if shared.params.equal_weights == 0 || domain.is_some() {
            return Ok(());
        }
        let most = ((*memory_size / SHARE_OF_MEMORY) as usize / size_of::<[u32; 4]>()).min(i32::MAX as usize);
        let mut room = (cells.max(FEWEST_CELLS) * RECORD_LENGTH).min(most);
        while room >= LONGEST_RECORD && !memory.begun.grow_if_possible(context, room)? {
            room /= 2;
        }
        let sites = shared.params.tree_sites as usize;
        if room < LONGEST_RECORD || !memory.begun_places.grow_if_possible(context, sites)? {
            self.give_begun_up();
            return Ok(());
        }
        memory.begun_places.fill_with(context, queue, 0, sites)?;
        shared.params.begun_room = room as u32;
        Ok(())
    }

    /// Forgets what cells have been begun, and gives their memory back; whether there was any.
    pub(super) fn give_begun_up(&mut self) -> bool {
        let is_made = self.memory.begun.length() > 1;
        self.shared.params.begun_room = 0;
        self.memory.begun.free();
        is_made
    }

    /// Forgets what cells have been begun where not all had room: which had would decide how the others are cut, and so the last bits of their volumes.
    pub(super) fn forget_begun_in_part(&mut self) {
        if self.counters.begun > self.shared.params.begun_room {
            self.shared.params.begun_room = 0;
        }
    }

    /// Cells that are computed at a time where they are too large for local memory.
    pub(super) const fn vast_cells(&self) -> usize {
        let share = self.memory_size / SHARE_OF_MEMORY / (8 * VAST_WORDS as u64);
        if share < MOST_VAST { share as usize + 1 } else { MOST_VAST as usize }
    }

    /// Cells of a batch, at most `most` or else the fewest, such that the device has room for their facets.
    pub(super) fn room_for_batch(&mut self, request: &Watched<'_>, count: usize, most: usize) -> Result<usize> {
        if !request.needs_facets() {
            self.memory.facets.grow(&self.context, 1)?;
            return Ok(most);
        }
        let (has_moments, has_seconds) = (request.facets(), request.facet_second_moments());
        let moment = if has_moments { size_of::<[f64; 3]>() } else { 0 };
        let second = if has_seconds { size_of::<FacetSecond>() } else { 0 };
        let length = if self.shares_cells() { RECORD_LENGTH } else { 0 };
        let of_facets = FACETS_PER_CELL * (size_of::<FacetRecord>() + moment + second);
        let share = |of: u64, bytes: usize| (self.memory_size / of) as usize / bytes;
        let most_kept = share(SHARE_OF_KEPT, of_facets).min(self.most_cells).min(u32::MAX as usize / FACETS_PER_CELL);
        let mut batch = share(SHARE_OF_MEMORY, of_facets + length * size_of::<[u32; 4]>())
            .min(most)
            .max(FEWEST_CELLS)
            .min(count.max(self.most_cells));
        if self.counters.surface > 0 || (self.facets_are_kept && self.counters.facets > 0) {
            // What stays must not go with the memory that it is in; what has no room in that is told by `full`.
            let fit = (self.shared.params.given_room as usize).checked_div(length).unwrap_or(batch);
            return Ok(batch.min(fit.max(1)));
        }
        // All that are to stay on the device, if it has the memory.
        let mut all = if self.facets_are_kept { most_kept } else { 0 };
        loop {
            let room = (batch.max(all) * FACETS_PER_CELL).max(MOST_FACETS);
            let Memory { facets, facet_moments, facet_seconds, given, .. } = &mut self.memory;
            let (moments, seconds) = (if has_moments { room } else { 1 }, if has_seconds { room } else { 1 });
            let records = if length == 0 { 1 } else { (batch * length).max(LONGEST_RECORD) };
            if batch > FEWEST_CELLS && !given.grow_if_possible(&self.context, records)? {
                batch /= 2;
                continue;
            }
            let is_there = (batch <= FEWEST_CELLS && all <= batch)
                || (facets.grow_if_possible(&self.context, room)?
                    && facet_moments.grow_if_possible(&self.context, moments)?
                    && facet_seconds.grow_if_possible(&self.context, seconds)?);
            if !is_there {
                (batch, all) = if all > batch { (batch, 0) } else { (batch / 2, 0) };
                continue;
            }
            facets.grow(&self.context, room)?;
            facet_moments.grow(&self.context, moments)?;
            facet_seconds.grow(&self.context, seconds)?;
            given.grow(&self.context, records)?;
            (self.shared.params.facet_room, self.shared.params.given_room) = (room as u32, records as u32);
            return Ok(batch);
        }
    }
}
