//! `laguerre transport`.

use std::fs;

#[cfg(target_os = "linux")]
use crate::outputs::interrupted_at;
use crate::support::{UNIT_BOX, fails, inputs, json, laguerre, notes, runs};

/// The numbers of one column of a text file, after `skip` lines.
fn column(text: &str, skip: usize, at: usize) -> Vec<f64> {
    text.lines().skip(skip).map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

#[test]
fn cells_get_equal_masses_and_the_weights_can_be_given_back() {
    let folder = inputs();
    let folder = folder.path();
    let args = ["transport", "white.xyz", "--domain", "cube.off", "-o", "w.txt", "--cells", "cells.csv", "--json"];
    let report = json(&runs(folder, &args));
    let history = report["history"].as_array().unwrap();
    assert_eq!(report["iterations"], history.len() - 1);
    assert_eq!((&report["converged"], &report["sites"]), (&true.into(), &2000.into()));
    assert!(history.len() <= 16, "{report}");
    let residual = report["residual"].as_f64().unwrap();
    assert!(residual <= 1e-9 && history.last().unwrap()["residual"] == residual, "{report}");
    for sum in ["evaluations", "linear_iterations"] {
        assert_eq!(report[sum], history.iter().map(|row| row[sum].as_u64().unwrap()).sum::<u64>());
    }
    assert!(report["seconds"].as_f64() >= report["diagram_seconds"].as_f64(), "{report}");
    // About what it costs to gather white noise: the mean squared size of a cell.
    let cost = report["cost"].as_f64().unwrap() * 2000_f64.powf(2.0 / 3.0);
    assert!(0.1 < cost && cost < 2.0, "{cost}");
    assert_eq!(fs::read_to_string(folder.join("w.txt")).unwrap().lines().count(), 2000);

    // The weights make the same cells, to the bit.
    let cells = fs::read_to_string(folder.join("cells.csv")).unwrap();
    assert!(column(&cells, 1, 1).iter().all(|v| (v * 2000.0 - 1.0).abs() <= 1e-9));
    runs(folder, &["integrate", "white.xyz", "--weights", "w.txt", "--domain", "cube.off", "-o", "again.csv"]);
    let again = fs::read_to_string(folder.join("again.csv")).unwrap();
    assert!(column(&cells, 1, 1) == column(&again, 1, 1));
    // Given back, they are the solution: there is nothing to do.
    let given = ["transport", "white.xyz", "--weights", "w.txt", "--domain", "cube.off", "-o", "w.npy", "--json"];
    let report = json(&runs(folder, &given));
    assert_eq!((&report["iterations"], &report["evaluations"]), (&0.into(), &1.into()));
    // Written as an array they are the same again.
    runs(folder, &["integrate", "white.xyz", "--weights", "w.npy", "--domain", "cube.off", "-o", "again.csv"]);
    assert!(column(&cells, 1, 1) == column(&fs::read_to_string(folder.join("again.csv")).unwrap(), 1, 1));
    // The same bits, for every number of threads.
    let first = fs::read(folder.join("w.txt")).unwrap();
    for threads in ["1", "2"] {
        runs(folder, &[&args[..], &["--threads", threads]].concat());
        assert!(fs::read(folder.join("w.txt")).unwrap() == first, "{threads} threads");
    }
}

#[test]
fn masses_and_densities_are_met() {
    let folder = inputs();
    let folder = folder.path();
    // Masses that some weights have are found again, whatever the start.
    runs(folder, &["integrate", "white.xyz", "--box", UNIT_BOX, "-o", "voronoi.csv"]);
    let voronoi = column(&fs::read_to_string(folder.join("voronoi.csv")).unwrap(), 1, 1);
    let lines: Vec<String> = voronoi.iter().map(|v| format!("{v:?}\n")).collect();
    fs::write(folder.join("masses.csv"), format!("mass\n{}", lines.concat())).unwrap();
    let args = ["transport", "strong.xyz", "--box", UNIT_BOX, "--masses", "masses.csv", "-o", "w.csv", "--json"];
    let report = json(&runs(folder, &args));
    assert_eq!(report["converged"], true);
    let weights = column(&fs::read_to_string(folder.join("w.csv")).unwrap(), 0, 0);
    assert!(weights.iter().all(|w| w.abs() < 1e-8 * 2000_f64.powf(-2.0 / 3.0)), "a Voronoi diagram has equal weights");

    // Where it is twice as dense, cells of equal mass have half the volume.
    let args = ["transport", "white.xyz", "--box", UNIT_BOX, "--density", "1,0,0,1", "--cells", "c.csv", "--json"];
    let report = json(&runs(folder, &args));
    assert!(report["cost"].as_f64() > Some(0.0), "{report}");
    let cells = fs::read_to_string(folder.join("c.csv")).unwrap();
    for (v, z) in column(&cells, 1, 1).iter().zip(column(&cells, 1, 4)) {
        assert!((v * (1.0 + z) * 2000.0 / 1.5 - 1.0).abs() <= 2e-9, "{v} at {z}");
    }
}

#[test]
fn what_does_not_converge_is_written_and_said() {
    let folder = inputs();
    let folder = folder.path();
    let args = ["transport", "white.xyz", "--box", UNIT_BOX, "--iterations", "1", "-o", "w.txt"];
    let output = laguerre(folder, &args);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(said.starts_with("laguerre: the residual is ") && said.contains("give more --iterations"), "{said}");
    assert!(said.contains("; site ") && said.contains(" has the mass "), "{said}");
    assert_eq!(said.lines().count(), 1);
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.starts_with("iteration  residual") && table.contains("after 1 Newton steps"), "{table}");
    assert_eq!(fs::read_to_string(folder.join("w.txt")).unwrap().lines().count(), 2000);
    let said = notes(folder, &["transport", "white.xyz", "--tolerance", "0.5"]);
    assert_eq!(said, ["the weights are not kept; name a file with -o for them"]);
    // Sites that are too near each other for weights to tell them apart are named.
    fs::write(folder.join("near.xyz"), "0.2 0.3 0.4\n0.7 0.6 0.5\n0.700000000000001 0.6 0.5\n0.3 0.9 0.1\n").unwrap();
    let output = laguerre(folder, &["transport", "near.xyz", "--box", UNIT_BOX, "-o", "w.txt"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), said.lines().count()), (Some(4), 1), "{said}");
    assert!(
        said.contains("between sites 1 and 2, at a distance of 1.0e-15") || said.contains("between sites 2 and 1"),
        "{said}"
    );
}

