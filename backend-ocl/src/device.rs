//! One device: its queue, its programs, its memory, and the batches it computes.

use crate::buffer::{Room, failed};
use crate::params::{self, Cluster, Facet, Params};
use crate::platform::Found as FoundDevice;
use crate::program::{MOST_PLANES, Programs};
use crate::shells;
use laguerre_core::assemble::{Assembler, CellRecord, FacetRecord};
use laguerre_core::cell::{self, CellSums, FacetSum, v3};
use laguerre_core::diagram::Prepared;
use laguerre_core::passes::Capacities;
use laguerre_core::{CellStatus, Domain, Request, Result};
use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::kernel::ExecuteKernel;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Work-items of a group. They share nothing; a multiple of what any GPU runs in step.
const GROUP: usize = 64;

/// `FACETS_FULL` of `evaluate.cl`.
const FACETS_FULL: u32 = 16;

/// Numbers that `evaluate.cl` writes for each cell (`FEW_SUMS`, `ALL_SUMS`).
const FEW_SUMS: usize = 4;
const ALL_SUMS: usize = 18;

/// Facets of a cell that a batch has room for, on average: a Voronoi cell of random sites has 15.5.
const FACETS_PER_CELL: usize = 18;

/// Cells of a batch at most, and the share of the device's memory that its results may take.
const MOST_CELLS: usize = 1 << 21;
const SHARE_OF_MEMORY: u64 = 8;

/// A device that is open.
pub(crate) struct Device {
    /// Bytes of its memory.
    memory_size: u64,
    context: Context,
    queue: CommandQueue,
    programs: Programs,
    memory: Memory,
    results: Results,
    /// The domain whose grid is on the device.
    domain: Option<Domain>,
}

struct Memory {
    params: Room<Params>,
    sites: Room<[f64; 4]>,
    voxels: Room<u32>,
    weights: Room<f64>,
    clusters: Room<Cluster>,
    roots: Room<u32>,
    shells: Room<[u8; 4]>,
    domain_vertices: Room<[f64; 3]>,
    triangles: Room<[u32; 3]>,
    lowest_voxels: Room<[u32; 3]>,
    list_offsets: Room<u32>,
    list_entries: Room<u32>,
    windings: Room<i32>,
    surface_table: Room<u32>,
    list: Room<u32>,
    outcome: Room<[u32; 2]>,
    sums: Room<f64>,
    facets: Room<Facet>,
    rows: Room<[u32; 2]>,
    facet_count: Room<u32>,
}

/// Results on the host, kept from batch to batch.
#[derive(Default)]
struct Results {
    outcomes: Vec<[u32; 2]>,
    sums: Vec<f64>,
    rows: Vec<[u32; 2]>,
    facet_count: Vec<u32>,
    facets: Vec<Facet>,
}

/// What one pass leaves to do, and what it took.
#[derive(Debug, Default)]
pub(crate) struct PassResult {
    /// Cells that did not fit.
    pub(crate) failed: Vec<u32>,
    /// Cells that only the host can decide.
    pub(crate) undecided: Vec<u32>,
    pub(crate) exact_cells: usize,
    pub(crate) visited: u32,
    /// Time that the kernels took.
    pub(crate) seconds: f64,
}

/// Cells of a batch that have to run again: without room for their facets, or on the surface.
#[derive(Default)]
struct Again {
    full: Vec<u32>,
    boundary: Vec<u32>,
}

impl Device {
    pub(crate) fn open(found: &FoundDevice) -> Result<Self> {
        let id = found.id.0;
        let device = opencl3::device::Device::new(id);
        let context = Context::from_device(&device).map_err(|e| failed("creating a context", e))?;
        // SAFETY: context and device are valid, and no properties are asked for that the device could lack.
        let queue = unsafe { CommandQueue::create(&context, id, 0) }.map_err(|e| failed("creating a queue", e))?;
        let mut device = Self {
            memory_size: found.info.memory,
            context,
            queue,
            programs: Programs::default(),
            memory: Memory::new(),
            results: Results::default(),
            domain: None,
        };
        let (context, queue) = (&device.context, &device.queue);
        device.memory.shells.fill(context, queue, &shells::table())?;
        Ok(device)
    }

