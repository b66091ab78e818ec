//! Outputs that cannot be written, and a program that is stopped: nothing half-written, nothing lost.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::{PROGRAM, UNIT_BOX, failed, fails, files, inputs, laguerre, runs};

const RESULTS: [&str; 7] =
    ["cells.csv", "cells.npy", "cells.npz", "cells.vtu", "facets.csv", "facets.npy", "facets.npz"];

/// The arguments that write one of [`RESULTS`].
fn writing(name: &str) -> Vec<&str> {
    let option = if name.starts_with("facets") { "--facets" } else { "-o" };
    vec!["integrate", "white.xyz", "--box", UNIT_BOX, option, name]
}

#[test]
fn where_no_file_can_be_is_said_before_the_work() {
    let folder = inputs();
    let folder = folder.path();
    for name in RESULTS {
        let said = |path: &str| {
            let option = if name.starts_with("facets") { "--facets" } else { "-o" };
            // Before even the sites are read: there are none.
            fails(folder, 2, &["integrate", "gone.xyz", option, path])
        };
        let missing = format!("nowhere/{name}");
        assert_eq!(said(&missing), format!("{missing}: there is no folder 'nowhere'; make it first"));
        let taken = format!("white.xyz/{name}");
        assert_eq!(said(&taken), format!("{taken}: there is no folder 'white.xyz'; make it first"));
        fs::create_dir(folder.join(name)).unwrap();
        assert_eq!(said(name), format!("{name}: cannot write: it is a folder; name a file"));
        fs::remove_dir(folder.join(name)).unwrap();
    }
    let args = ["sample", "white", "9", "-o", "nowhere/s.xyz"];
    assert_eq!(fails(folder, 2, &args), "nowhere/s.xyz: there is no folder 'nowhere'; make it first");
}

