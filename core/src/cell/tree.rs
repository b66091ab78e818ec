//! What the tree over the sites knows of those of a node: the least value there of what the search asks for.

use super::quadratic::{FEW_ROUNDINGS_OF_SUM, add_least};
use super::search_store::{NO_SITE, NodeBox, NodeSlab, NodeWeights, SearchStore, WIDTH};
use super::vector::{Real, UNIT_ROUNDOFF, V3, dot, larger, scale, sub, v3};

/// Bits of an open block that say which of its level it is; those above say its level.
const LEVEL_SHIFT: u32 = 28;
const BLOCK_MASK: u32 = 0x0FFF_FFFF;

/// Open blocks from which on one is taken at a time: of four every child may be open, and of one on each level seven of eight.
const FEW_OPEN: u32 = 32;

/// What is asked of a site at the way `d`, of excess `w`: whether `α|d − v|² + g·d − w` is below a limit.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct Question {
    /// α.
    pub(super) square: Real,
    /// g.
    pub(super) slope: V3,
    pub(super) limit: Real,
    /// v; where it is not the cell's own site, α is 1 and g 0: the power at v, and 1.
    pub(super) place: V3,
    pub(super) is_power: u32,
}

/// The open blocks and the leaves at hand.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct Open {
    pub(super) blocks: u32,
    pub(super) leaves: u32,
}

/// How far `place` is from the range `[lo, hi]`, at least.
#[inline(always)]
fn gap_along(lo: Real, hi: Real, place: Real) -> Real {
    let rounding: Real = (16.0 * UNIT_ROUNDOFF) * (place.abs() + larger(lo.abs(), hi.abs()));
    return larger(larger(lo - place, place - hi) - rounding, 0.0);
}

/// The square of how far `place` is from the box `[lo, hi]`, at least.
#[inline(always)]
fn square_to_box(lo: V3, hi: V3, place: V3) -> Real {
    let x: Real = gap_along(lo.x, hi.x, place.x);
    let y: Real = gap_along(lo.y, hi.y, place.y);
    let z: Real = gap_along(lo.z, hi.z, place.z);
    return ((x * x) + (y * y)) + (z * z);
}

/// The least that a question can come to at any site of a node.
///
/// With `h` at most the gap between `v` and the node's slab, across its normal `n`, `|v − p|² ≥ h² + |(v − hn) − p|²`: the box is seen from the
/// foot of `v` on the slab, unless weights differ, when that often says less (c = 0.9 took 30 times as long on far cells).
#[inline(always)]
pub(super) fn least_of_node<S: SearchStore>(s: &S, question: Question, level: u32, node: u32) -> Real {
    let bounds: NodeBox = s.node_box(level, node);
    let site: V3 = s.site();
    let lo: V3 = sub(bounds.lo, site);
    let hi: V3 = sub(bounds.hi, site);
    let place: V3 = question.place;
    let mut foot: V3 = place;
    let mut beyond: Real = 0.0;
    let mut largest: Real = 0.0;
    if question.is_power != 0 {
        let slab: NodeSlab = s.node_slab(level, node);
        let from: V3 = v3(site.x + place.x, site.y + place.y, site.z + place.z);
        let height: Real = dot(slab.normal, from);
        let rounding: Real = FEW_ROUNDINGS_OF_SUM * ((from.x.abs() + from.y.abs()) + from.z.abs());
        let across: Real = larger((height - slab.hi) - rounding, 0.0) - larger((slab.lo - height) - rounding, 0.0);
        foot = sub(place, scale(across, slab.normal));
        beyond = (across * across) * (1.0 - FEW_ROUNDINGS_OF_SUM);
        largest = slab.largest;
    }
    if s.has_weights() == 0 {
        // (Where it is not the power, nothing is beyond.)
        return ((question.square * square_to_box(lo, hi, foot)) + beyond) * (1.0 - FEW_ROUNDINGS_OF_SUM);
    }
    let weights: NodeWeights = s.node_weights(level, node);
    let g: V3 = sub(question.slope, scale(2.0, place));
    let alpha: Real = question.square;
    let mut sum: Real = dot(place, place);
    let mut size: Real = sum;
    add_least(lo.x, hi.x, alpha, g.x, weights.slope.x, weights.curvature.x, &mut sum, &mut size);
    add_least(lo.y, hi.y, alpha, g.y, weights.slope.y, weights.curvature.y, &mut sum, &mut size);
    add_least(lo.z, hi.z, alpha, g.z, weights.slope.z, weights.curvature.z, &mut sum, &mut size);
    sum += s.own_excess() - weights.offset;
    size += s.own_excess() + weights.offset.abs();
    sum = sum - (FEW_ROUNDINGS_OF_SUM * size);
    if question.is_power != 0 {
        let rounding: Real = FEW_ROUNDINGS_OF_SUM * (largest.abs() + s.own_excess());
        sum = larger(sum, (beyond - (largest - s.own_excess())) - rounding);
    }
    return sum;
}

/// Opens the root alone.
#[inline(always)]
pub(super) fn open_root<S: SearchStore>(s: &mut S) -> Open {
    s.set_open_block(0, s.top_level() << LEVEL_SHIFT, 0);
    s.lanes_wait();
    return Open { blocks: 1, leaves: 0 };
}

