// What of the search is beyond the table of offsets, where LANES work-items compute a cell together: twice as far each time, through nodes of the
// pyramid that are twice as large, of which each lane has its own, until it comes to a block whose sites may cut the cell.

#import "bounds.cl"
#import "lanes_reach.cl"

#if SEARCHES_FAR

// The squared distance of a node's box from the site; no less than that of any node that it is in.
INLINE real square_to_node(Store *s, GridNode node) {
    const real3 site = (real3)(s->site.x, s->site.y, s->site.z);
    const real3 gap = fmax(fabs(middle_of(s->world.params, node) - site) - half_width(s->world.params, node.level), REAL(0.0));
    return dot(gap, gap);
}

// Whether a site of a node, which is at that distance, may cut the cell.
INLINE uint node_reaches(Store *s, Reach reach, GridNode node, real square) {
    __global const Params *params = s->world.params;
    if (s->world.weights[params->level_begin[node.level] + index_at(params, node)] == -INFINITY) {
        return 0;
    }
#if WITH_WEIGHTS
    const real3 site = (real3)(s->site.x, s->site.y, s->site.z);
    const real3 middle = middle_of(params, node);
    const real half_node = half_width(params, node.level);
    const real4 bound = s->world.bounds[bound_at(params, node)];
    const real3 slope = (real3)(s->about.slope.x, s->about.slope.y, s->about.slope.z);
    const real rest = largest_rest(bound, middle, half_node, slope, site, REAL(0.0), REAL(0.0)) - s->weight;
    const float far = reach_about(reach.span, convert_float_rtp(rest));
    if (convert_float_rtz(square) >= (far * far)) {
        return 0;
    }
    // |d|² − W, at least, over 2|d|, at most (`bound_blocks`).
    const real height = s->weight - largest_rest(bound, middle, half_node, slope, site, REAL(0.0), REAL(1.0));
    return height <= ((REAL(2.000001) * (real)reach.span) * length(fabs(middle - site) + half_node));
#else
    return convert_float_rtz(square) < reach.extent;
#endif
}

// The sharp test (`box_cannot_cut`): whether a site of a node may cut off a vertex. It may be the site at d, if |d|² − 2p·d < w' − w for the vertex p.
INLINE uint reaches_vertex(Store *s, GridNode node) {
    __global const Params *params = s->world.params;
    const real3 site = (real3)(s->site.x, s->site.y, s->site.z);
    const real3 middle = middle_of(params, node);
    const real half_node = half_width(params, node.level);
    const real length_1 = norm_1_of(middle - site) + (REAL(3.0) * half_node);
#if WITH_WEIGHTS
    const real4 bound = s->world.bounds[bound_at(params, node)];
#else
    const real4 bound = (real4)((real3)(REAL(0.0)), s->weight);
#endif
    uint is_reached = 0;
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        const float4 p = s->cell->rough[v];
        const real3 slope = REAL(-2.0) * convert_double3(p.xyz);
        const real height = s->weight - largest_rest(bound, middle, half_node, slope, site, REAL(0.0), REAL(1.0));
        is_reached |= height <= ((REAL(2.001) * (real)p.w) * length_1);
    }
    return lanes_with(is_reached) != 0u;
}

// Whether a site's voxel is not in the table of offsets about voxel `center`.
INLINE uint is_beyond_table(Store *s, uint3 center, real4 site) {
    __global const Params *params = s->world.params;
    const uint3 voxel = (uint3)(voxel_along(params, 0, site.x), voxel_along(params, 1, site.y), voxel_along(params, 2, site.z));
    const uint3 off = abs_diff(voxel, center);
    return max(max(off.x, off.y), off.z) > SHELL_RADIUS;
}

