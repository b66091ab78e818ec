//! Caps: half-spaces that cut off what of a cell is far from its site and outside the domain, where it has no integral. A cell at
//! the edge of a cloud of sites would else reach to the container's box, and be cut there by sites from all over the cloud.

use super::clip::clip;
use super::plane::Plane;
use super::restrict::voxels_of_box;
use super::status::{CUT, TAG_CAP, UNTOUCHED};
use super::store::{CellStore, Voxel};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, dot, larger, norm_1, norm_max, scale, smaller, sub, v3};

/// Caps of a cell at most.
pub const MOST_CAPS: u32 = 16;

/// Part of the distance of a cap by which what it cuts off is taken for larger, for all roundings.
const CAP_MARGIN: Real = 0.015625;

/// Parts of what a cap cuts off, eight along each axis, that are looked at where its bounding box does not tell.
const ALL_PARTS: u32 = 512;

/// The first distance of a cap that is tried, in units of the radius to be reached: its facet has vertices that are farther.
const FIRST_DISTANCE: Real = 0.85;
/// The same in units of the farthest vertex's distance, at least: nearer caps are for a cell that is less long.
const LEAST_SHARE: Real = 0.0009765625;
/// A vertex less than this times as far as a cap is not worth one.
const WORTH_A_CAP: Real = 1.1;

/// Cuts off, cap by cap, what lies outside the domain, until no vertex is farther from the site than `radius`, or what is cannot be cut
/// off: `CUT` where something was, `UNTOUCHED` where nothing was, or how the cell ended.
#[cfg_attr(opencl, outline)]
pub fn cap_outside<S: CellStore>(s: &mut S, radius: Real) -> u32 {
    if !s.has_domain() || !(radius > 0.0) {
        return UNTOUCHED;
    }
    let mut end: u32 = UNTOUCHED;
    for _caps in 0..MOST_CAPS {
        let far: V3 = farthest_position(s);
        let length: Real = dot(far, far).sqrt();
        if length <= radius {
            return end;
        }
        let mut distance: Real = larger(FIRST_DISTANCE * radius, LEAST_SHARE * length);
        let mut status: u32 = UNTOUCHED;
        while (status == UNTOUCHED) && ((WORTH_A_CAP * distance) < length) {
            if part_is_outside(s, far, distance * length) {
                status = clip(s, Plane { n: scale(-1.0, far), d: distance * length }, TAG_CAP);
            }
            distance = next_distance(distance, radius);
        }
        if status == UNTOUCHED {
            return end;
        }
        if status != CUT {
            return status;
        }
        end = CUT;
    }
    return end;
}

/// The distance that is tried next: in small steps up to the radius, then in large ones.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn next_distance(distance: Real, radius: Real) -> Real {
    if distance < radius {
        return 1.2 * distance;
    }
    return 1.75 * distance;
}

/// The position of the vertex that is farthest from the site.
#[cfg_attr(opencl, outline)]
pub(super) fn farthest_position<S: CellStore>(s: &S) -> V3 {
    let mut far: V3 = s.position(0);
    for v in 1..s.vertices() {
        let p: V3 = s.position(v);
        if dot(p, p) > dot(far, far) {
            far = p;
        }
    }
    return far;
}

/// Whether what of the cell has `direction·x ≥ height` certainly lies where the domain's winding number is 0: its bounding box, or each
/// part of it that has something of the cell.
#[cfg_attr(opencl, outline)]
pub(super) fn part_is_outside<S: CellStore>(s: &S, direction: V3, height: Real) -> bool {
    let mut low: V3 = direction;
    let mut high: V3 = direction;
    let mut radius: Real = 0.0;
    for v in 0..s.vertices() {
        add_to_part(s, v, direction, height, &mut low, &mut high);
        radius = larger(radius, s.radius(v));
    }
    if !widen_part(s, direction, height, radius, &mut low, &mut high) {
        return false;
    }
    return boxes_are_outside(s, direction, height, low, high, 0, 1);
}

