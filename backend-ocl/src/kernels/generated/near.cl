// Generated from core/src/cell/near.rs by `cargo xtask codegen`; do not edit.

// Whether no triangle in the voxels from `lo` to `hi` meets the cell, whose box is `[low, high]` in the frame of its site. Then
// `winding`, which is that of the corner of `lo`, becomes that of the cell. `false` where one does, or may.
OUTLINE bool surface_passes_by(Store *s, V3 low, V3 high, Voxel lo, Voxel hi, int *winding) {
    if (!site_is_inside(s)) {
        return 0;
    }
    uint k = lo.k;
    while (k <= hi.k) {
        uint j = lo.j;
        while (j <= hi.j) {
            const bool is_empty = row_is_empty(s, lo, hi, j, k);
            uint i = lo.i;
            while ((i <= hi.i) && !is_empty) {
                if (!voxel_passes_by(s, (Voxel){ .i = i, .j = j, .k = k }, lo, low, high, winding)) {
                    return 0;
                }
                i += 1;
            }
            j += 1;
        }
        k += 1;
    }
    return 1;
}

// Whether no triangle stands in the voxels of row `j`, `k` from `lo` to `hi`, whose lists stand one after the other.
INLINE bool row_is_empty(Store *s, Voxel lo, Voxel hi, uint j, uint k) {
    return store_list_begin(s, (Voxel){ .i = lo.i, .j = j, .k = k }) == store_list_end(s, (Voxel){ .i = hi.i, .j = j, .k = k });
}

// Whether the site is strictly inside its cell, so that the cell's winding number is the site's.
OUTLINE bool site_is_inside(Store *s) {
    for (uint f = 0; f < store_planes(s); f++) {
        const real d = store_plane(s, f).d;
        if (!(d > REAL(0.0))) {
            return 0;
        }
    }
    return 1;
}

// The same for the triangles of one voxel, of which `lo` is the lowest; takes from `winding` what they add between the corner of
// `lo` and the site.
HOT bool voxel_passes_by(Store *s, Voxel voxel, Voxel lo, V3 low, V3 high, int *winding) {
    const uint end = store_list_end(s, voxel);
    for (uint entry = store_list_begin(s, voxel); entry < end; entry++) {
        const uint t = store_list_entry(s, entry);
        if (is_first_voxel(store_lowest_voxel(s, t), lo, voxel)) {
            if (!triangle_passes_by(s, t, lo, low, high, winding)) {
                return 0;
            }
        }
    }
    return 1;
}

// Whether triangle `t` certainly does not meet the cell; takes from `winding` its sign as seen from the corner of `apex`, as often as it stands, where
// that is between that and the site.
//
// Every sign is certain about the true points: floating point with a bound, and 0 where that does not suffice.
HOT bool triangle_passes_by(Store *s, uint t, Voxel apex, V3 low, V3 high, int *winding) {
    const Triangle triangle = store_triangle(s, t);
    const V3 a = store_domain_point(s, triangle.a);
    const V3 b = store_domain_point(s, triangle.b);
    const V3 c = store_domain_point(s, triangle.c);
    const V3 site = store_site(s);
    const V3 a_in = sub(a, site);
    const V3 b_in = sub(b, site);
    const V3 c_in = sub(c, site);
    const V3 least = least_of(a_in, b_in, c_in);
    const V3 most = most_of(a_in, b_in, c_in);
    if (!are_apart(least, most, low, high)) {
        if (!plane_is_apart(s, a_in, sub(b, a), sub(c, a))) {
            return 0;
        }
    }
    // Does it cross the segment from the corner, the lowest point of the cell's voxels, to the site?
    const V3 o = store_corner(s, apex);
    const V3 x = sub(site, o);
    const V3 o_in = sub(o, site);
    if (are_apart(least, most, o_in, (V3){ .x = REAL(0.0), .y = REAL(0.0), .z = REAL(0.0) })) {
        return 1;
    }
    const V3 p = sub(a, o);
    const V3 q = sub(b, o);
    const V3 r = sub(c, o);
    const int of_corner = filtered_sign(p, q, r);
    const int of_site = filtered_sign(a_in, b_in, c_in);
    if ((of_corner == SIGN_UNKNOWN) || (of_site == SIGN_UNKNOWN)) {
        return 0;
    }
    if (of_corner == of_site) {
        return 1;
    }
    const int over_0 = filtered_sign(p, q, x);
    const int over_1 = filtered_sign(q, r, x);
    const int over_2 = filtered_sign(r, p, x);
    if (((over_0 == SIGN_UNKNOWN) || (over_1 == SIGN_UNKNOWN)) || (over_2 == SIGN_UNKNOWN)) {
        return 0;
    }
    if (((over_0 == of_corner) && (over_1 == of_corner)) && (over_2 == of_corner)) {
        *winding -= (of_corner * triangle.times);
    }
    return 1;
}

