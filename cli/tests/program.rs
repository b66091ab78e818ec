//! The program as its users meet it: what it prints, writes and exits with.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

fn laguerre(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_laguerre")).current_dir(folder).args(args).output().unwrap()
}

/// Runs, expects success, returns standard output.
fn runs(folder: &Path, args: &[&str]) -> String {
    let output = laguerre(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs, expects the exit code and nothing on standard output, returns the one line on standard error.
fn fails(folder: &Path, code: i32, args: &[&str]) -> String {
    let output = laguerre(folder, args);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{args:?}: {errors}");
    assert!(output.stdout.is_empty(), "{args:?}");
    let last = errors.lines().last().unwrap_or("").to_string();
    assert!(last.starts_with("laguerre: "), "{args:?}: {errors}");
    let others = errors.lines().filter(|line| !line.starts_with("laguerre: note: ")).count();
    assert_eq!(others, 1, "{args:?}: {errors}");
    last
}

fn json(text: &str) -> Value {
    assert_eq!(text.lines().count(), 1, "{text}");
    serde_json::from_str(text).unwrap()
}

/// A folder with 2,000 sites in the unit cube whose weights hide most of them, and a few other inputs.
fn inputs() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    runs(folder.path(), &["sample", "white", "2000", "-o", "white.xyz"]);
    let white = fs::read_to_string(folder.path().join("white.xyz")).unwrap();
    let mut strong = fs::File::create(folder.path().join("strong.xyz")).unwrap();
    for (i, line) in white.lines().enumerate() {
        // Spread over [0, 0.1) by the golden ratio.
        let weight = 0.1 * (i as f64 * 0.618_033_988_749_894_9).fract();
        writeln!(strong, "{line} {weight:?}").unwrap();
    }
    let cube = "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n\
        4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 3 0 4 7\n";
    fs::write(folder.path().join("cube.off"), cube).unwrap();
    fs::write(folder.path().join("open.off"), cube.replace("8 6 0", "8 5 0")).unwrap();
    fs::write(folder.path().join("bad.xyz"), "0 0 0\n1 1 one\n").unwrap();
    folder
}

const UNIT_BOX: &str = "0,0,0,1,1,1";

#[test]
fn help_and_version_are_no_errors() {
    let folder = tempfile::tempdir().unwrap();
    assert!(runs(folder.path(), &["--version"]).starts_with("laguerre 0."));
    for command in [&["--help"][..], &["integrate", "--help"], &["sample", "--help"], &["demo", "--help"]] {
        assert!(runs(folder.path(), command).contains("Usage: laguerre"));
    }
}

#[test]
fn what_is_wrong_is_said_in_one_line_with_code_2() {
    let folder = inputs();
    let wrong = |args: &[&str]| fails(folder.path(), 2, args);
    assert!(wrong(&[]).contains("see laguerre --help"));
    assert!(wrong(&["integrate"]).contains("<SITES>"));
    assert!(wrong(&["fly"]).contains("'fly'"));
    assert!(wrong(&["integrate", "none.xyz"]).contains("none.xyz: cannot open"));
    assert!(wrong(&["integrate", "bad.xyz"]).contains("bad.xyz: line 2: 'one' is not a number"));
    assert!(wrong(&["integrate", "white.pdf"]).contains("known here: .xyz, .txt, .npy"));
    assert!(wrong(&["integrate", "white.xyz", "--domain", "cube.stl"]).contains("known here: .obj, .off"));
    assert!(wrong(&["integrate", "white.xyz", "--domain", "open.off"]).contains("open.off"));
    assert!(wrong(&["integrate", "white.xyz", "--box", "0,0,0,1,1"]).contains("5 numbers; 6 are needed"));
    assert!(wrong(&["integrate", "white.xyz", "--box", "1,0,0,0,1,1"]).contains("its x range is empty"));
    assert!(
        wrong(&["integrate", "white.xyz", "--box", UNIT_BOX, "--domain", "cube.off"]).contains("cannot be used with")
    );
    assert!(wrong(&["integrate", "white.xyz", "--precision", "f32", "--backend", "cpu"]).contains("f64 only"));
    assert!(wrong(&["integrate", "white.xyz", "--epsilon", "-1"]).contains("0 or larger"));
    assert!(wrong(&["integrate", "white.xyz", "--threads", "0"]).contains("from 1 to"));
    assert!(wrong(&["integrate", "white.xyz", "-o", "cells.xls"]).contains("known here: .csv, .npy, .vtu"));
    assert!(wrong(&["integrate", "white.xyz", "-o", "nowhere/cells.csv"]).contains("there is no folder"));
    assert!(wrong(&["integrate", "white.xyz", "-o", "a.csv", "--facets", "a.csv"]).contains("give two files"));
    assert!(wrong(&["sample", "white", "0", "-o", "a.xyz"]).contains("0"));
    assert!(wrong(&["sample", "white", "9", "--inside", "-o", "a.xyz"]).contains("--domain"));
}

#[test]
fn a_backend_that_is_not_there_is_code_3() {
    let folder = inputs();
    assert!(fails(folder.path(), 3, &["integrate", "white.xyz", "--backend", "ocl"]).contains("ocl"));
}

#[test]
fn the_json_object_has_its_fields_in_their_order() {
    let folder = inputs();
    let args = ["integrate", "white.xyz", "--domain", "cube.off", "--threads", "2", "--json"];
    let text = runs(folder.path(), &args);
    let fields = [
        "sites",
        "cells",
        "empty",
        "uncertified",
        "volume_sum",
        "domain_volume",
        "relative_error",
        "barycenter_error",
        "exact_cells",
        "backend",
        "device",
        "precision",
        "threads",
        "seconds",
        "read",
        "domain_grid",
        "compute",
        "write",
        "passes",
        "K",
        "P",
        "V",
        "T",
        "cells",
        "failed",
    ];
    let mut from = 0;
    for field in fields {
        let key = format!("\"{field}\":");
        from += text[from..].find(&key).unwrap_or_else(|| panic!("{field} is not where it should be in {text}"))
            + key.len();
    }
    let report = json(&text);
    assert_eq!(report.as_object().unwrap().len(), 15);
    assert_eq!((&report["sites"], &report["cells"], &report["empty"]), (&2000.into(), &2000.into(), &0.into()));
    assert_eq!(
        (&report["backend"], &report["precision"], &report["threads"]),
        (&"cpu".into(), &"f64".into(), &2.into())
    );
    assert_eq!(report["domain_volume"], 1.0);
    // The bound of the design for the sums over all cells.
    assert!(report["relative_error"].as_f64().unwrap() <= 1e-14, "{text}");
    assert!(report["barycenter_error"].as_f64().unwrap() <= 1e-14, "{text}");
    assert!(report["passes"].as_array().unwrap().iter().any(|pass| pass["cells"] == 2000));
}

#[test]
fn results_are_written_as_promised() {
    let folder = inputs();
    let args = ["integrate", "strong.xyz", "--box", UNIT_BOX, "-o", "cells.csv", "--facets", "facets.csv", "--json"];
    let report = json(&runs(folder.path(), &args));
    assert!(report["empty"].as_u64().unwrap() > 1000, "most are hidden");
    let cells = fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    let mut rows = cells.lines();
    assert_eq!(rows.next(), Some("site,volume,x,y,z,facets,status"));
    let mut sum = 0.0;
    let mut empty = 0;
    let mut facets = 0;
    for (i, row) in rows.enumerate() {
        let fields: Vec<&str> = row.split(',').collect();
        assert_eq!(fields.len(), 7);
        assert_eq!(fields[0], i.to_string());
        sum += fields[1].parse::<f64>().unwrap();
        facets += fields[5].parse::<usize>().unwrap();
        match fields[6] {
            "complete" => assert!(fields[2].parse::<f64>().unwrap().is_finite()),
            "empty" => assert_eq!((fields[1], fields[2], fields[5]), ("0.0", "NaN", "0")),
            other => panic!("{other}"),
        }
        empty += u64::from(fields[6] == "empty");
    }
    assert_eq!(Some(empty), report["empty"].as_u64());
    // Summed plainly here: n roundings of at most half an ulp of the sum.
    assert!((sum - 1.0).abs() < 2000.0 * f64::EPSILON);

    let list = fs::read_to_string(folder.path().join("facets.csv")).unwrap();
    let mut rows = list.lines();
    assert_eq!(rows.next(), Some("site,neighbor,area,x,y,z,distance"));
    let mut boundary = 0.0;
    let mut pairs = std::collections::HashMap::new();
    for row in rows {
        facets -= 1;
        let fields: Vec<&str> = row.split(',').collect();
        let area: f64 = fields[2].parse().unwrap();
        if fields[1] == "-1" {
            boundary += area;
            assert_eq!(fields[6], "");
        } else {
            pairs.insert((fields[0].to_string(), fields[1].to_string()), area);
        }
    }
    assert_eq!(facets, 0, "cells.csv counts what facets.csv lists");
    assert!((boundary - 6.0).abs() < 1e-12, "the surface of the cube: {boundary}");
    for ((i, j), area) in &pairs {
        let other = pairs[&(j.clone(), i.clone())];
        // A share of the mean facet area, some 1e-2 here.
        assert!((area - other).abs() < 1e-14, "facet {i}, {j}: {area} and {other}");
    }

    runs(folder.path(), &["integrate", "strong.xyz", "--box", UNIT_BOX, "-o", "cells.npy"]);
    assert!(fs::read(folder.path().join("cells.npy")).unwrap().starts_with(b"\x93NUMPY"));
    runs(folder.path(), &["integrate", "strong.xyz", "--domain", "cube.off", "-o", "cells.vtu"]);
    assert!(fs::read(folder.path().join("cells.vtu")).unwrap().starts_with(b"<?xml"));
}

#[test]
fn cells_that_are_not_certified_are_code_4_and_written() {
    let folder = inputs();
    let args = ["integrate", "strong.xyz", "--box", UNIT_BOX, "--epsilon", "0", "-o", "cells.csv", "--json"];
    let output = laguerre(folder.path(), &args);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{errors}");
    assert!(errors.starts_with("laguerre: ") && errors.contains("not certified"), "{errors}");
    let report = json(&String::from_utf8(output.stdout).unwrap());
    let uncertified = report["uncertified"].as_u64().unwrap();
    assert!(uncertified > 0);
    assert!(report["volume_sum"].as_f64() > report["domain_volume"].as_f64(), "the check can fail");
    let cells = fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    assert_eq!(cells.lines().filter(|row| row.ends_with(",uncertified")).count() as u64, uncertified);
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let folder = inputs();
    let mut command = Command::new(env!("CARGO_BIN_EXE_laguerre"));
    command.current_dir(folder.path()).args(["integrate", "white.xyz", "--json", "-o", "cells.csv"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty());
    assert!(folder.path().join("cells.csv").exists());
}

#[test]
fn samples_are_what_they_are_called() {
    let folder = inputs();
    let sample = |distribution: &str, extra: &[&str]| {
        let args = [&["sample", distribution, "1000", "-o", "s.xyz"], extra].concat();
        runs(folder.path(), &args);
        fs::read_to_string(folder.path().join("s.xyz")).unwrap()
    };
    for distribution in ["white", "perturbed", "blue", "lattice", "mirrored"] {
        let sites = sample(distribution, &[]);
        assert_eq!(sites.lines().count(), 1000, "{distribution}");
        assert_eq!(sites, sample(distribution, &["--seed", "1"]), "{distribution}");
        assert_eq!(sites == sample(distribution, &["--seed", "2"]), distribution == "lattice", "{distribution}");
        // Each fills its box.
        let report = json(&runs(folder.path(), &["integrate", "s.xyz", "--box", UNIT_BOX, "--json"]));
        assert_eq!((&report["empty"], &report["uncertified"]), (&0.into(), &0.into()), "{distribution}");
    }
    let bunny = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/meshes/bunny.obj");
    for distribution in ["white", "blue"] {
        assert_eq!(sample(distribution, &["--domain", bunny, "--inside"]).lines().count(), 1000);
    }
}

#[test]
fn the_demo_does_the_main_job() {
    let folder = tempfile::tempdir().unwrap();
    let summary = runs(folder.path(), &["demo", "--sites", "300", "--out-dir", "a/b"]);
    assert!(summary.contains("relative error") && summary.contains("cells.png"), "{summary}");
    let written = folder.path().join("a/b");
    assert_eq!(fs::read_to_string(written.join("cells.csv")).unwrap().lines().count(), 301);
    assert!(fs::read(written.join("cells.vtu")).unwrap().starts_with(b"<?xml"));
    assert!(fs::read(written.join("cells.png")).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(fs::read_dir(&written).unwrap().count(), 3, "nothing half-written is left");
}
