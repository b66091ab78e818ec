// Generated from core/src/cell/ by `cargo xtask codegen`; do not edit.

#import "parity_state.cl"

INLINE V3 take_V3(Input *in) {
    V3 value;
    value.x = take_real(in);
    value.y = take_real(in);
    value.z = take_real(in);
    return value;
}
OUTLINE void give_V3(Output *out, V3 value) {
    give_real(out, value.x);
    give_real(out, value.y);
    give_real(out, value.z);
}

INLINE Plane take_Plane(Input *in) {
    Plane value;
    value.n = take_V3(in);
    value.d = take_real(in);
    return value;
}
OUTLINE void give_Plane(Output *out, Plane value) {
    give_V3(out, value.n);
    give_real(out, value.d);
}

INLINE Triplet take_Triplet(Input *in) {
    Triplet value;
    value.a = take_uint(in);
    value.b = take_uint(in);
    value.c = take_uint(in);
    return value;
}
OUTLINE void give_Triplet(Output *out, Triplet value) {
    give_uint(out, value.a);
    give_uint(out, value.b);
    give_uint(out, value.c);
}

INLINE Cramer take_Cramer(Input *in) {
    Cramer value;
    value.bc = take_V3(in);
    value.ca = take_V3(in);
    value.ab = take_V3(in);
    value.d = take_V3(in);
    value.det = take_real(in);
    value.size = take_real(in);
    value.offsets = take_real(in);
    return value;
}
OUTLINE void give_Cramer(Output *out, Cramer value) {
    give_V3(out, value.bc);
    give_V3(out, value.ca);
    give_V3(out, value.ab);
    give_V3(out, value.d);
    give_real(out, value.det);
    give_real(out, value.size);
    give_real(out, value.offsets);
}

INLINE Wide take_Wide(Input *in) {
    Wide value;
    value.hi = take_real(in);
    value.lo = take_real(in);
    return value;
}
OUTLINE void give_Wide(Output *out, Wide value) {
    give_real(out, value.hi);
    give_real(out, value.lo);
}

INLINE Expansion take_Expansion(Input *in) {
    Expansion value;
    for (uint i = 0; i < 192u; i++) value.terms[i] = take_real(in);
    value.count = take_uint(in);
    return value;
}
OUTLINE void give_Expansion(Output *out, Expansion value) {
    for (uint i = 0; i < 192u; i++) give_real(out, value.terms[i]);
    give_uint(out, value.count);
}

INLINE CellSums take_CellSums(Input *in) {
    CellSums value;
    value.volume = take_real(in);
    value.first = take_V3(in);
    value.second_diagonal = take_V3(in);
    value.second_mixed = take_V3(in);
    value.integral = take_real(in);
    value.rounding = take_real(in);
    value.largest_rounding = take_real(in);
    value.boundary_area = take_real(in);
    value.boundary_moment = take_V3(in);
    value.boundary_vector = take_V3(in);
    value.boundary_flux = take_real(in);
    return value;
}
OUTLINE void give_CellSums(Output *out, CellSums value) {
    give_real(out, value.volume);
    give_V3(out, value.first);
    give_V3(out, value.second_diagonal);
    give_V3(out, value.second_mixed);
    give_real(out, value.integral);
    give_real(out, value.rounding);
    give_real(out, value.largest_rounding);
    give_real(out, value.boundary_area);
    give_V3(out, value.boundary_moment);
    give_V3(out, value.boundary_vector);
    give_real(out, value.boundary_flux);
}

INLINE Side take_Side(Input *in) {
    Side value;
    value.index = take_uint(in);
    value.n = take_V3(in);
    value.d = take_real(in);
    value.square = take_real(in);
    value.foot = take_V3(in);
    return value;
}
OUTLINE void give_Side(Output *out, Side value) {
    give_uint(out, value.index);
    give_V3(out, value.n);
    give_real(out, value.d);
    give_real(out, value.square);
    give_V3(out, value.foot);
}

INLINE Corner take_Corner(Input *in) {
    Corner value;
    value.triplet = take_Triplet(in);
    value.position = take_V3(in);
    value.distance = take_real(in);
    value.radius = take_real(in);
    return value;
}
OUTLINE void give_Corner(Output *out, Corner value) {
    give_Triplet(out, value.triplet);
    give_V3(out, value.position);
    give_real(out, value.distance);
    give_real(out, value.radius);
}

INLINE Piece take_Piece(Input *in) {
    Piece value;
    value.volume = take_real(in);
    value.rounding = take_real(in);
    value.first = take_V3(in);
    return value;
}
OUTLINE void give_Piece(Output *out, Piece value) {
    give_real(out, value.volume);
    give_real(out, value.rounding);
    give_V3(out, value.first);
}

INLINE FacetSum take_FacetSum(Input *in) {
    FacetSum value;
    value.area = take_real(in);
    value.moment = take_V3(in);
    value.rounding = take_real(in);
    return value;
}
OUTLINE void give_FacetSum(Output *out, FacetSum value) {
    give_real(out, value.area);
    give_V3(out, value.moment);
    give_real(out, value.rounding);
}

