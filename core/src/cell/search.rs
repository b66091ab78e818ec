//! The search for the sites that cut a cell, by one lane or by many, over the tree.
//!
//! 1. **Near** ([`search_near`]): from the site's own leaves up the tree to its root, every node that the cell reaches. (On the CPU the sites of a
//!    leaf look about together instead, `core/src/search.rs`: a third of the nodes are opened for each cell.)
//!    Where an octree over the container tells where the cell is, it goes box by box instead ([`super::boxes::search_boxes`]).
//! 2. **Far** ([`super::far::search_far`]): a cell that reaches beyond what is worth that is completed vertex by vertex: which site has the least
//!    power there?
//!
//! # What is proved, and from where
//! Weights that are affine in the site's place only move all cells, by minus half their slope `g`. So a cell is measured from `y = p_i − g/2`, and
//! weights are compared less the slope: with `ω_ij = w_j − w_i − g·(p_j − p_i)` and `D = |p_j − p_i|` the difference of powers at `y` is
//! `h_j(y) − h_i(y) = D² − ω_ij`, and it changes by at most `2D` a length. Site `j` cannot cut what is within `r` of `y` if
//! `D² − ω_ij ≥ 2rD`; as `2rD ≤ λD² + r²/λ` for any `λ`, it suffices that `(1 − λ)D² − ω_ij ≥ r²/λ`, which is a sum over axes and so has a
//! least value over a box. With equal weights `λ = ½` makes it the `D ≥ 2r` of the paper.

use super::candidates::{Held, key_limit, nearest_held, reach_of_site, take_held, visit_candidates};
use super::far::settle_near;
use super::ring::{block_of_site, level_of_block};
use super::search_store::{
    HOME_KNOWN, HOME_UNKNOWN, KEPT_AT_ONCE, LEAVES_AT_ONCE, MOST_CANDIDATES, NO_SITE, NodeBox, NodeWeights,
    SearchStore, WIDTH,
};
use super::status::{COMPLETE, CUT, UNTOUCHED};
use super::sweep::gather_kept;
use super::tree::{Open, Question, open_blocks, open_path, open_top};
use super::vector::{Real, Rough, UNIT_ROUNDOFF, V3, add, dot, larger, scale, smaller, sub, v3};

/// All sites are visited first that are within [`NEAR_SQUARE`] times, as a square, the distance of the `NEAR_SITES`th of the own leaf's block: of white
/// noise some forty.
const NEAR_SITES: u32 = 8;
const NEAR_SQUARE: Real = 2.25;

/// What a key may round off, as a share, and where numbers underflow.
const ROOM_OF_KEY: Real = 1.000004;
const LEAST_OF_KEY: Real = 1e-37;

/// From a key up, what of it is certainly below the square that it was rounded from, where that does not underflow.
const SHARE_OF_KEY: Real = 0.99999;
const LEAST_TO_SHARE: Real = 1e-30;

/// For a cell that then reaches this many times as far, as a square, few leaves or none are looked at before it is completed by its vertices
/// (`SearchStore::leaves_if_far`), and for any so many leaves, or sites, at most. (With 100 instead of 500 a million sites of a Lévy flight take 0.262 s instead of 0.197, with
/// 3,000 on a bumpy surface 0.299 instead of 0.288; one NVIDIA H200.)
const FAR_SQUARE: Real = 500.0;
const MOST_NEAR_LEAVES: u32 = 400;
const MOST_NEAR_SITES: u32 = 400;

/// A cell that then reaches this many times as far, as a square, is cut by what may cut it at a vertex, where the store says so (`SearchStore::is_swept`), and else by all that it reaches: how far a
/// node is takes less to find, but a long cell reaches much that cannot cut it. (8,253 cells of transport in a domain, 300 leaves looked at for each and 11 vertices asked for, then: 4.9 ms, swept 3.8; of a million
/// sites with weights 0.5 |x|² 10,554: 5.1 and 2.0. With 1, 16 and 64: 3.9, 4.9 and 5.5 of the first, 1.9, 2.2 and 3.0 of the second; and with 1 those with -2 |x|² 3.1 instead of 2.8. One NVIDIA H200.)
const SWEPT_SQUARE: Real = 4.0;

/// What is searched: all near a cell, and then what it reaches; sites that are known to bound what is beside it far off, or come from all over; and all that can still cut it at a vertex (`sweep.rs`).
pub const NEAR: u32 = 0;
/// The second.
pub const KEPT: u32 = 1;
/// The third.
pub const SWEEP: u32 = 2;

/// Leaves that are looked at before a sweep is given up, and sites visited: bounds in single precision may tell little apart.
const MOST_SWEPT_LEAVES: u32 = 400;
const MOST_SWEPT_SITES: u32 = 200;

/// Room for the roundings of a limit.
const SAFE: Real = 1.0 + (16.0 * UNIT_ROUNDOFF);

/// The largest curvature of the weights that is reckoned with: of more, near neighbours hide a cell.
pub(crate) const MOST_CURVATURE: Real = 0.96;

