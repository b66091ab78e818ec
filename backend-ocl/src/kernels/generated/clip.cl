// Generated from core/src/cell/clip.rs by `cargo xtask codegen`; do not edit.

// Starts the cell as the box with minimum corner `lo` and maximum corner `hi`, in the frame of the site.
//
// Planes 0 to 5 keep x ≥ lo.x, x ≤ hi.x, y ≥ lo.y, y ≤ hi.y, z ≥ lo.z, z ≤ hi.z.
OUTLINE uint begin(Store *s, V3 lo, V3 hi) {
    if ((store_cap_p(s) < 6) || (store_cap_v(s) < 8)) {
        return P_FULL;
    }
    set_box_planes(s, lo, hi);
    for (uint f = 0; f < 6; f++) {
        store_set_link(s, f, 0);
    }
    for (uint v = 0; v < 8; v++) {
        place_corner(s, v);
    }
    return COMPLETE;
}

// Clips the cell by `plane`, keeping the side where `n·x + d ≥ 0`; `tag` says whose plane it is. Returns `CUT`, `UNTOUCHED`,
// `EMPTY`, or `P_FULL`, `V_FULL`, `UNCERTAIN`, after which the cell must be begun again. (A host calls it through `widest.rs`.)
OUTLINE uint clip(Store *s, Plane plane, uint tag) {
    if (store_planes(s) == store_cap_p(s)) {
        compact_planes(s);
        if (store_planes(s) == store_cap_p(s)) {
            return P_FULL;
        }
    }
    const uint k = store_planes(s);
    store_set_plane(s, k, plane);
    // 1. Mark the vertices in conflict; what floating point cannot decide is decided exactly, and zero is no conflict.
    const uint seen = store_mark_conflicts(s, k);
    if ((seen & (SEEN_CONFLICT | SEEN_UNCERTAIN)) == 0) {
        return UNTOUCHED;
    }
    if (seen == SEEN_CONFLICT) {
        return EMPTY;
    }
    if ((seen & SEEN_UNCERTAIN) != 0) {
        if (settle_marks(s, k) != COMPLETE) {
            return UNCERTAIN;
        }
    }
    // 2. Link the planes around the hole. Marked vertex (a, b, c) contributes the directed edges a→b, b→c, c→a; an edge
    // cancels its reverse. Around plane a the marked vertices form one chain, so the exclusive or of their b and c
    // telescopes to next(a) ^ previous(a) on the boundary of the hole, and to 0 inside it.
    const uint end = store_vertices(s);
    uint marked = 0;
    uint v = store_next_conflict(s, 0, end);
    while (v < end) {
        const Triplet t = store_triplet(s, v);
        store_toggle_link(s, t.a, t.b ^ t.c);
        store_toggle_link(s, t.b, t.c ^ t.a);
        store_toggle_link(s, t.c, t.a ^ t.b);
        marked += 1;
        v = store_next_conflict(s, v + 1, end);
    }
    if (marked == 0) {
        return UNTOUCHED;
    }
    if (marked == end) {
        return EMPTY;
    }
    store_set_tag(s, k, tag);
    store_set_link(s, k, 0);
    store_set_planes(s, k + 1);
    // 3. One directed edge of that boundary, and from it once around: each edge a→b gives the new vertex (a, b, k), first
    // into the places of the marked vertices, then at the end.
    Triplet edge = (Triplet){ .a = 0, .b = 0, .c = 0 };
    find_boundary_edge(s, end, &edge);
    const uint first = edge.a;
    uint from = edge.a;
    uint to = edge.b;
    uint count = end;
    uint hole = store_next_conflict(s, 0, end);
    uint status;
    uint steps = 0;
    for (;;) {
        // The boundary is one cycle through each plane at most once; more steps would mean inconsistent signs.
        steps += 1;
        if (steps > k) {
            status = UNCERTAIN;
            break;
        }
        uint slot = hole;
        if (hole < end) {
            store_set_mark(s, hole, MARK_KEEP);
            hole = store_next_conflict(s, hole + 1, end);
        } else {
            if (count == store_cap_v(s)) {
                status = V_FULL;
                break;
            }
            slot = count;
            count += 1;
        }
        store_set_triplet(s, slot, (Triplet){ .a = from, .b = to, .c = k });
        status = place_vertex(s, slot);
        if (status != COMPLETE) {
            break;
        }
        const uint next = store_link(s, to) ^ from;
        store_set_link(s, to, 0);
        if (to == first) {
            break;
        }
        from = to;
        to = next;
    }
    if (status != COMPLETE) {
        clear_links(s);
        return status;
    }
    // 4. Fill the places left over from the end.
    while ((hole < end) && (hole < count)) {
        count -= 1;
        if (hole == count) {
            break;
        }
        if (store_mark(s, count) == MARK_CONFLICT) {
            continue;
        }
        store_move_vertex(s, count, hole);
        store_set_mark(s, hole, MARK_KEEP);
        hole = store_next_conflict(s, hole + 1, count);
    }
    store_set_vertices(s, count);
    return CUT;
}

