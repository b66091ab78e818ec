//! What is tried with a sample of the cells before all are computed: how much room they need, and by which way they are found.

use super::Device;
use super::schedule::{FIRST, Todo};
use crate::builds::{Stage, Way};
use crate::interface::data::Counters;
use crate::program::MOST_PLANES;
use laguerre_core::cell::{FACET_SECOND_MOMENTS, INTEGRAL};
use laguerre_core::passes::Capacities;
use laguerre_core::{Request, Result};
use std::ops::Range;

/// Sites from which on a sample is worth its time, its size, and how many of it may fail: a pass costs about as much as what it
/// saves the next where one cell in twenty fails (paper §6.1: capacities at 95 %).
const WORTH_A_SAMPLE: usize = 1 << 16;
const SAMPLE: usize = 1024;
pub(super) const MAY_FAIL: f64 = 0.05;

/// Cells of the sample of those that are computed together: as many as a large GPU computes at two times, 0.3 ms.
const SAMPLE_TOGETHER: usize = 4096;

/// Shares of the sample beyond what the first stage searches from which on the tree is made, by the host, and from which on all cells begin in
/// the stage of those that reach far.
const WORTH_A_TREE: f64 = 0.125;
pub(super) const MOSTLY_FAR: f64 = 0.5;

impl Device {
    /// Room such that few cells fail: what sufficed in the last call, or what a sample of the cells needs.
    pub(super) fn first_capacities(&mut self, share: Range<usize>) -> Result<Capacities> {
        if let Some((count, room)) = self.first
            && share.len() / 2 <= count
            && count / 2 <= share.len()
        {
            return Ok(room);
        }
        let mut room = FIRST;
        if share.len() < WORTH_A_SAMPLE {
            return Ok(room);
        }
        // Without facets: they have no room yet.
        self.shared.params.facet_room = 0;
        loop {
            let (all, stride) = (Todo::Sorted(share.clone()), share.len() / SAMPLE);
            if let Some(late) = self.run(Way::Alone(room), &all, stride, 0..SAMPLE, false)? {
                return Err(late);
            }
            let failures = self.counters.failed;
            self.counters = Counters::default();
            self.memory.counters.fill(&self.context, &self.queue, &[self.counters])?;
            if f64::from(failures) <= MAY_FAIL * SAMPLE as f64 || room.grown().planes > MOST_PLANES {
                return Ok(room);
            }
            room = room.grown();
        }
    }

    /// How many work-items compute a cell together, if they do: together no proof is cut short, and what few ask for is not computed.
    pub(super) fn lanes(&self, request: &Request) -> Option<usize> {
        let whole = request.epsilon.is_none() && self.shared.params.flags & (FACET_SECOND_MOMENTS | INTEGRAL) == 0;
        self.together.filter(|_| whole)
    }

    /// Whether the tree over the sites is to be searched, though no voxel is crowded: where enough of the `count` cells need more than the voxels
    /// near their sites, as those of sites on a surface do, and of weights that curve. (Not asked of a domain.)
    pub(crate) fn wants_tree(&mut self, request: &Request, sites: usize, count: usize) -> Result<bool> {
        match self.lanes(request) {
            Some(lanes) if self.domain.is_none() && count >= WORTH_A_SAMPLE => {
                self.clear(request, sites, count)?;
                self.look_about(sites, 0..0)?;
                Ok(self.share_beyond(lanes, 0..count)? > WORTH_A_TREE)
            }
            _ => Ok(false),
        }
    }

    /// The share of a range of cells, where they are many, that reach beyond what the first stage searches, or need more room. (Not of those
    /// that need exact signs: those of a lattice all do, and reach no farther than others.)
    pub(super) fn share_beyond(&mut self, lanes: usize, share: Range<usize>) -> Result<f64> {
        if share.len() < WORTH_A_SAMPLE {
            return Ok(0.0);
        }
        let (way, stride) = (Way::Together(lanes, Stage::First), share.len() / SAMPLE_TOGETHER);
        // Without facets: they have no room yet.
        self.shared.params.facet_room = 0;
        if let Some(late) = self.run(way, &Todo::Sorted(share), stride, 0..SAMPLE_TOGETHER, false)? {
            return Err(late);
        }
        let beyond = self.counters.beyond + self.counters.boundary;
        self.counters = Counters::default();
        self.memory.counters.fill(&self.context, &self.queue, &[self.counters])?;
        Ok(f64::from(beyond) / SAMPLE_TOGETHER as f64)
    }
}
