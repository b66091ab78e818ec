// The site grid: sites moved into the frame, sorted by voxel and within a voxel by position, coincident ones taken out, and the pyramid
// of largest weights. The same sites in the same order as the host's `SiteGrid` (site_grid.rs) sorts them.

#import "params.cl"

// The sites in the frame: x, y, z, weight; the same expressions as `Frame::enter` and `Frame::enter_weight`. And the range of each
// group.
__kernel __attribute__((reqd_work_group_size(GRID_GROUP, 1, 1))) void enter_sites(ENTER_SITES_ARGUMENTS) {
    __local real lo[3][GRID_GROUP];
    __local real hi[3][GRID_GROUP];
    __local real least[GRID_GROUP];
    __local real most[GRID_GROUP];
    const uint i = get_global_id(0);
    const uint own = get_local_id(0);
    real p[3];
    real w = REAL(0.0);
    if (i < count) {
        for (uint axis = 0; axis < 3u; axis++) {
            const real x = (positions[3u * (size_t)i + axis] - params->frame_shift[axis]) / params->frame_unit;
            p[axis] = (fabs(x) < params->frame_smallest) ? REAL(0.0) : x;
        }
        if (has_weights != 0u) {
            w = fmin(fmax(weights[i] / (params->frame_unit * params->frame_unit), -DBL_MAX), DBL_MAX) + REAL(0.0);
        }
        placed[i] = (real4)(p[0], p[1], p[2], w);
    }
    for (uint axis = 0; axis < 3u; axis++) {
        lo[axis][own] = (i < count) ? p[axis] : INFINITY;
        hi[axis][own] = (i < count) ? p[axis] : -INFINITY;
    }
    least[own] = (i < count) ? w : INFINITY;
    most[own] = (i < count) ? w : -INFINITY;
    for (uint distance = GRID_GROUP / 2u; distance > 0u; distance >>= 1) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (own < distance) {
            for (uint axis = 0; axis < 3u; axis++) {
                lo[axis][own] = fmin(lo[axis][own], lo[axis][own + distance]);
                hi[axis][own] = fmax(hi[axis][own], hi[axis][own + distance]);
            }
            least[own] = fmin(least[own], least[own + distance]);
            most[own] = fmax(most[own], most[own + distance]);
        }
    }
    if (own == 0u) {
        __global Range *range = ranges + get_group_id(0);
        for (uint axis = 0; axis < 3u; axis++) {
            range->lo[axis] = lo[axis][0];
            range->hi[axis] = hi[axis][0];
        }
        range->smallest_weight = least[0];
        range->largest_weight = most[0];
    }
}

// The voxel of a site.
INLINE uint voxel_of(__global const Params *params, real4 p) {
    const uint row = voxel_along(params, 1, p.y) + (params->grid_dims[1] * voxel_along(params, 2, p.z));
    return voxel_along(params, 0, p.x) + (params->grid_dims[0] * row);
}

// Marks the voxels that have a site.
__kernel void mark_voxels(MARK_VOXELS_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i < count) {
        // (Most are marked already, and reading costs less than writing.)
        __global uint *mark = marks + voxel_of(params, placed[i]);
        if (*mark == 0u) {
            *mark = 1u;
        }
    }
}

// Counts the sites of each voxel, and gives each site its number among them (in no order: `sort_voxels` makes one).
// `crowded` becomes 1 where a voxel has more than CROWDED: then the host makes a tree.
__kernel void count_sites(COUNT_SITES_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i >= count) {
        return;
    }
    const uint voxel = voxel_of(params, placed[i]);
    const uint number = atomic_inc(counts + voxel);
    place[i] = (uint2)(voxel, number);
    if (number >= CROWDED) {
        *crowded = 1u;
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
    sum[own] = total;
    for (uint step = 1; step < GRID_GROUP; step <<= 1) {
        barrier(CLK_LOCAL_MEM_FENCE);
        const uint before = (own >= step) ? sum[own - step] : 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        sum[own] += before;
    }
    const uint before = sum[own] - total;
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

// Puts each site into the slot that is its own.
__kernel void place_sites(PLACE_SITES_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i < count) {
        slots[starts[place[i].x] + place[i].y] = i;
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

// Sorts the slots of each voxel, and drops those that stand at the position of another; `kept` counts what is left. Crowded voxels are
// left alone.
__kernel void sort_voxels(SORT_VOXELS_ARGUMENTS) {
    const uint voxel = get_global_id(0);
    if (voxel >= voxels) {
        return;
    }
    const uint begin = starts[voxel];
    const uint count = starts[voxel + 1u] - begin;
    kept[voxel] = count;
    if ((count < 2u) || (count > CROWDED)) {
        return;
    }
    __global uint *own = slots + begin;
    for (uint a = 1; a < count; a++) {
        const uint site = own[a];
        const real4 p = placed[site];
        uint b = a;
        while ((b > 0u) && is_before(p, site, placed[own[b - 1u]], own[b - 1u])) {
            own[b] = own[b - 1u];
            b--;
        }
        own[b] = site;
    }
    uint different = 1;
    for (uint a = 1; a < count; a++) {
        const real4 p = placed[own[different - 1u]];
        const real4 q = placed[own[a]];
        if (((p.x != q.x) || (p.y != q.y)) || (p.z != q.z)) {
            own[different] = own[a];
            different++;
        }
    }
    kept[voxel] = different;
}

// Sites and caller's indices in sorted order, and the largest weight of each voxel.
__kernel void gather_sites(GATHER_SITES_ARGUMENTS) {
    const uint voxel = get_global_id(0);
    if (voxel >= voxels) {
        return;
    }
    const uint begin = offsets[voxel];
    const uint count = offsets[voxel + 1u] - begin;
    real largest = -INFINITY;
    for (uint a = 0; a < count; a++) {
        const uint i = slots[starts[voxel] + a];
        const real4 site = placed[i];
        sites[begin + a] = site;
        order[begin + a] = i;
        largest = fmax(largest, site.w);
    }
    weights[voxel] = largest;
}

// The largest weight of each node of a level from the level below.
__kernel void raise_level(RAISE_LEVEL_ARGUMENTS) {
    const uint node = get_global_id(0);
    if (node >= ((nx * ny) * nz)) {
        return;
    }
    const uint i = 2u * (node % nx);
    const uint j = 2u * ((node / nx) % ny);
    const uint k = 2u * ((node / nx) / ny);
    real largest = -INFINITY;
    for (uint c = k; c < min(k + 2u, below_nz); c++) {
        for (uint b = j; b < min(j + 2u, below_ny); b++) {
            for (uint a = i; a < min(i + 2u, below_nx); a++) {
                largest = fmax(largest, weights[below + a + (below_nx * (b + (below_ny * c)))]);
            }
        }
    }
    weights[begin + node] = largest;
}
