//! Sites that stay on the device with what comes of their cells, for a loop that asks for a few sums and lets each site move to the barycenter of its cell.

use crate::believed::is_near;
use crate::buffer::Room;
use crate::device::Device;
use crate::evaluate::Ocl;
use crate::grid::{GROUP, Given};
use crate::interface::data::{SUM_EACH, TOTALS};
use crate::interface::kernels::{MoveSites, SumCells};
use laguerre_core::assemble::Assembler;
use laguerre_core::diagram::FramedContainer;
use laguerre_core::session::{Resident, Totals};
use laguerre_core::summation::Sum;
use laguerre_core::{Capabilities, Observer, Output, PassReport, PowerDiagram, Report, Request, Result, Watched};
use std::mem;

/// Cells that one group adds up.
const SUMMED: usize = GROUP * SUM_EACH as usize;

/// They, in memory of their own: whoever evaluates another diagram by the same backend meanwhile takes but the place of the results.
pub(crate) struct Stay<'a> {
    backend: &'a Ocl,
    request: Request,
    observer: &'a dyn Observer,
    /// What the cells are cut by, and its volume in the caller's lengths.
    container: Option<(FramedContainer, f64)>,
    given: Given,
    /// Where the sites were before they moved.
    before: Room<[f64; 3]>,
    /// The evaluations of the sites here, and there.
    found: Option<Found>,
    found_before: Option<Found>,
}

/// An evaluation.
struct Found {
    /// Its number: its results are on the device while that had no other.
    evaluation: u64,
    passes: Vec<PassReport>,
    seconds: f64,
    totals: Totals,
}

impl<'a> Stay<'a> {
    /// Room for them where one device does all that is asked for.
    pub(crate) fn new(backend: &'a Ocl, request: &Request, observer: &'a dyn Observer) -> Option<Self> {
        let is_one = backend.devices.lock().len() == 1;
        let is_plain = !request.needs_facets() && !request.geometry() && request.integral().is_none();
        (is_one && is_plain).then(|| Self {
            backend,
            request: request.clone(),
            observer,
            container: None,
            given: Given::new(),
            before: Room::new("sites"),
            found: None,
            found_before: None,
        })
    }

    /// Evaluates; `None` as [`Resident::evaluate`].
    fn run(&mut self, device: &mut Device, observer: &dyn Observer) -> Result<Option<Found>> {
        let Some((container, volume)) = &self.container else { return Ok(None) };
        let request = Watched::new(&self.request, observer);
        let count = self.given.count;
        mem::swap(&mut device.sites.given, &mut self.given);
        let found = device.compute_all(container, &request, count);
        mem::swap(&mut device.sites.given, &mut self.given);
        let Some(mut found) = found? else { return Ok(None) };
        found.totals = found.totals.in_units(container.density, container.frame.unit());
        let Totals { volume: sum, size, .. } = found.totals;
        let is_believed = self.request.epsilon().is_some() || is_near(sum, size, *volume, self.backend.precision);
        Ok(is_believed.then_some(found))
    }

    /// Whether the results of the sites as they stand are on the device, where they may have to be brought about once more.
    fn has_results(&mut self, device: &mut Device) -> Result<bool> {
        match &self.found {
            None => return Ok(false),
            Some(found) if found.evaluation == device.evaluation => return Ok(true),
            Some(_) => self.found = self.run(device, &())?,
        }
        Ok(self.found.is_some())
    }
}

