//! The sites on the device: sorted there, or, where a voxel is crowded, by the host, with a tree over them.

use crate::buffer::Room;
use crate::interface::data::{BLOCK_LEVEL, Block, GRID_GROUP, MOST_LEVELS, Range, SCAN_EACH};
use crate::interface::kernels::{
    AddBlocks, BoundBlocks, CountSites, EnterSites, FitBlocks, GatherSites, MarkVoxels, PlaceSites, RaiseBounds,
    RaiseLevel, ScanBlocks, SortVoxels,
};
use crate::params::Shared;
use crate::program::GridKernels;
use laguerre_core::diagram::{FARTHEST_SITE, FramedContainer, LARGEST_WEIGHT_SPREAD, Prepared};
use laguerre_core::site_grid::Voxels;
use laguerre_core::site_tree::{Boxes, Slabs, WeightBounds};
use laguerre_core::{PowerDiagram, Result};
use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use rayon::prelude::*;

/// Sites per voxel: the smaller the voxels, the more nearly sites come nearest first, and the more voxels are looked at (measured: see
/// BENCHMARKS.md).
pub(crate) const SITES_PER_VOXEL: f64 = 2.0;

/// Work-items of a group, and the elements that one group scans.
pub(crate) const GROUP: usize = GRID_GROUP as usize;
const SCANNED: usize = GROUP * SCAN_EACH as usize;

/// The sites, as the caller gave them and as the search needs them.
pub(crate) struct Sites {
    positions: Room<[f64; 3]>,
    given_weights: Room<f64>,
    placed: Room<[f64; 4]>,
    ranges: Room<Range>,
    place: Room<[u32; 2]>,
    starts: Room<u32>,
    slots: Room<u32>,
    crowded: Room<u32>,
    /// Sums of blocks, of blocks of blocks, and so on.
    sums: Vec<Room<u32>>,
    pub(crate) sites: Room<[f64; 4]>,
    /// The caller's index of each sorted site.
    pub(crate) order: Room<u32>,
    pub(crate) offsets: Room<u32>,
    pub(crate) weights: Room<f64>,
    /// What bounds the weights of each node of the pyramid from blocks of voxels on, and the search about each block, where weights differ
    /// (`blocks.cl`).
    pub(crate) bounds: Room<[f64; 4]>,
    pub(crate) blocks: Room<Block>,
    /// The tree over the sites, where the host made one.
    pub(crate) boxes: Room<Boxes>,
    pub(crate) slabs: Room<Slabs>,
    pub(crate) weight_bounds: Room<WeightBounds>,
    on_host: OnHost,
}

/// What is read back, kept from call to call.
#[derive(Default)]
struct OnHost {
    ranges: Vec<Range>,
    number: Vec<u32>,
}

impl Sites {
    pub(crate) const fn new() -> Self {
        Self {
            positions: Room::new("sites"),
            given_weights: Room::new("weights"),
            placed: Room::new("sites"),
            ranges: Room::new("the range of the sites"),
            place: Room::new("the site grid"),
            starts: Room::new("the site grid"),
            slots: Room::new("the site grid"),
            crowded: Room::new("the site grid"),
            sums: Vec::new(),
            sites: Room::new("sorted sites"),
            order: Room::new("sorted sites"),
            offsets: Room::new("the site grid"),
            weights: Room::new("the pyramid"),
            bounds: Room::new("the blocks of voxels"),
            blocks: Room::new("the blocks of voxels"),
            boxes: Room::new("the tree over the sites"),
            slabs: Room::new("the tree over the sites"),
            weight_bounds: Room::new("the tree over the sites"),
            on_host: OnHost { ranges: Vec::new(), number: Vec::new() },
        }
    }

    /// Brings the caller's sites to the device.
    pub(crate) fn upload(&mut self, context: &Context, queue: &CommandQueue, diagram: &PowerDiagram) -> Result<()> {
        self.positions.fill(context, queue, diagram.positions())?;
        self.given_weights.fill(context, queue, diagram.weights())
    }

