// Signs that single precision leaves open, where LANES work-items compute a cell together; built with -D WITH_EXACT=1.
//
// What double precision leaves open, too, is mostly a lattice's: there the coefficients of a column are integers of at most 62 bits times a
// power of two, and the determinant is the sum of six products of 2×2 minors, of which each lane computes one. Otherwise each lane
// goes through the stages of `sign_of_conflict` for its own vertex.

#import "generated/cell.cl"

// The side of a half-space on which a point is, in double precision.
INLINE uint side_of(Plane plane, V3 position, real radius) {
    const real value = (((plane.n.x * position.x) + (plane.n.y * position.y)) + (plane.n.z * position.z)) + plane.d;
    const real bound = (norm_1(plane.n) * radius) + ((REAL(4.0) * UNIT_ROUNDOFF) * fabs(plane.d));
    return (value > bound) ? MARK_KEEP : ((value < -bound) ? MARK_CONFLICT : MARK_UNCERTAIN);
}

// The side of vertex v of half-space k in double precision, of a place that is refined where it must be.
INLINE uint mark_in_double(Store *s, uint v, uint k) {
    V3 position;
    real radius;
    if (find_vertex_closely(s, unpacked(s->cell->triplet[v]), FINE_ENOUGH, &position, &radius) != COMPLETE) {
        return MARK_UNCERTAIN;
    }
    return side_of(s->cell->plane[k], position, radius);
}

#if SETTLES_CLOSELY
// The same in double-double, where that leaves it open.
OUTLINE uint settle_closely(CELL_SPACE Cell *cell, uint v, uint k, uint mark) {
    if (mark != MARK_UNCERTAIN) {
        return mark;
    }
    Store store;
    store.cell = cell;
    store.view = WHOLE;
    const uint its = mark_in_double(&store, v, k);
    if (its != MARK_UNCERTAIN) {
        return its;
    }
    const Triplet t = unpacked(cell->triplet[v]);
    const int sign = wide_sign(cell->plane[t.a], cell->plane[t.b], cell->plane[t.c], cell->plane[k]);
    return (sign == SIGN_UNKNOWN) ? MARK_UNCERTAIN : ((sign < 0) ? MARK_CONFLICT : MARK_KEEP);
}
#endif

#if SETTLES_CLOSELY || TAKES_CLOSELY
// A new vertex of nearly dependent planes.
OUTLINE uint place_closely(CELL_SPACE Cell *cell, uint v, uint is_fine) {
    Store store;
    store.cell = cell;
    store.view = WHOLE;
    store.is_fine = is_fine;
    const Triplet t = unpacked(cell->triplet[v]);
    V3 position;
    real radius;
    uint status = find_vertex_closely(&store, t, (is_fine != 0u) ? WITHIN_ROUNDING : ROUGH_ENOUGH, &position, &radius);
    if (status != COMPLETE) {
        status = wide_position(cell->plane[t.a], cell->plane[t.b], cell->plane[t.c], &position, &radius);
    }
    if (status == COMPLETE) {
        store_set_position(&store, v, position, radius);
    }
    return status;
}
#endif

#if WITH_EXACT

// The sum, or the difference, modulo 2²⁵⁶.
INLINE void add_to_sum(Product *sum, Product x) {
    sum->lo = wrapped_add(sum->lo, x.lo);
    const uint over = (sum->lo.hi < x.lo.hi) || ((sum->lo.hi == x.lo.hi) && (sum->lo.lo < x.lo.lo));
    sum->hi = wrapped_add(wrapped_add(sum->hi, x.hi), (Wrapped){ .lo = over, .hi = 0ul });
}
INLINE void take_from_sum(Product *sum, Product x) {
    const uint under = (sum->lo.hi < x.lo.hi) || ((sum->lo.hi == x.lo.hi) && (sum->lo.lo < x.lo.lo));
    sum->lo = wrapped_sub(sum->lo, x.lo);
    sum->hi = wrapped_sub(wrapped_sub(sum->hi, x.hi), (Wrapped){ .lo = under, .hi = 0ul });
}

