//! The sites on the device, in the order of a curve, with the tree over them and the table of voxels; ordered there, or, where sites are too near
//! each other for the curve, by the host.

mod order;

use crate::buffer::Room;
use crate::interface::data::{DIGITS, GRID_GROUP, NODES_GROUP, Params, RINGS_GROUP, Range, SCAN_EACH, SORT_EACH};
use crate::interface::kernels::{AddBlocks, BoundNodes, EnterSites, LookAtRings, ScanBlocks, TightenSlabs};
use crate::params::Shared;
use crate::program::GridKernels;
use crate::queue::Queue;
use laguerre_core::cell::ring::RINGS;
use laguerre_core::diagram::{FARTHEST_SITE, LARGEST_WEIGHT_SPREAD, Prepared};
use laguerre_core::site_tree::{
    Boxes, MadeTree, Slabs, TIGHT_LEVELS, TURNS, WIDTH, WeightBounds, level_begins, order_of_levels,
};
use laguerre_core::{PowerDiagram, Result};
use opencl3::context::Context;
use order::Ordered;
use rayon::prelude::*;

/// Sites per voxel: the smaller the voxels, the more nearly sites come nearest first, and the more voxels are looked at.
const SITES_PER_VOXEL: f64 = 2.0;

/// Work-items of a group, and the elements that one group scans.
pub(crate) const GROUP: usize = GRID_GROUP as usize;
const SCANNED: usize = GROUP * SCAN_EACH as usize;

/// Elements that a group sorts.
const SORTED: usize = GROUP * SORT_EACH as usize;

/// The sites as the caller gave them: how many, where, and their weights unless all are equal.
pub(crate) struct Given {
    pub(crate) count: usize,
    pub(crate) positions: Room<[f64; 3]>,
    weights: Room<f64>,
    has_weights: bool,
    /// Which positions they are ([`PowerDiagram::positions_id`]); 0 where they are nobody's.
    positions_id: u64,
}

impl Given {
    pub(crate) const fn new() -> Self {
        Self {
            count: 0,
            positions: Room::new("sites"),
            weights: Room::new("weights"),
            has_weights: false,
            positions_id: 0,
        }
    }

    /// The positions are others now.
    pub(crate) const fn move_away(&mut self) {
        self.positions_id = 0;
    }

    /// Brings the sites of a diagram to the device, as far as they are not there.
    pub(crate) fn bring(&mut self, context: &Context, queue: &Queue, diagram: &PowerDiagram) -> Result<()> {
        self.count = diagram.positions().len();
        self.has_weights = !diagram.weights().is_empty();
        if !(self.positions_id == diagram.positions_id() && self.positions.is_made()) {
            self.positions_id = 0;
            self.positions.fill(context, queue, diagram.positions())?;
            self.positions_id = diagram.positions_id();
        }
        self.weights.fill(context, queue, diagram.weights())
    }
}

/// The sites, as the caller gave them and as the search needs them.
pub(crate) struct Sites {
    pub(crate) given: Given,
    /// In the frame, with their weights, in the caller's order.
    pub(crate) placed: Room<[f64; 4]>,
    ranges: Room<Range>,
    marks: Room<u32>,
    turns: Room<[u8; 2]>,
    ranks: [Room<u64>; 2],
    slots: [Room<u32>; 2],
    digits: Room<u32>,
    kept: Room<u32>,
    flag: Room<u32>,
    /// Sums of blocks, of blocks of blocks, and so on.
    pub(crate) sums: Vec<Room<u32>>,
    pub(crate) sites: Room<[f64; 4]>,
    /// The caller's index of each sorted site.
    pub(crate) order: Room<u32>,
    pub(crate) voxels: Room<[u32; 2]>,
    pub(crate) boxes: Room<Boxes>,
    pub(crate) slabs: Room<Slabs>,
    pub(crate) weight_bounds: Room<WeightBounds>,
    /// What sites around each block of leaves weigh at most, ring by ring.
    pub(crate) around: Room<f64>,
    /// Whether the tree was made by the host.
    pub(crate) is_from_host: bool,
    /// What is in order, if other weights would leave it so.
    ordered: Option<Ordered>,
    on_host: OnHost,
}

/// What is read back, kept from call to call.
#[derive(Default)]
struct OnHost {
    ranges: Vec<Range>,
    marks: Vec<u32>,
}

impl Sites {
    pub(crate) const fn new() -> Self {
        let order = "the order of the sites";
        let tree = "the tree over the sites";
        Self {
            given: Given::new(),
            placed: Room::new("sites"),
            ranges: Room::new("the range of the sites"),
            marks: Room::new("the site grid"),
            turns: Room::new(order),
            ranks: [Room::new(order), Room::new(order)],
            slots: [Room::new(order), Room::new(order)],
            digits: Room::new(order),
            kept: Room::new(order),
            flag: Room::new(order),
            sums: Vec::new(),
            sites: Room::new("sorted sites"),
            order: Room::new("sorted sites"),
            voxels: Room::new("the site grid"),
            boxes: Room::new(tree),
            slabs: Room::new(tree),
            weight_bounds: Room::new(tree),
            around: Room::new(tree),
            is_from_host: false,
            ordered: None,
            on_host: OnHost { ranges: Vec::new(), marks: Vec::new() },
        }
    }