    /// Sorts the sites that were brought. Returns how many have a cell, or `None` where a voxel is crowded; then
    /// [`take`](Self::take) what the host sorts.
    pub(crate) fn sort(
        &mut self,
        context: &Context,
        queue: &CommandQueue,
        kernels: &GridKernels,
        diagram: &PowerDiagram,
        container: &FramedContainer,
        shared: &mut Shared,
    ) -> Result<Option<usize>> {
        let n = diagram.positions().len();
        let count = n as u32;
        shared.send(context, queue)?;
        self.placed.grow(context, n)?;
        self.ranges.grow(context, n.div_ceil(GROUP))?;
        let has_weights = u32::from(!diagram.weights().is_empty());
        kernels.enter_sites.run(
            queue,
            n,
            GROUP,
            EnterSites {
                params: &shared.room,
                positions: &self.positions,
                weights: &self.given_weights,
                has_weights,
                count,
                placed: &self.placed,
                ranges: &self.ranges,
            },
        )?;
        self.ranges.read(queue, n.div_ceil(GROUP), &mut self.on_host.ranges)?;
        let range = self.on_host.ranges.iter().fold(Range::default(), |all, part| all.joined(part));
        let farthest = range.lo.iter().chain(&range.hi).fold(0.0_f64, |far, x| far.max(x.abs()));
        if farthest > FARTHEST_SITE || range.largest_weight - range.smallest_weight > LARGEST_WEIGHT_SPREAD {
            diagram.check_range(container)?;
        }
        let coarse = Voxels::coarse(range.lo, range.hi, n);
        shared.params.sort_into(&coarse, &range);
        shared.send(context, queue)?;
        self.starts.fill_with(context, queue, 0, coarse.count())?;
        kernels.mark_voxels.run(
            queue,
            n,
            GROUP,
            MarkVoxels { params: &shared.room, placed: &self.placed, count, marks: &self.starts },
        )?;
        self.starts.read(queue, coarse.count(), &mut self.on_host.number)?;
        let filled = self.on_host.number.iter().filter(|&&mark| mark != 0).count();
        let voxels = coarse.over_part(range.lo, range.hi, n, filled, SITES_PER_VOXEL);
        let nodes = shared.params.sort_into(&voxels, &range);
        shared.send(context, queue)?;
        let boxes = voxels.count();
        let box_count = boxes as u32;
        self.reserve(context, n, boxes, nodes)?;

        self.starts.fill_with(context, queue, 0, boxes + 1)?;
        self.crowded.fill_with(context, queue, 0, 1)?;
        self.place.grow(context, n)?;
        self.slots.grow(context, n)?;
        self.offsets.fill_with(context, queue, 0, boxes + 1)?;
        self.sites.grow(context, n)?;
        self.order.grow(context, n)?;
        self.boxes.grow(context, 1)?;
        self.slabs.grow(context, 1)?;
        self.weight_bounds.grow(context, 1)?;
        kernels.count_sites.run(
            queue,
            n,
            GROUP,
            CountSites {
                params: &shared.room,
                placed: &self.placed,
                count,
                place: &self.place,
                counts: &self.starts,
                crowded: &self.crowded,
            },
        )?;
        self.crowded.read(queue, 1, &mut self.on_host.number)?;
        if self.on_host.number[0] != 0 {
            return Ok(None);
        }
        scan(queue, kernels, &self.starts, boxes + 1, &mut self.sums)?;
        kernels.place_sites.run(
            queue,
            n,
            GROUP,
            PlaceSites { count, place: &self.place, starts: &self.starts, slots: &self.slots },
        )?;
        kernels.sort_voxels.run(
            queue,
            boxes,
            GROUP,
            SortVoxels {
                placed: &self.placed,
                voxels: box_count,
                starts: &self.starts,
                slots: &self.slots,
                kept: &self.offsets,
            },
        )?;
        scan(queue, kernels, &self.offsets, boxes + 1, &mut self.sums)?;
        kernels.gather_sites.run(
            queue,
            boxes,
            GROUP,
            GatherSites {
                placed: &self.placed,
                voxels: box_count,
                starts: &self.starts,
                slots: &self.slots,
                offsets: &self.offsets,
                sites: &self.sites,
                order: &self.order,
                weights: &self.weights,
            },
        )?;
        let levels = voxels.levels();
        for (level, pair) in levels.windows(2).enumerate() {
            let ([bx, by, bz], [nx, ny, nz]) = (pair[0], pair[1]);
            kernels.raise_level.run(
                queue,
                (nx * ny * nz) as usize,
                GROUP,
                RaiseLevel {
                    weights: &self.weights,
                    begin: shared.params.level_begin[level + 1],
                    nx,
                    ny,
                    nz,
                    below: shared.params.level_begin[level],
                    below_nx: bx,
                    below_ny: by,
                    below_nz: bz,
                },
            )?;
        }
        self.bound_blocks(context, queue, kernels, &levels, shared)?;
        self.offsets.read_from(queue, boxes, 1, &mut self.on_host.number)?;
        Ok(Some(self.on_host.number[0] as usize))
    }