#[test]
fn masses_known_up_to_a_factor_are_scaled() {
    let folder = inputs();
    let folder = folder.path();
    fs::write(folder.join("shares.txt"), "1\n2\n".repeat(1000)).unwrap();
    let args = [
        "transport",
        "white.xyz",
        "--box",
        UNIT_BOX,
        "--masses",
        "shares.txt",
        "--normalize",
        "--cells",
        "c.csv",
        "-o",
        "w.txt",
    ];
    let said = notes(folder, &args);
    assert_eq!(said.len(), 1);
    assert!(said[0].starts_with("shares.txt: each mass is multiplied by 0.000333"), "{said:?}");
    let volumes = column(&fs::read_to_string(folder.join("c.csv")).unwrap(), 1, 1);
    for (i, v) in volumes.iter().enumerate() {
        assert!((v * 3000.0 / (1 + i % 2) as f64 - 1.0).abs() <= 1e-9, "cell {i}: {v}");
    }
    let line = fails(folder, 2, &["transport", "white.xyz", "--normalize", "-o", "w.txt"]);
    assert!(line.contains("--masses"), "{line}");
}

/// The weights that an interrupt leaves have the residual that was printed last.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_keeps_the_last_step() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    runs(folder, &["sample", "white", "3e4", "-o", "white.npy"]);
    let args = ["transport", "white.npy", "--box", UNIT_BOX, "-o", "w.npy", "--cells", "cells.csv"];
    let (output, table) = interrupted_at(folder, &args, 3, 1);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    let rows: Vec<&str> = table.lines().skip(1).take_while(|line| !line.starts_with("sites")).collect();
    let last: Vec<&str> = rows[rows.len() - 1].split_whitespace().collect();
    let iterations = if last[0] == "1" { "1 iteration".into() } else { format!("{} iterations", last[0]) };
    assert_eq!(said, format!("laguerre: interrupted after {iterations}; the weights as they were then are in w.npy\n"));
    let args = ["transport", "white.npy", "--weights", "w.npy", "--box", UNIT_BOX, "--iterations", "0", "--json"];
    let again = json(&String::from_utf8(laguerre(folder, &args).stdout).unwrap());
    assert_eq!(format!("{:.2e}", again["residual"].as_f64().unwrap()), last[1]);
    let cells = column(&fs::read_to_string(folder.join("cells.csv")).unwrap(), 1, 1);
    assert!(cells.len() == 30_000 && (cells.iter().sum::<f64>() - 1.0).abs() < 1e-10);
}