/// From where a cell is searched: as weights lead to it, or as an octree over the container tells.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Vantage {
    /// g, the slope of the weights at the site.
    pub slope: V3,
    /// −g/2.
    pub center: V3,
    /// λ.
    pub lambda: Real,
    /// What the octree tells (`HOME_KNOWN`, …).
    pub home: u32,
}

/// From where the cell of a store is searched: its home, as if half the slope led to it; or else the slope and the curvature of the weights of the
/// sites around its own.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn vantage_of<S: SearchStore>(s: &S) -> Vantage {
    let mut vantage: Vantage =
        Vantage { slope: v3(0.0, 0.0, 0.0), center: v3(0.0, 0.0, 0.0), lambda: 0.5, home: HOME_UNKNOWN };
    let mut place: V3 = v3(0.0, 0.0, 0.0);
    vantage.home = s.home(&mut place);
    if vantage.home == HOME_KNOWN {
        vantage.center = place;
        vantage.slope = scale(-2.0, place);
        return vantage;
    }
    if !s.has_weights() {
        return vantage;
    }
    let level: u32 = level_of_block(s.top_level());
    let node: u32 = block_of_site(s.top_level(), s.own_site());
    let bounds: NodeBox = s.node_box(level, node);
    let weights: NodeWeights = s.node_weights(level, node);
    let way: V3 = sub(s.site(), scale(0.5, add(bounds.lo, bounds.hi)));
    let q: V3 = v3(
        smaller(weights.curvature.x, MOST_CURVATURE),
        smaller(weights.curvature.y, MOST_CURVATURE),
        smaller(weights.curvature.z, MOST_CURVATURE),
    );
    let most: Real = larger(larger(larger(q.x, q.y), q.z), 0.0);
    vantage.slope = add(weights.slope, scale(2.0, v3(q.x * way.x, q.y * way.y, q.z * way.z)));
    vantage.center = scale(-0.5, vantage.slope);
    vantage.lambda = 0.5 * (1.0 - most);
    return vantage;
}

/// The size of what is around the site: some three distances between sites.
#[inline(always)]
fn size_around<S: SearchStore>(s: &S) -> Real {
    let leaf: u32 = s.own_site() / WIDTH;
    let own: NodeBox = s.node_box(0, leaf);
    let extent: V3 = sub(own.hi, own.lo);
    let mut size: Real = 0.8 * dot(extent, extent).sqrt();
    if s.top_level() > 0 {
        let block: NodeBox = s.node_box(1, leaf / WIDTH);
        let around: V3 = sub(block.hi, block.lo);
        size = larger(size, 0.4 * dot(around, around).sqrt());
    }
    return size;
}

/// What becomes a candidate of the sites that are met: keys from `above` on and below `below`.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct Wanted {
    pub(super) above: u32,
    pub(super) below: u32,
}

