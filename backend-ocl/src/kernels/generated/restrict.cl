// Generated from core/src/cell/restrict.rs by `cargo xtask codegen`; do not edit.

// The integrals of the finished cell over the container: the domain where there is one, weighted by its winding number,
// else the initial box. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again; with `interior_only`, `BOUNDARY`
// where the cell's voxels hold triangles.
//
// With the flag `FACETS` the facets' sums of the half-spaces are those of the restricted cell afterwards, with
// `FACET_SECOND_MOMENTS` their second moments too; with `FACET_AREAS` no more of them than areas is told.
OUTLINE uint integrate_cell(Store *s, uint flags, uint interior_only, CellSums *sums) {
    *sums = (CellSums){ 0 };
    compact_planes(s);
    const V3 center = reference_point(s);
    const uint status = integrate_restricted(s, center, flags, interior_only, sums);
    if ((status == COMPLETE) && ((flags & FACET_SECOND_MOMENTS) != 0)) {
        center_facets(s, center);
    }
    return status;
}

// The same about a given point.
OUTLINE uint integrate_restricted(Store *s, V3 center, uint flags, uint interior_only, CellSums *sums) {
    if (!store_has_domain(s)) {
        const uint status = integrate_whole(s, REAL(1.0), center, flags, sums);
        if ((status == COMPLETE) && asks_for_boundary(flags)) {
            add_box_faces(s, sums);
        }
        return status;
    }
    Voxel lo = (Voxel){ .i = 0, .j = 0, .k = 0 };
    Voxel hi = (Voxel){ .i = 0, .j = 0, .k = 0 };
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    outer_box_of_cell(s, &low, &high);
    voxels_of_box(s, low, high, &lo, &hi);
    const int winding = store_winding(s, lo);
    // Where no triangle is near or meets the cell, the winding number is the same all over it.
    if (store_surface_voxels(s, lo, hi) == 0) {
        return integrate_whole(s, (real)winding, center, flags, sums);
    }
    int inner = winding;
    if (surface_passes_by(s, low, high, lo, hi, &inner)) {
        return integrate_whole(s, (real)inner, center, flags, sums);
    }
    if (interior_only != 0) {
        return BOUNDARY;
    }
    // Room for the four planes of a cone, whose indices must not move.
    if ((store_cap_p(s) - store_planes(s)) < 4) {
        return P_FULL;
    }
    if ((flags & FACETS) != 0) {
        reset_facets(s, flags);
    }
    // (What a rule of quadrature leaves of a function that is no polynomial does not cancel: a Gaussian in a torus, 30 sites, degree 3, was 7e-3 off by the whole of cells less what is
    // outside, 8e-4 so.)
    Voxel apex = lo;
    if ((flags & INTEGRAL) == 0) {
        apex = nearest_corner(s, add(store_site(s), center), lo, hi);
    }
    const int of_apex = store_winding(s, apex);
    if (of_apex != 0) {
        const uint status = integrate(s, (real)of_apex, center, REAL(0.0), flags, sums);
        if (status != COMPLETE) {
            return status;
        }
    }
    bool touched = 0;
    const uint cones = add_cones(s, lo, hi, apex, center, flags, &touched, sums);
    if (cones != COMPLETE) {
        return cones;
    }
    if (!touched) {
        // No piece ends at its triangle: the surface does not meet the cell, and the winding number within is the nearest
        // integer to the quotient.
        CellSums whole = (CellSums){ 0 };
        const uint status = integrate(s, REAL(1.0), center, REAL(0.0), VOLUME_ONLY, &whole);
        if (status != COMPLETE) {
            return status;
        }
        if (!volume_is_above_bound(whole)) {
            return EMPTY;
        }
        if (is_undivided(*sums, whole, &inner)) {
            *sums = (CellSums){ 0 };
            return integrate_whole(s, (real)inner, center, flags, sums);
        }
    }
    return settle(s, sums);
}

// The integrals of the whole cell, times `weight`.
OUTLINE uint integrate_whole(Store *s, real weight, V3 center, uint flags, CellSums *sums) {
    if (weight == REAL(0.0)) {
        return EMPTY;
    }
    if ((flags & FACETS) != 0) {
        reset_facets(s, flags);
    }
    const uint status = integrate(s, weight, center, REAL(0.0), flags, sums);
    if (status != COMPLETE) {
        return status;
    }
    return settle(s, sums);
}

// The faces of the initial box are the boundary where there is no domain.
OUTLINE void add_box_faces(Store *s, CellSums *sums) {
    for (uint f = 0; f < store_planes(s); f++) {
        if (store_tag(s, f) == TAG_BOX) {
            add_boundary(store_facet(s, f), store_plane(s, f), REAL(1.0), sums);
        }
    }
}

