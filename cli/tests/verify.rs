//! `laguerre verify` as its users meet it: right results pass, each fault is found and named.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

const UNIT_BOX: [&str; 2] = ["--box", "0,0,0,1,1,1"];
const BUNNY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/meshes/bunny.obj");

fn laguerre(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_laguerre")).current_dir(folder).args(args).output().unwrap()
}

/// Runs, expects success.
fn runs(folder: &Path, args: &[&str]) {
    let output = laguerre(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// `verify cells.csv sites.xyz --facets facets.csv --json` and more: the exit code and the object.
fn verify(folder: &Path, more: &[&str]) -> (Option<i32>, Value) {
    let args = [&["verify", "cells.csv", "sites.xyz", "--facets", "facets.csv", "--json"], more].concat();
    let output = laguerre(folder, &args);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.lines().count(), 1, "{text} {}", String::from_utf8_lossy(&output.stderr));
    (output.status.code(), serde_json::from_str(&text).unwrap())
}

/// A folder with sites, their cells and their facets in `container`.
fn results(sites: &str, container: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("sites.xyz"), sites).unwrap();
    let args = [&["integrate", "sites.xyz", "-o", "cells.csv", "--facets", "facets.csv"], container].concat();
    runs(folder.path(), &args);
    folder
}

/// `n` sites by a low-discrepancy sequence, stretched to a box, with weights up to `weight`.
fn scattered(n: usize, lo: [f64; 3], hi: [f64; 3], weight: f64) -> String {
    let steps = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3, 0.618_033_988_749_894_9];
    let row = |i: usize| {
        let [a, b, c, w] = steps.map(|step| (0.5 + i as f64 * step).fract());
        let at = |k: usize, t: f64| lo[k] + t * (hi[k] - lo[k]);
        format!("{:?} {:?} {:?} {:?}\n", at(0, a), at(1, b), at(2, c), weight * w)
    };
    (0..n).map(row).collect()
}

fn white() -> TempDir {
    results(&scattered(2000, [0.0; 3], [1.0; 3], 0.0), &UNIT_BOX)
}

/// Changes line `line` (from 0, the header) of a file, field by field.
fn edit(folder: &Path, name: &str, line: usize, change: impl Fn(&mut Vec<String>)) {
    let path = folder.join(name);
    let text = fs::read_to_string(&path).unwrap();
    let lines = text.lines().enumerate().map(|(k, row)| {
        let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
        if k == line {
            change(&mut fields);
        }
        fields.join(",") + "\n"
    });
    fs::write(&path, lines.collect::<String>()).unwrap();
}

/// Multiplies field `field` of that line.
fn scale(folder: &Path, name: &str, line: usize, field: usize, factor: f64) {
    edit(folder, name, line, |fields| fields[field] = format!("{:?}", fields[field].parse::<f64>().unwrap() * factor));
}

/// Which sites, or facets, are listed as wrong.
fn named(found: &Value) -> Vec<(u64, Option<i64>)> {
    let wrong = found["wrong"].as_array().unwrap().iter();
    let mut named: Vec<_> = wrong.map(|w| (w["site"].as_u64().unwrap(), w["neighbor"].as_i64())).collect();
    named.sort_unstable();
    named
}

