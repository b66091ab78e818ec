//! Nearest sites where they are crowded: a k-d tree over the sites lifted to four dimensions.
//!
//! Site `j` is lifted to height `√(W − w_j)`, `W` the largest weight of all; then the squared distance to a point at height 0 is its
//! power distance plus `W`, so that one tree serves Voronoi and power diagrams alike.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use laguerre_core::search::Nearest;
use std::num::NonZero;

/// First neighbours fetched for a site in a crowded block: about what a Voronoi cell of random sites visits.
const NEAREST: NonZero<usize> = NonZero::new(48).unwrap();

/// The tree.
pub(crate) struct Clusters {
    tree: ImmutableKdTree<f64, 4>,
}

impl Clusters {
    /// Over all sorted sites.
    pub(crate) fn new(sites: &[[f64; 4]]) -> Option<Self> {
        let largest = sites.iter().fold(f64::NEG_INFINITY, |w, s| w.max(s[3]));
        let lifted: Vec<[f64; 4]> = sites.iter().map(|&[x, y, z, w]| [x, y, z, (largest - w).sqrt()]).collect();
        ImmutableKdTree::new_from_slice(&lifted).ok().map(|tree| Self { tree })
    }
}

impl Nearest for Clusters {
    fn nearest(&self, point: [f64; 3], indices: &mut Vec<u32>) {
        let [x, y, z] = point;
        indices.clear();
        let found = self.tree.query(&[x, y, z, 0.0]).nearest_n::<SquaredEuclidean<f64>>(NEAREST).execute();
        indices.extend(found.iter().map(|item| item.item));
    }
}
