//! What a person would otherwise type from memory: `cargo xtask test`, `cargo xtask check`.
#![forbid(unsafe_code)]

mod browser;
mod codegen;
mod count;
mod deny;
mod features;
mod fixtures;
mod guide;
mod lanes;
mod nvptx;
mod page;
mod paper;
mod peers;
mod python;
mod readers;
mod run;

use std::env;
use std::process::ExitCode;

use run::{Counts, cargo, cargo_test};

const USAGE: &str = "usage: cargo xtask COMMAND

  test [FILTER…]   all tests of the workspace, doc tests and the conformance suite of every backend included;
                   LAGUERRE_REQUIRE (default: cpu) names the backends that must be there
  lanes            the conformance suite where work-items share a cell in sub-groups, on Intel's OpenCL for CPUs, which it installs
                   into target/ (225 MB from PyPI; needs Python and an x86-64; 13 minutes on 2 cores)
  nvptx            the kernels for NVIDIA's GPUs by clang (with libclc) and NVIDIA's assembler, which it installs into target/ (40 MB from PyPI; needs Python and an
                   x86-64), where there is no GPU: that they compile, and the registers, memory and text of each (two minutes)
  readers          the program's files read by PyVista, meshio and trimesh, which it installs into target/ (PyPI; needs Python; a minute)
  page             the program's pages (--html) in a headless Chromium, which must be there, at a desktop's and a phone's width: pictures, picking,
                   sliders, the time to the first picture of 100,000 cells (a minute)
  python           builds the Python module as tests are built, installs it into target/, and runs its tests and examples (PyPI; three minutes)
  guide            builds the guide by mdBook, which it installs into target/ (PyPI; needs Python), checks its links, and runs its commands, those of
                   README.md, and examples/ (half a minute)
  wheel            the module for users: a wheel in target/wheels/
  count            the instructions that small inputs take on the CPU, counted by valgrind, which it needs, and held to benches/instructions.txt;
                   --write makes that anew
  check            formatting, clippy and documentation, warnings as errors; the fuzz workspace compiles; every crate packs;
                   generated text as it should be; then `deny` and `features`
  deny             the licences, versions and sources of all dependencies are those that deny.toml allows
  features         the library brings few crates, and compiles with each feature alone; its tests, documentation and examples with the default ones
  codegen          the OpenCL C of core/src/cell/ and of backend-ocl/src/interface/; with --check only says whether it is up to date
  fixtures         makes the CGAL fixtures anew (needs g++ and libcgal-dev) and fails if any changed; with --worst holds the
                   backends to those that are there and prints the largest errors
  paper [OPTION…]  the paper's experiments, into BENCHMARKS.md (minutes; options are those of `laguerre paper --help`, as --sites N,
                   --backend NAME, --device N); --from FILE puts in what `laguerre paper --markdown FILE` wrote on another machine
  peers            voro++, CGAL, meshless_voronoi and geogram beside this program on two threads, those that are there; the table in
                   BENCHMARKS.md (C++ compiler, Debian's voro++-dev and libcgal-dev, PyPI; eight minutes on a machine with nothing else to do)";

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["test", ref filters @ ..] => test(filters),
        ["lanes"] => lanes::run(),
        ["nvptx"] => nvptx::run(),
        ["readers"] => readers::run(),
        ["page"] => page::run(),
        ["python"] => python::test(),
        ["guide"] => guide::run(),
        ["wheel"] => python::wheel(),
        ["count"] => count::run(false),
        ["count", "--write"] => count::run(true),
        ["check"] => check(),
        ["deny"] => deny::run(),
        ["features"] => features::run(),
        ["fixtures"] => fixtures::run(),
        ["fixtures", "--worst"] => fixtures::worst(),
        ["paper", ref arguments @ ..] => paper::run(arguments),
        ["peers"] => peers::run(),
        ["codegen"] => codegen::run(false),
        ["codegen", "--check"] => codegen::run(true),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("xtask: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// Runs all tests, keeps on after a failure, and ends with the sum.
fn test(filters: &[&str]) -> Result<(), String> {
    let required = env::var("LAGUERRE_REQUIRE").unwrap_or_else(|_| "cpu".to_owned());
    let variables = [("LAGUERRE_REQUIRE", required.as_str())];
    let mut counts = Counts::default();
    // `cargo test --all-targets` leaves doc tests out, and without it benches are not built: hence two runs. Benches are only
    // built: a timing is not a test.
    let mut failures = Vec::new();
    for arguments in [&["--lib", "--bins", "--tests", "--examples"][..], &["--doc"]] {
        let mut line = vec!["test", "--locked", "--workspace", "--all-features", "--no-fail-fast"];
        line.extend(arguments);
        line.push("--");
        line.extend(filters);
        let (ran, ok) = cargo_test(&line, &variables)?;
        counts += ran;
        if !ok {
            failures.push(arguments.join(" "));
        }
    }
    cargo(&["build", "--locked", "--workspace", "--all-features", "--benches"], &[])?;
    println!("{counts}");
    match failures.is_empty() && counts.failed == 0 {
        true => Ok(()),
        false => Err(format!("tests failed (cargo test {})", failures.join(", cargo test "))),
    }
}

/// Formatting, lints and documentation; the first that fails ends it.
fn check() -> Result<(), String> {
    cargo(&["fmt", "--all", "--check"], &[])?;
    let clippy = ["clippy", "--locked", "--workspace", "--all-features", "--all-targets", "--", "-D", "warnings"];
    cargo(&clippy, &[])?;
    let doc = ["doc", "--locked", "--workspace", "--all-features", "--no-deps"];
    cargo(&doc, &[("RUSTDOCFLAGS", "-D warnings")])?;
    // A workspace of its own, which nothing else builds; its targets proper need libFuzzer, a C++ compiler and time.
    cargo(&["check", "--locked", "--manifest-path", "fuzz/Cargo.toml", "--no-default-features"], &[])?;
    cargo(&["fmt", "--manifest-path", "python/Cargo.toml", "--check"], &[])?;
    // Versions and files are there; without building what was packed, which takes five minutes (`cargo package --workspace` does).
    let package = ["package", "--locked", "--offline", "--workspace", "--no-verify", "--allow-dirty", "--quiet"];
    cargo(&package, &[])?;
    codegen::run(true)?;
    deny::run()?;
    features::run()
}
