//! The CGAL fixtures made anew, and their largest errors.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::thread;

use crate::run::{root, succeed, target};

/// What `fixtures/` holds that is made here.
const MADE: [&str; 3] = ["sites", "meshes", "answers"];

/// What is not made but found: one mesh, and its terms.
const FOUND: [&str; 2] = ["meshes/bunny.obj", "meshes/README.md"];

/// Lines that `--worst` prints.
const WORST: usize = 20;

/// Makes inputs and answers in the target folder and, once all are there, puts those that differ into `fixtures/`: each is a
/// failure, until it is committed.
pub(crate) fn run() -> Result<(), String> {
    let kept = root().join("fixtures");
    let made = target().join("fixtures");
    // What an earlier run left may be of another list.
    let _ = fs::remove_dir_all(&made);
    for folder in MADE {
        fs::create_dir_all(made.join(folder)).map_err(|error| failed(&made.join(folder), &error))?;
    }
    for file in FOUND {
        fs::copy(kept.join(file), made.join(file)).map_err(|error| failed(&kept.join(file), &error))?;
    }
    let program = compile(&kept.join("cells.cpp"), &made)?;
    let list = inputs(&made)?;
    answers(&program, &made, &list)?;
    let changed = take_over(&made, &kept)?;
    if changed.is_empty() {
        println!("{} fixtures, all as they were", list.len());
        return Ok(());
    }
    Err(format!("{} files changed: {}; look at `git diff fixtures`", changed.len(), changed.join(", ")))
}

/// Runs the checks against the fixtures and prints the largest errors, by their share of the bound.
pub(crate) fn worst() -> Result<(), String> {
    let mut command = Command::new(cargo());
    command.args(["test", "--locked", "--package", "laguerre-conformance", "--test", "conformance", "--", "cgal::"]);
    let output = command.current_dir(root()).env("LAGUERRE_WORST", "1").output();
    let output = output.map_err(|error| format!("cargo did not start: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let mut lines: Vec<(f64, &str)> = text.lines().filter_map(share).collect();
    lines.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("share of the bound, fixture, quantity, error; the largest of {}:", lines.len());
    lines.iter().take(WORST).for_each(|(_, line)| println!("{line}"));
    if output.status.success() {
        return Ok(());
    }
    print!("{}", String::from_utf8_lossy(&output.stdout));
    Err("a fixture's bound is broken, or the checks did not build: `cargo xtask test cgal::` says more".into())
}

/// A line `worst SHARE …` without its first word, and the share.
fn share(line: &str) -> Option<(f64, &str)> {
    let line = line.strip_prefix("worst ")?;
    Some((line.split(' ').next()?.parse().ok()?, line))
}

/// The program that makes answers.
fn compile(source: &Path, folder: &Path) -> Result<PathBuf, String> {
    // Only the headers, of nothing.
    let headers = ["-include", "CGAL/version.h", "-include", "gmpxx.h", "-include", "boost/multiprecision/mpfr.hpp"];
    let probe = Command::new("g++").args(headers).args(["-fsyntax-only", "-x", "c++", "/dev/null"]).output();
    if !probe.is_ok_and(|output| output.status.success()) {
        return Err("g++ or CGAL is missing: apt-get install --no-install-recommends g++ libcgal-dev".into());
    }
    println!("compiling {} (a minute or two)", source.display());
    let program = folder.join("cells");
    let mut command = Command::new("g++");
    // CGAL's intervals need that the compiler leaves the rounding mode alone.
    command.args(["-std=c++17", "-O2", "-DNDEBUG", "-frounding-math", "-o"]).arg(&program).arg(source);
    succeed(command.args(["-lgmpxx", "-lmpfr", "-lgmp"]))?;
    Ok(program)
}

/// Writes sites and meshes; the name and the container of every fixture.
fn inputs(folder: &Path) -> Result<Vec<(String, String)>, String> {
    let mut command = Command::new(cargo());
    command.args([
        "run",
        "--quiet",
        "--locked",
        "--package",
        "laguerre-conformance",
        "--example",
        "fixture_inputs",
        "--",
    ]);
    let list = succeed(command.arg(folder).current_dir(root()))?;
    let fixture = |line: &str| line.split_once(' ').map(|(name, container)| (name.to_owned(), container.to_owned()));
    Ok(list.lines().filter_map(fixture).collect())
}

/// Makes all answers, as many at a time as there are cores.
fn answers(program: &Path, folder: &Path, list: &[(String, String)]) -> Result<(), String> {
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let queue = Mutex::new(list.iter());
    let next = || queue.lock().unwrap_or_else(std::sync::PoisonError::into_inner).next();
    let work = || {
        while let Some((name, container)) = next() {
            let mut command = Command::new(program);
            command.args([format!("sites/{name}.xyz"), container.clone(), format!("answers/{name}.txt")]);
            succeed(command.current_dir(folder))?;
            println!("{name}");
        }
        Ok(())
    };
    thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().unwrap_or_else(|_| Err("a thread died".into())))
    })
}

/// Copies what differs and deletes what is no longer made; the names of these files.
fn take_over(made: &Path, kept: &Path) -> Result<Vec<String>, String> {
    let mut changed = Vec::new();
    for folder in MADE {
        let (from, to) = (made.join(folder), kept.join(folder));
        fs::create_dir_all(&to).map_err(|error| failed(&to, &error))?;
        let new = files(&from)?;
        for name in &new {
            let bytes = fs::read(from.join(name)).map_err(|error| failed(&from.join(name), &error))?;
            if fs::read(to.join(name)).ok().as_ref() != Some(&bytes) {
                fs::write(to.join(name), bytes).map_err(|error| failed(&to.join(name), &error))?;
                changed.push(format!("{folder}/{name}"));
            }
        }
        for name in files(&to)?.into_iter().filter(|name| !new.contains(name)) {
            fs::remove_file(to.join(&name)).map_err(|error| failed(&to.join(&name), &error))?;
            changed.push(format!("{folder}/{name} (deleted)"));
        }
    }
    Ok(changed)
}

/// The names of the files of a folder, sorted.
fn files(folder: &Path) -> Result<Vec<String>, String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| failed(folder, &error))? {
        names.push(entry.map_err(|error| failed(folder, &error))?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}

/// Runs a command to its end; what it printed.
fn failed(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

fn cargo() -> std::ffi::OsString {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}
