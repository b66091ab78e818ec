// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "cell.cl"
#import "tree_store.cl"

INLINE void add_least(real lo, real hi, real alpha, real g, real slope, real curvature, real *sum, real *size);
INLINE real polynomial_at(real t, real m, real alpha, real g, real slope, real curvature);
INLINE real gap_along(real lo, real hi, real place);
INLINE real square_to_box(V3 lo, V3 hi, V3 place);
INLINE real least_of_node(Store *s, Question question, uint level, uint node);
INLINE Open open_root(Store *s);
INLINE Open open_path(Store *s);
INLINE uint take_last(Store *s, uint is_leaf, real limit, uint most, uint *count);
HOT Open open_blocks(Store *s, Question question, uint with_own, Open given);
HOT Vantage vantage_of(Store *s);
INLINE real reach_of_site(Store *s, Vantage vantage, uint j);
INLINE real size_around(Store *s);
HOT uint search_near(Store *s, Vantage vantage, uint *visited);
HOT uint near_key(Store *s, Vantage vantage, real *near);
HOT uint gather(Store *s, Vantage vantage, uint first, uint leaves, Wanted wanted, uint count);
INLINE uint take_nearest(Store *s, uint count, uint limit);
HOT uint visit_candidates(Store *s, Vantage vantage, uint count, uint below, real *reach, uint *visited);
INLINE uint key_of_reach(Store *s, real reach, uint below);
HOT uint search_far(Store *s, Vantage vantage, uint *visited);
HOT uint farthest_unsettled(Store *s, Vantage vantage);
HOT uint least_at(Store *s, V3 v, real radius, uint *ties);
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

// core/src/cell/tree.rs

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

// The least that a question can come to at any site of a node.
//
// With `h` at most the gap between `v` and the node's slab, across its normal `n`, `|v − p|² ≥ h² + |(v − hn) − p|²`: the box is seen from the
// foot of `v` on the slab, unless weights differ, when that often says less (c = 0.9 took 30 times as long on far cells).
INLINE real least_of_node(Store *s, Question question, uint level, uint node) {
    const NodeBox bounds = store_node_box(s, level, node);
    const V3 site = store_site(s);
    const V3 lo = sub(bounds.lo, site);
    const V3 hi = sub(bounds.hi, site);
    const V3 place = question.place;
    V3 foot = place;
    real beyond = REAL(0.0);
    real largest = REAL(0.0);
    if (question.is_power != 0) {
        const NodeSlab slab = store_node_slab(s, level, node);
        const V3 from = v3(site.x + place.x, site.y + place.y, site.z + place.z);
        const real height = v3_dot(slab.normal, from);
        const real rounding = FEW_ROUNDINGS_OF_SUM * ((fabs(from.x) + fabs(from.y)) + fabs(from.z));
        const real across = larger((height - slab.hi) - rounding, REAL(0.0)) - larger((slab.lo - height) - rounding, REAL(0.0));
        foot = sub(place, scale(across, slab.normal));
        beyond = (across * across) * (REAL(1.0) - FEW_ROUNDINGS_OF_SUM);
        largest = slab.largest;
    }
    if (store_has_weights(s) == 0) {
        // (Where it is not the power, nothing is beyond.)
        return ((question.square * square_to_box(lo, hi, foot)) + beyond) * (REAL(1.0) - FEW_ROUNDINGS_OF_SUM);
    }
    const NodeWeights weights = store_node_weights(s, level, node);
    const V3 g = sub(question.slope, scale(REAL(2.0), place));
    const real alpha = question.square;
    real sum = v3_dot(place, place);
    real size = sum;
    add_least(lo.x, hi.x, alpha, g.x, weights.slope.x, weights.curvature.x, &sum, &size);
    add_least(lo.y, hi.y, alpha, g.y, weights.slope.y, weights.curvature.y, &sum, &size);
    add_least(lo.z, hi.z, alpha, g.z, weights.slope.z, weights.curvature.z, &sum, &size);
    sum += (store_own_excess(s) - weights.offset);
    size += (store_own_excess(s) + fabs(weights.offset));
    sum = sum - (FEW_ROUNDINGS_OF_SUM * size);
    if (question.is_power != 0) {
        const real rounding = FEW_ROUNDINGS_OF_SUM * (fabs(largest) + store_own_excess(s));
        sum = larger(sum, (beyond - (largest - store_own_excess(s))) - rounding);
    }
    return sum;
}

