// Generated from core/src/cell/integrate.rs by `cargo xtask codegen`; do not edit.

// Whether a cell's volume exceeds what rounding alone can make of nothing.
//
// For a volume that is positive the bound of one of the pieces that it is made of decides: the bounds of all pieces together are far
// above what rounding does, and would swallow thin slabs that the sum over all cells misses. What is negative is believed only beyond
// that sum of bounds, which no rounding exceeds (16 times what it did in ten thousand cells of volume 0): few surfaces go around anything the
// wrong way, but those that fold over themselves do so in slabs as thin as that.
HOT bool volume_is_above_bound(CellSums sums) {
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
    // What the vertices of earlier blocks have added.
    CellSums before = (CellSums){ 0 };
    const bool is_in_blocks = store_sums_in_blocks(s) && (store_vertices(s) > BLOCK_OF_VERTICES);
    for (uint v = 0; v < store_vertices(s); v++) {
        if ((is_in_blocks && (v != 0)) && ((v & (BLOCK_OF_VERTICES - 1)) == 0)) {
            before = both_sums(before, part);
            part = (CellSums){ 0 };
        }
        const Triplet t = store_triplet(s, v);
        const Corner at = (Corner){ .triplet = t, .position = sub(store_position(s, v), center), .distance = norm_1(store_position(s, v)) + reach, .radius = radius_at(store_radius(s, v), reach) };
        Side f = side(s, t.a, center);
        if (store_is_short(s)) {
            ROLLED
            for (uint edge = 0; edge < 3; edge++) {
                uint next = t.a;
                if (edge == 0) {
                    next = t.b;
                } else if (edge == 1) {
                    next = t.c;
                }
                const Side g = side(s, next, center);
                if (add_edge(s, f, g, at, weight, center, flags, &part) != COMPLETE) {
                    return UNCERTAIN;
                }
                f = g;
            }
        } else {
            const Side b = side(s, t.b, center);
            const Side c = side(s, t.c, center);
            if (add_edge(s, f, b, at, weight, center, flags, &part) != COMPLETE) {
                return UNCERTAIN;
            }
            if (add_edge(s, b, c, at, weight, center, flags, &part) != COMPLETE) {
                return UNCERTAIN;
            }
            if (add_edge(s, c, f, at, weight, center, flags, &part) != COMPLETE) {
                return UNCERTAIN;
            }
        }
    }
    if (is_in_blocks) {
        part = both_sums(before, part);
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

// The sums of two sets of pieces, or of vertices.
OUTLINE CellSums both_sums(CellSums a, CellSums b) {
    return (CellSums){ .volume = a.volume + b.volume, .first = add(a.first, b.first), .second_diagonal = add(a.second_diagonal, b.second_diagonal), .second_mixed = add(a.second_mixed, b.second_mixed), .integral = a.integral + b.integral, .rounding = a.rounding + b.rounding, .largest_rounding = larger(a.largest_rounding, b.largest_rounding), .boundary_area = a.boundary_area + b.boundary_area, .boundary_moment = add(a.boundary_moment, b.boundary_moment), .boundary_vector = add(a.boundary_vector, b.boundary_vector), .boundary_flux = a.boundary_flux + b.boundary_flux };
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
    if (foot_on_edge(s, f, g, center, (flags & FACETS) != 0, &foot, &off) != COMPLETE) {
        return UNCERTAIN;
    }
    const V3 spoke = spoke_of(foot, at.position);
    add_tetrahedron(v3_dot(g.foot, spoke), g.foot, foot, at.position, flags, part);
    add_tetrahedron(-v3_dot(f.foot, spoke), f.foot, foot, at.position, flags, part);
    part->rounding = part->rounding + rounding_across(at.distance, norm_1(spoke));
    if ((flags & FACETS) != 0) {
        FacetSum sum = store_facet_at(s, at.triplet, g.index);
        add_triangle(g, foot, off, at, -weight, center, store_sums_areas_alone(s), &sum);
        store_set_facet_at(s, at.triplet, g.index, sum);
        sum = store_facet_at(s, at.triplet, f.index);
        add_triangle(f, foot, off, at, weight, center, store_sums_areas_alone(s), &sum);
        store_set_facet_at(s, at.triplet, f.index, sum);
    }
    return COMPLETE;
}

// `I×v`, but the foot is at right angles to the edge: nothing cancels, however far away a small piece is.
INLINE V3 spoke_of(V3 foot, V3 position) {
    return v3_cross(foot, sub(position, foot));
}

// What rounding across a vertex's planes does to the volumes of one of its edges.
INLINE real rounding_across(real distance, real spoke) {
    return ((ROUNDINGS_ACROSS * UNIT_ROUNDOFF) * distance) * spoke;
}

// The foot of the perpendicular from the reference point to the line of planes f and g:
// `I = (−d_f n_g×x − d_g x×n_f) / |x|²`, `x = n_f×n_g`; and, if that `is_bounded`, how far it may be off that line.
// (Bounds are of facets alone; their root and quotient are 3 % of a white cell on the CPU.)
//
// `x` is off by 3u over the sine of the angle between the planes, and the foot by as much of its length, however far away the planes are:
// what two nearly parallel planes have in common cancels. Each step of refinement multiplies that by itself, until roundings are left.
INLINE uint foot_on_edge(Store *s, Side f, Side g, V3 center, bool is_bounded, V3 *foot, real *off) {
    const V3 direction = v3_cross(f.n, g.n);
    const real square = v3_dot(direction, direction);
    const real whole = f.square * g.square;
    if (!(square > (NEARLY_PARALLEL * whole))) {
        const uint status = store_exact_foot(s, f.index, g.index, center, foot);
        *off = UNIT_ROUNDOFF * norm_1(*foot);
        return status;
    }
    const real per_square = REAL(1.0) / square;
    *foot = foot_by(f.n, f.d, g.n, g.d, direction, per_square);
    if (is_plain(square, whole)) {
        if (is_bounded) {
            *off = off_plain_foot(*foot, per_square * whole, center);
        }
        return COMPLETE;
    }
    *off = (ROUNDINGS_OF_FOOT * UNIT_ROUNDOFF) * norm_1(*foot);
    const V3 to_f = scale(-per_square, v3_cross(g.n, direction));
    const V3 to_g = scale(-per_square, v3_cross(direction, f.n));
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

// The foot by the planes' normals and offsets, the normals' product and one over its square.
INLINE V3 foot_by(V3 n_f, real d_f, V3 n_g, real d_g, V3 direction, real per_square) {
    const V3 to_f = scale(-per_square, v3_cross(n_g, direction));
    const V3 to_g = scale(-per_square, v3_cross(direction, n_f));
    return add(scale(d_f, to_f), scale(d_g, to_g));
}

// Whether the foot on the edge of two planes needs no refinement: `square` as above, `whole` the product of the normals' squares.
INLINE bool is_plain(real square, real whole) {
    return square >= (WORTH_REFINING_FOOT * whole);
}

// How far such a foot may be off its line, where one over the square of the angle's sine is that.
INLINE real off_plain_foot(V3 foot, real per_sine_square, V3 center) {
    const real amplified = UNIT_ROUNDOFF * sqrt(per_sine_square);
    return amplified * ((ROUNDINGS_OF_FOOT * norm_1(foot)) + (ROUNDINGS_OF_OFFSET * norm_1(center)));
}

// How far a vertex whose planes reach so far is off, at most, where its triangles are.
INLINE real radius_at(real radius, real reach) {
    return radius + ((ROUNDINGS_OF_SURFACE * UNIT_ROUNDOFF) * reach);
}

// The tetrahedron (center, h, i, v): first moment `U(h+i+v)/4`.
INLINE Piece piece_of(real volume, V3 h, V3 i, V3 v) {
    const real bound = (ROUNDINGS * UNIT_ROUNDOFF) * fabs(volume);
    return (Piece){ .volume = volume, .rounding = bound, .first = scale(volume, add(add(h, i), v)) };
}

INLINE void add_piece(Piece piece, CellSums *part) {
    part->volume = part->volume + piece.volume;
    part->rounding = part->rounding + piece.rounding;
    part->first = add(part->first, piece.first);
}

// Adds the tetrahedron (center, h, i, v) of sixfold signed volume `volume`; second moment `U(hhᵀ+iiᵀ+vvᵀ+ssᵀ)/20`, `s = h+i+v`.
INLINE void add_tetrahedron(real volume, V3 h, V3 i, V3 v, uint flags, CellSums *part) {
    add_piece(piece_of(volume, h, i, v), part);
    if ((flags & SECOND_MOMENTS) != 0) {
        const V3 sum = add(add(h, i), v);
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
    bool inside = 1;
    for (uint f = 0; f < store_planes(s); f++) {
        if (store_plane(s, f).d < REAL(0.0)) {
            inside = 0;
        }
    }
    V3 mean = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    if (inside) {
        return mean;
    }
    for (uint v = 0; v < store_vertices(s); v++) {
        mean = add(mean, store_position(s, v));
    }
    return scale(REAL(1.0) / ((real)store_vertices(s)), mean);
}
