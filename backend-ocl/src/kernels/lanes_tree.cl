// The search of the tree (`tree_search.cl`), where LANES work-items compute a cell together.

#import "lanes_search.cl"
#import "output.cl"

// Where what a team has begins of what all have; and whether it is the first.
#if TEAMS > 1
#define OF_TEAM(room) (s->team * (room))
#define IS_FIRST_TEAM (s->team == 0u)
#else
#define OF_TEAM(room) 0u
#define IS_FIRST_TEAM true
#endif

#if TEAMS > 1
INLINE uint store_teams(Store *s) { return TEAMS; }
INLINE bool store_shares_vertices(Store *s) { return WITH_ROOM == 2; }
INLINE uint store_team(Store *s) { return s->team; }
INLINE void store_teams_wait(Store *s) { barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE); }
INLINE Answer store_answer(Store *s, uint team) { return s->cell->answer[team]; }
INLINE void store_set_answer(Store *s, Answer answer) {
    if (s->lane == 0u) {
        s->cell->answer[s->team] = answer;
        s->cell->noted[s->team] = s->exact;
    }
}
INLINE uint store_tied(Store *s, uint team, uint i) { return s->cell->candidate[(team * MOST_CANDIDATES) + i]; }
INLINE uint store_first_says(Store *s, uint what) {
    CELL_SPACE Cell *cell = s->cell;
    if (IS_FIRST_TEAM) {
        for (uint team = 1; team < TEAMS; team++) {
            s->exact |= cell->noted[team];
        }
        if (s->lane == 0u) {
            cell->said = what;
            cell->said_planes = s->planes;
            cell->said_vertices = s->vertices;
        }
    }
    store_teams_wait(s);
    s->planes = lanes_alike(cell->said_planes);
    s->vertices = lanes_alike(cell->said_vertices);
    return lanes_alike(cell->said);
}
#endif

#if SEARCHES_TREE
INLINE uint store_open_block(Store *s, uint i) { return s->cell->open[OF_TEAM(MOST_OPEN) + i]; }
INLINE uint store_leaf(Store *s, uint i) { return s->cell->leaf[OF_TEAM(MOST_LEAVES) + i]; }
#if KEEPS_KEYS
INLINE uint store_open_key(Store *s, uint i) { return s->cell->open_key[OF_TEAM(MOST_OPEN) + i]; }
INLINE uint store_leaf_key(Store *s, uint i) { return s->cell->leaf_key[OF_TEAM(MOST_LEAVES) + i]; }
INLINE void store_set_open_block(Store *s, uint i, uint block, uint key, uint asks) {
    s->cell->open[OF_TEAM(MOST_OPEN) + i] = block;
    s->cell->open_key[OF_TEAM(MOST_OPEN) + i] = key;
}
INLINE void store_set_leaf(Store *s, uint i, uint leaf, uint key, uint asks) {
    s->cell->leaf[OF_TEAM(MOST_LEAVES) + i] = leaf;
    s->cell->leaf_key[OF_TEAM(MOST_LEAVES) + i] = key;
}
#else
INLINE uint store_open_key(Store *s, uint i) { return 0u; }
INLINE uint store_leaf_key(Store *s, uint i) { return 0u; }
INLINE void store_set_open_block(Store *s, uint i, uint block, uint key, uint asks) { s->cell->open[i] = block; }
INLINE void store_set_leaf(Store *s, uint i, uint leaf, uint key, uint asks) { s->cell->leaf[i] = leaf; }
#endif
INLINE uint store_candidate(Store *s, uint i) { return s->cell->candidate[OF_TEAM(MOST_CANDIDATES) + i]; }
INLINE uint store_candidate_key(Store *s, uint i) { return s->cell->candidate_key[i]; }
// (Only the first team looks at keys.)
INLINE void store_set_candidate(Store *s, uint i, uint site, uint key) {
    s->cell->candidate[OF_TEAM(MOST_CANDIDATES) + i] = site;
    if (IS_FIRST_TEAM) {
        s->cell->candidate_key[i] = key;
    }
}

