// Generated from core/src/cell/node.rs by `cargo xtask codegen`; do not edit.

INLINE V3 least_corner(V3 a, V3 b) {
    return v3(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z));
}

INLINE V3 largest_corner(V3 a, V3 b) {
    return v3(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z));
}

// The box of a node's sites.
HOT NodeBox box_of_node(Store *s) {
    NodeBox bounds = (NodeBox){ .lo = store_sampled_place(s, 0), .hi = store_sampled_place(s, 0) };
    uint i = 1;
    while ((store_parts(s) == 0) && (i < store_sampled(s))) {
        bounds.lo = least_corner(bounds.lo, store_sampled_place(s, i));
        bounds.hi = largest_corner(bounds.hi, store_sampled_place(s, i));
        i += 1;
    }
    for (uint i = 0; i < store_parts(s); i++) {
        const NodeBox its = store_part_box(s, i);
        bounds.lo = least_corner(bounds.lo, its.lo);
        bounds.hi = largest_corner(bounds.hi, its.hi);
    }
    return bounds;
}

INLINE Symmetric square_of_matrix(Symmetric m) {
    return (Symmetric){ .xx = ((m.xx * m.xx) + (m.xy * m.xy)) + (m.zx * m.zx), .yy = ((m.xy * m.xy) + (m.yy * m.yy)) + (m.yz * m.yz), .zz = ((m.zx * m.zx) + (m.yz * m.yz)) + (m.zz * m.zz), .xy = ((m.xx * m.xy) + (m.xy * m.yy)) + (m.zx * m.yz), .yz = ((m.xy * m.zx) + (m.yy * m.yz)) + (m.yz * m.zz), .zx = ((m.zx * m.xx) + (m.yz * m.xy)) + (m.zz * m.zx) };
}

// A unit vector across the thinnest direction of the sampled sites: the longest of what their spread leaves of its trace, where the powers of that
// matrix lead.
HOT V3 thinnest_direction(Store *s) {
    const uint count = store_sampled(s);
    V3 mean = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    for (uint i = 0; i < count; i++) {
        mean = add(mean, store_sampled_place(s, i));
    }
    mean = scale(REAL(1.0) / ((real)count), mean);
    Symmetric spread = (Symmetric){ .xx = REAL(0.0), .yy = REAL(0.0), .zz = REAL(0.0), .xy = REAL(0.0), .yz = REAL(0.0), .zx = REAL(0.0) };
    for (uint i = 0; i < count; i++) {
        const V3 d = sub(store_sampled_place(s, i), mean);
        spread.xx += (d.x * d.x);
        spread.yy += (d.y * d.y);
        spread.zz += (d.z * d.z);
        spread.xy += (d.x * d.y);
        spread.yz += (d.y * d.z);
        spread.zx += (d.z * d.x);
    }
    Symmetric power = (Symmetric){ .xx = spread.yy + spread.zz, .yy = spread.zz + spread.xx, .zz = spread.xx + spread.yy, .xy = -spread.xy, .yz = -spread.yz, .zx = -spread.zx };
    for (uint _turn = 0; _turn < SQUARINGS; _turn++) {
        const real unit = REAL(1.0) / ((power.xx + power.yy) + power.zz);
        power = square_of_matrix((Symmetric){ .xx = power.xx * unit, .yy = power.yy * unit, .zz = power.zz * unit, .xy = power.xy * unit, .yz = power.yz * unit, .zx = power.zx * unit });
    }
    const V3 along = v3(((power.xx * REAL(0.577)) + (power.xy * REAL(0.5771))) + (power.zx * REAL(0.5772)), ((power.xy * REAL(0.577)) + (power.yy * REAL(0.5771))) + (power.yz * REAL(0.5772)), ((power.zx * REAL(0.577)) + (power.yz * REAL(0.5771))) + (power.zz * REAL(0.5772)));
    const real length = sqrt(v3_dot(along, along));
    // (Not a number where the sites are one.)
    if ((length > REAL(0.0)) && (length < LARGEST)) {
        return scale(REAL(1.0) / length, along);
    }
    return v3(REAL(1.0), REAL(0.0), REAL(0.0));
}