impl Resident for Stay<'_> {
    fn set_sites(&mut self, diagram: &PowerDiagram) -> Result<()> {
        Capabilities::OF_DEVICES.check(&self.request, diagram)?;
        (self.found, self.found_before) = (None, None);
        self.container = Some((diagram.framed_container()?, diagram.container()?.volume()));
        self.backend.on_first_with_threads(|device| self.given.bring(&device.context, &device.queue, diagram))
    }

    fn evaluate(&mut self) -> Result<Option<Totals>> {
        self.found = None;
        self.found = self.backend.on_first_with_threads(|device| self.run(device, self.observer))?;
        Ok(self.found.as_ref().map(|found| found.totals))
    }

    fn move_to_barycenters(&mut self) -> Result<bool> {
        self.backend.on_first_with_threads(|device| {
            let count = self.given.count;
            if !self.has_results(device)? || !self.before.grow_if_possible(&device.context, count)? {
                return Ok(false);
            }
            device.move_sites(count, &self.given.positions, &self.before)?;
            mem::swap(&mut self.given.positions, &mut self.before);
            self.given.move_away();
            self.found_before = self.found.take();
            Ok(true)
        })
    }

    fn step_back(&mut self) {
        mem::swap(&mut self.given.positions, &mut self.before);
        self.given.move_away();
        self.found = self.found_before.take();
    }

    fn positions(&self) -> Result<Vec<[f64; 3]>> {
        let mut positions = Vec::new();
        self.backend.on_first_with_threads(|device| {
            self.given.positions.read(&device.queue, self.given.count, &mut positions)
        })?;
        Ok(positions)
    }

    fn read(&mut self, diagram: &PowerDiagram) -> Result<Option<Output>> {
        self.backend.on_first_with_threads(|device| {
            if !self.has_results(device)? {
                return Ok(None);
            }
            let (Some((container, _)), Some(found)) = (&self.container, &self.found) else { return Ok(None) };
            device.read_results(&self.request, self.given.count)?;
            let mut assembler = Assembler::new(diagram, container, &self.request);
            device.results.assemble(&mut assembler);
            let exact_cells = device.results.exact_cells();
            let report = Report::of_devices(exact_cells, 0, found.seconds, found.passes.clone());
            assembler.finish(&[], report, None).map(Some)
        })
    }
}

impl Device {
    /// Evaluates the cells of the sites that are there, and gives sums in the frame's lengths; `None` where the host has to do some of it.
    fn compute_all(
        &mut self,
        container: &FramedContainer,
        request: &Watched<'_>,
        sites: usize,
    ) -> Result<Option<Found>> {
        self.load(container, request, None)?;
        let Some(count) = self.sort(&|| Ok(false))? else { return Ok(None) };
        let computed = self.compute(request, sites, 0..count, 1)?;
        if !computed.for_host.is_empty() {
            return Ok(None);
        }
        let (passes, seconds, totals) = (computed.passes, self.seconds, self.sum_cells(request, sites)?);
        Ok(Some(Found { evaluation: self.evaluation, passes, seconds, totals }))
    }

    fn sum_cells(&mut self, request: &Request, count: usize) -> Result<Totals> {
        let Self { context, queue, total_kernels, memory, sites, shared, answers, .. } = self;
        let groups = count.div_ceil(SUMMED);
        let width = 2 * TOTALS as usize;
        answers.parts.grow(context, groups * width)?;
        let arguments = SumCells {
            params: &shared.room,
            count: count as u32,
            placed: &sites.placed,
            outcome: &memory.outcome,
            sums: &memory.sums,
            parts: &answers.parts,
        };
        total_kernels.get()?.sum_cells.run(queue, groups * GROUP, GROUP, arguments)?;
        answers.parts.read(queue, groups * width, &mut answers.sums)?;
        let mut all = [Sum::default(); TOTALS as usize];
        for part in answers.sums.chunks(width) {
            let each = part.chunks(2).map(|pair| Sum::of_parts(pair[0], pair[1]));
            all.iter_mut().zip(each).for_each(|(sum, part)| sum.join(part));
        }
        let [cells, uncertified, volume, negative, squares, energy, displacement] = all.map(|sum| sum.total());
        let energy = if request.second_moments() { energy } else { f64::NAN };
        let size = volume - 2.0 * negative;
        let mean = volume / count as f64;
        let displacement = (displacement / size).sqrt();
        let spread = (squares / count as f64 / (mean * mean) - 1.0).max(0.0).sqrt();
        let (cells, uncertified) = (cells as usize, uncertified as usize);
        Ok(Totals::new([cells, count - cells, uncertified], [volume, size, spread, energy, displacement]))
    }

    fn move_sites(&self, count: usize, positions: &Room<[f64; 3]>, moved: &Room<[f64; 3]>) -> Result<()> {
        let Self { queue, total_kernels, memory, sites, shared, .. } = self;
        let arguments = MoveSites {
            params: &shared.room,
            count: count as u32,
            placed: &sites.placed,
            outcome: &memory.outcome,
            sums: &memory.sums,
            positions,
            moved,
        };
        total_kernels.get()?.move_sites.run(queue, count, GROUP, arguments)
    }
}
