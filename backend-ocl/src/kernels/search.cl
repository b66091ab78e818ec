// The search for the sites that cut a cell. First the voxels around the cell's own, in the order of a table of offsets sorted by distance
// (`search_shells`); then, where those do not prove the cell complete, the pyramid from its root, and the trees of crowded voxels
// (`search_rest`).
//
// Each work-item looks for its own next candidate, and then all of a group clip together: looking must cost little. So what it needs
// is kept in registers, and distances to voxels are in single precision and units of a voxel.

// Sites in a voxel from which on the sharp test costs less than what it saves.
#define WORTH_SHARP_TEST 8u

// Where the search of the pyramid stands.
#define IN_PYRAMID 1u
#define IN_TREE 2u
#define AT_END 3u

typedef struct {
    uint site;
    V3 position;
    real weight;
    // Upper bound of the distance to the farthest vertex.
    real farthest;
    uint uncertified;
    uint visited;
    uint is_capped;
    // Whether sites from all over have cut it, which are not to cut it twice.
    uint is_sampled;
    uint where;
    // Sites at hand.
    uint next;
    uint end;
    uint center[3];
    uint level;
    uint node[3];
    // Nodes of a tree still to be searched: at most its depth.
    uint depth;
    uint stack[40];
} Search;

INLINE real square_of(V3 d) { return ((d.x * d.x) + (d.y * d.y)) + (d.z * d.z); }

// Whether sites of weight at most `largest`, at squared distance at least `square`, can be left out: by the quick test, or because
// `enlarged` says so.
INLINE uint out_of_reach(Store *s, Search *search, real square, real largest) {
    const real reach = security_reach(search->farthest, largest - search->weight);
    if (square >= (reach * reach)) {
        return 1;
    }
    const real enlarged = s->world.params->enlarged;
    if (enlarged > REAL(0.0)) {
        const real left_out = enlarged * security_reach(search->farthest, REAL(0.0));
        if (square >= (left_out * left_out)) {
            search->uncertified = 1;
            return 1;
        }
    }
    return 0;
}

// How far x is outside [lo, hi].
INLINE real gap_to(real x, real lo, real hi) { return fmax(fmax(lo - x, x - hi), REAL(0.0)); }

// Whether no site in the box can cut the cell: the quick test, then, if asked for, the sharp one.
INLINE uint can_skip(Store *s, Search *search, V3 lo, V3 hi, real largest, uint sharp) {
    if (largest == -INFINITY) {
        return 1;
    }
    const V3 p = search->position;
    const V3 gap = (V3){ .x = gap_to(p.x, lo.x, hi.x), .y = gap_to(p.y, lo.y, hi.y), .z = gap_to(p.z, lo.z, hi.z) };
    if (out_of_reach(s, search, square_of(gap), largest)) {
        return 1;
    }
    return (sharp != 0) && (box_cannot_cut(s, sub(lo, p), sub(hi, p), largest - search->weight) != 0);
}

INLINE uint node_index(Store *s, uint level, uint i, uint j, uint k) {
    return i + (level_dim(s->world.params, 0, level) * (j + (level_dim(s->world.params, 1, level) * k)));
}

// Corner of a node, padded outward by what rounding can misplace a site by (`SiteGrid::node_box`).
INLINE real node_side(Store *s, uint axis, uint i, real pad) {
    return (s->world.params->grid_lo[axis] + ((real)i * s->world.params->grid_width)) + pad;
}

INLINE uint can_skip_node(Store *s, Search *search, uint level, uint i, uint j, uint k, uint sharp) {
    __global const Params *params = s->world.params;
    const real largest = s->world.weights[params->level_begin[level] + node_index(s, level, i, j, k)];
    const V3 lo = (V3){ .x = node_side(s, 0, i << level, -params->grid_pad[0]),
                        .y = node_side(s, 1, j << level, -params->grid_pad[1]),
                        .z = node_side(s, 2, k << level, -params->grid_pad[2]) };
    const V3 hi = (V3){ .x = node_side(s, 0, (i + 1u) << level, params->grid_pad[0]),
                        .y = node_side(s, 1, (j + 1u) << level, params->grid_pad[1]),
                        .z = node_side(s, 2, (k + 1u) << level, params->grid_pad[2]) };
    return can_skip(s, search, lo, hi, largest, sharp);
}

// The octant of a node's children in which the cell's site is, or nearest.
INLINE uint near_octant(Store *s, Search *search, uint level, uint i, uint j, uint k) {
    const uint x = search->position.x > node_side(s, 0, ((i << 1) + 1u) << (level - 1u), REAL(0.0)) ? 1u : 0u;
    const uint y = search->position.y > node_side(s, 1, ((j << 1) + 1u) << (level - 1u), REAL(0.0)) ? 2u : 0u;
    const uint z = search->position.z > node_side(s, 2, ((k << 1) + 1u) << (level - 1u), REAL(0.0)) ? 4u : 0u;
    return (x | y) | z;
}