// Whether the boxes `[a, b]` and `[c, d]` are apart. (The rounded differences that their corners are tell it as the exact ones
// do: rounding keeps the order.)
INLINE bool are_apart(V3 a, V3 b, V3 c, V3 d) {
    if (((b.x < c.x) || (b.y < c.y)) || (b.z < c.z)) {
        return 1;
    }
    return ((a.x > d.x) || (a.y > d.y)) || (a.z > d.z);
}

// Whether all vertices are certainly on one side of the plane through `a_in` along `e` and `f`.
HOT bool plane_is_apart(Store *s, V3 a_in, V3 e, V3 f) {
    const V3 n = v3_cross(e, f);
    const real of_normal = norm_1(e) * norm_1(f);
    const real length = norm_1(n) + (FEW_ROUNDINGS * of_normal);
    const real reach = norm_1(a_in);
    uint above = 0;
    uint below = 0;
    for (uint v = 0; v < store_vertices(s); v++) {
        const V3 way = sub(store_position(s, v), a_in);
        const real height = v3_dot(n, way);
        const real way_length = norm_1(way);
        const real bound = (length * (store_radius(s, v) + (FEW_ROUNDINGS * (reach + way_length)))) + ((FEW_ROUNDINGS * of_normal) * way_length);
        if (height > bound) {
            above = 1;
        } else if (height < -bound) {
            below = 1;
        } else {
            return 0;
        }
        if ((above != 0) && (below != 0)) {
            return 0;
        }
    }
    return 1;
}

INLINE V3 least_of(V3 a, V3 b, V3 c) {
    return (V3){ .x = smaller(smaller(a.x, b.x), c.x), .y = smaller(smaller(a.y, b.y), c.y), .z = smaller(smaller(a.z, b.z), c.z) };
}

INLINE V3 most_of(V3 a, V3 b, V3 c) {
    return (V3){ .x = larger(larger(a.x, b.x), c.x), .y = larger(larger(a.y, b.y), c.y), .z = larger(larger(a.z, b.z), c.z) };
}

// A triangle stands in every voxel of its bounding box; it is taken only in the lowest one that the cell's box shares.
INLINE bool is_first_voxel(Voxel lowest, Voxel lo, Voxel voxel) {
    uint i = lowest.i;
    uint j = lowest.j;
    uint k = lowest.k;
    if (lo.i > i) {
        i = lo.i;
    }
    if (lo.j > j) {
        j = lo.j;
    }
    if (lo.k > k) {
        k = lo.k;
    }
    return ((i == voxel.i) && (j == voxel.j)) && (k == voxel.k);
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

// The voxels that a box in the frame of the site meets.
HOT void voxels_of_box(Store *s, V3 low, V3 high, Voxel *lo, Voxel *hi) {
    *lo = store_voxel_of(s, add(store_site(s), low));
    *hi = store_voxel_of(s, add(store_site(s), high));
}
