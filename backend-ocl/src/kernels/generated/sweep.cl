// Generated from core/src/cell/sweep.rs by `cargo xtask codegen`; do not edit.

// Makes the sites that bound another cell far off candidates; returns how many they are.
INLINE uint gather_kept(Store *s, Vantage vantage) {
    const uint count = store_kept_count(s);
    uint i = store_lane(s);
    while (i < count) {
        const uint j = store_kept_site(s, i);
        uint key = NO_SITE;
        if (j != store_own_site(s)) {
            key = store_key_below(s, reach_of_site(s, vantage.slope, j));
        }
        store_set_candidate(s, i, j, key);
        i += store_lanes(s);
    }
    store_lanes_wait(s);
    return count;
}

// Whether a site of a node may have less power than the cell's own at a vertex that is not settled; of weights that are all the same.
INLINE bool may_cut(Store *s, uint level, uint node) {
    const RoughNode its = seen_roughly(store_site(s), store_node_box(s, level, node), store_node_slab(s, level, node));
    bool may = 0;
    for (uint v = 0; v < store_vertices(s); v++) {
        if (!store_settled(s, v) && may_cut_at(its, store_rough_vertex(s, v))) {
            may = 1;
        }
    }
    return may;
}

// (A node that is not there is farther than single precision reaches, and stays there: what is rounded outward is still in double precision.)
INLINE RoughNode seen_roughly(V3 site, NodeBox bounds, NodeSlab slab) {
    const V3 lo = sub(bounds.lo, site);
    const V3 hi = sub(bounds.hi, site);
    const real height = v3_dot(slab.normal, site);
    const real lost = REAL(1e-14) * ((fabs(site.x) + fabs(site.y)) + fabs(site.z));
    return (RoughNode){ .lo = (RoughPlace){ .x = lower(lo.x), .y = lower(lo.y), .z = lower(lo.z) }, .hi = (RoughPlace){ .x = upper(hi.x), .y = upper(hi.y), .z = upper(hi.z) }, .normal = (RoughPlace){ .x = (float)slab.normal.x, .y = (float)slab.normal.y, .z = (float)slab.normal.z }, .below = lower((slab.lo - height) - lost), .above = upper((slab.hi - height) + lost) };
}

INLINE float lower(real x) {
    return (float)(x - (SWEEP_OUTWARD * fabs(x)));
}

INLINE float upper(real x) {
    return (float)(x + (SWEEP_OUTWARD * fabs(x)));
}

INLINE float above_nothing(float x) {
    return fmax(x, SWEEP_NOTHING);
}

// How far a place is from a range, at least, where it is off by `off`.
INLINE float rough_gap(float lo, float hi, float place, float off) {
    return above_nothing(fmax((lo - place), place - hi) - off);
}

// Whether a site of a node may be as near to a vertex as the cell's own; the vertex is off by up to `radius` along each axis.
//
// With |v − d| < |v| at the vertex, at the place p that is known of it |p − d| < |p| + 2√3·radius. As [`least_power_of_node`](super::bound::least_power_of_node), the box is
// seen from the foot on the slab.
INLINE bool may_cut_at(RoughNode node, RoughVertex p) {
    const float size = (fabs(p.x) + fabs(p.y)) + fabs(p.z);
    const float off = SWEEP_ROUNDINGS * size;
    const float own = ((p.x * p.x) + (p.y * p.y)) + (p.z * p.z);
    const float height = ((node.normal.x * p.x) + (node.normal.y * p.y)) + (node.normal.z * p.z);
    const float across = above_nothing((height - node.above) - off) - above_nothing((node.below - height) - off);
    const float x = rough_gap(node.lo.x, node.hi.x, p.x - (across * node.normal.x), off);
    const float y = rough_gap(node.lo.y, node.hi.y, p.y - (across * node.normal.y), off);
    const float z = rough_gap(node.lo.z, node.hi.z, p.z - (across * node.normal.z), off);
    const float square = (((x * x) + (y * y)) + (z * z)) + (across * across);
    const float more = p.radius * ((SWEEP_EIGHT * size) + (SWEEP_SIXTEEN * p.radius));
    return !(square > ((own * (SWEEP_ONE + (SWEEP_EIGHT * SWEEP_ROUNDINGS))) + (more + SWEEP_LEAST_SQUARE)));
}
