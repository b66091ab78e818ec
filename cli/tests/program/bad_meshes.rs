//! Meshes that are wrong, and meshes that only look it.

use std::fs;
use std::path::Path;

use crate::support::{CUBE, fails, inputs, json, notes, runs};

/// Writes a mesh, and returns what `integrate` says of it after the file's name.
fn said_of(folder: &Path, name: &str, bytes: &[u8]) -> String {
    fs::write(folder.join(name), bytes).unwrap();
    let args = ["integrate", "white.xyz", "--domain", name, "-o", "cells.csv", "--facets", "facets.csv", "--json"];
    let line = fails(folder, 2, &args);
    line.strip_prefix(&format!("{name}: ")).unwrap_or_else(|| panic!("{line}")).to_owned()
}

/// Writes a mesh that is accepted, and returns its volume and the notes on it.
fn accepted(folder: &Path, name: &str, bytes: &[u8]) -> (f64, Vec<String>) {
    fs::write(folder.join(name), bytes).unwrap();
    let args = ["integrate", "white.xyz", "--domain", name, "--json"];
    let report = json(&runs(folder, &args));
    assert!(report["relative_error"].as_f64().unwrap() <= 1e-14, "{report}");
    (report["domain_volume"].as_f64().unwrap(), notes(folder, &args))
}

#[test]
fn surfaces_that_enclose_nothing_are_named_by_edge_and_triangle() {
    let folder = inputs();
    let said = |text: &str| said_of(folder.path(), "bad.off", text.as_bytes());
    // Without its last face.
    assert_eq!(
        said(&CUBE.replace("8 6 0", "8 5 0")),
        "the domain's surface is open: the edge from [0.0, 0.0, 0.0] to [0.0, 1.0, 0.0] of triangle 1 (from 0) belongs to no other \
         triangle; close the hole"
    );
    // A fin on an edge: that is met by three triangles.
    let fin = said(
        &CUBE
            .replace("8 6 0", "9 7 0")
            .replace("0 1 1\n", "0 1 1\n2 2 2\n")
            .replace("4 3 0 4 7\n", "4 3 0 4 7\n3 0 1 8\n"),
    );
    assert!(fin.starts_with("the domain's surface is open: the edge from ["), "{fin}");
    // Two squares, back to back.
    assert_eq!(
        said("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n4 3 2 1 0\n"),
        "the domain's 4 triangles enclose volume 0: give a closed surface that bounds a solid"
    );
    let point = said("OFF\n3 1 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n");
    assert!(point.starts_with("all 1 triangles of the domain have two vertices at one place"), "{point}");
}

#[test]
fn meshes_without_triangles_are_refused() {
    let folder = inputs();
    let folder = folder.path();
    let stl = [&[0; 80][..], &0_u32.to_le_bytes()].concat();
    let ply = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        element face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n";
    for (name, bytes) in [
        ("none.off", &b"OFF\n1 0 0\n0 0 0\n"[..]),
        ("none.obj", b"v 0 0 0\nl 1 1\n"),
        ("empty.obj", b""),
        ("none.stl", b"solid\nendsolid\n"),
        ("binary.stl", &stl),
        ("none.ply", ply),
    ] {
        assert_eq!(said_of(folder, name, bytes), "no faces in it; a closed triangle mesh is needed", "{name}");
    }
    assert_eq!(
        said_of(folder, "points.ply", &ply.to_vec().replacing("face 0", "edge 0")),
        "no element 'face' in its header"
    );
}

/// `str::replace` for bytes that are text.
trait Replacing {
    fn replacing(&self, from: &str, to: &str) -> Vec<u8>;
}

impl Replacing for Vec<u8> {
    fn replacing(&self, from: &str, to: &str) -> Vec<u8> {
        String::from_utf8(self.clone()).unwrap().replace(from, to).into_bytes()
    }
}

