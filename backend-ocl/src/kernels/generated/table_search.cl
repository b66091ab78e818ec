// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "generated/candidate_search.cl"

INLINE float limit_in_voxels(Store *s, float reach);
INLINE float gap_to_voxel(int offset, float place);
INLINE uint gather_voxels(Store *s, VoxelPlace place, float reach, uint *next);
HOT uint search_table(Store *s, float *reach, uint *visited);

#import "generated/table.cl"
