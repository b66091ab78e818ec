//! Restriction to the domain by signed truncated cones (paper §4, with winding numbers, exact signs and no merge).

use super::clip::{clip, compact_planes};
use super::integrate::{
    CellSums, FACETS, VOLUME_ONLY, add_boundary, integrate, reference_point, reset_facets, volume_is_above_bound,
};
use super::plane::{Plane, cone_side, triangle_plane};
use super::status::{
    BOUNDARY, COMPLETE, CUT, EMPTY, P_FULL, SEEN_CONFLICT, SIGN_UNKNOWN, TAG_BOX, TAG_CONE, TAG_TRIANGLE, UNCERTAIN,
    UNTOUCHED,
};
use super::store::{CellStore, Triangle, Voxel};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, cross, dot, norm_max, sub, v3};

/// A truncated cone: three sides through the apex, and the triangle's plane, keeping what lies behind it.
#[derive(Clone, Copy)]
struct TruncatedCone {
    /// Sign of the triangle as seen from the apex: +1 where it turns its back, so that what lies behind is outside.
    sign: Real,
    end: Plane,
    side_0: Plane,
    side_1: Plane,
    side_2: Plane,
}

/// The integrals of the finished cell over the container: the domain where there is one, weighted by its winding number,
/// else the initial box. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again; with `interior_only`, `BOUNDARY`
/// where the cell's voxels hold triangles.
///
/// With the flag `FACETS` the facets' sums of the half-spaces are those of the restricted cell afterwards.
pub fn integrate_cell<S: CellStore>(s: &mut S, flags: u32, interior_only: u32, sums: &mut CellSums) -> u32 {
    *sums = CellSums::default();
    compact_planes(s);
    let center: V3 = reference_point(s);
    if s.has_domain() == 0 {
        let status: u32 = integrate_whole(s, 1.0, center, flags, sums);
        if (status == COMPLETE) && ((flags & FACETS) != 0) {
            add_box_faces(s, sums);
        }
        return status;
    }
    let mut lo: Voxel = Voxel { i: 0, j: 0, k: 0 };
    let mut hi: Voxel = Voxel { i: 0, j: 0, k: 0 };
    voxels_of_cell(s, &mut lo, &mut hi);
    let winding: i32 = s.winding(lo);
    if s.surface_voxels(lo, hi) == 0 {
        // No triangle near: the winding number is the same all over the cell.
        return integrate_whole(s, winding as Real, center, flags, sums);
    }
    if interior_only != 0 {
        return BOUNDARY;
    }
    // Room for the four planes of a cone, whose indices must not move.
    if (s.cap_p() - s.planes()) < 4 {
        return P_FULL;
    }
    if (flags & FACETS) != 0 {
        reset_facets(s);
    }
    if winding != 0 {
        let status: u32 = integrate(s, winding as Real, center, flags, sums);
        if status != COMPLETE {
            return status;
        }
    }
    let mut touched: u32 = 0;
    let cones: u32 = add_cones(s, lo, hi, center, flags, &mut touched, sums);
    if cones != COMPLETE {
        return cones;
    }
    if touched == 0 {
        // No piece ends at its triangle: the surface does not meet the cell, and the winding number within is the nearest
        // integer to the quotient.
        let mut whole: CellSums = CellSums::default();
        let status: u32 = integrate(s, 1.0, center, VOLUME_ONLY, &mut whole);
        if status != COMPLETE {
            return status;
        }
        if volume_is_above_bound(whole) == 0 {
            return EMPTY;
        }
        let quotient: Real = sums.volume / whole.volume;
        let mut inner: i32 = (quotient.abs() + 0.5) as i32;
        if quotient < 0.0 {
            inner = -inner;
        }
        *sums = CellSums::default();
        return integrate_whole(s, inner as Real, center, flags, sums);
    }
    if volume_is_above_bound(*sums) == 0 {
        return EMPTY;
    }
    return COMPLETE;
}

/// Whether (1) the present cell, and so all that clipping can leave of it, lies where the domain's winding number is 0.
pub fn lies_outside<S: CellStore>(s: &S) -> u32 {
    if s.has_domain() == 0 {
        return 0;
    }
    let mut lo: Voxel = Voxel { i: 0, j: 0, k: 0 };
    let mut hi: Voxel = Voxel { i: 0, j: 0, k: 0 };
    voxels_of_cell(s, &mut lo, &mut hi);
    if (s.surface_voxels(lo, hi) == 0) && (s.winding(lo) == 0) {
        return 1;
    }
    return 0;
}

/// The integrals of the whole cell, times `weight`.
fn integrate_whole<S: CellStore>(s: &mut S, weight: Real, center: V3, flags: u32, sums: &mut CellSums) -> u32 {
    if weight == 0.0 {
        return EMPTY;
    }
    if (flags & FACETS) != 0 {
        reset_facets(s);
    }
    let status: u32 = integrate(s, weight, center, flags, sums);
    if status != COMPLETE {
        return status;
    }
    if volume_is_above_bound(*sums) == 0 {
        return EMPTY;
    }
    return COMPLETE;
}

