//! Sites and weights that are wrong: one line that names file and line, code 2, and nothing written.

use std::fs;
use std::path::Path;

use crate::support::{CUBE, UNIT_BOX, failed, fails, inputs, json, laguerre_with, notes, runs};

/// Writes a file of sites, and returns what `integrate` says of it after the file's name.
fn said_of(folder: &Path, name: &str, bytes: &[u8]) -> String {
    fs::write(folder.join(name), bytes).unwrap();
    let args = ["integrate", name, "--box", UNIT_BOX, "-o", "cells.csv", "--facets", "facets.csv", "--json"];
    let line = fails(folder, 2, &args);
    line.strip_prefix(&format!("{name}: ")).unwrap_or_else(|| panic!("{line}")).to_owned()
}

#[test]
fn numbers_that_are_not_finite_are_named_by_line() {
    let folder = inputs();
    let said = |text: &str| said_of(folder.path(), "bad.xyz", text.as_bytes());
    assert_eq!(said("0 0 0\n# the next\n0.5 NaN 0\n"), "line 3: 'NaN' is not finite");
    assert_eq!(said("0 0 0\n0.5 0.5 -inf\n"), "line 2: '-inf' is not finite");
    assert_eq!(said("0 0 0\n0.5 0.5 1e999\n"), "line 2: '1e999' is not finite");
    assert_eq!(said("0 0 0 1\n\n1 1 1 nan\n"), "line 3: 'nan' is not finite");
    assert_eq!(said("0 0 0 infinity\n"), "line 1: 'infinity' is not finite");
    let csv = |text: &str| said_of(folder.path(), "bad.csv", text.as_bytes());
    assert_eq!(csv("x,y,z\r\n0,0,0\r\n0,nan,0\r\n"), "line 3: 'nan' is not finite");
    let ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
        property float w\nend_header\n0 0 0 0\n1 1 1 inf\n";
    assert_eq!(
        said_of(folder.path(), "bad.ply", ply.as_bytes()),
        "line 10: vertex 1 (from 0): weight is inf, which is not finite"
    );
}

#[test]
fn files_that_are_ragged_or_empty_or_no_numbers_are_refused() {
    let folder = inputs();
    let said = |text: &[u8]| said_of(folder.path(), "bad.xyz", text);
    assert_eq!(said(b"0 0 0\n0 0 0 1\n"), "line 2: 4 columns, but line 1 has 3");
    assert_eq!(said(b"0 0 0 1\n0 0 0\n"), "line 2: 3 columns, but line 1 has 4");
    assert_eq!(
        said(b"0 0\n"),
        "line 1: 2 columns; x y z, or x y z weight, are needed, or a first line of their names, as 'id x y z r'"
    );
    assert_eq!(
        said(b"1 2 3 4 5 6\n"),
        "line 1: 6 columns; x y z, or x y z weight, are needed, or a first line of their names, as 'id x y z r'"
    );
    assert_eq!(said(b"0,,0\n"), "line 1: a number is missing between commas");
    assert_eq!(said(b"0;;0\n"), "line 1: a number is missing between semicolons");
    // Decimal commas.
    assert_eq!(said(b"0,5;1;0\n"), "line 1: '0,5' is not a number");
    for empty in [&b""[..], b"\n\n", b"# nothing\n", b"0\n", b"x y z\n", b"\xef\xbb\xbf"] {
        assert_eq!(said(empty), "no sites in it; at least one is needed");
    }
    assert_eq!(said(b"Call me Ishmael. Some years ago\n"), "line 1: 'Call' is not a number");
    assert_eq!(said(b"0 0 0\nC 0 0 0\n"), "line 2: 'C' is not a number");
    assert_eq!(said(b"0 0 0\n\xff\xfe\n"), "line 2: not text in UTF-8");
    // Text in UTF-16, as some editors save it.
    assert_eq!(said(b"\xff\xfe0\0 \x000\0 \x000\0\n\0"), "line 1: not text in UTF-8");
    assert_eq!(said(&vec![0; 1 << 20]), "line 1: longer than 65536 bytes; is this a text file?");
    assert_eq!(said(b"weight x y\n1 2 3\n"), "line 1: no column 'z' among 'weight,x,y'; x, y and z are needed");
}

