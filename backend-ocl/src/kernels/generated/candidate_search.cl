// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "generated/cell.cl"
#import "generated/tree_types.cl"

INLINE void add_least(real lo, real hi, real from, real alpha, real g, real slope, real curvature, real *sum, real *size);
INLINE real gap_along(real lo, real hi, real place, real off);
INLINE real square_to_box(V3 lo, V3 hi, V3 place, real off);
INLINE real least_weighted(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights);
INLINE real least_of_node(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights);
INLINE real least_power_of_node(Seer seer, V3 v, NodeBox bounds, NodeSlab slab, NodeWeights weights);
INLINE real reach_of_bisector(V3 g, V3 d, real excess);
INLINE uint end_of_ring(uint ring);
INLINE uint level_of_block(uint top_level);
INLINE uint block_of_site(uint top_level, uint site);
INLINE real less_slope(real excess, V3 slope, V3 way, real *size);
INLINE real reach_of_site(Store *s, V3 slope, uint j);
INLINE Held nearest_held(Store *s, uint count);
INLINE uint take_held(Store *s, Held held, uint least);
HOT uint visit_candidates(Store *s, V3 center, uint count, uint below, bool checks, float *reach, uint *visited);
INLINE uint key_limit(Store *s, float reach, uint below);

#import "generated/quadratic.cl"
#import "generated/bound.cl"
#import "generated/ring.cl"
#import "generated/candidates.cl"
