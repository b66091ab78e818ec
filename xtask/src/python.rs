//! The Python module: its wheel, and its tests and examples in an environment of their own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::guide::Page;
use crate::run::{cargo, install, root, succeed, target};

/// From PyPI: what builds the wheel.
const MATURIN: &str = "maturin==1.16.0";
/// That, and what tests and examples import.
const PACKAGES: [&str; 8] = [
    MATURIN,
    "pytest==9.2.0",
    "numpy==2.4.6",
    "scipy==1.17.1",
    "pyvista==0.49.1",
    // PyVista's films.
    "imageio==2.38.1",
    "jax==0.10.2",
    // Holds annotations to the code, and the stub to what it is of.
    "mypy==2.4.1",
];

/// A wheel for users, in `target/wheels`.
pub(crate) fn wheel() -> Result<(), String> {
    let python = environment("maturin", "import maturin", &[MATURIN])?;
    let folder = target().join("wheels");
    build(&python, &folder, "release")?;
    println!("the wheel is in {}", folder.display());
    Ok(())
}

/// Builds the wheel as tests are built, installs it, and runs its tests and examples.
pub(crate) fn test() -> Result<(), String> {
    let home = target().join("python-module");
    let lints = ["clippy", "--locked", "--manifest-path", "python/Cargo.toml", "--", "-D", "warnings"];
    cargo(&lints, &[("CARGO_TARGET_DIR", &home.to_string_lossy())])?;
    // With it the module is compared, as the guide and the program's own tests have it, so that nothing is built twice.
    cargo(&["test", "--locked", "--workspace", "--all-features", "--no-run", "--test", "program"], &[])?;
    let python = tools()?;
    let folder = target().join("python-wheels");
    // One wheel: the one that is built now.
    let _ = fs::remove_dir_all(&folder);
    build(&python, &folder, "dev")?;
    let wheel = fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?.flatten().next();
    let wheel = wheel.ok_or("maturin has made no wheel")?.path();
    let mut pip = module(&python, &["pip", "install", "--quiet", "--disable-pip-version-check"]);
    succeed(pip.args(["--force-reinstall", "--no-deps"]).arg(wheel))?;
    let sources = root().join("python");
    succeed(module(&python, &["mypy", "laguerre"]).current_dir(&sources))?;
    // Beside the sources `import laguerre` would find those.
    let tests = sources.join("tests");
    let stubtest = ["mypy.stubtest", "--mypy-config-file", "../pyproject.toml", "laguerre._laguerre"];
    succeed(module(&python, &stubtest).current_dir(&tests))?;
    let mut pytest = module(&python, &["pytest", "-q", "-p", "no:cacheprovider"]);
    let program = target().join("debug/laguerre").with_extension(std::env::consts::EXE_EXTENSION);
    print!("{}", succeed(pytest.current_dir(tests).env("LAGUERRE_PROGRAM", program))?);
    examples(&python)
}

/// Runs all of `python/examples/` and what README.md shows, pictures without a screen.
fn examples(python: &Path) -> Result<(), String> {
    let scratch = target().join("python-examples");
    fs::create_dir_all(&scratch).map_err(|e| format!("{}: {e}", scratch.display()))?;
    let folder = root().join("python/examples");
    let entries = fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut scripts: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    // PyTorch is too large to be installed for one example.
    let has_torch = Command::new(python).args(["-c", "import torch"]).output().is_ok_and(|o| o.status.success());
    scripts.retain(|script| has_torch || !script.ends_with("gradients.py"));
    scripts.sort();
    for page in ["README.md", "python/README.md"] {
        for block in Page::read(&root().join(page))?.blocks("python") {
            let script = scratch.join(format!("{}-{}.py", page.replace('/', "-"), block.line));
            fs::write(&script, block.text).map_err(|e| format!("{}: {e}", script.display()))?;
            scripts.push(script);
        }
    }
    for script in scripts {
        let mut run = Command::new(python);
        run.arg(&script).current_dir(&scratch).env("PYVISTA_OFF_SCREEN", "true");
        print!("{}", succeed(&mut run).map_err(|e| format!("{}: {e}", script.display()))?);
    }
    Ok(())
}

fn tools() -> Result<PathBuf, String> {
    environment("python", "import maturin, pytest, scipy, pyvista, imageio, jax, mypy", &PACKAGES)
}

fn build(python: &Path, folder: &Path, profile: &str) -> Result<(), String> {
    let mut maturin = module(python, &["maturin", "build", "--locked", "--quiet", "--profile", profile, "--out"]);
    maturin.arg(folder).current_dir(root().join("python"));
    // A workspace of its own, with a folder of its own for what it builds.
    succeed(maturin.env("CARGO_TARGET_DIR", target().join("python-module"))).map(drop)
}

fn module(python: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(python);
    command.arg("-m").args(arguments);
    command
}

/// The Python of an environment with `packages`, made where `imports` do not work there.
pub(crate) fn environment(name: &str, imports: &str, packages: &[&str]) -> Result<PathBuf, String> {
    let home = target().join(name);
    let python = home.join("bin/python");
    let has_all = Command::new(&python).args(["-c", imports]).output();
    if !has_all.is_ok_and(|output| output.status.success()) {
        install(&home, packages)?;
    }
    Ok(python)
}
