//! How the lanes talk that compute a cell together. Like `store.rs` the boundary of the dialect.

use super::vector::{Real, V3};

/// Lanes that compute a cell together: each calls the same functions at the same time; what a method gives is alike in all lanes unless it says
/// otherwise. As it stands there is one lane.
pub trait Lanes {
    /// Number of lanes: 1, or a multiple of [`WIDTH`](super::search_store::WIDTH).
    fn lanes(&self) -> u32 {
        1
    }
    /// The number of this lane: not alike.
    fn lane(&self) -> u32 {
        0
    }
    /// The lanes for which something is so, a bit each.
    fn lanes_with(&self, is_so: bool) -> u32 {
        u32::from(is_so)
    }
    /// How many lanes are among `lanes`.
    fn count_of(&self, lanes: u32) -> u32 {
        lanes
    }
    /// How many of `lanes` are before this one: not alike.
    fn rank_in(&self, _lanes: u32) -> u32 {
        0
    }
    /// The first of `lanes`, of which there is one at least.
    fn first_of(&self, _lanes: u32) -> u32 {
        0
    }
    /// The least of the lanes' numbers.
    fn least_of_lanes(&self, x: u32) -> u32 {
        x
    }
    /// A lane whose key is the least of all.
    fn lane_of_key(&self, own: u32, least: u32) -> u32 {
        self.first_of(self.lanes_with(own == least))
    }
    /// What lane `from` has.
    fn lane_value(&self, x: u32, _from: u32) -> u32 {
        x
    }
    /// The same for a number.
    fn lane_real(&self, x: Real, _from: u32) -> Real {
        x
    }
    /// Lanes see from here on what the others wrote.
    fn lanes_wait(&self) {}
    /// The largest of the lanes' numbers.
    fn most_of_lanes(&self, x: Real) -> Real {
        x
    }
    /// The same for each coordinate.
    fn most_along_axes(&self, x: V3) -> V3 {
        x
    }
}