    /// Brings the sites, and the domain if it is another one, to the device.
    pub(crate) fn load(&mut self, prepared: &Prepared, request: &Request, room: Capacities) -> Result<()> {
        self.probe(room, request.facets)?;
        let Self { context, queue, memory, .. } = self;
        let sites = &prepared.sites;
        memory.sites.fill(context, queue, sites.sites())?;
        memory.voxels.fill(context, queue, sites.offsets())?;
        let weights: Vec<f64> = sites.levels().iter().flat_map(|level| level.largest_weight.iter().copied()).collect();
        memory.weights.fill(context, queue, &weights)?;
        memory.clusters.fill(context, queue, &params::clusters(prepared))?;
        memory.roots.fill(context, queue, sites.roots())?;
        let domain = prepared.domain();
        if domain.is_some_and(|new| self.domain.as_ref().is_some_and(|old| old.is_same(new))) {
            return Ok(());
        }
        self.domain = None;
        let grid = domain.map(Domain::grid);
        memory.domain_vertices.fill(context, queue, grid.map_or(&[], |g| g.vertices()))?;
        memory.triangles.fill(context, queue, grid.map_or(&[], |g| g.triangles()))?;
        memory.lowest_voxels.fill(context, queue, grid.map_or(&[], |g| g.lowest_voxels()))?;
        memory.list_offsets.fill(context, queue, grid.map_or(&[], |g| g.offsets()))?;
        memory.list_entries.fill(context, queue, grid.map_or(&[], |g| g.entries()))?;
        memory.windings.fill(context, queue, grid.map_or(&[], |g| g.windings()))?;
        memory.surface_table.fill(context, queue, grid.map_or(&[], |g| g.surface_table()))?;
        self.domain = domain.cloned();
        Ok(())
    }

    /// Compares the device's layouts with the host's.
    fn probe(&mut self, room: Capacities, facets: bool) -> Result<()> {
        let Self { context, queue, memory, programs, .. } = self;
        memory.list.grow(context, params::PROBES)?;
        let kernels = programs.get(context, room, facets)?;
        // SAFETY: `probe` takes one buffer of `PROBES` numbers, and one work-item runs.
        unsafe {
            ExecuteKernel::new(&kernels.probe)
                .set_arg(memory.list.get()?)
                .set_global_work_size(1)
                .enqueue_nd_range(queue)
        }
        .map_err(|e| failed("running probe", e))?;
        let mut probed = Vec::new();
        memory.list.read(queue, params::PROBES, &mut probed)?;
        params::check_layouts(&probed)
    }

    /// Computes cells (sorted sites) with the given room, batch by batch; in two substeps if `substeps` (paper, Alg. 1): first all, then
    /// those that turn out to meet the surface.
    pub(crate) fn compute(
        &mut self,
        prepared: &Prepared,
        request: &Request,
        room: Capacities,
        list: &[u32],
        substeps: bool,
        assembler: &Mutex<Assembler<'_>>,
    ) -> Result<PassResult> {
        let mut result = PassResult::default();
        let mut params = Params::new(prepared, request);
        let batch = self.cells_per_batch(request);
        for cells in list.chunks(batch) {
            if request.facets {
                params.facet_room = (cells.len() * FACETS_PER_CELL).max(MOST_PLANES as usize) as u32;
            }
            let mut now = cells.to_vec();
            let mut again = Again::default();
            let mut interior_only = substeps && prepared.domain_grid().is_some();
            while !now.is_empty() {
                result.seconds += self.run(&params, request, room, &now, interior_only)?;
                self.collect(request, &now, assembler, &mut result, &mut again)?;
                now = std::mem::take(&mut again.full);
                if now.is_empty() {
                    now = std::mem::take(&mut again.boundary);
                    interior_only = false;
                }
            }
            request.progress.advance(cells.len());
        }
        Ok(result)
    }

    fn cells_per_batch(&self, request: &Request) -> usize {
        let sums = if cell::flags_of(request) == 0 { FEW_SUMS } else { ALL_SUMS };
        let facets = if request.facets { FACETS_PER_CELL * size_of::<Facet>() + 8 } else { 0 };
        let bytes = 12 + 8 * sums + facets;
        ((self.memory_size / SHARE_OF_MEMORY) as usize / bytes).clamp(1024, MOST_CELLS)
    }

    fn run(
        &mut self,
        params: &Params,
        request: &Request,
        room: Capacities,
        cells: &[u32],
        interior: bool,
    ) -> Result<f64> {
        let Self { context, queue, memory, programs, .. } = self;
        let sums = if cell::flags_of(request) == 0 { FEW_SUMS } else { ALL_SUMS };
        let n = cells.len();
        memory.params.fill(context, queue, &[*params])?;
        memory.list.fill(context, queue, cells)?;
        memory.outcome.grow(context, n)?;
        memory.sums.grow(context, n * sums)?;
        memory.facets.grow(context, params.facet_room as usize)?;
        memory.rows.grow(context, n)?;
        memory.facet_count.fill(context, queue, &[0])?;
        let kernels = programs.get(context, room, request.facets)?;
        queue.finish().map_err(|e| failed("preparing cells", e))?;
        let begin = Instant::now();
        // SAFETY: the arguments are those of `cells` in `evaluate.cl`, in its order; every buffer is as long as the kernel takes it
        // to be: `n` cells, their sums, `facet_room` facets, and the grids as `load` left them.
        unsafe {
            ExecuteKernel::new(&kernels.cells)
                .set_arg(memory.params.get()?)
                .set_arg(memory.sites.get()?)
                .set_arg(memory.voxels.get()?)
                .set_arg(memory.weights.get()?)
                .set_arg(memory.clusters.get()?)
                .set_arg(memory.roots.get()?)
                .set_arg(memory.shells.get()?)
                .set_arg(memory.domain_vertices.get()?)
                .set_arg(memory.triangles.get()?)
                .set_arg(memory.lowest_voxels.get()?)
                .set_arg(memory.list_offsets.get()?)
                .set_arg(memory.list_entries.get()?)
                .set_arg(memory.windings.get()?)
                .set_arg(memory.surface_table.get()?)
                .set_arg(memory.list.get()?)
                .set_arg(&(n as u32))
                .set_arg(&u32::from(interior))
                .set_arg(memory.outcome.get()?)
                .set_arg(memory.sums.get()?)
                .set_arg(memory.facets.get()?)
                .set_arg(memory.rows.get()?)
                .set_arg(memory.facet_count.get()?)
                .set_global_work_size(n.next_multiple_of(GROUP))
                .set_local_work_size(GROUP)
                .enqueue_nd_range(queue)
        }
        .map_err(|e| failed("running cells", e))?;
        queue.finish().map_err(|e| failed("running cells", e))?;
        Ok(begin.elapsed().as_secs_f64())
    }

