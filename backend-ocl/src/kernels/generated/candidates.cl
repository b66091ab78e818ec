// Generated from core/src/cell/candidates.rs by `cargo xtask codegen`; do not edit.

// What `reach_of_bisector` says of site `j`, from where weights of some slope have the cell.
INLINE real reach_of_site(Store *s, V3 slope, uint j) {
    const V3 d = store_way_to(s, j);
    if (!store_has_weights(s)) {
        return v3_dot(d, d);
    }
    return reach_of_bisector(slope, d, store_excess_of(s, j));
}

// The nearest of the candidates that this lane holds: not alike.
INLINE Held nearest_held(Store *s, uint count) {
    Held nearest = (Held){ .key = NO_SITE, .number = 0 };
    for (uint c = 0; c < store_held(s, count); c++) {
        const uint key = store_held_key(s, c);
        if (key < nearest.key) {
            nearest.key = key;
            nearest.number = c;
        }
    }
    return nearest;
}

// Takes the nearest of the lanes' candidates out, whose key is `least`; returns its site.
INLINE uint take_held(Store *s, Held held, uint least) {
    const uint from = store_lane_of_key(s, held.key, least);
    const uint j = store_lane_value(s, store_held_site(s, held.number), from);
    if (store_lane(s) == from) {
        store_let_go(s, held.number);
    }
    return j;
}

// Cuts the cell by those candidates that it reaches, nearest first: `UNTOUCHED`, or how it ended. `reach` is the square of its reach, before and
// after. Where it `checks`, it is instead by all but those that are known to leave it untouched, whatever they reach, and `reach` stays what it was.
HOT uint visit_candidates(Store *s, V3 center, uint count, uint below, bool checks, float *reach, uint *visited) {
    uint limit = below;
    uint cuts = 0;
    uint there = count;
    if (checks) {
        there = store_drop_held(s, there);
    } else {
        limit = key_limit(s, *reach, below);
        // (What remains when some were visited before is looked at soon.)
        cuts = *visited;
    }
    for (;;) {
        const Held held = nearest_held(s, there);
        const uint least = store_least_of_lanes(s, held.key);
        if (least >= limit) {
            return UNTOUCHED;
        }
        const uint j = take_held(s, held, least);
        uint status = UNTOUCHED;
        if (!checks || !store_was_tried(s, j)) {
            *visited += 1;
            status = store_cut_by(s, j);
        }
        if (status == CUT) {
            if (!checks) {
                *reach = store_square_of_reach(s, center);
                limit = key_limit(s, *reach, below);
            }
            cuts += 1;
        } else if (status != UNTOUCHED) {
            return status;
        } else if (checks) {
            // (After each cut sites on a bumpy surface took 4 % longer, one NVIDIA H200.)
            if (cuts > 0) {
                there = store_drop_held(s, there);
            }
            cuts = 0;
        } else if (cuts >= store_cuts_before_look(s)) {
            if (store_count_of(s, store_lanes_with(s, held.key < limit)) >= WORTH_A_LOOK) {
                there = store_drop_held(s, there);
            }
            cuts = 0;
        }
    }
}

// The key from which on sites cannot cut the cell, or `below` if that is less.
INLINE uint key_limit(Store *s, float reach, uint below) {
    const uint key = store_key_of_reach(s, reach);
    if (below < key) {
        return below;
    }
    return key;
}
