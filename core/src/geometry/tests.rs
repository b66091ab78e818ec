use super::*;
use crate::oracle::Naive;
use crate::shapes::{self, Contact};
use crate::{Backend, CellStatus, Output, PowerDiagram, Request};
use glam::DVec3;
use std::collections::HashMap;

/// Sites that hardly touch anything, within a box.
fn white(n: usize, lo: [f64; 3], hi: [f64; 3]) -> Vec<[f64; 3]> {
    let steps = [0.819_172, 0.671_043, 0.549_7];
    (0..n).map(|i| std::array::from_fn(|k| lo[k] + (hi[k] - lo[k]) * ((i + 1) as f64 * steps[k]).fract())).collect()
}

/// Sites whose bisectors meet many at a time, and the vertices and edges of symmetric domains.
fn lattice(n: usize, lo: [f64; 3], hi: [f64; 3]) -> Vec<[f64; 3]> {
    let at = |i: usize, k: usize| lo[k] + (hi[k] - lo[k]) * (i as f64 + 0.5) / n as f64;
    (0..n * n * n).map(|i| [at(i % n, 0), at(i / n % n, 1), at(i / n / n, 2)]).collect()
}

/// Volume and first moment of what faces enclose; they must close.
fn enclosed<'a>(geometry: &Geometry, faces: impl Iterator<Item = Face<'a>>, about: DVec3) -> (f64, DVec3) {
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for face in faces {
        let corners: Vec<DVec3> =
            face.corners.iter().map(|&c| DVec3::from(geometry.points()[c as usize]) - about).collect();
        for pair in corners[1..].windows(2) {
            let v = corners[0].dot(pair[0].cross(pair[1])) / 6.0;
            volume += v;
            moment += v * (corners[0] + pair[0] + pair[1]) / 4.0;
        }
        for [a, b] in faces::edges(face.corners) {
            *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|&n| n == 0), "open");
    (volume, moment)
}

/// How much larger the convex hull of a solid may be, at most: a hull has no more volume than all that stands before a face.
fn before_faces(geometry: &Geometry, solid: &[Face<'_>]) -> f64 {
    let at = |&c: &u32| DVec3::from(geometry.points()[c as usize]);
    let corners: Vec<DVec3> = solid.iter().flat_map(|face| face.corners).map(at).collect();
    let before = |face: &Face<'_>| {
        let p: Vec<DVec3> = face.corners.iter().map(at).collect();
        let area: DVec3 = p[1..].windows(2).map(|pair| (pair[0] - p[0]).cross(pair[1] - p[0]) / 2.0).sum();
        corners.iter().map(|&c| (c - p[0]).dot(area) / 3.0).fold(0.0, f64::max)
    };
    solid.iter().map(before).sum()
}

/// Holds the faces and the solids of all cells to the cells' integrals, within 1e-12 of the mean volume.
fn hold(what: &str, diagram: &PowerDiagram, whole: f64) -> Output {
    let output = Naive::default().evaluate(diagram, &Request::moments().with_geometry()).unwrap();
    let geometry = output.geometry().unwrap();
    let bound = 1e-12 * whole / output.volume().len() as f64;
    for i in 0..geometry.sites() {
        let is_empty = output.status()[i] == CellStatus::Empty;
        assert_eq!(geometry.faces(i).len() == 0, is_empty, "{what}: cell {i} of volume {}", output.volume()[i]);
        if is_empty {
            continue;
        }
        let about = DVec3::from(output.barycenter()[i]);
        let (volume, moment) = enclosed(geometry, geometry.faces(i), about);
        let off = (volume - output.volume()[i]).abs().max(moment.length());
        assert!(off < bound, "{what}: cell {i} is off by {off:e}");
        let mut filled = 0.0;
        for solid in geometry.solids(i) {
            let (volume, _) = enclosed(geometry, solid.iter().copied(), about);
            let before = before_faces(geometry, &solid);
            assert!(before < bound, "{what}: a solid of cell {i} is not convex by {before:e}");
            filled += volume;
        }
        let off = (filled - volume).abs();
        assert!(off < bound, "{what}: the solids of cell {i} are off by {off:e}");
    }
    output
}

#[test]
fn faces_and_solids_are_the_cells() {
    for (name, mesh) in [
        ("sphere", shapes::icosphere(2)),
        ("cuboid", shapes::cuboid([0.0; 3], [1.0; 3])),
        ("torus", shapes::torus(1.0, 0.4, 16, 8)),
        ("trefoil", shapes::trefoil(0.35, 48, 6)),
        ("nested spheres", shapes::nested_spheres(1)),
        ("box with a cavity", shapes::box_with_cavity(1)),
        ("two components", shapes::two_components(1)),
        ("boxes that touch", shapes::touching_boxes(Contact::Edge)),
        ("double torus", shapes::double_torus()),
    ] {
        let domain = mesh.domain();
        let (lo, hi) = domain.bounding_box();
        let restricted = |sites: &[[f64; 3]]| PowerDiagram::new(sites, &[]).unwrap().restricted_to(&domain);
        for n in [1, 2, 7, 60, 400] {
            hold(&format!("{name}, {n} sites"), &restricted(&white(n, lo, hi)), domain.volume());
        }
        for n in [1, 2, 3, 4, 8] {
            hold(&format!("{name}, a lattice of {n}³"), &restricted(&lattice(n, lo, hi)), domain.volume());
        }
    }
}

#[test]
fn cells_share_their_corners() {
    let in_box = |sites: &[[f64; 3]]| PowerDiagram::new(sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let output = hold("white in a box", &in_box(&white(500, [0.0; 3], [1.0; 3])), 1.0);
    let geometry = output.geometry().unwrap();
    // Of simple polytopes that fill a box: each corner within is one of four cells, on a face of the box of three, on an edge of two, in a corner of one.
    let mut cells: HashMap<u32, Vec<usize>> = HashMap::new();
    for i in 0..500 {
        for &corner in geometry.faces(i).flat_map(|face| face.corners) {
            let cells = cells.entry(corner).or_default();
            if cells.last() != Some(&i) {
                cells.push(i);
            }
        }
    }
    assert_eq!(cells.len(), geometry.points().len());
    for (corner, cells) in cells {
        let place = geometry.points()[corner as usize];
        let on_box = place.iter().filter(|&&x| x.min(1.0 - x).abs() < 1e-15).count();
        assert_eq!(cells.len(), [4, 3, 2, 1][on_box], "corner {place:?}");
    }
    hold("lattice in a box", &in_box(&lattice(5, [0.0; 3], [1.0; 3])), 1.0);
}
