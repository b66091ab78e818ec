//! A site's block of leaves of the tree; and the rings about it, of which it is known what their sites weigh at most: for the search of the table of voxels,
//! where weights differ.

use super::search_store::WIDTH;
use super::vector::{Real, V3};

/// How many rings there are. The last has no end.
pub const RINGS: u32 = 16;

/// Where a ring ends, in voxels: at 2, 3, 4, 6, 8, 12, …, where the next begins.
#[inline(always)]
pub fn end_of_ring(ring: u32) -> u32 {
    return (2 + (ring & 1)) << (ring / 2);
}

/// The level of the nodes that are blocks of leaves, as far as there are any.
#[inline(always)]
pub fn level_of_block(top_level: u32) -> u32 {
    if top_level == 0 {
        return 0;
    }
    return 1;
}

/// The block of leaves of a site, a node of that level.
#[inline(always)]
pub fn block_of_site(top_level: u32, site: u32) -> u32 {
    return (site / WIDTH) >> (3 * level_of_block(top_level));
}

/// A weight less what a slope makes of the way to its site, and the size of what is summed.
#[inline(always)]
pub fn less_slope(excess: Real, slope: V3, way: V3, size: &mut Real) -> Real {
    let x: Real = slope.x * way.x;
    let y: Real = slope.y * way.y;
    let z: Real = slope.z * way.z;
    *size = excess.abs() + ((x.abs() + y.abs()) + z.abs());
    return excess - ((x + y) + z);
}