INLINE Voxel take_Voxel(Input *in) {
    Voxel value;
    value.i = take_uint(in);
    value.j = take_uint(in);
    value.k = take_uint(in);
    return value;
}
OUTLINE void give_Voxel(Output *out, Voxel value) {
    give_uint(out, value.i);
    give_uint(out, value.j);
    give_uint(out, value.k);
}

INLINE TruncatedCone take_TruncatedCone(Input *in) {
    TruncatedCone value;
    value.sign = take_real(in);
    value.jump = take_real(in);
    value.reach = take_real(in);
    value.end = take_Plane(in);
    value.side_0 = take_Plane(in);
    value.side_1 = take_Plane(in);
    value.side_2 = take_Plane(in);
    return value;
}
OUTLINE void give_TruncatedCone(Output *out, TruncatedCone value) {
    give_real(out, value.sign);
    give_real(out, value.jump);
    give_real(out, value.reach);
    give_Plane(out, value.end);
    give_Plane(out, value.side_0);
    give_Plane(out, value.side_1);
    give_Plane(out, value.side_2);
}

__kernel void parity_v3(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real x = take_real(&in);
    const real y = take_real(&in);
    const real z = take_real(&in);
    const V3 result = v3(x, y, z);
    give_V3(&out, result);
}

__kernel void parity_add(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 result = add(a, b);
    give_V3(&out, result);
}

__kernel void parity_sub(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 result = sub(a, b);
    give_V3(&out, result);
}

__kernel void parity_scale(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real t = take_real(&in);
    const V3 a = take_V3(&in);
    const V3 result = scale(t, a);
    give_V3(&out, result);
}

__kernel void parity_dot(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const real result = v3_dot(a, b);
    give_real(&out, result);
}

__kernel void parity_cross(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 result = v3_cross(a, b);
    give_V3(&out, result);
}

__kernel void parity_norm_1(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const real result = norm_1(a);
    give_real(&out, result);
}

__kernel void parity_norm_max(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const real result = norm_max(a);
    give_real(&out, result);
}

__kernel void parity_smaller(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real a = take_real(&in);
    const real b = take_real(&in);
    const real result = smaller(a, b);
    give_real(&out, result);
}

__kernel void parity_larger(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real a = take_real(&in);
    const real b = take_real(&in);
    const real result = larger(a, b);
    give_real(&out, result);
}

__kernel void parity_bisector(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 d = take_V3(&in);
    const real dw = take_real(&in);
    const Plane result = bisector(d, dw);
    give_Plane(&out, result);
}

__kernel void parity_cone_side(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 o = take_V3(&in);
    const V3 lo_o = take_V3(&in);
    const V3 edge = take_V3(&in);
    const real sign = take_real(&in);
    const Plane result = cone_side(o, lo_o, edge, sign);
    give_Plane(&out, result);
}

__kernel void parity_triangle_plane(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 c = take_V3(&in);
    const real sign = take_real(&in);
    const Plane result = triangle_plane(a, b, c, sign);
    give_Plane(&out, result);
}

__kernel void parity_wall_over_edge(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 n = take_V3(&in);
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const Plane result = wall_over_edge(n, a, b);
    give_Plane(&out, result);
}

