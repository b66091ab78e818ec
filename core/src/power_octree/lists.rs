//! The host goes over the leaves that the boxes of an octree list.

use super::OctreeBox;
use crate::cell::octree::{
    FEW_LISTED, OCTREE_PLACES, SeenSite, half_of, middle_of, more_power, octree_place, power_at, seen_from,
};
use crate::cell::{V3, v3};
use crate::parallel;
use crate::site_tree::{Leaf, SiteTree, WIDTH};
use pulp::{Arch, NullaryFnOnce};

/// The lists of the boxes that are split, one after the other, and of those that are not.
pub(super) struct OnHost<'a> {
    tree: &'a SiteTree,
    margin: f64,
    whole: Vec<u32>,
    parts: Vec<Vec<u32>>,
    pub(super) listed: Vec<u32>,
}

/// Where the leaves of a part go.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// Behind those of the boxes that are split next.
    Whole,
    /// Behind those that boxes list in the end.
    Listed,
    /// They are too many.
    Nowhere,
}

impl<'a> OnHost<'a> {
    pub(super) fn new(tree: &'a SiteTree, margin: f64) -> Self {
        let whole = (0..tree.len().div_ceil(WIDTH) as u32).collect();
        Self { tree, margin, whole, parts: Vec::new(), listed: Vec::new() }
    }

    /// How many leaves each part of some boxes keeps, eight parts of each box: those with a site that may have the least power there.
    pub(super) fn split(&mut self, front: &[OctreeBox]) -> Vec<u32> {
        let part = |i: usize| {
            let whole = &front[i / WIDTH];
            let [lo, hi] = whole.part(i % WIDTH);
            let leaves = &self.whole[whole.begin as usize..][..whole.count as usize];
            let job = Job { tree: self.tree, middle: middle_of(lo, hi), half: half_of(lo, hi, self.margin), leaves };
            Arch::new().dispatch(job)
        };
        self.parts = parallel::results(WIDTH * front.len(), part);
        self.parts.iter().map(|leaves| leaves.len() as u32).collect()
    }

    /// Puts the leaves that each part keeps in its place.
    pub(super) fn place(&mut self, places: &[Place]) {
        self.whole.clear();
        for (leaves, place) in std::mem::take(&mut self.parts).into_iter().zip(places) {
            match place {
                Place::Whole => self.whole.extend(leaves),
                Place::Listed => self.listed.extend(leaves),
                Place::Nowhere => {}
            }
        }
    }
}

/// Finds those of some leaves with a site that may have the least power somewhere in a box, by the widest instructions that the CPU has.
struct Job<'a> {
    tree: &'a SiteTree,
    middle: V3,
    half: V3,
    leaves: &'a [u32],
}

impl NullaryFnOnce for Job<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn call(self) -> Vec<u32> {
        let Self { tree, middle, half, leaves } = self;
        let kept = undominated(tree, middle, half, leaves, least_at(tree, [middle], leaves));
        if kept.len() <= FEW_LISTED as usize {
            return kept;
        }
        let faces: [V3; OCTREE_PLACES as usize - 1] = std::array::from_fn(|i| octree_place(middle, half, i as u32 + 1));
        undominated(tree, middle, half, &kept, least_at(tree, faces, &kept))
    }
}

/// The powers of the sites of a leaf at a place.
#[inline(always)]
pub(super) fn powers_at(leaf: &Leaf, place: V3) -> [f64; WIDTH] {
    let Leaf { at: [xs, ys, zs], weight } = leaf;
    let mut powers = [0.0; WIDTH];
    // (A loop, as in `search/store/look.rs`.)
    for k in 0..WIDTH {
        powers[k] = power_at(v3(xs[k], ys[k], zs[k]), weight[k], place);
    }
    powers
}

/// The sites of least power at some places, of equals one; 0 where there are none.
#[inline(always)]
pub(super) fn least_at<const N: usize>(tree: &SiteTree, places: [V3; N], leaves: &[u32]) -> [u32; N] {
    let mut least = [[f64::INFINITY; WIDTH]; N];
    let mut of = [[0_u32; WIDTH]; N];
    for &leaf in leaves {
        for (place, &at) in places.iter().enumerate() {
            let powers = powers_at(tree.leaf(leaf), at);
            for k in 0..WIDTH {
                let is_less = powers[k] < least[place][k];
                least[place][k] = if is_less { powers[k] } else { least[place][k] };
                of[place][k] = if is_less { leaf } else { of[place][k] };
            }
        }
    }
    std::array::from_fn(|place| {
        let best = (1..WIDTH).fold(0, |best, k| if least[place][k] < least[place][best] { k } else { best });
        of[place][best] * WIDTH as u32 + best as u32
    })
}

/// Those leaves with a site that has certainly more power than none of some `others`, everywhere in the box `middle ± half`.
#[inline(always)]
fn undominated<const N: usize>(tree: &SiteTree, middle: V3, half: V3, leaves: &[u32], others: [u32; N]) -> Vec<u32> {
    let base = tree.base_weight();
    let others = others.map(|other| {
        let [x, y, z, weight] = tree.site(other);
        seen_from(v3(x, y, z), weight - base, middle)
    });
    let mut kept = Vec::with_capacity(leaves.len());
    for &leaf in leaves {
        let Leaf { at: [xs, ys, zs], weight } = tree.leaf(leaf);
        let (mut squares, mut excesses) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            let seen = seen_from(v3(xs[k], ys[k], zs[k]), weight[k] - base, middle);
            (squares[k], excesses[k]) = (seen.square, seen.excess);
        }
        // By how much each has more power than one of the others at least.
        let mut most = [f64::NEG_INFINITY; WIDTH];
        for other in others {
            for k in 0..WIDTH {
                let site = SeenSite { place: v3(xs[k], ys[k], zs[k]), excess: excesses[k], square: squares[k] };
                let more = more_power(site, other, half);
                most[k] = if more > most[k] { more } else { most[k] };
            }
        }
        if most.iter().any(|&more| more <= 0.0) {
            kept.push(leaf);
        }
    }
    kept
}
