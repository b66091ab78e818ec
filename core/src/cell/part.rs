//! The part of a cell beyond a height, and whether it is outside the domain: what a cap may cut off (`cap.rs`).

use super::near::voxels_of_box;
use super::plane::Plane;
use super::store::{DomainStore, Polytope, Voxel};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, dot, larger, norm_1, norm_max, scale, smaller, sub, v3};

/// Part of the distance of a cap by which what it cuts off is taken for larger, for all roundings.
const CAP_MARGIN: Real = 0.015625;

/// Parts of what a cap cuts off, four along each axis, that are looked at where its bounding box does not tell; and parts of one that does not tell either.
pub(super) const ALL_PARTS: u32 = 64;
pub(super) const PARTS_OF_PART: u32 = 8;

/// Widens `[low, high]`, if vertex `v` has `direction·x ≥ height`, by that vertex, and by where the ways to it from all vertices that have not
/// come to have: what of the cell has lies between such. (All by less than `height`, by a margin.)
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn add_to_part<S: Polytope>(s: &S, v: u32, direction: V3, height: Real, low: &mut V3, high: &mut V3) {
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
pub(super) fn widen_part<S: Polytope>(
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

/// The middle of number `n` of [`ALL_PARTS`] parts of some size, of which the first begins at `low`.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn middle_of_part(low: V3, size: V3, n: u32) -> V3 {
    let along: V3 = v3(((n & 3) as Real) + 0.5, (((n >> 2) & 3) as Real) + 0.5, ((n >> 4) as Real) + 0.5);
    return add(low, v3(along.x * size.x, along.y * size.y, along.z * size.z));
}

/// The same of a part's own parts.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn middle_within_part(middle: V3, size: V3, n: u32) -> V3 {
    let along: V3 = v3(((n & 1) as Real) - 0.5, (((n >> 1) & 1) as Real) - 0.5, ((n >> 2) as Real) - 0.5);
    return add(middle, scale(0.5, v3(along.x * size.x, along.y * size.y, along.z * size.z)));
}

/// Whether a box of some size about `middle` is outside the domain, or has nothing of the cell with `direction·x ≥ height`.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn box_has_nothing<S: DomainStore>(s: &S, direction: V3, height: Real, middle: V3, size: V3) -> bool {
    // Wider by what its corners are rounded by.
    let halves: V3 = scale(0.5 + CAP_MARGIN, size);
    return box_is_outside(s, sub(middle, halves), add(middle, halves))
        || box_misses_part(s, direction, height, middle, halves);
}

/// Whether the domain's winding number is 0 all over the box `[low, high]`.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn box_is_outside<S: DomainStore>(s: &S, low: V3, high: V3) -> bool {
    let mut lo: Voxel = Voxel { i: 0, j: 0, k: 0 };
    let mut hi: Voxel = Voxel { i: 0, j: 0, k: 0 };
    voxels_of_box(s, low, high, &mut lo, &mut hi);
    return (s.surface_voxels(lo, hi) == 0) && (s.winding(lo) == 0);
}

/// Whether a box about `middle` certainly has nothing of the cell with `direction·x ≥ height`.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn box_misses_part<S: Polytope>(s: &S, direction: V3, height: Real, middle: V3, halves: V3) -> bool {
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

/// The distance that is tried next: in small steps up to the radius, then in large ones.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn next_distance(distance: Real, radius: Real) -> Real {
    if distance < radius {
        return 1.2 * distance;
    }
    return 1.75 * distance;
}
