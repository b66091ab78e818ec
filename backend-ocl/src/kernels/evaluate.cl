// The entry point where one work-item computes a cell.

#import "search.cl"
#import "output.cl"

// Computes `count` cells: those of `list` from `first` on, or without a list every `stride`th site from `first` on; every `apart`th work-item
// computes one, since few cells take less time where they do not wait for each other. Each cell that ends is written where the caller has its
// site: `outcome`, `sums`, and where facets are asked for, `rows`: where their records begin, and how many they are. The others are
// appended to a list.
__kernel void cells(CELLS_ARGUMENTS) {
    const uint own = (uint)get_global_id(0) / apart;
    if ((own >= count) || (((uint)get_global_id(0) % apart) != 0u)) {
        return;
    }
    const uint turn = first + (own * stride);
    const uint site = (has_list != 0u) ? list[turn] : turn;
    Store store;
    store.world = WORLD_OF_ARGUMENTS;
    store.tried = 0;
    store.last_tried = 0;
    uint visited = 0;
    uint status = complete_cell(&store, shells, site, &visited);
    if (status == COMPLETE) {
        status = refine(&store);
    }
    CellSums part = (CellSums){ 0 };
    if (status == COMPLETE) {
        status = integrate_cell(&store, params->flags, interior_only, &part);
    }
    const uint i = order[site];
#if WITH_FACETS
    if (status == COMPLETE) {
        uint n = 0;
        for (uint f = 0; f < store.planes; f++) {
            if ((store_tag(&store, f) < TAG_BOX) && (facet_is_above_bound(store.facet[f]) != 0)) {
                n++;
            }
        }
        const uint begin = atomic_add(&counters->facets, n);
        if ((begin + n) > params->facet_room) {
            status = BATCH_FULL;
        } else {
            rows[i] = (ulong2)(params->facet_base + begin, n);
            uint next = begin;
            for (uint f = 0; f < store.planes; f++) {
                const FacetSum sum = store.facet[f];
                if ((store_tag(&store, f) < TAG_BOX) && (facet_is_above_bound(sum) != 0)) {
                    facets[next].area = sum.area;
                    if ((params->flags & FACET_AREAS) == 0u) {
                        write_vector(facet_moments + (3ul * next), sum.moment);
                    }
                    facets[next].neighbor = order[store_tag(&store, f)];
                    facets[next].unused = 0u;
#if WITH_FACET_SECOND
                    facet_seconds[next] = store.facet_second[f];
#endif
                    next++;
                }
            }
        }
    }
#endif
    if (visited > counters->visited) {
        atomic_max(&counters->visited, visited);
    }
    if (store.tried > counters->tried) {
        atomic_max(&counters->tried, store.tried);
    }
    if ((status != COMPLETE) && (status != EMPTY)) {
        if (status == BOUNDARY) {
            surface[atomic_inc(&counters->surface)] = site;
        } else if ((status == P_FULL) || (status == V_FULL)) {
            later[atomic_inc(&counters->later)] = site;
        } else if (status == BATCH_FULL) {
            full[atomic_inc(&counters->full)] = site;
        } else {
            left[atomic_inc(&counters->left)] = site;
        }
        return;
    }
    outcome[i] = (status | ((store.exact != 0u) ? OUTCOME_EXACT : 0u)) | ((store.uncertified != 0u) ? OUTCOME_UNCERTIFIED : 0u);
    if (status != COMPLETE) {
        return;
    }
    write_sums(sums, params->sums_width, i, &part);
}
