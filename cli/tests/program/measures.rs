//! What cells need, and how fast they are: `tune`, `bench`, and the paper's experiments.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::support::{PROGRAM, UNIT_BOX, failed, fails, inputs, json, notes, runs};

/// The cells of a histogram: `[[value, cells], …]`.
fn cells(histogram: &Value) -> u64 {
    histogram.as_array().unwrap().iter().map(|bin| bin[1].as_u64().unwrap()).sum()
}

#[test]
fn tune_counts_every_cell_and_proposes_what_suffices() {
    let folder = inputs();
    for sites in ["white.xyz", "strong.xyz"] {
        let report = json(&runs(folder.path(), &["tune", sites, "--domain", "cube.off", "--json"]));
        assert_eq!(report["sites"], 2000);
        for letter in ["K", "P", "V", "T"] {
            let histogram = &report["histograms"][letter];
            assert_eq!(cells(histogram), 2000, "{letter}");
            let (proposed, most) = (&report["proposed"][letter], &report["most"][letter]);
            let bins = histogram.as_array().unwrap();
            assert_eq!(&bins[bins.len() - 1][0], most);
            let enough: Vec<Value> = bins.iter().filter(|bin| bin[0].as_u64() <= proposed.as_u64()).cloned().collect();
            assert!(cells(&Value::Array(enough.clone())) >= 1900, "{letter}: {proposed}");
            assert!(cells(&Value::Array(enough[..enough.len() - 1].to_vec())) < 1900, "{letter}: {proposed}");
        }
    }
}

#[test]
fn a_lattice_needs_the_same_everywhere_inside() {
    let folder = inputs();
    runs(folder.path(), &["sample", "lattice", "1000", "-o", "lattice.xyz"]);
    let report = json(&runs(folder.path(), &["tune", "lattice.xyz", "--box", UNIT_BOX, "--share", "100", "--json"]));
    assert_eq!(report["proposed"], report["most"]);
    // The 26 voxels around each of the 8³ that are not on the box's faces; a lattice has no triangles.
    let histogram = report["histograms"]["K"].as_array().unwrap();
    assert_eq!(histogram.iter().find(|bin| bin[0] == 26), Some(&serde_json::json!([26, 512])), "{histogram:?}");
    assert_eq!(report["histograms"]["T"], serde_json::json!([[0, 1000]]));
}

#[test]
fn tune_draws_what_it_prints() {
    let folder = inputs();
    let text = runs(folder.path(), &["tune", "white.xyz", "--domain", "cube.off", "-o", "counts.svg"]);
    assert!(text.lines().last().unwrap().starts_with("proposed   K "), "{text}");
    let picture = fs::read_to_string(folder.path().join("counts.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"));
    for caption in ["K: sites visited", "P: half-spaces at once", "V: vertices at once", "T: triangles tried"] {
        assert!(picture.contains(caption), "{caption}");
    }
    let wrong = |args: &[&str]| fails(folder.path(), 2, args);
    assert!(wrong(&["tune", "white.xyz", "-o", "a.png"]).contains("known here: .svg"));
    assert!(wrong(&["tune", "white.xyz", "--share", "0"]).contains("above 0 and up to 100"));
}

#[test]
fn bench_has_a_row_for_each_combination() {
    let folder = inputs();
    let args = ["bench", "--backends", "cpu", "--sites", "100,300", "--distributions", "white,lattice"];
    let args = [&args[..], &["--domains", "box,torus,cube.off", "--repetitions", "2"]].concat();
    let args = [&args[..], &["--requests", "moments,facets"]].concat();
    let report = json(&runs(folder.path(), &[&args[..], &["--json"]].concat()));
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 2 * 3 * 2);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(row["request"], ["moments", "facets"][k % 2]);
        assert!(row["cycles_per_site"].as_f64().unwrap() > 0.0);
        let seconds = |name: &str| row["seconds"][name].as_f64().unwrap();
        assert!(0.0 < seconds("min") && seconds("min") <= seconds("median") && seconds("median") <= seconds("max"));
        let rate = row["sites"].as_f64().unwrap() / seconds("median");
        assert!((row["sites_per_second"].as_f64().unwrap() / rate - 1.0).abs() < 1e-12, "{row}");
        assert_eq!((&row["backend"], &row["seconds"]["device"]), (&"cpu".into(), &Value::Null));
    }
    // The same for people: a row has its words.
    let text = runs(folder.path(), &args);
    let rows = text.lines().filter(|line| line.starts_with("cpu "));
    assert!(rows.clone().all(|row| row.contains(" [") && (row.contains("white") || row.contains("lattice"))), "{text}");
    assert_eq!(rows.count(), 24, "{text}");
}

