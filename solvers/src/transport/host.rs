//! Linear algebra in the host's memory, on all threads.

use laguerre_core::algebra::{
    Algebra, CELL, Coarsening, Coarser, Held, Kept, Smoothed, Smoothing, check_lengths, part, rise,
};
use laguerre_core::rows::Rows;
use laguerre_core::{Laplacian, Result};

use super::aggregation;
use super::sparse::{self, Matrix};
use crate::vectors::{any, for_each, map};

/// It: what it holds are [`Matrix`] and lists of numbers.
pub(crate) struct Host;

/// The one that there is.
pub(crate) static HOST: Host = Host;

fn numbers(x: &Held) -> Result<&[f64]> {
    Ok(x.own::<Vec<f64>>()?)
}

fn own_matrix(a: &Held) -> Result<&Matrix> {
    a.own()
}

/// The numbers of the cells of a matrix's rows.
fn cells_of<'a>(a: &Matrix, cells: &'a Held) -> Result<&'a [[f64; CELL]]> {
    let cells = numbers(cells)?.as_chunks().0;
    check_lengths(cells.len() >= a.rows())?;
    Ok(cells)
}

impl Algebra for Host {
    fn vector(&self, values: &[f64]) -> Result<Held> {
        Ok(Held::new(values.to_vec()))
    }

    fn read(&self, x: &Held) -> Result<Vec<f64>> {
        Ok(numbers(x)?.to_vec())
    }

    fn write(&self, values: &[f64], x: &mut Held) -> Result<()> {
        x.own_mut::<Vec<f64>>()?.copy_from_slice(values);
        Ok(())
    }

    fn matrix(&self, (offsets, columns, values): Rows) -> Result<Held> {
        Ok(Held::new(Matrix { offsets, columns, values }))
    }

    fn rows(&self, a: &Held) -> Result<Rows> {
        let Matrix { offsets, columns, values } = own_matrix(a)?.clone();
        Ok((offsets, columns, values))
    }

    fn row_count(&self, a: &Held) -> Result<usize> {
        Ok(own_matrix(a)?.rows())
    }

    fn coarser(&self, a: &Held, inverse_diagonal: &Held, how: Coarsening) -> Result<Option<Coarser>> {
        let made = aggregation::coarser(own_matrix(a)?, numbers(inverse_diagonal)?, how);
        Ok(made.map(|(prolongation, restriction, matrix)| Coarser {
            prolongation: Held::new(prolongation),
            restriction: Held::new(restriction),
            matrix: Held::new(matrix),
        }))
    }

    fn laplacian(&self, _kept: &Kept, _scale: f64) -> Result<Option<Held>> {
        Ok(None)
    }

    fn read_laplacian(&self, _kept: &Kept) -> Result<Option<Laplacian>> {
        Ok(None)
    }

    fn cells(&self, _kept: &Kept, _density: f64) -> Result<Option<Held>> {
        Ok(None)
    }

    fn multiply(&self, a: &Held, x: &Held, y: &mut Held) -> Result<()> {
        let (a, x, y) = (own_matrix(a)?, numbers(x)?, y.own_mut::<Vec<f64>>()?);
        if y.len() == a.rows() {
            a.apply(x, y, |_, ax, _| ax);
            return Ok(());
        }
        check_lengths(y.len() == 3 * a.rows())?;
        let (x, y) = (x.as_chunks::<3>().0, y.as_chunks_mut::<3>().0);
        for_each(y, |i, y| {
            *y = a.row(i).fold([0.0; 3], |sum, (j, a)| std::array::from_fn(|k| sum[k] + a * x[j][k]));
        });
        Ok(())
    }

    fn subtract(&self, a: &Held, x: &Held, y: &mut Held) -> Result<()> {
        own_matrix(a)?.apply(numbers(x)?, y.own_mut::<Vec<f64>>()?, |_, ax, y| y - ax);
        Ok(())
    }

    fn combine(&self, alpha: f64, x: &Held, beta: f64, y: &mut Held) -> Result<()> {
        let x = numbers(x)?;
        for_each(y.own_mut::<Vec<f64>>()?, |i, y| *y = alpha * x[i] + if beta == 0.0 { 0.0 } else { beta * *y });
        Ok(())
    }

