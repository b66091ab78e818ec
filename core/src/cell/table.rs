//! The near search of sites that fill space evenly and whose weights do not differ: the voxels around the cell's own, in the order of a table of
//! offsets, nearest first. What it does not prove complete is completed by its vertices (`far.rs`).

use super::search::{Vantage, visit_candidates};
use super::search_store::{NO_SITE, SearchStore};
use super::security::SAFE;
use super::status::{COMPLETE, CUT, UNTOUCHED};
use super::vector::{Real, V3, dot, larger};

/// Sites that become candidates at one time.
const WINDOW: u32 = 64;

/// What is allowed for the roundings of a distance in voxels, which is below 16, and of its square.
const SLACK_IN_VOXELS: Real = 1e-5;
const SAFE_IN_VOXELS: Real = 1.00001;

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
    pub apart: Real,
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

/// What the search of the table needs beside the tree's.
pub trait TableStore: SearchStore {
    /// Number of offsets in the table.
    fn offsets(&self) -> u32;
    /// Offset `i`: not alike.
    fn offset(&self, i: u32) -> Offset;
    /// The sites in the voxel at an offset; none where it is outside the grid.
    fn sites_at(&self, offset: Offset) -> SiteRange;
    /// Where in its voxel the cell's site is, in voxels.
    fn place_in_voxel(&self) -> V3;
    /// Voxels along a length of 1, rounded up.
    fn voxels_per_length(&self) -> Real;
    /// The sum of the numbers of the lanes before this one, which is not alike, and of all; they are below 128.
    fn sum_before(&self, x: u32, all: &mut u32) -> u32;
    /// Ends, or cuts off, what of the cell is outside the domain, after so many offsets, where it reaches so far: as `clip`, or how the search ends.
    fn look_outside(&mut self, offsets: u32, reach: Real) -> u32;
}

/// The squared distance in voxels from which on a voxel's sites cannot cut the cell.
#[inline(always)]
fn limit_in_voxels<S: TableStore>(s: &S, reach: Real) -> Real {
    let voxels: Real = (((4.0 * reach) * SAFE).sqrt() * s.voxels_per_length()) + SLACK_IN_VOXELS;
    return (voxels * voxels) * SAFE_IN_VOXELS;
}

/// How far along an axis a place in a voxel is from the voxel `offset` beyond.
#[inline(always)]
fn gap_to_voxel(offset: i32, place: Real) -> Real {
    let begin: Real = offset as Real;
    return larger(larger(begin - place, place - (begin + 1.0)), 0.0);
}

/// Cuts the cell by all sites that can cut it: `COMPLETE`; `UNTOUCHED` where the table does not prove that; or how it ended.
#[inline]
pub fn search_table<S: TableStore>(s: &mut S, vantage: Vantage, visited: &mut u32) -> u32 {
    let place: V3 = s.place_in_voxel();
    let mut reach: Real = s.square_of_reach(vantage.center);
    let mut next: u32 = 0;
    loop {
        let outside: u32 = s.look_outside(next, reach);
        if outside == CUT {
            reach = s.square_of_reach(vantage.center);
        } else if outside != UNTOUCHED {
            return outside;
        }
        // A voxel for each lane, and where its sites stand among those of all.
        let limit: Real = limit_in_voxels(s, reach);
        let mut range: SiteRange = SiteRange { begin: 0, end: 0 };
        let mut before: u32 = 0;
        let mut all: u32 = 0;
        while (all == 0) && (next < s.offsets()) {
            let mut is_past: u32 = 0;
            range = SiteRange { begin: 0, end: 0 };
            if (next + s.lane()) < s.offsets() {
                let offset: Offset = s.offset(next + s.lane());
                let x: Real = gap_to_voxel(offset.x, place.x);
                let y: Real = gap_to_voxel(offset.y, place.y);
                let z: Real = gap_to_voxel(offset.z, place.z);
                if offset.apart >= limit {
                    is_past = 1;
                } else if (((x * x) + (y * y)) + (z * z)) < limit {
                    range = s.sites_at(offset);
                }
            }
            before = s.sum_before(range.end - range.begin, &mut all);
            next += s.lanes();
            if next > s.offsets() {
                next = s.offsets();
            }
            if s.lanes_with(is_past) != 0 {
                next = s.offsets() + 1;
            }
        }
        let mut window: u32 = 0;
        while window < all {
            let mut i: u32 = 0;
            while i < (range.end - range.begin) {
                if ((before + i) >= window) && ((before + i) < (window + WINDOW)) {
                    s.set_candidate((before + i) - window, range.begin + i, NO_SITE);
                }
                i += 1;
            }
            s.lanes_wait();
            let mut count: u32 = all - window;
            if count > WINDOW {
                count = WINDOW;
            }
            i = s.lane();
            while i < count {
                let j: u32 = s.candidate(i);
                if j != s.own_site() {
                    let way: V3 = s.way_to(j);
                    s.set_candidate(i, j, s.key_below(dot(way, way)));
                }
                i += s.lanes();
            }
            let status: u32 = visit_candidates(s, vantage, count, NO_SITE, &mut reach, visited);
            if status != UNTOUCHED {
                return status;
            }
            window += WINDOW;
        }
        if (all == 0) && (next >= s.offsets()) {
            if next > s.offsets() {
                return COMPLETE;
            }
            return UNTOUCHED;
        }
    }
}
