// Generated from core/src/cell/table.rs by `cargo xtask codegen`; do not edit.

// From where a cell is searched where weights differ: by the slope of its block of leaves.
INLINE Vantage vantage_in_block(Store *s) {
    const uint block = block_of_site(store_top_level(s), store_own_site(s));
    const V3 slope = store_node_weights(s, level_of_block(store_top_level(s)), block).slope;
    return (Vantage){ .slope = slope, .center = scale(-REAL(0.5), slope), .lambda = REAL(0.5), .home = HOME_UNKNOWN };
}

// Finds what the sites around weigh more than the cell's.
INLINE void look_around(Store *s, V3 slope) {
    const uint block = block_of_site(store_top_level(s), store_own_site(s));
    const NodeBox bounds = store_node_box(s, level_of_block(store_top_level(s)), block);
    const V3 way = sub(store_site(s), scale(REAL(0.5), add(bounds.lo, bounds.hi)));
    real size = REAL(0.0);
    const real own = less_slope(store_own_excess(s), slope, way, &size);
    uint ring = store_lane(s);
    while (ring < RINGS) {
        const real largest = store_largest_in_ring(s, block, ring);
        store_set_excess_around(s, ring, (largest - own) + (FEW_ROUNDINGS_OF_SUM * (size + fabs(largest))));
        ring += store_lanes(s);
    }
    store_lanes_wait(s);
}

// The squared distance in voxels from which on a voxel's sites cannot cut the cell. Sites beyond `ring` cannot, whatever it is.
INLINE float limit_in_voxels(Store *s, float reach, uint *ring) {
    float voxels = sqrt(reach) * store_voxels_per_length(s);
    if (store_has_weights(s)) {
        const float radius = HALF * voxels;
        bool goes_on = 1;
        while (goes_on) {
            voxels = radius + sqrt((radius * radius) + store_excess_around(s, *ring));
            goes_on = 0;
            if (*ring > 0) {
                const float begin = (float)end_of_ring(*ring - 1);
                // (With room for roundings.)
                if (((voxels + SLACK_IN_VOXELS) * SAFE_IN_VOXELS) <= begin) {
                    *ring -= 1;
                    goes_on = 1;
                }
            }
        }
        const float end = (float)end_of_ring(*ring);
        if ((*ring < (RINGS - 1)) && (end < voxels)) {
            voxels = end;
        }
    }
    voxels += SLACK_IN_VOXELS;
    return (voxels * voxels) * SAFE_IN_VOXELS;
}

// How far along an axis a place in a voxel is from the voxel `offset` beyond.
INLINE float gap_to_voxel(int offset, float place) {
    const float begin = (float)offset;
    return fmax(fmax((begin - place), place - (begin + ONE_VOXEL)), NO_GAP);
}

// The voxels nearer than the square root of `limit` that come next in the table, at most one for each lane, into the window; returns how many. `next` is the
// offset to be looked at then: `offsets()` where the table has ended, more where all others are farther.
INLINE uint gather_voxels(Store *s, VoxelPlace place, float limit, uint *next) {
    uint found = 0;
    bool goes_on = 1;
    while (goes_on) {
        const uint own = *next + store_lane(s);
        const Offset offset = store_offset(s, own);
        const float x = gap_to_voxel(offset.x, place.x);
        const float y = gap_to_voxel(offset.y, place.y);
        const float z = gap_to_voxel(offset.z, place.z);
        const uint voxel = store_voxel_at(s, offset);
        const bool is_near = ((own < store_offsets(s)) && (voxel != NO_VOXEL)) && ((((x * x) + (y * y)) + (z * z)) < limit);
        const uint all = store_lanes_with(s, is_near);
        const uint rank = found + store_rank_in(s, all);
        if (is_near && (rank < store_lanes(s))) {
            store_set_in_window(s, rank, voxel);
        }
        const uint out = store_lanes_with(s, is_near && (rank >= store_lanes(s)));
        const uint past = store_lanes_with(s, (own < store_offsets(s)) && (offset.apart >= limit));
        if (out != 0) {
            // The first that has no place is the next to be looked at.
            *next += store_first_of(s, out);
            found = store_lanes(s);
            goes_on = 0;
        } else {
            found += store_count_of(s, all);
            *next += store_lanes(s);
            if (*next > store_offsets(s)) {
                *next = store_offsets(s);
            }
            if (past != 0) {
                // All later voxels are at least as far away.
                *next = store_offsets(s) + 1;
            }
            goes_on = (found <= (store_lanes(s) / 2)) && (*next < store_offsets(s));
        }
    }
    store_lanes_wait(s);
    return found;
}

// Cuts the cell by all sites that can cut it: `COMPLETE`; `UNTOUCHED` where the table does not prove that, or likely will not; or how it ended. `reach` is the square of
// its reach about the vantage's center, afterwards.
HOT uint search_table(Store *s, Vantage vantage, float *reach, uint *visited) {
    V3 center = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    if (store_has_weights(s)) {
        center = vantage.center;
        look_around(s, vantage.slope);
    }
    uint ring = RINGS - 1;
    const VoxelPlace place = store_place_in_voxel(s);
    *reach = store_square_of_reach(s, center);
    uint next = 0;
    for (;;) {
        const uint outside = store_look_outside(s, next, *reach);
        if (outside == CUT) {
            *reach = store_square_of_reach(s, center);
        } else if (outside != UNTOUCHED) {
            return outside;
        }
        // A voxel for each lane, and where its sites stand among those of all.
        const float voxels = limit_in_voxels(s, *reach, &ring);
        if (store_leaves_early(s) && ((next >= TRIED_OFFSETS) && (voxels > WORTH_GOING_ON))) {
            return UNTOUCHED;
        }
        const uint found = gather_voxels(s, place, voxels, &next);
        SiteRange range = (SiteRange){ .begin = 0, .end = 0 };
        if (store_lane(s) < found) {
            range = store_sites_in(s, store_in_window(s, store_lane(s)));
        }
        const uint own = range.end - range.begin;
        uint all = 0;
        const uint before = store_sum_before(s, own, &all);
        uint window = 0;
        while (window < all) {
            store_lanes_wait(s);
            for (uint i = 0; i < own; i++) {
                const uint at = ((before + i) - window);
                if (at < store_window(s)) {
                    store_set_in_window(s, at, range.begin + i);
                }
            }
            store_lanes_wait(s);
            uint count = all - window;
            if (count > store_window(s)) {
                count = store_window(s);
            }
            // (A site out of reach does not get its key, so that the lanes agree at once that none is left.)
            const uint limit = store_key_of_reach(s, *reach);
            for (uint c = 0; c < store_held(s, count); c++) {
                const uint at = (c * store_lanes(s)) + store_lane(s);
                uint site = store_own_site(s);
                uint key = NO_SITE;
                if ((window + at) < all) {
                    site = store_in_window(s, at);
                    const uint its = store_key_below(s, reach_of_site(s, vantage.slope, site));
                    if ((site != store_own_site(s)) && (its < limit)) {
                        key = its;
                    }
                }
                store_hold(s, c, site, key);
            }
            const uint status = visit_candidates(s, center, count, NO_SITE, 0, reach, visited);
            if (status != UNTOUCHED) {
                return status;
            }
            window += store_window(s);
        }
        if (next >= store_offsets(s)) {
            break;
        }
    }
    if (*reach <= NO_GAP) {
        return EMPTY;
    }
    if (next > store_offsets(s)) {
        return COMPLETE;
    }
    return UNTOUCHED;
}
