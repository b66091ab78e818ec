//! The program's files before those who read them: PyVista (VTK), meshio and trimesh, by `scripts/check_readers.py`.

use std::path::Path;
use std::process::Command;

use crate::run::{cargo, root, succeed, target};

/// From PyPI. A version of VTK is one way to take a polyhedron apart: with another, `core/src/io/polyhedra.rs` is to be looked at again.
const PACKAGES: [&str; 5] = ["pyvista==0.49.1", "vtk==9.7.2", "meshio==5.3.5", "trimesh==5.2.0", "numpy==2.4.6"];

pub(crate) fn run() -> Result<(), String> {
    let home = target().join("readers");
    let python = home.join("bin/python");
    let has_all = Command::new(&python).args(["-c", "import pyvista, meshio, trimesh"]).output();
    if !has_all.is_ok_and(|output| output.status.success()) {
        install(&home)?;
    }
    // The program as its own tests have it, so that nothing is built twice.
    cargo(&["test", "--locked", "--workspace", "--all-features", "--no-run", "--test", "program"], &[])?;
    let program = target().join("debug").join(format!("laguerre{}", std::env::consts::EXE_SUFFIX));
    let mut script = Command::new(python);
    print!("{}", succeed(script.arg(root().join("scripts/check_readers.py")).arg(program))?);
    Ok(())
}

/// Into a folder of its own.
fn install(home: &Path) -> Result<(), String> {
    succeed(Command::new("python3").args(["-m", "venv"]).arg(home))?;
    let mut pip = Command::new(home.join("bin/pip"));
    succeed(pip.args(["install", "--quiet", "--disable-pip-version-check"]).args(PACKAGES)).map(drop)
}
