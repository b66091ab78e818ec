// Generated from core/src/cell/boxes.rs by `cargo xtask codegen`; do not edit.

// Completes the cell, whose home is known, by the sites that are listed in the boxes that it is in: `COMPLETE`; `UNTOUCHED` where a box lists none, or
// a vertex is too near a box's face to tell in which it is: those that are not settled are left to vertex by vertex; or how it ended.
HOT uint search_boxes(Store *s, Vantage vantage, uint *visited) {
    V3 place = vantage.center;
    real radius = REAL(0.0);
    uint looked = 0;
    bool is_home = 1;
    for (;;) {
        const OctreePlace at = open_ended(s, octree_box_at(s, add(store_site(s), place)));
        if ((at.node.count == 0) || !is_in_box(s, at, place, radius)) {
            return UNTOUCHED;
        }
        const uint fresh = take_fresh(s, at.node, &looked);
        const uint status = store_visit_leaves(s, vantage, fresh, is_home, visited);
        if (status != UNTOUCHED) {
            return status;
        }
        if (is_home && store_has_domain(s)) {
            const uint status = store_cut_outside(s, at.diagonal + sqrt(v3_dot(vantage.center, vantage.center)));
            if ((status != UNTOUCHED) && (status != CUT)) {
                return status;
            }
        }
        is_home = 0;
        uint v = store_lane(s);
        while (v < store_vertices(s)) {
            if (!store_settled(s, v) && is_in_box(s, at, store_position(s, v), store_radius(s, v))) {
                store_settle_own(s, v);
            }
            v += store_lanes(s);
        }
        store_lanes_wait(s);
        uint key = 0;
        const uint next = next_unsettled(s, share_of_all(s), vantage.center, -REAL(1.0), &key);
        if (next == NO_SITE) {
            return COMPLETE;
        }
        place = store_position(s, next);
        radius = store_radius(s, next);
    }
}

// Begins the search for the sites that cut the cell, which [`search_far`](super::far::search_far) ends where that is `UNTOUCHED`: box by box where the
// cell's home is known, or else as [`search_near`].
HOT uint search_from(Store *s, Vantage vantage, uint what, uint *visited, real *proven) {
    if (what == NEAR) {
        *proven = REAL(0.0);
        if (vantage.home == HOME_NOWHERE) {
            return EMPTY;
        }
        if (vantage.home == HOME_KNOWN) {
            return search_boxes(s, vantage, visited);
        }
    }
    return search_near(s, vantage, what, visited, proven);
}

// A box, without an end where the container has none beyond it.
INLINE OctreePlace open_ended(Store *s, OctreePlace at) {
    OctreePlace open = at;
    const V3 lo = store_octree_lo(s);
    const V3 hi = store_octree_hi(s);
    if (at.lo.x <= lo.x) {
        open.lo.x = -NO_END;
    }
    if (at.lo.y <= lo.y) {
        open.lo.y = -NO_END;
    }
    if (at.lo.z <= lo.z) {
        open.lo.z = -NO_END;
    }
    if (at.hi.x >= hi.x) {
        open.hi.x = NO_END;
    }
    if (at.hi.y >= hi.y) {
        open.hi.y = NO_END;
    }
    if (at.hi.z >= hi.z) {
        open.hi.z = NO_END;
    }
    return open;
}

// Whether what is within `radius` along each axis of a place, from the cell's site, is in a box.
INLINE bool is_in_box(Store *s, OctreePlace at, V3 place, real radius) {
    const V3 x = add(store_site(s), place);
    const real off = (radius + (UNIT_ROUNDOFF * norm_1(x))) - store_octree_off(s);
    const bool is_above = ((x.x - off) >= at.lo.x) && (((x.y - off) >= at.lo.y) && ((x.z - off) >= at.lo.z));
    const bool is_below = ((x.x + off) <= at.hi.x) && (((x.y + off) <= at.hi.y) && ((x.z + off) <= at.hi.z));
    return is_above && is_below;
}

// Has those leaves at hand that a box lists and that were not looked at, as far as there is room to remember them; returns how many.
INLINE uint take_fresh(Store *s, OctreeNode node, uint *looked) {
    const uint before = *looked;
    uint fresh = 0;
    uint i = store_lane(s);
    while ((i - store_lane(s)) < node.count) {
        uint leaf = 0;
        bool is_fresh = 0;
        if (i < node.count) {
            leaf = store_octree_leaf(s, node.begin + i);
            is_fresh = 1;
            for (uint k = 0; k < before; k++) {
                if (store_open_block(s, k) == leaf) {
                    is_fresh = 0;
                }
            }
        }
        const uint all = store_lanes_with(s, is_fresh);
        const uint at = fresh + store_rank_in(s, all);
        if (is_fresh) {
            store_set_leaf(s, at, leaf, 0, 0);
            if ((before + at) < MOST_OPEN) {
                store_set_open_block(s, before + at, leaf, 0, 0);
            }
        }
        fresh += store_count_of(s, all);
        i += store_lanes(s);
    }
    store_lanes_wait(s);
    *looked = before + fresh;
    if (*looked > MOST_OPEN) {
        *looked = MOST_OPEN;
    }
    return fresh;
}

// Cuts the cell by those sites of so many leaves at hand that may cut it, nearest first as far as there is room for candidates: `UNTOUCHED`, or how it
// ended. Those that may not are dropped before and in between, each by a lane of its own, but for the first from home, when all may.
//
// (By the cell's reach alone some 150 to 300 sites were visited, of which 30 cut it, and took half of the time.)
HOT uint visit_leaves(Store *s, Vantage vantage, uint leaves, bool is_home, uint *visited) {
    float reach = store_square_of_reach(s, vantage.center);
    uint limit = key_limit(s, reach, NO_SITE);
    uint left = leaves;
    uint count = 0;
    uint cuts = 0;
    bool is_looked_at = is_home;
    while ((left > 0) || (count > 0)) {
        if ((left > 0) && ((count + (LEAVES_AT_ONCE * WIDTH)) <= MOST_CANDIDATES)) {
            uint some = LEAVES_AT_ONCE;
            if (left < some) {
                some = left;
            }
            left -= some;
            count = gather(s, vantage, left, some, (Wanted){ .above = 0, .below = limit }, count);
            is_looked_at = is_home && (*visited == 0);
        } else {
            if (!is_looked_at) {
                count = store_drop_held(s, count);
                is_looked_at = 1;
                cuts = 0;
            }
            const Held held = nearest_held(s, count);
            const uint least = store_least_of_lanes(s, held.key);
            if (least >= limit) {
                store_lanes_wait(s);
                count = 0;
            } else {
                const uint j = take_held(s, held, least);
                *visited += 1;
                const uint status = store_cut_by(s, j);
                if (status == CUT) {
                    reach = store_square_of_reach(s, vantage.center);
                    limit = key_limit(s, reach, NO_SITE);
                    cuts += 1;
                    is_looked_at = cuts < CUTS_IN_BOX;
                } else if (status != UNTOUCHED) {
                    return status;
                }
            }
        }
    }
    return UNTOUCHED;
}