/// Cuts the cell by the sites that it reaches (`what` is `NEAR`): `COMPLETE`, as it may be when those near have cut it; `UNTOUCHED` where that is not worth while; or how it ended. By those that are `KEPT`: `UNTOUCHED`, or how
/// it ended. By all that can cut it at a vertex that is not settled (`SWEEP`): as the first.
///
/// Near, first come all sites near, then the rest; each time nearest first, as far as there is room for candidates. Were a cell cut by those of its
/// own leaf's block before, one at the block's edge would be open to the other side, and be tried with all that there is.
///
/// `proven` then becomes the square of twice the radius about the vantage's center within which no other site can cut the cell.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn search_near<S: SearchStore>(
    s: &mut S,
    vantage: Vantage,
    what: u32,
    visited: &mut u32,
    proven: &mut Real,
) -> u32 {
    let mut near: Real = 0.0;
    let mut wanted: Wanted = Wanted { above: 0, below: NO_SITE };
    let mut open: Open = Open { blocks: 0, leaves: 0 };
    let mut count: u32 = 0;
    let mut most_leaves: u32 = MOST_NEAR_LEAVES;
    let mut most_sites: u32 = MOST_NEAR_SITES;
    if what == NEAR {
        *proven = 0.0;
        wanted.below = near_key(s, vantage, &mut near);
        open = open_path(s);
    } else if what == SWEEP {
        open = open_top(s, 0);
        most_leaves = MOST_SWEPT_LEAVES;
        most_sites = *visited + MOST_SWEPT_SITES;
    }
    let mut reach: Rough = s.square_of_reach(vantage.center);
    let mut is_rest: bool = false;
    let mut sweeps: bool = false;
    let mut looked: u32 = 0;
    let mut gathered: u32 = 0;
    let checks: bool = (what != NEAR) || s.checks_near();
    loop {
        let is_batch: bool = (open.leaves >= LEAVES_AT_ONCE) || ((open.leaves > 0) && (open.blocks == 0));
        if is_batch && ((count + (LEAVES_AT_ONCE * WIDTH)) <= MOST_CANDIDATES) {
            let mut some: u32 = LEAVES_AT_ONCE;
            if open.leaves < some {
                some = open.leaves;
            }
            open.leaves -= some;
            let mut limit: u32 = wanted.below;
            if what == NEAR {
                limit = key_limit(s, reach, limit);
            }
            count = gather(s, vantage, open.leaves, some, Wanted { above: wanted.above, below: limit }, count);
            looked += some;
            if looked > most_leaves {
                return UNTOUCHED;
            }
        } else if !is_batch && (open.blocks > 0) {
            let mut within: Real = reach;
            if !is_rest {
                within = smaller(reach, near);
            }
            let question: Question = Question {
                square: 1.0 - vantage.lambda,
                slope: vantage.slope,
                limit: ((0.25 * within) / vantage.lambda) * SAFE,
                vertices: 0,
                sweeps: (what == SWEEP) || sweeps,
                opens_own: what == SWEEP,
            };
            open = open_blocks(s, question, open);
        } else if count > 0 {
            let status: u32 = visit_candidates(s, vantage.center, count, wanted.below, checks, &mut reach, visited);
            if status != UNTOUCHED {
                return status;
            }
            s.lanes_wait();
            count = 0;
            if (what != SWEEP) && checks {
                reach = s.square_of_reach(vantage.center);
            }
            if *visited > most_sites {
                return UNTOUCHED;
            }
        } else if (what == NEAR) && !is_rest {
            if near > LEAST_TO_SHARE {
                *proven = SHARE_OF_KEY * near;
            }
            if s.has_domain() {
                let status: u32 = s.cut_outside(size_around(s) + dot(vantage.center, vantage.center).sqrt());
                if (status != UNTOUCHED) && (status != CUT) {
                    return status;
                }
                reach = s.square_of_reach(vantage.center);
            }
            if reach <= *proven {
                return COMPLETE;
            }
            if reach > (FAR_SQUARE * near) {
                let few: u32 = s.leaves_if_far();
                if few == 0 {
                    return UNTOUCHED;
                }
                if (looked + few) < most_leaves {
                    most_leaves = looked + few;
                }
            }
            is_rest = true;
            sweeps = s.is_swept() && (reach > (SWEPT_SQUARE * near));
            if sweeps {
                settle_near(s, vantage.center, *proven);
            }
            wanted.above = wanted.below;
            wanted.below = NO_SITE;
            open = open_path(s);
        } else if what == KEPT {
            if gathered == s.kept_count() {
                return UNTOUCHED;
            }
            let mut some: u32 = s.kept_count() - gathered;
            if some > KEPT_AT_ONCE {
                some = KEPT_AT_ONCE;
            }
            count = gather_kept(s, vantage, gathered, some, key_limit(s, reach, NO_SITE));
            gathered += some;
        } else {
            return COMPLETE;
        }
    }
}

/// The key below which sites are near; all that have one have a `reach_of_site` below `near`.
#[inline]
#[cfg_attr(opencl, hot)]
fn near_key<S: SearchStore>(s: &mut S, vantage: Vantage, near: &mut Real) -> u32 {
    let all: Wanted = Wanted { above: 0, below: NO_SITE };
    let open: Open = open_path(s);
    let mut leaves: u32 = open.leaves;
    let mut count: u32 = 0;
    while leaves > 0 {
        let mut some: u32 = LEAVES_AT_ONCE;
        if leaves < some {
            some = leaves;
        }
        leaves -= some;
        count = gather(s, vantage, leaves, some, all, count);
    }
    let mut last: u32 = s.own_site();
    let mut turn: u32 = 0;
    while (turn < NEAR_SITES) && (turn < count) {
        let held: Held = nearest_held(s, count);
        last = take_held(s, held, s.least_of_lanes(held.key));
        turn += 1;
    }
    if turn == 0 {
        return 0;
    }
    let square: Real = NEAR_SQUARE * larger(reach_of_site(s, vantage.slope, last), 0.0);
    *near = (ROOM_OF_KEY * square) + LEAST_OF_KEY;
    return s.key_below(square) + 1;
}

/// Adds those sites of some leaves at hand that are wanted to the candidates, of which there are `count`; returns how many there are now.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn gather<S: SearchStore>(
    s: &mut S,
    vantage: Vantage,
    first: u32,
    leaves: u32,
    wanted: Wanted,
    count: u32,
) -> u32 {
    let mut there: u32 = count;
    let mut i: u32 = s.lane();
    while (i - s.lane()) < (leaves * WIDTH) {
        let mut j: u32 = NO_SITE;
        if i < (leaves * WIDTH) {
            j = (s.leaf(first + (i / WIDTH)) * WIDTH) + (i & (WIDTH - 1));
        }
        let mut key: u32 = NO_SITE;
        let mut is_wanted: bool = false;
        if (j < s.sites()) && (j != s.own_site()) {
            key = s.key_below(reach_of_site(s, vantage.slope, j));
            is_wanted = (key >= wanted.above) && (key < wanted.below);
        }
        let all: u32 = s.lanes_with(is_wanted);
        if is_wanted {
            s.set_candidate(there + s.rank_in(all), j, key);
        }
        there += s.count_of(all);
        i += s.lanes();
    }
    s.lanes_wait();
    return there;
}
