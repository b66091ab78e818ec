//! What is tried with a sample of the cells before all are computed: how much room they need, and by which way they are found.

use super::cells::Todo;
use super::{Device, IN_TESTS};
use crate::builds::{Lanes, Stage, Way};
use crate::interface::data::Counters;
use crate::octree::OfSites;
use crate::program::MOST_PLANES;
use laguerre_core::cell::{FACET_SECOND_MOMENTS, INTEGRAL};
use laguerre_core::passes::{Capacities, Cells as _};
use laguerre_core::{ErrorKind, Request, Result, Watched};
use std::ops::Range;
use std::time::Instant;

/// Sites from which on a sample is worth its time, its size, and how many of it may fail: a pass costs about as much as what it
/// saves the next where one cell in twenty fails (paper §6.1: capacities at 95 %).
const WORTH_A_SAMPLE: usize = 1 << 16;
const SAMPLE: usize = 1024;
pub(super) const MAY_FAIL: f64 = 0.05;

/// Cells of the sample of those that are computed together: as many as a large GPU computes at two times, 0.3 ms.
const SAMPLE_TOGETHER: usize = 4096;

/// The share of a device's memory that what an octree is made with may keep, and records of cells that were begun.
pub(super) const SHARE_OF_SCRATCH: u64 = 32;

/// How many of the sample have to reach beyond what the first stage searches, or to need more room, for the tree alone to be searched, or where weights differ, and no more than half do, for a sample of the tree; and to fail,
/// where it is, for all cells to begin in the stage of those that reach far; or to have open signs, where weights differ, for those that settle them by the table.
const WORTH_A_TREE: u32 = SAMPLE_TOGETHER as u32 / 8;
const MOST_OF_SAMPLE: u32 = SAMPLE_TOGETHER as u32 / 2;
/// The same to fail where weights are equal, as what the first stage has begun is gone on with. (A Lévy flight of which 56 % fail, where less counts as near, takes 0.062 s so, and 0.233
/// in the other way, one NVIDIA H200.)
const NEARLY_ALL_OF_SAMPLE: u32 = 7 * (SAMPLE_TOGETHER as u32 / 8);
/// Cells that the table of offsets does not complete, most of which reach beyond it, from which on they are searched by the tree at once, and not by the table with exact signs
/// before. (8,000 of 100,000 Soneira-Peebles sites take 4.2 ms in all that comes, and took 8.5; of 50,000 scanned ones, of which most reach beyond, 14 and 36. One NVIDIA H200.)
pub(super) const WORTH_LEAVING: u32 = if IN_TESTS { 1 << 5 } else { 1 << 10 };

/// How many have to reach beyond what the first stage searches, or to need more room, where weights differ, for an octree to tell where cells are. (With weights of
/// transport from crowded sites 1,500 to all of a sample do; of white sites 200 to 380, of other weights 2 to 250. Of a million of an NFW profile 1,900 do: 0.53 s
/// without, 0.15 with; one NVIDIA H100. Signs that are open alone do not tell: a fluid's particles that were a lattice have them, and the octree is half of its time.)
const WORTH_AN_OCTREE: u32 = SAMPLE_TOGETHER as u32 / 8;

/// Of cells that begin where they are completed by their vertices, the share that is given up by one stage and kept for another, at most (of a million scanned sites 110,000).
const SHARE_GIVEN_UP: usize = 4;

/// Leaves that are looked at for a cell that reaches far in a domain, where most cells of a sample end without. (Without one sites from all over tell more: before these were asked,
/// a Lévy flight took 0.175 s with 40 leaves, 0.162 with 100, 0.155 with 200, no less with 400.) And where weights differ, when what their bounds say is nearer may be farther than sites that cut: 0.065 to 0.057 s
/// where they are a sinusoid. One NVIDIA H200.
const LEAVES_IF_FAR: u32 = 200;
const LEAVES_IF_WEIGHTED: u32 = 400;

impl Device {
    /// Room such that few cells fail: what sufficed in the last call, or what a sample of the cells needs.
    pub(super) fn first_capacities(&mut self, share: Range<usize>) -> Result<Capacities> {
        if let Some((count, room)) = self.first
            && share.len() / 2 <= count
            && count / 2 <= share.len()
        {
            return Ok(room);
        }
        let mut room = Capacities::FIRST;
        if share.len() < WORTH_A_SAMPLE {
            return Ok(room);
        }
        let all = Todo::Sorted(share);
        loop {
            let failures = self.sample_of(Way::Alone(room), &all, SAMPLE)?.later;
            if f64::from(failures) <= MAY_FAIL * SAMPLE as f64 || room.grown().planes > MOST_PLANES {
                return Ok(room);
            }
            room = room.grown();
        }
    }

    /// The work-items that compute a cell together, if they do: together no proof is cut short, and what few ask for is not computed.
    pub(super) fn lanes(&self, request: &Request) -> Option<Lanes> {
        let whole = request.epsilon().is_none() && self.shared.params.flags & (FACET_SECOND_MOMENTS | INTEGRAL) == 0;
        self.together.filter(|_| whole)
    }

