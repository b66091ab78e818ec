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

/// A peak in a corner draws cells of equal mass together there, and the same peak by deviation and by covariance gives the same.
#[test]
fn gaussians_are_met() {
    let folder = inputs();
    let folder = folder.path();
    let white = fs::read_to_string(folder.join("white.xyz")).unwrap();
    let few: String = white.lines().take(200).map(|line| format!("{line}\n")).collect();
    fs::write(folder.join("few.xyz"), few).unwrap();
    // ∫ over the cube: an eighth of each of the first, all but 1e-6 of the second.
    fs::write(folder.join("round.csv"), "x,y,z,deviation,mass\n0,0,0,0.2,8\n0.5,0.5,0.5,0.1,0.25\n").unwrap();
    let whole = "0 0 0  0.04 0.04 0.04  0 0 0  8\n0.5 0.5 0.5  0.01 0.01 0.01  0 0 0  0.25 # the same\n";
    fs::write(folder.join("whole.txt"), whole).unwrap();
    let run = |file: &str, weights: &str, more: &[&str]| {
        let args = ["transport", "few.xyz", "--box", UNIT_BOX, "--constant", "0.5", "-o", weights, "--gaussians", file];
        runs(folder, &[&args[..], more].concat())
    };
    let report = json(&run("round.csv", "w.txt", &["--json", "--cells", "cells.csv"]));
    assert_eq!((&report["converged"], &report["density"]), (&true.into(), &"2 Gaussians on 0.5, by degree 5".into()));
    let mass = report["mass"].as_f64().unwrap();
    assert!((mass - 1.75).abs() < 2e-4, "{mass}");
    // Each cell has a 200th of the mass: it is small where that is dense, which is near the corner.
    let cells = fs::read_to_string(folder.join("cells.csv")).unwrap();
    let volumes = column(&cells, 1, 1);
    let [x, y, z] = [2, 3, 4].map(|at| column(&cells, 1, at));
    let near = |i: usize| x[i].max(y[i]).max(z[i]) < 0.2;
    let far = |i: usize| x[i].min(y[i]).min(z[i]) > 0.6;
    let mean = |of: &dyn Fn(usize) -> bool| {
        let those: Vec<f64> = (0..200).filter(|&i| of(i)).map(|i| volumes[i]).collect();
        those.iter().sum::<f64>() / those.len() as f64
    };
    // (There the densities are some 8 and 0.5.)
    assert!(10.0 * mean(&near) < mean(&far), "{} {}", mean(&near), mean(&far));
    let said = run("whole.txt", "again.txt", &["--degree", "5"]);
    assert!(said.contains("density      2 Gaussians on 0.5, by degree 5; mass 1.7"), "{said}");
    let [one, other] = ["w.txt", "again.txt"].map(|file| fs::read_to_string(folder.join(file)).unwrap());
    assert!(column(&one, 0, 0).iter().zip(column(&other, 0, 0)).all(|(a, b)| (a - b).abs() < 1e-9));

    let wrong = |rows: &str, more: &[&str]| {
        fs::write(folder.join("g.csv"), rows).unwrap();
        let args = ["transport", "few.xyz", "--box", UNIT_BOX, "--gaussians", "g.csv", "-o", "w.npy"];
        fails(folder, 2, &[&args[..], more].concat())
    };
    let round = "0.5,0.5,0.5,0.01,1\n";
    let line = wrong(round, &[]);
    assert!(line.starts_with("g.csv: the density is 0 at [") && line.contains("a constant"), "{line}");
    fs::write(folder.join("masses.txt"), "1\n".repeat(200)).unwrap();
    assert!(wrong(round, &["--masses", "masses.txt"]).starts_with("g.csv: the density is 0 at ["));
    let needed = "x,y,z,deviation,mass, or x,y,z,xx,yy,zz,xy,xz,yz,mass are needed";
    assert_eq!(wrong("0.5,0.5,0.5,1\n", &[]), format!("g.csv: line 1: 4 columns; {needed}"));
    assert_eq!(wrong("x,y,z,sigma,mass\n", &[]), format!("g.csv: line 1: columns 'x,y,z,sigma,mass'; {needed}"));
    let line = wrong(&format!("{round}0,0,0,-0.1,1\n"), &[]);
    assert_eq!(line, "g.csv: the deviation of Gaussian 1 is -0.1: a positive length is needed");
    assert!(wrong("0,0,0,1,1,1,2,0,0,1\n", &[]).starts_with("g.csv: Gaussian 0, "));
    assert!(wrong(round, &["--constant", "-1"]).contains("a number from 0 to"));
    assert!(wrong(round, &["--degree", "32"]).contains("32 is not in 0..=31"));
    assert!(wrong(round, &["--density", "1,0,0,0"]).contains("cannot be used with"));
    let line = fails(folder, 2, &["transport", "few.xyz", "--constant", "1", "-o", "w.npy"]);
    assert!(line.contains("--gaussians"), "{line}");
    let args = ["transport", "few.xyz", "--box", UNIT_BOX, "--gaussians", "round.csv", "-o", "round.csv"];
    assert_eq!(fails(folder, 2, &args), "round.csv: would be written over, but is read; name another file");
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
