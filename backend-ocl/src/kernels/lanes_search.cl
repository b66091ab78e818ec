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
#if WITH_TABLE && CUTS_OUTSIDE
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

// (A million sites of a Lévy flight take 0.161 instead of 0.183 s with it where cells are completed by their vertices, in a plane 0.078 and 0.085; swept 0.118 and 0.160; of lognormal
// radii those that need much room 5.5 and 13 ms. But on a bumpy surface, where nothing but what is near is looked at before a sweep, 0.192 and 0.187 s. One NVIDIA H200.)
// (Of the sites that a white cell visits 27 of 43 do not cut it: a million white sites take 0.0194 instead of 0.0206 s with it, of a Plummer cluster 0.036 and 0.038; with 3 to 14 cuts
// it is as long. Where the tree is searched a Lévy flight takes 0.106 s with 3 cuts, 0.109 with 6, a jittered sphere 0.176 and 0.179. One NVIDIA H200.)
INLINE uint store_cuts_before_look(Store *s) { return (LANES > 1u) ? ((WITH_TABLE != 0) ? 6u : 3u) : NO_SITE; }
#if GOES_ON
INLINE bool store_checks_near(Store *s) { return s->checks_near != 0u; }
#else
INLINE bool store_checks_near(Store *s) { return false; }
#endif

// Vertices that are compared at a time where the tree is searched, so that what is read of them is waited for together: a million sites on a bumpy surface take 0.194 instead of
// 0.207 s, on a jittered sphere 0.205 and 0.228; with 8 as long. One NVIDIA H200.
#define COMPARED 4u
// Whether a site certainly leaves the cell untouched, as `clip_together` would find it. (As a number, and by a loop that
// ends in one place: with `bool` and a return in it `First` compiles to other code, and white sites took 2 % longer, one NVIDIA H200.)
INLINE uint leaves_untouched(Store *s, uint j) {
    const Trial trial = trial_of(s, bisector_with(s, j));
    uint is_within = 1;
#if WITH_TABLE
    ROLLED
    for (uint v = 0; v < s->vertices; v++) {
        const float4 p = s->cell->rough[v];
        if (!(value_at(trial, p) > bound_at(trial, p))) {
            is_within = 0;
            break;
        }
    }
#else
    // (A cell has some.)
    const uint last = s->vertices - 1u;
    ROLLED
    for (uint v = 0; (v <= last) && (is_within != 0u); v += COMPARED) {
        float4 p[COMPARED];
        UNROLLED
        for (uint i = 0; i < COMPARED; i++) {
            p[i] = s->cell->rough[min(v + i, last)];
        }
        UNROLLED
        for (uint i = 0; i < COMPARED; i++) {
            is_within &= (value_at(trial, p[i]) > bound_at(trial, p[i])) ? 1u : 0u;
        }
    }
#endif
    return is_within;
}
#if WITH_TABLE
INLINE uint store_drop_held(Store *s, uint count) {
    ROLLED
    for (uint c = 0; c < store_held(s, count); c++) {
        if (store_held_key(s, c) != NO_SITE) {
            if (leaves_untouched(s, store_held_site(s, c)) != 0u) {
                store_let_go(s, c);
            }
        }
    }
    return count;
}
#else
// (Those that stay move together: the few of a sweep took as many turns as all, on a bumpy surface a third of its cycles, and 0.180 instead of 0.174 s; one NVIDIA H200.)
INLINE uint store_drop_held(Store *s, uint count) {
    CELL_SPACE Cell *cell = s->cell;
    uint kept = 0;
    ROLLED
    for (uint from = 0; from < count; from += LANES) {
        const uint i = from + s->lane;
        const uint j = (i < count) ? cell->candidate[i] : 0u;
        const uint key = (i < count) ? cell->candidate_key[i] : NO_SITE;
        const uint all = lanes_with((key != NO_SITE) && (leaves_untouched(s, j) == 0u));
        if (((all >> s->lane) & 1u) != 0u) {
            const uint to = kept + popcount(all & ((1u << s->lane) - 1u));
            cell->candidate[to] = j;
            cell->candidate_key[to] = key;
        }
        kept += popcount(all);
    }
    lanes_wait();
    return kept;
}
#endif

#import "generated/candidate_search.cl"
