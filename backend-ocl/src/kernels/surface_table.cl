// Voxels of the domain's grid that the surface meets, counted for any box of voxels from the summed-area table (domain_grid/surface.rs).

#import <prelude>

INLINE uint table_entry(__global const uint *dims, __global const uint *table, uint i, uint j, uint k) {
    return table[i + ((dims[0] + 1u) * (j + ((dims[1] + 1u) * k)))];
}

// Those from `lo` on and below `end`.
INLINE uint voxels_met(__global const uint *dims, __global const uint *table, uint3 lo, uint3 end) {
    const uint upper = table_entry(dims, table, end.x, end.y, end.z) - table_entry(dims, table, lo.x, end.y, end.z)
        - table_entry(dims, table, end.x, lo.y, end.z) + table_entry(dims, table, lo.x, lo.y, end.z);
    const uint lower = table_entry(dims, table, end.x, end.y, lo.z) - table_entry(dims, table, lo.x, end.y, lo.z)
        - table_entry(dims, table, end.x, lo.y, lo.z) + table_entry(dims, table, lo.x, lo.y, lo.z);
    return upper - lower;
}
