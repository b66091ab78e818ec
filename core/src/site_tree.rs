//! One implicit tree over the sites, whatever their spread: sites along a Hilbert curve, a leaf is eight consecutive sites, a node eight
//! consecutive nodes. By rank, not by place: no pointer, no empty voxel, no crowded one, as deep as log₈ of the number of sites.

#![allow(clippy::needless_range_loop, reason = "loops over eight lanes, and over rows of matrices")]

mod hilbert;
mod slope;

use crate::cell::V3;
use crate::cell::node::{MOST_SAMPLED, NodeSource, box_of_node, slab_of_node, weights_of_node};
use crate::cell::search_store::{NodeBox, NodeSlab, NodeWeights};
use crate::parallel;
use crate::summation::CHUNK;
pub use hilbert::TURNS;
use hilbert::curve_order;
use rayon::prelude::*;
use slope::fit_slope;

/// Sites in a leaf, and nodes in a block.
pub const WIDTH: usize = 8;

/// Levels whose slabs are found from all sites of a node: of those below the sample is all of them, and those above are opened anyway. (From the
/// parts' slabs they are thicker about curved surfaces: a jittered sphere took twice as long, one NVIDIA H200.)
pub const TIGHT_LEVELS: std::ops::Range<usize> = 2..6;

/// Coordinate of the boxes of nodes that are not there: farther than any site, and its square is finite.
pub(crate) const NOWHERE: f64 = 1e150;

/// Eight sibling nodes: the tight boxes of their sites.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Boxes<Real = f64> {
    /// Minimum corners, axis by axis.
    pub lo: [[Real; WIDTH]; 3],
    /// Maximum corners, axis by axis.
    pub hi: [[Real; WIDTH]; 3],
}

/// An upper bound of the weights of each of eight sibling nodes, less [`SiteTree::base_weight`]:
/// `w_j − base ≤ c + g·(p_j − m) + Σ_k q_k (p_j − m)_k²`, `m` the middle of the box. `c` has room for all roundings of evaluating it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct WeightBounds<Real = f64> {
    /// Constant.
    pub c: [Real; WIDTH],
    /// Slope, axis by axis.
    pub g: [[Real; WIDTH]; 3],
    /// Curvature, axis by axis.
    pub q: [[Real; WIDTH]; 3],
}

/// A slab that holds the sites of each of eight sibling nodes, across their thinnest direction: it tells sites that lie along a surface from
/// a sphere that touches the surface.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Slabs<Real = f64> {
    /// Unit normals, axis by axis; zero where the box says as much.
    pub normal: [[Real; WIDTH]; 3],
    /// Least `normal·p`, rounded down.
    pub lo: [Real; WIDTH],
    /// Largest `normal·p`, rounded up.
    pub hi: [Real; WIDTH],
    /// Largest weight, less the base.
    pub largest_weight: [Real; WIDTH],
}

/// Blocks of the tree that one task makes.
const BLOCKS_AT_ONCE: usize = 16;

/// Eight consecutive sites, coordinate by coordinate.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Leaf {
    /// Coordinates, axis by axis; farther than any site where no site is.
    pub at: [[f64; WIDTH]; 3],
    /// Weights.
    pub weight: [f64; WIDTH],
}

/// Sites in the internal frame, in the order of the curve, with the tree over them.
///
/// Of sites at one position only the one with the largest weight (on a tie the lowest index) is in the tree; the cells of the
/// others are empty and they cannot cut any cell. The order depends on the positions alone, not on the caller's order.
#[derive(Debug)]
pub struct SiteTree {
    leaves: Vec<Leaf>,
    order: Vec<u32>,
    coincident: Vec<u32>,
    /// Blocks of all levels, those of the leaves first, the root's last.
    boxes: Vec<Boxes>,
    slabs: Vec<Slabs>,
    /// Empty where all weights are equal.
    weights: Vec<WeightBounds>,
    /// Where the blocks of each level begin in `boxes`; one more at the end.
    levels: Vec<usize>,
    base_weight: f64,
    largest_weight: f64,
}

