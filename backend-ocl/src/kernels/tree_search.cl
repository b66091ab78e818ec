// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "tree_store.cl"
#import "candidates.cl"

INLINE void add_least(real lo, real hi, real alpha, real g, real slope, real curvature, real *sum, real *size);
INLINE real polynomial_at(real t, real m, real alpha, real g, real slope, real curvature);
INLINE real gap_along(real lo, real hi, real place);
INLINE real square_to_box(V3 lo, V3 hi, V3 place);
INLINE real least_weighted(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights);
INLINE real least_of_node(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights);
INLINE real least_power_of_node(Seer seer, V3 v, NodeBox bounds, NodeSlab slab, NodeWeights weights);
INLINE real reach_of_bisector(V3 g, V3 d, real excess);
INLINE Seer seer_of(Store *s);
INLINE Open open_top(Store *s, uint vertices);
INLINE Open open_path(Store *s);
INLINE uint keep_asked(Store *s, bool is_leaf, uint vertices, uint count);
INLINE Open still_asked(Store *s, uint vertices, Open open);
INLINE uint asks_by_powers(Store *s, uint level, uint node, uint of_block, uint *key);
HOT Open open_blocks(Store *s, Question question, Open given);
HOT Vantage vantage_of(Store *s);
INLINE real reach_of_site(Store *s, Vantage vantage, uint j);
INLINE real size_around(Store *s);
HOT uint search_near(Store *s, Vantage vantage, uint *visited);
HOT uint near_key(Store *s, Vantage vantage, real *near);
HOT uint gather(Store *s, Vantage vantage, uint first, uint leaves, Wanted wanted, uint count);
HOT uint search_far(Store *s, V3 center, uint first_asked, uint *visited);
HOT uint next_unsettled(Store *s, V3 from, real sign, uint *key);
HOT uint ask_near_first(Store *s, uint at_once);
INLINE uint ask(Store *s, uint v, uint i);
INLINE Asked asked_at(real largest_excess, uint v, V3 place, real radius);
HOT uint least_at(Store *s, uint asked, uint *ties, uint *stay);
INLINE uint ask_site(Store *s, uint j, uint asks, uint left, uint *found, uint *ties);
INLINE uint larger_count(uint a, uint b);

// core/src/cell/search_store.rs

// core/src/cell/quadratic.rs

// Adds the least of `αt² + gt − (G + Q(t − m))(t − m)` for t from `lo` to `hi`, and the size of its terms. It is where the slope
// is 0, if that is a minimum, and else at an end.
INLINE void add_least(real lo, real hi, real alpha, real g, real slope, real curvature, real *sum, real *size) {
    const real m = REAL(0.5) * (lo + hi);
    const real width = hi - m;
    const real bend = alpha - curvature;
    const real still = ((REAL(0.5) * (slope - g)) - (curvature * m)) / bend;
    const real t = smaller(larger(still, lo), hi);
    real least = polynomial_at(t, m, alpha, g, slope, curvature);
    if (!(bend > REAL(0.0))) {
        least = smaller(polynomial_at(lo, m, alpha, g, slope, curvature), polynomial_at(hi, m, alpha, g, slope, curvature));
    }
    const real far = fabs(m) + width;
    *sum += least;
    // (Seen from afar a small box is narrower than the rounding of where it is, by as much of which its weights may differ.)
    const real steep = fabs(slope) + ((REAL(2.0) * fabs(curvature)) * width);
    *size += ((((alpha * far) + fabs(g)) * far) + (steep * far));
}

INLINE real polynomial_at(real t, real m, real alpha, real g, real slope, real curvature) {
    const real u = t - m;
    return (((alpha * t) + g) * t) - ((slope + (curvature * u)) * u);
}

// core/src/cell/bound.rs

// How far `place` is from the range `[lo, hi]`, at least.
INLINE real gap_along(real lo, real hi, real place) {
    const real rounding = (REAL(16.0) * UNIT_ROUNDOFF) * (fabs(place) + larger(fabs(lo), fabs(hi)));
    return larger(larger(lo - place, place - hi) - rounding, REAL(0.0));
}

