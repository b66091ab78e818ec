//! The search where the octree over the container tells where a cell is: it is completed box by box.
//!
//! A site that a box does not list has more power, at each of its points, than one that it does. So once all sites that a box lists have cut the cell or
//! cannot reach it, no other site cuts off what of the cell is in the box, now or after further cuts; where that is so of all its vertices, the cell is
//! complete. A cell is in some ten boxes, which list much the same sites. (Asked for vertex by vertex it had some thirty questions: a million sites of a
//! Plummer cluster with weights of transport took 0.23 s so, now 0.11, the octree not counted; one NVIDIA H100.)

use super::candidates::{Held, key_limit, nearest_held, take_held};
use super::far::{next_unsettled, share_of_all};
use super::search::{NEAR, Vantage, Wanted, gather, search_near};
use super::search_store::{
    HOME_KNOWN, HOME_NOWHERE, LEAVES_AT_ONCE, MOST_CANDIDATES, MOST_OPEN, NO_SITE, OctreeNode, OctreeStore,
    SearchStore, WIDTH,
};
use super::status::{COMPLETE, CUT, EMPTY, UNTOUCHED};
use super::tree::{OctreePlace, octree_box_at};
use super::vector::{Real, Rough, UNIT_ROUNDOFF, V3, add, dot, norm_1};

/// Cuts after which it is looked which of a box's candidates may still cut the cell.
const CUTS_IN_BOX: u32 = 6;

/// Beyond all that is in a container.
#[cfg_attr(opencl, single(1e30))]
const NO_END: Real = 1e300;

/// Completes the cell, whose home is known, by the sites that are listed in the boxes that it is in: `COMPLETE`; `UNTOUCHED` where a box lists none, or
/// a vertex is too near a box's face to tell in which it is: those that are not settled are left to vertex by vertex; or how it ended.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn search_boxes<S: SearchStore + OctreeStore>(s: &mut S, vantage: Vantage, visited: &mut u32) -> u32 {
    let mut place: V3 = vantage.center;
    let mut radius: Real = 0.0;
    let mut looked: u32 = 0;
    let mut is_home: bool = true;
    loop {
        let at: OctreePlace = open_ended(s, octree_box_at(s, add(s.site(), place)));
        if (at.node.count == 0) || !is_in_box(s, at, place, radius) {
            return UNTOUCHED;
        }
        let fresh: u32 = take_fresh(s, at.node, &mut looked);
        let status: u32 = s.visit_leaves(vantage, fresh, is_home, visited);
        if status != UNTOUCHED {
            return status;
        }
        if is_home && s.has_domain() {
            let status: u32 = s.cut_outside(at.diagonal + dot(vantage.center, vantage.center).sqrt());
            if (status != UNTOUCHED) && (status != CUT) {
                return status;
            }
        }
        is_home = false;
        let mut v: u32 = s.lane();
        while v < s.vertices() {
            if !s.settled(v) && is_in_box(s, at, s.position(v), s.radius(v)) {
                s.settle_own(v);
            }
            v += s.lanes();
        }
        s.lanes_wait();
        let mut key: u32 = 0;
        let next: u32 = next_unsettled(s, share_of_all(s), vantage.center, -1.0, &mut key);
        if next == NO_SITE {
            return COMPLETE;
        }
        place = s.position(next);
        radius = s.radius(next);
    }
}

/// Begins the search for the sites that cut the cell, which [`search_far`](super::far::search_far) ends where that is `UNTOUCHED`: box by box where the
/// cell's home is known, or else as [`search_near`].
#[inline]
#[cfg_attr(opencl, hot)]
pub fn search_from<S: SearchStore + OctreeStore>(
    s: &mut S,
    vantage: Vantage,
    what: u32,
    visited: &mut u32,
    proven: &mut Real,
) -> u32 {
    if what == NEAR {
        *proven = 0.0;
        if vantage.home == HOME_NOWHERE {
            return EMPTY;
        }
        if vantage.home == HOME_KNOWN {
            return search_boxes(s, vantage, visited);
        }
    }
    return search_near(s, vantage, what, visited, proven);
}

