// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "generated/candidate_search.cl"

INLINE Vantage vantage_in_block(Store *s);
INLINE void look_around(Store *s, V3 slope);
INLINE float limit_in_voxels(Store *s, float reach, uint *ring);
INLINE float gap_to_voxel(int offset, float place);
INLINE uint gather_voxels(Store *s, VoxelPlace place, float limit, uint *next);
HOT uint search_table(Store *s, Vantage vantage, float *reach, uint *visited);

#import "generated/table.cl"
