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

// An upper bound of what any site weighs, less the slope at the middle of block `own`, that is nearer to its box than `end`, where a ring
// ends that has a beginning.
HOT real largest_around(Store *s, uint own, real begin, real end) {
    const uint top = store_top_level(s);
    const NodeBox bounds = store_node_box(s, level_of_block(top), own);
    const V3 middle = scale(REAL(0.5), add(bounds.lo, bounds.hi));
    const V3 slope = store_node_weights(s, level_of_block(top), own).slope;
    const Seer seer = (Seer){ .site = middle, .excess = REAL(0.0), .has_weights = 1 };
    const real within = (end * end) * (REAL(1.0) + FEW_ROUNDINGS_OF_SUM);
    const V3 own_extent = sub(bounds.hi, bounds.lo);
    const real small = larger(begin * begin, (SHARE_OF_BLOCK * SHARE_OF_BLOCK) * v3_dot(own_extent, own_extent));
    real largest = LEAST_OF_ALL;
    uint level = top;
    uint node = 0;
    for (;;) {
        bool opens = 0;
        if ((node << (3 * level)) <= ((store_sites(s) - 1) / WIDTH)) {
            const NodeBox its = store_node_box(s, level, node);
            real most = LEAST_OF_ALL;
            if (square_between(bounds, its) < within) {
                most = -least_weighted(seer, REAL(0.0), slope, its, store_node_weights(s, level, node));
            }
            if (most > largest) {
                const V3 extent = sub(its.hi, its.lo);
                if (v3_dot(extent, extent) < small) {
                    largest = most;
                } else if (level > 0) {
                    opens = 1;
                } else {
                    uint last = (node + 1) * WIDTH;
                    if (store_sites(s) < last) {
                        last = store_sites(s);
                    }
                    for (uint j = (node * WIDTH); j < last; j++) {
                        const V3 place = store_site_place(s, j);
                        real size = REAL(0.0);
                        const real weight = less_slope(store_site_weight(s, j), slope, sub(place, middle), &size);
                        if (square_between(bounds, (NodeBox){ .lo = place, .hi = place }) < within) {
                            largest = larger(largest, weight + (FEW_ROUNDINGS_OF_SUM * size));
                        }
                    }
                }
            }
        }
        if (opens) {
            level -= 1;
            node = node * WIDTH;
        } else {
            node += 1;
            while (((node & (WIDTH - 1)) == 0) && (level < top)) {
                node = node / WIDTH;
                level += 1;
            }
            if (node == WIDTH) {
                if (level == top) {
                    return largest;
                }
            }
        }
    }
}
