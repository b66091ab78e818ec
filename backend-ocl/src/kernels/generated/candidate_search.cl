// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "generated/cell.cl"
#import "generated/tree_types.cl"

INLINE Held nearest_held(Store *s, uint count);
INLINE uint take_held(Store *s, Held held, uint least);
HOT uint visit_candidates(Store *s, V3 center, uint count, uint below, float *reach, uint *visited);
INLINE uint key_limit(Store *s, float reach, uint below);

#import "generated/candidates.cl"
