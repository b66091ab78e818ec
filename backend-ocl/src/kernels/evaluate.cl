// The entry points.

// No room left for facet records; the cell is tried again with an empty buffer. After the statuses of the cells.
#define FACETS_FULL 16u

// One facet of a finished cell, in the frame of its site.
typedef struct {
    real area;
    real moment[3];
    uint neighbor;
    uint unused;
} FacetRecord;

// Sums that are written for each cell: volume and first moment, and with any flag all others.
#define FEW_SUMS 4u
#define ALL_SUMS 18u

// Computes the cells of the sites `list[0..count]`. For each: `outcome` (status, bit 8: exact arithmetic was needed, bit 9:
// uncertified; visited sites), `sums`, and where facets are asked for their records from `rows.x` on, `rows.y` of them.
__kernel void cells(
    __global const Params *params, __global const real4 *sites, __global const uint *voxels, __global const real *weights,
    __global const Cluster *clusters, __global const uint *roots, __global const uchar4 *shells,
    __global const real *domain_vertices, __global const uint *triangles, __global const uint *lowest_voxels,
    __global const uint *list_offsets, __global const uint *list_entries, __global const int *windings,
    __global const uint *surface_table, __global const uint *list, uint count, uint interior_only, __global uint2 *outcome,
    __global real *sums, __global FacetRecord *facets, __global uint2 *rows, volatile __global uint *facet_count
) {
    const uint i = get_global_id(0);
    if (i >= count) {
        return;
    }
    Store store;
    store.world = (World){
        .params = params, .sites = sites, .voxels = voxels, .weights = weights, .clusters = clusters, .roots = roots,
        .domain_vertices = domain_vertices, .triangles = triangles, .lowest_voxels = lowest_voxels,
        .list_offsets = list_offsets, .list_entries = list_entries, .windings = windings, .surface_table = surface_table
    };
    Search search;
    uint status = complete_cell(&store, &search, shells, list[i]);
    if (status == COMPLETE) {
        status = refine(&store);
    }
    CellSums part = (CellSums){ 0 };
    if (status == COMPLETE) {
        status = integrate_cell(&store, params->flags, interior_only, &part);
    }
#if WITH_FACETS
    if (status == COMPLETE) {
        uint n = 0;
        for (uint f = 0; f < store.planes; f++) {
            if ((store_tag(&store, f) < TAG_BOX) && (facet_is_above_bound(store.facet[f]) != 0)) {
                n++;
            }
        }
        const uint first = atomic_add(facet_count, n);
        if ((first + n) > params->facet_room) {
            status = FACETS_FULL;
        } else {
            rows[i] = (uint2)(first, n);
            uint next = first;
            for (uint f = 0; f < store.planes; f++) {
                const FacetSum sum = store.facet[f];
                if ((store_tag(&store, f) < TAG_BOX) && (facet_is_above_bound(sum) != 0)) {
                    facets[next].area = sum.area;
                    facets[next].moment[0] = sum.moment.x;
                    facets[next].moment[1] = sum.moment.y;
                    facets[next].moment[2] = sum.moment.z;
                    facets[next].neighbor = store_tag(&store, f);
                    next++;
                }
            }
        }
    }
#endif
    outcome[i] = (uint2)(status | (store.exact << 8) | (search.uncertified << 9), search.visited);
    if (status != COMPLETE) {
        return;
    }
    if (params->flags == 0u) {
        __global real *out = sums + ((size_t)i * FEW_SUMS);
        out[0] = part.volume;
        out[1] = part.first.x;
        out[2] = part.first.y;
        out[3] = part.first.z;
        return;
    }
    __global real *out = sums + ((size_t)i * ALL_SUMS);
    out[0] = part.volume;
    out[1] = part.first.x;
    out[2] = part.first.y;
    out[3] = part.first.z;
    out[4] = part.second_diagonal.x;
    out[5] = part.second_diagonal.y;
    out[6] = part.second_diagonal.z;
    out[7] = part.second_mixed.x;
    out[8] = part.second_mixed.y;
    out[9] = part.second_mixed.z;
    out[10] = part.boundary_area;
    out[11] = part.boundary_moment.x;
    out[12] = part.boundary_moment.y;
    out[13] = part.boundary_moment.z;
    out[14] = part.boundary_vector.x;
    out[15] = part.boundary_vector.y;
    out[16] = part.boundary_vector.z;
    out[17] = part.boundary_flux;
}

// What the device thinks of the layouts: sizes, and offsets of the fields behind which padding could hide.
__kernel void probe(__global uint *out) {
    __private Params params;
    out[0] = sizeof(Params);
    out[1] = (uint)((__private char *)&params.grid_dims - (__private char *)&params);
    out[2] = (uint)((__private char *)&params.facet_room - (__private char *)&params);
    out[3] = sizeof(Cluster);
    out[4] = sizeof(FacetRecord);
    out[5] = sizeof(V3);
    out[6] = sizeof(Plane);
    out[7] = sizeof(CellSums);
}
