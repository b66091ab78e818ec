//! Laws of the grid, against slow and independent answers.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::*;
use crate::shapes::{Mesh, icosphere, tetrahedron, torus, trefoil};

/// A cube whose top has a vertex in its middle: at `top`, wherever that is.
fn dented_cube(top: [f64; 3]) -> Mesh {
    let mut mesh = crate::shapes::cuboid([0.0; 3], [1.0; 3]);
    mesh.vertices.push(top);
    mesh.triangles.retain(|t| t.iter().any(|&v| v < 4));
    mesh.triangles.extend([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]]);
    mesh
}

/// Shapes of every kind, in coordinates of a frame, with a name.
fn shapes() -> Vec<(&'static str, Mesh)> {
    let turned = DMat3::from_rotation_x(0.3) * DMat3::from_rotation_z(1.1);
    let sphere = |center: [f64; 3], radius: f64, subdivisions: u32| {
        icosphere(subdivisions).transformed(turned * radius, DVec3::from(center))
    };
    let outer = || sphere([0.1, -0.3, 0.4], 0.45, 3);
    let inner = sphere(INNER, 0.25, 2);
    vec![
        ("cube", dented_cube([0.5, 0.5, 1.0])),
        ("dented cube", dented_cube([0.3, 0.6, 0.25])),
        ("tetrahedron", tetrahedron().transformed(turned * 0.7, DVec3::new(0.3, -0.4, 1.1))),
        ("sphere", outer()),
        ("sphere in a sphere", outer().merged(&inner)),
        ("cavity", outer().merged(&inner.flipped())),
        ("torus", torus(0.33, 0.13, 40, 24).transformed(turned, DVec3::new(0.0, 0.3, 0.0))),
        ("knot", trefoil(0.4, 90, 12).transformed(turned / 8.0, DVec3::splat(-0.5))),
    ]
}

/// The center of the inner sphere of [`shapes`].
const INNER: [f64; 3] = [0.12, -0.31, 0.45];

fn grid_of(mesh: &Mesh) -> DomainGrid {
    DomainGrid::new(&mesh.vertices, &mesh.triangles, &vec![1; mesh.triangles.len()], 0)
}

/// The solid angle of the surface seen from `x`, over 4π (Van Oosterom and Strackee).
fn winding_by_solid_angle(mesh: &Mesh, x: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut angle = 0.0;
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| [0, 1, 2].map(|k| mesh.vertices[i as usize][k] - x[k]));
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
        angle += 2.0 * dot(a, cross).atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    angle / (4.0 * PI)
}

fn assert_windings(name: &str, mesh: &Mesh, grid: &DomainGrid) {
    let every = (grid.voxel_index(grid.dims().map(|d| d - 1)) / 3000).max(1);
    let mut n = 0;
    each_voxel([0; 3], grid.dims().map(|d| d - 1), |voxel| {
        n += 1;
        if n % every == 0 {
            let right = winding_by_solid_angle(mesh, grid.corner(voxel));
            let found = f64::from(grid.winding(voxel));
            assert!((found - right).abs() < 1e-6, "{name}: winding {found} at {voxel:?}, solid angle says {right}");
        }
    });
}

#[test]
fn windings_are_those_of_the_solid_angle() {
    for (name, mesh) in shapes() {
        let grid = grid_of(&mesh);
        assert_windings(name, &mesh, &grid);
        let expected = match name {
            "sphere in a sphere" => vec![0, 1, 2],
            _ => vec![0, 1],
        };
        let mut found = grid.windings().to_vec();
        found.sort_unstable();
        found.dedup();
        assert_eq!(found, expected, "{name}");
        let inside = grid.winding([0, 1, 2].map(|k| grid.voxel_of(k, INNER[k])));
        match name {
            "sphere" => assert_eq!(inside, 1),
            "sphere in a sphere" => assert_eq!(inside, 2),
            "cavity" => assert_eq!(inside, 0),
            _ => {}
        }
    }
}