// The product of two signed integers.
INLINE Product long_product(Wrapped a, Wrapped b) {
    const Wrapped across = (Wrapped){ .lo = a.lo * b.hi, .hi = mul_hi(a.lo, b.hi) };
    const Wrapped other = (Wrapped){ .lo = a.hi * b.lo, .hi = mul_hi(a.hi, b.lo) };
    Wrapped lo = (Wrapped){ .lo = a.lo * b.lo, .hi = mul_hi(a.lo, b.lo) };
    Wrapped hi = (Wrapped){ .lo = a.hi * b.hi, .hi = mul_hi(a.hi, b.hi) };
    lo.hi += across.lo;
    ulong carry = (lo.hi < across.lo) ? 1ul : 0ul;
    lo.hi += other.lo;
    carry += (lo.hi < other.lo) ? 1ul : 0ul;
    hi = wrapped_add(hi, (Wrapped){ .lo = across.hi, .hi = 0ul });
    hi = wrapped_add(hi, (Wrapped){ .lo = other.hi, .hi = 0ul });
    hi = wrapped_add(hi, (Wrapped){ .lo = carry, .hi = 0ul });
    // That was the product of the numbers without sign.
    const ulong of_a = (ulong)((long)a.hi >> 63);
    const ulong of_b = (ulong)((long)b.hi >> 63);
    hi = wrapped_sub(hi, (Wrapped){ .lo = b.lo & of_a, .hi = b.hi & of_a });
    hi = wrapped_sub(hi, (Wrapped){ .lo = a.lo & of_b, .hi = a.hi & of_b });
    return (Product){ .lo = lo, .hi = hi };
}

// a·d − b·c.
INLINE Wrapped long_minor(long a, long b, long c, long d) {
    const Wrapped p = (Wrapped){ .lo = (ulong)a * (ulong)d, .hi = (ulong)mul_hi(a, d) };
    const Wrapped q = (Wrapped){ .lo = (ulong)b * (ulong)c, .hi = (ulong)mul_hi(b, c) };
    return wrapped_sub(p, q);
}

// The magnitude of a number as bits that are in its order; of two words the upper.
INLINE uint upper_word(real x) { return (uint)(as_ulong(x) >> 32) & 0x7FFFFFFFu; }

// The power of two by which numbers of a column come below 2⁶²; where they may not be so scaled without rounding, `fits` becomes 0.
INLINE real long_scale(real a, real b, real c, real e, uint *fits) {
    const uint largest = max(max(upper_word(a), upper_word(b)), max(upper_word(c), upper_word(e)));
    const uint exponent = largest >> 20;
    *fits &= (exponent >= 64u) && (exponent <= 1080u);
    const real scale = as_double((ulong)(2107u - clamp(exponent, 64u, 1080u)) << 52);
    *fits &= (rint(a * scale) == (a * scale)) && (rint(b * scale) == (b * scale));
    *fits &= (rint(c * scale) == (c * scale)) && (rint(e * scale) == (e * scale));
    return scale;
}

INLINE uint nibble(uint nibbles, uint place) { return (nibbles >> (4u * place)) & 15u; }

// Term `turn` of the determinant of `[n | d]` of vertex v and half-space k: minors are below 2¹²⁵, and the sum of six products below
// 2²⁵³. Returns whether the numbers are such integers.
INLINE uint term_of(CELL_SPACE Cell *cell, uint v, uint k, uint turn, CELL_SPACE Product *term) {
    const Triplet t = unpacked(cell->triplet[v]);
    const Plane row[4] = { cell->plane[t.a], cell->plane[t.b], cell->plane[t.c], cell->plane[k] };
    uint fits = 1;
    const real x = long_scale(row[0].n.x, row[1].n.x, row[2].n.x, row[3].n.x, &fits);
    const real y = long_scale(row[0].n.y, row[1].n.y, row[2].n.y, row[3].n.y, &fits);
    const real z = long_scale(row[0].n.z, row[1].n.z, row[2].n.z, row[3].n.z, &fits);
    const real w = long_scale(row[0].d, row[1].d, row[2].d, row[3].d, &fits);
    // Laplace expansion along the first two columns, as in the wide stage: rows 01|23, 02|13, 03|12, 12|03, 13|02, 23|01.
    const ulong planes = ((ulong)t.a | ((ulong)t.b << 16)) | (((ulong)t.c << 32) | ((ulong)k << 48));
    const Plane p = cell->plane[(uint)(planes >> (16u * nibble(0x211000u, turn))) & 0xFFFFu];
    const Plane q = cell->plane[(uint)(planes >> (16u * nibble(0x332321u, turn))) & 0xFFFFu];
    const Plane r = cell->plane[(uint)(planes >> (16u * nibble(0x000112u, turn))) & 0xFFFFu];
    const Plane u = cell->plane[(uint)(planes >> (16u * nibble(0x123233u, turn))) & 0xFFFFu];
    const Wrapped left = long_minor(convert_long_rtz(p.n.x * x), convert_long_rtz(p.n.y * y), convert_long_rtz(q.n.x * x),
                                    convert_long_rtz(q.n.y * y));
    const Wrapped right = long_minor(convert_long_rtz(r.n.z * z), convert_long_rtz(r.d * w), convert_long_rtz(u.n.z * z),
                                     convert_long_rtz(u.d * w));
    *term = long_product(left, right);
    return fits;
}

