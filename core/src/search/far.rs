//! The far phase: vertex by vertex, farthest first, the site of least power there.

use super::{Cell, Search, larger, least_of, smaller};
use crate::cell::{self, COMPLETE, CellStore, Real, UNCERTAIN, V3};
use crate::site_tree::{Boxes, Leaf, SiteTree, Slabs, WIDTH, WeightBounds};
use std::collections::HashSet;

/// What is left of a product `ρs` of a vertex's error and a site's distance from it is taken as this share of `s²`, and its square over four
/// times the share: any share is right, a small one keeps what is tried exactly rare.
const SHARE: Real = 9.094_947_017_729_282e-13;

/// Roundings of a difference of powers, in units of the squares that it is made of; and, times a vertex's error radius, what a length of
/// the way to the site adds: 2√3, and as much again for the bound's own roundings.
const ROUNDINGS: Real = 32.0 * Real::EPSILON;
const PER_LENGTH: Real = 8.0;

/// Vertices that one descent asks for at most. (What a block says from the cell's site is computed once for all of them.)
const MOST_AT_ONCE: usize = 8;

/// A node still to be opened: the vertices that its sites may cut off, a bit for each, and the least power there.
#[derive(Clone, Copy, Debug)]
struct Node {
    power: Real,
    block: u32,
    k: u32,
    asks: u32,
}

/// A vertex of a cell, from its site, and what is known of the sites' powers there.
#[derive(Clone, Copy, Debug)]
struct Asked {
    /// Its number in the store, and the sites of its half-spaces.
    number: u32,
    touching: [u32; 3],
    place: V3,
    /// The cell's own power, and the distance from its site.
    own: Real,
    length: Real,
    /// What its error radius takes from a power, a length.
    lost: Real,
    /// Beyond this power no site can have less than the cell's; or than the site that was found.
    limit: Real,
}

/// The buffers of a descent.
#[derive(Debug, Default)]
pub(super) struct Descent {
    nodes: Vec<Node>,
    asked: Vec<Asked>,
    /// Vertices that are not settled, with the square of a distance.
    open: Vec<(Real, u32)>,
    /// Sites whose power at the first vertex rounding does not tell from the cell's own.
    ties: Vec<u32>,
    /// Those that the present cell was tried with.
    tried: HashSet<u32>,
}

