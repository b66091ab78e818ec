//! Integrals of a polynomial, and derivatives as sparse matrices.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::numpy::{bytes_of, floats};
use crate::support::{UNIT_BOX, fails, inputs, json, runs};

const SITES: usize = 40;
const STEP: f64 = 1e-4;

#[test]
fn integrals_sum_to_that_of_the_whole() {
    let folder = inputs();
    let folder = folder.path();
    for container in [["--box", UNIT_BOX], ["--domain", "cube.off"]] {
        let integrate = |polynomial: &str| {
            let args = ["integrate", "strong.xyz", container[0], container[1], "--integral", polynomial];
            let report = json(&runs(folder, &[&args[..], &["-o", "c.npz", "--json"]].concat()));
            (report["integral_sum"].as_f64().unwrap(), fs::read(folder.join("c.npz")).unwrap())
        };
        for (polynomial, whole) in [("1", 1.0), ("x^2*y", 1.0 / 6.0), ("-x + 3*z*z - 2*x*y*z", 0.25), ("x^9", 0.1)] {
            let (sum, archive) = integrate(polynomial);
            assert!((sum - whole).abs() < 1e-14, "{container:?} {polynomial}: {sum}");
            let cells = floats(&archive, "integral", 2000);
            assert!((cells.iter().sum::<f64>() - whole).abs() < 1e-13, "{polynomial}");
            if polynomial == "1" {
                let volumes = floats(&archive, "volume", 2000);
                assert!(cells.iter().zip(&volumes).all(|(a, b)| (a - b).abs() < 1e-15));
            }
        }
    }
    let said = runs(folder, &["integrate", "white.xyz", "--box", UNIT_BOX, "--integral", "x"]);
    let line = said.lines().find(|line| line.starts_with("integral ")).unwrap();
    assert!((line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() - 0.5).abs() < 1e-14, "{line}");
    let report = json(&runs(folder, &["integrate", "white.xyz", "--box", UNIT_BOX, "--json"]));
    assert!(report.get("integral_sum").is_none(), "{report}");
}

/// Sites with weights, of which number `site` has its coordinate `axis`, or as number 3 its weight, moved.
fn write_sites(folder: &Path, (site, axis): (usize, usize), moved: f64) {
    let mut text = String::new();
    for i in 0..SITES {
        let fraction = |x: f64| ((i + 1) as f64 * x).fract();
        let mut row =
            [fraction(2_f64.sqrt()), fraction(3_f64.sqrt()), fraction(5_f64.sqrt()), 0.02 * fraction(7_f64.sqrt())];
        if i == site {
            row[axis] += moved;
        }
        let _ = writeln!(text, "{:?} {:?} {:?} {:?}", row[0], row[1], row[2], row[3]);
    }
    fs::write(folder.join("s.xyz"), text).unwrap();
}

/// A matrix as `scipy.sparse.load_npz` would read it, row by row.
fn matrix(path: &Path) -> Vec<Vec<f64>> {
    let archive = fs::read(path).unwrap();
    assert_eq!(bytes_of(&archive, "format", 3), b"csr");
    let whole = |name: &str, count: usize, wide: usize| -> Vec<usize> {
        let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |x, &byte| 256 * x + usize::from(byte));
        bytes_of(&archive, name, wide * count).chunks(wide).map(number).collect()
    };
    let shape = whole("shape", 2, 8);
    let starts = whole("indptr", shape[0] + 1, 4);
    let count = starts[shape[0]];
    let (columns, numbers) = (whole("indices", count, 4), floats(&archive, "data", count));
    let mut rows = vec![vec![0.0; shape[1]]; shape[0]];
    for (row, bounds) in rows.iter_mut().zip(starts.windows(2)) {
        assert!(columns[bounds[0]..bounds[1]].is_sorted_by(|a, b| a < b));
        (bounds[0]..bounds[1]).for_each(|k| row[columns[k]] = numbers[k]);
    }
    rows
}

