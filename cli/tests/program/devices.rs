//! What goes wrong with OpenCL, and what the user sees. The program's loader is one that makes chosen calls fail
//! (`backend-ocl/faults`; its faults are described in `plan.rs`).

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::support::{PROGRAM, failed, files, inputs, runs};

/// `CL_MEM_OBJECT_ALLOCATION_FAILURE`, `CL_OUT_OF_RESOURCES`, `CL_OUT_OF_HOST_MEMORY`, `CL_INVALID_COMMAND_QUEUE`,
/// `CL_INVALID_BUFFER_SIZE`.
const NO_MEMORY: i32 = -4;
const NO_RESOURCES: i32 = -5;
const NO_HOST_MEMORY: i32 = -6;
const NO_QUEUE: i32 = -36;
const TOO_LARGE: i32 = -61;

/// 2,000 cells and their facets, the surface among them: both substeps of the first pass.
const RUN: [&str; 11] = [
    "integrate",
    "white.xyz",
    "--backend",
    "ocl",
    "--domain",
    "cube.off",
    "-o",
    "cells.csv",
    "--facets",
    "facets.csv",
    "--json",
];

pub(crate) fn is_required() -> bool {
    env::var("LAGUERRE_REQUIRE").unwrap_or_default().split(',').any(|name| name.trim() == "ocl")
}

/// The loader that fails: cargo puts it beside this test when it builds the whole workspace, else one folder up.
pub(crate) fn loader() -> Option<PathBuf> {
    let name = format!("{}laguerre_ocl_faults{}", env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX);
    let test = env::current_exe().unwrap();
    let found = test.ancestors().skip(1).take(2).map(|folder| folder.join(&name)).find(|path| path.exists());
    if found.is_none() {
        let message =
            format!("{name} is not beside {}: run `cargo build -p laguerre-ocl-faults` first", test.display());
        assert!(!is_required(), "{message}");
        eprintln!("not run: {message}");
    }
    found
}

/// A place to run in: inputs, the loader, and what the run gives where nothing fails.
struct Place {
    folder: TempDir,
    loader: PathBuf,
    /// The device's name.
    device: String,
    wanted: BTreeMap<PathBuf, Vec<u8>>,
}

