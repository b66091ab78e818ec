//! Clipping a cell by a half-space (design: paper §2.2, with the boundary of the hole found without a walk).

use super::first::{place_corner, set_box_planes};
use super::plane::Plane;
use super::status::{
    COMPLETE, CUT, EMPTY, MARK_CONFLICT, MARK_KEEP, MARK_UNCERTAIN, P_FULL, SEEN_CONFLICT, SEEN_UNCERTAIN,
    SIGN_UNKNOWN, UNCERTAIN, UNTOUCHED, V_FULL,
};
use super::store::{ClipStore, SignStore};
use super::vector::{Real, UNIT_ROUNDOFF, V3};
use super::vertex::{Triplet, place_vertex};
use super::wide::sign_of_conflict;

/// Starts the cell as the box with minimum corner `lo` and maximum corner `hi`, in the frame of the site.
///
/// Planes 0 to 5 keep x ≥ lo.x, x ≤ hi.x, y ≥ lo.y, y ≤ hi.y, z ≥ lo.z, z ≤ hi.z.
#[cfg_attr(opencl, outline)]
pub fn begin<S: ClipStore>(s: &mut S, lo: V3, hi: V3) -> u32 {
    if (s.cap_p() < 6) || (s.cap_v() < 8) {
        return P_FULL;
    }
    set_box_planes(s, lo, hi);
    for f in 0..6 {
        s.set_link(f, 0);
    }
    for v in 0..8 {
        place_corner(s, v);
    }
    return COMPLETE;
}

/// Clips the cell by `plane`, keeping the side where `n·x + d ≥ 0`; `tag` says whose plane it is. Returns `CUT`, `UNTOUCHED`,
/// `EMPTY`, or `P_FULL`, `V_FULL`, `UNCERTAIN`, after which the cell must be begun again. (A host calls it through `widest.rs`.)
#[inline(always)]
#[cfg_attr(opencl, outline)]
pub(super) fn clip<S: ClipStore + SignStore>(s: &mut S, plane: Plane, tag: u32) -> u32 {
    if s.planes() == s.cap_p() {
        compact_planes(s);
        if s.planes() == s.cap_p() {
            return P_FULL;
        }
    }
    let k: u32 = s.planes();
    s.set_plane(k, plane);

    // 1. Mark the vertices in conflict; what floating point cannot decide is decided exactly, and zero is no conflict.
    let seen: u32 = s.mark_conflicts(k);
    if (seen & (SEEN_CONFLICT | SEEN_UNCERTAIN)) == 0 {
        return UNTOUCHED;
    }
    if seen == SEEN_CONFLICT {
        return EMPTY;
    }
    if (seen & SEEN_UNCERTAIN) != 0 {
        if settle_marks(s, k) != COMPLETE {
            return UNCERTAIN;
        }
    }

    // 2. Link the planes around the hole. Marked vertex (a, b, c) contributes the directed edges a→b, b→c, c→a; an edge
    //    cancels its reverse. Around plane a the marked vertices form one chain, so the exclusive or of their b and c
    //    telescopes to next(a) ^ previous(a) on the boundary of the hole, and to 0 inside it.
    let end: u32 = s.vertices();
    let mut marked: u32 = 0;
    let mut v: u32 = s.next_conflict(0, end);
    while v < end {
        let t: Triplet = s.triplet(v);
        s.toggle_link(t.a, t.b ^ t.c);
        s.toggle_link(t.b, t.c ^ t.a);
        s.toggle_link(t.c, t.a ^ t.b);
        marked += 1;
        v = s.next_conflict(v + 1, end);
    }
    if marked == 0 {
        return UNTOUCHED;
    }
    if marked == end {
        return EMPTY;
    }
    s.set_tag(k, tag);
    s.set_link(k, 0);
    s.set_planes(k + 1);

    // 3. One directed edge of that boundary, and from it once around: each edge a→b gives the new vertex (a, b, k), first
    //    into the places of the marked vertices, then at the end.
    let mut edge: Triplet = Triplet { a: 0, b: 0, c: 0 };
    find_boundary_edge(s, end, &mut edge);
    let first: u32 = edge.a;
    let mut from: u32 = edge.a;
    let mut to: u32 = edge.b;
    let mut count: u32 = end;
    let mut hole: u32 = s.next_conflict(0, end);
    let mut status: u32;
    let mut steps: u32 = 0;
    loop {
        // The boundary is one cycle through each plane at most once; more steps would mean inconsistent signs.
        steps += 1;
        if steps > k {
            status = UNCERTAIN;
            break;
        }
        let mut slot: u32 = hole;
        if hole < end {
            s.set_mark(hole, MARK_KEEP);
            hole = s.next_conflict(hole + 1, end);
        } else {
            if count == s.cap_v() {
                status = V_FULL;
                break;
            }
            slot = count;
            count += 1;
        }
        s.set_triplet(slot, Triplet { a: from, b: to, c: k });
        status = place_vertex(s, slot);
        if status != COMPLETE {
            break;
        }
        let next: u32 = s.link(to) ^ from;
        s.set_link(to, 0);
        if to == first {
            break;
        }
        from = to;
        to = next;
    }
    if status != COMPLETE {
        clear_links(s);
        return status;
    }

    // 4. Fill the places left over from the end.
    while (hole < end) && (hole < count) {
        count -= 1;
        if hole == count {
            break;
        }
        if s.mark(count) == MARK_CONFLICT {
            continue;
        }
        s.move_vertex(count, hole);
        s.set_mark(hole, MARK_KEEP);
        hole = s.next_conflict(hole + 1, count);
    }
    s.set_vertices(count);
    return CUT;
}

