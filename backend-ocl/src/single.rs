//! The backend in single precision: for devices that have no other, or have little of it. On the device the cells whose rounding provably
//! does not matter (`single.cl`), on the host all others, in double precision.

mod scene;

use crate::believed::check_volumes;
use crate::buffer::{failed, rooms};
use crate::builds::Build;
use crate::devices::{Devices, on_all, on_device};
use crate::evaluate::{join_passes, shares};
use crate::fallback;
use crate::handle::Handle;
use crate::interface::single::{Boxes, OUTCOME_EXACT, OUTCOME_STATUS, Params, SingleCells, Slabs, WeightBounds};
use crate::launch::Kernel;
use crate::platform::{self, Found, choose};
use crate::program::compile;
use crate::queue::Queue;
use laguerre_core::assemble::Assembler;
use laguerre_core::cell::{self, v3};
use laguerre_core::diagram::Prepared;
use laguerre_core::domain_grid::DomainGrid;
use laguerre_core::geometry;
use laguerre_core::passes::{Capacities, PassOutcome, run_passes};
use laguerre_core::{
    Backend, BackendInfo, Capabilities, CellStatus, DeviceChoice, Error, Observer, Output, PassReport, PowerDiagram,
    Precision, Report, Request, Result, Watched,
};
use opencl3::context::Context;
use opencl3::types::cl_device_id;
use scene::Scene;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// Half-spaces of the last pass: what needs more is the host's.
const MOST_PLANES: u32 = 144;

/// Cells that are computed at once, and work-items of a group.
const BATCH: usize = 1 << 20;
const GROUP: usize = 64;

/// OpenCL devices that compute in single precision.
pub(crate) struct Single {
    name: String,
    devices: Devices<Device>,
}

