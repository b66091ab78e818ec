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
INLINE void add_least(real lo, real hi, real alpha, real g, real slope, real curvature, real *sum, real *size);
INLINE real polynomial_at(real t, real m, real alpha, real g, real slope, real curvature);
INLINE V3 least_corner(V3 a, V3 b);
INLINE V3 largest_corner(V3 a, V3 b);
HOT NodeBox box_of_node(Store *s);
INLINE Symmetric square_of_matrix(Symmetric m);
HOT V3 thinnest_direction(Store *s);
INLINE real largest_along(NodeBox bounds, V3 n);
HOT NodeSlab slab_of_node(Store *s, NodeBox bounds);
INLINE real rise(NodeWeights w, V3 u);
HOT Rest rest_of_sampled(Store *s, V3 middle, NodeWeights w);
HOT NodeWeights fit_of_sampled(Store *s, V3 middle, real width, real base, uint unknowns);
INLINE void add_largest(real lo, real hi, real slope, real curvature, real its_slope, real its_curvature, real *sum, real *size);
HOT NodeWeights weights_of_node(Store *s, NodeBox bounds);
INLINE V3 middle_of(V3 lo, V3 hi);
INLINE V3 half_of(V3 lo, V3 hi, real margin);
INLINE V3 part_lo(V3 lo, V3 hi, uint octant);
INLINE V3 part_hi(V3 lo, V3 hi, uint octant);
INLINE V3 octree_place(V3 middle, V3 halves, uint i);
INLINE real power_at(V3 site, real weight, V3 place);
INLINE SeenSite seen_from(V3 place, real excess, V3 middle);
INLINE real more_power(SeenSite site, SeenSite other, V3 halves);
INLINE float way_home(V3 site, real power, V3 first, real least);

#import "generated/vector.cl"
#import "generated/quadratic.cl"
#import "generated/node.cl"
#import "generated/octree.cl"
