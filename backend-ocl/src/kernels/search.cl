// The search for the sites that cut a cell, where one work-item computes it: the tree (`tree_alone.cl`), or WITH_TABLE, where weights are the same,
// first the voxels around the cell's own (`table_search.cl`).

#import "generated/cell_alone.cl"

INLINE uint store_cut(Store *s, Plane plane, uint tag) { return clip(s, plane, tag); }

OUTLINE bool store_was_tried(Store *s, uint j);

INLINE bool store_leaves_out(Store *s) { return s->world.params->enlarged > REAL(0.0); }
INLINE uint store_cut_by(Store *s, uint j) {
#if WITH_TABLE
    if ((s->is_sampled != 0u) && store_was_tried(s, j)) {
        return UNTOUCHED;
    }
#endif
    const V3 d = store_way_to(s, j);
    const real enlarged = s->world.params->enlarged;
    if (enlarged > REAL(0.0)) {
        const real stop = enlarged * (REAL(2.0) * farthest_vertex(s));
        if (v3_dot(d, d) >= (stop * stop)) {
            s->uncertified = 1;
            return UNTOUCHED;
        }
    }
    return clip(s, bisector(d, -store_excess_of(s, j)), j);
}
INLINE uint store_cut_outside(Store *s, real radius) {
    return (lies_outside(s) != 0u) ? EMPTY : cap_outside(s, radius);
}

#import "tree_alone.cl"
#import "table_store.cl"

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
#if WITH_TABLE
    s->is_capped = 0;
    s->is_sampled = 0;
    s->rings = 0;
    find_voxel(s);
#endif
    const V3 lo = (V3){ .x = params->box_lo[0] - own.x, .y = params->box_lo[1] - own.y, .z = params->box_lo[2] - own.z };
    const V3 hi = (V3){ .x = params->box_hi[0] - own.x, .y = params->box_hi[1] - own.y, .z = params->box_hi[2] - own.z };
    return begin(s, lo, hi);
}

#if WITH_TABLE
INLINE uint store_window(Store *s) { return 64u; }
INLINE uint store_in_window(Store *s, uint i) { return s->candidate[i]; }
INLINE void store_set_in_window(Store *s, uint i, uint x) { s->candidate[i] = x; }
INLINE void store_hold(Store *s, uint c, uint site, uint key) { store_set_candidate(s, c, site, key); }
INLINE uint store_sum_before(Store *s, uint x, uint *all) {
    *all = x;
    return 0;
}

// Cuts off what of a cell that reaches far is outside the domain, once; where that does not help, after some sites from all over have made it end
// half-way to the other parts of the domain that it reaches to: `CUT`, or how the cell ended.
OUTLINE uint cap_far(Store *s) {
    const real from = CAP_FROM * s->world.params->grid_width;
    s->is_capped = 1;
    const uint status = cap_outside(s, from);
    if (((status != CUT) && (status != UNTOUCHED)) || (farthest_vertex(s) < (SAMPLE_FROM * s->world.params->grid_width))) {
        return (status == UNTOUCHED) ? CUT : status;
    }
    s->is_sampled = 1;
    for (uint i = 0; i < SAMPLE; i++) {
        const uint site = sampled_site(s->world.params, i);
        const V3 d = store_way_to(s, site);
        const real reach = REAL(2.0) * farthest_vertex(s);
        if ((site != s->own) && (v3_dot(d, d) < (reach * reach))) {
            const uint cut = store_cut_by(s, site);
            if ((cut != CUT) && (cut != UNTOUCHED)) {
                return cut;
            }
        }
    }
    const uint end = cap_outside(s, from);
    return (end == UNTOUCHED) ? CUT : end;
}

// Whether a cell is known to lie outside is looked for after the voxel itself and those at its faces, edges and corners.
INLINE uint store_look_outside(Store *s, uint offsets, float reach) {
    if (s->world.params->has_domain == 0u) {
        return UNTOUCHED;
    }
    const uint rings = ((offsets >= 7u) + (offsets >= 19u)) + (offsets >= INNER_SHELLS);
    if (rings > s->rings) {
        s->rings = rings;
        if (lies_outside(s) != 0u) {
            return EMPTY;
        }
    }
    const real from = REAL(2.0) * (CAP_FROM * s->world.params->grid_width);
    return (((offsets >= INNER_SHELLS) && (s->is_capped == 0u)) && (reach >= (from * from))) ? cap_far(s) : UNTOUCHED;
}

#import "generated/table_search.cl"
#endif

// Cuts the cell of a site until no other site can cut it. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again.
INLINE uint complete_cell(Store *s, __global const uchar4 *shells, uint site, uint *visited) {
    uint status = begin_alone(s, site);
    if (status != COMPLETE) {
        return status;
    }
    const Vantage vantage = vantage_of(s);
#if WITH_TABLE
    s->shells = shells;
    float reach = 0.0f;
    status = search_table(s, vantage, &reach, visited);
#else
    real proven;
    status = search_near(s, vantage, NEAR, visited, &proven);
    if (status == UNTOUCHED) {
        settle_near(s, vantage.center, proven);
    }
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