struct Device {
    id: cl_device_id,
    name: String,
    context: Arc<Handle<Context>>,
    queue: Queue,
    kernels: HashMap<Capacities, (Kernel<SingleCells<'static>>, usize)>,
    memory: Memory,
    /// The domain's grid whose tables are on the device.
    domain: Option<Arc<DomainGrid>>,
    seconds: f64,
}

// SAFETY: OpenCL objects may be used from any thread; a device is used by one at a time, being borrowed mutably.
unsafe impl Send for Device {}

rooms! {
    struct Memory {
        params: Params = "parameters",
        sites: [f32; 4] = "sorted sites",
        rests: [f32; 4] = "sorted sites",
        boxes: Boxes = "the tree over the sites",
        slabs: Slabs = "the tree over the sites",
        weight_bounds: WeightBounds = "the tree over the sites",
        windings: i32 = "the domain's grid",
        surface_table: u32 = "the domain's grid",
        list: u32 = "a list of cells",
        outcome: u32 = "how cells ended",
        sums: [f32; 4] = "cells' sums",
        visited: u32 = "counters",
    }
}

/// What a device did with its share of the cells.
struct Computed {
    passes: Vec<PassReport>,
    /// Sorted sites, how their cells ended, volume and first moment in the unit of the scene.
    cells: Vec<(u32, CellStatus, [f32; 4])>,
    /// Cells that plain floating point did not suffice for.
    exact_cells: usize,
    /// Sorted sites whose cells are the host's.
    for_host: Vec<u32>,
    seconds: f64,
}

impl Single {
    /// Opens devices.
    ///
    /// # Errors
    /// `Unavailable` where there is no OpenCL, no device, or not the one asked for; `Device` where it fails.
    pub(crate) fn new(choice: &DeviceChoice) -> Result<Self> {
        let chosen = choose(choice, Precision::F32)?;
        let names: Vec<&str> = chosen.iter().map(|device| device.info.name.as_str()).collect();
        let name = names.join(", ");
        let open = |found| Device::open(found).map_err(|error| on_device(error, &found.info.name));
        let devices = Devices::new(chosen.iter().map(open).collect::<Result<Vec<_>>>()?)?;
        Ok(Self { name, devices })
    }
}

impl Backend for Single {
    fn info(&self) -> BackendInfo {
        BackendInfo::of_devices("ocl", self.name.clone(), Precision::F32).with(Capabilities::MOMENTS)
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        Capabilities::MOMENTS.check(request, diagram)?;
        self.devices.with(|devices| self.compute(diagram, &Watched::new(request, observer), devices))
    }
}

impl Single {
    fn compute(&self, diagram: &PowerDiagram, request: &Watched<'_>, devices: &mut [Device]) -> Result<Output> {
        let prepared = diagram.prepare()?;
        let scene = Scene::new(&prepared);
        let shares = shares(prepared.sites.len(), devices.len());
        let computed = on_all(devices, |device| &device.name, &|i, device| {
            device.compute(&prepared, &scene, request, shares[i].clone())
        })?;

        let order = prepared.sites.order();
        let mut cells = vec![None; diagram.positions().len()];
        let mut for_host = Vec::new();
        let (mut exact_cells, mut passes, mut device_seconds) = (0, Vec::new(), 0.0_f64);
        for device in &computed {
            for (site, status, sums) in &device.cells {
                cells[order[*site as usize] as usize] = Some((*status, *sums));
            }
            for_host.extend(device.for_host.iter().map(|&site| order[site as usize]));
            exact_cells += device.exact_cells;
            join_passes(&mut passes, &device.passes);
            device_seconds = device_seconds.max(device.seconds);
        }
        let mut assembler = Assembler::new(diagram, &prepared.container, request);
        let volume = scene.unit.powi(3);
        assembler.add_all(|i, sums| {
            let (status, [v, x, y, z]) = cells[i]?;
            let [v, x, y, z] = [v, x, y, z].map(|number| f64::from(number) * volume);
            (sums.volume, sums.first) = (v, v3(x * scene.unit, y * scene.unit, z * scene.unit));
            Some(status)
        });
        // Everything is proved here, so that nothing is left of `epsilon`.
        let proved = Request::clone(request).without_epsilon();
        if !for_host.is_empty() {
            fallback::compute(&prepared, &request.of(&proved), &for_host, &mut assembler)?;
        }
        let report = Report::of_devices(exact_cells, for_host.len(), device_seconds, passes);
        let geometry = geometry::on_host(diagram, &request.of(&proved), assembler.status())?;
        let output = assembler.finish(&[], report, geometry)?;
        check_volumes(diagram, &output, Precision::F32, &self.name)?;
        Ok(output)
    }
}

impl Device {
    fn open(found: &Found) -> Result<Self> {
        let (context, queue) = platform::open(found)?;
        Ok(Self {
            id: found.id.0,
            name: found.info.name.clone(),
            context,
            queue,
            kernels: HashMap::new(),
            memory: Memory::new(),
            domain: None,
            seconds: 0.0,
        })
    }

    /// Computes the cells of a range of the sorted sites.
    fn compute(
        &mut self,
        prepared: &Prepared,
        scene: &Scene,
        request: &Watched<'_>,
        share: Range<usize>,
    ) -> Result<Computed> {
        let mut computed =
            Computed { passes: Vec::new(), cells: Vec::new(), exact_cells: 0, for_host: Vec::new(), seconds: 0.0 };
        let all: Vec<u32> = share.map(|site| site as u32).collect();
        self.load(prepared, scene)?;
        self.seconds = 0.0;
        let grow = |room: Capacities, _| room.grown();
        let passes = run_passes(Capacities::FIRST, all, grow, |room, cells: &Vec<u32>| {
            if room.planes > MOST_PLANES {
                computed.for_host.extend_from_slice(cells);
                computed.exact_cells += cells.len();
                return Ok(PassOutcome::default());
            }
            let before = self.seconds;
            let mut outcome = PassOutcome::default();
            for batch in cells.chunks(BATCH) {
                self.run(request, room, batch, &mut outcome, &mut computed)?;
            }
            outcome.device_seconds = self.seconds - before;
            Ok::<_, Error>(outcome)
        })?;
        computed.passes = passes;
        computed.seconds = self.seconds;
        Ok(computed)
    }