#[test]
fn bench_holds_uneven_inputs_to_white_noise_and_to_the_oracle() {
    let folder = inputs();
    let args = ["bench", "--uneven=levy,lognormal,outlier", "--check", "--backends", "cpu", "--sites", "300,700"];
    let args = [&args[..], &["--repetitions", "2", "--threads", "2"]].concat();
    let report = json(&runs(folder.path(), &[&args[..], &["--json"]].concat()));
    assert_eq!(report["threads"], 2);
    let rows = report["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|row| row["input"].as_str().unwrap()).collect();
    assert_eq!(names, ["white", "levy", "lognormal", "outlier"].repeat(2));
    for (row, count) in rows.iter().zip([300, 300, 300, 300, 700, 700, 700, 700]) {
        assert_eq!((&row["sites"], &row["uncertified"]), (&count.into(), &0.into()), "{row}");
        assert_eq!((&row["oracle"]["checked"], &row["oracle"]["wrong"]), (&count.min(500).into(), &0.into()), "{row}");
        let white = rows.iter().find(|white| white["sites"] == row["sites"]).unwrap();
        let seconds = |row: &Value| row["seconds_per_site"].as_f64().unwrap();
        let over = row["over_white"].as_f64().unwrap() * seconds(white) / seconds(row);
        assert!((over - 1.0).abs() < 1e-12, "{row}");
        assert_eq!(row["limit"], if row["input"] == "white" { Value::Null } else { 3.0.into() });
    }
    // The same for people, in Markdown.
    let text = runs(folder.path(), &args);
    let rows: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).collect();
    assert_eq!(rows.len(), 2 + 8, "{text}");
    assert!(rows.iter().all(|row| row.matches('|').count() == 10), "{text}");
    assert!(rows[2..].iter().all(|row| row.contains(" equal ")), "{text}");
}

/// All of them, and white noise once for each number of sites: the sphere's is bounded.
#[test]
fn bench_has_a_row_for_each_uneven_input() {
    let folder = inputs();
    put_bunny(folder.path());
    let args = ["bench", "--uneven", "--sites", "50", "--backends", "cpu", "--repetitions", "1", "--json"];
    let report = json(&runs(folder.path(), &args));
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 1 + 20);
    assert!(rows.iter().all(|row| row["oracle"].is_null() && row["uncertified"] == 0), "{report}");
    assert_eq!((&rows[20]["input"], &rows[20]["limit"]), (&"sphere".into(), &Value::Null));
}

#[test]
fn uneven_inputs_are_sampled_with_their_weights() {
    let folder = inputs();
    let sample = |args: &[&str]| {
        runs(folder.path(), &[&["sample"], args, &["-o", "a.xyz"]].concat());
        fs::read_to_string(folder.path().join("a.xyz")).unwrap()
    };
    let columns = |text: &str| -> Vec<usize> { text.lines().map(|line| line.split(' ').count()).collect() };
    assert_eq!(columns(&sample(&["plummer", "100"])), [3; 100]);
    assert_eq!(columns(&sample(&["heavy", "100"])), [4; 100]);
    assert_eq!(sample(&["nfw", "9", "--seed", "2"]), sample(&["nfw", "9", "--seed", "2", "--box", UNIT_BOX]));
    assert_ne!(sample(&["nfw", "9", "--seed", "2"]), sample(&["nfw", "9"]));
    // The far corner of the box, and a weight that is four times what it is in the unit cube.
    assert!(sample(&["outlier", "9", "--box", "2,2,2,4,4,4"]).starts_with("4.0 4.0 4.0\n"));
    let heavy = sample(&["heavy", "9", "--box", "2,2,2,4,4,4"]);
    let weight: f64 = heavy.lines().next().unwrap().split(' ').next_back().unwrap().parse().unwrap();
    assert!((weight - 0.36).abs() < 1e-15, "{heavy}");
    fs::remove_file(folder.path().join("a.xyz")).unwrap();
    for more in [&[][..], &["--inside"]] {
        let args = ["sample", "heavy", "9", "--domain", "cube.off", "-o", "a.xyz"];
        let line = fails(folder.path(), 2, &[&args[..], more].concat());
        assert_eq!(line, "--domain: the sites of heavy are in the unit cube, or in a --box; leave --domain out");
    }
    assert!(fails(folder.path(), 2, &["sample", "uneven", "9", "-o", "a.xyz"]).contains("plummer, clusters, nfw"));
}

