//! The sites in the order of the curve (`kernels/order.cl`), and the table of voxels.

use super::{GROUP, SITES_PER_VOXEL, SORTED, Sites, scan};
use crate::interface::data::{DIGIT_BITS, DIGITS, Params, Range};
use crate::interface::kernels::{CountDigits, FindVoxels, GatherSites, MarkVoxels, PlaceDigits, RankSites, SettleRuns};
use crate::params::Shared;
use crate::program::GridKernels;
use crate::queue::Queue;
use crate::voxels::Voxels;
use laguerre_core::Result;
use laguerre_core::site_tree::WIDTH;
use opencl3::context::Context;

/// Levels of the curve that divide voxels, of which each has a few sites; levels at most, three bits of a rank each; and how many sites may have
/// one rank, when only the levels are more that are gone through, and when all are.
const FINER: u32 = 2;
const MOST_CURVE_LEVELS: u32 = 21;
const MOST_OF_RUN: u32 = WIDTH as u32;
const MOST_OF_LAST_RUN: u32 = 64;

/// Sites in order, all of which have a cell, whatever they weigh: for the same positions.
#[derive(Clone, Copy)]
pub(super) struct Ordered {
    /// Which they are, in which frame: its shift, its unit, and what is nothing in it.
    positions_id: u64,
    frame: [f64; 5],
    voxels: Voxels,
    has_table: u32,
}

impl Sites {
    /// Puts the sites in order, which are within a range: as they are, where nothing but weights has changed since. Returns how many have a cell; `None` as [`sort`](Self::sort).
    pub(super) fn put_in_order(
        &mut self,
        context: &Context,
        queue: &Queue,
        kernels: &GridKernels,
        range: &Range,
        shared: &mut Shared,
    ) -> Result<Option<u32>> {
        let Params { frame_shift: [x, y, z], frame_unit, frame_smallest, .. } = shared.params;
        let (positions_id, frame) = (self.given.positions_id, [x, y, z, frame_unit, frame_smallest]);
        let is_same = |of: &Ordered| positions_id != 0 && of.positions_id == positions_id && of.frame == frame;
        let (n, count) = (self.given.count, self.given.count as u32);
        if let Some(ordered) = self.ordered.take().filter(is_same) {
            shared.params.sort_into(&ordered.voxels, range, shared.will_differ);
            shared.params.has_table = ordered.has_table;
            self.reserve(context, queue, shared, n, ordered.voxels.count())?;
            self.gather(queue, kernels)?;
            self.ordered = Some(ordered);
            return Ok(Some(count));
        }
        let Some((sites, voxels)) = self.order(context, queue, kernels, range, shared)? else { return Ok(None) };
        let has_table = shared.params.has_table;
        self.ordered = (sites == count).then_some(Ordered { positions_id, frame, voxels, has_table });
        Ok(Some(sites))
    }

