// The search of the table of offsets, where LANES work-items compute a cell together and weights do not differ: the voxels around the cell's own,
// nearest first. What it does not prove complete the tree does (`lanes_tree.cl`).

#import "lanes_tree.cl"

#if WITH_TABLE
// What is carried from cut to cut, for what is asked of the domain (0 where the cell is outside, which nothing reaches) and of other sites: the
// squared distance from which on no site can cut the cell. A site's key is the smaller, the earlier it had better cut; those cannot that are not
// below the limit.
INLINE float reach_now(Store *s) { return extent_of(farthest_of(s)); }
INLINE float within(float reach, float outside) { return (reach <= outside) ? 0.0f : reach; }
INLINE uint key_limit(float reach) { return as_uint(reach); }
INLINE uint key_of(V3 way) { return as_uint(convert_float_rtz(v3_dot(way, way))); }

#if WITH_DOMAIN
// Whether a vertex is so many voxels of the site grid away from the site, and may be on the other side of the surface.
INLINE uint is_beyond(Store *s, float reach, real widths) {
    const float from = extent_of(convert_float_rtp(widths * s->world.params->grid_width));
    return (reach > from) && (reach > s->cell->clear);
}
#endif

// A squared distance in voxels, for comparison with those between voxels.
INLINE float voxels_in_reach(Store *s, float reach) {
    const float in_voxels = (sqrt(reach) * (convert_float_rtp(s->world.params->grid_per_width) * ROUGH_SAFE)) + SHELL_SLACK;
    return (in_voxels * in_voxels) * 1.00001f;
}

// No key of a candidate.
#define USED 0xFFFFFFFFu

// Cuts by those of two sites for each lane that are in reach, nearest first: `UNTOUCHED`, or how the cell ended.
INLINE uint cut_by_nearest(Store *s, const uint *site, uint *key, uint is_sampled, float *reach, uint *visited) {
    for (;;) {
        const uint mine = min(key[0], key[1]);
        const uint nearest = ~lanes_most(~mine);
        if (nearest >= key_limit(*reach)) {
            return UNTOUCHED;
        }
        // (No index, so that all stays in registers.)
        const uint from = lowest_bit(lanes_with(mine == nearest));
        const uint is_first = key[0] == mine;
        const uint beyond = lane_value((is_first != 0u) ? site[0] : site[1], from);
        if (s->lane == from) {
            key[0] = (is_first != 0u) ? USED : key[0];
            key[1] = (is_first != 0u) ? key[1] : USED;
        }
        if ((is_sampled != 0u) && (has_cut(s, beyond) != 0u)) {
            continue;
        }
        *visited += 1u;
        // Each lane makes the half-space for itself.
        const uint status = cut_together(s, bisector_with(s, beyond), beyond);
        if (status == CUT) {
            *reach = reach_now(s);
#if WITH_DOMAIN
            // (Which ends the search without a way out of here of its own.)
            *reach = within(*reach, s->cell->outside);
#endif
        } else if (status != UNTOUCHED) {
            return status;
        }
    }
}

// The voxels within reach that come next in the table of offsets, up to LANES, into `marked`, as places in the grid; returns how many.
// `entry` is the next to be looked at: SHELLS where the table has ended, more where all others are out of reach.
INLINE uint gather_voxels(Store *s, __global const uchar4 *shells, const uint *center, float3 f, float reach, uint *entry) {
    __global const Params *params = s->world.params;
    const float limit = voxels_in_reach(s, reach);
    const uint below = (1u << s->lane) - 1u;
    uint found = 0;
    uint goes_on = 1;
    while (goes_on != 0u) {
        const uint own = *entry + s->lane;
        const uchar4 shell = shells[min(own, SHELLS - 1u)];
        const int ox = (int)shell.x - (int)SHELL_RADIUS;
        const int oy = (int)shell.y - (int)SHELL_RADIUS;
        const int oz = (int)shell.z - (int)SHELL_RADIUS;
        const float gx = fmax(fmax((float)ox - f.x, f.x - (float)(ox + 1)), 0.0f);
        const float gy = fmax(fmax((float)oy - f.y, f.y - (float)(oy + 1)), 0.0f);
        const float gz = fmax(fmax((float)oz - f.z, f.z - (float)(oz + 1)), 0.0f);
        // Below zero is beyond the end, too.
        const uint i = center[0] + (uint)ox;
        const uint j = center[1] + (uint)oy;
        const uint k = center[2] + (uint)oz;
        const float square = ((gx * gx) + (gy * gy)) + (gz * gz);
        const uint voxel = i + (params->grid_dims[0] * (j + (params->grid_dims[1] * k)));
        const uint is_near = ((own < SHELLS) && (square < limit))
            && (((i < params->grid_dims[0]) && (j < params->grid_dims[1])) && (k < params->grid_dims[2]));
        const uint all = lanes_with(is_near);
        const uint rank = found + popcount(all & below);
        if ((is_near != 0u) && (rank < LANES)) {
            s->cell->marked[rank] = voxel;
        }
        const uint out = lanes_with((is_near != 0u) && (rank >= LANES));
        const uint past = lanes_with((own < SHELLS) && ((float)shell.w >= limit));
        if (out != 0u) {
            // The first that has no place is the next to be looked at.
            *entry += lowest_bit(out);
            found = LANES;
            goes_on = 0;
        } else {
            // All later voxels are at least as far away as one that is past the limit.
            found += popcount(all);
            *entry = (past != 0u) ? (SHELLS + 1u) : min(*entry + LANES, SHELLS);
            goes_on = (found <= (LANES / 2u)) && (*entry < SHELLS);
        }
    }
    lanes_wait();
    return found;
}

