//! Which calls fail, and how: the variable `LAGUERRE_FAULT`.

use std::env;
use std::fs::OpenOptions;
use std::io::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, AtomicU64, Ordering};

/// What the variables say. Faults are separated by commas:
///
/// | fault | meaning |
/// |---|---|
/// | `clFinish:3:-5` | the third call of this function returns −5 |
/// | `clFinish:3+:-5` | so do the third and all later ones |
/// | `clCreateBuffer:>9999:-4` | so do those that ask for more than so many bytes, or move them |
/// | `lost:clFinish:3:-36` | the third call fails so, and after it every call of every function |
/// | `gpu` | devices say that they are GPUs |
/// | `no-doubles` | devices have no double precision |
/// | `no-build` | programs are built without their options, so that the compiler has something to say |
/// | `groups-of:16` | work-groups are of at most 16 |
///
/// With `LAGUERRE_FAULT_FIRED=FILE` each fault that happens appends a line to the file; with `LAGUERRE_FAULT_CALLS=FILE` each call
/// does: the function, and the bytes that it asks for or moves.
struct Plan {
    faults: Vec<Fault>,
    gpu: bool,
    no_doubles: bool,
    no_build: bool,
    largest_group: Option<usize>,
    fired: Option<String>,
    calls: Option<String>,
    /// What every call returns, once the device is lost.
    lost: AtomicI32,
}

struct Fault {
    function: String,
    when: When,
    code: i32,
    loses_device: bool,
    calls: AtomicU64,
}

enum When {
    Call(u64),
    From(u64),
    MoreThan(usize),
}

/// The error of this call of `function`, if it is to fail; `size` is the bytes that it asks for or moves.
pub(crate) fn fault(function: &str, size: usize) -> Option<i32> {
    let plan = plan();
    append(plan.calls.as_deref(), &format!("{function} {size}"));
    let lost = plan.lost.load(Ordering::SeqCst);
    if lost != 0 {
        return Some(lost);
    }
    let mut code = None;
    for fault in plan.faults.iter().filter(|fault| fault.function == function) {
        let call = fault.calls.fetch_add(1, Ordering::SeqCst) + 1;
        let happens = match fault.when {
            When::Call(number) => call == number,
            When::From(number) => call >= number,
            When::MoreThan(bytes) => size > bytes,
        };
        if happens && code.is_none() {
            code = Some(fault.code);
            if fault.loses_device {
                plan.lost.store(fault.code, Ordering::SeqCst);
            }
        }
    }
    if let Some(code) = code {
        note(&format!("{function} {code}"));
    }
    code
}

/// Whether devices are to say that they are GPUs.
pub(crate) fn gpu() -> bool {
    plan().gpu
}

/// Whether devices are to have no double precision.
pub(crate) fn no_doubles() -> bool {
    plan().no_doubles
}

/// Whether programs are to be built without their options.
pub(crate) fn no_build() -> bool {
    plan().no_build
}

/// The largest work-group, if it is limited.
pub(crate) fn largest_group() -> Option<usize> {
    plan().largest_group
}

/// Notes that a fault has happened.
pub(crate) fn note(what: &str) {
    append(plan().fired.as_deref(), what);
}

fn append(path: Option<&str>, line: &str) {
    if let Some(path) = path
        && let Ok(mut file) = OpenOptions::new().create(true).append(true).open(path)
    {
        // The test that wants the file sees that it lacks it. In one piece, as several threads may write.
        let _ = file.write_all(format!("{line}\n").as_bytes());
    }
}

fn plan() -> &'static Plan {
    static PLAN: OnceLock<Plan> = OnceLock::new();
    PLAN.get_or_init(|| {
        let mut plan = Plan {
            faults: Vec::new(),
            gpu: false,
            no_doubles: false,
            no_build: false,
            largest_group: None,
            fired: env::var("LAGUERRE_FAULT_FIRED").ok(),
            calls: env::var("LAGUERRE_FAULT_CALLS").ok(),
            lost: AtomicI32::new(0),
        };
        let text = env::var("LAGUERRE_FAULT").unwrap_or_default();
        for word in text.split(',').map(str::trim).filter(|word| !word.is_empty()) {
            // A test that is not understood must not pass.
            assert!(plan.add(word).is_some(), "LAGUERRE_FAULT: `{word}` is no fault");
        }
        plan
    })
}

impl Plan {
    fn add(&mut self, word: &str) -> Option<()> {
        let parts: Vec<&str> = word.split(':').collect();
        let (parts, loses_device) = match parts[..] {
            ["gpu"] => {
                self.gpu = true;
                return Some(());
            }
            ["no-doubles"] => {
                self.no_doubles = true;
                return Some(());
            }
            ["no-build"] => {
                self.no_build = true;
                return Some(());
            }
            ["groups-of", size] => {
                self.largest_group = Some(size.parse().ok()?);
                return Some(());
            }
            ["lost", ref rest @ ..] => (rest, true),
            ref all => (all, false),
        };
        let [function, when, code] = *parts else { return None };
        let when = match (when.strip_prefix('>'), when.strip_suffix('+')) {
            (Some(bytes), _) => When::MoreThan(bytes.parse().ok()?),
            (_, Some(first)) => When::From(first.parse().ok()?),
            _ => When::Call(when.parse().ok()?),
        };
        let code = code.parse().ok()?;
        self.faults.push(Fault { function: function.to_owned(), when, code, loses_device, calls: AtomicU64::new(0) });
        Some(())
    }
}
