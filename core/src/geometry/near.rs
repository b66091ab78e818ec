//! Points that are as near to each other as rounding.

use crate::cell::{Real, V3};
use foldhash::fast::FixedState;
use std::collections::HashMap;

/// Width of a grid's cell over what counts as near: seldom is a point near two, and few points that are not near share one.
const WIDTH: Real = 64.0;

/// Calls `join` for pairs of numbered points whose coordinates are all within `near`: not for all pairs, but whoever is near to another is joined to
/// it by way of such pairs.
pub(super) fn join_near(points: impl Iterator<Item = (u32, V3)>, near: Real, mut join: impl FnMut(u32, u32)) {
    let mut grid: HashMap<[i64; 3], Vec<(u32, V3)>, FixedState> = HashMap::default();
    let cell = |x: Real| (x / (WIDTH * near)).floor() as i64;
    for (number, point) in points {
        let range = |x: Real| cell(x - near)..=cell(x + near);
        let mut is_there = false;
        for (i, j) in range(point.x).flat_map(|i| range(point.y).map(move |j| (i, j))) {
            for k in range(point.z) {
                for &(other, place) in grid.get(&[i, j, k]).into_iter().flatten() {
                    let [x, y, z] = [point.x - place.x, point.y - place.y, point.z - place.z];
                    if x.abs() <= near && y.abs() <= near && z.abs() <= near {
                        is_there |= place == point;
                        join(other, number);
                    }
                }
            }
        }
        // One of those in the same place does for all.
        if !is_there {
            grid.entry([point.x, point.y, point.z].map(cell)).or_default().push((number, point));
        }
    }
}

/// The number that stands for `i` where each that was joined names a lesser one.
pub(super) fn root(same: &[u32], mut i: u32) -> u32 {
    while same[i as usize] != i {
        i = same[i as usize];
    }
    i
}

/// Lets the greater of two roots name the lesser.
pub(super) fn unite(same: &mut [u32], a: u32, b: u32) {
    let [a, b] = [root(same, a), root(same, b)];
    same[a.max(b) as usize] = a.min(b);
}