// Opens the root alone.
INLINE Open open_root(Store *s) {
    store_set_open_block(s, 0, store_top_level(s) << LEVEL_SHIFT, 0);
    store_lanes_wait(s);
    return (Open){ .blocks = 1, .leaves = 0 };
}

// Opens the blocks that hold the cell's own site, but for that of its leaf, whose leaves are at hand: the nearest last.
INLINE Open open_path(Store *s) {
    const uint own = store_own_site(s) / (WIDTH * WIDTH);
    Open open = (Open){ .blocks = 0, .leaves = 0 };
    uint level = store_top_level(s);
    while (level > 0) {
        store_set_open_block(s, open.blocks, (level << LEVEL_SHIFT) | (own >> (3 * level)), 0);
        open.blocks += 1;
        level -= 1;
    }
    const uint first = own * WIDTH;
    while ((open.leaves < WIDTH) && (((first + open.leaves) * WIDTH) < store_sites(s))) {
        store_set_leaf(s, open.leaves, first + open.leaves, 0);
        open.leaves += 1;
    }
    store_lanes_wait(s);
    return open;
}

// Keeps of the last open blocks, or of the leaves at hand, those that may come to less than `limit`: so many at most, the last first, behind the
// `count` that are left, which it lowers. Returns how many.
INLINE uint take_last(Store *s, uint is_leaf, real limit, uint most, uint *count) {
    const uint there = *count;
    uint mine = 0;
    uint key = NO_SITE;
    if (store_lane(s) < there) {
        const uint at = (there - 1) - store_lane(s);
        if (is_leaf != 0) {
            mine = store_leaf(s, at);
            key = store_leaf_key(s, at);
        } else {
            mine = store_open_block(s, at);
            key = store_open_key(s, at);
        }
    }
    uint is_taken = (uint)((store_lane(s) < there) && (key <= store_key_above(s, limit)));
    const uint all = store_lanes_with(s, is_taken);
    const uint rank = store_rank_in(s, all);
    if (rank >= most) {
        is_taken = 0;
    }
    const uint taken = store_lanes_with(s, is_taken);
    const uint last = store_lanes_with(s, (uint)((is_taken != 0) && ((rank + 1) == most)));
    uint looked = store_lanes(s);
    if (last != 0) {
        looked = store_first_of(s, last) + 1;
    }
    if (looked > there) {
        looked = there;
    }
    *count = there - looked;
    if (is_taken != 0) {
        if (is_leaf != 0) {
            store_set_leaf(s, (there - looked) + rank, mine, key);
        } else {
            store_set_open_block(s, (there - looked) + rank, mine, key);
        }
    }
    store_lanes_wait(s);
    return store_count_of(s, taken);
}