#[test]
fn counts_are_held_against_the_lines() {
    let folder = inputs();
    let said = |text: &str| said_of(folder.path(), "bad.txt", text.as_bytes());
    assert_eq!(said("3\n0 0 0\n1 1 1\n"), "line 1: says 3 sites, but 2 follow");
    assert_eq!(said("# count\n1\n0 0 0\n1 1 1\n"), "line 2: says 1 sites, but 2 follow");
    assert_eq!(said("18446744073709551615\n0 0 0\n"), "line 1: says 18446744073709551615 sites, but 1 follow");
    assert_eq!(
        said("99999999999999999999\n0 0 0\n"),
        "line 1: only '99999999999999999999'; x y z, or x y z weight, are needed"
    );
    assert_eq!(said("-1\n0 0 0\n"), "line 1: only '-1'; x y z, or x y z weight, are needed");
    let ply = |kind: &str, count: &str| {
        format!(
            "ply\nformat {kind} 1.0\nelement vertex {count}\nproperty char x\nproperty char y\nproperty char z\nend_header\n"
        )
    };
    let said = |text: String| said_of(folder.path(), "bad.ply", text.as_bytes());
    assert_eq!(
        said(ply("ascii", "18446744073709551615") + "1 2 3\n"),
        "line 9: vertex 1 (from 0): the file ends after 1 of 18446744073709551615"
    );
    assert_eq!(
        said(ply("binary_little_endian", "9000000000000000000") + "abcd"),
        "vertex 1 (from 0): the file ends after 1 of 9000000000000000000"
    );
}

