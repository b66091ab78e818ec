// Generated from core/src/cell/restrict.rs by `cargo xtask codegen`; do not edit.

// The integrals of the finished cell over the container: the domain where there is one, weighted by its winding number,
// else the initial box. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again; with `interior_only`, `BOUNDARY`
// where the cell's voxels hold triangles.
//
// With the flag `FACETS` the facets' sums of the half-spaces are those of the restricted cell afterwards, with
// `FACET_SECOND_MOMENTS` their second moments too.
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
        if ((status == COMPLETE) && ((flags & FACETS) != 0)) {
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
    if (winding != 0) {
        const uint status = integrate(s, (real)winding, center, REAL(0.0), flags, sums);
        if (status != COMPLETE) {
            return status;
        }
    }
    bool touched = 0;
    const uint cones = add_cones(s, lo, hi, center, flags, &touched, sums);
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

// Whether the winding number is the same all over a cell that no triangle touches: the nearest integer to the quotient of `sums` and the
// integrals of the whole cell. A cone so thin that rounding loses it does not tell that its triangle divides the cell; the sum does. Where rounding
// can make as much of nothing as the whole cell is, no more is believed than 0 and 1 (it was −1,147,767 for a hair of 1e-15 across).
HOT bool is_undivided(CellSums sums, CellSums whole, int *winding) {
    const real quotient = sums.volume / whole.volume;
    const real noise = SHARE_OF_NOTHING * smaller(sums.rounding, sums.largest_rounding);
    if (!(fabs(quotient) < MOST_WINDINGS)) {
        return 0;
    }
    const bool is_usual = (quotient > -REAL(0.5)) && (quotient < REAL(1.5));
    if (!(noise < whole.volume) && !is_usual) {
        return 0;
    }
    int inner = (int)(fabs(quotient) + REAL(0.5));
    if (quotient < REAL(0.0)) {
        inner = -inner;
    }
    *winding = inner;
    const real off = fabs(sums.volume - (((real)inner) * whole.volume));
    return off <= (sums.rounding + whole.rounding);
}

// `COMPLETE` where something is left of the cell, else `EMPTY`.
//
// A volume that rounding may have made is believed only where its barycenter is near the cell: what rounding makes has it anywhere.
HOT uint settle(Store *s, CellSums *sums) {
    if (!volume_is_above_bound(*sums)) {
        return EMPTY;
    }
    if (fabs(sums->volume) > sums->rounding) {
        return COMPLETE;
    }
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    const real radius = box_of_cell(s, &low, &high);
    const real extent = norm_max(sub(high, low)) + radius;
    const V3 middle = scale(REAL(0.5), add(low, high));
    const V3 barycenter = scale(REAL(1.0) / sums->volume, sums->first);
    if (norm_max(sub(barycenter, middle)) > extent) {
        return EMPTY;
    }
    return COMPLETE;
}

// Whether the present cell, and so all that clipping can leave of it, lies where the domain's winding number is 0.
OUTLINE bool lies_outside(Store *s) {
    if (!store_has_domain(s)) {
        return 0;
    }
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    outer_box_of_cell(s, &low, &high);
    return box_is_outside(s, low, high);
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

// The bounding box of the vertices; returns their largest error radius.
HOT real box_of_cell(Store *s, V3 *low, V3 *high) {
    *low = store_position(s, 0);
    *high = *low;
    real radius = store_radius(s, 0);
    for (uint v = 1; v < store_vertices(s); v++) {
        const V3 p = store_position(s, v);
        *low = v3(smaller(low->x, p.x), smaller(low->y, p.y), smaller(low->z, p.z));
        *high = v3(larger(high->x, p.x), larger(high->y, p.y), larger(high->z, p.z));
        radius = larger(radius, store_radius(s, v));
    }
    return radius;
}

// The bounding box of the cell, rounded outward.
HOT void outer_box_of_cell(Store *s, V3 *low, V3 *high) {
    const real radius = box_of_cell(s, low, high);
    // The vertices' error, and the rounding of moving them into the diagram's frame.
    const real margin = radius + ((REAL(4.0) * UNIT_ROUNDOFF) * (norm_max(store_site(s)) + larger(norm_max(*low), norm_max(*high))));
    const V3 outward = v3(margin, margin, margin);
    *low = sub(*low, outward);
    *high = add(*high, outward);
}

// The voxels that a box in the frame of the site meets.
HOT void voxels_of_box(Store *s, V3 low, V3 high, Voxel *lo, Voxel *hi) {
    *lo = store_voxel_of(s, add(store_site(s), low));
    *hi = store_voxel_of(s, add(store_site(s), high));
}

// Subtracts the signed integrals of the cell's intersection with the truncated cone of every triangle near it; `touched` becomes true
// where a piece ends at its triangle.
OUTLINE uint add_cones(Store *s, Voxel lo, Voxel hi, V3 center, uint flags, bool *touched, CellSums *sums) {
    store_save(s);
    uint k = lo.k;
    while (k <= hi.k) {
        uint j = lo.j;
        while (j <= hi.j) {
            uint i = lo.i;
            while (i <= hi.i) {
                const Voxel voxel = (Voxel){ .i = i, .j = j, .k = k };
                const uint end = store_list_end(s, voxel);
                for (uint entry = store_list_begin(s, voxel); entry < end; entry++) {
                    const uint t = store_list_entry(s, entry);
                    if (is_first_voxel(store_lowest_voxel(s, t), lo, voxel)) {
                        const uint status = add_cone(s, t, lo, center, flags, touched, sums);
                        if (status != COMPLETE) {
                            return status;
                        }
                        if ((flags & FACETS) != 0) {
                            const uint surface = add_surface(s, t, lo, center, sums);
                            if (surface != COMPLETE) {
                                return surface;
                            }
                        }
                    }
                }
                i += 1;
            }
            j += 1;
        }
        k += 1;
    }
    return COMPLETE;
}
