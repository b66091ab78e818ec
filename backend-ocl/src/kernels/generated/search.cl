// Generated from core/src/cell/search.rs by `cargo xtask codegen`; do not edit.

// From where the cell of a store is searched: its home, as if half the slope led to it; or else the slope and the curvature of the weights of the
// sites around its own.
HOT Vantage vantage_of(Store *s) {
    Vantage vantage = (Vantage){ .slope = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .center = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .lambda = REAL(0.5), .home = HOME_UNKNOWN };
    V3 place = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    vantage.home = store_home(s, &place);
    if (vantage.home == HOME_KNOWN) {
        vantage.center = place;
        vantage.slope = scale(-REAL(2.0), place);
        return vantage;
    }
    if (!store_has_weights(s)) {
        return vantage;
    }
    const uint level = level_of_block(store_top_level(s));
    const uint node = block_of_site(store_top_level(s), store_own_site(s));
    const NodeBox bounds = store_node_box(s, level, node);
    const NodeWeights weights = store_node_weights(s, level, node);
    const V3 way = sub(store_site(s), scale(REAL(0.5), add(bounds.lo, bounds.hi)));
    const V3 q = v3(smaller(weights.curvature.x, MOST_CURVATURE), smaller(weights.curvature.y, MOST_CURVATURE), smaller(weights.curvature.z, MOST_CURVATURE));
    const real most = larger(larger(larger(q.x, q.y), q.z), REAL(0.0));
    vantage.slope = add(weights.slope, scale(REAL(2.0), v3(q.x * way.x, q.y * way.y, q.z * way.z)));
    vantage.center = scale(-REAL(0.5), vantage.slope);
    vantage.lambda = REAL(0.5) * (REAL(1.0) - most);
    return vantage;
}

// The size of what is around the site: some three distances between sites.
INLINE real size_around(Store *s) {
    const uint leaf = store_own_site(s) / WIDTH;
    const NodeBox own = store_node_box(s, 0, leaf);
    const V3 extent = sub(own.hi, own.lo);
    real size = REAL(0.8) * sqrt(v3_dot(extent, extent));
    if (store_top_level(s) > 0) {
        const NodeBox block = store_node_box(s, 1, leaf / WIDTH);
        const V3 around = sub(block.hi, block.lo);
        size = larger(size, REAL(0.4) * sqrt(v3_dot(around, around)));
    }
    return size;
}