// The square of how far `place` is from the box `[lo, hi]`, at least.
INLINE real square_to_box(V3 lo, V3 hi, V3 place) {
    const real x = gap_along(lo.x, hi.x, place.x);
    const real y = gap_along(lo.y, hi.y, place.y);
    const real z = gap_along(lo.z, hi.z, place.z);
    return ((x * x) + (y * y)) + (z * z);
}

// The least of `αd² + g·d − w` of weights that differ, at any site of a node.
INLINE real least_weighted(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights) {
    const V3 lo = sub(bounds.lo, seer.site);
    const V3 hi = sub(bounds.hi, seer.site);
    real sum = seer.excess - weights.offset;
    real size = seer.excess + fabs(weights.offset);
    add_least(lo.x, hi.x, alpha, g.x, weights.slope.x, weights.curvature.x, &sum, &size);
    add_least(lo.y, hi.y, alpha, g.y, weights.slope.y, weights.curvature.y, &sum, &size);
    add_least(lo.z, hi.z, alpha, g.z, weights.slope.z, weights.curvature.z, &sum, &size);
    return sum - (FEW_ROUNDINGS_OF_SUM * size);
}

// The least of `αd² + g·d − w` at any site of a node; without weights there is no g.
INLINE real least_of_node(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights) {
    if (seer.has_weights == 0) {
        const V3 lo = sub(bounds.lo, seer.site);
        const V3 hi = sub(bounds.hi, seer.site);
        return (alpha * square_to_box(lo, hi, v3(REAL(0.0), REAL(0.0), REAL(0.0)))) * (REAL(1.0) - FEW_ROUNDINGS_OF_SUM);
    }
    return least_weighted(seer, alpha, g, bounds, weights);
}

// The least power `|d − v|² − w` at the place `v` of any site of a node.
//
// With `h` at most the gap between `v` and the node's slab, across its normal `n`, `|v − p|² ≥ h² + |(v − hn) − p|²`: the box is seen from the
// foot of `v` on the slab, unless weights differ, when that often says less (c = 0.9 took 30 times as long on far cells).
INLINE real least_power_of_node(Seer seer, V3 v, NodeBox bounds, NodeSlab slab, NodeWeights weights) {
    const V3 site = seer.site;
    const V3 from = v3(site.x + v.x, site.y + v.y, site.z + v.z);
    const real height = v3_dot(slab.normal, from);
    const real rounding = FEW_ROUNDINGS_OF_SUM * ((fabs(from.x) + fabs(from.y)) + fabs(from.z));
    const real across = larger((height - slab.hi) - rounding, REAL(0.0)) - larger((slab.lo - height) - rounding, REAL(0.0));
    const real beyond = (across * across) * (REAL(1.0) - FEW_ROUNDINGS_OF_SUM);
    if (seer.has_weights == 0) {
        const V3 foot = sub(v, scale(across, slab.normal));
        const real square = square_to_box(sub(bounds.lo, site), sub(bounds.hi, site), foot);
        return (square + beyond) * (REAL(1.0) - FEW_ROUNDINGS_OF_SUM);
    }
    // |d − v|² is d² − 2v·d and v².
    const real own = v3_dot(v, v);
    const real least = own + least_weighted(seer, REAL(1.0), scale(-REAL(2.0), v), bounds, weights);
    const real across_slab = (beyond - (slab.largest - seer.excess)) - (FEW_ROUNDINGS_OF_SUM * (fabs(slab.largest) + seer.excess));
    return larger(least - (FEW_ROUNDINGS_OF_SUM * own), across_slab);
}

