//! The backend: the passes of the scheduler over all devices, and what they leave to the host.

use crate::device::{Device, PassResult};
use crate::fallback;
use crate::platform::choose;
use crate::program::MOST_PLANES;
use laguerre_core::assemble::Assembler;
use laguerre_core::passes::{Capacities, PassOutcome, run_passes};
use laguerre_core::{Backend, BackendInfo, DeviceChoice, Error, ErrorKind, Output, PowerDiagram, Request, Result};
use std::sync::{Mutex, PoisonError};

/// Room of the first pass: half-spaces and vertices of nearly every cell of random sites, with its four cone planes.
const FIRST: Capacities = Capacities { planes: 64, vertices: 128 };

/// Sites per voxel: the smaller the voxels, the more nearly sites come nearest first, and the more voxels are looked at (measured: see
/// BENCHMARKS.md).
const SITES_PER_VOXEL: f64 = 2.0;

/// The OpenCL backend.
pub struct Ocl {
    name: String,
    devices: Mutex<Vec<Device>>,
}

impl Ocl {
    /// Opens devices.
    ///
    /// # Errors
    /// `Unavailable` where there is no OpenCL, no device, or not the one asked for; `Device` where it fails.
    pub fn new(choice: &DeviceChoice) -> Result<Self> {
        let chosen = choose(choice)?;
        let names: Vec<&str> = chosen.iter().map(|device| device.info.name.as_str()).collect();
        let name = names.join(", ");
        let devices = chosen.iter().map(Device::open).collect::<Result<Vec<_>>>()?;
        Ok(Self { name, devices: Mutex::new(devices) })
    }
}

impl Backend for Ocl {
    fn info(&self) -> BackendInfo {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        BackendInfo { backend: "ocl", device: self.name.clone(), precision: "f64", threads }
    }

    fn evaluate(&self, diagram: &PowerDiagram, request: &Request) -> Result<Output> {
        let prepared = diagram.prepare_with(SITES_PER_VOXEL)?;
        let mut devices = self.devices.lock().unwrap_or_else(PoisonError::into_inner);
        for device in devices.iter_mut() {
            device.load(&prepared, request, FIRST)?;
        }
        let assembler = Mutex::new(Assembler::new(&prepared, request));
        let (mut output_exact, mut device_seconds) = (0, 0.0);
        let mut for_host = Vec::new();
        let all = (0..prepared.sites.len() as u32).collect();
        let passes = run_passes(FIRST, all, |room, cells| -> Result<PassOutcome> {
            let mut outcome = PassOutcome::default();
            if room.planes > MOST_PLANES {
                for_host.extend_from_slice(cells);
                return Ok(outcome);
            }
            let substeps = room == FIRST;
            let compute = |device: &mut Device, cells: &[u32]| {
                device.compute(&prepared, request, room, cells, substeps, &assembler)
            };
            let mut longest = 0.0_f64;
            for result in on_all(&mut devices, cells, &compute)? {
                longest = longest.max(result.seconds);
                outcome.failed.extend(result.failed);
                outcome.neighbors = outcome.neighbors.max(result.visited);
                output_exact += result.exact_cells;
                for_host.extend(result.undecided);
            }
            device_seconds += longest;
            Ok(outcome)
        })?;
        let mut assembler = assembler.into_inner().unwrap_or_else(PoisonError::into_inner);
        for (cell, facets) in fallback::compute(&prepared, request, &for_host)? {
            assembler.add(&cell, &facets);
        }
        let mut output = assembler.finish();
        output.exact_cells = output_exact + for_host.len();
        output.device_seconds = device_seconds;
        output.host_cells = for_host.len();
        output.passes = passes;
        Ok(output)
    }
}

/// Splits `cells` over the devices along the grid's order, each on a thread of its own; the results in order.
fn on_all(
    devices: &mut [Device],
    cells: &[u32],
    compute: &(dyn Fn(&mut Device, &[u32]) -> Result<PassResult> + Sync),
) -> Result<Vec<PassResult>> {
    let share = cells.len().div_ceil(devices.len()).max(1);
    if let [device] = devices {
        return Ok(vec![compute(device, cells)?]);
    }
    std::thread::scope(|scope| {
        let running: Vec<_> = devices
            .iter_mut()
            .zip(cells.chunks(share))
            .map(|(device, cells)| scope.spawn(move || compute(device, cells)))
            .collect();
        let joined = running.into_iter().map(|thread| {
            thread.join().unwrap_or_else(|_| Err(Error::new(ErrorKind::Device, "a device's thread ended early")))
        });
        joined.collect()
    })
}
