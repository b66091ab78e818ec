//! The direct solver of the coarsest level.

use super::sparse::Matrix;

/// A Cholesky factor `L Lᵀ` of a small positive semidefinite matrix. A pivot that is zero but for rounding belongs to the kernel: its
/// unknown is zero.
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
        for j in 0..n {
            let whole = l[j * n + j];
            let pivot = whole - (0..j).map(|k| l[j * n + k] * l[j * n + k]).sum::<f64>();
            let root = if pivot > n as f64 * 8.0 * f64::EPSILON * whole { pivot.sqrt() } else { 0.0 };
            l[j * n + j] = root;
            for i in j + 1..n {
                let rest = l[i * n + j] - (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum::<f64>();
                l[i * n + j] = if root > 0.0 { rest / root } else { 0.0 };
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
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let matrix = Matrix::from_rows(
            5,
            || (),
            |i, (), columns, values| {
                columns.extend(rows[i].iter().map(|x| x.0));
                values.extend(rows[i].iter().map(|x| x.1));
            },
        );
        let dense = Dense::factorised(&matrix);
        assert_eq!(dense.kernel(), 2);
        let (b, mut x) = ([1.0, 2.0, -3.0, -0.75, 0.75], [0.0; 5]);
        dense.solve(&b, &mut x);
        for (i, b) in b.iter().enumerate() {
            assert!((matrix.row_times(i, &x) - b).abs() < 1e-14, "{x:?}");
        }
    }
}