/// Each matrix against what cells become when a site moves, or its weight changes.
#[test]
fn derivatives_are_what_differences_tend_to() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_sites(folder, (0, 0), 0.0);
    let mut args = vec!["integrate", "s.xyz", "--box", UNIT_BOX];
    let names = [
        "volumes-by-weights=a.npz",
        "volumes-by-positions=b.npz",
        "barycenters-by-weights=c.npz",
        "barycenters-by-positions=d.npz",
    ];
    names.iter().for_each(|name| args.extend(["--derivatives", name]));
    runs(folder, &args);
    let [by_weights, by_positions, centers_by_weights, centers_by_positions] =
        ["a.npz", "b.npz", "c.npz", "d.npz"].map(|name| matrix(&folder.join(name)));
    assert_eq!((by_weights.len(), by_weights[0].len()), (SITES, SITES));
    assert_eq!((by_positions.len(), by_positions[0].len()), (SITES, 3 * SITES));
    assert_eq!((centers_by_weights.len(), centers_by_weights[0].len()), (3 * SITES, SITES));
    assert_eq!((centers_by_positions.len(), centers_by_positions[0].len()), (3 * SITES, 3 * SITES));
    let cells = |place: (usize, usize), moved: f64| {
        write_sites(folder, place, moved);
        runs(folder, &["integrate", "s.xyz", "--box", UNIT_BOX, "-o", "cells.npz"]);
        let archive = fs::read(folder.join("cells.npz")).unwrap();
        (floats(&archive, "volume", SITES), floats(&archive, "barycenter", 3 * SITES))
    };
    for (site, axis) in [(3, 0), (17, 1), (29, 2), (8, 3)] {
        let ((less, centers_less), (more, centers_more)) = (cells((site, axis), -STEP), cells((site, axis), STEP));
        let (volumes, centers, column) = match axis {
            3 => (&by_weights, &centers_by_weights, site),
            _ => (&by_positions, &centers_by_positions, 3 * site + axis),
        };
        let hold = |matrix: &[Vec<f64>], less: &[f64], more: &[f64]| {
            let mut largest = 0_f64;
            for (i, row) in matrix.iter().enumerate() {
                let (found, wanted) = (row[column], (more[i] - less[i]) / (2.0 * STEP));
                // An empty cell has no barycenter.
                if wanted.is_finite() {
                    assert!(
                        (found - wanted).abs() < 1e-4 * (1.0 + wanted.abs()),
                        "{i} {column}: {found}, not {wanted}"
                    );
                    largest = largest.max(found.abs());
                }
            }
            assert!(largest > 0.01, "{column}");
        };
        hold(volumes, &less, &more);
        hold(centers, &centers_less, &centers_more);
    }
}

#[test]
fn what_is_wrong_is_said_in_one_line() {
    let folder = inputs();
    let wrong = |args: &[&str]| fails(folder.path(), 2, &[&["integrate", "white.xyz"], args].concat());
    let known = "volumes-by-weights, volumes-by-positions, barycenters-by-weights, barycenters-by-positions";
    let see = "; see laguerre integrate --help";
    let option = "for '--derivatives <NAME=FILE>'";
    for text in ["a.npz", "volumes-by-weights", "volumes-by-weights="] {
        let line = wrong(&["--derivatives", text]);
        assert_eq!(line, format!("invalid value '{text}' {option}: NAME=FILE.npz is needed, NAME one of {known}{see}"));
    }
    let line = wrong(&["--derivatives", "areas=a.npz"]);
    assert_eq!(line, format!("invalid value 'areas=a.npz' {option}: 'areas' is none of {known}{see}"));
    assert_eq!(wrong(&["--derivatives", "volumes-by-weights=a.csv"]), "a.csv: unknown ending '.csv'; known here: .npz");
    let twice = ["--derivatives", "volumes-by-weights=a.npz", "--derivatives", "volumes-by-positions=./a.npz"];
    assert_eq!(wrong(&twice), "a.npz: named for two outputs; give two files");
    let twice = ["-o", "a.npz", "--derivatives", "volumes-by-weights=a.npz"];
    assert_eq!(wrong(&twice), "a.npz: named for two outputs; give two files");
    assert_eq!(wrong(&["--derivatives", "volumes-by-weights=-"]), "-: no ending; known here: .npz");
    let needed = "a polynomial in x, y, z is needed, such as 2*x^2*y - z + 1";
    let option = "for '--integral <POLYNOMIAL>'";
    for (text, from) in [("sin(x)", "sin(x)"), ("x/2", "/2"), ("-2x", "x")] {
        let line = wrong(&["--integral", text]);
        assert_eq!(line, format!("invalid value '{text}' {option}: not understood from '{from}' on; {needed}{see}"));
    }
    let line = wrong(&["--integral", "x^32"]);
    assert_eq!(line, format!("invalid value 'x^32' {option}: degree 32 is beyond 31, the largest{see}"));
}
