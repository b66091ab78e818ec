//! Which points are inside a closed mesh: exact crossings of a vertical ray.

use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::diagram::bounding_box;

/// Triangles that a column of the grid holds on average, about: so that building costs no more than asking.
const TRIANGLES_A_COLUMN: usize = 4;

/// A mesh's triangles, sorted into columns along z.
pub struct InsideTest<'a> {
    vertices: &'a [[f64; 3]],
    mesh: &'a [[u32; 3]],
    lo: [f64; 3],
    hi: [f64; 3],
    /// Columns along each of x and y.
    columns: usize,
    /// Column `c` holds `triangles[offsets[c]..offsets[c + 1]]`.
    offsets: Vec<usize>,
    triangles: Vec<u32>,
}

impl<'a> InsideTest<'a> {
    /// For the triangles `mesh`, indices into `vertices`, of which there is one at least.
    pub fn new(vertices: &'a [[f64; 3]], mesh: &'a [[u32; 3]]) -> Self {
        let (lo, hi) = bounding_box(vertices);
        let count = mesh.len();
        let columns = ((count / TRIANGLES_A_COLUMN) as f64).sqrt().ceil().clamp(1.0, 2048.0) as usize;
        let mut test = Self { vertices, mesh, lo, hi, columns, offsets: Vec::new(), triangles: Vec::new() };
        // A counting sort: how many in each column, where each begins, which.
        let mut offsets = vec![0; columns * columns + 1];
        for t in 0..count as u32 {
            test.columns_of(t, |column| offsets[column + 1] += 1);
        }
        for c in 1..offsets.len() {
            offsets[c] += offsets[c - 1];
        }
        let mut next = offsets.clone();
        let mut triangles = vec![0; offsets[columns * columns]];
        for t in 0..count as u32 {
            test.columns_of(t, |column| {
                triangles[next[column]] = t;
                next[column] += 1;
            });
        }
        (test.offsets, test.triangles) = (offsets, triangles);
        test
    }

    /// Whether the mesh's winding number about `p` is positive. The surface counts as inside, but for its vertical
    /// parts, which the shift of [`InsideTest::crossings`] puts on one side or the other.
    pub fn contains(&self, p: [f64; 3]) -> bool {
        let mut winding = 0;
        for crossing in self.crossings(p) {
            match crossing.height {
                0 => return true,
                height if height > 0 => winding += crossing.side,
                _ => {}
            }
        }
        winding > 0
    }

    /// Where the vertical line through `p` meets triangles. The line is moved by (ε, ε²) in x and y, ε infinitesimal, so that it meets no
    /// edge and no vertex: exact for every `p`.
    pub fn crossings(&self, p: [f64; 3]) -> impl Iterator<Item = Crossing> + '_ {
        self.near(p).iter().filter_map(move |&t| {
            let [a, b, c] = self.corners(t);
            let side = edge_side(a, b, p);
            if side == 0 || side != edge_side(b, c, p) || side != edge_side(c, a, p) {
                return None;
            }
            // Seen from above, the triangle is counterclockwise for side > 0; p is below its plane where orient3d > 0.
            let height = f64::from(side) * plane_side(a, b, c, p);
            Some(Crossing { triangle: t, side, height: i32::from(height > 0.0) - i32::from(height < 0.0) })
        })
    }

    /// The triangles that `p` may lie on: those with it in their plane and their box.
    pub fn touching(&self, p: [f64; 3]) -> impl Iterator<Item = u32> + '_ {
        self.near(p).iter().copied().filter(move |&t| {
            let [a, b, c] = self.corners(t);
            let spans = |k: usize| a[k].min(b[k]).min(c[k]) <= p[k] && p[k] <= a[k].max(b[k]).max(c[k]);
            (0..3).all(spans) && plane_side(a, b, c, p) == 0.0
        })
    }

    /// The triangles whose boxes meet that of triangle `t`, itself among them, some more than once.
    pub fn beside(&self, t: u32) -> impl Iterator<Item = u32> + '_ {
        let mut columns = Vec::new();
        self.columns_of(t, |column| columns.push(column));
        let ends = |t: u32, k: usize| {
            let [a, b, c] = self.corners(t).map(|p| p[k]);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let own = [0, 1, 2].map(|k| ends(t, k));
        columns
            .into_iter()
            .flat_map(|column| &self.triangles[self.offsets[column]..self.offsets[column + 1]])
            .copied()
            .filter(move |&other| {
                (0..3).all(|k| {
                    let [lo, hi] = ends(other, k);
                    lo <= own[k][1] && own[k][0] <= hi
                })
            })
    }

    /// Whether an edge of one triangle goes through the inner part of the other: exact. (Where it goes through an edge or a corner, it may only touch what goes on there.)
    pub fn cross(&self, t: u32, other: u32) -> bool {
        let (one, other) = (self.corners(t), self.corners(other));
        let pierces = |edges: [[f64; 3]; 3], [a, b, c]: [[f64; 3]; 3]| {
            let sides = edges.map(|p| plane_side(a, b, c, p));
            [[0, 1], [1, 2], [2, 0]].into_iter().any(|[i, j]| {
                let (p, q) = (edges[i], edges[j]);
                let turns = || [(a, b), (b, c), (c, a)].map(|(u, v)| plane_side(p, q, u, v));
                let are_alike = |turns: [f64; 3]| turns.iter().all(|&x| x > 0.0) || turns.iter().all(|&x| x < 0.0);
                ((sides[i] > 0.0 && sides[j] < 0.0) || (sides[i] < 0.0 && sides[j] > 0.0)) && are_alike(turns())
            })
        };
        pierces(one, other) || pierces(other, one)
    }

    /// The triangles of the column of `p`, which hold all that the vertical line through it meets.
    fn near(&self, p: [f64; 3]) -> &[u32] {
        if (0..3).any(|k| p[k] < self.lo[k] || p[k] > self.hi[k]) {
            return &[];
        }
        let column = self.column(1, p[1]) * self.columns + self.column(0, p[0]);
        &self.triangles[self.offsets[column]..self.offsets[column + 1]]
    }

    fn corners(&self, t: u32) -> [[f64; 3]; 3] {
        self.mesh[t as usize].map(|i| self.vertices[i as usize])
    }

    /// The column of coordinate `x` along `axis`; monotone in `x`, so that a triangle's columns hold all its points.
    fn column(&self, axis: usize, x: f64) -> usize {
        let share = (x - self.lo[axis]) / (self.hi[axis] - self.lo[axis]);
        ((share * self.columns as f64) as usize).min(self.columns - 1)
    }

    fn columns_of(&self, t: u32, mut each: impl FnMut(usize)) {
        let corners = self.corners(t);
        let range = |axis: usize| {
            let at = corners.map(|p| self.column(axis, p[axis]));
            at[0].min(at[1]).min(at[2])..=at[0].max(at[1]).max(at[2])
        };
        for y in range(1) {
            for x in range(0) {
                each(y * self.columns + x);
            }
        }
    }
}

