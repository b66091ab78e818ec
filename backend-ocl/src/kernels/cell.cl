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
HOT uint find_vertex_once(Store *s, Triplet t, V3 *position, real *radius);
INLINE Cramer cramer(Store *s, Triplet t);
INLINE V3 solve(Cramer by, real inverse);
OUTLINE real residual(Plane plane, V3 x);
OUTLINE real residual_about(Plane plane, V3 c, V3 x);
INLINE V3 combine(real ra, real rb, real rc, V3 bc, V3 ca, V3 ab);
INLINE real farthest_vertex(Store *s);
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
INLINE uint is_tiny(Plane plane);
INLINE uint is_tiny_number(real x);
OUTLINE void add_minors(Expansion *sum, real x0, real y0, real x1, real y1, real z2, real w2, real z3, real w3);
OUTLINE void add_four(Expansion *sum, Wide p, Wide q);
INLINE void add_product(Expansion *sum, real x, real y);
OUTLINE void add_number(Expansion *sum, real x);
OUTLINE Wide value_of(Expansion *sum);
OUTLINE Wide determinant(V3 a, V3 b, V3 c);
OUTLINE void add_triple(Expansion *sum, real x, real y, real z);
OUTLINE uint begin(Store *s, V3 lo, V3 hi);
OUTLINE void set_box_planes(Store *s, V3 lo, V3 hi);
HOT uint place_corner(Store *s, uint v);
OUTLINE void set_box_plane(Store *s, uint f, V3 n, real d);
OUTLINE uint clip(Store *s, Plane plane, uint tag);
OUTLINE uint settle_marks(Store *s, uint k);
INLINE void toggle_link(Store *s, uint f, uint change);
OUTLINE void clear_links(Store *s);
OUTLINE void find_boundary_edge(Store *s, uint end, Triplet *edge);
INLINE uint is_boundary_edge(Store *s, uint end, uint a, uint b);
OUTLINE void compact_planes(Store *s);
OUTLINE real integrate_function(Store *s, V3 center);
OUTLINE void add_fans_at_edge(Store *s, uint v, uint f, uint g, V3 center, Wide *sum);
OUTLINE uint first_vertex_on(Store *s, uint f, uint g, uint end);
OUTLINE void add_quadrature(Store *s, real volume, V3 a, V3 b, V3 c, V3 center, Wide *sum);
INLINE void add_compensated(real x, Wide *sum);
OUTLINE real polynomial(Store *s, V3 x);
HOT uint volume_is_above_bound(CellSums sums);
HOT uint integrate(Store *s, real weight, V3 center, real reach, uint flags, CellSums *sums);
INLINE Side side(Store *s, uint f, V3 center);
INLINE uint add_edge(Store *s, Side f, Side g, Corner at, real weight, V3 center, uint flags, CellSums *part);
INLINE uint foot_on_edge(Store *s, Side f, Side g, V3 center, V3 *foot, real *off);
INLINE void add_tetrahedron(real volume, V3 h, V3 i, V3 v, uint flags, CellSums *part);
INLINE V3 second_diagonal(V3 h, V3 i, V3 v, V3 s);
INLINE V3 second_mixed(V3 h, V3 i, V3 v, V3 s);
INLINE real squares(real a, real b, real c);
INLINE real products(real a, real b, real c, real d, real e, real f);
OUTLINE V3 reference_point(Store *s);
OUTLINE uint facet_is_above_bound(FacetSum sum);
INLINE void add_triangle(Side f, V3 foot, real off, Corner at, real sign, V3 center, FacetSum *sum);
INLINE real area_of_triangle(Side f, V3 to_foot, V3 to_vertex, real sign);
OUTLINE uint integrate_facet(Store *s, uint index, V3 center, FacetSum *sum);
OUTLINE void reset_facets(Store *s, uint flags);
OUTLINE void add_boundary(FacetSum sum, Plane plane, real outward, CellSums *sums);
OUTLINE uint add_facet_seconds(Store *s, real weight, V3 center);
OUTLINE uint add_edge_second(Store *s, Side f, Side g, V3 position, real weight, V3 center);
OUTLINE void add_triangle_second(Store *s, Side f, V3 foot, V3 position, real sign);
OUTLINE void center_facets(Store *s, V3 center);
OUTLINE uint add_cone(Store *s, uint t, Voxel apex, V3 center, uint flags, uint *touched, CellSums *sums);
OUTLINE uint clip_by_sides(Store *s, TruncatedCone cone);
OUTLINE uint add_surface(Store *s, uint t, Voxel apex, V3 center, CellSums *sums);
INLINE uint all_in_conflict(Store *s, uint k, Plane plane);
OUTLINE uint make_cone(Store *s, uint t, Voxel apex, TruncatedCone *cone);
OUTLINE TruncatedCone no_cone();
OUTLINE uint make_prism(Store *s, uint t, Voxel apex, TruncatedCone *prism);
INLINE Plane side_over_edge(uint i, uint j, V3 p, V3 q, V3 o, V3 o_in, real sign);
OUTLINE int cone_sign(Store *s, uint t, Voxel apex, V3 a, V3 b, V3 c);
HOT int filtered_sign(V3 a, V3 b, V3 c);
INLINE V3 magnitudes(V3 a);
OUTLINE uint surface_passes_by(Store *s, V3 low, V3 high, Voxel lo, Voxel hi, int *winding);
OUTLINE uint site_is_inside(Store *s);
HOT uint voxel_passes_by(Store *s, Voxel voxel, Voxel lo, V3 low, V3 high, int *winding);
HOT uint triangle_passes_by(Store *s, uint t, Voxel apex, V3 low, V3 high, int *winding);
INLINE uint are_apart(V3 a, V3 b, V3 c, V3 d);
HOT uint plane_is_apart(Store *s, V3 a_in, V3 e, V3 f);
INLINE V3 least_of(V3 a, V3 b, V3 c);
INLINE V3 most_of(V3 a, V3 b, V3 c);
INLINE uint is_first_voxel(Voxel lowest, Voxel lo, Voxel voxel);
OUTLINE uint integrate_cell(Store *s, uint flags, uint interior_only, CellSums *sums);
OUTLINE uint integrate_restricted(Store *s, V3 center, uint flags, uint interior_only, CellSums *sums);
HOT uint is_undivided(CellSums sums, CellSums whole, int *winding);
HOT uint settle(Store *s, CellSums *sums);
OUTLINE uint lies_outside(Store *s);
OUTLINE uint integrate_whole(Store *s, real weight, V3 center, uint flags, CellSums *sums);
OUTLINE void add_box_faces(Store *s, CellSums *sums);
HOT real box_of_cell(Store *s, V3 *low, V3 *high);
HOT void outer_box_of_cell(Store *s, V3 *low, V3 *high);
HOT void voxels_of_box(Store *s, V3 low, V3 high, Voxel *lo, Voxel *hi);
OUTLINE uint add_cones(Store *s, Voxel lo, Voxel hi, V3 center, uint flags, uint *touched, CellSums *sums);
OUTLINE uint cap_outside(Store *s, real radius);
HOT real next_distance(real distance, real radius);
OUTLINE V3 farthest_position(Store *s);
OUTLINE uint part_is_outside(Store *s, V3 direction, real height);
HOT void add_to_part(Store *s, uint v, V3 direction, real height, V3 *low, V3 *high);
OUTLINE uint widen_part(Store *s, V3 direction, real height, real radius, V3 *low, V3 *high);
OUTLINE uint boxes_are_outside(Store *s, V3 direction, real height, V3 low, V3 high, uint first, uint step);
HOT uint box_is_outside(Store *s, V3 low, V3 high);
HOT uint box_misses_part(Store *s, V3 direction, real height, V3 middle, V3 halves);
INLINE real reach_along(V3 n, V3 halves);

// core/src/cell/vector.rs

// The vector (x, y, z).
INLINE V3 v3(real x, real y, real z) {
    return (V3){ .x = x, .y = y, .z = z };
}