/// Widens `[low, high]`, if vertex `v` has `direction·x ≥ height`, by that vertex, and by where the ways to it from all vertices that have not
/// come to have: what of the cell has lies between such. (All by less than `height`, by a margin.)
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn add_to_part<S: CellStore>(s: &S, v: u32, direction: V3, height: Real, low: &mut V3, high: &mut V3) {
    let below: Real = height - (CAP_MARGIN * height);
    let p: V3 = s.position(v);
    let p_height: Real = dot(direction, p);
    if p_height < below {
        return;
    }
    *low = v3(smaller(low.x, p.x), smaller(low.y, p.y), smaller(low.z, p.z));
    *high = v3(larger(high.x, p.x), larger(high.y, p.y), larger(high.z, p.z));
    for u in 0..s.vertices() {
        let q: V3 = s.position(u);
        let q_height: Real = dot(direction, q);
        if q_height < below {
            let between: V3 = add(q, scale((below - q_height) / (p_height - q_height), sub(p, q)));
            *low = v3(smaller(low.x, between.x), smaller(low.y, between.y), smaller(low.z, between.z));
            *high = v3(larger(high.x, between.x), larger(high.y, between.y), larger(high.z, between.z));
        }
    }
}

/// Widens `[low, high]` by all roundings, `radius` the vertices' largest error: whether they are not too large to tell. No vertex is farther than
/// `direction`.
#[cfg_attr(opencl, outline)]
pub(super) fn widen_part<S: CellStore>(
    s: &S,
    direction: V3,
    height: Real,
    radius: Real,
    low: &mut V3,
    high: &mut V3,
) -> bool {
    // The vertices' error, the roundings of heights and places, and of moving them into the diagram's frame.
    let rounding: Real = radius + ((16.0 * UNIT_ROUNDOFF) * (norm_max(s.site()) + norm_1(direction)));
    if !((norm_1(direction) * rounding) < (0.25 * (CAP_MARGIN * height))) {
        return false;
    }
    let outward: V3 = v3(rounding, rounding, rounding);
    *low = sub(*low, outward);
    *high = add(*high, outward);
    return true;
}

/// Whether all of the cell in the box `[low, high]` with `direction·x ≥ height` is outside: its whole box, or where that has something of
/// the domain, each of `ALL_PARTS` parts of it that the cell has something of, of which only every `step`th from `first` on is looked at.
#[cfg_attr(opencl, outline)]
pub(super) fn boxes_are_outside<S: CellStore>(
    s: &S,
    direction: V3,
    height: Real,
    low: V3,
    high: V3,
    first: u32,
    step: u32,
) -> bool {
    if box_is_outside(s, low, high) {
        return true;
    }
    if (step == 0) || (step > ALL_PARTS) {
        return false;
    }
    let size: V3 = scale(0.125, sub(high, low));
    // Wider than a part by what its corners are rounded by.
    let halves: V3 = scale(0.5 + CAP_MARGIN, size);
    let mut n: u32 = first;
    while n < ALL_PARTS {
        let along_x: Real = ((n & 7) as Real) + 0.5;
        let along_y: Real = (((n >> 3) & 7) as Real) + 0.5;
        let along_z: Real = ((n >> 6) as Real) + 0.5;
        let middle: V3 = add(low, v3(along_x * size.x, along_y * size.y, along_z * size.z));
        if !box_is_outside(s, sub(middle, halves), add(middle, halves)) {
            if !box_misses_part(s, direction, height, middle, halves) {
                return false;
            }
        }
        n += step;
    }
    return true;
}

/// Whether the domain's winding number is 0 all over the box `[low, high]`.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn box_is_outside<S: CellStore>(s: &S, low: V3, high: V3) -> bool {
    let mut lo: Voxel = Voxel { i: 0, j: 0, k: 0 };
    let mut hi: Voxel = Voxel { i: 0, j: 0, k: 0 };
    voxels_of_box(s, low, high, &mut lo, &mut hi);
    return (s.surface_voxels(lo, hi) == 0) && (s.winding(lo) == 0);
}

/// Whether a box about `middle` certainly has nothing of the cell with `direction·x ≥ height`.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn box_misses_part<S: CellStore>(s: &S, direction: V3, height: Real, middle: V3, halves: V3) -> bool {
    if (dot(direction, middle) + reach_along(direction, halves)) < (height - (CAP_MARGIN * height)) {
        return true;
    }
    for f in 0..s.planes() {
        let plane: Plane = s.plane(f);
        let largest: Real = (dot(plane.n, middle) + plane.d) + reach_along(plane.n, halves);
        let rounding: Real =
            (16.0 * UNIT_ROUNDOFF) * ((norm_1(plane.n) * (norm_max(middle) + norm_max(halves))) + plane.d.abs());
        if largest < -rounding {
            return true;
        }
    }
    return false;
}

/// The largest `n·x` of a box about 0.
#[inline(always)]
pub(super) fn reach_along(n: V3, halves: V3) -> Real {
    return ((n.x.abs() * halves.x) + (n.y.abs() * halves.y)) + (n.z.abs() * halves.z);
}
