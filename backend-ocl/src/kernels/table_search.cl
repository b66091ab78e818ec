// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "tree_search.cl"

INLINE real limit_in_voxels(Store *s, real reach);
INLINE real gap_to_voxel(int offset, real place);
HOT uint search_table(Store *s, Vantage vantage, uint *visited);

// core/src/cell/table.rs

// The squared distance in voxels from which on a voxel's sites cannot cut the cell.
INLINE real limit_in_voxels(Store *s, real reach) {
    const real voxels = (sqrt((REAL(4.0) * reach) * SAFE) * store_voxels_per_length(s)) + SLACK_IN_VOXELS;
    return (voxels * voxels) * SAFE_IN_VOXELS;
}

// How far along an axis a place in a voxel is from the voxel `offset` beyond.
INLINE real gap_to_voxel(int offset, real place) {
    const real begin = (real)offset;
    return larger(larger(begin - place, place - (begin + REAL(1.0))), REAL(0.0));
}

// Cuts the cell by all sites that can cut it: `COMPLETE`; `UNTOUCHED` where the table does not prove that; or how it ended.
HOT uint search_table(Store *s, Vantage vantage, uint *visited) {
    const V3 place = store_place_in_voxel(s);
    real reach = store_square_of_reach(s, vantage.center);
    uint next = 0;
    for (;;) {
        const uint outside = store_look_outside(s, next, reach);
        if (outside == CUT) {
            reach = store_square_of_reach(s, vantage.center);
        } else if (outside != UNTOUCHED) {
            return outside;
        }
        // A voxel for each lane, and where its sites stand among those of all.
        const real limit = limit_in_voxels(s, reach);
        SiteRange range = (SiteRange){ .begin = 0, .end = 0 };
        uint before = 0;
        uint all = 0;
        while ((all == 0) && (next < store_offsets(s))) {
            uint is_past = 0;
            range = (SiteRange){ .begin = 0, .end = 0 };
            if ((next + store_lane(s)) < store_offsets(s)) {
                const Offset offset = store_offset(s, next + store_lane(s));
                const real x = gap_to_voxel(offset.x, place.x);
                const real y = gap_to_voxel(offset.y, place.y);
                const real z = gap_to_voxel(offset.z, place.z);
                if (offset.apart >= limit) {
                    is_past = 1;
                } else if ((((x * x) + (y * y)) + (z * z)) < limit) {
                    range = store_sites_at(s, offset);
                }
            }
            before = store_sum_before(s, range.end - range.begin, &all);
            next += store_lanes(s);
            if (next > store_offsets(s)) {
                next = store_offsets(s);
            }
            if (store_lanes_with(s, is_past) != 0) {
                next = store_offsets(s) + 1;
            }
        }
        uint window = 0;
        while (window < all) {
            uint i = 0;
            while (i < (range.end - range.begin)) {
                if (((before + i) >= window) && ((before + i) < (window + WINDOW))) {
                    store_set_candidate(s, (before + i) - window, range.begin + i, NO_SITE);
                }
                i += 1;
            }
            store_lanes_wait(s);
            uint count = all - window;
            if (count > WINDOW) {
                count = WINDOW;
            }
            i = store_lane(s);
            while (i < count) {
                const uint j = store_candidate(s, i);
                if (j != store_own_site(s)) {
                    const V3 way = store_way_to(s, j);
                    store_set_candidate(s, i, j, store_key_below(s, v3_dot(way, way)));
                }
                i += store_lanes(s);
            }
            const uint status = visit_candidates(s, vantage, count, NO_SITE, &reach, visited);
            if (status != UNTOUCHED) {
                return status;
            }
            window += WINDOW;
        }
        if ((all == 0) && (next >= store_offsets(s))) {
            if (next > store_offsets(s)) {
                return COMPLETE;
            }
            return UNTOUCHED;
        }
    }
}
