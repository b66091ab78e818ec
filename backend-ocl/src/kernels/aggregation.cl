// The next coarser level of a multigrid by smoothed aggregation (Vaněk, Mandel, Brezina 1996), as `solvers/src/transport/aggregation.rs` makes it on the host, but for
// which unknowns begin an aggregate. Nothing depends on which work-item comes first: who gives way is decided by numbers of the unknowns, and all sums are in
// the order of rows.

#import "generated/interface.cl"

#define NO_AGGREGATE 0xffffffffu

// Whether an entry off the diagonal ties two unknowns strongly.
INLINE bool is_strong(uint row, uint column, real a, __global const double *inverse, real strong) {
    return (column != row) && (a < REAL(0.0)) && ((((a * a) * inverse[row]) * inverse[column]) >= (strong * strong));
}

// A number of an unknown that no other has and that tells nothing of its neighbors', nor is 0 (the finalizer of MurmurHash3, which is one to one).
INLINE uint rank_of(uint i) {
    uint h = i + 1u;
    h ^= h >> 16;
    h *= 0x85ebca6bu;
    h ^= h >> 13;
    h *= 0xc2b2ae35u;
    h ^= h >> 16;
    return h;
}

// Ranks of those that may begin an aggregate, being free as are all that they are strongly tied to; else 0. And whether there are any.
__kernel void rank_free(RANK_FREE_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    uint rank = 0;
    if (root[row] == NO_AGGREGATE) {
        for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
            const uint column = columns[k];
            if (is_strong(row, column, values[k], inverse, strong)) {
                rank = rank_of(row);
                if (root[column] != NO_AGGREGATE) {
                    rank = 0;
                    break;
                }
            }
        }
    }
    ranks[row] = rank;
    if (rank != 0u) {
        is_found[0] = 1u;
    }
}

// The highest rank of an unknown and those that it is strongly tied to.
INLINE uint highest_about(
    uint row, __global const uint *offsets, __global const uint *columns, __global const double *values, __global const double *inverse,
    real strong, __global const uint *ranks
) {
    uint highest = ranks[row];
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        const uint column = columns[k];
        if (is_strong(row, column, values[k], inverse, strong)) {
            highest = max(highest, ranks[column]);
        }
    }
    return highest;
}

__kernel void spread_ranks(SPREAD_RANKS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row < count) {
        near[row] = highest_about(row, offsets, columns, values, inverse, strong, ranks);
    }
}

// Those that no neighbor of a neighbor outranks begin an aggregate.
__kernel void choose_roots(CHOOSE_ROOTS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if ((row < count) && (ranks[row] != 0u) && (highest_about(row, offsets, columns, values, inverse, strong, near) == ranks[row])) {
        root[row] = row;
    }
}

// Who is strongly tied to one that has begun an aggregate joins it.
__kernel void join_roots(JOIN_ROOTS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if ((row >= count) || (root[row] != NO_AGGREGATE)) {
        return;
    }
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        const uint column = columns[k];
        if (is_strong(row, column, values[k], inverse, strong) && (root[column] == column)) {
            root[row] = column;
            return;
        }
    }
}

// Whoever is left joins the aggregate of the neighbor that it is most strongly tied to. And 1 for each root.
__kernel void join_rest(JOIN_REST_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    uint own = root[row];
    if (own == NO_AGGREGATE) {
        real least = REAL(0.0);
        for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
            const uint column = columns[k];
            const real a = values[k];
            if ((a < least) && is_strong(row, column, a, inverse, strong) && (root[column] != NO_AGGREGATE)) {
                least = a;
                own = root[column];
            }
        }
    }
    joined[row] = own;
    numbers[row] = (root[row] == row) ? 1u : 0u;
}

// Entries of a row of the prolongation that there is room for.
#define MOST_TIED 64u

// The number of the aggregate that an unknown has joined.
INLINE uint aggregate_of(__global const uint *joined, __global const uint *numbers, uint i) {
    return (joined[i] == NO_AGGREGATE) ? NO_AGGREGATE : numbers[joined[i]];
}

INLINE uint add_tied(uint *column, real *value, uint n, uint aggregate, real by) {
    if (aggregate == NO_AGGREGATE) {
        return n;
    }
    uint at = 0;
    while ((at < n) && (column[at] != aggregate)) {
        at++;
    }
    if (at == MOST_TIED) {
        return n;
    }
    if (at == n) {
        column[at] = aggregate;
        value[at] = by;
        return n + 1u;
    }
    value[at] += by;
    return n;
}

