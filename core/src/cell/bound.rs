//! What the tree knows of the sites of a node: the least that they can come to in what the search asks for.
//!
//! All is seen from a cell's site: `d` is the way from it to another, `w` what that one weighs more.

use super::quadratic::{FEW_ROUNDINGS_OF_SUM, add_least};
use super::search_store::{NodeBox, NodeSlab, NodeWeights};
use super::vector::{Real, UNIT_ROUNDOFF, V3, dot, larger, scale, sub, v3};

/// The site whose cell is searched.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Seer {
    /// Its place.
    pub site: V3,
    /// What it weighs more than the lightest of all.
    pub excess: Real,
    /// Whether weights differ.
    pub has_weights: bool,
}

/// How far what is within `off` of `place` is from the range `[lo, hi]`, at least.
#[inline(always)]
fn gap_along(lo: Real, hi: Real, place: Real, off: Real) -> Real {
    return larger(larger(lo - place, place - hi) - off, 0.0);
}

/// The square of how far what is off from `place` along each axis by up to `off` is from the box `[lo, hi]`, at least but for few roundings of it.
#[inline(always)]
fn square_to_box(lo: V3, hi: V3, place: V3, off: Real) -> Real {
    let x: Real = gap_along(lo.x, hi.x, place.x, off);
    let y: Real = gap_along(lo.y, hi.y, place.y, off);
    let z: Real = gap_along(lo.z, hi.z, place.z, off);
    return ((x * x) + (y * y)) + (z * z);
}

/// The least of `αd² + g·d − w` of weights that differ, at any site of a node.
#[inline(always)]
pub fn least_weighted(seer: Seer, alpha: Real, g: V3, bounds: NodeBox, weights: NodeWeights) -> Real {
    let lo: V3 = bounds.lo;
    let hi: V3 = bounds.hi;
    let from: V3 = seer.site;
    let mut sum: Real = seer.excess - weights.offset;
    let mut size: Real = seer.excess + weights.offset.abs();
    add_least(lo.x, hi.x, from.x, alpha, g.x, weights.slope.x, weights.curvature.x, &mut sum, &mut size);
    add_least(lo.y, hi.y, from.y, alpha, g.y, weights.slope.y, weights.curvature.y, &mut sum, &mut size);
    add_least(lo.z, hi.z, from.z, alpha, g.z, weights.slope.z, weights.curvature.z, &mut sum, &mut size);
    return sum - (FEW_ROUNDINGS_OF_SUM * size);
}

/// The least of `αd² + g·d − w` at any site of a node; without weights there is no g.
#[inline(always)]
pub fn least_of_node(seer: Seer, alpha: Real, g: V3, bounds: NodeBox, weights: NodeWeights) -> Real {
    if !seer.has_weights {
        return (alpha * square_to_box(bounds.lo, bounds.hi, seer.site, 0.0)) * (1.0 - FEW_ROUNDINGS_OF_SUM);
    }
    return least_weighted(seer, alpha, g, bounds, weights);
}

/// The least power `|d − v|² − w` at the place `v` of any site of a node.
///
/// With `h` at most the gap between `v` and the node's slab, across its normal `n`, `|v − p|² ≥ h² + |(v − hn) − p|²`: the box is seen from the
/// foot of `v` on the slab, unless weights differ, when that often says less (c = 0.9 took 30 times as long on far cells).
#[inline(always)]
pub fn least_power_of_node(seer: Seer, v: V3, bounds: NodeBox, slab: NodeSlab, weights: NodeWeights) -> Real {
    let site: V3 = seer.site;
    let from: V3 = v3(site.x + v.x, site.y + v.y, site.z + v.z);
    let height: Real = dot(slab.normal, from);
    let size: Real = (from.x.abs() + from.y.abs()) + from.z.abs();
    let rounding: Real = FEW_ROUNDINGS_OF_SUM * size;
    let across: Real = larger((height - slab.hi) - rounding, 0.0) - larger((slab.lo - height) - rounding, 0.0);
    let beyond: Real = (across * across) * (1.0 - FEW_ROUNDINGS_OF_SUM);
    if !seer.has_weights {
        let foot: V3 = sub(from, scale(across, slab.normal));
        // (What the foot is off by, beyond roundings of `across`, which are roundings of the power, too.)
        let square: Real = square_to_box(bounds.lo, bounds.hi, foot, (4.0 * UNIT_ROUNDOFF) * size);
        return (square + beyond) * (1.0 - FEW_ROUNDINGS_OF_SUM);
    }
    // |d − v|² is d² − 2v·d and v².
    let own: Real = dot(v, v);
    let least: Real = own + least_weighted(seer, 1.0, scale(-2.0, v), bounds, weights);
    let across_slab: Real =
        (beyond - (slab.largest - seer.excess)) - (FEW_ROUNDINGS_OF_SUM * (slab.largest.abs() + seer.excess));
    return larger(least - (FEW_ROUNDINGS_OF_SUM * own), across_slab);
}

/// Four times the square of the distance from the cell's centre to the bisector with a site, at least, where the centre is on the own side, and
/// else below 0: `(h_j − h_i)²/d²` (see `search.rs`), of weights that differ with the slope `g` at the cell's site.
#[inline(always)]
pub fn reach_of_bisector(g: V3, d: V3, excess: Real) -> Real {
    let square: Real = dot(d, d);
    let along: V3 = v3(g.x * d.x, g.y * d.y, g.z * d.z);
    let size: Real = square + (excess.abs() + ((along.x.abs() + along.y.abs()) + along.z.abs()));
    let power: Real = ((square - excess) + ((along.x + along.y) + along.z)) - (FEW_ROUNDINGS_OF_SUM * size);
    // (In single precision the square of the power of a site far away overflows.)
    return power * (power.abs() / square);
}