// Goes to the child with number `turn` in the order of nearness, or the next that is inside the grid; 0 where there is none.
INLINE uint enter_child(Store *s, Search *search, uint level, uint i, uint j, uint k, uint turn) {
    const uint near = near_octant(s, search, level, i, j, k);
    for (uint t = turn; t < 8u; t++) {
        const uint octant = t ^ near;
        const uint ci = (i << 1) + (octant & 1u);
        const uint cj = (j << 1) + ((octant >> 1) & 1u);
        const uint ck = (k << 1) + (octant >> 2);
        if ((ci < level_dim(s->world.params, 0, level - 1u)) && (cj < level_dim(s->world.params, 1, level - 1u)) && (ck < level_dim(s->world.params, 2, level - 1u))) {
            search->level = level - 1u;
            search->node[0] = ci;
            search->node[1] = cj;
            search->node[2] = ck;
            return 1;
        }
    }
    return 0;
}

// Goes to the next node that is not below the present one.
OUTLINE void leave_node(Store *s, Search *search) {
    while (search->level < s->world.params->top_level) {
        const uint octant = (search->node[0] & 1u) | ((search->node[1] & 1u) << 1) | ((search->node[2] & 1u) << 2);
        const uint level = search->level + 1u;
        const uint i = search->node[0] >> 1;
        const uint j = search->node[1] >> 1;
        const uint k = search->node[2] >> 1;
        const uint turn = octant ^ near_octant(s, search, level, i, j, k);
        if (enter_child(s, search, level, i, j, k, turn + 1u)) {
            return;
        }
        search->level = level;
        search->node[0] = i;
        search->node[1] = j;
        search->node[2] = k;
    }
    search->where = AT_END;
}

INLINE uint distance_1(uint a, uint b) { return a > b ? a - b : b - a; }

// One step through the pyramid.
OUTLINE void step_in_pyramid(Store *s, Search *search) {
    const uint level = search->level;
    const uint i = search->node[0];
    const uint j = search->node[1];
    const uint k = search->node[2];
    if (level > 0u) {
        if (can_skip_node(s, search, level, i, j, k, 1) || !enter_child(s, search, level, i, j, k, 0)) {
            leave_node(s, search);
        }
        return;
    }
    const uint voxel = node_index(s, 0, i, j, k);
    const uint begin = s->world.voxels[voxel];
    const uint end = s->world.voxels[voxel + 1u];
    const uint is_crowded = (s->world.params->has_clusters != 0) && ((end - begin) > CROWDED);
    const uint in_shells = (distance_1(i, search->center[0]) <= SHELL_RADIUS)
        && (distance_1(j, search->center[1]) <= SHELL_RADIUS) && (distance_1(k, search->center[2]) <= SHELL_RADIUS);
    if ((is_crowded || !in_shells) && !can_skip_node(s, search, 0, i, j, k, (end - begin) >= WORTH_SHARP_TEST)) {
        if (is_crowded) {
            search->stack[0] = s->world.roots[voxel];
            search->depth = 1;
        } else {
            search->next = begin;
            search->end = end;
        }
    }
    leave_node(s, search);
    if (search->depth > 0u) {
        // The pyramid goes on where `level` and `node` say, once the tree is done.
        search->where = (search->where == AT_END) ? (IN_TREE | 4u) : IN_TREE;
    }
}

// One step through the tree of a crowded voxel.
OUTLINE void step_in_tree(Store *s, Search *search) {
    if (search->depth == 0u) {
        search->where = (search->where & 4u) ? AT_END : IN_PYRAMID;
        return;
    }
    search->depth--;
    const Cluster node = s->world.clusters[search->stack[search->depth]];
    const V3 lo = (V3){ .x = node.lo[0], .y = node.lo[1], .z = node.lo[2] };
    const V3 hi = (V3){ .x = node.hi[0], .y = node.hi[1], .z = node.hi[2] };
    if (can_skip(s, search, lo, hi, node.largest_weight, 1)) {
        return;
    }
    if (node.children == 0u) {
        search->next = node.begin;
        search->end = node.end;
        return;
    }
    // The nearer child is taken first: the one whose box is at the smaller power distance.
    const V3 p = search->position;
    real power[2];
    for (uint c = 0; c < 2u; c++) {
        const Cluster child = s->world.clusters[node.children + c];
        const V3 gap = (V3){ .x = gap_to(p.x, child.lo[0], child.hi[0]), .y = gap_to(p.y, child.lo[1], child.hi[1]),
                             .z = gap_to(p.z, child.lo[2], child.hi[2]) };
        power[c] = square_of(gap) - child.largest_weight;
    }
    const uint near = (power[1] < power[0]) ? 1u : 0u;
    search->stack[search->depth] = node.children + (1u - near);
    search->stack[search->depth + 1u] = node.children + near;
    search->depth += 2u;
}