// Decides every uncertain mark against plane `k` by the exact sign.
OUTLINE uint settle_marks(Store *s, uint k) {
    for (uint v = 0; v < store_vertices(s); v++) {
        if (store_mark(s, v) == MARK_UNCERTAIN) {
            const int sign = sign_of_conflict(s, v, k);
            if (sign == SIGN_UNKNOWN) {
                return UNCERTAIN;
            }
            uint mark = MARK_KEEP;
            if (sign < 0) {
                mark = MARK_CONFLICT;
            }
            store_set_mark(s, v, mark);
        }
    }
    return COMPLETE;
}

OUTLINE void clear_links(Store *s) {
    for (uint f = 0; f < store_planes(s); f++) {
        store_set_link(s, f, 0);
    }
}

// Finds a directed edge a→b of a marked vertex whose reverse belongs to no marked vertex.
OUTLINE void find_boundary_edge(Store *s, uint end, Triplet *edge) {
    uint v = store_next_conflict(s, 0, end);
    while (v < end) {
        const Triplet t = store_triplet(s, v);
        if (is_boundary_edge(s, end, t.a, t.b)) {
            edge->a = t.a;
            edge->b = t.b;
            return;
        }
        if (is_boundary_edge(s, end, t.b, t.c)) {
            edge->a = t.b;
            edge->b = t.c;
            return;
        }
        if (is_boundary_edge(s, end, t.c, t.a)) {
            edge->a = t.c;
            edge->b = t.a;
            return;
        }
        v = store_next_conflict(s, v + 1, end);
    }
}

// Whether the edge a→b of a marked vertex lies on the boundary of the hole: both planes do, and no marked vertex has b→a.
INLINE bool is_boundary_edge(Store *s, uint end, uint a, uint b) {
    if ((store_link(s, a) == 0) || (store_link(s, b) == 0)) {
        return 0;
    }
    // Of a plane that one marked vertex alone lies on, that vertex has both edges.
    if (store_was_toggled_once(s, a) || store_was_toggled_once(s, b)) {
        return 1;
    }
    uint v = store_next_conflict(s, 0, end);
    while (v < end) {
        const Triplet t = store_triplet(s, v);
        if ((((t.a == b) && (t.b == a)) || ((t.b == b) && (t.c == a))) || ((t.c == b) && (t.a == a))) {
            return 0;
        }
        v = store_next_conflict(s, v + 1, end);
    }
    return 1;
}

// Drops the planes that no vertex lies on and renumbers the others in order.
OUTLINE void compact_planes(Store *s) {
    for (uint v = 0; v < store_vertices(s); v++) {
        const Triplet t = store_triplet(s, v);
        store_set_link(s, t.a, 1);
        store_set_link(s, t.b, 1);
        store_set_link(s, t.c, 1);
    }
    // The link of a kept plane becomes its new number plus one.
    uint kept = 0;
    for (uint f = 0; f < store_planes(s); f++) {
        if (store_link(s, f) != 0) {
            if (kept != f) {
                store_move_plane(s, f, kept);
            }
            kept += 1;
            store_set_link(s, f, kept);
        }
    }
    for (uint v = 0; v < store_vertices(s); v++) {
        const Triplet t = store_triplet(s, v);
        store_renumber(s, v, (Triplet){ .a = store_link(s, t.a) - 1, .b = store_link(s, t.b) - 1, .c = store_link(s, t.c) - 1 });
    }
    clear_links(s);
    store_set_planes(s, kept);
}

// An upper bound of the distance from the site to the farthest vertex.
INLINE real farthest_vertex(Store *s) {
    const V3 largest = store_farthest(s);
    // The radius bounds each component; √3 < 2.
    return (sqrt(largest.x) + (REAL(2.0) * largest.y)) * (REAL(1.0) + (REAL(16.0) * UNIT_ROUNDOFF));
}
