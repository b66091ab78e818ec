//! A case: a seed and a few words from which sites, weights and container are made.

use std::fmt;

use proptest::prelude::*;
use proptest::sample::select;

use crate::domains::{Pose, Shape};
use crate::sites::{Random, Sites};
use crate::weights::Weights;
use crate::{Scene, domains, sites, weights};

/// A small description of an input, from which [`Case::scene`] makes always the same one.
#[derive(Clone, Copy, PartialEq)]
pub struct Case {
    /// Seed of everything random in it.
    pub seed: u64,
    /// Number of sites.
    pub count: u32,
    /// How the sites stand.
    pub sites: Sites,
    /// How they are weighted.
    pub weights: Weights,
    /// What they are restricted to.
    pub shape: Shape,
    /// How that is turned.
    pub pose: Pose,
}

impl Case {
    /// The input that this case describes.
    pub fn scene(&self) -> Scene {
        let room = domains::room(self.shape, self.pose);
        let mut random = Random::new(self.seed);
        let positions = sites::place(self.sites, self.count as usize, &room, &mut random);
        let weights = weights::weigh(self.weights, &positions, &room, &mut random);
        Scene { positions, weights, room }
    }

    /// The same case in another container.
    #[must_use]
    pub fn within(self, shape: Shape) -> Self {
        Self { shape, ..self }
    }

    /// The same case with its container along the axes.
    #[must_use]
    pub fn plain(self) -> Self {
        Self { pose: Pose::Plain, ..self }
    }

    /// A random stream of its own for `purpose`, for choices that the scene does not depend on.
    pub fn random(&self, purpose: u64) -> Random {
        Random::new(self.seed.wrapping_mul(0x9e37_79b9).wrapping_add(purpose))
    }
}

impl fmt::Debug for Case {
    /// As Rust, so that a failing case can be pasted.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seed, count, sites, weights, shape, pose } = self;
        write!(f, "Case {{ seed: {seed}, count: {count}, sites: Sites::{sites:?}, weights: Weights::{weights:?}, ")?;
        write!(f, "shape: Shape::{shape:?}, pose: Pose::{pose:?} }}")
    }
}

/// Every combination; shrinks to few sites and to the words that stand first in their lists.
pub fn any() -> impl Strategy<Value = Case> {
    let count = prop_oneof![1 => 1_u32..4, 3 => 4_u32..16, 4 => 16_u32..=60];
    let words = (select(&Sites::ALL[..]), select(&Weights::ALL[..]), select(&Shape::ALL[..]), select(&Pose::ALL[..]));
    (0..1_000_000_u64, count, words).prop_map(|(seed, count, (sites, weights, shape, pose))| Case {
        seed,
        count,
        sites,
        weights,
        shape,
        pose,
    })
}
