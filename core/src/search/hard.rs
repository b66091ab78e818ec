//! The search where the octree over the container tells which sites have the least power where, and whether it is worth while to make it.

use super::one_cell::Cell;
use super::store::{MOST_LISTED, Searched};
use super::{Outcome, Search};
use crate::Result;
use crate::cell::boxes::search_boxes;
use crate::cell::far::search_far;
use crate::cell::search::Vantage;
use crate::cell::search_store::HOME_KNOWN;
use crate::cell::{CellStore, EMPTY, PlainStore, Real, UNTOUCHED, scale, v3};
use crate::diagram::Prepared;
use crate::parallel;
use crate::power_octree::{Home, PowerOctree};
use std::ops::Range;

/// Cells that are tried without an octree: so many, one in so many at most, and none where that would be too few to go by. (A hard one takes ten times as
/// long so; a thousand sites are as fast without.)
const MOST_TRIED: usize = 64;
const ONE_IN: usize = 256;
const LEAST_TRIED: usize = 4;
/// Of them in one task.
const TRIED_AT_ONCE: usize = 4;

/// A cell is hard that opens more blocks of eight nodes than this. An octree is made where more than one of so many cells that are tried is hard and all open many on average, or a few open so many that
/// all do. (Of sites in clusters with weights of transport all of 64 are, and open 780: cells take a sixth of the time with it. Of white ones in the bunny's box 11 are, and all open 43: 3.3 instead of 5.1 s. In the bunny, of blue noise
/// so weighted, 3 are, and all open 3: 1.4 s without it, 2.7 with.)
const MANY_OPENED: u32 = 40;
const ENOUGH_HARD: u64 = 8;
const MANY_ON_AVERAGE: u64 = 30;
const VERY_MANY_ON_AVERAGE: u64 = 400;

impl Prepared {
    /// With an octree over the container where cells look at many nodes of the tree over the sites for want of good bounds of their weights.
    ///
    /// # Errors
    /// What `go_on` says, which is asked now and then.
    pub fn with_octree_if_hard(mut self, go_on: &dyn Fn() -> Result<()>) -> Result<Self> {
        let sites = self.sites.len();
        let tried = MOST_TRIED.min(sites / ONE_IN);
        if !self.sites.has_weights() || tried < LEAST_TRIED {
            return Ok(self);
        }
        let opened = |search: &mut Search<'_>, i: usize| -> u32 {
            let site = (i * (sites / tried)) as u32;
            let [x, y, z, _] = self.sites.site(site);
            let mut store = PlainStore::new([x, y, z], self.domain_grid());
            search.complete(&mut store, site, None).opened
        };
        let some = |range: Range<usize>| {
            let mut search = Search::new(&self);
            range.map(|i| opened(&mut search, i)).collect::<Vec<u32>>()
        };
        let opened: Vec<u32> = parallel::chunks(tried, TRIED_AT_ONCE, some).concat();
        let (all, hard) = (tried as u64, opened.iter().filter(|&&opened| opened > MANY_OPENED).count() as u64);
        let sum: u64 = opened.iter().map(|&opened| u64::from(opened)).sum();
        let are_hard = ENOUGH_HARD * hard > all && sum > MANY_ON_AVERAGE * all;
        if are_hard || sum > VERY_MANY_ON_AVERAGE * all {
            let bounds = [self.container.lo, self.container.hi];
            self.octree = PowerOctree::new(&self.sites, bounds, MOST_LISTED, go_on)?;
        }
        Ok(self)
    }
}

impl Search<'_> {
    /// Cuts the cell of a sorted site box by box of the octree, from where it is; `None` where that is not known.
    #[cold]
    #[inline(never)]
    pub(super) fn complete_at_home<S: CellStore>(
        &mut self,
        store: &mut S,
        octree: &PowerOctree,
        site: u32,
        epsilon: Option<Real>,
    ) -> Option<Outcome> {
        let tree = &self.prepared.sites;
        let own @ [x, y, z, _] = tree.site(site);
        let middle = match octree.home(site) {
            Home::At(middle) => middle,
            Home::Nowhere => return Some(Outcome { status: EMPTY, ..Outcome::default() }),
            Home::Unknown => return None,
        };
        // Seen from there, as if half the weights' slope led to it.
        let center = v3(middle[0] - x, middle[1] - y, middle[2] - z);
        let vantage = Vantage { slope: scale(-2.0, center), center, lambda: 0.5, home: HOME_KNOWN };
        let mut cell = Cell::new(store, site, own, Some(vantage.slope), epsilon);
        cell.measure();
        let mut searched = Searched::new(&mut cell, tree, Some(octree), &mut self.room, 0.0);
        let mut status = search_boxes(&mut searched, vantage, &mut 0);
        if status == UNTOUCHED {
            status = search_far(&mut searched, center, 1, &mut 0);
        }
        cell.outcome.status = status;
        cell.outcome.opened = self.room.opened();
        Some(cell.outcome)
    }
}