// Subtracts the signed integrals of the cell's intersection with the truncated cone from corner `apex` of every triangle near it; `touched` becomes true
// where a piece ends at its triangle. (A call of its own: inlined, cells inside the bunny take 2 % more instructions.)
OUTLINE uint add_cones(Store *s, Voxel lo, Voxel hi, Voxel apex, V3 center, uint flags, bool *touched, CellSums *sums) {
    store_save(s);
    uint k = lo.k;
    while (k <= hi.k) {
        uint j = lo.j;
        while (j <= hi.j) {
            // By rows: of a cell with 3,600 pieces, added one to the next, rounding was 1e-14 of the volume.
            CellSums row = (CellSums){ 0 };
            const bool is_empty = row_is_empty(s, lo, hi, j, k);
            uint i = lo.i;
            while ((i <= hi.i) && !is_empty) {
                const Voxel voxel = (Voxel){ .i = i, .j = j, .k = k };
                const uint end = store_list_end(s, voxel);
                for (uint entry = store_list_begin(s, voxel); entry < end; entry++) {
                    const uint t = store_list_entry(s, entry);
                    if (is_first_voxel(store_lowest_voxel(s, t), lo, voxel)) {
                        const uint beyond = lies_beyond(s, t, apex);
                        if (beyond != CONE_BEYOND) {
                            const uint status = add_cone(s, t, apex, center, flags, touched, &row);
                            if (status != COMPLETE) {
                                return status;
                            }
                        }
                        if ((beyond == NONE_BEYOND) && asks_for_boundary(flags)) {
                            const uint surface = add_surface(s, t, apex, center, &row);
                            if (surface != COMPLETE) {
                                return surface;
                            }
                        }
                    }
                }
                i += 1;
            }
            if (!is_empty) {
                *sums = both_sums(*sums, row);
            }
            j += 1;
        }
        k += 1;
    }
    return COMPLETE;
}

// Subtracts the signed integrals of the cell's intersection with the truncated cone over triangle `t` from corner `apex`.
OUTLINE uint add_cone(Store *s, uint t, Voxel apex, V3 center, uint flags, bool *touched, CellSums *sums) {
    TruncatedCone cone = no_cone();
    if (make_cone(s, t, apex, &cone) != COMPLETE) {
        return UNCERTAIN;
    }
    if (cone.sign == REAL(0.0)) {
        // The cone is flat, but the surface may still divide the cell.
        *touched = 1;
        return COMPLETE;
    }
    // Cull before cutting: most candidates have the whole cell on the wrong side of one of the four planes.
    const uint base = store_planes(s);
    if (((all_in_conflict(s, base, cone.end) || all_in_conflict(s, base, cone.side_0)) || all_in_conflict(s, base, cone.side_1)) || all_in_conflict(s, base, cone.side_2)) {
        return COMPLETE;
    }
    uint status = clip_by_sides(s, cone);
    if (status == COMPLETE) {
        status = clip(s, cone.end, TAG_TRIANGLE);
        if (status == CUT) {
            *touched = 1;
        }
        if ((status == CUT) || (status == UNTOUCHED)) {
            status = integrate(s, -cone.jump, center, cone.reach, flags, sums);
        }
    }
    store_restore(s);
    store_set_planes(s, base);
    if (status == EMPTY) {
        return COMPLETE;
    }
    return status;
}

// Clips by the three sides; `COMPLETE` where something is left.
OUTLINE uint clip_by_sides(Store *s, TruncatedCone cone) {
    uint status = clip(s, cone.side_0, TAG_CONE);
    if ((status == CUT) || (status == UNTOUCHED)) {
        status = clip(s, cone.side_1, TAG_CONE);
    }
    if ((status == CUT) || (status == UNTOUCHED)) {
        status = clip(s, cone.side_2, TAG_CONE);
    }
    if ((status == CUT) || (status == UNTOUCHED)) {
        return COMPLETE;
    }
    return status;
}

// Adds the part of triangle `t` within the cell to the boundary's sums: the facet on the triangle's plane of the cell's intersection
// with the prism behind it. (The cone would do, but its sides can be nearly parallel to the triangle.)
OUTLINE uint add_surface(Store *s, uint t, Voxel apex, V3 center, CellSums *sums) {
    TruncatedCone prism = no_cone();
    if (make_prism(s, t, apex, &prism) != COMPLETE) {
        return UNCERTAIN;
    }
    const uint base = store_planes(s);
    store_set_plane(s, base, prism.end);
    const uint seen = store_mark_conflicts(s, base);
    if ((seen == SEEN_CONFLICT) || (seen == SEEN_KEEP)) {
        return COMPLETE;
    }
    if (((all_in_conflict(s, base, prism.side_0)) || (all_in_conflict(s, base, prism.side_1))) || (all_in_conflict(s, base, prism.side_2))) {
        return COMPLETE;
    }
    uint status = clip_by_sides(s, prism);
    const uint end_index = store_planes(s);
    if (status == COMPLETE) {
        status = clip(s, prism.end, TAG_TRIANGLE);
    }
    if (status == CUT) {
        FacetSum facet = (FacetSum){ 0 };
        status = integrate_facet(s, end_index, center, REAL(0.0), &facet);
        if (status == COMPLETE) {
            add_boundary(facet, prism.end, -prism.jump, sums);
        }
    }
    store_restore(s);
    store_set_planes(s, base);
    if ((status == EMPTY) || (status == UNTOUCHED)) {
        return COMPLETE;
    }
    return status;
}

// Whether every vertex is certainly in conflict with `plane`; uses the slot of plane `k`.
INLINE bool all_in_conflict(Store *s, uint k, Plane plane) {
    store_set_plane(s, k, plane);
    return store_mark_conflicts(s, k) == SEEN_CONFLICT;
}
