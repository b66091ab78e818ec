//! The far phase: vertex by vertex, farthest first, the site of least power there.

use super::{Cell, Search};
use crate::cell::{self, COMPLETE, CellStore, Real, UNCERTAIN, V3};
use crate::site_tree::{SiteTree, WIDTH};
use std::collections::HashSet;

/// What is left of a product `ρs` of a vertex's error and a site's distance from it is taken as this share of `s²`, and its square over four
/// times the share: any share is right, a small one keeps what is tried exactly rare.
const SHARE: Real = 9.094_947_017_729_282e-13;

/// Roundings of a difference of powers, in units of the squares that it is made of; and, times a vertex's error radius, what a length of
/// the way to the site adds: 2√3, and as much again for the bound's own roundings.
const ROUNDINGS: Real = 32.0 * Real::EPSILON;
const PER_LENGTH: Real = 8.0;

/// A node still to be opened, with the least power of its sites at the vertex.
#[derive(Clone, Copy, Debug)]
struct Node {
    power: Real,
    block: u32,
    k: u32,
}

/// The buffers of a descent.
#[derive(Debug, Default)]
pub(super) struct Descent {
    nodes: Vec<Node>,
    /// Sites whose power at the vertex rounding does not tell from the cell's own.
    ties: Vec<u32>,
    /// Those that the present cell was tried with.
    tried: HashSet<u32>,
}

/// A vertex of a cell, from its site.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    place: V3,
    radius: Real,
}

impl Search<'_> {
    /// Completes the cell by its vertices; those within the proven radius of its centre need no look.
    #[cold]
    #[inline(never)]
    pub(super) fn far<S: CellStore>(&mut self, cell: &mut Cell<'_, S>, proven_square: Real, site: u32) {
        for v in 0..cell.store.vertices() {
            cell.store.set_settled(v, false);
        }
        self.descent.tried.clear();
        cell.outcome.status = loop {
            let Some(v) = farthest_unsettled(cell, proven_square) else { break COMPLETE };
            let vertex = Vertex { place: cell.store.position(v), radius: cell.store.radius(v) };
            let least = self.descent.least(&self.prepared.sites, cell, vertex, site);
            let tried = match least {
                Some(j) => self.visit(cell, j),
                None => self.visit_ties(cell),
            };
            match tried {
                // What rounding cannot take back has less power there, or was left out.
                cell::UNTOUCHED if least.is_some() && cell.enlarged.is_none() => break UNCERTAIN,
                cell::UNTOUCHED => cell.store.set_settled(v, true),
                cell::CUT => {}
                status => break status,
            }
        };
    }

    fn visit<S: CellStore>(&self, cell: &mut Cell<'_, S>, j: u32) -> u32 {
        let planes = cell.outcome.cuts;
        if !cell.visit(self.prepared.sites.site(j), j) {
            return cell.outcome.status;
        }
        if cell.outcome.cuts == planes { cell::UNTOUCHED } else { cell::CUT }
    }

    /// Tries what rounding does not tell from the vertex, until something cuts the cell.
    fn visit_ties<S: CellStore>(&mut self, cell: &mut Cell<'_, S>) -> u32 {
        let ties = std::mem::take(&mut self.descent.ties);
        let mut status = cell::UNTOUCHED;
        for &j in &ties {
            // What was tried once cannot cut what is left. (Of sites on a sphere all tie at many vertices of each cell.)
            if self.descent.tried.insert(j) && !(0..cell.store.planes()).any(|f| cell.store.tag(f) == j) {
                status = self.visit(cell, j);
                if status != cell::UNTOUCHED {
                    break;
                }
            }
        }
        self.descent.ties = ties;
        status
    }
}

/// The vertex farthest from the cell's centre of those that are not settled and beyond the proven radius.
fn farthest_unsettled<S: CellStore>(cell: &Cell<'_, S>, proven_square: Real) -> Option<u32> {
    let proven = proven_square.max(0.0).sqrt();
    let mut found = None;
    let mut far = 0.0;
    for v in 0..cell.store.vertices() {
        let (p, c) = (cell.store.position(v), cell.center);
        let away = super::norm(V3 { x: p.x - c.x, y: p.y - c.y, z: p.z - c.z });
        if away >= far && !cell.store.settled(v) && (away + 2.0 * cell.store.radius(v)) * super::SAFE > proven {
            (found, far) = (Some(v), away);
        }
    }
    found
}

