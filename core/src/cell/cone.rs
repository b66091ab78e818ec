//! Truncated cones over triangles, and the prisms behind them (paper §4, with exact signs).

use super::clip::clip;
use super::facet::{FacetSum, add_boundary, integrate_facet};
use super::integrate::{CellSums, integrate};
use super::plane::{Plane, cone_side, triangle_plane, wall_over_edge};
use super::status::{
    COMPLETE, CUT, EMPTY, SEEN_CONFLICT, SEEN_KEEP, SIGN_UNKNOWN, TAG_CONE, TAG_TRIANGLE, UNCERTAIN, UNTOUCHED,
};
use super::store::{CellStore, Triangle, Voxel};
use super::vector::{Real, UNIT_ROUNDOFF, V3, cross, dot, larger, norm_1, scale, sub, v3};

/// A truncated cone: three sides through the apex, and the triangle's plane, keeping what lies behind it.
#[derive(Clone, Copy)]
pub(super) struct TruncatedCone {
    /// Sign of the triangle as seen from the apex: +1 where it turns its back, so that what lies behind is outside.
    pub(super) sign: Real,
    /// ‖·‖₁ of the way from the site to the farthest corner: what the planes' rounding is relative to.
    pub(super) reach: Real,
    pub(super) end: Plane,
    pub(super) side_0: Plane,
    pub(super) side_1: Plane,
    pub(super) side_2: Plane,
}

/// Subtracts the signed integrals of the cell's intersection with the truncated cone over triangle `t` from corner `apex`.
#[cfg_attr(opencl, outline)]
pub(crate) fn add_cone<S: CellStore>(
    s: &mut S,
    t: u32,
    apex: Voxel,
    center: V3,
    flags: u32,
    touched: &mut bool,
    sums: &mut CellSums,
) -> u32 {
    let mut cone: TruncatedCone = no_cone();
    if make_cone(s, t, apex, &mut cone) != COMPLETE {
        return UNCERTAIN;
    }
    if cone.sign == 0.0 {
        // The cone is flat, but the surface may still divide the cell.
        *touched = true;
        return COMPLETE;
    }
    // Cull before cutting: most candidates have the whole cell on the wrong side of one of the four planes.
    let base: u32 = s.planes();
    if (all_in_conflict(s, base, cone.end))
        || (all_in_conflict(s, base, cone.side_0))
        || (all_in_conflict(s, base, cone.side_1))
        || (all_in_conflict(s, base, cone.side_2))
    {
        return COMPLETE;
    }
    let mut status: u32 = clip_by_sides(s, cone);
    if status == COMPLETE {
        status = clip(s, cone.end, TAG_TRIANGLE);
        if status == CUT {
            *touched = true;
        }
        if (status == CUT) || (status == UNTOUCHED) {
            status = integrate(s, -cone.sign, center, cone.reach, flags, sums);
        }
    }
    s.restore();
    s.set_planes(base);
    if status == EMPTY {
        return COMPLETE;
    }
    return status;
}

/// Clips by the three sides; `COMPLETE` where something is left.
#[cfg_attr(opencl, outline)]
pub(super) fn clip_by_sides<S: CellStore>(s: &mut S, cone: TruncatedCone) -> u32 {
    let mut status: u32 = clip(s, cone.side_0, TAG_CONE);
    if (status == CUT) || (status == UNTOUCHED) {
        status = clip(s, cone.side_1, TAG_CONE);
    }
    if (status == CUT) || (status == UNTOUCHED) {
        status = clip(s, cone.side_2, TAG_CONE);
    }
    if (status == CUT) || (status == UNTOUCHED) {
        return COMPLETE;
    }
    return status;
}

/// Adds the part of triangle `t` within the cell to the boundary's sums: the facet on the triangle's plane of the cell's intersection
/// with the prism behind it. (The cone would do, but its sides can be nearly parallel to the triangle.)
#[cfg_attr(opencl, outline)]
pub(crate) fn add_surface<S: CellStore>(s: &mut S, t: u32, apex: Voxel, center: V3, sums: &mut CellSums) -> u32 {
    let mut prism: TruncatedCone = no_cone();
    if make_prism(s, t, apex, &mut prism) != COMPLETE {
        return UNCERTAIN;
    }
    let base: u32 = s.planes();
    s.set_plane(base, prism.end);
    let seen: u32 = s.mark_conflicts(base);
    if (seen == SEEN_CONFLICT) || (seen == SEEN_KEEP) {
        return COMPLETE;
    }
    if (all_in_conflict(s, base, prism.side_0))
        || (all_in_conflict(s, base, prism.side_1))
        || (all_in_conflict(s, base, prism.side_2))
    {
        return COMPLETE;
    }
    let mut status: u32 = clip_by_sides(s, prism);
    let end_index: u32 = s.planes();
    if status == COMPLETE {
        status = clip(s, prism.end, TAG_TRIANGLE);
    }
    if status == CUT {
        let mut facet: FacetSum = FacetSum::default();
        status = integrate_facet(s, end_index, center, &mut facet);
        if status == COMPLETE {
            add_boundary(facet, prism.end, -prism.sign, sums);
        }
    }
    s.restore();
    s.set_planes(base);
    if (status == EMPTY) || (status == UNTOUCHED) {
        return COMPLETE;
    }
    return status;
}

