//! Sparse matrices on all threads, to the same bits for every number of them, and what their vectors need.

use laguerre_core::rows::{Rows, gather};

use crate::vectors::{CHUNK, for_each, map, sum};

/// A matrix in compressed rows. Columns within a row are in no order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Matrix {
    /// Row starts; one more than rows.
    pub(super) offsets: Vec<usize>,
    pub(super) columns: Vec<u32>,
    pub(super) values: Vec<f64>,
}

impl Matrix {
    pub(super) fn of((offsets, columns, values): Rows) -> Self {
        Self { offsets, columns, values }
    }

    pub(super) fn into_rows(self) -> Rows {
        (self.offsets, self.columns, self.values)
    }

    pub(super) fn rows(&self) -> usize {
        self.offsets.len() - 1
    }

    pub(super) fn entries(&self) -> usize {
        self.columns.len()
    }

    pub(super) fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let range = self.offsets[i]..self.offsets[i + 1];
        self.columns[range.clone()].iter().map(|&j| j as usize).zip(self.values[range].iter().copied())
    }

    /// Row `i` times `x`.
    pub(super) fn row_times(&self, i: usize, x: &[f64]) -> f64 {
        self.row(i).map(|(j, a)| a * x[j]).sum()
    }

    /// Sets `y_i = f(i, (A x)_i, y_i)`.
    pub(super) fn apply(&self, x: &[f64], y: &mut [f64], f: impl Fn(usize, f64, f64) -> f64 + Sync) {
        for_each(y, |i, y| *y = f(i, self.row_times(i, x), *y));
    }

    /// The matrix whose rows `row` appends, as (column, value), to what it is given.
    pub(super) fn from_rows<S>(
        rows: usize,
        scratch: impl Fn() -> S + Sync,
        row: impl Fn(usize, &mut S, &mut Vec<u32>, &mut Vec<f64>) + Sync,
    ) -> Self {
        Self::of(gather(rows, scratch, row))
    }

    /// The transpose, which has `rows` rows, each sorted.
    pub(super) fn transposed(&self, rows: usize) -> Self {
        let mut offsets = vec![0; rows + 1];
        for &j in &self.columns {
            offsets[j as usize + 1] += 1;
        }
        for i in 0..rows {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let (mut columns, mut values) = (vec![0; self.entries()], vec![0.0; self.entries()]);
        for i in 0..self.rows() {
            for (j, a) in self.row(i) {
                columns[next[j]] = i as u32;
                values[next[j]] = a;
                next[j] += 1;
            }
        }
        Self { offsets, columns, values }
    }

    /// Makes each row's sum zero but for a rounding of its own, by its diagonal. What rounding left of it grew from level to level, until the
    /// direct solver of two lattices of 4,000 points did not find the constants in the kernel.
    pub(super) fn balance(&mut self) {
        let diagonals: Vec<Option<(usize, f64)>> = map(self.rows(), |i| {
            let others = self.row(i).filter(|&(j, _)| j != i).map(|(_, a)| a).sum::<f64>();
            let at = self.columns[self.offsets[i]..self.offsets[i + 1]].iter().position(|&j| j as usize == i)?;
            Some((self.offsets[i] + at, -others))
        });
        diagonals.into_iter().flatten().for_each(|(k, diagonal)| self.values[k] = diagonal);
    }

    /// The product with `other`.
    pub(super) fn times(&self, other: &Self) -> Self {
        Self::from_rows(self.rows(), Gather::default, |i, gather, columns, values| {
            gather.start(self.row(i).map(|(j, _)| other.offsets[j + 1] - other.offsets[j]).sum());
            for (j, a) in self.row(i) {
                for (k, b) in other.row(j) {
                    gather.add(k as u32, a * b, columns, values);
                }
            }
        })
    }
}

/// Finds where a column stands in the row that is being gathered: a hash table with as many slots as a row needs, not as many as
/// there are columns.
#[derive(Default)]
struct Gather {
    /// Which row wrote a slot last, the column, and where in the results it stands.
    slots: Vec<(u32, u32, u32)>,
    stamp: u32,
    mask: usize,
}

impl Gather {
    /// Begins a row of at most `terms` different columns.
    fn start(&mut self, terms: usize) {
        let size = (2 * terms).next_power_of_two().max(16);
        if self.slots.len() < size || self.stamp == u32::MAX {
            self.slots = vec![(0, 0, 0); size];
            self.stamp = 0;
        }
        self.mask = size - 1;
        self.stamp += 1;
    }

    fn add(&mut self, column: u32, value: f64, columns: &mut Vec<u32>, values: &mut Vec<f64>) {
        // Multiplicative hashing (Knuth); the high bits are the mixed ones.
        let mut at = (column.wrapping_mul(0x9E37_79B1) >> 8) as usize & self.mask;
        loop {
            let slot = &mut self.slots[at];
            if slot.0 != self.stamp {
                *slot = (self.stamp, column, columns.len() as u32);
                columns.push(column);
                values.push(value);
                return;
            }
            if slot.1 == column {
                values[slot.2 as usize] += value;
                return;
            }
            at = (at + 1) & self.mask;
        }
    }
}

/// `x · y`.
pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    sum(x.len(), |i| x[i] * y[i])
}

/// Euclidean norm.
pub(super) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// Subtracts the mean, unless that is but the rounding of a sum over a chunk: what is centered stays as it is.
pub(super) fn center(x: &mut [f64]) {
    let n = x.len() as f64;
    let mean = sum(x.len(), |i| x[i]) / n;
    let size = sum(x.len(), |i| x[i].abs()) / n;
    if mean.abs() > CHUNK as f64 * f64::EPSILON * size {
        for_each(x, |_, x| *x -= mean);
    }
}

/// Subtracts from the rows of each part their own mean.
pub(super) fn center_parts(x: &mut [f64], parts: &[u32], count: usize) {
    let (mut sums, mut rows) = (vec![0.0; count], vec![0.0; count]);
    for (x, &part) in x.iter().zip(parts) {
        sums[part as usize] += x;
        rows[part as usize] += 1.0;
    }
    for_each(x, |row, x| *x -= sums[parts[row] as usize] / rows[parts[row] as usize]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dense(matrix: &Matrix, columns: usize) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; columns]; matrix.rows()];
        for (i, row) in rows.iter_mut().enumerate() {
            matrix.row(i).for_each(|(j, a)| row[j] += a);
        }
        rows
    }

    #[test]
    fn products_and_transposes_are_those_of_dense_matrices() {
        // More rows than a chunk, few columns; entries are small integers, so that all sums are exact.
        let (n, m) = (CHUNK + 17, 23);
        let tall = Matrix::from_rows(
            n,
            || (),
            |i, (), columns, values| {
                for k in 0..i % 5 {
                    columns.push(((7 * i + 5 * k) % m) as u32);
                    values.push((i % 11) as f64 - k as f64);
                }
            },
        );
        let wide = tall.transposed(m);
        let (t, w) = (dense(&tall, m), dense(&wide, n));
        assert!((0..n).all(|i| (0..m).all(|j| t[i][j] == w[j][i])));
        let square = wide.times(&tall);
        let s = dense(&square, m);
        for i in 0..m {
            for j in 0..m {
                assert_eq!(s[i][j], (0..n).map(|k| t[k][i] * t[k][j]).sum::<f64>());
            }
            let row: Vec<usize> = square.row(i).map(|(j, _)| j).collect();
            assert_eq!(row.iter().collect::<std::collections::HashSet<_>>().len(), row.len(), "a column stands twice");
        }
    }
}
