//! The direct solver of the coarsest level.

use laguerre_core::parallel;

use super::sparse::Matrix;

/// A Cholesky factor `L Lᵀ` of a small matrix of transport, whose rows sum to zero, or of a coarse level of one.
///
/// Of a Laplacian (no entry off the diagonal is above zero) what is left after some pivots is one again: there, a pivot is the sum of its column's others,
/// not the difference of two numbers (Grassmann, Taksar, Heyman 1985). All sums are of one sign, and right to the last digits however stiff some
/// facets are: of 150 sites, pairs at a distance of 1e-14 of the box took those for the kernel, and the conjugate gradient went nowhere. Coarse
/// levels have entries of both signs, made from far larger ones: their sums are not zero, and that way was worse for fives of sites.
///
/// A pivot that is zero but for rounding belongs to the kernel: its unknown is zero.
pub(super) struct Dense {
    size: usize,
    /// Lower triangle by rows; a diagonal of 0 stands for a pivot of the kernel.
    factor: Vec<f64>,
}

impl Dense {
    pub(super) fn factorised(matrix: &Matrix) -> Self {
        let n = matrix.rows();
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            matrix.row(i).for_each(|(j, a)| l[i * n + j] += a);
        }
        // Not a pivot's own diagonal, which is stiff where its site has a near neighbour: what is left of it is not rounding.
        let least = (0..n).map(|i| l[i * n + i]).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        let is_laplacian = (0..n).all(|i| matrix.row(i).all(|(j, a)| j == i || a <= 0.0));
        for j in 0..n {
            let whole = l[j * n + j];
            let mut sum = 0.0;
            for i in j + 1..n {
                let rest = l[i * n + j] - (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum::<f64>();
                l[i * n + j] = rest;
                sum -= rest;
            }
            let (pivot, size) = if is_laplacian {
                (sum, least)
            } else {
                (whole - (0..j).map(|k| l[j * n + k] * l[j * n + k]).sum::<f64>(), whole)
            };
            let root = if pivot > n as f64 * 8.0 * f64::EPSILON * size { pivot.sqrt() } else { 0.0 };
            l[j * n + j] = root;
            for i in j + 1..n {
                l[i * n + j] = if root > 0.0 { l[i * n + j] / root } else { 0.0 };
            }
        }
        Self { size: n, factor: l }
    }

    /// Number of pivots that are zero but for rounding.
    pub(super) fn kernel(&self) -> usize {
        (0..self.size).filter(|i| self.factor[i * self.size + i] == 0.0).count()
    }

    /// Solves `A x = b` for a `b` that is orthogonal to the kernel.
    pub(super) fn solve(&self, b: &[f64], x: &mut [f64]) {
        let (n, l) = (self.size, &self.factor);
        for i in 0..n {
            let rest = b[i] - (0..i).map(|k| l[i * n + k] * x[k]).sum::<f64>();
            x[i] = if l[i * n + i] > 0.0 { rest / l[i * n + i] } else { 0.0 };
        }
        for i in (0..n).rev() {
            let rest = x[i] - (i + 1..n).map(|k| l[k * n + i] * x[k]).sum::<f64>();
            x[i] = if l[i * n + i] > 0.0 { rest / l[i * n + i] } else { 0.0 };
        }
    }

    /// What solves as [`Self::solve`] does, as a matrix of all entries.
    pub(super) fn inverse(&self) -> Matrix {
        let n = self.size;
        let columns: Vec<Vec<f64>> = parallel::map(n, 1, |k| {
            let unit: Vec<f64> = (0..n).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
            let mut column = vec![0.0; n];
            self.solve(&unit, &mut column);
            column
        });
        // (It is symmetric: a column is a row.)
        Matrix::from_rows(
            n,
            || (),
            |i, (), numbers, values| {
                numbers.extend(0..n as u32);
                values.extend_from_slice(&columns[i]);
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: &[Vec<(u32, f64)>]) -> Matrix {
        Matrix::from_rows(
            rows.len(),
            || (),
            |i, (), columns, values| {
                columns.extend(rows[i].iter().map(|x| x.0));
                values.extend(rows[i].iter().map(|x| x.1));
            },
        )
    }

    #[test]
    fn a_laplacian_in_two_parts_is_solved_and_its_kernel_counted() {
        // A path of three and one of two, their ties of different strength.
        let rows = [
            vec![(0, 2.0), (1, -2.0)],
            vec![(1, 2.5), (0, -2.0), (2, -0.5)],
            vec![(2, 0.5), (1, -0.5)],
            vec![(3, 3.0), (4, -3.0)],
            vec![(4, 3.0), (3, -3.0)],
        ];
        let matrix = of(&rows);
        let dense = Dense::factorised(&matrix);
        assert_eq!(dense.kernel(), 2);
        let (b, mut x) = ([1.0, 2.0, -3.0, -0.75, 0.75], [0.0; 5]);
        dense.solve(&b, &mut x);
        for (i, b) in b.iter().enumerate() {
            assert!((matrix.row_times(i, &x) - b).abs() < 1e-14, "{x:?}");
        }
        let inverse = dense.inverse();
        for (i, x) in x.iter().enumerate() {
            assert!((inverse.row_times(i, &b) - x).abs() < 1e-14);
        }
    }

    /// A pair that is tied 1e15 times as strongly as others is no kernel, and solved to the last digits.
    #[test]
    fn stiff_ties_lose_nothing() {
        let (weak, stiff) = ([1.0, 3.0], 1e15);
        let rows = [
            vec![(0, stiff + weak[0]), (1, -stiff), (2, -weak[0])],
            vec![(1, stiff + weak[1]), (0, -stiff), (2, -weak[1])],
            vec![(2, weak[0] + weak[1]), (0, -weak[0]), (1, -weak[1])],
        ];
        let matrix = of(&rows);
        let dense = Dense::factorised(&matrix);
        assert_eq!(dense.kernel(), 1);
        let mut x = [0.0; 3];
        dense.solve(&[2.0, 2.0, -4.0], &mut x);
        assert!((x[0] - x[2] - 1.0).abs() < 1e-14 && (x[1] - x[2] - 1.0).abs() < 1e-14, "{x:?}");
    }
}
