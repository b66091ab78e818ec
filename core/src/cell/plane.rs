//! Half-spaces. Each is rounded once, by one expression; its coefficients are exact inputs from then on.

use super::vector::{Real, V3, cross, dot, scale, sub, v3};

/// The half-space that keeps `n·x + d ≥ 0`; `n` need not be unit.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plane {
    /// Inward normal.
    pub n: V3,
    /// Offset.
    pub d: Real,
}

/// The power bisector of a site at the origin and a site at `d`, keeping the origin's side; `dw = w_i − w_j`, the
/// origin's weight less the other's. `n = −d`, offset `(‖d‖² + dw)/2` (paper §2.3).
#[inline(always)]
pub fn bisector(d: V3, dw: Real) -> Plane {
    return Plane { n: v3(-d.x, -d.y, -d.z), d: 0.5 * (dot(d, d) + dw) };
}

/// The side of the truncated cone of apex `o` over the edge from `lo` to `hi` (the ends in index order), both relative to the
/// apex's frame as `lo_o = lo − o` and `edge = hi − lo`; keeps the side where `sign·(lo_o × edge)·(x − o) ≥ 0`.
///
/// `lo_o × edge` is `(lo − o) × (hi − o)` without the cancellation of short edges. The triangle on the other side of the
/// edge gets the same plane negated, to the last bit.
#[cfg_attr(opencl, outline)]
pub(crate) fn cone_side(o: V3, lo_o: V3, edge: V3, sign: Real) -> Plane {
    let n: V3 = scale(sign, cross(lo_o, edge));
    return Plane { n: n, d: -dot(n, o) };
}

/// The plane of triangle `(a, b, c)`, keeping the side where `sign·(b − a)×(c − a)·(x − a) ≥ 0`.
#[cfg_attr(opencl, outline)]
pub(crate) fn triangle_plane(a: V3, b: V3, c: V3, sign: Real) -> Plane {
    let n: V3 = scale(sign, cross(sub(b, a), sub(c, a)));
    return Plane { n: n, d: -dot(n, a) };
}

/// The plane through the edge from `a` to `b` of a triangle, across the triangle's own plane of normal `n`; keeps the side
/// where `(n × (b − a))·(x − a) ≥ 0`: the triangle's, where it is counterclockwise about `n`.
#[cfg_attr(opencl, outline)]
pub(crate) fn wall_over_edge(n: V3, a: V3, b: V3) -> Plane {
    let inward: V3 = cross(n, sub(b, a));
    return Plane { n: inward, d: -dot(inward, a) };
}
