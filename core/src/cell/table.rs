//! The near search of sites that fill space evenly, on devices: the voxels around the cell's own, in the order of a table of offsets, nearest first. What it does
//! not prove complete is completed by its vertices (`far.rs`), or where weights differ and such cells are many found by the tree (`search.rs`).
//!
//! Where weights differ, sites that are at least `D` away cannot cut what is within `r` of where the slope has the cell if none of them weighs more than `Ω` less
//! that slope, and `D² − Ω ≥ 2rD` (`search.rs`). Of sites around the cell's block of leaves it is known, ring by ring, what they weigh at most (`around.rs`).

use super::candidates::{reach_of_site, visit_candidates};
use super::quadratic::FEW_ROUNDINGS_OF_SUM;
use super::ring::{RINGS, block_of_site, end_of_ring, less_slope, level_of_block};
use super::search::Vantage;
use super::search_store::{HOME_UNKNOWN, NO_SITE, NodeBox, SearchStore};
use super::status::{COMPLETE, CUT, EMPTY, UNTOUCHED};
use super::vector::{Real, Rough, V3, add, scale, sub, v3};

/// What is allowed for the roundings of a distance in voxels, in single precision and below 16, and of its square.
const SLACK_IN_VOXELS: Rough = 1e-5;
const SAFE_IN_VOXELS: Rough = 1.00001;

/// Where weights differ a cell which sites may cut that are, as squared voxels, farther than this when the voxels about its own, so many offsets, have been gone through, is given up: it would go through what is
/// left of the table, most often in vain. (Of 215,222 cells of transport in a domain the table proves 77 %, in 7.5 ms; given up so, with 6 voxels, 77 % in 4.2, with 4 voxels 73 % in 3.8; lognormal radii are
/// found sooner by the tree where they need more than 4. After 125 offsets, with 6 voxels, 4.3. One NVIDIA H200.)
pub const TRIED_OFFSETS: u32 = 27;
const WORTH_GOING_ON: Rough = 16.0;

/// (Named, since a literal would be a `Real`, in double precision on devices.)
const NO_GAP: Rough = 0.0;
const ONE_VOXEL: Rough = 1.0;
const HALF: Rough = 0.5;

/// The number of what is no voxel.
pub const NO_VOXEL: u32 = 0xFFFF_FFFF;

/// A voxel's place, in voxels from the site's own.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Offset {
    /// Along x.
    pub x: i32,
    /// Along y.
    pub y: i32,
    /// Along z.
    pub z: i32,
    /// A lower bound of the squared distance, in voxels, from any place in the site's voxel to this one and to all that come later, in the table or
    /// not.
    pub apart: Rough,
}

/// A place in a voxel, in voxels.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct VoxelPlace {
    /// Along x.
    pub x: Rough,
    /// Along y.
    pub y: Rough,
    /// Along z.
    pub z: Rough,
}

/// Consecutive sorted sites.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct SiteRange {
    /// The first.
    pub begin: u32,
    /// One more than the last.
    pub end: u32,
}

/// What the search of the table needs beside the tree's. A cell that is known to be outside the domain has a `square_of_reach` of 0 where weights are the same; where
/// they differ `cut_by` says that it is `EMPTY`.
pub trait TableStore: SearchStore {
    /// Number of offsets in the table.
    fn offsets(&self) -> u32;
    /// Offset `i`, or any where there are not so many: not alike.
    fn offset(&self, i: u32) -> Offset;
    /// The voxel at an offset, or `NO_VOXEL` outside the grid: not alike.
    fn voxel_at(&self, offset: Offset) -> u32;
    /// Its sites: not alike.
    fn sites_in(&self, voxel: u32) -> SiteRange;
    /// Where in its voxel the cell's site is.
    fn place_in_voxel(&self) -> VoxelPlace;
    /// Voxels along a length of 1, rounded up.
    fn voxels_per_length(&self) -> Rough;
    /// What sites in and within a ring about a block of leaves weigh at most, less the slope at its middle: see `around.rs`.
    fn largest_in_ring(&self, block: u32, ring: u32) -> Real;
    /// What they weigh so more than the cell's site, in squared voxels, rounded up, and 0 at least.
    fn excess_around(&self, ring: u32) -> Rough;
    /// Sets it, as what it is in the frame.
    fn set_excess_around(&mut self, ring: u32, excess: Real);
    /// Whether weights differ and what is left early is found by the same stage and the tree.
    fn leaves_early(&self) -> bool;
    /// How many sites become candidates at one time.
    fn window(&self) -> u32;
    /// Number `i` of so many that all lanes see: not alike.
    fn in_window(&self, i: u32) -> u32;
    /// Sets it.
    fn set_in_window(&mut self, i: u32, x: u32);
    /// Sets candidate `c` of this lane; its key is `NO_SITE` where there is no such candidate.
    fn hold(&mut self, c: u32, site: u32, key: u32);
    /// The sum of the numbers of the lanes before this one, which is not alike, and of all; they are below 128.
    fn sum_before(&self, x: u32, all: &mut u32) -> u32;
    /// Ends, or cuts off, what of the cell is outside the domain, after so many offsets, where it reaches so far: as `clip`, or how the search ends.
    fn look_outside(&mut self, offsets: u32, reach: Rough) -> u32;
}

