// What one work-item knows while it searches the sites that cut its cell, and the part of the search that goes through the pyramid from its
// root.

#import "reach.cl"

// Where the search of the pyramid stands.
#define IN_PYRAMID 1u
#define AT_END 2u

typedef struct {
    uint site;
    V3 position;
    real weight;
    // Upper bound of the distance to the farthest vertex; and where weights differ, from where their slope has the site (`Block`).
    real farthest;
    float span;
    V3 slope;
    Block about;
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
} Search;

// What is carried from cut to cut.
INLINE void measure(Store *s, Search *search) {
    search->farthest = farthest_vertex(s);
    search->span = convert_float_rtp(search->farthest);
    if (((search->slope.x != REAL(0.0)) || (search->slope.y != REAL(0.0))) || (search->slope.z != REAL(0.0))) {
        const float3 halved = (float3)(0.5f * (float)search->slope.x, 0.5f * (float)search->slope.y, 0.5f * (float)search->slope.z);
        float most = 0.0f;
        for (uint v = 0; v < s->vertices; v++) {
            const float3 d = s->rough[v].xyz + halved;
            const float square = fmax(((d.x * d.x) + (d.y * d.y)) + (d.z * d.z), ROUGH_SQUARE);
            most = fmax(most, (sqrt(square) + (2.0f * s->rough[v].w)) * ROUGH_SAFE);
        }
        search->span = most;
    }
}

// Whether a site at `d` of weight `weight` cannot cut the cell.
INLINE uint site_is_out_of_reach(Search *search, V3 d, real weight) {
    return bisector_distance(d, weight - search->weight, search->slope) >= search->span;
}

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
    const uint in_shells = (distance_1(i, search->center[0]) <= SHELL_RADIUS)
        && (distance_1(j, search->center[1]) <= SHELL_RADIUS) && (distance_1(k, search->center[2]) <= SHELL_RADIUS);
    if (!in_shells && !can_skip_node(s, search, 0, i, j, k, (end - begin) >= WORTH_SHARP_TEST)) {
        search->next = begin;
        search->end = end;
    }
    leave_node(s, search);
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
            if (((site != search->site) && !site_is_out_of_reach(search, d, other.w)) && !out_of_reach(s, search, square_of(d), other.w)) {
                *found = site;
                return 1;
            }
        }
        if (search->where == AT_END) {
            return 0;
        }
        step_in_pyramid(s, search);
    }
}
