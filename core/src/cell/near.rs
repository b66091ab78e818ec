//! Cells near the surface: their box and its voxels, and whether the surface passes them by, told without cutting anything.

use super::cone::filtered_sign;
use super::status::SIGN_UNKNOWN;
use super::store::{DomainStore, Polytope, Triangle, Voxel};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, cross, dot, larger, norm_1, norm_max, smaller, sub, v3};

/// Whether no triangle in the voxels from `lo` to `hi` meets the cell, whose box is `[low, high]` in the frame of its site. Then
/// `winding`, which is that of the corner of `lo`, becomes that of the cell. `false` where one does, or may.
#[cfg_attr(opencl, outline)]
pub(super) fn surface_passes_by<S: DomainStore>(
    s: &mut S,
    low: V3,
    high: V3,
    lo: Voxel,
    hi: Voxel,
    winding: &mut i32,
) -> bool {
    if !site_is_inside(s) {
        return false;
    }
    let mut k: u32 = lo.k;
    while k <= hi.k {
        let mut j: u32 = lo.j;
        while j <= hi.j {
            let is_empty: bool = row_is_empty(s, lo, hi, j, k);
            let mut i: u32 = lo.i;
            while (i <= hi.i) && !is_empty {
                if !voxel_passes_by(s, Voxel { i: i, j: j, k: k }, lo, low, high, winding) {
                    return false;
                }
                i += 1;
            }
            j += 1;
        }
        k += 1;
    }
    return true;
}

/// Whether no triangle stands in the voxels of row `j`, `k` from `lo` to `hi`, whose lists stand one after the other.
#[inline(always)]
pub(super) fn row_is_empty<S: DomainStore>(s: &S, lo: Voxel, hi: Voxel, j: u32, k: u32) -> bool {
    return s.list_begin(Voxel { i: lo.i, j: j, k: k }) == s.list_end(Voxel { i: hi.i, j: j, k: k });
}

/// Whether the site is strictly inside its cell, so that the cell's winding number is the site's.
#[cfg_attr(opencl, outline)]
pub(super) fn site_is_inside<S: Polytope>(s: &S) -> bool {
    for f in 0..s.planes() {
        let d: Real = s.plane(f).d;
        if !(d > 0.0) {
            return false;
        }
    }
    return true;
}

/// The same for the triangles of one voxel, of which `lo` is the lowest; takes from `winding` what they add between the corner of
/// `lo` and the site.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn voxel_passes_by<S: DomainStore>(
    s: &mut S,
    voxel: Voxel,
    lo: Voxel,
    low: V3,
    high: V3,
    winding: &mut i32,
) -> bool {
    let end: u32 = s.list_end(voxel);
    for entry in s.list_begin(voxel)..end {
        let t: u32 = s.list_entry(entry);
        if is_first_voxel(s.lowest_voxel(t), lo, voxel) {
            if !triangle_passes_by(s, t, lo, low, high, winding) {
                return false;
            }
        }
    }
    return true;
}

/// Whether triangle `t` certainly does not meet the cell; takes from `winding` its sign as seen from the corner of `apex`, as often as it stands, where
/// that is between that and the site.
///
/// Every sign is certain about the true points: floating point with a bound, and 0 where that does not suffice.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn triangle_passes_by<S: DomainStore>(
    s: &mut S,
    t: u32,
    apex: Voxel,
    low: V3,
    high: V3,
    winding: &mut i32,
) -> bool {
    let triangle: Triangle = s.triangle(t);
    let a: V3 = s.domain_point(triangle.a);
    let b: V3 = s.domain_point(triangle.b);
    let c: V3 = s.domain_point(triangle.c);
    let site: V3 = s.site();
    let a_in: V3 = sub(a, site);
    let b_in: V3 = sub(b, site);
    let c_in: V3 = sub(c, site);
    let least: V3 = least_of(a_in, b_in, c_in);
    let most: V3 = most_of(a_in, b_in, c_in);
    if !are_apart(least, most, low, high) {
        if !plane_is_apart(s, a_in, sub(b, a), sub(c, a)) {
            return false;
        }
    }
    // Does it cross the segment from the corner, the lowest point of the cell's voxels, to the site?
    let o: V3 = s.corner(apex);
    let x: V3 = sub(site, o);
    let o_in: V3 = sub(o, site);
    if are_apart(least, most, o_in, V3 { x: 0.0, y: 0.0, z: 0.0 }) {
        return true;
    }
    let p: V3 = sub(a, o);
    let q: V3 = sub(b, o);
    let r: V3 = sub(c, o);
    let of_corner: i32 = filtered_sign(p, q, r);
    let of_site: i32 = filtered_sign(a_in, b_in, c_in);
    if (of_corner == SIGN_UNKNOWN) || (of_site == SIGN_UNKNOWN) {
        return false;
    }
    if of_corner == of_site {
        return true;
    }
    let over_0: i32 = filtered_sign(p, q, x);
    let over_1: i32 = filtered_sign(q, r, x);
    let over_2: i32 = filtered_sign(r, p, x);
    if ((over_0 == SIGN_UNKNOWN) || (over_1 == SIGN_UNKNOWN)) || (over_2 == SIGN_UNKNOWN) {
        return false;
    }
    if ((over_0 == of_corner) && (over_1 == of_corner)) && (over_2 == of_corner) {
        *winding -= of_corner * triangle.times;
    }
    return true;
}