/// Opens the blocks that hold the cell's own site, but for that of its leaf, whose leaves are at hand: the nearest last.
#[inline(always)]
pub(super) fn open_path<S: SearchStore>(s: &mut S) -> Open {
    let own: u32 = s.own_site() / (WIDTH * WIDTH);
    let mut open: Open = Open { blocks: 0, leaves: 0 };
    let mut level: u32 = s.top_level();
    while level > 0 {
        s.set_open_block(open.blocks, (level << LEVEL_SHIFT) | (own >> (3 * level)), 0);
        open.blocks += 1;
        level -= 1;
    }
    let first: u32 = own * WIDTH;
    while (open.leaves < WIDTH) && (((first + open.leaves) * WIDTH) < s.sites()) {
        s.set_leaf(open.leaves, first + open.leaves, 0);
        open.leaves += 1;
    }
    s.lanes_wait();
    return open;
}

/// Keeps of the last open blocks, or of the leaves at hand, those that may come to less than `limit`: so many at most, the last first, behind the
/// `count` that are left, which it lowers. Returns how many.
#[inline(always)]
pub(super) fn take_last<S: SearchStore>(s: &mut S, is_leaf: u32, limit: Real, most: u32, count: &mut u32) -> u32 {
    let there: u32 = *count;
    let mut mine: u32 = 0;
    let mut key: u32 = NO_SITE;
    if s.lane() < there {
        let at: u32 = (there - 1) - s.lane();
        if is_leaf != 0 {
            mine = s.leaf(at);
            key = s.leaf_key(at);
        } else {
            mine = s.open_block(at);
            key = s.open_key(at);
        }
    }
    let mut is_taken: u32 = ((s.lane() < there) && (key <= s.key_above(limit))) as u32;
    let all: u32 = s.lanes_with(is_taken);
    let rank: u32 = s.rank_in(all);
    if rank >= most {
        is_taken = 0;
    }
    let taken: u32 = s.lanes_with(is_taken);
    let last: u32 = s.lanes_with(((is_taken != 0) && ((rank + 1) == most)) as u32);
    let mut looked: u32 = s.lanes();
    if last != 0 {
        looked = s.first_of(last) + 1;
    }
    if looked > there {
        looked = there;
    }
    *count = there - looked;
    if is_taken != 0 {
        if is_leaf != 0 {
            s.set_leaf((there - looked) + rank, mine, key);
        } else {
            s.set_open_block((there - looked) + rank, mine, key);
        }
    }
    s.lanes_wait();
    return s.count_of(taken);
}

/// Puts the children of the last open blocks, as many as there are lanes for, in the place of these, where a question can come to less than its
/// limit there; leaves to those at hand. Without the nodes that hold the site's own leaf's block, where these are not asked for. Where the
/// power is asked for, the least of the blocks is the last.
#[inline]
pub(super) fn open_blocks<S: SearchStore>(s: &mut S, question: Question, with_own: u32, given: Open) -> Open {
    let mut open: Open = given;
    let lanes: u32 = s.lanes();
    let mut some: u32 = 1;
    if (lanes > WIDTH) && (open.blocks <= FEW_OPEN) {
        some = lanes / WIDTH;
        if some > open.blocks {
            some = open.blocks;
        }
    }
    if question.is_power != 0 {
        some = take_last(s, 0, question.limit, some, &mut open.blocks);
    } else {
        open.blocks -= some;
    }
    let turn: u32 = s.lane() / WIDTH;
    let mut is_there: u32 = 0;
    let mut block: u32 = 0;
    if turn < some {
        is_there = 1;
        block = s.open_block(open.blocks + turn);
    }
    s.lanes_wait();
    let level: u32 = block >> LEVEL_SHIFT;
    let first: u32 = (block & BLOCK_MASK) * WIDTH;
    // Of the nodes of the level, that which holds the own leaf's block.
    let mut own: u32 = 0xFFFF_FFFF;
    if with_own == 0 {
        own = (s.own_site() / WIDTH) >> (3 * level);
    }
    let mut best: u32 = NO_SITE;
    let mut best_at: u32 = 0;
    let mut k: u32 = s.lane() & (WIDTH - 1);
    while k < WIDTH {
        let node: u32 = first + k;
        let mut is_block: u32 = 0;
        let mut is_leaf: u32 = 0;
        let mut key: u32 = 0;
        if (is_there != 0) && (node != own) {
            let least: Real = least_of_node(s, question, level, node);
            if question.is_power != 0 {
                key = s.key_below(least);
            }
            if least < question.limit {
                is_block = 1;
                if level == 0 {
                    is_block = 0;
                    is_leaf = 1;
                }
            }
        }
        let blocks: u32 = s.lanes_with(is_block);
        let leaves: u32 = s.lanes_with(is_leaf);
        if is_block != 0 {
            let at: u32 = open.blocks + s.rank_in(blocks);
            s.set_open_block(at, ((level - 1) << LEVEL_SHIFT) | node, key);
            if key < best {
                best = key;
                best_at = at;
            }
        }
        if is_leaf != 0 {
            s.set_leaf(open.leaves + s.rank_in(leaves), node, key);
        }
        open.blocks += s.count_of(blocks);
        open.leaves += s.count_of(leaves);
        k += lanes;
    }
    s.lanes_wait();
    // (Few are all opened next.)
    if (question.is_power != 0) && ((open.blocks * WIDTH) > lanes) {
        let least: u32 = s.least_of_lanes(best);
        if least != NO_SITE {
            let at: u32 = s.lane_value(best_at, s.first_of(s.lanes_with((best == least) as u32)));
            let last: u32 = open.blocks - 1;
            let nearest: u32 = s.open_block(at);
            let other: u32 = s.open_block(last);
            let other_key: u32 = s.open_key(last);
            s.lanes_wait();
            if s.lane() == 0 {
                s.set_open_block(at, other, other_key);
                s.set_open_block(last, nearest, least);
            }
            s.lanes_wait();
        }
    }
    return open;
}