/// What a device made of a tree.
#[derive(Debug)]
pub struct MadeTree {
    /// The sites in the order of the curve: x, y, z, weight.
    pub sites: Vec<[f64; 4]>,
    /// The caller's index of each.
    pub order: Vec<u32>,
    /// The boxes of all blocks, as [`SiteTree::all_boxes`].
    pub boxes: Vec<Boxes>,
    /// Their slabs.
    pub slabs: Vec<Slabs>,
    /// The bounds of their weights; empty where all weights are equal.
    pub weights: Vec<WeightBounds>,
    /// What these are relative to, at most the smallest weight.
    pub base_weight: f64,
    /// The largest weight, or more.
    pub largest_weight: f64,
}

/// Where the blocks of each level begin in the tree over so many sites (at least one), those of the leaves first; one more at the end.
pub fn level_begins(sites: usize) -> Vec<usize> {
    let mut begins = vec![0];
    let mut nodes = sites.div_ceil(WIDTH);
    loop {
        let blocks = nodes.div_ceil(WIDTH);
        begins.push(begins[begins.len() - 1] + blocks);
        if blocks == 1 {
            return begins;
        }
        nodes = blocks;
    }
}

impl SiteTree {
    /// Over `positions` (at least one, in the frame) with `weights` (one for each, or none).
    pub fn new(positions: &[[f64; 3]], weights: &[f64]) -> Self {
        let weight = |i: u32| weights.get(i as usize).copied().unwrap_or(0.0);
        let mut order = curve_order(positions, &weight);
        let mut coincident = Vec::new();
        let is_second = |k: usize| k > 0 && positions[order[k - 1] as usize] == positions[order[k] as usize];
        if parallel::chunks(order.len(), CHUNK, |mut range| range.any(is_second)).contains(&true) {
            let mut last = None;
            order.retain(|&i| {
                let place = positions[i as usize];
                let is_first = last != Some(place);
                last = Some(place);
                if !is_first {
                    coincident.push(i);
                }
                is_first
            });
        }
        let site = |i: u32| {
            let [x, y, z] = positions[i as usize];
            [x, y, z, weight(i)]
        };
        let sites: Vec<[f64; 4]> = parallel::map(order.len(), CHUNK, |k| site(order[k]));
        let fold = |start: f64, pick: fn(f64, f64) -> f64| sites.iter().fold(start, |w, site| pick(w, site[3]));
        let (base_weight, largest_weight) = (fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max));
        let mut tree = Self {
            leaves: leaves_of(&sites),
            order,
            coincident,
            boxes: Vec::new(),
            slabs: Vec::new(),
            weights: Vec::new(),
            levels: level_begins(sites.len()),
            base_weight,
            largest_weight,
        };
        tree.build(&sites);
        tree
    }

    /// A tree that a device has made, by the same text, of `total` sites, of which `order` has those that stand in it.
    pub fn from_device(made: MadeTree, total: usize) -> Self {
        let MadeTree { sites, order, boxes, slabs, weights, base_weight, largest_weight } = made;
        let mut coincident = Vec::new();
        if order.len() < total {
            let mut is_there = vec![false; total];
            order.iter().for_each(|&i| is_there[i as usize] = true);
            coincident.extend((0..total as u32).filter(|&i| !is_there[i as usize]));
        }
        Self {
            leaves: leaves_of(&sites),
            levels: level_begins(sites.len()),
            order,
            coincident,
            boxes,
            slabs,
            weights,
            base_weight,
            largest_weight,
        }
    }

    /// Number of sites in the tree: all but the coincident ones.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Never: a diagram has at least one site.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Site `i` in the order of the curve: x, y, z, weight.
    #[inline(always)]
    pub fn site(&self, i: u32) -> [f64; 4] {
        let (Leaf { at: [x, y, z], weight }, k) = (&self.leaves[i as usize / WIDTH], i as usize % WIDTH);
        [x[k], y[k], z[k], weight[k]]
    }

    /// All sites in that order.
    pub fn sites(&self) -> impl ExactSizeIterator<Item = [f64; 4]> + '_ {
        (0..self.len() as u32).map(|i| self.site(i))
    }

    /// The caller's index of each sorted site.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The caller's indices of the sites that a coincident one empties.
    pub fn coincident(&self) -> &[u32] {
        &self.coincident
    }

    /// The smallest weight: what the bounds of weights are relative to.
    pub fn base_weight(&self) -> f64 {
        self.base_weight
    }

    /// The largest weight.
    pub fn largest_weight(&self) -> f64 {
        self.largest_weight
    }

    /// Whether weights differ.
    pub fn has_weights(&self) -> bool {
        !self.weights.is_empty()
    }

    /// The root's block.
    pub fn root(&self) -> usize {
        self.boxes.len() - 1
    }

    /// The level of the root's block, 0 that of the leaves.
    pub fn top_level(&self) -> usize {
        self.levels.len() - 2
    }

    /// Where the blocks of a level begin.
    pub fn level_begin(&self, level: usize) -> usize {
        self.levels[level]
    }

    /// The node that holds leaf `leaf` and its siblings, as its block and its number there; the leaf itself where it is in the root's block.
    pub fn around(&self, leaf: usize) -> (usize, usize) {
        if self.levels.len() == 2 {
            return (leaf / WIDTH, leaf % WIDTH);
        }
        let parent = leaf / WIDTH;
        (self.levels[1] + parent / WIDTH, parent % WIDTH)
    }

    /// A better slope and curvature of the weights at the middle of a leaf than `slope` and `curvature`, if its block has any.
    pub(crate) fn slope_about(
        &self,
        leaf: usize,
        middle: [f64; 3],
        slope: [f64; 3],
        curvature: [f64; 3],
    ) -> Option<([f64; 3], [f64; 3])> {
        let first = leaf / WIDTH * WIDTH * WIDTH;
        let mut sites = [[0.0; 4]; WIDTH * WIDTH];
        let count = sites.len().min(self.len() - first);
        for (site, i) in sites[..count].iter_mut().zip(first as u32..) {
            *site = self.site(i);
        }
        fit_slope(&sites[..count], middle, self.base_weight, slope, curvature)
    }

    /// The boxes of the nodes of a block.
    pub fn boxes(&self, block: usize) -> &Boxes {
        &self.boxes[block]
    }

    /// The slabs of the nodes of a block.
    pub fn slabs(&self, block: usize) -> &Slabs {
        &self.slabs[block]
    }

    /// The bounds of the weights of the nodes of a block, where weights differ.
    pub fn weights(&self, block: usize) -> &WeightBounds {
        &self.weights[block]
    }

    /// The boxes of all blocks.
    pub fn all_boxes(&self) -> &[Boxes] {
        &self.boxes
    }

    /// The slabs of all blocks.
    pub fn all_slabs(&self) -> &[Slabs] {
        &self.slabs
    }

    /// The bounds of the weights of all blocks, where weights differ.
    pub fn all_weights(&self) -> &[WeightBounds] {
        &self.weights
    }

    /// Whether the nodes of a block are leaves.
    pub fn is_leaf(&self, block: usize) -> bool {
        block < self.levels[1]
    }

    /// The block of the children of node `k` of a block that has no leaves.
    pub fn child(&self, block: usize, k: usize) -> usize {
        let level = self.levels.partition_point(|&begin| begin <= block) - 1;
        self.levels[level - 1] + (block - self.levels[level]) * WIDTH + k
    }

    /// Leaf `leaf`: the sites from `8 leaf` on.
    #[inline(always)]
    pub fn leaf(&self, leaf: u32) -> &Leaf {
        &self.leaves[leaf as usize]
    }

    /// The boxes, slabs and bounds, a level at a time.
    fn build(&mut self, sites: &[[f64; 4]]) {
        let has_weights = self.base_weight < self.largest_weight;
        let all = self.levels[self.levels.len() - 1];
        self.boxes.resize(all, Boxes::NONE);
        self.slabs.resize(all, Slabs::NONE);
        self.weights.resize(if has_weights { all } else { 0 }, WeightBounds::NONE);
        for level in order_of_levels(self.levels.len() - 1) {
            let span = WIDTH << (3 * level);
            let blocks = self.levels[level + 1] - self.levels[level];
            let block = |block: usize| {
                let (mut boxes, mut slabs, mut weights) = (Boxes::NONE, Slabs::NONE, WeightBounds::NONE);
                for k in 0..WIDTH {
                    let node = block * WIDTH + k;
                    let of_node = &sites[sites.len().min(node * span)..sites.len().min((node + 1) * span)];
                    if of_node.is_empty() {
                        break;
                    }
                    let source = Node { tree: &*self, sites: of_node, level, node };
                    let bounds = box_of_node(&source);
                    boxes.set(k, bounds);
                    let mut slab = slab_of_node(&source, bounds);
                    if TIGHT_LEVELS.contains(&level) {
                        (slab.lo, slab.hi) = heights(of_node, slab.normal);
                    }
                    slabs.set(k, slab);
                    if has_weights {
                        weights.set(k, weights_of_node(&source, bounds));
                    }
                }
                (boxes, slabs, has_weights.then_some(weights))
            };
            let built = parallel::chunks(blocks, BLOCKS_AT_ONCE, |range| range.map(block).collect::<Vec<_>>());
            for (block, (boxes, slabs, weights)) in (self.levels[level]..).zip(built.into_iter().flatten()) {
                self.boxes[block] = boxes;
                self.slabs[block] = slabs;
                if let Some(weights) = weights {
                    self.weights[block] = weights;
                }
            }
        }
    }
}

