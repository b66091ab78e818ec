// What a loop over diagrams does with all cells where their sites stay on the device: a few sums, and moves.

#import "generated/interface.cl"

// Adds x to a sum with Neumaier's compensation (`core/src/summation.rs`).
INLINE void add_to(real *sum, real *lost, real x) {
    const real total = *sum + x;
    *lost += (fabs(*sum) >= fabs(x)) ? ((*sum - total) + x) : ((x - total) + *sum);
    *sum = total;
}

// Whether site i has a cell.
INLINE bool has_cell(__global const uint *outcome, uint i) {
    const uint how = outcome[i];
    return (how != NOT_COMPUTED) && ((how & OUTCOME_STATUS) != EMPTY);
}

// The TOTALS over parts of the cells, one of each group, in the frame's lengths. About its site a cell has its second moment, and of what is sought
// no place is needed.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void sum_cells(SUM_CELLS_ARGUMENTS) {
    __local real sum[GRID_GROUP];
    __local real lost[GRID_GROUP];
    const uint own = get_local_id(0);
    const uint begin = get_group_id(0) * (GRID_GROUP * SUM_EACH);
    const ulong width = params->sums_width;
    real sums_here[TOTALS];
    real lost_here[TOTALS];
    for (uint k = 0; k < TOTALS; k++) {
        sums_here[k] = REAL(0.0);
        lost_here[k] = REAL(0.0);
    }
    for (uint turn = 0; turn < SUM_EACH; turn++) {
        const uint i = (begin + (turn * GRID_GROUP)) + own;
        if ((i >= count) || !has_cell(outcome, i)) {
            continue;
        }
        __global const double *cell = sums + ((size_t)i * width);
        const real v = cell[0];
        const real off = ((cell[1] * cell[1]) + (cell[2] * cell[2])) + (cell[3] * cell[3]);
        sums_here[0] += REAL(1.0);
        sums_here[1] += ((outcome[i] & OUTCOME_UNCERTIFIED) != 0u) ? REAL(1.0) : REAL(0.0);
        add_to(&sums_here[2], &lost_here[2], v);
        add_to(&sums_here[3], &lost_here[3], fmin(v, REAL(0.0)));
        add_to(&sums_here[4], &lost_here[4], v * v);
        if (width >= MOMENT_SUMS) {
            add_to(&sums_here[5], &lost_here[5], ((cell[4] + cell[5]) + cell[6]) - (placed[i].w * v));
        }
        add_to(&sums_here[6], &lost_here[6], off / fabs(v));
    }
    for (uint k = 0; k < TOTALS; k++) {
        real whole = sums_here[k];
        real missed = lost_here[k];
        for (uint distance = GRID_GROUP / 2u; distance > 0u; distance >>= 1) {
            sum[own] = whole;
            lost[own] = missed;
            barrier(CLK_LOCAL_MEM_FENCE);
            if (own < distance) {
                add_to(&whole, &missed, sum[own + distance]);
                missed += lost[own + distance];
            }
            barrier(CLK_LOCAL_MEM_FENCE);
        }
        if (own == 0u) {
            __global double *part = parts + (2u * ((get_group_id(0) * (size_t)TOTALS) + k));
            part[0] = whole;
            part[1] = missed;
        }
    }
}

// Each site at the barycenter of its cell, by the expressions of `finish` (core/src/assemble.rs); where it was if that is empty. (What is no number is out of
// all range, which is seen when the sites are sorted.)
__kernel void move_sites(MOVE_SITES_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i >= count) {
        return;
    }
    const real4 p = placed[i];
    const real at[3] = {p.x, p.y, p.z};
    const bool moves = has_cell(outcome, i);
    __global const double *cell = sums + ((size_t)i * params->sums_width);
    for (uint axis = 0; axis < 3u; axis++) {
        const size_t place = (3u * (size_t)i) + axis;
        real x = positions[place];
        if (moves) {
            x = ((at[axis] + (cell[1u + axis] / cell[0])) * params->frame_unit) + params->frame_shift[axis];
        }
        moved[place] = isnan(x) ? INFINITY : x;
    }
}
