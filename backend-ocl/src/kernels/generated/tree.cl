// Generated from core/src/cell/tree.rs by `cargo xtask codegen`; do not edit.

// The site whose cell is searched.
INLINE Seer seer_of(Store *s) {
    return (Seer){ .site = store_site(s), .excess = store_own_excess(s), .has_weights = store_has_weights(s) };
}

// The box that a place is in; of no leaves where none are listed, or that is out of the container.
INLINE OctreePlace octree_box_at(Store *s, V3 place) {
    const real off = store_octree_off(s);
    V3 lo = store_octree_lo(s);
    V3 hi = store_octree_hi(s);
    const bool is_above = (place.x >= (lo.x - off)) && ((place.y >= (lo.y - off)) && (place.z >= (lo.z - off)));
    const bool is_below = (place.x <= (hi.x + off)) && ((place.y <= (hi.y + off)) && (place.z <= (hi.z + off)));
    OctreeNode node = (OctreeNode){ .begin = 0, .count = 0 };
    if (is_above && is_below) {
        node = store_octree_node(s, 0);
    }
    while (node.count == HAS_PARTS) {
        const V3 middle = middle_of(lo, hi);
        uint octant = 0;
        if (place.x >= middle.x) {
            octant += 1;
        }
        if (place.y >= middle.y) {
            octant += 2;
        }
        if (place.z >= middle.z) {
            octant += 4;
        }
        const V3 corner = part_lo(lo, hi, octant);
        hi = part_hi(lo, hi, octant);
        lo = corner;
        node = store_octree_node(s, node.begin + octant);
    }
    if (node.count == UNLISTED) {
        node.count = 0;
    }
    const V3 extent = sub(hi, lo);
    return (OctreePlace){ .lo = lo, .hi = hi, .diagonal = sqrt(v3_dot(extent, extent)), .node = node };
}

// Where the sites that may have less power at the asked vertex are listed, has their leaves at hand. Else it opens, for some asked vertices, the lowest
// level of which the lanes take all blocks at one time: the root, where there is one lane.
INLINE Open open_top(Store *s, uint vertices) {
    const uint listed = store_set_listed_leaves(s, vertices);
    if (listed > 0) {
        return (Open){ .blocks = 0, .leaves = listed };
    }
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
        const uint all = store_lanes_with(s, is_kept);
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
// limit there; leaves to those at hand. Without the nodes that hold the site's own leaf's block, unless the question opens them, too. Where a
// vertex is asked for the least of the blocks is the last.
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
    bool is_there = 0;
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
    if (!question.opens_own) {
        own = (store_own_site(s) / WIDTH) >> (3 * level);
    }
    uint best = NO_SITE;
    uint best_at = 0;
    uint k = store_lane(s) & (WIDTH - 1);
    while (k < WIDTH) {
        const uint node = first + k;
        bool is_wanted = 0;
        uint key = 0;
        uint asks = 0;
        if (is_there && (node != own)) {
            if (question.vertices != 0) {
                asks = store_asks_of_node(s, level, node, of_block, &key);
                is_wanted = asks != 0;
            } else if (question.sweeps) {
                is_wanted = may_cut(s, seer_of(s), level, node);
            } else {
                const real least = least_of_node(seer_of(s), question.square, question.slope, store_node_box(s, level, node), store_node_weights(s, level, node));
                is_wanted = least < question.limit;
            }
        }
        const bool is_block = is_wanted && (level > 0);
        const bool is_leaf = is_wanted && (level == 0);
        const uint blocks = store_lanes_with(s, is_block);
        const uint leaves = store_lanes_with(s, is_leaf);
        if (is_block) {
            const uint at = open.blocks + store_rank_in(s, blocks);
            store_set_open_block(s, at, ((level - 1) << LEVEL_SHIFT) | node, key, asks);
            if (key < best) {
                best = key;
                best_at = at;
            }
        }
        if (is_leaf) {
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
            const uint at = store_lane_value(s, best_at, store_first_of(s, store_lanes_with(s, best == least)));
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
