//! Long work without Python's lock, which Ctrl-C ends; and errors as Python has them.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use laguerre::{Backend, BackendInfo, Error, ErrorKind, Observer, Output, PowerDiagram, Request, Result};
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// Between two looks for a signal.
const LOOK: Duration = Duration::from_millis(50);

/// The library's error as Python's: what is wrong with the input is a `ValueError`.
pub(crate) fn raised(error: Error) -> PyErr {
    let message = error.to_string();
    match error.kind() {
        ErrorKind::Input => PyValueError::new_err(message),
        ErrorKind::Io => PyOSError::new_err(message),
        ErrorKind::Interrupted => PyKeyboardInterrupt::new_err(message),
        _ => PyRuntimeError::new_err(message),
    }
}

/// Whether the work is to end.
#[derive(Default)]
pub(crate) struct Stop(AtomicBool);

impl Stop {
    pub(crate) fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Observer for Stop {
    fn advance(&self, _cells: usize) -> ControlFlow<()> {
        if self.0.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// A backend whose every evaluation ends when it is to.
pub(crate) struct Stoppable<'a> {
    pub(crate) backend: &'a dyn Backend,
    pub(crate) stop: &'a Stop,
}

impl Backend for Stoppable<'_> {
    fn info(&self) -> BackendInfo {
        self.backend.info()
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, _: &dyn Observer) -> Result<Output> {
        self.backend.evaluate_watched(diagram, request, self.stop)
    }
}

/// Does `work` on a thread of its own while this one looks for signals, so that Ctrl-C ends it.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce(&Stop) -> Result<T> + Send) -> PyResult<T> {
    let stop = Stop::default();
    let (done, signal) = py.detach(|| {
        thread::scope(|scope| {
            let (caller, stop) = (thread::current(), &stop);
            let worker = scope.spawn(move || {
                let done = work(stop);
                caller.unpark();
                done
            });
            let mut signal = None;
            while !worker.is_finished() {
                thread::park_timeout(LOOK);
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    stop.set();
                    signal = Some(error);
                }
            }
            (worker.join(), signal)
        })
    });
    if let Some(signal) = signal {
        return Err(signal);
    }
    done.map_err(|_| PyRuntimeError::new_err("the computation ended early; please report its input"))?.map_err(raised)
}
