//! Sites and grids as `single.cl` reads them: each number as the sum of two single ones, in a unit of the grid's.

use crate::interface::single::Params;
use laguerre_core::diagram::Prepared;
use laguerre_core::site_grid::SiteGrid;
use std::iter;

/// Width of a voxel in the unit, at least: normals are about as large, and from 2⁻⁸ (`EXPANSION_SMALLEST`) to 2¹⁹ (`LARGEST_NORMAL`)
/// they leave room on both sides.
const WIDTH: f64 = 256.0;

/// The smallest voxel that this is held to, in units of the container: farther sites and weights overflow nothing.
const SMALLEST_VOXEL: f64 = 1.0 / (1 << 20) as f64;

/// What two single numbers leave of a difference of two others made so: 2⁻⁴⁸ of each, by the rounding of the second number, and twice
/// as much by that of the differences; with the host's own, and half as much again for the rest.
const LEFT_BY_PAIRS: f64 = 1.0 / (1_u64 << 44) as f64;

/// What rounding may misplace a corner of the site grid by, in units of the largest coordinate, and a site's voxel: one for the width, two
/// for the corner, two for the site, or five for a quotient; and a point in the domain's grid, whose extent is up to twice as much: one for
/// the site, the cell and the grid's corner, five for their sums, ten for the quotient, eight for the voxel's corner.
const ROUNDINGS_OF_SITE: f64 = 16.0 * (f32::EPSILON as f64 / 2.0);
const ROUNDINGS_IN_DOMAIN: f64 = 32.0 * (f32::EPSILON as f64 / 2.0);

/// What a device needs of a diagram, but for the domain's tables.
pub(super) struct Scene {
    pub(super) params: Params,
    pub(super) sites: Vec<[f32; 4]>,
    pub(super) rests: Vec<[f32; 4]>,
    pub(super) weights: Vec<f32>,
    /// Length of the unit in the diagram's frame.
    pub(super) unit: f64,
}

impl Scene {
    pub(super) fn new(prepared: &Prepared<SiteGrid>) -> Self {
        let (grid, container) = (&prepared.sites, &prepared.container);
        let voxels = grid.voxels();
        let extent = (0..3).map(|k| container.hi[k] - container.lo[k]).fold(0.0, f64::max);
        let scale = (WIDTH / voxels.width.max(extent * SMALLEST_VOXEL)).log2().ceil().exp2();
        let place = |c: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| (c[k] - voxels.lo[k]) * scale) };
        let lightest = grid.sites().iter().fold(f64::INFINITY, |w, site| w.min(site[3]));
        let weigh = |w: f64| (w - lightest) * (scale * scale);
        let (box_lo, box_hi) = (place(container.lo), place(container.hi));
        let mut farthest = box_lo.iter().chain(&box_hi).fold(0.0_f64, |far, x| far.max(x.abs()));
        let (mut sites, mut rests) = (Vec::with_capacity(grid.len()), Vec::with_capacity(grid.len()));
        for &[x, y, z, w] in grid.sites() {
            let [x, y, z] = place([x, y, z]);
            farthest = farthest.max(x).max(y).max(z);
            let (site, rest) = in_two([x, y, z, weigh(w)]);
            sites.push(site);
            rests.push(rest);
        }
        let levels = grid.levels();
        let heaviest = weigh(grid.largest_weight());
        let mut params = Params {
            grid_width: (voxels.width * scale) as f32,
            grid_pad: up(ROUNDINGS_OF_SITE * farthest),
            position_error: up(LEFT_BY_PAIRS * farthest),
            weight_error: up(LEFT_BY_PAIRS * heaviest),
            largest_weight: up(heaviest),
            grid_dims: voxels.dims,
            top_level: levels.len() as u32 - 1,
            ..Params::default()
        };
        (params.box_lo, params.box_lo_rest) = in_two(box_lo);
        (params.box_hi, params.box_hi_rest) = in_two(box_hi);
        let begins =
            levels.iter().scan(0, |next, level| Some(std::mem::replace(next, *next + level.largest_weight.len())));
        iter::zip(&mut params.level_begin, begins).for_each(|(slot, begin)| *slot = begin as u32);
        if let Some(domain) = prepared.domain_grid() {
            params.domain_lo = place(domain.corner([0; 3])).map(|x| x as f32);
            params.domain_width = (domain.voxel_width() * scale) as f32;
            params.domain_margin = up(ROUNDINGS_IN_DOMAIN * farthest);
            params.domain_dims = domain.dims();
            params.has_domain = 1;
        }
        let weights = levels.iter().flat_map(|level| &level.largest_weight).map(|&w| up(weigh(w))).collect();
        Self { params, sites, rests, weights, unit: 1.0 / scale }
    }
}

/// Numbers as sums of two single ones.
fn in_two<const N: usize>(x: [f64; N]) -> ([f32; N], [f32; N]) {
    let high = x.map(|x| x as f32);
    (high, std::array::from_fn(|k| (x[k] - f64::from(high[k])) as f32))
}

/// The next single number that is not smaller.
fn up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}
