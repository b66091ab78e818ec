//! Closed, outward oriented triangle meshes made by code: the domains of tests, benches, examples and of the program's demo.
//!
//! Where a shape has a formula for its volume, the tests below hold the mesh against it; [`Domain::new`] checks closedness
//! and orientation once more.

mod folded;
mod swan;

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use crate::Domain;

pub use folded::{Section, folded_prism};
pub use swan::swan;

/// A triangle mesh as arrays. Triangles are counterclockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions (length).
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The mesh as a validated domain.
    ///
    /// # Panics
    /// Where the mesh is not closed: never for the shapes of this module.
    pub fn domain(&self) -> Domain {
        Domain::new(&self.vertices, &self.triangles).unwrap_or_else(|error| panic!("a mesh made by code: {error}"))
    }

    /// Every vertex `x` moved to `matrix · x + shift`. Triangles are turned over where `matrix` mirrors, so that outward
    /// stays outward.
    #[must_use]
    pub fn transformed(&self, matrix: DMat3, shift: DVec3) -> Self {
        let vertices = self.vertices.iter().map(|&x| (matrix * DVec3::from(x) + shift).into()).collect();
        let mesh = Self { vertices, triangles: self.triangles.clone() };
        if matrix.determinant() < 0.0 { mesh.flipped() } else { mesh }
    }

    /// This mesh and `other` in one, nothing welded.
    #[must_use]
    pub fn merged(mut self, other: &Self) -> Self {
        let base = index(self.vertices.len());
        self.vertices.extend_from_slice(&other.vertices);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + base)));
        self
    }

    /// Every triangle turned over: inside becomes outside, the signed volume changes its sign.
    #[must_use]
    pub fn flipped(mut self) -> Self {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }
}

/// How the two boxes of [`touching_boxes`] meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// A whole face of each.
    Face,
    /// Parts of a face of each, so that the edges of one lie inside triangles of the other.
    PartOfFace,
    /// An edge of each.
    Edge,
    /// A vertex of each.
    Vertex,
}

/// The box with minimum corner `lo` and maximum corner `hi`: 12 triangles.
pub fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Mesh {
    let vertices = (0..8).map(|c| std::array::from_fn(|k| if c >> k & 1 == 1 { hi[k] } else { lo[k] })).collect();
    // Corners are numbered by bits (x 1, y 2, z 4); each face is a quad, counterclockwise from outside.
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { vertices, triangles }
}

/// One tetrahedron with three edges of length 1 along the axes; volume 1/6.
pub fn tetrahedron() -> Mesh {
    Mesh {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    }
}

/// The icosahedron inscribed in the unit sphere, each triangle split in four `subdivisions` times and the new vertices
/// moved to the sphere: 20·4ˢ triangles.
pub fn icosphere(subdivisions: u32) -> Mesh {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut vertices = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        vertices.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]].map(|x| <[f64; 3]>::from(DVec3::from(x).normalize())));
    }
    // The faces are the triples of mutually nearest vertices (edge² = 4 / (1 + golden²) ≈ 1.1, the next distance² ≈ 2.9).
    let near = |a: usize, b: usize| DVec3::from(vertices[a]).distance_squared(DVec3::from(vertices[b])) < 2.0;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let [x, y, z] = [a, b, c].map(|v| DVec3::from(vertices[v]));
                    let outward = x.dot(y.cross(z)) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] }.map(index));
                }
            }
        }
    }
    let mut mesh = Mesh { vertices, triangles };
    for _ in 0..subdivisions {
        mesh = split_on_sphere(&mesh);
    }
    mesh
}

/// A torus around the z axis: the circle of radius `minor` (length) led along the circle of radius `major`, in `around`
/// times `across` quads. Its volume tends to 2π²·major·minor² as they grow.
pub fn torus(major: f64, minor: f64, around: u32, across: u32) -> Mesh {
    tube(minor, around, across, |t| {
        let (sin, cos) = t.sin_cos();
        (DVec3::new(major * cos, major * sin, 0.0), DVec3::new(cos, sin, 0.0), DVec3::Z)
    })
}

/// A tube of radius `radius` along the trefoil knot `((2 + cos 3t) cos 2t, (2 + cos 3t) sin 2t, sin 3t)`, of `along` times
/// `across` quads. It does not meet itself for radii up to 0.4.
pub fn trefoil(radius: f64, along: u32, across: u32) -> Mesh {
    tube(radius, along, across, |t| {
        let ((s2, c2), (s3, c3)) = ((2.0 * t).sin_cos(), (3.0 * t).sin_cos());
        let center = DVec3::new((2.0 + c3) * c2, (2.0 + c3) * s2, s3);
        let tangent =
            DVec3::new(-3.0 * s3 * c2 - 2.0 * (2.0 + c3) * s2, -3.0 * s3 * s2 + 2.0 * (2.0 + c3) * c2, 3.0 * c3);
        // The knot lies on a torus, whose normal is across the knot everywhere and closes up after one turn.
        let normal = DVec3::new(c3 * c2, c3 * s2, s3);
        (center, normal, normal.cross(tangent).normalize())
    })
}