    /// Puts the sites in order, which are within a range; returns how many have a cell, and the voxels of the table. `None` as [`sort`](Self::sort).
    fn order(
        &mut self,
        context: &Context,
        queue: &Queue,
        kernels: &GridKernels,
        range: &Range,
        shared: &mut Shared,
    ) -> Result<Option<(u32, Voxels)>> {
        let n = self.given.count;
        let count = n as u32;
        let coarse = Voxels::coarse(range.lo, range.hi, n);
        shared.params.sort_into(&coarse, range, shared.will_differ);
        shared.send(context, queue)?;
        self.marks.grow(context, Voxels::most_coarse(n))?;
        self.marks.fill_with(context, queue, 0, coarse.count())?;
        kernels.mark_voxels.run(
            queue,
            n,
            GROUP,
            MarkVoxels { params: &shared.room, placed: &self.placed, count, marks: &self.marks },
        )?;
        self.marks.read(queue, coarse.count(), &mut self.on_host.marks)?;
        let filled = self.on_host.marks.iter().filter(|&&mark| mark != 0).count();
        let voxels = coarse.over_part(range.lo, range.hi, n, filled, SITES_PER_VOXEL);
        shared.params.sort_into(&voxels, range, shared.will_differ);
        shared.send(context, queue)?;
        self.reserve(context, queue, shared, n, voxels.count())?;

        let across = voxels.dims.iter().fold(1, |most, &dim| most.max(dim)).next_power_of_two().ilog2();
        if across > MOST_CURVE_LEVELS {
            return Ok(None);
        }
        let most_finer = MOST_CURVE_LEVELS - across;
        let mut finer = FINER.min(most_finer);
        loop {
            let most = if finer == most_finer { MOST_OF_LAST_RUN } else { MOST_OF_RUN };
            self.sort_by_curve(context, queue, kernels, shared, n, (across + finer, finer, most))?;
            if self.flag.first(queue)? == 0 {
                break;
            } else if finer == most_finer {
                return Ok(None);
            }
            finer = most_finer;
        }
        scan(context, queue, kernels, &self.kept, n + 1, &mut self.sums)?;
        self.gather(queue, kernels)?;
        let sites = self.kept.number(queue, n)?;
        self.voxels.fill_with(context, queue, [0, 0], voxels.count())?;
        self.flag.fill_with(context, queue, 0, 1)?;
        let arguments = FindVoxels {
            params: &shared.room,
            sites: &self.sites,
            count: sites,
            voxels: &self.voxels,
            crowded: &self.flag,
        };
        kernels.find_voxels.run(queue, sites as usize, GROUP, arguments)?;
        shared.params.has_table = u32::from(self.flag.first(queue)? == 0);
        Ok(Some((sites, voxels)))
    }

    /// Brings the sites that have a cell to where they stand in order.
    fn gather(&self, queue: &Queue, kernels: &GridKernels) -> Result<()> {
        let n = self.given.count;
        let Self { placed, slots: [slots, _], kept: places, sites, order, .. } = self;
        let arguments = GatherSites { placed, slots, places, count: n as u32, sites, order };
        kernels.gather_sites.run(queue, n, GROUP, arguments)
    }

    /// Puts the slots into the order of the curve, as far as so many levels tell, of which `finer` divide voxels, and marks in `kept` those that have a
    /// cell; `flag` becomes 1 where more than `most` have one rank.
    fn sort_by_curve(
        &mut self,
        context: &Context,
        queue: &Queue,
        kernels: &GridKernels,
        shared: &Shared,
        n: usize,
        (levels, finer, most): (u32, u32, u32),
    ) -> Result<()> {
        let count = n as u32;
        let Self {
            placed, turns, ranks: [ranks, new_ranks], slots: [slots, new_slots], digits, kept, flag, sums, ..
        } = self;
        kernels.rank_sites.run(
            queue,
            n,
            GROUP,
            RankSites { params: &shared.room, placed, count, turns, levels, finer, ranks, slots },
        )?;
        let groups = n.div_ceil(SORTED);
        for shift in (0..3 * levels).step_by(DIGIT_BITS as usize) {
            let counts = &*digits;
            kernels.count_digits.run(queue, groups * GROUP, GROUP, CountDigits { ranks, count, shift, counts })?;
            scan(context, queue, kernels, counts, DIGITS as usize * groups, sums)?;
            kernels.place_digits.run(
                queue,
                groups * GROUP,
                GROUP,
                PlaceDigits { ranks, slots, count, shift, starts: counts, new_ranks, new_slots },
            )?;
            std::mem::swap(ranks, new_ranks);
            std::mem::swap(slots, new_slots);
        }
        kept.fill_with(context, queue, 0, n + 1)?;
        flag.fill_with(context, queue, 0, 1)?;
        let is_long = &*flag;
        kernels.settle_runs.run(queue, n, GROUP, SettleRuns { placed, ranks, count, most, slots, kept, is_long })
    }
}
