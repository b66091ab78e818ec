//! Vertices: triplets of planes, and where they meet.

use super::expansion::expansion_position;
use super::plane::Plane;
use super::status::{COMPLETE, UNCERTAIN};
use super::store::{Polytope, SignStore};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, cross, dot, norm_1, norm_max, scale, sub, v3};
use super::wide::{Wide, product_exact, sum_exact, wide_add, wide_position};

/// A vertex as the three half-spaces it lies on, clockwise from outside: `det(n_a, n_b, n_c) > 0` exactly.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Triplet {
    /// First plane.
    pub a: u32,
    /// Second plane.
    pub b: u32,
    /// Third plane.
    pub c: u32,
}

/// Below this share of `‖n_a‖₁‖n_b‖₁‖n_c‖₁` of the determinant the three normals count as nearly dependent, and
/// `find_vertex` computes the position in double-double. The refined one below is off by the square of `ROUNDINGS_OF_PLACE` u over the share: here by 2u.
///
/// In single precision two roundings would leave out every twentieth vertex; so far down one in ten thousand is left out, and the others' radius says
/// what they have lost.
#[cfg_attr(opencl, single(3.0517578125e-5))]
pub const NEARLY_DEPENDENT: Real = 2.3841857910156e-7;

/// Down to this share steps of Newton's method lead to the vertex, each by the factor `ROUNDINGS_OF_PLACE` u over the share: here a 16,384th (in single precision a 16th).
#[cfg_attr(opencl, single(3.0517578125e-5))]
const REFINABLE: Real = 5.820766091346741e-11;

/// Steps that `find_vertex_closely` takes at most: what they leave of the first error down there is less than a rounding.
const MOST_STEPS: u32 = 3;

/// Below this share the position is refined once: Cramer's rule alone is off by the inverse of the share.
///
/// Of the digits of single precision there are none to spare.
#[cfg_attr(opencl, single(0.015625))]
const WORTH_REFINING: Real = 0.001953125;

/// Roundings in a position and in the evaluation of a plane there, in units of `UNIT_ROUNDOFF` and of the sum that
/// `find_vertex` forms: at most 8 for Cramer's rule (5 in the numerator, 5 in the determinant weighted by `|v|`, 2 for
/// the quotient), and 4 for `n·v + d`; more than doubled for the rounding of the bound itself.
const ROUNDINGS_OF_PLACE: Real = 32.0;

/// The same for a position that is itself within a rounding: 1 for each component, 4 for `n·v + d`, and the bound's.
pub(super) const ROUNDINGS_OF_EXACT: Real = 8.0;

/// Computes the position of vertex `v` from its triplet and sets it, see [`find_vertex`].
#[inline(always)]
#[cfg_attr(opencl, hot)]
pub(crate) fn place_vertex<S: SignStore>(s: &mut S, v: u32) -> u32 {
    let mut position: V3 = v3(0.0, 0.0, 0.0);
    let mut radius: Real = 0.0;
    let status: u32 = find_vertex(s, s.triplet(v), &mut position, &mut radius);
    if status == COMPLETE {
        s.set_position(v, position, radius);
    }
    return status;
}

/// The position of the vertex with triplet `t`, and an error radius such that
/// `|fl(n·v + d) − (n·v* + d)| ≤ ‖n‖₁·radius + 4u|d|` for every plane, `v*` the exact vertex.
///
/// (The rare ways out read the planes again: what is handed to a function that is not inlined cannot stay in a GPU's registers before it.)
#[inline(always)]
#[cfg_attr(opencl, hot)]
pub(crate) fn find_vertex<S: SignStore>(s: &mut S, t: Triplet, position: &mut V3, radius: &mut Real) -> u32 {
    let by: Cramer = cramer(s, t);
    if !(by.det > (NEARLY_DEPENDENT * by.size)) {
        let mut exact: V3 = v3(0.0, 0.0, 0.0);
        let mut its: Real = 0.0;
        if wide_position(s.plane(t.a), s.plane(t.b), s.plane(t.c), &mut exact, &mut its) == COMPLETE {
            *position = exact;
            *radius = its;
            return COMPLETE;
        }
        s.note_exact();
        if expansion_position(s.plane(t.a), s.plane(t.b), s.plane(t.c), &mut exact) != COMPLETE {
            if s.exact_position(t, &mut exact) != COMPLETE {
                return UNCERTAIN;
            }
        }
        *position = exact;
        *radius = (ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * norm_max(exact);
        return COMPLETE;
    }
    refine_by(s, t, by, position, radius);
    return COMPLETE;
}

/// The same without the rare ways out: `UNCERTAIN` where the normals are nearly dependent.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn find_vertex_refined<S: Polytope>(s: &S, t: Triplet, position: &mut V3, radius: &mut Real) -> u32 {
    let by: Cramer = cramer(s, t);
    if !(by.det > (NEARLY_DEPENDENT * by.size)) {
        return UNCERTAIN;
    }
    refine_by(s, t, by, position, radius);
    return COMPLETE;
}

