//! The highest of the planes that touch the potential, one for each cell.
//!
//! The potential `ψ(p) = (‖p‖² − w)/2` is convex, and the cell of a site is the set of its gradients there. So a cell of barycenter b, of a site q,
//! has the plane `ψ(q) + b·(p − q)`, which `ψ` is nowhere below. Where another site p is on the highest of them, its weight is the least with which it
//! has some cell's barycenter in its own.

use laguerre_core::Output;
use laguerre_core::parallel;
use laguerre_core::summation::chunks;
use std::ops::Range;

use super::levels::halved;
use crate::vectors::{distance2, inner, map};

/// Children of a node, and planes of a leaf.
const CHILDREN: usize = 8;

/// For so few questions all planes are gone through: to put them in order takes as long as some ten times that.
const FEW: usize = 8;

/// The planes of some cells.
pub(super) struct Tangents {
    tangents: Vec<Tangent>,
    /// The row of the cell of each.
    rows: Vec<u32>,
    /// The nodes of each level, the leaves first, a single one last; none where there are few questions.
    levels: Vec<Vec<Node>>,
}

/// The plane of a cell.
#[derive(Clone, Copy, Default)]
struct Tangent {
    weight: f64,
    site: [f64; 3],
    barycenter: [f64; 3],
}

/// Some planes that follow each other.
struct Node {
    /// The site of one, the least weight that a site there is to have, and the box of the barycenters.
    site: [f64; 3],
    least: f64,
    lo: [f64; 3],
    hi: [f64; 3],
}

impl Tangent {
    /// The weight of a site at p that is on this plane: `w + (p − q)·(p + q − 2b)`.
    fn weight_at(&self, p: [f64; 3]) -> f64 {
        let (q, b) = (self.site, self.barycenter);
        let way = std::array::from_fn(|k| p[k] - q[k]);
        self.weight + inner(way, std::array::from_fn(|k| (p[k] - b[k]) + (q[k] - b[k])))
    }
}

impl Node {
    fn new(tangents: &[Tangent]) -> Self {
        let along = |k: usize| tangents.iter().map(move |tangent| tangent.barycenter[k]);
        let lo = std::array::from_fn(|k| along(k).fold(f64::INFINITY, f64::min));
        let hi = std::array::from_fn(|k| along(k).fold(f64::NEG_INFINITY, f64::max));
        // That whose barycenter is in the middle: the bound misses half of the box's width then, not up to all of it.
        let middle = std::array::from_fn(|k| 0.5 * (lo[k] + hi[k]));
        let away = |tangent: &Tangent| distance2(tangent.barycenter, middle);
        let site = tangents.iter().min_by(|a, b| away(a).total_cmp(&away(b))).map_or(middle, |tangent| tangent.site);
        Self {
            site,
            least: tangents.iter().map(|tangent| tangent.weight_at(site)).fold(f64::INFINITY, f64::min),
            lo,
            hi,
        }
    }

    /// On none of these planes a site at p has a smaller weight: from `site` to p the weight changes by `(p − site)·(p + site − 2b)`.
    fn bound(&self, p: [f64; 3]) -> f64 {
        let q = self.site;
        let change = |k: usize| {
            let way = p[k] - q[k];
            let b = if way > 0.0 { self.hi[k] } else { self.lo[k] };
            way * ((p[k] - b) + (q[k] - b))
        };
        self.least + change(0) + change(1) + change(2)
    }
}

impl Tangents {
    /// Of the cells of some of these sites, none of which is empty, for so many questions.
    pub(super) fn new(positions: &[[f64; 3]], weights: &[f64], output: &Output, sites: &[u32], asked: usize) -> Self {
        let tangent = |row: usize| {
            let i = sites[row] as usize;
            Tangent { weight: weights[i], site: positions[i], barycenter: output.barycenter()[i] }
        };
        let tangents = map(sites.len(), tangent);
        if asked <= FEW { Self { tangents, rows: Vec::new(), levels: Vec::new() } } else { Self::of(&tangents) }
    }

    fn of(given: &[Tangent]) -> Self {
        // What a node's bound misses is as large as its barycenters are apart, along whatever axis. (In the order of the sites, which lie otherwise where they
        // are crowded, 230 of 2,048 leaves were gone through, twice as many with four times the sites.)
        let barycenters: Vec<[f64; 3]> = given.iter().map(|tangent| tangent.barycenter).collect();
        let depth = (0..).find(|depth| given.len() <= CHILDREN << depth).unwrap_or(0);
        let rows = halved(&barycenters, depth);
        let tangents: Vec<Tangent> = rows.iter().map(|&row| given[row as usize]).collect();
        let mut levels: Vec<Vec<Node>> = Vec::new();
        let mut width = CHILDREN;
        while levels.last().is_none_or(|last| last.len() > 1) {
            let node = |k: usize| Node::new(&tangents[k * width..tangents.len().min((k + 1) * width)]);
            levels.push(parallel::results(tangents.len().div_ceil(width), node));
            width *= CHILDREN;
        }
        Self { tangents, rows, levels }
    }

    /// The weight of a site at p that is on the highest plane, and the row of the cell whose plane that is; of equals the first.
    pub(super) fn highest(&self, p: [f64; 3]) -> (f64, usize) {
        let Some(top) = self.levels.len().checked_sub(1) else {
            let less = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
            let least = |part: Range<usize>| part.map(|row| (self.tangents[row].weight_at(p), row)).min_by(less);
            return chunks(self.tangents.len(), least).into_iter().flatten().min_by(less).unwrap_or((f64::INFINITY, 0));
        };
        let mut found = (f64::INFINITY, 0);
        self.descend(p, top, 0, &mut found);
        found
    }

    fn descend(&self, p: [f64; 3], level: usize, node: usize, found: &mut (f64, usize)) {
        let begin = node * CHILDREN;
        if level == 0 {
            for (k, tangent) in self.tangents[begin..self.tangents.len().min(begin + CHILDREN)].iter().enumerate() {
                let (weight, row) = (tangent.weight_at(p), self.rows[begin + k] as usize);
                if weight < found.0 || (weight == found.0 && row < found.1) {
                    *found = (weight, row);
                }
            }
            return;
        }
        let below = &self.levels[level - 1];
        let mut children = [(f64::INFINITY, 0); CHILDREN];
        let there = below.len().min(begin + CHILDREN) - begin;
        let children = &mut children[..there];
        for (child, (bound, node)) in children.iter_mut().enumerate() {
            (*bound, *node) = (below[begin + child].bound(p), begin + child);
        }
        children.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &mut (bound, child) in children {
            if bound <= found.0 {
                self.descend(p, level - 1, child, found);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_the_highest_of_all() {
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut point = || std::array::from_fn(|_| unit());
        for cells in [1, 7, 8, 9, 700] {
            let one = |_| Tangent { weight: point()[0], site: point(), barycenter: point() };
            let given: Vec<Tangent> = (0..cells).map(one).collect();
            let tangents = Tangents::of(&given);
            let none = Tangents { tangents: given.clone(), rows: Vec::new(), levels: Vec::new() };
            for _ in 0..100 {
                let p = point();
                let all = given.iter().enumerate().map(|(row, tangent)| (tangent.weight_at(p), row));
                assert_eq!(tangents.highest(p), none.highest(p));
                assert_eq!(tangents.highest(p), all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap());
            }
        }
    }
}
