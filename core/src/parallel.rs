//! Loops on all threads. All of them are one instance of rayon's iterators, over numbered tasks, or one for each type of what is collected: an instance
//! of its own for each loop, of which there were 178, was 60 % of what the compiler made of `laguerre-solvers` and a fifth of this crate.

use crate::backend::MOST_THREADS;
use crate::error::{Error, ErrorKind, Result};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::error::Error as _;
use std::num::NonZero;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use std::{env, fs};

/// Times that fewer threads are tried: as often as 4096 of them can be halved.
const MOST_TRIES: u32 = MOST_THREADS.ilog2() + 1;

/// Threads of a pool of its own: so many, or, where no number is asked for, one for each core, and fewer where a limit has no room for all of them
/// or they cannot be started.
///
/// # Errors
/// `Device` where what is asked for, or not even one, can be started.
pub fn pool(threads: Option<usize>) -> Result<ThreadPool> {
    let mut asked = threads.unwrap_or_else(most);
    let mut tries = MOST_TRIES;
    loop {
        let mut started: Vec<JoinHandle<()>> = Vec::new();
        let built = ThreadPoolBuilder::new().num_threads(asked).spawn_handler(|thread| {
            started.push(thread::Builder::new().spawn(|| thread.run())?);
            Ok(())
        });
        let error = match built.build() {
            Ok(pool) => {
                // What a thread takes of the address space as it starts, for a moment twice what it keeps, is not to be in the way of what follows.
                pool.broadcast(|_| ());
                return Ok(pool);
            }
            Err(error) => error,
        };
        let n = started.len();
        // What they had is free only when they ended.
        started.into_iter().for_each(|thread| drop(thread.join()));
        tries -= 1;
        if threads.is_some() || tries == 0 {
            return Err(cannot_start(asked, &error));
        }
        asked = n.div_ceil(2).max(1);
        // (Another thread that starts just now has for a moment what is missing.)
        thread::sleep(Duration::from_millis(1));
    }
}

/// Starts the threads of loops that are in no pool, rayon's own, if nobody did: else rayon does at the first such loop, as many as there are cores, and panics
/// where it cannot.
///
/// # Errors
/// `Device` where they cannot be started; no such loop can be run then.
pub fn start() -> Result<()> {
    static STARTED: OnceLock<Result<()>> = OnceLock::new();
    let start = || match ThreadPoolBuilder::new().num_threads(most()).build_global() {
        // (They were started by others where nothing else led to the error.)
        Err(error) if error.source().is_some() => Err(cannot_start(most(), &error)),
        _ => Ok(()),
    };
    STARTED.get_or_init(start).clone()
}

fn cannot_start(threads: usize, error: &ThreadPoolBuildError) -> Error {
    let what = if threads == 1 { "a thread".to_owned() } else { format!("{threads} threads") };
    Error::new(ErrorKind::Device, format!("cannot start {what}: {error}"))
}

/// One for each core, or as many as a limit has room for.
fn most() -> usize {
    cores().min(most_in_limit()).max(1)
}

/// One for each core, or what rayon's variable says.
fn cores() -> usize {
    let said = env::var("RAYON_NUM_THREADS")
        .ok()
        .and_then(|said| said.parse().ok())
        .filter(|said| (1..=MOST_THREADS).contains(said));
    said.unwrap_or_else(|| thread::available_parallelism().map_or(1, NonZero::get))
}

/// As many as take a quarter of a limit of the address space, as Linux's table of limits has it: a program has a backend's pool, rayon's own, and at times a
/// solver's. (Where only those that could not be started were fewer, 44 of 618 runs with 64 threads within 38 to 345 MB were ended by Rust or the C library, which
/// at times had no 41 bytes left. To ask for memory and give it back would tell what is left, but where that fails glibc takes 64 MB for itself.)
fn most_in_limit() -> usize {
    // For its stack, and what glibc sets aside for what it allocates and keeps when the thread ends.
    const OF_A_THREAD: usize = 66 << 20;
    let limits = fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let limit = limits.lines().find_map(|line| line.strip_prefix("Max address space")?.split_whitespace().next());
    limit.and_then(|limit| limit.parse().ok()).map_or(usize::MAX, |bytes: usize| bytes / 4 / OF_A_THREAD)
}

/// Calls `task` with each number below `n`, in any order.
pub fn tasks(n: usize, task: &(dyn Fn(usize) + Sync)) {
    (0..n).into_par_iter().for_each(task);
}

/// Calls `task` with each part and its number.
pub fn each<P: Send>(parts: impl IntoIterator<Item = P>, task: impl Fn(usize, &mut P) + Sync) {
    // Each is locked once, by the task whose it is.
    let parts: Vec<Mutex<P>> = parts.into_iter().map(Mutex::new).collect();
    tasks(parts.len(), &|k| task(k, &mut lock(&parts[k])));
}

fn lock<P>(part: &Mutex<P>) -> MutexGuard<'_, P> {
    part.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What `task` makes of each number below `n`, in their order.
pub fn results<T: Send>(n: usize, task: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut results: Vec<Option<T>> = Vec::new();
    results.resize_with(n, || None);
    each(&mut results, |k, result| **result = Some(task(k)));
    results.into_iter().flatten().collect()
}

/// What `part` makes of each chunk of `length` of the numbers below `n`, in their order.
pub fn chunks<T: Send>(n: usize, length: usize, part: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    results(n.div_ceil(length), |chunk| part(chunk * length..n.min((chunk + 1) * length)))
}

/// Calls `f` with each entry and its index, `length` of them in a task.
pub fn for_each<T: Send>(x: &mut [T], length: usize, f: impl Fn(usize, &mut T) + Sync) {
    each(x.chunks_mut(length), |chunk, part| {
        for (k, x) in part.iter_mut().enumerate() {
            f(chunk * length + k, x);
        }
    });
}

/// `f(i)` for each i below `n`, `length` of them or more in a task.
pub fn map<T: Send>(n: usize, length: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    collected(n, length, &f)
}

/// (Into new memory, which no one thread goes through before: a million triples of zeros, set afterwards, took 2.3 ms where this takes 0.7; 16 cores.)
fn collected<T: Send>(n: usize, length: usize, f: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    (0..n).into_par_iter().with_min_len(length).map(f).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_has_its_result_in_its_place() {
        for n in [0, 1, 7, 100, 5_000] {
            let squares: Vec<usize> = (0..n).map(|i| i * i).collect();
            assert_eq!(results(n, |i| i * i), squares);
            for length in [1, 7, 4_096] {
                assert_eq!(map(n, length, |i| i * i), squares, "{n} by {length}");
                assert_eq!(chunks(n, length, |range| range).into_iter().flatten().max(), n.checked_sub(1));
            }
        }
    }
}