/// A triangle that a vertical line meets.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// Its index.
    pub triangle: u32,
    /// 1 where it is counterclockwise seen from above, −1 where it is clockwise.
    pub side: i32,
    /// 1 where it is above the point, −1 below, 0 where the point is on it.
    pub height: i32,
}

/// On which side of the edge from `a` to `b`, seen from above, the moved `p` is: 1 left, −1 right; 0 for a vertical edge.
fn edge_side(a: [f64; 3], b: [f64; 3], p: [f64; 3]) -> i32 {
    let coord = |p: [f64; 3]| Coord { x: p[0], y: p[1] };
    let area = orient2d(coord(a), coord(b), coord(p));
    // On the line: its derivatives along x, then y, are what ε, then ε², bring.
    let deciding = [area, a[1] - b[1], b[0] - a[0]].into_iter().find(|&x| x != 0.0);
    deciding.map_or(0, |x| if x > 0.0 { 1 } else { -1 })
}

/// Positive where `p` is on the side of the plane from which the triangle is seen clockwise, 0 where it is on the plane.
pub(crate) fn plane_side(a: [f64; 3], b: [f64; 3], c: [f64; 3], p: [f64; 3]) -> f64 {
    let [a, b, c, p] = [a, b, c, p].map(|[x, y, z]| Coord3D { x, y, z });
    orient3d(a, b, c, p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Domain;

    /// The cube [0, 1]³, its faces cut along diagonals.
    fn cube() -> Domain {
        let vertices: Vec<[f64; 3]> =
            (0..8).map(|i| [f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2 & 1)]).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Domain::new(&vertices, &triangles).unwrap()
    }

    #[test]
    fn rays_through_edges_and_vertices_are_decided() {
        let domain = cube();
        let test = InsideTest::new(domain.vertices(), domain.triangles());
        // Every point of this lattice stands under edges, diagonals or vertices of the cube, or on them.
        for (x, y, z) in (0..9 * 9 * 9).map(|i| (i % 9, i / 9 % 9, i / 81)) {
            let p = [x, y, z].map(|k| f64::from(k - 2) / 4.0);
            let strictly_inside = p.iter().all(|&c| 0.0 < c && c < 1.0);
            let outside = p.iter().any(|&c| !(0.0..=1.0).contains(&c));
            assert!(!strictly_inside || test.contains(p), "{p:?} is inside");
            assert!(!outside || !test.contains(p), "{p:?} is outside");
        }
        assert!(test.contains([0.5, 0.25, 0.0]) && test.contains([0.5, 0.25, 1.0]), "the surface counts as inside");
    }

    #[test]
    fn as_many_points_are_inside_as_the_volume_says() {
        let domain = crate::shapes::swan().domain();
        let test = InsideTest::new(domain.vertices(), domain.triangles());
        let (lo, hi) = domain.bounding_box();
        // A lattice whose spacing has no relation to the mesh: the share of points inside is that of the volume, but for the
        // surface's share of voxels, of random sign.
        let n = 40;
        let at = |k: usize, i: usize| lo[k] + (i as f64 + 0.5) / n as f64 * (hi[k] - lo[k]);
        let inside =
            (0..n * n * n).filter(|i| test.contains([at(0, i % n), at(1, i / n % n), at(2, i / n / n)])).count();
        let box_volume: f64 = (0..3).map(|k| hi[k] - lo[k]).product();
        let share = domain.volume() / box_volume;
        assert!((inside as f64 / (n * n * n) as f64 - share).abs() < 0.005, "{inside} inside, share {share}");
    }
}
