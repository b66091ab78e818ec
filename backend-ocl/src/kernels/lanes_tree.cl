// The search of the tree (`tree_search.cl`), where LANES work-items compute a cell together.

#import "lanes_search.cl"

#if SEARCHES_TREE
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

INLINE uint store_settled(Store *s, uint v) { return s->cell->triplet[v] & SETTLED; }
INLINE void store_set_settled(Store *s, uint v, uint settled) {
    if (s->lane == 0u) {
        const uint triplet = s->cell->triplet[v] & ~SETTLED;
        s->cell->triplet[v] = (settled != 0u) ? (triplet | SETTLED) : triplet;
    }
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
INLINE bool store_was_tried(Store *s, uint j) { return has_cut(s, j); }
INLINE bool store_touches(Store *s, uint v, uint j) {
    const Triplet t = store_triplet(s, v);
    return (s->cell->source[t.a] == j) || (s->cell->source[t.b] == j) || (s->cell->source[t.c] == j);
}
// (Proofs that are cut short are for one work-item.)
INLINE bool store_leaves_out(Store *s) { return false; }
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

#import "generated/tree_search.cl"

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