// Cuts the cell by all sites that can cut it: `COMPLETE`, `EMPTY`, `LEFT`, `OPEN` or `BEYOND`.
INLINE uint complete_by_table(Store *s, __global const uchar4 *shells, uint own, uint *visited, float *extent) {
    CELL_SPACE Cell *cell = s->cell;
    __global const Params *params = s->world.params;
    const V3 p = s->site;
    const real per_width = params->grid_per_width;
    const V3 at = (V3){ .x = (p.x - params->grid_lo[0]) * per_width, .y = (p.y - params->grid_lo[1]) * per_width,
                        .z = (p.z - params->grid_lo[2]) * per_width };
    const uint center[3] = { voxel_along(params, 0, p.x), voxel_along(params, 1, p.y), voxel_along(params, 2, p.z) };
    const float3 f = (float3)((float)(at.x - (real)center[0]), (float)(at.y - (real)center[1]), (float)(at.z - (real)center[2]));
    const uint below = (1u << s->lane) - 1u;
    float reach = reach_now(s);
#if WITH_DOMAIN && WITH_EXACT
    uint is_capped = 0;
#endif
    uint is_sampled = 0;
    uint entry = 0;
    for (;;) {
#if WITH_DOMAIN && WITH_EXACT
        if (((entry >= INNER_SHELLS) && (is_capped == 0u)) && (is_beyond(s, reach, CAP_FROM) != 0u)) {
            Store copy = *s;
            uint status = lanes_alike(cap_together(&copy, CAP_FROM * params->grid_width));
            if (((status == CUT) || (status == UNTOUCHED)) && (is_beyond(&copy, reach_now(&copy), SAMPLE_FROM) != 0u)) {
                is_sampled = 1;
                status = lanes_alike(sample_together(&copy, own));
                if ((status == CUT) || (status == UNTOUCHED)) {
                    status = lanes_alike(cap_together(&copy, CAP_FROM * params->grid_width));
                }
            }
            take_over(s, &copy);
            if ((status != CUT) && (status != UNTOUCHED)) {
                return status;
            }
            reach = reach_now(s);
            // Once is enough.
            is_capped = 1;
        }
#endif
        // 1. A voxel for each lane, and where its sites stand in the row of all.
        const uint found = gather_voxels(s, shells, center, f, reach, &entry);
        uint begin = 0;
        uint count = 0;
        if (s->lane < found) {
            const uint voxel = cell->marked[s->lane];
            const uint2 range = s->world.voxels[voxel];
            begin = range.x;
            count = range.y - range.x;
        }
        uint total = 0;
        uint place = 0;
        for (uint bit = 0; bit < 7u; bit++) {
            const uint all = lanes_with((count >> bit) & 1u);
            place += popcount(all & below) << bit;
            total += popcount(all) << bit;
        }
        // 2. Two sites for each lane at a time.
        for (uint window = 0; window < total; window += 2u * LANES) {
            lanes_wait();
            for (uint c = 0; c < count; c++) {
                const uint at = (place + c) - window;
                if (at < (2u * LANES)) {
                    cell->marked[at] = begin + c;
                }
            }
            lanes_wait();
            uint site[2];
            uint key[2];
            UNROLLED
            for (uint c = 0; c < 2u; c++) {
                const uint at = (c * LANES) + s->lane;
                key[c] = USED;
                site[c] = own;
                if ((window + at) < total) {
                    site[c] = cell->marked[at];
                    const real4 other = s->world.sites[site[c]];
                    const V3 way = (V3){ .x = other.x - p.x, .y = other.y - p.y, .z = other.z - p.z };
                    const uint its = key_of(way);
                    key[c] = ((site[c] != own) && (its < key_limit(reach))) ? its : USED;
                }
            }
            // 3. The nearest of them, again and again, until none is in reach.
            const uint status = cut_by_nearest(s, site, key, is_sampled, &reach, visited);
            if (status != UNTOUCHED) {
                return status;
            }
        }
        // All voxels in reach were in the table, or it ended; or the cell is for the stage WITH_EXACT, which can cut it off.
        uint is_last = entry >= SHELLS;
#if WITH_DOMAIN && !WITH_EXACT
        is_last = is_last || ((entry >= INNER_SHELLS) && (is_beyond(s, reach, FAR_FROM) != 0u));
#endif
        if (is_last != 0u) {
            break;
        }
    }
    const uint is_proved = entry > SHELLS;
#if WITH_DOMAIN
    if (reach <= cell->outside) {
        *extent = reach;
        return EMPTY;
    }
#endif
#if SEARCHES_BEYOND
    if (is_proved == 0u) {
        Store copy = *s;
        uint all = *visited;
        const uint status = lanes_alike(complete_by_vertices(&copy, &all));
        *visited = all;
        take_over(s, &copy);
        *extent = extent_of(farthest_of(s));
        return status;
    }
#endif
    *extent = reach;
    return (is_proved != 0u) ? COMPLETE : ((WITH_EXACT != 0) ? LEFT : BEYOND);
}
#endif
