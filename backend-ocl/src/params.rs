//! What fills the structs of the interface.

use crate::buffer::Room;
use crate::interface::data::{ALL_SUMS, FEW_SUMS, MOMENT_SUMS, Params, Range};
use crate::queue::Queue;
use crate::voxels::Voxels;
use laguerre_core::assemble::laplacian_unit;
use laguerre_core::diagram::FramedContainer;
use laguerre_core::integrand::FramedIntegrand;
use laguerre_core::site_tree::{self, SiteTree};
use laguerre_core::{Request, Result};
use laguerre_core::{cell, frame};
use opencl3::context::Context;

impl Default for Range {
    fn default() -> Self {
        let (above, below) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { lo: [above; 3], hi: [below; 3], smallest_weight: above, largest_weight: below }
    }
}

impl Range {
    /// The range of both.
    pub(crate) fn joined(&self, other: &Self) -> Self {
        Self {
            lo: std::array::from_fn(|k| self.lo[k].min(other.lo[k])),
            hi: std::array::from_fn(|k| self.hi[k].max(other.hi[k])),
            smallest_weight: self.smallest_weight.min(other.smallest_weight),
            largest_weight: self.largest_weight.max(other.largest_weight),
        }
    }
}

impl Params {
    /// All but what `sort_into` sets.
    pub(crate) fn new(container: &FramedContainer, request: &Request, integrand: Option<&FramedIntegrand>) -> Self {
        let frame = &container.frame;
        let mut params = Self {
            box_lo: container.lo,
            box_hi: container.hi,
            enlarged: request.epsilon().map_or(0.0, |e| 1.0 + e),
            frame_shift: frame.shift(),
            frame_unit: frame.unit(),
            frame_smallest: frame::SMALLEST,
            flags: cell::flags_of(request),
            sums_width: u64::from(sums_of(request)),
            laplacian_unit: laplacian_unit(frame, container.density),
            ..Self::default()
        };
        if let Some(grid) = container.domain_grid() {
            params.domain_lo = grid.corner([0; 3]);
            params.domain_width = grid.voxel_width();
            params.domain_per_width = 1.0 / params.domain_width;
            params.domain_dims = grid.dims();
            params.has_domain = 1;
        }
        if let Some(integrand) = integrand {
            params.origin = integrand.origin();
            params.nodes = integrand.nodes().len() as u32;
            params.degree = integrand.degree();
        }
        params
    }

    /// Who is about to change weights needs the builds for weights that differ: where all are the same at first, a million white sites take 9 ms more so, and four builds
    /// less are to be compiled (8 of 24 s) and brought to the device (40 ms; one NVIDIA H100). A transport of a million sites of which most are outside a mesh begins with one site for all,
    /// and had five builds more for it, 48 of 120 s of the driver's compiler (one NVIDIA H200).
    fn weigh(&mut self, range: &Range, will_differ: bool) {
        self.smallest_weight = range.smallest_weight;
        self.largest_weight = range.largest_weight;
        self.equal_weights = u32::from(range.smallest_weight == range.largest_weight && !will_differ);
    }

    /// The tree over so many sites; returns where the blocks of each level begin, and one more at the end.
    pub(crate) fn search_tree(&mut self, sites: usize) -> Vec<usize> {
        let levels = site_tree::level_begins(sites);
        self.tree_sites = sites as u32;
        self.tree_top = levels.len() as u32 - 2;
        self.tree_begin.iter_mut().zip(&levels).for_each(|(begin, &level)| *begin = level as u32);
        levels
    }

    /// The tree that the host made.
    pub(crate) fn take_tree(&mut self, tree: &SiteTree) {
        self.smallest_weight = tree.base_weight();
        self.largest_weight = tree.largest_weight();
        self.equal_weights = u32::from(!tree.has_weights());
        self.has_table = 0;
        self.search_tree(tree.len());
    }

    /// The grid of the sites, whose weights may be about to differ.
    pub(crate) fn sort_into(&mut self, voxels: &Voxels, range: &Range, will_differ: bool) {
        self.grid_lo = voxels.lo;
        self.grid_width = voxels.width;
        self.grid_per_width = 1.0 / voxels.width;
        self.grid_dims = voxels.dims;
        self.weigh(range, will_differ);
    }
}

/// The sums that are written for each cell.
fn sums_of(request: &Request) -> u32 {
    if request.integral().is_some() {
        ALL_SUMS + 1
    } else if request.facets() {
        ALL_SUMS
    } else if request.second_moments() {
        MOMENT_SUMS
    } else {
        FEW_SUMS
    }
}

/// The parameters on the host, and room for them on the device.
pub(crate) struct Shared {
    pub(crate) params: Params,
    pub(crate) room: Room<Params>,
    /// Whether work-items share cells, and whether weights are about to differ.
    pub(crate) is_shared: bool,
    pub(crate) will_differ: bool,
}

impl Shared {
    pub(crate) fn new() -> Self {
        Self { params: Params::default(), room: Room::new("parameters"), is_shared: false, will_differ: false }
    }

    /// Brings the parameters to the device.
    pub(crate) fn send(&mut self, context: &Context, queue: &Queue) -> Result<()> {
        self.room.fill(context, queue, &[self.params])
    }
}
