//! Truncated cones over triangles, and the prisms behind them (paper §4, with exact signs).

use super::plane::{Plane, cone_side, triangle_plane, wall_over_edge};
use super::status::{COMPLETE, SIGN_UNKNOWN, UNCERTAIN};
use super::store::{DomainStore, Triangle, Voxel};
use super::vector::{Real, UNIT_ROUNDOFF, V3, cross, dot, larger, norm_1, scale, sub, v3};

/// A truncated cone: three sides through the apex, and the triangle's plane, keeping what lies behind it.
#[derive(Clone, Copy)]
pub(super) struct TruncatedCone {
    /// Sign of the triangle as seen from the apex: +1 where it turns its back, so that what lies behind is outside.
    pub(super) sign: Real,
    /// How much larger the winding number is within than behind the triangle: the sign, as often as the triangle stands.
    pub(super) jump: Real,
    /// ‖·‖₁ of the way from the site to the farthest corner: what the planes' rounding is relative to.
    pub(super) reach: Real,
    pub(super) end: Plane,
    pub(super) side_0: Plane,
    pub(super) side_1: Plane,
    pub(super) side_2: Plane,
}

/// The truncated cone over triangle `t` from corner `apex`, in the frame of the site.
#[cfg_attr(opencl, outline)]
pub(super) fn make_cone<S: DomainStore>(s: &mut S, t: u32, apex: Voxel, cone: &mut TruncatedCone) -> u32 {
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
    cone.jump = cone.sign * (triangle.times as Real);
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
        jump: 0.0,
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
pub(super) fn make_prism<S: DomainStore>(s: &mut S, t: u32, apex: Voxel, prism: &mut TruncatedCone) -> u32 {
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
    prism.jump = prism.sign * (triangle.times as Real);
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
pub(super) fn cone_sign<S: DomainStore>(s: &mut S, t: u32, apex: Voxel, a: V3, b: V3, c: V3) -> i32 {
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