/// The faces of the initial box are the boundary where there is no domain.
fn add_box_faces<S: CellStore>(s: &S, sums: &mut CellSums) {
    let mut f: u32 = 0;
    while f < s.planes() {
        if s.tag(f) == TAG_BOX {
            add_boundary(s, f, 1.0, 1.0, sums);
        }
        f += 1;
    }
}

/// The voxels that the bounding box of the cell meets, rounded outward.
fn voxels_of_cell<S: CellStore>(s: &S, lo: &mut Voxel, hi: &mut Voxel) {
    let mut low: V3 = s.position(0);
    let mut high: V3 = low;
    let mut radius: Real = s.radius(0);
    let mut v: u32 = 1;
    while v < s.vertices() {
        let p: V3 = s.position(v);
        low = v3(smaller(low.x, p.x), smaller(low.y, p.y), smaller(low.z, p.z));
        high = v3(larger(high.x, p.x), larger(high.y, p.y), larger(high.z, p.z));
        radius = larger(radius, s.radius(v));
        v += 1;
    }
    let site: V3 = s.site();
    // The vertices' error, and the rounding of moving them into the diagram's frame.
    let margin: Real = radius + ((4.0 * UNIT_ROUNDOFF) * (norm_max(site) + larger(norm_max(low), norm_max(high))));
    let outward: V3 = v3(margin, margin, margin);
    *lo = s.voxel_of(sub(add(site, low), outward));
    *hi = s.voxel_of(add(add(site, high), outward));
}

#[inline(always)]
fn smaller(a: Real, b: Real) -> Real {
    if b < a {
        return b;
    }
    return a;
}

#[inline(always)]
fn larger(a: Real, b: Real) -> Real {
    if b > a {
        return b;
    }
    return a;
}

/// Subtracts the signed integrals of the cell's intersection with the truncated cone of every triangle near it; `touched` becomes 1
/// where a piece ends at its triangle.
fn add_cones<S: CellStore>(
    s: &mut S,
    lo: Voxel,
    hi: Voxel,
    center: V3,
    flags: u32,
    touched: &mut u32,
    sums: &mut CellSums,
) -> u32 {
    s.save();
    let mut k: u32 = lo.k;
    while k <= hi.k {
        let mut j: u32 = lo.j;
        while j <= hi.j {
            let mut i: u32 = lo.i;
            while i <= hi.i {
                let voxel: Voxel = Voxel { i: i, j: j, k: k };
                let end: u32 = s.list_end(voxel);
                let mut entry: u32 = s.list_begin(voxel);
                while entry < end {
                    let t: u32 = s.list_entry(entry);
                    if is_first_voxel(s.lowest_voxel(t), lo, voxel) != 0 {
                        let status: u32 = add_cone(s, t, lo, center, flags, touched, sums);
                        if status != COMPLETE {
                            return status;
                        }
                    }
                    entry += 1;
                }
                i += 1;
            }
            j += 1;
        }
        k += 1;
    }
    return COMPLETE;
}

/// A triangle stands in every voxel of its bounding box; it is taken only in the lowest one that the cell's box shares.
#[inline(always)]
fn is_first_voxel(lowest: Voxel, lo: Voxel, voxel: Voxel) -> u32 {
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
    if ((i == voxel.i) && (j == voxel.j)) && (k == voxel.k) {
        return 1;
    }
    return 0;
}

/// Subtracts the signed integrals of the cell's intersection with the truncated cone over triangle `t` from corner `apex`.
fn add_cone<S: CellStore>(
    s: &mut S,
    t: u32,
    apex: Voxel,
    center: V3,
    flags: u32,
    touched: &mut u32,
    sums: &mut CellSums,
) -> u32 {
    let mut cone: TruncatedCone = TruncatedCone {
        sign: 0.0,
        end: Plane::default(),
        side_0: Plane::default(),
        side_1: Plane::default(),
        side_2: Plane::default(),
    };
    if make_cone(s, t, apex, &mut cone) != COMPLETE {
        return UNCERTAIN;
    }
    if cone.sign == 0.0 {
        return COMPLETE;
    }
    // Cull before cutting: most candidates have the whole cell on the wrong side of one of the four planes.
    let base: u32 = s.planes();
    if (all_in_conflict(s, base, cone.end) != 0)
        || (all_in_conflict(s, base, cone.side_0) != 0)
        || (all_in_conflict(s, base, cone.side_1) != 0)
        || (all_in_conflict(s, base, cone.side_2) != 0)
    {
        return COMPLETE;
    }
    let mut status: u32 = clip(s, cone.side_0, TAG_CONE);
    if (status == CUT) || (status == UNTOUCHED) {
        status = clip(s, cone.side_1, TAG_CONE);
    }
    if (status == CUT) || (status == UNTOUCHED) {
        status = clip(s, cone.side_2, TAG_CONE);
    }
    let end_index: u32 = s.planes();
    if (status == CUT) || (status == UNTOUCHED) {
        status = clip(s, cone.end, TAG_TRIANGLE);
    }
    if (status == CUT) || (status == UNTOUCHED) {
        if (flags & FACETS) != 0 {
            reset_from(s, base);
        }
        let ended: u32 = status;
        status = integrate(s, -cone.sign, center, flags, sums);
        if (status == COMPLETE) && (ended == CUT) {
            *touched = 1;
            if (flags & FACETS) != 0 {
                add_boundary(s, end_index, -cone.sign, -cone.sign, sums);
            }
        }
    }
    s.restore();
    s.set_planes(base);
    if (status == EMPTY) || (status == COMPLETE) {
        return COMPLETE;
    }
    return status;
}

