//! Data that the device reads, laid out as `store.cl` and `evaluate.cl` declare it.

use laguerre_core::cell;
use laguerre_core::diagram::Prepared;
use laguerre_core::{Error, ErrorKind, Request, Result};
use std::mem::offset_of;

/// `Params` of `store.cl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Params {
    box_lo: [f64; 3],
    box_hi: [f64; 3],
    grid_lo: [f64; 3],
    grid_width: f64,
    grid_pad: [f64; 3],
    largest_weight: f64,
    domain_lo: [f64; 3],
    domain_width: f64,
    enlarged: f64,
    grid_dims: [u32; 3],
    top_level: u32,
    level_begin: [u32; 32],
    domain_dims: [u32; 3],
    has_domain: u32,
    has_clusters: u32,
    flags: u32,
    equal_weights: u32,
    pub(crate) facet_room: u32,
}

/// `Cluster` of `store.cl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cluster {
    lo: [f64; 3],
    hi: [f64; 3],
    largest_weight: f64,
    begin: u32,
    end: u32,
    children: u32,
    unused: u32,
}

/// `FacetRecord` of `evaluate.cl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Facet {
    pub(crate) area: f64,
    pub(crate) moment: [f64; 3],
    pub(crate) neighbor: u32,
    pub(crate) unused: u32,
}

/// Numbers that `probe` of `evaluate.cl` writes.
pub(crate) const PROBES: usize = 8;

/// Whether the device lays its data out as the host does.
pub(crate) fn check_layouts(probed: &[u32]) -> Result<()> {
    let expected = [
        size_of::<Params>(),
        offset_of!(Params, grid_dims),
        offset_of!(Params, facet_room),
        size_of::<Cluster>(),
        size_of::<Facet>(),
        size_of::<cell::V3>(),
        size_of::<cell::Plane>(),
        size_of::<cell::CellSums>(),
    ];
    if probed.iter().map(|&n| n as usize).eq(expected) {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Device, format!("the device lays out structs as {probed:?}, the host as {expected:?}")))
}

impl Params {
    pub(crate) fn new(prepared: &Prepared, request: &Request) -> Self {
        let sites = &prepared.sites;
        let mut level_begin = [0; 32];
        let mut begin = 0;
        for (slot, level) in level_begin.iter_mut().zip(sites.levels()) {
            *slot = begin as u32;
            begin += level.largest_weight.len();
        }
        let mut params = Self {
            box_lo: prepared.lo,
            box_hi: prepared.hi,
            grid_lo: sites.corner(),
            grid_width: sites.voxel_width(),
            grid_pad: sites.pad(),
            largest_weight: sites.largest_weight(),
            enlarged: request.epsilon.map_or(0.0, |e| 1.0 + e),
            grid_dims: sites.levels()[0].dims,
            top_level: sites.levels().len() as u32 - 1,
            level_begin,
            has_clusters: u32::from(sites.has_clusters()),
            flags: cell::flags_of(request),
            equal_weights: u32::from(sites.sites().iter().all(|site| site[3] == sites.largest_weight())),
            ..Self::default()
        };
        if let Some(grid) = prepared.domain_grid() {
            params.domain_lo = grid.corner([0; 3]);
            params.domain_width = grid.voxel_width();
            params.domain_dims = grid.dims();
            params.has_domain = 1;
        }
        params
    }
}

/// The trees of the crowded voxels.
pub(crate) fn clusters(prepared: &Prepared) -> Vec<Cluster> {
    let nodes = prepared.sites.clusters().iter();
    nodes
        .map(|node| Cluster {
            lo: node.lo,
            hi: node.hi,
            largest_weight: node.largest_weight,
            begin: node.begin,
            end: node.end,
            children: node.children,
            unused: 0,
        })
        .collect()
}