// (I − ω D⁻¹ A) T, `T` the piecewise constants; weak entries of `A` are added to the diagonal. How many entries each row has; or, where `fills`, these.
__kernel void prolong(PROLONG_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    uint column[MOST_TIED];
    real value[MOST_TIED];
    uint n = 0;
    const uint own = aggregate_of(joined, numbers, row);
    n = add_tied(column, value, n, own, REAL(1.0));
    real sum = REAL(0.0);
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        sum -= is_strong(row, columns[k], values[k], inverse, strong) ? values[k] : REAL(0.0);
    }
    if (sum > REAL(0.0)) {
        // The filtered row sums to zero, as the row does.
        const real scale = omega / sum;
        for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
            if (is_strong(row, columns[k], values[k], inverse, strong)) {
                n = add_tied(column, value, n, aggregate_of(joined, numbers, columns[k]), -scale * values[k]);
            }
        }
        n = add_tied(column, value, n, own, -omega);
    }
    if (fills == 0u) {
        starts[row] = n;
        if (n == MOST_TIED) {
            is_found[0] = 1u;
        }
        return;
    }
    for (uint k = 0; k < n; k++) {
        made_columns[starts[row] + k] = column[k];
        made_values[starts[row] + k] = value[k];
    }
}

// How many entries each column has.
__kernel void count_columns(COUNT_COLUMNS_ARGUMENTS) {
    const uint k = get_global_id(0);
    if (k < count) {
        atomic_inc(counts + columns[k]);
    }
}

// The entries of each column, as they come: their rows and where they stand.
__kernel void list_columns(LIST_COLUMNS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        const uint at = starts[columns[k]] + atomic_inc(listed + columns[k]);
        listed_rows[at] = row;
        listed_places[at] = k;
    }
}

// The same in the order of rows: the transpose. By ROW_GROUP work-items a row.
__kernel __attribute__((reqd_work_group_size(ROW_GROUP, 1, 1))) void sort_columns(SORT_COLUMNS_ARGUMENTS) {
    const uint row = get_group_id(0);
    const uint begin = starts[row];
    const uint end = starts[row + 1u];
    for (uint k = begin + (uint)get_local_id(0); k < end; k += ROW_GROUP) {
        const uint own = listed_rows[k];
        uint at = begin;
        for (uint other = begin; other < end; other++) {
            at += (listed_rows[other] < own) ? 1u : 0u;
        }
        made_columns[at] = own;
        made_values[at] = values[listed_places[k]];
    }
}

// Slots of the table that finds where a column stands in a row, and how many of them may be in use.
#define SLOTS 512u
#define MOST_SLOTS 384u

// The slot of a column, which it takes if it has none; none where too many are in use.
INLINE uint slot_of(__local uint *key, __local uint *used, __local ushort *taken, uint column) {
    // (Multiplicative hashing, Knuth; the high bits are the mixed ones.)
    uint slot = (column * 0x9E3779B1u) >> 23;
    for (uint tries = 0; tries < SLOTS; tries++) {
        const uint found = atomic_cmpxchg(key + slot, NO_AGGREGATE, column);
        if (found == column) {
            return slot;
        }
        if (found == NO_AGGREGATE) {
            const uint n = atomic_inc(used);
            if (n < MOST_SLOTS) {
                taken[n] = (ushort)slot;
            }
            return slot;
        }
        slot = (slot + 1u) & (SLOTS - 1u);
    }
    return NO_AGGREGATE;
}

// A product of matrices, by ROW_GROUP work-items a row, whose columns are in order: the rows of the second one by one, the entries of each side by side. How many entries
// each row has; or, where `fills`, these.
__kernel __attribute__((reqd_work_group_size(ROW_GROUP, 1, 1))) void multiply_rows(MULTIPLY_ROWS_ARGUMENTS) {
    __local uint key[SLOTS];
    __local double sum[SLOTS];
    __local ushort taken[MOST_SLOTS];
    __local uint used[1];
    const uint row = get_group_id(0);
    const uint lane = get_local_id(0);
    for (uint slot = lane; slot < SLOTS; slot += ROW_GROUP) {
        key[slot] = NO_AGGREGATE;
        sum[slot] = REAL(0.0);
    }
    if (lane == 0u) {
        used[0] = 0u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint end = offsets[row + 1u];
    for (uint k = offsets[row]; k < end; k++) {
        const uint middle = columns[k];
        const real a = values[k];
        for (uint m = other_offsets[middle] + lane; m < other_offsets[middle + 1u]; m += ROW_GROUP) {
            const uint slot = slot_of(key, used, taken, other_columns[m]);
            if (slot != NO_AGGREGATE) {
                sum[slot] += a * other_values[m];
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    const uint n = used[0];
    if (fills == 0u) {
        if (lane == 0u) {
            starts[row] = n;
            if (n > MOST_SLOTS) {
                is_found[0] = 1u;
            }
        }
        return;
    }
    for (uint k = lane; k < n; k += ROW_GROUP) {
        const uint slot = taken[k];
        uint at = starts[row];
        for (uint other = 0; other < n; other++) {
            at += (key[taken[other]] < key[slot]) ? 1u : 0u;
        }
        made_columns[at] = key[slot];
        made_values[at] = sum[slot];
    }
}

// Makes each row's sum zero by its diagonal, but for a rounding of its own.
__kernel void balance_rows(BALANCE_ROWS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    real others = REAL(0.0);
    uint diagonal = NO_AGGREGATE;
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        if (columns[k] == row) {
            diagonal = k;
        } else {
            others += values[k];
        }
    }
    if (diagonal != NO_AGGREGATE) {
        values[diagonal] = -others;
    }
}
