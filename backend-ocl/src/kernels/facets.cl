// Facets as the caller has them: rows in the order of the sites, sorted by neighbor, in the caller's lengths. The same values as `core/src/assemble/facets.rs`.

#import "params.cl"
#import "generated/cell_types.cl"

// How many facets the cell of site i has.
INLINE uint facets_of_cell(__global const uint *outcome, __global const ulong2 *rows, uint i) {
    const uint how = outcome[i];
    return ((how == NOT_COMPUTED) || ((how & OUTCOME_STATUS) == EMPTY)) ? 0u : (uint)rows[i].y;
}

// The distance of two sites.
INLINE real distance_between(real4 p, real4 q) {
    const real x = q.x - p.x;
    const real y = q.y - p.y;
    const real z = q.z - p.z;
    return sqrt(((x * x) + (y * y)) + (z * z));
}

__kernel void count_rows(COUNT_ROWS_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i >= count) {
        return;
    }
    counts[i] = facets_of_cell(outcome, rows, i);
}

// The facets of each row, by PER_ROW work-items: each goes behind those that are before it.
__kernel void write_rows(WRITE_ROWS_ARGUMENTS) {
    const uint i = (uint)(get_global_id(0) / PER_ROW);
    if (i >= count) {
        return;
    }
    const uint begin = offsets[i];
    const uint facets = offsets[i + 1u] - begin;
    const ulong first = rows[i].x;
    const real4 p = placed[i];
    const real site[3] = { p.x, p.y, p.z };
    for (uint k = (uint)get_global_id(0) % PER_ROW; k < facets; k += PER_ROW) {
        const FacetRecord facet = records[first + k];
        uint at = begin;
        for (uint other = 0; other < facets; other++) {
            const uint beside = records[first + other].neighbor;
            at += (beside < facet.neighbor) || ((beside == facet.neighbor) && (other < k));
        }
        neighbors[at] = facet.neighbor;
        areas[at] = facet.area * area_unit;
        distances[at] = distance_between(p, placed[facet.neighbor]) * params->frame_unit;
        for (uint axis = 0; axis < 3u; axis++) {
            const real along = site[axis] + (moments[(3ul * (first + k)) + axis] / facet.area);
            barycenters[(3ul * at) + axis] = (along * params->frame_unit) + params->frame_shift[axis];
        }
        if (has_seconds != 0u) {
            const FacetSecond second = seconds[first + k];
            const real entries[6] = { second.diagonal.x, second.diagonal.y, second.diagonal.z, second.mixed.x, second.mixed.y, second.mixed.z };
            for (uint entry = 0; entry < 6u; entry++) {
                second_moments[(6ul * at) + entry] = entries[entry] * second_unit;
            }
        }
    }
}
