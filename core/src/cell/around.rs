//! What the sites within a distance of a block of leaves weigh at most, less the slope of the block's own weights.

use super::bound::{Seer, least_weighted};
use super::quadratic::FEW_ROUNDINGS_OF_SUM;
use super::ring::{less_slope, level_of_block};
use super::search_store::{NodeBox, NodeWeights, WIDTH};
use super::vector::{Real, V3, add, dot, larger, scale, sub};

/// A node whose extent is less than where the ring begins is not opened, nor one whose extent is less than this share of the block's own: a block that spans a gap
/// between sites is as large as what it would be gone through.
const SHARE_OF_BLOCK: Real = 0.25;

/// Less than any weight.
const LEAST_OF_ALL: Real = -1e300;

/// The tree over the sites.
pub trait AroundSource {
    /// Number of sites.
    fn sites(&self) -> u32;
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

/// An upper bound of what any site weighs, less the slope at the middle of block `own`, that is nearer to its box than `end`, where a ring
/// ends that has a beginning.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn largest_around<S: AroundSource>(s: &S, own: u32, begin: Real, end: Real) -> Real {
    let top: u32 = s.top_level();
    let bounds: NodeBox = s.node_box(level_of_block(top), own);
    let middle: V3 = scale(0.5, add(bounds.lo, bounds.hi));
    let slope: V3 = s.node_weights(level_of_block(top), own).slope;
    let seer: Seer = Seer { site: middle, excess: 0.0, has_weights: true };
    let within: Real = (end * end) * (1.0 + FEW_ROUNDINGS_OF_SUM);
    let own_extent: V3 = sub(bounds.hi, bounds.lo);
    let small: Real = larger(begin * begin, (SHARE_OF_BLOCK * SHARE_OF_BLOCK) * dot(own_extent, own_extent));
    let mut largest: Real = LEAST_OF_ALL;
    let mut level: u32 = top;
    let mut node: u32 = 0;
    loop {
        let mut opens: bool = false;
        if (node << (3 * level)) <= ((s.sites() - 1) / WIDTH) {
            let its: NodeBox = s.node_box(level, node);
            let mut most: Real = LEAST_OF_ALL;
            if square_between(bounds, its) < within {
                most = -least_weighted(seer, 0.0, slope, its, s.node_weights(level, node));
            }
            if most > largest {
                let extent: V3 = sub(its.hi, its.lo);
                if dot(extent, extent) < small {
                    largest = most;
                } else if level > 0 {
                    opens = true;
                } else {
                    let mut last: u32 = (node + 1) * WIDTH;
                    if s.sites() < last {
                        last = s.sites();
                    }
                    for j in (node * WIDTH)..last {
                        let place: V3 = s.site_place(j);
                        let mut size: Real = 0.0;
                        let weight: Real = less_slope(s.site_weight(j), slope, sub(place, middle), &mut size);
                        if square_between(bounds, NodeBox { lo: place, hi: place }) < within {
                            largest = larger(largest, weight + (FEW_ROUNDINGS_OF_SUM * size));
                        }
                    }
                }
            }
        }
        if opens {
            level -= 1;
            node = node * WIDTH;
        } else {
            node += 1;
            while ((node & (WIDTH - 1)) == 0) && (level < top) {
                node = node / WIDTH;
                level += 1;
            }
            if node == WIDTH {
                if level == top {
                    return largest;
                }
            }
        }
    }
}
