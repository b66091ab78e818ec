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
    return box_is_outside(s, low, high) || parts_are_outside(s, direction, height, low, sub(high, low));
}

// Whether each of the parts of a box of some extent from `low` on is outside, or has nothing of the cell with `direction·x ≥ height`; or each of that
// one's own parts.
HOT bool parts_are_outside(Store *s, V3 direction, real height, V3 low, V3 extent) {
    const V3 size = scale(REAL(0.25), extent);
    uint first = 0;
    while (first < ALL_PARTS) {
        const uint n = first + store_lane(s);
        bool is_open = 0;
        if (n < ALL_PARTS) {
            is_open = !box_has_nothing(s, direction, height, middle_of_part(low, size, n), size);
        }
        uint open = store_lanes_with(s, is_open);
        while (open != 0) {
            // One for each eight lanes, one of its parts a lane.
            uint own = ALL_PARTS;
            uint before = 0;
            while ((open != 0) && (before < store_lanes(s))) {
                if ((store_lane(s) >= before) && (store_lane(s) < (before + PARTS_OF_PART))) {
                    own = first + store_first_of(s, open);
                }
                open = open & (open - 1);
                before += PARTS_OF_PART;
            }
            bool is_there = 0;
            uint part = store_lane(s) & (PARTS_OF_PART - 1);
            while ((own < ALL_PARTS) && (part < PARTS_OF_PART)) {
                const V3 middle = middle_within_part(middle_of_part(low, size, own), size, part);
                if (!box_has_nothing(s, direction, height, middle, scale(REAL(0.5), size))) {
                    is_there = 1;
                }
                part += store_lanes(s);
            }
            if (store_lanes_with(s, is_there) != 0) {
                return 0;
            }
        }
        first += store_lanes(s);
    }
    return 1;
}
