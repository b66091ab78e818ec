//! An OpenCL loader that notes calls, and lets some fail (`backend-ocl/faults`).

use std::env;
use std::path::PathBuf;

use laguerre_core::required::is_required;

/// It: cargo puts it beside a test when it builds the whole workspace, else one folder up.
pub(crate) fn loader() -> Option<PathBuf> {
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