/// A sphere of radius ½ within the unit sphere, both outward: the winding number is 2 in the inner one, 1 between them.
pub fn nested_spheres(subdivisions: u32) -> Mesh {
    let sphere = icosphere(subdivisions);
    sphere.clone().merged(&sphere.transformed(DMat3::from_diagonal(DVec3::splat(0.5)), DVec3::ZERO))
}

/// The box [−1, 1]³ without a ball of radius ½ about (0.2, 0.1, 0).
pub fn box_with_cavity(subdivisions: u32) -> Mesh {
    cuboid([-1.0; 3], [1.0; 3]).merged(&cavity(subdivisions).flipped())
}

/// What [`box_with_cavity`] lacks of its box, oriented outward.
pub fn cavity(subdivisions: u32) -> Mesh {
    icosphere(subdivisions).transformed(DMat3::from_diagonal(DVec3::splat(0.5)), DVec3::new(0.2, 0.1, 0.0))
}

/// The two separate parts of [`two_components`].
pub fn components(subdivisions: u32) -> [Mesh; 2] {
    let sphere = icosphere(subdivisions).transformed(DMat3::IDENTITY, DVec3::new(1.5, 0.0, 0.0));
    [cuboid([-1.0, -0.5, -0.5], [0.0, 0.5, 0.5]), sphere]
}

/// A box and a sphere apart from each other.
pub fn two_components(subdivisions: u32) -> Mesh {
    let [first, second] = components(subdivisions);
    first.merged(&second)
}

/// Two unit boxes, each a closed shell of its own, that touch: volume 2.
pub fn touching_boxes(contact: Contact) -> Mesh {
    let shift = match contact {
        Contact::Face => [1.0, 0.0, 0.0],
        Contact::PartOfFace => [1.0, 0.25, 0.5],
        Contact::Edge => [1.0, 1.0, 0.0],
        Contact::Vertex => [1.0, 1.0, 1.0],
    };
    let first = cuboid([0.0; 3], [1.0; 3]);
    let second = first.transformed(DMat3::IDENTITY, DVec3::from(shift));
    first.merged(&second)
}

/// A box of 2 × 2 × 0.02.
pub fn plate() -> Mesh {
    cuboid([0.0; 3], [2.0, 2.0, 0.02])
}

/// A box of 8 × 0.25 × 0.25, turned about no axis of symmetry: long triangles across all voxels.
pub fn long_box() -> Mesh {
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    cuboid([0.0; 3], [8.0, 0.25, 0.25]).transformed(turn, DVec3::ZERO)
}

/// A slab of 5 × 3 × 1 unit cubes without the two at (1, 1) and (3, 1): genus 2, volume 13, all its faces coplanar with
/// others.
pub fn double_torus() -> Mesh {
    cubes([5, 3, 1], |[i, j, _]| j != 1 || i % 2 == 0)
}

/// The surface of the union of the unit cubes `[i, i+1] × [j, j+1] × [k, k+1]` for which `filled` holds, among `dims` of them.
pub fn cubes(dims: [u32; 3], filled: impl Fn([u32; 3]) -> bool) -> Mesh {
    let inside = |c: [i64; 3]| {
        (0..3).all(|k| c[k] >= 0 && c[k] < i64::from(dims[k]))
            && filled(c.map(|x| u32::try_from(x).unwrap_or_default()))
    };
    let mut mesh = Mesh::default();
    let mut known: HashMap<[i64; 3], u32> = HashMap::new();
    let [nx, ny, nz] = dims.map(i64::from);
    for cell in (0..nx).flat_map(|i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k]))) {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beyond = cell;
                beyond[axis] += 2 * side - 1;
                if !inside(cell) || inside(beyond) {
                    continue;
                }
                let mut quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                    let mut corner = cell;
                    corner[axis] += side;
                    corner[(axis + 1) % 3] += a;
                    corner[(axis + 2) % 3] += b;
                    *known.entry(corner).or_insert_with(|| {
                        mesh.vertices.push(corner.map(|x| x as f64));
                        index(mesh.vertices.len() - 1)
                    })
                });
                if side == 0 {
                    quad.reverse();
                }
                mesh.triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
            }
        }
    }
    mesh
}

/// The circle of radius `radius` led along a closed curve in `along` times `across` quads: `frame(t)`, `0 ≤ t < 2π`, gives the
/// curve's point and two unit vectors `e`, `f` across it with `e × f` against the direction of travel.
fn tube(radius: f64, along: u32, across: u32, frame: impl Fn(f64) -> (DVec3, DVec3, DVec3)) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..along {
        let (center, e, f) = frame(TAU * f64::from(i) / f64::from(along));
        for j in 0..across {
            let (sin, cos) = (TAU * f64::from(j) / f64::from(across)).sin_cos();
            mesh.vertices.push((center + radius * (cos * e + sin * f)).into());
            let at = |i: u32, j: u32| (i % along) * across + j % across;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Each triangle of a mesh on the unit sphere split in four.
fn split_on_sphere(mesh: &Mesh) -> Mesh {
    let mut vertices = mesh.vertices.clone();
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let sum = DVec3::from(vertices[a as usize]) + DVec3::from(vertices[b as usize]);
            vertices.push(sum.normalize().into());
            index(vertices.len() - 1)
        })
    };
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for &[a, b, c] in &mesh.triangles {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh { vertices, triangles }
}

