//! Which convex polyhedra VTK takes for what they are.
//!
//! VTK (9.7, as all before) makes of a polyhedron the Delaunay tetrahedra of its corners, among which it puts six points of its own, two diagonals
//! of the bounding box from its middle along the axes. Two things make it lose tetrahedra, and with them volume and all that lies there. Where faces
//! meet at a shallow edge, a tetrahedron's sphere reaches as far as one of the six points, which then takes its place. And what is nearer to the plane
//! of a tetrahedron's face than a hundred thousandth of twice the diagonal counts as lying in it. Both are asked here, of the hull alone. Of 20,000
//! white cells in a box VTK loses a part of 235, of 145 for the first reason, all of which this finds, and no other; of 90 for the second.

use crate::cell::{Real, V3, add, cross, dot, scale, sub, v3};
use crate::geometry::Face;

/// How near a corner may be to the plane of a face that it is not on, or to the line of two corners of a face, as a share of the bounding box's
/// diagonal. VTK's bound is 2e-5 for planes that it meets on the way, which need not be those of faces: of what it lost none was farther than 3.2e-5.
const NEAR: Real = 5e-5;

/// What VTK takes off the square of a sphere's radius, with a margin: spheres through more than four corners are as usual in lattices as they are
/// exact there.
const TOUCHES: Real = 4e-6;

/// Corners of a polyhedron at most: where VTK looks for the place of a point it gives up after 200 steps.
const MOST_CORNERS: usize = 128;

/// Asks of one polyhedron after the other, and keeps its room.
#[derive(Default)]
pub(super) struct Polyhedra {
    corners: Vec<u32>,
    /// Of each corner its place about the first, and whether it is on the present face.
    places: Vec<(V3, bool)>,
    polygon: Vec<V3>,
    open: Vec<(usize, usize)>,
}

impl Polyhedra {
    /// Whether VTK keeps all of the convex polyhedron of these faces.
    pub(super) fn keeps<'a>(&mut self, points: &[[Real; 3]], faces: impl Iterator<Item = Face<'a>> + Clone) -> bool {
        self.corners.clear();
        self.corners.extend(faces.clone().flat_map(|face| face.corners));
        self.corners.sort_unstable();
        self.corners.dedup();
        let Some(&first) = self.corners.first() else { return true };
        if self.corners.len() > MOST_CORNERS {
            return false;
        }
        let at = |i: u32| {
            let [x, y, z] = points[i as usize];
            v3(x, y, z)
        };
        self.places.clear();
        self.places.extend(self.corners.iter().map(|&i| (sub(at(i), at(first)), false)));
        let (mut lo, mut hi) = (V3::default(), V3::default());
        for &(x, _) in &self.places {
            lo = v3(lo.x.min(x.x), lo.y.min(x.y), lo.z.min(x.z));
            hi = v3(hi.x.max(x.x), hi.y.max(x.y), hi.z.max(x.z));
        }
        let diagonal = dot(sub(hi, lo), sub(hi, lo)).sqrt();
        let (middle, far) = (scale(0.5, add(lo, hi)), 2.0 * diagonal);
        let ways = [v3(far, 0.0, 0.0), v3(0.0, far, 0.0), v3(0.0, 0.0, far)];
        let around = [0, 1, 2, 3, 4, 5].map(|k| if k < 3 { add(middle, ways[k]) } else { sub(middle, ways[k - 3]) });
        faces.into_iter().all(|face| {
            self.polygon.clear();
            self.places.iter_mut().for_each(|(_, is_on_face)| *is_on_face = false);
            for corner in face.corners {
                let (place, is_on_face) = &mut self.places[self.corners.partition_point(|c| c < corner)];
                self.polygon.push(*place);
                *is_on_face = true;
            }
            self.keeps_face(&around, NEAR * diagonal)
        })
    }

    /// The same of one face, given the points that VTK puts around.
    fn keeps_face(&mut self, around: &[V3; 6], near: Real) -> bool {
        let polygon = &self.polygon;
        let n = polygon.len();
        let area = polygon[1..]
            .windows(2)
            .fold(V3::default(), |sum, pair| add(sum, cross(sub(pair[0], polygon[0]), sub(pair[1], polygon[0]))));
        let size = dot(area, area).sqrt();
        let normal = scale(1.0 / size, area);
        let height = dot(polygon[0], normal);
        let before = self.places.iter().filter(|(_, is_on_face)| !is_on_face);
        let nearest = before.map(|&(x, _)| height - dot(x, normal)).fold(Real::INFINITY, Real::min);
        let is_flat = |corners: [V3; 3]| is_flat(corners, near);
        // The first also where a face has no area, and so no normal.
        if size == 0.0
            || nearest <= near
            || (0..n).any(|i| is_flat([polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]]))
        {
            return false;
        }
        // The Delaunay triangles of the polygon: on each edge, from the first, the one whose angle over it is the largest.
        self.open.clear();
        self.open.push((0, n - 1));
        while let Some((from, to)) = self.open.pop() {
            let cotangent = |i: usize| {
                let [a, b] = [from, to].map(|k| sub(polygon[k], polygon[i]));
                dot(a, b) / dot(cross(a, b), normal).abs()
            };
            let tops = from + 1..to;
            let Some(top) = tops.min_by(|&i, &j| cotangent(i).total_cmp(&cotangent(j))) else { continue };
            self.open.extend([(from, top), (top, to)]);
            let triangle = [from, top, to].map(|i| polygon[i]);
            if is_flat(triangle) || is_lost(triangle, normal, around, nearest, &self.places) {
                return false;
            }
        }
        true
    }
}