/// By Cramer's rule, refined where that is worth it.
#[inline(always)]
fn refine_by<S: Polytope>(s: &S, t: Triplet, by: Cramer, position: &mut V3, radius: &mut Real) {
    let inverse: Real = 1.0 / by.det;
    place_by(by, inverse, position, radius);
    if by.det < (WORTH_REFINING * by.size) {
        step_by(s, t, by, inverse, position, radius);
    }
}

/// Where Cramer's rule alone has the vertex, and what it may be off by.
#[inline(always)]
fn place_by(by: Cramer, inverse: Real, position: &mut V3, radius: &mut Real) {
    *position = solve(by, inverse);
    *radius = ((ROUNDINGS_OF_PLACE * UNIT_ROUNDOFF) * inverse) * (by.offsets + (norm_max(*position) * by.size));
}

/// A step of Newton's method: residuals from which little is rounded off, so that it ends within a rounding in every direction, also the one
/// in which the planes hardly tell one point from the next.
#[inline(always)]
fn step_by<S: Polytope>(s: &S, t: Triplet, by: Cramer, inverse: Real, position: &mut V3, radius: &mut Real) {
    let amplified: Real = (ROUNDINGS_OF_PLACE * UNIT_ROUNDOFF) * inverse;
    let rest_a: Real = residual(s.plane(t.a), *position);
    let rest_b: Real = residual(s.plane(t.b), *position);
    let rest_c: Real = residual(s.plane(t.c), *position);
    *position = sub(*position, scale(inverse, combine(rest_a, rest_b, rest_c, by.bc, by.ca, by.ab)));
    *radius = ((ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * norm_max(*position)) + (*radius * (amplified * by.size));
}

/// The position of the vertex with triplet `t`, refined until it is off by no more than the share `most` of its largest component; `UNCERTAIN` where that
/// is not reached, as where the normals are so nearly dependent that no step leads to it. (Some 100 operations, and 130 a step; in double-double 950.)
#[inline]
#[cfg_attr(opencl, hot)]
pub fn find_vertex_closely<S: Polytope>(s: &S, t: Triplet, most: Real, position: &mut V3, radius: &mut Real) -> u32 {
    let by: Cramer = cramer(s, t);
    if !(by.det > (REFINABLE * by.size)) {
        return UNCERTAIN;
    }
    let inverse: Real = 1.0 / by.det;
    place_by(by, inverse, position, radius);
    let mut steps: u32 = 0;
    while (*radius > (most * norm_max(*position))) && (steps < MOST_STEPS) {
        step_by(s, t, by, inverse, position, radius);
        steps += 1;
    }
    if !(*radius <= (most * norm_max(*position))) {
        return UNCERTAIN;
    }
    return COMPLETE;
}

/// The position of the vertex with triplet `t` without refinement, and its error radius: enough where both are rounded to single precision
/// anyway. `UNCERTAIN` where the determinant is no more than the share `least` of `‖n_a‖₁‖n_b‖₁‖n_c‖₁`, as [`NEARLY_DEPENDENT`].
#[inline]
#[cfg_attr(opencl, hot)]
pub fn find_vertex_once<S: Polytope>(s: &S, t: Triplet, least: Real, position: &mut V3, radius: &mut Real) -> u32 {
    let by: Cramer = cramer(s, t);
    if !(by.det > (least * by.size)) {
        return UNCERTAIN;
    }
    let inverse: Real = 1.0 / by.det;
    *position = solve(by, inverse);
    *radius = ((ROUNDINGS_OF_PLACE * UNIT_ROUNDOFF) * inverse) * (by.offsets + (norm_1(*position) * by.size));
    return COMPLETE;
}

/// What Cramer's rule for three planes is made of.
#[derive(Clone, Copy)]
pub(super) struct Cramer {
    /// `n_b×n_c`.
    pub(super) bc: V3,
    /// `n_c×n_a`.
    pub(super) ca: V3,
    /// `n_a×n_b`.
    pub(super) ab: V3,
    /// The offsets.
    pub(super) d: V3,
    /// `det(n_a, n_b, n_c)`.
    pub(super) det: Real,
    /// `‖n_a‖₁‖n_b‖₁‖n_c‖₁`.
    pub(super) size: Real,
    /// The same, each norm in turn replaced by the offset, and summed.
    pub(super) offsets: Real,
}

#[inline(always)]
pub(super) fn cramer<S: Polytope>(s: &S, t: Triplet) -> Cramer {
    let pa: Plane = s.plane(t.a);
    let pb: Plane = s.plane(t.b);
    let pc: Plane = s.plane(t.c);
    let bc: V3 = cross(pb.n, pc.n);
    let size_a: Real = norm_1(pa.n);
    let size_b: Real = norm_1(pb.n);
    let size_c: Real = norm_1(pc.n);
    return Cramer {
        bc: bc,
        ca: cross(pc.n, pa.n),
        ab: cross(pa.n, pb.n),
        d: v3(pa.d, pb.d, pc.d),
        det: dot(pa.n, bc),
        size: (size_a * size_b) * size_c,
        offsets: (((pa.d.abs() * size_b) * size_c) + ((pb.d.abs() * size_c) * size_a))
            + ((pc.d.abs() * size_a) * size_b),
    };
}

/// `v = −(d_a n_b×n_c + d_b n_c×n_a + d_c n_a×n_b) / det(n_a, n_b, n_c)`, `inverse` one over that determinant.
#[inline(always)]
pub(super) fn solve(by: Cramer, inverse: Real) -> V3 {
    return scale(-inverse, combine(by.d.x, by.d.y, by.d.z, by.bc, by.ca, by.ab));
}

/// `n·x + d`, rounded once or little more: products and sums leave what they round off, which is added up (Ogita, Rump & Oishi, Accurate Sum and Dot Product, 2005), so that no more than
/// 25u² of the magnitudes is lost. (On devices 30 operations; as sums in double-double it took 88. A million sites on a line take a device 0.073 instead of 0.078 s so, and 0.066 where it is
/// inlined, one NVIDIA H200; on the CPU blue sites take 1.0 % more instructions where it is.)
#[inline(never)]
pub(crate) fn residual(plane: Plane, x: V3) -> Real {
    let px: Wide = product_exact(plane.n.x, x.x);
    let py: Wide = product_exact(plane.n.y, x.y);
    let pz: Wide = product_exact(plane.n.z, x.z);
    let xy: Wide = sum_exact(px.hi, py.hi);
    let zd: Wide = sum_exact(pz.hi, plane.d);
    let sum: Wide = sum_exact(xy.hi, zd.hi);
    return sum.hi + (sum.lo + ((xy.lo + (px.lo + py.lo)) + (zd.lo + pz.lo)));
}

/// `n·(c + x) + d`, rounded once or little more. (Sums as in `residual` take white sites on one NVIDIA H200 2 % longer.)
#[cfg_attr(opencl, outline)]
pub(super) fn residual_about(plane: Plane, c: V3, x: V3) -> Real {
    let first: Wide = wide_add(product_exact(plane.n.x, x.x), product_exact(plane.n.y, x.y));
    let second: Wide = wide_add(product_exact(plane.n.z, x.z), product_exact(plane.n.x, c.x));
    let third: Wide = wide_add(product_exact(plane.n.y, c.y), product_exact(plane.n.z, c.z));
    let sum: Wide = wide_add(wide_add(first, second), wide_add(third, Wide { hi: plane.d, lo: 0.0 }));
    return sum.hi + sum.lo;
}

/// `r_a·bc + r_b·ca + r_c·ab`.
#[inline(always)]
pub(super) fn combine(ra: Real, rb: Real, rc: Real, bc: V3, ca: V3, ab: V3) -> V3 {
    return add(add(scale(ra, bc), scale(rb, ca)), scale(rc, ab));
}
