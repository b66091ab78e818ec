//! The near phase: what the eight sites of a leaf have around them, nearest leaves first, looked up once for all of them.

use super::{Reaches, larger, smaller};
use crate::cell::search::MOST_CURVATURE;
use crate::cell::{Real, V3};
use crate::site_tree::{Boxes, SiteTree, WIDTH, WeightBounds};
use pulp::{Arch, NullaryFnOnce};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Leaves that are found for the first chunk and for each other; those of them that are nearer than all that are not found make the chunk.
const FIRST_LEAVES: usize = 128;
const MORE_LEAVES: usize = 48;

/// Leaves that are found for the first chunk at most, where weights are so rough about the group that fewer prove nothing. (Of 88,000 sites of blue noise with the weights that give cells of one
/// volume in the bunny 11 % would be completed by their vertices, or begin far off; 8 % are so, as their Voronoi cells. That takes 1.4 times the cycles of these, instead of 1.86. 2,048 take as long.)
const MOST_FIRST_LEAVES: usize = 512;

/// Times the square of its diagonal, what the weights of a group's sites differ by beyond their slope where some hide others. (Where 97 of 100 sites are hidden, more leaves for each group take 1.5
/// times as long.)
const HIDING: Real = 0.5;

/// The first candidates of the first chunk are about as near as this many nearest sites of the group's middle one.
const NEAREST: usize = 24;

/// `λ` (see `search`) where weights do not curve the way the distance does.
const LAMBDA: Real = 0.5;

/// Relative room for roundings of sums of some twenty terms.
const ROUNDINGS: Real = 32.0 * Real::EPSILON;

/// A node of the tree, with a lower bound of `(1 − λ)D² − ω` of its sites.
#[derive(Clone, Copy, Debug)]
struct Node {
    power: Real,
    block: u32,
    k: u32,
}

/// The end of a chunk in the list, and a lower bound of `(1 − λ)D² − ω` of all sites beyond it.
#[derive(Clone, Copy, Debug)]
struct Chunk {
    end: usize,
    bound: Real,
}

/// Bounds the powers of the eight nodes of a block, by the widest instructions that the CPU has.
struct Powers<'g, 'a> {
    group: &'g Group<'a>,
    block: usize,
}

impl NullaryFnOnce for Powers<'_, '_> {
    type Output = [Real; WIDTH];

    #[inline(always)]
    fn call(self) -> [Real; WIDTH] {
        let Self { group, block } = self;
        let boxes = group.tree.boxes(block);
        if group.tree.has_weights() {
            return group.least_powers(boxes, group.tree.weights(block));
        }
        let mut powers = group.least_distances(boxes);
        for power in &mut powers {
            *power *= 1.0 - group.lambda;
        }
        powers
    }
}

/// The sites of one leaf, and what is around them.
#[derive(Debug)]
pub(super) struct Group<'a> {
    tree: &'a SiteTree,
    leaf: Option<usize>,
    lo: [Real; 3],
    hi: [Real; 3],
    /// What weights are compared less of, about `origin`.
    slope: [Real; 3],
    curvature: [Real; 3],
    origin: [Real; 3],
    lambda: Real,
    nodes: BinaryHeap<Node>,
    leaves: Vec<Node>,
    listed: Vec<u32>,
    chunks: Vec<Chunk>,
    near: Real,
    /// The instructions that the CPU has.
    arch: Arch,
}

impl<'a> Group<'a> {
    pub(super) fn new(tree: &'a SiteTree) -> Self {
        Self {
            tree,
            leaf: None,
            lo: [0.0; 3],
            hi: [0.0; 3],
            slope: [0.0; 3],
            curvature: [0.0; 3],
            origin: [0.0; 3],
            lambda: LAMBDA,
            nodes: BinaryHeap::new(),
            leaves: Vec::new(),
            listed: Vec::new(),
            chunks: Vec::new(),
            near: 0.0,
            arch: Arch::new(),
        }
    }