// The next site of the pyramid that may cut the cell; 0 where there is none.
OUTLINE uint next_in_pyramid(Store *s, Search *search, uint *found) {
    for (;;) {
        while (search->next < search->end) {
            const uint site = search->next;
            search->next = site + 1u;
            const real4 other = s->world.sites[site];
            const V3 d = (V3){ .x = other.x - search->position.x, .y = other.y - search->position.y,
                               .z = other.z - search->position.z };
            if ((site != search->site) && !out_of_reach(s, search, square_of(d), other.w)) {
                *found = site;
                return 1;
            }
        }
        if (search->where == IN_PYRAMID) {
            step_in_pyramid(s, search);
        } else if (search->where == AT_END) {
            return 0;
        } else {
            step_in_tree(s, search);
        }
    }
}

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
        search->farthest = farthest_vertex(s);
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
    __global const uint *dims = s->world.params->grid_dims;
    const ulong sites = s->world.voxels[dims[0] * (dims[1] * dims[2])];
    for (uint i = 0; i < SAMPLE; i++) {
        const uint site = (uint)((i * sites) / SAMPLE);
        const real4 other = s->world.sites[site];
        const V3 d = (V3){ .x = other.x - search->position.x, .y = other.y - search->position.y,
                           .z = other.z - search->position.z };
        if ((site == search->site) || (out_of_reach(s, search, square_of(d), other.w) != 0u)) {
            continue;
        }
        status = cut_by(s, search, site);
        if (status == CUT) {
            search->farthest = farthest_vertex(s);
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
    const uint crowded = (params->has_clusters != 0) ? CROWDED : 0xFFFFFFFFu;
    const uint nx = params->grid_dims[0];
    const uint ny = params->grid_dims[1];
    const uint nz = params->grid_dims[2];
    const real per_width = params->grid_per_width;
    const float fx = (float)(((p.x - params->grid_lo[0]) * per_width) - (real)search->center[0]);
    const float fy = (float)(((p.y - params->grid_lo[1]) * per_width) - (real)search->center[1]);
    const float fz = (float)(((p.z - params->grid_lo[2]) * per_width) - (real)search->center[2]);
    // How much heavier a site of the table may be, and how far vertices may be for none beyond it to cut.
    const uint has_blocks = (equal == 0u) && (params->has_clusters == 0u);
    const real2 about = (has_blocks != 0u) ? block_about(params, s->world.blocks, p.x, p.y, p.z)
        : (real2)(params->largest_weight, INFINITY);
    const real extra = about.x - search->weight;
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
        real reach = security_reach(search->farthest, extra);
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
                    if (equal || !out_of_reach(s, search, square, other.w)) {
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
            if ((end - next) > crowded) {
                rest = 1;
                next = end;
            } else if (!equal && can_skip_node(s, search, 0, i, j, k, 0)) {
                next = end;
            }
        }
        if (found == 0xFFFFFFFFu) {
            search->uncertified |= left_out;
            return ((rest != 0u) || (search->farthest > about.y)) ? UNTOUCHED : COMPLETE;
        }
        const uint status = cut_by(s, search, found);
        if (status == CUT) {
            search->farthest = farthest_vertex(s);
        } else if (status != UNTOUCHED) {
            return status;
        }
    }
}

// Goes through the pyramid, but for the voxels of the table of offsets that are not crowded.
OUTLINE uint search_rest(Store *s, Search *search) {
    uint site;
    while (next_in_pyramid(s, search, &site)) {
        const uint status = cut_by(s, search, site);
        if (status == CUT) {
            search->farthest = farthest_vertex(s);
        } else if (status != UNTOUCHED) {
            return status;
        }
    }
    return COMPLETE;
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
    search->depth = 0;
    search->level = params->top_level;
    for (uint axis = 0; axis < 3u; axis++) {
        search->node[axis] = 0;
    }
    search->center[0] = voxel_along(params, 0, own.x);
    search->center[1] = voxel_along(params, 1, own.y);
    search->center[2] = voxel_along(params, 2, own.z);
    s->site = search->position;
    s->weight = own.w;
    s->exact = 0;
    s->is_fine = 0;
    s->specials = 0;
    s->caps = 0;
    s->last_index = 0xFFFFFFFFu;
    const V3 lo = (V3){ .x = params->box_lo[0] - own.x, .y = params->box_lo[1] - own.y, .z = params->box_lo[2] - own.z };
    const V3 hi = (V3){ .x = params->box_hi[0] - own.x, .y = params->box_hi[1] - own.y, .z = params->box_hi[2] - own.z };
    uint status = begin(s, lo, hi);
    if (status != COMPLETE) {
        return status;
    }
    search->farthest = farthest_vertex(s);
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