// Four times the square of the distance from the cell's centre to the bisector with a site, at least, where the centre is on the own side, and
// else below 0: `(h_j − h_i)²/d²` (see `search.rs`), of weights that differ with the slope `g` at the cell's site.
INLINE real reach_of_bisector(V3 g, V3 d, real excess) {
    const real square = v3_dot(d, d);
    const V3 along = v3(g.x * d.x, g.y * d.y, g.z * d.z);
    const real size = square + (fabs(excess) + ((fabs(along.x) + fabs(along.y)) + fabs(along.z)));
    const real power = ((square - excess) + ((along.x + along.y) + along.z)) - (FEW_ROUNDINGS_OF_SUM * size);
    return (power * fabs(power)) / square;
}

// core/src/cell/tree.rs

// The site whose cell is searched.
INLINE Seer seer_of(Store *s) {
    return (Seer){ .site = store_site(s), .excess = store_own_excess(s), .has_weights = store_has_weights(s) };
}

// Opens, for some asked vertices, the lowest level of which the lanes take all blocks at one time: the root, where there is one lane.
INLINE Open open_top(Store *s, uint vertices) {
    uint level = store_top_level(s);
    uint blocks = 1;
    // (A level has eight times as many nodes, so at most eight times as many blocks.)
    const uint last = (store_sites(s) - 1) / (WIDTH * WIDTH);
    while ((level > 0) && (((last >> (3 * (level - 1))) * WIDTH) < store_lanes(s))) {
        level -= 1;
        blocks = (last >> (3 * level)) + 1;
    }
    if (store_lane(s) < blocks) {
        store_set_open_block(s, store_lane(s), (level << LEVEL_SHIFT) | store_lane(s), 0, vertices);
    }
    store_lanes_wait(s);
    return (Open){ .blocks = blocks, .leaves = 0 };
}

// Opens the blocks that hold the cell's own site, but for that of its leaf, whose leaves are at hand: the nearest last.
INLINE Open open_path(Store *s) {
    const uint own = store_own_site(s) / (WIDTH * WIDTH);
    Open open = (Open){ .blocks = 0, .leaves = 0 };
    uint level = store_top_level(s);
    while (level > 0) {
        store_set_open_block(s, open.blocks, (level << LEVEL_SHIFT) | (own >> (3 * level)), 0, 0);
        open.blocks += 1;
        level -= 1;
    }
    const uint first = own * WIDTH;
    while ((open.leaves < WIDTH) && (((first + open.leaves) * WIDTH) < store_sites(s))) {
        store_set_leaf(s, open.leaves, first + open.leaves, 0, 0);
        open.leaves += 1;
    }
    store_lanes_wait(s);
    return open;
}

// Keeps of the open blocks, or of the leaves at hand, those where one of some vertices is still asked for, of the first alone only where the least
// power is below its limit; returns how many of the `count` are left.
INLINE uint keep_asked(Store *s, bool is_leaf, uint vertices, uint count) {
    const uint limit = store_key_above(s, store_asked(s, 0).limit);
    uint kept = 0;
    uint i = store_lane(s);
    while ((i - store_lane(s)) < count) {
        uint number = 0;
        uint key = NO_SITE;
        uint asks = 0;
        if (i < count) {
            if (is_leaf) {
                number = store_leaf(s, i);
                key = store_leaf_key(s, i);
                asks = store_leaf_asks(s, i) & vertices;
            } else {
                number = store_open_block(s, i);
                key = store_open_key(s, i);
                asks = store_open_asks(s, i) & vertices;
            }
        }
        const bool is_kept = (asks > 1) || ((asks == 1) && (key <= limit));
        const uint all = store_lanes_with(s, (uint)is_kept);
        store_lanes_wait(s);
        if (is_kept) {
            if (is_leaf) {
                store_set_leaf(s, kept + store_rank_in(s, all), number, key, asks);
            } else {
                store_set_open_block(s, kept + store_rank_in(s, all), number, key, asks);
            }
        }
        kept += store_count_of(s, all);
        i += store_lanes(s);
    }
    store_lanes_wait(s);
    return kept;
}

