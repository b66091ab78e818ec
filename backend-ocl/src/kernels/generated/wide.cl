// Generated from core/src/cell/wide.rs by `cargo xtask codegen`; do not edit.

// The sign of the 4×4 determinant of `[n | d]` of the planes of vertex `v` and of plane `k`: −1, 0 or 1, or `SIGN_UNKNOWN`
// where no stage of the store can decide it. Negative: the vertex is in conflict with `k`. Five stages: integers, where
// coefficients have few digits, double-double, integers that wrap, expansions, and the store's own.
OUTLINE int sign_of_conflict(Store *s, uint v, uint k) {
    const Triplet t = store_triplet(s, v);
    const Plane a = store_plane(s, t.a);
    const Plane b = store_plane(s, t.b);
    const Plane c = store_plane(s, t.c);
    const Plane e = store_plane(s, k);
    int sign = store_narrow_sign(s, t, v, k);
    if (sign != SIGN_UNKNOWN) {
        // (Of the others double-double would have told almost all.)
        if (sign == 0) {
            store_note_exact(s);
        }
        return sign;
    }
    if (store_keeps_minors(s)) {
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