#[test]
fn indices_and_counts_are_held_against_the_file() {
    let folder = inputs();
    let folder = folder.path();
    let off = |from: &str, to: &str| said_of(folder, "bad.off", CUBE.replace(from, to).as_bytes());
    assert_eq!(off("4 3 0 4 7", "4 3 0 4 8"), "line 16: face 5: vertex 8 of 8 (from 0) does not exist");
    assert_eq!(off("4 3 0 4 7", "4 3 0 4 -7"), "line 16: face 5: '-7' is not an index");
    assert_eq!(off("4 3 0 4 7", "5 3 0 4 7"), "line 16: face 5: an index is missing");
    assert_eq!(off("4 3 0 4 7", "2 3 0"), "line 16: face 5: 2 corners; at least 3 are needed");
    assert_eq!(off("8 6 0", "8 7 0"), "line 17: the file ends after 6 of 7 faces");
    // What follows three coordinates is a colour, so the first face passes for a vertex.
    assert_eq!(off("8 6 0", "9 6 0"), "line 17: the file ends after 5 of 6 faces");
    assert_eq!(off("8 6 0", "4294967295 4294967295 0"), "line 17: the file ends after 14 of 4294967295 vertices");
    assert_eq!(off("1 1 1\n", "1 1 nan\n"), "line 9: vertex 6: 'nan' is not finite");
    let obj = |text: &str| said_of(folder, "bad.obj", text.as_bytes());
    assert_eq!(obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), "line 4: vertex 4 of 3 does not exist");
    assert_eq!(obj("v 0 0 0\nf 1 1 -2\n"), "line 2: vertex -2 of the 1 so far does not exist");
    assert_eq!(obj("v 0 0 0\nf 0 1 1\n"), "line 2: vertex 0: OBJ counts from 1");
    assert_eq!(obj("v 0 0 0\nv 0 inf 0\n"), "line 2: 'inf' is not finite");
    assert_eq!(obj("v 0 0 0\nv 0 zero 0\n"), "line 2: 'zero' is not a number");
    let mut stl = vec![0; 84 + 49];
    stl[80] = 1;
    assert_eq!(
        said_of(folder, "bad.stl", &stl),
        "binary, and says 1 triangles, which take 134 bytes, but it has 133; is the file whole?"
    );
    stl[80..84].fill(255);
    assert_eq!(
        said_of(folder, "bad.stl", &stl),
        "binary, and says 4294967295 triangles, which take 214748364834 bytes, but it has 133; is the file whole?"
    );
    assert_eq!(
        said_of(folder, "text.stl", b"v 0 0 0\n"),
        "neither text that begins with 'solid' nor a binary STL file"
    );
    assert_eq!(
        said_of(folder, "cut.stl", b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
        "line 5: the file ends, but 'vertex' or 'endloop' is needed; is it whole?"
    );
    assert_eq!(
        said_of(
            folder,
            "bad.ply",
            b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nelement face 1\nend_header\n"
        ),
        "its element vertex has no properties"
    );
    assert!(said_of(folder, "bad.ply", b"OFF\n").starts_with("line 1: not a PLY file"));
    assert!(said_of(folder, "bad.off", b"ply\n").starts_with("line 1: not a three-dimensional OFF file"));
}

#[test]
fn coordinates_beyond_the_range_are_named_by_vertex() {
    let folder = inputs();
    assert_eq!(
        said_of(folder.path(), "far.off", CUBE.replace("1 1 1\n", "1 1 1e61\n").as_bytes()),
        "vertex 6 of the domain: coordinate 1e61 is not a number within ±1e60; choose another unit"
    );
    let (head, faces) = CUBE.split_at(CUBE.find("4 3 2 1 0").unwrap());
    let small = head.replace('1', "1e-61") + faces;
    assert_eq!(
        said_of(folder.path(), "small.off", small.as_bytes()),
        "the domain's largest extent is 1e-61: it must be at least 1e-60; scale the mesh up"
    );
}

