//! Constants and structs of the kernels in single precision, and their parameters.
#![allow(dead_code, reason = "the kernels use all of it")]

use super::table::kernels;
use laguerre_core::site_tree;

pub(crate) type Boxes = site_tree::Boxes<f32>;
pub(crate) type Slabs = site_tree::Slabs<f32>;
pub(crate) type WeightBounds = site_tree::WeightBounds<f32>;

/// The outcome of a cell: its status, and beside it whether a wider stage was needed.
pub(crate) const OUTCOME_STATUS: u32 = 0xff;
pub(crate) const OUTCOME_EXACT: u32 = 0x100;

/// Scalars of an evaluation, in a unit of the sites' (`single/scene.rs`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Params {
    /// Initial cell, each coordinate as the sum of two numbers.
    pub(crate) box_lo: [f32; 3],
    pub(crate) box_lo_rest: [f32; 3],
    pub(crate) box_hi: [f32; 3],
    pub(crate) box_hi_rest: [f32; 3],
    /// What the two numbers of a position, and of a weight, leave of a difference of two of them, at most.
    pub(crate) position_error: f32,
    pub(crate) weight_error: f32,
    /// Of sites that are nearer than this, along all axes, single numbers tell too little.
    pub(crate) least_distance: f32,
    /// Largest weight of all sites; the smallest is 0.
    pub(crate) largest_weight: f32,
    /// Domain grid: minimum corner, width of the voxels, and what rounding may misplace a point by.
    pub(crate) domain_lo: [f32; 3],
    pub(crate) domain_width: f32,
    pub(crate) domain_margin: f32,
    pub(crate) domain_dims: [u32; 3],
    pub(crate) has_domain: u32,
    /// Whether all weights are equal.
    pub(crate) equal_weights: u32,
    /// The tree over the sites: how many, the root's level, and where the blocks of each level begin.
    pub(crate) tree_sites: u32,
    pub(crate) tree_top: u32,
    pub(crate) tree_begin: [u32; 12],
}

kernels! {
    kernel SingleCells = single_cells {
        input params: Params,
        /// Sorted sites, x, y, z, weight, each as the sum of two numbers.
        input sites: [f32; 4],
        input rests: [f32; 4],
        /// The tree, all blocks; no bounds of weights where these are equal.
        input boxes: Boxes,
        input slabs: Slabs,
        input weight_bounds: WeightBounds,
        input windings: i32,
        input surface_table: u32,
        /// The cells, `count` of them; results by their place in it.
        input list: u32,
        value count: u32,
        output outcome: u32,
        output sums: [f32; 4],
        atomic most_visited: u32,
    }
}