impl Descent {
    /// The site of least power at a vertex, if that is certainly less than the cell's own; else the ties are all that may be.
    fn least<S: CellStore>(&mut self, tree: &SiteTree, cell: &Cell<'_, S>, vertex: Vertex, site: u32) -> Option<u32> {
        let Vertex { place: v, radius } = vertex;
        let own = super::square(v);
        let length = own.sqrt();
        // Beyond this power no site can have less than the cell's: with s the distance from the vertex, rounding is at most
        // PER_LENGTH·radius·(length + s) + ROUNDINGS·(s² + own + …), and s² the power and the largest weight.
        let share = SHARE + 4.0 * ROUNDINGS;
        let heaviest = Real::max(tree.largest_weight() - cell.weight, 0.0);
        let lost = PER_LENGTH * radius;
        let mut limit =
            (own * (1.0 + 2.0 * ROUNDINGS) + lost * length + lost * lost / (4.0 * SHARE) + share * heaviest)
                * (1.0 + 2.0 * share);
        let mut found = None;
        self.ties.clear();
        self.nodes.clear();
        self.open(tree, cell, v, tree.root(), limit);
        while let Some(node) = self.nodes.pop() {
            if node.power >= limit {
                continue;
            }
            if !tree.is_leaf(node.block as usize) {
                self.open(tree, cell, v, tree.child(node.block as usize, node.k as usize), limit);
                continue;
            }
            let first = (node.block * WIDTH as u32 + node.k) * WIDTH as u32;
            for j in first..(first + WIDTH as u32).min(tree.len() as u32) {
                if j == site {
                    continue;
                }
                let (d, more) = cell.difference(tree.site(j));
                let square = super::square(V3 { x: v.x - d.x, y: v.y - d.y, z: v.z - d.z });
                let less = (square - own) - more;
                let rounding =
                    lost * (length + square.sqrt()) + ROUNDINGS * ((square + own) + (more.abs() + super::square(d)));
                if less < -rounding {
                    if found.is_none() || square - more < limit {
                        found = Some(j);
                        limit = limit.min(square - more);
                    }
                } else if less <= rounding && found.is_none() {
                    self.ties.push(j);
                }
            }
        }
        found
    }

    /// The same at a place that is exact.
    #[cfg(test)]
    pub(super) fn least_at<S: CellStore>(&mut self, tree: &SiteTree, cell: &Cell<'_, S>, place: V3) -> Option<u32> {
        self.least(tree, cell, Vertex { place, radius: 0.0 }, cell.site)
    }

    /// Puts the nodes of a block among those to be opened, the nearest last.
    fn open<S: CellStore>(&mut self, tree: &SiteTree, cell: &Cell<'_, S>, v: V3, block: usize, limit: Real) {
        let powers = least_powers(tree, cell.position, cell.weight, v, block);
        let first = self.nodes.len();
        for (k, &power) in powers.iter().enumerate() {
            if power < limit {
                self.nodes.push(Node { power, block: block as u32, k: k as u32 });
            }
        }
        self.nodes[first..].sort_unstable_by(|a, b| b.power.total_cmp(&a.power));
    }
}

/// A lower bound of the power, relative to `weight`, that the sites of each of eight nodes have at `v` from `position`.
#[inline]
fn least_powers(tree: &SiteTree, position: [f64; 3], weight: Real, v: V3, block: usize) -> [Real; WIDTH] {
    let (boxes, slabs) = (tree.boxes(block), tree.slabs(block));
    let way = [v.x, v.y, v.z];
    let own = weight - tree.base_weight();
    let mut powers = [0.0; WIDTH];
    if tree.has_weights() {
        let bounds = tree.weights(block);
        let mut sizes = [0.0; WIDTH];
        for axis in 0..3 {
            for k in 0..WIDTH {
                let (lo, hi) = (boxes.lo[axis][k], boxes.hi[axis][k]);
                let (g, q) = (bounds.g[axis][k], bounds.q[axis][k]);
                let m = 0.5 * (lo + hi);
                let u = (position[axis] - m) + way[axis];
                let (from, to) = (lo - m, hi - m);
                // The least of (u − s)² − (g + qs)s.
                let value = |s: Real| (u - s) * (u - s) - (g + q * s) * s;
                let inner = ((u + 0.5 * g) / (1.0 - q)).max(from).min(to);
                let inner = if q < 1.0 { value(inner) } else { Real::INFINITY };
                powers[k] += Real::min(value(from), value(to)).min(inner);
                let size = (u.abs() + to) + way[axis].abs();
                sizes[k] += size * size;
            }
        }
        for k in 0..WIDTH {
            let size = sizes[k] + (bounds.c[k].abs() + own.abs());
            powers[k] = ((powers[k] - bounds.c[k]) + own) - ROUNDINGS * size;
        }
    } else {
        for axis in 0..3 {
            for k in 0..WIDTH {
                let (lo, hi) = (boxes.lo[axis][k] - position[axis], boxes.hi[axis][k] - position[axis]);
                let gap = Real::max(lo - way[axis], way[axis] - hi).max(0.0);
                powers[k] += gap * gap;
            }
        }
    }
    let at: [f64; 3] = std::array::from_fn(|axis| position[axis] + way[axis]);
    let rounding = ROUNDINGS * ((at[0].abs() + at[1].abs()) + at[2].abs());
    for k in 0..WIDTH {
        let height = (slabs.normal[0][k] * at[0] + slabs.normal[1][k] * at[1]) + slabs.normal[2][k] * at[2];
        let gap = (Real::max(slabs.lo[k] - height, height - slabs.hi[k]) - rounding).max(0.0);
        let less = (gap * gap) * (1.0 - ROUNDINGS) - (slabs.largest_weight[k] - own);
        // Where all weights are equal the last term is zero.
        powers[k] = powers[k].max(less);
    }
    powers
}