#[test]
fn a_flipped_mesh_is_turned_and_noted() {
    let folder = inputs();
    let (head, faces) = CUBE.split_at(CUBE.find("4 3 2 1 0").unwrap());
    let flip = |face: &str| {
        let corners: Vec<&str> = face.split(' ').skip(1).collect();
        format!("4 {}\n", corners.into_iter().rev().collect::<Vec<_>>().join(" "))
    };
    let flipped = head.to_owned() + &faces.lines().map(flip).collect::<String>();
    let (volume, notes) = accepted(folder.path(), "in.off", flipped.as_bytes());
    assert_eq!(volume, 1.0);
    assert_eq!(notes[0], "in.off: the mesh was oriented inward: all its triangles were flipped");
}

#[test]
fn triangles_that_do_not_agree_are_turned_and_noted() {
    let folder = inputs();
    let (volume, notes) = accepted(folder.path(), "one.off", CUBE.replace("4 3 0 4 7", "4 7 4 0 3").as_bytes());
    assert_eq!(volume, 1.0);
    assert!(
        notes[0].starts_with("one.off: 2 of 12 triangles were turned, for they were not consistently oriented"),
        "{notes:?}"
    );
    // A cube within a cube, both outward: counted twice, or asked to be a cavity.
    let (head, faces) = CUBE.split_at(CUBE.find("4 3 2 1 0").unwrap());
    let corners: Vec<&str> = head.lines().skip(2).collect();
    let inner = corners.iter().map(|line| line.replace('0', "0.25").replace('1', "0.75") + "\n").collect::<String>();
    let further = |face: &str| {
        let corners = face.split(' ').skip(1).map(|i| (i.parse::<u32>().unwrap() + 8).to_string());
        format!("4 {}\n", corners.collect::<Vec<_>>().join(" "))
    };
    let nested = head.replace("8 6 0", "16 12 0") + &inner + faces + &faces.lines().map(further).collect::<String>();
    std::fs::write(folder.path().join("two.off"), nested).unwrap();
    for (option, volume) in [(None, 1.125), (Some("--orient"), 0.875)] {
        let args = ["integrate", "white.xyz", "--domain", "two.off", "--json"];
        let args: Vec<&str> = args.into_iter().chain(option).collect();
        assert_eq!(json(&runs(folder.path(), &args))["domain_volume"].as_f64().unwrap(), volume);
    }
}

#[test]
fn triangles_without_area_are_accepted() {
    let folder = inputs();
    // A vertex in the midst of an edge, and the triangle without area that closes the seam; then one that is a line twice.
    let seam = CUBE.replace("8 6 0", "9 7 0").replace("0 1 1\n4", "0 1 1\n0.5 0 0\n4");
    let seam = seam.replace("4 3 2 1 0", "5 3 2 1 8 0") + "3 0 8 1\n";
    assert_eq!(accepted(folder.path(), "seam.off", seam.as_bytes()).0, 1.0);
    let twice = CUBE.replace("8 6 0", "8 7 0") + "3 2 2 6\n";
    let (volume, notes) = accepted(folder.path(), "twice.off", twice.as_bytes());
    assert_eq!(volume, 1.0);
    assert_eq!(notes[0], "twice.off: 1 triangles with two vertices at one place were dropped");
}

#[test]
fn meshes_that_are_no_files_are_refused() {
    let folder = inputs();
    let folder = folder.path();
    fs::create_dir(folder.join("d.stl")).unwrap();
    let said = |mesh: &str| fails(folder, 2, &["integrate", "white.xyz", "--domain", mesh, "-o", "cells.csv"]);
    assert_eq!(said("d.stl"), "d.stl: it is a folder; name a file");
    assert!(said("gone.ply").starts_with("gone.ply: cannot open: "));
    assert_eq!(
        said("white.xyz"),
        "white.xyz: unknown ending '.xyz'; known here: .obj, .off, .ply, .stl, .vtk, .vtp; also packed, as .obj.gz"
    );
    assert_eq!(said("-"), "-: no ending; known here: .obj, .off, .ply, .stl, .vtk, .vtp; also packed, as .obj.gz");
}
