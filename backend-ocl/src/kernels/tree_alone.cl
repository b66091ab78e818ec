// The search of the tree (`tree_search.cl`), where one work-item computes a cell.

#import "tree_store.cl"

INLINE uint store_open_block(Store *s, uint i) { return s->open[i]; }
INLINE uint store_open_key(Store *s, uint i) { return s->open_key[i]; }
INLINE void store_set_open_block(Store *s, uint i, uint block, uint key, uint asks) {
    s->open[i] = block;
    s->open_key[i] = key;
}
INLINE uint store_leaf(Store *s, uint i) { return s->leaf[i]; }
INLINE uint store_leaf_key(Store *s, uint i) { return s->leaf_key[i]; }
INLINE void store_set_leaf(Store *s, uint i, uint leaf, uint key, uint asks) {
    s->leaf[i] = leaf;
    s->leaf_key[i] = key;
}
INLINE uint store_candidate(Store *s, uint i) { return s->candidate[i]; }
INLINE uint store_candidate_key(Store *s, uint i) { return s->candidate_key[i]; }
INLINE void store_set_candidate(Store *s, uint i, uint site, uint key) {
    s->candidate[i] = site;
    s->candidate_key[i] = key;
}
INLINE uint store_held(Store *s, uint count) { return count; }
INLINE uint store_held_site(Store *s, uint c) { return s->candidate[c]; }
INLINE uint store_held_key(Store *s, uint c) { return s->candidate_key[c]; }
INLINE void store_let_go(Store *s, uint c) { s->candidate_key[c] = NO_SITE; }
INLINE uint store_cuts_before_look(Store *s) { return NO_SITE; }
INLINE bool store_checks_near(Store *s) { return false; }
INLINE uint store_drop_held(Store *s, uint count) { return count; }

// In single precision, as `store_farthest`; so is the place.
INLINE float store_square_of_reach(Store *s, V3 center) {
    const float3 c = (float3)((float)center.x, (float)center.y, (float)center.z);
    float most = ROUGH_SQUARE;
    float radius = (float)ROUGH * ((fabs(c.x) + fabs(c.y)) + fabs(c.z));
    for (uint v = 0; v < s->vertices; v++) {
        const float3 d = s->rough[v].xyz - c;
        most = fmax(most, ((d.x * d.x) + (d.y * d.y)) + (d.z * d.z));
        radius = fmax(radius, s->rough[v].w);
    }
    const float far = (sqrt(most) + (3.0f * radius)) * ROUGH_SAFE;
    return (4.0f * far) * (far * ROUGH_SAFE);
}

INLINE uint store_key_of_reach(Store *s, float square) { return in_order(square); }

INLINE uint store_settled(Store *s, uint v) { return s->triplet[v] & SETTLED; }
INLINE void store_set_settled(Store *s, uint v, uint settled) {
    const uint triplet = s->triplet[v] & ~SETTLED;
    s->triplet[v] = (settled != 0u) ? (triplet | SETTLED) : triplet;
}
INLINE void store_settle_own(Store *s, uint v) { s->triplet[v] |= SETTLED; }

INLINE uint store_fine_position(Store *s, uint v, V3 *position, real *radius) {
    return find_vertex(s, store_triplet(s, v), position, radius);
}

OUTLINE bool store_was_tried(Store *s, uint j) {
    for (uint f = 0; f < s->planes; f++) {
        if (store_tag(s, f) == j) {
            return true;
        }
    }
    return false;
}
INLINE bool store_touches(Store *s, uint v, uint j) {
    const Triplet t = store_triplet(s, v);
    return (store_tag(s, t.a) == j) || (store_tag(s, t.b) == j) || (store_tag(s, t.c) == j);
}

#import "generated/tree_search.cl"
