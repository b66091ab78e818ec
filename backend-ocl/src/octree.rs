//! The octree over the container (`core/src/power_octree.rs`), made on the device.

use crate::buffer::{Room, failed, rooms};
use crate::device::IN_TESTS;
use crate::grid::scan_all;
use crate::interface::data::{NO_BOX, NO_HOME, OCTREE_GROUP, Params};
use crate::interface::kernels::{FindHomes, FindLeasts, JudgeParts, MarkSlices, PlaceLeaves, SplitBoxes, Splitting};
use crate::params::Shared;
use crate::program::{GridKernels, OctreeKernels};
use crate::queue::Queue;
use laguerre_core::Result;
use laguerre_core::cell::octree::{MOST_DEPTH, OCTREE_PLACES};
use laguerre_core::cell::search_store::MOST_LEAVES;
use laguerre_core::power_octree::{OctreeBox, are_too_many, margin_of, most_listed, off_of};
use laguerre_core::site_tree::WIDTH;
use opencl3::context::Context;
use std::mem;

const GROUP: usize = OCTREE_GROUP as usize;

/// Leaves that boxes list, on average, above which several groups go over those of a part, and how many each then does: there are few such boxes. (With one group for each part, of 256 work-items, the first
/// four of seven levels over a million sites took 12.6 of 27 ms, one NVIDIA H200.)
const MANY_LEAVES: usize = if IN_TESTS { 16 } else { 1024 };
const OF_SLICE: usize = MANY_LEAVES / 2;

rooms! {
    pub(crate) struct OctreeMemory {
        pub(crate) nodes: [u32; 2] = "the octree over the container",
        pub(crate) listed: u32 = "the octree over the container",
        pub(crate) homes: u32 = "the octree over the container",
        pub(crate) middles: [f64; 4] = "the octree over the container",
        ways: u32 = "the octree over the container",
        /// The boxes that are split, and those that are split next.
        boxes: OctreeBox = "boxes of the octree over the container",
        next_boxes: OctreeBox = "boxes of the octree over the container",
        /// The leaves of the boxes that are split, and of those that are split next.
        whole: u32 = "boxes of the octree over the container",
        next: u32 = "boxes of the octree over the container",
        kept: u8 = "boxes of the octree over the container",
        counts: u32 = "boxes of the octree over the container",
        firsts: u32 = "boxes of the octree over the container",
        leasts: u32 = "boxes of the octree over the container",
        splits: u32 = "boxes of the octree over the container",
        wholes: u32 = "boxes of the octree over the container",
        lists: u32 = "boxes of the octree over the container",
        unlisted: u32 = "boxes of the octree over the container",
    }
}

/// A device, and the sorted sites on it.
#[derive(Clone, Copy)]
pub(crate) struct OfSites<'a> {
    pub(crate) context: &'a Context,
    pub(crate) queue: &'a Queue,
    pub(crate) grid: &'a GridKernels,
    pub(crate) kernels: &'a OctreeKernels,
    pub(crate) shared: &'a Shared,
    pub(crate) sites: &'a Room<[f64; 4]>,
}

impl OctreeMemory {
    /// Makes room for a little of what the kernels of cells are given.
    pub(crate) fn be_there(&mut self, context: &Context) -> Result<()> {
        self.nodes.grow(context, 1)?;
        self.listed.grow(context, 1)?;
        self.homes.grow(context, 1)?;
        self.middles.grow(context, 1)
    }

    /// Gives back what the octree was made with, if it is more than `most` bytes.
    pub(crate) fn free_scratch(&mut self, most: u64) {
        let Self { ways, boxes, next_boxes, whole, next, kept, counts, firsts, leasts, splits, wholes, lists, .. } =
            self;
        let mut numbers = [ways, whole, next, counts, firsts, leasts, splits, wholes, lists];
        let of_numbers: u64 = numbers.iter().map(|numbers| numbers.bytes()).sum();
        if of_numbers + boxes.bytes() + next_boxes.bytes() + kept.bytes() > most {
            numbers.iter_mut().for_each(|numbers| numbers.free());
            boxes.free();
            next_boxes.free();
            kept.free();
        }
    }

    /// Gives all back.
    pub(crate) fn free(&mut self) {
        self.free_scratch(0);
        self.unlisted.free();
        self.nodes.free();
        self.listed.free();
        self.homes.free();
        self.middles.free();
    }

