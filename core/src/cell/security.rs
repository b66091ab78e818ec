//! Completeness: which sites, or boxes of sites, provably cannot cut the cell. Everything is rounded to the safe side.

use super::store::CellStore;
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, dot, norm_1, norm_max, v3};

/// Relative room for the roundings of the tests below: at most ten operations each.
pub(super) const SAFE: Real = 1.0 + (16.0 * UNIT_ROUNDOFF);

/// An upper bound of the distance from the site to the farthest vertex.
#[inline(always)]
pub fn farthest_vertex<S: CellStore>(s: &S) -> Real {
    let largest: V3 = s.farthest();
    // The radius bounds each component; √3 < 2.
    return (largest.x.sqrt() + (2.0 * largest.y)) * SAFE;
}

/// The quick test: a site at distance at least this from the cell's site, of weight at most `W`, cannot cut a cell whose
/// farthest vertex is at most `r` away, where `dw = W − w_i`: `r + √(max(0, r² + dw))`; with equal weights the `2r` of the paper.
#[inline(always)]
pub fn security_reach(r: Real, dw: Real) -> Real {
    let inner: Real = ((r * r) * SAFE) + dw;
    if inner <= 0.0 {
        return r;
    }
    return (r + inner.sqrt()) * SAFE;
}

/// The sharp test: whether (1) no site in the box `[lo, hi]` (in the frame of the site) of weight at most `W` can cut the cell,
/// `dw = W − w_i`: `dist²(v, box) − W ≥ ‖v‖² − w_i` for every vertex `v`.
#[inline(always)]
pub fn box_cannot_cut<S: CellStore>(s: &S, lo: V3, hi: V3, dw: Real) -> u32 {
    let mut v: u32 = 0;
    while v < s.vertices() {
        let position: V3 = s.position(v);
        let gap: V3 = v3(
            outside_of(position.x, lo.x, hi.x),
            outside_of(position.y, lo.y, hi.y),
            outside_of(position.z, lo.z, hi.z),
        );
        let distance: Real = dot(gap, gap);
        let power: Real = dot(position, position) + dw;
        // The slope of dist² − ‖v‖² is twice the nearest point of the box, v plus or minus the gap.
        let slope: Real = 2.0 * norm_1(add(v3(position.x.abs(), position.y.abs(), position.z.abs()), gap));
        let margin: Real = ((slope + s.radius(v)) * (4.0 * s.radius(v)))
            + ((16.0 * UNIT_ROUNDOFF) * ((distance + dot(position, position)) + dw.abs()))
            + ((4.0 * UNIT_ROUNDOFF) * (norm_max(gap) * slope));
        if (distance - power) < margin {
            return 0;
        }
        v += 1;
    }
    return 1;
}

/// How far `x` lies outside `[lo, hi]`.
#[inline(always)]
pub(super) fn outside_of(x: Real, lo: Real, hi: Real) -> Real {
    if x < lo {
        return lo - x;
    }
    if x > hi {
        return x - hi;
    }
    return 0.0;
}