/// Sets the facets' sums of the half-spaces from `base` on to zero.
fn reset_from<S: CellStore>(s: &mut S, base: u32) {
    let mut f: u32 = base;
    while f < s.planes() {
        s.set_facet(f, Default::default());
        f += 1;
    }
}

/// Whether (1) every vertex is certainly in conflict with `plane`; uses the slot of plane `k`.
#[inline(always)]
fn all_in_conflict<S: CellStore>(s: &mut S, k: u32, plane: Plane) -> u32 {
    s.set_plane(k, plane);
    if s.mark_conflicts(k) == SEEN_CONFLICT {
        return 1;
    }
    return 0;
}

/// The truncated cone over triangle `t` from corner `apex`, in the frame of the site.
fn make_cone<S: CellStore>(s: &mut S, t: u32, apex: Voxel, cone: &mut TruncatedCone) -> u32 {
    let triangle: Triangle = s.triangle(t);
    let a: V3 = s.domain_point(triangle.a);
    let b: V3 = s.domain_point(triangle.b);
    let c: V3 = s.domain_point(triangle.c);
    let o: V3 = s.corner(apex);
    let sign: i32 = cone_sign(s, t, apex, sub(a, o), sub(b, o), sub(c, o));
    if sign == SIGN_UNKNOWN {
        return UNCERTAIN;
    }
    cone.sign = sign as Real;
    if sign == 0 {
        return COMPLETE;
    }
    let site: V3 = s.site();
    let o_in: V3 = sub(o, site);
    cone.end = triangle_plane(sub(a, site), sub(b, site), sub(c, site), cone.sign);
    cone.side_0 = side_over_edge(triangle.a, triangle.b, a, b, o, o_in, cone.sign);
    cone.side_1 = side_over_edge(triangle.b, triangle.c, b, c, o, o_in, cone.sign);
    cone.side_2 = side_over_edge(triangle.c, triangle.a, c, a, o, o_in, cone.sign);
    return COMPLETE;
}

/// The side over the edge from vertex `i` at `p` to vertex `j` at `q`, computed with the ends in index order so that both
/// triangles at the edge get the very same plane.
#[inline(always)]
fn side_over_edge(i: u32, j: u32, p: V3, q: V3, o: V3, o_in: V3, sign: Real) -> Plane {
    if i < j {
        return cone_side(o_in, sub(p, o), sub(q, p), sign);
    }
    return cone_side(o_in, sub(q, o), sub(p, q), -sign);
}

/// The filter's bound for the determinant of three rounded differences: (7 + 56u)u times its permanent (Shewchuk 1997).
const CONE_SIGN_ERROR: Real = (7.0 + (56.0 * UNIT_ROUNDOFF)) * UNIT_ROUNDOFF;

/// The exact sign of `det(a − o, b − o, c − o)`, given the rounded differences.
fn cone_sign<S: CellStore>(s: &mut S, t: u32, apex: Voxel, a: V3, b: V3, c: V3) -> i32 {
    let det: Real = dot(a, cross(b, c));
    let abs_b: V3 = magnitudes(b);
    let abs_c: V3 = magnitudes(c);
    let permanent: Real = dot(
        magnitudes(a),
        v3(
            (abs_b.y * abs_c.z) + (abs_b.z * abs_c.y),
            (abs_b.z * abs_c.x) + (abs_b.x * abs_c.z),
            (abs_b.x * abs_c.y) + (abs_b.y * abs_c.x),
        ),
    );
    let bound: Real = CONE_SIGN_ERROR * permanent;
    if det > bound {
        return 1;
    }
    if det < -bound {
        return -1;
    }
    return s.exact_cone_sign(t, apex);
}

#[inline(always)]
fn magnitudes(a: V3) -> V3 {
    return v3(a.x.abs(), a.y.abs(), a.z.abs());
}
