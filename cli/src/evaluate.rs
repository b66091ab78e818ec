//! Opening a backend and evaluating with it, with a progress bar where there is a terminal to draw it on.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use laguerre::engine::memory;
use laguerre::{Backend, Error, ErrorKind, Observer, Output, PowerDiagram, Request, Result, Selection};

use crate::args::{BackendArgs, BackendChoice, Precision};
use crate::kernels;
use crate::outcome::is_interrupted;

/// Opens the backend of the command line. The only place that does.
pub(crate) fn open(args: &BackendArgs) -> Result<Box<dyn Backend>> {
    let precision = match args.precision {
        Precision::F64 => laguerre::Precision::F64,
        Precision::F32 => laguerre::Precision::F32,
    };
    let selection = match (args.backend, &args.device) {
        // A device is a matter of OpenCL alone, threads are one of the CPU, which has 64 bits only.
        (BackendChoice::Ocl, _) | (BackendChoice::Auto, Some(_)) if args.threads.is_some() => {
            return Err(Error::input("--threads: they are of backend cpu alone; leave them out"));
        }
        (BackendChoice::Ocl, choice) => Selection::Ocl { devices: choice.clone().unwrap_or_default(), precision },
        (BackendChoice::Auto, Some(choice)) => Selection::Ocl { devices: choice.clone(), precision },
        (BackendChoice::Auto, None) if args.threads.is_none() && args.precision == Precision::F32 => {
            Selection::Ocl { devices: laguerre::DeviceChoice::First, precision }
        }
        (BackendChoice::Cpu, Some(_)) => {
            return Err(Error::input("--device: backend cpu has none; give --backend ocl"));
        }
        (BackendChoice::Auto, None) if args.threads.is_none() => Selection::Auto,
        (BackendChoice::Auto | BackendChoice::Cpu, None) => Selection::Cpu { threads: args.threads },
    };
    let backend = laguerre::open(selection)?;
    let info = backend.info();
    if args.precision == Precision::F32 && info.precision != laguerre::Precision::F32 {
        let name = info.backend;
        return Err(Error::input(format!(
            "--precision f32: backend {name} computes in {0} only; give --precision {0}",
            info.precision.word()
        )));
    }
    Ok(backend)
}

/// The default backend, for commands without the options of `integrate`.
pub(crate) fn open_default() -> Result<Box<dyn Backend>> {
    open(&BackendArgs { backend: BackendChoice::Auto, device: None, precision: Precision::F64, threads: None })
}

/// The backend for what a seed has to make again, to the bit, on any machine: the CPU, or what was built instead.
pub(crate) fn open_for_samples() -> Result<Box<dyn Backend>> {
    let cpu = laguerre::open(Selection::Cpu { threads: None });
    cpu.or_else(|error| if error.kind() == ErrorKind::Unavailable { open_default() } else { Err(error) })
}

/// Bytes for each cell: the sites as they are sorted and their grid, the cell's sums, and its part of the output.
const CELL: u64 = 320;
/// The same for its facets, of which most cells have about 16, as they are collected and in the output.
const FACETS: u64 = 16 * 120 + 88;
/// The same for the domain's grid, with up to 16 voxels a site.
const VOXELS: u64 = 64;

/// Time between two drawings of the bar.
const REDRAW: Duration = Duration::from_millis(100);

/// Evaluates, drawing the progress on standard error if that is a terminal.
///
/// # Errors
/// Also where there is not so much memory as that will take, for the host at least.
pub(crate) fn evaluate(backend: &dyn Backend, diagram: &PowerDiagram, request: &Request) -> Result<Output> {
    let of_facets = if request.facets() { FACETS } else { 0 };
    let of_domain = if diagram.domain().is_some() { VOXELS } else { 0 };
    memory::probe(diagram.positions().len() as u64, CELL + of_facets + of_domain, "cells")?;
    let progress = Progress::default();
    if !std::io::stderr().is_terminal() {
        return backend.evaluate_watched(diagram, request, &progress);
    }
    let (done, wait) = mpsc::channel::<()>();
    let cells = diagram.positions().len();
    let watched = &progress;
    thread::scope(|scope| {
        // Without a second thread there is no bar, and nothing else is lost.
        let drawing = thread::Builder::new().spawn_scoped(scope, move || draw(watched, cells, &wait));
        let output = backend.evaluate_watched(diagram, request, &progress);
        drop(done);
        drop(drawing);
        output
    })
}

/// Counts the cells of one diagram, and ends it where Ctrl-C came to a command that ends by itself.
#[derive(Default)]
struct Progress(AtomicUsize);

impl Observer for Progress {
    fn advance(&self, cells: usize) -> ControlFlow<()> {
        self.0.fetch_add(cells, Ordering::Relaxed);
        Interruptible.advance(cells)
    }
}

/// Ends a diagram where Ctrl-C came to a command that ends by itself.
pub(crate) struct Interruptible;

impl Observer for Interruptible {
    fn advance(&self, _cells: usize) -> ControlFlow<()> {
        if is_interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn draw(progress: &Progress, cells: usize, wait: &mpsc::Receiver<()>) {
    let bar = ProgressBar::new(cells as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {human_pos}/{human_len} cells, {msg}{eta}") {
        bar.set_style(style);
    }
    while wait.recv_timeout(REDRAW) == Err(RecvTimeoutError::Timeout) {
        bar.set_position(progress.0.load(Ordering::Relaxed) as u64);
        bar.set_message(if kernels::are_compiled() { "the device's driver compiles kernels, once; " } else { "" });
    }
    bar.finish_and_clear();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_of_each_diagram_begins_at_none_and_ends_full() {
        let (backend, request) = (open_default().unwrap(), Request::moments());
        let diagram = PowerDiagram::new(&[[0.2; 3], [0.7; 3]], &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        // One request for both, as a solver has it.
        for _ in 0..2 {
            let progress = Progress::default();
            backend.evaluate_watched(&diagram, &request, &progress).unwrap();
            assert_eq!(progress.0.into_inner(), 2);
        }
    }
}
