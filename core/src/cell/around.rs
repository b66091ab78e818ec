//! What the sites within some distances of a block of leaves weigh at most, less the slope of the block's own weights: what is seen of a node, and of a site. (`look_at_rings` of
//! `bound_nodes.cl` goes through the tree.)

use super::bound::{Seer, least_weighted};
use super::quadratic::FEW_ROUNDINGS_OF_SUM;
use super::ring::{RINGS, end_of_ring, less_slope, level_of_block};
use super::search_store::{NodeBox, NodeWeights};
use super::vector::{Real, V3, add, dot, larger, scale, sub};

/// A node whose extent is less than where its ring begins is not opened, nor one whose extent is less than this share of the block's own: a block that spans a gap
/// between sites is as large as what it would be gone through.
const SHARE_OF_BLOCK: Real = 0.25;

/// The tree over the sites.
pub trait AroundSource {
    /// The level of the root, 0 that of the leaves.
    fn top_level(&self) -> u32;
    /// The box of node `node` of a level.
    fn node_box(&self, level: u32, node: u32) -> NodeBox;
    /// What bounds its weights.
    fn node_weights(&self, level: u32, node: u32) -> NodeWeights;
    /// The place of a site.
    fn site_place(&self, j: u32) -> V3;
    /// What it weighs more than the lightest of all.
    fn site_weight(&self, j: u32) -> Real;
}

#[inline(always)]
fn gap_between(lo: Real, hi: Real, its_lo: Real, its_hi: Real) -> Real {
    return larger(larger(its_lo - hi, lo - its_hi), 0.0);
}

/// The square of the distance of two boxes.
#[inline(always)]
fn square_between(a: NodeBox, b: NodeBox) -> Real {
    let x: Real = gap_between(a.lo.x, a.hi.x, b.lo.x, b.hi.x);
    let y: Real = gap_between(a.lo.y, a.hi.y, b.lo.y, b.hi.y);
    let z: Real = gap_between(a.lo.z, a.hi.z, b.lo.z, b.hi.z);
    return ((x * x) + (y * y)) + (z * z);
}

/// A block of leaves, around which sites are looked at.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Around {
    bounds: NodeBox,
    middle: V3,
    slope: V3,
    /// The width of a voxel.
    width: Real,
}

/// What a site, or any of a node's, weighs at most, less the slope at the middle of the block.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Seen {
    /// That.
    pub most: Real,
    /// The ring that the nearest of it is in, at least.
    pub ring: u32,
    /// Whether its parts are not looked at.
    pub is_small: bool,
}

/// Block `own`, where voxels are so wide.
#[inline(always)]
pub fn around_block<S: AroundSource>(s: &S, own: u32, width: Real) -> Around {
    let level: u32 = level_of_block(s.top_level());
    let bounds: NodeBox = s.node_box(level, own);
    return Around {
        bounds: bounds,
        middle: scale(0.5, add(bounds.lo, bounds.hi)),
        slope: s.node_weights(level, own).slope,
        width: width,
    };
}

/// The ring that what is so far, as a square, is in, at least.
#[inline(always)]
fn ring_at(square: Real, width: Real) -> u32 {
    let mut ring: u32 = 0;
    let mut is_within: bool = false;
    while (ring < (RINGS - 1)) && !is_within {
        let end: Real = (end_of_ring(ring) as Real) * width;
        is_within = square < ((end * end) * (1.0 + FEW_ROUNDINGS_OF_SUM));
        if !is_within {
            ring += 1;
        }
    }
    return ring;
}

/// Looks at a node.
#[inline(always)]
pub fn look_at_node<S: AroundSource>(s: &S, of: Around, level: u32, node: u32) -> Seen {
    let its: NodeBox = s.node_box(level, node);
    let ring: u32 = ring_at(square_between(of.bounds, its), of.width);
    let mut begin: Real = 0.0;
    if ring > 0 {
        begin = (end_of_ring(ring - 1) as Real) * of.width;
    }
    let own: V3 = sub(of.bounds.hi, of.bounds.lo);
    let small: Real = larger(begin * begin, (SHARE_OF_BLOCK * SHARE_OF_BLOCK) * dot(own, own));
    let extent: V3 = sub(its.hi, its.lo);
    let seer: Seer = Seer { site: of.middle, excess: 0.0, has_weights: true };
    return Seen {
        most: -least_weighted(seer, 0.0, of.slope, its, s.node_weights(level, node)),
        ring: ring,
        is_small: dot(extent, extent) < small,
    };
}

/// Looks at a site.
#[inline(always)]
pub fn look_at_site<S: AroundSource>(s: &S, of: Around, j: u32) -> Seen {
    let place: V3 = s.site_place(j);
    let mut size: Real = 0.0;
    let weight: Real = less_slope(s.site_weight(j), of.slope, sub(place, of.middle), &mut size);
    return Seen {
        most: weight + (FEW_ROUNDINGS_OF_SUM * size),
        ring: ring_at(square_between(of.bounds, NodeBox { lo: place, hi: place }), of.width),
        is_small: true,
    };
}