#[test]
fn what_integrate_wrote_is_right() {
    let lattice: String = (0..512).map(|i| format!("{} {} {}\n", i % 8, i / 8 % 8, i / 64)).collect();
    let duplicates: String = (0..300).map(|i| format!("{} {} {} {}\n", i % 3, i % 5, i % 4, i % 2)).collect();
    let [lo, hi] = [[-9.0, 0.0, -6.0], [6.0, 15.0, 6.0]];
    let scenes: [(&str, String, &[&str]); 6] = [
        ("white", scattered(2000, [0.0; 3], [1.0; 3], 0.0), &UNIT_BOX),
        ("strong weights", scattered(1000, [0.0; 3], [1.0; 3], 0.3), &UNIT_BOX),
        ("far sites", scattered(200, [-200.0; 3], [100.0; 3], 0.0), &UNIT_BOX),
        ("lattice", lattice, &["--box", "-0.5,-0.5,-0.5,7.5,7.5,7.5"]),
        ("duplicates", duplicates, &["--box", "-1,-1,-1,3,5,4"]),
        ("bunny", scattered(1500, lo, hi, 2.0), &["--domain", BUNNY]),
    ];
    for (name, sites, container) in scenes {
        let folder = results(&sites, container);
        let (code, found) = verify(folder.path(), &[container, &["--cells", "400"]].concat());
        assert_eq!((code, &found["right"]), (Some(0), &true.into()), "{name}: {found}");
        let count = sites.lines().count() as u64;
        assert_eq!((&found["sites"], &found["checked_by_oracle"]), (&count.into(), &count.min(400).into()), "{name}");
        assert_eq!(found["laws"].as_array().unwrap().len(), 3);
        assert!(found["laws"].as_array().unwrap().iter().all(|law| law["holds"] == true), "{name}");
    }
    let folder = white();
    runs(folder.path(), &["integrate", "sites.xyz", UNIT_BOX[0], UNIT_BOX[1], "-o", "cells.npy"]);
    let output = laguerre(folder.path(), &["verify", "cells.npy", "sites.xyz", UNIT_BOX[0], UNIT_BOX[1]]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{text}");
    assert!(text.contains("verdict      all 2,000 cells are right\n"), "{text}");
}

#[test]
fn swapped_rows_are_named() {
    let folder = white();
    let cells = folder.path().join("cells.csv");
    let right = fs::read_to_string(&cells).unwrap();
    let rows: Vec<&str> = right.lines().collect();
    // Whole lines, as of a producer with an order of its own; then what stands behind the index, which leaves every sum as it was.
    let mut lines = rows.clone();
    lines.swap(1235, 412);
    fs::write(&cells, lines.join("\n")).unwrap();
    let (code, found) = verify(folder.path(), &UNIT_BOX);
    assert_eq!((code, named(&found)), (Some(4), vec![(411, None), (1234, None)]), "{found}");
    fs::write(&cells, &right).unwrap();
    for (to, from) in [(1235, 412), (412, 1235)] {
        let (_, data) = rows[from].split_once(',').unwrap();
        edit(folder.path(), "cells.csv", to, |fields| {
            fields.truncate(1);
            fields.extend(data.split(',').map(str::to_owned));
        });
    }
    let (code, found) = verify(folder.path(), &UNIT_BOX);
    let cells: Vec<_> = named(&found).into_iter().filter(|w| w.1.is_none()).collect();
    assert_eq!(code, Some(4));
    assert!(cells.contains(&(411, None)) && cells.contains(&(1234, None)), "{found}");
    assert_eq!(found["wrong_cells"], 2);
}

#[test]
fn the_tenth_digit_is_seen() {
    for (line, field, what) in [(700, 1, "volume"), (1700, 3, "barycenter")] {
        let folder = white();
        scale(folder.path(), "cells.csv", line, field, 1.0 + 2e-10);
        let (code, found) = verify(folder.path(), &[&UNIT_BOX[..], &["--cells", "0"]].concat());
        assert_eq!((code, named(&found)), (Some(4), vec![(line as u64 - 1, None)]), "{found}");
        let wrong = &found["wrong"][0];
        assert_eq!(wrong["what"], what);
        let [file, expected] = ["file", "expected"].map(|side| wrong[side]["volume"].as_f64().unwrap());
        assert_eq!((file / expected - 1.0).abs() > 1e-10, what == "volume", "{found}");
        // The sample is empty, but the oracle was asked about this one.
        assert_eq!(found["checked_by_oracle"], 1);
        // Who has fewer digits says so.
        let (code, _) = verify(folder.path(), &[&UNIT_BOX[..], &["--tolerance", "1e-9"]].concat());
        assert_eq!(code, Some(0));
    }
}

#[test]
fn nothing_is_nan_or_negative_or_misnamed() {
    let change: [(usize, &str, &str); 6] = [
        (1, "NaN", "volume"),
        (1, "-1e-30", "volume"),
        (1, "inf", "volume"),
        (4, "NaN", "barycenter"),
        (6, "1", "status"),
        (1, "0.0", "volume"),
    ];
    for (field, text, what) in change {
        let folder = white();
        edit(folder.path(), "cells.csv", 100, |fields| fields[field] = text.into());
        let (code, found) = verify(folder.path(), &UNIT_BOX);
        assert_eq!((code, named(&found)), (Some(4), vec![(99, None)]), "{text}: {found}");
        assert_eq!(found["wrong"][0]["what"], what, "{text}");
    }
}

#[test]
fn facets_have_two_sides_a_distance_and_an_area() {
    let first = |folder: &Path| {
        let text = fs::read_to_string(folder.join("facets.csv")).unwrap();
        let line = text.lines().skip(1).position(|row| !row.contains(",-1,")).unwrap() + 1;
        let fields: Vec<&str> = text.lines().nth(line).unwrap().split(',').collect();
        (line, (fields[0].parse().unwrap(), fields[1].parse::<i64>().ok()))
    };
    for (field, factor) in [(2, 1.0 + 1e-8), (2, -1.0), (3, 1.0 + 1e-6), (6, 1.0 + 1e-9)] {
        let folder = white();
        let (line, facet) = first(folder.path());
        scale(folder.path(), "facets.csv", line, field, factor);
        let (code, found) = verify(folder.path(), &UNIT_BOX);
        assert_eq!(code, Some(4), "field {field}: {found}");
        assert!(named(&found).contains(&facet), "field {field}: {found}");
        assert_eq!(found["wrong_cells"], 0);
    }
    let folder = white();
    let (line, (site, neighbor)) = first(folder.path());
    let text = fs::read_to_string(folder.path().join("facets.csv")).unwrap();
    let rows: Vec<&str> = text.lines().enumerate().filter(|(k, _)| *k != line).map(|(_, row)| row).collect();
    fs::write(folder.path().join("facets.csv"), rows.join("\n")).unwrap();
    let (code, found) = verify(folder.path(), &UNIT_BOX);
    let back = (neighbor.unwrap() as u64, Some(site as i64));
    // Missing here, without its other side there; and the row of the cell counts one more.
    assert_eq!((code, named(&found).len()), (Some(4), 3), "{found}");
    assert!([(site, neighbor), back, (site, None)].iter().all(|w| named(&found).contains(w)), "{found}");
    // A piece of the surface that is missing is missing from the sum, too.
    let folder = white();
    let rows: Vec<&str> = text.lines().filter(|row| !row.starts_with("3,-1,")).collect();
    let boundary: Vec<&str> = text.lines().filter(|row| row.contains(",-1,")).collect();
    let lost: u64 = boundary[0].split(',').next().unwrap().parse().unwrap();
    let rows: Vec<&str> = rows.into_iter().filter(|row| *row != boundary[0]).collect();
    fs::write(folder.path().join("facets.csv"), rows.join("\n")).unwrap();
    let (_, found) = verify(folder.path(), &UNIT_BOX);
    assert!(named(&found).contains(&(lost, Some(-1))), "{found}");
    let law = found["laws"].as_array().unwrap().iter().find(|law| law["law"] == "boundaries").unwrap();
    assert_eq!(law["holds"], false, "{found}");
}

#[test]
fn another_diagram_is_wrong_from_end_to_end() {
    let folder = white();
    fs::write(folder.path().join("sites.xyz"), scattered(2000, [0.0; 3], [1.0; 3], 0.01)).unwrap();
    let output = laguerre(folder.path(), &["verify", "cells.csv", "sites.xyz", UNIT_BOX[0], UNIT_BOX[1]]);
    assert_eq!(output.status.code(), Some(4));
    let (text, errors) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(text.lines().count() < 30 && text.contains("more, none worse"), "{text}");
    assert!(text.starts_with("site ") && text.contains("it should be"), "{text}");
    assert!(errors.starts_with("laguerre: cells.csv: wrong: ") && errors.lines().count() == 1, "{errors}");
}

#[test]
fn cells_that_are_too_large_break_the_sum() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("sites.xyz"), scattered(1000, [0.0; 3], [1.0; 3], 0.1)).unwrap();
    let args = ["integrate", "sites.xyz", UNIT_BOX[0], UNIT_BOX[1], "--epsilon", "0", "-o", "cells.csv"];
    assert_eq!(laguerre(folder.path(), &args).status.code(), Some(4));
    let output = laguerre(folder.path(), &["verify", "cells.csv", "sites.xyz", UNIT_BOX[0], UNIT_BOX[1]]);
    assert_eq!(output.status.code(), Some(4));
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(errors.contains("the sum of volumes") && errors.contains("marked as not certified"), "{errors}");
}

