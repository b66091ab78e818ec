//! All sites that can still cut the cell at any of its vertices, in one descent of the tree: instead of the far search (`far.rs`), or where weights differ of what the near one (`search.rs`) has left.
//!
//! The difference of two powers is linear in the place. So a site that has less power than the cell's own anywhere in the cell has less at one of its
//! vertices; and what a site cannot cut of a cell, it cannot of what others leave of it. A node is opened if a site of it may have less power at
//! a vertex that is not settled, and when none is left all that can cut the cell have.
//!
//! The vertices of a cell ask for much the same nodes. What that gains, and when, is in `README.md`.

use super::bound::{Seer, least_weighted};
use super::candidates::reach_of_site;
use super::search::Vantage;
use super::search_store::{NodeBox, NodeSlab, NodeWeights, RoughVertex, SearchStore};
use super::vector::{Real, Rough, UNIT_ROUNDOFF, V3, dot, larger, scale, sub};

/// What single precision rounds off, of what is multiplied: 46 roundings at most (see `may_cut_at`), 2.75e-6.
const SWEEP_ROUNDINGS: Rough = 3e-6;
const SWEEP_OUTWARD: Real = 1e-6;
/// Where its squares underflow.
const SWEEP_LEAST_SQUARE: Rough = 1e-30;
const SWEEP_NOTHING: Rough = 0.0;
/// 2, and what `may_cut_at` rounds off of it.
const SWEEP_TWICE: Rough = 2.00001;
/// 2, with room for roundings.
const SWEPT_TWICE: Real = 2.0 + (16.0 * UNIT_ROUNDOFF);
const SWEEP_MINUS_TWICE: Rough = -2.0;

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
    /// How far the box reaches along its axes in all, and the slab along its normal.
    size: Rough,
}