#[test]
fn junk_arrays_are_refused_by_their_header() {
    let folder = inputs();
    let npy = |kind: &str, shape: &str, data: &[u8]| {
        let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n");
        let length = (header.len() as u16).to_le_bytes();
        said_of(folder.path(), "bad.npy", &[b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat())
    };
    let whole: Vec<u8> = [1.0_f64, 2.0, f64::NAN].iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(npy("<f8", "(1, 3)", &whole), "row 0, column 2 (from 0): NaN is not finite");
    assert_eq!(
        npy("<f8", "(1, 3)", &whole[..20]),
        "20 bytes of data, but shape [1, 3] of '<f8' needs other; is the file whole?"
    );
    assert_eq!(
        npy("<f8", "(400000000000000, 4)", &whole),
        "24 bytes of data, but shape [400000000000000, 4] of '<f8' needs other; is the file whole?"
    );
    assert_eq!(
        npy("<f8", "(99999999999999999999, 99999999999999999999)", &whole),
        "its .npy header is not that of an array of numbers"
    );
    let kind = "'f8' or 'f4' is needed (NumPy: a.astype('f8'))";
    assert_eq!(npy("<i8", "(1, 3)", &whole), format!("type '<i8'; {kind}"));
    assert_eq!(npy("|O", "(1, 3)", &whole), format!("type '|O'; {kind}"));
    assert_eq!(npy("<c16", "(1, 3)", &whole), format!("type '<c16'; {kind}"));
    for shape in ["(3,)", "(3, 1)", "(1, 2)", "(1, 1, 3)", "()"] {
        assert!(npy("<f8", shape, &whole).ends_with("; (N, 3), or (N, 4) with weights, is needed"), "{shape}");
    }
    assert_eq!(npy("<f8", "(0, 3)", &[]), "no sites in it; at least one is needed");
    let said = |bytes: &[u8]| said_of(folder.path(), "bad.npy", bytes);
    for bytes in [&b""[..], b"0 0 0\n", b"\x93NUMPY\x01\x00\xff\x00{", b"PK\x03\x04 an archive of arrays"] {
        assert_eq!(said(bytes), "not a .npy file: its first bytes are not NumPy's");
    }
    assert_eq!(said(b"\x93NUMPY\x09\x00\x10\x00{}"), "version 9 of the .npy format; 1 to 3 are known");
    assert_eq!(said(b"\x93NUMPY\x02\x00\xff\xff\xff\xff{}"), "its .npy header is not that of an array of numbers");
}

#[test]
fn weights_must_fit_the_sites() {
    let folder = inputs();
    let folder = folder.path();
    fs::write(folder.join("two.xyz"), "0 0 0\n1 1 1\n").unwrap();
    fs::write(folder.join("weighted.xyz"), "0 0 0 1\n1 1 1 2\n").unwrap();
    fs::write(folder.join("three.txt"), "1\n2\n3\n").unwrap();
    fs::write(folder.join("nan.txt"), "1\nnan\n").unwrap();
    fs::write(folder.join("rows.csv"), "1,2\n").unwrap();
    fs::write(folder.join("none.txt"), "# none\n").unwrap();
    let said = |sites: &str, weights: &str| {
        fails(folder, 2, &["integrate", sites, "--weights", weights, "--box", UNIT_BOX, "-o", "cells.csv"])
    };
    assert_eq!(said("two.xyz", "three.txt"), "three.txt: 3 weights, but two.xyz has 2 sites; give one for each");
    assert_eq!(
        said("weighted.xyz", "three.txt"),
        "weighted.xyz: has weights already; leave --weights or the fourth column out"
    );
    assert_eq!(said("two.xyz", "nan.txt"), "nan.txt: line 2: 'nan' is not finite");
    assert_eq!(said("two.xyz", "rows.csv"), "rows.csv: line 1: more than one column; one weight a line is needed");
    assert_eq!(said("two.xyz", "none.txt"), "none.txt: no weights in it; one for each site is needed");
    assert_eq!(
        said("two.xyz", "cube.off"),
        "cube.off: unknown ending '.off'; known here: .txt, .csv, .npy; also packed, as .txt.gz"
    );
    assert!(said("two.xyz", "gone.txt").starts_with("gone.txt: cannot open: "));
}

#[test]
fn files_that_are_none_are_refused() {
    let folder = inputs();
    let folder = folder.path();
    fs::create_dir(folder.join("folder.xyz")).unwrap();
    fs::create_dir(folder.join("folder.npy")).unwrap();
    let said = |sites: &str| fails(folder, 2, &["integrate", sites, "--box", UNIT_BOX, "-o", "cells.csv"]);
    assert_eq!(said("folder.xyz"), "folder.xyz: it is a folder; name a file");
    assert_eq!(said("folder.npy"), "folder.npy: it is a folder; name a file");
    assert!(said("gone.xyz").starts_with("gone.xyz: cannot open: "));
    assert_eq!(
        said("sites"),
        "sites: no ending; known here: .xyz, .txt, .csv, .npy, .ply, .dump, .lammpstrj, .vtk, .vtp, .npz; also packed, as .xyz.gz"
    );
    assert_eq!(
        said("sites.las"),
        "sites.las: unknown ending '.las'; known here: .xyz, .txt, .csv, .npy, .ply, .dump, .lammpstrj, .vtk, .vtp, .npz; also packed, as .xyz.gz"
    );
    let args = ["integrate", "-", "--box", UNIT_BOX, "-o", "cells.csv"];
    let said = |input: &[u8]| failed(&laguerre_with(folder, &args, input), 2, &args);
    assert_eq!(said(b"0 0 0\n0 x 0\n"), "standard input: line 2: 'x' is not a number");
    assert_eq!(said(b""), "standard input: no sites in it; at least one is needed");
    assert!(!folder.join("cells.csv").exists());
}

#[test]
fn numbers_beyond_the_range_are_named_by_site() {
    let folder = inputs();
    let said = |text: &str| said_of(folder.path(), "far.xyz", text.as_bytes());
    assert_eq!(said("0 0 0\n0 1e61 0\n"), "site 1: coordinate 1e61 is not a number within ±1e60; choose another unit");
    assert_eq!(
        said("0 0 0 0\n0 0 0 -1e121\n"),
        "site 1: weight -1e121 is not a number within ±1e120; choose another unit"
    );
    assert!(
        said("0 0 0\n0 0 0\n5e3 0 0\n")
            .starts_with("site 2 at [5000.0, 0.0, 0.0] is out of range: sites must stand within")
    );
    assert!(
        said("0 0 0 1e9\n0 0 0 0\n")
            .starts_with("site 0 has weight 1000000000, the smallest weight is 0: weights must")
    );
    // Without a box, that of the sites is taken.
    fs::write(folder.path().join("flat.xyz"), "0 0 0\n1 1 0\n0 1 0\n").unwrap();
    assert_eq!(
        fails(folder.path(), 2, &["integrate", "flat.xyz", "-o", "cells.csv"]),
        "flat.xyz: the bounding box of the 3 sites is flat: give a box or a domain to restrict their cells to"
    );
}

/// The cells of any sites cover all of space, so none leaves a domain unmet: sites beside it share it as they must, which is
/// right, but noted, since a mistake in the unit looks the same; sites so far away that digits are lost are refused.
#[test]
fn a_domain_beside_all_sites_still_belongs_to_them() {
    let folder = inputs();
    let folder = folder.path();
    fs::write(folder.join("beside.xyz"), "10 0.5 0.5\n20 0.5 0.5\n10 0.25 0.5\n").unwrap();
    let args = ["integrate", "beside.xyz", "--domain", "cube.off", "-o", "cells.csv", "--json"];
    let report = json(&runs(folder, &args));
    assert_eq!((&report["cells"], &report["empty"], &report["domain_volume"]), (&2.into(), &1.into(), &1.0.into()));
    assert!(report["relative_error"].as_f64().unwrap() <= 1e-14, "{report}");
    assert_eq!(
        notes(folder, &args),
        ["no site is in the domain's box; are sites and domain in the same unit and place?"]
    );
    assert!(notes(folder, &["integrate", "white.xyz", "--domain", "cube.off", "-o", "cells.csv"]).is_empty());
    fs::remove_file(folder.join("cells.csv")).unwrap();
    fs::write(folder.join("shifted.off"), CUBE.replace("\n1 ", "\n3001 ").replace("\n0 ", "\n3000 ")).unwrap();
    let line = fails(
        folder,
        2,
        &["integrate", "white.xyz", "--domain", "shifted.off", "-o", "cells.csv", "--facets", "f.csv"],
    );
    assert!(line.starts_with("white.xyz: site "), "{line}");
}