// Puts the children of the last open blocks, as many as there are lanes for, in the place of these, where a question can come to less than its
// limit there; leaves to those at hand. Without the nodes that hold the site's own leaf's block, where these are not asked for. Where the
// power is asked for, the least of the blocks is the last.
HOT Open open_blocks(Store *s, Question question, uint with_own, Open given) {
    Open open = given;
    const uint lanes = store_lanes(s);
    uint some = 1;
    if ((lanes > WIDTH) && (open.blocks <= FEW_OPEN)) {
        some = lanes / WIDTH;
        if (some > open.blocks) {
            some = open.blocks;
        }
    }
    if (question.is_power != 0) {
        some = take_last(s, 0, question.limit, some, &open.blocks);
    } else {
        open.blocks -= some;
    }
    const uint turn = store_lane(s) / WIDTH;
    uint is_there = 0;
    uint block = 0;
    if (turn < some) {
        is_there = 1;
        block = store_open_block(s, open.blocks + turn);
    }
    store_lanes_wait(s);
    const uint level = block >> LEVEL_SHIFT;
    const uint first = (block & BLOCK_MASK) * WIDTH;
    // Of the nodes of the level, that which holds the own leaf's block.
    uint own = 0xFFFFFFFF;
    if (with_own == 0) {
        own = (store_own_site(s) / WIDTH) >> (3 * level);
    }
    uint best = NO_SITE;
    uint best_at = 0;
    uint k = store_lane(s) & (WIDTH - 1);
    while (k < WIDTH) {
        const uint node = first + k;
        uint is_block = 0;
        uint is_leaf = 0;
        uint key = 0;
        if ((is_there != 0) && (node != own)) {
            const real least = least_of_node(s, question, level, node);
            if (question.is_power != 0) {
                key = store_key_below(s, least);
            }
            if (least < question.limit) {
                is_block = 1;
                if (level == 0) {
                    is_block = 0;
                    is_leaf = 1;
                }
            }
        }
        const uint blocks = store_lanes_with(s, is_block);
        const uint leaves = store_lanes_with(s, is_leaf);
        if (is_block != 0) {
            const uint at = open.blocks + store_rank_in(s, blocks);
            store_set_open_block(s, at, ((level - 1) << LEVEL_SHIFT) | node, key);
            if (key < best) {
                best = key;
                best_at = at;
            }
        }
        if (is_leaf != 0) {
            store_set_leaf(s, open.leaves + store_rank_in(s, leaves), node, key);
        }
        open.blocks += store_count_of(s, blocks);
        open.leaves += store_count_of(s, leaves);
        k += lanes;
    }
    store_lanes_wait(s);
    // (Few are all opened next.)
    if ((question.is_power != 0) && ((open.blocks * WIDTH) > lanes)) {
        const uint least = store_least_of_lanes(s, best);
        if (least != NO_SITE) {
            const uint at = store_lane_value(s, best_at, store_first_of(s, store_lanes_with(s, (uint)(best == least))));
            const uint last = open.blocks - 1;
            const uint nearest = store_open_block(s, at);
            const uint other = store_open_block(s, last);
            const uint other_key = store_open_key(s, last);
            store_lanes_wait(s);
            if (store_lane(s) == 0) {
                store_set_open_block(s, at, other, other_key);
                store_set_open_block(s, last, nearest, least);
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

// Four times the square of the distance from the cell's centre to the bisector with site `j`, at least, where the cell's centre is on the own
// side, and else below 0: `(h_j − h_i)²/D²`.
INLINE real reach_of_site(Store *s, Vantage vantage, uint j) {
    const V3 d = store_way_to(s, j);
    const real square = v3_dot(d, d);
    if (store_has_weights(s) == 0) {
        return square;
    }
    const real excess = store_excess_of(s, j);
    const V3 along = v3(vantage.slope.x * d.x, vantage.slope.y * d.y, vantage.slope.z * d.z);
    const real size = square + (fabs(excess) + ((fabs(along.x) + fabs(along.y)) + fabs(along.z)));
    const real power = ((square - excess) + ((along.x + along.y) + along.z)) - (FEW_ROUNDINGS_OF_SUM * size);
    return (power * fabs(power)) / square;
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
    real reach = store_square_of_reach(s, vantage.center);
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
            const uint limit = key_of_reach(s, reach, wanted.below);
            count = gather(s, vantage, open.leaves, some, (Wanted){ .above = wanted.above, .below = limit }, count);
            looked += some;
            if (looked > MOST_NEAR_LEAVES) {
                return UNTOUCHED;
            }
        } else if (!is_batch && (open.blocks > 0)) {
            real within = reach;
            if (is_rest == 0) {
                within = smaller(reach, REAL(0.25) * near);
            }
            const Question question = (Question){ .square = REAL(1.0) - vantage.lambda, .slope = vantage.slope, .limit = (within / vantage.lambda) * SAFE, .place = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .is_power = 0 };
            open = open_blocks(s, question, 0, open);
        } else if (count > 0) {
            const uint status = visit_candidates(s, vantage, count, wanted.below, &reach, visited);
            if (status != UNTOUCHED) {
                return status;
            }
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
            if ((REAL(4.0) * reach) > (FAR_SQUARE * near)) {
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
        last = take_nearest(s, count, NO_SITE);
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

// Takes the nearest of the candidates out: its site, or `NO_SITE` where none has a key below `limit`.
INLINE uint take_nearest(Store *s, uint count, uint limit) {
    uint own = NO_SITE;
    uint place = 0;
    uint i = store_lane(s);
    while (i < count) {
        const uint key = store_candidate_key(s, i);
        if (key < own) {
            own = key;
            place = i;
        }
        i += store_lanes(s);
    }
    const uint nearest = store_least_of_lanes(s, own);
    if (nearest >= limit) {
        return NO_SITE;
    }
    const uint from = store_first_of(s, store_lanes_with(s, (uint)(own == nearest)));
    const uint at = store_lane_value(s, place, from);
    const uint j = store_candidate(s, at);
    // (A lane reads no other keys than its own.)
    if (store_lane(s) == from) {
        store_set_candidate(s, at, j, NO_SITE);
    }
    return j;
}

// Cuts the cell by those candidates that it reaches, nearest first: `UNTOUCHED`, or how it ended. `reach` is the square of its reach, before and
// after.
HOT uint visit_candidates(Store *s, Vantage vantage, uint count, uint below, real *reach, uint *visited) {
    uint limit = key_of_reach(s, *reach, below);
    for (;;) {
        const uint j = take_nearest(s, count, limit);
        if (j == NO_SITE) {
            store_lanes_wait(s);
            return UNTOUCHED;
        }
        *visited += 1;
        const uint status = store_cut_by(s, j);
        if (status == CUT) {
            *reach = store_square_of_reach(s, vantage.center);
            limit = key_of_reach(s, *reach, below);
        } else if (status != UNTOUCHED) {
            return status;
        }
    }
}

// The key from which on sites cannot cut the cell, or `below` if that is less.
INLINE uint key_of_reach(Store *s, real reach, uint below) {
    const uint key = store_key_above(s, (REAL(4.0) * reach) * SAFE);
    if (below < key) {
        return below;
    }
    return key;
}

// core/src/cell/far.rs

// Completes the cell by its vertices, none of which is settled: `COMPLETE`, or how it ended; `UNCERTAIN` where more sites than there is room for
// are within rounding of a vertex, or a vertex is not known well.
HOT uint search_far(Store *s, Vantage vantage, uint *visited) {
    for (;;) {
        const uint v = farthest_unsettled(s, vantage);
        if (v == NO_SITE) {
            return COMPLETE;
        }
        V3 place = v3(REAL(0.0), REAL(0.0), REAL(0.0));
        real radius = REAL(0.0);
        if (store_fine_position(s, v, &place, &radius) != COMPLETE) {
            return UNCERTAIN;
        }
        uint ties = 0;
        const uint found = least_at(s, place, radius, &ties);
        if (found != NO_SITE) {
            store_set_candidate(s, 0, found, 0);
            ties = 1;
        }
        if (ties > MOST_CANDIDATES) {
            return UNCERTAIN;
        }
        uint status = UNTOUCHED;
        uint i = 0;
        while ((i < ties) && (status == UNTOUCHED)) {
            const uint j = store_candidate(s, i);
            if ((found != NO_SITE) || (store_has_cut(s, j) == 0)) {
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
        } else if (status != CUT) {
            return status;
        }
    }
}

// The vertex farthest from the cell's centre of those that are not settled; `NO_SITE` where there is none.
HOT uint farthest_unsettled(Store *s, Vantage vantage) {
    uint nearness = NO_SITE;
    uint own = 0;
    uint v = store_lane(s);
    while (v < store_vertices(s)) {
        if (!store_settled(s, v)) {
            const V3 way = sub(store_position(s, v), vantage.center);
            const uint its = store_key_below(s, -v3_dot(way, way));
            if (its < nearness) {
                nearness = its;
                own = v;
            }
        }
        v += store_lanes(s);
    }
    const uint least = store_least_of_lanes(s, nearness);
    if (least == NO_SITE) {
        return NO_SITE;
    }
    return store_lane_value(s, own, store_first_of(s, store_lanes_with(s, (uint)(nearness == least))));
}

// The site of least power at a vertex, if that is certainly less than the cell's own; else `NO_SITE`, and the candidates are all that may be,
// of which `ties` says how many.
HOT uint least_at(Store *s, V3 v, real radius, uint *ties) {
    const real own = v3_dot(v, v);
    const real lost = PER_LENGTH * radius;
    // Beyond this power no site can have less than the cell's: with t the distance from the vertex, rounding is at most
    // lost·(√own + t) + FEW_ROUNDINGS_OF_SUM·(t² + own + …), where 2t ≤ length + t²/length for any length; and t² is the power and the
    // largest weight. (A vertex may be where the cell's site is.)
    const real length = larger(larger(sqrt(own), LENGTHS_OF_LOST * lost), LEAST_LENGTH);
    const real lost_of_square = (REAL(0.5) * lost) / length;
    const real share = lost_of_square + (REAL(4.0) * FEW_ROUNDINGS_OF_SUM);
    const real room = ((REAL(1.5) * lost) * length) + (share * larger(store_largest_excess(s), REAL(0.0)));
    Question question = (Question){ .square = REAL(1.0), .slope = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .limit = ((own * (REAL(1.0) + (REAL(2.0) * FEW_ROUNDINGS_OF_SUM))) + room) * (REAL(1.0) + (REAL(2.0) * share)), .place = v, .is_power = 1 };
    uint found = NO_SITE;
    Open open = open_root(s);
    *ties = 0;
    for (;;) {
        // As many leaves as there are lanes for their sites.
        const uint lanes = store_lanes(s);
        const uint most = larger_count(lanes / WIDTH, 1);
        if ((open.leaves >= most) || ((open.leaves > 0) && (open.blocks == 0))) {
            const uint some = take_last(s, 1, question.limit, most, &open.leaves);
            uint i = store_lane(s);
            while (i < larger_count(some * WIDTH, lanes)) {
                uint j = NO_SITE;
                if (i < (some * WIDTH)) {
                    j = (store_leaf(s, open.leaves + (i / WIDTH)) * WIDTH) + (i & (WIDTH - 1));
                }
                uint is_less = 0;
                uint is_tied = 0;
                real power = REAL(0.0);
                if ((j < store_sites(s)) && (j != store_own_site(s))) {
                    const V3 d = store_way_to(s, j);
                    const real excess = store_excess_of(s, j);
                    const V3 way = sub(v, d);
                    const real square = v3_dot(way, way);
                    const real less = (square - own) - excess;
                    const real rounding = (((REAL(1.5) * lost) * length) + (lost_of_square * square)) + (FEW_ROUNDINGS_OF_SUM * ((square + own) + (fabs(excess) + v3_dot(d, d))));
                    power = square - excess;
                    if (less < -rounding) {
                        is_less = 1;
                    } else if (less <= rounding) {
                        is_tied = 1;
                    }
                }
                if (store_lanes_with(s, is_less) != 0) {
                    uint key = NO_SITE;
                    if (is_less != 0) {
                        key = store_key_above(s, power);
                    }
                    const uint least = store_least_of_lanes(s, key);
                    const uint from = store_first_of(s, store_lanes_with(s, (uint)(key == least)));
                    const real best = store_lane_real(s, power, from);
                    if ((found == NO_SITE) || (best < question.limit)) {
                        found = store_lane_value(s, j, from);
                        question.limit = smaller(best, question.limit);
                    }
                }
                const uint tied = store_lanes_with(s, is_tied);
                if ((found == NO_SITE) && (tied != 0)) {
                    const uint at = *ties + store_rank_in(s, tied);
                    if ((is_tied != 0) && (at < MOST_CANDIDATES)) {
                        store_set_candidate(s, at, j, 0);
                    }
                    *ties += store_count_of(s, tied);
                }
                i += lanes;
            }
            store_lanes_wait(s);
        } else if (open.blocks > 0) {
            open = open_blocks(s, question, 1, open);
        } else {
            return found;
        }
    }
}

INLINE uint larger_count(uint a, uint b) {
    if (a > b) {
        return a;
    }
    return b;
}