    /// Makes the octree over the sites of a tree; how far a place may be off there, or 0 where boxes would list too many. `sums` is scratch. (What
    /// `core/src/power_octree.rs` makes, level by level: boxes stay on the device, where a million sites may have three million.)
    pub(crate) fn make(
        &mut self,
        of: OfSites<'_>,
        sums: &mut Vec<Room<u32>>,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<f64> {
        let OfSites { context, queue, shared, .. } = of;
        let Params { box_lo, box_hi, tree_sites, .. } = shared.params;
        let (bounds, sites) = ([box_lo, box_hi], tree_sites as usize);
        let margin = margin_of(bounds);
        self.listed.grow(context, most_listed(sites))?;
        let all: Vec<u32> = (0..sites.div_ceil(WIDTH) as u32).collect();
        self.whole.fill(context, queue, &all)?;
        self.boxes.fill(context, queue, &[OctreeBox::of_all(bounds, sites)])?;
        self.unlisted.fill_with(context, queue, 0, 1)?;
        // (The first box has parts, so that its middle is of no use.)
        self.nodes.grow(context, 1)?;
        self.middles.grow(context, 1)?;
        let mut level = Level { boxes: 1, leaves: all.len(), nodes: 1, listed: 0 };
        for depth in 1..=MOST_DEPTH {
            if level.boxes == 0 {
                break;
            }
            go_on()?;
            let Some(next) = self.split(of, level, depth, margin, sums)? else { return Ok(0.0) };
            level = next;
        }
        self.find_homes(of, level.nodes)?;
        queue.finish().map_err(|e| failed("making the octree over the container", e))?;
        Ok(off_of(margin))
    }

    /// Marks the leaves that each part of the boxes of a level keeps, and counts them.
    fn mark(&mut self, of: OfSites<'_>, level: Level, margin: f64) -> Result<()> {
        let OfSites { context, queue, kernels, shared, sites, .. } = of;
        let Level { boxes: count, leaves: all, .. } = level;
        let parts = WIDTH * count;
        self.kept.grow(context, WIDTH * all)?;
        self.counts.grow(context, parts)?;
        let Self { boxes, whole: leaves, kept, counts, firsts, leasts, .. } = self;
        let splitting = Splitting { params: &shared.room, sites, boxes, leaves, margin, kept };
        if all <= MANY_LEAVES * count {
            return kernels.split_boxes.run(queue, parts * GROUP, GROUP, SplitBoxes { splitting, counts });
        }
        let slices = all.div_ceil(OF_SLICE * count);
        leasts.grow(context, parts * slices * OCTREE_PLACES as usize)?;
        firsts.fill_with(context, queue, 0, parts)?;
        counts.fill_with(context, queue, 0, parts)?;
        let (items, slices) = (parts * slices * GROUP, slices as u32);
        for is_second in [0, 1] {
            let finding = FindLeasts { splitting, slices, is_second, firsts, leasts };
            kernels.find_leasts.run(queue, items, GROUP, finding)?;
            let marking = MarkSlices { splitting, slices, is_second, leasts, firsts, counts };
            kernels.mark_slices.run(queue, items, GROUP, marking)?;
        }
        Ok(())
    }

    /// Splits the boxes of a level; `None` where there are too many then.
    fn split(
        &mut self,
        of: OfSites<'_>,
        level: Level,
        depth: u32,
        margin: f64,
        sums: &mut Vec<Room<u32>>,
    ) -> Result<Option<Level>> {
        let OfSites { context, queue, grid, kernels, shared, .. } = of;
        let Level { boxes: count, nodes: first, listed: before, .. } = level;
        let parts = WIDTH * count;
        self.mark(of, level, margin)?;
        for numbers in [&mut self.splits, &mut self.wholes, &mut self.lists] {
            numbers.grow(context, parts + 1)?;
        }
        let Self { boxes, counts, splits, wholes, lists, unlisted, .. } = &*self;
        let most = MOST_LEAVES - 1;
        let number = parts as u32;
        let arguments = JudgeParts { boxes, counts, parts: number, depth, most, splits, wholes, lists, unlisted };
        kernels.judge_parts.run(queue, parts + 1, GROUP, arguments)?;
        let mut totals = [0; 3];
        for (total, numbers) in totals.iter_mut().zip([splits, wholes, lists]) {
            *total = scan_all(context, queue, grid, numbers, parts, sums)?;
        }
        let [next_boxes, next_leaves, more] = totals;
        if are_too_many(before + more, next_leaves, next_boxes, shared.params.tree_sites as usize) {
            return Ok(None);
        }
        self.next_boxes.grow(context, next_boxes)?;
        self.next.grow(context, next_leaves)?;
        self.nodes.extend(context, queue, first, first + parts)?;
        self.middles.extend(context, queue, first, first + parts)?;
        let arguments = PlaceLeaves {
            boxes: &self.boxes,
            leaves: &self.whole,
            kept: &self.kept,
            counts: &self.counts,
            splits: &self.splits,
            wholes: &self.wholes,
            lists: &self.lists,
            most,
            first: first as u32,
            before: before as u32,
            next_boxes: &self.next_boxes,
            next: &self.next,
            listed: &self.listed,
            nodes: &self.nodes,
            middles: &self.middles,
        };
        kernels.place_leaves.run(queue, parts * GROUP, GROUP, arguments)?;
        mem::swap(&mut self.boxes, &mut self.next_boxes);
        mem::swap(&mut self.whole, &mut self.next);
        Ok(Some(Level { boxes: next_boxes, leaves: next_leaves, nodes: first + parts, listed: before + more }))
    }

    /// Finds where each site's cell is, among so many boxes.
    fn find_homes(&mut self, of: OfSites<'_>, boxes: usize) -> Result<()> {
        let OfSites { context, queue, kernels, shared, sites, .. } = of;
        let is_whole = self.unlisted.first(queue)? == 0;
        let count = shared.params.tree_sites as usize;
        self.ways.fill_with(context, queue, u32::MAX, count)?;
        self.homes.fill_with(context, queue, if is_whole { NO_HOME } else { NO_BOX }, count)?;
        for is_second in [0, 1] {
            let Self { nodes, middles, listed, ways, homes, .. } = &*self;
            let arguments = FindHomes { params: &shared.room, sites, nodes, middles, listed, is_second, ways, homes };
            kernels.find_homes.run(queue, boxes * GROUP, GROUP, arguments)?;
        }
        Ok(())
    }
}

/// How far it has come: the boxes that are split next, and the leaves that they list; all boxes, and the leaves that are listed in the end.
#[derive(Clone, Copy)]
struct Level {
    boxes: usize,
    leaves: usize,
    nodes: usize,
    listed: usize,
}
