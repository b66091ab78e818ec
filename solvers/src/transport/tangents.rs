//! The highest of the planes that touch the potential, one for each cell.
//!
//! The potential `ψ(p) = (‖p‖² − w)/2` is convex, and the cell of a site is the set of its gradients there. So a cell of barycenter b, of a site q,
//! has the plane `ψ(q) + b·(p − q)`, which `ψ` is nowhere below. Where another site p is on the highest of them, its weight is the least with which it
//! has some cell's barycenter in its own.

use laguerre_core::Output;
use laguerre_core::parallel;
use laguerre_core::summation::chunks;
use pulp::{Arch, NullaryFnOnce};
use std::ops::Range;

use super::levels::halved;
use crate::vectors::{distance2, inner, map};

/// Children of a node, and planes of a leaf.
const CHILDREN: usize = 8;

/// Questions that are asked together, at least: such a group goes over all planes once, and all groups over no more than so many.
const TOGETHER: usize = 512;
const MOST_PLANES: usize = 1 << 28;

/// Questions that go down the tree abreast, a node's bounds for all of them at a time, by the widest instructions that the CPU has. (Eight sites of 200,000 of an NFW profile, which ask
/// 65,536 planes, open 88 nodes together, where one by itself opens some 250. One after the other, a million took 0.92 s on 16 threads, now 0.48.)
const ABREAST: usize = 8;

/// For so few questions all planes are gone through: to put a million in order takes 0.5 s, to go through them for 64 questions 0.14 (two threads); with 256 as long.
const FEW: usize = 128;

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
    /// The box of their barycenters.
    around: Around,
    /// The site of one, and what they come to there.
    site: [f64; 3],
    least: f64,
}

/// A box.
#[derive(Clone, Copy)]
struct Around {
    lo: [f64; 3],
    hi: [f64; 3],
}

/// What the planes of each node, level by level, come to at a place: the least weight that a site there is to have.
struct Anchor {
    place: [f64; 3],
    least: Vec<Vec<f64>>,
}

/// Some of those who ask: where, axis by axis, and the least weight that each has found, with its row.
struct Abreast {
    at: [[f64; ABREAST]; 3],
    weight: [f64; ABREAST],
    row: [usize; ABREAST],
}

impl Tangent {
    /// The weight of a site at p that is on this plane: `w + (p − q)·(p + q − 2b)`.
    #[inline(always)]
    fn weight_at(&self, p: [f64; 3]) -> f64 {
        let (q, b) = (self.site, self.barycenter);
        let way = std::array::from_fn(|k| p[k] - q[k]);
        self.weight + inner(way, std::array::from_fn(|k| (p[k] - b[k]) + (q[k] - b[k])))
    }
}

impl Node {
    fn new(tangents: &[Tangent]) -> Self {
        let around = Around::of(tangents.iter().map(|tangent| tangent.barycenter));
        // That whose barycenter is in the middle: the bound misses half of the box's width then, not up to all of it.
        let middle = around.middle();
        let away = |tangent: &Tangent| distance2(tangent.barycenter, middle);
        let site = tangents.iter().min_by(|a, b| away(a).total_cmp(&away(b))).map_or(middle, |tangent| tangent.site);
        Self {
            around,
            site,
            least: tangents.iter().map(|tangent| tangent.weight_at(site)).fold(f64::INFINITY, f64::min),
        }
    }
}

impl Around {
    /// Of some places.
    fn of(places: impl Iterator<Item = [f64; 3]>) -> Self {
        let none = Self { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };
        places.fold(none, |all, place| Self {
            lo: std::array::from_fn(|k| all.lo[k].min(place[k])),
            hi: std::array::from_fn(|k| all.hi[k].max(place[k])),
        })
    }

    fn middle(&self) -> [f64; 3] {
        std::array::from_fn(|k| 0.5 * (self.lo[k] + self.hi[k]))
    }

