//! What the octree over the container (`core/src/power_octree.rs`) asks of its boxes and of one site after the other.

use super::search_store::WIDTH;
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, dot, scale, sub, v3};

/// Roundings of a difference of powers.
const ROUNDINGS_OF_MORE: Real = 32.0 * UNIT_ROUNDOFF;

/// By how much a box is taken to be larger on each side, as a share of the container's extent: a place may be off by a quarter of it.
pub const OCTREE_MARGIN: Real = 1e-9;

/// A box that lists so many leaves of eight sites, or fewer, is not split. (With 10 the octree takes twice as long, with 32 the cells do.)
pub const FEW_LISTED: u32 = 20;

/// A box is split so often at most.
pub const MOST_DEPTH: u32 = 18;

/// Nor is it where it lists more than this share of what the box before lists, twice in a row: sites that nearly tie, as at a sphere's middle.
const BARREN: Real = 0.8;
/// How often in a row that may be.
const MOST_BARREN: u32 = 2;

/// Places of a box whose sites of least power leave others out: its middle, and the middles of its faces.
pub const OCTREE_PLACES: u32 = 7;

/// A site, as a box of the octree sees it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct SeenSite {
    /// Its place.
    pub place: V3,
    /// What it weighs more than the lightest of all.
    pub excess: Real,
    /// The square of its distance from the box's middle.
    pub square: Real,
}

/// The middle of a box.
#[inline(always)]
pub fn middle_of(lo: V3, hi: V3) -> V3 {
    return v3(0.5 * (lo.x + hi.x), 0.5 * (lo.y + hi.y), 0.5 * (lo.z + hi.z));
}

/// Half its extent, and a margin.
#[inline(always)]
pub fn half_of(lo: V3, hi: V3, margin: Real) -> V3 {
    return add(scale(0.5, sub(hi, lo)), v3(margin, margin, margin));
}

/// The lower corner of one of a box's eight parts, that which is upper along the axes whose bits `octant` has.
#[inline(always)]
pub fn part_lo(lo: V3, hi: V3, octant: u32) -> V3 {
    let mut corner: V3 = lo;
    let middle: V3 = middle_of(lo, hi);
    if (octant & 1) != 0 {
        corner.x = middle.x;
    }
    if (octant & 2) != 0 {
        corner.y = middle.y;
    }
    if (octant & 4) != 0 {
        corner.z = middle.z;
    }
    return corner;
}

/// Its upper corner.
#[inline(always)]
pub fn part_hi(lo: V3, hi: V3, octant: u32) -> V3 {
    return part_lo(hi, lo, octant ^ (WIDTH - 1));
}

/// How often in a row a part of a box lists nearly as much as the box before: the box has done so `barren` times, and the part keeps so many of all
/// that the box lists.
#[inline(always)]
pub fn barren_of_part(barren: u32, count: u32, all: u32) -> u32 {
    if (count as Real) > (BARREN * (all as Real)) {
        return barren + 1;
    }
    return 0;
}

/// Whether a part that keeps so many leaves, and that `depth` splits have made, is split.
#[inline(always)]
pub fn part_is_split(count: u32, barren: u32, depth: u32) -> bool {
    return (count > FEW_LISTED) && (depth < MOST_DEPTH) && (barren < MOST_BARREN);
}

/// The middle of a box, of given half extent; of its faces, for `i` from 1.
#[inline(always)]
pub fn octree_place(middle: V3, halves: V3, i: u32) -> V3 {
    let mut place: V3 = middle;
    if i == 1 {
        place.x += halves.x;
    }
    if i == 2 {
        place.x -= halves.x;
    }
    if i == 3 {
        place.y += halves.y;
    }
    if i == 4 {
        place.y -= halves.y;
    }
    if i == 5 {
        place.z += halves.z;
    }
    if i == 6 {
        place.z -= halves.z;
    }
    return place;
}

/// The power of a site at a place.
#[inline(always)]
pub fn power_at(site: V3, weight: Real, place: V3) -> Real {
    let way: V3 = sub(site, place);
    return dot(way, way) - weight;
}

/// A site as the box about `middle` sees it.
#[inline(always)]
pub fn seen_from(place: V3, excess: Real, middle: V3) -> SeenSite {
    let way: V3 = sub(place, middle);
    return SeenSite { place: place, excess: excess, square: dot(way, way) };
}

/// By how much a site has more power than another at least, everywhere in a box of given half extent: the difference is affine.
#[inline(always)]
pub fn more_power(site: SeenSite, other: SeenSite, halves: V3) -> Real {
    let way: V3 = sub(site.place, other.place);
    let change: Real = 2.0 * dot(halves, v3(way.x.abs(), way.y.abs(), way.z.abs()));
    let size: Real = (site.square + other.square) + (site.excess + other.excess);
    return (((site.square - other.square) - (site.excess - other.excess)) - change) - (ROUNDINGS_OF_MORE * size);
}

/// How far it is from a place, where the least power is that of site `first`, to where `site`, which has so much power there, has as little: about
/// twice that, in single precision; 0 for that site itself.
#[inline(always)]
pub fn way_home(site: V3, power: Real, first: V3, least: Real) -> f32 {
    let apart: V3 = sub(site, first);
    let way: Real = (power - least) / dot(apart, apart).sqrt();
    if way > 0.0 {
        return way as f32;
    }
    return 0.0;
}