#[test]
fn bench_says_what_it_does_not_know() {
    let folder = inputs();
    let line = fails(folder.path(), 2, &["bench", "--domains", "box,hare"]);
    assert!(line.contains("--domains hare: not one of box, swan, trefoil"), "{line}");
    assert!(fails(folder.path(), 2, &["bench", "--domains", "none.off"]).contains("none.off: cannot open"));
    assert!(fails(folder.path(), 2, &["bench", "--sites", "0"]).contains('0'));
    assert!(fails(folder.path(), 2, &["bench", "--uneven=flat"]).contains("not one of plummer, clusters, nfw"));
    assert!(fails(folder.path(), 2, &["bench", "--check"]).contains("--uneven"));
    for other in [["--distributions", "white"], ["--domains", "box"]] {
        assert!(
            fails(folder.path(), 2, &[&["bench", "--uneven"][..], &other].concat()).contains("cannot be used with")
        );
    }
    let args = ["bench", "--backends", "ocl", "--sites", "100"];
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder.path()).args(args).env("OCL_ICD_VENDORS", "/nowhere");
    failed(&command.output().unwrap(), 3, &args);
}

/// Puts the bunny where the program looks for it.
fn put_bunny(folder: &Path) {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/meshes/bunny.obj");
    fs::create_dir_all(folder.join("fixtures/meshes")).unwrap();
    fs::copy(kept, folder.join("fixtures/meshes/bunny.obj")).unwrap();
}

#[test]
fn the_bunny_is_a_file_and_what_can_do_without_it_does() {
    let folder = inputs();
    let bench = |what: &[&'static str]| {
        [&["bench"], what, &["--sites", "20", "--backends", "cpu", "--repetitions", "1"]].concat()
    };
    let sample = ["sample", "scanned", "500", "-o", "scanned.xyz"];
    for args in [&sample[..], &bench(&["--domains", "bunny"]), &bench(&["--uneven=plummer,scanned"]), &["paper"]] {
        let line = fails(folder.path(), 2, args);
        assert!(line.starts_with("fixtures/meshes/bunny.obj is not here: the bunny is no part"), "{line}");
    }
    assert_eq!(notes(folder.path(), &bench(&["--distributions", "white"])), [""; 0]);
    let left_out = notes(folder.path(), &bench(&["--uneven"]));
    assert!(left_out.len() == 1 && left_out[0].starts_with("scanned is left out: fixtures/"), "{left_out:?}");

    put_bunny(folder.path());
    runs(folder.path(), &bench(&["--domains", "bunny"]));
    runs(folder.path(), &sample);
    let sites = fs::read_to_string(folder.path().join("scanned.xyz")).unwrap();
    let inside = |x: &str| x.parse().is_ok_and(|x: f64| (0.0..=1.0).contains(&x));
    assert!(sites.lines().count() == 500 && sites.split_whitespace().all(inside));
    // What a seed gives is not to change.
    assert_eq!(sites.lines().next(), Some("0.19312484984101302 0.8041087169217613 0.5484783714469996"));
}

#[test]
fn the_papers_experiments_are_text_between_markers() {
    let folder = inputs();
    put_bunny(folder.path());
    let args = ["paper", "--sites", "300", "--backend", "cpu", "--repetitions", "1"];
    runs(folder.path(), &[&args[..], &["--markdown", "paper.md", "--picture", "counts.svg"]].concat());
    assert!(folder.path().join("counts.svg").exists());
    let text = fs::read_to_string(folder.path().join("paper.md")).unwrap();
    assert!(text.starts_with("<!-- paper cpu: begin -->\n") && text.ends_with("<!-- paper cpu: end -->\n"), "{text}");
    let rows = |title: &str| -> Vec<Vec<String>> {
        let (_, part) = text.split_once(title).unwrap_or_else(|| panic!("no {title} in {text}"));
        let part = part.split("\n**").next().unwrap();
        let rows = part.lines().filter(|line| line.starts_with('|')).skip(2);
        rows.map(|row| row.replace("\\|", "").split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
    };
    assert_eq!(rows("**Fig. 9**").len(), 4 * 2);
    assert_eq!(rows("**Fig. 10**").len(), 3 * 7);
    assert_eq!(rows("**Fig. 11**").len(), 3);
    // The laws of the sums over all cells; single cells as the suite holds them.
    let figures: Vec<f64> = rows("**§6.3").iter().map(|row| row[3].parse().unwrap()).collect();
    assert_eq!(figures.len(), 6);
    assert!(figures[0] <= 1e-14 && figures[1] <= 1e-14, "{figures:?}");
    assert!(figures.iter().all(|&figure| figure < 1e-11), "{figures:?}");
    assert!(text.contains("0 of "), "{text}");
}
