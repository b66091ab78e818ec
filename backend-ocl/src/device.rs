//! One device: its queue, its programs, its memory.

mod cells;
mod finish;
#[cfg(all(test, feature = "test-util"))]
mod host_tests;
mod leaders;
mod room;
mod sample;
mod schedule;
#[cfg(test)]
mod tests;

use crate::algebra::Answers;
use crate::buffer::{failed, rooms};
use crate::builds::Lanes;
use crate::facets::FacetMemory;
use crate::fresh::Lengths;
use crate::grid::{GROUP, Sites};
use crate::handle::Handle;
use crate::interface::data::{Counters, Params};
use crate::interface::kernels::MeasureClearances;
use crate::lanes;
use crate::laplacian::{LaplacianMemory, MadeLaplacian};
use crate::octree::OctreeMemory;
use crate::params::Shared;
use crate::platform::{self, Found};
use crate::program::{
    AlgebraKernels, Built as _, GridKernels, Later, OctreeKernels, Programs, RowKernels, TotalKernels,
};
use crate::queue::Queue;
use crate::results::Results;
use crate::shells;
use laguerre_core::assemble::FacetRecord;
use laguerre_core::cell::FacetSecond;
use laguerre_core::diagram::{FramedContainer, Prepared};
use laguerre_core::domain_grid::DomainGrid;
use laguerre_core::integrand::FramedIntegrand;
use laguerre_core::passes::Capacities;
use laguerre_core::site_tree::MadeTree;
use laguerre_core::{PassReport, PowerDiagram, Precision, Request, Result};
use opencl3::context::Context;
use opencl3::types::cl_device_id;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Whether numbers of cells from which on something is worth while are small, so that tests come to it.
pub(crate) const IN_TESTS: bool = cfg!(feature = "test-util");

/// Evaluations of all devices, and one.
static EVALUATIONS: AtomicU64 = AtomicU64::new(1);

/// A device that is open.
pub(crate) struct Device {
    id: cl_device_id,
    /// For messages.
    pub(crate) name: String,
    /// The work-items that compute a cell together, where they do.
    together: Option<Lanes>,
    /// That of the first stage, where cells are computed together.
    precision: Precision,
    /// Bytes of its memory.
    pub(crate) memory_size: u64,
    pub(crate) context: Arc<Handle<Context>>,
    pub(crate) queue: Queue,
    pub(crate) grid_kernels: GridKernels,
    octree_kernels: Later<OctreeKernels>,
    pub(crate) row_kernels: Later<RowKernels>,
    pub(crate) total_kernels: Later<TotalKernels>,
    pub(crate) algebra_kernels: Later<AlgebraKernels>,
    programs: Programs,
    pub(crate) memory: Memory,
    pub(crate) sites: Sites,
    pub(crate) shared: Shared,
    pub(crate) counters: Counters,
    /// How long it has computed in this call, from sites on the device to results on the device.
    pub(crate) seconds: f64,
    pub(crate) results: Results,
    /// Whether rows and records of facets are on the device, all of them.
    pub(crate) facets_are_kept: bool,
    pub(crate) facets: FacetMemory,
    pub(crate) laplacian: LaplacianMemory,
    octree: OctreeMemory,
    /// The number of the last evaluation, which no other device has.
    pub(crate) evaluation: u64,
    /// The Laplacian that is on the device.
    pub(crate) made: Option<MadeLaplacian>,
    pub(crate) answers: Answers,
    /// How long the last output's lists were.
    pub(crate) lengths: Lengths,
    /// The domain whose grid is on the device.
    domain: Option<Arc<DomainGrid>>,
    /// Cells of this call at most.
    most_cells: usize,
    /// Whether those that are left were given up by a sweep, or are tried once more.
    was_swept: bool,
    /// Cells that are swept at a time: fewer once the device had no memory for the records of more.
    swept_at_once: usize,
    /// What the first pass of the next call begins with, and for how many sites that was found.
    first: Option<(usize, Capacities)>,
}

// SAFETY: OpenCL objects may be used from any thread; a device is used by one at a time, being borrowed mutably.
unsafe impl Send for Device {}

