//! Sites that may cut the cell, each with a key: the smaller, the earlier the site had better cut. Each lane holds some of them.

use super::bound::reach_of_bisector;
use super::search_store::{NO_SITE, SearchStore};
use super::status::{CUT, UNTOUCHED};
use super::vector::{Real, Rough, V3, dot};

/// Lanes that hold a candidate within reach, at least, for that to be worth while.
const WORTH_A_LOOK: u32 = 4;

/// One of the candidates that a lane holds.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct Held {
    /// Its key, or `NO_SITE` of none.
    pub key: u32,
    /// Its number.
    pub number: u32,
}

/// What `reach_of_bisector` says of site `j`, from where weights of some slope have the cell.
#[inline(always)]
pub(super) fn reach_of_site<S: SearchStore>(s: &S, slope: V3, j: u32) -> Real {
    let d: V3 = s.way_to(j);
    if !s.has_weights() {
        return dot(d, d);
    }
    return reach_of_bisector(slope, d, s.excess_of(j));
}

/// The nearest of the candidates that this lane holds: not alike.
#[inline(always)]
pub(super) fn nearest_held<S: SearchStore>(s: &S, count: u32) -> Held {
    let mut nearest: Held = Held { key: NO_SITE, number: 0 };
    for c in 0..s.held(count) {
        let key: u32 = s.held_key(c);
        if key < nearest.key {
            nearest.key = key;
            nearest.number = c;
        }
    }
    return nearest;
}

/// Takes the nearest of the lanes' candidates out, whose key is `least`; returns its site.
#[inline(always)]
pub(super) fn take_held<S: SearchStore>(s: &mut S, held: Held, least: u32) -> u32 {
    let from: u32 = s.lane_of_key(held.key, least);
    let j: u32 = s.lane_value(s.held_site(held.number), from);
    if s.lane() == from {
        s.let_go(held.number);
    }
    return j;
}

/// Cuts the cell by those candidates that it reaches, nearest first: `UNTOUCHED`, or how it ended. `reach` is the square of its reach, before and
/// after. Where it `checks`, it is instead by all but those that are known to leave it untouched, whatever they reach, and `reach` stays what it was.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn visit_candidates<S: SearchStore>(
    s: &mut S,
    center: V3,
    count: u32,
    below: u32,
    checks: bool,
    reach: &mut Rough,
    visited: &mut u32,
) -> u32 {
    let mut limit: u32 = below;
    let mut cuts: u32 = 0;
    let mut there: u32 = count;
    if checks {
        there = s.drop_held(there);
    } else {
        limit = key_limit(s, *reach, below);
        // (What remains when some were visited before is looked at soon.)
        cuts = *visited;
    }
    loop {
        let held: Held = nearest_held(s, there);
        let least: u32 = s.least_of_lanes(held.key);
        if least >= limit {
            return UNTOUCHED;
        }
        let j: u32 = take_held(s, held, least);
        let mut status: u32 = UNTOUCHED;
        if !checks || !s.was_tried(j) {
            *visited += 1;
            status = s.cut_by(j);
        }
        if status == CUT {
            if !checks {
                *reach = s.square_of_reach(center);
                limit = key_limit(s, *reach, below);
            }
            cuts += 1;
        } else if status != UNTOUCHED {
            return status;
        } else if checks {
            // (After each cut sites on a bumpy surface took 4 % longer, one NVIDIA H200.)
            if cuts > 0 {
                there = s.drop_held(there);
            }
            cuts = 0;
        } else if cuts >= s.cuts_before_look() {
            if s.count_of(s.lanes_with(held.key < limit)) >= WORTH_A_LOOK {
                there = s.drop_held(there);
            }
            cuts = 0;
        }
    }
}

/// The key from which on sites cannot cut the cell, or `below` if that is less.
#[inline(always)]
pub(super) fn key_limit<S: SearchStore>(s: &S, reach: Rough, below: u32) -> u32 {
    let key: u32 = s.key_of_reach(reach);
    if below < key {
        return below;
    }
    return key;
}