    /// Of sites at some places, axis by axis: on no plane of a barycenter in here, on all of which a site at q has at least a weight of `least`, has a site at p a smaller one: from q to p the
    /// weight changes by `(p − q)·(p + q − 2b)`.
    #[inline(always)]
    fn bounds(&self, q: [f64; 3], least: f64, at: &[[f64; ABREAST]; 3]) -> [f64; ABREAST] {
        let mut bounds = [least; ABREAST];
        for k in 0..3 {
            let (lo, hi, q) = (self.lo[k], self.hi[k], q[k]);
            for (bound, &p) in bounds.iter_mut().zip(&at[k]) {
                let way = p - q;
                let b = if way > 0.0 { hi } else { lo };
                *bound += way * ((p - b) + (q - b));
            }
        }
        bounds
    }
}

/// Of weights and rows the less, of equal weights the first row.
fn less(a: &(f64, usize), b: &(f64, usize)) -> std::cmp::Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
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
            levels.push(parallel::chunks(tangents.len(), width, |range| Node::new(&tangents[range])));
            width *= CHILDREN;
        }
        Self { tangents, rows, levels }
    }

    /// For each of some sites, which had better be in an order that keeps neighbors together: the weight of a site there that is on the highest plane, and the row of
    /// the cell whose plane that is; of equals the first.
    ///
    /// A node's bound is the better of two: from what its planes come to at a site of its own, and at the middle of some sites that follow each other. (Of 100,000 sites, 33,000 planes: 235 to 300 nodes
    /// are opened a site of a Plummer cluster, of clusters, of two clusters and of a Lévy flight; with the first alone 320 to 730, for along the boundary between the cells of two clusters it misses as
    /// much as these are apart; with the second alone 350 to 1,400, for some sites lie far apart.) Both are up to rounding, so that of planes as high as each other up to that any may be found.
    pub(super) fn highest(&self, points: &[[f64; 3]]) -> Vec<(f64, usize)> {
        if self.levels.is_empty() {
            return self.highest_of_all(points);
        }
        let length = TOGETHER.max(points.len().saturating_mul(self.tangents.len()) / MOST_PLANES);
        let together = parallel::chunks(points.len(), length, |range| {
            let points = &points[range];
            let anchor = self.anchor(points);
            Arch::new().dispatch(Descent { tangents: self, anchor: &anchor, points })
        });
        together.concat()
    }

    /// The same where there are no nodes.
    fn highest_of_all(&self, points: &[[f64; 3]]) -> Vec<(f64, usize)> {
        let parts = chunks(self.tangents.len(), |part| Arch::new().dispatch(All { tangents: self, part, points }));
        let least = |k: usize| parts.iter().map(|found| found[k]).min_by(less).unwrap_or((f64::INFINITY, 0));
        (0..points.len()).map(least).collect()
    }

    /// At the middle of some places.
    fn anchor(&self, points: &[[f64; 3]]) -> Anchor {
        let place = Around::of(points.iter().copied()).middle();
        let least_of = |weights: &[f64]| weights.iter().copied().fold(f64::INFINITY, f64::min);
        let of_leaf =
            |leaf: &[Tangent]| leaf.iter().map(|tangent| tangent.weight_at(place)).fold(f64::INFINITY, f64::min);
        let mut least: Vec<Vec<f64>> = vec![self.tangents.chunks(CHILDREN).map(of_leaf).collect()];
        while let Some(last) = least.last().filter(|last| last.len() > 1) {
            least.push(last.chunks(CHILDREN).map(least_of).collect());
        }
        Anchor { place, least }
    }
}

/// All who ask, some abreast after the others, and a part of the planes.
struct All<'a> {
    tangents: &'a Tangents,
    part: Range<usize>,
    points: &'a [[f64; 3]],
}

impl NullaryFnOnce for All<'_> {
    type Output = Vec<(f64, usize)>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let mut found = Vec::with_capacity(self.points.len());
        for points in self.points.chunks(ABREAST) {
            let mut asked = Abreast::new(points);
            for row in self.part.clone() {
                asked.add(&self.tangents.tangents[row], row);
            }
            found.extend(asked.weight.into_iter().zip(asked.row).take(points.len()));
        }
        found
    }
}

/// Those who ask together, some abreast after the others.
struct Descent<'a> {
    tangents: &'a Tangents,
    anchor: &'a Anchor,
    points: &'a [[f64; 3]],
}

