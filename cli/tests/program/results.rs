//! What the commands write.

use std::fs;

use crate::support::{UNIT_BOX, inputs, json, laguerre, runs};

#[test]
fn sites_at_one_place_are_told() {
    let folder = inputs();
    let sites =
        "0.2 0.3 0.4 0\n0.7 0.6 0.5 0\n0.2 0.3 0.4 0.1\n0.7 0.6 0.5 0\n0.0 0.9 0.1 0\n-0.0 0.9 0.1 0\n0.5 0.5 0.5 -9\n";
    fs::write(folder.path().join("twice.xyz"), sites).unwrap();
    let run = |args: &[&str]| {
        let output = laguerre(folder.path(), args);
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let said = run(&["integrate", "twice.xyz", "--box", UNIT_BOX, "--json"]);
    let note =
        "sites at the place of another: 3 (first site 2, at that of site 0); of each such group one at most has a cell";
    assert!(said.contains(note), "{said}");
    assert!(!run(&["integrate", "strong.xyz", "--box", UNIT_BOX, "--json"]).contains("another"));
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
            "0" => assert!(fields[2].parse::<f64>().unwrap().is_finite()),
            "1" => assert_eq!((fields[1], fields[2], fields[5]), ("0.0", "NaN", "0")),
            other => panic!("{other}"),
        }
        empty += u64::from(fields[6] == "1");
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
            assert_eq!(fields[6], "NaN");
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
    assert_eq!(cells.lines().filter(|row| row.ends_with(",2")).count() as u64, uncertified);
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
    let domain = fs::read_to_string(written.join("swan.off")).unwrap();
    assert!(domain.starts_with("OFF\n2018 4032 0\n"));
    runs(&written, &["sample", "white", "200", "--domain", "swan.off", "-o", "sites.xyz"]);
    let report = json(&runs(&written, &["integrate", "sites.xyz", "--domain", "swan.off", "--json"]));
    assert!(report["domain_volume"].as_f64().is_some_and(|volume| (volume - 15.87).abs() < 0.01), "{report}");
    fs::remove_file(written.join("sites.xyz")).unwrap();
    assert!(fs::read(written.join("cells.vtu")).unwrap().starts_with(b"<?xml"));
    assert!(fs::read(written.join("cells.png")).unwrap().starts_with(b"\x89PNG"));
    assert!(fs::read(written.join("cells.html")).unwrap().starts_with(b"<!doctype html>"));
    assert_eq!(fs::read_dir(&written).unwrap().count(), 5, "nothing half-written is left");
    let report = json(&runs(folder.path(), &["demo", "--sites", "300", "--out-dir", "a/b", "--json"]));
    assert!(report["sites"] == 300 && report["relative_error"].as_f64().unwrap() < 1e-14, "{report}");
}
