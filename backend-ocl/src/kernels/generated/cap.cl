// Generated from core/src/cell/cap.rs by `cargo xtask codegen`; do not edit.

// Cuts off, cap by cap, what lies outside the domain, until no vertex is farther from the site than `radius`, or what is cannot be cut
// off: `CUT` where something was, `UNTOUCHED` where nothing was, or how the cell ended.
HOT uint cap_outside(Store *s, real radius) {
    if (!store_has_domain(s) || !(radius > REAL(0.0))) {
        return UNTOUCHED;
    }
    uint end = UNTOUCHED;
    for (uint _caps = 0; _caps < MOST_CAPS; _caps++) {
        const V3 far = farthest_position(s);
        const real length = sqrt(v3_dot(far, far));
        if (length <= radius) {
            return end;
        }
        real distance = larger(FIRST_DISTANCE * radius, LEAST_SHARE * length);
        uint status = UNTOUCHED;
        while ((status == UNTOUCHED) && ((WORTH_A_CAP * distance) < length)) {
            if (part_is_outside(s, far, distance * length)) {
                status = store_cut(s, (Plane){ .n = scale(-REAL(1.0), far), .d = distance * length }, TAG_CAP);
            }
            distance = next_distance(distance, radius);
        }
        if (status == UNTOUCHED) {
            return end;
        }
        if (status != CUT) {
            return status;
        }
        end = CUT;
    }
    return end;
}

// The position of the vertex that is farthest from the site.
HOT V3 farthest_position(Store *s) {
    V3 own = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    real square = REAL(0.0);
    uint v = store_lane(s);
    while (v < store_vertices(s)) {
        const V3 p = store_position(s, v);
        if (v3_dot(p, p) > square) {
            own = p;
            square = v3_dot(p, p);
        }
        v += store_lanes(s);
    }
    const uint from = store_first_of(s, store_lanes_with(s, square == store_most_of_lanes(s, square)));
    return v3(store_lane_real(s, own.x, from), store_lane_real(s, own.y, from), store_lane_real(s, own.z, from));
}

// Whether what of the cell has `direction·x ≥ height` certainly lies where the domain's winding number is 0: its bounding box, or each
// part of it that has something of the cell.
HOT bool part_is_outside(Store *s, V3 direction, real height) {
    V3 low = direction;
    V3 high = direction;
    real radius = REAL(0.0);
    uint v = store_lane(s);
    while (v < store_vertices(s)) {
        add_to_part(s, v, direction, height, &low, &high);
        radius = larger(radius, store_radius(s, v));
        v += store_lanes(s);
    }
    low = scale(-REAL(1.0), store_most_along_axes(s, scale(-REAL(1.0), low)));
    high = store_most_along_axes(s, high);
    if (!widen_part(s, direction, height, store_most_of_lanes(s, radius), &low, &high)) {
        return 0;
    }
    return store_lanes_with(s, !boxes_are_outside(s, direction, height, low, high, store_lane(s), store_lanes(s))) == 0;
}
