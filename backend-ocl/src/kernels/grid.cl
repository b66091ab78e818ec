// The sites enter the frame, and the table of voxels that tells where those of each voxel stand: sites are in the order of a curve that leaves no
// voxel before it has met all of its sites (`order.cl`).

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

// Where the sites of each voxel begin and end; `crowded` becomes 1 where a voxel has more than CROWDED, which the table is no help to.
__kernel void find_voxels(FIND_VOXELS_ARGUMENTS) {
    const uint i = get_global_id(0);
    if (i >= count) {
        return;
    }
    __global uint *range = (__global uint *)voxels;
    const uint voxel = voxel_of(params, sites[i]);
    if ((i == 0u) || (voxel_of(params, sites[i - 1u]) != voxel)) {
        range[2u * voxel] = i;
    }
    const uint next = i + 1u;
    if ((next == count) || (voxel_of(params, sites[next]) != voxel)) {
        range[(2u * voxel) + 1u] = next;
    }
    if (((i + CROWDED) < count) && (voxel_of(params, sites[i + CROWDED]) == voxel)) {
        *crowded = 1u;
    }
}
