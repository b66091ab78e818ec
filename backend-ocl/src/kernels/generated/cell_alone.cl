// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "generated/cell.cl"

OUTLINE uint begin(Store *s, V3 lo, V3 hi);
OUTLINE uint clip(Store *s, Plane plane, uint tag);
OUTLINE uint settle_marks(Store *s, uint k);
OUTLINE void clear_links(Store *s);
OUTLINE void find_boundary_edge(Store *s, uint end, Triplet *edge);
INLINE bool is_boundary_edge(Store *s, uint end, uint a, uint b);
OUTLINE void compact_planes(Store *s);
INLINE real farthest_vertex(Store *s);
OUTLINE uint integrate_cell(Store *s, uint flags, uint interior_only, CellSums *sums);
OUTLINE uint integrate_restricted(Store *s, V3 center, uint flags, uint interior_only, CellSums *sums);
OUTLINE uint integrate_whole(Store *s, real weight, V3 center, uint flags, CellSums *sums);
OUTLINE void add_box_faces(Store *s, CellSums *sums);
OUTLINE uint add_cones(Store *s, Voxel lo, Voxel hi, Voxel apex, V3 center, uint flags, bool *touched, CellSums *sums);
OUTLINE uint add_cone(Store *s, uint t, Voxel apex, V3 center, uint flags, bool *touched, CellSums *sums);
OUTLINE uint clip_by_sides(Store *s, TruncatedCone cone);
OUTLINE uint add_surface(Store *s, uint t, Voxel apex, V3 center, CellSums *sums);
INLINE bool all_in_conflict(Store *s, uint k, Plane plane);

#import "generated/clip.cl"
#import "generated/restrict.cl"
