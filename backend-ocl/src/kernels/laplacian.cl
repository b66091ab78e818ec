// The Laplacian from the areas of facets: rows in the order of the sites along the curve. The same values as `core/src/laplacian.rs`.

#import "params.cl"

// How many facets the cell of each row has, the row of each site, and whether there is a long one.
__kernel void count_facets(COUNT_FACETS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    const uint i = order[row];
    place[i] = row;
    const uint how = outcome[i];
    const uint facets = ((how == NOT_COMPUTED) || ((how & OUTCOME_STATUS) == EMPTY)) ? 0u : (uint)rows[i].y;
    counts[row] = facets;
    if (facets > LONG_ROW) {
        is_long[0] = 1u;
    }
}

// The neighbors of each row, sorted, and the areas of their facets.
__kernel void sort_facets(SORT_FACETS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    const uint begin = offsets[row];
    const uint facets = offsets[row + 1u] - begin;
    __global const FacetRecord *record = records + rows[order[row]].x;
    for (uint k = 0; k < facets; k++) {
        const uint column = place[record[k].neighbor];
        uint at = begin + k;
        while ((at > begin) && (columns[at - 1u] > column)) {
            columns[at] = columns[at - 1u];
            areas[at] = areas[at - 1u];
            at--;
        }
        columns[at] = column;
        areas[at] = record[k].area;
    }
}

// The value of each entry, NaN where the other side does not see the facet; and how many have one.
__kernel void match_facets(MATCH_FACETS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    uint matched = 0;
    const real4 p = sites[row];
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        const uint column = columns[k];
        uint lo = offsets[column];
        uint hi = offsets[column + 1u];
        while (lo < hi) {
            const uint middle = lo + ((hi - lo) / 2u);
            if (columns[middle] < row) {
                lo = middle + 1u;
            } else {
                hi = middle;
            }
        }
        if ((lo < offsets[column + 1u]) && (columns[lo] == row)) {
            const real4 q = sites[column];
            const real x = q.x - p.x;
            const real y = q.y - p.y;
            const real z = q.z - p.z;
            const real distance = sqrt(((x * x) + (y * y)) + (z * z));
            values[k] = (((areas[k] + areas[lo]) / REAL(2.0)) / distance) * params->laplacian_unit;
            matched++;
        } else {
            values[k] = NAN;
        }
    }
    counts[row] = matched;
}

// The entries that have a value, one after the other.
__kernel void pack_facets(PACK_FACETS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    uint next = starts[row];
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        if (!isnan(values[k])) {
            packed_columns[next] = columns[k];
            packed_values[next] = values[k];
            next++;
        }
    }
}
