// Generated from core/src/cell/plane.rs by `cargo xtask codegen`; do not edit.

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