    /// Where weights differ, finds what bounds the search about each block of voxels; not for trees, which only one work-item searches.
    fn bound_blocks(
        &mut self,
        context: &Context,
        queue: &CommandQueue,
        kernels: &GridKernels,
        levels: &[[u32; 3]],
        shared: &Shared,
    ) -> Result<()> {
        if shared.params.equal_weights != 0 {
            self.bounds.grow(context, 1)?;
            return self.blocks.grow(context, 1);
        }
        let own = (BLOCK_LEVEL as usize).min(levels.len() - 1);
        let nodes: Vec<usize> = levels[own..].iter().map(|dims| dims.iter().map(|&n| n as usize).product()).collect();
        let count = nodes[0] as u32;
        let boxes = levels[0].iter().map(|&n| n as usize).product::<usize>();
        self.bounds.grow(context, nodes.iter().sum::<usize>().max(boxes / 4))?;
        self.blocks.grow(context, nodes[0].max(boxes / 4))?;
        kernels.fit_blocks.run(
            queue,
            nodes[0],
            GROUP,
            FitBlocks { params: &shared.room, sites: &self.sites, voxels: &self.offsets, count, bounds: &self.bounds },
        )?;
        for (level, &nodes) in (own..).zip(&nodes).skip(1) {
            kernels.raise_bounds.run(
                queue,
                nodes,
                GROUP,
                RaiseBounds { params: &shared.room, bounds: &self.bounds, level: level as u32 },
            )?;
        }
        kernels.bound_blocks.run(
            queue,
            nodes[0],
            GROUP,
            BoundBlocks {
                params: &shared.room,
                sites: &self.sites,
                voxels: &self.offsets,
                bounds: &self.bounds,
                count,
                blocks: &self.blocks,
            },
        )?;
        Ok(())
    }

    /// Makes room for this grid of `boxes` voxels and `nodes` of the pyramid and a fourth more, and for any of `n` sites that fill half of their
    /// box, so that nothing is allocated where they move and its shape is another one.
    fn reserve(&mut self, context: &Context, n: usize, boxes: usize, nodes: usize) -> Result<()> {
        let boxes = (boxes + boxes / 4).max((2.0 * n as f64 / SITES_PER_VOXEL) as usize);
        self.starts.grow(context, boxes + 1)?;
        self.offsets.grow(context, boxes + 1)?;
        // A row of voxels has the most: half as many in each level, rounded up.
        self.weights.grow(context, nodes.max(2 * boxes + MOST_LEVELS))?;
        let mut count = boxes + 1;
        for depth in 0.. {
            if self.sums.len() == depth {
                self.sums.push(Room::new("sums of the site grid"));
            }
            count = count.div_ceil(SCANNED);
            self.sums[depth].grow(context, count)?;
            if count == 1 {
                break;
            }
        }
        Ok(())
    }

    /// Takes the tree over the sites that the host made; returns how many have a cell.
    pub(crate) fn take(
        &mut self,
        context: &Context,
        queue: &CommandQueue,
        prepared: &Prepared,
        shared: &mut Shared,
    ) -> Result<usize> {
        let tree = &prepared.sites;
        shared.params.search_tree(tree);
        shared.send(context, queue)?;
        let sites: Vec<_> = (0..tree.len() as u32).into_par_iter().map(|i| tree.site(i)).collect();
        self.sites.fill(context, queue, &sites)?;
        self.order.fill(context, queue, tree.order())?;
        self.boxes.fill(context, queue, tree.all_boxes())?;
        self.slabs.fill(context, queue, tree.all_slabs())?;
        self.weight_bounds.fill(context, queue, tree.all_weights())?;
        self.bounds.grow(context, 1)?;
        self.blocks.grow(context, 1)?;
        Ok(tree.len())
    }
}

/// Replaces each of the first `count` numbers by the sum of those before it; `sums` have room for those of blocks, of blocks of blocks,
/// and so on.
fn scan(
    queue: &CommandQueue,
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
        scan(queue, kernels, own, blocks, deeper)?;
        kernels.add_blocks.run(queue, count, GROUP, AddBlocks { data, count: number, sums: own })?;
    }
    Ok(())
}