// The largest `n·x` of a box.
INLINE real largest_along(NodeBox bounds, V3 n) {
    return (larger(n.x * bounds.lo.x, n.x * bounds.hi.x) + larger(n.y * bounds.lo.y, n.y * bounds.hi.y)) + larger(n.z * bounds.lo.z, n.z * bounds.hi.z);
}

// A slab that holds a node's sites, whose box is known.
HOT NodeSlab slab_of_node(Store *s, NodeBox bounds) {
    const V3 normal = thinnest_direction(s);
    NodeSlab slab = (NodeSlab){ .normal = normal, .lo = LARGEST, .hi = -LARGEST, .largest = REAL(0.0) };
    uint i = 0;
    while ((store_parts(s) == 0) && (i < store_sampled(s))) {
        const real height = v3_dot(normal, store_sampled_place(s, i));
        slab.lo = smaller(slab.lo, height);
        slab.hi = larger(slab.hi, height);
        slab.largest = larger(slab.largest, store_sampled_weight(s, i));
        i += 1;
    }
    for (uint i = 0; i < store_parts(s); i++) {
        // By its box alone, or by its slab and what the box has across the slab's normal.
        const NodeSlab its = store_part_slab(s, i);
        const NodeBox its_box = store_part_box(s, i);
        const real share = v3_dot(normal, its.normal);
        const V3 rest = sub(normal, scale(share, its.normal));
        const real top = larger(share * its.lo, share * its.hi) + largest_along(its_box, rest);
        const real bottom = smaller(share * its.lo, share * its.hi) - largest_along(its_box, scale(-REAL(1.0), rest));
        slab.hi = larger(slab.hi, smaller(top, largest_along(its_box, normal)));
        slab.lo = smaller(slab.lo, larger(bottom, -largest_along(its_box, scale(-REAL(1.0), normal))));
        slab.largest = larger(slab.largest, its.largest);
    }
    const V3 farthest = v3(larger(fabs(bounds.lo.x), fabs(bounds.hi.x)), larger(fabs(bounds.lo.y), fabs(bounds.hi.y)), larger(fabs(bounds.lo.z), fabs(bounds.hi.z)));
    const real outward = FEW_ROUNDINGS_OF_SUM * norm_1(farthest);
    slab.lo = slab.lo - outward;
    slab.hi = slab.hi + outward;
    return slab;
}

// A polynomial without its constant at the way `u` from where it is about.
INLINE real rise(NodeWeights w, V3 u) {
    return (((w.slope.x + (w.curvature.x * u.x)) * u.x) + ((w.slope.y + (w.curvature.y * u.y)) * u.y)) + ((w.slope.z + (w.curvature.z * u.z)) * u.z);
}

HOT Rest rest_of_sampled(Store *s, V3 middle, NodeWeights w) {
    Rest rest = (Rest){ .top = -LARGEST, .bottom = LARGEST };
    for (uint i = 0; i < store_sampled(s); i++) {
        const real its = store_sampled_weight(s, i) - rise(w, sub(store_sampled_place(s, i), middle));
        rest.top = larger(rest.top, its);
        rest.bottom = smaller(rest.bottom, its);
    }
    return rest;
}

// The normal equations of what fits the sampled weights best, less a given curvature.
INLINE Equations equations_of_sampled(Store *s, V3 middle, real width, real base, V3 curvature) {
    Equations e = (Equations){ .matrix = { 0 }, .right = { 0 } };
    for (uint i = 0; i < store_sampled(s); i++) {
        const V3 way = sub(store_sampled_place(s, i), middle);
        const V3 u = scale(REAL(1.0) / width, way);
        const V3 curved = v3(curvature.x * way.x, curvature.y * way.y, curvature.z * way.z);
        const real w = (store_sampled_weight(s, i) - base) - v3_dot(curved, way);
        real terms[7] = { 0 };
        terms[0] = REAL(1.0);
        terms[1] = u.x;
        terms[2] = u.y;
        terms[3] = u.z;
        terms[4] = u.x * u.x;
        terms[5] = u.y * u.y;
        terms[6] = u.z * u.z;
        UNROLLED
        for (uint row = 0; row < QUADRATIC; row++) {
            UNROLLED
            for (uint column = 0; column < QUADRATIC; column++) {
                if (column >= row) {
                    e.matrix[((row * QUADRATIC) + column)] += (terms[row] * terms[column]);
                }
            }
            e.right[row] += (terms[row] * w);
        }
    }
    return e;
}