    /// Turns to the leaf of a site.
    pub(super) fn turn_to(&mut self, site: usize) {
        let leaf = site / WIDTH;
        if self.leaf == Some(leaf) {
            return;
        }
        self.leaf = Some(leaf);
        self.nodes.clear();
        self.leaves.clear();
        self.chunks.clear();
        self.listed.clear();
        let boxes = self.tree.boxes(leaf / WIDTH);
        let k = leaf % WIDTH;
        self.lo = boxes.lo.map(|lo| lo[k]);
        self.hi = boxes.hi.map(|hi| hi[k]);
        self.origin = boxes.middle(k);
        self.bend();
        self.open(self.tree.root());
        self.list();
        self.look_about((site - site % WIDTH) as u32);
    }

    /// The weights' slope and curvature at the group, and `λ`, from the bound of the sites around it.
    fn bend(&mut self) {
        if !self.tree.has_weights() {
            return;
        }
        let (block, k) = self.tree.around(self.leaf.unwrap_or_default());
        let (bounds, middle) = (self.tree.weights(block), self.tree.boxes(block).middle(k));
        for axis in 0..3 {
            // A cell that its neighbours do not hide has less.
            self.curvature[axis] = bounds.q[axis][k].min(MOST_CURVATURE);
            self.slope[axis] = bounds.g[axis][k] + 2.0 * self.curvature[axis] * (self.origin[axis] - middle[axis]);
        }
        // That bound has no mixed terms (a sum over axes is what has a least value over a box), and its slope may be as wrong as they are large.
        let leaf = self.leaf.unwrap_or_default();
        if let Some((slope, curvature)) = self.tree.slope_about(leaf, self.origin, self.slope, self.curvature) {
            (self.slope, self.curvature) = (slope, curvature.map(|q| q.min(MOST_CURVATURE)));
        }
        let most = self.curvature.iter().fold(0.0, |most, &q| Real::max(most, q));
        self.lambda = 0.5 * (1.0 - most);
    }

    /// The slope of the weights at a site of the group: minus half of it leads to its cell's centre.
    pub(super) fn slope_at(&self, position: [f64; 3]) -> V3 {
        let along = |k: usize| self.slope[k] + 2.0 * self.curvature[k] * (position[k] - self.origin[k]);
        V3 { x: along(0), y: along(1), z: along(2) }
    }

    /// The middle of the group's box.
    #[cfg(test)]
    pub(super) fn middle(&self) -> [f64; 3] {
        self.origin
    }

    /// Whether there is a chunk of this number; lists it if need be.
    pub(super) fn has_chunk(&mut self, chunk: usize) -> bool {
        while self.chunks.len() <= chunk {
            if self.chunks.last().is_some_and(|last| last.bound == Real::INFINITY) {
                return false;
            }
            self.list();
        }
        true
    }

    /// The square of the radius about the centre of a cell of the group within which no site beyond a chunk can cut it, at least.
    pub(super) fn proven_square(&self, chunk: usize, position: [f64; 3], weight: Real) -> Real {
        let (own, size) = self.beyond_slope(position, weight);
        let bound = self.chunks[chunk].bound;
        let margin = if bound == Real::INFINITY { 0.0 } else { ROUNDINGS * (bound.abs() + size) };
        self.lambda * ((bound + own) - margin)
    }

    /// What a site of the group weighs beyond the group's slope and curvature, more than the lightest of all; and the size of the terms that this is a sum of.
    fn beyond_slope(&self, position: [f64; 3], weight: Real) -> (Real, Real) {
        let mut own = weight - self.tree.base_weight();
        let mut size = own.abs();
        for axis in 0..3 {
            let u = position[axis] - self.origin[axis];
            own -= (self.slope[axis] + self.curvature[axis] * u) * u;
            size += (self.slope[axis].abs() + self.curvature[axis].abs() * u.abs()) * u.abs();
        }
        (own, size)
    }

