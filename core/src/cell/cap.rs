//! Caps: half-spaces that cut off what of a cell is far from its site and outside the domain, where it has no integral. A cell at
//! the edge of a cloud of sites would else reach to the container's box, and be cut there by sites from all over the cloud.

use super::clip::clip;
use super::plane::Plane;
use super::restrict::voxels_of_box;
use super::status::{CUT, TAG_CAP, UNTOUCHED};
use super::store::{CellStore, Voxel};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, dot, larger, norm_1, norm_max, scale, smaller, sub, v3};

/// Caps of a cell at most.
pub const MOST_CAPS: u32 = 8;

/// Part of the distance of a cap by which what it cuts off is taken for larger, for all roundings.
const CAP_MARGIN: Real = 0.015625;

/// Times of `radius` that are tried as the distance of a cap: this often its double.
const MOST_DOUBLINGS: u32 = 3;

/// Cuts off, cap by cap, what lies outside the domain and farther from the site than about `radius`: `CUT` where something was, `UNTOUCHED`
/// where nothing was, or how the cell ended. Cells of sites about a domain of which `radius` is a few times their spacing come to be
/// little larger than it.
pub fn cap_outside<S: CellStore>(s: &mut S, radius: Real) -> u32 {
    if s.has_domain() == 0 {
        return UNTOUCHED;
    }
    let mut end: u32 = UNTOUCHED;
    let mut caps: u32 = 0;
    while caps < MOST_CAPS {
        let far: V3 = farthest_position(s);
        let square: Real = dot(far, far);
        let mut distance: Real = radius;
        let mut status: u32 = UNTOUCHED;
        let mut doublings: u32 = 0;
        while (status == UNTOUCHED) && (doublings <= MOST_DOUBLINGS) {
            // A vertex that is not clearly farther is not worth a half-space.
            if square < ((2.0 * distance) * distance) {
                return end;
            }
            if part_is_outside(s, far, distance * square.sqrt()) != 0 {
                status = clip(s, Plane { n: scale(-1.0, far), d: distance * square.sqrt() }, TAG_CAP);
            }
            distance = 2.0 * distance;
            doublings += 1;
        }
        if status != CUT {
            if status == UNTOUCHED {
                return end;
            }
            return status;
        }
        end = CUT;
        caps += 1;
    }
    return end;
}

/// The position of the vertex that is farthest from the site.
pub(super) fn farthest_position<S: CellStore>(s: &S) -> V3 {
    let mut far: V3 = s.position(0);
    let mut v: u32 = 1;
    while v < s.vertices() {
        let p: V3 = s.position(v);
        if dot(p, p) > dot(far, far) {
            far = p;
        }
        v += 1;
    }
    return far;
}

/// Whether (1) what of the cell has `direction·x ≥ height` certainly lies where the domain's winding number is 0: no triangle is in the
/// voxels of its bounding box.
pub(super) fn part_is_outside<S: CellStore>(s: &S, direction: V3, height: Real) -> u32 {
    let mut low: V3 = direction;
    let mut high: V3 = direction;
    let mut radius: Real = 0.0;
    let mut v: u32 = 0;
    while v < s.vertices() {
        add_to_part(s, v, direction, height, &mut low, &mut high);
        radius = larger(radius, s.radius(v));
        v += 1;
    }
    return box_of_part_is_outside(s, direction, height, low, high, radius);
}

/// Widens `[low, high]`, if vertex `v` has `direction·x ≥ height`, by that vertex, and by where the ways to it from all vertices that have not
/// come to have: what of the cell has lies between such. (All by less than `height`, by a margin.)
#[inline]
pub(super) fn add_to_part<S: CellStore>(s: &S, v: u32, direction: V3, height: Real, low: &mut V3, high: &mut V3) {
    let below: Real = height - (CAP_MARGIN * height);
    let p: V3 = s.position(v);
    let p_height: Real = dot(direction, p);
    if p_height < below {
        return;
    }
    *low = v3(smaller(low.x, p.x), smaller(low.y, p.y), smaller(low.z, p.z));
    *high = v3(larger(high.x, p.x), larger(high.y, p.y), larger(high.z, p.z));
    let mut u: u32 = 0;
    while u < s.vertices() {
        let q: V3 = s.position(u);
        let q_height: Real = dot(direction, q);
        if q_height < below {
            let between: V3 = add(q, scale((below - q_height) / (p_height - q_height), sub(p, q)));
            *low = v3(smaller(low.x, between.x), smaller(low.y, between.y), smaller(low.z, between.z));
            *high = v3(larger(high.x, between.x), larger(high.y, between.y), larger(high.z, between.z));
        }
        u += 1;
    }
}

/// Whether (1) the part of the cell in the box `[low, high]` is outside, where `radius` is the vertices' largest error; no vertex is farther
/// than `direction`.
pub(super) fn box_of_part_is_outside<S: CellStore>(
    s: &S,
    direction: V3,
    height: Real,
    low: V3,
    high: V3,
    radius: Real,
) -> u32 {
    // The vertices' error, the roundings of heights and places, and of moving them into the diagram's frame.
    let rounding: Real = radius + ((16.0 * UNIT_ROUNDOFF) * (norm_max(s.site()) + norm_1(direction)));
    if !((norm_1(direction) * rounding) < (0.25 * (CAP_MARGIN * height))) {
        return 0;
    }
    let outward: V3 = v3(rounding, rounding, rounding);
    let mut lo: Voxel = Voxel { i: 0, j: 0, k: 0 };
    let mut hi: Voxel = Voxel { i: 0, j: 0, k: 0 };
    voxels_of_box(s, sub(low, outward), add(high, outward), &mut lo, &mut hi);
    if (s.surface_voxels(lo, hi) == 0) && (s.winding(lo) == 0) {
        return 1;
    }
    return 0;
}