    /// Brings the sites, and the domain if it is another one, to the device.
    fn load(&mut self, prepared: &Prepared, scene: &Scene) -> Result<()> {
        let Self { context, queue, memory, .. } = self;
        memory.params.fill(context, queue, &[scene.params])?;
        memory.sites.fill(context, queue, &scene.sites)?;
        memory.rests.fill(context, queue, &scene.rests)?;
        memory.boxes.fill(context, queue, &scene.boxes)?;
        memory.slabs.fill(context, queue, &scene.slabs)?;
        memory.weight_bounds.fill(context, queue, &scene.weight_bounds)?;
        let grid = prepared.container.shared_grid();
        if grid.is_some_and(|new| self.domain.as_ref().is_some_and(|old| Arc::ptr_eq(old, new))) {
            return Ok(());
        }
        self.domain = None;
        memory.windings.fill(context, queue, grid.map_or(&[], |g| g.windings()))?;
        memory.surface_table.fill(context, queue, grid.map_or(&[], |g| g.surface_table()))?;
        self.domain = grid.cloned();
        Ok(())
    }

    /// Computes the cells of some sorted sites.
    fn run(
        &mut self,
        request: &Watched<'_>,
        room: Capacities,
        sites: &[u32],
        pass: &mut PassOutcome,
        computed: &mut Computed,
    ) -> Result<()> {
        let Self { context, queue, memory, kernels, id, .. } = self;
        let (kernel, group) = match kernels.entry(room) {
            Entry::Occupied(built) => built.into_mut(),
            Entry::Vacant(place) => place.insert(build(context, *id, room)?),
        };
        memory.list.fill(context, queue, sites)?;
        memory.outcome.grow(context, sites.len())?;
        memory.sums.grow(context, sites.len())?;
        memory.visited.fill(context, queue, &[pass.neighbors])?;
        queue.finish().map_err(|e| failed("copying sites to the device", e))?;
        let begin = Instant::now();
        let arguments = SingleCells {
            params: &memory.params,
            sites: &memory.sites,
            rests: &memory.rests,
            boxes: &memory.boxes,
            slabs: &memory.slabs,
            weight_bounds: &memory.weight_bounds,
            windings: &memory.windings,
            surface_table: &memory.surface_table,
            list: &memory.list,
            count: sites.len() as u32,
            outcome: &memory.outcome,
            sums: &memory.sums,
            most_visited: &memory.visited,
        };
        kernel.run(queue, sites.len(), *group, arguments)?;
        let (mut visited, mut outcomes, mut sums) = (Vec::new(), Vec::new(), Vec::new());
        memory.visited.read(queue, 1, &mut visited)?;
        self.seconds += begin.elapsed().as_secs_f64();
        pass.neighbors = visited[0];
        memory.outcome.read(queue, sites.len(), &mut outcomes)?;
        memory.sums.read(queue, sites.len(), &mut sums)?;
        let mut done = 0;
        for ((&site, &outcome), &sums) in sites.iter().zip(&outcomes).zip(&sums) {
            let status = match outcome & OUTCOME_STATUS {
                cell::COMPLETE => CellStatus::Complete,
                cell::EMPTY => CellStatus::Empty,
                cell::P_FULL | cell::V_FULL => {
                    pass.failed.push(site);
                    continue;
                }
                other => {
                    computed.for_host.push(site);
                    // At the surface the host needs no more than it always does.
                    computed.exact_cells += usize::from(other != cell::BOUNDARY);
                    continue;
                }
            };
            done += 1;
            computed.exact_cells += usize::from(outcome & OUTCOME_EXACT != 0);
            computed.cells.push((site, status, sums));
        }
        request.advance(done)?;
        Ok(())
    }
}

/// The kernel with the given room, and how many work-items it has in a group.
fn build(context: &Context, device: cl_device_id, room: Capacities) -> Result<(Kernel<SingleCells<'static>>, usize)> {
    let program = compile(context, device, Build::Single(room))?;
    let kernel = Kernel::new(&program)?;
    let group = GROUP.min(kernel.largest_group(device)?);
    Ok((kernel, group))
}