    /// Whether a bound proves nothing for a cell of the group, though its sites do not hide each other.
    fn proves_too_little(&self, bound: Real) -> bool {
        if !self.tree.has_weights() {
            return false;
        }
        let (mut least, mut most) = (Real::INFINITY, Real::NEG_INFINITY);
        let first = self.leaf.unwrap_or_default() * WIDTH;
        for site in first..self.tree.len().min(first + WIDTH) {
            let [x, y, z, weight] = self.tree.site(site as u32);
            let own = self.beyond_slope([x, y, z], weight).0;
            (least, most) = (smaller(least, own), larger(most, own));
        }
        let diagonal: Real = (0..3).map(|axis| self.hi[axis] - self.lo[axis]).map(|extent| extent * extent).sum();
        bound + least <= 0.0 && most - least < HIDING * diagonal
    }

    /// What [`Reaches`] says of the twentieth nearest site of one of the group's: about the square of its distance.
    pub(super) fn near(&self) -> Real {
        self.near
    }

    /// The leaves of a chunk.
    pub(super) fn leaves(&self, chunk: usize) -> &[u32] {
        let begin = if chunk == 0 { 0 } else { self.chunks[chunk - 1].end };
        &self.listed[begin..self.chunks[chunk].end]
    }

    /// Lists one more chunk: the leaves that are nearer than all that is not found yet.
    fn list(&mut self) {
        let is_first = self.chunks.is_empty();
        let mut wanted = self.leaves.len() + if is_first { FIRST_LEAVES } else { MORE_LEAVES };
        let mut bound;
        loop {
            while self.leaves.len() < wanted {
                let Some(nearest) = self.nodes.pop() else { break };
                self.open(self.tree.child(nearest.block as usize, nearest.k as usize));
            }
            bound = self.nodes.peek().map_or(Real::INFINITY, |node| node.power);
            let goes_on = is_first && self.leaves.len() < MOST_FIRST_LEAVES && self.proves_too_little(bound);
            if bound == Real::INFINITY || (!goes_on && self.leaves.iter().any(|leaf| leaf.power < bound)) {
                break;
            }
            wanted = self.leaves.len() + MORE_LEAVES;
        }
        let Self { leaves, listed, .. } = self;
        leaves.retain(|leaf| {
            let is_listed = leaf.power < bound;
            if is_listed {
                listed.push(leaf.block * WIDTH as u32 + leaf.k);
            }
            !is_listed
        });
        self.chunks.push(Chunk { end: self.listed.len(), bound });
    }

    /// Notes how near the nearest sites of the middle one are.
    fn look_about(&mut self, first: u32) {
        let middle = first + (WIDTH as u32 / 2).min(self.tree.len() as u32 - 1 - first);
        let [x, y, z, weight] = self.tree.site(middle);
        let slope = self.tree.has_weights().then(|| self.slope_at([x, y, z]));
        let of_leaf = |leaf: u32| Reaches::new(self.tree.leaf(leaf), [x, y, z], weight, slope);
        // Enough are hardly farther than this.
        let own = of_leaf(middle / WIDTH as u32).of.into_iter().filter(|reach| reach.is_finite()).fold(0.0, Real::max);
        let mut near: Vec<Real> = Vec::with_capacity(4 * NEAREST);
        for &leaf in self.leaves(0) {
            let reaches = of_leaf(leaf);
            if reaches.least <= own {
                near.extend(reaches.of.iter().filter(|&&reach| reach <= own));
            }
        }
        if near.len() <= NEAREST {
            let all = self.leaves(0).iter().flat_map(|&leaf| of_leaf(leaf).of);
            near.clear();
            near.extend(all.filter(|reach| reach.is_finite()));
        }
        let last = NEAREST.min(near.len().saturating_sub(1));
        self.near = if near.is_empty() { 0.0 } else { *near.select_nth_unstable_by(last, Real::total_cmp).1 };
    }

