//! Looks at the eight nodes of a block, or the eight sites of leaves, by the widest instructions that the CPU has.

use super::{Entry, Searched};
use crate::cell::bound::{Seer, least_power_of_node};
use crate::cell::quadratic::FEW_ROUNDINGS_OF_SUM;
use crate::cell::search_store::{Asked, NodeWeights, SearchStore as _};
use crate::cell::{CellStore, Real, V3, dot, norm_1, norm_max, v3};
use crate::search::{Reaches, in_order, smaller};
use crate::site_tree::{Leaf, WIDTH};
use pulp::NullaryFnOnce;

/// A look at the eight nodes of a block, or sites of a leaf, by the widest instructions that the CPU has; all give the same bits, as no sum or product
/// is contracted. (With 32-byte vectors instead of 16 sites on a bumpy surface take 14 % less time, with 64 another 7.)
pub(super) struct Look<'s, 'c, 'a, S, const OF_LEAF: bool> {
    pub(super) search: &'s mut Searched<'c, 'a, S>,
    pub(super) number: usize,
    pub(super) asks: u32,
}

impl<S: CellStore, const OF_LEAF: bool> NullaryFnOnce for Look<'_, '_, '_, S, OF_LEAF> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        match OF_LEAF {
            true => self.search.look_at_leaf(self.number, self.asks),
            false => self.search.look_at_block(self.number, self.asks),
        }
    }
}

/// Takes those of some leaves to hand where a site may have less power at the asked vertex.
pub(super) struct Take<'s, 'c, 'a, S> {
    pub(super) search: &'s mut Searched<'c, 'a, S>,
    pub(super) leaves: &'c [u32],
    pub(super) asks: u32,
}

impl<S: CellStore> NullaryFnOnce for Take<'_, '_, '_, S> {
    type Output = u32;

    #[inline(always)]
    fn call(self) -> u32 {
        let Self { search, leaves, asks } = self;
        let Asked { place, limit, .. } = search.room.asked[0];
        let mut count = 0;
        for &number in leaves {
            let powers = search.powers_of_leaf(place, number);
            search.room.leaves[count] = Entry { number, key: 0, asks };
            // Without a branch.
            count += usize::from(powers.iter().any(|&power| power < limit));
        }
        count as u32
    }
}

/// Finds how far the bisectors of the sites of the listed leaves are: beyond all of those that cannot cut the cell, unless that is still the container.
pub(super) struct Measure<'s, 'c, 'a, S> {
    pub(super) search: &'s mut Searched<'c, 'a, S>,
    pub(super) is_container: bool,
}

impl<S: CellStore> NullaryFnOnce for Measure<'_, '_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { search, is_container } = self;
        search.room.reaches.clear();
        for i in 0..search.room.listed.len() {
            let number = search.room.listed[i];
            let Searched { cell, tree, .. } = &*search;
            let mut reaches = Reaches::new(tree.leaf(number), cell.position, cell.weight, cell.slope);
            if !is_container {
                let may = search.may_cut(number);
                for k in 0..WIDTH {
                    reaches.of[k] = if may[k] { reaches.of[k] } else { Real::INFINITY };
                }
            }
            search.room.reaches.push(reaches);
        }
    }
}

impl<S: CellStore> Searched<'_, '_, S> {
    /// Which sites of a leaf may have less power than the cell's at one of its vertices.
    #[inline(always)]
    fn may_cut(&self, number: u32) -> [bool; WIDTH] {
        let (Leaf { at: [xs, ys, zs], weight }, [px, py, pz]) = (self.tree.leaf(number), self.cell.position);
        let mut others = [Other::default(); WIDTH];
        // (Loops here and in `powers_of_leaf`: what `array::from_fn` calls is inlined or not, and if not, does without wide instructions: 4 % of a bumpy surface, and of clusters with weights of transport.)
        for k in 0..WIDTH {
            others[k] = other_at(v3(xs[k] - px, ys[k] - py, zs[k] - pz), weight[k] - self.cell.weight);
        }
        let store = &*self.cell.store;
        let mut may = [false; WIDTH];
        for v in 0..store.vertices() {
            let (place, radius) = (store.position(v), store.radius(v));
            for k in 0..WIDTH {
                may[k] |= may_have_less(others[k], place, radius);
            }
        }
        may
    }