// The sign of the sum of the six terms.
INLINE int sign_of_terms(CELL_SPACE const Product *term) {
    Product sum = term[0];
    take_from_sum(&sum, term[1]);
    add_to_sum(&sum, term[2]);
    add_to_sum(&sum, term[3]);
    take_from_sum(&sum, term[4]);
    add_to_sum(&sum, term[5]);
    if (((sum.lo.lo | sum.lo.hi) | (sum.hi.lo | sum.hi.hi)) == 0ul) {
        return 0;
    }
    return ((long)sum.hi.hi < 0l) ? -1 : 1;
}

// Settles the lanes' marks of vertices v for half-space k, of which some are uncertain, and stay so where the host has to decide; returns
// whether the lane's was settled by more than double precision and double-double.
OUTLINE uint settle_together(CELL_SPACE Cell *cell, uint lane, uint v, uint k, uint *mark) {
    Store store;
    store.cell = cell;
    store.view = WHOLE;
    store.exact = 0;
    if (*mark == MARK_UNCERTAIN) {
        *mark = mark_in_double(&store, v, k);
    }
    const uint is_open = *mark == MARK_UNCERTAIN;
    const uint open = lanes_with(is_open);
    const uint own = popcount(open & ((1u << lane) - 1u));
    const uint count = popcount(open);
    if (is_open != 0u) {
        cell->row[own] = v;
    }
    int sign = SIGN_UNKNOWN;
    for (uint first = 0; first < count; first += AT_ONCE) {
        const uint there = min(count - first, AT_ONCE);
        lanes_wait();
        for (uint item = lane; item < (there * TERMS); item += LANES) {
            const uint turn = item % TERMS;
            const uint fits = term_of(cell, cell->row[first + (item / TERMS)], k, turn, cell->term + item);
            if (turn == 0u) {
                cell->sign[item / TERMS] = (fits != 0u) ? 0 : SIGN_UNKNOWN;
            }
        }
        lanes_wait();
        if (((is_open != 0u) && (own >= first)) && (own < (first + there))) {
            sign = cell->sign[own - first];
            if (sign != SIGN_UNKNOWN) {
                sign = sign_of_terms(cell->term + (TERMS * (own - first)));
                store.exact = 1;
            }
        }
    }
    if (is_open != 0u) {
        if (sign == SIGN_UNKNOWN) {
            sign = sign_of_conflict(&store, v, k);
        }
        *mark = (sign == SIGN_UNKNOWN) ? MARK_UNCERTAIN : ((sign < 0) ? MARK_CONFLICT : MARK_KEEP);
    }
    lanes_wait();
    return store.exact;
}

// A new vertex of nearly dependent planes, as `find_vertex` finds it.
OUTLINE uint place_carefully(CELL_SPACE Cell *cell, uint v, uint *exact) {
    Store store;
    store.cell = cell;
    store.view = WHOLE;
    store.is_fine = 0;
    store.exact = 0;
    const uint status = place_vertex(&store, v);
    *exact |= store.exact;
    return status;
}
#endif