__kernel void parity_place_vertex(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint v = take_uint(&in);
    const uint result = place_vertex(s, v);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_find_vertex(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Triplet t = take_Triplet(&in);
    V3 position = take_V3(&in);
    real radius = take_real(&in);
    const uint result = find_vertex(s, t, &position, &radius);
    give_uint(&out, result);
    give_V3(&out, position);
    give_real(&out, radius);
    parity_dump(&out, s);
}

__kernel void parity_find_vertex_refined(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Triplet t = take_Triplet(&in);
    V3 position = take_V3(&in);
    real radius = take_real(&in);
    const uint result = find_vertex_refined(s, t, &position, &radius);
    give_uint(&out, result);
    give_V3(&out, position);
    give_real(&out, radius);
    parity_dump(&out, s);
}

__kernel void parity_find_vertex_closely(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Triplet t = take_Triplet(&in);
    const real most = take_real(&in);
    V3 position = take_V3(&in);
    real radius = take_real(&in);
    const uint result = find_vertex_closely(s, t, most, &position, &radius);
    give_uint(&out, result);
    give_V3(&out, position);
    give_real(&out, radius);
    parity_dump(&out, s);
}

__kernel void parity_find_vertex_once(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Triplet t = take_Triplet(&in);
    const real least = take_real(&in);
    V3 position = take_V3(&in);
    real radius = take_real(&in);
    const uint result = find_vertex_once(s, t, least, &position, &radius);
    give_uint(&out, result);
    give_V3(&out, position);
    give_real(&out, radius);
    parity_dump(&out, s);
}

__kernel void parity_cramer(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Triplet t = take_Triplet(&in);
    const Cramer result = cramer(s, t);
    give_Cramer(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_solve(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Cramer by = take_Cramer(&in);
    const real inverse = take_real(&in);
    const V3 result = solve(by, inverse);
    give_V3(&out, result);
}

__kernel void parity_residual(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Plane plane = take_Plane(&in);
    const V3 x = take_V3(&in);
    const real result = residual(plane, x);
    give_real(&out, result);
}

__kernel void parity_residual_about(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Plane plane = take_Plane(&in);
    const V3 c = take_V3(&in);
    const V3 x = take_V3(&in);
    const real result = residual_about(plane, c, x);
    give_real(&out, result);
}

__kernel void parity_combine(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real ra = take_real(&in);
    const real rb = take_real(&in);
    const real rc = take_real(&in);
    const V3 bc = take_V3(&in);
    const V3 ca = take_V3(&in);
    const V3 ab = take_V3(&in);
    const V3 result = combine(ra, rb, rc, bc, ca, ab);
    give_V3(&out, result);
}

__kernel void parity_sign_of_conflict(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint v = take_uint(&in);
    const uint k = take_uint(&in);
    const int result = sign_of_conflict(s, v, k);
    give_int(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_wide_sign(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Plane a = take_Plane(&in);
    const Plane b = take_Plane(&in);
    const Plane c = take_Plane(&in);
    const Plane e = take_Plane(&in);
    const int result = wide_sign(a, b, c, e);
    give_int(&out, result);
}

__kernel void parity_add_term(PARITY_ARGUMENTS) {
    PARITY_CALL;
    Wide sum = take_Wide(&in);
    real size = take_real(&in);
    const real x0 = take_real(&in);
    const real y0 = take_real(&in);
    const real x1 = take_real(&in);
    const real y1 = take_real(&in);
    const real z2 = take_real(&in);
    const real w2 = take_real(&in);
    const real z3 = take_real(&in);
    const real w3 = take_real(&in);
    const real sign = take_real(&in);
    add_term(&sum, &size, x0, y0, x1, y1, z2, w2, z3, w3, sign);
    give_Wide(&out, sum);
    give_real(&out, size);
}

__kernel void parity_minor(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real x0 = take_real(&in);
    const real y0 = take_real(&in);
    const real x1 = take_real(&in);
    const real y1 = take_real(&in);
    const Wide result = minor(x0, y0, x1, y1);
    give_Wide(&out, result);
}

__kernel void parity_product_exact(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real a = take_real(&in);
    const real b = take_real(&in);
    const Wide result = product_exact(a, b);
    give_Wide(&out, result);
}

__kernel void parity_rest_of_product(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real a = take_real(&in);
    const real b = take_real(&in);
    const real result = rest_of_product(a, b);
    give_real(&out, result);
}

__kernel void parity_wide_add(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Wide a = take_Wide(&in);
    const Wide b = take_Wide(&in);
    const Wide result = wide_add(a, b);
    give_Wide(&out, result);
}

__kernel void parity_multiply(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Wide a = take_Wide(&in);
    const Wide b = take_Wide(&in);
    const Wide result = multiply(a, b);
    give_Wide(&out, result);
}

__kernel void parity_sum_exact(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real a = take_real(&in);
    const real b = take_real(&in);
    const Wide result = sum_exact(a, b);
    give_Wide(&out, result);
}

__kernel void parity_wide_quotient(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Wide a = take_Wide(&in);
    const Wide b = take_Wide(&in);
    const real result = wide_quotient(a, b);
    give_real(&out, result);
}

__kernel void parity_wide_position(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Plane a = take_Plane(&in);
    const Plane b = take_Plane(&in);
    const Plane c = take_Plane(&in);
    V3 position = take_V3(&in);
    real radius = take_real(&in);
    const uint result = wide_position(a, b, c, &position, &radius);
    give_uint(&out, result);
    give_V3(&out, position);
    give_real(&out, radius);
}

__kernel void parity_expansion_sign(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Plane a = take_Plane(&in);
    const Plane b = take_Plane(&in);
    const Plane c = take_Plane(&in);
    const Plane e = take_Plane(&in);
    const int result = expansion_sign(a, b, c, e);
    give_int(&out, result);
}

__kernel void parity_expansion_position(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Plane a = take_Plane(&in);
    const Plane b = take_Plane(&in);
    const Plane c = take_Plane(&in);
    V3 position = take_V3(&in);
    const uint result = expansion_position(a, b, c, &position);
    give_uint(&out, result);
    give_V3(&out, position);
}

__kernel void parity_is_tiny(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Plane plane = take_Plane(&in);
    const bool result = is_tiny(plane);
    give_bool(&out, result);
}

__kernel void parity_is_tiny_number(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real x = take_real(&in);
    const uint result = is_tiny_number(x);
    give_uint(&out, result);
}

__kernel void parity_add_minors(PARITY_ARGUMENTS) {
    PARITY_CALL;
    Expansion sum = take_Expansion(&in);
    const real x0 = take_real(&in);
    const real y0 = take_real(&in);
    const real x1 = take_real(&in);
    const real y1 = take_real(&in);
    const real z2 = take_real(&in);
    const real w2 = take_real(&in);
    const real z3 = take_real(&in);
    const real w3 = take_real(&in);
    add_minors(&sum, x0, y0, x1, y1, z2, w2, z3, w3);
    give_Expansion(&out, sum);
}

__kernel void parity_add_four(PARITY_ARGUMENTS) {
    PARITY_CALL;
    Expansion sum = take_Expansion(&in);
    const Wide p = take_Wide(&in);
    const Wide q = take_Wide(&in);
    add_four(&sum, p, q);
    give_Expansion(&out, sum);
}

__kernel void parity_add_product(PARITY_ARGUMENTS) {
    PARITY_CALL;
    Expansion sum = take_Expansion(&in);
    const real x = take_real(&in);
    const real y = take_real(&in);
    add_product(&sum, x, y);
    give_Expansion(&out, sum);
}

__kernel void parity_add_number(PARITY_ARGUMENTS) {
    PARITY_CALL;
    Expansion sum = take_Expansion(&in);
    const real x = take_real(&in);
    add_number(&sum, x);
    give_Expansion(&out, sum);
}

__kernel void parity_value_of(PARITY_ARGUMENTS) {
    PARITY_CALL;
    Expansion sum = take_Expansion(&in);
    const Wide result = value_of(&sum);
    give_Wide(&out, result);
    give_Expansion(&out, sum);
}

__kernel void parity_determinant(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 c = take_V3(&in);
    const Wide result = determinant(a, b, c);
    give_Wide(&out, result);
}

__kernel void parity_add_triple(PARITY_ARGUMENTS) {
    PARITY_CALL;
    Expansion sum = take_Expansion(&in);
    const real x = take_real(&in);
    const real y = take_real(&in);
    const real z = take_real(&in);
    add_triple(&sum, x, y, z);
    give_Expansion(&out, sum);
}

__kernel void parity_set_box_planes(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 lo = take_V3(&in);
    const V3 hi = take_V3(&in);
    set_box_planes(s, lo, hi);
    parity_dump(&out, s);
}

__kernel void parity_set_box_plane(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint f = take_uint(&in);
    const V3 n = take_V3(&in);
    const real d = take_real(&in);
    set_box_plane(s, f, n, d);
    parity_dump(&out, s);
}

__kernel void parity_place_corner(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint v = take_uint(&in);
    place_corner(s, v);
    parity_dump(&out, s);
}

__kernel void parity_integrate_function(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 center = take_V3(&in);
    const real result = integrate_function(s, center);
    give_real(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_polynomial(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 x = take_V3(&in);
    const real result = polynomial(s, x);
    give_real(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_volume_is_above_bound(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const CellSums sums = take_CellSums(&in);
    const bool result = volume_is_above_bound(sums);
    give_bool(&out, result);
}

__kernel void parity_integrate(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const real weight = take_real(&in);
    const V3 center = take_V3(&in);
    const real reach = take_real(&in);
    const uint flags = take_uint(&in);
    CellSums sums = take_CellSums(&in);
    const uint result = integrate(s, weight, center, reach, flags, &sums);
    give_uint(&out, result);
    give_CellSums(&out, sums);
    parity_dump(&out, s);
}

__kernel void parity_both_sums(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const CellSums a = take_CellSums(&in);
    const CellSums b = take_CellSums(&in);
    const CellSums result = both_sums(a, b);
    give_CellSums(&out, result);
}

__kernel void parity_side(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint f = take_uint(&in);
    const V3 center = take_V3(&in);
    const Side result = side(s, f, center);
    give_Side(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_add_edge(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Side f = take_Side(&in);
    const Side g = take_Side(&in);
    const Corner at = take_Corner(&in);
    const real weight = take_real(&in);
    const V3 center = take_V3(&in);
    const uint flags = take_uint(&in);
    CellSums part = take_CellSums(&in);
    const uint result = add_edge(s, f, g, at, weight, center, flags, &part);
    give_uint(&out, result);
    give_CellSums(&out, part);
    parity_dump(&out, s);
}

__kernel void parity_spoke_of(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 foot = take_V3(&in);
    const V3 position = take_V3(&in);
    const V3 result = spoke_of(foot, position);
    give_V3(&out, result);
}

__kernel void parity_rounding_across(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real distance = take_real(&in);
    const real spoke = take_real(&in);
    const real result = rounding_across(distance, spoke);
    give_real(&out, result);
}

__kernel void parity_foot_on_edge(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Side f = take_Side(&in);
    const Side g = take_Side(&in);
    const V3 center = take_V3(&in);
    const bool is_bounded = take_bool(&in);
    V3 foot = take_V3(&in);
    real off = take_real(&in);
    const uint result = foot_on_edge(s, f, g, center, is_bounded, &foot, &off);
    give_uint(&out, result);
    give_V3(&out, foot);
    give_real(&out, off);
    parity_dump(&out, s);
}

__kernel void parity_foot_by(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 n_f = take_V3(&in);
    const real d_f = take_real(&in);
    const V3 n_g = take_V3(&in);
    const real d_g = take_real(&in);
    const V3 direction = take_V3(&in);
    const real per_square = take_real(&in);
    const V3 result = foot_by(n_f, d_f, n_g, d_g, direction, per_square);
    give_V3(&out, result);
}

__kernel void parity_is_plain(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real square = take_real(&in);
    const real whole = take_real(&in);
    const bool result = is_plain(square, whole);
    give_bool(&out, result);
}

__kernel void parity_off_plain_foot(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 foot = take_V3(&in);
    const real per_sine_square = take_real(&in);
    const V3 center = take_V3(&in);
    const real result = off_plain_foot(foot, per_sine_square, center);
    give_real(&out, result);
}

__kernel void parity_radius_at(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real radius = take_real(&in);
    const real reach = take_real(&in);
    const real result = radius_at(radius, reach);
    give_real(&out, result);
}

__kernel void parity_piece_of(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real volume = take_real(&in);
    const V3 h = take_V3(&in);
    const V3 i = take_V3(&in);
    const V3 v = take_V3(&in);
    const Piece result = piece_of(volume, h, i, v);
    give_Piece(&out, result);
}

__kernel void parity_add_piece(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Piece piece = take_Piece(&in);
    CellSums part = take_CellSums(&in);
    add_piece(piece, &part);
    give_CellSums(&out, part);
}

__kernel void parity_add_tetrahedron(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real volume = take_real(&in);
    const V3 h = take_V3(&in);
    const V3 i = take_V3(&in);
    const V3 v = take_V3(&in);
    const uint flags = take_uint(&in);
    CellSums part = take_CellSums(&in);
    add_tetrahedron(volume, h, i, v, flags, &part);
    give_CellSums(&out, part);
}

__kernel void parity_second_diagonal(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 h = take_V3(&in);
    const V3 i = take_V3(&in);
    const V3 v = take_V3(&in);
    const V3 s = take_V3(&in);
    const V3 result = second_diagonal(h, i, v, s);
    give_V3(&out, result);
}

__kernel void parity_second_mixed(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 h = take_V3(&in);
    const V3 i = take_V3(&in);
    const V3 v = take_V3(&in);
    const V3 s = take_V3(&in);
    const V3 result = second_mixed(h, i, v, s);
    give_V3(&out, result);
}

__kernel void parity_squares(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real a = take_real(&in);
    const real b = take_real(&in);
    const real c = take_real(&in);
    const real result = squares(a, b, c);
    give_real(&out, result);
}

__kernel void parity_products(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real a = take_real(&in);
    const real b = take_real(&in);
    const real c = take_real(&in);
    const real d = take_real(&in);
    const real e = take_real(&in);
    const real f = take_real(&in);
    const real result = products(a, b, c, d, e, f);
    give_real(&out, result);
}

__kernel void parity_reference_point(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 result = reference_point(s);
    give_V3(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_facet_is_above_bound(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const FacetSum sum = take_FacetSum(&in);
    const bool result = facet_is_above_bound(sum);
    give_bool(&out, result);
}

__kernel void parity_add_triangle(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Side f = take_Side(&in);
    const V3 foot = take_V3(&in);
    const real off = take_real(&in);
    const Corner at = take_Corner(&in);
    const real sign = take_real(&in);
    const V3 center = take_V3(&in);
    const bool area_alone = take_bool(&in);
    FacetSum sum = take_FacetSum(&in);
    add_triangle(f, foot, off, at, sign, center, area_alone, &sum);
    give_FacetSum(&out, sum);
}

__kernel void parity_moment_of_triangle(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Side f = take_Side(&in);
    const V3 foot = take_V3(&in);
    const V3 position = take_V3(&in);
    const V3 center = take_V3(&in);
    const real area = take_real(&in);
    const V3 result = moment_of_triangle(f, foot, position, center, area);
    give_V3(&out, result);
}

__kernel void parity_rounding_of_triangle(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Side f = take_Side(&in);
    const V3 foot = take_V3(&in);
    const real off = take_real(&in);
    const V3 position = take_V3(&in);
    const real radius = take_real(&in);
    const real result = rounding_of_triangle(f, foot, off, position, radius);
    give_real(&out, result);
}

__kernel void parity_per_length(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Side f = take_Side(&in);
    const real result = per_length(f);
    give_real(&out, result);
}

__kernel void parity_area_of_triangle(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Side f = take_Side(&in);
    const real per_length = take_real(&in);
    const V3 to_foot = take_V3(&in);
    const V3 to_vertex = take_V3(&in);
    const real sign = take_real(&in);
    const real result = area_of_triangle(f, per_length, to_foot, to_vertex, sign);
    give_real(&out, result);
}

__kernel void parity_integrate_facet(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint index = take_uint(&in);
    const V3 center = take_V3(&in);
    const real reach = take_real(&in);
    FacetSum sum = take_FacetSum(&in);
    const uint result = integrate_facet(s, index, center, reach, &sum);
    give_uint(&out, result);
    give_FacetSum(&out, sum);
    parity_dump(&out, s);
}

__kernel void parity_reset_facets(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint flags = take_uint(&in);
    reset_facets(s, flags);
    parity_dump(&out, s);
}

__kernel void parity_asks_for_boundary(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const uint flags = take_uint(&in);
    const bool result = asks_for_boundary(flags);
    give_bool(&out, result);
}

__kernel void parity_add_boundary(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const FacetSum sum = take_FacetSum(&in);
    const Plane plane = take_Plane(&in);
    const real outward = take_real(&in);
    CellSums sums = take_CellSums(&in);
    add_boundary(sum, plane, outward, &sums);
    give_CellSums(&out, sums);
}

__kernel void parity_add_facet_seconds(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const real weight = take_real(&in);
    const V3 center = take_V3(&in);
    const uint result = add_facet_seconds(s, weight, center);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_add_edge_second(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Side f = take_Side(&in);
    const Side g = take_Side(&in);
    const V3 position = take_V3(&in);
    const real weight = take_real(&in);
    const V3 center = take_V3(&in);
    const uint result = add_edge_second(s, f, g, position, weight, center);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_add_triangle_second(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Side f = take_Side(&in);
    const V3 foot = take_V3(&in);
    const V3 position = take_V3(&in);
    const real sign = take_real(&in);
    add_triangle_second(s, f, foot, position, sign);
    parity_dump(&out, s);
}

__kernel void parity_center_facets(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 center = take_V3(&in);
    center_facets(s, center);
    parity_dump(&out, s);
}

__kernel void parity_surface_passes_by(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 low = take_V3(&in);
    const V3 high = take_V3(&in);
    const Voxel lo = take_Voxel(&in);
    const Voxel hi = take_Voxel(&in);
    int winding = take_int(&in);
    const bool result = surface_passes_by(s, low, high, lo, hi, &winding);
    give_bool(&out, result);
    give_int(&out, winding);
    parity_dump(&out, s);
}

__kernel void parity_row_is_empty(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Voxel lo = take_Voxel(&in);
    const Voxel hi = take_Voxel(&in);
    const uint j = take_uint(&in);
    const uint k = take_uint(&in);
    const bool result = row_is_empty(s, lo, hi, j, k);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_site_is_inside(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const bool result = site_is_inside(s);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_voxel_passes_by(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Voxel voxel = take_Voxel(&in);
    const Voxel lo = take_Voxel(&in);
    const V3 low = take_V3(&in);
    const V3 high = take_V3(&in);
    int winding = take_int(&in);
    const bool result = voxel_passes_by(s, voxel, lo, low, high, &winding);
    give_bool(&out, result);
    give_int(&out, winding);
    parity_dump(&out, s);
}

__kernel void parity_triangle_passes_by(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint t = take_uint(&in);
    const Voxel apex = take_Voxel(&in);
    const V3 low = take_V3(&in);
    const V3 high = take_V3(&in);
    int winding = take_int(&in);
    const bool result = triangle_passes_by(s, t, apex, low, high, &winding);
    give_bool(&out, result);
    give_int(&out, winding);
    parity_dump(&out, s);
}

__kernel void parity_are_apart(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 c = take_V3(&in);
    const V3 d = take_V3(&in);
    const bool result = are_apart(a, b, c, d);
    give_bool(&out, result);
}

__kernel void parity_plane_is_apart(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 a_in = take_V3(&in);
    const V3 e = take_V3(&in);
    const V3 f = take_V3(&in);
    const bool result = plane_is_apart(s, a_in, e, f);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_least_of(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 c = take_V3(&in);
    const V3 result = least_of(a, b, c);
    give_V3(&out, result);
}

__kernel void parity_most_of(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 c = take_V3(&in);
    const V3 result = most_of(a, b, c);
    give_V3(&out, result);
}

__kernel void parity_is_first_voxel(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const Voxel lowest = take_Voxel(&in);
    const Voxel lo = take_Voxel(&in);
    const Voxel voxel = take_Voxel(&in);
    const bool result = is_first_voxel(lowest, lo, voxel);
    give_bool(&out, result);
}

__kernel void parity_outer_box_of_cell(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    V3 low = take_V3(&in);
    V3 high = take_V3(&in);
    outer_box_of_cell(s, &low, &high);
    give_V3(&out, low);
    give_V3(&out, high);
    parity_dump(&out, s);
}

__kernel void parity_box_of_cell(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    V3 low = take_V3(&in);
    V3 high = take_V3(&in);
    const real result = box_of_cell(s, &low, &high);
    give_real(&out, result);
    give_V3(&out, low);
    give_V3(&out, high);
    parity_dump(&out, s);
}

__kernel void parity_voxels_of_box(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 low = take_V3(&in);
    const V3 high = take_V3(&in);
    Voxel lo = take_Voxel(&in);
    Voxel hi = take_Voxel(&in);
    voxels_of_box(s, low, high, &lo, &hi);
    give_Voxel(&out, lo);
    give_Voxel(&out, hi);
    parity_dump(&out, s);
}

__kernel void parity_make_cone(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint t = take_uint(&in);
    const Voxel apex = take_Voxel(&in);
    TruncatedCone cone = take_TruncatedCone(&in);
    const uint result = make_cone(s, t, apex, &cone);
    give_uint(&out, result);
    give_TruncatedCone(&out, cone);
    parity_dump(&out, s);
}

__kernel void parity_no_cone(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const TruncatedCone result = no_cone();
    give_TruncatedCone(&out, result);
}

__kernel void parity_make_prism(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint t = take_uint(&in);
    const Voxel apex = take_Voxel(&in);
    TruncatedCone prism = take_TruncatedCone(&in);
    const uint result = make_prism(s, t, apex, &prism);
    give_uint(&out, result);
    give_TruncatedCone(&out, prism);
    parity_dump(&out, s);
}

__kernel void parity_side_over_edge(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const uint i = take_uint(&in);
    const uint j = take_uint(&in);
    const V3 p = take_V3(&in);
    const V3 q = take_V3(&in);
    const V3 o = take_V3(&in);
    const V3 o_in = take_V3(&in);
    const real sign = take_real(&in);
    const Plane result = side_over_edge(i, j, p, q, o, o_in, sign);
    give_Plane(&out, result);
}

__kernel void parity_lies_beyond(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint t = take_uint(&in);
    const Voxel apex = take_Voxel(&in);
    const uint result = lies_beyond(s, t, apex);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_nearest_corner(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 x = take_V3(&in);
    const Voxel lo = take_Voxel(&in);
    const Voxel hi = take_Voxel(&in);
    const Voxel result = nearest_corner(s, x, lo, hi);
    give_Voxel(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_nearest_of(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real x = take_real(&in);
    const real low = take_real(&in);
    const real high = take_real(&in);
    const uint at = take_uint(&in);
    const uint least = take_uint(&in);
    const uint most = take_uint(&in);
    const uint result = nearest_of(x, low, high, at, least, most);
    give_uint(&out, result);
}

__kernel void parity_cone_sign(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint t = take_uint(&in);
    const Voxel apex = take_Voxel(&in);
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 c = take_V3(&in);
    const int result = cone_sign(s, t, apex, a, b, c);
    give_int(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_filtered_sign(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 b = take_V3(&in);
    const V3 c = take_V3(&in);
    const int result = filtered_sign(a, b, c);
    give_int(&out, result);
}

__kernel void parity_magnitudes(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 a = take_V3(&in);
    const V3 result = magnitudes(a);
    give_V3(&out, result);
}

__kernel void parity_settle(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    CellSums sums = take_CellSums(&in);
    const uint result = settle(s, &sums);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_is_undivided(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const CellSums sums = take_CellSums(&in);
    const CellSums whole = take_CellSums(&in);
    int winding = take_int(&in);
    const bool result = is_undivided(sums, whole, &winding);
    give_bool(&out, result);
    give_int(&out, winding);
}

__kernel void parity_lies_outside(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const bool result = lies_outside(s);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_add_to_part(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint v = take_uint(&in);
    const V3 direction = take_V3(&in);
    const real height = take_real(&in);
    V3 low = take_V3(&in);
    V3 high = take_V3(&in);
    add_to_part(s, v, direction, height, &low, &high);
    give_V3(&out, low);
    give_V3(&out, high);
    parity_dump(&out, s);
}

__kernel void parity_widen_part(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 direction = take_V3(&in);
    const real height = take_real(&in);
    const real radius = take_real(&in);
    V3 low = take_V3(&in);
    V3 high = take_V3(&in);
    const bool result = widen_part(s, direction, height, radius, &low, &high);
    give_bool(&out, result);
    give_V3(&out, low);
    give_V3(&out, high);
    parity_dump(&out, s);
}

__kernel void parity_middle_of_part(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 low = take_V3(&in);
    const V3 size = take_V3(&in);
    const uint n = take_uint(&in);
    const V3 result = middle_of_part(low, size, n);
    give_V3(&out, result);
}

__kernel void parity_middle_within_part(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 middle = take_V3(&in);
    const V3 size = take_V3(&in);
    const uint n = take_uint(&in);
    const V3 result = middle_within_part(middle, size, n);
    give_V3(&out, result);
}

__kernel void parity_box_has_nothing(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 direction = take_V3(&in);
    const real height = take_real(&in);
    const V3 middle = take_V3(&in);
    const V3 size = take_V3(&in);
    const bool result = box_has_nothing(s, direction, height, middle, size);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_box_is_outside(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 low = take_V3(&in);
    const V3 high = take_V3(&in);
    const bool result = box_is_outside(s, low, high);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_box_misses_part(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 direction = take_V3(&in);
    const real height = take_real(&in);
    const V3 middle = take_V3(&in);
    const V3 halves = take_V3(&in);
    const bool result = box_misses_part(s, direction, height, middle, halves);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_reach_along(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const V3 n = take_V3(&in);
    const V3 halves = take_V3(&in);
    const real result = reach_along(n, halves);
    give_real(&out, result);
}

__kernel void parity_next_distance(PARITY_ARGUMENTS) {
    PARITY_CALL;
    const real distance = take_real(&in);
    const real radius = take_real(&in);
    const real result = next_distance(distance, radius);
    give_real(&out, result);
}

__kernel void parity_cap_outside(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const real radius = take_real(&in);
    const uint result = cap_outside(s, radius);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_farthest_position(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 result = farthest_position(s);
    give_V3(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_part_is_outside(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 direction = take_V3(&in);
    const real height = take_real(&in);
    const bool result = part_is_outside(s, direction, height);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_begin(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 lo = take_V3(&in);
    const V3 hi = take_V3(&in);
    const uint result = begin(s, lo, hi);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_clip(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Plane plane = take_Plane(&in);
    const uint tag = take_uint(&in);
    const uint result = clip(s, plane, tag);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_settle_marks(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint k = take_uint(&in);
    const uint result = settle_marks(s, k);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_clear_links(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    clear_links(s);
    parity_dump(&out, s);
}

__kernel void parity_find_boundary_edge(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint end = take_uint(&in);
    Triplet edge = take_Triplet(&in);
    find_boundary_edge(s, end, &edge);
    give_Triplet(&out, edge);
    parity_dump(&out, s);
}

__kernel void parity_is_boundary_edge(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint end = take_uint(&in);
    const uint a = take_uint(&in);
    const uint b = take_uint(&in);
    const bool result = is_boundary_edge(s, end, a, b);
    give_bool(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_compact_planes(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    compact_planes(s);
    parity_dump(&out, s);
}

__kernel void parity_farthest_vertex(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const real result = farthest_vertex(s);
    give_real(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_integrate_cell(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint flags = take_uint(&in);
    const uint interior_only = take_uint(&in);
    CellSums sums = take_CellSums(&in);
    const uint result = integrate_cell(s, flags, interior_only, &sums);
    give_uint(&out, result);
    give_CellSums(&out, sums);
    parity_dump(&out, s);
}

__kernel void parity_integrate_restricted(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const V3 center = take_V3(&in);
    const uint flags = take_uint(&in);
    const uint interior_only = take_uint(&in);
    CellSums sums = take_CellSums(&in);
    const uint result = integrate_restricted(s, center, flags, interior_only, &sums);
    give_uint(&out, result);
    give_CellSums(&out, sums);
    parity_dump(&out, s);
}

__kernel void parity_integrate_whole(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const real weight = take_real(&in);
    const V3 center = take_V3(&in);
    const uint flags = take_uint(&in);
    CellSums sums = take_CellSums(&in);
    const uint result = integrate_whole(s, weight, center, flags, &sums);
    give_uint(&out, result);
    give_CellSums(&out, sums);
    parity_dump(&out, s);
}

__kernel void parity_add_box_faces(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    CellSums sums = take_CellSums(&in);
    add_box_faces(s, &sums);
    give_CellSums(&out, sums);
    parity_dump(&out, s);
}

__kernel void parity_add_cones(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const Voxel lo = take_Voxel(&in);
    const Voxel hi = take_Voxel(&in);
    const Voxel apex = take_Voxel(&in);
    const V3 center = take_V3(&in);
    const uint flags = take_uint(&in);
    bool touched = take_bool(&in);
    CellSums sums = take_CellSums(&in);
    const uint result = add_cones(s, lo, hi, apex, center, flags, &touched, &sums);
    give_uint(&out, result);
    give_bool(&out, touched);
    give_CellSums(&out, sums);
    parity_dump(&out, s);
}

__kernel void parity_add_cone(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint t = take_uint(&in);
    const Voxel apex = take_Voxel(&in);
    const V3 center = take_V3(&in);
    const uint flags = take_uint(&in);
    bool touched = take_bool(&in);
    CellSums sums = take_CellSums(&in);
    const uint result = add_cone(s, t, apex, center, flags, &touched, &sums);
    give_uint(&out, result);
    give_bool(&out, touched);
    give_CellSums(&out, sums);
    parity_dump(&out, s);
}

__kernel void parity_clip_by_sides(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const TruncatedCone cone = take_TruncatedCone(&in);
    const uint result = clip_by_sides(s, cone);
    give_uint(&out, result);
    parity_dump(&out, s);
}

__kernel void parity_add_surface(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint t = take_uint(&in);
    const Voxel apex = take_Voxel(&in);
    const V3 center = take_V3(&in);
    CellSums sums = take_CellSums(&in);
    const uint result = add_surface(s, t, apex, center, &sums);
    give_uint(&out, result);
    give_CellSums(&out, sums);
    parity_dump(&out, s);
}

__kernel void parity_all_in_conflict(PARITY_ARGUMENTS) {
    PARITY_CALL;
    PARITY_STORE;
    const uint k = take_uint(&in);
    const Plane plane = take_Plane(&in);
    const bool result = all_in_conflict(s, k, plane);
    give_bool(&out, result);
    parity_dump(&out, s);
}
