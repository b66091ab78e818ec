//! The same mesh in every encoding, and what is wrong named.

use super::*;
use crate::Domain;

/// A pyramid over a square: a face of four corners, four of three.
const VERTICES: [[f64; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
const FACES: [&[u32]; 5] = [&[3, 2, 1, 0], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];

/// The pyramid among things that do not matter.
fn header(encoding: &str) -> String {
    format!(
        "ply\nformat {encoding} 1.0\ncomment caf\u{e9}\nobj_info none\nelement camera 1\nproperty list uchar short view\n\
         property float zoom\nelement vertex 5\nproperty double x\nproperty uchar red\nproperty float y\n\
         property list uint8 int16 ring\nproperty float32 z\nproperty float w\nelement face 5\nproperty uint flags\n\
         property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nend_header\n"
    )
}

fn text() -> String {
    let mut file = header("ascii") + "2 7 8 nan\n";
    for [x, y, z] in VERTICES {
        file += &format!("{x} 255 {y} 1 -3 {z} 0.5\n");
    }
    for face in FACES {
        let corners: Vec<String> = face.iter().map(u32::to_string).collect();
        file += &format!("9 {} {}\n", face.len(), corners.join(" "));
    }
    file + "0\n"
}

fn binary(big: bool) -> Vec<u8> {
    let mut file = header(if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
    let mut put = |bytes: &[u8]| if big { file.extend(bytes.iter().rev()) } else { file.extend(bytes) };
    put(&[2]);
    [7_i16, 8].iter().for_each(|x| put(&x.to_le_bytes()));
    put(&f32::NAN.to_le_bytes());
    for [x, y, z] in VERTICES {
        put(&x.to_le_bytes());
        put(&[255]);
        put(&(y as f32).to_le_bytes());
        put(&[1]);
        put(&(-3_i16).to_le_bytes());
        put(&(z as f32).to_le_bytes());
        put(&0.5_f32.to_le_bytes());
    }
    for face in FACES {
        put(&9_u32.to_le_bytes());
        put(&[face.len() as u8]);
        face.iter().for_each(|&i| put(&i.to_le_bytes()));
    }
    put(&0_i32.to_le_bytes());
    file
}

#[test]
fn every_encoding_is_the_same_mesh_and_the_same_sites() {
    let mesh = parse_mesh(text().as_bytes()).unwrap();
    assert_eq!(mesh.vertices, VERTICES);
    assert_eq!(mesh.triangles, [[3, 2, 1], [3, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
    let volume = Domain::new(&mesh.vertices, &mesh.triangles).unwrap().volume();
    assert!((volume - 1.0 / 3.0).abs() < 1e-16);
    let windows = text().replace('\n', "\r\n");
    for file in [binary(false), binary(true), windows.into_bytes()] {
        assert_eq!(parse_mesh(&file[..]).unwrap(), mesh);
        let sites = parse_sites(&file[..]).unwrap();
        assert_eq!(sites, SitesFile { positions: VERTICES.to_vec(), weights: vec![0.5; 5] });
    }
    let unweighted = text().replace("float w\n", "float radius\n");
    assert_eq!(parse_sites(unweighted.as_bytes()).unwrap().weights, []);
    // `face` before `vertex`.
    let first = "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_index\nelement vertex 3\n\
        property int x\nproperty int y\nproperty int z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n";
    assert_eq!(parse_mesh(first.as_bytes()).unwrap().triangles, [[0, 1, 2]]);
}

#[test]
fn headers_are_not_believed() {
    let wrong = |text: &str| parse_mesh(text.as_bytes()).unwrap_err().to_string();
    let with = |from: &str, to: &str| wrong(&text().replace(from, to));
    assert_eq!(wrong("solid\n"), "line 1: not a PLY file: it should begin with the line 'ply'");
    assert_eq!(wrong("ply\nformat ascii 1.0\n"), "line 3: the file ends within the header");
    assert_eq!(wrong("ply\nend_header\n"), "its header has no line 'format'");
    assert_eq!(wrong("ply\nformat ascii 1.0\nend_header\n"), "no element 'vertex' in its header");
    assert_eq!(with("format ascii", "format gzip"), "line 2: 'format gzip 1.0' is no line of a PLY header");
    assert_eq!(with("vertex 5", "vertex five"), "line 8: 'five' is not a number of elements");
    assert_eq!(with("element vertex 5", "element camera 5"), "line 8: element camera a second time");
    assert_eq!(with("uchar red", "uchar x"), "line 10: property x a second time");
    assert_eq!(with("double x", "real x"), "line 9: 'real' is no type of a property");
    assert_eq!(with("list uchar int", "list float int"), "line 17: the number of a list's values must be whole");
    assert_eq!(with("double x", "list uchar double x"), "its vertices have no property 'x'");
    assert!(with("vertex_indices", "corners").starts_with("its faces have no list of vertex_indices"));
    assert_eq!(wrong("ply\nproperty int x\n"), "line 2: a property before any element");
    // Counting to this number would take centuries, and keeping what is counted all memory.
    let bare = "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\nend_header\n";
    assert_eq!(wrong(bare), "its element vertex has no properties");
    let absurd = text().replace("vertex 5", "vertex 18446744073709551615");
    assert_eq!(wrong(&absurd), "line 27: vertex 5 (from 0): z is missing");
}

#[test]
fn rows_are_named_when_wrong() {
    let wrong = |text: &str| parse_mesh(text.as_bytes()).unwrap_err().to_string();
    let with = |from: &str, to: &str| wrong(&text().replace(from, to));
    assert_eq!(with("0.5 255", "nan 255"), "line 26: vertex 4 (from 0): x is NaN, which is not finite");
    assert_eq!(with("0.5 255", "half 255"), "line 26: vertex 4 (from 0): 'half' is not a number");
    assert_eq!(with("1 -3 1 0.5", "1 -3 1"), "line 26: vertex 4 (from 0): w is missing");
    assert_eq!(with("1 -3 1 0.5", "99999999999999999999 -3 1 0.5"), "line 26: vertex 4 (from 0): ring is missing");
    assert_eq!(with("9 3 3 0 4", "9 3 3 0 5"), "line 31: face 4 (from 0): vertex 5 of 5 (from 0) does not exist");
    assert_eq!(with("9 3 3 0 4", "9 3 3 0 -1"), "line 31: face 4 (from 0): vertex -1 of 5 (from 0) does not exist");
    assert_eq!(with("9 3 3 0 4", "9 3 3 0 0.5"), "line 31: face 4 (from 0): vertex 0.5 of 5 (from 0) does not exist");
    assert_eq!(with("9 3 3 0 4", "9 2 3 0"), "line 31: face 4 (from 0): 2 corners; at least 3 are needed");
    assert_eq!(with("9 3 3 0 4", "9 3 3 0 4 1"), "line 31: face 4 (from 0): '1' is more than the header announces");
    assert_eq!(with("9 3 3 0 4\n0\n", ""), "line 31: face 4 (from 0): the file ends after 4 of 5");
    let whole = binary(true);
    let short = parse_mesh(&whole[..whole.len() - 5]).unwrap_err().to_string();
    assert_eq!(short, "face 4 (from 0): the file ends after 4 of 5");
    // Of the first vertex, the sign and exponent of x.
    let mut infinite = whole;
    let data = header("binary_big_endian").len() + 9;
    infinite[data..data + 8].copy_from_slice(&f64::INFINITY.to_be_bytes());
    assert_eq!(parse_sites(&infinite[..]).unwrap_err().to_string(), "vertex 0 (from 0): x is inf, which is not finite");
}