rooms! {
    pub(crate) struct Memory {
        shells: [u8; 4] = "the table of offsets",
        domain_vertices: [f64; 3] = "the domain's vertices",
        triangles: [u32; 4] = "the domain's triangles",
        lowest_voxels: [u32; 3] = "the domain's grid",
        list_offsets: u32 = "the domain's grid",
        list_entries: u32 = "the domain's grid",
        windings: i32 = "the domain's grid",
        surface_table: u32 = "the domain's grid",
        clearances: u8 = "the domain's grid",
        abouts: [i32; 2] = "what is near each site",
        counters: Counters = "counters",
        /// The cells of a pass, where they are not a range, and those it could not end.
        todo: u32 = "a list of cells",
        surface: u32 = "a list of cells",
        later: u32 = "a list of cells",
        full: u32 = "a list of cells",
        left: u32 = "a list of cells",
        cut: u32 = "a list of cells",
        /// Where `full` stands aside while records take its place.
        aside: u32 = "a list of cells",
        /// Records of finished cells (`lanes_records.cl`).
        given: [u32; 4] = "finished cells",
        begun: [u32; 4] = "cells that have been begun",
        begun_places: u32 = "cells that have been begun",
        vast: u64 = "cells that need much room",
        leaders: u32 = "cells that others begin with",
        kept: u32 = "what bounds cells far off",
        pub(crate) outcome: u32 = "how cells ended",
        pub(crate) sums: f64 = "cells' sums",
        pub(crate) rows: [u64; 2] = "rows of facets",
        pub(crate) facets: FacetRecord = "facets",
        pub(crate) facet_moments: [f64; 3] = "facets",
        pub(crate) facet_seconds: FacetSecond = "facets",
        integrand: f64 = "the integrand",
    }
}

/// What a device did with its share of the cells.
pub(crate) struct Computed {
    pub(crate) passes: Vec<PassReport>,
    /// The caller's indices of the sites whose cells only the host can decide, and where there are any the tree that it searches, if the device has made it.
    pub(crate) for_host: Vec<u32>,
    pub(crate) tree: Option<MadeTree>,
}

impl Device {
    pub(crate) fn open(found: &Found, precision: Precision) -> Result<Self> {
        let id = found.id.0;
        let (context, queue) = platform::open(found)?;
        let grid_kernels = GridKernels::build(&context, id)?;
        // (On a CPU one work-item a cell is many times faster than sub-groups, which are loops there: BENCHMARKS.md.)
        let together = match found.info.is_gpu {
            true if found.has_warps() => Some(Lanes::Warp),
            true => lanes::sub_group(id, &context, &queue),
            false => None,
        };
        let mut memory = Memory::new();
        memory.shells.fill(&context, &queue, &shells::table())?;
        Ok(Self {
            id,
            name: found.info.name.clone(),
            together,
            precision,
            memory_size: found.info.memory,
            octree_kernels: Later::new(&context, id),
            row_kernels: Later::new(&context, id),
            total_kernels: Later::new(&context, id),
            algebra_kernels: Later::new(&context, id),
            context,
            queue,
            grid_kernels,
            programs: Programs::default(),
            memory,
            sites: Sites::new(),
            shared: Shared::new(),
            counters: Counters::default(),
            seconds: 0.0,
            results: Results::default(),
            facets_are_kept: false,
            facets: FacetMemory::new(),
            laplacian: LaplacianMemory::new(),
            octree: OctreeMemory::new(),
            evaluation: 0,
            made: None,
            answers: Answers::new(),
            lengths: Lengths::default(),
            domain: None,
            most_cells: 0,
            was_swept: false,
            swept_at_once: leaders::swept_at_first(found.info.memory),
            first: None,
        })
    }

    /// Whether several work-items compute a cell together.
    pub(crate) fn shares_cells(&self) -> bool {
        self.together.is_some()
    }

    /// Lets one work-item compute each cell from now on; whether sub-groups did before.
    pub(crate) fn leave_sub_groups(&mut self) -> bool {
        let leaves = matches!(self.together, Some(Lanes::SubGroup(_)));
        if leaves {
            self.together = None;
        }
        leaves
    }

