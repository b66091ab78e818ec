//! Running cargo, and counting what its tests say.

use std::env;
use std::ffi::OsStr;
use std::fmt;
use std::io::{BufRead, BufReader};
use std::ops::AddAssign;
use std::path::{self, Path, PathBuf};
use std::process::{Command, Stdio};

/// Tests that passed, failed and were ignored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    pub(crate) ignored: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.ignored += other.ignored;
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed", self.passed, self.failed)?;
        if self.ignored > 0 { write!(f, ", {} ignored", self.ignored) } else { Ok(()) }
    }
}

/// Runs cargo with its output passed through.
pub(crate) fn cargo(arguments: &[&str], variables: &[(&str, &str)]) -> Result<(), String> {
    let status = command(arguments, variables).status().map_err(|error| format!("cargo did not start: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("cargo {} failed", arguments.join(" "))) }
}

/// Runs `cargo test …`, passes its output through line by line, and adds up its `test result:` lines. Whether all was well
/// is cargo's word, not the sum's: a test program that dies prints no sum.
pub(crate) fn cargo_test(arguments: &[&str], variables: &[(&str, &str)]) -> Result<(Counts, bool), String> {
    let failed = |error: std::io::Error| format!("cargo {}: {error}", arguments.join(" "));
    let mut child = command(arguments, variables).stdout(Stdio::piped()).spawn().map_err(failed)?;
    let mut counts = Counts::default();
    let output = child.stdout.take().ok_or("cargo has no output")?;
    let mut reader = BufReader::new(output);
    let mut line = Vec::new();
    // Bytes, not text: what a test prints need not be UTF-8.
    while reader.read_until(b'\n', &mut line).map_err(failed)? > 0 {
        let text = String::from_utf8_lossy(&line);
        print!("{text}");
        counts += counted(&text).unwrap_or_default();
        line.clear();
    }
    let status = child.wait().map_err(failed)?;
    Ok((counts, status.success()))
}

/// Cargo in the root of the workspace.
pub(crate) fn command(arguments: &[&str], variables: &[(&str, &str)]) -> Command {
    // Cargo says which cargo started this program.
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).envs(variables.iter().copied());
    // Tests and checks are of the whole, from wherever they are asked for.
    command.current_dir(root());
    command
}

/// The workspace's root.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_path_buf).unwrap_or_default()
}

/// Where cargo builds: relative to where this was called.
pub(crate) fn target() -> PathBuf {
    let folder = env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    path::absolute(&folder).unwrap_or(folder)
}

/// Runs a program to its end; what it prints, or why it failed.
pub(crate) fn succeed(command: &mut Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|error| format!("{name} did not start: {error}"))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    // What is wrong may be said on either: pytest says it on the first.
    let [out, err] = [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said).trim_end().to_owned());
    Err(format!("{name}: {}", if err.is_empty() { out } else { err }))
}

/// Installs packages of PyPI into a folder of their own, for which nothing else looks.
pub(crate) fn install<P: AsRef<OsStr>>(home: &Path, packages: &[P]) -> Result<(), String> {
    succeed(Command::new("python3").args(["-m", "venv"]).arg(home))?;
    let mut pip = Command::new(home.join("bin/pip"));
    succeed(pip.args(["install", "--quiet", "--disable-pip-version-check"]).args(packages)).map(drop)
}

/// The counts of a line `test result: ok. 4 passed; 1 failed; 0 ignored; …`, if it is one.
fn counted(line: &str) -> Option<Counts> {
    let (_, numbers) = line.trim().strip_prefix("test result: ")?.split_once(". ")?;
    let number = |word: &str| {
        let part = numbers.split(';').find(|part| part.trim().ends_with(word))?;
        part.trim().strip_suffix(word)?.trim().parse().ok()
    };
    Some(Counts { passed: number("passed")?, failed: number("failed")?, ignored: number("ignored")? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn result_lines_are_counted_and_others_are_not() {
        let line =
            "test result: FAILED. 12 passed; 3 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.15s\n";
        assert_eq!(counted(line), Some(Counts { passed: 12, failed: 3, ignored: 1 }));
        assert_eq!(counted("test places::result: ok. 1 passed ... ok"), None);
        assert_eq!(counted("test result: what"), None);
    }

    #[test]
    fn the_sum_is_one_line() {
        let mut sum = Counts { passed: 2, failed: 0, ignored: 0 };
        sum += Counts { passed: 3, failed: 1, ignored: 0 };
        assert_eq!(sum.to_string(), "5 passed, 1 failed");
    }
}
