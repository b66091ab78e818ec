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

/// The triangle is beyond none of the cell's half-spaces; beyond one, so that it misses the cell; beyond one that holds the apex, so that its cone does, too.
pub(super) const NONE_BEYOND: u32 = 0;
pub(super) const TRIANGLE_BEYOND: u32 = 1;
pub(super) const CONE_BEYOND: u32 = 2;

/// How far beyond, as a share of the way to the farthest of its corners and the apex. The sides of a cone are off by roundings over the sine of the angle between
/// an edge and the way to it, and what one triangle loses to that its neighbour has: a cone that is left out is beyond the reach of that, down to a sine of 2⁻³¹.
#[cfg_attr(opencl, single(0.0009765625))]
const LEAST_BEYOND: Real = 9.5367431640625e-7;

/// Whether triangle `t` lies beyond one of the cell's half-spaces, as seen from corner `apex`. (Of 69,266 triangles in the voxels of 4,319 cells of 20,000 sites in the
/// bunny 22,710 are left, of which 18,774 have something of the cell in their cones; by their cones' planes alone 62,855 are.)
#[inline]
#[cfg_attr(opencl, outline)]
pub(super) fn lies_beyond<S: DomainStore>(s: &S, t: u32, apex: Voxel) -> u32 {
    let triangle: Triangle = s.triangle(t);
    let site: V3 = s.site();
    let a: V3 = sub(s.domain_point(triangle.a), site);
    let b: V3 = sub(s.domain_point(triangle.b), site);
    let c: V3 = sub(s.domain_point(triangle.c), site);
    let o: V3 = sub(s.corner(apex), site);
    let reach: Real = larger(larger(norm_1(a), norm_1(b)), larger(norm_1(c), norm_1(o)));
    let mut beyond: u32 = NONE_BEYOND;
    for f in 0..s.planes() {
        let plane: Plane = s.plane(f);
        let margin: Real = (LEAST_BEYOND * reach) * norm_1(plane.n);
        let highest: Real = larger(larger(dot(plane.n, a), dot(plane.n, b)), dot(plane.n, c));
        if (highest + plane.d) < -margin {
            beyond = TRIANGLE_BEYOND;
            if (dot(plane.n, o) + plane.d) > margin {
                return CONE_BEYOND;
            }
        }
    }
    return beyond;
}

/// The corner of a voxel from `lo` to `hi` that is nearest to `x`, in the diagram's frame: as an apex within the cell it has cones of the fewest triangles. (From
/// the corner of `lo` those of the 20,000 sites have 246,000 vertices of the cell in them, from there 179,000.)
#[cfg_attr(opencl, outline)]
pub(super) fn nearest_corner<S: DomainStore>(s: &S, x: V3, lo: Voxel, hi: Voxel) -> Voxel {
    let at: Voxel = s.voxel_of(x);
    let low: V3 = s.corner(at);
    let high: V3 = s.corner(Voxel { i: at.i + 1, j: at.j + 1, k: at.k + 1 });
    return Voxel {
        i: nearest_of(x.x, low.x, high.x, at.i, lo.i, hi.i),
        j: nearest_of(x.y, low.y, high.y, at.j, lo.j, hi.j),
        k: nearest_of(x.z, low.z, high.z, at.k, lo.k, hi.k),
    };
}

/// The number of the voxel from `least` to `most` that begins nearest to `x`, which is from `low` to `high` in number `at`.
#[inline(always)]
pub(super) fn nearest_of(x: Real, low: Real, high: Real, at: u32, least: u32, most: u32) -> u32 {
    let mut nearest: u32 = at;
    if (high - x) < (x - low) {
        nearest += 1;
    }
    if nearest < least {
        nearest = least;
    }
    if nearest > most {
        nearest = most;
    }
    return nearest;
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
