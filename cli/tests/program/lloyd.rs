//! `laguerre lloyd`.

use std::fs;

#[cfg(target_os = "linux")]
use crate::outputs::interrupted_at;
use crate::support::{UNIT_BOX, fails, files, inputs, json, laguerre, notes, runs};

#[test]
fn it_lowers_the_energy_and_writes_the_sites() {
    let folder = inputs();
    let run = |sites: &str, more: &[&str]| {
        let mut args = vec!["lloyd", sites, "--box", UNIT_BOX, "--tolerance", "0", "--json"];
        args.extend_from_slice(more);
        let output = laguerre(folder.path(), &args);
        assert_eq!(output.status.code(), Some(4), "no gradient is within a tolerance of 0");
        json(&String::from_utf8(output.stdout).unwrap())
    };
    let lloyd = run("white.xyz", &["--method", "lloyd", "--iterations", "40"]);
    let lbfgs = run("white.xyz", &["--iterations", "15", "-o", "even.xyz", "--threads", "1"]);
    assert_eq!(
        (&lloyd["iterations"], &lloyd["evaluations"], &lloyd["converged"]),
        (&40.into(), &41.into(), &false.into())
    );
    assert_eq!(lloyd["history"].as_array().unwrap().len(), 41);
    assert!(lbfgs["energy"].as_f64() < lloyd["energy"].as_f64(), "{lbfgs}");
    assert!(lbfgs["residual"].as_f64() > Some(0.0) && lbfgs["seconds"].as_f64() > Some(0.0), "{lbfgs}");
    // Above that of the best lattice, and not by much.
    let normalized = lbfgs["normalized_energy"].as_f64().unwrap();
    assert!(0.0785 < normalized && normalized < 0.0850, "{normalized}");
    // What was written is what was computed: its energy at the start is that of the end.
    let again = run("even.xyz", &["--iterations", "0"]);
    assert_eq!((&again["energy"], &again["evaluations"]), (&lbfgs["energy"], &1.into()));
    let first = fs::read(folder.path().join("even.xyz")).unwrap();
    run("white.xyz", &["--iterations", "15", "-o", "even.xyz", "--threads", "2"]);
    assert!(first == fs::read(folder.path().join("even.xyz")).unwrap(), "the same bits for any number of threads");
}

#[test]
fn it_stops_on_the_bound_and_says_what_it_did() {
    let folder = inputs();
    let args = ["lloyd", "strong.xyz", "--domain", "cube.off", "--tolerance", "0.05", "-o", "even.npy"];
    let text = runs(folder.path(), &args);
    assert!(text.starts_with("iteration  diagrams") && text.contains(" of a cell: within the tolerance"), "{text}");
    let said = notes(folder.path(), &args);
    assert!(said.iter().any(|line| line.ends_with("have empty cells, and stayed where they were")), "{said:?}");
    let said = notes(folder.path(), &["lloyd", "white.xyz", "--tolerance", "0.2"]);
    assert_eq!(said, ["only the energies are printed; name a file with -o to keep the sites"]);
}

/// Of many sites those per volume are as the density's power 3/5.
#[test]
fn sites_crowd_where_the_density_is_high() {
    let folder = inputs();
    let folder = folder.path();
    let white = fs::read_to_string(folder.join("white.xyz")).unwrap();
    let first = |count: usize| white.lines().take(count).map(|line| format!("{line}\n")).collect::<String>();
    fs::write(folder.join("some.xyz"), first(300)).unwrap();
    fs::write(folder.join("few.xyz"), first(60)).unwrap();
    let share = |file: &str, is_there: &dyn Fn(&[f64]) -> bool| {
        let text = fs::read_to_string(folder.join(file)).unwrap();
        let sites = text.lines().map(|line| line.split(' ').map(|x| x.parse().unwrap()).collect::<Vec<f64>>());
        let all: Vec<bool> = sites.map(|site| is_there(&site)).collect();
        all.iter().filter(|is_there| **is_there).count() as f64 / all.len() as f64
    };
    let args = ["lloyd", "some.xyz", "--box", UNIT_BOX, "--density", "0.001,0,0,1", "-o", "low.xyz", "--json"];
    let report = json(&runs(folder, &args));
    assert_eq!((&report["converged"], &report["normalized_energy"]), (&true.into(), &serde_json::Value::Null));
    assert_eq!(report["density"], "0.001 + 1.0·z");
    let low = share("low.xyz", &|site| site[2] < 0.5);
    assert!((low - 0.330).abs() < 0.02, "{low}");
    fs::write(folder.join("peak.csv"), "0.2 0.2 0.2 0.2 1\n").unwrap();
    let args = ["lloyd", "few.xyz", "--box", UNIT_BOX, "--gaussians", "peak.csv", "--constant", "0.01", "-o", "at.xyz"];
    let said = runs(folder, &[&args[..], &["--tolerance", "0.02", "--degree", "3"]].concat());
    assert!(said.contains("density      1 Gaussian on 0.01, by degree 3\nenergy "), "{said}");
    // A cube of an eighth of the volume.
    let [before, after] = ["few.xyz", "at.xyz"].map(|file| share(file, &|site| site.iter().all(|x| *x < 0.5)));
    assert!(after > 0.4 && after > 2.0 * before, "{before} {after}");
}

