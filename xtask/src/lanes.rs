//! The conformance suite where work-items compute a cell together and really talk: in sub-groups, which PoCL lacks. Intel's OpenCL for CPUs has them.

use std::fs;

use crate::run::{cargo_test, install, target};

/// From PyPI: the runtime, and what it loads.
const PACKAGES: [&str; 3] = ["intel-opencl-rt==2026.2.0", "intel-cmplr-lib-rt==2026.2.0", "tbb==2023.2.0"];

/// Cases of a law: with them the suite takes 13 minutes on 2 cores.
const CASES: &str = "2";

pub(crate) fn run() -> Result<(), String> {
    let home = target().join("intel-opencl");
    let library = home.join("lib/libintelocl.so");
    if !library.exists() {
        install(&home, &PACKAGES)?;
    }
    let vendors = home.join("vendors");
    let written = fs::create_dir_all(&vendors)
        .and_then(|()| fs::write(vendors.join("intel.icd"), format!("{}\n", library.display())));
    written.map_err(|error| format!("{}: {error}", vendors.display()))?;
    let (vendors, libraries) = (vendors.display().to_string(), home.join("lib").display().to_string());
    let variables = [
        ("OCL_ICD_VENDORS", vendors.as_str()),
        ("LD_LIBRARY_PATH", &libraries),
        ("LAGUERRE_REQUIRE", "ocl-lanes"),
        ("PROPTEST_CASES", CASES),
    ];
    let line = ["test", "--locked", "--workspace", "--all-features", "--test", "conformance", "--", "ocl-lanes::"];
    let (counts, ok) = cargo_test(&line, &variables)?;
    println!("{counts}");
    if ok && counts.passed > 0 { Ok(()) } else { Err("the suite failed with lanes that talk".to_owned()) }
}