/// From where a cell is searched where weights differ: by the slope of its block of leaves.
#[inline(always)]
pub fn vantage_in_block<S: TableStore>(s: &S) -> Vantage {
    let block: u32 = block_of_site(s.top_level(), s.own_site());
    let slope: V3 = s.node_weights(level_of_block(s.top_level()), block).slope;
    return Vantage { slope: slope, center: scale(-0.5, slope), lambda: 0.5, home: HOME_UNKNOWN };
}

/// Finds what the sites around weigh more than the cell's.
#[inline(always)]
fn look_around<S: TableStore>(s: &mut S, slope: V3) {
    let block: u32 = block_of_site(s.top_level(), s.own_site());
    let bounds: NodeBox = s.node_box(level_of_block(s.top_level()), block);
    let way: V3 = sub(s.site(), scale(0.5, add(bounds.lo, bounds.hi)));
    let mut size: Real = 0.0;
    let own: Real = less_slope(s.own_excess(), slope, way, &mut size);
    let mut ring: u32 = s.lane();
    while ring < RINGS {
        let largest: Real = s.largest_in_ring(block, ring);
        s.set_excess_around(ring, (largest - own) + (FEW_ROUNDINGS_OF_SUM * (size + largest.abs())));
        ring += s.lanes();
    }
    s.lanes_wait();
}

/// The squared distance in voxels from which on a voxel's sites cannot cut the cell. Sites beyond `ring` cannot, whatever it is.
#[inline(always)]
fn limit_in_voxels<S: TableStore>(s: &S, reach: Rough, ring: &mut u32) -> Rough {
    let mut voxels: Rough = reach.sqrt() * s.voxels_per_length();
    if s.has_weights() {
        let radius: Rough = HALF * voxels;
        let mut goes_on: bool = true;
        while goes_on {
            voxels = radius + ((radius * radius) + s.excess_around(*ring)).sqrt();
            goes_on = false;
            if *ring > 0 {
                let begin: Rough = end_of_ring(*ring - 1) as Rough;
                // (With room for roundings.)
                if ((voxels + SLACK_IN_VOXELS) * SAFE_IN_VOXELS) <= begin {
                    *ring -= 1;
                    goes_on = true;
                }
            }
        }
        let end: Rough = end_of_ring(*ring) as Rough;
        if (*ring < (RINGS - 1)) && (end < voxels) {
            voxels = end;
        }
    }
    voxels += SLACK_IN_VOXELS;
    return (voxels * voxels) * SAFE_IN_VOXELS;
}

/// How far along an axis a place in a voxel is from the voxel `offset` beyond.
#[inline(always)]
fn gap_to_voxel(offset: i32, place: Rough) -> Rough {
    let begin: Rough = offset as Rough;
    return (begin - place).max(place - (begin + ONE_VOXEL)).max(NO_GAP);
}