/// Whether the boxes `[a, b]` and `[c, d]` are apart. (The rounded differences that their corners are tell it as the exact ones
/// do: rounding keeps the order.)
#[inline(always)]
pub(super) fn are_apart(a: V3, b: V3, c: V3, d: V3) -> bool {
    if ((b.x < c.x) || (b.y < c.y)) || (b.z < c.z) {
        return true;
    }
    return ((a.x > d.x) || (a.y > d.y)) || (a.z > d.z);
}

/// Roundings of a product of three differences, or of one component that is twice rounded.
const FEW_ROUNDINGS: Real = 16.0 * UNIT_ROUNDOFF;

/// Whether all vertices are certainly on one side of the plane through `a_in` along `e` and `f`.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn plane_is_apart<S: Polytope>(s: &S, a_in: V3, e: V3, f: V3) -> bool {
    let n: V3 = cross(e, f);
    let of_normal: Real = norm_1(e) * norm_1(f);
    let length: Real = norm_1(n) + (FEW_ROUNDINGS * of_normal);
    let reach: Real = norm_1(a_in);
    let mut above: u32 = 0;
    let mut below: u32 = 0;
    for v in 0..s.vertices() {
        let way: V3 = sub(s.position(v), a_in);
        let height: Real = dot(n, way);
        let way_length: Real = norm_1(way);
        let bound: Real = (length * (s.radius(v) + (FEW_ROUNDINGS * (reach + way_length))))
            + ((FEW_ROUNDINGS * of_normal) * way_length);
        if height > bound {
            above = 1;
        } else if height < -bound {
            below = 1;
        } else {
            return false;
        }
        if (above != 0) && (below != 0) {
            return false;
        }
    }
    return true;
}

#[inline(always)]
pub(super) fn least_of(a: V3, b: V3, c: V3) -> V3 {
    return V3 {
        x: smaller(smaller(a.x, b.x), c.x),
        y: smaller(smaller(a.y, b.y), c.y),
        z: smaller(smaller(a.z, b.z), c.z),
    };
}

#[inline(always)]
pub(super) fn most_of(a: V3, b: V3, c: V3) -> V3 {
    return V3 { x: larger(larger(a.x, b.x), c.x), y: larger(larger(a.y, b.y), c.y), z: larger(larger(a.z, b.z), c.z) };
}

/// A triangle stands in every voxel of its bounding box; it is taken only in the lowest one that the cell's box shares.
#[inline(always)]
pub(crate) fn is_first_voxel(lowest: Voxel, lo: Voxel, voxel: Voxel) -> bool {
    let mut i: u32 = lowest.i;
    let mut j: u32 = lowest.j;
    let mut k: u32 = lowest.k;
    if lo.i > i {
        i = lo.i;
    }
    if lo.j > j {
        j = lo.j;
    }
    if lo.k > k {
        k = lo.k;
    }
    return ((i == voxel.i) && (j == voxel.j)) && (k == voxel.k);
}

/// The bounding box of the cell, rounded outward.
#[inline]
#[cfg_attr(opencl, hot)]
pub(crate) fn outer_box_of_cell<S: Polytope>(s: &S, low: &mut V3, high: &mut V3) {
    let radius: Real = box_of_cell(s, low, high);
    // The vertices' error, and the rounding of moving them into the diagram's frame.
    let margin: Real =
        radius + ((4.0 * UNIT_ROUNDOFF) * (norm_max(s.site()) + larger(norm_max(*low), norm_max(*high))));
    let outward: V3 = v3(margin, margin, margin);
    *low = sub(*low, outward);
    *high = add(*high, outward);
}

/// The bounding box of the vertices; returns their largest error radius.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn box_of_cell<S: Polytope>(s: &S, low: &mut V3, high: &mut V3) -> Real {
    *low = s.position(0);
    *high = *low;
    let mut radius: Real = s.radius(0);
    for v in 1..s.vertices() {
        let p: V3 = s.position(v);
        *low = v3(smaller(low.x, p.x), smaller(low.y, p.y), smaller(low.z, p.z));
        *high = v3(larger(high.x, p.x), larger(high.y, p.y), larger(high.z, p.z));
        radius = larger(radius, s.radius(v));
    }
    return radius;
}

/// The voxels that a box in the frame of the site meets.
#[inline]
#[cfg_attr(opencl, hot)]
pub(crate) fn voxels_of_box<S: DomainStore>(s: &S, low: V3, high: V3, lo: &mut Voxel, hi: &mut Voxel) {
    *lo = s.voxel_of(add(s.site(), low));
    *hi = s.voxel_of(add(s.site(), high));
}