    /// The least powers at `place` of the sites of the eight nodes of a block. (Each loop becomes one over vectors.)
    #[inline(always)]
    fn least_powers(&self, place: V3, block: usize) -> [Real; WIDTH] {
        let mut powers = [0.0; WIDTH];
        let site = self.own();
        if self.tree.has_weights() {
            let seer = Seer { site, excess: self.own_excess(), has_weights: true };
            for (k, power) in powers.iter_mut().enumerate() {
                let (bounds, slab) = (self.boxed(block, k), self.slab(block, k));
                *power = least_power_of_node(seer, place, bounds, slab, self.weights(block, k));
            }
        } else {
            let seer = Seer { site, excess: 0.0, has_weights: false };
            for (k, power) in powers.iter_mut().enumerate() {
                let (bounds, slab) = (self.boxed(block, k), self.slab(block, k));
                *power = least_power_of_node(seer, place, bounds, slab, NodeWeights::default());
            }
        }
        powers
    }

    /// Finds what `asks_by_powers` says of the eight nodes of a block.
    #[inline(always)]
    fn look_at_block(&mut self, block: usize, asks: u32) {
        self.room.opened += 1;
        let (mut of, mut least) = ([0; WIDTH], [Real::INFINITY; WIDTH]);
        for i in bits(asks) {
            let Asked { place, limit, .. } = self.room.asked[i];
            let powers = self.least_powers(place, block);
            for k in 0..WIDTH {
                let is_below = powers[k] < limit;
                of[k] |= u32::from(is_below) << i;
                least[k] = smaller(if is_below { powers[k] } else { Real::INFINITY }, least[k]);
            }
        }
        (self.room.asks, self.room.keys) = (of, least.map(in_order));
    }

    /// Finds at which of some asked vertices the eight sites of a leaf have a power below the limit.
    #[inline(always)]
    fn look_at_leaf(&mut self, leaf: usize, asks: u32) {
        let mut of = [0; WIDTH];
        for i in bits(asks) {
            let Asked { place, limit, .. } = self.room.asked[i];
            let powers = self.powers_of_leaf(place, leaf as u32);
            for k in 0..WIDTH {
                of[k] |= u32::from(powers[k] < limit) << i;
            }
        }
        self.room.asks = of;
    }

    /// The powers at `place` of the sites of a leaf, as if the cell's site weighed nothing.
    #[inline(always)]
    fn powers_of_leaf(&self, place: V3, leaf: u32) -> [Real; WIDTH] {
        let leaf = self.tree.leaf(leaf);
        let ([xs, ys, zs], [px, py, pz]) = (&leaf.at, self.cell.position);
        let mut powers = [0.0; WIDTH];
        for k in 0..WIDTH {
            let (x, y, z) = (place.x - (xs[k] - px), place.y - (ys[k] - py), place.z - (zs[k] - pz));
            powers[k] = (((x * x) + (y * y)) + (z * z)) - (leaf.weight[k] - self.cell.weight);
        }
        powers
    }
}

/// Another site, as the cell's sees it.
#[derive(Clone, Copy, Default)]
struct Other {
    /// The way to it.
    way: V3,
    /// How much more power it has at the cell's site.
    more: Real,
    /// Room for roundings of that.
    room: Real,
    /// Twice the length of the way, at least.
    length: Real,
}

/// A site at the way `d` that weighs `excess` more.
#[inline(always)]
fn other_at(d: V3, excess: Real) -> Other {
    let square: Real = dot(d, d);
    Other {
        way: d,
        more: square - excess,
        room: FEW_ROUNDINGS_OF_SUM * (square + excess.abs()),
        length: 2.0 * norm_1(d),
    }
}

/// Whether it may have less power than the cell's site at a place, which is off by up to `radius` along each axis.
#[inline(always)]
fn may_have_less(other: Other, place: V3, radius: Real) -> bool {
    let off: Real = radius + (FEW_ROUNDINGS_OF_SUM * norm_max(place));
    (other.more - (2.0 * dot(other.way, place))) <= ((other.length * off) + other.room)
}

/// The numbers of the bits that are set.
#[inline(always)]
fn bits(mut word: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (bit < 32).then_some(bit as usize)
    })
}