    /// Believes nothing of what is there.
    pub(crate) fn forget(&mut self) {
        self.given.move_away();
        self.ordered = None;
    }

    /// Orders the sites that were brought, and makes the tree over them. Returns how many have a cell, or `None` where too many are too near each
    /// other, when [`take`](Self::take) takes what the host makes; or where some may be out of range and `is_in_range` does not know better.
    pub(crate) fn sort(
        &mut self,
        context: &Context,
        queue: &Queue,
        kernels: &GridKernels,
        is_in_range: &dyn Fn() -> Result<bool>,
        shared: &mut Shared,
    ) -> Result<Option<usize>> {
        let n = self.given.count;
        let count = n as u32;
        shared.send(context, queue)?;
        self.placed.grow(context, n)?;
        self.ranges.grow(context, n.div_ceil(GROUP))?;
        let has_weights = u32::from(self.given.has_weights);
        kernels.enter_sites.run(
            queue,
            n,
            GROUP,
            EnterSites {
                params: &shared.room,
                positions: &self.given.positions,
                weights: &self.given.weights,
                has_weights,
                count,
                placed: &self.placed,
                ranges: &self.ranges,
            },
        )?;
        self.ranges.read(queue, n.div_ceil(GROUP), &mut self.on_host.ranges)?;
        let range = self.on_host.ranges.iter().fold(Range::default(), |all, part| all.joined(part));
        let farthest = range.lo.iter().chain(&range.hi).fold(0.0_f64, |far, x| far.max(x.abs()));
        let is_far = farthest > FARTHEST_SITE || range.largest_weight - range.smallest_weight > LARGEST_WEIGHT_SPREAD;
        if is_far && !is_in_range()? {
            return Ok(None);
        }
        let Some(sites) = self.put_in_order(context, queue, kernels, &range, shared)? else { return Ok(None) };
        self.bound_nodes(context, queue, kernels, shared, sites as usize)?;
        if shared.is_shared && shared.params.has_table != 0 && shared.params.equal_weights == 0 {
            let count = blocks_of_leaves(sites as usize);
            // (Not where other room is made, by the number of the caller's sites: where some coincide there may be more blocks of the others, since a few leaves are a block each.)
            self.around.grow(context, count * RINGS as usize)?;
            kernels.look_at_rings.run(
                queue,
                count * RINGS_GROUP as usize,
                RINGS_GROUP as usize,
                LookAtRings {
                    params: &shared.room,
                    sites: &self.sites,
                    boxes: &self.boxes,
                    weight_bounds: &self.weight_bounds,
                    around: &self.around,
                },
            )?;
        }
        self.is_from_host = false;
        Ok(Some(sites as usize))
    }

    /// Makes the tree over the sites that are in order.
    fn bound_nodes(
        &mut self,
        context: &Context,
        queue: &Queue,
        kernels: &GridKernels,
        shared: &mut Shared,
        sites: usize,
    ) -> Result<()> {
        let begins = shared.params.search_tree(sites);
        shared.send(context, queue)?;
        for level in order_of_levels(begins.len() - 1) {
            let blocks = begins[level + 1] - begins[level];
            let group = NODES_GROUP as usize;
            kernels.bound_nodes.run(
                queue,
                blocks * [WIDTH, group, WIDTH * group][level.min(2)],
                group,
                BoundNodes {
                    params: &shared.room,
                    sites: &self.sites,
                    level: level as u32,
                    blocks: blocks as u32,
                    boxes: &self.boxes,
                    slabs: &self.slabs,
                    weight_bounds: &self.weight_bounds,
                },
            )?;
            if TIGHT_LEVELS.contains(&level) {
                let nodes = sites.div_ceil(WIDTH << (3 * level));
                let Self { sites, slabs, .. } = &*self;
                kernels.tighten_slabs.run(
                    queue,
                    nodes * GROUP,
                    GROUP,
                    TightenSlabs { params: &shared.room, sites, level: level as u32, slabs },
                )?;
            }
        }
        Ok(())
    }