// The polynomial of so many coefficients, and where these are but a slope of a given curvature, that fits the sampled weights best, without its constant; all 0 where
// there is none.
HOT NodeWeights fit_of_sampled(Store *s, V3 middle, real width, real base, uint unknowns, V3 curvature) {
    Equations e = equations_of_sampled(s, middle, width, base, curvature);
    const real ridge = RIDGE_SHARE * ((real)store_sampled(s));
    UNROLLED
    for (uint row = 0; row < QUADRATIC; row++) {
        if (row > 0) {
            e.matrix[((row * QUADRATIC) + row)] += ridge;
        }
        // (Coefficients that are not asked for are 0.)
        if (row >= unknowns) {
            e.matrix[((row * QUADRATIC) + row)] = REAL(1.0);
            e.right[row] = REAL(0.0);
        }
        UNROLLED
        for (uint column = 0; column < QUADRATIC; column++) {
            if (column > row) {
                if (column >= unknowns) {
                    e.matrix[((row * QUADRATIC) + column)] = REAL(0.0);
                }
                e.matrix[((column * QUADRATIC) + row)] = e.matrix[((row * QUADRATIC) + column)];
            }
        }
    }
    // Gauss–Jordan; positive definite, so that no pivot is sought.
    UNROLLED
    for (uint pivot = 0; pivot < QUADRATIC; pivot++) {
        const real inverse = REAL(1.0) / e.matrix[((pivot * QUADRATIC) + pivot)];
        UNROLLED
        for (uint row = 0; row < QUADRATIC; row++) {
            if (row != pivot) {
                const real share = e.matrix[((row * QUADRATIC) + pivot)] * inverse;
                UNROLLED
                for (uint column = 0; column < QUADRATIC; column++) {
                    if (column >= pivot) {
                        e.matrix[((row * QUADRATIC) + column)] -= (share * e.matrix[((pivot * QUADRATIC) + column)]);
                    }
                }
                e.right[row] -= (share * e.right[pivot]);
            }
        }
    }
    real largest = REAL(0.0);
    UNROLLED
    for (uint row = 0; row < QUADRATIC; row++) {
        e.right[row] = e.right[row] / (e.matrix[((row * QUADRATIC) + row)] * width);
        if (row >= AFFINE) {
            e.right[row] = e.right[row] / width;
        }
        // (What is not a number is not below.)
        if (!(fabs(e.right[row]) < LARGEST)) {
            largest = LARGEST;
        }
    }
    NodeWeights fit = (NodeWeights){ .offset = REAL(0.0), .slope = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .curvature = v3(REAL(0.0), REAL(0.0), REAL(0.0)) };
    if (largest < LARGEST) {
        fit.slope = v3(e.right[1], e.right[2], e.right[3]);
        fit.curvature = curvature;
        if (unknowns == QUADRATIC) {
            fit.curvature = v3(e.right[4], e.right[5], e.right[6]);
        }
    }
    return fit;
}

// Adds the largest of a part's bound less the node's, along an axis, to `sum`; `middle` is the node's.
INLINE void add_largest(real lo, real hi, real middle, real slope, real curvature, real its_slope, real its_curvature, real *sum, real *size) {
    real least = REAL(0.0);
    add_least(lo, hi, middle, curvature, slope, its_slope, its_curvature, &least, size);
    *sum -= least;
}

