// The Laplacian from the areas of facets: rows in the order of the sites along the curve. The same values as `core/src/laplacian.rs`.

#import "params.cl"
#import "facets.cl"

// How many facets the cell of each row has, the row of each site, and whether there is a long one.
__kernel void count_facets(COUNT_FACETS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    const uint i = order[row];
    place[i] = row;
    const uint facets = facets_of_cell(outcome, rows, i);
    counts[row] = facets;
    if (facets > LONG_ROW) {
        is_long[0] = 1u;
    }
}

// What is done for each facet has PER_ROW work-items for each row, side by side, that share its facets out.
#define ROW_OF_ITEM ((uint)(get_global_id(0) / PER_ROW))
#define FIRST_OF_ITEM ((uint)get_global_id(0) % PER_ROW)

// The neighbors of each row, as they come.
__kernel void list_facets(LIST_FACETS_ARGUMENTS) {
    const uint row = ROW_OF_ITEM;
    if (row >= count) {
        return;
    }
    const uint begin = offsets[row];
    const uint facets = offsets[row + 1u] - begin;
    __global const FacetRecord *record = records + rows[order[row]].x;
    for (uint k = FIRST_OF_ITEM; k < facets; k += PER_ROW) {
        listed[begin + k] = place[record[k].neighbor];
    }
}

// The neighbors of each row, sorted, and the areas of their facets: each goes behind those that are before it.
__kernel void sort_facets(SORT_FACETS_ARGUMENTS) {
    const uint row = ROW_OF_ITEM;
    if (row >= count) {
        return;
    }
    const uint begin = offsets[row];
    const uint facets = offsets[row + 1u] - begin;
    __global const FacetRecord *record = records + rows[order[row]].x;
    for (uint k = FIRST_OF_ITEM; k < facets; k += PER_ROW) {
        const uint column = listed[begin + k];
        uint at = begin;
        for (uint other = 0; other < facets; other++) {
            const uint beside = listed[begin + other];
            at += (beside < column) || ((beside == column) && (other < k));
        }
        columns[at] = column;
        areas[at] = record[k].area;
    }
}

// The value of entry k, NaN where the other side does not see the facet, in the area of record k, which nobody needs any more; and how many have one, added to
// `counts`.
__kernel void match_facets(MATCH_FACETS_ARGUMENTS) {
    const uint row = ROW_OF_ITEM;
    if (row >= count) {
        return;
    }
    uint matched = 0;
    const real4 p = sites[row];
    const uint end = offsets[row + 1u];
    for (uint k = offsets[row] + FIRST_OF_ITEM; k < end; k += PER_ROW) {
        const uint column = columns[k];
        uint lo = offsets[column];
        uint hi = offsets[column + 1u];
        const uint last = hi;
        while (lo < hi) {
            const uint middle = lo + ((hi - lo) / 2u);
            if (columns[middle] < row) {
                lo = middle + 1u;
            } else {
                hi = middle;
            }
        }
        if ((lo < last) && (columns[lo] == row)) {
            const real distance = distance_between(p, sites[column]);
            records[k].area = (((areas[k] + areas[lo]) / REAL(2.0)) / distance) * params->laplacian_unit;
            matched++;
        } else {
            records[k].area = NAN;
        }
    }
    if (matched != 0u) {
        atomic_add(counts + row, matched);
    }
}

// The entries that have a value, one after the other.
__kernel void pack_facets(PACK_FACETS_ARGUMENTS) {
    const uint row = ROW_OF_ITEM;
    if (row >= count) {
        return;
    }
    const uint begin = offsets[row];
    const uint end = offsets[row + 1u];
    const uint start = starts[row];
    // (In most rows all have one.)
    const uint is_whole = (starts[row + 1u] - start) == (end - begin);
    for (uint k = begin + FIRST_OF_ITEM; k < end; k += PER_ROW) {
        const real value = records[k].area;
        if (!isnan(value)) {
            uint at = start + (k - begin);
            for (uint before = begin; (is_whole == 0u) && (before < k); before++) {
                at -= isnan(records[before].area) ? 1u : 0u;
            }
            packed_columns[at] = columns[k];
            packed_values[at] = value;
        }
    }
}