/// The levels of a tree of so many in the order in which their nodes are bounded: the blocks of leaves first, which have the curvature of their leaves' weights, then the leaves, and
/// the others up to the root.
pub fn order_of_levels(levels: usize) -> impl Iterator<Item = usize> {
    (0..levels).map(move |turn| if turn < 2 && levels > 1 { 1 - turn } else { turn })
}

/// The sites eight by eight.
fn leaves_of(sites: &[[f64; 4]]) -> Vec<Leaf> {
    // (Leaves of nothing would be written by one thread beforehand, a fifth of a kilobyte each.)
    sites.par_chunks(WIDTH).map(Leaf::of).collect()
}

/// A node whose bounds are found.
struct Node<'a> {
    tree: &'a SiteTree,
    sites: &'a [[f64; 4]],
    level: usize,
    node: usize,
}

impl Node<'_> {
    fn sample(&self, i: u32) -> &[f64; 4] {
        &self.sites[i as usize * self.sites.len() / self.sampled() as usize]
    }

    /// A node of the second level below: its block, and its number there.
    fn part(&self, i: u32) -> (usize, usize) {
        let i = i as usize;
        (self.tree.levels[self.level - 2] + self.node * WIDTH + i / WIDTH, i % WIDTH)
    }
}

impl NodeSource for Node<'_> {
    fn sampled(&self) -> u32 {
        self.sites.len().min(MOST_SAMPLED as usize) as u32
    }

    fn sampled_place(&self, i: u32) -> V3 {
        let &[x, y, z, _] = self.sample(i);
        V3 { x, y, z }
    }

    fn sampled_weight(&self, i: u32) -> f64 {
        self.sample(i)[3] - self.tree.base_weight
    }

    fn parts(&self) -> u32 {
        match self.sites.len() > MOST_SAMPLED as usize {
            true => self.sites.len().div_ceil(WIDTH << (3 * (self.level - 2))) as u32,
            false => 0,
        }
    }

    fn part_box(&self, i: u32) -> NodeBox {
        let (block, k) = self.part(i);
        self.tree.boxes[block].get(k)
    }

    fn part_slab(&self, i: u32) -> NodeSlab {
        let (block, k) = self.part(i);
        self.tree.slabs[block].get(k)
    }

    fn part_weights(&self, i: u32) -> NodeWeights {
        let (block, k) = self.part(i);
        self.tree.weights[block].get(k)
    }

    fn curvature_above(&self) -> V3 {
        if self.level > 0 || self.tree.top_level() == 0 {
            return V3::default();
        }
        let above = self.node / WIDTH;
        self.tree.weights[self.tree.levels[1] + above / WIDTH].get(above % WIDTH).curvature
    }
}

