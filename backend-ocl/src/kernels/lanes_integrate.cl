// The integrals of a cell that LANES work-items compute together.

#import "lanes_records.cl"
#import "lanes_reach.cl"
#import "lanes_sums.cl"
#import "lanes_surface.cl"

#if WITH_DOMAIN
// How many voxels the surface meets of those that the box of the vertices, which are in single precision, and the site may; and the lowest
// of them.
INLINE uint surface_near_box(Store *s, Voxel *lo) {
    const float per_width = ROUGH_SAFE * convert_float_rtp(s->world.params->domain_per_width);
    float3 below = (float3)(0.0f, 0.0f, 0.0f);
    float3 above = below;
    UNROLLED_WORDS
    for (uint word = 0; word < WORDS; word++) {
        const uint v = (word * LANES) + s->lane;
        if (v < s->vertices) {
            const float4 p = s->cell->rough[v];
            below = fmax(below, (float3)(p.w - p.x, p.w - p.y, p.w - p.z));
            above = fmax(above, (float3)(p.w + p.x, p.w + p.y, p.w + p.z));
        }
    }
    const float down[3] = { lanes_largest(below.x), lanes_largest(below.y), lanes_largest(below.z) };
    const float up[3] = { lanes_largest(above.x), lanes_largest(above.y), lanes_largest(above.z) };
    const double site[3] = { s->site.x, s->site.y, s->site.z };
    uint low[3];
    uint high[3];
    for (uint k = 0; k < 3u; k++) {
        const float at = place_in_domain(s->world.params, k, site[k]);
        // (Twice: once for the sums, once for the products.)
        low[k] = voxel_in_domain(s->world.params, k, at - ((((down[k] * ROUGH_SAFE) * per_width) * ROUGH_SAFE) + slack_at(at)));
        high[k] = voxel_in_domain(s->world.params, k, at + ((((up[k] * ROUGH_SAFE) * per_width) * ROUGH_SAFE) + slack_at(at)));
    }
    *lo = (Voxel){ .i = low[0], .j = low[1], .k = low[2] };
    return store_surface_voxels(s, *lo, (Voxel){ .i = high[0], .j = high[1], .k = high[2] });
}
#endif

// The integrals of a complete cell that reaches as far as `extent` says (`extent_of`), and where they are asked for those of its facets: `COMPLETE`, `EMPTY`,
// `LEFT`, `OPEN` or, of one that another stage takes, `FINISHED`.
INLINE uint integrate_together(Store *s, uint flags, float extent, CellSums *sums, FacetSum *facet) {
    CELL_SPACE Cell *cell = s->cell;
    // Whether the site is outside its cell, or only not strictly inside.
    uint outside = 0;
    uint on_wall = 0;
    for (uint f = s->lane; f < s->planes; f += LANES) {
        outside |= cell->plane[f].d < REAL(0.0);
        on_wall |= cell->plane[f].d == REAL(0.0);
    }
    outside = lanes_with(outside);
    *sums = (CellSums){ 0 };
    real winding = REAL(1.0);
    V3 center = v3(REAL(0.0), REAL(0.0), REAL(0.0));
#if WITH_DOMAIN
    Voxel lo = (Voxel){ .i = 0, .j = 0, .k = 0 };
#if TAKES_CELLS
    uint near = cell->is_near;
    winding = (real)cell->winding;
#else
    uint near = 0;
    if (extent <= cell->clear) {
        winding = (real)cell->winding;
    } else {
        near = surface_near_box(s, &lo);
        winding = (real)store_winding(s, lo);
    }
#endif
#if GIVES_CELLS
    cell->is_near = (near != 0u) ? 1u : 0u;
    cell->winding = (int)winding;
    if (near != 0u) {
        return FINISHED;
    }
#else
    if (near != 0u) {
        Store copy = *s;
        CellSums part = (CellSums){ 0 };
        real inner = REAL(0.0);
        const uint is_out = outside | lanes_with(on_wall);
        const uint ended = lanes_alike(meet_surface(&copy, outside, is_out, flags, &inner, &part, facet));
        s->planes = lanes_alike(copy.planes);
        s->exact |= copy.exact;
        s->tried = copy.tried;
        if (ended != UNTOUCHED) {
            *sums = part;
            return ended;
        }
        winding = inner;
    }
#endif
    if (winding == REAL(0.0)) {
        return EMPTY;
    }
#endif
#if GIVES_CELLS
    if (gives_all(s) != 0u) {
        return FINISHED;
    }
#endif
#if !SINGLE
    uint exact = 0;
    if (refine_together(cell, s->lane, s->vertices, &exact) != COMPLETE) {
        return UNSETTLED;
    }
    s->exact |= exact;
#endif
    // (In single precision the rough vertices are the fine ones.)
    s->is_fine = 1;
    // The common point of the tetrahedra: the site where it is inside, else the middle of the vertices' box.
    if (outside != 0u) {
        turn_to_box(s);
        center = scale(REAL(0.5), add(store_position(s, 0), store_position(s, 1)));
    }
#if WITH_FACETS
    clear_facets(facet);
#endif
    const uint summed = sum_together(cell, s->lane, s->vertices, winding, center, REAL(0.0), flags, sums, s->planes, facet);
    if (summed != COMPLETE) {
        return UNSETTLED;
    }
#if SINGLE
    // (Twice: the half-spaces are rounded, too, each by fewer roundings than the bound has for a vertex across its planes.)
    return ((2.0f * sums->rounding) < (SHARE_OF_VOLUME * fabs(sums->volume))) ? COMPLETE : OPEN;
#else
    return settle_sums(s, sums);
#endif
}