#[test]
fn bad_input_is_said_in_one_line() {
    let folder = inputs();
    let folder = folder.path();
    let wrong = |args: &[&str]| fails(folder, 2, &[&["transport", "white.xyz", "-o", "w.txt"], args].concat());
    fs::write(folder.join("few.txt"), "1\n2\n").unwrap();
    fs::write(folder.join("much.txt"), "0.001\n".repeat(2000)).unwrap();
    fs::write(folder.join("none.txt"), format!("{}-1\n", "0.001\n".repeat(1999))).unwrap();
    let masses = |file: &str| wrong(&["--box", UNIT_BOX, "--masses", file]);
    assert_eq!(masses("few.txt"), "few.txt: 2 masses for 2000 sites: give one for each");
    assert_eq!(masses("none.txt"), "none.txt: the mass of site 1999 is -1: masses must be positive numbers");
    let line = masses("much.txt");
    assert!(
        line.starts_with("much.txt: the masses sum to 2.0, but the domain has 1.0: multiply each by 0.5"),
        "{line}"
    );
    assert!(masses("gone.txt").starts_with("gone.txt: cannot open: "));
    let line = wrong(&["--box", UNIT_BOX, "--density", "1,-2,0,0"]);
    assert!(line.starts_with("--density: the density is -1 at [1.0, 0.0, 0.0]: it must be positive"), "{line}");
    assert!(wrong(&["--density", "1,2,3"]).contains("3 numbers; 4 are needed: c,gx,gy,gz"));
    assert!(wrong(&["--density", "1,2,3,nan"]).contains("'nan' is not a finite number"));
    assert!(wrong(&["--tolerance", "0"]).contains("a number above 0, at most 1e60, is needed"));
    assert!(wrong(&["--cells", "cells.vtu"]).contains("known here: .csv, .npy"));
    let line = fails(folder, 2, &["transport", "white.xyz", "-o", "w.vtu"]);
    assert!(line.contains("known here: .txt, .csv, .npy"), "{line}");
    assert_eq!(
        fails(folder, 2, &["transport", "white.xyz", "-o", "one.csv", "--cells", "one.csv"]),
        "one.csv: named for weights and for cells; give two files"
    );
    assert_eq!(
        fails(folder, 2, &["transport", "white.xyz", "-o", "one.csv", "--cells", "./one.csv"]),
        "one.csv: named for weights and for cells; give two files"
    );
    let line = fails(folder, 2, &["transport", "white.xyz", "--masses", "much.txt", "-o", "much.txt"]);
    assert_eq!(line, "much.txt: would be written over, but is read; name another file");
    fs::write(folder.join("twice.xyz"), "0.1 0.2 0.3\n0.5 0.5 0.5\n0.1 0.2 0.3\n").unwrap();
    let line = fails(folder, 2, &["transport", "twice.xyz", "--box", UNIT_BOX]);
    assert!(line.starts_with("twice.xyz: sites 0 and 2 are at the same place [0.1, 0.2, 0.3]: "), "{line}");
}