impl Leaf {
    fn of(sites: &[[f64; 4]]) -> Self {
        let mut leaf = Self { at: [[NOWHERE; WIDTH]; 3], weight: [0.0; WIDTH] };
        for (k, site) in sites.iter().enumerate() {
            for axis in 0..3 {
                leaf.at[axis][k] = site[axis];
            }
            leaf.weight[k] = site[3];
        }
        leaf
    }
}

/// The least and the largest `normal·p` of sites, rounded outward.
fn heights(sites: &[[f64; 4]], normal: V3) -> (f64, f64) {
    let (mut lo, mut hi, mut size) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for &[x, y, z, _] in sites {
        let height = normal.x * x + normal.y * y + normal.z * z;
        (lo, hi, size) = (lo.min(height), hi.max(height), size.max(x.abs() + y.abs() + z.abs()));
    }
    let outward = 8.0 * f64::EPSILON * size;
    (lo - outward, hi + outward)
}

/// Vector `k` of eight.
fn vector(of: &[[f64; WIDTH]; 3], k: usize) -> V3 {
    V3 { x: of[0][k], y: of[1][k], z: of[2][k] }
}

fn set_vector(of: &mut [[f64; WIDTH]; 3], k: usize, v: V3) {
    (of[0][k], of[1][k], of[2][k]) = (v.x, v.y, v.z);
}

