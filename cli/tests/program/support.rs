//! What the tests of the program share: running it, and inputs.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_laguerre");

pub(crate) const UNIT_BOX: &str = "0,0,0,1,1,1";

/// The unit cube, its faces squares.
pub(crate) const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n\
    4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 3 0 4 7\n";

pub(crate) fn laguerre(folder: &Path, args: &[&str]) -> Output {
    Command::new(PROGRAM).current_dir(folder).args(args).output().unwrap()
}

/// Runs with `input` on standard input.
pub(crate) fn laguerre_with(folder: &Path, args: &[&str], input: &[u8]) -> Output {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(args).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A program that refuses its input does not read it to the end.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

/// Runs, expects success, returns standard output.
pub(crate) fn runs(folder: &Path, args: &[&str]) -> String {
    let output = laguerre(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs, expects success, returns the lines on standard error, all of them notes, without "laguerre: note: ".
pub(crate) fn notes(folder: &Path, args: &[&str]) -> Vec<String> {
    let output = laguerre(folder, args);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{args:?}: {errors}");
    let lines = errors.lines().map(|line| line.strip_prefix("laguerre: note: ").unwrap_or_else(|| panic!("{line}")));
    lines.map(str::to_owned).collect()
}

/// Runs, expects the exit code and failure as [`failed`], and that every file is as it was; returns the line.
pub(crate) fn fails(folder: &Path, code: i32, args: &[&str]) -> String {
    let before = files(folder);
    let line = failed(&laguerre(folder, args), code, args);
    assert_eq!(files(folder).keys().collect::<Vec<_>>(), before.keys().collect::<Vec<_>>(), "{args:?} left something");
    assert!(files(folder) == before, "{args:?} changed a file");
    line
}

/// Expects the exit code, nothing on standard output, and one line on standard error after any notes; returns it without
/// "laguerre: ".
pub(crate) fn failed(output: &Output, code: i32, args: &[&str]) -> String {
    let errors = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(code), "{args:?}: {errors}");
    assert!(output.stdout.is_empty(), "{args:?}: {}", String::from_utf8_lossy(&output.stdout));
    let mut lines: Vec<&str> = errors.lines().filter(|line| !line.starts_with("laguerre: note: ")).collect();
    let line = lines.pop().unwrap_or_default();
    assert!(lines.is_empty(), "{args:?}: more than one line: {errors}");
    assert!(!errors.contains("panicked"), "{args:?}: {errors}");
    let line = line.strip_prefix("laguerre: ");
    line.unwrap_or_else(|| panic!("{args:?}: {errors}")).to_owned()
}

/// Every file of a folder, hidden ones too, with its bytes.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.filter(|path| !path.is_dir()).map(|path| (path.clone(), fs::read(&path).unwrap_or_default())).collect()
}

pub(crate) fn json(text: &str) -> Value {
    assert_eq!(text.lines().count(), 1, "{text}");
    serde_json::from_str(text).unwrap()
}

/// A folder with 2,000 sites in the unit cube, the same with weights that hide most of them, and the cube.
pub(crate) fn inputs() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    runs(folder.path(), &["sample", "white", "2000", "-o", "white.xyz"]);
    let white = fs::read_to_string(folder.path().join("white.xyz")).unwrap();
    let mut strong = fs::File::create(folder.path().join("strong.xyz")).unwrap();
    for (i, line) in white.lines().enumerate() {
        // Spread over [0, 0.1) by the golden ratio.
        let weight = 0.1 * (i as f64 * 0.618_033_988_749_894_9).fract();
        writeln!(strong, "{line} {weight:?}").unwrap();
    }
    fs::write(folder.path().join("cube.off"), CUBE).unwrap();
    folder
}
