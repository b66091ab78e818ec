// Generated from core/src/cell/facet.rs by `cargo xtask codegen`; do not edit.

// Whether a facet's area exceeds what rounding alone can make of nothing.
OUTLINE bool facet_is_above_bound(FacetSum sum) {
    return (sum.area > (SHARE_OF_NO_FACET * sum.rounding)) || (sum.area < -(BOUNDS_OF_NEGATIVE * sum.rounding));
}

// Adds the triangle (H, I, v) to a facet of plane `f`: signed area `sign·½ (I − H)×(v − H)·n/|n|`, moment
// `area·(H + I + v)/3` but where areas alone are summed. The foot I is off its edge by up to `off`.
//
// What I and v are off counts with the way between them: the two triangles of a vertex lose its error times the way between their feet,
// those of an edge the foot's times the edge's length. The vertex has been rounded once more on its way to the reference point.
INLINE void add_triangle(Side f, V3 foot, real off, Corner at, real sign, V3 center, bool area_alone, FacetSum *sum) {
    const real area = area_of_triangle(f, per_length(f), sub(foot, f.foot), sub(at.position, f.foot), sign);
    sum->area = sum->area + area;
    if (!area_alone) {
        sum->moment = add(sum->moment, moment_of_triangle(f, foot, at.position, center, area));
    }
    sum->rounding = larger(sum->rounding, rounding_of_triangle(f, foot, off, at.position, at.radius));
}

// `area·(H + I + v)/3`.
INLINE V3 moment_of_triangle(Side f, V3 foot, V3 position, V3 center, real area) {
    return scale(area, add(scale(REAL(1.0) / REAL(3.0), add(add(f.foot, foot), position)), center));
}

// What rounding may have added to its area, where the vertex is off by up to `radius`.
INLINE real rounding_of_triangle(Side f, V3 foot, real off, V3 position, real radius) {
    const V3 to_foot = sub(foot, f.foot);
    const V3 to_vertex = sub(position, f.foot);
    const real lost = (ROUNDINGS_OF_TRIANGLE * UNIT_ROUNDOFF) * (norm_1(to_foot) * norm_1(to_vertex));
    const real moved = (radius + off) + (UNIT_ROUNDOFF * norm_1(position));
    return lost + (moved * norm_1(sub(position, foot)));
}

// 1/|n|.
INLINE real per_length(Side f) {
    return REAL(1.0) / sqrt(f.square);
}

// `sign·½ (I − H)×(v − H)·n/|n|`, given 1/|n| and the two sides at H.
INLINE real area_of_triangle(Side f, real per_length, V3 to_foot, V3 to_vertex, real sign) {
    const V3 normal = v3_cross(to_foot, to_vertex);
    return ((REAL(0.5) * sign) * v3_dot(normal, f.n)) * per_length;
}

// The sums of the facet of plane `index` alone; `reach` as of `integrate`.
OUTLINE uint integrate_facet(Store *s, uint index, V3 center, real reach, FacetSum *sum) {
    *sum = (FacetSum){ 0 };
    const Side f = side(s, index, center);
    for (uint v = 0; v < store_vertices(s); v++) {
        Triplet t = store_triplet(s, v);
        if (t.b == index) {
            t = (Triplet){ .a = t.b, .b = t.c, .c = t.a };
        } else if (t.c == index) {
            t = (Triplet){ .a = t.c, .b = t.a, .c = t.b };
        }
        if (t.a == index) {
            // Vertex (f, b, c): of its edges (f, b) begins here and (c, f) ends here.
            const Corner at = (Corner){ .triplet = t, .position = sub(store_position(s, v), center), .distance = norm_1(store_position(s, v)) + reach, .radius = radius_at(store_radius(s, v), reach) };
            const Side b = side(s, t.b, center);
            const Side c = side(s, t.c, center);
            V3 foot = v3(REAL(0.0), REAL(0.0), REAL(0.0));
            real off = REAL(0.0);
            if (foot_on_edge(s, f, b, center, 1, &foot, &off) != COMPLETE) {
                return UNCERTAIN;
            }
            add_triangle(f, foot, off, at, REAL(1.0), center, 0, sum);
            if (foot_on_edge(s, c, f, center, 1, &foot, &off) != COMPLETE) {
                return UNCERTAIN;
            }
            add_triangle(f, foot, off, at, -REAL(1.0), center, 0, sum);
        }
    }
    return COMPLETE;
}