/// Whether every vertex is certainly in conflict with `plane`; uses the slot of plane `k`.
#[inline(always)]
pub(super) fn all_in_conflict<S: CellStore>(s: &mut S, k: u32, plane: Plane) -> bool {
    s.set_plane(k, plane);
    return s.mark_conflicts(k) == SEEN_CONFLICT;
}

/// The truncated cone over triangle `t` from corner `apex`, in the frame of the site.
#[cfg_attr(opencl, outline)]
pub(super) fn make_cone<S: CellStore>(s: &mut S, t: u32, apex: Voxel, cone: &mut TruncatedCone) -> u32 {
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
    let a_in: V3 = sub(a, site);
    let b_in: V3 = sub(b, site);
    let c_in: V3 = sub(c, site);
    cone.reach = larger(larger(norm_1(a_in), norm_1(b_in)), larger(norm_1(c_in), norm_1(o_in)));
    cone.end = triangle_plane(a_in, b_in, c_in, cone.sign);
    cone.side_0 = side_over_edge(triangle.a, triangle.b, a, b, o, o_in, cone.sign);
    cone.side_1 = side_over_edge(triangle.b, triangle.c, b, c, o, o_in, cone.sign);
    cone.side_2 = side_over_edge(triangle.c, triangle.a, c, a, o, o_in, cone.sign);
    return COMPLETE;
}

/// No cone yet.
#[cfg_attr(opencl, outline)]
pub(super) fn no_cone() -> TruncatedCone {
    return TruncatedCone {
        sign: 0.0,
        reach: 0.0,
        end: Plane::default(),
        side_0: Plane::default(),
        side_1: Plane::default(),
        side_2: Plane::default(),
    };
}

/// The prism over triangle `t`, in the frame of the site, on the side that the cone from `apex` keeps: where the surface touches
/// the cell, both then decide alike.
#[cfg_attr(opencl, outline)]
pub(super) fn make_prism<S: CellStore>(s: &mut S, t: u32, apex: Voxel, prism: &mut TruncatedCone) -> u32 {
    let triangle: Triangle = s.triangle(t);
    let a: V3 = s.domain_point(triangle.a);
    let b: V3 = s.domain_point(triangle.b);
    let c: V3 = s.domain_point(triangle.c);
    let o: V3 = s.corner(apex);
    let sign: i32 = cone_sign(s, t, apex, sub(a, o), sub(b, o), sub(c, o));
    if sign == SIGN_UNKNOWN {
        return UNCERTAIN;
    }
    prism.sign = 1.0;
    if sign < 0 {
        prism.sign = -1.0;
    }
    let site: V3 = s.site();
    let a_in: V3 = sub(a, site);
    let b_in: V3 = sub(b, site);
    let c_in: V3 = sub(c, site);
    prism.end = triangle_plane(a_in, b_in, c_in, prism.sign);
    let n: V3 = scale(prism.sign, prism.end.n);
    prism.side_0 = wall_over_edge(n, a_in, b_in);
    prism.side_1 = wall_over_edge(n, b_in, c_in);
    prism.side_2 = wall_over_edge(n, c_in, a_in);
    return COMPLETE;
}

/// The side over the edge from vertex `i` at `p` to vertex `j` at `q`, computed with the ends in index order so that both
/// triangles at the edge get the very same plane.
#[inline(always)]
pub(super) fn side_over_edge(i: u32, j: u32, p: V3, q: V3, o: V3, o_in: V3, sign: Real) -> Plane {
    if i < j {
        return cone_side(o_in, sub(p, o), sub(q, p), sign);
    }
    return cone_side(o_in, sub(q, o), sub(p, q), -sign);
}

/// The filter's bound for the determinant of three rounded differences: (7 + 56u)u times its permanent (Shewchuk 1997).
const CONE_SIGN_ERROR: Real = (7.0 + (56.0 * UNIT_ROUNDOFF)) * UNIT_ROUNDOFF;

/// The exact sign of `det(a − o, b − o, c − o)`, given the rounded differences.
#[cfg_attr(opencl, outline)]
pub(super) fn cone_sign<S: CellStore>(s: &mut S, t: u32, apex: Voxel, a: V3, b: V3, c: V3) -> i32 {
    let sign: i32 = filtered_sign(a, b, c);
    if sign == SIGN_UNKNOWN {
        return s.exact_cone_sign(t, apex);
    }
    return sign;
}

/// The sign of the determinant of three differences of points, given rounded; never 0, but `SIGN_UNKNOWN` where floating point cannot tell.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn filtered_sign(a: V3, b: V3, c: V3) -> i32 {
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
    return SIGN_UNKNOWN;
}

#[inline(always)]
pub(super) fn magnitudes(a: V3) -> V3 {
    return v3(a.x.abs(), a.y.abs(), a.z.abs());
}
