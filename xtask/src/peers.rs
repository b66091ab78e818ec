//! `cargo xtask peers`: other programs beside this one on the same sites, in one run, turn by turn; their table in BENCHMARKS.md. What other programs
//! compute is in `benches/peers/`: voro++ and CGAL (headers, and a C++ compiler), meshless_voronoi (a crate), geogram (PyPI). Those that are not there are said.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::paper::replaced;
use crate::python::environment;
use crate::run::{cargo, root, succeed, target};

const BEGIN: &str = "<!-- peers: begin -->";
const END: &str = "<!-- peers: end -->";

/// Sites, and turns of which the table has medians.
const SITES: &str = "100000";
const TURNS: usize = 5;

/// What sites are cut by: a name in the table, what `laguerre bench` calls it, and where sites are put and cells are cut.
const CONTAINERS: [(&str, &str, [&str; 2]); 2] =
    [("the unit cube", "box", ["--box", "0,0,0,1,1,1"]), ("the bunny", "bunny", ["--domain", MESH])];
const MESH: &str = "fixtures/meshes/bunny.obj";

/// Another program that can be run here.
struct Peer {
    name: &'static str,
    run: PathBuf,
    before: Vec<String>,
    threads: usize,
    /// Whether it cuts cells by a mesh, too.
    cuts: bool,
}

/// What a program says of one run.
#[derive(Debug, PartialEq)]
struct Said {
    seconds: f64,
    /// The sum of the squares of all volumes, where it has volumes.
    squares: Option<f64>,
}

pub(crate) fn run() -> Result<(), String> {
    cargo(&["build", "--locked", "--release", "--package", "laguerre-cli"], &[])?;
    let laguerre = target().join("release").join(format!("laguerre{}", std::env::consts::EXE_SUFFIX));
    let folder = target().join("peers");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut absent = Vec::new();
    let peers: Vec<Peer> = [voro(&folder), cgal(&folder), meshless(&folder), geogram()]
        .into_iter()
        .filter_map(|found| found.map_err(|reason| absent.push(reason)).ok())
        .collect();
    absent.iter().for_each(|reason| eprintln!("not compared: {reason}"));
    let mut rows = String::new();
    let mut machine = String::new();
    for (container, named, place) in CONTAINERS {
        for distribution in ["white", "blue"] {
            let sites = folder.join(format!("{distribution}-{named}.xyz"));
            let in_root = |program: &Path| {
                let mut command = Command::new(program);
                command.current_dir(root());
                command
            };
            succeed(in_root(&laguerre).args(["sample", distribution, SITES, "-o"]).arg(&sites).args(place))?;
            let volumes = folder.join("volumes.csv");
            let mut integrate = in_root(&laguerre);
            succeed(integrate.arg("integrate").arg(&sites).args(place).args(["--backend", "cpu", "-o"]).arg(&volumes))?;
            let squares = sum_of_squares(&volumes)?;
            let able: Vec<&Peer> = peers.iter().filter(|peer| peer.cuts || named == "box").collect();
            let (mut theirs, mut own) = (vec![Vec::new(); able.len()], [Vec::new(), Vec::new()]);
            let mut agreement = vec![None; able.len()];
            for _ in 0..TURNS {
                for (k, threads) in ["1", "2"].into_iter().enumerate() {
                    let mut bench = in_root(&laguerre);
                    bench.args(["bench", "--backends", "cpu", "--repetitions", "1", "--json", "--sites", SITES]);
                    bench.args(["--threads", threads, "--distributions", distribution, "--domains", named]);
                    let said = succeed(&mut bench)?;
                    let said: serde_json::Value = serde_json::from_str(&said).map_err(|e| e.to_string())?;
                    said["machine"].as_str().unwrap_or_default().clone_into(&mut machine);
                    own[k].push(said["rows"][0]["seconds"]["median"].as_f64().ok_or("laguerre bench says no seconds")?);
                }
                for (k, peer) in able.iter().enumerate() {
                    let mut job = in_root(&peer.run);
                    job.args(&peer.before).arg(&sites).env("RAYON_NUM_THREADS", peer.threads.to_string());
                    if named == "bunny" {
                        job.arg(MESH);
                    }
                    let said = said_by(&succeed(&mut job)?)?;
                    theirs[k].push(said.seconds);
                    agreement[k] = said.squares.map(|theirs| (theirs / squares - 1.0).abs());
                }
            }
            for (k, peer) in able.iter().enumerate() {
                let (other, this) = (median(&mut theirs[k]), median(&mut own[peer.threads - 1]));
                let differs = agreement[k].map_or_else(|| "-".to_owned(), |share| format!("{share:.0e}"));
                rows += &format!(
                    "| {distribution}, {container} | {} | {} | {other:.3} s | {this:.3} s | {:.2} | {differs} |\n",
                    peer.name,
                    peer.threads,
                    other / this
                );
            }
        }
    }
    let without: String = absent.iter().map(|reason| format!("\n\nNot compared: {reason}.")).collect();
    let block = format!(
        "{BEGIN}\n`cargo xtask peers`: 100,000 sites, turn by turn in one run, medians of {TURNS} turns; each program's second evaluation, from arrays in memory to \
         arrays in memory. Volumes and barycenters; CGAL makes the Delaunay triangulation alone, geogram (PyPI) the tetrahedra that cells consist of. \
         Machine: {machine}. \"Times\" is how many times as long the other takes; the last column how far the sums of all squared volumes are apart.\n\n\
         | input | program | threads | its time | laguerre | times | difference |\n|---|---|---|---|---|---|---|\n{rows}{without}{END}"
    );
    let page = root().join("BENCHMARKS.md");
    let text = fs::read_to_string(&page).map_err(|e| format!("{}: {e}", page.display()))?;
    let text = replaced(&text, [BEGIN, END], &block).ok_or("BENCHMARKS.md has no place for the table of peers")?;
    fs::write(&page, text).map_err(|e| format!("{}: {e}", page.display()))?;
    println!("{block}");
    Ok(())
}

