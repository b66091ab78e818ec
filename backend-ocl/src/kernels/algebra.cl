// Sparse linear algebra (`core/src/algebra.rs`). Sums are over fixed parts, so that they have the same bits whenever they are computed.

#import "generated/interface.cl"

// A row times x, where that has `width` numbers for each, of which this is number `which`. `per_row` work-items, side by side and a power of two, share out the
// entries of a row; the first of these has the sum, by way of what the group has for each.
INLINE real row_times(
    __local real *sum, uint row, uint count, uint per_row, __global const uint *offsets, __global const uint *columns, __global const double *values,
    __global const double *x, uint width, uint which
) {
    const uint own = get_local_id(0);
    const uint first = own % per_row;
    sum[own] = REAL(0.0);
    if (row < count) {
        real part = REAL(0.0);
        const uint end = offsets[row + 1u];
        for (uint k = offsets[row] + first; k < end; k += per_row) {
            part += values[k] * x[(columns[k] * width) + which];
        }
        sum[own] = part;
    }
    for (uint distance = per_row / 2u; distance > 0u; distance >>= 1) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (first < distance) {
            sum[own] += sum[own + distance];
        }
    }
    return sum[own];
}

// The row of a work-item.
INLINE uint row_of(uint per_row) { return (get_group_id(0) * (GRID_GROUP / per_row)) + ((uint)get_local_id(0) / per_row); }

// y = A x, or y − A x.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void multiply(MULTIPLY_ARGUMENTS) {
    __local real sum[GRID_GROUP];
    const uint row = row_of(per_row);
    const real product = row_times(sum, row, count, per_row, offsets, columns, values, x, width, which);
    if (((get_local_id(0) % per_row) == 0u) && (row < count)) {
        const uint place = (row * width) + which;
        y[place] = (subtracts != 0u) ? (y[place] - product) : product;
    }
}

// A step of a smoother: `Algebra::smooth`.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void smooth(SMOOTH_ARGUMENTS) {
    __local real sum[GRID_GROUP];
    const uint row = row_of(per_row);
    const real product = row_times(sum, row, count, per_row, offsets, columns, values, last, 1u, 0u);
    if (((get_local_id(0) % per_row) == 0u) && (row < count)) {
        const real r = residual[row] - product;
        const real s = last[row];
        const real scaled = alpha * (inverse[row] * r);
        const real t = (beta == REAL(0.0)) ? scaled : (scaled + (beta * s));
        residual[row] = r;
        step[row] = t;
        const real before = (is_nothing != 0u) ? s : ((has_last != 0u) ? solution[row] : (solution[row] + s));
        solution[row] = before + t;
    }
}

// α x + β y, each number of x times that of `scales` where there are any.
__kernel void combine(COMBINE_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i >= count) {
        return;
    }
    const real scaled = (has_scales != 0u) ? (scales[i] * x[i]) : x[i];
    y[i] = (beta == REAL(0.0)) ? (alpha * scaled) : ((alpha * scaled) + (beta * y[i]));
}

// Adds up what the work-items of a group have; the first one has the sum.
INLINE void add_up(__local real *sum, uint own) {
    for (uint distance = GRID_GROUP / 2u; distance > 0u; distance >>= 1) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (own < distance) {
            sum[own] += sum[own + distance];
        }
    }
}

// The sums of x_i y_i over parts of a vector, one of each group.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void dot_parts(DOT_PARTS_ARGUMENTS) {
    __local real sum[GRID_GROUP];
    const uint own = get_local_id(0);
    const uint begin = get_group_id(0) * (GRID_GROUP * SUM_EACH);
    sum[own] = REAL(0.0);
    for (uint turn = 0; turn < SUM_EACH; turn++) {
        const uint i = (begin + (turn * GRID_GROUP)) + own;
        if (i < count) {
            sum[own] += x[i] * y[i];
        }
    }
    add_up(sum, own);
    if (own == 0u) {
        parts[get_group_id(0)] = sum[0];
    }
}

// The sums of x_i, of their sizes, and of their squares.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void sum_parts(SUM_PARTS_ARGUMENTS) {
    __local real sum[GRID_GROUP];
    __local real size[GRID_GROUP];
    __local real square[GRID_GROUP];
    const uint own = get_local_id(0);
    const uint begin = get_group_id(0) * (GRID_GROUP * SUM_EACH);
    sum[own] = REAL(0.0);
    size[own] = REAL(0.0);
    square[own] = REAL(0.0);
    for (uint turn = 0; turn < SUM_EACH; turn++) {
        const uint i = (begin + (turn * GRID_GROUP)) + own;
        if (i < count) {
            sum[own] += x[i];
            size[own] += fabs(x[i]);
            square[own] += x[i] * x[i];
        }
    }
    add_up(sum, own);
    add_up(size, own);
    add_up(square, own);
    if (own == 0u) {
        __global double *part = parts + (3u * get_group_id(0));
        part[0] = sum[0];
        part[1] = size[0];
        part[2] = square[0];
    }
}

__kernel void subtract_number(SUBTRACT_NUMBER_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i < count) {
        x[i] -= number;
    }
}

__kernel void invert_diagonal(INVERT_DIAGONAL_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    real a = REAL(0.0);
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        if (columns[k] == row) {
            a += values[k];
        }
    }
    inverse[row] = (a > REAL(0.0)) ? (REAL(1.0) / a) : REAL(0.0);
}

// Whether some |x_i| is more than `factor` times its bound, or no number.
__kernel void find_beyond(FIND_BEYOND_ARGUMENTS) {
    const uint i = get_global_id(0);
    if ((i < count) && !(fabs(x[i]) <= (factor * bounds[i]))) {
        is_found[0] = 1u;
    }
}

