//! Every format of sites, weights and meshes is read to the same numbers.

use std::fs;
use std::path::Path;

use crate::support::{CUBE, UNIT_BOX, fails, files, inputs, json, laguerre_with, notes, runs};

/// Sites in the unit cube and their weights; exact in 32 bits.
const SITES: [[f64; 4]; 5] = [
    [0.25, 0.25, 0.25, 0.0],
    [0.75, 0.25, 0.375, 0.125],
    [0.5, 0.75, 0.25, -0.0625],
    [0.125, 0.625, 0.875, 0.03125],
    [0.875, 0.75, 0.625, 0.0],
];

/// The sites as text, their numbers parted by `between`, the lines by `end`.
fn text(columns: usize, between: &str, end: &str) -> String {
    let row = |site: &[f64; 4]| site[..columns].iter().map(f64::to_string).collect::<Vec<_>>().join(between);
    SITES.iter().map(|site| row(site) + end).collect()
}

/// A `.npy` file of version `version`.
fn npy(version: u8, kind: &str, fortran: bool, shape: &str, data: Vec<u8>) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut bytes = [&b"\x93NUMPY"[..], &[version, 0]].concat();
    match version {
        1 => bytes.extend((header.len() as u16).to_le_bytes()),
        _ => bytes.extend((header.len() as u32).to_le_bytes()),
    }
    [bytes, header.into_bytes(), data].concat()
}

fn by_rows() -> impl Iterator<Item = f64> {
    SITES.into_iter().flatten()
}

fn by_columns() -> impl Iterator<Item = f64> {
    (0..4).flat_map(|k| SITES.map(|site| site[k]))
}

/// The sites as the vertices of a binary `.ply`, among lists and elements that do not matter.
fn ply() -> Vec<u8> {
    let mut bytes = b"ply\r\nformat binary_big_endian 1.0\r\ncomment caf\xe9\r\nelement face 1\r\n\
        property list uchar int vertex_indices\r\nelement vertex 5\r\nproperty list uchar short ring\r\n\
        property float x\r\nproperty double y\r\nproperty float z\r\nproperty double weight\r\nend_header\r\n"
        .to_vec();
    bytes.extend([3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]);
    for [x, y, z, w] in SITES {
        bytes.extend([1, 255, 255]);
        bytes.extend((x as f32).to_be_bytes());
        bytes.extend(y.to_be_bytes());
        bytes.extend((z as f32).to_be_bytes());
        bytes.extend(w.to_be_bytes());
    }
    bytes
}

/// What `integrate` writes for sites and more arguments.
fn cells(folder: &Path, args: &[&str]) -> String {
    runs(folder, &[&["integrate", "--box", "0,0,0,1,1,1", "-o", "cells.csv"], args].concat());
    fs::read_to_string(folder.join("cells.csv")).unwrap()
}

#[test]
fn sites_are_the_same_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let little: Vec<u8> = by_rows().flat_map(f64::to_le_bytes).collect();
    let variants: [(&str, Vec<u8>); 13] = [
        ("plain.xyz", text(4, " ", "\n").into()),
        ("counted.txt", format!("  5 # sites\n{}", text(4, "\t ", "\n\n")).into()),
        ("windows.TXT", format!("\u{feff}# made by hand\r\n{}", text(4, "  ", "\r\n")).into()),
        ("commented.xyz", [b"# caf\xe9\n", text(4, " ", " # a site\n").as_bytes()].concat()),
        ("plain.csv", text(4, ",", "\n").into()),
        ("named.csv", format!("x,y,z,weight\r\n{}", text(4, ", ", "\r\n")).into()),
        ("c.npy", npy(1, "<f8", false, "(5, 4)", little.clone())),
        ("second.npy", npy(2, "<f8", false, "(5, 4)", little)),
        ("fortran.npy", npy(1, "<f8", true, "(5, 4)", by_columns().flat_map(f64::to_le_bytes).collect())),
        ("big.npy", npy(1, ">f8", false, "(5, 4)", by_rows().flat_map(f64::to_be_bytes).collect())),
        ("single.npy", npy(1, "<f4", true, "(5, 4)", by_columns().flat_map(|x| (x as f32).to_le_bytes()).collect())),
        ("single-big.npy", npy(3, ">f4", false, "(5, 4)", by_rows().flat_map(|x| (x as f32).to_be_bytes()).collect())),
        ("vertices.ply", ply()),
    ];
    fs::write(folder.join("sites.xyz"), text(4, " ", "\n")).unwrap();
    let expected = cells(folder, &["sites.xyz"]);
    assert!(expected.matches(",NaN,0\n").count() == 5 && !expected.contains("0.2,"), "{expected}");
    for (name, bytes) in variants {
        fs::write(folder.join(name), bytes).unwrap();
        assert_eq!(cells(folder, &[name]), expected, "{name}");
    }
    let args = ["integrate", "-", "--box", "0,0,0,1,1,1", "-o", "cells.csv", "--json"];
    let output = laguerre_with(folder, &args, text(4, " ", "\n").as_bytes());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(json(&String::from_utf8(output.stdout).unwrap())["sites"], 5);
    assert_eq!(fs::read_to_string(folder.join("cells.csv")).unwrap(), expected);
}

