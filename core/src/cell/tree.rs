//! The tree over the sites, opened from its root or along the way to a cell's site, as far as the search asks for.

use super::bound::{Seer, least_of_node, least_power_of_node};
use super::octree::{middle_of, part_hi, part_lo};
use super::search_store::{Asked, HAS_PARTS, NO_SITE, OctreeNode, OctreeStore, SearchStore, UNLISTED, WIDTH};
use super::sweep::may_cut;
use super::vector::{Real, V3, dot, sub};

/// Bits of an open block that say which of its level it is; those above say its level.
const LEVEL_SHIFT: u32 = 28;
const BLOCK_MASK: u32 = 0x0FFF_FFFF;

/// Open blocks from which on one is taken at a time: of four every child may be open, and of one on each level seven of eight.
const FEW_OPEN: u32 = 32;

/// What is asked of a site at the way `d`, of excess `w`: whether `αd² + g·d − w` is below a limit; or of the asked vertices whose bits are in
/// `vertices`, whether its power there is below theirs.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct Question {
    /// α.
    pub(super) square: Real,
    /// g.
    pub(super) slope: V3,
    pub(super) limit: Real,
    /// 0 where no vertex is asked for.
    pub(super) vertices: u32,
    /// Whether it is instead whether a site may cut the cell at a vertex that is not settled.
    pub(super) sweeps: bool,
    /// Whether nodes that hold the site's own leaf's block are opened, too.
    pub(super) opens_own: bool,
}

/// The open blocks and the leaves at hand.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct Open {
    pub(super) blocks: u32,
    pub(super) leaves: u32,
}

/// The site whose cell is searched.
#[inline(always)]
fn seer_of<S: SearchStore>(s: &S) -> Seer {
    return Seer { site: s.site(), excess: s.own_excess(), has_weights: s.has_weights() };
}

/// A box of the octree over the container.
#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct OctreePlace {
    pub(crate) lo: V3,
    pub(crate) hi: V3,
    /// Of it.
    pub(crate) diagonal: Real,
    /// What it lists.
    pub(crate) node: OctreeNode,
}

/// The box that a place is in; of no leaves where none are listed, or that is out of the container.
#[inline(always)]
pub(crate) fn octree_box_at<S: OctreeStore>(s: &S, place: V3) -> OctreePlace {
    let off: Real = s.octree_off();
    let mut lo: V3 = s.octree_lo();
    let mut hi: V3 = s.octree_hi();
    let is_above: bool = (place.x >= (lo.x - off)) && ((place.y >= (lo.y - off)) && (place.z >= (lo.z - off)));
    let is_below: bool = (place.x <= (hi.x + off)) && ((place.y <= (hi.y + off)) && (place.z <= (hi.z + off)));
    let mut node: OctreeNode = OctreeNode { begin: 0, count: 0 };
    if is_above && is_below {
        node = s.octree_node(0);
    }
    while node.count == HAS_PARTS {
        let middle: V3 = middle_of(lo, hi);
        let mut octant: u32 = 0;
        if place.x >= middle.x {
            octant += 1;
        }
        if place.y >= middle.y {
            octant += 2;
        }
        if place.z >= middle.z {
            octant += 4;
        }
        let corner: V3 = part_lo(lo, hi, octant);
        hi = part_hi(lo, hi, octant);
        lo = corner;
        node = s.octree_node(node.begin + octant);
    }
    if node.count == UNLISTED {
        node.count = 0;
    }
    let extent: V3 = sub(hi, lo);
    return OctreePlace { lo: lo, hi: hi, diagonal: dot(extent, extent).sqrt(), node: node };
}

