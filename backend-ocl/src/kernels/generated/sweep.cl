// Generated from core/src/cell/sweep.rs by `cargo xtask codegen`; do not edit.

// Makes those of some sites that are kept candidates, from the `first` on, which have a key below a limit; returns how many they are.
INLINE uint gather_kept(Store *s, Vantage vantage, uint first, uint count, uint below) {
    uint there = 0;
    uint i = store_lane(s);
    while ((i - store_lane(s)) < count) {
        uint j = store_own_site(s);
        if (i < count) {
            j = store_kept_site(s, first + i);
        }
        const uint key = store_key_below(s, reach_of_site(s, vantage.slope, j));
        const bool is_wanted = (j != store_own_site(s)) && (key < below);
        const uint all = store_lanes_with(s, is_wanted);
        if (is_wanted) {
            store_set_candidate(s, there + store_rank_in(s, all), j, key);
        }
        there += store_count_of(s, all);
        i += store_lanes(s);
    }
    store_lanes_wait(s);
    return there;
}

// Whether a site of a node may have less power than the cell's own at a vertex that is not settled.
INLINE bool may_cut(Store *s, Seer seer, uint level, uint node) {
    bool may = 0;
    // (A node that is not there has a box that single precision does not reach.)
    const bool is_there = node <= ((store_sites(s) - 1) >> (3 * (level + 1)));
    if (is_there && store_has_weights(s)) {
        const NodeBox bounds = store_node_box(s, level, node);
        const NodeWeights weights = store_node_weights(s, level, node);
        for (uint v = 0; v < store_vertices(s); v++) {
            if (!store_settled(s, v) && may_cut_weighted(seer, store_position(s, v), store_radius(s, v), bounds, weights)) {
                may = 1;
            }
        }
    } else if (is_there) {
        const RoughNode its = seen_roughly(store_site(s), store_node_box(s, level, node), store_node_slab(s, level, node));
        for (uint v = 0; v < store_vertices(s); v++) {
            if (!store_settled(s, v) && may_cut_at(its, store_rough_vertex(s, v))) {
                may = 1;
            }
        }
    }
    return may;
}

// Whether a site of a node, whose weights differ, may have less power than the cell's own at a place that is off by up to `radius` along each axis.
//
// With d the way to such a site, w what it weighs more and v the place |d|² − 2v·d − w ≤ 0, and what v is off by makes of that at most 2 `radius` times the sum of d's components.
INLINE bool may_cut_weighted(Seer seer, V3 place, real radius, NodeBox bounds, NodeWeights weights) {
    const V3 lo = sub(bounds.lo, seer.site);
    const V3 hi = sub(bounds.hi, seer.site);
    const real size = (larger(fabs(lo.x), fabs(hi.x)) + larger(fabs(lo.y), fabs(hi.y))) + larger(fabs(lo.z), fabs(hi.z));
    return !(least_weighted(seer, REAL(1.0), scale(-REAL(2.0), place), bounds, weights) > (SWEPT_TWICE * (radius * size)));
}

INLINE RoughNode seen_roughly(V3 site, NodeBox bounds, NodeSlab slab) {
    const V3 lo = sub(bounds.lo, site);
    const V3 hi = sub(bounds.hi, site);
    const real height = v3_dot(slab.normal, site);
    const real lost = REAL(1e-14) * ((fabs(site.x) + fabs(site.y)) + fabs(site.z));
    RoughNode its = (RoughNode){ .lo = (RoughPlace){ .x = lower(lo.x), .y = lower(lo.y), .z = lower(lo.z) }, .hi = (RoughPlace){ .x = upper(hi.x), .y = upper(hi.y), .z = upper(hi.z) }, .normal = (RoughPlace){ .x = (float)slab.normal.x, .y = (float)slab.normal.y, .z = (float)slab.normal.z }, .below = lower((slab.lo - height) - lost), .above = upper((slab.hi - height) + lost), .size = SWEEP_NOTHING };
    its.size = ((fmax(fabs(its.lo.x), fabs(its.hi.x)) + fmax(fabs(its.lo.y), fabs(its.hi.y))) + fmax(fabs(its.lo.z), fabs(its.hi.z))) + fmax(fabs(its.below), fabs(its.above));
    return its;
}

INLINE float lower(real x) {
    return (float)(x - (SWEEP_OUTWARD * fabs(x)));
}

INLINE float upper(real x) {
    return (float)(x + (SWEEP_OUTWARD * fabs(x)));
}

// What of a range is nearest.
INLINE float within(float lo, float hi, float x) {
    return -(fmax((-(fmax(x, lo))), -hi));
}

// a·b + c; on devices rounded once.
INLINE float fused(float a, float b, float c) {
    return fma(a, b, c);
}

// x² − 2qx of the x in a range for which that is least, and what is given.
INLINE float least_along(float lo, float hi, float q, float more) {
    const float x = within(lo, hi, q);
    return fused(x, fused(SWEEP_MINUS_TWICE, q, x), more);
}

// Whether a site of a node may be as near to a vertex as the cell's own; the vertex is off by up to `radius` along each axis.
//
// With d the way to such a site and v the vertex |d|² − 2v·d ≤ 0. For any number a that is the same as (|d|² − 2q·d) − 2a n·d with q = v − an: the first is a sum over axes,
// which has a least value over the box, and the second at least −2a times the slab's end on the side of a. The best a is how far v is beyond the slab. No square of v's distance
// is in it, as there would be in a comparison of two distances: so of what is near the cell's site little is rounded off, however far the vertex is. (Distances took 70 instead of 45
// instructions a vertex as well: a million sites on a bumpy surface 0.231 instead of 0.207 s, one NVIDIA H200.)
//
// With u half of the last bit of single precision, X the `size` of the node, and L the sum of X and of v's components: q is off by `radius` + 3uL along each axis, which adds 2X times
// that; |q| < 2L and |d − 2q| < 5L, so that no sum is above 7LX, and the roundings of four sums, of three factors, and of seven products where they are not fused are 40uLX at most: in all
// 2X·radius + 46uLX. (Of 17 million nodes that a bisector just meets, with the vertex as far off as its radius allows, none is missed, and 0.78 of what is allowed is used. Sites and
// vertices are within some thousands of a frame of size 1, where nothing overflows.)
INLINE bool may_cut_at(RoughNode node, RoughVertex p) {
    const float size = ((fabs(p.x) + fabs(p.y)) + fabs(p.z)) + node.size;
    const float height = fused(node.normal.x, p.x, fused(node.normal.y, p.y, node.normal.z * p.z));
    const float end = within(node.below, node.above, height);
    const float across = height - end;
    const float slab = (SWEEP_MINUS_TWICE * across) * end;
    const float x = least_along(node.lo.x, node.hi.x, fused(-across, node.normal.x, p.x), slab);
    const float xy = least_along(node.lo.y, node.hi.y, fused(-across, node.normal.y, p.y), x);
    const float least = least_along(node.lo.z, node.hi.z, fused(-across, node.normal.z, p.z), xy);
    const float lost = fused(SWEEP_ROUNDINGS, size, SWEEP_TWICE * p.radius);
    return !(least > fused(node.size, lost, SWEEP_LEAST_SQUARE));
}