    /// Reads the results of a run and hands them to the assembler.
    fn collect(
        &mut self,
        request: &Request,
        cells: &[u32],
        assembler: &Mutex<Assembler<'_>>,
        pass: &mut PassResult,
        again: &mut Again,
    ) -> Result<()> {
        let Self { queue, memory, results, .. } = self;
        let width = if cell::flags_of(request) == 0 { FEW_SUMS } else { ALL_SUMS };
        memory.outcome.read(queue, cells.len(), &mut results.outcomes)?;
        memory.sums.read(queue, cells.len() * width, &mut results.sums)?;
        if request.facets {
            memory.rows.read(queue, cells.len(), &mut results.rows)?;
            memory.facet_count.read(queue, 1, &mut results.facet_count)?;
            memory.facets.read(queue, results.facet_count[0] as usize, &mut results.facets)?;
        }
        let mut assembler = assembler.lock().unwrap_or_else(PoisonError::into_inner);
        let mut records = Vec::new();
        for (i, (&site, &[outcome, visited])) in cells.iter().zip(&results.outcomes).enumerate() {
            let status = match outcome & 0xff {
                cell::COMPLETE if outcome >> 9 & 1 != 0 => CellStatus::Uncertified,
                cell::COMPLETE => CellStatus::Complete,
                cell::EMPTY => CellStatus::Empty,
                other => {
                    match other {
                        cell::BOUNDARY => again.boundary.push(site),
                        FACETS_FULL => again.full.push(site),
                        cell::P_FULL | cell::V_FULL => pass.failed.push(site),
                        _ => pass.undecided.push(site),
                    }
                    continue;
                }
            };
            pass.exact_cells += (outcome >> 8 & 1) as usize;
            pass.visited = pass.visited.max(visited);
            if status == CellStatus::Empty {
                // What is not added is empty.
                continue;
            }
            records.clear();
            if request.facets {
                let [begin, count] = results.rows[i].map(|n| n as usize);
                records.extend(results.facets[begin..begin + count].iter().map(record_of));
            }
            let sums = sums_of(&results.sums[i * width..][..width]);
            assembler.add(&CellRecord { site, status, sums }, &records);
        }
        Ok(())
    }
}

fn sums_of(numbers: &[f64]) -> CellSums {
    let vector = |at: usize| v3(numbers[at], numbers[at + 1], numbers[at + 2]);
    let few = CellSums { volume: numbers[0], first: vector(1), ..CellSums::default() };
    if numbers.len() == FEW_SUMS {
        return few;
    }
    CellSums {
        second_diagonal: vector(4),
        second_mixed: vector(7),
        boundary_area: numbers[10],
        boundary_moment: vector(11),
        boundary_vector: vector(14),
        boundary_flux: numbers[17],
        ..few
    }
}

fn record_of(facet: &Facet) -> FacetRecord {
    let [x, y, z] = facet.moment;
    // What is below its bound was left out on the device.
    FacetRecord { neighbor: facet.neighbor, sum: FacetSum { area: facet.area, moment: v3(x, y, z), rounding: 0.0 } }
}

impl Memory {
    const fn new() -> Self {
        Self {
            params: Room::new("parameters"),
            sites: Room::new("sites"),
            voxels: Room::new("the site grid"),
            weights: Room::new("the pyramid"),
            clusters: Room::new("the trees of crowded voxels"),
            roots: Room::new("the trees of crowded voxels"),
            shells: Room::new("the table of offsets"),
            domain_vertices: Room::new("the domain's vertices"),
            triangles: Room::new("the domain's triangles"),
            lowest_voxels: Room::new("the domain's grid"),
            list_offsets: Room::new("the domain's grid"),
            list_entries: Room::new("the domain's grid"),
            windings: Room::new("the domain's grid"),
            surface_table: Room::new("the domain's grid"),
            list: Room::new("a batch of cells"),
            outcome: Room::new("a batch of cells"),
            sums: Room::new("a batch of cells"),
            facets: Room::new("a batch's facets"),
            rows: Room::new("a batch's facets"),
            facet_count: Room::new("a batch's facets"),
        }
    }
}