/// Decides every uncertain mark against plane `k` by the exact sign.
#[cfg_attr(opencl, outline)]
pub(super) fn settle_marks<S: ClipStore + SignStore>(s: &mut S, k: u32) -> u32 {
    for v in 0..s.vertices() {
        if s.mark(v) == MARK_UNCERTAIN {
            let sign: i32 = sign_of_conflict(s, v, k);
            if sign == SIGN_UNKNOWN {
                return UNCERTAIN;
            }
            let mut mark: u32 = MARK_KEEP;
            if sign < 0 {
                mark = MARK_CONFLICT;
            }
            s.set_mark(v, mark);
        }
    }
    return COMPLETE;
}

#[cfg_attr(opencl, outline)]
pub(super) fn clear_links<S: ClipStore>(s: &mut S) {
    for f in 0..s.planes() {
        s.set_link(f, 0);
    }
}

/// Finds a directed edge a→b of a marked vertex whose reverse belongs to no marked vertex.
#[inline(always)]
#[cfg_attr(opencl, outline)]
pub(super) fn find_boundary_edge<S: ClipStore>(s: &mut S, end: u32, edge: &mut Triplet) {
    let mut v: u32 = s.next_conflict(0, end);
    while v < end {
        let t: Triplet = s.triplet(v);
        if is_boundary_edge(s, end, t.a, t.b) {
            edge.a = t.a;
            edge.b = t.b;
            return;
        }
        if is_boundary_edge(s, end, t.b, t.c) {
            edge.a = t.b;
            edge.b = t.c;
            return;
        }
        if is_boundary_edge(s, end, t.c, t.a) {
            edge.a = t.c;
            edge.b = t.a;
            return;
        }
        v = s.next_conflict(v + 1, end);
    }
}

/// Whether the edge a→b of a marked vertex lies on the boundary of the hole: both planes do, and no marked vertex has b→a.
#[inline(always)]
pub(super) fn is_boundary_edge<S: ClipStore>(s: &mut S, end: u32, a: u32, b: u32) -> bool {
    if (s.link(a) == 0) || (s.link(b) == 0) {
        return false;
    }
    // Of a plane that one marked vertex alone lies on, that vertex has both edges.
    if s.was_toggled_once(a) || s.was_toggled_once(b) {
        return true;
    }
    let mut v: u32 = s.next_conflict(0, end);
    while v < end {
        let t: Triplet = s.triplet(v);
        if ((t.a == b) && (t.b == a)) || ((t.b == b) && (t.c == a)) || ((t.c == b) && (t.a == a)) {
            return false;
        }
        v = s.next_conflict(v + 1, end);
    }
    return true;
}

/// Drops the planes that no vertex lies on and renumbers the others in order.
#[cfg_attr(opencl, outline)]
pub fn compact_planes<S: ClipStore>(s: &mut S) {
    for v in 0..s.vertices() {
        let t: Triplet = s.triplet(v);
        s.set_link(t.a, 1);
        s.set_link(t.b, 1);
        s.set_link(t.c, 1);
    }
    // The link of a kept plane becomes its new number plus one.
    let mut kept: u32 = 0;
    for f in 0..s.planes() {
        if s.link(f) != 0 {
            if kept != f {
                s.move_plane(f, kept);
            }
            kept += 1;
            s.set_link(f, kept);
        }
    }
    for v in 0..s.vertices() {
        let t: Triplet = s.triplet(v);
        s.renumber(v, Triplet { a: s.link(t.a) - 1, b: s.link(t.b) - 1, c: s.link(t.c) - 1 });
    }
    clear_links(s);
    s.set_planes(kept);
}

/// An upper bound of the distance from the site to the farthest vertex.
#[inline(always)]
pub fn farthest_vertex<S: ClipStore>(s: &S) -> Real {
    let largest: V3 = s.farthest();
    // The radius bounds each component; √3 < 2.
    return (largest.x.sqrt() + (2.0 * largest.y)) * (1.0 + (16.0 * UNIT_ROUNDOFF));
}
