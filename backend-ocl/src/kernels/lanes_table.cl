// The search of the table of offsets (`table_search.cl`), where LANES work-items compute a cell together. What it does not prove complete the
// tree does (`lanes_tree.cl`).

#import "lanes_tree.cl"
#import "table_store.cl"

#if WITH_TABLE
INLINE void store_hold(Store *s, uint c, uint site, uint key) {
    key = (key & ~LANE_BITS) | (s->lane & LANE_BITS);
    s->held_site[0] = (c == 0u) ? site : s->held_site[0];
    s->held_site[1] = (c == 0u) ? s->held_site[1] : site;
    s->held_key[0] = (c == 0u) ? key : s->held_key[0];
    s->held_key[1] = (c == 0u) ? s->held_key[1] : key;
}

INLINE uint store_window(Store *s) { return HELD * LANES; }
INLINE uint store_in_window(Store *s, uint i) { return s->cell->marked[i]; }
INLINE void store_set_in_window(Store *s, uint i, uint x) { s->cell->marked[i] = x; }
INLINE uint store_sum_before(Store *s, uint x, uint *all) {
    const uint below = (1u << s->lane) - 1u;
    uint before = 0;
    uint sum = 0;
    for (uint bit = 0; bit < 7u; bit++) {
        const uint with = lanes_with((x >> bit) & 1u);
        before += popcount(with & below) << bit;
        sum += popcount(with) << bit;
    }
    *all = sum;
    return before;
}

#if WITH_DOMAIN
// Whether a vertex is so many voxels of the site grid away from the site, and may be on the other side of the surface.
INLINE uint is_beyond(Store *s, float reach, double widths) {
    const float from = extent_of(convert_float_rtp(widths * s->world.params->grid_width));
    return (reach > from) && (reach > s->cell->clear);
}
#endif

#if CUTS_OUTSIDE
// Cuts by a sample of all sites, as `cap_far` of `search.cl`: `CUT`, `UNTOUCHED`, or how the cell ended. Each lane has a site, and the nearest of those that may cut it does. (512 sites, of which few cut, one
// after the other took a cell 2 million cycles, where three caps take 600,000; one NVIDIA H200.)
OUTLINE uint sample_together(Store *given, uint own) {
    Store store = taken_store(given);
    Store *s = &store;
    uint end = UNTOUCHED;
    for (uint first = 0; first < SAMPLE; first += LANES) {
        const uint site = sampled_site(s->world.params, first + s->lane);
        const double4 place = s->world.sites[site];
        const float3 way = (float3)((float)(place.x - s->site.x), (float)(place.y - s->site.y), (float)(place.z - s->site.z));
        const uint key = in_order(fma(way.x, way.x, fma(way.y, way.y, way.z * way.z)));
        uint left = lanes_with(site != own);
        while (left != 0u) {
            const uint is_left = (left >> s->lane) & 1u;
            left = lanes_with((is_left != 0u) && (leaves_untouched(s, site) == 0u));
            if (left != 0u) {
                const uint its = (((left >> s->lane) & 1u) != 0u) ? key : NO_SITE;
                const uint nearest = lowest_bit(lanes_with(its == store_least_of_lanes(s, its)));
                left &= ~(1u << nearest);
                const uint j = lane_value(site, nearest);
                const uint status = (has_cut(s, j) != 0u) ? UNTOUCHED : cut_together(s, bisector_with(s, j), j);
                end = (status == UNTOUCHED) ? end : status;
                if ((status != UNTOUCHED) && (status != CUT)) {
                    return give_back(given, s, status);
                }
            }
        }
    }
    return give_back(given, s, end);
}
#endif

// A cell that reaches far is for a stage that CUTS_OUTSIDE: what of it is outside the domain is cut off, once; and where that does not help, again
// after some sites from all over have made it end half-way to the other parts of the domain that it reaches to.
INLINE uint store_look_outside(Store *s, uint offsets, float reach) {
#if CUTS_OUTSIDE
    if (((offsets < INNER_SHELLS) || (s->is_capped != 0u)) || (is_beyond(s, reach, CAP_FROM) == 0u)) {
        return UNTOUCHED;
    }
    s->is_capped = 1;
    const real from = CAP_FROM * s->world.params->grid_width;
    Store copy = *s;
    uint status = lanes_alike(cap_together(&copy, from));
    if (((status == CUT) || (status == UNTOUCHED)) && (is_beyond(&copy, extent_of(farthest_of(&copy)), SAMPLE_FROM) != 0u)) {
        s->is_sampled = 1;
        status = lanes_alike(sample_together(&copy, s->own));
        if ((status == CUT) || (status == UNTOUCHED)) {
            status = lanes_alike(cap_together(&copy, from));
        }
    }
    take_over(s, &copy);
    return (status == UNTOUCHED) ? CUT : status;
#elif WITH_DOMAIN
#if WITH_WEIGHTS
    // (From the site, where `reach` is from where the weights' slope has the cell.)
    reach = (offsets >= INNER_SHELLS) ? extent_of(farthest_of(s)) : 0.0f;
#endif
    return ((offsets >= INNER_SHELLS) && (is_beyond(s, reach, FAR_FROM) != 0u)) ? BEYOND : UNTOUCHED;
#else
    return UNTOUCHED;
#endif
}

#import "generated/table_search.cl"

// Cuts the cell by all sites that can cut it: `COMPLETE`, `EMPTY`, `LEFT`, `OPEN` or `BEYOND`.
INLINE uint complete_by_table(Store *s, Vantage vantage, __global const uchar4 *shells, uint *visited, float *extent) {
    s->shells = shells;
    find_voxel(s);
#if CUTS_OUTSIDE
    s->is_capped = 0;
    s->is_sampled = 0;
#endif
    uint status = UNTOUCHED;
    if (IS_FIRST_TEAM) {
        status = search_table(s, vantage, extent, visited);
#if WITH_WEIGHTS
        *extent = extent_of(farthest_of(s));
#endif
    }
    status = store_first_says(s, status);
#if SEARCHES_BEYOND
    if (status == UNTOUCHED) {
        Store copy = *s;
        uint all = *visited;
        status = lanes_alike(complete_by_vertices(&copy, &all));
        *visited = all;
        take_over(s, &copy);
        if (IS_FIRST_TEAM) {
            *extent = extent_of(farthest_of(s));
        }
    }
#endif
    return (status == UNTOUCHED) ? ((WITH_EXACT != 0) ? LEFT : BEYOND) : status;
}
#endif