/// A box, without an end where the container has none beyond it.
#[inline(always)]
fn open_ended<S: OctreeStore>(s: &S, at: OctreePlace) -> OctreePlace {
    let mut open: OctreePlace = at;
    let lo: V3 = s.octree_lo();
    let hi: V3 = s.octree_hi();
    if at.lo.x <= lo.x {
        open.lo.x = -NO_END;
    }
    if at.lo.y <= lo.y {
        open.lo.y = -NO_END;
    }
    if at.lo.z <= lo.z {
        open.lo.z = -NO_END;
    }
    if at.hi.x >= hi.x {
        open.hi.x = NO_END;
    }
    if at.hi.y >= hi.y {
        open.hi.y = NO_END;
    }
    if at.hi.z >= hi.z {
        open.hi.z = NO_END;
    }
    return open;
}

/// Whether what is within `radius` along each axis of a place, from the cell's site, is in a box.
#[inline(always)]
fn is_in_box<S: SearchStore + OctreeStore>(s: &S, at: OctreePlace, place: V3, radius: Real) -> bool {
    let x: V3 = add(s.site(), place);
    let off: Real = (radius + (UNIT_ROUNDOFF * norm_1(x))) - s.octree_off();
    let is_above: bool = ((x.x - off) >= at.lo.x) && (((x.y - off) >= at.lo.y) && ((x.z - off) >= at.lo.z));
    let is_below: bool = ((x.x + off) <= at.hi.x) && (((x.y + off) <= at.hi.y) && ((x.z + off) <= at.hi.z));
    return is_above && is_below;
}

/// Has those leaves at hand that a box lists and that were not looked at, as far as there is room to remember them; returns how many.
#[inline(always)]
fn take_fresh<S: SearchStore + OctreeStore>(s: &mut S, node: OctreeNode, looked: &mut u32) -> u32 {
    let before: u32 = *looked;
    let mut fresh: u32 = 0;
    let mut i: u32 = s.lane();
    while (i - s.lane()) < node.count {
        let mut leaf: u32 = 0;
        let mut is_fresh: bool = false;
        if i < node.count {
            leaf = s.octree_leaf(node.begin + i);
            is_fresh = true;
            for k in 0..before {
                if s.open_block(k) == leaf {
                    is_fresh = false;
                }
            }
        }
        let all: u32 = s.lanes_with(is_fresh);
        let at: u32 = fresh + s.rank_in(all);
        if is_fresh {
            s.set_leaf(at, leaf, 0, 0);
            if (before + at) < MOST_OPEN {
                s.set_open_block(before + at, leaf, 0, 0);
            }
        }
        fresh += s.count_of(all);
        i += s.lanes();
    }
    s.lanes_wait();
    *looked = before + fresh;
    if *looked > MOST_OPEN {
        *looked = MOST_OPEN;
    }
    return fresh;
}

/// Cuts the cell by those sites of so many leaves at hand that may cut it, nearest first as far as there is room for candidates: `UNTOUCHED`, or how it
/// ended. Those that may not are dropped before and in between, each by a lane of its own, but for the first from home, when all may.
///
/// (By the cell's reach alone some 150 to 300 sites were visited, of which 30 cut it, and took half of the time.)
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn visit_leaves<S: SearchStore>(
    s: &mut S,
    vantage: Vantage,
    leaves: u32,
    is_home: bool,
    visited: &mut u32,
) -> u32 {
    let mut reach: Rough = s.square_of_reach(vantage.center);
    let mut limit: u32 = key_limit(s, reach, NO_SITE);
    let mut left: u32 = leaves;
    let mut count: u32 = 0;
    let mut cuts: u32 = 0;
    let mut is_looked_at: bool = is_home;
    while (left > 0) || (count > 0) {
        if (left > 0) && ((count + (LEAVES_AT_ONCE * WIDTH)) <= MOST_CANDIDATES) {
            let mut some: u32 = LEAVES_AT_ONCE;
            if left < some {
                some = left;
            }
            left -= some;
            count = gather(s, vantage, left, some, Wanted { above: 0, below: limit }, count);
            is_looked_at = is_home && (*visited == 0);
        } else {
            if !is_looked_at {
                count = s.drop_held(count);
                is_looked_at = true;
                cuts = 0;
            }
            let held: Held = nearest_held(s, count);
            let least: u32 = s.least_of_lanes(held.key);
            if least >= limit {
                s.lanes_wait();
                count = 0;
            } else {
                let j: u32 = take_held(s, held, least);
                *visited += 1;
                let status: u32 = s.cut_by(j);
                if status == CUT {
                    reach = s.square_of_reach(vantage.center);
                    limit = key_limit(s, reach, NO_SITE);
                    cuts += 1;
                    is_looked_at = cuts < CUTS_IN_BOX;
                } else if status != UNTOUCHED {
                    return status;
                }
            }
        }
    }
    return UNTOUCHED;
}
