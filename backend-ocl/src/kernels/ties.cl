// The sign of a determinant that double-double could not tell from 0, by integers that wrap: `sign_of_tie` of exact.rs says why it is right.

#import "generated/cell_types.cl"

// An integer modulo 2¹²⁸.
typedef struct {
    ulong lo;
    ulong hi;
} Wrapped;

INLINE Wrapped wrapped_add(Wrapped a, Wrapped b) {
    const ulong lo = a.lo + b.lo;
    return (Wrapped){ .lo = lo, .hi = (a.hi + b.hi) + ((lo < a.lo) ? 1ul : 0ul) };
}

INLINE Wrapped wrapped_sub(Wrapped a, Wrapped b) {
    return (Wrapped){ .lo = a.lo - b.lo, .hi = (a.hi - b.hi) - ((a.lo < b.lo) ? 1ul : 0ul) };
}

INLINE Wrapped wrapped_mul(Wrapped a, Wrapped b) {
    return (Wrapped){ .lo = a.lo * b.lo, .hi = (mul_hi(a.lo, b.lo) + (a.lo * b.hi)) + (a.hi * b.lo) };
}

// ± m·2ˢ, or 0 where s is 128 or more.
INLINE Wrapped wrapped_number(ulong m, uint s, uint is_negative) {
    Wrapped x = (Wrapped){ .lo = 0ul, .hi = 0ul };
    if (s == 0u) {
        x.lo = m;
    } else if (s < 64u) {
        x.lo = m << s;
        x.hi = m >> (64u - s);
    } else if (s < 128u) {
        x.hi = m << (s - 64u);
    }
    return (is_negative != 0u) ? wrapped_sub((Wrapped){ .lo = 0ul, .hi = 0ul }, x) : x;
}

// x = ± m·2ᵉ with m odd, or 0.
INLINE ulong odd_part(double x, int *e) {
    const ulong bits = as_ulong(x);
    const int exponent = (int)((bits >> 52) & 0x7fful);
    const ulong fraction = bits & 0xffffffffffffful;
    const ulong m = (exponent != 0) ? (fraction | (1ul << 52)) : fraction;
    if (m == 0ul) {
        *e = 0;
        return 0ul;
    }
    const int zeros = 63 - (int)clz(m & (0ul - m));
    *e = ((exponent != 0) ? (exponent - 1075) : -1074) + zeros;
    return m >> zeros;
}

// One column of the determinant as integers times a power of two: `unit` and `top` as in exact.rs; 0 where all are zero.
INLINE uint integer_column(double a, double b, double c, double e, Wrapped *column, int *unit, int *top) {
    const double x[4] = { a, b, c, e };
    ulong m[4];
    int exponent[4];
    *unit = INT_MAX;
    *top = INT_MIN;
    for (uint row = 0; row < 4u; row++) {
        m[row] = odd_part(x[row], exponent + row);
        if (m[row] != 0ul) {
            *unit = min(*unit, exponent[row]);
            *top = max(*top, exponent[row] + (64 - (int)clz(m[row])));
        }
    }
    for (uint row = 0; row < 4u; row++) {
        const uint shift = (m[row] != 0ul) ? (uint)(exponent[row] - *unit) : 0u;
        column[row] = wrapped_number(m[row], shift, x[row] < 0.0);
    }
    return *unit != INT_MAX;
}

INLINE Wrapped wrapped_minor(Wrapped a, Wrapped b, Wrapped c, Wrapped d) {
    return wrapped_sub(wrapped_mul(a, d), wrapped_mul(b, c));
}

OUTLINE int sign_of_tie(Plane a, Plane b, Plane c, Plane e) {
    Wrapped x[4];
    Wrapped y[4];
    Wrapped z[4];
    Wrapped w[4];
    int unit[4];
    int top[4];
    if (((integer_column(a.n.x, b.n.x, c.n.x, e.n.x, x, unit, top) == 0u)
         || (integer_column(a.n.y, b.n.y, c.n.y, e.n.y, y, unit + 1, top + 1) == 0u))
        || ((integer_column(a.n.z, b.n.z, c.n.z, e.n.z, z, unit + 2, top + 2) == 0u)
            || (integer_column(a.d, b.d, c.d, e.d, w, unit + 3, top + 3) == 0u))) {
        return 0;
    }
    const int units = (unit[0] + unit[1]) + (unit[2] + unit[3]);
    const int tops = (top[0] + top[1]) + (top[2] + top[3]);
    if ((units < -800) || ((tops - units) > 220)) {
        return SIGN_UNKNOWN;
    }
    // Laplace expansion along the first two columns, as in the wide stage.
    Wrapped sum = wrapped_mul(wrapped_minor(x[0], y[0], x[1], y[1]), wrapped_minor(z[2], w[2], z[3], w[3]));
    sum = wrapped_sub(sum, wrapped_mul(wrapped_minor(x[0], y[0], x[2], y[2]), wrapped_minor(z[1], w[1], z[3], w[3])));
    sum = wrapped_add(sum, wrapped_mul(wrapped_minor(x[0], y[0], x[3], y[3]), wrapped_minor(z[1], w[1], z[2], w[2])));
    sum = wrapped_add(sum, wrapped_mul(wrapped_minor(x[1], y[1], x[2], y[2]), wrapped_minor(z[0], w[0], z[3], w[3])));
    sum = wrapped_sub(sum, wrapped_mul(wrapped_minor(x[1], y[1], x[3], y[3]), wrapped_minor(z[0], w[0], z[2], w[2])));
    sum = wrapped_add(sum, wrapped_mul(wrapped_minor(x[2], y[2], x[3], y[3]), wrapped_minor(z[0], w[0], z[1], w[1])));
    if ((sum.lo | sum.hi) == 0ul) {
        return 0;
    }
    return ((sum.hi >> 63) != 0ul) ? -1 : 1;
}