/// A node that is to be looked at, its level, and what its planes come to at least for each who asks.
#[derive(Clone, Copy, Default)]
struct Open {
    level: usize,
    node: usize,
    bound: [f64; ABREAST],
    sum: f64,
}

impl NullaryFnOnce for Descent<'_> {
    type Output = Vec<(f64, usize)>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let (mut found, mut open) = (Vec::with_capacity(self.points.len()), Vec::new());
        for points in self.points.chunks(ABREAST) {
            let Abreast { weight, row, .. } = self.highest(points, &mut open);
            found.extend(weight.into_iter().zip(row).take(points.len()));
        }
        found
    }
}

impl Descent<'_> {
    /// For up to as many as ask abreast; `open` is scratch.
    #[inline(always)]
    fn highest(&self, points: &[[f64; 3]], open: &mut Vec<Open>) -> Abreast {
        let Self { tangents: Tangents { tangents, rows, levels }, anchor, .. } = self;
        let mut asked = Abreast::new(points);
        open.push(Open { level: levels.len() - 1, ..Open::default() });
        while let Some(Open { level, node, bound, .. }) = open.pop() {
            // (Not one after the other.)
            let is_of_use = bound.iter().zip(&asked.weight).fold(false, |any, (bound, weight)| any | (bound <= weight));
            if !is_of_use {
                continue;
            }
            let begin = node * CHILDREN;
            if level == 0 {
                let end = tangents.len().min(begin + CHILDREN);
                tangents[begin..end]
                    .iter()
                    .zip(&rows[begin..end])
                    .for_each(|(plane, &row)| asked.add(plane, row as usize));
                continue;
            }
            let (below, least) = (&levels[level - 1], &anchor.least[level - 1]);
            let first = open.len();
            for node in begin..below.len().min(begin + CHILDREN) {
                let Node { around, site, least: own } = &below[node];
                let mut bound = around.bounds(anchor.place, least[node], &asked.at);
                let from_own = around.bounds(*site, *own, &asked.at);
                for (bound, own) in bound.iter_mut().zip(from_own) {
                    *bound = if *bound > own { *bound } else { own };
                }
                open.push(Open { level: level - 1, node, bound, sum: bound.iter().sum() });
            }
            // The lowest, of all who ask together, comes next.
            open[first..].sort_unstable_by(|a, b| b.sum.total_cmp(&a.sum));
        }
        asked
    }
}

impl Abreast {
    /// Those at some places; where these are fewer the last asks several times.
    #[inline(always)]
    fn new(points: &[[f64; 3]]) -> Self {
        let point = |lane: usize| points[lane.min(points.len() - 1)];
        Self {
            at: std::array::from_fn(|k| std::array::from_fn(|lane| point(lane)[k])),
            weight: [f64::INFINITY; ABREAST],
            row: [0; ABREAST],
        }
    }

    #[inline(always)]
    fn place(&self, lane: usize) -> [f64; 3] {
        [self.at[0][lane], self.at[1][lane], self.at[2][lane]]
    }

    /// Takes a plane, of that row, where it is the highest so far.
    #[inline(always)]
    fn add(&mut self, plane: &Tangent, row: usize) {
        let weight: [f64; ABREAST] = std::array::from_fn(|lane| plane.weight_at(self.place(lane)));
        for (lane, &weight) in weight.iter().enumerate() {
            let is_less = weight < self.weight[lane] || (weight == self.weight[lane] && row < self.row[lane]);
            self.weight[lane] = if is_less { weight } else { self.weight[lane] };
            self.row[lane] = if is_less { row } else { self.row[lane] };
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
            let points: Vec<[f64; 3]> = (0..2 * TOGETHER / 3 * 2).map(|_| point()).collect();
            let found = tangents.highest(&points);
            assert_eq!(found, none.highest(&points));
            for (&p, found) in points.iter().zip(found) {
                let all = given.iter().enumerate().map(|(row, tangent)| (tangent.weight_at(p), row));
                assert_eq!(found, all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap());
            }
        }
    }
}