impl Search<'_> {
    /// Completes the cell by its vertices; those within the proven radius of its centre need no look.
    #[cold]
    #[inline(never)]
    pub(super) fn far<S: CellStore>(&mut self, cell: &mut Cell<'_, S>, proven_square: Real) {
        for v in 0..cell.store.vertices() {
            cell.store.set_settled(v, false);
        }
        self.descent.tried.clear();
        // Where many sites in a row have not cut a simple cell, few will.
        let is_simple = cell.is_idle && cell.store.vertices() as usize <= 2 * MOST_AT_ONCE;
        let mut at_once = if is_simple { MOST_AT_ONCE } else { 1 };
        cell.outcome.status = loop {
            let Some(v) = self.descent.ask(cell, proven_square, at_once) else { break COMPLETE };
            let least = self.descent.least(&self.prepared.sites, cell);
            let tried = match least {
                Some(j) => self.visit(cell, j),
                None => self.visit_ties(cell),
            };
            // Where one vertex stays, others do: a cut would waste what was asked for them.
            at_once = if tried == cell::UNTOUCHED { MOST_AT_ONCE.min(2 * at_once) } else { 1 };
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

impl Descent {
    /// Asks for the vertex farthest from the cell's centre of those that are not settled and beyond the proven radius, and for others near it.
    fn ask<S: CellStore>(&mut self, cell: &Cell<'_, S>, proven_square: Real, at_once: usize) -> Option<u32> {
        let proven = proven_square.max(0.0).sqrt();
        self.open.clear();
        let (mut first, mut far) = (None, 0.0);
        for v in 0..cell.store.vertices() {
            let away = super::norm(less(cell.store.position(v), cell.center));
            if !cell.store.settled(v) && (away + 2.0 * cell.store.radius(v)) * super::SAFE > proven {
                self.open.push((0.0, v));
                if away >= far {
                    (first, far) = (Some(v), away);
                }
            }
        }
        let first = first?;
        if at_once > 1 {
            let place = cell.store.position(first);
            for (square, v) in &mut self.open {
                *square = if *v == first { -1.0 } else { super::square(less(cell.store.position(*v), place)) };
            }
            self.open.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            self.open.truncate(at_once);
        } else {
            self.open.clear();
            self.open.push((0.0, first));
        }
        Some(first)
    }

    /// The site of least power at the first vertex asked for, if that is certainly less than the cell's own; else the ties are all that may be.
    /// Settles those of the others where no site has less power or ties, but for those that they lie on.
    fn least<S: CellStore>(&mut self, tree: &SiteTree, cell: &mut Cell<'_, S>) -> Option<u32> {
        self.asked.clear();
        for &(_, v) in &self.open {
            let touching = |f: u32| cell.store.tag(f);
            let triplet = cell.store.triplet(v);
            let touching = [touching(triplet.a), touching(triplet.b), touching(triplet.c)];
            let (place, radius) = (cell.store.position(v), cell.store.radius(v));
            self.asked.push(Asked::new(tree, cell.weight, place, radius, v, touching));
        }
        let (found, left) = self.descend(tree, cell);
        for (i, asked) in self.asked.iter().enumerate().skip(1) {
            if left >> i & 1 != 0 {
                cell.store.set_settled(asked.number, true);
            }
        }
        found
    }

    /// The same, and a bit for each vertex that stays, the first not counted.
    fn descend<S: CellStore>(&mut self, tree: &SiteTree, cell: &Cell<'_, S>) -> (Option<u32>, u32) {
        let mut found = None;
        let mut left = (1_u32 << self.asked.len()) - 1;
        self.ties.clear();
        self.nodes.clear();
        self.open_block(tree, cell, tree.root(), left);
        while let Some(node) = self.nodes.pop() {
            let asks = node.asks & left;
            if asks == 0 || (asks == 1 && node.power >= self.asked[0].limit) {
                continue;
            }
            if !tree.is_leaf(node.block as usize) {
                self.open_block(tree, cell, tree.child(node.block as usize, node.k as usize), asks);
                continue;
            }
            let leaf = node.block * WIDTH as u32 + node.k;
            let sites = NearSites::new(tree.leaf(leaf), cell.position, cell.weight);
            for i in bits(asks) {
                let asked = self.asked[i];
                let powers = sites.powers(asked.place);
                // Most leaves have no site that is near enough.
                if least_of(&powers) >= asked.limit {
                    continue;
                }
                for (k, &power) in powers.iter().enumerate() {
                    let j = leaf * WIDTH as u32 + k as u32;
                    if power >= asked.limit || j == cell.site || (i > 0 && asked.touching.contains(&j)) {
                        continue;
                    }
                    let (d, more) = cell.difference(tree.site(j));
                    let square = super::square(less(asked.place, d));
                    let power = square - more;
                    let rounding = asked.rounding(square, more, d);
                    if power - asked.own > rounding {
                        continue;
                    }
                    if i > 0 {
                        left &= !(1 << i);
                        break;
                    }
                    if power - asked.own < -rounding {
                        if found.is_none() || power < self.asked[0].limit {
                            found = Some(j);
                            self.asked[0].limit = self.asked[0].limit.min(power);
                        }
                    } else if found.is_none() {
                        self.ties.push(j);
                    }
                }
            }
        }
        (found, left)
    }

    /// The same at a place that is exact.
    #[cfg(test)]
    pub(super) fn least_at<S: CellStore>(&mut self, tree: &SiteTree, cell: &Cell<'_, S>, place: V3) -> Option<u32> {
        self.asked.clear();
        self.asked.push(Asked::new(tree, cell.weight, place, 0.0, 0, [u32::MAX; 3]));
        self.descend(tree, cell).0
    }

    /// A bit for each of some places where no site has less power than the cell's, nor a tie, the first place not counted.
    #[cfg(test)]
    pub(super) fn stay_at<S: CellStore>(&mut self, tree: &SiteTree, cell: &Cell<'_, S>, places: &[V3]) -> u32 {
        self.asked.clear();
        self.asked.extend(places.iter().map(|&p| Asked::new(tree, cell.weight, p, 0.0, 0, [u32::MAX; 3])));
        self.descend(tree, cell).1
    }

    /// Puts the nodes of a block among those to be opened, the nearest last.
    fn open_block<S: CellStore>(&mut self, tree: &SiteTree, cell: &Cell<'_, S>, block: usize, asks: u32) {
        let seen = Seen::new(tree, cell.position, cell.weight, block);
        let (mut least, mut of) = ([Real::INFINITY; WIDTH], [0_u32; WIDTH]);
        for i in bits(asks) {
            let asked = &self.asked[i];
            let powers = seen.least_powers(asked.place);
            // With branches: few of them pass.
            for (k, &power) in powers.iter().enumerate() {
                if power < asked.limit {
                    of[k] |= 1 << i;
                    least[k] = smaller(power, least[k]);
                }
            }
        }
        let first = self.nodes.len();
        for k in 0..WIDTH {
            if of[k] != 0 {
                self.nodes.push(Node { power: least[k], block: block as u32, k: k as u32, asks: of[k] });
                let mut at = self.nodes.len() - 1;
                while at > first && self.nodes[at - 1].power < self.nodes[at].power {
                    self.nodes.swap(at - 1, at);
                    at -= 1;
                }
            }
        }
    }
}

impl Asked {
    fn new(tree: &SiteTree, weight: Real, place: V3, radius: Real, number: u32, touching: [u32; 3]) -> Self {
        let own = super::square(place);
        let length = own.sqrt();
        // With s the distance from the vertex, rounding is at most PER_LENGTH·radius·(length + s) + ROUNDINGS·(s² + own + …), and s² the power
        // and the largest weight.
        let share = SHARE + 4.0 * ROUNDINGS;
        let heaviest = Real::max(tree.largest_weight() - weight, 0.0);
        let lost = PER_LENGTH * radius;
        let limit = (own * (1.0 + 2.0 * ROUNDINGS) + lost * length + lost * lost / (4.0 * SHARE) + share * heaviest)
            * (1.0 + 2.0 * share);
        Self { number, touching, place, own, length, lost, limit }
    }

    /// What rounding may have moved the difference by of the cell's power and that of a site at `d`, `√square` from the vertex.
    fn rounding(&self, square: Real, more: Real, d: V3) -> Real {
        self.lost * (self.length + square.sqrt()) + ROUNDINGS * ((square + self.own) + (more.abs() + super::square(d)))
    }
}

fn less(a: V3, b: V3) -> V3 {
    V3 { x: a.x - b.x, y: a.y - b.y, z: a.z - b.z }
}

/// The numbers of the bits that are set.
fn bits(mut word: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (bit < 32).then_some(bit as usize)
    })
}

