// What either search needs (`lanes_tree.cl`, `lanes_table.cl`), where LANES work-items compute a cell together.

#import "lanes_cap.cl"
#import "lanes_reach.cl"
#import "tree_store.cl"

// (In single precision: in double, with its two roots, each call took 1,800 cycles, of 210,000 that a search of white noise took.)
INLINE float store_square_of_reach(Store *s, V3 center) {
#if WITH_WEIGHTS
    const V3 from = origin_of(s->cell);
    const float3 place = (float3)((float)(center.x - from.x), (float)(center.y - from.y), (float)(center.z - from.z));
    const float far = (farthest_from(s, place) + (ROUGH * ((fabs(place.x) + fabs(place.y)) + fabs(place.z)))) * ROUGH_SAFE;
#else
    const float far = farthest_of(s);
#endif
    const float reach = (4.0f * far) * (far * ROUGH_SAFE);
#if (WITH_TABLE && WITH_DOMAIN) && !WITH_WEIGHTS
    return (reach <= s->cell->outside) ? 0.0f : reach;
#else
    return reach;
#endif
}

INLINE uint store_cut_by(Store *s, uint j) {
#if WITH_TABLE && (WITH_DOMAIN && WITH_EXACT)
    if ((s->is_sampled != 0u) && (has_cut(s, j) != 0u)) {
        return UNTOUCHED;
    }
#endif
    const uint status = cut_together(s, bisector_with(s, j), j);
#if WITH_DOMAIN && (SEARCHES_TREE || WITH_WEIGHTS)
    if (((status == CUT) && (s->cell->outside > 0.0f)) && (extent_of(farthest_of(s)) <= s->cell->outside)) {
        return EMPTY;
    }
#endif
    return status;
}

INLINE bool store_was_tried(Store *s, uint j) { return has_cut(s, j); }

#if WITH_TABLE
// Each lane holds two candidates. (No index, so that they stay in registers.) The last bits of a key are the lane's number, so that the least one says
// whose it is: without that white noise takes 1 % longer, one NVIDIA H200.
#define HELD 2u
#define LANE_BITS (LANES - 1u)
INLINE uint store_lane_of_key(Store *s, uint own, uint least) { return least & LANE_BITS; }
INLINE uint store_key_of_reach(Store *s, float square) { return in_order(square) + LANE_BITS; }
INLINE uint store_held(Store *s, uint count) { return HELD; }
INLINE uint store_held_site(Store *s, uint c) { return (c == 0u) ? s->held_site[0] : s->held_site[1]; }
INLINE uint store_held_key(Store *s, uint c) { return (c == 0u) ? s->held_key[0] : s->held_key[1]; }
INLINE void store_let_go(Store *s, uint c) {
    s->held_key[0] = (c == 0u) ? NO_SITE : s->held_key[0];
    s->held_key[1] = (c == 0u) ? s->held_key[1] : NO_SITE;
}
#else
INLINE uint store_lane_of_key(Store *s, uint own, uint least) { return lowest_bit(lanes_with(own == least)); }
INLINE uint store_key_of_reach(Store *s, float square) { return in_order(square); }
INLINE uint store_held(Store *s, uint count) { return ((count + (LANES - 1u)) - s->lane) / LANES; }
INLINE uint store_held_site(Store *s, uint c) { return s->cell->candidate[(c * LANES) + s->lane]; }
INLINE uint store_held_key(Store *s, uint c) { return s->cell->candidate_key[(c * LANES) + s->lane]; }
INLINE void store_let_go(Store *s, uint c) { s->cell->candidate_key[(c * LANES) + s->lane] = NO_SITE; }
#endif

// (Of cells that are completed by their vertices few sites are visited before: those of sites in a plane took 12 % longer with it.)
INLINE bool store_drops_candidates(Store *s) { return (LANES > 1u) && !(WITH_FAR || WITH_SWEEP); }
// (As `clip_together` would find them. In loops that stay loops: the text is in the inner one.)
INLINE void store_drop_held(Store *s, uint count) {
    ROLLED
    for (uint c = 0; c < store_held(s, count); c++) {
        if (store_held_key(s, c) != NO_SITE) {
            const Trial trial = trial_of(s, bisector_with(s, store_held_site(s, c)));
            bool is_within = true;
            ROLLED
            for (uint v = 0; v < s->vertices; v++) {
                const float4 p = s->cell->rough[v];
                if (!(value_at(trial, p) > bound_at(trial, p))) {
                    is_within = false;
                    break;
                }
            }
            if (is_within) {
                store_let_go(s, c);
            }
        }
    }
}

#import "generated/candidate_search.cl"
