//! Long work without Python's lock, which Ctrl-C ends; and errors as Python has them.

use std::error::Error as _;
use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use laguerre::algebra::Algebra;
use laguerre::engine::parallel;
use laguerre::{Backend, BackendInfo, Error, ErrorKind, Observer, Output, PowerDiagram, Request, Resident, Result};
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// The number that makes an `OSError` a `FileNotFoundError`.
const NOT_FOUND: i32 = 2;

/// Between two looks for a signal.
const LOOK: Duration = Duration::from_millis(50);

/// The library's error as Python's: what is wrong with the input is a `ValueError`, a file that is not there a `FileNotFoundError`.
pub(crate) fn raised(error: Error) -> PyErr {
    let message = error.to_string();
    let number =
        |error: &io::Error| error.raw_os_error().or((error.kind() == io::ErrorKind::NotFound).then_some(NOT_FOUND));
    let system = error.source().and_then(|source| source.downcast_ref::<io::Error>()).and_then(number);
    match (error.kind(), system) {
        (ErrorKind::Input, _) => PyValueError::new_err(message),
        (ErrorKind::Io, Some(number)) => PyOSError::new_err((number, message)),
        (ErrorKind::Io, None) => PyOSError::new_err(message),
        (ErrorKind::Interrupted, _) => PyKeyboardInterrupt::new_err(message),
        _ => PyRuntimeError::new_err(message),
    }
}

/// Whether the work is to end.
#[derive(Default)]
pub(crate) struct Stop(AtomicBool);

impl Stop {
    fn set(&self) {
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

    fn algebra(&self) -> Option<&dyn Algebra> {
        self.backend.algebra()
    }

    fn resident<'a>(&'a self, request: &Request, _: &'a dyn Observer) -> Option<Box<dyn Resident + 'a>> {
        self.backend.resident(request, self.stop)
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
            let stop = &stop;
            let (send, receive) = mpsc::sync_channel(1);
            let worker = thread::Builder::new().spawn_scoped(scope, move || {
                // The caller waits until it has this.
                let _ = send.send(work(stop));
            });
            if let Err(error) = worker {
                let message = format!("cannot start a thread: {error}");
                return (Some(Err(Error::new(ErrorKind::Device, message).because(error))), None);
            }
            let mut signal = None;
            loop {
                match receive.recv_timeout(LOOK) {
                    Ok(done) => return (Some(done), signal),
                    // It has panicked.
                    Err(RecvTimeoutError::Disconnected) => return (None, signal),
                    Err(RecvTimeoutError::Timeout) => {}
                }
                // Where the interpreter is about to end nobody waits for the answer.
                match Python::try_attach(|py| py.check_signals()) {
                    Some(Ok(())) => {}
                    Some(Err(error)) => {
                        stop.set();
                        signal = Some(error);
                    }
                    None => stop.set(),
                }
            }
        })
    });
    match (done, signal) {
        (_, Some(signal)) => Err(signal),
        (Some(done), None) => done.map_err(raised),
        (None, None) => Err(PyRuntimeError::new_err("the computation ended early; please report its input")),
    }
}

/// The same within threads of its own, as many as the backend's: a pool that is shared would be without threads after a `fork`.
pub(crate) fn detached_in_pool<T: Send>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce(&Stop) -> Result<T> + Send,
) -> PyResult<T> {
    detached(py, |stop| parallel::pool(Some(threads))?.install(|| work(stop)))
}