#[test]
fn what_does_not_converge_is_written_and_said() {
    let folder = inputs();
    let folder = folder.path();
    let args = ["lloyd", "white.xyz", "--box", UNIT_BOX, "--iterations", "1", "-o", "even.xyz"];
    let output = laguerre(folder, &args);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(said.starts_with("laguerre: the gradient is ") && said.contains("give more --iterations"), "{said}");
    assert_eq!(said.lines().count(), 1);
    assert_eq!(fs::read_to_string(folder.join("even.xyz")).unwrap().lines().count(), 2000);
}

/// The first interrupt keeps what was printed last; a second one leaves all of it or nothing.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_keeps_the_last_iteration() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    runs(folder, &["sample", "white", "1e4", "-o", "white.npy"]);
    let args =
        ["lloyd", "white.npy", "--box", UNIT_BOX, "--tolerance", "0", "--iterations", "1000000", "-o", "even.npy"];
    let (output, table) = interrupted_at(folder, &args, 3, 1);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    let rows: Vec<&str> = table.lines().skip(1).take_while(|line| !line.starts_with("sites")).collect();
    let last: Vec<&str> = rows[rows.len() - 1].split_whitespace().collect();
    let iterations = if last[0] == "1" { "1 iteration".into() } else { format!("{} iterations", last[0]) };
    assert_eq!(
        said,
        format!("laguerre: interrupted after {iterations}; the sites as they were then are in even.npy\n")
    );
    let again = laguerre(folder, &["lloyd", "even.npy", "--box", UNIT_BOX, "--json", "--iterations", "0"]);
    let energy = json(&String::from_utf8(again.stdout).unwrap())["energy"].as_f64().unwrap();
    assert_eq!(format!("{energy:.6e}"), last[2]);
    fs::remove_file(folder.join("even.npy")).unwrap();
    let (output, _) = interrupted_at(folder, &args, 3, 2);
    assert_eq!(output.status.code(), Some(130));
    let left = files(folder);
    assert!(left.keys().all(|path| path.extension() != Some("part".as_ref())), "{:?}", left.keys());
    assert!(left.get(&folder.join("even.npy")).is_none_or(|bytes| bytes.len() > 24 * 10_000));
}

#[test]
fn bad_input_is_said_in_one_line() {
    let folder = inputs();
    let wrong = |args: &[&str]| fails(folder.path(), 2, args);
    assert!(wrong(&["lloyd"]).contains("<SITES>"));
    assert!(wrong(&["lloyd", "none.xyz"]).contains("none.xyz: cannot open"));
    assert!(wrong(&["lloyd", "white.xyz", "-o", "a.vtu"]).contains("known here: .xyz, .txt, .csv, .npy, .ply"));
    assert!(wrong(&["lloyd", "white.xyz", "--tolerance", "-1"]).contains("a number from 0 to 1e60 is needed"));
    assert!(wrong(&["lloyd", "white.xyz", "--method", "newton"]).contains("'newton'"));
    assert!(wrong(&["lloyd", "white.xyz", "--iterations", "-1"]).contains("-1"));
    let line = wrong(&["lloyd", "white.xyz", "--box", UNIT_BOX, "-o", "./white.xyz"]);
    assert_eq!(line, "./white.xyz: would be written over, but is read; name another file");
    let line = wrong(&["lloyd", "white.xyz", "--box", UNIT_BOX, "--density", "1,-2,0,0"]);
    assert!(line.starts_with("--density: the density is -1 at [1.0, 0.0, 0.0]: it must be positive"), "{line}");
    fs::write(folder.path().join("narrow.txt"), "0.5 0.5 0.5 0.001 1\n").unwrap();
    let line = wrong(&["lloyd", "white.xyz", "--box", UNIT_BOX, "--gaussians", "narrow.txt"]);
    assert!(line.starts_with("narrow.txt: the density is 0 at [") && line.contains("a constant"), "{line}");
    fs::write(folder.path().join("flat.xyz"), "0 0 0\n1 1 0\n").unwrap();
    assert!(wrong(&["lloyd", "flat.xyz"]).contains("flat.xyz: the bounding box of the 2 sites is flat"));
    fs::write(folder.path().join("far.xyz"), "0 0 0\n1e9 1 0\n").unwrap();
    assert!(wrong(&["lloyd", "far.xyz", "--box", UNIT_BOX]).contains("far.xyz: site 1"));
}