/// Makes those of some sites that are kept candidates, from the `first` on, which have a key below a limit; returns how many they are.
#[inline(always)]
pub(super) fn gather_kept<S: SearchStore>(s: &mut S, vantage: Vantage, first: u32, count: u32, below: u32) -> u32 {
    let mut there: u32 = 0;
    let mut i: u32 = s.lane();
    while (i - s.lane()) < count {
        let mut j: u32 = s.own_site();
        if i < count {
            j = s.kept_site(first + i);
        }
        let key: u32 = s.key_below(reach_of_site(s, vantage.slope, j));
        let is_wanted: bool = (j != s.own_site()) && (key < below);
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

/// Whether a site of a node may have less power than the cell's own at a vertex that is not settled.
#[inline(always)]
pub(super) fn may_cut<S: SearchStore>(s: &S, seer: Seer, level: u32, node: u32) -> bool {
    let mut may: bool = false;
    // (A node that is not there has a box that single precision does not reach.)
    let is_there: bool = node <= ((s.sites() - 1) >> (3 * (level + 1)));
    if is_there && s.has_weights() {
        let bounds: NodeBox = s.node_box(level, node);
        let weights: NodeWeights = s.node_weights(level, node);
        for v in 0..s.vertices() {
            if !s.settled(v) && may_cut_weighted(seer, s.position(v), s.radius(v), bounds, weights) {
                may = true;
            }
        }
    } else if is_there {
        let its: RoughNode = seen_roughly(s.site(), s.node_box(level, node), s.node_slab(level, node));
        for v in 0..s.vertices() {
            if !s.settled(v) && may_cut_at(its, s.rough_vertex(v)) {
                may = true;
            }
        }
    }
    return may;
}

/// Whether a site of a node, whose weights differ, may have less power than the cell's own at a place that is off by up to `radius` along each axis.
///
/// With d the way to such a site, w what it weighs more and v the place |d|² − 2v·d − w ≤ 0, and what v is off by makes of that at most 2 `radius` times the sum of d's components.
#[inline(always)]
pub(crate) fn may_cut_weighted(seer: Seer, place: V3, radius: Real, bounds: NodeBox, weights: NodeWeights) -> bool {
    let lo: V3 = sub(bounds.lo, seer.site);
    let hi: V3 = sub(bounds.hi, seer.site);
    let size: Real = (larger(lo.x.abs(), hi.x.abs()) + larger(lo.y.abs(), hi.y.abs())) + larger(lo.z.abs(), hi.z.abs());
    return !(least_weighted(seer, 1.0, scale(-2.0, place), bounds, weights) > (SWEPT_TWICE * (radius * size)));
}

#[inline(always)]
fn seen_roughly(site: V3, bounds: NodeBox, slab: NodeSlab) -> RoughNode {
    let lo: V3 = sub(bounds.lo, site);
    let hi: V3 = sub(bounds.hi, site);
    let height: Real = dot(slab.normal, site);
    let lost: Real = 1e-14 * ((site.x.abs() + site.y.abs()) + site.z.abs());
    let mut its: RoughNode = RoughNode {
        lo: RoughPlace { x: lower(lo.x), y: lower(lo.y), z: lower(lo.z) },
        hi: RoughPlace { x: upper(hi.x), y: upper(hi.y), z: upper(hi.z) },
        normal: RoughPlace { x: slab.normal.x as Rough, y: slab.normal.y as Rough, z: slab.normal.z as Rough },
        below: lower((slab.lo - height) - lost),
        above: upper((slab.hi - height) + lost),
        size: SWEEP_NOTHING,
    };
    its.size = ((its.lo.x.abs().max(its.hi.x.abs()) + its.lo.y.abs().max(its.hi.y.abs()))
        + its.lo.z.abs().max(its.hi.z.abs()))
        + its.below.abs().max(its.above.abs());
    return its;
}

#[inline(always)]
fn lower(x: Real) -> Rough {
    return (x - (SWEEP_OUTWARD * x.abs())) as Rough;
}

#[inline(always)]
fn upper(x: Real) -> Rough {
    return (x + (SWEEP_OUTWARD * x.abs())) as Rough;
}

/// What of a range is nearest.
#[inline(always)]
fn within(lo: Rough, hi: Rough, x: Rough) -> Rough {
    return -((-(x.max(lo))).max(-hi));
}

/// a·b + c; on devices rounded once.
#[cfg_attr(opencl, returns("fma(a, b, c)"))]
#[inline(always)]
fn fused(a: Rough, b: Rough, c: Rough) -> Rough {
    return (a * b) + c;
}

/// x² − 2qx of the x in a range for which that is least, and what is given.
#[inline(always)]
fn least_along(lo: Rough, hi: Rough, q: Rough, more: Rough) -> Rough {
    let x: Rough = within(lo, hi, q);
    return fused(x, fused(SWEEP_MINUS_TWICE, q, x), more);
}

/// Whether a site of a node may be as near to a vertex as the cell's own; the vertex is off by up to `radius` along each axis.
///
/// With d the way to such a site and v the vertex |d|² − 2v·d ≤ 0. For any number a that is the same as (|d|² − 2q·d) − 2a n·d with q = v − an: the first is a sum over axes,
/// which has a least value over the box, and the second at least −2a times the slab's end on the side of a. The best a is how far v is beyond the slab. No square of v's distance
/// is in it, as there would be in a comparison of two distances: so of what is near the cell's site little is rounded off, however far the vertex is. (Distances took 70 instead of 45
/// instructions a vertex as well: a million sites on a bumpy surface 0.231 instead of 0.207 s, one NVIDIA H200.)
///
/// With u half of the last bit of single precision, X the `size` of the node, and L the sum of X and of v's components: q is off by `radius` + 3uL along each axis, which adds 2X times
/// that; |q| < 2L and |d − 2q| < 5L, so that no sum is above 7LX, and the roundings of four sums, of three factors, and of seven products where they are not fused are 40uLX at most: in all
/// 2X·radius + 46uLX. (Of 17 million nodes that a bisector just meets, with the vertex as far off as its radius allows, none is missed, and 0.78 of what is allowed is used. Sites and
/// vertices are within some thousands of a frame of size 1, where nothing overflows.)
#[inline(always)]
fn may_cut_at(node: RoughNode, p: RoughVertex) -> bool {
    let size: Rough = ((p.x.abs() + p.y.abs()) + p.z.abs()) + node.size;
    let height: Rough = fused(node.normal.x, p.x, fused(node.normal.y, p.y, node.normal.z * p.z));
    let end: Rough = within(node.below, node.above, height);
    let across: Rough = height - end;
    let slab: Rough = (SWEEP_MINUS_TWICE * across) * end;
    let x: Rough = least_along(node.lo.x, node.hi.x, fused(-across, node.normal.x, p.x), slab);
    let xy: Rough = least_along(node.lo.y, node.hi.y, fused(-across, node.normal.y, p.y), x);
    let least: Rough = least_along(node.lo.z, node.hi.z, fused(-across, node.normal.z, p.z), xy);
    let lost: Rough = fused(SWEEP_ROUNDINGS, size, SWEEP_TWICE * p.radius);
    return !(least > fused(node.size, lost, SWEEP_LEAST_SQUARE));
}