    /// Makes room for `n` sites in so many voxels and a fourth more, and for any of them that fill half of their box, so that nothing is allocated
    /// where they move.
    fn reserve(&mut self, context: &Context, queue: &Queue, shared: &Shared, n: usize, voxels: usize) -> Result<()> {
        let voxels = (voxels + voxels / 4).max((2.0 * n as f64 / SITES_PER_VOXEL) as usize);
        self.voxels.grow(context, voxels)?;
        if !self.turns.is_made() {
            let turns: Vec<[u8; 2]> = TURNS.iter().flatten().map(|&(rank, turn)| [rank, turn]).collect();
            self.turns.fill(context, queue, &turns)?;
        }
        self.ranks.iter_mut().try_for_each(|ranks| ranks.grow(context, n))?;
        self.slots.iter_mut().try_for_each(|slots| slots.grow(context, n))?;
        self.digits.grow(context, DIGITS as usize * n.div_ceil(SORTED))?;
        self.kept.grow(context, n + 1)?;
        self.sites.grow(context, n)?;
        self.order.grow(context, n)?;
        let begins = level_begins(n);
        let blocks = begins[begins.len() - 1];
        self.boxes.grow(context, blocks)?;
        self.slabs.grow(context, blocks)?;
        let has_weights = shared.params.equal_weights == 0;
        self.weight_bounds.grow(context, if has_weights { blocks } else { 1 })?;
        self.around.grow(context, 1)?;
        Ok(())
    }

    /// Reads the tree over the sites back.
    pub(crate) fn read_tree(&self, queue: &Queue, params: &Params) -> Result<MadeTree> {
        let count = params.tree_sites as usize;
        let blocks = level_begins(count).last().copied().unwrap_or(0);
        let mut made = MadeTree {
            sites: Vec::new(),
            order: Vec::new(),
            boxes: Vec::new(),
            slabs: Vec::new(),
            weights: Vec::new(),
            base_weight: params.smallest_weight,
            largest_weight: params.largest_weight,
        };
        self.sites.read(queue, count, &mut made.sites)?;
        self.order.read(queue, count, &mut made.order)?;
        self.boxes.read(queue, blocks, &mut made.boxes)?;
        self.slabs.read(queue, blocks, &mut made.slabs)?;
        self.weight_bounds.read(queue, if params.equal_weights == 0 { blocks } else { 0 }, &mut made.weights)?;
        Ok(made)
    }

    /// Takes the tree over the sites that the host made; returns how many have a cell.
    pub(crate) fn take(
        &mut self,
        context: &Context,
        queue: &Queue,
        prepared: &Prepared,
        shared: &mut Shared,
    ) -> Result<usize> {
        let tree = &prepared.sites;
        shared.params.take_tree(tree);
        shared.send(context, queue)?;
        let sites: Vec<_> = (0..tree.len() as u32).into_par_iter().map(|i| tree.site(i)).collect();
        self.sites.fill(context, queue, &sites)?;
        self.order.fill(context, queue, tree.order())?;
        self.boxes.fill(context, queue, tree.all_boxes())?;
        self.slabs.fill(context, queue, tree.all_slabs())?;
        self.weight_bounds.fill(context, queue, tree.all_weights())?;
        self.voxels.grow(context, 1)?;
        self.around.grow(context, 1)?;
        self.is_from_host = true;
        self.ordered = None;
        Ok(tree.len())
    }
}

/// Blocks of leaves in the tree over so many sites: leaves, where there is no more than one block.
const fn blocks_of_leaves(sites: usize) -> usize {
    let leaves = sites.div_ceil(WIDTH);
    if leaves <= WIDTH { leaves } else { leaves.div_ceil(WIDTH) }
}

/// Replaces each of the first `count` numbers by the sum of those before it; `sums` is room for those of blocks, of blocks of blocks,
/// and so on, which grows if it must.
pub(crate) fn scan(
    context: &Context,
    queue: &Queue,
    kernels: &GridKernels,
    data: &Room<u32>,
    count: usize,
    sums: &mut Vec<Room<u32>>,
) -> Result<()> {
    let mut blocks = count;
    for depth in 0.. {
        if sums.len() == depth {
            sums.push(Room::new("sums of blocks"));
        }
        blocks = blocks.div_ceil(SCANNED);
        sums[depth].grow(context, blocks)?;
        if blocks <= 1 {
            break;
        }
    }
    scan_with(queue, kernels, data, count, sums)
}

/// The same of one number more; the sum of all `count`.
pub(crate) fn scan_all(
    context: &Context,
    queue: &Queue,
    kernels: &GridKernels,
    data: &Room<u32>,
    count: usize,
    sums: &mut Vec<Room<u32>>,
) -> Result<usize> {
    scan(context, queue, kernels, data, count + 1, sums)?;
    Ok(data.number(queue, count)? as usize)
}

fn scan_with(
    queue: &Queue,
    kernels: &GridKernels,
    data: &Room<u32>,
    count: usize,
    sums: &mut [Room<u32>],
) -> Result<()> {
    let blocks = count.div_ceil(SCANNED);
    let number = count as u32;
    let Some((own, deeper)) = sums.split_first_mut() else { return Ok(()) };
    kernels.scan_blocks.run(queue, blocks * GROUP, GROUP, ScanBlocks { data, count: number, sums: own })?;
    if blocks > 1 {
        scan_with(queue, kernels, own, blocks, deeper)?;
        kernels.add_blocks.run(queue, count, GROUP, AddBlocks { data, count: number, sums: own })?;
    }
    Ok(())
}
