//! Winding numbers of the voxels' minimum corners, by exact predicates.

use std::ops::RangeInclusive;

use robust::{Coord, Coord3D, orient2d, orient3d};

use super::lattice::Lattice;
use super::surface::sum_up;
use crate::parallel;

/// The winding number of every voxel's minimum corner; `None` where a line of corners parallel to x meets an edge or
/// a vertex, or a corner lies on a triangle.
///
/// Going along such a line towards +x, a triangle crossed whose normal points towards −x is entered (+1), otherwise left
/// (−1), each as often as it stands; far outside the winding number is 0.
pub(super) fn windings(
    vertices: &[[f64; 3]],
    triangles: &[[u32; 3]],
    times: &[i32],
    lattice: &Lattice,
) -> Option<Vec<i32>> {
    let mut windings = vec![0_i32; lattice.voxels()];
    for (t, times) in triangles.iter().zip(times) {
        let corners = t.map(|i| vertices[i as usize]);
        for j in lines(lattice, 1, &corners) {
            for k in lines(lattice, 2, &corners) {
                let side = side_of_line(&corners, lattice.coordinate(1, j), lattice.coordinate(2, k))?;
                if side.sign != 0 {
                    let i = first_beyond(&corners, side, lattice, j, k)?;
                    if i < lattice.dims[0] {
                        windings[lattice.voxel_index([i, j, k])] -= side.sign * times;
                    }
                }
            }
        }
    }
    let [along_x, along_y, _] = lattice.dims.map(|n| n as usize);
    parallel::each(windings.chunks_exact_mut(along_x * along_y), |_, plane| {
        plane.chunks_exact_mut(along_x).for_each(sum_up);
    });
    Some(windings)
}

/// The corners `i` along `axis` with `min ≤ coordinate(i) ≤ max` over the triangle's vertices.
fn lines(lattice: &Lattice, axis: usize, corners: &[[f64; 3]; 3]) -> RangeInclusive<u32> {
    let min = corners[0][axis].min(corners[1][axis]).min(corners[2][axis]);
    let max = corners[0][axis].max(corners[1][axis]).max(corners[2][axis]);
    let first = lattice.voxel_of(axis, min);
    let first = if lattice.coordinate(axis, first) < min { first + 1 } else { first };
    first..=lattice.voxel_of(axis, max)
}

/// How a line parallel to x passes a triangle.
#[derive(Clone, Copy)]
struct Side {
    /// The sign of the x component of the normal where the line crosses the triangle's inside, 0 where it passes by.
    sign: i32,
    /// An estimate of the x coordinate of the crossing.
    x: f64,
}

/// `None` where the line at `(y, z)`, which is within the triangle's box, meets an edge or vertex.
///
/// The three signs tell it all: two opposite ones put the line outside the projected triangle, also where that is a
/// segment or a point (then the areas add up to zero); without them a zero is on its boundary.
fn side_of_line(corners: &[[f64; 3]; 3], y: f64, z: f64) -> Option<Side> {
    let at = |i: usize| Coord { x: corners[i % 3][1], y: corners[i % 3][2] };
    let mut area = [0.0; 3];
    for (i, area) in area.iter_mut().enumerate() {
        *area = orient2d(at(i + 1), at(i + 2), Coord { x: y, y: z });
    }
    let (positive, negative) = (area.iter().any(|&a| a > 0.0), area.iter().any(|&a| a < 0.0));
    if positive && negative {
        return Some(Side { sign: 0, x: 0.0 });
    }
    if area.contains(&0.0) {
        return None;
    }
    let x =
        (area[0] * corners[0][0] + area[1] * corners[1][0] + area[2] * corners[2][0]) / (area[0] + area[1] + area[2]);
    Some(Side { sign: if positive { 1 } else { -1 }, x })
}

/// The first corner of the line `(j, k)` whose x is beyond the crossing, at most `dims[0]` (none is); `None` where a
/// corner lies on the triangle. The estimate says where to begin, exact signs on both sides where to stop.
fn first_beyond(corners: &[[f64; 3]; 3], side: Side, lattice: &Lattice, j: u32, k: u32) -> Option<u32> {
    let point = |p: [f64; 3]| Coord3D { x: p[0], y: p[1], z: p[2] };
    let [a, b, c] = corners.map(point);
    let (y, z) = (lattice.coordinate(1, j), lattice.coordinate(2, k));
    // orient3d is positive below the plane, `n·(corner − a) < 0`; beyond in x is on the normal's side if n_x > 0.
    let is_beyond = |i: u32| {
        let above = -orient3d(a, b, c, Coord3D { x: lattice.coordinate(0, i), y, z });
        if above == 0.0 { None } else { Some((above > 0.0) == (side.sign > 0)) }
    };
    let mut i = lattice.voxel_of(0, side.x);
    while i > 0 && is_beyond(i - 1)? {
        i -= 1;
    }
    while i < lattice.dims[0] && !is_beyond(i)? {
        i += 1;
    }
    Some(i)
}
