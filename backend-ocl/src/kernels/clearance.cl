// How far from each voxel of the domain's grid the surface is, and so from each site.

#import "params.cl"
#import "surface_table.cl"

// For each of `count` voxels 0 where the surface meets it, or else the largest number n up to 255 such that it meets no voxel less than n away
// along each axis.
__kernel void measure_clearances(MEASURE_CLEARANCES_ARGUMENTS) {
    const uint index = get_global_id(0);
    if (index >= count) {
        return;
    }
    const uint3 dims = (uint3)(params->domain_dims[0], params->domain_dims[1], params->domain_dims[2]);
    const uint3 voxel = (uint3)(index % dims.x, (index / dims.x) % dims.y, index / (dims.x * dims.y));
    // Bit by bit, from the highest.
    uint clearance = 0;
    for (uint bit = 128; bit > 0u; bit >>= 1) {
        const uint tried = clearance + bit;
        if (voxels_met(params->domain_dims, surface_table, voxel - min(voxel, tried - 1u), min(voxel + tried, dims)) == 0u) {
            clearance = tried;
        }
    }
    clearances[index] = (uchar)clearance;
}

// For each of `count` sorted sites from `first` on what its cell has to know: while no vertex is farther than x, a number in single
// precision, the cell does not meet the surface, and lies where the winding number is y. (A site beyond the grid, which its cell is not, is
// no nearer than the voxel that it is next to.)
__kernel void look_about(LOOK_ABOUT_ARGUMENTS) {
    if (get_global_id(0) >= count) {
        return;
    }
    const uint site = first + (uint)get_global_id(0);
    const real4 own = sites[site];
    const float x = place_in_domain(params, 0, own.x);
    const float y = place_in_domain(params, 1, own.y);
    const float z = place_in_domain(params, 2, own.z);
    const uint voxel = voxel_in_domain(params, 0, x)
        + (params->domain_dims[0] * (voxel_in_domain(params, 1, y) + (params->domain_dims[1] * voxel_in_domain(params, 2, z))));
    const float slack = slack_at(fmax(fmax(fabs(x), fabs(y)), fabs(z)));
    const float free = ((float)clearances[voxel] - 1.0f) - slack;
    const float clear = (free * convert_float_rtz(params->domain_width)) * (2.0f - ROUGH_SAFE);
    abouts[site] = (int2)(as_int(clear), windings[voxel]);
}