// What of it is still asked for, some vertices being left, where the first one's limit is less than before or a vertex is not asked for any more.
INLINE Open still_asked(Store *s, uint vertices, Open open) {
    return (Open){ .blocks = keep_asked(s, 0, vertices, open.blocks), .leaves = keep_asked(s, 1, vertices, open.leaves) };
}

// Those of some asked vertices, a bit each, at which a site of a node may have a power below their limit; and the key of the least of those.
INLINE uint asks_by_powers(Store *s, uint level, uint node, uint of_block, uint *key) {
    uint asks = 0;
    uint least = NO_SITE;
    uint rest = of_block;
    uint i = 0;
    while (rest != 0) {
        if ((rest & 1) != 0) {
            const Asked its = store_asked(s, i);
            const real power = least_power_of_node(seer_of(s), its.place, store_node_box(s, level, node), store_node_slab(s, level, node), store_node_weights(s, level, node));
            if (power < its.limit) {
                asks = asks | (1 << i);
                const uint its_key = store_key_below(s, power);
                if (its_key < least) {
                    least = its_key;
                }
            }
        }
        rest = rest >> 1;
        i += 1;
    }
    *key = least;
    return asks;
}

// Puts the children of the last open blocks, as many as there are lanes for, in the place of these, where a question can come to less than its
// limit there; leaves to those at hand. Without the nodes that hold the site's own leaf's block, where no vertex is asked for; else the least
// of the blocks is the last.
HOT Open open_blocks(Store *s, Question question, Open given) {
    Open open = given;
    const uint lanes = store_lanes(s);
    uint some = 1;
    if ((lanes > WIDTH) && (open.blocks <= FEW_OPEN)) {
        some = lanes / WIDTH;
        if (some > open.blocks) {
            some = open.blocks;
        }
    }
    open.blocks -= some;
    const uint turn = store_lane(s) / WIDTH;
    uint is_there = 0;
    uint block = 0;
    uint of_block = 0;
    if (turn < some) {
        is_there = 1;
        block = store_open_block(s, open.blocks + turn);
        of_block = store_open_asks(s, open.blocks + turn);
    }
    store_lanes_wait(s);
    const uint level = block >> LEVEL_SHIFT;
    const uint first = (block & BLOCK_MASK) * WIDTH;
    // Of the nodes of the level, that which holds the own leaf's block.
    uint own = 0xFFFFFFFF;
    if (question.vertices == 0) {
        own = (store_own_site(s) / WIDTH) >> (3 * level);
    }
    uint best = NO_SITE;
    uint best_at = 0;
    uint k = store_lane(s) & (WIDTH - 1);
    while (k < WIDTH) {
        const uint node = first + k;
        uint is_wanted = 0;
        uint key = 0;
        uint asks = 0;
        if ((is_there != 0) && (node != own)) {
            if (question.vertices != 0) {
                asks = store_asks_of_node(s, level, node, of_block, &key);
                is_wanted = (uint)(asks != 0);
            } else {
                const real least = least_of_node(seer_of(s), question.square, question.slope, store_node_box(s, level, node), store_node_weights(s, level, node));
                is_wanted = (uint)(least < question.limit);
            }
        }
        uint is_block = is_wanted;
        uint is_leaf = 0;
        if (level == 0) {
            is_block = 0;
            is_leaf = is_wanted;
        }
        const uint blocks = store_lanes_with(s, is_block);
        const uint leaves = store_lanes_with(s, is_leaf);
        if (is_block != 0) {
            const uint at = open.blocks + store_rank_in(s, blocks);
            store_set_open_block(s, at, ((level - 1) << LEVEL_SHIFT) | node, key, asks);
            if (key < best) {
                best = key;
                best_at = at;
            }
        }
        if (is_leaf != 0) {
            store_set_leaf(s, open.leaves + store_rank_in(s, leaves), node, key, asks);
        }
        open.blocks += store_count_of(s, blocks);
        open.leaves += store_count_of(s, leaves);
        k += lanes;
    }
    store_lanes_wait(s);
    // (Few are all opened next.)
    if ((question.vertices != 0) && ((open.blocks * WIDTH) > lanes)) {
        const uint least = store_least_of_lanes(s, best);
        if (least != NO_SITE) {
            const uint at = store_lane_value(s, best_at, store_first_of(s, store_lanes_with(s, (uint)(best == least))));
            const uint last = open.blocks - 1;
            const uint nearest = store_open_block(s, at);
            const uint other = store_open_block(s, last);
            const uint other_key = store_open_key(s, last);
            const uint nearest_asks = store_open_asks(s, at);
            const uint other_asks = store_open_asks(s, last);
            store_lanes_wait(s);
            if (store_lane(s) == 0) {
                store_set_open_block(s, at, other, other_key, other_asks);
                store_set_open_block(s, last, nearest, least, nearest_asks);
            }
            store_lanes_wait(s);
        }
    }
    return open;
}

