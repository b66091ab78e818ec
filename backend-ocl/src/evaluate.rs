//! The backend: the passes of the scheduler over all devices, and what they leave to the host.

use crate::device::{Device, Found};
use crate::platform::{DeviceChoice, choose};
use crate::program::MOST_PLANES;
use crate::{fallback, platform};
use laguerre_core::assemble::Assembler;
use laguerre_core::passes::{Capacities, PassOutcome, run_passes};
use laguerre_core::{Backend, BackendInfo, Error, ErrorKind, Output, PowerDiagram, Request, Result};
use std::sync::{Mutex, PoisonError};

/// Room of the first pass: half-spaces and vertices of nearly every cell of random sites, with its four cone planes.
const FIRST: Capacities = Capacities { planes: 64, vertices: 128 };

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
        let names: Vec<String> = chosen.iter().map(|d: &platform::DeviceInfo| d.name.clone()).collect();
        let devices = chosen.into_iter().map(Device::open).collect::<Result<Vec<_>>>()?;
        Ok(Self { name: names.join(", "), devices: Mutex::new(devices) })
    }
}

impl Backend for Ocl {
    fn info(&self) -> BackendInfo {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        BackendInfo { backend: "ocl", device: self.name.clone(), precision: "f64", threads }
    }

    fn evaluate(&self, diagram: &PowerDiagram, request: &Request) -> Result<Output> {
        let start = std::time::Instant::now();
        let trace = |what: &str| {
            if std::env::var_os("TRACE").is_some() {
                eprintln!("{what} {:.3}", start.elapsed().as_secs_f64())
            }
        };
        let prepared = diagram.prepare()?;
        trace("prepared");
        let mut devices = self.devices.lock().unwrap_or_else(PoisonError::into_inner);
        for device in devices.iter_mut() {
            device.load(&prepared, request, FIRST)?;
        }
        trace("loaded");
        let mut assembler = Assembler::new(&prepared, request);
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
            let compute =
                |device: &mut Device, cells: &[u32]| device.compute(&prepared, request, room, cells, substeps);
            let mut longest = 0.0_f64;
            for found in on_all(&mut devices, cells, &compute)? {
                longest = longest.max(found.seconds);
                for (cell, &[begin, count]) in found.cells.iter().zip(&found.rows) {
                    assembler.add(cell, &found.facets[begin..begin + count]);
                }
                outcome.failed.extend(found.failed);
                outcome.neighbors = outcome.neighbors.max(found.visited);
                output_exact += found.exact_cells;
                for_host.extend(found.undecided);
            }
            device_seconds += longest;
            Ok(outcome)
        })?;
        trace("computed");
        for (cell, facets) in fallback::compute(&prepared, request, &for_host)? {
            assembler.add(&cell, &facets);
        }
        trace("fallback");
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
    compute: &(dyn Fn(&mut Device, &[u32]) -> Result<Found> + Sync),
) -> Result<Vec<Found>> {
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