#[test]
fn weights_may_have_a_file_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("all.xyz"), text(4, " ", "\n")).unwrap();
    fs::write(folder.join("sites.csv"), text(3, ",", "\n")).unwrap();
    let lines: String = SITES.iter().map(|site| format!("{}\n", site[3])).collect();
    let bytes: Vec<u8> = SITES.iter().flat_map(|site| site[3].to_le_bytes()).collect();
    fs::write(folder.join("w.txt"), &lines).unwrap();
    fs::write(folder.join("w.csv"), format!("weight\n{lines}")).unwrap();
    fs::write(folder.join("w.npy"), npy(1, "<f8", false, "(5,)", bytes)).unwrap();
    let expected = cells(folder, &["all.xyz"]);
    assert_ne!(cells(folder, &["sites.csv"]), expected);
    for name in ["w.txt", "w.csv", "w.npy"] {
        assert_eq!(cells(folder, &["sites.csv", "--weights", name]), expected, "{name}");
    }
}

#[test]
fn samples_are_the_same_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let sample = |name: &str| runs(folder, &["sample", "white", "100", "-o", name]);
    sample("s.xyz");
    let expected = cells(folder, &["s.xyz"]);
    for name in ["s.txt", "s.csv", "s.npy", "s.ply"] {
        sample(name);
        assert_eq!(cells(folder, &[name]), expected, "{name}");
    }
}

/// The triangles of the cube, by its corners.
fn triangles() -> Vec<[[f64; 3]; 3]> {
    let numbers = |line: &str| line.split(' ').map(|word| word.parse::<usize>().unwrap()).collect::<Vec<_>>();
    let rows: Vec<Vec<usize>> = CUBE.lines().skip(2).map(numbers).collect();
    let corner = |i: usize| [0, 1, 2].map(|k| rows[i][k] as f64);
    let faces = rows[8..].iter();
    faces.flat_map(|f| [[f[1], f[2], f[3]], [f[1], f[3], f[4]]].map(|t| t.map(corner))).collect()
}

fn binary_stl(header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12_u32.to_le_bytes());
    for triangle in triangles() {
        // Normals that are wrong: they do not count.
        bytes.extend([0xff; 12]);
        bytes.extend(triangle.iter().flatten().flat_map(|&x| (x as f32).to_le_bytes()));
        bytes.extend([1, 2]);
    }
    bytes
}

fn text_stl() -> String {
    let corner = |[x, y, z]: &[f64; 3]| format!("vertex {x:e} {y} {z:?}\r\n");
    let facet = |t: &[[f64; 3]; 3]| {
        format!(
            "facet normal -nan(ind) 0 0\nouter loop\n{}endloop\nendfacet\n",
            t.iter().map(corner).collect::<String>()
        )
    };
    // Two solids, as exporters write assemblies.
    let all: Vec<String> = triangles().iter().map(facet).collect();
    format!("solid one\n{}endsolid one\nsolid\n{}endsolid\n", all[..6].concat(), all[6..].concat())
}

