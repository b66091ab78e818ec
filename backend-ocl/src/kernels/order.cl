// The order of the sites: along a Hilbert curve (`core/src/site_tree/hilbert.rs`), those of equal rank by position; coincident ones are taken out.
// The curve's finest cells divide the voxels of the site grid, so that each voxel's sites stand together.

#import "params.cl"

// The finest cell along an axis that holds x.
INLINE uint cell_along(__global const Params *params, uint axis, real x, uint finer) {
    const uint voxel = voxel_along(params, axis, x);
    const real cells = (real)(1u << finer);
    const real within = (((x - params->grid_lo[axis]) / params->grid_width) - (real)voxel) * cells;
    return (voxel << finer) | (uint)clamp(within, REAL(0.0), cells - REAL(1.0));
}

// The rank of each site along the curve, of which `levels` levels are gone through, and `finer` of them divide voxels.
__kernel void rank_sites(RANK_SITES_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i >= count) {
        return;
    }
    const uint x = cell_along(params, 0, placed[i].x, finer);
    const uint y = cell_along(params, 1, placed[i].y, finer);
    const uint z = cell_along(params, 2, placed[i].z, finer);
    ulong rank = 0;
    uint turn = 0;
    for (uint level = levels; level > 0u; level--) {
        const uint bit = level - 1u;
        const uint octant = (((x >> bit) & 1u) | (((y >> bit) & 1u) << 1)) | (((z >> bit) & 1u) << 2);
        const uchar2 next = turns[(8u * turn) + octant];
        rank = (rank << 3) | (ulong)next.x;
        turn = next.y;
    }
    ranks[i] = rank;
    slots[i] = i;
}

// The sum of what the work-items of a group before this one have, of which this one has `total`; `sum` becomes the sums up to each.
INLINE uint sum_before(__local uint *sum, uint own, uint total) {
    sum[own] = total;
    for (uint step = 1; step < GRID_GROUP; step <<= 1) {
        barrier(CLK_LOCAL_MEM_FENCE);
        const uint before = (own >= step) ? sum[own - step] : 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        sum[own] += before;
    }
    return sum[own] - total;
}

INLINE uint digit_of(ulong rank, uint shift) { return (uint)(rank >> shift) & (DIGITS - 1u); }