// a + b.
INLINE V3 add(V3 a, V3 b) {
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

// a − b.
INLINE V3 sub(V3 a, V3 b) {
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

// t·a.
INLINE V3 scale(real t, V3 a) {
    return v3(t * a.x, t * a.y, t * a.z);
}

// a·b.
INLINE real v3_dot(V3 a, V3 b) {
    return ((a.x * b.x) + (a.y * b.y)) + (a.z * b.z);
}

// a×b. Exactly −(b×a) also in floating point.
INLINE V3 v3_cross(V3 a, V3 b) {
    return v3((a.y * b.z) - (a.z * b.y), (a.z * b.x) - (a.x * b.z), (a.x * b.y) - (a.y * b.x));
}

// Sum of the components' magnitudes, at least the Euclidean norm.
INLINE real norm_1(V3 a) {
    return (fabs(a.x) + fabs(a.y)) + fabs(a.z);
}

// Largest magnitude of a component.
INLINE real norm_max(V3 a) {
    real m = fabs(a.x);
    if (fabs(a.y) > m) {
        m = fabs(a.y);
    }
    if (fabs(a.z) > m) {
        m = fabs(a.z);
    }
    return m;
}

// The smaller of two numbers.
INLINE real smaller(real a, real b) {
    if (b < a) {
        return b;
    }
    return a;
}

// The larger of two numbers.
INLINE real larger(real a, real b) {
    if (b > a) {
        return b;
    }
    return a;
}

// core/src/cell/status.rs

// core/src/cell/plane.rs

// The power bisector of a site at the origin and a site at `d`, keeping the origin's side; `dw = w_i − w_j`, the
// origin's weight less the other's. `n = −d`, offset `(‖d‖² + dw)/2` (paper §2.3).
INLINE Plane bisector(V3 d, real dw) {
    return (Plane){ .n = v3(-d.x, -d.y, -d.z), .d = REAL(0.5) * (v3_dot(d, d) + dw) };
}

// The side of the truncated cone of apex `o` over the edge from `lo` to `hi` (the ends in index order), both relative to the
// apex's frame as `lo_o = lo − o` and `edge = hi − lo`; keeps the side where `sign·(lo_o × edge)·(x − o) ≥ 0`.
//
// `lo_o × edge` is `(lo − o) × (hi − o)` without the cancellation of short edges. The triangle on the other side of the
// edge gets the same plane negated, to the last bit.
OUTLINE Plane cone_side(V3 o, V3 lo_o, V3 edge, real sign) {
    const V3 n = scale(sign, v3_cross(lo_o, edge));
    return (Plane){ .n = n, .d = -v3_dot(n, o) };
}

// The plane of triangle `(a, b, c)`, keeping the side where `sign·(b − a)×(c − a)·(x − a) ≥ 0`.
OUTLINE Plane triangle_plane(V3 a, V3 b, V3 c, real sign) {
    const V3 n = scale(sign, v3_cross(sub(b, a), sub(c, a)));
    return (Plane){ .n = n, .d = -v3_dot(n, a) };
}

// The plane through the edge from `a` to `b` of a triangle, across the triangle's own plane of normal `n`; keeps the side
// where `(n × (b − a))·(x − a) ≥ 0`: the triangle's, where it is counterclockwise about `n`.
OUTLINE Plane wall_over_edge(V3 n, V3 a, V3 b) {
    const V3 inward = v3_cross(n, sub(b, a));
    return (Plane){ .n = inward, .d = -v3_dot(inward, a) };
}

// core/src/cell/vertex.rs

// Computes the position of vertex `v` from its triplet and sets it, see [`find_vertex`].
HOT uint place_vertex(Store *s, uint v) {
    V3 position = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real radius = REAL(0.0);
    const uint status = find_vertex(s, store_triplet(s, v), &position, &radius);
    if (status == COMPLETE) {
        store_set_position(s, v, position, radius);
    }
    return status;
}

// The position of the vertex with triplet `t`, and an error radius such that
// `|fl(n·v + d) − (n·v* + d)| ≤ ‖n‖₁·radius + 4u|d|` for every plane, `v*` the exact vertex.
//
// (The rare ways out read the planes again: what is handed to a function that is not inlined cannot stay in a GPU's registers before it.)
HOT uint find_vertex(Store *s, Triplet t, V3 *position, real *radius) {
    const Cramer by = cramer(s, t);
    if (!(by.det > (NEARLY_DEPENDENT * by.size))) {
        V3 exact = v3(REAL(0.0), REAL(0.0), REAL(0.0));
        real its = REAL(0.0);
        if (wide_position(store_plane(s, t.a), store_plane(s, t.b), store_plane(s, t.c), &exact, &its) == COMPLETE) {
            *position = exact;
            *radius = its;
            return COMPLETE;
        }
        store_note_exact(s);
        if (expansion_position(store_plane(s, t.a), store_plane(s, t.b), store_plane(s, t.c), &exact) != COMPLETE) {
            if (store_exact_position(s, t, &exact) != COMPLETE) {
                return UNCERTAIN;
            }
        }
        *position = exact;
        *radius = (ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * norm_max(exact);
        return COMPLETE;
    }
    const real inverse = REAL(1.0) / by.det;
    const real amplified = (ROUNDINGS_OF_PLACE * UNIT_ROUNDOFF) * inverse;
    *position = solve(by, inverse);
    *radius = amplified * (by.offsets + (norm_max(*position) * by.size));
    if (by.det < (WORTH_REFINING * by.size)) {
        // A step of Newton's method: residuals in double-double, so that it ends within a rounding in every direction, also the one
        // in which the planes hardly tell one point from the next.
        const real rest_a = residual(store_plane(s, t.a), *position);
        const real rest_b = residual(store_plane(s, t.b), *position);
        const real rest_c = residual(store_plane(s, t.c), *position);
        *position = sub(*position, scale(inverse, combine(rest_a, rest_b, rest_c, by.bc, by.ca, by.ab)));
        *radius = ((ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * norm_max(*position)) + (*radius * (amplified * by.size));
    }
    return COMPLETE;
}

// The position of the vertex with triplet `t` without refinement, and its error radius: enough where both are rounded to single precision
// anyway. `UNCERTAIN` where the normals are nearly dependent.
HOT uint find_vertex_once(Store *s, Triplet t, V3 *position, real *radius) {
    const Cramer by = cramer(s, t);
    if (!(by.det > (NEARLY_DEPENDENT * by.size))) {
        return UNCERTAIN;
    }
    const real inverse = REAL(1.0) / by.det;
    *position = solve(by, inverse);
    *radius = ((ROUNDINGS_OF_PLACE * UNIT_ROUNDOFF) * inverse) * (by.offsets + (norm_1(*position) * by.size));
    return COMPLETE;
}

INLINE Cramer cramer(Store *s, Triplet t) {
    const Plane pa = store_plane(s, t.a);
    const Plane pb = store_plane(s, t.b);
    const Plane pc = store_plane(s, t.c);
    const V3 bc = v3_cross(pb.n, pc.n);
    const real size_a = norm_1(pa.n);
    const real size_b = norm_1(pb.n);
    const real size_c = norm_1(pc.n);
    return (Cramer){ .bc = bc, .ca = v3_cross(pc.n, pa.n), .ab = v3_cross(pa.n, pb.n), .d = v3(pa.d, pb.d, pc.d), .det = v3_dot(pa.n, bc), .size = (size_a * size_b) * size_c, .offsets = (((fabs(pa.d) * size_b) * size_c) + ((fabs(pb.d) * size_c) * size_a)) + ((fabs(pc.d) * size_a) * size_b) };
}

// `v = −(d_a n_b×n_c + d_b n_c×n_a + d_c n_a×n_b) / det(n_a, n_b, n_c)`, `inverse` one over that determinant.
INLINE V3 solve(Cramer by, real inverse) {
    return scale(-inverse, combine(by.d.x, by.d.y, by.d.z, by.bc, by.ca, by.ab));
}

// `n·x + d`, rounded once or little more.
OUTLINE real residual(Plane plane, V3 x) {
    const Wide first = wide_add(product_exact(plane.n.x, x.x), product_exact(plane.n.y, x.y));
    const Wide second = wide_add(product_exact(plane.n.z, x.z), (Wide){ .hi = plane.d, .lo = REAL(0.0) });
    const Wide sum = wide_add(first, second);
    return sum.hi + sum.lo;
}

// `n·(c + x) + d`, rounded once or little more.
OUTLINE real residual_about(Plane plane, V3 c, V3 x) {
    const Wide first = wide_add(product_exact(plane.n.x, x.x), product_exact(plane.n.y, x.y));
    const Wide second = wide_add(product_exact(plane.n.z, x.z), product_exact(plane.n.x, c.x));
    const Wide third = wide_add(product_exact(plane.n.y, c.y), product_exact(plane.n.z, c.z));
    const Wide sum = wide_add(wide_add(first, second), wide_add(third, (Wide){ .hi = plane.d, .lo = REAL(0.0) }));
    return sum.hi + sum.lo;
}

// `r_a·bc + r_b·ca + r_c·ab`.
INLINE V3 combine(real ra, real rb, real rc, V3 bc, V3 ca, V3 ab) {
    return add(add(scale(ra, bc), scale(rb, ca)), scale(rc, ab));
}

// An upper bound of the distance from the site to the farthest vertex.
INLINE real farthest_vertex(Store *s) {
    const V3 largest = store_farthest(s);
    // The radius bounds each component; √3 < 2.
    return (sqrt(largest.x) + (REAL(2.0) * largest.y)) * (REAL(1.0) + (REAL(16.0) * UNIT_ROUNDOFF));
}

// core/src/cell/store.rs

// core/src/cell/wide.rs

// The sign of the 4×4 determinant of `[n | d]` of the planes of vertex `v` and of plane `k`: −1, 0 or 1, or `SIGN_UNKNOWN`
// where no stage of the store can decide it. Negative: the vertex is in conflict with `k`. Four stages: double-double,
// integers that wrap, expansions, and the store's own.
OUTLINE int sign_of_conflict(Store *s, uint v, uint k) {
    const Triplet t = store_triplet(s, v);
    const Plane a = store_plane(s, t.a);
    const Plane b = store_plane(s, t.b);
    const Plane c = store_plane(s, t.c);
    const Plane e = store_plane(s, k);
    int sign;
    if (store_keeps_minors(s) != 0) {
        Minors minors = store_minors(s, v);
        if (minors.is_known == 0) {
            minors = minors_of(a, b, c);
            store_keep_minors(s, v, minors);
        }
        sign = sign_by_minors(minors, e);
    } else {
        sign = wide_sign(a, b, c, e);
    }
    if (sign != SIGN_UNKNOWN) {
        return sign;
    }
    store_note_exact(s);
    sign = store_tie_sign(s, t, k);
    if (sign != SIGN_UNKNOWN) {
        return sign;
    }
    sign = expansion_sign(a, b, c, e);
    if (sign != SIGN_UNKNOWN) {
        return sign;
    }
    return store_exact_sign(s, t, k);
}

// The minors of three planes.
OUTLINE Minors minors_of(Plane a, Plane b, Plane c) {
    // Of columns z and d, and of x and y.
    const Wide3 zd = (Wide3){ .x = minor(b.n.z, b.d, c.n.z, c.d), .y = minor(c.n.z, c.d, a.n.z, a.d), .z = minor(a.n.z, a.d, b.n.z, b.d) };
    const Wide3 xy = (Wide3){ .x = minor(b.n.x, b.n.y, c.n.x, c.n.y), .y = minor(c.n.x, c.n.y, a.n.x, a.n.y), .z = minor(a.n.x, a.n.y, b.n.x, b.n.y) };
    const V3 zd_size = v3(fabs(b.n.z * c.d) + fabs(c.n.z * b.d), fabs(c.n.z * a.d) + fabs(a.n.z * c.d), fabs(a.n.z * b.d) + fabs(b.n.z * a.d));
    const V3 xy_size = v3(fabs(b.n.x * c.n.y) + fabs(c.n.x * b.n.y), fabs(c.n.x * a.n.y) + fabs(a.n.x * c.n.y), fabs(a.n.x * b.n.y) + fabs(b.n.x * a.n.y));
    return (Minors){ .x = wide_dot(zd, v3(a.n.y, b.n.y, c.n.y)), .y = wide_dot(zd, v3(a.n.x, b.n.x, c.n.x)), .z = wide_dot(xy, v3(a.d, b.d, c.d)), .d = wide_dot(xy, v3(a.n.z, b.n.z, c.n.z)), .size = (Plane){ .n = v3(((fabs(a.n.y) * zd_size.x) + (fabs(b.n.y) * zd_size.y)) + (fabs(c.n.y) * zd_size.z), ((fabs(a.n.x) * zd_size.x) + (fabs(b.n.x) * zd_size.y)) + (fabs(c.n.x) * zd_size.z), ((fabs(a.d) * xy_size.x) + (fabs(b.d) * xy_size.y)) + (fabs(c.d) * xy_size.z)), .d = ((fabs(a.n.z) * xy_size.x) + (fabs(b.n.z) * xy_size.y)) + (fabs(c.n.z) * xy_size.z) }, .is_known = 1 };
}

// The sign of `det [n|d](a, b, c, e)` by the minors of a, b and c: `e_y M_y − e_x M_x + d M_d − e_z M_z`; or `SIGN_UNKNOWN`. A term passes through
// one minor, two products and four sums: less than in `wide_sign`.
OUTLINE int sign_by_minors(Minors minors, Plane e) {
    const Wide first = wide_add(wide_scaled(minors.y, e.n.y), wide_scaled(minors.x, -e.n.x));
    const Wide second = wide_add(wide_scaled(minors.d, e.d), wide_scaled(minors.z, -e.n.z));
    const Wide sum = wide_add(first, second);
    const real size = ((minors.size.n.y * fabs(e.n.y)) + (minors.size.n.x * fabs(e.n.x))) + ((minors.size.d * fabs(e.d)) + (minors.size.n.z * fabs(e.n.z)));
    return sign_beyond(sum, size);
}

// The sign of a determinant whose magnitudes sum to `size`, or `SIGN_UNKNOWN`.
INLINE int sign_beyond(Wide sum, real size) {
    if ((size < WIDE_SMALLEST) || !(fabs(sum.hi) > (WIDE_ERROR * size))) {
        return SIGN_UNKNOWN;
    }
    if (sum.hi < REAL(0.0)) {
        return -1;
    }
    return 1;
}

// The sign of `det [n|d](a, b, c, e)` by double-double arithmetic, or `SIGN_UNKNOWN`.
OUTLINE int wide_sign(Plane a, Plane b, Plane c, Plane e) {
    // Laplace expansion along the first two columns: x, y against z, d.
    Wide sum = (Wide){ .hi = REAL(0.0), .lo = REAL(0.0) };
    real size = REAL(0.0);
    add_term(&sum, &size, a.n.x, a.n.y, b.n.x, b.n.y, c.n.z, c.d, e.n.z, e.d, REAL(1.0));
    add_term(&sum, &size, a.n.x, a.n.y, c.n.x, c.n.y, b.n.z, b.d, e.n.z, e.d, -REAL(1.0));
    add_term(&sum, &size, a.n.x, a.n.y, e.n.x, e.n.y, b.n.z, b.d, c.n.z, c.d, REAL(1.0));
    add_term(&sum, &size, b.n.x, b.n.y, c.n.x, c.n.y, a.n.z, a.d, e.n.z, e.d, REAL(1.0));
    add_term(&sum, &size, b.n.x, b.n.y, e.n.x, e.n.y, a.n.z, a.d, c.n.z, c.d, -REAL(1.0));
    add_term(&sum, &size, c.n.x, c.n.y, e.n.x, e.n.y, a.n.z, a.d, b.n.z, b.d, REAL(1.0));
    return sign_beyond(sum, size);
}

// Adds `sign·(x_0 y_1 − x_1 y_0)·(z_2 w_3 − z_3 w_2)` to `sum`, and the magnitude of its parts to `size`.
INLINE void add_term(Wide *sum, real *size, real x0, real y0, real x1, real y1, real z2, real w2, real z3, real w3, real sign) {
    const Wide left = minor(x0, y0, x1, y1);
    const Wide right = minor(z2, w2, z3, w3);
    const Wide product = multiply(left, right);
    const Wide scaled = (Wide){ .hi = sign * product.hi, .lo = sign * product.lo };
    *sum = wide_add(*sum, scaled);
    const real left_size = fabs(x0 * y1) + fabs(x1 * y0);
    const real right_size = fabs(z2 * w3) + fabs(z3 * w2);
    *size = *size + (left_size * right_size);
}

// `x_0 y_1 − x_1 y_0`.
INLINE Wide minor(real x0, real y0, real x1, real y1) {
    const Wide p = product_exact(x0, y1);
    const Wide q = product_exact(x1, y0);
    const Wide negated = (Wide){ .hi = -q.hi, .lo = -q.lo };
    return wide_add(p, negated);
}

// `a·b`, exactly.
INLINE Wide product_exact(real a, real b) {
    const real p = a * b;
    return (Wide){ .hi = p, .lo = rest_of_product(a, b) };
}

// What rounding leaves out of the product `a·b`.
//
// On devices one operation instead of sixteen, and the same bits.
INLINE real rest_of_product(real a, real b) {
    return fma(a, b, -(a * b));
}

// `a + b`, both halves exactly, then rounded to double-double.
INLINE Wide wide_add(Wide a, Wide b) {
    const Wide high = sum_exact(a.hi, b.hi);
    const Wide low = sum_exact(a.lo, b.lo);
    const Wide first = sum_exact(high.hi, high.lo + low.hi);
    return sum_exact(first.hi, first.lo + low.lo);
}

// `a·b`.
INLINE Wide multiply(Wide a, Wide b) {
    const Wide p = product_exact(a.hi, b.hi);
    const real rest = p.lo + ((a.hi * b.lo) + (a.lo * b.hi));
    return sum_exact(p.hi, rest);
}

// `a + b`, exactly.
INLINE Wide sum_exact(real a, real b) {
    const real s = a + b;
    const real t = s - a;
    const real error = (a - (s - t)) + (b - t);
    return (Wide){ .hi = s, .lo = error };
}

// `a/b`, rounded to one number: within a rounding and a little of the exact quotient.
OUTLINE real wide_quotient(Wide a, Wide b) {
    const real first = a.hi / b.hi;
    const Wide product = multiply((Wide){ .hi = first, .lo = REAL(0.0) }, b);
    const Wide rest = wide_add(a, (Wide){ .hi = -product.hi, .lo = -product.lo });
    return first + (rest.hi / b.hi);
}

// The position of the vertex of three planes by Cramer's rule in double-double, and its error radius; `UNCERTAIN` where their normals are dependent.
OUTLINE uint wide_position(Plane a, Plane b, Plane c, V3 *position, real *radius) {
    const real size_a = norm_1(a.n);
    const real size_b = norm_1(b.n);
    const real size_c = norm_1(c.n);
    const real size = (size_a * size_b) * size_c;
    const Wide3 x = wide_cross(b.n, c.n);
    const Wide3 y = wide_cross(c.n, a.n);
    const Wide3 z = wide_cross(a.n, b.n);
    const Wide det = wide_dot(x, a.n);
    if (!(size > WIDE_SMALLEST) || !(det.hi > (DEPENDENT * size))) {
        return UNCERTAIN;
    }
    *position = v3(wide_quotient(wide_combine(x.x, y.x, z.x, a.d, b.d, c.d), det), wide_quotient(wide_combine(x.y, y.y, z.y, a.d, b.d, c.d), det), wide_quotient(wide_combine(x.z, y.z, z.z, a.d, b.d, c.d), det));
    const real offsets = (((fabs(a.d) * size_b) * size_c) + ((fabs(b.d) * size_c) * size_a)) + ((fabs(c.d) * size_a) * size_b);
    const real largest = norm_max(*position);
    *radius = ((ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * largest) + ((WIDE_ERROR / det.hi) * (offsets + (largest * size)));
    return COMPLETE;
}

INLINE Wide3 wide_cross(V3 p, V3 q) {
    return (Wide3){ .x = minor(p.y, p.z, q.y, q.z), .y = minor(p.z, p.x, q.z, q.x), .z = minor(p.x, p.y, q.x, q.y) };
}

// `a·b` for a vector b of numbers.
INLINE Wide wide_dot(Wide3 a, V3 b) {
    return wide_add(wide_add(wide_scaled(a.x, b.x), wide_scaled(a.y, b.y)), wide_scaled(a.z, b.z));
}

INLINE Wide wide_scaled(Wide a, real by) {
    return multiply(a, (Wide){ .hi = by, .lo = REAL(0.0) });
}

// `−(a x + b y + c z)`.
INLINE Wide wide_combine(Wide x, Wide y, Wide z, real a, real b, real c) {
    return wide_add(wide_add(wide_scaled(x, -a), wide_scaled(y, -b)), wide_scaled(z, -c));
}

// core/src/cell/expansion.rs

// The sign of the 4×4 determinant with rows `[n | d]`, exactly, or `SIGN_UNKNOWN` where a product could underflow.
OUTLINE int expansion_sign(Plane a, Plane b, Plane c, Plane e) {
    if ((((is_tiny(a) + is_tiny(b)) + is_tiny(c)) + is_tiny(e)) != 0) {
        return SIGN_UNKNOWN;
    }
    Expansion sum = (Expansion){ .terms = { 0 }, .count = 0 };
    // Laplace expansion along the first two columns, as in the wide stage.
    add_minors(&sum, a.n.x, a.n.y, b.n.x, b.n.y, c.n.z, c.d, e.n.z, e.d);
    add_minors(&sum, c.n.x, c.n.y, a.n.x, a.n.y, b.n.z, b.d, e.n.z, e.d);
    add_minors(&sum, a.n.x, a.n.y, e.n.x, e.n.y, b.n.z, b.d, c.n.z, c.d);
    add_minors(&sum, b.n.x, b.n.y, c.n.x, c.n.y, a.n.z, a.d, e.n.z, e.d);
    add_minors(&sum, e.n.x, e.n.y, b.n.x, b.n.y, a.n.z, a.d, c.n.z, c.d);
    add_minors(&sum, c.n.x, c.n.y, e.n.x, e.n.y, a.n.z, a.d, b.n.z, b.d);
    const Wide value = value_of(&sum);
    if (value.hi > REAL(0.0)) {
        return 1;
    }
    if (value.hi < REAL(0.0)) {
        return -1;
    }
    return 0;
}

// The point where three planes meet, each component within a rounding of the exact one: quotients of determinants (Cramer),
// each exact before it is rounded. `UNCERTAIN` where a product could underflow, or the normals are dependent.
OUTLINE uint expansion_position(Plane a, Plane b, Plane c, V3 *position) {
    if (((is_tiny(a) + is_tiny(b)) + is_tiny(c)) != 0) {
        return UNCERTAIN;
    }
    const Wide det = determinant(a.n, b.n, c.n);
    if (det.hi == REAL(0.0)) {
        return UNCERTAIN;
    }
    const Wide x = determinant(v3(-a.d, a.n.y, a.n.z), v3(-b.d, b.n.y, b.n.z), v3(-c.d, c.n.y, c.n.z));
    const Wide y = determinant(v3(a.n.x, -a.d, a.n.z), v3(b.n.x, -b.d, b.n.z), v3(c.n.x, -c.d, c.n.z));
    const Wide z = determinant(v3(a.n.x, a.n.y, -a.d), v3(b.n.x, b.n.y, -b.d), v3(c.n.x, c.n.y, -c.d));
    *position = v3(wide_quotient(x, det), wide_quotient(y, det), wide_quotient(z, det));
    return COMPLETE;
}

// Whether (1) a coefficient is smaller than `EXPANSION_SMALLEST` and not zero.
INLINE uint is_tiny(Plane plane) {
    if (((is_tiny_number(plane.n.x) + is_tiny_number(plane.n.y)) + (is_tiny_number(plane.n.z) + is_tiny_number(plane.d))) != 0) {
        return 1;
    }
    return 0;
}

INLINE uint is_tiny_number(real x) {
    if ((fabs(x) < EXPANSION_SMALLEST) && (x != REAL(0.0))) {
        return 1;
    }
    return 0;
}

// Adds `(x_0 y_1 − x_1 y_0)·(z_2 w_3 − z_3 w_2)`.
OUTLINE void add_minors(Expansion *sum, real x0, real y0, real x1, real y1, real z2, real w2, real z3, real w3) {
    const Wide p = product_exact(x0, y1);
    const Wide q = product_exact(-x1, y0);
    const Wide r = product_exact(z2, w3);
    const Wide t = product_exact(-z3, w2);
    add_four(sum, p, r);
    add_four(sum, p, t);
    add_four(sum, q, r);
    add_four(sum, q, t);
}

// Adds `p·q`.
OUTLINE void add_four(Expansion *sum, Wide p, Wide q) {
    add_product(sum, p.lo, q.lo);
    add_product(sum, p.lo, q.hi);
    add_product(sum, p.hi, q.lo);
    add_product(sum, p.hi, q.hi);
}

// Adds `x·y`.
INLINE void add_product(Expansion *sum, real x, real y) {
    if ((x == REAL(0.0)) || (y == REAL(0.0))) {
        return;
    }
    const Wide p = product_exact(x, y);
    add_number(sum, p.lo);
    add_number(sum, p.hi);
}

// Adds one number: it passes through the terms from the smallest on and leaves each sum's rounding error behind.
OUTLINE void add_number(Expansion *sum, real x) {
    real carried = x;
    uint kept = 0;
    uint i = 0;
    while (i < sum->count) {
        const Wide next = sum_exact(carried, sum->terms[i]);
        carried = next.hi;
        if (next.lo != REAL(0.0)) {
            sum->terms[kept] = next.lo;
            kept += 1;
        }
        i += 1;
    }
    if (carried != REAL(0.0)) {
        sum->terms[kept] = carried;
        kept += 1;
    }
    sum->count = kept;
}

// The value rounded to double-double; the sign of its `hi` is the sign of the sum.
OUTLINE Wide value_of(Expansion *sum) {
    if (sum->count == 0) {
        return (Wide){ .hi = REAL(0.0), .lo = REAL(0.0) };
    }
    const uint last = sum->count - 1;
    real rest = REAL(0.0);
    uint i = 0;
    while (i < last) {
        rest = rest + sum->terms[i];
        i += 1;
    }
    return sum_exact(sum->terms[last], rest);
}

// `det(a, b, c)`, exactly before it is rounded to double-double.
OUTLINE Wide determinant(V3 a, V3 b, V3 c) {
    Expansion sum = (Expansion){ .terms = { 0 }, .count = 0 };
    add_triple(&sum, a.x, b.y, c.z);
    add_triple(&sum, -a.x, b.z, c.y);
    add_triple(&sum, a.y, b.z, c.x);
    add_triple(&sum, -a.y, b.x, c.z);
    add_triple(&sum, a.z, b.x, c.y);
    add_triple(&sum, -a.z, b.y, c.x);
    return value_of(&sum);
}

// Adds `x·y·z`.
OUTLINE void add_triple(Expansion *sum, real x, real y, real z) {
    const Wide p = product_exact(x, y);
    add_product(sum, p.lo, z);
    add_product(sum, p.hi, z);
}

// core/src/cell/clip.rs

// Starts the cell as the box with minimum corner `lo` and maximum corner `hi`, in the frame of the site.
//
// Planes 0 to 5 keep x ≥ lo.x, x ≤ hi.x, y ≥ lo.y, y ≤ hi.y, z ≥ lo.z, z ≤ hi.z.
OUTLINE uint begin(Store *s, V3 lo, V3 hi) {
    if ((store_cap_p(s) < 6) || (store_cap_v(s) < 8)) {
        return P_FULL;
    }
    set_box_planes(s, lo, hi);
    uint v = 0;
    while (v < 8) {
        const uint placed = place_corner(s, v);
        if (placed != COMPLETE) {
            return placed;
        }
        v += 1;
    }
    return COMPLETE;
}

// The six planes of the box; its corners are still to be placed.
OUTLINE void set_box_planes(Store *s, V3 lo, V3 hi) {
    set_box_plane(s, 0, v3(REAL(1.0), REAL(0.0), REAL(0.0)), -lo.x);
    set_box_plane(s, 1, v3(-REAL(1.0), REAL(0.0), REAL(0.0)), hi.x);
    set_box_plane(s, 2, v3(REAL(0.0), REAL(1.0), REAL(0.0)), -lo.y);
    set_box_plane(s, 3, v3(REAL(0.0), -REAL(1.0), REAL(0.0)), hi.y);
    set_box_plane(s, 4, v3(REAL(0.0), REAL(0.0), REAL(1.0)), -lo.z);
    set_box_plane(s, 5, v3(REAL(0.0), REAL(0.0), -REAL(1.0)), hi.z);
    store_set_planes(s, 6);
    store_set_vertices(s, 8);
}

// Places corner `v` of the box: bit 0 of `v` says whether it is on the maximum along x, bit 1 along y, bit 2 along z.
HOT uint place_corner(Store *s, uint v) {
    const uint on_x = v & 1;
    const uint on_y = (v >> 1) & 1;
    const uint on_z = (v >> 2) & 1;
    // The determinant of the three normals is the product of their signs: an odd number of maxima swaps two planes.
    if ((((on_x + on_y) + on_z) & 1) == 0) {
        store_set_triplet(s, v, (Triplet){ .a = on_x, .b = 2 + on_y, .c = 4 + on_z });
    } else {
        store_set_triplet(s, v, (Triplet){ .a = on_x, .b = 4 + on_z, .c = 2 + on_y });
    }
    return place_vertex(s, v);
}

OUTLINE void set_box_plane(Store *s, uint f, V3 n, real d) {
    store_set_plane(s, f, (Plane){ .n = n, .d = d });
    store_set_tag(s, f, TAG_BOX);
    store_set_link(s, f, 0);
}

// Clips the cell by `plane`, keeping the side where `n·x + d ≥ 0`; `tag` says whose plane it is. Returns `CUT`, `UNTOUCHED`,
// `EMPTY`, or `P_FULL`, `V_FULL`, `UNCERTAIN`, after which the cell must be begun again.
OUTLINE uint clip(Store *s, Plane plane, uint tag) {
    if (store_planes(s) == store_cap_p(s)) {
        compact_planes(s);
        if (store_planes(s) == store_cap_p(s)) {
            return P_FULL;
        }
    }
    const uint k = store_planes(s);
    store_set_plane(s, k, plane);
    // 1. Mark the vertices in conflict; what floating point cannot decide is decided exactly, and zero is no conflict.
    const uint seen = store_mark_conflicts(s, k);
    if ((seen & (SEEN_CONFLICT | SEEN_UNCERTAIN)) == 0) {
        return UNTOUCHED;
    }
    if (seen == SEEN_CONFLICT) {
        return EMPTY;
    }
    if ((seen & SEEN_UNCERTAIN) != 0) {
        if (settle_marks(s, k) != COMPLETE) {
            return UNCERTAIN;
        }
    }
    // 2. Link the planes around the hole. Marked vertex (a, b, c) contributes the directed edges a→b, b→c, c→a; an edge
    // cancels its reverse. Around plane a the marked vertices form one chain, so the exclusive or of their b and c
    // telescopes to next(a) ^ previous(a) on the boundary of the hole, and to 0 inside it.
    const uint end = store_vertices(s);
    uint marked = 0;
    uint v = store_next_conflict(s, 0, end);
    while (v < end) {
        const Triplet t = store_triplet(s, v);
        toggle_link(s, t.a, t.b ^ t.c);
        toggle_link(s, t.b, t.c ^ t.a);
        toggle_link(s, t.c, t.a ^ t.b);
        marked += 1;
        v = store_next_conflict(s, v + 1, end);
    }
    if (marked == 0) {
        return UNTOUCHED;
    }
    if (marked == end) {
        return EMPTY;
    }
    store_set_tag(s, k, tag);
    store_set_link(s, k, 0);
    store_set_planes(s, k + 1);
    // 3. One directed edge of that boundary, and from it once around: each edge a→b gives the new vertex (a, b, k), first
    // into the places of the marked vertices, then at the end.
    Triplet edge = (Triplet){ .a = 0, .b = 0, .c = 0 };
    find_boundary_edge(s, end, &edge);
    const uint first = edge.a;
    uint from = edge.a;
    uint to = edge.b;
    uint count = end;
    uint hole = store_next_conflict(s, 0, end);
    uint status;
    uint steps = 0;
    for (;;) {
        // The boundary is one cycle through each plane at most once; more steps would mean inconsistent signs.
        steps += 1;
        if (steps > k) {
            status = UNCERTAIN;
            break;
        }
        uint slot = hole;
        if (hole < end) {
            store_set_mark(s, hole, MARK_KEEP);
            hole = store_next_conflict(s, hole + 1, end);
        } else {
            if (count == store_cap_v(s)) {
                status = V_FULL;
                break;
            }
            slot = count;
            count += 1;
        }
        store_set_triplet(s, slot, (Triplet){ .a = from, .b = to, .c = k });
        status = place_vertex(s, slot);
        if (status != COMPLETE) {
            break;
        }
        const uint next = store_link(s, to) ^ from;
        store_set_link(s, to, 0);
        if (to == first) {
            break;
        }
        from = to;
        to = next;
    }
    if (status != COMPLETE) {
        clear_links(s);
        return status;
    }
    // 4. Fill the places left over from the end.
    while ((hole < end) && (hole < count)) {
        count -= 1;
        if (hole == count) {
            break;
        }
        if (store_mark(s, count) == MARK_CONFLICT) {
            continue;
        }
        store_move_vertex(s, count, hole);
        store_set_mark(s, hole, MARK_KEEP);
        hole = store_next_conflict(s, hole + 1, count);
    }
    store_set_vertices(s, count);
    return CUT;
}

// Decides every uncertain mark against plane `k` by the exact sign.
OUTLINE uint settle_marks(Store *s, uint k) {
    uint v = 0;
    while (v < store_vertices(s)) {
        if (store_mark(s, v) == MARK_UNCERTAIN) {
            const int sign = sign_of_conflict(s, v, k);
            if (sign == SIGN_UNKNOWN) {
                return UNCERTAIN;
            }
            uint mark = MARK_KEEP;
            if (sign < 0) {
                mark = MARK_CONFLICT;
            }
            store_set_mark(s, v, mark);
        }
        v += 1;
    }
    return COMPLETE;
}

INLINE void toggle_link(Store *s, uint f, uint change) {
    const uint link = store_link(s, f) ^ change;
    store_set_link(s, f, link);
}

OUTLINE void clear_links(Store *s) {
    uint f = 0;
    while (f < store_planes(s)) {
        store_set_link(s, f, 0);
        f += 1;
    }
}

// Finds a directed edge a→b of a marked vertex whose reverse belongs to no marked vertex.
OUTLINE void find_boundary_edge(Store *s, uint end, Triplet *edge) {
    uint v = store_next_conflict(s, 0, end);
    while (v < end) {
        const Triplet t = store_triplet(s, v);
        if (is_boundary_edge(s, end, t.a, t.b) != 0) {
            edge->a = t.a;
            edge->b = t.b;
            return;
        }
        if (is_boundary_edge(s, end, t.b, t.c) != 0) {
            edge->a = t.b;
            edge->b = t.c;
            return;
        }
        if (is_boundary_edge(s, end, t.c, t.a) != 0) {
            edge->a = t.c;
            edge->b = t.a;
            return;
        }
        v = store_next_conflict(s, v + 1, end);
    }
}

// Whether the edge a→b of a marked vertex lies on the boundary of the hole: both planes do, and no marked vertex has b→a.
INLINE uint is_boundary_edge(Store *s, uint end, uint a, uint b) {
    if ((store_link(s, a) == 0) || (store_link(s, b) == 0)) {
        return 0;
    }
    uint v = store_next_conflict(s, 0, end);
    while (v < end) {
        const Triplet t = store_triplet(s, v);
        if ((((t.a == b) && (t.b == a)) || ((t.b == b) && (t.c == a))) || ((t.c == b) && (t.a == a))) {
            return 0;
        }
        v = store_next_conflict(s, v + 1, end);
    }
    return 1;
}

// Drops the planes that no vertex lies on and renumbers the others in order.
OUTLINE void compact_planes(Store *s) {
    uint v = 0;
    while (v < store_vertices(s)) {
        const Triplet t = store_triplet(s, v);
        store_set_link(s, t.a, 1);
        store_set_link(s, t.b, 1);
        store_set_link(s, t.c, 1);
        v += 1;
    }
    // The link of a kept plane becomes its new number plus one.
    uint kept = 0;
    uint f = 0;
    while (f < store_planes(s)) {
        if (store_link(s, f) != 0) {
            if (kept != f) {
                store_move_plane(s, f, kept);
            }
            kept += 1;
            store_set_link(s, f, kept);
        }
        f += 1;
    }
    v = 0;
    while (v < store_vertices(s)) {
        const Triplet t = store_triplet(s, v);
        store_set_triplet(s, v, (Triplet){ .a = store_link(s, t.a) - 1, .b = store_link(s, t.b) - 1, .c = store_link(s, t.c) - 1 });
        v += 1;
    }
    clear_links(s);
    store_set_planes(s, kept);
}

// core/src/cell/quadrature.rs

// The integral of the store's function over the present polytope; `center` is the point that the tetrahedra share.
OUTLINE real integrate_function(Store *s, V3 center) {
    Wide sum = (Wide){ .hi = REAL(0.0), .lo = REAL(0.0) };
    uint v = 0;
    while (v < store_vertices(s)) {
        const Triplet t = store_triplet(s, v);
        add_fans_at_edge(s, v, t.a, t.b, center, &sum);
        add_fans_at_edge(s, v, t.b, t.c, center, &sum);
        add_fans_at_edge(s, v, t.c, t.a, center, &sum);
        v += 1;
    }
    // Of sixfold volumes.
    return (sum.hi + sum.lo) / REAL(6.0);
}

// Adds the tetrahedra over the triangles that the edge (f, g) of vertex `v` has in its two facets; each edge at its later vertex.
OUTLINE void add_fans_at_edge(Store *s, uint v, uint f, uint g, V3 center, Wide *sum) {
    const uint w = first_vertex_on(s, f, g, v);
    if (w == v) {
        return;
    }
    const V3 to = sub(store_position(s, v), center);
    const V3 from = sub(store_position(s, w), center);
    const V3 spoke = v3_cross(from, to);
    const uint top_f = first_vertex_on(s, f, f, w);
    if (top_f != w) {
        const V3 top = sub(store_position(s, top_f), center);
        add_quadrature(s, -v3_dot(top, spoke), top, from, to, center, sum);
    }
    const uint top_g = first_vertex_on(s, g, g, w);
    if (top_g != w) {
        const V3 top = sub(store_position(s, top_g), center);
        add_quadrature(s, v3_dot(top, spoke), top, from, to, center, sum);
    }
}

// The first vertex below `end` that lies on both planes; `end` if there is none.
OUTLINE uint first_vertex_on(Store *s, uint f, uint g, uint end) {
    uint v = 0;
    while (v < end) {
        const Triplet t = store_triplet(s, v);
        if ((((t.a == f) || (t.b == f)) || (t.c == f)) && (((t.a == g) || (t.b == g)) || (t.c == g))) {
            return v;
        }
        v += 1;
    }
    return end;
}

// Adds the integral over the tetrahedron (center, a, b, c) of sixfold signed volume `volume`.
OUTLINE void add_quadrature(Store *s, real volume, V3 a, V3 b, V3 c, V3 center, Wide *sum) {
    if (volume == REAL(0.0)) {
        return;
    }
    Wide mean = (Wide){ .hi = REAL(0.0), .lo = REAL(0.0) };
    uint q = 0;
    while (q < store_nodes(s)) {
        const Node node = store_node(s, q);
        const V3 way = add(add(scale(node.place.x, a), scale(node.place.y, b)), scale(node.place.z, c));
        add_compensated(node.weight * store_function(s, add(center, way)), &mean);
        q += 1;
    }
    add_compensated(volume * (mean.hi + mean.lo), sum);
}

// Adds `x`, and what rounding loses of it apart.
INLINE void add_compensated(real x, Wide *sum) {
    const Wide added = sum_exact(sum->hi, x);
    sum->hi = added.hi;
    sum->lo = sum->lo + added.lo;
}

// The store's polynomial at `x`, in the frame of the site: by Horner's scheme, in the order of `FramedIntegrand::coefficients`.
OUTLINE real polynomial(Store *s, V3 x) {
    const uint degree = store_degree(s);
    const V3 y = add(sub(store_site(s), store_origin(s)), x);
    real in_x = REAL(0.0);
    uint next = 0;
    uint i = 0;
    while (i <= degree) {
        real in_y = REAL(0.0);
        uint j = 0;
        while (j <= i) {
            real in_z = REAL(0.0);
            uint k = 0;
            while (k <= j) {
                in_z = (in_z * y.z) + store_coefficient(s, next);
                next += 1;
                k += 1;
            }
            in_y = (in_y * y.y) + in_z;
            j += 1;
        }
        in_x = (in_x * y.x) + in_y;
        i += 1;
    }
    return in_x;
}

// core/src/cell/integrate.rs

// Whether (1) a cell's volume exceeds what rounding alone can make of nothing.
//
// For a volume that is positive the bound of one of the pieces that it is made of decides: the bounds of all pieces together are far
// above what rounding does, and would swallow thin slabs that the sum over all cells misses. What is negative is believed only beyond
// that sum of bounds, which no rounding exceeds (16 times what it did in ten thousand cells of volume 0): few surfaces go around anything the
// wrong way, but those that fold over themselves do so in slabs as thin as that.
HOT uint volume_is_above_bound(CellSums sums) {
    if ((sums.volume > (SHARE_OF_NOTHING * smaller(sums.rounding, sums.largest_rounding))) || (sums.volume < -sums.rounding)) {
        return 1;
    }
    return 0;
}

// Adds `weight` times the integrals of the present polytope to `sums`, and to the facets' sums.
//
// `center` is the point that the tetrahedra share; any point will do, one in or near the polytope keeps the digits.
// For each vertex and each of its edges (f, g): `I` the foot of `center` on the edge's line, `H_f` on the plane;
// signed volumes `+det(H_g, I, v)/6` and `−det(H_f, I, v)/6`.
//
// `reach` is the distance to the farthest point that a plane was made from, where that is not a site beyond the plane.
HOT uint integrate(Store *s, real weight, V3 center, real reach, uint flags, CellSums *sums) {
    CellSums part = (CellSums){ 0 };
    uint v = 0;
    while (v < store_vertices(s)) {
        const Triplet t = store_triplet(s, v);
        const Corner at = (Corner){ .position = sub(store_position(s, v), center), .distance = norm_1(store_position(s, v)) + reach, .radius = store_radius(s, v) + ((ROUNDINGS_OF_SURFACE * UNIT_ROUNDOFF) * reach) };
        const Side a = side(s, t.a, center);
        const Side b = side(s, t.b, center);
        const Side c = side(s, t.c, center);
        if (add_edge(s, a, b, at, weight, center, flags, &part) != COMPLETE) {
            return UNCERTAIN;
        }
        if (add_edge(s, b, c, at, weight, center, flags, &part) != COMPLETE) {
            return UNCERTAIN;
        }
        if (add_edge(s, c, a, at, weight, center, flags, &part) != COMPLETE) {
            return UNCERTAIN;
        }
        v += 1;
    }
    // `part` holds sixfold volumes, and moments about `center` scaled alike: 24 of the first, 120 of the second.
    const real volume = (weight / REAL(6.0)) * part.volume;
    const V3 first = scale(weight / REAL(24.0), part.first);
    const V3 about = scale(volume, center);
    sums->volume = sums->volume + volume;
    sums->first = add(sums->first, add(first, about));
    sums->rounding = sums->rounding + (part.rounding / REAL(6.0));
    sums->largest_rounding = larger(sums->largest_rounding, part.rounding / REAL(6.0));
    if ((flags & SECOND_MOMENTS) != 0) {
        // ∫ (y + c)(y + c)ᵀ = ∫ yyᵀ + c mᵀ + m cᵀ + V ccᵀ, m = ∫ y.
        const V3 twice = add(add(first, first), about);
        const V3 diagonal = v3(center.x * twice.x, center.y * twice.y, center.z * twice.z);
        const V3 both = add(first, about);
        const V3 mixed = v3((center.x * both.y) + (first.x * center.y), (center.x * both.z) + (first.x * center.z), (center.y * both.z) + (first.y * center.z));
        sums->second_diagonal = add(sums->second_diagonal, add(scale(weight / REAL(120.0), part.second_diagonal), diagonal));
        sums->second_mixed = add(sums->second_mixed, add(scale(weight / REAL(120.0), part.second_mixed), mixed));
    }
    if ((flags & FACET_SECOND_MOMENTS) != 0) {
        if (add_facet_seconds(s, weight, center) != COMPLETE) {
            return UNCERTAIN;
        }
    }
    // A store without nodes says so when it is compiled: what is not asked for is not there.
    if (((flags & INTEGRAL) != 0) && (store_nodes(s) != 0)) {
        sums->integral = sums->integral + (weight * integrate_function(s, center));
    }
    return COMPLETE;
}

// Plane `f` as seen from `center`.
INLINE Side side(Store *s, uint f, V3 center) {
    const Plane plane = store_plane(s, f);
    const real square = v3_dot(plane.n, plane.n);
    const real d = plane.d + v3_dot(plane.n, center);
    return (Side){ .index = f, .n = plane.n, .d = d, .square = square, .foot = scale(-(d / square), plane.n) };
}

// Adds the two tetrahedra of one vertex and its edge (f, g).
INLINE uint add_edge(Store *s, Side f, Side g, Corner at, real weight, V3 center, uint flags, CellSums *part) {
    V3 foot = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real off = REAL(0.0);
    if (foot_on_edge(s, f, g, center, &foot, &off) != COMPLETE) {
        return UNCERTAIN;
    }
    // `I×v`, but the foot is at right angles to the edge: nothing cancels, however far away a small piece is.
    const V3 spoke = v3_cross(foot, sub(at.position, foot));
    add_tetrahedron(v3_dot(g.foot, spoke), g.foot, foot, at.position, flags, part);
    add_tetrahedron(-v3_dot(f.foot, spoke), f.foot, foot, at.position, flags, part);
    part->rounding = part->rounding + (((ROUNDINGS_ACROSS * UNIT_ROUNDOFF) * at.distance) * norm_1(spoke));
    if ((flags & FACETS) != 0) {
        FacetSum sum = store_facet(s, g.index);
        add_triangle(g, foot, off, at, -weight, center, &sum);
        store_set_facet(s, g.index, sum);
        sum = store_facet(s, f.index);
        add_triangle(f, foot, off, at, weight, center, &sum);
        store_set_facet(s, f.index, sum);
    }
    return COMPLETE;
}

// The foot of the perpendicular from the reference point to the line of planes f and g:
// `I = (−d_f n_g×x − d_g x×n_f) / |x|²`, `x = n_f×n_g`; and how far it may be off that line.
//
// `x` is off by 3u over the sine of the angle between the planes, and the foot by as much of its length, however far away the planes are:
// what two nearly parallel planes have in common cancels. Each step of refinement multiplies that by itself, until roundings are left.
INLINE uint foot_on_edge(Store *s, Side f, Side g, V3 center, V3 *foot, real *off) {
    const V3 direction = v3_cross(f.n, g.n);
    const real square = v3_dot(direction, direction);
    const real whole = f.square * g.square;
    if (!(square > (NEARLY_PARALLEL * whole))) {
        const uint status = store_exact_foot(s, f.index, g.index, center, foot);
        *off = UNIT_ROUNDOFF * norm_1(*foot);
        return status;
    }
    const V3 to_f = scale(-REAL(1.0) / square, v3_cross(g.n, direction));
    const V3 to_g = scale(-REAL(1.0) / square, v3_cross(direction, f.n));
    *foot = add(scale(f.d, to_f), scale(g.d, to_g));
    const real length = norm_1(*foot);
    if (!(square < (WORTH_REFINING_FOOT * whole))) {
        const real amplified = UNIT_ROUNDOFF * sqrt(whole / square);
        *off = amplified * ((ROUNDINGS_OF_FOOT * length) + (ROUNDINGS_OF_OFFSET * norm_1(center)));
        return COMPLETE;
    }
    *off = (ROUNDINGS_OF_FOOT * UNIT_ROUNDOFF) * length;
    uint steps = 1;
    if (square < (WORTH_REFINING_MORE * whole)) {
        steps = 3;
    }
    // Of the planes themselves: what their offsets have lost on the way to the reference point would count over the sine.
    const Plane plane_f = store_plane(s, f.index);
    const Plane plane_g = store_plane(s, g.index);
    while (steps > 0) {
        const real rest_f = residual_about(plane_f, center, *foot);
        const real rest_g = residual_about(plane_g, center, *foot);
        *foot = add(*foot, add(scale(rest_f, to_f), scale(rest_g, to_g)));
        steps -= 1;
    }
    return COMPLETE;
}

// Adds the tetrahedron (center, h, i, v) of sixfold signed volume `volume`: first moment `U(h+i+v)/4`, second
// `U(hhᵀ+iiᵀ+vvᵀ+ssᵀ)/20`, `s = h+i+v`.
INLINE void add_tetrahedron(real volume, V3 h, V3 i, V3 v, uint flags, CellSums *part) {
    const V3 sum = add(add(h, i), v);
    part->volume = part->volume + volume;
    part->rounding = part->rounding + ((ROUNDINGS * UNIT_ROUNDOFF) * fabs(volume));
    part->first = add(part->first, scale(volume, sum));
    if ((flags & SECOND_MOMENTS) != 0) {
        part->second_diagonal = add(part->second_diagonal, scale(volume, second_diagonal(h, i, v, sum)));
        part->second_mixed = add(part->second_mixed, scale(volume, second_mixed(h, i, v, sum)));
    }
}

// The diagonal of `hhᵀ + iiᵀ + vvᵀ + ssᵀ`.
INLINE V3 second_diagonal(V3 h, V3 i, V3 v, V3 s) {
    return v3(squares(h.x, i.x, v.x) + (s.x * s.x), squares(h.y, i.y, v.y) + (s.y * s.y), squares(h.z, i.z, v.z) + (s.z * s.z));
}

// The entries xy, xz, yz of `hhᵀ + iiᵀ + vvᵀ + ssᵀ`.
INLINE V3 second_mixed(V3 h, V3 i, V3 v, V3 s) {
    return v3(products(h.x, h.y, i.x, i.y, v.x, v.y) + (s.x * s.y), products(h.x, h.z, i.x, i.z, v.x, v.z) + (s.x * s.z), products(h.y, h.z, i.y, i.z, v.y, v.z) + (s.y * s.z));
}

INLINE real squares(real a, real b, real c) {
    return ((a * a) + (b * b)) + (c * c);
}

INLINE real products(real a, real b, real c, real d, real e, real f) {
    return ((a * b) + (c * d)) + (e * f);
}

// The point that the tetrahedra of the present polytope share: the site where it is inside, else the mean of the vertices.
OUTLINE V3 reference_point(Store *s) {
    uint inside = 1;
    uint f = 0;
    while (f < store_planes(s)) {
        if (store_plane(s, f).d < REAL(0.0)) {
            inside = 0;
        }
        f += 1;
    }
    V3 mean = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    if (inside != 0) {
        return mean;
    }
    uint v = 0;
    while (v < store_vertices(s)) {
        mean = add(mean, store_position(s, v));
        v += 1;
    }
    return scale(REAL(1.0) / ((real)store_vertices(s)), mean);
}

// core/src/cell/facet.rs

// Whether (1) a facet's area exceeds what rounding alone can make of nothing.
OUTLINE uint facet_is_above_bound(FacetSum sum) {
    if ((sum.area > (SHARE_OF_NO_FACET * sum.rounding)) || (sum.area < -(BOUNDS_OF_NEGATIVE * sum.rounding))) {
        return 1;
    }
    return 0;
}

// Adds the triangle (H, I, v) to a facet of plane `f`: signed area `sign·½ (I − H)×(v − H)·n/|n|`, moment
// `area·(H + I + v)/3`. The foot I is off its edge by up to `off`.
//
// What I and v are off counts with the way between them: the two triangles of a vertex lose its error times the way between their feet,
// those of an edge the foot's times the edge's length. The vertex has been rounded once more on its way to the reference point.
INLINE void add_triangle(Side f, V3 foot, real off, Corner at, real sign, V3 center, FacetSum *sum) {
    const V3 to_foot = sub(foot, f.foot);
    const V3 to_vertex = sub(at.position, f.foot);
    const real area = area_of_triangle(f, to_foot, to_vertex, sign);
    const V3 middle = add(scale(REAL(1.0) / REAL(3.0), add(add(f.foot, foot), at.position)), center);
    sum->area = sum->area + area;
    sum->moment = add(sum->moment, scale(area, middle));
    const real lost = (ROUNDINGS_OF_TRIANGLE * UNIT_ROUNDOFF) * (norm_1(to_foot) * norm_1(to_vertex));
    const real moved = (at.radius + off) + (UNIT_ROUNDOFF * norm_1(at.position));
    sum->rounding = larger(sum->rounding, lost + (moved * norm_1(sub(at.position, foot))));
}

// `sign·½ (I − H)×(v − H)·n/|n|`, given the two sides at H.
INLINE real area_of_triangle(Side f, V3 to_foot, V3 to_vertex, real sign) {
    const V3 normal = v3_cross(to_foot, to_vertex);
    return ((REAL(0.5) * sign) * v3_dot(normal, f.n)) / sqrt(f.square);
}

// The sums of the facet of plane `index` alone.
OUTLINE uint integrate_facet(Store *s, uint index, V3 center, FacetSum *sum) {
    *sum = (FacetSum){ 0 };
    const Side f = side(s, index, center);
    uint v = 0;
    while (v < store_vertices(s)) {
        Triplet t = store_triplet(s, v);
        if (t.b == index) {
            t = (Triplet){ .a = t.b, .b = t.c, .c = t.a };
        } else if (t.c == index) {
            t = (Triplet){ .a = t.c, .b = t.a, .c = t.b };
        }
        if (t.a == index) {
            // Vertex (f, b, c): of its edges (f, b) begins here and (c, f) ends here.
            const Corner at = (Corner){ .position = sub(store_position(s, v), center), .distance = norm_1(store_position(s, v)), .radius = store_radius(s, v) };
            const Side b = side(s, t.b, center);
            const Side c = side(s, t.c, center);
            V3 foot = v3(REAL(0.0), REAL(0.0), REAL(0.0));
            real off = REAL(0.0);
            if (foot_on_edge(s, f, b, center, &foot, &off) != COMPLETE) {
                return UNCERTAIN;
            }
            add_triangle(f, foot, off, at, REAL(1.0), center, sum);
            if (foot_on_edge(s, c, f, center, &foot, &off) != COMPLETE) {
                return UNCERTAIN;
            }
            add_triangle(f, foot, off, at, -REAL(1.0), center, sum);
        }
        v += 1;
    }
    return COMPLETE;
}

// Sets the facets' sums to zero.
OUTLINE void reset_facets(Store *s, uint flags) {
    uint f = 0;
    while (f < store_planes(s)) {
        store_set_facet(s, f, (FacetSum){ 0 });
        if ((flags & FACET_SECOND_MOMENTS) != 0) {
            store_set_facet_second(s, f, (FacetSecond){ 0 });
        }
        f += 1;
    }
}

// Adds a facet of the half-space `plane`, which bounds the domain, to the boundary's sums; `outward` is +1 where the half-space
// keeps the domain's inside, −1 where it keeps its outside.
OUTLINE void add_boundary(FacetSum sum, Plane plane, real outward, CellSums *sums) {
    // The surface has no negative area.
    if ((facet_is_above_bound(sum) == 0) || (sum.area < REAL(0.0))) {
        return;
    }
    const real share = (outward * sum.area) / sqrt(v3_dot(plane.n, plane.n));
    sums->boundary_area = sums->boundary_area + sum.area;
    sums->boundary_moment = add(sums->boundary_moment, sum.moment);
    sums->boundary_vector = sub(sums->boundary_vector, scale(share, plane.n));
    sums->boundary_flux = sums->boundary_flux + (share * plane.d);
}

// Adds the triangles that `integrate` adds to the facets to their second moments. By itself: few ask for it, and what all do is not to pay
// for that.
OUTLINE uint add_facet_seconds(Store *s, real weight, V3 center) {
    uint v = 0;
    while (v < store_vertices(s)) {
        const Triplet t = store_triplet(s, v);
        const V3 position = sub(store_position(s, v), center);
        const Side a = side(s, t.a, center);
        const Side b = side(s, t.b, center);
        const Side c = side(s, t.c, center);
        if (add_edge_second(s, a, b, position, weight, center) != COMPLETE) {
            return UNCERTAIN;
        }
        if (add_edge_second(s, b, c, position, weight, center) != COMPLETE) {
            return UNCERTAIN;
        }
        if (add_edge_second(s, c, a, position, weight, center) != COMPLETE) {
            return UNCERTAIN;
        }
        v += 1;
    }
    return COMPLETE;
}

// Adds the two triangles of one vertex and its edge (f, g).
OUTLINE uint add_edge_second(Store *s, Side f, Side g, V3 position, real weight, V3 center) {
    V3 foot = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real off = REAL(0.0);
    if (foot_on_edge(s, f, g, center, &foot, &off) != COMPLETE) {
        return UNCERTAIN;
    }
    add_triangle_second(s, g, foot, position, -weight);
    add_triangle_second(s, f, foot, position, weight);
    return COMPLETE;
}

// Adds the triangle (H, I, v) to the second moments of the facet of plane `f`: `area·(HHᵀ + IIᵀ + vvᵀ + ssᵀ)/12`, `s = H + I + v`,
// about the point that all are relative to.
OUTLINE void add_triangle_second(Store *s, Side f, V3 foot, V3 position, real sign) {
    const real share = area_of_triangle(f, sub(foot, f.foot), sub(position, f.foot), sign) / REAL(12.0);
    const V3 sum = add(add(f.foot, foot), position);
    FacetSecond second = store_facet_second(s, f.index);
    second.diagonal = add(second.diagonal, scale(share, second_diagonal(f.foot, foot, position, sum)));
    second.mixed = add(second.mixed, scale(share, second_mixed(f.foot, foot, position, sum)));
    store_set_facet_second(s, f.index, second);
}

// Moves the facets' second moments from `center` to the facets' own barycenters: `∫ (x − b)(x − b)ᵀ = ∫ xxᵀ − mmᵀ/A`, `m = ∫ x`.
OUTLINE void center_facets(Store *s, V3 center) {
    uint f = 0;
    while (f < store_planes(s)) {
        const FacetSum sum = store_facet(s, f);
        if (facet_is_above_bound(sum) != 0) {
            const V3 m = sub(sum.moment, scale(sum.area, center));
            const V3 b = scale(REAL(1.0) / sum.area, m);
            FacetSecond second = store_facet_second(s, f);
            second.diagonal = sub(second.diagonal, v3(m.x * b.x, m.y * b.y, m.z * b.z));
            second.mixed = sub(second.mixed, v3(m.x * b.y, m.x * b.z, m.y * b.z));
            store_set_facet_second(s, f, second);
        }
        f += 1;
    }
}

// core/src/cell/cone.rs

// Subtracts the signed integrals of the cell's intersection with the truncated cone over triangle `t` from corner `apex`.
OUTLINE uint add_cone(Store *s, uint t, Voxel apex, V3 center, uint flags, uint *touched, CellSums *sums) {
    TruncatedCone cone = no_cone();
    if (make_cone(s, t, apex, &cone) != COMPLETE) {
        return UNCERTAIN;
    }
    if (cone.sign == REAL(0.0)) {
        // The cone is flat, but the surface may still divide the cell.
        *touched = 1;
        return COMPLETE;
    }
    // Cull before cutting: most candidates have the whole cell on the wrong side of one of the four planes.
    const uint base = store_planes(s);
    if ((((all_in_conflict(s, base, cone.end) != 0) || (all_in_conflict(s, base, cone.side_0) != 0)) || (all_in_conflict(s, base, cone.side_1) != 0)) || (all_in_conflict(s, base, cone.side_2) != 0)) {
        return COMPLETE;
    }
    uint status = clip_by_sides(s, cone);
    if (status == COMPLETE) {
        status = clip(s, cone.end, TAG_TRIANGLE);
        if (status == CUT) {
            *touched = 1;
        }
        if ((status == CUT) || (status == UNTOUCHED)) {
            status = integrate(s, -cone.sign, center, cone.reach, flags, sums);
        }
    }
    store_restore(s);
    store_set_planes(s, base);
    if (status == EMPTY) {
        return COMPLETE;
    }
    return status;
}

// Clips by the three sides; `COMPLETE` where something is left.
OUTLINE uint clip_by_sides(Store *s, TruncatedCone cone) {
    uint status = clip(s, cone.side_0, TAG_CONE);
    if ((status == CUT) || (status == UNTOUCHED)) {
        status = clip(s, cone.side_1, TAG_CONE);
    }
    if ((status == CUT) || (status == UNTOUCHED)) {
        status = clip(s, cone.side_2, TAG_CONE);
    }
    if ((status == CUT) || (status == UNTOUCHED)) {
        return COMPLETE;
    }
    return status;
}

// Adds the part of triangle `t` within the cell to the boundary's sums: the facet on the triangle's plane of the cell's intersection
// with the prism behind it. (The cone would do, but its sides can be nearly parallel to the triangle.)
OUTLINE uint add_surface(Store *s, uint t, Voxel apex, V3 center, CellSums *sums) {
    TruncatedCone prism = no_cone();
    if (make_prism(s, t, apex, &prism) != COMPLETE) {
        return UNCERTAIN;
    }
    const uint base = store_planes(s);
    store_set_plane(s, base, prism.end);
    const uint seen = store_mark_conflicts(s, base);
    if ((seen == SEEN_CONFLICT) || (seen == SEEN_KEEP)) {
        return COMPLETE;
    }
    if (((all_in_conflict(s, base, prism.side_0) != 0) || (all_in_conflict(s, base, prism.side_1) != 0)) || (all_in_conflict(s, base, prism.side_2) != 0)) {
        return COMPLETE;
    }
    uint status = clip_by_sides(s, prism);
    const uint end_index = store_planes(s);
    if (status == COMPLETE) {
        status = clip(s, prism.end, TAG_TRIANGLE);
    }
    if (status == CUT) {
        FacetSum facet = (FacetSum){ 0 };
        status = integrate_facet(s, end_index, center, &facet);
        if (status == COMPLETE) {
            add_boundary(facet, prism.end, -prism.sign, sums);
        }
    }
    store_restore(s);
    store_set_planes(s, base);
    if ((status == EMPTY) || (status == UNTOUCHED)) {
        return COMPLETE;
    }
    return status;
}

// Whether (1) every vertex is certainly in conflict with `plane`; uses the slot of plane `k`.
INLINE uint all_in_conflict(Store *s, uint k, Plane plane) {
    store_set_plane(s, k, plane);
    if (store_mark_conflicts(s, k) == SEEN_CONFLICT) {
        return 1;
    }
    return 0;
}

// The truncated cone over triangle `t` from corner `apex`, in the frame of the site.
OUTLINE uint make_cone(Store *s, uint t, Voxel apex, TruncatedCone *cone) {
    const Triangle triangle = store_triangle(s, t);
    const V3 a = store_domain_point(s, triangle.a);
    const V3 b = store_domain_point(s, triangle.b);
    const V3 c = store_domain_point(s, triangle.c);
    const V3 o = store_corner(s, apex);
    const int sign = cone_sign(s, t, apex, sub(a, o), sub(b, o), sub(c, o));
    if (sign == SIGN_UNKNOWN) {
        return UNCERTAIN;
    }
    cone->sign = (real)sign;
    if (sign == 0) {
        return COMPLETE;
    }
    const V3 site = store_site(s);
    const V3 o_in = sub(o, site);
    const V3 a_in = sub(a, site);
    const V3 b_in = sub(b, site);
    const V3 c_in = sub(c, site);
    cone->reach = larger(larger(norm_1(a_in), norm_1(b_in)), larger(norm_1(c_in), norm_1(o_in)));
    cone->end = triangle_plane(a_in, b_in, c_in, cone->sign);
    cone->side_0 = side_over_edge(triangle.a, triangle.b, a, b, o, o_in, cone->sign);
    cone->side_1 = side_over_edge(triangle.b, triangle.c, b, c, o, o_in, cone->sign);
    cone->side_2 = side_over_edge(triangle.c, triangle.a, c, a, o, o_in, cone->sign);
    return COMPLETE;
}

// No cone yet.
OUTLINE TruncatedCone no_cone() {
    return (TruncatedCone){ .sign = REAL(0.0), .reach = REAL(0.0), .end = (Plane){ 0 }, .side_0 = (Plane){ 0 }, .side_1 = (Plane){ 0 }, .side_2 = (Plane){ 0 } };
}

// The prism over triangle `t`, in the frame of the site, on the side that the cone from `apex` keeps: where the surface touches
// the cell, both then decide alike.
OUTLINE uint make_prism(Store *s, uint t, Voxel apex, TruncatedCone *prism) {
    const Triangle triangle = store_triangle(s, t);
    const V3 a = store_domain_point(s, triangle.a);
    const V3 b = store_domain_point(s, triangle.b);
    const V3 c = store_domain_point(s, triangle.c);
    const V3 o = store_corner(s, apex);
    const int sign = cone_sign(s, t, apex, sub(a, o), sub(b, o), sub(c, o));
    if (sign == SIGN_UNKNOWN) {
        return UNCERTAIN;
    }
    prism->sign = REAL(1.0);
    if (sign < 0) {
        prism->sign = -REAL(1.0);
    }
    const V3 site = store_site(s);
    const V3 a_in = sub(a, site);
    const V3 b_in = sub(b, site);
    const V3 c_in = sub(c, site);
    prism->end = triangle_plane(a_in, b_in, c_in, prism->sign);
    const V3 n = scale(prism->sign, prism->end.n);
    prism->side_0 = wall_over_edge(n, a_in, b_in);
    prism->side_1 = wall_over_edge(n, b_in, c_in);
    prism->side_2 = wall_over_edge(n, c_in, a_in);
    return COMPLETE;
}

// The side over the edge from vertex `i` at `p` to vertex `j` at `q`, computed with the ends in index order so that both
// triangles at the edge get the very same plane.
INLINE Plane side_over_edge(uint i, uint j, V3 p, V3 q, V3 o, V3 o_in, real sign) {
    if (i < j) {
        return cone_side(o_in, sub(p, o), sub(q, p), sign);
    }
    return cone_side(o_in, sub(q, o), sub(p, q), -sign);
}

// The exact sign of `det(a − o, b − o, c − o)`, given the rounded differences.
OUTLINE int cone_sign(Store *s, uint t, Voxel apex, V3 a, V3 b, V3 c) {
    const int sign = filtered_sign(a, b, c);
    if (sign == SIGN_UNKNOWN) {
        return store_exact_cone_sign(s, t, apex);
    }
    return sign;
}

// The sign of the determinant of three differences of points, given rounded; never 0, but `SIGN_UNKNOWN` where floating point cannot tell.
HOT int filtered_sign(V3 a, V3 b, V3 c) {
    const real det = v3_dot(a, v3_cross(b, c));
    const V3 abs_b = magnitudes(b);
    const V3 abs_c = magnitudes(c);
    const real permanent = v3_dot(magnitudes(a), v3((abs_b.y * abs_c.z) + (abs_b.z * abs_c.y), (abs_b.z * abs_c.x) + (abs_b.x * abs_c.z), (abs_b.x * abs_c.y) + (abs_b.y * abs_c.x)));
    const real bound = CONE_SIGN_ERROR * permanent;
    if (det > bound) {
        return 1;
    }
    if (det < -bound) {
        return -1;
    }
    return SIGN_UNKNOWN;
}

INLINE V3 magnitudes(V3 a) {
    return v3(fabs(a.x), fabs(a.y), fabs(a.z));
}

// core/src/cell/near.rs

// Whether (1) no triangle in the voxels from `lo` to `hi` meets the cell, whose box is `[low, high]` in the frame of its site. Then
// `winding`, which is that of the corner of `lo`, becomes that of the cell. 0 where one does, or may.
OUTLINE uint surface_passes_by(Store *s, V3 low, V3 high, Voxel lo, Voxel hi, int *winding) {
    if (site_is_inside(s) == 0) {
        return 0;
    }
    uint k = lo.k;
    while (k <= hi.k) {
        uint j = lo.j;
        while (j <= hi.j) {
            uint i = lo.i;
            while (i <= hi.i) {
                if (voxel_passes_by(s, (Voxel){ .i = i, .j = j, .k = k }, lo, low, high, winding) == 0) {
                    return 0;
                }
                i += 1;
            }
            j += 1;
        }
        k += 1;
    }
    return 1;
}

// Whether (1) the site is strictly inside its cell, so that the cell's winding number is the site's.
OUTLINE uint site_is_inside(Store *s) {
    uint f = 0;
    while (f < store_planes(s)) {
        const real d = store_plane(s, f).d;
        if (!(d > REAL(0.0))) {
            return 0;
        }
        f += 1;
    }
    return 1;
}

// The same for the triangles of one voxel, of which `lo` is the lowest; takes from `winding` what they add between the corner of
// `lo` and the site.
HOT uint voxel_passes_by(Store *s, Voxel voxel, Voxel lo, V3 low, V3 high, int *winding) {
    const uint end = store_list_end(s, voxel);
    uint entry = store_list_begin(s, voxel);
    while (entry < end) {
        const uint t = store_list_entry(s, entry);
        if (is_first_voxel(store_lowest_voxel(s, t), lo, voxel) != 0) {
            if (triangle_passes_by(s, t, lo, low, high, winding) == 0) {
                return 0;
            }
        }
        entry += 1;
    }
    return 1;
}

// Whether (1) triangle `t` certainly does not meet the cell; takes from `winding` its sign as seen from the corner of `apex`, where
// it stands between that and the site.
//
// Every sign is certain about the true points: floating point with a bound, and 0 where that does not suffice.
HOT uint triangle_passes_by(Store *s, uint t, Voxel apex, V3 low, V3 high, int *winding) {
    const Triangle triangle = store_triangle(s, t);
    const V3 a = store_domain_point(s, triangle.a);
    const V3 b = store_domain_point(s, triangle.b);
    const V3 c = store_domain_point(s, triangle.c);
    const V3 site = store_site(s);
    const V3 a_in = sub(a, site);
    const V3 b_in = sub(b, site);
    const V3 c_in = sub(c, site);
    const V3 least = least_of(a_in, b_in, c_in);
    const V3 most = most_of(a_in, b_in, c_in);
    if (are_apart(least, most, low, high) == 0) {
        if (plane_is_apart(s, a_in, sub(b, a), sub(c, a)) == 0) {
            return 0;
        }
    }
    // Does it cross the segment from the corner, the lowest point of the cell's voxels, to the site?
    const V3 o = store_corner(s, apex);
    const V3 x = sub(site, o);
    const V3 o_in = sub(o, site);
    if (are_apart(least, most, o_in, (V3){ .x = REAL(0.0), .y = REAL(0.0), .z = REAL(0.0) }) != 0) {
        return 1;
    }
    const V3 p = sub(a, o);
    const V3 q = sub(b, o);
    const V3 r = sub(c, o);
    const int of_corner = filtered_sign(p, q, r);
    const int of_site = filtered_sign(a_in, b_in, c_in);
    if ((of_corner == SIGN_UNKNOWN) || (of_site == SIGN_UNKNOWN)) {
        return 0;
    }
    if (of_corner == of_site) {
        return 1;
    }
    const int over_0 = filtered_sign(p, q, x);
    const int over_1 = filtered_sign(q, r, x);
    const int over_2 = filtered_sign(r, p, x);
    if (((over_0 == SIGN_UNKNOWN) || (over_1 == SIGN_UNKNOWN)) || (over_2 == SIGN_UNKNOWN)) {
        return 0;
    }
    if (((over_0 == of_corner) && (over_1 == of_corner)) && (over_2 == of_corner)) {
        *winding -= of_corner;
    }
    return 1;
}

// Whether (1) the boxes `[a, b]` and `[c, d]` are apart. (The rounded differences that their corners are tell it as the exact ones
// do: rounding keeps the order.)
INLINE uint are_apart(V3 a, V3 b, V3 c, V3 d) {
    if (((b.x < c.x) || (b.y < c.y)) || (b.z < c.z)) {
        return 1;
    }
    if (((a.x > d.x) || (a.y > d.y)) || (a.z > d.z)) {
        return 1;
    }
    return 0;
}

// Whether (1) all vertices are certainly on one side of the plane through `a_in` along `e` and `f`.
HOT uint plane_is_apart(Store *s, V3 a_in, V3 e, V3 f) {
    const V3 n = v3_cross(e, f);
    const real of_normal = norm_1(e) * norm_1(f);
    const real length = norm_1(n) + (FEW_ROUNDINGS * of_normal);
    const real reach = norm_1(a_in);
    uint above = 0;
    uint below = 0;
    uint v = 0;
    while (v < store_vertices(s)) {
        const V3 way = sub(store_position(s, v), a_in);
        const real height = v3_dot(n, way);
        const real way_length = norm_1(way);
        const real bound = (length * (store_radius(s, v) + (FEW_ROUNDINGS * (reach + way_length)))) + ((FEW_ROUNDINGS * of_normal) * way_length);
        if (height > bound) {
            above = 1;
        } else if (height < -bound) {
            below = 1;
        } else {
            return 0;
        }
        if ((above != 0) && (below != 0)) {
            return 0;
        }
        v += 1;
    }
    return 1;
}

INLINE V3 least_of(V3 a, V3 b, V3 c) {
    return (V3){ .x = smaller(smaller(a.x, b.x), c.x), .y = smaller(smaller(a.y, b.y), c.y), .z = smaller(smaller(a.z, b.z), c.z) };
}

INLINE V3 most_of(V3 a, V3 b, V3 c) {
    return (V3){ .x = larger(larger(a.x, b.x), c.x), .y = larger(larger(a.y, b.y), c.y), .z = larger(larger(a.z, b.z), c.z) };
}

// A triangle stands in every voxel of its bounding box; it is taken only in the lowest one that the cell's box shares.
INLINE uint is_first_voxel(Voxel lowest, Voxel lo, Voxel voxel) {
    uint i = lowest.i;
    uint j = lowest.j;
    uint k = lowest.k;
    if (lo.i > i) {
        i = lo.i;
    }
    if (lo.j > j) {
        j = lo.j;
    }
    if (lo.k > k) {
        k = lo.k;
    }
    if (((i == voxel.i) && (j == voxel.j)) && (k == voxel.k)) {
        return 1;
    }
    return 0;
}

// core/src/cell/restrict.rs

// The integrals of the finished cell over the container: the domain where there is one, weighted by its winding number,
// else the initial box. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again; with `interior_only`, `BOUNDARY`
// where the cell's voxels hold triangles.
//
// With the flag `FACETS` the facets' sums of the half-spaces are those of the restricted cell afterwards, with
// `FACET_SECOND_MOMENTS` their second moments too.
OUTLINE uint integrate_cell(Store *s, uint flags, uint interior_only, CellSums *sums) {
    *sums = (CellSums){ 0 };
    compact_planes(s);
    const V3 center = reference_point(s);
    const uint status = integrate_restricted(s, center, flags, interior_only, sums);
    if ((status == COMPLETE) && ((flags & FACET_SECOND_MOMENTS) != 0)) {
        center_facets(s, center);
    }
    return status;
}

// The same about a given point.
OUTLINE uint integrate_restricted(Store *s, V3 center, uint flags, uint interior_only, CellSums *sums) {
    if (store_has_domain(s) == 0) {
        const uint status = integrate_whole(s, REAL(1.0), center, flags, sums);
        if ((status == COMPLETE) && ((flags & FACETS) != 0)) {
            add_box_faces(s, sums);
        }
        return status;
    }
    Voxel lo = (Voxel){ .i = 0, .j = 0, .k = 0 };
    Voxel hi = (Voxel){ .i = 0, .j = 0, .k = 0 };
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    outer_box_of_cell(s, &low, &high);
    voxels_of_box(s, low, high, &lo, &hi);
    const int winding = store_winding(s, lo);
    // Where no triangle is near or meets the cell, the winding number is the same all over it.
    if (store_surface_voxels(s, lo, hi) == 0) {
        return integrate_whole(s, (real)winding, center, flags, sums);
    }
    int inner = winding;
    if (surface_passes_by(s, low, high, lo, hi, &inner) != 0) {
        return integrate_whole(s, (real)inner, center, flags, sums);
    }
    if (interior_only != 0) {
        return BOUNDARY;
    }
    // Room for the four planes of a cone, whose indices must not move.
    if ((store_cap_p(s) - store_planes(s)) < 4) {
        return P_FULL;
    }
    if ((flags & FACETS) != 0) {
        reset_facets(s, flags);
    }
    if (winding != 0) {
        const uint status = integrate(s, (real)winding, center, REAL(0.0), flags, sums);
        if (status != COMPLETE) {
            return status;
        }
    }
    uint touched = 0;
    const uint cones = add_cones(s, lo, hi, center, flags, &touched, sums);
    if (cones != COMPLETE) {
        return cones;
    }
    if (touched == 0) {
        // No piece ends at its triangle: the surface does not meet the cell, and the winding number within is the nearest
        // integer to the quotient.
        CellSums whole = (CellSums){ 0 };
        const uint status = integrate(s, REAL(1.0), center, REAL(0.0), VOLUME_ONLY, &whole);
        if (status != COMPLETE) {
            return status;
        }
        if (volume_is_above_bound(whole) == 0) {
            return EMPTY;
        }
        if (is_undivided(*sums, whole, &inner) != 0) {
            *sums = (CellSums){ 0 };
            return integrate_whole(s, (real)inner, center, flags, sums);
        }
    }
    return settle(s, sums);
}

// Whether (1) the winding number is the same all over a cell that no triangle touches: the nearest integer to the quotient of `sums` and the
// integrals of the whole cell. A cone so thin that rounding loses it does not tell that its triangle divides the cell; the sum does. Where rounding
// can make as much of nothing as the whole cell is, no more is believed than 0 and 1 (it was −1,147,767 for a hair of 1e-15 across).
HOT uint is_undivided(CellSums sums, CellSums whole, int *winding) {
    const real quotient = sums.volume / whole.volume;
    const real noise = SHARE_OF_NOTHING * smaller(sums.rounding, sums.largest_rounding);
    if (!(fabs(quotient) < MOST_WINDINGS)) {
        return 0;
    }
    const bool is_usual = (quotient > -REAL(0.5)) && (quotient < REAL(1.5));
    if (!(noise < whole.volume) && !is_usual) {
        return 0;
    }
    int inner = (int)(fabs(quotient) + REAL(0.5));
    if (quotient < REAL(0.0)) {
        inner = -inner;
    }
    *winding = inner;
    const real off = fabs(sums.volume - (((real)inner) * whole.volume));
    if (off <= (sums.rounding + whole.rounding)) {
        return 1;
    }
    return 0;
}

// `COMPLETE` where something is left of the cell, else `EMPTY`.
//
// A volume that rounding may have made is believed only where its barycenter is near the cell: what rounding makes has it anywhere.
HOT uint settle(Store *s, CellSums *sums) {
    if (volume_is_above_bound(*sums) == 0) {
        return EMPTY;
    }
    if (fabs(sums->volume) > sums->rounding) {
        return COMPLETE;
    }
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    const real radius = box_of_cell(s, &low, &high);
    const real extent = norm_max(sub(high, low)) + radius;
    const V3 middle = scale(REAL(0.5), add(low, high));
    const V3 barycenter = scale(REAL(1.0) / sums->volume, sums->first);
    if (norm_max(sub(barycenter, middle)) > extent) {
        return EMPTY;
    }
    return COMPLETE;
}

// Whether (1) the present cell, and so all that clipping can leave of it, lies where the domain's winding number is 0.
OUTLINE uint lies_outside(Store *s) {
    if (store_has_domain(s) == 0) {
        return 0;
    }
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    outer_box_of_cell(s, &low, &high);
    return box_is_outside(s, low, high);
}

// The integrals of the whole cell, times `weight`.
OUTLINE uint integrate_whole(Store *s, real weight, V3 center, uint flags, CellSums *sums) {
    if (weight == REAL(0.0)) {
        return EMPTY;
    }
    if ((flags & FACETS) != 0) {
        reset_facets(s, flags);
    }
    const uint status = integrate(s, weight, center, REAL(0.0), flags, sums);
    if (status != COMPLETE) {
        return status;
    }
    return settle(s, sums);
}

// The faces of the initial box are the boundary where there is no domain.
OUTLINE void add_box_faces(Store *s, CellSums *sums) {
    uint f = 0;
    while (f < store_planes(s)) {
        if (store_tag(s, f) == TAG_BOX) {
            add_boundary(store_facet(s, f), store_plane(s, f), REAL(1.0), sums);
        }
        f += 1;
    }
}

// The bounding box of the vertices; returns their largest error radius.
HOT real box_of_cell(Store *s, V3 *low, V3 *high) {
    *low = store_position(s, 0);
    *high = *low;
    real radius = store_radius(s, 0);
    uint v = 1;
    while (v < store_vertices(s)) {
        const V3 p = store_position(s, v);
        *low = v3(smaller(low->x, p.x), smaller(low->y, p.y), smaller(low->z, p.z));
        *high = v3(larger(high->x, p.x), larger(high->y, p.y), larger(high->z, p.z));
        radius = larger(radius, store_radius(s, v));
        v += 1;
    }
    return radius;
}

// The bounding box of the cell, rounded outward.
HOT void outer_box_of_cell(Store *s, V3 *low, V3 *high) {
    const real radius = box_of_cell(s, low, high);
    // The vertices' error, and the rounding of moving them into the diagram's frame.
    const real margin = radius + ((REAL(4.0) * UNIT_ROUNDOFF) * (norm_max(store_site(s)) + larger(norm_max(*low), norm_max(*high))));
    const V3 outward = v3(margin, margin, margin);
    *low = sub(*low, outward);
    *high = add(*high, outward);
}

// The voxels that a box in the frame of the site meets.
HOT void voxels_of_box(Store *s, V3 low, V3 high, Voxel *lo, Voxel *hi) {
    *lo = store_voxel_of(s, add(store_site(s), low));
    *hi = store_voxel_of(s, add(store_site(s), high));
}

// Subtracts the signed integrals of the cell's intersection with the truncated cone of every triangle near it; `touched` becomes 1
// where a piece ends at its triangle.
OUTLINE uint add_cones(Store *s, Voxel lo, Voxel hi, V3 center, uint flags, uint *touched, CellSums *sums) {
    store_save(s);
    uint k = lo.k;
    while (k <= hi.k) {
        uint j = lo.j;
        while (j <= hi.j) {
            uint i = lo.i;
            while (i <= hi.i) {
                const Voxel voxel = (Voxel){ .i = i, .j = j, .k = k };
                const uint end = store_list_end(s, voxel);
                uint entry = store_list_begin(s, voxel);
                while (entry < end) {
                    const uint t = store_list_entry(s, entry);
                    if (is_first_voxel(store_lowest_voxel(s, t), lo, voxel) != 0) {
                        const uint status = add_cone(s, t, lo, center, flags, touched, sums);
                        if (status != COMPLETE) {
                            return status;
                        }
                        if ((flags & FACETS) != 0) {
                            const uint surface = add_surface(s, t, lo, center, sums);
                            if (surface != COMPLETE) {
                                return surface;
                            }
                        }
                    }
                    entry += 1;
                }
                i += 1;
            }
            j += 1;
        }
        k += 1;
    }
    return COMPLETE;
}

// core/src/cell/cap.rs

// Cuts off, cap by cap, what lies outside the domain, until no vertex is farther from the site than `radius`, or what is cannot be cut
// off: `CUT` where something was, `UNTOUCHED` where nothing was, or how the cell ended.
OUTLINE uint cap_outside(Store *s, real radius) {
    if ((store_has_domain(s) == 0) || !(radius > REAL(0.0))) {
        return UNTOUCHED;
    }
    uint end = UNTOUCHED;
    uint caps = 0;
    while (caps < MOST_CAPS) {
        const V3 far = farthest_position(s);
        const real length = sqrt(v3_dot(far, far));
        if (length <= radius) {
            return end;
        }
        real distance = larger(FIRST_DISTANCE * radius, LEAST_SHARE * length);
        uint status = UNTOUCHED;
        while ((status == UNTOUCHED) && ((WORTH_A_CAP * distance) < length)) {
            if (part_is_outside(s, far, distance * length) != 0) {
                status = clip(s, (Plane){ .n = scale(-REAL(1.0), far), .d = distance * length }, TAG_CAP);
            }
            distance = next_distance(distance, radius);
        }
        if (status == UNTOUCHED) {
            return end;
        }
        if (status != CUT) {
            return status;
        }
        end = CUT;
        caps += 1;
    }
    return end;
}

// The distance that is tried next: in small steps up to the radius, then in large ones.
HOT real next_distance(real distance, real radius) {
    if (distance < radius) {
        return REAL(1.2) * distance;
    }
    return REAL(1.75) * distance;
}

// The position of the vertex that is farthest from the site.
OUTLINE V3 farthest_position(Store *s) {
    V3 far = store_position(s, 0);
    uint v = 1;
    while (v < store_vertices(s)) {
        const V3 p = store_position(s, v);
        if (v3_dot(p, p) > v3_dot(far, far)) {
            far = p;
        }
        v += 1;
    }
    return far;
}

// Whether (1) what of the cell has `direction·x ≥ height` certainly lies where the domain's winding number is 0: its bounding box, or each
// part of it that has something of the cell.
OUTLINE uint part_is_outside(Store *s, V3 direction, real height) {
    V3 low = direction;
    V3 high = direction;
    real radius = REAL(0.0);
    uint v = 0;
    while (v < store_vertices(s)) {
        add_to_part(s, v, direction, height, &low, &high);
        radius = larger(radius, store_radius(s, v));
        v += 1;
    }
    if (widen_part(s, direction, height, radius, &low, &high) == 0) {
        return 0;
    }
    return boxes_are_outside(s, direction, height, low, high, 0, 1);
}

// Widens `[low, high]`, if vertex `v` has `direction·x ≥ height`, by that vertex, and by where the ways to it from all vertices that have not
// come to have: what of the cell has lies between such. (All by less than `height`, by a margin.)
HOT void add_to_part(Store *s, uint v, V3 direction, real height, V3 *low, V3 *high) {
    const real below = height - (CAP_MARGIN * height);
    const V3 p = store_position(s, v);
    const real p_height = v3_dot(direction, p);
    if (p_height < below) {
        return;
    }
    *low = v3(smaller(low->x, p.x), smaller(low->y, p.y), smaller(low->z, p.z));
    *high = v3(larger(high->x, p.x), larger(high->y, p.y), larger(high->z, p.z));
    uint u = 0;
    while (u < store_vertices(s)) {
        const V3 q = store_position(s, u);
        const real q_height = v3_dot(direction, q);
        if (q_height < below) {
            const V3 between = add(q, scale((below - q_height) / (p_height - q_height), sub(p, q)));
            *low = v3(smaller(low->x, between.x), smaller(low->y, between.y), smaller(low->z, between.z));
            *high = v3(larger(high->x, between.x), larger(high->y, between.y), larger(high->z, between.z));
        }
        u += 1;
    }
}

// Widens `[low, high]` by all roundings, `radius` the vertices' largest error; 0 where they are too large to tell. No vertex is farther than
// `direction`.
OUTLINE uint widen_part(Store *s, V3 direction, real height, real radius, V3 *low, V3 *high) {
    // The vertices' error, the roundings of heights and places, and of moving them into the diagram's frame.
    const real rounding = radius + ((REAL(16.0) * UNIT_ROUNDOFF) * (norm_max(store_site(s)) + norm_1(direction)));
    if (!((norm_1(direction) * rounding) < (REAL(0.25) * (CAP_MARGIN * height)))) {
        return 0;
    }
    const V3 outward = v3(rounding, rounding, rounding);
    *low = sub(*low, outward);
    *high = add(*high, outward);
    return 1;
}

// Whether (1) all of the cell in the box `[low, high]` with `direction·x ≥ height` is outside: its whole box, or where that has something of
// the domain, each of `ALL_PARTS` parts of it that the cell has something of, of which only every `step`th from `first` on is looked at.
OUTLINE uint boxes_are_outside(Store *s, V3 direction, real height, V3 low, V3 high, uint first, uint step) {
    if (box_is_outside(s, low, high) != 0) {
        return 1;
    }
    if ((step == 0) || (step > ALL_PARTS)) {
        return 0;
    }
    const V3 size = scale(REAL(0.125), sub(high, low));
    // Wider than a part by what its corners are rounded by.
    const V3 halves = scale(REAL(0.5) + CAP_MARGIN, size);
    uint n = first;
    while (n < ALL_PARTS) {
        const real along_x = ((real)(n & 7)) + REAL(0.5);
        const real along_y = ((real)((n >> 3) & 7)) + REAL(0.5);
        const real along_z = ((real)(n >> 6)) + REAL(0.5);
        const V3 middle = add(low, v3(along_x * size.x, along_y * size.y, along_z * size.z));
        if (box_is_outside(s, sub(middle, halves), add(middle, halves)) == 0) {
            if (box_misses_part(s, direction, height, middle, halves) == 0) {
                return 0;
            }
        }
        n += step;
    }
    return 1;
}

// Whether (1) the domain's winding number is 0 all over the box `[low, high]`.
HOT uint box_is_outside(Store *s, V3 low, V3 high) {
    Voxel lo = (Voxel){ .i = 0, .j = 0, .k = 0 };
    Voxel hi = (Voxel){ .i = 0, .j = 0, .k = 0 };
    voxels_of_box(s, low, high, &lo, &hi);
    if ((store_surface_voxels(s, lo, hi) == 0) && (store_winding(s, lo) == 0)) {
        return 1;
    }
    return 0;
}

// Whether (1) a box about `middle` certainly has nothing of the cell with `direction·x ≥ height`.
HOT uint box_misses_part(Store *s, V3 direction, real height, V3 middle, V3 halves) {
    if ((v3_dot(direction, middle) + reach_along(direction, halves)) < (height - (CAP_MARGIN * height))) {
        return 1;
    }
    uint f = 0;
    while (f < store_planes(s)) {
        const Plane plane = store_plane(s, f);
        const real largest = (v3_dot(plane.n, middle) + plane.d) + reach_along(plane.n, halves);
        const real rounding = (REAL(16.0) * UNIT_ROUNDOFF) * ((norm_1(plane.n) * (norm_max(middle) + norm_max(halves))) + fabs(plane.d));
        if (largest < -rounding) {
            return 1;
        }
        f += 1;
    }
    return 0;
}

// The largest `n·x` of a box about 0.
INLINE real reach_along(V3 n, V3 halves) {
    return ((fabs(n.x) * halves.x) + (fabs(n.y) * halves.y)) + (fabs(n.z) * halves.z);
}