// An upper bound of the weights of a node's sites, whose box is known: of least degree that is tighter by enough.
HOT NodeWeights weights_of_node(Store *s, NodeBox bounds) {
    const V3 middle = scale(REAL(0.5), add(bounds.lo, bounds.hi));
    const V3 halves = scale(REAL(0.5), sub(bounds.hi, bounds.lo));
    const real width = larger(larger(larger(halves.x, halves.y), halves.z), LEAST_WIDTH);
    NodeWeights best = (NodeWeights){ .offset = REAL(0.0), .slope = v3(REAL(0.0), REAL(0.0), REAL(0.0)), .curvature = v3(REAL(0.0), REAL(0.0), REAL(0.0)) };
    Rest rest = rest_of_sampled(s, middle, best);
    const real all = rest.top - rest.bottom;
    real range = all;
    // (Of weights that are large and differ by little, the ridge would leave more than they differ by.)
    const real base = REAL(0.5) * (rest.top + rest.bottom);
    uint degree = 1;
    while ((degree <= 2) && ((all > REAL(0.0)) && (store_sampled(s) >= ENOUGH_FOR_SLOPE))) {
        uint unknowns = AFFINE;
        V3 curvature = v3(REAL(0.0), REAL(0.0), REAL(0.0));
        if (degree == 2) {
            if (store_sampled(s) >= ENOUGH_FOR_CURVATURE) {
                unknowns = QUADRATIC;
            } else {
                curvature = store_curvature_above(s);
            }
        }
        if ((degree == 1) || ((unknowns == QUADRATIC) || (norm_1(curvature) > REAL(0.0)))) {
            const NodeWeights fit = fit_of_sampled(s, middle, width, base, unknowns, curvature);
            const Rest left = rest_of_sampled(s, middle, fit);
            if ((left.top - left.bottom) < (WORTH_A_DEGREE * range)) {
                rest = left;
                range = left.top - left.bottom;
                best = fit;
            }
        }
        degree += 1;
    }
    real top = rest.top;
    real size = REAL(0.0);
    uint i = 0;
    while ((store_parts(s) == 0) && (i < store_sampled(s))) {
        size = larger(size, store_sampled_weight(s, i));
        i += 1;
    }
    if (store_parts(s) > 0) {
        top = -LARGEST;
    }
    while (i < store_parts(s)) {
        const NodeWeights its = store_part_weights(s, i);
        const NodeBox its_box = store_part_box(s, i);
        const V3 lo = its_box.lo;
        const V3 hi = its_box.hi;
        real its_top = its.offset;
        real its_size = fabs(its.offset);
        add_largest(lo.x, hi.x, middle.x, best.slope.x, best.curvature.x, its.slope.x, its.curvature.x, &its_top, &its_size);
        add_largest(lo.y, hi.y, middle.y, best.slope.y, best.curvature.y, its.slope.y, its.curvature.y, &its_top, &its_size);
        add_largest(lo.z, hi.z, middle.z, best.slope.z, best.curvature.z, its.slope.z, its.curvature.z, &its_top, &its_size);
        top = larger(top, its_top);
        size = larger(size, its_size);
        i += 1;
    }
    // The middle is rounded, here and where the bound is evaluated.
    const V3 steep = v3(fabs(best.slope.x) + (REAL(2.0) * (fabs(best.curvature.x) * halves.x)), fabs(best.slope.y) + (REAL(2.0) * (fabs(best.curvature.y) * halves.y)), fabs(best.slope.z) + (REAL(2.0) * (fabs(best.curvature.z) * halves.z)));
    const real off = (REAL(4.0) * UNIT_ROUNDOFF) * (((steep.x * larger(fabs(bounds.lo.x), fabs(bounds.hi.x))) + (steep.y * larger(fabs(bounds.lo.y), fabs(bounds.hi.y)))) + (steep.z * larger(fabs(bounds.lo.z), fabs(bounds.hi.z))));
    size += ((fabs(top) + (steep.x * halves.x)) + ((steep.y * halves.y) + (steep.z * halves.z)));
    best.offset = (top + (FEW_ROUNDINGS_OF_SUM * size)) + off;
    return best;
}