/// Where the sites that may have less power at the asked vertex are listed, has their leaves at hand. Else it opens, for some asked vertices, the lowest
/// level of which the lanes take all blocks at one time: the root, where there is one lane.
#[inline(always)]
pub(super) fn open_top<S: SearchStore>(s: &mut S, vertices: u32) -> Open {
    let listed: u32 = s.set_listed_leaves(vertices);
    if listed > 0 {
        return Open { blocks: 0, leaves: listed };
    }
    let mut level: u32 = s.top_level();
    let mut blocks: u32 = 1;
    // (A level has eight times as many nodes, so at most eight times as many blocks.)
    let last: u32 = (s.sites() - 1) / (WIDTH * WIDTH);
    while (level > 0) && (((last >> (3 * (level - 1))) * WIDTH) < s.lanes()) {
        level -= 1;
        blocks = (last >> (3 * level)) + 1;
    }
    if s.lane() < blocks {
        s.set_open_block(s.lane(), (level << LEVEL_SHIFT) | s.lane(), 0, vertices);
    }
    s.lanes_wait();
    return Open { blocks: blocks, leaves: 0 };
}

/// Opens the blocks that hold the cell's own site, but for that of its leaf, whose leaves are at hand: the nearest last.
#[inline(always)]
pub(super) fn open_path<S: SearchStore>(s: &mut S) -> Open {
    let own: u32 = s.own_site() / (WIDTH * WIDTH);
    let mut open: Open = Open { blocks: 0, leaves: 0 };
    let mut level: u32 = s.top_level();
    while level > 0 {
        s.set_open_block(open.blocks, (level << LEVEL_SHIFT) | (own >> (3 * level)), 0, 0);
        open.blocks += 1;
        level -= 1;
    }
    let first: u32 = own * WIDTH;
    while (open.leaves < WIDTH) && (((first + open.leaves) * WIDTH) < s.sites()) {
        s.set_leaf(open.leaves, first + open.leaves, 0, 0);
        open.leaves += 1;
    }
    s.lanes_wait();
    return open;
}

/// Keeps of the open blocks, or of the leaves at hand, those where one of some vertices is still asked for, of the first alone only where the least
/// power is below its limit; returns how many of the `count` are left.
#[inline(always)]
fn keep_asked<S: SearchStore>(s: &mut S, is_leaf: bool, vertices: u32, count: u32) -> u32 {
    let limit: u32 = s.key_above(s.asked(0).limit);
    let mut kept: u32 = 0;
    let mut i: u32 = s.lane();
    while (i - s.lane()) < count {
        let mut number: u32 = 0;
        let mut key: u32 = NO_SITE;
        let mut asks: u32 = 0;
        if i < count {
            if is_leaf {
                number = s.leaf(i);
                key = s.leaf_key(i);
                asks = s.leaf_asks(i) & vertices;
            } else {
                number = s.open_block(i);
                key = s.open_key(i);
                asks = s.open_asks(i) & vertices;
            }
        }
        let is_kept: bool = (asks > 1) || ((asks == 1) && (key <= limit));
        let all: u32 = s.lanes_with(is_kept);
        s.lanes_wait();
        if is_kept {
            if is_leaf {
                s.set_leaf(kept + s.rank_in(all), number, key, asks);
            } else {
                s.set_open_block(kept + s.rank_in(all), number, key, asks);
            }
        }
        kept += s.count_of(all);
        i += s.lanes();
    }
    s.lanes_wait();
    return kept;
}

/// What of it is still asked for, some vertices being left, where the first one's limit is less than before or a vertex is not asked for any more.
#[inline(always)]
pub(super) fn still_asked<S: SearchStore>(s: &mut S, vertices: u32, open: Open) -> Open {
    return Open {
        blocks: keep_asked(s, false, vertices, open.blocks),
        leaves: keep_asked(s, true, vertices, open.leaves),
    };
}

/// Those of some asked vertices, a bit each, at which a site of a node may have a power below their limit; and the key of the least of those.
#[inline(always)]
pub(crate) fn asks_by_powers<S: SearchStore>(s: &S, level: u32, node: u32, of_block: u32, key: &mut u32) -> u32 {
    let mut asks: u32 = 0;
    let mut least: u32 = NO_SITE;
    let mut rest: u32 = of_block;
    let mut i: u32 = 0;
    while rest != 0 {
        if (rest & 1) != 0 {
            let its: Asked = s.asked(i);
            let power: Real = least_power_of_node(
                seer_of(s),
                its.place,
                s.node_box(level, node),
                s.node_slab(level, node),
                s.node_weights(level, node),
            );
            if power < its.limit {
                asks = asks | (1 << i);
                let its_key: u32 = s.key_below(power);
                if its_key < least {
                    least = its_key;
                }
            }
        }
        rest = rest >> 1;
        i += 1;
    }
    *key = least;
    return asks;
}

