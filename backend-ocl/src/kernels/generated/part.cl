// Generated from core/src/cell/part.rs by `cargo xtask codegen`; do not edit.

// Widens `[low, high]`, if vertex `v` has `direction·x ≥ height`, by that vertex, and by where the ways to it from all vertices that have not
// come to have: what of the cell has lies between such. (All by less than `height`, by a margin.)
HOT void add_to_part(Store *s, uint v, V3 direction, real height, V3 *low, V3 *high) {
    const real below = height - (CAP_MARGIN * height);
    const V3 p = store_position(s, v);
    const real p_height = v3_dot(direction, p);
    if (p_height < below) {
        return;
    }
    *low = v3(smaller(low->x, p.x), smaller(low->y, p.y), smaller(low->z, p.z));
    *high = v3(larger(high->x, p.x), larger(high->y, p.y), larger(high->z, p.z));
    for (uint u = 0; u < store_vertices(s); u++) {
        const V3 q = store_position(s, u);
        const real q_height = v3_dot(direction, q);
        if (q_height < below) {
            const V3 between = add(q, scale((below - q_height) / (p_height - q_height), sub(p, q)));
            *low = v3(smaller(low->x, between.x), smaller(low->y, between.y), smaller(low->z, between.z));
            *high = v3(larger(high->x, between.x), larger(high->y, between.y), larger(high->z, between.z));
        }
    }
}

// Widens `[low, high]` by all roundings, `radius` the vertices' largest error: whether they are not too large to tell. No vertex is farther than
// `direction`.
OUTLINE bool widen_part(Store *s, V3 direction, real height, real radius, V3 *low, V3 *high) {
    // The vertices' error, the roundings of heights and places, and of moving them into the diagram's frame.
    const real rounding = radius + ((REAL(16.0) * UNIT_ROUNDOFF) * (norm_max(store_site(s)) + norm_1(direction)));
    if (!((norm_1(direction) * rounding) < (REAL(0.25) * (CAP_MARGIN * height)))) {
        return 0;
    }
    const V3 outward = v3(rounding, rounding, rounding);
    *low = sub(*low, outward);
    *high = add(*high, outward);
    return 1;
}

// The middle of number `n` of [`ALL_PARTS`] parts of some size, of which the first begins at `low`.
HOT V3 middle_of_part(V3 low, V3 size, uint n) {
    const V3 along = v3(((real)(n & 3)) + REAL(0.5), ((real)((n >> 2) & 3)) + REAL(0.5), ((real)(n >> 4)) + REAL(0.5));
    return add(low, v3(along.x * size.x, along.y * size.y, along.z * size.z));
}

// The same of a part's own parts.
HOT V3 middle_within_part(V3 middle, V3 size, uint n) {
    const V3 along = v3(((real)(n & 1)) - REAL(0.5), ((real)((n >> 1) & 1)) - REAL(0.5), ((real)(n >> 2)) - REAL(0.5));
    return add(middle, scale(REAL(0.5), v3(along.x * size.x, along.y * size.y, along.z * size.z)));
}

// Whether a box of some size about `middle` is outside the domain, or has nothing of the cell with `direction·x ≥ height`.
HOT bool box_has_nothing(Store *s, V3 direction, real height, V3 middle, V3 size) {
    // Wider by what its corners are rounded by.
    const V3 halves = scale(REAL(0.5) + CAP_MARGIN, size);
    return box_is_outside(s, sub(middle, halves), add(middle, halves)) || box_misses_part(s, direction, height, middle, halves);
}

// Whether the domain's winding number is 0 all over the box `[low, high]`.
HOT bool box_is_outside(Store *s, V3 low, V3 high) {
    Voxel lo = (Voxel){ .i = 0, .j = 0, .k = 0 };
    Voxel hi = (Voxel){ .i = 0, .j = 0, .k = 0 };
    voxels_of_box(s, low, high, &lo, &hi);
    return (store_surface_voxels(s, lo, hi) == 0) && (store_winding(s, lo) == 0);
}

// Whether a box about `middle` certainly has nothing of the cell with `direction·x ≥ height`.
HOT bool box_misses_part(Store *s, V3 direction, real height, V3 middle, V3 halves) {
    if ((v3_dot(direction, middle) + reach_along(direction, halves)) < (height - (CAP_MARGIN * height))) {
        return 1;
    }
    for (uint f = 0; f < store_planes(s); f++) {
        const Plane plane = store_plane(s, f);
        const real largest = (v3_dot(plane.n, middle) + plane.d) + reach_along(plane.n, halves);
        const real rounding = (REAL(16.0) * UNIT_ROUNDOFF) * ((norm_1(plane.n) * (norm_max(middle) + norm_max(halves))) + fabs(plane.d));
        if (largest < -rounding) {
            return 1;
        }
    }
    return 0;
}

// The largest `n·x` of a box about 0.
INLINE real reach_along(V3 n, V3 halves) {
    return ((fabs(n.x) * halves.x) + (fabs(n.y) * halves.y)) + (fabs(n.z) * halves.z);
}

// The distance that is tried next: in small steps up to the radius, then in large ones.
HOT real next_distance(real distance, real radius) {
    if (distance < radius) {
        return REAL(1.2) * distance;
    }
    return REAL(1.75) * distance;
}