#[test]
fn the_grid_encloses_the_domain_with_exact_corners() {
    for (name, mesh) in shapes() {
        let grid = grid_of(&mesh);
        let h = grid.voxel_width();
        let (lo, hi) = bounding_box(&mesh.vertices);
        let (first, last) = (grid.corner([0; 3]), grid.corner(grid.dims()));
        for k in 0..3 {
            let (low, high) = ((lo[k] - first[k]) / h, (last[k] - hi[k]) / h);
            assert!((0.5..0.76).contains(&low) && (0.24..1.26).contains(&high), "{name}: margins {low} {high}");
            for i in 0..=grid.dims()[k] {
                let x = grid.corner([i; 3].map(|i| i.min(grid.dims()[k])))[k];
                let steps = (x - first[k]) / h;
                assert_eq!(steps, f64::from(i));
                assert_eq!(steps * h + first[k], x);
                if i < grid.dims()[k] {
                    assert_eq!(grid.voxel_of(k, x), i);
                    assert_eq!(grid.voxel_of(k, x.next_down()), i.saturating_sub(1));
                }
            }
            assert_eq!(grid.voxel_of(k, 1e300), grid.dims()[k] - 1);
            assert_eq!(grid.voxel_of(k, -1e300), 0);
        }
        let max = [0, 1, 2].map(|k| grid.dims()[k]).into_iter().max().unwrap();
        let wanted = (mesh.triangles.len() as f64).sqrt().max(12.0);
        assert!((f64::from(max) - wanted).abs() <= 2.0, "{name}: {max} voxels, {wanted} wanted");
    }
}

#[test]
fn a_grid_that_touches_the_surface_is_shifted() {
    let plain = dented_cube([0.5, 0.5, 0.75]);
    let first = grid_of(&plain);
    let c = first.corner([6, 5, 7]);
    let tops = [
        // A vertex on a corner; a vertex on a line of corners.
        c,
        [c[0] + 0.01, c[1], c[2]],
        // The edge from (0, 0, 1) to the top has the corner, then only a line of corners, at its middle.
        [2.0 * c[0], 2.0 * c[1], 2.0 * c[2] - 1.0],
        [2.0 * c[0] + 0.01, 2.0 * c[1], 2.0 * c[2] - 1.0],
        // The corner in the middle of the triangle (0, 0, 1), (1, 0, 1), top; its plane contains the x axis.
        [2.0 * c[0] - 0.6, 2.0 * c[1], 2.0 * c[2] - 1.0],
    ];
    for top in tops {
        let mesh = dented_cube(top);
        let (lo, hi) = bounding_box(&mesh.vertices);
        assert_eq!((lo, hi), bounding_box(&plain.vertices), "the test is void");
        let grid = grid_of(&mesh);
        assert_ne!(grid.corner([0; 3]), first.corner([0; 3]), "top {top:?}");
        assert_windings("shifted", &mesh, &grid);
    }
    // The same with x and z exchanged: now the line along x crosses the triangle's inside in the very corner.
    let exchange = |mesh: Mesh| {
        Mesh { vertices: mesh.vertices.into_iter().map(|[x, y, z]| [z, y, x]).collect(), ..mesh }.flipped()
    };
    let c = grid_of(&exchange(plain)).corner([7, 5, 6]);
    let mesh = exchange(dented_cube([2.0 * c[2] - 0.6, 2.0 * c[1], 2.0 * c[0] - 1.0]));
    let grid = grid_of(&mesh);
    assert_ne!(grid.corner([7, 5, 6]), c);
    assert_windings("exchanged", &mesh, &grid);
}

/// Deterministic numbers in [0, 1).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

fn random_range(grid: &DomainGrid, state: &mut u64) -> ([u32; 3], [u32; 3]) {
    let mut pick = |k: usize| (random(state) * f64::from(grid.dims()[k])) as u32;
    let (a, b) = ([pick(0), pick(1), pick(2)], [pick(0), pick(1), pick(2)]);
    ([0, 1, 2].map(|k| a[k].min(b[k])), [0, 1, 2].map(|k| a[k].max(b[k])))
}