/// Puts the children of the last open blocks, as many as there are lanes for, in the place of these, where a question can come to less than its
/// limit there; leaves to those at hand. Without the nodes that hold the site's own leaf's block, unless the question opens them, too. Where a
/// vertex is asked for the least of the blocks is the last.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn open_blocks<S: SearchStore>(s: &mut S, question: Question, given: Open) -> Open {
    let mut open: Open = given;
    let lanes: u32 = s.lanes();
    let mut some: u32 = 1;
    if (lanes > WIDTH) && (open.blocks <= FEW_OPEN) {
        some = lanes / WIDTH;
        if some > open.blocks {
            some = open.blocks;
        }
    }
    open.blocks -= some;
    let turn: u32 = s.lane() / WIDTH;
    let mut is_there: bool = false;
    let mut block: u32 = 0;
    let mut of_block: u32 = 0;
    if turn < some {
        is_there = true;
        block = s.open_block(open.blocks + turn);
        of_block = s.open_asks(open.blocks + turn);
    }
    s.lanes_wait();
    let level: u32 = block >> LEVEL_SHIFT;
    let first: u32 = (block & BLOCK_MASK) * WIDTH;
    // Of the nodes of the level, that which holds the own leaf's block.
    let mut own: u32 = 0xFFFF_FFFF;
    if !question.opens_own {
        own = (s.own_site() / WIDTH) >> (3 * level);
    }
    let mut best: u32 = NO_SITE;
    let mut best_at: u32 = 0;
    let mut k: u32 = s.lane() & (WIDTH - 1);
    while k < WIDTH {
        let node: u32 = first + k;
        let mut is_wanted: bool = false;
        let mut key: u32 = 0;
        let mut asks: u32 = 0;
        if is_there && (node != own) {
            if question.vertices != 0 {
                asks = s.asks_of_node(level, node, of_block, &mut key);
                is_wanted = asks != 0;
            } else if question.sweeps {
                is_wanted = may_cut(s, seer_of(s), level, node);
            } else {
                let least: Real = least_of_node(
                    seer_of(s),
                    question.square,
                    question.slope,
                    s.node_box(level, node),
                    s.node_weights(level, node),
                );
                is_wanted = least < question.limit;
            }
        }
        let is_block: bool = is_wanted && (level > 0);
        let is_leaf: bool = is_wanted && (level == 0);
        let blocks: u32 = s.lanes_with(is_block);
        let leaves: u32 = s.lanes_with(is_leaf);
        if is_block {
            let at: u32 = open.blocks + s.rank_in(blocks);
            s.set_open_block(at, ((level - 1) << LEVEL_SHIFT) | node, key, asks);
            if key < best {
                best = key;
                best_at = at;
            }
        }
        if is_leaf {
            s.set_leaf(open.leaves + s.rank_in(leaves), node, key, asks);
        }
        open.blocks += s.count_of(blocks);
        open.leaves += s.count_of(leaves);
        k += lanes;
    }
    s.lanes_wait();
    // (Few are all opened next.)
    if (question.vertices != 0) && ((open.blocks * WIDTH) > lanes) {
        let least: u32 = s.least_of_lanes(best);
        if least != NO_SITE {
            let at: u32 = s.lane_value(best_at, s.first_of(s.lanes_with(best == least)));
            let last: u32 = open.blocks - 1;
            let nearest: u32 = s.open_block(at);
            let other: u32 = s.open_block(last);
            let other_key: u32 = s.open_key(last);
            let nearest_asks: u32 = s.open_asks(at);
            let other_asks: u32 = s.open_asks(last);
            s.lanes_wait();
            if s.lane() == 0 {
                s.set_open_block(at, other, other_key, other_asks);
                s.set_open_block(last, nearest, least, nearest_asks);
            }
            s.lanes_wait();
        }
    }
    return open;
}