    fn combine_scaled(&self, alpha: f64, d: &Held, x: &Held, beta: f64, y: &mut Held) -> Result<()> {
        let (d, x) = (numbers(d)?, numbers(x)?);
        for_each(y.own_mut::<Vec<f64>>()?, |i, y| {
            *y = alpha * (d[i] * x[i]) + if beta == 0.0 { 0.0 } else { beta * *y };
        });
        Ok(())
    }

    fn smooth(&self, how: Smoothing<'_>, r: &mut Held, t: &mut Held, x: &mut Held) -> Result<()> {
        self.subtract(how.matrix, how.last, r)?;
        let (d, r, s) = (numbers(how.inverse_diagonal)?, numbers(r)?, numbers(how.last)?);
        let t = t.own_mut::<Vec<f64>>()?;
        for_each(t, |i, t| *t = how.alpha * (d[i] * r[i]) + if how.beta == 0.0 { 0.0 } else { how.beta * s[i] });
        for_each(x.own_mut::<Vec<f64>>()?, |i, x| {
            let before = match how.before {
                Smoothed::WithLast => *x,
                Smoothed::WithoutLast => *x + s[i],
                Smoothed::Nothing => s[i],
            };
            *x = before + t[i];
        });
        Ok(())
    }

    fn dot(&self, x: &Held, y: &Held) -> Result<f64> {
        Ok(sparse::dot(numbers(x)?, numbers(y)?))
    }

    fn center(&self, x: &mut Held) -> Result<f64> {
        let x = x.own_mut::<Vec<f64>>()?;
        sparse::center(x);
        Ok(sparse::dot(x, x))
    }

    fn inverse_diagonal(&self, a: &Held) -> Result<Held> {
        let a = own_matrix(a)?;
        let mut inverse = vec![0.0; a.rows()];
        for_each(&mut inverse, |i, d| {
            let diagonal: f64 = a.row(i).filter(|&(j, _)| j == i).map(|(_, a)| a).sum();
            *d = if diagonal > 0.0 { diagonal.recip() } else { 0.0 };
        });
        Ok(Held::new(inverse))
    }

    fn is_within(&self, x: &Held, factor: f64, bound: &Held) -> Result<bool> {
        let (x, bound) = (numbers(x)?, numbers(bound)?);
        let is_within = |i: usize| x[i].abs() <= factor * bound[i];
        Ok(!any(x.len(), |i| !is_within(i)))
    }

    fn rises_too_far(&self, a: &Held, x: &Held, cells: &Held, share: f64, flattest: f64) -> Result<bool> {
        let (a, x) = (own_matrix(a)?, numbers(x)?);
        let cells = cells_of(a, cells)?;
        let rises = |i: usize, j: usize| x[i] > x[j] && x[i] - x[j] > rise(&cells[i], &cells[j], share, flattest);
        Ok(any(a.rows(), |i| a.row(i).any(|(j, _)| rises(i, j))))
    }

    fn stiffened(&self, a: &Held, x: &Held, cells: &Held, share: f64, flattest: f64) -> Result<Held> {
        let (a, x) = (own_matrix(a)?, numbers(x)?);
        let cells = cells_of(a, cells)?;
        // (Both entries of a facet have the same factor, to the last bit.)
        let factor = |i: usize, j: usize| {
            let (above, below) = if x[i] > x[j] { (i, j) } else { (j, i) };
            let by = x[above] - x[below];
            if by > 0.0 { (by / rise(&cells[above], &cells[below], share, flattest)).max(1.0) } else { 1.0 }
        };
        let row = |i: usize, (): &mut (), columns: &mut Vec<u32>, values: &mut Vec<f64>| {
            let diagonal = values.len();
            columns.extend(a.row(i).map(|(j, _)| j as u32));
            values.push(0.0);
            values.extend(a.row(i).skip(1).map(|(j, entry)| factor(i, j) * entry));
            values[diagonal] = -values[diagonal + 1..].iter().sum::<f64>();
        };
        Ok(Held::new(Matrix::from_rows(a.rows(), || (), row)))
    }

    fn parted(&self, a: &Held, cells: &Held, depth: f64) -> Result<Held> {
        let a = own_matrix(a)?;
        let cells = cells_of(a, cells)?;
        let others = |i: usize| a.row(i).filter(move |&(j, _)| j != i);
        Ok(Held::new(map(a.rows(), |i| others(i).map(|(j, _)| part(&cells[i], &cells[j], depth)).sum::<f64>())))
    }
}
