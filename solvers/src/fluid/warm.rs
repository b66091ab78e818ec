//! Weights to start the next transport from: no cell may be empty.
//!
//! Where two particles pass close by each other, their bisector turns quickly, and weights of a moment ago put it beyond one of the two
//! cells. One empty cell makes transport start from nothing, at several times the cost.

use laguerre_core::algebra::CELL;
use laguerre_core::{Backend, PowerDiagram, Result};

use super::neighbors::Neighbors;
use crate::vectors::{copied, map};

/// How deep the place where a barycenter is expected has to be in its cell, in cell sizes.
const DEPTH: f64 = 0.1;

/// Particles that have moved.
pub(super) struct Moved<'a> {
    pub(super) positions: &'a [[f64; 3]],
    /// Where the cells' barycenters are expected.
    pub(super) expected: &'a [[f64; 3]],
    /// A cell's.
    pub(super) size: f64,
}

impl Moved<'_> {
    /// Weights that differ from these as little as it takes for the barycenters to be in their cells: for each pair of neighbours of the last diagram the
    /// bisector is moved between the two, or to their middle where they are in the wrong order.
    ///
    /// # Errors
    /// As [`Neighbors::with`].
    pub(super) fn mended(
        &self,
        weights: &[f64],
        backend: &dyn Backend,
        diagram: &PowerDiagram,
        neighbors: &mut Neighbors,
    ) -> Result<Vec<f64>> {
        neighbors.with(backend, diagram, |algebra, matrix, order| {
            let cells: Vec<[f64; CELL]> = map(order.len(), |row| {
                let i = order[row] as usize;
                let ([x, y, z], [a, b, c]) = (self.positions[i], self.expected[i]);
                [x, y, z, weights[i], a, b, c, self.size]
            });
            let cells = algebra.vector(cells.as_flattened())?;
            let changes = algebra.read(&algebra.parted(matrix, &cells, DEPTH * self.size)?)?;
            let mut weights = copied(weights);
            order.iter().zip(changes).for_each(|(&i, change)| weights[i as usize] += change);
            Ok(weights)
        })
    }
}

#[cfg(test)]
mod tests {
    use laguerre_core::Laplacian;
    use laguerre_cpu::Cpu;

    use super::*;

    #[test]
    fn a_bisector_is_put_between_the_barycenters() {
        let laplacian = Laplacian::of_fitting(vec![0, 1], (vec![0, 1, 2], vec![1, 0], vec![100.0; 2]));
        let (mut neighbors, backend) = (Neighbors::of_host(&laplacian).unwrap(), Cpu::new(Some(1)).unwrap());
        let positions = [[0.0; 3], [0.01, 0.0, 0.0]];
        // Where along x the bisector is.
        let at = |w: &[f64]| (w[0] - w[1] + 0.01 * 0.01) / (2.0 * 0.01);
        let diagram = PowerDiagram::new(&positions, &[]).unwrap();
        let mut mended = |first: f64, second: f64, weight: f64| {
            let moved = Moved { positions: &positions, expected: &[[first, 0.0, 0.0], [second, 0.0, 0.0]], size: 1.0 };
            at(&moved.mended(&[weight, 0.0], &backend, &diagram, &mut neighbors).unwrap())
        };
        // Deep enough on both sides: as it was. Too near to one: as far as it must be. No room: between.
        assert_eq!(mended(-0.5, 0.5, 0.002), at(&[0.002, 0.0]));
        assert!((mended(-0.5, 0.5, 0.02) - 0.4).abs() < 1e-12);
        assert!((mended(-0.5, 0.5, -0.02) + 0.4).abs() < 1e-12);
        assert!((mended(-0.05, 0.03, 0.02) + 0.01).abs() < 1e-12);
        assert!((mended(0.3, -0.1, 0.02) - 0.1).abs() < 1e-12);
    }
}