/// The voxels nearer than the square root of `limit` that come next in the table, at most one for each lane, into the window; returns how many. `next` is the
/// offset to be looked at then: `offsets()` where the table has ended, more where all others are farther.
#[inline(always)]
fn gather_voxels<S: TableStore>(s: &mut S, place: VoxelPlace, limit: Rough, next: &mut u32) -> u32 {
    let mut found: u32 = 0;
    let mut goes_on: bool = true;
    while goes_on {
        let own: u32 = *next + s.lane();
        let offset: Offset = s.offset(own);
        let x: Rough = gap_to_voxel(offset.x, place.x);
        let y: Rough = gap_to_voxel(offset.y, place.y);
        let z: Rough = gap_to_voxel(offset.z, place.z);
        let voxel: u32 = s.voxel_at(offset);
        let is_near: bool = ((own < s.offsets()) && (voxel != NO_VOXEL)) && ((((x * x) + (y * y)) + (z * z)) < limit);
        let all: u32 = s.lanes_with(is_near);
        let rank: u32 = found + s.rank_in(all);
        if is_near && (rank < s.lanes()) {
            s.set_in_window(rank, voxel);
        }
        let out: u32 = s.lanes_with(is_near && (rank >= s.lanes()));
        let past: u32 = s.lanes_with((own < s.offsets()) && (offset.apart >= limit));
        if out != 0 {
            // The first that has no place is the next to be looked at.
            *next += s.first_of(out);
            found = s.lanes();
            goes_on = false;
        } else {
            found += s.count_of(all);
            *next += s.lanes();
            if *next > s.offsets() {
                *next = s.offsets();
            }
            if past != 0 {
                // All later voxels are at least as far away.
                *next = s.offsets() + 1;
            }
            goes_on = (found <= (s.lanes() / 2)) && (*next < s.offsets());
        }
    }
    s.lanes_wait();
    return found;
}

/// Cuts the cell by all sites that can cut it: `COMPLETE`; `UNTOUCHED` where the table does not prove that, or likely will not; or how it ended. `reach` is the square of
/// its reach about the vantage's center, afterwards.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn search_table<S: TableStore>(s: &mut S, vantage: Vantage, reach: &mut Rough, visited: &mut u32) -> u32 {
    let mut center: V3 = v3(0.0, 0.0, 0.0);
    if s.has_weights() {
        center = vantage.center;
        look_around(s, vantage.slope);
    }
    let mut ring: u32 = RINGS - 1;
    let place: VoxelPlace = s.place_in_voxel();
    *reach = s.square_of_reach(center);
    let mut next: u32 = 0;
    loop {
        let outside: u32 = s.look_outside(next, *reach);
        if outside == CUT {
            *reach = s.square_of_reach(center);
        } else if outside != UNTOUCHED {
            return outside;
        }
        // A voxel for each lane, and where its sites stand among those of all.
        let voxels: Rough = limit_in_voxels(s, *reach, &mut ring);
        if s.leaves_early() && ((next >= TRIED_OFFSETS) && (voxels > WORTH_GOING_ON)) {
            return UNTOUCHED;
        }
        let found: u32 = gather_voxels(s, place, voxels, &mut next);
        let mut range: SiteRange = SiteRange { begin: 0, end: 0 };
        if s.lane() < found {
            range = s.sites_in(s.in_window(s.lane()));
        }
        let own: u32 = range.end - range.begin;
        let mut all: u32 = 0;
        let before: u32 = s.sum_before(own, &mut all);
        let mut window: u32 = 0;
        while window < all {
            s.lanes_wait();
            for i in 0..own {
                let at: u32 = (before + i).wrapping_sub(window);
                if at < s.window() {
                    s.set_in_window(at, range.begin + i);
                }
            }
            s.lanes_wait();
            let mut count: u32 = all - window;
            if count > s.window() {
                count = s.window();
            }
            // (A site out of reach does not get its key, so that the lanes agree at once that none is left.)
            let limit: u32 = s.key_of_reach(*reach);
            for c in 0..s.held(count) {
                let at: u32 = (c * s.lanes()) + s.lane();
                let mut site: u32 = s.own_site();
                let mut key: u32 = NO_SITE;
                if (window + at) < all {
                    site = s.in_window(at);
                    let its: u32 = s.key_below(reach_of_site(s, vantage.slope, site));
                    if (site != s.own_site()) && (its < limit) {
                        key = its;
                    }
                }
                s.hold(c, site, key);
            }
            let status: u32 = visit_candidates(s, center, count, NO_SITE, false, reach, visited);
            if status != UNTOUCHED {
                return status;
            }
            window += s.window();
        }
        if next >= s.offsets() {
            break;
        }
    }
    if *reach <= NO_GAP {
        return EMPTY;
    }
    if next > s.offsets() {
        return COMPLETE;
    }
    return UNTOUCHED;
}
