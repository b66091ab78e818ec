//! Constants and structs of the kernels in single precision, and their parameters.
#![allow(dead_code, reason = "the kernels use all of it")]

use super::table::kernels;

/// Voxels to each side, along each axis, that the table of offsets (`shells.rs`) holds.
pub(crate) const SHELL_RADIUS: u32 = 4;

/// Entries of the table of offsets, and how many of them are about the own voxel.
pub(crate) const SHELLS: u32 = 729;
pub(crate) const INNER_SHELLS: u32 = 27;

/// A voxel with more sites is the host's, which has trees.
pub(crate) const CROWDED: u32 = 256;

/// The outcome of a cell: its status, and beside it whether a wider stage was needed.
pub(crate) const OUTCOME_STATUS: u32 = 0xff;
pub(crate) const OUTCOME_EXACT: u32 = 0x100;

/// Scalars of an evaluation, in a unit of the grid's (`single/scene.rs`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Params {
    /// Initial cell, each coordinate as the sum of two numbers.
    pub(crate) box_lo: [f32; 3],
    pub(crate) box_lo_rest: [f32; 3],
    pub(crate) box_hi: [f32; 3],
    pub(crate) box_hi_rest: [f32; 3],
    /// Width of the voxels of the site grid, whose minimum corner is the origin, and how far outside its voxel rounding may put a site.
    pub(crate) grid_width: f32,
    pub(crate) grid_pad: f32,
    /// What the two numbers of a position, and of a weight, leave of a difference of two of them, at most.
    pub(crate) position_error: f32,
    pub(crate) weight_error: f32,
    /// Largest weight of all sites.
    pub(crate) largest_weight: f32,
    /// Domain grid: minimum corner, width of the voxels, and what rounding may misplace a point by.
    pub(crate) domain_lo: [f32; 3],
    pub(crate) domain_width: f32,
    pub(crate) domain_margin: f32,
    pub(crate) grid_dims: [u32; 3],
    pub(crate) top_level: u32,
    pub(crate) level_begin: [u32; 32],
    pub(crate) domain_dims: [u32; 3],
    pub(crate) has_domain: u32,
}

kernels! {
    kernel SingleCells = single_cells {
        input params: Params,
        /// Sorted sites, x, y, z, weight, each as the sum of two numbers.
        input sites: [f32; 4],
        input rests: [f32; 4],
        /// Where the sites of each voxel begin; one more at the end.
        input voxels: u32,
        /// Largest weight of each node, level after level.
        input weights: f32,
        /// The table of offsets.
        input shells: [u8; 4],
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
