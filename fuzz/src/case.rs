//! Structured cases: sites, weights and a room, held to every law.

use laguerre_conformance::domains::{Pose, Shape};
use laguerre_conformance::{Given, Verdict};
use laguerre_core::diagram::bounding_box;
use laguerre_core::{Backend, Request};

/// A structured case.
#[derive(Clone, Debug, PartialEq)]
pub struct Structured {
    /// As [`Given::room`].
    pub room: Option<(Shape, Pose)>,
    /// Sites (length).
    pub positions: Vec<[f64; 3]>,
    /// Weights (length²), or none.
    pub weights: Vec<f64>,
    /// What else is looked at.
    pub also: Also,
}

/// What is looked at besides the laws of an output with facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Also {
    /// Nothing.
    Nothing,
    /// Second moments.
    SecondMoments,
    /// The laws of an output without facets.
    NoFacets,
    /// The naive oracle's answer, where there are few sites.
    Oracle,
}

impl Structured {
    /// The case of these sites in `shape`. Without one the sites must have a box, not too small for the weights, nor beyond the least numbers in
    /// any direction: else it is the unit box.
    pub fn new(shape: Option<Shape>, pose: Pose, positions: Vec<[f64; 3]>, weights: Vec<f64>, also: Also) -> Self {
        let (lo, hi) = bounding_box(&positions);
        let [x, y, z] = std::array::from_fn(|k| hi[k] - lo[k]);
        let is_box = x.max(y).max(z) > 0.1 && x.min(y).min(z) > 1e-30;
        let shape = if shape.is_none() && !is_box { Some(Shape::Box) } else { shape };
        Self { room: shape.map(|shape| (shape, pose)), positions, weights, also }
    }

    /// The case as it would stand among the regressions.
    pub fn given(&self) -> Given<'_> {
        Given { room: self.room, positions: &self.positions, weights: &self.weights }
    }

    /// Evaluates it and holds the output to every law, and to what [`Also`] asks for.
    ///
    /// # Errors
    /// The law that is broken, or the library's error: a case is valid input.
    pub fn holds(&self, backend: &dyn Backend) -> Verdict {
        /// Sites up to which the oracle, of quadratic cost, is cheap.
        const FEW: usize = 12;
        let (given, moments) = (self.given(), Request::moments());
        match self.also {
            Also::NoFacets => given.sane(backend, &moments),
            Also::SecondMoments => given.sane(backend, &moments.with_facets().with_second_moments()),
            Also::Oracle if self.positions.len() <= FEW => given.like_the_oracle(backend),
            Also::Oracle | Also::Nothing => given.sane(backend, &moments.with_facets()),
        }
    }

    /// The smallest case found from this one for which `fails` still says so: with fewer sites, first many at a time, and without weights.
    #[must_use]
    pub fn shrunk(self, fails: impl Fn(&Self) -> bool) -> Self {
        let mut best = self;
        let mut size = best.positions.len().div_ceil(2);
        while size > 0 {
            let (before, mut end) = (best.positions.len(), best.positions.len());
            while end > 0 {
                let gone = end.saturating_sub(size)..end;
                end = gone.start;
                if gone.len() == best.positions.len() {
                    continue;
                }
                let mut fewer = best.clone();
                fewer.positions.drain(gone.clone());
                if !fewer.weights.is_empty() {
                    fewer.weights.drain(gone);
                }
                if fails(&fewer) {
                    best = fewer;
                }
            }
            // One at a time until none can go.
            if size > 1 || best.positions.len() == before {
                size /= 2;
            }
        }
        let unweighted = Self { weights: Vec::new(), ..best.clone() };
        if fails(&unweighted) { unweighted } else { best }
    }
}