// How a cell and another stand to each other, along the way from the site of the first: `between` of core/src/algebra.rs.
typedef struct {
    real distance;
    real plane;
    real own_center;
    real center;
} Between;

INLINE Between between(__global const double *own, __global const double *other) {
    const real x = other[0] - own[0];
    const real y = other[1] - own[1];
    const real z = other[2] - own[2];
    Between found;
    found.distance = sqrt(((x * x) + (y * y)) + (z * z));
    found.plane = ((found.distance * found.distance) + (own[3] - other[3])) / (REAL(2.0) * found.distance);
    found.own_center = ((((own[4] - own[0]) * x) + ((own[5] - own[1]) * y)) + ((own[6] - own[2]) * z)) / found.distance;
    found.center = ((((other[4] - own[0]) * x) + ((other[5] - own[1]) * y)) + ((other[6] - own[2]) * z)) / found.distance;
    return found;
}

// `rise` there.
INLINE real allowed_rise(__global const double *own, __global const double *other, real share, real flattest) {
    const Between to = between(own, other);
    return ((REAL(2.0) * to.distance) * share) * fmax(to.center - to.plane, flattest * other[7]);
}

// `part` there.
INLINE real part_of_pair(__global const double *own, __global const double *other, real depth) {
    const Between to = between(own, other);
    const real mine = to.plane - to.own_center;
    const real theirs = to.center - to.plane;
    const real wanted = fmin(depth, (mine + theirs) / REAL(2.0));
    return to.distance * (fmax(wanted - mine, REAL(0.0)) - fmax(wanted - theirs, REAL(0.0)));
}

// Whether a site rises too far above another.
__kernel void find_risen(FIND_RISEN_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        const real by = x[row] - x[columns[k]];
        if ((by > REAL(0.0)) && (by > allowed_rise(cells + (CELL_NUMBERS * (size_t)row), cells + (CELL_NUMBERS * (size_t)columns[k]), share, flattest))) {
            is_found[0] = 1u;
        }
    }
}

// The matrix with the entries of those larger that are too far apart.
__kernel void stiffen(STIFFEN_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row > count) {
        return;
    }
    const uint begin = offsets[row];
    made_offsets[row] = begin;
    if (row == count) {
        return;
    }
    real others = REAL(0.0);
    for (uint k = begin + 1u; k < offsets[row + 1u]; k++) {
        const uint column = columns[k];
        const uint above = (x[row] > x[column]) ? row : column;
        const uint below = (x[row] > x[column]) ? column : row;
        const real by = x[above] - x[below];
        real factor = REAL(1.0);
        if (by > REAL(0.0)) {
            factor = fmax(by / allowed_rise(cells + (CELL_NUMBERS * (size_t)above), cells + (CELL_NUMBERS * (size_t)below), share, flattest), REAL(1.0));
        }
        const real value = factor * values[k];
        made_columns[k] = column;
        made_values[k] = value;
        others += value;
    }
    if (begin < offsets[row + 1u]) {
        made_columns[begin] = row;
        made_values[begin] = -others;
    }
}

// What each cell adds to its weight for barycenters to be in their cells.
__kernel void part_cells(PART_CELLS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    real change = REAL(0.0);
    for (uint k = offsets[row]; k < offsets[row + 1u]; k++) {
        const uint other = columns[k];
        if (other != row) {
            change += part_of_pair(cells + (CELL_NUMBERS * (size_t)row), cells + (CELL_NUMBERS * (size_t)other), depth);
        }
    }
    changes[row] = change;
}

// The cells in the caller's lengths, but for where the origin is: site, weight, barycenter, and the cube root of the volume over a density, `per_unit` of it
// where lengths are the frame's.
__kernel void gather_cells(GATHER_CELLS_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row >= count) {
        return;
    }
    const real unit = params->frame_unit;
    const real4 p = sites[row];
    __global const double *own = sums + ((size_t)order[row] * params->sums_width);
    const uint how = outcome[order[row]];
    const bool is_there = (how != NOT_COMPUTED) && ((how & OUTCOME_STATUS) != EMPTY);
    const real volume = is_there ? own[0] : REAL(0.0);
    __global double *cell = cells + (CELL_NUMBERS * (size_t)row);
    cell[0] = p.x * unit;
    cell[1] = p.y * unit;
    cell[2] = p.z * unit;
    cell[3] = (p.w * unit) * unit;
    cell[4] = is_there ? ((p.x + (own[1] / volume)) * unit) : NAN;
    cell[5] = is_there ? ((p.y + (own[2] / volume)) * unit) : NAN;
    cell[6] = is_there ? ((p.z + (own[3] / volume)) * unit) : NAN;
    cell[7] = cbrt(volume) * per_unit;
}

// The Laplacian's rows with their diagonals, times `scale`; a facet of no area, or less, becomes nothing on the diagonal.
__kernel void fill_laplacian(FILL_LAPLACIAN_ARGUMENTS) {
    const uint row = get_global_id(0);
    if (row > count) {
        return;
    }
    const uint begin = starts[row] + row;
    offsets[row] = begin;
    if (row == count) {
        return;
    }
    real sum = REAL(0.0);
    uint next = begin + 1u;
    for (uint k = starts[row]; k < starts[row + 1u]; k++) {
        const real a = packed_values[k] * scale;
        const bool is_tie = a > REAL(0.0);
        columns[next] = is_tie ? packed_columns[k] : row;
        values[next] = is_tie ? -a : REAL(0.0);
        sum += is_tie ? a : REAL(0.0);
        next++;
    }
    columns[begin] = row;
    values[begin] = sum;
}
