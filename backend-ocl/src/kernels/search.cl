// The search for the sites that cut a cell. First the voxels around the cell's own, in the order of a table of offsets sorted by distance
// (`search_shells`); then, where those do not prove the cell complete, the pyramid from its root (`search_rest`).
//
// Each work-item looks for its own next candidate, and then all of a group clip together: looking must cost little. So what it needs
// is kept in registers, and distances to voxels are in single precision and units of a voxel.

#import "pyramid.cl"

// Whether a site's bisector is among the cell's half-spaces.
OUTLINE uint has_cut(Store *s, uint site) {
    for (uint f = 0; f < s->planes; f++) {
        if (s->source[f] == site) {
            return 1;
        }
    }
    return 0;
}

// Cuts the cell by the bisector with a site.
INLINE uint cut_by(Store *s, Search *search, uint site) {
    if ((search->is_sampled != 0u) && (has_cut(s, site) != 0u)) {
        return UNTOUCHED;
    }
    const real4 other = s->world.sites[site];
    const V3 d = (V3){ .x = other.x - search->position.x, .y = other.y - search->position.y, .z = other.z - search->position.z };
    search->visited++;
    return clip(s, bisector(d, search->weight - other.w), site);
}

// Cuts off what of the cell is outside the domain: `UNTOUCHED` where the search goes on, or how the cell ended.
OUTLINE uint cap_cell(Store *s, Search *search) {
    const uint status = cap_outside(s, CAP_FROM * s->world.params->grid_width);
    if (status == CUT) {
        measure(s, search);
        return UNTOUCHED;
    }
    return status;
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
        const uint site = sampled_site(s->world.params, s->world.voxels, i);
        const real4 other = s->world.sites[site];
        const V3 d = (V3){ .x = other.x - search->position.x, .y = other.y - search->position.y,
                           .z = other.z - search->position.z };
        if (((site == search->site) || site_is_out_of_reach(search, d, other.w)) || (out_of_reach(s, search, square_of(d), other.w) != 0u)) {
            continue;
        }
        status = cut_by(s, search, site);
        if (status == CUT) {
            measure(s, search);
        } else if (status != UNTOUCHED) {
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
INLINE uint search_shells(Store *s, Search *search, __global const uchar4 *shells) {
    __global const Params *params = s->world.params;
    __global const real4 *sites = s->world.sites;
    __global const uint *voxels = s->world.voxels;
    const V3 p = search->position;
    const uint own = search->site;
    const uint equal = params->equal_weights;
    const uint nx = params->grid_dims[0];
    const uint ny = params->grid_dims[1];
    const uint nz = params->grid_dims[2];
    const real per_width = params->grid_per_width;
    const float fx = (float)(((p.x - params->grid_lo[0]) * per_width) - (real)search->center[0]);
    const float fy = (float)(((p.y - params->grid_lo[1]) * per_width) - (real)search->center[1]);
    const float fz = (float)(((p.z - params->grid_lo[2]) * per_width) - (real)search->center[2]);
    // How much heavier a site of the table may be, and how far vertices may be for none beyond it to cut.
    const Block about = search->about;
    const real left = REAL(1.0) - about.growth;
    const real extra = left * ((about.excess - search->weight) + v3_dot(search->slope, p));
    const real enlarged = params->enlarged;
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
        // How far a site that can cut the cell may be; the same in units of a voxel, squared.
        real reach = security_reach((real)search->span, extra) / left;
        if (enlarged > REAL(0.0)) {
            const real stop = enlarged * security_reach(search->farthest, REAL(0.0));
            left_out = stop < reach;
            reach = fmin(reach, stop);
        }
        const real reach_square = reach * reach;
        const float in_voxels = (float)(reach * per_width) + SHELL_SLACK;
        const float limit = (in_voxels * in_voxels) * 1.00001f;
        uint found = 0xFFFFFFFFu;
        for (;;) {
            if (next < end) {
                const real4 other = sites[next];
                const V3 d = (V3){ .x = other.x - p.x, .y = other.y - p.y, .z = other.z - p.z };
                const real square = square_of(d);
                const uint site = next;
                next++;
                if ((square < reach_square) && (site != own)) {
                    if (equal || (!site_is_out_of_reach(search, d, other.w) && !out_of_reach(s, search, square, other.w))) {
                        found = site;
                        break;
                    }
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
            const uint i = search->center[0] + (uint)ox;
            const uint j = search->center[1] + (uint)oy;
            const uint k = search->center[2] + (uint)oz;
            if ((((((gx * gx) + (gy * gy)) + (gz * gz)) >= limit) || (i >= nx)) || ((j >= ny) || (k >= nz))) {
                continue;
            }
            const uint voxel = i + (nx * (j + (ny * k)));
            next = voxels[voxel];
            end = voxels[voxel + 1u];
            if (!equal && can_skip_node(s, search, 0, i, j, k, 0)) {
                next = end;
            }
        }
        if (found == 0xFFFFFFFFu) {
            search->uncertified |= left_out;
            return ((rest != 0u) || ((real)search->span > about.proved)) ? UNTOUCHED : COMPLETE;
        }
        const uint status = cut_by(s, search, found);
        if (status == CUT) {
            measure(s, search);
        } else if (status != UNTOUCHED) {
            return status;
        }
    }
}

// Goes through the pyramid, but for the voxels of the table of offsets.
OUTLINE uint search_rest(Store *s, Search *search) {
    uint site;
    while (next_in_pyramid(s, search, &site)) {
        const uint status = cut_by(s, search, site);
        if (status == CUT) {
            measure(s, search);
        } else if (status != UNTOUCHED) {
            return status;
        }
    }
    return COMPLETE;
}

// Begins the cell of a site as the container's box.
INLINE uint begin_alone(Store *s, real4 own) {
    __global const Params *params = s->world.params;
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

// Cuts the cell of a site until no other site can cut it. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again.
INLINE uint complete_cell(Store *s, Search *search, __global const uchar4 *shells, uint site) {
    __global const Params *params = s->world.params;
    const real4 own = s->world.sites[site];
    search->site = site;
    search->position = (V3){ .x = own.x, .y = own.y, .z = own.z };
    search->weight = own.w;
    search->uncertified = 0;
    search->visited = 0;
    search->is_capped = params->has_domain == 0;
    search->is_sampled = 0;
    search->where = IN_PYRAMID;
    search->next = 0;
    search->end = 0;
    search->level = params->top_level;
    for (uint axis = 0; axis < 3u; axis++) {
        search->node[axis] = 0;
    }
    search->center[0] = voxel_along(params, 0, own.x);
    search->center[1] = voxel_along(params, 1, own.y);
    search->center[2] = voxel_along(params, 2, own.z);
    search->about = (Block){ .slope = { REAL(0.0), REAL(0.0), REAL(0.0) }, .excess = params->largest_weight, .growth = REAL(0.0), .proved = INFINITY };
    if (params->equal_weights == 0u) {
        search->about = block_about(params, s->world.blocks, own.x, own.y, own.z);
    }
    search->slope = v3(search->about.slope[0], search->about.slope[1], search->about.slope[2]);
    uint status = begin_alone(s, own);
    if (status != COMPLETE) {
        return status;
    }
    measure(s, search);
    status = search_shells(s, search, shells);
    if (status == UNTOUCHED) {
        status = cap_once(s, search);
    }
    return (status == UNTOUCHED) ? search_rest(s, search) : status;
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