// Cuts by the sites of a node that are beyond the table of offsets: `UNTOUCHED`, or how the cell ended.
INLINE uint cut_by_node(Store *s, GridNode node, uint3 center, uint own, uint is_sampled, Reach *reach, uint *visited) {
    __global const Params *params = s->world.params;
    const V3 p = s->site;
    for (uint row = 0; row < rows_of(node.level); row++) {
        const uint2 in_row = sites_of_row(params, s->world.voxels, node, row);
        for (uint first = in_row.x; first < in_row.y; first += LANES) {
            const uint site[2] = { first + s->lane, own };
            uint key[2] = { USED, USED };
            if ((site[0] < in_row.y) && (site[0] != own)) {
                const real4 other = s->world.sites[site[0]];
                const uint its = key_of(s, (V3){ .x = other.x - p.x, .y = other.y - p.y, .z = other.z - p.z }, other.w);
                const uint is_near = its < key_limit(*reach);
                key[0] = ((is_near != 0u) && (is_beyond_table(s, center, other) != 0u)) ? its : USED;
            }
            const uint status = cut_by_nearest(s, site, key, is_sampled, reach, visited);
            if (status != UNTOUCHED) {
                return status;
            }
        }
    }
    return UNTOUCHED;
}

// Cuts a cell by all sites that can and are beyond the table of offsets about voxel x, y, z: `COMPLETE`, or how the cell ended.
OUTLINE uint search_far(Store *given, uint x, uint y, uint z, uint own, uint is_sampled, uint *visited) {
    Store store = taken_store(given);
    Store *s = &store;
    __global const Params *params = s->world.params;
    Reach reach = reach_now(s);
    const uint leaf = block_level(params);
    const uint side = max(max(params->grid_dims[0], params->grid_dims[1]), params->grid_dims[2]);
    const uint3 center = (uint3)(x, y, z);
    const uint3 last = (uint3)(params->grid_dims[0], params->grid_dims[1], params->grid_dims[2]) - 1u;
    real done = REAL(-1.0);
    uint voxels = SHELL_RADIUS;
    uint level = leaf;
    for (;;) {
        // 1. The nodes of a level that are about so near.
        voxels *= 2u;
        level = min(level + 1u, params->top_level);
        const uint about = min(voxels, side) + 2u;
        const uint3 from = (center - min(center, about)) >> level;
        const uint3 count = ((min(center + about, last) >> level) + 1u) - from;
        const uint nodes = (count.x * count.y) * count.z;
        const real radius = (real)voxels * params->grid_width;
        const real limit = (voxels < side) ? (radius * radius) : INFINITY;
        uint turn = s->lane;
        uint is_at_root = 1;
        GridNode node = (GridNode){ .level = level, .i = 0, .j = 0, .k = 0 };
        for (;;) {
            // 2. Each lane to its next block.
            GridNode mine = node;
            uint is_found = 0;
            while ((turn < nodes) && (is_found == 0u)) {
                if (is_at_root != 0u) {
                    node = (GridNode){ .level = level, .i = from.x + (turn % count.x), .j = from.y + ((turn / count.x) % count.y),
                                       .k = from.z + ((turn / count.x) / count.y) };
                    is_at_root = 0;
                }
                const real square = square_to_node(s, node);
                if ((square < limit) && (node_reaches(s, reach, node, square) != 0u)) {
                    if (node.level > leaf) {
                        node = first_child(node);
                        continue;
                    }
                    mine = node;
                    is_found = square >= done;
                }
                if (next_node(params, level, &node) == 0u) {
                    turn += LANES;
                    is_at_root = 1;
                }
            }
            uint all = lanes_with(is_found);
            if (all == 0u) {
                break;
            }
            // 3. All lanes through the sites of each of these.
            while (all != 0u) {
                const uint lane = lowest_bit(all);
                all &= all - 1u;
                const GridNode its = (GridNode){
                    .level = leaf, .i = lane_value(mine.i, lane), .j = lane_value(mine.j, lane), .k = lane_value(mine.k, lane)
                };
                if (reaches_vertex(s, its) != 0u) {
                    const uint status = cut_by_node(s, its, center, own, is_sampled, &reach, visited);
                    if (status != UNTOUCHED) {
                        return give_back(given, s, status);
                    }
                }
            }
        }
#if WITH_WEIGHTS
        const uint is_done = reach.span <= s->about.proved;
#else
        const uint is_done = convert_float_rtz(limit) >= reach.extent;
#endif
        if ((voxels >= side) || (is_done != 0u)) {
            return give_back(given, s, COMPLETE);
        }
        done = limit;
    }
}
#endif
