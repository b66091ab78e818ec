// Generated from core/src/cell/around.rs by `cargo xtask codegen`; do not edit.

INLINE real gap_between(real lo, real hi, real its_lo, real its_hi) {
    return larger(larger(its_lo - hi, lo - its_hi), REAL(0.0));
}

// The square of the distance of two boxes.
INLINE real square_between(NodeBox a, NodeBox b) {
    const real x = gap_between(a.lo.x, a.hi.x, b.lo.x, b.hi.x);
    const real y = gap_between(a.lo.y, a.hi.y, b.lo.y, b.hi.y);
    const real z = gap_between(a.lo.z, a.hi.z, b.lo.z, b.hi.z);
    return ((x * x) + (y * y)) + (z * z);
}

// Block `own`, where voxels are so wide.
INLINE Around around_block(Store *s, uint own, real width) {
    const uint level = level_of_block(store_top_level(s));
    const NodeBox bounds = store_node_box(s, level, own);
    return (Around){ .bounds = bounds, .middle = scale(REAL(0.5), add(bounds.lo, bounds.hi)), .slope = store_node_weights(s, level, own).slope, .width = width };
}

// The ring that what is so far, as a square, is in, at least.
INLINE uint ring_at(real square, real width) {
    uint ring = 0;
    bool is_within = 0;
    while ((ring < (RINGS - 1)) && !is_within) {
        const real end = ((real)end_of_ring(ring)) * width;
        is_within = square < ((end * end) * (REAL(1.0) + FEW_ROUNDINGS_OF_SUM));
        if (!is_within) {
            ring += 1;
        }
    }
    return ring;
}

// Looks at a node.
INLINE Seen look_at_node(Store *s, Around of, uint level, uint node) {
    const NodeBox its = store_node_box(s, level, node);
    const uint ring = ring_at(square_between(of.bounds, its), of.width);
    real begin = REAL(0.0);
    if (ring > 0) {
        begin = ((real)end_of_ring(ring - 1)) * of.width;
    }
    const V3 own = sub(of.bounds.hi, of.bounds.lo);
    const real small = larger(begin * begin, (SHARE_OF_BLOCK * SHARE_OF_BLOCK) * v3_dot(own, own));
    const V3 extent = sub(its.hi, its.lo);
    const Seer seer = (Seer){ .site = of.middle, .excess = REAL(0.0), .has_weights = 1 };
    return (Seen){ .most = -least_weighted(seer, REAL(0.0), of.slope, its, store_node_weights(s, level, node)), .ring = ring, .is_small = v3_dot(extent, extent) < small };
}

// Looks at a site.
INLINE Seen look_at_site(Store *s, Around of, uint j) {
    const V3 place = store_site_place(s, j);
    real size = REAL(0.0);
    const real weight = less_slope(store_site_weight(s, j), of.slope, sub(place, of.middle), &size);
    return (Seen){ .most = weight + (FEW_ROUNDINGS_OF_SUM * size), .ring = ring_at(square_between(of.bounds, (NodeBox){ .lo = place, .hi = place }), of.width), .is_small = 1 };
}