    /// Gives up the table of offsets where enough of the `share` of cells need more than the voxels near their sites, as those of sites on a surface
    /// do, or cells of steep or rough weights. (Not asked of a domain, unless weights differ.)
    ///
    /// Signs that are open in single precision alone do not tell: all cells of a lattice have them, as have those of sites on a line. These are
    /// not completed with exact signs, either. (Where weights differ both are `Close`'s or `Far`'s.)
    ///
    /// The stage in which cells begin that go through the table; and whether weights differ and it completes at least half of the sample: so that the caller may take it though it is given up here, where the
    /// tree finds most of what it leaves.
    pub(super) fn choose_table(&mut self, lanes: Lanes, share: Range<usize>) -> Result<(Stage, bool)> {
        let has_weights = self.shared.params.equal_weights == 0;
        if self.shared.params.has_table == 0 || (self.domain.is_some() && !has_weights) || share.len() < WORTH_A_SAMPLE
        {
            return Ok((Stage::First, false));
        }
        let all = Todo::Sorted(share);
        let first = self.sample_of(Way::Together(lanes, Stage::First), &all, SAMPLE_TOGETHER)?;
        if has_weights && first.later - first.beyond > MOST_OF_SAMPLE {
            let close = self.sample_of(Way::Together(lanes, Stage::Close), &all, SAMPLE_TOGETHER)?;
            self.shared.params.has_table = u32::from(close.left + close.later <= WORTH_A_TREE);
            return Ok((Stage::Close, false));
        }
        let mut beyond = first.left + if has_weights { first.later } else { first.beyond };
        if !has_weights && beyond <= WORTH_A_TREE && first.later > WORTH_A_TREE {
            std::mem::swap(&mut self.memory.todo, &mut self.memory.later);
            let open = Todo::Listed(first.later as usize);
            beyond += self.sample_of(Way::Together(lanes, Stage::Exact), &open, SAMPLE_TOGETHER)?.left;
        }
        self.shared.params.has_table = u32::from(beyond <= WORTH_A_TREE);
        Ok((Stage::First, has_weights && beyond <= MOST_OF_SAMPLE))
    }

    /// Gives up the table of offsets for all that is still to come, so many cells, where weights are equal and there is no domain; says whether there was one.
    pub(super) fn leave_table(&mut self, cells: usize) -> Result<bool> {
        let params = &mut self.shared.params;
        let leaves = params.has_table != 0 && params.equal_weights != 0 && self.domain.is_none();
        if leaves {
            params.has_table = 0;
            self.make_room_for_begun(cells / SHARE_GIVEN_UP)?;
        }
        Ok(leaves)
    }

    /// Of the cells of a range, where they are many, whether most are not completed by the first stage, or where weights are equal nearly all; and whether so many reach far, where weights differ,
    /// that an octree is worth its time. Makes room for the records of what is then begun and not completed.
    pub(super) fn failures(&mut self, lanes: Lanes, share: Range<usize>) -> Result<(bool, bool)> {
        let cells = share.len();
        if cells < WORTH_A_SAMPLE {
            self.make_room_for_begun(cells + cells / 4)?;
            return Ok((false, false));
        }
        let first = self.sample_of(Way::Together(lanes, Stage::First), &Todo::Sorted(share), SAMPLE_TOGETHER)?;
        let has_weights = self.shared.params.equal_weights == 0;
        let most_fail = first.later + first.left > if has_weights { MOST_OF_SAMPLE } else { NEARLY_ALL_OF_SAMPLE };
        let fail = (first.later + first.left) as usize * cells / SAMPLE_TOGETHER;
        self.make_room_for_begun(if most_fail { cells / SHARE_GIVEN_UP } else { fail + fail / 4 })?;
        Ok((most_fail, has_weights && first.beyond + first.left > WORTH_AN_OCTREE))
    }

    /// Leaves that are looked at for a cell that reaches far, of so many cells of which most fail or do not. (As whether there is a table, and what is swept, this is decided by a
    /// device's share of the cells: where several decide otherwise, last bits of cells may be others.)
    pub(super) fn leaves_if_far(&self, cells: usize, most_fail: bool) -> u32 {
        match self.shared.params.equal_weights {
            _ if most_fail => 0,
            0 => LEAVES_IF_WEIGHTED,
            _ if cells < WORTH_A_SAMPLE || self.domain.is_none() => 0,
            _ => LEAVES_IF_FAR,
        }
    }

    /// Makes an octree over the container, for this evaluation, if that is not too large.
    pub(super) fn make_octree(&mut self, request: &Watched<'_>) -> Result<()> {
        let begin = Instant::now();
        let Self { context, queue, grid_kernels: grid, octree_kernels, octree, shared, sites, memory_size, .. } = self;
        let kernels = octree_kernels.get()?;
        let of = OfSites { context, queue, grid, kernels, shared, sites: &sites.sites };
        let made = octree.make(of, &mut sites.sums, &|| request.advance(0));
        let off = match made {
            // (It is for want of memory, or what comes will say it again.)
            Err(error) if error.kind() != ErrorKind::Device => return Err(error),
            made => made.unwrap_or(0.0),
        };
        match off > 0.0 {
            true => octree.free_scratch(*memory_size / SHARE_OF_SCRATCH),
            false => octree.free(),
        }
        shared.params.octree_off = off;
        self.seconds += begin.elapsed().as_secs_f64();
        Ok(())
    }

    /// Tries a way with so many of the cells, or all if they are fewer; how they ended.
    fn sample_of(&mut self, way: Way, cells: &Todo, most: usize) -> Result<Counters> {
        // Without facets, which have no room yet, nor the records of finished cells.
        self.shared.params.facet_room = 0;
        self.shared.params.leaves_if_far = 0;
        let some = cells.count().min(most);
        if let Some(late) = self.run(way, cells, cells.count() / some, 0..some, false)? {
            return Err(late);
        }
        let ended = self.counters;
        self.counters = Counters::default();
        self.memory.counters.fill(&self.context, &self.queue, &[self.counters])?;
        Ok(ended)
    }
}