// core/src/cell/search.rs

// From where the cell of a store is searched: the slope and the curvature of the weights of the sites around its own.
HOT Vantage vantage_of(Store *s) {
    Vantage vantage = (Vantage){ .slope = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .center = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .lambda = REAL(0.5) };
    if (store_has_weights(s) == 0) {
        return vantage;
    }
    // The leaf's block, where the tree has more than one.
    uint level = 1;
    if (store_top_level(s) == 0) {
        level = 0;
    }
    const uint node = (store_own_site(s) / WIDTH) >> (3 * level);
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

// What `reach_of_bisector` says of site `j`.
INLINE real reach_of_site(Store *s, Vantage vantage, uint j) {
    const V3 d = store_way_to(s, j);
    if (store_has_weights(s) == 0) {
        return v3_dot(d, d);
    }
    return reach_of_bisector(vantage.slope, d, store_excess_of(s, j));
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

// Cuts the cell by the sites that it reaches: `COMPLETE`; `UNTOUCHED` where that is not worth while; or how it ended.
//
// First come all sites near, then the rest; each time nearest first, as far as there is room for candidates. Were a cell cut by those of its
// own leaf's block before, one at the block's edge would be open to the other side, and be tried with all that there is.
HOT uint search_near(Store *s, Vantage vantage, uint *visited) {
    real near = REAL(0.0);
    Wanted wanted = (Wanted){ .above = 0, .below = near_key(s, vantage, &near) };
    float reach = store_square_of_reach(s, vantage.center);
    uint is_rest = 0;
    Open open = open_path(s);
    uint looked = 0;
    uint count = 0;
    for (;;) {
        const bool is_batch = (open.leaves >= LEAVES_AT_ONCE) || ((open.leaves > 0) && (open.blocks == 0));
        if (is_batch && ((count + (LEAVES_AT_ONCE * WIDTH)) <= MOST_CANDIDATES)) {
            uint some = LEAVES_AT_ONCE;
            if (open.leaves < some) {
                some = open.leaves;
            }
            open.leaves -= some;
            const uint limit = key_limit(s, reach, wanted.below);
            count = gather(s, vantage, open.leaves, some, (Wanted){ .above = wanted.above, .below = limit }, count);
            looked += some;
            if (looked > MOST_NEAR_LEAVES) {
                return UNTOUCHED;
            }
        } else if (!is_batch && (open.blocks > 0)) {
            real within = reach;
            if (is_rest == 0) {
                within = smaller(reach, near);
            }
            const Question question = (Question){ .square = REAL(1.0) - vantage.lambda, .slope = vantage.slope, .limit = ((REAL(0.25) * within) / vantage.lambda) * SAFE, .vertices = 0 };
            open = open_blocks(s, question, open);
        } else if (count > 0) {
            const uint status = visit_candidates(s, vantage.center, count, wanted.below, &reach, visited);
            if (status != UNTOUCHED) {
                return status;
            }
            store_lanes_wait(s);
            count = 0;
            if (*visited > MOST_NEAR_SITES) {
                return UNTOUCHED;
            }
        } else if (is_rest == 0) {
            if (store_has_domain(s) != 0) {
                const uint status = store_cut_outside(s, size_around(s) + sqrt(v3_dot(vantage.center, vantage.center)));
                if ((status != UNTOUCHED) && (status != CUT)) {
                    return status;
                }
                reach = store_square_of_reach(s, vantage.center);
            }
            if (reach > (FAR_SQUARE * near)) {
                return UNTOUCHED;
            }
            is_rest = 1;
            wanted.above = wanted.below;
            wanted.below = NO_SITE;
            open = open_path(s);
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
    const real square = NEAR_SQUARE * larger(reach_of_site(s, vantage, last), REAL(0.0));
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
        uint is_wanted = 0;
        if ((j < store_sites(s)) && (j != store_own_site(s))) {
            key = store_key_below(s, reach_of_site(s, vantage, j));
            if ((key >= wanted.above) && (key < wanted.below)) {
                is_wanted = 1;
            }
        }
        const uint all = store_lanes_with(s, is_wanted);
        if (is_wanted != 0) {
            store_set_candidate(s, there + store_rank_in(s, all), j, key);
        }
        there += store_count_of(s, all);
        i += store_lanes(s);
    }
    store_lanes_wait(s);
    return there;
}

// core/src/cell/far.rs

// Completes the cell by its vertices, none of which is settled: `COMPLETE`, or how it ended; `UNCERTAIN` where more sites than there is room for
// are within rounding of a vertex, or a vertex is not known well. The farthest from `center` come first; so many are asked for at once at first,
// more where one stays, as others will, and one where one is cut off, which wastes what was asked for others.
HOT uint search_far(Store *s, V3 center, uint first_asked, uint *visited) {
    uint at_once = first_asked;
    for (;;) {
        // The farthest.
        uint key = 0;
        const uint v = next_unsettled(s, center, -REAL(1.0), &key);
        if (v == NO_SITE) {
            return COMPLETE;
        }
        if (ask(s, v, 0) == 0) {
            return UNCERTAIN;
        }
        uint asked = 1;
        if (at_once > 1) {
            asked = ask_near_first(s, at_once);
        }
        uint ties = 0;
        uint stay = 0;
        const uint found = least_at(s, asked, &ties, &stay);
        uint i = 1;
        while (i < asked) {
            if ((stay & (1 << i)) != 0) {
                const uint other = store_asked(s, i).vertex;
                store_set_settled(s, other, 1);
            }
            i += 1;
        }
        if (found != NO_SITE) {
            store_set_candidate(s, 0, found, 0);
            ties = 1;
        }
        if (ties > store_most_ties(s)) {
            return UNCERTAIN;
        }
        uint status = UNTOUCHED;
        i = 0;
        while ((i < ties) && (status == UNTOUCHED)) {
            const uint j = store_candidate(s, i);
            if ((found != NO_SITE) || (store_was_tried(s, j) == 0)) {
                *visited += 1;
                status = store_cut_by(s, j);
            }
            i += 1;
        }
        if (((status == UNTOUCHED) && (found != NO_SITE)) && (store_leaves_out(s) == 0)) {
            // What rounding cannot take back has less power there.
            return UNCERTAIN;
        }
        if (status == UNTOUCHED) {
            store_set_settled(s, v, 1);
            store_lanes_wait(s);
            at_once = 2 * at_once;
            if (at_once > store_most_asked(s)) {
                at_once = store_most_asked(s);
            }
        } else if (status == CUT) {
            at_once = 1;
        } else {
            return status;
        }
    }
}

// Of the vertices that are not settled, or of the first that a lane meets, that with the least key above `*key` of its squared distance from a
// place times `sign`, and the key; `NO_SITE` where there is none.
HOT uint next_unsettled(Store *s, V3 from, real sign, uint *key) {
    uint nearest = NO_SITE;
    uint own = 0;
    uint compared = 0;
    uint v = store_lane(s);
    while ((v < store_vertices(s)) && (compared < MOST_COMPARED)) {
        if (!store_settled(s, v)) {
            compared += 1;
            const V3 way = sub(store_position(s, v), from);
            const uint its = store_key_below(s, sign * v3_dot(way, way));
            if ((its > *key) && (its < nearest)) {
                nearest = its;
                own = v;
            }
        }
        v += store_lanes(s);
    }
    const uint least = store_least_of_lanes(s, nearest);
    *key = least;
    if (least == NO_SITE) {
        return NO_SITE;
    }
    return store_lane_value(s, own, store_first_of(s, store_lanes_with(s, (uint)(nearest == least))));
}

// Asks for vertices near the first, nearest first, until so many are asked for; returns how many are.
HOT uint ask_near_first(Store *s, uint at_once) {
    const Asked first = store_asked(s, 0);
    uint asked = 1;
    // (Of vertices as far as another one is asked for.)
    uint key = store_key_above(s, REAL(0.0));
    while (asked < at_once) {
        const uint v = next_unsettled(s, first.place, REAL(1.0), &key);
        if (v == NO_SITE) {
            return asked;
        }
        asked += ask(s, v, asked);
    }
    return asked;
}

// Makes vertex `v` the asked vertex `i`: 1; or 0 where it is not known well.
INLINE uint ask(Store *s, uint v, uint i) {
    V3 place = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real radius = REAL(0.0);
    if (store_fine_position(s, v, &place, &radius) != COMPLETE) {
        return 0;
    }
    const Asked asked = asked_at(store_largest_excess(s), v, place, radius);
    store_set_asked(s, i, asked);
    return 1;
}

// What is asked for at a place that is off by up to `radius` along each axis, of sites that weigh up to `largest_excess` more than the cell's.
INLINE Asked asked_at(real largest_excess, uint v, V3 place, real radius) {
    const real own = v3_dot(place, place);
    const real lost = PER_LENGTH * radius;
    // Beyond this power no site can have less than the cell's: with t the distance from the vertex, rounding is at most
    // lost·(√own + t) + FEW_ROUNDINGS_OF_SUM·(t² + own + …), where 2t ≤ length + t²/length for any length; and t² is the power and the
    // largest weight. (A vertex may be where the cell's site is.)
    const real length = larger(larger(sqrt(own), LENGTHS_OF_LOST * lost), LEAST_LENGTH);
    const real lost_of_square = (REAL(0.5) * lost) / length;
    const real share = lost_of_square + (REAL(4.0) * FEW_ROUNDINGS_OF_SUM);
    const real lost_of_all = (REAL(1.5) * lost) * length;
    const real room = lost_of_all + (share * larger(largest_excess, REAL(0.0)));
    const real limit = ((own * (REAL(1.0) + (REAL(2.0) * FEW_ROUNDINGS_OF_SUM))) + room) * (REAL(1.0) + (REAL(2.0) * share));
    return (Asked){ .vertex = v, .place = place, .own = own, .lost = lost_of_all, .lost_of_square = lost_of_square, .limit = limit };
}

// The site of least power at the first asked vertex, if that is certainly less than the cell's own; else `NO_SITE`, and the candidates are all
// that may be, of which `ties` says how many. `stay` has a bit for each of the others where no site has less power or ties, but for those that
// it lies on.
HOT uint least_at(Store *s, uint asked, uint *ties, uint *stay) {
    const uint lanes = store_lanes(s);
    // As many leaves at a time as there are lanes for their sites.
    const uint most = larger_count(lanes / WIDTH, 1);
    uint left = (1 << asked) - 1;
    uint found = NO_SITE;
    Open open = open_top(s, left);
    *ties = 0;
    for (;;) {
        if ((open.leaves >= most) || ((open.leaves > 0) && (open.blocks == 0))) {
            uint some = most;
            if (open.leaves < some) {
                some = open.leaves;
            }
            open.leaves -= some;
            const real limit = store_asked(s, 0).limit;
            const uint before = left;
            uint i = store_lane(s);
            while (i < larger_count(some * WIDTH, lanes)) {
                uint j = NO_SITE;
                uint asks = 0;
                if (i < (some * WIDTH)) {
                    const uint at = open.leaves + (i / WIDTH);
                    j = (store_leaf(s, at) * WIDTH) + (i & (WIDTH - 1));
                    if (j < store_sites(s)) {
                        asks = store_asks_of_site(s, j, store_leaf_asks(s, at)) & left;
                    }
                    if (j == store_own_site(s)) {
                        asks = 0;
                    }
                }
                if (store_lanes_with(s, asks) != 0) {
                    left = left & ask_site(s, j, asks, left, &found, ties);
                }
                i += lanes;
            }
            store_lanes_wait(s);
            if ((store_asked(s, 0).limit < limit) || (left != before)) {
                open = still_asked(s, left, open);
            }
        } else if (open.blocks > 0) {
            const Question question = (Question){ .square = REAL(1.0), .slope = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .limit = REAL(0.0), .vertices = left };
            open = open_blocks(s, question, open);
        } else {
            *stay = left;
            return found;
        }
    }
}

// Compares the power of each lane's site with the cell's at those of the asked vertices whose bits `asks` has, which are among `left`: `found`,
// the candidates and `ties` as `least_at`; returns all bits but those of vertices other than the first that may not stay.
INLINE uint ask_site(Store *s, uint j, uint asks, uint left, uint *found, uint *ties) {
    uint stay = 0xFFFFFFFF;
    V3 d = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real excess = REAL(0.0);
    if (asks != 0) {
        d = store_way_to(s, j);
        excess = store_excess_of(s, j);
    }
    uint a = 0;
    while ((left >> a) != 0) {
        const Asked its = store_asked(s, a);
        uint is_less = 0;
        uint is_tied = 0;
        real power = REAL(0.0);
        if ((asks & (1 << a)) != 0) {
            const V3 way = sub(its.place, d);
            const real square = v3_dot(way, way);
            const real less = (square - its.own) - excess;
            const real rounding = (its.lost + (its.lost_of_square * square)) + (FEW_ROUNDINGS_OF_SUM * ((square + its.own) + (fabs(excess) + v3_dot(d, d))));
            power = square - excess;
            if (less < -rounding) {
                is_less = 1;
            } else if (less <= rounding) {
                is_tied = 1;
            }
        }
        if (a > 0) {
            uint is_off = 0;
            if (((is_less + is_tied) != 0) && (store_touches(s, its.vertex, j) == 0)) {
                is_off = 1;
            }
            if (store_lanes_with(s, is_off) != 0) {
                stay = stay & (0xFFFFFFFF ^ (1 << a));
            }
        } else {
            if (store_lanes_with(s, is_less) != 0) {
                uint key = NO_SITE;
                if (is_less != 0) {
                    key = store_key_above(s, power);
                }
                const uint least = store_least_of_lanes(s, key);
                const uint from = store_first_of(s, store_lanes_with(s, (uint)(key == least)));
                const real best = store_lane_real(s, power, from);
                if ((*found == NO_SITE) || (best < its.limit)) {
                    *found = store_lane_value(s, j, from);
                    Asked first = its;
                    first.limit = smaller(best, its.limit);
                    store_set_asked(s, 0, first);
                }
            }
            const uint tied = store_lanes_with(s, is_tied);
            if ((*found == NO_SITE) && (tied != 0)) {
                const uint at = *ties + store_rank_in(s, tied);
                if ((is_tied != 0) && (at < store_most_ties(s))) {
                    store_set_candidate(s, at, j, 0);
                }
                *ties += store_count_of(s, tied);
            }
        }
        a += 1;
    }
    return stay;
}

INLINE uint larger_count(uint a, uint b) {
    if (a > b) {
        return a;
    }
    return b;
}
