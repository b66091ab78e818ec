//! The cell at first: the container's box.

use super::plane::Plane;
use super::status::TAG_BOX;
use super::store::Polytope;
use super::vector::{Real, UNIT_ROUNDOFF, V3, norm_max, v3};
use super::vertex::{ROUNDINGS_OF_EXACT, Triplet};

/// The six planes of the box; its corners are still to be placed.
#[cfg_attr(opencl, outline)]
pub(super) fn set_box_planes<S: Polytope>(s: &mut S, lo: V3, hi: V3) {
    set_box_plane(s, 0, v3(1.0, 0.0, 0.0), -lo.x);
    set_box_plane(s, 1, v3(-1.0, 0.0, 0.0), hi.x);
    set_box_plane(s, 2, v3(0.0, 1.0, 0.0), -lo.y);
    set_box_plane(s, 3, v3(0.0, -1.0, 0.0), hi.y);
    set_box_plane(s, 4, v3(0.0, 0.0, 1.0), -lo.z);
    set_box_plane(s, 5, v3(0.0, 0.0, -1.0), hi.z);
    s.set_planes(6);
    s.set_vertices(8);
}

#[cfg_attr(opencl, outline)]
pub(super) fn set_box_plane<S: Polytope>(s: &mut S, f: u32, n: V3, d: Real) {
    s.set_plane(f, Plane { n: n, d: d });
    s.set_tag(f, TAG_BOX);
}

/// Places corner `v` of the box: bit 0 of `v` says whether it is on the maximum along x, bit 1 along y, bit 2 along z. The faces
/// are at right angles, so that nothing is rounded.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn place_corner<S: Polytope>(s: &mut S, v: u32) {
    let on_x: u32 = v & 1;
    let on_y: u32 = (v >> 1) & 1;
    let on_z: u32 = (v >> 2) & 1;
    // The determinant of the three normals is the product of their signs: an odd number of maxima swaps two planes.
    if (((on_x + on_y) + on_z) & 1) == 0 {
        s.set_triplet(v, Triplet { a: on_x, b: 2 + on_y, c: 4 + on_z });
    } else {
        s.set_triplet(v, Triplet { a: on_x, b: 4 + on_z, c: 2 + on_y });
    }
    let mut position: V3 = v3(-s.plane(0).d, -s.plane(2).d, -s.plane(4).d);
    if on_x != 0 {
        position.x = s.plane(1).d;
    }
    if on_y != 0 {
        position.y = s.plane(3).d;
    }
    if on_z != 0 {
        position.z = s.plane(5).d;
    }
    s.set_position(v, position, (ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * norm_max(position));
}
