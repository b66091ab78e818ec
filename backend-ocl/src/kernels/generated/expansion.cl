// Generated from core/src/cell/expansion.rs by `cargo xtask codegen`; do not edit.

// The sign of the 4×4 determinant with rows `[n | d]`, exactly, or `SIGN_UNKNOWN` where a product could underflow.
OUTLINE int expansion_sign(Plane a, Plane b, Plane c, Plane e) {
    if (((is_tiny(a) || is_tiny(b)) || is_tiny(c)) || is_tiny(e)) {
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
    if ((is_tiny(a) || is_tiny(b)) || is_tiny(c)) {
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

// Whether a coefficient is smaller than `EXPANSION_SMALLEST` and not zero.
INLINE bool is_tiny(Plane plane) {
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
    for (uint i = 0; i < sum->count; i++) {
        const Wide next = sum_exact(carried, sum->terms[i]);
        carried = next.hi;
        if (next.lo != REAL(0.0)) {
            sum->terms[kept] = next.lo;
            kept += 1;
        }
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
    for (uint i = 0; i < last; i++) {
        rest = rest + sum->terms[i];
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