// How many of a group's ranks have each digit, digit by digit.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void count_digits(COUNT_DIGITS_ARGUMENTS) {
    __local uint number[DIGITS];
    const uint own = get_local_id(0);
    if (own < DIGITS) {
        number[own] = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint turn = 0; turn < SORT_EACH; turn++) {
        const uint i = (get_group_id(0) * (GRID_GROUP * SORT_EACH)) + (turn * GRID_GROUP) + own;
        if (i < count) {
            atomic_inc(&number[digit_of(ranks[i], shift)]);
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (own < DIGITS) {
        counts[(own * get_num_groups(0)) + get_group_id(0)] = number[own];
    }
}

// Puts ranks and slots where their digit has them, equal ones in the order in which they come: `starts` are the sums of `counts` before each.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void place_digits(PLACE_DIGITS_ARGUMENTS) {
    // Of each digit, how many each work-item has; then how many stand before those.
    __local ushort place[DIGITS * GRID_GROUP];
    __local uint sum[GRID_GROUP];
    __local uint start[DIGITS];
    const uint own = get_local_id(0);
    const uint first = ((get_group_id(0) * GRID_GROUP) + own) * SORT_EACH;
    for (uint digit = 0; digit < DIGITS; digit++) {
        place[(digit * GRID_GROUP) + own] = 0;
    }
    for (uint i = first; i < min(first + SORT_EACH, count); i++) {
        place[(digit_of(ranks[i], shift) * GRID_GROUP) + own]++;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    uint total = 0;
    for (uint k = 0; k < DIGITS; k++) {
        const uint here = place[(own * DIGITS) + k];
        place[(own * DIGITS) + k] = (ushort)total;
        total += here;
    }
    const uint before = sum_before(sum, own, total);
    for (uint k = 0; k < DIGITS; k++) {
        place[(own * DIGITS) + k] += (ushort)before;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (own < DIGITS) {
        start[own] = starts[(own * get_num_groups(0)) + get_group_id(0)] - place[own * GRID_GROUP];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = first; i < min(first + SORT_EACH, count); i++) {
        const uint digit = digit_of(ranks[i], shift);
        const uint to = start[digit] + place[(digit * GRID_GROUP) + own];
        place[(digit * GRID_GROUP) + own]++;
        new_ranks[to] = ranks[i];
        new_slots[to] = slots[i];
    }
}

// Sums of the elements before each, within a block of GRID_GROUP · SCAN_EACH, in place; and the sum of each block.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void scan_blocks(SCAN_BLOCKS_ARGUMENTS) {
    __local uint sum[GRID_GROUP];
    const uint own = get_local_id(0);
    const uint first = get_group_id(0) * (GRID_GROUP * SCAN_EACH) + own * SCAN_EACH;
    uint total = 0;
    for (uint e = first; e < min(first + SCAN_EACH, count); e++) {
        const uint here = data[e];
        data[e] = total;
        total += here;
    }
    const uint before = sum_before(sum, own, total);
    for (uint e = first; e < min(first + SCAN_EACH, count); e++) {
        data[e] += before;
    }
    if (own == (GRID_GROUP - 1u)) {
        sums[get_group_id(0)] = sum[own];
    }
}

// Adds to each element the sum of the blocks before its own.
__kernel void add_blocks(ADD_BLOCKS_ARGUMENTS) {
    const uint e = get_global_id(0);
    if (e < count) {
        data[e] += sums[e / (GRID_GROUP * SCAN_EACH)];
    }
}

// Whether site i of position and weight p stands before site j of q: by position, then the heavier, then the caller's order.
INLINE uint is_before(real4 p, uint i, real4 q, uint j) {
    if (p.x != q.x) {
        return p.x < q.x;
    }
    if (p.y != q.y) {
        return p.y < q.y;
    }
    if (p.z != q.z) {
        return p.z < q.z;
    }
    if (p.w != q.w) {
        return p.w > q.w;
    }
    return i < j;
}

// Sorts the slots of each run of equal ranks by position, and marks in `kept` those that do not stand at the position of another. `is_long` becomes
// 1 where a run is longer than `most`, and is left alone.
__kernel void settle_runs(SETTLE_RUNS_ARGUMENTS) {
    const uint begin = get_global_id(0);
    if (begin >= count) {
        return;
    }
    const ulong rank = ranks[begin];
    if ((begin > 0u) && (ranks[begin - 1u] == rank)) {
        return;
    }
    uint end = begin + 1u;
    while (((end < count) && (ranks[end] == rank)) && ((end - begin) <= most)) {
        end++;
    }
    if ((end - begin) > most) {
        *is_long = 1u;
        return;
    }
    for (uint a = begin + 1u; a < end; a++) {
        const uint site = slots[a];
        const real4 p = placed[site];
        uint b = a;
        while ((b > begin) && is_before(p, site, placed[slots[b - 1u]], slots[b - 1u])) {
            slots[b] = slots[b - 1u];
            b--;
        }
        slots[b] = site;
    }
    for (uint a = begin; a < end; a++) {
        const real4 p = placed[slots[a]];
        const real4 q = placed[slots[max(a, begin + 1u) - 1u]];
        kept[a] = (a == begin) || (((p.x != q.x) || (p.y != q.y)) || (p.z != q.z));
    }
}

// Sites and caller's indices in their order, without those that are not kept: `places` are the sums of `kept` before each.
__kernel void gather_sites(GATHER_SITES_ARGUMENTS) {
    const uint i = get_global_id(0);
    if ((i < count) && (places[i] != places[i + 1u])) {
        sites[places[i]] = placed[slots[i]];
        order[places[i]] = slots[i];
    }
}