impl Boxes {
    const NONE: Self = Self { lo: [[NOWHERE; WIDTH]; 3], hi: [[NOWHERE; WIDTH]; 3] };

    fn get(&self, k: usize) -> NodeBox {
        NodeBox { lo: vector(&self.lo, k), hi: vector(&self.hi, k) }
    }

    fn set(&mut self, k: usize, bounds: NodeBox) {
        set_vector(&mut self.lo, k, bounds.lo);
        set_vector(&mut self.hi, k, bounds.hi);
    }

    /// The middle of box `k`.
    pub fn middle(&self, k: usize) -> [f64; 3] {
        std::array::from_fn(|axis| 0.5 * (self.lo[axis][k] + self.hi[axis][k]))
    }
}

impl Slabs {
    const NONE: Self = Self {
        normal: [[0.0; WIDTH]; 3],
        lo: [0.0; WIDTH],
        hi: [0.0; WIDTH],
        largest_weight: [f64::NEG_INFINITY; WIDTH],
    };

    fn get(&self, k: usize) -> NodeSlab {
        let normal = vector(&self.normal, k);
        NodeSlab { normal, lo: self.lo[k], hi: self.hi[k], largest: self.largest_weight[k] }
    }

    fn set(&mut self, k: usize, slab: NodeSlab) {
        set_vector(&mut self.normal, k, slab.normal);
        (self.lo[k], self.hi[k], self.largest_weight[k]) = (slab.lo, slab.hi, slab.largest);
    }
}

impl WeightBounds {
    /// Where no node is, no weight is.
    const NONE: Self = Self { c: [-NOWHERE; WIDTH], g: [[0.0; WIDTH]; 3], q: [[0.0; WIDTH]; 3] };

    fn get(&self, k: usize) -> NodeWeights {
        NodeWeights { offset: self.c[k], slope: vector(&self.g, k), curvature: vector(&self.q, k) }
    }

    fn set(&mut self, k: usize, weights: NodeWeights) {
        self.c[k] = weights.offset;
        set_vector(&mut self.g, k, weights.slope);
        set_vector(&mut self.q, k, weights.curvature);
    }
}

#[cfg(test)]
mod tests;
