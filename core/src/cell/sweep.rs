//! The end of the far search (`far.rs`): all sites that can still cut the cell at any of its vertices, in one descent of the tree.
//!
//! The difference of two powers is linear in the place. So a site that has less power than the cell's own anywhere in the cell has less at one of its
//! vertices; and what a site cannot cut of a cell, it cannot of what others leave of it. A node is opened if a site of it may have less power at
//! a vertex that is not settled, and when none is left all that can cut the cell have.
//!
//! The vertices of a cell ask for much the same nodes. What that gains, and when, is in `README.md`.

use super::candidates::reach_of_site;
use super::search::Vantage;
use super::search_store::{NO_SITE, NodeBox, NodeSlab, RoughVertex, SearchStore};
use super::vector::{Real, Rough, V3, dot, sub};

/// What single precision rounds off, of the size of what is added, at most: sixteen roundings.
const SWEEP_ROUNDINGS: Rough = 1e-6;
const SWEEP_OUTWARD: Real = 1e-6;
/// Where its squares underflow.
const SWEEP_LEAST_SQUARE: Rough = 1e-30;
const SWEEP_ONE: Rough = 1.0;
const SWEEP_EIGHT: Rough = 8.0;
const SWEEP_SIXTEEN: Rough = 16.0;
const SWEEP_NOTHING: Rough = 0.0;

/// A place in single precision, from the cell's site.
#[repr(C)]
#[derive(Clone, Copy)]
struct RoughPlace {
    x: Rough,
    y: Rough,
    z: Rough,
}

/// What holds a node's sites, from the cell's: a box, and a slab `below ≤ n·x ≤ above`.
#[repr(C)]
#[derive(Clone, Copy)]
struct RoughNode {
    lo: RoughPlace,
    hi: RoughPlace,
    normal: RoughPlace,
    below: Rough,
    above: Rough,
}

/// Makes the sites that bound another cell far off candidates; returns how many they are.
#[inline(always)]
pub(super) fn gather_kept<S: SearchStore>(s: &mut S, vantage: Vantage) -> u32 {
    let count: u32 = s.kept_count();
    let mut i: u32 = s.lane();
    while i < count {
        let j: u32 = s.kept_site(i);
        let mut key: u32 = NO_SITE;
        if j != s.own_site() {
            key = s.key_below(reach_of_site(s, vantage.slope, j));
        }
        s.set_candidate(i, j, key);
        i += s.lanes();
    }
    s.lanes_wait();
    return count;
}

/// Whether a site of a node may have less power than the cell's own at a vertex that is not settled; of weights that are all the same.
#[inline(always)]
pub(super) fn may_cut<S: SearchStore>(s: &S, level: u32, node: u32) -> bool {
    let its: RoughNode = seen_roughly(s.site(), s.node_box(level, node), s.node_slab(level, node));
    let mut may: bool = false;
    for v in 0..s.vertices() {
        if !s.settled(v) && may_cut_at(its, s.rough_vertex(v)) {
            may = true;
        }
    }
    return may;
}

/// (A node that is not there is farther than single precision reaches, and stays there: what is rounded outward is still in double precision.)
#[inline(always)]
fn seen_roughly(site: V3, bounds: NodeBox, slab: NodeSlab) -> RoughNode {
    let lo: V3 = sub(bounds.lo, site);
    let hi: V3 = sub(bounds.hi, site);
    let height: Real = dot(slab.normal, site);
    let lost: Real = 1e-14 * ((site.x.abs() + site.y.abs()) + site.z.abs());
    return RoughNode {
        lo: RoughPlace { x: lower(lo.x), y: lower(lo.y), z: lower(lo.z) },
        hi: RoughPlace { x: upper(hi.x), y: upper(hi.y), z: upper(hi.z) },
        normal: RoughPlace { x: slab.normal.x as Rough, y: slab.normal.y as Rough, z: slab.normal.z as Rough },
        below: lower((slab.lo - height) - lost),
        above: upper((slab.hi - height) + lost),
    };
}

#[inline(always)]
fn lower(x: Real) -> Rough {
    return (x - (SWEEP_OUTWARD * x.abs())) as Rough;
}

#[inline(always)]
fn upper(x: Real) -> Rough {
    return (x + (SWEEP_OUTWARD * x.abs())) as Rough;
}

#[inline(always)]
fn above_nothing(x: Rough) -> Rough {
    return x.max(SWEEP_NOTHING);
}

/// How far a place is from a range, at least, where it is off by `off`.
#[inline(always)]
fn rough_gap(lo: Rough, hi: Rough, place: Rough, off: Rough) -> Rough {
    return above_nothing((lo - place).max(place - hi) - off);
}

/// Whether a site of a node may be as near to a vertex as the cell's own; the vertex is off by up to `radius` along each axis.
///
/// With |v − d| < |v| at the vertex, at the place p that is known of it |p − d| < |p| + 2√3·radius. As [`least_power_of_node`](super::bound::least_power_of_node), the box is
/// seen from the foot on the slab.
#[inline(always)]
fn may_cut_at(node: RoughNode, p: RoughVertex) -> bool {
    let size: Rough = (p.x.abs() + p.y.abs()) + p.z.abs();
    let off: Rough = SWEEP_ROUNDINGS * size;
    let own: Rough = ((p.x * p.x) + (p.y * p.y)) + (p.z * p.z);
    let height: Rough = ((node.normal.x * p.x) + (node.normal.y * p.y)) + (node.normal.z * p.z);
    let across: Rough = above_nothing((height - node.above) - off) - above_nothing((node.below - height) - off);
    let x: Rough = rough_gap(node.lo.x, node.hi.x, p.x - (across * node.normal.x), off);
    let y: Rough = rough_gap(node.lo.y, node.hi.y, p.y - (across * node.normal.y), off);
    let z: Rough = rough_gap(node.lo.z, node.hi.z, p.z - (across * node.normal.z), off);
    let square: Rough = (((x * x) + (y * y)) + (z * z)) + (across * across);
    let more: Rough = p.radius * ((SWEEP_EIGHT * size) + (SWEEP_SIXTEEN * p.radius));
    return !(square > ((own * (SWEEP_ONE + (SWEEP_EIGHT * SWEEP_ROUNDINGS))) + (more + SWEEP_LEAST_SQUARE)));
}
