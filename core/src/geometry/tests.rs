use super::*;
use crate::cell::{COMPLETE, PlainStore};
use crate::oracle::Naive;
use crate::search::Search;
use crate::shapes::{self, Contact};
use crate::{Backend, CellStatus, Output, PowerDiagram, Request};
use glam::{DMat3, DVec3};
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

/// How much larger the convex hull of a solid may be, at most: a hull has no more volume than all that stands before a face; of one that is turned
/// inside out (`sign` is negative), behind it.
fn before_faces(geometry: &Geometry, solid: &[Face<'_>], sign: f64) -> f64 {
    let at = |&c: &u32| DVec3::from(geometry.points()[c as usize]);
    let corners: Vec<DVec3> = solid.iter().flat_map(|face| face.corners).map(at).collect();
    let before = |face: &Face<'_>| {
        let p: Vec<DVec3> = face.corners.iter().map(at).collect();
        let area: DVec3 = p[1..].windows(2).map(|pair| (pair[0] - p[0]).cross(pair[1] - p[0]) / 2.0).sum();
        corners.iter().map(|&c| sign * (c - p[0]).dot(area) / 3.0).fold(0.0, f64::max)
    };
    solid.iter().map(before).sum()
}

/// Holds the faces and the solids of all cells to the cells' integrals, within 1e-12 of the mean volume.
fn hold(what: &str, diagram: &PowerDiagram, whole: f64) -> Output {
    let output = Naive::default().evaluate(diagram, &Request::moments().with_solids()).unwrap();
    let geometry = output.geometry().unwrap();
    let bound = 1e-12 * whole / output.volume().len() as f64;
    let points = || geometry.points().iter().map(|&p| DVec3::from(p));
    let (lo, hi) = points().fold((DVec3::MAX, DVec3::MIN), |(lo, hi), p| (lo.min(p), hi.max(p)));
    for i in 0..geometry.sites() {
        let is_empty = output.status()[i] == CellStatus::Empty;
        assert_eq!(geometry.faces(i).len() == 0, is_empty, "{what}: cell {i} of volume {}", output.volume()[i]);
        if is_empty {
            continue;
        }
        // Where volumes cancel the barycenter may be far away, and the moment about it is all rounding.
        let barycenter = DVec3::from(output.barycenter()[i]);
        let about = barycenter.clamp(lo, hi);
        let (volume, moment) = enclosed(geometry, geometry.faces(i), about);
        let off_moment = moment - output.volume()[i] * (barycenter - about);
        let off = (volume - output.volume()[i]).abs().max(off_moment.length());
        assert!(off < bound, "{what}: cell {i} is off by {off:e}");
        let mut filled = 0.0;
        for solid in geometry.solids(i) {
            let (volume, _) = enclosed(geometry, solid.iter().copied(), about);
            let before = before_faces(geometry, &solid, volume.signum());
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
fn solids_are_turned_where_the_winding_number_is_negative() {
    // A box, and one turned inside out of which a third is in it: winding numbers 1, 0 and −1. And two boxes that share a part: 1 and 2.
    let bar = shapes::cuboid([0.5, 0.2, 0.3], [2.0, 0.8, 0.7]);
    let ball = shapes::icosphere(1).transformed(DMat3::from_diagonal(DVec3::splat(0.4)), DVec3::new(1.0, 0.5, 0.5));
    for (name, other) in [
        ("a bar turned", bar.clone().flipped()),
        ("a ball turned", ball.clone().flipped()),
        ("a bar", bar),
        ("a ball", ball),
    ] {
        let domain = shapes::cuboid([0.0; 3], [1.0; 3]).merged(&other).domain();
        let (lo, hi) = domain.bounding_box();
        for n in [1, 2, 7, 60, 400] {
            let diagram = PowerDiagram::new(&white(n, lo, hi), &[]).unwrap().restricted_to(&domain);
            let output = hold(&format!("{name}, {n} sites"), &diagram, domain.volume());
            let negative = output.volume().iter().filter(|&&v| v < 0.0).count();
            let is_right = if name.ends_with("turned") { negative > 0 || n < 60 } else { negative == 0 };
            assert!(is_right, "{name}, {n} sites: {negative} negative");
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
}

/// The points of a geometry, and those that faces have.
fn counted(geometry: &Geometry) -> [usize; 2] {
    let mut used: Vec<u32> =
        (0..geometry.sites()).flat_map(|i| geometry.faces(i)).flat_map(|face| face.corners).copied().collect();
    used.sort_unstable();
    used.dedup();
    [geometry.points().len(), used.len()]
}

#[test]
fn cells_of_lattices_share_their_corners() {
    for n in [1, 2, 3, 5, 8] {
        for (lo, hi) in [([0.0; 3], [1.0; 3]), ([-0.1, 0.3, 7.0], [0.7, 0.9, 7.7]), ([1e6; 3], [1e6 + 1.0; 3])] {
            let diagram = PowerDiagram::new(&lattice(n, lo, hi), &[]).unwrap().in_box(lo, hi).unwrap();
            let output = Naive::default().evaluate(&diagram, &Request::moments().with_geometry()).unwrap();
            assert_eq!(counted(output.geometry().unwrap()), [(n + 1).pow(3); 2], "{n}³ from {lo:?}");
        }
    }
    // Of a face-centred lattice: rhombic dodecahedra, of 14 corners, of which 8 are of four cells and 6 of six; those at the box are not counted so.
    let n = 4;
    let at = |i: usize| [i % n, i / n % n, i / n / n].map(|k| k as f64);
    let shifts = [[0.25; 3], [0.25, 0.75, 0.75], [0.75, 0.25, 0.75], [0.75, 0.75, 0.25]];
    let sites = (0..n.pow(3)).flat_map(|i| shifts.map(|s| [0, 1, 2].map(|k| (at(i)[k] + s[k]) / n as f64)));
    let diagram = PowerDiagram::new(&sites.collect::<Vec<_>>(), &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let output = hold("face-centred", &diagram, 1.0);
    let geometry = output.geometry().unwrap();
    let mut places: Vec<[i64; 3]> =
        geometry.points().iter().map(|p| p.map(|x| (x * 4096.0 * n as f64).round() as i64)).collect();
    places.sort_unstable();
    places.dedup();
    assert_eq!(places.len(), geometry.points().len(), "two points in one place");
}

#[test]
fn points_that_are_apart_stay_so() {
    // Two lattices of one plane each, the second moved by some thousand roundings: its corners are near those of the first, and are others.
    let shift = 1e-11;
    let mut sites = lattice(4, [0.0; 3], [1.0; 3]);
    sites.iter_mut().filter(|x| x[2] > 0.5).for_each(|x| x[0] += shift);
    let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let output = hold("sheared", &diagram, 1.0);
    let geometry = output.geometry().unwrap();
    let [points, used] = counted(geometry);
    assert_eq!(points, used);
    let middle: Vec<_> =
        geometry.points().iter().filter(|p| (p[2] - 0.5).abs() < 1e-9 && (p[1] - 0.5).abs() < 1e-9).collect();
    // Along the line of those: 5 of the lattice below, and the 3 within of that above.
    assert_eq!(middle.len(), 8, "{middle:?}");
}

#[test]
fn coordinates_far_from_the_origin_share_their_corners_too() {
    let (lo, hi) = ([1e9, -1e9, 0.0], [1e9 + 1.0, -1e9 + 1.0, 1.0]);
    let diagram = PowerDiagram::new(&white(200, lo, hi), &[]).unwrap().in_box(lo, hi).unwrap();
    let output = Naive::default().evaluate(&diagram, &Request::moments().with_geometry()).unwrap();
    let [points, used] = counted(output.geometry().unwrap());
    let diagram = PowerDiagram::new(&white(200, [0.0; 3], [1.0; 3]), &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let output = Naive::default().evaluate(&diagram, &Request::moments().with_geometry()).unwrap();
    // Coordinates that have lost 23 bits make a few cells others.
    let expected = counted(output.geometry().unwrap())[0];
    assert_eq!(points, used);
    assert!(points.abs_diff(expected) * 50 < expected, "{points} against {expected}");
}

#[test]
fn solids_are_made_where_they_are_asked_for() {
    let domain = shapes::box_with_cavity(1).domain();
    let (lo, hi) = domain.bounding_box();
    let diagram = PowerDiagram::new(&white(20, lo, hi), &[]).unwrap().restricted_to(&domain);
    let [without, with] = [Request::moments().with_geometry(), Request::moments().with_solids()]
        .map(|request| Naive::default().evaluate(&diagram, &request).unwrap().into_arrays().geometry.unwrap());
    assert!(!without.has_solids() && with.has_solids());
    assert_eq!((0..20).flat_map(|i| without.solids(i)).count(), 0);
    let [points, used] = counted(&without);
    assert_eq!(points, used, "points of solids alone");
    assert!(with.points().len() > points);
}

#[test]
fn one_cell_of_a_hollow_ball_is_solids() {
    let sphere = shapes::icosphere(4);
    let inner = sphere.transformed(DMat3::from_diagonal(DVec3::splat(0.5)), DVec3::ZERO).flipped();
    let domain = sphere.merged(&inner).domain();
    let diagram = PowerDiagram::new(&[[0.1, 0.2, 0.3]], &[]).unwrap().restricted_to(&domain);
    let output = hold("hollow ball", &diagram, domain.volume());
    let solids = output.geometry().unwrap().solids(0).count();
    assert!(solids < 32 * domain.triangles().len(), "{solids} solids");
}

#[test]
fn more_points_than_have_numbers_are_refused() {
    let diagram = PowerDiagram::new(&[[0.5; 3]], &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let prepared = diagram.prepare().unwrap();
    let (frame, order) = (&prepared.container.frame, prepared.sites.order());
    let [x, y, z, _] = prepared.sites.site(0);
    let mut store = PlainStore::new([x, y, z], None);
    assert_eq!(Search::new(&prepared).complete(&mut store, 0, None).status, COMPLETE);
    let mut shapes = Shapes::default();
    assert_eq!(Shaper::default().add(&store, 0, 1.0, order, frame, &mut shapes), COMPLETE);
    for (most, is_enough) in [(7, false), (8, true)] {
        let mut assembler = GeometryAssembler::new(1, frame, false).with_most_points(most);
        assembler.add(&shapes);
        let geometry = assembler.finish();
        assert_eq!(geometry.is_ok(), is_enough);
        assert!(geometry.map_or_else(|e| e.to_string().contains("points; take fewer"), |g| g.points().len() == 8));
    }
}

#[test]
fn loops_lose_what_leads_nowhere() {
    for (given, left) in [
        (&[1, 2, 3][..], &[1, 2, 3][..]),
        (&[1, 1, 2, 2, 3, 3], &[1, 2, 3]),
        (&[1, 2, 1, 3, 4], &[1, 3, 4]),
        (&[2, 1, 3, 4, 1], &[1, 3, 4]),
        (&[5, 1, 2, 3, 1, 5, 4], &[1, 2, 3]),
        (&[1, 2, 3, 1, 4, 5], &[1, 2, 3, 1, 4, 5]),
        (&[1, 2, 3, 2], &[]),
        (&[1, 2], &[]),
    ] {
        let mut faces = faces::Faces::default();
        faces.push_simplified(&mut given.to_vec(), Beyond::Nothing);
        let mut found = faces.iter().next().map_or(Vec::new(), |face| face.0.to_vec());
        let begin = (0..found.len()).find(|&k| left.iter().eq(found[k..].iter().chain(&found[..k])));
        found.rotate_left(begin.unwrap_or(0));
        assert_eq!(found, left, "{given:?}");
    }
}
