//! Which voxels the surface meets, counted for any box of voxels in eight look-ups.

use super::lattice::Lattice;
use super::{box_of_triangle, each_voxel};
use crate::parallel;
use std::ops::AddAssign;

/// The summed-area table, `dims + 1` entries along each axis, x fastest: entry `(i, j, k)` counts the voxels below
/// `i`, `j`, `k` on the three axes that some triangle meets. A voxel is never missed; one that a triangle
/// passes within [`slack`] may be counted too.
pub(super) fn summed_table(vertices: &[[f64; 3]], triangles: &[[u32; 3]], lattice: &Lattice) -> Vec<u32> {
    let [nx, ny, nz] = lattice.dims.map(|d| d as usize + 1);
    let mut table = vec![0_u32; nx * ny * nz];
    let index = |[i, j, k]: [u32; 3]| (i as usize + 1) + nx * ((j as usize + 1) + ny * (k as usize + 1));
    for t in triangles {
        let (lo, hi) = box_of_triangle(vertices, t, lattice);
        let triangle = t.map(|i| vertices[i as usize]);
        if lo == hi {
            table[index(lo)] = 1;
            continue;
        }
        let axes = Axes::new(triangle, lattice.width);
        each_voxel(lo, hi, |voxel| {
            let met = &mut table[index(voxel)];
            if *met == 0 {
                let center = [0, 1, 2].map(|k| lattice.coordinate(k, voxel[k]) + 0.5 * lattice.width);
                *met = u32::from(axes.meet(center));
            }
        });
    }
    parallel::each(table.chunks_exact_mut(nx * ny), |_, plane| {
        plane.chunks_exact_mut(nx).for_each(sum_up);
        add_parts_before(plane, nx);
    });
    add_parts_before(&mut table, nx * ny);
    table
}

/// Makes of each number the sum of those up to it.
pub(super) fn sum_up<T: Copy + Default + AddAssign>(numbers: &mut [T]) {
    let mut sum = T::default();
    for x in numbers {
        sum += *x;
        *x = sum;
    }
}

/// Adds to each part of such a length, number by number, the one before it, the first first.
fn add_parts_before(numbers: &mut [u32], length: usize) {
    for begin in (length..numbers.len()).step_by(length) {
        let (before, rest) = numbers.split_at_mut(begin);
        rest[..length].iter_mut().zip(&before[begin - length..]).for_each(|(x, &other)| *x += other);
    }
}

/// The number of voxels in the inclusive range that the surface meets.
pub(super) fn count(table: &[u32], dims: [u32; 3], lo: [u32; 3], hi: [u32; 3]) -> u32 {
    let (nx, ny) = (dims[0] as usize + 1, dims[1] as usize + 1);
    let at = |i: u32, j: u32, k: u32| table[i as usize + nx * (j as usize + ny * k as usize)];
    let [a, b, c] = lo;
    let [d, e, f] = hi.map(|x| x + 1);
    // Wrapping: the partial sums may pass below zero, the result is a count.
    let upper = at(d, e, f).wrapping_sub(at(a, e, f)).wrapping_sub(at(d, b, f)).wrapping_add(at(a, b, f));
    let lower = at(d, e, c).wrapping_sub(at(a, e, c)).wrapping_sub(at(d, b, c)).wrapping_add(at(a, b, c));
    upper.wrapping_sub(lower)
}

/// How much wider than a voxel the test's box is on each side, for what is rounded.
///
/// All lengths are below 4 (|x| ≤ 2 on a domain whose extent is at most 1, so that distances within it are smaller
/// still). A side axis compares `|e_y v_z − e_z v_y|` with `half (|e_y| + |e_z|)`; the rounding of `e`, `v`, the products
/// and the sum is below 6u · 4 (|e_y| + |e_z|), u = 2⁻⁵³, thus below 2⁻⁴⁸ of the axis's length.
fn slack() -> f64 {
    (-48_f64).exp2()
}

/// The separating axes of a triangle and a cube, but for the cube's own, which the list of voxels has settled.
struct Axes {
    corner: [f64; 3],
    edges: [[f64; 3]; 3],
    triangle: [[f64; 3]; 3],
    normal: [f64; 3],
    half: f64,
    normal_reach: f64,
}

impl Axes {
    fn new(triangle: [[f64; 3]; 3], width: f64) -> Self {
        let [a, b, c] = triangle;
        let edges = [sub(b, a), sub(c, b), sub(a, c)];
        let half = 0.5 * width + slack();
        let mut normal = [0.0; 3];
        let mut products = 0.0;
        let mut length = 0.0;
        for (k, n) in normal.iter_mut().enumerate() {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let (p, q) = (edges[0][i] * edges[1][j], edges[0][j] * edges[1][i]);
            *n = p - q;
            length += n.abs();
            products += p.abs() + q.abs();
        }
        // A component of the normal errs by 4u of its two products, whatever remains of them, and is multiplied by a
        // length below 4: with the roundings of the sum, below 32u (and half that again on the other side).
        let normal_reach = half * length + (-47_f64).exp2() * products;
        Self { corner: a, edges, triangle, normal, half, normal_reach }
    }

    /// Whether no axis separates the triangle from the cube around `center`.
    fn meet(&self, center: [f64; 3]) -> bool {
        let v = sub(self.corner, center);
        let height = self.normal[0] * v[0] + self.normal[1] * v[1] + self.normal[2] * v[2];
        if height.abs() > self.normal_reach {
            return false;
        }
        for (i, edge) in self.edges.iter().enumerate() {
            // Both ends of the edge project to one point: it and the third vertex are the triangle's projection.
            let (v, w) = (sub(self.triangle[i], center), sub(self.triangle[(i + 2) % 3], center));
            for k in 0..3 {
                let (y, z) = ((k + 1) % 3, (k + 2) % 3);
                let p = edge[y] * v[z] - edge[z] * v[y];
                let q = edge[y] * w[z] - edge[z] * w[y];
                let reach = self.half * (edge[y].abs() + edge[z].abs());
                if p.min(q) > reach || p.max(q) < -reach {
                    return false;
                }
            }
        }
        true
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
