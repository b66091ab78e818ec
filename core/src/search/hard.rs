//! The search where the octree over the container tells which sites have the least power where, and whether it is worth while to make it.

use super::one_cell::Cell;
use super::store::MOST_LISTED;
use super::{Outcome, Reaches, Search, gather, visit_all};
use crate::Result;
use crate::cell::{self, CellStore, EMPTY, PlainStore, Real, V3, v3};
use crate::diagram::Prepared;
use crate::power_octree::{Home, PowerOctree};
use rayon::prelude::*;

/// Cells that are tried without an octree: so many, one in so many at most, and none where that would be too few to go by. (A hard one takes ten times as
/// long so; a thousand sites are as fast without.)
const MOST_TRIED: usize = 64;
const ONE_IN: usize = 256;
const LEAST_TRIED: usize = 4;

/// Blocks of eight nodes that a cell opens on average, from which on an octree is made. (At 90, clusters with weights of transport, cells take half the
/// time with it; white sites with any weights open 2 to 27.)
const MANY_OPENED: u64 = 40;

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
        let opened = |search: &mut Search<'_>, i: usize| {
            let site = (i * (sites / tried)) as u32;
            let [x, y, z, _] = self.sites.site(site);
            let mut store = PlainStore::new([x, y, z], self.domain_grid());
            u64::from(search.complete(&mut store, site, None).opened)
        };
        let opened: u64 = (0..tried).into_par_iter().map_init(|| Search::new(&self), opened).sum();
        if opened > MANY_OPENED * tried as u64 {
            let bounds = [self.container.lo, self.container.hi];
            self.octree = PowerOctree::new(&self.sites, bounds, MOST_LISTED, go_on)?;
        }
        Ok(self)
    }
}

impl Search<'_> {
    /// Cuts the cell of a sorted site by the sites that are listed where it is, nearest bisector first, and then at its vertices by those that are listed
    /// there; `None` where it is not known where it is.
    pub(super) fn complete_at_home<S: CellStore>(
        &mut self,
        store: &mut S,
        octree: &PowerOctree,
        site: u32,
        epsilon: Option<Real>,
    ) -> Option<Outcome> {
        let tree = &self.prepared.sites;
        let own @ [x, y, z, weight] = tree.site(site);
        let (leaves, middle) = match octree.home(site) {
            Home::At(leaves, middle) => (leaves, middle),
            Home::Nowhere => return Some(Outcome { status: EMPTY, ..Outcome::default() }),
            Home::Unknown => return None,
        };
        // Seen from there, as if half the weights' slope led to it.
        let slope = v3(-2.0 * (middle[0] - x), -2.0 * (middle[1] - y), -2.0 * (middle[2] - z));
        let mut cell = Cell::new(store, site, own, Some(slope), epsilon);
        cell.measure();
        self.reaches.clear();
        self.reaches.extend(leaves.iter().map(|&leaf| Reaches::new(tree.leaf(leaf), [x, y, z], weight, Some(slope))));
        let listed = gather(leaves, &self.reaches, Real::NEG_INFINITY, cell.reach_square, &mut self.candidates);
        if visit_all(tree, &mut cell, listed, Real::INFINITY, true) && self.is_to_complete(&mut cell) {
            self.far(&mut cell, 0.0);
        }
        Some(cell.outcome)
    }

    /// Whether a cell may have something in the domain; what of it is far outside is then cut off.
    fn is_to_complete<S: CellStore>(&self, cell: &mut Cell<'_, S>) -> bool {
        if self.prepared.domain_grid().is_none() {
            return true;
        }
        if cell::lies_outside(cell.store) {
            cell.outcome.status = EMPTY;
            return false;
        }
        let V3 { x: square, .. } = cell.store.farthest_from(cell.center);
        cell.cap(square.sqrt())
    }
}