#[cfg(unix)]
#[test]
fn a_file_keeps_its_mode_and_a_link_what_it_names() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = inputs();
    let folder = folder.path();
    for name in RESULTS {
        let path = folder.join(name);
        fs::write(&path, "old results").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
        runs(folder, &writing(name));
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600, "{name}");
        let whole = fs::read(&path).unwrap();
        assert_ne!(whole, b"old results", "{name}");
        fs::remove_file(&path).unwrap();
        // What the link names is not there yet.
        let target = folder.join(format!("target-{name}"));
        symlink(target.file_name().unwrap(), &path).unwrap();
        runs(folder, &writing(name));
        assert!(fs::symlink_metadata(&path).unwrap().is_symlink(), "{name}");
        assert!(fs::read(&target).unwrap() == whole, "{name}");
        fs::remove_file(target).unwrap();
    }
    // Two names of one file that is still to be made.
    let line = fails(folder, 2, &["integrate", "white.xyz", "-o", "target-facets.csv", "--facets", "facets.csv"]);
    assert_eq!(line, "facets.csv: named for cells and for facets; give two files");
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_read_only_is_said_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
    let folder = inputs();
    let folder = folder.path();
    let closed = folder.join("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).unwrap();
    // Who runs this may be above permissions; what the kernel keeps for itself nobody writes.
    let mut places = vec![];
    if fs::write(closed.join("try"), "").is_err() {
        places.push("closed");
    }
    if cfg!(target_os = "linux") {
        places.push("/proc");
    }
    for place in places {
        for name in RESULTS {
            let path = format!("{place}/{name}");
            let option = if name.starts_with("facets") { "--facets" } else { "-o" };
            let line = fails(folder, 2, &["integrate", "gone.xyz", option, &path]);
            assert!(line.starts_with(&format!("{path}: cannot write: ")), "{line}");
        }
    }
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn what_is_read_is_not_written_over() {
    let folder = inputs();
    let folder = folder.path();
    fs::write(folder.join("w.csv"), "1\n").unwrap();
    runs(folder, &["sample", "white", "9", "-o", "sites.npy"]);
    let refused = |name: &str| format!("{name}: would be written over, but is read; name another file");
    assert_eq!(fails(folder, 2, &["integrate", "sites.npy", "-o", "./sites.npy"]), refused("./sites.npy"));
    assert_eq!(
        fails(folder, 2, &["integrate", "sites.npy", "--weights", "w.csv", "--facets", "w.csv"]),
        refused("w.csv")
    );
    fs::write(folder.join("mesh.ply"), "").unwrap();
    assert_eq!(
        fails(folder, 2, &["sample", "white", "9", "--domain", "mesh.ply", "-o", "mesh.ply"]),
        refused("mesh.ply")
    );
}

/// A limit on the size of files is a disk that fills at that place.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_leaves_the_old_file_and_no_other() {
    let folder = inputs();
    let folder = folder.path();
    for name in RESULTS {
        for old in [None, Some("old results")] {
            let _ = fs::remove_file(folder.join(name));
            if let Some(old) = old {
                fs::write(folder.join(name), old).unwrap();
            }
            let before = files(folder);
            let mut command = Command::new("sh");
            // Without the trap the limit would be a signal.
            command.current_dir(folder).args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"", PROGRAM]);
            let output = command.args(writing(name)).output().unwrap();
            let line = failed(&output, 2, &writing(name));
            assert!(line.starts_with(&format!("{name}: cannot write: ")), "{line}");
            assert!(files(folder) == before, "{name}: {:?}", files(folder).keys());
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error() {
    let folder = inputs();
    let folder = folder.path();
    for name in RESULTS {
        std::os::unix::fs::symlink("/dev/full", folder.join(name)).unwrap();
        let line = failed(&laguerre(folder, &writing(name)), 2, &writing(name));
        assert!(line.starts_with(&format!("{name}: cannot write: No space left on device")), "{line}");
        assert!(fs::symlink_metadata(folder.join(name)).unwrap().is_symlink());
        fs::remove_file(folder.join(name)).unwrap();
    }
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(["integrate", "white.xyz", "--json"]);
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = command.stdout(full).output().unwrap();
    let line = failed(&output, 2, &["--json > /dev/full"]);
    assert!(line.starts_with("standard output: cannot write: No space left on device"), "{line}");
}

/// Starts the program with its signals as a terminal has them, sends it a signal once `ready`, and returns how it ended.
#[cfg(target_os = "linux")]
pub(crate) fn interrupted(
    folder: &Path,
    signal: &str,
    args: &[&str],
    ready: impl Fn() -> bool,
) -> std::process::Output {
    // A test that runs in the background has its interrupts ignored, and hands that on.
    let mut command = Command::new("env");
    command.args(["--default-signal=INT,TERM,HUP", PROGRAM]).current_dir(folder).args(args);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while !ready() {
        assert!(start.elapsed() < Duration::from_secs(60), "{args:?}: never ready");
        assert!(child.try_wait().unwrap().is_none(), "{args:?}: ended too soon");
        sleep(Duration::from_millis(1));
    }
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
    child.wait_with_output().unwrap()
}

/// Starts the program with its table going to a file, interrupts it so many times once the table has so many lines, and returns how it ended,
/// and the table.
#[cfg(target_os = "linux")]
pub(crate) fn interrupted_at(
    folder: &Path,
    args: &[&str],
    lines: usize,
    times: usize,
) -> (std::process::Output, String) {
    let path = folder.join("table.txt");
    let mut command = Command::new("env");
    command.args(["--default-signal=INT,TERM,HUP", PROGRAM]).current_dir(folder).args(args);
    let mut child = command.stdout(fs::File::create(&path).unwrap()).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while fs::read_to_string(&path).unwrap().lines().count() < lines {
        assert!(start.elapsed() < Duration::from_secs(60), "{args:?}: never ready");
        assert!(child.try_wait().unwrap().is_none(), "{args:?}: ended too soon");
        sleep(Duration::from_millis(1));
    }
    for _ in 0..times {
        // By the second it may have ended.
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
    }
    (child.wait_with_output().unwrap(), fs::read_to_string(path).unwrap())
}

/// Whether a file is being written.
#[cfg(target_os = "linux")]
fn half_written(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).unwrap().flatten();
    let mut parts = entries.filter(|entry| entry.file_name().to_string_lossy().ends_with(".part"));
    parts.any(|part| part.metadata().is_ok_and(|found| found.len() > 0))
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_leaves_nothing_half_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    runs(folder, &["sample", "white", "100000", "-o", "sites.npy"]);
    fs::write(folder.join("facets.csv"), "old results").unwrap();
    let before = files(folder);
    let start = Instant::now();
    let computing = || start.elapsed() > Duration::from_millis(500);
    let writing = || half_written(folder);
    let relax = ["sample", "blue", "300000", "-o", "blue.xyz"];
    let facets = ["integrate", "sites.npy", "--facets", "facets.csv", "--json"];
    for (what, output) in [
        ("in mid-run", interrupted(folder, "-INT", &relax, computing)),
        ("in mid-file", interrupted(folder, "-INT", &facets, writing)),
        ("ended", interrupted(folder, "-TERM", &facets, writing)),
    ] {
        assert_eq!(output.status.code(), Some(130), "{what}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(output.stdout.is_empty(), "{what}");
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(errors.lines().all(|line| line.starts_with("laguerre: note: ")), "{what}: {errors}");
        assert!(files(folder) == before, "{what}: {:?}", files(folder).keys());
    }
}