/// Whether a corner behind a triangle's face, none of which is nearer to it than `nearest`, is in the sphere through it and one of the points around.
fn is_lost([a, b, c]: [V3; 3], normal: V3, around: &[V3; 6], nearest: Real, places: &[(V3, bool)]) -> bool {
    let (u, w) = (sub(b, a), sub(c, a));
    let x = cross(u, w);
    let to_middle = add(scale(dot(w, w), cross(x, u)), scale(dot(u, u), cross(w, x)));
    let to_middle = scale(0.5 / dot(x, x), to_middle);
    let (middle, square) = (add(a, to_middle), dot(to_middle, to_middle));
    // The sphere's middle is so high over the triangle's; of all such spheres the lowest reaches deepest.
    let lowest = around.iter().map(|&o| sub(o, middle)).fold(Real::INFINITY, |lowest, way| {
        let height = dot(way, normal);
        if height > 0.0 { lowest.min((dot(way, way) - square) / (2.0 * height)) } else { lowest }
    });
    let margin = TOUCHES * (square + lowest * lowest);
    // Seldom is any so near that it takes more than this.
    let is_far = lowest > 0.0 && 2.0 * lowest * nearest > square + margin;
    !is_far
        && places.iter().filter(|(_, is_on_face)| !is_on_face).any(|&(x, _)| {
            let way = sub(x, middle);
            dot(way, way) - square - 2.0 * lowest * dot(way, normal) < margin
        })
}

/// Whether a corner of a triangle is within `near` of the opposite edge's line.
fn is_flat([a, b, c]: [V3; 3], near: Real) -> bool {
    let edges = [sub(b, a), sub(c, b), sub(a, c)];
    let area = cross(edges[0], edges[2]);
    let longest = edges.iter().map(|&e| dot(e, e)).fold(0.0, Real::max);
    dot(area, area) <= near * near * longest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Beyond;

    fn keeps(points: &[[f64; 3]], faces: &[&[u32]]) -> bool {
        let faces = faces.iter().map(|&corners| Face { corners, beyond: Beyond::Nothing });
        Polyhedra::default().keeps(points, faces)
    }

    /// What VTK 9.7 does, tried at each of these sizes: of the flat tetrahedron nothing is left, and of a cube with a corner cut off a part is lost.
    #[test]
    fn what_vtk_loses_a_part_of_is_told() {
        let tetrahedron = |h: f64| {
            let points = [[0.0, 0.0, h], [1.0, 0.0, h], [0.5, 0.3, 0.0], [0.5, -0.3, 0.0]];
            keeps(&points, &[&[0, 1, 2], &[0, 3, 1], &[0, 2, 3], &[1, 3, 2]])
        };
        for h in [0.5, 0.3, 0.2, 0.15, 0.1, 0.08] {
            assert!(tetrahedron(h), "height {h}");
        }
        for h in [0.06, 0.04, 0.01] {
            assert!(!tetrahedron(h), "height {h}");
        }
        let cube_without_corner = |e: f64| {
            let (o, i) = (1.0, 1.0 - e);
            let below = [[0.0, 0.0, 0.0], [o, 0.0, 0.0], [o, o, 0.0], [0.0, o, 0.0]];
            let above = [[0.0, 0.0, o], [o, 0.0, o], [0.0, o, o], [i, o, o], [o, i, o], [o, o, i]];
            let sides: [&[u32]; 5] = [&[0, 3, 2, 1], &[0, 4, 6, 3], &[0, 1, 5, 4], &[1, 2, 9, 8, 5], &[2, 3, 6, 7, 9]];
            keeps(&[&below[..], &above].concat(), &[&sides[..], &[&[4, 5, 8, 7, 6], &[7, 8, 9]]].concat())
        };
        for e in [0.3, 0.1, 1e-2, 1e-3] {
            assert!(cube_without_corner(e), "corner {e}");
        }
        for e in [2e-5, 1e-5, 1e-6] {
            assert!(!cube_without_corner(e), "corner {e}");
        }
    }

    /// Eight corners on one sphere, wherever the cube is and however large.
    #[test]
    fn cubes_are_kept() {
        for (size, at) in [(1.0, 0.0), (1e-6, 1.0), (0.3, -2e3), (1e9, 1e9)] {
            let points: [[f64; 3]; 8] =
                std::array::from_fn(|i| std::array::from_fn(|k| at + if i >> k & 1 == 1 { size } else { 0.0 }));
            let faces: [&[u32]; 6] =
                [&[0, 4, 6, 2], &[1, 3, 7, 5], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 2, 3, 1], &[4, 5, 7, 6]];
            assert!(keeps(&points, &faces), "size {size} at {at}");
        }
    }
}