fn source(name: &str) -> PathBuf {
    root().join("benches/peers").join(name)
}

/// Compiles the C++ text of a peer.
fn compiled(name: &str, libraries: &[&str], folder: &Path) -> Result<PathBuf, String> {
    let program = folder.join(name);
    let text = source(&format!("{name}.cc"));
    let mut compiler = Command::new("c++");
    compiler.args(["-O3", "-std=c++17"]).arg(text).args(libraries).arg("-o").arg(&program);
    succeed(&mut compiler).map_err(|said| said.lines().next().unwrap_or_default().to_owned())?;
    Ok(program)
}

fn voro(folder: &Path) -> Result<Peer, String> {
    let run = compiled("voro", &["-lvoro++"], folder).map_err(|e| format!("voro++ (Debian's voro++-dev): {e}"))?;
    Ok(Peer { name: "voro++", run, before: Vec::new(), threads: 1, cuts: false })
}

fn cgal(folder: &Path) -> Result<Peer, String> {
    let run =
        compiled("cgal", &["-lgmp", "-lmpfr"], folder).map_err(|e| format!("CGAL (Debian's libcgal-dev): {e}"))?;
    Ok(Peer { name: "CGAL, Delaunay", run, before: Vec::new(), threads: 1, cuts: false })
}

fn meshless(folder: &Path) -> Result<Peer, String> {
    let manifest = source("meshless/Cargo.toml");
    let line = ["build", "--locked", "--release", "--quiet", "--manifest-path", &manifest.to_string_lossy()];
    cargo(&line, &[("CARGO_TARGET_DIR", &folder.to_string_lossy())]).map_err(|e| format!("meshless_voronoi: {e}"))?;
    let run = folder.join("release/laguerre-peer-meshless").with_extension(std::env::consts::EXE_EXTENSION);
    Ok(Peer { name: "meshless_voronoi", run, before: Vec::new(), threads: 1, cuts: false })
}

fn geogram() -> Result<Peer, String> {
    let run = environment("peers-python", "import geogram", &["geogram==0.0.7", "numpy==2.4.6"])
        .map_err(|e| format!("geogram (PyPI): {e}"))?;
    let before = vec![source("geogram_cells.py").to_string_lossy().into_owned()];
    Ok(Peer { name: "geogram", run, before, threads: 2, cuts: true })
}

/// The seconds, and after the sum of all volumes that of their squares.
fn said_by(text: &str) -> Result<Said, String> {
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[seconds]) => Ok(Said { seconds, squares: None }),
        Some(&[seconds, _, squares]) => Ok(Said { seconds, squares: Some(squares) }),
        _ => Err(format!("a peer says {text:?}, not its seconds and sums")),
    }
}

/// Of the second column.
fn sum_of_squares(results: &Path) -> Result<f64, String> {
    let text = fs::read_to_string(results).map_err(|e| format!("{}: {e}", results.display()))?;
    let volumes = text.lines().skip(1).map(|row| row.split(',').nth(1).and_then(|word| word.parse::<f64>().ok()));
    let squares: Option<f64> = volumes.map(|volume| volume.map(|v| v * v)).sum();
    squares.ok_or_else(|| format!("{}: no column of volumes", results.display()))
}

fn median(seconds: &mut [f64]) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_peers_say_is_read() {
        assert_eq!(said_by("1.25 1 2e-5\n"), Ok(Said { seconds: 1.25, squares: Some(2e-5) }));
        assert_eq!(said_by("0.5\n"), Ok(Said { seconds: 0.5, squares: None }));
        assert!(said_by("no sites").is_err() && said_by("1 2").is_err());
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
    }
}