impl Place {
    /// None where the backend is not there, and not required.
    fn new() -> Option<Self> {
        let mut place = Self { folder: inputs(), loader: loader()?, device: String::new(), wanted: BTreeMap::new() };
        let output = place.run("", &RUN);
        if output.status.code() == Some(3) && !is_required() {
            eprintln!("not run: {}", String::from_utf8_lossy(&output.stderr));
            return None;
        }
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let report = String::from_utf8(output.stdout).unwrap();
        place.device = report.split("\"device\":\"").nth(1).unwrap().split('"').next().unwrap().to_owned();
        place.wanted = files(place.path());
        assert!(place.wanted.contains_key(&place.path().join("facets.csv")));
        place.clear();
        Some(place)
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn run(&self, fault: &str, args: &[&str]) -> Output {
        self.command(fault, args).output().unwrap()
    }

    fn command(&self, fault: &str, args: &[&str]) -> Command {
        let mut command = Command::new(PROGRAM);
        command.current_dir(self.path()).args(args).env("OPENCL_DYLIB_PATH", &self.loader).env("LAGUERRE_FAULT", fault);
        command.env("RUST_BACKTRACE", "0").env("LAGUERRE_FAULT_FIRED", self.path().join("fired"));
        command
    }

    /// Removes what a run has written, and says whether its fault has happened.
    fn clear(&self) -> bool {
        for name in ["cells.csv", "facets.csv"] {
            let _ = fs::remove_file(self.path().join(name));
        }
        fs::remove_file(self.path().join("fired")).is_ok()
    }

    /// Runs, expects the exit code, one line, and that nothing is left; returns the line.
    fn fails(&self, fault: &str, code: i32) -> String {
        self.clear();
        let before = files(self.path());
        let line = failed(&self.run(fault, &RUN), code, &[fault]);
        let _ = fs::remove_file(self.path().join("fired"));
        assert!(files(self.path()) == before, "{fault} left {:?}", files(self.path()).keys());
        line
    }

    /// Runs; the results are those without the fault, or there is a line and no result. Says what went wrong, else whether the fault
    /// has happened.
    fn survives(&self, fault: &str) -> Result<bool, String> {
        let output = self.run(fault, &RUN);
        let said = String::from_utf8_lossy(&output.stderr).lines().take(4).collect::<Vec<_>>().join("\n");
        let mut left = files(self.path());
        left.remove(&self.path().join("fired"));
        let happened = self.clear();
        let result = match output.status.code() {
            Some(0) if left == self.wanted => Ok(happened),
            Some(0) => Err("other results than without the fault".to_owned()),
            Some(2 | 3) if left != files(self.path()) => Err(format!("{said}; left {:?}", left.keys())),
            Some(2 | 3) if !output.stdout.is_empty() || said.lines().count() != 1 || said.contains("panicked") => {
                Err(format!("not one line: {said}"))
            }
            Some(2 | 3) if said.contains(" 0 bytes") => Err(format!("no memory was asked for: {said}")),
            // What failed, or OpenCL's name for its error.
            Some(2 | 3) if !said.contains("OpenCL") && !said.contains("CL_") => {
                Err(format!("the line does not say what failed: {said}"))
            }
            Some(2 | 3) => Ok(happened),
            other => Err(format!("exit code {other:?}: {said}")),
        };
        result.map_err(|what| format!("{fault}: {what}"))
    }

    /// Lets single calls of a function fail, the first, second, fourth and so on, until there is none; how many failed.
    fn sweep(&self, function: &str, code: i32, wrong: &mut Vec<String>) -> usize {
        let (mut call, mut happened) = (1_u32, 0);
        loop {
            match self.survives(&format!("{function}:{call}:{code}")) {
                Ok(false) => return happened,
                Ok(true) => {}
                Err(what) => wrong.push(what),
            }
            happened += 1;
            assert!(happened < 16, "{function} is called without end");
            call *= 2;
        }
    }
}

/// Expects the words in the line.
fn says(line: &str, words: &[&str]) {
    for word in words {
        assert!(line.contains(word), "no `{word}` in: {line}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn no_loader_is_code_3() {
    let folder = inputs();
    // What is found first under the loader's name is none.
    fs::create_dir(folder.path().join("broken")).unwrap();
    fs::write(folder.path().join("broken/libOpenCL.so.1"), "no library").unwrap();
    let run = |args: &[&str]| {
        let mut command = Command::new(PROGRAM);
        command.current_dir(folder.path()).args(args).env_remove("OPENCL_DYLIB_PATH");
        command.env("LD_LIBRARY_PATH", folder.path().join("broken")).output().unwrap()
    };
    let before = files(folder.path());
    let line = failed(&run(&RUN), 3, &RUN);
    assert!(files(folder.path()) == before);
    says(&line, &["OpenCL loader", "libOpenCL.so.1", "not found", "--backend cpu"]);
    let devices = run(&["devices"]);
    assert_eq!(devices.status.code(), Some(0));
    says(&String::from_utf8(devices.stdout).unwrap(), &["cpu", "ocl", "cannot be used: ", "libOpenCL.so.1"]);
    assert_eq!(run(&["integrate", "white.xyz", "--backend", "cpu", "--json"]).status.code(), Some(0));
}

#[test]
fn no_platform_and_no_device_are_code_3() {
    let Some(place) = Place::new() else { return };
    says(&place.fails("clGetPlatformIDs:1+:-1001", 3), &["no OpenCL platform", "install the driver", "--backend cpu"]);
    says(&place.fails("clGetPlatformIDs:1+:-6", 3), &["platforms cannot be listed", "--backend cpu"]);
    says(&place.fails("clGetDeviceIDs:1+:-1", 3), &["no platform has a device", "--backend cpu"]);
    let output = place.run("clGetDeviceIDs:1+:-1", &["devices"]);
    assert_eq!(output.status.code(), Some(0));
    says(&String::from_utf8(output.stdout).unwrap(), &["cpu", "cannot be used: ", "no platform has a device"]);
    // To fail is not to have none.
    says(
        &place.fails("clGetDeviceIDs:1+:-5", 3),
        &["cannot list the devices", "CL_OUT_OF_RESOURCES (-5)", "--backend cpu"],
    );
    let output = place.run("clGetDeviceIDs:1+:-5", &["devices"]);
    assert_eq!(output.status.code(), Some(0));
    says(&String::from_utf8(output.stdout).unwrap(), &["cpu", "cannot be used: ", "CL_OUT_OF_RESOURCES (-5)"]);
}

#[test]
fn a_device_that_does_not_answer_is_not_one_without_doubles() {
    let Some(place) = Place::new() else { return };
    let mut call = 0;
    loop {
        call += 1;
        let output = place.run(&format!("clGetDeviceInfo:{call}:-5"), &["devices"]);
        if !place.clear() {
            break;
        }
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.code() == Some(0) && !said.contains("no double precision"), "call {call}: {said}");
        let is_told = said.contains("does not answer for it: CL_OUT_OF_RESOURCES (-5)");
        assert!(
            is_told || said.contains("a device without a name") || said.contains(&place.device),
            "call {call}: {said}"
        );
    }
    assert!(call > 8);
    says(&place.fails("clGetDeviceInfo:1+:-5", 3), &["does not answer", "CL_OUT_OF_RESOURCES (-5)", "--backend cpu"]);
}

#[test]
fn a_device_without_doubles_is_code_3() {
    let Some(place) = Place::new() else { return };
    says(&place.fails("no-doubles", 3), &["no double precision", "--backend cpu"]);
    let output = place.run("no-doubles", &["devices"]);
    assert_eq!(output.status.code(), Some(0));
    says(&String::from_utf8(output.stdout).unwrap(), &["cannot be used: it has no double precision"]);
    let args = ["integrate", "white.xyz", "--backend", "ocl", "--device", "0"];
    says(&failed(&place.run("no-doubles", &args), 3, &args), &["device 0", "no double precision", "--precision f32"]);
    // It has all that single precision needs.
    let single: Vec<&str> = args.iter().copied().chain(["--precision", "f32", "--json"]).collect();
    let output = place.run("no-doubles", &single);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    says(&String::from_utf8(output.stdout).unwrap(), &["\"precision\":\"f32\"", "\"uncertified\":0", "\"cells\":2000"]);
}

#[test]
fn a_kernel_that_does_not_build_shows_its_log() {
    let Some(place) = Place::new() else { return };
    // Without its options the text lacks the room of a cell. A driver may have a word on standard error, too.
    let before = files(place.path());
    let output = place.run("no-build", &RUN);
    assert_eq!(output.status.code(), Some(3));
    assert!(output.stdout.is_empty() && files(place.path()) == before);
    let said = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<&str> = said.lines().filter(|line| line.starts_with("laguerre: ")).collect();
    assert_eq!(lines.len(), 1, "{said}");
    says(lines[0], &[&place.device, "OpenCL", "do not build", "CAP_P", "error", "--backend cpu"]);
    assert!(lines[0].len() < 1500, "{}", lines[0]);
    says(&place.fails("clBuildProgram:1+:-6", 3), &["do not build", "OUT_OF_HOST_MEMORY"]);
    says(&place.fails("clCreateKernel:1:-46", 3), &["OpenCL failed creating", "INVALID_KERNEL_NAME"]);
}

#[test]
fn memory_that_is_not_there_makes_batches_smaller_and_then_an_error() {
    let Some(mut place) = Place::new() else { return };
    // So many that the records of their facets, 17 MB, can do with several times less; all else needs 3 MB at most.
    runs(place.path(), &["sample", "white", "20000", "-o", "white.xyz"]);
    assert_eq!(place.run("", &RUN).status.code(), Some(0));
    place.wanted = files(place.path());
    place.clear();
    for code in [NO_MEMORY, TOO_LARGE] {
        let fault = format!("clCreateBuffer:>4000000:{code}");
        let output = place.run(&fault, &RUN);
        assert_eq!(output.status.code(), Some(0), "{fault}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(place.path().join("fired").exists(), "{fault} did not happen");
        let _ = fs::remove_file(place.path().join("fired"));
        assert!(files(place.path()) == place.wanted, "{fault} changed results");
        place.clear();
        // Nothing fits.
        let line = place.fails(&format!("clCreateBuffer:>1000:{code}"), 3);
        says(
            &line,
            &[&place.device, "OpenCL failed allocating", " bytes for ", "use the CPU, or fewer sites", "--backend cpu"],
        );
    }
}

/// Facets that have no room, or no kernel, to be put in order by the device are put so by the host: to the bit the same.
#[test]
fn facets_that_the_device_cannot_put_in_order_are_the_hosts() {
    let Some(place) = Place::new() else { return };
    let log = place.path().join("calls");
    assert_eq!(place.command("", &RUN).env("LAGUERRE_FAULT_CALLS", &log).output().unwrap().status.code(), Some(0));
    let calls = fs::read_to_string(&log).unwrap();
    fs::remove_file(&log).unwrap();
    place.clear();
    // The last of each are theirs: five columns and the rows; what counts these, adds the counts up, and writes the columns.
    for (function, last) in [("clCreateBuffer", 6), ("clEnqueueNDRangeKernel", 3)] {
        let count = calls.lines().filter(|call| call.starts_with(function)).count();
        for call in count - last + 1..=count {
            let fault = format!("{function}:{call}:{NO_MEMORY}");
            let output = place.run(&fault, &RUN);
            assert_eq!(output.status.code(), Some(0), "{fault}: {}", String::from_utf8_lossy(&output.stderr));
            let mut left = files(place.path());
            left.remove(&place.path().join("fired"));
            assert!(place.clear() && left == place.wanted, "{fault}");
        }
    }
}

/// Drivers that allocate late say so when a kernel is run: one that computes cells is run again on fewer.
#[test]
fn memory_that_is_not_there_late_makes_batches_smaller_and_then_an_error() {
    let Some(place) = Place::new() else { return };
    for code in [NO_MEMORY, NO_RESOURCES] {
        let (mut call, mut recovered) = (0, 0);
        loop {
            call += 1;
            let fault = format!("clEnqueueNDRangeKernel:{call}:{code}");
            let output = place.run(&fault, &RUN);
            let mut left = files(place.path());
            left.remove(&place.path().join("fired"));
            if !place.clear() {
                break;
            }
            let said = String::from_utf8_lossy(&output.stderr);
            match output.status.code() {
                Some(0) => {
                    assert!(left == place.wanted, "{fault} changed results");
                    recovered += 1;
                }
                Some(3) => says(
                    &said,
                    &[&place.device, "OpenCL failed running ", "use the CPU, or fewer sites", "--backend cpu"],
                ),
                other => panic!("{fault}: {other:?}: {said}"),
            }
        }
        // All cells; those at the surface are too few to be halved.
        assert!(call > 8 && recovered > 0, "{recovered} of {call} calls");
    }
    place.fails(&format!("clEnqueueNDRangeKernel:8+:{NO_MEMORY}"), 3);
}

#[test]
fn a_device_of_small_work_groups_is_code_3() {
    let Some(place) = Place::new() else { return };
    place.survives("groups-of:256").unwrap();
    for size in ["1", "16", "255"] {
        let fault = format!("groups-of:{size}");
        says(&place.fails(&fault, 3), &[&place.device, &format!("at most {size} work-items"), "256", "--backend cpu"]);
        let output = place.run(&fault, &["devices"]);
        assert_eq!(output.status.code(), Some(0));
        says(&String::from_utf8(output.stdout).unwrap(), &["cannot be used: its work-groups", "256"]);
    }
}

/// No call that fails changes results: there is an error, or the same results.
#[test]
fn an_error_in_mid_run_is_never_a_partial_result() {
    let Some(place) = Place::new() else { return };
    let mut wrong = Vec::new();
    let mut happened = BTreeMap::new();
    for (function, code) in [
        ("clGetPlatformIDs", NO_HOST_MEMORY),
        ("clGetPlatformInfo", NO_HOST_MEMORY),
        ("clGetDeviceIDs", NO_RESOURCES),
        ("clGetDeviceInfo", NO_RESOURCES),
        ("clCreateContext", NO_RESOURCES),
        ("clCreateCommandQueue", NO_RESOURCES),
        ("clCreateCommandQueueWithProperties", NO_RESOURCES),
        ("clCreateProgramWithSource", NO_RESOURCES),
        ("clBuildProgram", NO_RESOURCES),
        ("clCreateKernel", NO_RESOURCES),
        ("clGetKernelWorkGroupInfo", NO_RESOURCES),
        ("clCreateBuffer", NO_RESOURCES),
        ("clEnqueueWriteBuffer", NO_QUEUE),
        ("clEnqueueFillBuffer", NO_QUEUE),
        ("clEnqueueCopyBuffer", NO_QUEUE),
        ("clEnqueueNDRangeKernel", NO_QUEUE),
        ("clFlush", NO_QUEUE),
        ("clFinish", NO_QUEUE),
        ("clWaitForEvents", NO_QUEUE),
        ("clEnqueueReadBuffer", NO_QUEUE),
    ] {
        happened.insert(function, place.sweep(function, code, &mut wrong));
    }
    println!("calls that failed: {happened:?}");
    assert!(happened["clEnqueueNDRangeKernel"] > 1 && happened["clEnqueueReadBuffer"] > 1, "{happened:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// As above, for calls that a driver hardly ever lets fail.
#[test]
fn calls_that_hardly_ever_fail_are_no_panic() {
    let Some(place) = Place::new() else { return };
    let mut wrong = Vec::new();
    for function in [
        "clGetKernelInfo",
        "clSetKernelArg",
        "clGetCommandQueueInfo",
        "clReleaseEvent",
        "clReleaseKernel",
        "clReleaseProgram",
        "clReleaseMemObject",
        "clReleaseCommandQueue",
        "clReleaseContext",
    ] {
        place.sweep(function, NO_RESOURCES, &mut wrong);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// From one call on, every call fails: the device has gone.
#[test]
fn a_lost_device_is_an_error() {
    let Some(place) = Place::new() else { return };
    let mut wrong = Vec::new();
    for fault in [
        "lost:clEnqueueNDRangeKernel:1:-36",
        "lost:clEnqueueNDRangeKernel:4:-36",
        "lost:clEnqueueReadBuffer:1:-36",
        "lost:clEnqueueReadBuffer:3:-36",
        "lost:clFinish:2:-36",
    ] {
        wrong.extend(place.survives(fault).err());
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
