//! Too little memory for what is asked: one line that names it, code 2, and nothing written.

use std::path::Path;
use std::process::Command;

use crate::support::{PROGRAM, UNIT_BOX, failed, inputs, runs};

/// What the program says with so many kilobytes of address space, where rayon's variable says how many cores there are.
fn said_within(folder: &Path, kilobytes: u32, cores: &str, args: &[&str]) -> String {
    let limited = format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
    let mut shell = Command::new("sh");
    shell.current_dir(folder).env("RAYON_NUM_THREADS", cores).args(["-c", &limited, PROGRAM]).args(args);
    failed(&shell.output().unwrap(), 2, args)
}

#[test]
fn what_there_is_no_memory_for_is_named() {
    let folder = inputs();
    for distribution in ["white", "lattice", "perturbed", "blue"] {
        let line = said_within(folder.path(), 1_000_000, "", &["sample", distribution, "400000000", "-o", "many.npy"]);
        assert!(line.starts_with("not enough memory for 400000000 sites, which take 9600 MB"), "{line}");
    }
    runs(folder.path(), &["sample", "white", "1000000", "-o", "million.npy"]);
    runs(folder.path(), &["sample", "white", "1000000", "-o", "million.xyz"]);
    let mut words = [0, 0];
    for sites in ["million.npy", "million.xyz"] {
        // From where the program starts to where it has memory enough.
        for (kilobytes, cores) in (40_000..340_000).step_by(50_000).flat_map(|n| [(n, ""), (n, "64")]) {
            // (On the CPU: PoCL, which is looked at otherwise, ends a process for whose threads it has no memory.)
            let args = ["integrate", sites, "--box", UNIT_BOX, "--backend", "cpu", "-o", "cells.npy"];
            let line = said_within(folder.path(), kilobytes, cores, &args);
            assert!(line.starts_with(&format!("{sites}: not enough memory for ")), "{kilobytes}: {line}");
            words[0] += usize::from(line.contains(" sites,"));
            words[1] += usize::from(line.contains(" cells,"));
        }
    }
    assert!(words.iter().all(|&count| count > 0), "{words:?}");
}