/// The rows of the cube's vertices, and of its faces with `first` added to each index.
fn rows(first: usize) -> (Vec<String>, Vec<String>) {
    let lines: Vec<&str> = CUBE.lines().skip(2).collect();
    let raised = |line: &&str| {
        line.split(' ').skip(1).map(|i| (i.parse::<usize>().unwrap() + first).to_string()).collect::<Vec<_>>().join(" ")
    };
    (lines[..8].iter().map(|&line| line.to_owned()).collect(), lines[8..].iter().map(raised).collect())
}

/// With groups that share no vertices, materials, normals, texture coordinates, lines and points.
fn dressed_obj() -> Vec<u8> {
    let mut file = b"# caf\xe9\nmtllib none.mtl\nvn 0 0 1\nvt 0 0\n".to_vec();
    let (vertices, faces) = rows(1);
    for (g, face) in faces.iter().enumerate() {
        let corners: Vec<usize> = face.split(' ').map(|i| i.parse().unwrap()).collect();
        file.extend(format!("o part\ng g{g}\nusemtl m{g}\ns {g}\n").bytes());
        for &i in &corners {
            file.extend(format!("v {} 0.5 0.25 1.0\n", vertices[i - 1]).bytes());
        }
        // From the back, with texture and normal, over two lines.
        file.extend(b"f -4/1/1 -3/1/1 \\\n -2//1 -1\nl -1 -2\np -1\n");
    }
    file
}

fn obj() -> String {
    let (vertices, faces) = rows(1);
    let vertices: String = vertices.iter().map(|v| format!("v {v}\n")).collect();
    vertices + &faces.iter().map(|f| format!("f {f}\n")).collect::<String>()
}

fn text_ply() -> String {
    let (vertices, faces) = rows(0);
    let header = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nelement tag 1\nproperty uchar t\nelement face 6\n\
        property list uchar uint vertex_index\nproperty uchar red\nend_header\n";
    let vertices: String = vertices.iter().map(|v| format!("{v} nan\n")).collect();
    format!("{header}{vertices}7\n{}", faces.iter().map(|f| format!("4 {f} 255\n")).collect::<String>())
}

fn binary_ply(big: bool) -> Vec<u8> {
    let (vertices, faces) = rows(0);
    let kind = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{kind}_endian 1.0\nelement vertex 8\nproperty double x\nproperty short y\nproperty float z\n\
         element face 6\nproperty list int ushort vertex_indices\nend_header\n"
    )
    .into_bytes();
    let mut put = |number: &[u8]| if big { bytes.extend(number.iter().rev()) } else { bytes.extend(number) };
    for vertex in vertices {
        let v: Vec<f64> = vertex.split(' ').map(|x| x.parse().unwrap()).collect();
        put(&v[0].to_le_bytes());
        put(&(v[1] as i16).to_le_bytes());
        put(&(v[2] as f32).to_le_bytes());
    }
    for face in faces {
        put(&4_i32.to_le_bytes());
        face.split(' ').for_each(|i| put(&i.parse::<u16>().unwrap().to_le_bytes()));
    }
    bytes
}

#[test]
fn meshes_are_the_same_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("sites.xyz"), text(4, " ", "\n")).unwrap();
    let volumes = |mesh: &str| -> Vec<f64> {
        assert!(notes(folder, &["integrate", "sites.xyz", "--domain", mesh, "-o", "cells.csv"]).is_empty(), "{mesh}");
        let cells = fs::read_to_string(folder.join("cells.csv")).unwrap();
        cells.lines().skip(1).map(|row| row.split(',').nth(1).unwrap().parse().unwrap()).collect()
    };
    fs::write(folder.join("cube.off"), CUBE).unwrap();
    let expected = volumes("cube.off");
    let variants: [(&str, Vec<u8>); 11] = [
        ("coloured.off", CUBE.replace("OFF", "\u{feff}# made by hand\r\nCOFF").replace('\n', " # c\r\n").into()),
        ("plain.obj", obj().into()),
        ("windows.OBJ", format!("\u{feff}{}", obj().replace('\n', "\r\n").replace(' ', "\t")).into()),
        ("dressed.obj", dressed_obj()),
        ("text.stl", text_stl().into()),
        ("binary.stl", binary_stl(b"made by hand")),
        ("solid.stl", binary_stl(b"solid made by hand")),
        ("text.ply", text_ply().into()),
        ("windows.ply", text_ply().replace('\n', "\r\n").into()),
        ("little.ply", binary_ply(false)),
        ("big.ply", binary_ply(true)),
    ];
    for (name, bytes) in variants {
        fs::write(folder.join(name), bytes).unwrap();
        for (i, (found, expected)) in volumes(name).iter().zip(&expected).enumerate() {
            // Triangles come in another order: some roundings of numbers up to 1.
            assert!((found - expected).abs() < 1e-15, "{name}, site {i}: {found} for {expected}");
        }
    }
    assert!(!files(folder).keys().any(|path| path.to_string_lossy().ends_with(".part")));
}

