// Cuts off what of a cell is far outside the domain (`core/src/cell/cap.rs`), where LANES work-items compute it together: only built
// WITH_EXACT, since a cell of a site amid others reaches nowhere far.

#import "lanes_clip.cl"

#if WITH_DOMAIN && WITH_EXACT

// The position of the vertex that is farthest from the site.
INLINE V3 farthest_together(Store *s) {
    float most = 0.0f;
    float4 own = (float4)(0.0f, 0.0f, 0.0f, 0.0f);
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        const float4 p = s->cell->rough[v];
        const float square = ((p.x * p.x) + (p.y * p.y)) + (p.z * p.z);
        own = (square > most) ? p : own;
        most = fmax(most, square);
    }
    const uint from = lowest_bit(lanes_with(most == lanes_largest(most)));
    return (V3){ .x = as_float(lane_value(as_uint(own.x), from)), .y = as_float(lane_value(as_uint(own.y), from)),
                 .z = as_float(lane_value(as_uint(own.z), from)) };
}

// `part_is_outside`, the vertices shared out among the lanes.
INLINE uint part_is_outside_together(const Store *given, V3 direction, real height) {
    Store copy = *given;
    Store *s = &copy;
    V3 low = direction;
    V3 high = direction;
    real radius = REAL(0.0);
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        add_to_part(s, v, direction, height, &low, &high);
        radius = fmax(radius, store_radius(s, v));
    }
    low = scale(REAL(-1.0), lanes_most_of(scale(REAL(-1.0), low)));
    high = lanes_most_of(high);
    if (widen_part(s, direction, height, lanes_folded(radius, 0u), &low, &high) == 0u) {
        return 0;
    }
    return lanes_with(boxes_are_outside(s, direction, height, low, high, s->lane, LANES) == 0u) == 0u;
}

// `cap_outside`: `CUT`, `UNTOUCHED`, or how the cell ended.
OUTLINE uint cap_together(Store *given, real radius) {
    Store store = taken_store(given);
    Store *s = &store;
    uint end = UNTOUCHED;
    for (uint caps = 0; caps < MOST_CAPS; caps++) {
        const V3 far = farthest_together(s);
        const real length = sqrt(v3_dot(far, far));
        if (length <= radius) {
            break;
        }
        real distance = larger(FIRST_DISTANCE * radius, LEAST_SHARE * length);
        uint status = UNTOUCHED;
        while ((status == UNTOUCHED) && ((WORTH_A_CAP * distance) < length)) {
            const Plane plane = (Plane){ .n = scale(REAL(-1.0), far), .d = distance * length };
            if (part_is_outside_together(s, far, plane.d) != 0u) {
                status = cut_together(s, plane, TAG_CAP);
            }
            distance = next_distance(distance, radius);
        }
        if (status == UNTOUCHED) {
            break;
        }
        end = status;
        if (status != CUT) {
            break;
        }
    }
    return give_back(given, &store, end);
}

// Cuts by a sample of all sites, as `cap_far` of `search.cl`: `CUT`, `UNTOUCHED`, or how the cell ended.
OUTLINE uint sample_together(Store *given, uint own) {
    Store store = taken_store(given);
    Store *s = &store;
    uint end = UNTOUCHED;
    for (uint i = 0; i < SAMPLE; i++) {
        const uint site = sampled_site(s->world.params, i);
        if ((site == own) || (has_cut(s, site) != 0u)) {
            continue;
        }
        const uint status = cut_together(s, bisector_with(s, site), site);
        end = (status == UNTOUCHED) ? end : status;
        if ((status != UNTOUCHED) && (status != CUT)) {
            break;
        }
    }
    return give_back(given, &store, end);
}
#endif
