// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "generated/tree_types.cl"
#import "node_source.cl"

INLINE V3 v3(real x, real y, real z);
INLINE V3 add(V3 a, V3 b);
INLINE V3 sub(V3 a, V3 b);
INLINE V3 scale(real t, V3 a);
INLINE real v3_dot(V3 a, V3 b);
INLINE V3 v3_cross(V3 a, V3 b);
INLINE real norm_1(V3 a);
INLINE real norm_max(V3 a);
INLINE real smaller(real a, real b);
INLINE real larger(real a, real b);
INLINE void add_least(real lo, real hi, real from, real alpha, real g, real slope, real curvature, real *sum, real *size);
INLINE real gap_along(real lo, real hi, real place, real off);
INLINE real square_to_box(V3 lo, V3 hi, V3 place, real off);
INLINE real least_weighted(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights);
INLINE real least_of_node(Seer seer, real alpha, V3 g, NodeBox bounds, NodeWeights weights);
INLINE real least_power_of_node(Seer seer, V3 v, NodeBox bounds, NodeSlab slab, NodeWeights weights);
INLINE real reach_of_bisector(V3 g, V3 d, real excess);
INLINE V3 middle_of(V3 lo, V3 hi);
INLINE V3 half_of(V3 lo, V3 hi, real margin);
INLINE V3 part_lo(V3 lo, V3 hi, uint octant);
INLINE V3 part_hi(V3 lo, V3 hi, uint octant);
INLINE uint barren_of_part(uint barren, uint count, uint all);
INLINE bool part_is_split(uint count, uint barren, uint depth);
INLINE V3 octree_place(V3 middle, V3 halves, uint i);
INLINE real power_at(V3 site, real weight, V3 place);
INLINE SeenSite seen_from(V3 place, real excess, V3 middle);
INLINE real more_power(SeenSite site, SeenSite other, V3 halves);
INLINE float way_home(V3 site, real power, V3 first, real least);
INLINE uint end_of_ring(uint ring);
INLINE uint level_of_block(uint top_level);
INLINE uint block_of_site(uint top_level, uint site);
INLINE real less_slope(real excess, V3 slope, V3 way, real *size);
INLINE real gap_between(real lo, real hi, real its_lo, real its_hi);
INLINE real square_between(NodeBox a, NodeBox b);
INLINE Around around_block(Store *s, uint own, real width);
INLINE uint ring_at(real square, real width);
INLINE Seen look_at_node(Store *s, Around of, uint level, uint node);
INLINE Seen look_at_site(Store *s, Around of, uint j);
INLINE V3 least_corner(V3 a, V3 b);
INLINE V3 largest_corner(V3 a, V3 b);
HOT NodeBox box_of_node(Store *s);
INLINE Symmetric square_of_matrix(Symmetric m);
HOT V3 thinnest_direction(Store *s);
INLINE real largest_along(NodeBox bounds, V3 n);
HOT NodeSlab slab_of_node(Store *s, NodeBox bounds);
INLINE real rise(NodeWeights w, V3 u);
HOT Rest rest_of_sampled(Store *s, V3 middle, NodeWeights w);
INLINE Equations equations_of_sampled(Store *s, V3 middle, real width, real base, V3 curvature);
HOT NodeWeights fit_of_sampled(Store *s, V3 middle, real width, real base, uint unknowns, V3 curvature);
INLINE void add_largest(real lo, real hi, real middle, real slope, real curvature, real its_slope, real its_curvature, real *sum, real *size);
HOT NodeWeights weights_of_node(Store *s, NodeBox bounds);

#import "generated/vector.cl"
#import "generated/quadratic.cl"
#import "generated/bound.cl"
#import "generated/octree.cl"
#import "generated/ring.cl"
#import "generated/around.cl"
#import "generated/node.cl"
