// Generated from core/src/cell/quadrature.rs by `cargo xtask codegen`; do not edit.

// The integral of the store's function over the present polytope; `center` is the point that the tetrahedra share.
OUTLINE real integrate_function(Store *s, V3 center) {
    Wide sum = (Wide){ .hi = REAL(0.0), .lo = REAL(0.0) };
    for (uint v = 0; v < store_vertices(s); v++) {
        const Triplet t = store_triplet(s, v);
        add_fans_at_edge(s, v, t.a, t.b, center, &sum);
        add_fans_at_edge(s, v, t.b, t.c, center, &sum);
        add_fans_at_edge(s, v, t.c, t.a, center, &sum);
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
    for (uint v = 0; v < end; v++) {
        const Triplet t = store_triplet(s, v);
        if ((((t.a == f) || (t.b == f)) || (t.c == f)) && (((t.a == g) || (t.b == g)) || (t.c == g))) {
            return v;
        }
    }
    return end;
}

// Adds the integral over the tetrahedron (center, a, b, c) of sixfold signed volume `volume`.
OUTLINE void add_quadrature(Store *s, real volume, V3 a, V3 b, V3 c, V3 center, Wide *sum) {
    if (volume == REAL(0.0)) {
        return;
    }
    Wide mean = (Wide){ .hi = REAL(0.0), .lo = REAL(0.0) };
    for (uint q = 0; q < store_nodes(s); q++) {
        const Node node = store_node(s, q);
        const V3 way = add(add(scale(node.place.x, a), scale(node.place.y, b)), scale(node.place.z, c));
        add_compensated(node.weight * store_function(s, add(center, way)), &mean);
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