/// The sites of a leaf, and what they weigh more, seen from a site.
struct NearSites {
    at: [[Real; WIDTH]; 3],
    more: [Real; WIDTH],
}

impl NearSites {
    #[inline(always)]
    fn new(leaf: &Leaf, position: [f64; 3], weight: Real) -> Self {
        let at = std::array::from_fn(|axis| leaf.at[axis].map(|x| x - position[axis]));
        Self { at, more: leaf.weight.map(|w| w - weight) }
    }

    /// Their powers at `v`, relative to the site's weight: of one that is not there it is larger than any.
    #[inline(always)]
    fn powers(&self, v: V3) -> [Real; WIDTH] {
        let [xs, ys, zs] = &self.at;
        let mut powers = [0.0; WIDTH];
        for k in 0..WIDTH {
            let (x, y, z) = (v.x - xs[k], v.y - ys[k], v.z - zs[k]);
            powers[k] = (((x * x) + (y * y)) + (z * z)) - self.more[k];
        }
        powers
    }
}

/// Eight nodes, seen from a site.
struct Seen<'a> {
    weighted: Option<(&'a Boxes, &'a WeightBounds)>,
    slabs: &'a Slabs,
    position: [f64; 3],
    own: Real,
    /// The boxes from the site, and its height above the slabs' faces.
    lo: [[Real; WIDTH]; 3],
    hi: [[Real; WIDTH]; 3],
    above: [Real; WIDTH],
    below: [Real; WIDTH],
}

