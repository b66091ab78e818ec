// How far from each voxel of the domain's grid the surface is, and so from each site.

// Voxels that the surface meets of those at most `away` from one, along each axis.
INLINE uint voxels_met(__global const Params *params, __global const uint *surface_table, uint3 voxel, uint away) {
    const uint nx = params->domain_dims[0] + 1u;
    const uint nxy = nx * (params->domain_dims[1] + 1u);
    const uint3 lo = voxel - min(voxel, away);
    const uint3 dims = (uint3)(params->domain_dims[0], params->domain_dims[1], params->domain_dims[2]);
    const uint3 hi = min(voxel + (away + 1u), dims);
    const uint upper = surface_table[hi.x + (nx * hi.y) + (nxy * hi.z)] - surface_table[lo.x + (nx * hi.y) + (nxy * hi.z)]
        - surface_table[hi.x + (nx * lo.y) + (nxy * hi.z)] + surface_table[lo.x + (nx * lo.y) + (nxy * hi.z)];
    const uint lower = surface_table[hi.x + (nx * hi.y) + (nxy * lo.z)] - surface_table[lo.x + (nx * hi.y) + (nxy * lo.z)]
        - surface_table[hi.x + (nx * lo.y) + (nxy * lo.z)] + surface_table[lo.x + (nx * lo.y) + (nxy * lo.z)];
    return upper - lower;
}

// For each of `count` voxels 0 where the surface meets it, or else the largest number n up to 255 such that it meets no voxel less than n away
// along each axis.
__kernel void measure_clearances(
    __global const Params *params, __global const uint *surface_table, uint count, __global uchar *clearances
) {
    const uint index = get_global_id(0);
    if (index >= count) {
        return;
    }
    const uint nx = params->domain_dims[0];
    const uint ny = params->domain_dims[1];
    const uint3 voxel = (uint3)(index % nx, (index / nx) % ny, index / (nx * ny));
    // Bit by bit, from the highest.
    uint clearance = 0;
    for (uint bit = 128; bit > 0u; bit >>= 1) {
        if (voxels_met(params, surface_table, voxel, (clearance + bit) - 1u) == 0u) {
            clearance += bit;
        }
    }
    clearances[index] = (uchar)clearance;
}

// For each of `count` sorted sites from `first` on what its cell has to know: while no vertex is farther than x, a number in single precision, the cell does
// not meet the surface, and lies where the winding number is y. (A site beyond the grid, which its cell is not, is no nearer than the voxel
// that it is next to.)
__kernel void look_about(
    __global const Params *params, __global const real4 *sites, uint first, uint count, __global const uchar *clearances,
    __global const int *windings, __global int2 *abouts
) {
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
