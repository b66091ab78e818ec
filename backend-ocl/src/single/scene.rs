//! Sites and tree as `single.cl` reads them, in a unit of the sites'; each number of a site as the sum of two single ones.

use crate::interface::single::{Boxes, Params, Slabs, WeightBounds};
use laguerre_core::diagram::Prepared;
use laguerre_core::site_tree::{self, SiteTree, WIDTH};
use rayon::prelude::*;

/// The median extent of the leaves in the unit, at least: normals are up to about as large, and from 2⁻⁸ (`EXPANSION_SMALLEST`) to 2¹⁹
/// (`LARGEST_NORMAL`) they leave room on both sides.
const LEAF: f64 = 512.0;

/// The smallest extent of leaves that this is held to, in units of the container: farther sites and weights overflow nothing.
const SMALLEST_LEAF: f64 = 1.0 / (1 << 20) as f64;

/// Coordinate of the boxes of nodes that are not there, as [`site_tree::NOWHERE`]; and what no weight is below there.
const NOWHERE: f64 = 1e16;
const NO_WEIGHT: f32 = -1e36;

/// Slopes and curvatures of weights up to here are single numbers, of whose products with lengths and squares none overflows.
const STEEPEST: f64 = 1e12;

/// The unit roundoff of single numbers.
const UNIT_ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// What two single numbers leave of a difference of two others made so: 2⁻⁴⁸ of each, by the rounding of the second number, and twice
/// as much by that of the differences; with the host's own, and half as much again for the rest.
const LEFT_BY_PAIRS: f64 = 1.0 / (1_u64 << 44) as f64;

/// What that may be of a distance, and of a squared one: the search has room for 64 roundings of a power, of which these are 24 and 4.
const LEFT_OF_DISTANCE: f64 = 2.0 * UNIT_ROUNDOFF;
const LEFT_OF_SQUARE: f64 = 4.0 * UNIT_ROUNDOFF;

/// How far a bound has to move for the search to see the cell's site where its first number has it, in units of the largest coordinate: one
/// rounding of each coordinate, and as much for those of the host. A slab's normal is rounded, too: along each axis by one for its coordinate.
const ROUNDINGS_OF_SITE: f64 = 2.0 * UNIT_ROUNDOFF;
const ROUNDINGS_OF_SLAB: f64 = 8.0 * UNIT_ROUNDOFF;

/// What rounding may misplace a point by in the domain's grid, whose extent is up to twice the largest coordinate, in units of this: one for
/// the site, the cell and the grid's corner, five for their sums, ten for the quotient, eight for the voxel's corner.
const ROUNDINGS_IN_DOMAIN: f64 = 32.0 * UNIT_ROUNDOFF;

/// What a device needs of a diagram, but for the domain's tables.
pub(super) struct Scene {
    pub(super) params: Params,
    pub(super) sites: Vec<[f32; 4]>,
    pub(super) rests: Vec<[f32; 4]>,
    pub(super) boxes: Vec<Boxes>,
    pub(super) slabs: Vec<Slabs>,
    pub(super) weight_bounds: Vec<WeightBounds>,
    /// Length of the unit in the diagram's frame.
    pub(super) unit: f64,
}

impl Scene {
    pub(super) fn new(prepared: &Prepared) -> Self {
        let (tree, container) = (&prepared.sites, &prepared.container);
        let extent = (0..3).map(|k| container.hi[k] - container.lo[k]).fold(0.0, f64::max);
        let scale = (LEAF / leaf_extent(tree).max(extent * SMALLEST_LEAF)).log2().ceil().exp2();
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (container.lo[k] + container.hi[k]));
        let place = |c: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| (c[k] - middle[k]) * scale) };
        let weigh = |w: f64| (w - tree.base_weight()) * (scale * scale);
        let in_unit = |[x, y, z, w]: [f64; 4]| {
            let [x, y, z] = place([x, y, z]);
            in_two([x, y, z, weigh(w)])
        };
        let (sites, rests) = tree.sites().map(in_unit).unzip();
        let (box_lo, box_hi) = (place(container.lo), place(container.hi));
        let farthest_of = |c: [f64; 3]| c.iter().fold(0.0_f64, |far, x| far.max(x.abs()));
        let farthest = tree.sites().map(|[x, y, z, _]| farthest_of(place([x, y, z])));
        let farthest = farthest.fold(farthest_of(box_lo).max(farthest_of(box_hi)), f64::max);
        let heaviest = weigh(tree.largest_weight());
        let (lost, weight_lost) = (LEFT_BY_PAIRS * farthest, LEFT_BY_PAIRS * heaviest);
        let levels = site_tree::level_begins(tree.len());
        let mut params = Params {
            position_error: up(lost),
            weight_error: up(weight_lost),
            least_distance: up((lost / LEFT_OF_DISTANCE).max((weight_lost / LEFT_OF_SQUARE).sqrt())),
            largest_weight: up(heaviest),
            equal_weights: u32::from(!tree.has_weights()),
            tree_sites: tree.len() as u32,
            tree_top: tree.top_level() as u32,
            ..Params::default()
        };
        (params.box_lo, params.box_lo_rest) = in_two(box_lo);
        (params.box_hi, params.box_hi_rest) = in_two(box_hi);
        params.tree_begin.iter_mut().zip(&levels).for_each(|(begin, &level)| *begin = level as u32);
        if let Some(domain) = prepared.domain_grid() {
            params.domain_lo = place(domain.corner([0; 3])).map(|x| x as f32);
            params.domain_width = (domain.voxel_width() * scale) as f32;
            params.domain_margin = up(ROUNDINGS_IN_DOMAIN * farthest);
            params.domain_dims = domain.dims();
            params.has_domain = 1;
        }
        let unit = Unit { middle, scale, farthest };
        Self {
            params,
            sites,
            rests,
            boxes: tree.all_boxes().par_iter().map(|boxes| unit.boxes(boxes)).collect(),
            slabs: tree.all_slabs().par_iter().map(|slabs| unit.slabs(slabs)).collect(),
            weight_bounds: (tree.all_boxes().par_iter().zip(tree.all_weights()))
                .map(|(boxes, weights)| unit.weights(boxes, weights))
                .collect(),
            unit: 1.0 / scale,
        }
    }
}

