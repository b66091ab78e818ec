//! The next level of a multigrid, made on the host: aggregates of unknowns and their strong neighbours, and the matrix between them.

use laguerre_core::algebra::Coarsening;

use super::sparse::Matrix;
use crate::vectors::for_each;
use laguerre_core::parallel;

/// Unknowns whose aggregates one thread makes; fixed, for these depend on it.
const BLOCK: usize = 1 << 15;
const NONE: u32 = u32::MAX;

/// The next level of a matrix: `P`, `Pᵀ` and `Pᵀ A P`; `None` where there is none.
pub(super) fn coarser(matrix: &Matrix, inverse: &[f64], how: Coarsening) -> Option<(Matrix, Matrix, Matrix)> {
    let (aggregate, aggregates) = aggregates(matrix, inverse, how.strong);
    if aggregates == 0 || aggregates >= matrix.rows() {
        return None;
    }
    let prolongation = prolongation(matrix, inverse, how, &aggregate);
    let restriction = prolongation.transposed(aggregates);
    let mut coarse = restriction.times(&matrix.times(&prolongation));
    coarse.balance();
    Some((prolongation, restriction, coarse))
}

/// `(I − ω D⁻¹ A) T`, `T` the piecewise constants; weak entries of `A` are added to the diagonal.
fn prolongation(matrix: &Matrix, inverse: &[f64], how: Coarsening, aggregate: &[u32]) -> Matrix {
    let Coarsening { strong: least, omega } = how;
    Matrix::from_rows(
        matrix.rows(),
        || (),
        |i, (), columns, values| {
            let begin = columns.len();
            let mut add = |column: u32, value: f64| {
                if column != NONE {
                    match columns[begin..].iter().position(|&c| c == column) {
                        Some(at) => values[begin + at] += value,
                        None => {
                            columns.push(column);
                            values.push(value);
                        }
                    }
                }
            };
            add(aggregate[i], 1.0);
            let mut strong = 0.0;
            for (j, a) in matrix.row(i) {
                if j != i && is_strong(i, j, a, inverse, least) {
                    strong -= a;
                }
            }
            if strong > 0.0 {
                // The filtered row sums to zero, as the row does.
                let scale = omega / strong;
                for (j, a) in matrix.row(i) {
                    if j != i && is_strong(i, j, a, inverse, least) {
                        add(aggregate[j], -scale * a);
                    }
                }
                add(aggregate[i], -omega);
            }
        },
    )
}

fn is_strong(i: usize, j: usize, a: f64, inverse: &[f64], least: f64) -> bool {
    a < 0.0 && a * a * inverse[i] * inverse[j] >= least * least
}

/// The aggregate of each unknown, and their number: first unknowns with all their strong neighbours where all are free, then what is
/// left joins the aggregate it is most strongly tied to. An unknown without a strong neighbour has no part in the coarse levels:
/// smoothing alone settles it. Blocks of unknowns are put together each for itself, on all threads, at first without ties between blocks.
fn aggregates(matrix: &Matrix, inverse: &[f64], least: f64) -> (Vec<u32>, usize) {
    let n = matrix.rows();
    let strong = |i: usize| matrix.row(i).filter(move |&(j, a)| j != i && is_strong(i, j, a, inverse, least));
    let mut first = vec![NONE; n];
    let mut counts = vec![0; n.div_ceil(BLOCK)];
    parallel::each(first.chunks_mut(BLOCK).zip(&mut counts), |block, (aggregate, count)| {
        let begin = block * BLOCK;
        let is_inside = |j: &usize| j.wrapping_sub(begin) < BLOCK;
        let of_block = |i: usize| strong(i).map(|(j, _)| j).filter(is_inside).map(|j| j - begin);
        for k in 0..aggregate.len() {
            let i = begin + k;
            if aggregate[k] == NONE && strong(i).next().is_some() && of_block(i).all(|j| aggregate[j] == NONE) {
                of_block(i).for_each(|j| aggregate[j] = **count);
                aggregate[k] = **count;
                **count += 1;
            }
        }
    });
    let mut sum = 0;
    let mut base = Vec::with_capacity(counts.len());
    for count in counts {
        base.push(sum);
        sum += count;
    }
    let name = |i: usize| if first[i] == NONE { NONE } else { base[i / BLOCK] + first[i] };
    // Whoever is left has a strong neighbour that is taken, else it would have begun an aggregate.
    let mut aggregate = vec![NONE; n];
    for_each(&mut aggregate, |i, own| {
        *own = name(i);
        if *own == NONE {
            let tied = strong(i).filter(|&(j, _)| first[j] != NONE).min_by(|x, y| x.1.total_cmp(&y.1));
            *own = tied.map_or(NONE, |(j, _)| name(j));
        }
    });
    (aggregate, sum as usize)
}