#[test]
fn each_triangle_of_a_box_is_taken_once() {
    let mut state = 7;
    for (name, mesh) in shapes() {
        let grid = grid_of(&mesh);
        for _ in 0..60 {
            let (lo, hi) = random_range(&grid, &mut state);
            let (min, max) = (grid.corner(lo), grid.corner(hi.map(|i| i + 1)));
            let mut taken = vec![0; mesh.triangles.len()];
            each_voxel(lo, hi, |voxel| {
                for &t in grid.triangles_in(voxel) {
                    let lowest = grid.lowest_voxel(t);
                    taken[t as usize] += u32::from(voxel == [0, 1, 2].map(|k| lowest[k].max(lo[k])));
                }
            });
            for (t, triangle) in mesh.triangles.iter().enumerate() {
                let (a, b) = bounding_box(&triangle.map(|i| mesh.vertices[i as usize]));
                let meets = (0..3).all(|k| a[k] < max[k] && b[k] >= min[k]);
                assert_eq!(taken[t], u32::from(meets), "{name}: triangle {t} in {lo:?}..={hi:?}");
            }
        }
    }
}

#[test]
fn surface_voxels_hold_the_surface_and_little_else() {
    let mut state = 11;
    for (name, mesh) in shapes() {
        let grid = grid_of(&mesh);
        let mut hit = vec![false; grid.windings().len()];
        let steps = 200_000 / mesh.triangles.len() + 20;
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
            for _ in 0..steps {
                let (mut u, mut v) = (random(&mut state), random(&mut state));
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let p = [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
                hit[grid.voxel_index([0, 1, 2].map(|k| grid.voxel_of(k, p[k])))] = true;
            }
        }
        let met = |voxel| grid.surface_voxels(voxel, voxel) == 1;
        let (mut met_count, mut hit_count) = (0, 0);
        each_voxel([0; 3], grid.dims().map(|d| d - 1), |voxel| {
            let hit = hit[grid.voxel_index(voxel)];
            assert!(grid.surface_voxels(voxel, voxel) <= 1);
            assert!(!hit || met(voxel), "{name}: {voxel:?} is missed");
            met_count += u32::from(met(voxel));
            hit_count += u32::from(hit);
            // A voxel that the surface misses has one winding number, so its neighbours across agree with it.
            for k in 0..3 {
                let mut next = voxel;
                next[k] += 1;
                if next[k] < grid.dims()[k] && !met(voxel) {
                    assert_eq!(grid.winding(voxel), grid.winding(next), "{name}: {voxel:?} to {next:?}");
                }
            }
        });
        assert!(f64::from(met_count) < 1.1 * f64::from(hit_count), "{name}: {met_count} met, {hit_count} hit");
        for _ in 0..60 {
            let (lo, hi) = random_range(&grid, &mut state);
            let mut count = 0;
            each_voxel(lo, hi, |voxel| count += u32::from(met(voxel)));
            assert_eq!(grid.surface_voxels(lo, hi), count, "{name}: {lo:?}..={hi:?}");
        }
    }
}

#[test]
fn long_diagonal_triangles_do_not_fill_the_memory() {
    // A thin screw of long slivers from one corner of the cube to the opposite one.
    let n = 10_000_u32;
    let mut vertices = vec![[0.0; 3], [1.0, 0.99, 0.98]];
    let mut triangles = Vec::new();
    for i in 0..n {
        let s = 2.0 * PI * f64::from(i) / f64::from(n);
        vertices.push([0.5 + 0.1 * s.cos(), 0.5 + 0.1 * s.sin(), 0.5]);
        let (p, q) = (2 + i, 2 + (i + 1) % n);
        triangles.extend([[1, p, q], [0, q, p]]);
    }
    let mesh = Mesh { vertices, triangles };
    let grid = grid_of(&mesh);
    assert!(grid.entries().len() <= 8 * (mesh.triangles.len() + grid.windings().len()));
    assert!(grid.dims()[0] < 100 && grid.windings().contains(&1));
    assert_windings("screw", &mesh, &grid);
}