INLINE uint store_settled(Store *s, uint v) { return s->cell->triplet[v] & SETTLED; }
INLINE void store_set_settled(Store *s, uint v, uint settled) {
    if (s->lane == 0u) {
        const uint triplet = s->cell->triplet[v] & ~SETTLED;
        s->cell->triplet[v] = (settled != 0u) ? (triplet | SETTLED) : triplet;
    }
}

INLINE void store_settle_own(Store *s, uint v) { s->cell->triplet[v] |= SETTLED; }

INLINE uint store_fine_position(Store *s, uint v, V3 *position, real *radius) {
    const Triplet t = store_triplet(s, v);
#if WITH_EXACT
    return find_vertex(s, t, position, radius);
#else
    if (find_vertex_closely(s, t, FINE_ENOUGH, position, radius) == COMPLETE) {
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
#if CUTS_OUTSIDE
    Store copy = *s;
    const uint status = lanes_alike(cap_together(&copy, radius));
    take_over(s, &copy);
    return status;
#else
    // (What cuts it off is in other stages, CUTS_OUTSIDE.)
    return BEYOND;
#endif
#else
    return UNTOUCHED;
#endif
}

#import "generated/tree_search.cl"

#if WITH_FAR && (WITH_EXACT || WITH_TABLE)
// (Few cells come to it: a function of its own, so that it does not take registers from all.)
OUTLINE uint complete_by_vertices(Store *given, uint *visited) {
    Store store = taken_store(given);
    const uint status = search_far(&store, vantage_of(&store).center, 1u, visited);
    return give_back(given, &store, (status == UNCERTAIN) ? UNSETTLED : status);
}
#endif

#if KEEPS_FAR && !WITH_SWEEP
// Keeps for other cells which sites bound this one that reach at least `above`, as far as there is room.
INLINE void keep_far(Store *s, V3 slope, real above, __global uint *kept) {
    uint count = 0;
    for (uint from = 0; from < s->planes; from += LANES) {
        const uint f = from + s->lane;
        const uint site = (f < s->planes) ? s->cell->source[f] : TAG_BOX;
        const bool is_far = (site < TAG_BOX) && (reach_of_site(s, slope, site) >= above);
        const uint all = lanes_with(is_far);
        const uint at = count + popcount(all & ((1u << s->lane) - 1u));
        if (is_far && (at < (MOST_KEPT - 1u))) {
            kept[1u + at] = site;
        }
        count += popcount(all);
    }
    if (s->lane == 0u) {
        kept[0] = min(count, MOST_KEPT - 1u);
    }
}
#endif

// Cuts the cell by all sites that can cut it: `COMPLETE`, `EMPTY`, `LEFT`, `OPEN` or `BEYOND`; WITH_SWEEP `BATCH_FULL` where it is given up, for the same list. `above` becomes
// the square of twice the radius within which no other site can cut it than those that were near, 0 where that was not found.
INLINE uint complete_by_tree(Store *s, Vantage vantage, uint *visited, float *extent, real *above) {
    uint status = UNTOUCHED;
#if GOES_ON
    if (IS_FIRST_TEAM) {
        // (One place that searches, for the text's size.)
        ROLLED
        for (uint what = s->next; (what <= ((WITH_SWEEP != 0) ? SWEEP : KEPT)) && (status == UNTOUCHED); what++) {
            if (what == KEPT) {
                settle_near(s, vantage.center, *above);
            }
            // (So that the compiler knows it where nothing is swept.)
            const uint known = ((WITH_SWEEP != 0) || (what == NEAR)) ? what : KEPT;
            status = search_from(s, vantage, known, visited, above);
            s->next = (status == UNTOUCHED) ? (what + 1u) : s->next;
        }
    }
#else
    if (IS_FIRST_TEAM) {
        status = search_from(s, vantage, NEAR, visited, above);
#if KEEPS_BEGUN
        s->next = (status == UNTOUCHED) ? KEPT : NEAR;
#endif
#if WITH_FAR
        if (status == UNTOUCHED) {
            settle_near(s, vantage.center, *above);
        }
#endif
    }
#endif
#if WITH_SWEEP
    status = (status == UNTOUCHED) ? BATCH_FULL : ((status == UNCERTAIN) ? OPEN : status);
#else
    status = store_first_says(s, status);
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
#endif
    if (IS_FIRST_TEAM) {
        *extent = extent_of(farthest_of(s));
    }
    return status;
}
#endif
