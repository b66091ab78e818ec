// Cuts off what of a cell is far outside the domain (`core/src/cell/cap.rs`), where LANES work-items compute it together: only built
// WITH_EXACT, since a cell of a site amid others reaches nowhere far.
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
INLINE uint part_is_outside_together(Store *s, V3 direction, real height) {
    V3 low = direction;
    V3 high = direction;
    real radius = REAL(0.0);
    for (uint v = s->lane; v < s->vertices; v += LANES) {
        add_to_part(s, v, direction, height, &low, &high);
        radius = fmax(radius, store_radius(s, v));
    }
    low = scale(REAL(-1.0), lanes_most_of(scale(REAL(-1.0), low)));
    return box_of_part_is_outside(s, direction, height, low, lanes_most_of(high), lanes_folded(radius, 0u));
}

// `cap_outside`: `CUT`, `UNTOUCHED`, or how the cell ended.
INLINE uint cap_together(Store *s, real radius) {
    uint end = UNTOUCHED;
    for (uint caps = 0; caps < MOST_CAPS; caps++) {
        const V3 far = farthest_together(s);
        const real square = v3_dot(far, far);
        real distance = radius;
        uint status = UNTOUCHED;
        for (uint doublings = 0; (status == UNTOUCHED) && (doublings <= MOST_DOUBLINGS); doublings++) {
            if (square < ((REAL(2.0) * distance) * distance)) {
                return end;
            }
            if (s->planes == LANES_P) {
                return LEFT;
            }
            const Plane plane = (Plane){ .n = scale(REAL(-1.0), far), .d = distance * sqrt(square) };
            if (part_is_outside_together(s, far, plane.d) != 0u) {
                if (s->lane == 0u) {
                    s->cell->plane[s->planes] = plane;
                    s->cell->source[s->planes] = TAG_CAP;
                }
                lanes_wait();
                status = clip_together(s, trial_of(plane));
            }
            distance = REAL(2.0) * distance;
        }
        if (status != CUT) {
            return (status == UNTOUCHED) ? end : status;
        }
        end = CUT;
    }
    return end;
}
#endif
