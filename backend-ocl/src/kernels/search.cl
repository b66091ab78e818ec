// The search for the sites that cut a cell, where one work-item computes it: the tree (`tree_alone.cl`), or WITH_TABLE, where weights do not differ,
// first the voxels around the cell's own, in the order of a table of offsets sorted by distance.
//
// Each work-item looks for its own next candidate, and then all of a group clip together: looking must cost little. So what it needs
// is kept in registers, and distances to voxels are in single precision and units of a voxel.

#import "tree_alone.cl"

// Begins the cell of a site as the container's box.
INLINE uint begin_alone(Store *s, uint site) {
    __global const Params *params = s->world.params;
    const real4 own = s->world.sites[site];
    s->own = site;
    s->uncertified = 0;
    s->site = (V3){ .x = own.x, .y = own.y, .z = own.z };
    s->weight = own.w;
    s->exact = 0;
    s->is_fine = 0;
    s->specials = 0;
    s->caps = 0;
    s->last_index = 0xFFFFFFFFu;
    const V3 lo = (V3){ .x = params->box_lo[0] - own.x, .y = params->box_lo[1] - own.y, .z = params->box_lo[2] - own.z };
    const V3 hi = (V3){ .x = params->box_hi[0] - own.x, .y = params->box_hi[1] - own.y, .z = params->box_hi[2] - own.z };
    return begin(s, lo, hi);
}

#if WITH_TABLE
typedef struct {
    // Upper bound of the distance to the farthest vertex.
    real farthest;
    uint visited;
    uint is_capped;
    // Whether sites from all over have cut it, which are not to cut it twice.
    uint is_sampled;
} Search;

// Cuts the cell by the bisector with a site: `UNTOUCHED` where the search goes on, or how the cell ended.
INLINE uint cut_by(Store *s, Search *search, uint site) {
    if ((search->is_sampled != 0u) && (store_was_tried(s, site) != 0u)) {
        return UNTOUCHED;
    }
    search->visited++;
    const uint status = clip(s, bisector(store_way_to(s, site), REAL(0.0)), site);
    if (status == CUT) {
        search->farthest = farthest_vertex(s);
        return UNTOUCHED;
    }
    return status;
}

// Cuts off what of the cell is outside the domain: `UNTOUCHED` where the search goes on, or how the cell ended.
OUTLINE uint cap_cell(Store *s, Search *search) {
    const uint status = cap_outside(s, CAP_FROM * s->world.params->grid_width);
    if (status == CUT) {
        search->farthest = farthest_vertex(s);
        return UNTOUCHED;
    }
    return status;
}

// The distance from which on sites cannot cut the cell, or, so `enlarged` says, are left out; which `left_out` tells.
INLINE real reach_of(Store *s, Search *search, uint *left_out) {
    const real reach = security_reach(search->farthest, REAL(0.0));
    const real enlarged = s->world.params->enlarged;
    *left_out = (enlarged > REAL(0.0)) && (enlarged < REAL(1.0));
    return (*left_out != 0u) ? (enlarged * reach) : reach;
}

// The same, once, for a cell that reaches far; where that does not help, after some sites from all over have made it end half-way to the other
// parts of the domain that it reaches to.
OUTLINE uint cap_far(Store *s, Search *search) {
    search->is_capped = 1;
    uint status = cap_cell(s, search);
    if ((status != UNTOUCHED) || (search->farthest < (SAMPLE_FROM * s->world.params->grid_width))) {
        return status;
    }
    search->is_sampled = 1;
    for (uint i = 0; i < SAMPLE; i++) {
        const uint site = sampled_site(s->world.params, i);
        uint left_out = 0;
        const V3 d = store_way_to(s, site);
        const real reach = reach_of(s, search, &left_out);
        if ((site == s->own) || (v3_dot(d, d) >= (reach * reach))) {
            continue;
        }
        status = cut_by(s, search, site);
        if (status != UNTOUCHED) {
            return status;
        }
    }
    return cap_cell(s, search);
}
INLINE uint cap_once(Store *s, Search *search) {
    const uint is_far = search->farthest >= (CAP_FROM * s->world.params->grid_width);
    return ((is_far != 0u) && (search->is_capped == 0u)) ? cap_far(s, search) : UNTOUCHED;
}

// Whether a cell is known to lie outside the domain: looked for after the voxel itself and those at its faces, edges and corners.
INLINE uint is_outside(Store *s, uint entry) {
    return (((entry == 7u) || (entry == 19u)) || (entry == INNER_SHELLS)) && (s->world.params->has_domain != 0) && (lies_outside(s) != 0);
}

