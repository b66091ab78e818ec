//! An OpenCL loader that notes calls, and lets some fail (`backend-ocl/faults`).

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use laguerre_core::required::is_required;

/// Has OpenCL loaded by it in this program, with this fault (none if empty); where it notes the calls. `None` where it is not there.
///
/// To be called before anything else reads the environment: by the only test of a program.
pub(crate) fn begin(name: &str, fault: &str) -> Option<PathBuf> {
    let loader = loader()?;
    let log = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
    fs::write(&log, "").unwrap();
    // SAFETY: the caller is the only test of its program, and no other thread reads the environment yet.
    unsafe {
        env::set_var("OPENCL_DYLIB_PATH", &loader);
        env::set_var("LAGUERRE_FAULT_CALLS", &log);
        if !fault.is_empty() {
            env::set_var("LAGUERRE_FAULT", fault);
        }
    }
    Some(log)
}

/// It: cargo puts it beside a test when it builds the whole workspace, else one folder up.
fn loader() -> Option<PathBuf> {
    let name = format!("{}laguerre_ocl_faults{}", env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX);
    let test = env::current_exe().unwrap();
    let found = test.ancestors().skip(1).take(2).map(|folder| folder.join(&name)).find(|path| path.exists());
    if found.is_none() {
        let message =
            format!("{name} is not beside {}: run `cargo build -p laguerre-ocl-faults` first", test.display());
        assert!(!is_required("ocl"), "{message}");
        eprintln!("not run: {message}");
    }
    found
}