fn index(i: usize) -> u32 {
    u32::try_from(i).expect("a mesh made by code has fewer than 2³² vertices")
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn volume(mesh: &Mesh) -> f64 {
        let tetrahedron = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| DVec3::from(mesh.vertices[v as usize]));
            a.dot(b.cross(c)) / 6.0
        };
        mesh.triangles.iter().map(tetrahedron).sum()
    }

    /// V − E + F; 2 − 2·genus for each component.
    fn euler(mesh: &Mesh) -> i64 {
        mesh.vertices.len() as i64 - mesh.triangles.len() as i64 / 2
    }

    /// Every directed edge once, its reverse once: a closed surface, each triangle turned like its neighbours.
    fn assert_closed(mesh: &Mesh) {
        let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
        for &[a, b, c] in &mesh.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        for (&(a, b), &count) in &edges {
            assert_eq!((count, edges.get(&(b, a))), (1, Some(&1)), "edge {a}-{b}");
        }
    }

    #[test]
    fn shapes_are_closed_outward_and_of_their_genus() {
        for (name, mesh, euler_characteristic) in [
            ("cuboid", cuboid([-1.0, 0.0, 2.0], [1.0, 3.0, 4.0]), 2),
            ("tetrahedron", tetrahedron(), 2),
            ("icosphere", icosphere(2), 2),
            ("torus", torus(1.0, 0.4, 24, 12), 0),
            ("trefoil", trefoil(0.35, 60, 8), 0),
            ("nested spheres", nested_spheres(1), 4),
            ("box with cavity", box_with_cavity(1), 4),
            ("two components", two_components(1), 4),
            ("touching boxes", touching_boxes(Contact::Edge), 4),
            ("plate", plate(), 2),
            ("long box", long_box(), 2),
            ("double torus", double_torus(), -2),
            ("swan", swan(), 2),
        ] {
            assert_closed(&mesh);
            assert!(volume(&mesh) > 0.0, "{name} is turned inward");
            assert_eq!(euler(&mesh), euler_characteristic, "{name}");
        }
    }

    #[test]
    fn folded_prisms_are_closed_and_nearly_of_their_sections_volume() {
        for section in Section::ALL {
            for off in [0.0, 1e-13, 1e-2] {
                let mesh = folded_prism(section, off);
                assert_closed(&mesh);
                let corners = &mesh.vertices[..mesh.vertices.len() / 2];
                let next = corners.iter().cycle().skip(1);
                let area: f64 = corners.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum();
                let difference = (volume(&mesh) - 0.5 * area).abs();
                assert!(difference <= 1e-15 + 2.0 * off, "{section:?}, {off}: {} of {}", volume(&mesh), 0.5 * area);
            }
        }
    }

    #[test]
    fn volumes_are_those_of_the_formulas() {
        // Inscribed polyhedra miss the smooth volume by the square of the angle between neighbouring vertices.
        let sphere = 4.0 / 3.0 * PI;
        for (mesh, formula, relative) in [
            (cuboid([-1.0, 0.0, 2.0], [1.0, 3.0, 4.0]), 12.0, 1e-15),
            (tetrahedron(), 1.0 / 6.0, 1e-15),
            (icosphere(5), sphere, 2e-3),
            (torus(1.0, 0.4, 300, 100), 2.0 * PI * PI * 0.16, 2e-3),
            (nested_spheres(5), sphere * 1.125, 2e-3),
            (box_with_cavity(5), 8.0 - sphere / 8.0, 2e-3),
            (two_components(5), 1.0 + sphere, 2e-3),
            (touching_boxes(Contact::PartOfFace), 2.0, 1e-15),
            (plate(), 0.08, 1e-15),
            (long_box(), 0.5, 1e-14),
            (double_torus(), 13.0, 1e-14),
        ] {
            let difference = (volume(&mesh) - formula).abs();
            assert!(difference <= relative * formula, "{} for {formula}", volume(&mesh));
        }
    }

    #[test]
    fn mirroring_keeps_outward_and_flipping_does_not() {
        let mesh = icosphere(1);
        let mirrored = mesh.transformed(DMat3::from_diagonal(DVec3::new(-2.0, 1.0, 1.0)), DVec3::ONE);
        assert!((volume(&mirrored) - 2.0 * volume(&mesh)).abs() < 1e-14 * volume(&mesh) * 8.0);
        assert_eq!(volume(&mesh.clone().flipped()), -volume(&mesh));
    }
}
