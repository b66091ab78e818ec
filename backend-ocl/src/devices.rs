//! The devices of a backend, of which one caller at a time has all.

use laguerre_core::{Error, ErrorKind, Result, parallel};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::panic::resume_unwind;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, Builder};

/// They, and the threads of the host that help whoever has them.
pub(crate) struct Devices<D> {
    all: Mutex<Vec<D>>,
    pool: ThreadPool,
}

impl<D: Send> Devices<D> {
    pub(crate) fn new(all: Vec<D>) -> Result<Self> {
        Ok(Self { all: Mutex::new(all), pool: parallel::pool(None)? })
    }

    pub(crate) fn get_mut(&mut self) -> &mut Vec<D> {
        self.all.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// Has them, for work that waits for no thread of any pool.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Vec<D>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Has them for work of which threads of the host do parts. Those are of a pool of its own, and a task of another pool waits in a thread that is of none:
    /// a thread of a pool that waits takes up another task meanwhile, and one that has the devices could take up one that waits for them.
    pub(crate) fn with<T: Send>(&self, work: impl FnOnce(&mut Vec<D>) -> Result<T> + Send) -> Result<T> {
        let work = || {
            let devices = &mut *self.lock();
            self.pool.install(move || work(devices))
        };
        if rayon::current_thread_index().is_none() {
            return work();
        }
        thread::scope(|scope| {
            let waiting = Builder::new().name("devices".to_owned()).spawn_scoped(scope, work);
            waiting.map_err(|error| no_threads(&error))?.join().unwrap_or_else(|panic| resume_unwind(panic))
        })
    }
}

fn no_threads(error: &dyn std::error::Error) -> Error {
    Error::new(ErrorKind::Device, format!("cannot start threads: {error}"))
}

/// Says of which device an error is, where it is one's.
pub(crate) fn on_device(error: Error, name: &str) -> Error {
    if error.kind() == ErrorKind::Device { error.at(name) } else { error }
}

/// Does something with every device at the same time; the results in order.
pub(crate) fn on_all<'a, D: Send, T: Send>(
    devices: &'a mut [D],
    name: fn(&D) -> &String,
    work: &(dyn Fn(usize, &'a mut D) -> Result<T> + Sync),
) -> Result<Vec<T>> {
    let work = |(i, device): (usize, &'a mut D)| {
        let name = name(device).clone();
        work(i, device).map_err(|error| on_device(error, &name))
    };
    let results: Vec<_> = devices.par_iter_mut().enumerate().with_max_len(1).map(work).collect();
    results.into_iter().collect()
}
