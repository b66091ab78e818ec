//! The program's files before those who read them: PyVista (VTK), meshio and trimesh, by `scripts/check_readers.py`.

use std::process::Command;

use crate::python::environment;
use crate::run::{cargo, root, succeed, target};

/// From PyPI. A version of VTK is one way to take a polyhedron apart: with another, `core/src/io/polyhedra.rs` is to be looked at again.
const PACKAGES: [&str; 5] = ["pyvista==0.49.1", "vtk==9.7.2", "meshio==5.3.5", "trimesh==5.2.0", "numpy==2.4.6"];

pub(crate) fn run() -> Result<(), String> {
    let python = environment("readers", "import pyvista, meshio, trimesh", &PACKAGES)?;
    // The program as its own tests have it, so that nothing is built twice.
    cargo(&["test", "--locked", "--workspace", "--all-features", "--no-run", "--test", "program"], &[])?;
    let program = target().join("debug").join(format!("laguerre{}", std::env::consts::EXE_SUFFIX));
    let mut script = Command::new(python);
    print!("{}", succeed(script.arg(root().join("scripts/check_readers.py")).arg(program))?);
    Ok(())
}
