//! What `--backend auto`, the default, takes. The loader of the faults makes any device say that it is a GPU.

use std::process::Command;

use crate::devices::{is_required, loader};
use crate::support::{PROGRAM, inputs, json};

#[test]
fn a_gpu_computes_where_one_can_be_used() {
    let Some(loader) = loader() else { return };
    let folder = inputs();
    let run = |fault: &str, args: &[&str]| {
        let mut command = Command::new(PROGRAM);
        command.current_dir(folder.path()).args(args).env("OPENCL_DYLIB_PATH", &loader).env("LAGUERRE_FAULT", fault);
        command.output().unwrap()
    };
    let backend = |fault: &str, more: &[&str]| {
        let args = [&["integrate", "white.xyz", "--json"], more].concat();
        let output = run(fault, &args);
        assert_eq!(output.status.code(), Some(0), "{fault}: {}", String::from_utf8_lossy(&output.stderr));
        json(&String::from_utf8(output.stdout).unwrap())["backend"].as_str().unwrap().to_owned()
    };
    let devices = json(&String::from_utf8(run("gpu", &["devices", "--json"]).stdout).unwrap());
    let devices = devices["ocl"]["devices"].as_array().unwrap();
    if !devices.iter().any(|device| device["unusable"].is_null()) {
        assert!(!is_required(), "{devices:?}");
        return;
    }
    assert!(devices.iter().all(|device| device["gpu"] == true), "{devices:?}");
    for (fault, more, expected) in [
        ("gpu", &[][..], "ocl"),
        ("gpu", &["--backend", "auto"], "ocl"),
        ("gpu", &["--backend", "cpu"], "cpu"),
        ("gpu", &["--threads", "1"], "cpu"),
        // No GPU that can be used, or opened.
        ("gpu,no-doubles", &[], "cpu"),
        ("gpu,clCreateContext:1+:-5", &[], "cpu"),
        ("clGetPlatformIDs:1+:-6", &[], "cpu"),
    ] {
        assert_eq!(backend(fault, more), expected, "{fault} {more:?}");
    }
    // A seed makes the same sites, whatever computes.
    let blue = ["gpu", ""].map(|fault| run(fault, &["sample", "blue", "300", "-o", "-"]).stdout);
    assert!(!blue[0].is_empty() && blue[0] == blue[1]);
}