// Goes through the table of offsets. Returns `COMPLETE` where the cell is, `UNTOUCHED` where the rest of the sites has to be searched,
// or how the cell ended.
INLINE uint search_table(Store *s, Search *search, __global const uchar4 *shells) {
    __global const Params *params = s->world.params;
    __global const real4 *sites = s->world.sites;
    __global const uint2 *voxels = s->world.voxels;
    const V3 p = s->site;
    const uint own = s->own;
    const uint nx = params->grid_dims[0];
    const uint ny = params->grid_dims[1];
    const uint nz = params->grid_dims[2];
    const uint cx = voxel_along(params, 0, p.x);
    const uint cy = voxel_along(params, 1, p.y);
    const uint cz = voxel_along(params, 2, p.z);
    const real per_width = params->grid_per_width;
    const float fx = (float)(((p.x - params->grid_lo[0]) * per_width) - (real)cx);
    const float fy = (float)(((p.y - params->grid_lo[1]) * per_width) - (real)cy);
    const float fz = (float)(((p.z - params->grid_lo[2]) * per_width) - (real)cz);
    uint entry = 0;
    uint next = 0;
    uint end = 0;
    uint rest = 0;
    uint left_out = 0;
    for (;;) {
        if (entry >= INNER_SHELLS) {
            const uint status = cap_once(s, search);
            if (status != UNTOUCHED) {
                return status;
            }
        }
        // How far a site that can cut the cell may be, squared; the same in units of a voxel.
        const real reach = reach_of(s, search, &left_out);
        const real reach_square = reach * reach;
        const float in_voxels = (float)(reach * per_width) + SHELL_SLACK;
        const float limit = (in_voxels * in_voxels) * 1.00001f;
        uint found = 0xFFFFFFFFu;
        for (;;) {
            if (next < end) {
                const real4 other = sites[next];
                const V3 d = (V3){ .x = other.x - p.x, .y = other.y - p.y, .z = other.z - p.z };
                const uint site = next;
                next++;
                if ((v3_dot(d, d) < reach_square) && (site != own)) {
                    found = site;
                    break;
                }
                continue;
            }
            if (is_outside(s, entry)) {
                return EMPTY;
            }
            if (entry == SHELLS) {
                rest = 1;
                break;
            }
            const uchar4 shell = shells[entry];
            // All later voxels are at least as far away.
            if ((float)shell.w >= limit) {
                break;
            }
            entry++;
            const int ox = (int)shell.x - (int)SHELL_RADIUS;
            const int oy = (int)shell.y - (int)SHELL_RADIUS;
            const int oz = (int)shell.z - (int)SHELL_RADIUS;
            const float gx = fmax(fmax((float)ox - fx, fx - (float)(ox + 1)), 0.0f);
            const float gy = fmax(fmax((float)oy - fy, fy - (float)(oy + 1)), 0.0f);
            const float gz = fmax(fmax((float)oz - fz, fz - (float)(oz + 1)), 0.0f);
            // Below zero is beyond the end, too.
            const uint i = cx + (uint)ox;
            const uint j = cy + (uint)oy;
            const uint k = cz + (uint)oz;
            if ((((((gx * gx) + (gy * gy)) + (gz * gz)) >= limit) || (i >= nx)) || ((j >= ny) || (k >= nz))) {
                continue;
            }
            const uint2 range = voxels[i + (nx * (j + (ny * k)))];
            next = range.x;
            end = range.y;
        }
        if (found == 0xFFFFFFFFu) {
            s->uncertified |= left_out;
            return (rest != 0u) ? UNTOUCHED : COMPLETE;
        }
        const uint status = cut_by(s, search, found);
        if (status != UNTOUCHED) {
            return status;
        }
    }
}

// Cuts the cell that begins: `COMPLETE`, `UNTOUCHED` where the table does not prove it complete, or how it ended.
INLINE uint search_near_table(Store *s, __global const uchar4 *shells, uint *visited) {
    Search search = (Search){ .farthest = farthest_vertex(s), .visited = 0, .is_capped = s->world.params->has_domain == 0u, .is_sampled = 0 };
    uint status = search_table(s, &search, shells);
    if (status == UNTOUCHED) {
        status = cap_once(s, &search);
    }
    *visited += search.visited;
    return status;
}
#endif

// Cuts the cell of a site until no other site can cut it. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again.
INLINE uint complete_cell(Store *s, __global const uchar4 *shells, uint site, uint *visited) {
    uint status = begin_alone(s, site);
    if (status != COMPLETE) {
        return status;
    }
    const Vantage vantage = vantage_of(s);
#if WITH_TABLE
    status = search_near_table(s, shells, visited);
#else
    status = search_near(s, vantage, visited);
#endif
    return (status == UNTOUCHED) ? search_far(s, vantage.center, 1u, visited) : status;
}

// Computes all vertices in double precision, for the integrals.
INLINE uint refine(Store *s) {
    s->is_fine = 1;
    for (uint v = 0; v < s->vertices; v++) {
        const uint status = place_vertex(s, v);
        if (status != COMPLETE) {
            return status;
        }
    }
    return COMPLETE;
}
