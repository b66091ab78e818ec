// What the search of the table of offsets (`table_search.cl`) reads of it and of the grid, wherever a cell lives.

#import "tree_store.cl"

#if WITH_TABLE
// The site's own voxel.
INLINE void find_voxel(Store *s) {
    s->voxel[0] = voxel_along(s->world.params, 0, s->site.x);
    s->voxel[1] = voxel_along(s->world.params, 1, s->site.y);
    s->voxel[2] = voxel_along(s->world.params, 2, s->site.z);
}

// (Not of `Close`, whose cells have no such stage.)
#if LANES && (WITH_WEIGHTS && !WITH_CLOSE)
INLINE bool store_leaves_early(Store *s) { return true; }
#else
INLINE bool store_leaves_early(Store *s) { return false; }
#endif
INLINE uint store_offsets(Store *s) { return SHELLS; }
INLINE Offset store_offset(Store *s, uint i) {
    const uchar4 shell = s->shells[min(i, SHELLS - 1u)];
    const int radius = (int)SHELL_RADIUS;
    return (Offset){ .x = (int)shell.x - radius, .y = (int)shell.y - radius, .z = (int)shell.z - radius, .apart = (float)shell.w };
}
INLINE uint store_voxel_at(Store *s, Offset offset) {
    __global const Params *params = s->world.params;
    // Below zero is beyond the end, too.
    const uint i = s->voxel[0] + (uint)offset.x;
    const uint j = s->voxel[1] + (uint)offset.y;
    const uint k = s->voxel[2] + (uint)offset.z;
    const uint voxel = i + (params->grid_dims[0] * (j + (params->grid_dims[1] * k)));
    return ((i < params->grid_dims[0]) && ((j < params->grid_dims[1]) && (k < params->grid_dims[2]))) ? voxel : NO_VOXEL;
}
INLINE SiteRange store_sites_in(Store *s, uint voxel) {
    const uint2 range = s->world.voxels[voxel];
    return (SiteRange){ .begin = range.x, .end = range.y };
}
INLINE VoxelPlace store_place_in_voxel(Store *s) {
    __global const Params *params = s->world.params;
    const double per_width = params->grid_per_width;
    return (VoxelPlace){ .x = (float)(((s->site.x - params->grid_lo[0]) * per_width) - (double)s->voxel[0]),
                         .y = (float)(((s->site.y - params->grid_lo[1]) * per_width) - (double)s->voxel[1]),
                         .z = (float)(((s->site.z - params->grid_lo[2]) * per_width) - (double)s->voxel[2]) };
}
#if LANES && WITH_WEIGHTS
INLINE real store_largest_in_ring(Store *s, uint block, uint ring) { return s->world.around[(RINGS * block) + ring]; }
INLINE float store_excess_around(Store *s, uint ring) { return s->cell->around[ring]; }
INLINE void store_set_excess_around(Store *s, uint ring, real excess) {
    const double per_width = s->world.params->grid_per_width;
    // (What is no number stays so, and proves nothing.)
    s->cell->around[ring] = (excess <= REAL(0.0)) ? 0.0f : (convert_float_rtp((excess * per_width) * per_width) * ROUGH_SAFE);
}
#else
// (Weights are the same.)
INLINE real store_largest_in_ring(Store *s, uint block, uint ring) { return REAL(0.0); }
INLINE float store_excess_around(Store *s, uint ring) { return 0.0f; }
INLINE void store_set_excess_around(Store *s, uint ring, real excess) {}
#endif
INLINE float store_voxels_per_length(Store *s) { return convert_float_rtp(s->world.params->grid_per_width) * ROUGH_SAFE; }
#endif
