//! Runs every check for every backend that was built, as `backend::area::check`.

use std::process::ExitCode;
use std::sync::Arc;

use laguerre_conformance::{CHECKS, Verdict, backends, regressions};
use laguerre_core::{Backend, ErrorKind};
use libtest_mimic::{Arguments, Failed, Trial};

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let mut trials_of_each = Vec::new();
    let mut present = Vec::new();
    for (name, opened) in backends::built() {
        match opened {
            Ok(backend) => {
                present.push(name);
                trials_of_each.push(trials_of(name, &Arc::from(backend)));
            }
            // Built, but this machine has no device: seen as ignored, and an error where it is required.
            Err(error) if error.kind() == ErrorKind::Unavailable => {
                eprintln!("{name}: {error}");
                trials_of_each.push(vec![Trial::test(format!("{name}::opens"), || Ok(())).with_ignored_flag(true)]);
            }
            // It was built, so someone counts on it.
            Err(error) => {
                trials_of_each.push(vec![Trial::test(format!("{name}::opens"), move || Err(error.to_string().into()))]);
            }
        }
    }
    // Not as trials: a filter on the command line must not hide what is missing.
    let mut missing = backends::required();
    missing.retain(|name| !present.contains(&name.as_str()));
    if !missing.is_empty() {
        eprintln!(
            "LAGUERRE_REQUIRE names {}, not there: build with these features, and see what the lines above say",
            missing.join(", ")
        );
        return ExitCode::FAILURE;
    }
    if trials_of_each.is_empty() {
        eprintln!("no backend was built, so nothing can be checked: build with the feature `cpu`");
        return ExitCode::FAILURE;
    }
    libtest_mimic::run(&arguments, in_turns(trials_of_each)).exit_code()
}

/// One of each backend's in turn: a device computes one diagram at a time, and two laws of one backend wait for each other.
fn in_turns(trials_of_each: Vec<Vec<Trial>>) -> Vec<Trial> {
    let mut left: Vec<_> = trials_of_each.into_iter().map(Vec::into_iter).collect();
    let mut all = Vec::new();
    loop {
        let before = all.len();
        all.extend(left.iter_mut().filter_map(Iterator::next));
        if all.len() == before {
            return all;
        }
    }
}

/// A check, or a law with its case.
type Run = Box<dyn FnOnce(&dyn Backend) -> Verdict + Send>;

fn trials_of(name: &str, backend: &Arc<dyn Backend>) -> Vec<Trial> {
    let check = |check: &str, run: Run| {
        let backend = Arc::clone(backend);
        Trial::test(format!("{name}::{check}"), move || run(&*backend).map_err(Failed::from))
    };
    let mut trials: Vec<Trial> = CHECKS.iter().map(|&(of, run)| check(of, Box::new(run))).collect();
    for &(of, law, case) in regressions::CASES {
        trials.push(check(&format!("regressions::{of}"), Box::new(move |backend| law(backend, &case))));
    }
    for &(of, scene) in regressions::SCENES {
        trials.push(check(&format!("regressions::{of}"), Box::new(move |backend| scene.holds(backend))));
    }
    trials
}
