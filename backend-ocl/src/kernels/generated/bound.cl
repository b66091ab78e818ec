// Generated from core/src/cell/bound.rs by `cargo xtask codegen`; do not edit.

// How far what is within `off` of `place` is from the range `[lo, hi]`, at least.
INLINE real gap_along(real lo, real hi, real place, real off) {
    return larger(larger(lo - place, place - hi) - off, REAL(0.0));
}

// The square of how far what is off from `place` along each axis by up to `off` is from the box `[lo, hi]`, at least but for few roundings of it.
INLINE real square_to_box(V3 lo, V3 hi, V3 place, real off) {
    const real x = gap_along(lo.x, hi.x, place.x, off);
    const real y = gap_along(lo.y, hi.y, place.y, off);
    const real z = gap_along(lo.z, hi.z, place.z, off);
    return ((x * x) + (y * y)) + (z * z);
}

// The least of `αd² + g·d − w` of weights that differ, at any site of a node.
INLINE real least_weighted(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights) {
    const V3 lo = bounds.lo;
    const V3 hi = bounds.hi;
    const V3 from = seer.site;
    real sum = seer.excess - weights.offset;
    real size = seer.excess + fabs(weights.offset);
    add_least(lo.x, hi.x, from.x, alpha, g.x, weights.slope.x, weights.curvature.x, &sum, &size);
    add_least(lo.y, hi.y, from.y, alpha, g.y, weights.slope.y, weights.curvature.y, &sum, &size);
    add_least(lo.z, hi.z, from.z, alpha, g.z, weights.slope.z, weights.curvature.z, &sum, &size);
    return sum - (FEW_ROUNDINGS_OF_SUM * size);
}

// The least of `αd² + g·d − w` at any site of a node; without weights there is no g.
INLINE real least_of_node(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights) {
    if (!seer.has_weights) {
        return (alpha * square_to_box(bounds.lo, bounds.hi, seer.site, REAL(0.0))) * (REAL(1.0) - FEW_ROUNDINGS_OF_SUM);
    }
    return least_weighted(seer, alpha, g, bounds, weights);
}

// The least power `|d − v|² − w` at the place `v` of any site of a node.
//
// With `h` at most the gap between `v` and the node's slab, across its normal `n`, `|v − p|² ≥ h² + |(v − hn) − p|²`: the box is seen from the
// foot of `v` on the slab, unless weights differ, when that often says less (c = 0.9 took 30 times as long on far cells).
INLINE real least_power_of_node(Seer seer, V3 v, NodeBox bounds, NodeSlab slab, NodeWeights weights) {
    const V3 site = seer.site;
    const V3 from = v3(site.x + v.x, site.y + v.y, site.z + v.z);
    const real height = v3_dot(slab.normal, from);
    const real size = (fabs(from.x) + fabs(from.y)) + fabs(from.z);
    const real rounding = FEW_ROUNDINGS_OF_SUM * size;
    const real across = larger((height - slab.hi) - rounding, REAL(0.0)) - larger((slab.lo - height) - rounding, REAL(0.0));
    const real beyond = (across * across) * (REAL(1.0) - FEW_ROUNDINGS_OF_SUM);
    if (!seer.has_weights) {
        const V3 foot = sub(from, scale(across, slab.normal));
        // (What the foot is off by, beyond roundings of `across`, which are roundings of the power, too.)
        const real square = square_to_box(bounds.lo, bounds.hi, foot, (REAL(4.0) * UNIT_ROUNDOFF) * size);
        return (square + beyond) * (REAL(1.0) - FEW_ROUNDINGS_OF_SUM);
    }
    // |d − v|² is d² − 2v·d and v².
    const real own = v3_dot(v, v);
    const real least = own + least_weighted(seer, REAL(1.0), scale(-REAL(2.0), v), bounds, weights);
    const real across_slab = (beyond - (slab.largest - seer.excess)) - (FEW_ROUNDINGS_OF_SUM * (fabs(slab.largest) + seer.excess));
    return larger(least - (FEW_ROUNDINGS_OF_SUM * own), across_slab);
}

// Four times the square of the distance from the cell's centre to the bisector with a site, at least, where the centre is on the own side, and
// else below 0: `(h_j − h_i)²/d²` (see `search.rs`), of weights that differ with the slope `g` at the cell's site.
INLINE real reach_of_bisector(V3 g, V3 d, real excess) {
    const real square = v3_dot(d, d);
    const V3 along = v3(g.x * d.x, g.y * d.y, g.z * d.z);
    const real size = square + (fabs(excess) + ((fabs(along.x) + fabs(along.y)) + fabs(along.z)));
    const real power = ((square - excess) + ((along.x + along.y) + along.z)) - (FEW_ROUNDINGS_OF_SUM * size);
    // (In single precision the square of the power of a site far away overflows.)
    return power * (fabs(power) / square);
}
