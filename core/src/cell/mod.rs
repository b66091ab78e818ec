//! THE algorithm, written once: one cell, in the frame of its site, over a [`CellStore`] that says where it lives.
//!
//! A cell begins as a box ([`begin`]), is cut by bisectors ([`clip`]) until the search proves that no other site can cut it
//! ([`search::search_near`], [`far::search_far`]), and is integrated over the container ([`integrate_cell`]). Signs are exact and a zero is no conflict, which amounts to moving each plane outward by an
//! infinitesimal that dominates all earlier ones: the cell is always a simple polytope, and clipping cannot fail.
//!
//! # The dialect
//!
//! This text is meant to be translated to OpenCL C, so it keeps to a subset of Rust: constants, `#[repr(C)]` structs,
//! free functions; the first parameter may be the store, any other `&mut` is to a local; no slices, references into the
//! store, tuples, `Option`, `match`, closures, operators on structs, or panics; `for` goes over `a..b`, where `b` stays what it is in the loop; locals carry types; float expressions are
//! fully parenthesised, with `sqrt`, `abs` and `max` alone and no fused operation; integers wrap in `wrapping_sub` alone; functions return a status
//! or a plain value. `#[cfg_attr(opencl, …)]` says what is other on devices: `single(…)` is a constant's value in single precision, `returns("…")`
//! what a function does, `rolled` a loop that is not unrolled, `unrolled` one that is; an `if` under `#[cfg(not(opencl))]` is of hosts alone; a function is inlined there, unless it is `outline` (always called) or `hot` (called where each
//! work-item has a cell of its own). Only what is behind `store.rs` (traits; `plain.rs` is that of tests) is written by hand for each backend; the bounds of a
//! function say what it asks of a store, and who asks for a `ClipStore` is for one work-item (`clip`, `restrict`): lanes that share a cell have a text of their own.

// The dialect says what C would say.
#![allow(
    clippy::assign_op_pattern,
    clippy::collapsible_if,
    clippy::needless_return,
    clippy::neg_cmp_op_on_partial_ord,
    clippy::redundant_field_names,
    clippy::too_many_arguments
)]

pub mod around;
pub mod bound;
pub mod boxes;
mod candidates;
mod cap;
mod clip;
mod cone;
mod corners;
mod expansion;
mod facet;
pub mod far;
mod first;
mod integrate;
mod lanes;
mod listed;
mod near;
pub mod node;
pub mod octree;
#[cfg(feature = "test-util")]
pub mod parity;
mod part;
mod plain;
mod plane;
pub(crate) mod quadratic;
mod quadrature;
mod restrict;
pub mod ring;
pub mod search;
pub mod search_store;
mod settle;
mod status;
mod store;
pub(crate) mod sweep;
pub mod table;
pub(crate) mod tree;
mod vector;
mod vertex;
mod wide;
mod widest;

pub use cap::{MOST_CAPS, cap_outside};
pub use clip::{begin, compact_planes, farthest_vertex};
pub use corners::Corners;
pub use facet::{FacetSecond, FacetSum, facet_is_above_bound};
pub use integrate::{
    CellSums, FACET_AREAS, FACET_SECOND_MOMENTS, FACETS, INTEGRAL, SECOND_MOMENTS, VOLUME_ONLY, volume_is_above_bound,
};
pub use lanes::Lanes;
pub(crate) use near::{is_first_voxel, outer_box_of_cell, voxels_of_box};
pub use plain::PlainStore;
pub(crate) use plane::triangle_plane;
pub use plane::{Plane, bisector};
pub use quadrature::Node;
pub use restrict::integrate_cell;
pub use settle::lies_outside;
pub use status::*;
pub use store::{CellStore, ClipStore, CutStore, DomainStore, IntegralStore, Polytope, SignStore, Triangle, Voxel};
pub use vector::{Real, Rough, UNIT_ROUNDOFF, V3, v3};
pub(crate) use vector::{add, cross, dot, norm_1, norm_max, scale, sub};
pub use vertex::{NEARLY_DEPENDENT, Triplet, find_vertex_closely, find_vertex_once, find_vertex_refined};
pub use wide::Minors;
pub use widest::clip;

/// Half-spaces that a host's store looks at together, see [`ClipStore::may_be_cut_by`].
pub const TOGETHER: usize = 8;

/// The flags of [`integrate_cell`] that answer a request.
pub fn flags_of(request: &crate::Request) -> u32 {
    let mut flags = VOLUME_ONLY;
    if request.needs_facets() {
        flags |= FACETS;
        if !request.facets() {
            flags |= FACET_AREAS;
        }
        if request.facet_second_moments() {
            flags |= FACET_SECOND_MOMENTS;
        }
    }
    if request.second_moments() {
        flags |= SECOND_MOMENTS;
    }
    if request.integral().is_some() {
        flags |= INTEGRAL;
    }
    flags
}

#[cfg(test)]
mod tests;
