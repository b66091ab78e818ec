//! What NumPy reads: text that is all numbers, and arrays. What `verify` reads of it is right.

use std::fs;
use std::path::Path;

use crate::support::{UNIT_BOX, failed, inputs, laguerre, runs};

/// Every field below the header, as a number.
fn numbers(path: &Path, columns: usize) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let rows = text.lines().skip(1).map(|line| line.split(',').map(|word| word.parse().unwrap()).collect());
    let rows: Vec<Vec<f64>> = rows.collect();
    assert!(rows.iter().all(|row| row.len() == columns));
    rows
}

/// The numbers of an array of 64-bit floats in an uncompressed archive, found by its name.
pub(crate) fn floats(archive: &[u8], name: &str, count: usize) -> Vec<f64> {
    bytes_of(archive, name, 8 * count).chunks(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect()
}

/// So many bytes of an array.
pub(crate) fn bytes_of<'a>(archive: &'a [u8], name: &str, count: usize) -> &'a [u8] {
    let name = format!("{name}.npy");
    let at = archive.windows(name.len()).position(|bytes| bytes == name.as_bytes()).unwrap() + name.len();
    let magic = archive[at..].windows(6).position(|bytes| bytes == b"\x93NUMPY").unwrap() + at;
    let start = magic + 10 + usize::from(u16::from_le_bytes([archive[magic + 8], archive[magic + 9]]));
    assert_eq!(start - magic, 128, "as NumPy pads it");
    &archive[start..start + count]
}

#[test]
fn text_is_numbers_and_arrays_are_the_same() {
    let folder = inputs();
    let folder = folder.path();
    for (cells, facets) in [("c.csv", "f.csv"), ("c.npz", "f.npz"), ("c.npy", "f.npy")] {
        let args = ["integrate", "strong.xyz", "--box", UNIT_BOX, "-o", cells, "--facets", facets];
        runs(folder, &args);
        runs(folder, &["verify", cells, "strong.xyz", "--box", UNIT_BOX, "--facets", facets]);
    }
    let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    let (cells, facets) = (numbers(&folder.join("c.csv"), 7), numbers(&folder.join("f.csv"), 7));
    let archive = fs::read(folder.join("c.npz")).unwrap();
    let (volume, barycenter) = (floats(&archive, "volume", 2000), floats(&archive, "barycenter", 6000));
    for (i, row) in cells.iter().enumerate() {
        assert!(same(row[1], volume[i]) && (0..3).all(|k| same(row[2 + k], barycenter[3 * i + k])), "{row:?}");
    }
    let archive = fs::read(folder.join("f.npz")).unwrap();
    let (area, distance) = (floats(&archive, "area", facets.len()), floats(&archive, "distance", facets.len()));
    let array = fs::read(folder.join("f.npy")).unwrap();
    let array: Vec<f64> = array[array.len() - 56 * facets.len()..]
        .chunks(8)
        .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()))
        .collect();
    for (k, row) in facets.iter().enumerate() {
        assert!(same(row[2], area[k]) && same(row[6], distance[k]), "{row:?}");
        assert!(row.iter().zip(&array[7 * k..]).all(|(&a, &b)| same(a, b)), "{row:?}");
    }
    // Without facets, too.
    runs(folder, &["integrate", "strong.xyz", "--box", UNIT_BOX, "-o", "alone.csv"]);
    assert!(numbers(&folder.join("alone.csv"), 7).iter().all(|row| row[5].is_nan()));
}

#[test]
fn second_moments_are_matrices() {
    let folder = inputs();
    let folder = folder.path();
    // One cell: the cube, whose moments are 1/12.
    fs::write(folder.join("one.xyz"), "0.3 0.4 0.5\n").unwrap();
    runs(folder, &["integrate", "one.xyz", "--box", UNIT_BOX, "--second-moments", "-o", "c.npz"]);
    let moments = floats(&fs::read(folder.join("c.npz")).unwrap(), "second_moment", 9);
    for (k, x) in moments.iter().enumerate() {
        let expected = if k % 4 == 0 { 1.0 / 12.0 } else { 0.0 };
        assert!((x - expected).abs() < 1e-15, "{moments:?}");
    }
}

#[test]
fn a_wrong_archive_is_said_in_one_line() {
    let folder = inputs();
    let folder = folder.path();
    let args = ["integrate", "white.xyz", "--box", UNIT_BOX, "-o", "c.npz", "--facets", "f.npz"];
    runs(folder, &args);
    let whole = fs::read(folder.join("c.npz")).unwrap();
    let verify = |bytes: &[u8]| {
        fs::write(folder.join("w.npz"), bytes).unwrap();
        laguerre(folder, &["verify", "w.npz", "white.xyz", "--box", UNIT_BOX])
    };
    let said = |bytes: &[u8]| failed(&verify(bytes), 2, &["w.npz"]);
    assert_eq!(said(b"junk"), "w.npz: no .npz file, or not the whole of one");
    assert_eq!(said(&whole[..whole.len() / 2]), "w.npz: no .npz file, or not the whole of one");
    let args = ["verify", "f.npz", "white.xyz", "--box", UNIT_BOX];
    assert_eq!(failed(&laguerre(folder, &args), 2, &args), "f.npz: there is no array 'volume' in it");
    let find = |what: &[u8]| whole.windows(what.len()).position(|bytes| bytes == what).unwrap();
    let mut wrong = whole.clone();
    let at = find(b"'<f8'");
    wrong[at..at + 5].copy_from_slice(b"'>f8'");
    let line = said(&wrong);
    assert!(line.starts_with("w.npz: array 'volume': type '>f8'; "), "{line}");
    // Any byte of a head may be wrong: a line, or findings, and no panic.
    for at in (0..200).step_by(7).chain(whole.len() - 150..whole.len()) {
        let mut wrong = whole.clone();
        wrong[at] ^= 0x55;
        let output = verify(&wrong);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(matches!(output.status.code(), Some(0 | 2 | 4)) && !errors.contains("panicked"), "{at}: {errors}");
    }
}