// Cuts the cell by the sites that it reaches (`what` is `NEAR`): `COMPLETE`, as it may be when those near have cut it; `UNTOUCHED` where that is not worth while; or how it ended. By those that are `KEPT`: `UNTOUCHED`, or how
// it ended. By all that can cut it at a vertex that is not settled (`SWEEP`): as the first.
//
// Near, first come all sites near, then the rest; each time nearest first, as far as there is room for candidates. Were a cell cut by those of its
// own leaf's block before, one at the block's edge would be open to the other side, and be tried with all that there is.
//
// `proven` then becomes the square of twice the radius about the vantage's center within which no other site can cut the cell.
HOT uint search_near(Store *s, Vantage vantage, uint what, uint *visited, real *proven) {
    real near = REAL(0.0);
    Wanted wanted = (Wanted){ .above = 0, .below = NO_SITE };
    Open open = (Open){ .blocks = 0, .leaves = 0 };
    uint count = 0;
    uint most_leaves = MOST_NEAR_LEAVES;
    uint most_sites = MOST_NEAR_SITES;
    if (what == NEAR) {
        *proven = REAL(0.0);
        wanted.below = near_key(s, vantage, &near);
        open = open_path(s);
    } else if (what == SWEEP) {
        open = open_top(s, 0);
        most_leaves = MOST_SWEPT_LEAVES;
        most_sites = *visited + MOST_SWEPT_SITES;
    }
    float reach = store_square_of_reach(s, vantage.center);
    bool is_rest = 0;
    bool sweeps = 0;
    uint looked = 0;
    uint gathered = 0;
    const bool checks = (what != NEAR) || store_checks_near(s);
    for (;;) {
        const bool is_batch = (open.leaves >= LEAVES_AT_ONCE) || ((open.leaves > 0) && (open.blocks == 0));
        if (is_batch && ((count + (LEAVES_AT_ONCE * WIDTH)) <= MOST_CANDIDATES)) {
            uint some = LEAVES_AT_ONCE;
            if (open.leaves < some) {
                some = open.leaves;
            }
            open.leaves -= some;
            uint limit = wanted.below;
            if (what == NEAR) {
                limit = key_limit(s, reach, limit);
            }
            count = gather(s, vantage, open.leaves, some, (Wanted){ .above = wanted.above, .below = limit }, count);
            looked += some;
            if (looked > most_leaves) {
                return UNTOUCHED;
            }
        } else if (!is_batch && (open.blocks > 0)) {
            real within = reach;
            if (!is_rest) {
                within = smaller(reach, near);
            }
            const Question question = (Question){ .square = REAL(1.0) - vantage.lambda, .slope = vantage.slope, .limit = ((REAL(0.25) * within) / vantage.lambda) * SAFE, .vertices = 0, .sweeps = (what == SWEEP) || sweeps, .opens_own = what == SWEEP };
            open = open_blocks(s, question, open);
        } else if (count > 0) {
            const uint status = visit_candidates(s, vantage.center, count, wanted.below, checks, &reach, visited);
            if (status != UNTOUCHED) {
                return status;
            }
            store_lanes_wait(s);
            count = 0;
            if ((what != SWEEP) && checks) {
                reach = store_square_of_reach(s, vantage.center);
            }
            if (*visited > most_sites) {
                return UNTOUCHED;
            }
        } else if ((what == NEAR) && !is_rest) {
            if (near > LEAST_TO_SHARE) {
                *proven = SHARE_OF_KEY * near;
            }
            if (store_has_domain(s)) {
                const uint status = store_cut_outside(s, size_around(s) + sqrt(v3_dot(vantage.center, vantage.center)));
                if ((status != UNTOUCHED) && (status != CUT)) {
                    return status;
                }
                reach = store_square_of_reach(s, vantage.center);
            }
            if (reach <= *proven) {
                return COMPLETE;
            }
            if (reach > (FAR_SQUARE * near)) {
                const uint few = store_leaves_if_far(s);
                if (few == 0) {
                    return UNTOUCHED;
                }
                if ((looked + few) < most_leaves) {
                    most_leaves = looked + few;
                }
            }
            is_rest = 1;
            sweeps = store_is_swept(s) && (reach > (SWEPT_SQUARE * near));
            if (sweeps) {
                settle_near(s, vantage.center, *proven);
            }
            wanted.above = wanted.below;
            wanted.below = NO_SITE;
            open = open_path(s);
        } else if (what == KEPT) {
            if (gathered == store_kept_count(s)) {
                return UNTOUCHED;
            }
            uint some = store_kept_count(s) - gathered;
            if (some > KEPT_AT_ONCE) {
                some = KEPT_AT_ONCE;
            }
            count = gather_kept(s, vantage, gathered, some, key_limit(s, reach, NO_SITE));
            gathered += some;
        } else {
            return COMPLETE;
        }
    }
}

// The key below which sites are near; all that have one have a `reach_of_site` below `near`.
HOT uint near_key(Store *s, Vantage vantage, real *near) {
    const Wanted all = (Wanted){ .above = 0, .below = NO_SITE };
    const Open open = open_path(s);
    uint leaves = open.leaves;
    uint count = 0;
    while (leaves > 0) {
        uint some = LEAVES_AT_ONCE;
        if (leaves < some) {
            some = leaves;
        }
        leaves -= some;
        count = gather(s, vantage, leaves, some, all, count);
    }
    uint last = store_own_site(s);
    uint turn = 0;
    while ((turn < NEAR_SITES) && (turn < count)) {
        const Held held = nearest_held(s, count);
        last = take_held(s, held, store_least_of_lanes(s, held.key));
        turn += 1;
    }
    if (turn == 0) {
        return 0;
    }
    const real square = NEAR_SQUARE * larger(reach_of_site(s, vantage.slope, last), REAL(0.0));
    *near = (ROOM_OF_KEY * square) + LEAST_OF_KEY;
    return store_key_below(s, square) + 1;
}

// Adds those sites of some leaves at hand that are wanted to the candidates, of which there are `count`; returns how many there are now.
HOT uint gather(Store *s, Vantage vantage, uint first, uint leaves, Wanted wanted, uint count) {
    uint there = count;
    uint i = store_lane(s);
    while ((i - store_lane(s)) < (leaves * WIDTH)) {
        uint j = NO_SITE;
        if (i < (leaves * WIDTH)) {
            j = (store_leaf(s, first + (i / WIDTH)) * WIDTH) + (i & (WIDTH - 1));
        }
        uint key = NO_SITE;
        bool is_wanted = 0;
        if ((j < store_sites(s)) && (j != store_own_site(s))) {
            key = store_key_below(s, reach_of_site(s, vantage.slope, j));
            is_wanted = (key >= wanted.above) && (key < wanted.below);
        }
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
