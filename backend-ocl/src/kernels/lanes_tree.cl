// The search of the tree (`tree_search.cl`), where LANES work-items compute a cell together.

#import "lanes_cap.cl"
#import "lanes_reach.cl"
#import "tree_store.cl"

#if SEARCHES_TREE

INLINE uint store_lanes(Store *s) { return LANES; }
INLINE uint store_lane(Store *s) { return s->lane; }
INLINE uint store_lanes_with(Store *s, uint bit) { return lanes_with(bit); }
INLINE uint store_count_of(Store *s, uint lanes) { return popcount(lanes); }
INLINE uint store_rank_in(Store *s, uint lanes) { return popcount(lanes & ((1u << s->lane) - 1u)); }
INLINE uint store_first_of(Store *s, uint lanes) { return lowest_bit(lanes); }
INLINE uint store_least_of_lanes(Store *s, uint x) { return ~lanes_most(~x); }
INLINE uint store_lane_value(Store *s, uint x, uint from) { return lane_value(x, from); }
INLINE real store_lane_real(Store *s, real x, uint from) {
    const uint2 own = as_uint2(x);
    return as_double((uint2)(lane_value(own.x, from), lane_value(own.y, from)));
}
INLINE void store_lanes_wait(Store *s) { lanes_wait(); }

INLINE uint store_open_block(Store *s, uint i) { return s->cell->open[i]; }
INLINE uint store_leaf(Store *s, uint i) { return s->cell->leaf[i]; }
#if KEEPS_KEYS
INLINE uint store_open_key(Store *s, uint i) { return s->cell->open_key[i]; }
INLINE uint store_leaf_key(Store *s, uint i) { return s->cell->leaf_key[i]; }
INLINE void store_set_open_block(Store *s, uint i, uint block, uint key, uint asks) {
    s->cell->open[i] = block;
    s->cell->open_key[i] = key;
}
INLINE void store_set_leaf(Store *s, uint i, uint leaf, uint key, uint asks) {
    s->cell->leaf[i] = leaf;
    s->cell->leaf_key[i] = key;
}
#else
INLINE uint store_open_key(Store *s, uint i) { return 0u; }
INLINE uint store_leaf_key(Store *s, uint i) { return 0u; }
INLINE void store_set_open_block(Store *s, uint i, uint block, uint key, uint asks) { s->cell->open[i] = block; }
INLINE void store_set_leaf(Store *s, uint i, uint leaf, uint key, uint asks) { s->cell->leaf[i] = leaf; }
#endif
INLINE uint store_candidate(Store *s, uint i) { return s->cell->candidate[i]; }
INLINE uint store_candidate_key(Store *s, uint i) { return s->cell->candidate_key[i]; }
INLINE void store_set_candidate(Store *s, uint i, uint site, uint key) {
    s->cell->candidate[i] = site;
    s->cell->candidate_key[i] = key;
}

// (In single precision: in double, with its two roots, each call took 1,800 cycles, of 210,000 that a search of white noise took.)
INLINE real store_square_of_reach(Store *s, V3 center) {
#if WITH_WEIGHTS
    const V3 from = origin_of(s->cell);
    const float3 place = (float3)((float)(center.x - from.x), (float)(center.y - from.y), (float)(center.z - from.z));
    const float far = (farthest_from(s, place) + (ROUGH * ((fabs(place.x) + fabs(place.y)) + fabs(place.z)))) * ROUGH_SAFE;
#else
    const float far = farthest_of(s);
#endif
    return (real)((far * far) * ROUGH_SAFE);
}

INLINE uint store_settled(Store *s, uint v) { return s->cell->triplet[v] & SETTLED; }
INLINE void store_set_settled(Store *s, uint v, uint settled) {
    if (s->lane == 0u) {
        const uint triplet = s->cell->triplet[v] & ~SETTLED;
        s->cell->triplet[v] = (settled != 0u) ? (triplet | SETTLED) : triplet;
    }
}

INLINE uint store_cut_by(Store *s, uint j) {
    const uint status = cut_together(s, bisector_with(s, j), j);
#if WITH_DOMAIN
    if (((status == CUT) && (s->cell->outside > 0.0f)) && (extent_of(farthest_of(s)) <= s->cell->outside)) {
        return EMPTY;
    }
#endif
    return status;
}
// Where a vertex is off by more than this share of its distance it is worked out in double-double: what it is off by decides how many sites may
// have the least power there.
#define FINE_ENOUGH REAL(1e-12)
INLINE uint store_fine_position(Store *s, uint v, V3 *position, real *radius) {
    const Triplet t = store_triplet(s, v);
#if WITH_EXACT
    return find_vertex(s, t, position, radius);
#else
    if ((find_vertex_once(s, t, position, radius) == COMPLETE) && (*radius <= (FINE_ENOUGH * norm_1(*position)))) {
        return COMPLETE;
    }
    // (Its arguments cannot stay in registers.)
    V3 place;
    real its;
    const uint status = wide_position(s->cell->plane[t.a], s->cell->plane[t.b], s->cell->plane[t.c], &place, &its);
    *position = place;
    *radius = its;
    return status;
#endif
}
INLINE uint store_was_tried(Store *s, uint j) { return has_cut(s, j); }
INLINE uint store_touches(Store *s, uint v, uint j) {
    const Triplet t = store_triplet(s, v);
    return (s->cell->source[t.a] == j) || (s->cell->source[t.b] == j) || (s->cell->source[t.c] == j);
}
// (Proofs that are cut short are for one work-item.)
INLINE uint store_leaves_out(Store *s) { return 0u; }
INLINE uint store_cut_outside(Store *s, real radius) {
#if WITH_DOMAIN
    const float far = farthest_of(s);
    if (((real)far <= radius) || (extent_of(far) <= s->cell->clear)) {
        return UNTOUCHED;
    }
#if WITH_EXACT
    Store copy = *s;
    const uint status = lanes_alike(cap_together(&copy, radius));
    take_over(s, &copy);
    return status;
#elif WITH_FACETS
    return OPEN;
#else
    // (No stage before that with exact signs can do more for it.)
    return LEFT;
#endif
#else
    return UNTOUCHED;
#endif
}

#import "tree_search.cl"

#if WITH_FAR && WITH_EXACT
// (Few cells come to it: a function of its own, so that it does not take registers from all.)
OUTLINE uint complete_by_vertices(Store *given, uint *visited) {
    Store store = taken_store(given);
    const uint status = search_far(&store, vantage_of(&store).center, 1u, visited);
    return give_back(given, &store, (status == UNCERTAIN) ? LEFT : status);
}
#endif

// Cuts the cell by all sites that can cut it: `COMPLETE`, `EMPTY`, `LEFT`, `OPEN` or `BEYOND`.
INLINE uint complete_by_tree(Store *s, Vantage vantage, uint *visited, float *extent) {
    uint status = search_near(s, vantage, visited);
    if (status == UNTOUCHED) {
#if WITH_FAR && !WITH_EXACT
        status = search_far(s, vantage.center, 1u, visited);
        status = (status == UNCERTAIN) ? OPEN : status;
#elif WITH_FAR
        Store copy = *s;
        uint more = *visited;
        status = lanes_alike(complete_by_vertices(&copy, &more));
        *visited = more;
        take_over(s, &copy);
#else
        status = BEYOND;
#endif
    }
    *extent = extent_of(farthest_of(s));
    return status;
}
#endif
