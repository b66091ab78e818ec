//! `structured CASES [SEED [THREADS [uneven]]]`: structured cases from a seed, full of ties or of uneven sites, as fast as they go. `CASES` is
//! how many, or `FIRST..END`: `7..8` is case 7 alone. Says how many a second, how many fail for which kind of reason, and of each kind the first
//! few in their smallest form, to be pasted into `conformance/src/regressions.rs`.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use arbitrary::Unstructured;
use laguerre::Selection;
use laguerre_conformance::Verdict;
use laguerre_conformance::sites::Random;
use laguerre_core::Backend;
use laguerre_fuzz::{case::Structured, tied::tied, uneven::uneven};

/// Cases that a thread takes at a time.
const CHUNK: u64 = 1000;
/// Bytes of a case full of ties: more than the largest takes.
const BYTES: usize = 512;
/// Failing cases of each kind that are told.
const TOLD: usize = 3;
/// Between two lines of progress.
const PAUSE: Duration = Duration::from_secs(60);

const USAGE: &str = "usage: structured CASES [SEED [THREADS [uneven]]]; the first three are whole numbers, the first may be FIRST..END";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let whole = |at: usize, usual: u64| words.get(at).map_or(Some(usual), |word| word.parse().ok());
    let cases = words.first().and_then(|word| match word.split_once("..") {
        Some((first, end)) => Some(first.parse().ok()?..end.parse().ok()?),
        None => Some(0..word.parse().ok()?),
    });
    let known = words.len() < 4 || words[3..] == ["uneven"];
    let (Some(cases), Some(seed), Some(threads), true) = (cases, whole(1, 1), whole(2, 1), known) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let make = if words.len() == 4 { uneven_case } else { tied_case };
    // Panics are caught and told with their case.
    std::panic::set_hook(Box::new(|_| {}));
    let (next, done, told) = (AtomicU64::new(cases.start), AtomicU64::new(0), Mutex::new(Instant::now()));
    let failed = Mutex::new(BTreeMap::<String, usize>::new());
    let start = Instant::now();
    let work = || {
        let backend = match laguerre::open(Selection::Cpu { threads: Some(1) }) {
            Ok(backend) => backend,
            Err(error) => return eprintln!("{error}"),
        };
        loop {
            let first = next.fetch_add(CHUNK, Ordering::Relaxed);
            if first >= cases.end {
                return;
            }
            for index in first..cases.end.min(first + CHUNK) {
                let case = make(seed, index);
                if let Err(reason) = verdict(&case, &*backend) {
                    let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                    let count = failed.entry(kind(&reason)).or_default();
                    *count += 1;
                    if *count <= TOLD {
                        tell(index, &reason, case, &*backend);
                    }
                }
                done.fetch_add(1, Ordering::Relaxed);
            }
            if let Ok(mut last) = told.try_lock()
                && last.elapsed() > PAUSE
            {
                *last = Instant::now();
                eprintln!("{} cases, {:.0} s", done.load(Ordering::Relaxed), start.elapsed().as_secs_f64());
            }
        }
    };
    std::thread::scope(|scope| (0..threads.max(1)).for_each(|_| drop(scope.spawn(work))));
    let (done, seconds) = (done.into_inner(), start.elapsed().as_secs_f64());
    let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    println!("{done} cases of seed {seed} in {seconds:.1} s, {:.0} a second", done as f64 / seconds);
    failed.iter().for_each(|(kind, count)| println!("{count} failed: {kind}"));
    if failed.is_empty() && done == cases.end.saturating_sub(cases.start) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// A reason without its numbers.
fn kind(reason: &str) -> String {
    let words = reason.split_ascii_whitespace().filter(|word| !word.contains(|c: char| c.is_ascii_digit()));
    words.take(8).collect::<Vec<_>>().join(" ")
}

/// The stream of case `index` of a seed, the same for any number of threads.
fn stream(seed: u64, index: u64) -> Random {
    Random::new(seed ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

fn tied_case(seed: u64, index: u64) -> Structured {
    let mut random = stream(seed, index);
    let bytes: Vec<u8> = (0..BYTES / 8).flat_map(|_| random.bits().to_le_bytes()).collect();
    tied(&mut Unstructured::new(&bytes)).expect("enough bytes for a case")
}

fn uneven_case(seed: u64, index: u64) -> Structured {
    uneven(&mut stream(seed, index))
}

/// Whether the case holds; a panic is a reason too.
fn verdict(case: &Structured, backend: &dyn Backend) -> Verdict {
    let caught = catch_unwind(AssertUnwindSafe(|| case.holds(backend)));
    caught.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        Err(format!("panic: {}", text.unwrap_or("without words")))
    })
}

fn tell(index: u64, reason: &str, case: Structured, backend: &dyn Backend) {
    let smallest = case.shrunk(|case| verdict(case, backend).is_err());
    let of_smallest = verdict(&smallest, backend).err().unwrap_or_default();
    println!("case {index}: {reason}\nits smallest form, {:?}: {of_smallest}", smallest.also);
    println!("    (\"…\", {:?}),\n", smallest.given());
}
