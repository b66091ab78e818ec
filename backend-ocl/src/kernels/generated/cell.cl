// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import <store>
#import "world.cl"
#import "further.cl"

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
INLINE Plane bisector(V3 d, real dw);
OUTLINE Plane cone_side(V3 o, V3 lo_o, V3 edge, real sign);
OUTLINE Plane triangle_plane(V3 a, V3 b, V3 c, real sign);
OUTLINE Plane wall_over_edge(V3 n, V3 a, V3 b);
HOT uint place_vertex(Store *s, uint v);
HOT uint find_vertex(Store *s, Triplet t, V3 *position, real *radius);
HOT uint find_vertex_refined(Store *s, Triplet t, V3 *position, real *radius);
INLINE void refine_by(Store *s, Triplet t, Cramer by, V3 *position, real *radius);
INLINE void place_by(Cramer by, real inverse, V3 *position, real *radius);
INLINE void step_by(Store *s, Triplet t, Cramer by, real inverse, V3 *position, real *radius);
HOT uint find_vertex_closely(Store *s, Triplet t, real most, V3 *position, real *radius);
HOT uint find_vertex_once(Store *s, Triplet t, real least, V3 *position, real *radius);
INLINE Cramer cramer(Store *s, Triplet t);
INLINE V3 solve(Cramer by, real inverse);
INLINE real residual(Plane plane, V3 x);
OUTLINE real residual_about(Plane plane, V3 c, V3 x);
INLINE V3 combine(real ra, real rb, real rc, V3 bc, V3 ca, V3 ab);
OUTLINE int sign_of_conflict(Store *s, uint v, uint k);
OUTLINE Minors minors_of(Plane a, Plane b, Plane c);
OUTLINE int sign_by_minors(Minors minors, Plane e);
INLINE int sign_beyond(Wide sum, real size);
OUTLINE int wide_sign(Plane a, Plane b, Plane c, Plane e);
INLINE void add_term(Wide *sum, real *size, real x0, real y0, real x1, real y1, real z2, real w2, real z3, real w3, real sign);
INLINE Wide minor(real x0, real y0, real x1, real y1);
INLINE Wide product_exact(real a, real b);
INLINE real rest_of_product(real a, real b);
INLINE Wide wide_add(Wide a, Wide b);
INLINE Wide multiply(Wide a, Wide b);
INLINE Wide sum_exact(real a, real b);
OUTLINE real wide_quotient(Wide a, Wide b);
OUTLINE uint wide_position(Plane a, Plane b, Plane c, V3 *position, real *radius);
INLINE Wide3 wide_cross(V3 p, V3 q);
INLINE Wide wide_dot(Wide3 a, V3 b);
INLINE Wide wide_scaled(Wide a, real by);
INLINE Wide wide_combine(Wide x, Wide y, Wide z, real a, real b, real c);
OUTLINE int expansion_sign(Plane a, Plane b, Plane c, Plane e);
OUTLINE uint expansion_position(Plane a, Plane b, Plane c, V3 *position);
INLINE bool is_tiny(Plane plane);
INLINE uint is_tiny_number(real x);
OUTLINE void add_minors(Expansion *sum, real x0, real y0, real x1, real y1, real z2, real w2, real z3, real w3);
OUTLINE void add_four(Expansion *sum, Wide p, Wide q);
INLINE void add_product(Expansion *sum, real x, real y);
OUTLINE void add_number(Expansion *sum, real x);
OUTLINE Wide value_of(Expansion *sum);
OUTLINE Wide determinant(V3 a, V3 b, V3 c);
OUTLINE void add_triple(Expansion *sum, real x, real y, real z);
OUTLINE void set_box_planes(Store *s, V3 lo, V3 hi);
OUTLINE void set_box_plane(Store *s, uint f, V3 n, real d);
HOT void place_corner(Store *s, uint v);
OUTLINE real integrate_function(Store *s, V3 center);
OUTLINE void add_fans_at_edge(Store *s, uint v, uint f, uint g, V3 center, Wide *sum);
OUTLINE uint first_vertex_on(Store *s, uint f, uint g, uint end);
OUTLINE void add_quadrature(Store *s, real volume, V3 a, V3 b, V3 c, V3 center, Wide *sum);
INLINE void add_compensated(real x, Wide *sum);
OUTLINE real polynomial(Store *s, V3 x);
HOT bool volume_is_above_bound(CellSums sums);
HOT uint integrate(Store *s, real weight, V3 center, real reach, uint flags, CellSums *sums);
OUTLINE CellSums both_sums(CellSums a, CellSums b);
INLINE Side side(Store *s, uint f, V3 center);
INLINE uint add_edge(Store *s, Side f, Side g, Corner at, real weight, V3 center, uint flags, CellSums *part);
INLINE V3 spoke_of(V3 foot, V3 position);
INLINE real rounding_across(real distance, real spoke);
INLINE uint foot_on_edge(Store *s, Side f, Side g, V3 center, bool is_bounded, V3 *foot, real *off);
INLINE V3 foot_by(V3 n_f, real d_f, V3 n_g, real d_g, V3 direction, real per_square);
INLINE bool is_plain(real square, real whole);
INLINE real off_plain_foot(V3 foot, real per_sine_square, V3 center);
INLINE real radius_at(real radius, real reach);
INLINE Piece piece_of(real volume, V3 h, V3 i, V3 v);
INLINE void add_piece(Piece piece, CellSums *part);
INLINE void add_tetrahedron(real volume, V3 h, V3 i, V3 v, uint flags, CellSums *part);
INLINE V3 second_diagonal(V3 h, V3 i, V3 v, V3 s);
INLINE V3 second_mixed(V3 h, V3 i, V3 v, V3 s);
INLINE real squares(real a, real b, real c);
INLINE real products(real a, real b, real c, real d, real e, real f);
OUTLINE V3 reference_point(Store *s);
OUTLINE bool facet_is_above_bound(FacetSum sum);
INLINE void add_triangle(Side f, V3 foot, real off, Corner at, real sign, V3 center, bool area_alone, FacetSum *sum);
INLINE V3 moment_of_triangle(Side f, V3 foot, V3 position, V3 center, real area);
INLINE real rounding_of_triangle(Side f, V3 foot, real off, V3 position, real radius);
INLINE real per_length(Side f);
INLINE real area_of_triangle(Side f, real per_length, V3 to_foot, V3 to_vertex, real sign);
OUTLINE uint integrate_facet(Store *s, uint index, V3 center, real reach, FacetSum *sum);
OUTLINE void reset_facets(Store *s, uint flags);
INLINE bool asks_for_boundary(uint flags);
OUTLINE void add_boundary(FacetSum sum, Plane plane, real outward, CellSums *sums);
OUTLINE uint add_facet_seconds(Store *s, real weight, V3 center);
OUTLINE uint add_edge_second(Store *s, Side f, Side g, V3 position, real weight, V3 center);
OUTLINE void add_triangle_second(Store *s, Side f, V3 foot, V3 position, real sign);
OUTLINE void center_facets(Store *s, V3 center);
OUTLINE bool surface_passes_by(Store *s, V3 low, V3 high, Voxel lo, Voxel hi, int *winding);
INLINE bool row_is_empty(Store *s, Voxel lo, Voxel hi, uint j, uint k);
OUTLINE bool site_is_inside(Store *s);
HOT bool voxel_passes_by(Store *s, Voxel voxel, Voxel lo, V3 low, V3 high, int *winding);
HOT bool triangle_passes_by(Store *s, uint t, Voxel apex, V3 low, V3 high, int *winding);
INLINE bool are_apart(V3 a, V3 b, V3 c, V3 d);
HOT bool plane_is_apart(Store *s, V3 a_in, V3 e, V3 f);
INLINE V3 least_of(V3 a, V3 b, V3 c);
INLINE V3 most_of(V3 a, V3 b, V3 c);
INLINE bool is_first_voxel(Voxel lowest, Voxel lo, Voxel voxel);
HOT void outer_box_of_cell(Store *s, V3 *low, V3 *high);
HOT real box_of_cell(Store *s, V3 *low, V3 *high);
HOT void voxels_of_box(Store *s, V3 low, V3 high, Voxel *lo, Voxel *hi);
OUTLINE uint make_cone(Store *s, uint t, Voxel apex, TruncatedCone *cone);
OUTLINE TruncatedCone no_cone();
OUTLINE uint make_prism(Store *s, uint t, Voxel apex, TruncatedCone *prism);
INLINE Plane side_over_edge(uint i, uint j, V3 p, V3 q, V3 o, V3 o_in, real sign);
OUTLINE uint lies_beyond(Store *s, uint t, Voxel apex);
OUTLINE Voxel nearest_corner(Store *s, V3 x, Voxel lo, Voxel hi);
INLINE uint nearest_of(real x, real low, real high, uint at, uint least, uint most);
OUTLINE int cone_sign(Store *s, uint t, Voxel apex, V3 a, V3 b, V3 c);
HOT int filtered_sign(V3 a, V3 b, V3 c);
INLINE V3 magnitudes(V3 a);
HOT uint settle(Store *s, CellSums *sums);
HOT bool is_undivided(CellSums sums, CellSums whole, int *winding);
OUTLINE bool lies_outside(Store *s);
HOT void add_to_part(Store *s, uint v, V3 direction, real height, V3 *low, V3 *high);
OUTLINE bool widen_part(Store *s, V3 direction, real height, real radius, V3 *low, V3 *high);
HOT V3 middle_of_part(V3 low, V3 size, uint n);
HOT V3 middle_within_part(V3 middle, V3 size, uint n);
HOT bool box_has_nothing(Store *s, V3 direction, real height, V3 middle, V3 size);
HOT bool box_is_outside(Store *s, V3 low, V3 high);
HOT bool box_misses_part(Store *s, V3 direction, real height, V3 middle, V3 halves);
INLINE real reach_along(V3 n, V3 halves);
HOT real next_distance(real distance, real radius);
HOT uint cap_outside(Store *s, real radius);
HOT V3 farthest_position(Store *s);
HOT bool part_is_outside(Store *s, V3 direction, real height);
HOT bool parts_are_outside(Store *s, V3 direction, real height, V3 low, V3 extent);

#import "generated/vector.cl"
#import "generated/plane.cl"
#import "generated/vertex.cl"
#import "generated/wide.cl"
#import "generated/expansion.cl"
#import "generated/first.cl"
#import "generated/quadrature.cl"
#import "generated/integrate.cl"
#import "generated/facet.cl"
#import "generated/near.cl"
#import "generated/cone.cl"
#import "generated/settle.cl"
#import "generated/part.cl"
#import "generated/cap.cl"
