//! Vertices: triplets of planes, and where they meet.

use super::plane::Plane;
use super::status::{COMPLETE, UNCERTAIN};
use super::store::CellStore;
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, cross, dot, norm_1, norm_max, scale, sub, v3};

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

/// Below this share of `‖n_a‖₁‖n_b‖₁‖n_c‖₁` the three normals count as nearly dependent and the position is computed
/// exactly: at 1e-10 floating point still has six digits, enough for the error radius to be meaningful.
const NEARLY_DEPENDENT: Real = 1e-10;

/// Below this share the position is refined once, so that it lies on its planes to a rounding (Cramer's rule alone lies
/// off by the inverse of the share).
const WORTH_REFINING: Real = 0.001953125;

/// Roundings in a position and in the evaluation of a plane there, in units of `UNIT_ROUNDOFF` and of the sum that
/// `place_vertex` forms: at most 8 for Cramer's rule (5 in the numerator, 5 in the determinant weighted by `|v|`, 2 for
/// the quotient) or 12 for the refined one, and 4 for `n·v + d`; doubled for the rounding of the bound itself.
const ROUNDINGS: Real = 32.0;

/// Computes the position of vertex `v` from its triplet, with an error radius such that
/// `|fl(n·v + d) − (n·v* + d)| ≤ ‖n‖₁·radius + 4u|d|` for every plane, `v*` the exact vertex.
///
/// Position: `v = −(d_a n_b×n_c + d_b n_c×n_a + d_c n_a×n_b) / det(n_a, n_b, n_c)`.
pub(crate) fn place_vertex<S: CellStore>(s: &mut S, v: u32) -> u32 {
    let t: Triplet = s.triplet(v);
    let pa: Plane = s.plane(t.a);
    let pb: Plane = s.plane(t.b);
    let pc: Plane = s.plane(t.c);
    let bc: V3 = cross(pb.n, pc.n);
    let ca: V3 = cross(pc.n, pa.n);
    let ab: V3 = cross(pa.n, pb.n);
    let det: Real = dot(pa.n, bc);
    let size_a: Real = norm_1(pa.n);
    let size_b: Real = norm_1(pb.n);
    let size_c: Real = norm_1(pc.n);
    let size: Real = (size_a * size_b) * size_c;
    let mut position: V3 = v3(0.0, 0.0, 0.0);
    if !(det > (NEARLY_DEPENDENT * size)) {
        if s.exact_position(t, &mut position) != COMPLETE {
            return UNCERTAIN;
        }
        s.set_position(v, position, (8.0 * UNIT_ROUNDOFF) * norm_max(position));
        return COMPLETE;
    }
    let inverse: Real = 1.0 / det;
    position = scale(-inverse, combine(pa.d, pb.d, pc.d, bc, ca, ab));
    if det < (WORTH_REFINING * size) {
        let ra: Real = dot(pa.n, position) + pa.d;
        let rb: Real = dot(pb.n, position) + pb.d;
        let rc: Real = dot(pc.n, position) + pc.d;
        position = sub(position, scale(inverse, combine(ra, rb, rc, bc, ca, ab)));
    }
    let offsets: Real =
        (((pa.d.abs() * size_b) * size_c) + ((pb.d.abs() * size_c) * size_a)) + ((pc.d.abs() * size_a) * size_b);
    let radius: Real = ((ROUNDINGS * UNIT_ROUNDOFF) * inverse) * (offsets + (norm_max(position) * size));
    s.set_position(v, position, radius);
    return COMPLETE;
}

/// `r_a·bc + r_b·ca + r_c·ab`.
#[inline(always)]
fn combine(ra: Real, rb: Real, rc: Real, bc: V3, ca: V3, ab: V3) -> V3 {
    return add(add(scale(ra, bc), scale(rb, ca)), scale(rc, ab));
}