    /// Lets one work-item compute a cell as several would; whether that is not how the device does it anyway.
    #[cfg(feature = "test-util")]
    pub(crate) fn share_cells(&mut self) -> bool {
        let is_other = self.together.is_none();
        self.together.get_or_insert(Lanes::One);
        is_other
    }

    /// Lets a sub-group compute a cell together; whether the device has any, and does not do so anyway.
    #[cfg(feature = "test-util")]
    pub(crate) fn share_in_sub_groups(&mut self) -> bool {
        let lanes = lanes::sub_group_as_written(self.id, &self.context, &self.queue);
        lanes.is_some() && std::mem::replace(&mut self.together, lanes).is_none()
    }

    /// Brings the sites of a diagram to the device.
    pub(crate) fn bring_sites(&mut self, diagram: &PowerDiagram) -> Result<()> {
        self.sites.given.bring(&self.context, &self.queue, diagram)
    }

    /// Begins an evaluation: brings the domain, if it is another one, to the device.
    pub(crate) fn load(
        &mut self,
        container: &FramedContainer,
        request: &Request,
        integrand: Option<&FramedIntegrand>,
    ) -> Result<()> {
        self.evaluation = EVALUATIONS.fetch_add(1, Ordering::Relaxed);
        self.made = None;
        self.shared.params = Params::new(container, request, integrand);
        self.shared.is_shared = self.lanes(request).is_some();
        self.shared.will_differ = self.shared.is_shared && request.weights_will_differ();
        let Self { context, queue, memory, shared, grid_kernels, .. } = self;
        memory.integrand.fill(context, queue, &integrand.map_or(Vec::new(), FramedIntegrand::table))?;
        let grid = container.shared_grid();
        let is_there = match (grid, &self.domain) {
            (Some(new), Some(old)) => Arc::ptr_eq(old, new),
            (None, None) => memory.clearances.is_made(),
            _ => false,
        };
        if is_there {
            return Ok(());
        }
        self.domain = None;
        // (The last of them that is made: without it none is believed to be there.)
        memory.clearances.free();
        memory.domain_vertices.fill(context, queue, grid.map_or(&[], |g| g.vertices()))?;
        memory.triangles.fill(context, queue, grid.map_or(&[], |g| g.triangles()))?;
        memory.lowest_voxels.fill(context, queue, grid.map_or(&[], |g| g.lowest_voxels()))?;
        memory.list_offsets.fill(context, queue, grid.map_or(&[], |g| g.offsets()))?;
        memory.list_entries.fill(context, queue, grid.map_or(&[], |g| g.entries()))?;
        memory.windings.fill(context, queue, grid.map_or(&[], |g| g.windings()))?;
        memory.surface_table.fill(context, queue, grid.map_or(&[], |g| g.surface_table()))?;
        let voxels = grid.map_or(0, |g| g.windings().len());
        memory.clearances.grow(context, voxels)?;
        if voxels > 0 {
            shared.send(context, queue)?;
            let arguments = MeasureClearances {
                params: &shared.room,
                surface_table: &memory.surface_table,
                count: voxels as u32,
                clearances: &memory.clearances,
            };
            grid_kernels.measure_clearances.run(queue, voxels, GROUP, arguments)?;
        }
        self.domain = grid.cloned();
        self.first = None;
        Ok(())
    }

    /// Puts the sites in order on the device, and says how many have a cell; `None` where the host has to, or where some may be out of range and
    /// `is_in_range` does not know better.
    pub(crate) fn sort(&mut self, is_in_range: &dyn Fn() -> Result<bool>) -> Result<Option<usize>> {
        let Self { context, queue, grid_kernels, sites, shared, .. } = self;
        queue.finish().map_err(|e| failed("copying sites to the device", e))?;
        let begin = Instant::now();
        let sorted = sites.sort(context, queue, grid_kernels, is_in_range, shared)?;
        queue.finish().map_err(|e| failed("sorting sites", e))?;
        self.seconds = begin.elapsed().as_secs_f64();
        Ok(sorted)
    }

    /// Takes the tree over the sites that the host made; returns how many have a cell.
    pub(crate) fn take(&mut self, prepared: &Prepared) -> Result<usize> {
        let Self { context, queue, sites, shared, .. } = self;
        sites.take(context, queue, prepared, shared)
    }
}