/// Atoms are sites: the chemists' rows and LAMMPS's dump give the cells of their positions.
#[test]
fn atoms_are_sites() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let rows = ["0.5 0.25 0.125", "0.75 0.5 0.5", "0.25 0.75 0.875"];
    fs::write(folder.join("sites.xyz"), rows.join("\n")).unwrap();
    let expected = cells(folder, &["sites.xyz"]);
    let dump = |columns: &str, between: &str| {
        let rows: Vec<String> = rows.iter().enumerate().map(|(i, row)| format!("{}{between}{row}\n", i + 1)).collect();
        let bounds = "ITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n";
        format!("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n3\n{bounds}ITEM: ATOMS {columns}\n{}", rows.concat())
    };
    for (name, text) in [
        ("atoms.xyz", format!("3\nwater\nO {}\nH {}\nH {}\n", rows[0], rows[1], rows[2])),
        ("a.dump", dump("id type x y z", " 1 ")),
        ("a.lammpstrj", dump("id xs ys zs", " ")),
    ] {
        fs::write(folder.join(name), &text).unwrap();
        assert_eq!(cells(folder, &[name]), expected, "{name}");
        let args = ["integrate", "-", "--box", "0,0,0,1,1,1", "-o", "-"];
        assert_eq!(laguerre_with(folder, &args, text.as_bytes()).stdout, expected.as_bytes(), "{name}");
    }
    fs::write(folder.join("film.xyz"), "1\n\nHe 1 2 3\n1\n\nHe 1 2 3\n").unwrap();
    let line = fails(folder, 2, &["integrate", "film.xyz"]);
    assert_eq!(line, "film.xyz: line 4: more rows than the 1 that line 1 says; give one frame alone");
    let line = fails(folder, 2, &["sample", "white", "9", "-o", "a.dump"]);
    assert!(line.ends_with("unknown ending '.dump'; known here: .xyz, .txt, .csv, .npy, .ply"), "{line}");
}

#[test]
fn columns_are_named_by_the_file_or_the_command_line() {
    let folder = inputs();
    let folder = folder.path();
    let rows: Vec<[f64; 5]> = (0..20)
        .map(|i| [f64::from(i), 0.618, 0.414, 0.732, 0.1].map(|x: f64| (x * f64::from(i + 1)).fract()))
        .collect();
    let text = |between: &str, order: [usize; 5]| {
        let row = |row: &[f64; 5]| order.map(|k| format!("{:?}", row[k])).join(between) + "\n";
        rows.iter().map(row).collect::<String>()
    };
    fs::write(folder.join("named.csv"), "r;z;y;x;id\n".to_owned() + &text(";", [4, 3, 2, 1, 0])).unwrap();
    fs::write(folder.join("voro.txt"), text(" ", [0, 1, 2, 3, 4])).unwrap();
    let plain = |row: &[f64; 5]| format!("{:?} {:?} {:?} {:?}\n", row[1], row[2], row[3], row[4] * row[4]);
    fs::write(folder.join("plain.xyz"), rows.iter().map(plain).collect::<String>()).unwrap();
    let cells = |sites: &[&str]| {
        runs(folder, &[&["integrate"], sites, &["--box", UNIT_BOX, "-o", "cells.csv"]].concat());
        fs::read(folder.join("cells.csv")).unwrap()
    };
    let expected = cells(&["plain.xyz"]);
    assert_eq!(cells(&["named.csv"]), expected);
    assert_eq!(cells(&["voro.txt", "--columns", "id,x,y,z,r"]), expected);
    let line = fails(folder, 2, &["integrate", "voro.txt", "--columns", "id,x,y"]);
    assert!(line.contains("no column 'z' among 'id,x,y'; x, y and z are needed"), "{line}");
}
