//! The kernel of cells, launched over some of them.

use super::Device;
use crate::buffer::lacked_memory;
use crate::builds::Way;
use crate::interface::kernels::{self, World};
use laguerre_core::passes::Cells;
use laguerre_core::{Error, Result};
use std::ops::Range;
use std::time::Instant;

/// Work-items over which few cells are spread that are computed alone, where work-items run in step: so that none waits for another, which goes
/// another way (579 cells at the edge of a cloud: 0.143 to 0.038 s, one NVIDIA H200). About as many as a large GPU runs at a time.
const FEW_ITEMS: usize = 1 << 16;

/// Cells of a pass: a range of sorted sites, or as many as stand in `todo`.
#[derive(Clone, Debug)]
pub(crate) enum Todo {
    Sorted(Range<usize>),
    Listed(usize),
}

impl Todo {
    /// Whether they stand in the list, and where they begin.
    pub(super) fn place(&self) -> (u32, usize) {
        match self {
            Self::Sorted(range) => (0, range.start),
            Self::Listed(_) => (1, 0),
        }
    }
}

impl Cells for Todo {
    fn count(&self) -> usize {
        match self {
            Self::Sorted(range) => range.len(),
            Self::Listed(count) => *count,
        }
    }
}

impl Default for Todo {
    fn default() -> Self {
        Self::Listed(0)
    }
}

impl Device {
    /// Launches the kernel over those that have a turn (`ALL_TURNS`: over all): as [`run`](Self::run).
    pub(super) fn launch(
        &mut self,
        way: Way,
        cells: &Todo,
        stride: usize,
        turns: Range<usize>,
        interior_only: bool,
        turn_of: u32,
    ) -> Result<Option<Error>> {
        let Self { context, queue, memory, octree, programs, sites, shared, counters, .. } = self;
        let kernels = programs.get(context, self.id, way, &shared.params)?;
        let begin = Instant::now();
        memory.facets.grow(context, 1)?;
        memory.facet_moments.grow(context, 1)?;
        memory.facet_seconds.grow(context, 1)?;
        memory.given.grow(context, 1)?;
        // (It may have been given back since.)
        shared.params.given_room = memory.given.length().min(shared.params.given_room as usize) as u32;
        memory.begun.grow(context, 1)?;
        memory.begun_places.grow(context, 1)?;
        memory.vast.grow(context, 1)?;
        memory.leaders.grow(context, 1)?;
        memory.kept.grow(context, 1)?;
        octree.be_there(context)?;
        shared.send(context, queue)?;
        memory.counters.fill(context, queue, &[*counters])?;
        let (has_list, start) = cells.place();
        let first = (start + turns.start) as u32;
        let apart = match (way, self.together) {
            (Way::Alone(_), Some(lanes)) => (FEW_ITEMS / turns.len().max(1)).clamp(1, lanes.count()),
            _ => 1,
        };
        let world = World {
            params: &shared.room,
            sites: &sites.sites,
            voxels: &sites.voxels,
            boxes: &sites.boxes,
            slabs: &sites.slabs,
            weight_bounds: &sites.weight_bounds,
            around: &sites.around,
            octree_nodes: &octree.nodes,
            octree_leaves: &octree.listed,
            octree_homes: &octree.homes,
            octree_middles: &octree.middles,
            domain_vertices: &memory.domain_vertices,
            triangles: &memory.triangles,
            lowest_voxels: &memory.lowest_voxels,
            list_offsets: &memory.list_offsets,
            list_entries: &memory.list_entries,
            windings: &memory.windings,
            surface_table: &memory.surface_table,
            integrand: &memory.integrand,
        };
        let arguments = kernels::Cells {
            world,
            shells: &memory.shells,
            abouts: &memory.abouts,
            order: &sites.order,
            list: &memory.todo,
            has_list,
            first,
            stride: stride as u32,
            apart: apart as u32,
            count: turns.len() as u32,
            interior_only: u32::from(interior_only),
            turn_of,
            leaders: &memory.leaders,
            kept: &memory.kept,
            outcome: &memory.outcome,
            sums: &memory.sums,
            rows: &memory.rows,
            facets: &memory.facets,
            facet_moments: &memory.facet_moments,
            facet_seconds: &memory.facet_seconds,
            counters: &memory.counters,
            surface: &memory.surface,
            later: &memory.later,
            full: &memory.full,
            left: &memory.left,
            given: &memory.given,
            begun: &memory.begun,
            begun_places: &memory.begun_places,
            vast: &memory.vast,
        };
        let items = turns.len() * kernels.per_cell * apart;
        let ran = kernels.cells.launch(queue, items, kernels.group, arguments)?;
        if let Err(error) = ran {
            let late = lacked_memory(&error);
            let failed = kernels.cells.failed(error);
            return if late { Ok(Some(failed)) } else { Err(failed) };
        }
        *counters = memory.counters.first(queue)?;
        self.seconds += begin.elapsed().as_secs_f64();
        Ok(None)
    }
}
