// Generated from core/src/cell/cap.rs by `cargo xtask codegen`; do not edit.

// Cuts off, cap by cap, what lies outside the domain, until no vertex is farther from the site than `radius`, or what is cannot be cut
// off: `CUT` where something was, `UNTOUCHED` where nothing was, or how the cell ended.
OUTLINE uint cap_outside(Store *s, real radius) {
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
                status = clip(s, (Plane){ .n = scale(-REAL(1.0), far), .d = distance * length }, TAG_CAP);
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
OUTLINE V3 farthest_position(Store *s) {
    V3 far = store_position(s, 0);
    for (uint v = 1; v < store_vertices(s); v++) {
        const V3 p = store_position(s, v);
        if (v3_dot(p, p) > v3_dot(far, far)) {
            far = p;
        }
    }
    return far;
}

// Whether what of the cell has `direction·x ≥ height` certainly lies where the domain's winding number is 0: its bounding box, or each
// part of it that has something of the cell.
OUTLINE bool part_is_outside(Store *s, V3 direction, real height) {
    V3 low = direction;
    V3 high = direction;
    real radius = REAL(0.0);
    for (uint v = 0; v < store_vertices(s); v++) {
        add_to_part(s, v, direction, height, &low, &high);
        radius = larger(radius, store_radius(s, v));
    }
    if (!widen_part(s, direction, height, radius, &low, &high)) {
        return 0;
    }
    return boxes_are_outside(s, direction, height, low, high, 0, 1);
}