impl<'a> Seen<'a> {
    #[inline(always)]
    fn new(tree: &'a SiteTree, position: [f64; 3], weight: Real, block: usize) -> Self {
        let (boxes, slabs) = (tree.boxes(block), tree.slabs(block));
        let (mut lo, mut hi) = ([[0.0; WIDTH]; 3], [[0.0; WIDTH]; 3]);
        let mut height = [0.0; WIDTH];
        for axis in 0..3 {
            for k in 0..WIDTH {
                lo[axis][k] = boxes.lo[axis][k] - position[axis];
                hi[axis][k] = boxes.hi[axis][k] - position[axis];
                height[k] += slabs.normal[axis][k] * position[axis];
            }
        }
        let (mut above, mut below) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            above[k] = height[k] - slabs.hi[k];
            below[k] = slabs.lo[k] - height[k];
        }
        let weighted = tree.has_weights().then(|| (boxes, tree.weights(block)));
        Self { weighted, slabs, position, own: weight - tree.base_weight(), lo, hi, above, below }
    }

    /// A lower bound of the power, relative to the site's weight, that the sites of each node have at `v` from it.
    #[inline(always)]
    fn least_powers(&self, v: V3) -> [Real; WIDTH] {
        let way = [v.x, v.y, v.z];
        let mut height = [0.0; WIDTH];
        for axis in 0..3 {
            for k in 0..WIDTH {
                height[k] += self.slabs.normal[axis][k] * way[axis];
            }
        }
        // Of the absolute heights, which the slabs' faces are given by.
        let size: Real = (0..3).map(|axis| self.position[axis].abs() + way[axis].abs()).sum();
        let rounding = ROUNDINGS * size;
        let (mut over, mut under) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            over[k] = larger((self.above[k] + height[k]) - rounding, 0.0);
            under[k] = larger((self.below[k] - height[k]) - rounding, 0.0);
        }
        let mut powers = [0.0; WIDTH];
        if let Some((boxes, bounds)) = self.weighted {
            powers = least_weighted_powers(boxes, bounds, self.position, self.own, way);
            for k in 0..WIDTH {
                let gap = over[k] + under[k];
                let largest = self.slabs.largest_weight[k];
                let slab = (gap * gap) * (1.0 - ROUNDINGS) - (largest - self.own);
                powers[k] = larger(powers[k], slab - ROUNDINGS * (largest.abs() + self.own));
            }
            return powers;
        }
        // With `g` at most the gap between the place and the slab, across `n`: `|v − p|² ≥ g² + |(v − gn) − p|²`.
        let mut across = [0.0; WIDTH];
        for k in 0..WIDTH {
            across[k] = over[k] - under[k];
            powers[k] = (across[k] * across[k]) * (1.0 - ROUNDINGS);
        }
        for axis in 0..3 {
            for k in 0..WIDTH {
                let at = way[axis] - across[k] * self.slabs.normal[axis][k];
                let gap = larger(larger(self.lo[axis][k] - at, at - self.hi[axis][k]), 0.0);
                powers[k] += gap * gap;
            }
        }
        powers
    }
}

/// The same from the boxes and the bounds of the weights, `own` being the site's weight less the base.
#[inline]
fn least_weighted_powers(
    boxes: &Boxes,
    bounds: &WeightBounds,
    position: [f64; 3],
    own: Real,
    way: [Real; 3],
) -> [Real; WIDTH] {
    let (mut powers, mut sizes) = ([0.0; WIDTH], [0.0; WIDTH]);
    for axis in 0..3 {
        for k in 0..WIDTH {
            let (lo, hi) = (boxes.lo[axis][k], boxes.hi[axis][k]);
            let (g, q) = (bounds.g[axis][k], bounds.q[axis][k]);
            let m = 0.5 * (lo + hi);
            let u = (position[axis] - m) + way[axis];
            let (from, to) = (lo - m, hi - m);
            // The least of (u − s)² − (g + qs)s.
            let value = |s: Real| (u - s) * (u - s) - (g + q * s) * s;
            let inner = smaller(larger((u + 0.5 * g) / (1.0 - q), from), to);
            let inner = if q < 1.0 { value(inner) } else { Real::INFINITY };
            powers[k] += smaller(smaller(value(from), value(to)), inner);
            let size = (u.abs() + to) + way[axis].abs();
            sizes[k] += size * size;
        }
    }
    for k in 0..WIDTH {
        let size = sizes[k] + (bounds.c[k].abs() + own.abs());
        powers[k] = ((powers[k] - bounds.c[k]) + own) - ROUNDINGS * size;
    }
    powers
}