#[test]
fn what_cannot_be_checked_is_said_in_one_line_with_code_2() {
    let folder = white();
    let fails = |args: &[&str]| {
        let output = laguerre(folder.path(), &[&["verify"], args, &UNIT_BOX].concat());
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), errors.lines().count()), (Some(2), 1), "{args:?}: {errors}");
        assert!(output.stdout.is_empty());
        errors
    };
    let text = fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    let rows: Vec<&str> = text.lines().enumerate().filter(|(k, _)| *k != 18).map(|(_, row)| row).collect();
    fs::write(folder.path().join("short.csv"), rows.join("\n")).unwrap();
    let expected = "short.csv: 1999 rows for 2000 sites; there is none for site 17";
    assert!(fails(&["short.csv", "sites.xyz"]).contains(expected));
    assert!(fails(&["facets.csv", "sites.xyz"]).contains("facets.csv: line 1: header"));
    assert!(fails(&["sites.xyz", "sites.xyz"]).contains("known here: .csv, .npy"));
    assert!(fails(&["none.csv", "sites.xyz"]).contains("none.csv: cannot open"));
    assert!(fails(&["cells.csv", "sites.xyz", "--facets", "cells.csv"]).contains("cells.csv: line 1: header"));
    fs::write(folder.path().join("far.csv"), "site,neighbor,area,x,y,z,distance\n0,2000,1,0,0,0,1\n").unwrap();
    assert!(fails(&["cells.csv", "sites.xyz", "--facets", "far.csv"]).contains("far.csv: line 2: site 2000"));
    assert!(fails(&["cells.csv", "sites.xyz", "--tolerance", "-1"]).contains("0 or larger"));
}
