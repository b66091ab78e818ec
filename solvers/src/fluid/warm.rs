//! Weights to start the next transport from: no cell may be empty.
//!
//! Where two particles pass close by each other, their bisector turns quickly, and weights of a moment ago put it beyond one of the two
//! cells. One empty cell makes transport start from nothing, at several times the cost.

use laguerre_core::Laplacian;

use crate::vectors::{distance2, map};

/// How deep the place where a barycenter is expected has to be in its cell, in cell sizes.
const DEPTH: f64 = 0.1;

/// Changes `weights` for sites at `positions` as little as it takes for `expected`, where the cells' barycenters are expected, to be in their cells: for
/// each pair of neighbours of the last diagram the bisector is moved between the two, or to their middle where they are in the wrong
/// order. `size` is a cell's.
pub(super) fn mend(
    weights: &mut [f64],
    positions: &[[f64; 3]],
    expected: &[[f64; 3]],
    neighbors: &Laplacian,
    size: f64,
) {
    let found = &*weights;
    let depth = |i: usize, j: usize, distance: f64| {
        let power = |k: usize| distance2(expected[i], positions[k]) - found[k];
        (power(j) - power(i)) / (2.0 * distance)
    };
    let order = neighbors.order();
    let changes = map(order.len(), |row| {
        let i = order[row] as usize;
        let change = |&column: &u32| {
            let j = order[column as usize] as usize;
            let distance = distance2(positions[i], positions[j]).sqrt();
            let [mine, theirs] = [depth(i, j, distance), depth(j, i, distance)];
            // Both have it where there is room for both, else half of what there is.
            let wanted = (DEPTH * size).min((mine + theirs) / 2.0);
            // Each side gives half; a facet stands once in the rows of both, each of which finds what changes for its own.
            distance * ((wanted - mine).max(0.0) - (wanted - theirs).max(0.0))
        };
        neighbors.columns()[neighbors.row(row)].iter().map(change).sum::<f64>()
    });
    order.iter().zip(changes).for_each(|(&i, change)| weights[i as usize] += change);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bisector_is_put_between_the_barycenters() {
        let neighbors = Laplacian::of_fitting(vec![0, 1], (vec![0, 1, 2], vec![1, 0], vec![100.0; 2]));
        let positions = [[0.0; 3], [0.01, 0.0, 0.0]];
        // Where along x the bisector is.
        let at = |w: &[f64]| (w[0] - w[1] + 0.01 * 0.01) / (2.0 * 0.01);
        let mended = |first: f64, second: f64, weight: f64| {
            let mut weights = [weight, 0.0];
            mend(&mut weights, &positions, &[[first, 0.0, 0.0], [second, 0.0, 0.0]], &neighbors, 1.0);
            at(&weights)
        };
        // Deep enough on both sides: as it was. Too near to one: as far as it must be. No room: between.
        assert_eq!(mended(-0.5, 0.5, 0.002), at(&[0.002, 0.0]));
        assert!((mended(-0.5, 0.5, 0.02) - 0.4).abs() < 1e-12);
        assert!((mended(-0.5, 0.5, -0.02) + 0.4).abs() < 1e-12);
        assert!((mended(-0.05, 0.03, 0.02) + 0.01).abs() < 1e-12);
        assert!((mended(0.3, -0.1, 0.02) - 0.1).abs() < 1e-12);
    }
}
