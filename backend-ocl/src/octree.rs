//! The octree over the container (`core/src/power_octree.rs`), whose leaves are on the device.

use crate::buffer::{Room, failed, rooms};
use crate::interface::data::{
    GRID_GROUP, NO_BOX, NO_HOME, OCTREE_GROUP, PLACED_LISTED, PLACED_NOWHERE, PLACED_WHOLE, Params,
};
use crate::interface::kernels::{FindHomes, PlaceLeaves, SplitBoxes};
use crate::params::Shared;
use crate::program::GridKernels;
use crate::queue::Queue;
use laguerre_core::Result;
use laguerre_core::cell::search_store::MOST_LEAVES;
use laguerre_core::power_octree::{Lists, OctreeBox, OctreeBoxes, Place, margin_of, most_listed};
use laguerre_core::site_tree::WIDTH;
use opencl3::context::Context;
use opencl3::types::cl_device_id;
use rayon::prelude::*;

/// Work-items of a group, and where boxes list more leaves than so many: there are few such boxes. (Of a million sites the first two levels took 22 of 41 ms
/// with small groups, one NVIDIA H100.)
const GROUP: usize = OCTREE_GROUP as usize;
const LARGE_GROUP: usize = GRID_GROUP as usize;
const MANY_LEAVES: usize = 1024;

rooms! {
    pub(crate) struct OctreeMemory {
        pub(crate) nodes: [u32; 2] = "the octree over the container",
        pub(crate) listed: u32 = "the octree over the container",
        pub(crate) homes: u32 = "the octree over the container",
        pub(crate) middles: [f64; 4] = "the octree over the container",
        ways: u32 = "the octree over the container",
        boxes: OctreeBox = "boxes of the octree over the container",
        /// The leaves of the boxes that are split, and of those that are split next.
        whole: u32 = "boxes of the octree over the container",
        next: u32 = "boxes of the octree over the container",
        kept: u8 = "boxes of the octree over the container",
        counts: u32 = "boxes of the octree over the container",
        places: [u32; 2] = "boxes of the octree over the container",
    }
}

/// A device, and the sorted sites on it.
#[derive(Clone, Copy)]
pub(crate) struct OfSites<'a> {
    pub(crate) device: cl_device_id,
    pub(crate) context: &'a Context,
    pub(crate) queue: &'a Queue,
    pub(crate) kernels: &'a GridKernels,
    pub(crate) shared: &'a Shared,
    pub(crate) sites: &'a Room<[f64; 4]>,
}

/// What makes it.
struct OnDevice<'a> {
    of: OfSites<'a>,
    memory: &'a mut OctreeMemory,
    margin: f64,
    /// Work-items of a group that goes over many leaves.
    large: usize,
}

impl Lists for OnDevice<'_> {
    fn split(&mut self, front: &[OctreeBox]) -> Result<Vec<u32>> {
        let Self { of: OfSites { context, queue, kernels, shared, sites, .. }, memory, margin, large } = self;
        let leaves: usize = front.iter().map(|its| its.count as usize).sum();
        let parts = WIDTH * front.len();
        memory.boxes.fill(context, queue, front)?;
        memory.kept.grow(context, WIDTH * leaves)?;
        memory.counts.grow(context, parts)?;
        let arguments = SplitBoxes {
            params: &shared.room,
            sites,
            boxes: &memory.boxes,
            leaves: &memory.whole,
            margin: *margin,
            kept: &memory.kept,
            counts: &memory.counts,
        };
        let group = if leaves > MANY_LEAVES * front.len() { *large } else { GROUP };
        kernels.split_boxes.run(queue, parts * group, group, arguments)?;
        let mut counts = Vec::new();
        memory.counts.read(queue, parts, &mut counts)?;
        Ok(counts)
    }

    fn place(&mut self, places: &[Place], whole: usize) -> Result<()> {
        let Self { of: OfSites { context, queue, kernels, .. }, memory, .. } = self;
        let places: Vec<[u32; 2]> = places
            .par_iter()
            .map(|place| match *place {
                Place::Whole(begin) => [PLACED_WHOLE, begin],
                Place::Listed(begin) => [PLACED_LISTED, begin],
                Place::Nowhere => [PLACED_NOWHERE, 0],
            })
            .collect();
        memory.places.fill(context, queue, &places)?;
        memory.next.grow(context, whole)?;
        let arguments = PlaceLeaves {
            boxes: &memory.boxes,
            leaves: &memory.whole,
            kept: &memory.kept,
            places: &memory.places,
            next: &memory.next,
            listed: &memory.listed,
        };
        kernels.place_leaves.run(queue, places.len() * GROUP, GROUP, arguments)?;
        std::mem::swap(&mut memory.whole, &mut memory.next);
        Ok(())
    }
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
        let Self { ways, boxes, whole, next, kept, counts, places, .. } = self;
        let lists = ways.bytes() + whole.bytes() + next.bytes() + kept.bytes();
        if lists + boxes.bytes() + counts.bytes() + places.bytes() > most {
            [ways, whole, next, counts].into_iter().for_each(Room::free);
            boxes.free();
            kept.free();
            places.free();
        }
    }

    /// Gives all back.
    pub(crate) fn free(&mut self) {
        self.free_scratch(0);
        self.nodes.free();
        self.listed.free();
        self.homes.free();
        self.middles.free();
    }

    /// Makes the octree over the sites of a tree; how far a place may be off there, or 0 where boxes would list too many.
    pub(crate) fn make(&mut self, of: OfSites<'_>, go_on: &dyn Fn() -> Result<()>) -> Result<f64> {
        let OfSites { device, context, queue, kernels, shared, sites } = of;
        let Params { box_lo, box_hi, tree_sites, .. } = shared.params;
        let (bounds, count) = ([box_lo, box_hi], tree_sites as usize);
        self.listed.grow(context, most_listed(count))?;
        let all: Vec<u32> = (0..count.div_ceil(WIDTH) as u32).collect();
        self.whole.fill(context, queue, &all)?;
        let largest = kernels.split_boxes.largest_group(device)?.clamp(GROUP, LARGE_GROUP);
        let margin = margin_of(bounds);
        let mut lists = OnDevice { of, memory: self, margin, large: 1 << largest.ilog2() };
        let Some(boxes) = OctreeBoxes::new(&mut lists, count, bounds, MOST_LEAVES as usize - 1, go_on)? else {
            return Ok(0.0);
        };
        let nodes: Vec<[u32; 2]> = boxes.nodes().par_iter().map(|node| [node.begin, node.count]).collect();
        let in_double = |middle: &[f32; 3]| [f64::from(middle[0]), f64::from(middle[1]), f64::from(middle[2]), 0.0];
        let middles: Vec<[f64; 4]> = boxes.middles().par_iter().map(in_double).collect();
        self.nodes.fill(context, queue, &nodes)?;
        self.middles.fill(context, queue, &middles)?;
        self.ways.fill_with(context, queue, u32::MAX, count)?;
        self.homes.fill_with(context, queue, if boxes.is_whole() { NO_HOME } else { NO_BOX }, count)?;
        for is_second in [0, 1] {
            let Self { nodes, middles, listed, ways, homes, .. } = &*self;
            let arguments = FindHomes { params: &shared.room, sites, nodes, middles, listed, is_second, ways, homes };
            kernels.find_homes.run(queue, boxes.nodes().len() * GROUP, GROUP, arguments)?;
        }
        queue.finish().map_err(|e| failed("making the octree over the container", e))?;
        Ok(boxes.off())
    }
}