/// The median of the leaves' largest extents.
fn leaf_extent(tree: &SiteTree) -> f64 {
    let of_leaf = |leaf: usize| {
        let (boxes, k) = (tree.boxes(leaf / WIDTH), leaf % WIDTH);
        (0..3).map(|axis| boxes.hi[axis][k] - boxes.lo[axis][k]).fold(0.0, f64::max)
    };
    let mut extents: Vec<f64> = (0..tree.len().div_ceil(WIDTH)).map(of_leaf).collect();
    let middle = extents.len() / 2;
    *extents.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The unit of a scene, and what bounds its nodes there, in single numbers, rounded outward.
struct Unit {
    middle: [f64; 3],
    scale: f64,
    farthest: f64,
}

impl Unit {
    /// A place along an axis.
    fn along(&self, axis: usize, x: f64) -> f64 {
        ((x - self.middle[axis]) * self.scale).clamp(-NOWHERE, NOWHERE)
    }

    fn boxes(&self, boxes: &site_tree::Boxes) -> Boxes {
        let room = ROUNDINGS_OF_SITE * self.farthest;
        let lo = |axis: usize| boxes.lo[axis].map(|x| down(self.along(axis, x) - room));
        let hi = |axis: usize| boxes.hi[axis].map(|x| up(self.along(axis, x) + room));
        Boxes { lo: [lo(0), lo(1), lo(2)], hi: [hi(0), hi(1), hi(2)] }
    }

    fn slabs(&self, slabs: &site_tree::Slabs) -> Slabs {
        let room = ROUNDINGS_OF_SLAB * self.farthest;
        let of_middle = |k: usize| (0..3).map(|axis| slabs.normal[axis][k] * self.middle[axis]).sum::<f64>();
        let height = |x: f64, k: usize| ((x - of_middle(k)) * self.scale).clamp(-NOWHERE, NOWHERE);
        Slabs {
            normal: slabs.normal.map(|along| along.map(|x| x as f32)),
            lo: std::array::from_fn(|k| down(height(slabs.lo[k], k) - room)),
            hi: std::array::from_fn(|k| up(height(slabs.hi[k], k) + room)),
            largest_weight: slabs.largest_weight.map(|w| up(w * (self.scale * self.scale)).max(NO_WEIGHT)),
        }
    }

    /// The constant makes up for what rounding does to slope and curvature, and for the middle of a box that is moved; where they are too steep for
    /// single numbers, for all of them.
    fn weights(&self, boxes: &site_tree::Boxes, bounds: &site_tree::WeightBounds) -> WeightBounds {
        let moved = 2.0 * ROUNDINGS_OF_SITE * self.farthest;
        let mut single = WeightBounds::default();
        for k in 0..WIDTH {
            let (mut is_steep, mut roundings, mut all) = (false, 0.0, 0.0);
            for axis in 0..3 {
                let (g, q) = (bounds.g[axis][k] * self.scale, bounds.q[axis][k]);
                let width = 0.5 * (boxes.hi[axis][k] - boxes.lo[axis][k]) * self.scale + moved;
                is_steep |= g.abs() > STEEPEST || q.abs() > STEEPEST;
                all += (g.abs() + q.abs() * width) * width;
                roundings += (g.abs() + 2.0 * q.abs() * width) * moved;
                (single.g[axis][k], single.q[axis][k]) = (g as f32, q as f32);
            }
            if is_steep {
                roundings = all;
                for axis in 0..3 {
                    (single.g[axis][k], single.q[axis][k]) = (0.0, 0.0);
                }
            }
            let c = bounds.c[k] * (self.scale * self.scale);
            single.c[k] = up(c + roundings + 2.0 * UNIT_ROUNDOFF * all).max(NO_WEIGHT);
        }
        single
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

/// The next single number that is not larger.
fn down(x: f64) -> f32 {
    -up(-x)
}