// Sets the facets' sums to zero.
OUTLINE void reset_facets(Store *s, uint flags) {
    for (uint f = 0; f < store_planes(s); f++) {
        store_set_facet(s, f, (FacetSum){ 0 });
        if ((flags & FACET_SECOND_MOMENTS) != 0) {
            store_set_facet_second(s, f, (FacetSecond){ 0 });
        }
    }
}

// Whether the parts of the boundary within the cell are to be summed.
INLINE bool asks_for_boundary(uint flags) {
    return (flags & (FACETS | FACET_AREAS)) == FACETS;
}

// Adds a facet of the half-space `plane`, which bounds the domain, to the boundary's sums; `outward` is by how much the winding number is
// larger in the half-space: +1 where it keeps the domain's inside, −1 where it keeps its outside.
OUTLINE void add_boundary(FacetSum sum, Plane plane, real outward, CellSums *sums) {
    // The surface has no negative area.
    if (!facet_is_above_bound(sum) || (sum.area < REAL(0.0))) {
        return;
    }
    const real share = (outward * sum.area) / sqrt(v3_dot(plane.n, plane.n));
    sums->boundary_area = sums->boundary_area + (fabs(outward) * sum.area);
    sums->boundary_moment = add(sums->boundary_moment, scale(fabs(outward), sum.moment));
    sums->boundary_vector = sub(sums->boundary_vector, scale(share, plane.n));
    sums->boundary_flux = sums->boundary_flux + (share * plane.d);
}

// Adds the triangles that `integrate` adds to the facets to their second moments. By itself: few ask for it, and what all do is not to pay
// for that.
OUTLINE uint add_facet_seconds(Store *s, real weight, V3 center) {
    for (uint v = 0; v < store_vertices(s); v++) {
        const Triplet t = store_triplet(s, v);
        const V3 position = sub(store_position(s, v), center);
        const Side a = side(s, t.a, center);
        const Side b = side(s, t.b, center);
        const Side c = side(s, t.c, center);
        if (add_edge_second(s, a, b, position, weight, center) != COMPLETE) {
            return UNCERTAIN;
        }
        if (add_edge_second(s, b, c, position, weight, center) != COMPLETE) {
            return UNCERTAIN;
        }
        if (add_edge_second(s, c, a, position, weight, center) != COMPLETE) {
            return UNCERTAIN;
        }
    }
    return COMPLETE;
}

// Adds the two triangles of one vertex and its edge (f, g).
OUTLINE uint add_edge_second(Store *s, Side f, Side g, V3 position, real weight, V3 center) {
    V3 foot = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real off = REAL(0.0);
    if (foot_on_edge(s, f, g, center, 0, &foot, &off) != COMPLETE) {
        return UNCERTAIN;
    }
    add_triangle_second(s, g, foot, position, -weight);
    add_triangle_second(s, f, foot, position, weight);
    return COMPLETE;
}

// Adds the triangle (H, I, v) to the second moments of the facet of plane `f`: `area·(HHᵀ + IIᵀ + vvᵀ + ssᵀ)/12`, `s = H + I + v`,
// about the point that all are relative to.
OUTLINE void add_triangle_second(Store *s, Side f, V3 foot, V3 position, real sign) {
    const real share = area_of_triangle(f, per_length(f), sub(foot, f.foot), sub(position, f.foot), sign) / REAL(12.0);
    const V3 sum = add(add(f.foot, foot), position);
    FacetSecond second = store_facet_second(s, f.index);
    second.diagonal = add(second.diagonal, scale(share, second_diagonal(f.foot, foot, position, sum)));
    second.mixed = add(second.mixed, scale(share, second_mixed(f.foot, foot, position, sum)));
    store_set_facet_second(s, f.index, second);
}

// Moves the facets' second moments from `center` to the facets' own barycenters: `∫ (x − b)(x − b)ᵀ = ∫ xxᵀ − mmᵀ/A`, `m = ∫ x`.
OUTLINE void center_facets(Store *s, V3 center) {
    for (uint f = 0; f < store_planes(s); f++) {
        const FacetSum sum = store_facet(s, f);
        if (facet_is_above_bound(sum)) {
            const V3 m = sub(sum.moment, scale(sum.area, center));
            const V3 b = scale(REAL(1.0) / sum.area, m);
            FacetSecond second = store_facet_second(s, f);
            second.diagonal = sub(second.diagonal, v3(m.x * b.x, m.y * b.y, m.z * b.z));
            second.mixed = sub(second.mixed, v3(m.x * b.y, m.x * b.z, m.y * b.z));
            store_set_facet_second(s, f, second);
        }
    }
}
