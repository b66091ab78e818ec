//! `cargo xtask count`: the instructions that fixed small inputs take on the CPU, counted by valgrind, held to `benches/instructions.txt`. A count does not
//! depend on what else a machine does (two runs differ by one in a hundred thousand), and so shows what a timing cannot: one percent.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::run::{cargo, root, succeed, target};

/// What a count may be over its limit, as a share, before it is a failure: the limit is changed then, with a reason in the commit, or the code.
const MOST_OVER: f64 = 0.03;

struct Input {
    name: &'static str,
    /// What `laguerre sample` is told, and `laguerre integrate`.
    sample: &'static [&'static str],
    integrate: [&'static str; 2],
}

const INPUTS: [Input; 8] = [
    Input { name: "white", sample: &["white", "3000"], integrate: BOX },
    Input { name: "blue", sample: &["blue", "3000"], integrate: BOX },
    Input { name: "lattice", sample: &["lattice", "3000"], integrate: BOX },
    Input { name: "white-bunny", sample: &["white", "3000", "--domain", MESH], integrate: BUNNY },
    Input { name: "inside-bunny", sample: &["white", "1500", "--domain", MESH, "--inside"], integrate: BUNNY },
    Input { name: "levy", sample: &["levy", "1500"], integrate: BOX },
    Input { name: "bumpy", sample: &["bumpy", "1000"], integrate: BOX },
    Input { name: "quadratic", sample: &["quadratic-0.9", "3000"], integrate: BOX },
];
const MESH: &str = "fixtures/meshes/bunny.obj";
const BOX: [&str; 2] = ["--box", "0,0,0,1,1,1"];
const BUNNY: [&str; 2] = ["--domain", MESH];

const LIMITS: &str = "benches/instructions.txt";
const HEAD: &str = "# Millions of instructions: limits that `cargo xtask count` holds the program to, and `cargo xtask count --write` makes anew.\n";

pub(crate) fn run(writes: bool) -> Result<(), String> {
    succeed(Command::new("valgrind").arg("--version"))
        .map_err(|error| format!("{error}: install valgrind (Debian: apt-get install valgrind)"))?;
    let compiler = succeed(Command::new("rustc").arg("--version"))?;
    let compiler = compiler.trim();
    cargo(&["build", "--locked", "--release", "-p", "laguerre-cli"], &[])?;
    let program = target().join("release/laguerre");
    let folder = target().join("count");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut counts = Vec::new();
    for input in &INPUTS {
        counts.push((input.name, count(&program, &folder, input)?));
    }
    let path = root().join(LIMITS);
    if writes {
        let mut text = format!("{HEAD}# {compiler}\n");
        for (name, count) in counts {
            let _ = writeln!(text, "{name} {count:.1}");
        }
        return fs::write(&path, text).map_err(|error| format!("{LIMITS}: {error}"));
    }
    let text = fs::read_to_string(&path).map_err(|error| format!("{LIMITS}: {error}"))?;
    let (table, over) = compared(&counts, &text);
    print!("{table}");
    // (Far cells take the widest vectors that there are, and valgrind has those of AVX2.)
    let is_the_same = text.lines().any(|line| line.strip_prefix("# ") == Some(compiler)) && has_avx2();
    if !is_the_same {
        println!(
            "(the limits are another compiler's than {compiler}, or another kind of CPU's: nothing is held to them)"
        );
        return Ok(());
    }
    match over.is_empty() {
        true => Ok(()),
        false => Err(format!(
            "more instructions than {LIMITS} allows: {} (if there is a reason, `cargo xtask count --write`, and say it)",
            over.join(", ")
        )),
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_avx2() -> bool {
    false
}

/// Millions of instructions that the cells of an input take, on one thread.
fn count(program: &Path, folder: &Path, input: &Input) -> Result<f64, String> {
    let &Input { name, sample, integrate } = input;
    let (sites, cells) = (folder.join(format!("{name}.npy")), folder.join("cells.npy"));
    succeed(Command::new(program).current_dir(root()).arg("sample").args(sample).arg("-o").arg(&sites))?;
    let output = Command::new("valgrind")
        .current_dir(root())
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .arg("integrate")
        .arg(&sites)
        .args(integrate)
        .args(["--backend", "cpu", "--threads", "1", "-o"])
        .arg(&cells)
        .output()
        .map_err(|error| format!("valgrind did not start: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let collected = said.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse::<f64>().ok());
    match collected.filter(|_| output.status.success()) {
        Some(count) => Ok(count / 1e6),
        None => Err(format!("valgrind, {name}: {}", said.trim_end())),
    }
}

/// A line for each count beside its limit, and those that are too far over it, or have none.
fn compared(counts: &[(&str, f64)], limits: &str) -> (String, Vec<String>) {
    let (mut table, mut over) = (String::new(), Vec::new());
    for &(name, count) in counts {
        let limit = limits.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' ')?.parse::<f64>().ok());
        let Some(limit) = limit else {
            over.push(format!("{name} (no limit)"));
            continue;
        };
        let change = count / limit - 1.0;
        let _ =
            writeln!(table, "{name:<16} {count:>8.1} million instructions, limit {limit:.1}: {:+.1} %", 100.0 * change);
        if change > MOST_OVER {
            over.push(name.to_owned());
        }
    }
    (table, over)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_over_its_limit_is_named() {
        let limits = "# head\nwhite 100.0\nwhite-bunny 200.0\n";
        let (table, over) = compared(&[("white", 103.1), ("white-bunny", 205.0), ("levy", 1.0)], limits);
        assert_eq!(over, ["white", "levy (no limit)"]);
        assert!(table.contains("white-bunny") && table.contains("+2.5 %") && table.contains("+3.1 %"), "{table}");
    }
}
