// Generated from core/src/cell/vertex.rs by `cargo xtask codegen`; do not edit.

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
    refine_by(s, t, by, position, radius);
    return COMPLETE;
}

// The same without the rare ways out: `UNCERTAIN` where the normals are nearly dependent.
HOT uint find_vertex_refined(Store *s, Triplet t, V3 *position, real *radius) {
    const Cramer by = cramer(s, t);
    if (!(by.det > (NEARLY_DEPENDENT * by.size))) {
        return UNCERTAIN;
    }
    refine_by(s, t, by, position, radius);
    return COMPLETE;
}

// By Cramer's rule, refined where that is worth it.
INLINE void refine_by(Store *s, Triplet t, Cramer by, V3 *position, real *radius) {
    const real inverse = REAL(1.0) / by.det;
    place_by(by, inverse, position, radius);
    if (by.det < (WORTH_REFINING * by.size)) {
        step_by(s, t, by, inverse, position, radius);
    }
}

// Where Cramer's rule alone has the vertex, and what it may be off by.
INLINE void place_by(Cramer by, real inverse, V3 *position, real *radius) {
    *position = solve(by, inverse);
    *radius = ((ROUNDINGS_OF_PLACE * UNIT_ROUNDOFF) * inverse) * (by.offsets + (norm_max(*position) * by.size));
}

// A step of Newton's method: residuals from which little is rounded off, so that it ends within a rounding in every direction, also the one
// in which the planes hardly tell one point from the next.
INLINE void step_by(Store *s, Triplet t, Cramer by, real inverse, V3 *position, real *radius) {
    const real amplified = (ROUNDINGS_OF_PLACE * UNIT_ROUNDOFF) * inverse;
    const real rest_a = residual(store_plane(s, t.a), *position);
    const real rest_b = residual(store_plane(s, t.b), *position);
    const real rest_c = residual(store_plane(s, t.c), *position);
    *position = sub(*position, scale(inverse, combine(rest_a, rest_b, rest_c, by.bc, by.ca, by.ab)));
    *radius = ((ROUNDINGS_OF_EXACT * UNIT_ROUNDOFF) * norm_max(*position)) + (*radius * (amplified * by.size));
}

// The position of the vertex with triplet `t`, refined until it is off by no more than the share `most` of its largest component; `UNCERTAIN` where that
// is not reached, as where the normals are so nearly dependent that no step leads to it. (Some 100 operations, and 130 a step; in double-double 950.)
HOT uint find_vertex_closely(Store *s, Triplet t, real most, V3 *position, real *radius) {
    const Cramer by = cramer(s, t);
    if (!(by.det > (REFINABLE * by.size))) {
        return UNCERTAIN;
    }
    const real inverse = REAL(1.0) / by.det;
    place_by(by, inverse, position, radius);
    uint steps = 0;
    while ((*radius > (most * norm_max(*position))) && (steps < MOST_STEPS)) {
        step_by(s, t, by, inverse, position, radius);
        steps += 1;
    }
    if (!(*radius <= (most * norm_max(*position)))) {
        return UNCERTAIN;
    }
    return COMPLETE;
}

// The position of the vertex with triplet `t` without refinement, and its error radius: enough where both are rounded to single precision
// anyway. `UNCERTAIN` where the determinant is no more than the share `least` of `‖n_a‖₁‖n_b‖₁‖n_c‖₁`, as [`NEARLY_DEPENDENT`].
HOT uint find_vertex_once(Store *s, Triplet t, real least, V3 *position, real *radius) {
    const Cramer by = cramer(s, t);
    if (!(by.det > (least * by.size))) {
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

// `n·x + d`, rounded once or little more: products and sums leave what they round off, which is added up (Ogita, Rump & Oishi, Accurate Sum and Dot Product, 2005), so that no more than
// 25u² of the magnitudes is lost. (On devices 30 operations; as sums in double-double it took 88. A million sites on a line take a device 0.073 instead of 0.078 s so, and 0.066 where it is
// inlined, one NVIDIA H200; on the CPU blue sites take 1.0 % more instructions where it is.)
INLINE real residual(Plane plane, V3 x) {
    const Wide px = product_exact(plane.n.x, x.x);
    const Wide py = product_exact(plane.n.y, x.y);
    const Wide pz = product_exact(plane.n.z, x.z);
    const Wide xy = sum_exact(px.hi, py.hi);
    const Wide zd = sum_exact(pz.hi, plane.d);
    const Wide sum = sum_exact(xy.hi, zd.hi);
    return sum.hi + (sum.lo + ((xy.lo + (px.lo + py.lo)) + (zd.lo + pz.lo)));
}

// `n·(c + x) + d`, rounded once or little more. (Sums as in `residual` take white sites on one NVIDIA H200 2 % longer.)
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