    /// Puts the nodes of a block among those found.
    fn open(&mut self, block: usize) {
        let boxes = self.tree.boxes(block);
        let powers = self.arch.dispatch(Powers { group: self, block });
        let is_leaf = self.tree.is_leaf(block);
        for (k, &power) in powers.iter().enumerate() {
            // Where no node is, the box is nowhere.
            if boxes.lo[0][k] >= crate::site_tree::NOWHERE {
                continue;
            }
            let node = Node { power, block: block as u32, k: k as u32 };
            if is_leaf { self.leaves.push(node) } else { self.nodes.push(node) }
        }
    }

    /// The squared distance from the group's box to each of eight.
    #[inline(always)]
    fn least_distances(&self, boxes: &Boxes) -> [Real; WIDTH] {
        let mut squares = [0.0; WIDTH];
        for axis in 0..3 {
            let (lo, hi) = (self.lo[axis], self.hi[axis]);
            for k in 0..WIDTH {
                let gap = larger(larger(boxes.lo[axis][k] - hi, lo - boxes.hi[axis][k]), 0.0);
                squares[k] += gap * gap;
            }
        }
        squares
    }

    /// A lower bound of `Σ_k α_k (p − p_i)_k² − ω(p)` for each of eight nodes: the least value over the group's box and the node's. `ω` is
    /// what a site weighs beyond the group's slope and curvature, `α_k = 1 − λ − q_k`.
    ///
    /// Along each axis that is `α dist(p, group)² − (s + qu)u`, `u = p − m`, `s` and `q` the differences of slope and curvature: three
    /// parabolas, whose least value is at an end or at one of their stationary points.
    #[inline(always)]
    fn least_powers(&self, boxes: &Boxes, bounds: &WeightBounds) -> [Real; WIDTH] {
        let mut powers = [0.0; WIDTH];
        let mut sizes = [0.0; WIDTH];
        for k in 0..WIDTH {
            powers[k] = -bounds.c[k];
            sizes[k] = bounds.c[k].abs();
        }
        for axis in 0..3 {
            let (a, b) = (self.lo[axis], self.hi[axis]);
            let (slope, curvature) = (self.slope[axis], self.curvature[axis]);
            let alpha = (1.0 - self.lambda) - curvature;
            for k in 0..WIDTH {
                let (lo, hi) = (boxes.lo[axis][k], boxes.hi[axis][k]);
                let m = 0.5 * (lo + hi);
                let away = m - self.origin[axis];
                let (g, q) = (bounds.g[axis][k], bounds.q[axis][k] - curvature);
                let s = g - (slope + 2.0 * curvature * away);
                let value = |p: Real| {
                    let p = smaller(larger(p, lo), hi);
                    let gap = larger(larger(a - p, p - b), 0.0);
                    let u = p - m;
                    alpha * (gap * gap) - (s + q * u) * u
                };
                let steep = 1.0 / (alpha - q);
                let left = (alpha * a + 0.5 * s - q * m) * steep;
                let right = (alpha * b + 0.5 * s - q * m) * steep;
                let middle = m - 0.5 * s / q;
                let ends = smaller(smaller(value(lo), value(hi)), smaller(value(a), value(b)));
                let inner = smaller(smaller(value(left), value(right)), value(middle));
                let least = smaller(ends, inner);
                let moved = (slope + curvature * away) * away;
                let size = (slope.abs() + curvature.abs() * away.abs()) * away.abs();
                let half = hi - m;
                let steepest = (g.abs() + slope.abs()) + (q.abs() * half + 2.0 * curvature.abs() * away.abs());
                powers[k] += least + moved;
                sizes[k] += (least.abs() + size) + (steepest * half + Real::EPSILON * (m * m));
            }
        }
        for k in 0..WIDTH {
            powers[k] -= ROUNDINGS * sizes[k];
        }
        powers
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The nearest is the greatest, which a heap gives first.
impl Ord for Node {
    fn cmp(&self, other: &Self) -> Ordering {
        other.power.total_cmp(&self.power).then_with(|| (other.block, other.k).cmp(&(self.block, self.k)))
    }
}
