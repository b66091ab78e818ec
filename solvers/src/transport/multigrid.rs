//! Algebraic multigrid by smoothed aggregation (Vaněk, Mandel, Brezina 1996), as a preconditioner for the conjugate gradient.
//!
//! A level's unknowns are put together to aggregates of an unknown and its strong neighbours. Piecewise constant vectors over the
//! aggregates, which hold the kernel of a Laplacian, are smoothed by one Jacobi step and make the columns of the prolongation `P`; the
//! next level's matrix is `Pᵀ A P`. A cycle smooths by Chebyshev polynomials, which are symmetric and, unlike Gauss–Seidel, the same for
//! every number of threads.
//!
//! To make a hierarchy takes as long as some 15 iterations, so that it is kept from one matrix to the next while it serves.

use rayon::prelude::*;

use super::dense::Dense;
use super::sparse::{Matrix, norm};
use crate::vectors::for_each;

/// Levels end where a dense factorisation is cheaper than another level.
const COARSEST: usize = 300;
/// `|a_ij| ≥ STRONG·√(a_ii a_jj)` makes j a strong neighbour of i. Cells of white noise have 15 neighbours, whose mean is 1/15.
const STRONG: f64 = 0.02;
/// Power iterations for the largest eigenvalue of `D⁻¹A`, and what is added to their estimate, which is from below.
const POWER_ITERATIONS: usize = 8;
const POWER_MARGIN: f64 = 1.1;
/// A smoother damps the eigenvalues from the largest down to this share of it; the coarse levels see to the rest.
const SMOOTHED_SHARE: f64 = 0.25;
/// Degree of the smoother's polynomial.
const DEGREE: usize = 2;
/// Unknowns whose aggregates one thread makes; fixed, for these depend on it.
const BLOCK: usize = 1 << 15;
const NONE: u32 = u32::MAX;

/// A hierarchy of matrices.
pub(super) struct Multigrid {
    levels: Vec<Level>,
    /// Solves the last level; `None` where hardly anything is tied to anything, and smoothing is all that is needed.
    coarsest: Option<Dense>,
    /// Whether all but the finest level was made for another matrix.
    is_of_another: bool,
}

struct Level {
    smoother: Smoother,
    /// To the next level, and back.
    restriction: Matrix,
    prolongation: Matrix,
    scratch: Scratch,
}

/// A matrix, and what smooths with it.
struct Smoother {
    matrix: Matrix,
    /// 0 where the diagonal is.
    inverse_diagonal: Vec<f64>,
    /// Bounds of the eigenvalues of `D⁻¹A` that are smoothed.
    smoothed: (f64, f64),
}

/// Vectors of a cycle.
#[derive(Default)]
struct Scratch {
    solution: Vec<f64>,
    residual: Vec<f64>,
    step: Vec<f64>,
}

impl Multigrid {
    /// For a symmetric matrix, positive semidefinite with the constants in its kernel; each row has its diagonal first.
    pub(super) fn new(matrix: Matrix) -> Self {
        let mut levels = vec![Level::new(matrix)];
        while let Some(last) = levels.last_mut() {
            match last.coarser() {
                Some(coarse) => levels.push(Level::new(coarse)),
                None => break,
            }
        }
        let last = &levels[levels.len() - 1].smoother.matrix;
        let coarsest = (last.rows() <= 4 * COARSEST).then(|| Dense::factorised(last));
        Self { levels, coarsest, is_of_another: false }
    }

    /// The same for another matrix of as many rows: with these coarse levels where there are some, and no more than one part.
    pub(super) fn renew(&mut self, matrix: Matrix) {
        if self.levels.len() == 1 || !self.is_connected() {
            *self = Self::new(matrix);
        } else {
            self.levels[0].smoother = Smoother::new(matrix);
            self.is_of_another = true;
        }
    }

    /// The same with coarse levels of its own.
    pub(super) fn make_anew(&mut self) {
        *self = Self::new(std::mem::take(&mut self.levels[0].smoother.matrix));
    }

    /// Whether coarse levels are those of another matrix.
    pub(super) fn is_of_another(&self) -> bool {
        self.is_of_another
    }

    /// The matrix that is solved.
    pub(super) fn finest(&self) -> &Matrix {
        &self.levels[0].smoother.matrix
    }

    /// Whether the coarsest matrix has but the constants in its kernel.
    fn is_connected(&self) -> bool {
        self.coarsest.as_ref().is_some_and(|dense| dense.kernel() <= 1)
    }

    /// The connected part that each unknown is in, and the number of parts. Looked for only where the coarsest matrix has more than the
    /// constants in its kernel, as it then does, and not where that is another's.
    pub(super) fn parts(&self) -> Option<(Vec<u32>, usize)> {
        if self.is_connected() {
            return None;
        }
        let matrix = self.finest();
        let mut part = vec![NONE; matrix.rows()];
        let mut count = 0;
        let mut stack = Vec::new();
        for start in 0..part.len() {
            if part[start] == NONE {
                part[start] = count;
                stack.push(start);
                while let Some(i) = stack.pop() {
                    for (j, _) in matrix.row(i) {
                        if part[j] == NONE {
                            part[j] = count;
                            stack.push(j);
                        }
                    }
                }
                count += 1;
            }
        }
        (count > 1).then_some((part, count as usize))
    }

    /// One symmetric V-cycle: `x ≈ A⁻¹ b`.
    pub(super) fn apply(&mut self, b: &[f64], x: &mut [f64]) {
        self.levels[0].scratch.residual.copy_from_slice(b);
        self.cycle(0);
        x.copy_from_slice(&self.levels[0].scratch.solution);
    }

    /// From the residual to the solution of a level.
    fn cycle(&mut self, depth: usize) {
        let (upper, lower) = self.levels.split_at_mut(depth + 1);
        let level = &mut upper[depth];
        let Some(next) = lower.first_mut() else {
            match &self.coarsest {
                Some(factor) => factor.solve(&level.scratch.residual, &mut level.scratch.solution),
                None => {
                    level.scratch.solution.fill(0.0);
                    level.smooth();
                }
            }
            return;
        };
        level.scratch.solution.fill(0.0);
        level.smooth();
        level.update_residual();
        level.restriction.apply(&level.scratch.residual, &mut next.scratch.residual, |_, r, _| r);
        self.cycle(depth + 1);
        let (upper, lower) = self.levels.split_at_mut(depth + 1);
        let level = &mut upper[depth];
        let Scratch { solution, step, .. } = &mut level.scratch;
        level.prolongation.apply(&lower[0].scratch.solution, step, |_, e, _| e);
        for_each(solution, |i, x| *x += step[i]);
        level.update_residual();
        level.smooth();
    }
}

impl Smoother {
    fn new(matrix: Matrix) -> Self {
        let n = matrix.rows();
        let mut inverse_diagonal = vec![0.0; n];
        for_each(&mut inverse_diagonal, |i, d| {
            let a: f64 = matrix.row(i).filter(|&(j, _)| j == i).map(|(_, a)| a).sum();
            *d = if a > 0.0 { a.recip() } else { 0.0 };
        });
        let largest = largest_eigenvalue(&matrix, &inverse_diagonal);
        Self { matrix, inverse_diagonal, smoothed: (SMOOTHED_SHARE * largest, largest) }
    }
}

impl Level {
    fn new(matrix: Matrix) -> Self {
        let zeros = || vec![0.0; matrix.rows()];
        Self {
            scratch: Scratch { solution: zeros(), residual: zeros(), step: zeros() },
            smoother: Smoother::new(matrix),
            restriction: Matrix::default(),
            prolongation: Matrix::default(),
        }
    }

    /// Makes the transfers to the next level, and its matrix; `None` where there is to be none.
    fn coarser(&mut self) -> Option<Matrix> {
        if self.smoother.matrix.rows() <= COARSEST {
            return None;
        }
        let (aggregate, aggregates) = aggregates(&self.smoother.matrix, &self.smoother.inverse_diagonal);
        if aggregates == 0 || aggregates >= self.smoother.matrix.rows() {
            return None;
        }
        self.prolongation = self.prolongation(&aggregate);
        self.restriction = self.prolongation.transposed(aggregates);
        let mut coarse = self.restriction.times(&self.smoother.matrix.times(&self.prolongation));
        coarse.balance();
        Some(coarse)
    }

    /// `(I − ω D⁻¹ A) T`, `T` the piecewise constants; weak entries of `A` are added to the diagonal.
    fn prolongation(&self, aggregate: &[u32]) -> Matrix {
        let omega = 4.0 / 3.0 / self.smoother.smoothed.1;
        let inverse = &self.smoother.inverse_diagonal;
        Matrix::from_rows(
            self.smoother.matrix.rows(),
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
                for (j, a) in self.smoother.matrix.row(i) {
                    if j != i && is_strong(i, j, a, inverse) {
                        strong -= a;
                    }
                }
                if strong > 0.0 {
                    // The filtered row sums to zero, as the row does.
                    let scale = omega / strong;
                    for (j, a) in self.smoother.matrix.row(i) {
                        if j != i && is_strong(i, j, a, inverse) {
                            add(aggregate[j], -scale * a);
                        }
                    }
                    add(aggregate[i], -omega);
                }
            },
        )
    }

    /// Improves the solution by Chebyshev's polynomial for the smoothed eigenvalues. The residual must be that of the solution, and
    /// lags behind by the last `step` after.
    fn smooth(&mut self) {
        let (lo, hi) = self.smoother.smoothed;
        let (middle, half) = ((hi + lo) / 2.0, (hi - lo) / 2.0);
        let sigma = middle / half;
        let mut rho = 1.0 / sigma;
        let inverse = &self.smoother.inverse_diagonal;
        let Scratch { solution, residual, step } = &mut self.scratch;
        for_each(step, |i, d| *d = inverse[i] * residual[i] / middle);
        for_each(solution, |i, x| *x += step[i]);
        for _ in 1..DEGREE {
            self.smoother.matrix.apply(step, residual, |_, ad, r| r - ad);
            let next = 1.0 / (2.0 * sigma - rho);
            for_each(step, |i, d| *d = next * rho * *d + 2.0 * next / half * inverse[i] * residual[i]);
            for_each(solution, |i, x| *x += step[i]);
            rho = next;
        }
    }

    /// Brings the residual up to the last `step`.
    fn update_residual(&mut self) {
        let Scratch { residual, step, .. } = &mut self.scratch;
        self.smoother.matrix.apply(step, residual, |_, ad, r| r - ad);
    }
}

fn is_strong(i: usize, j: usize, a: f64, inverse_diagonal: &[f64]) -> bool {
    a < 0.0 && a * a * inverse_diagonal[i] * inverse_diagonal[j] >= STRONG * STRONG
}

/// The aggregate of each unknown, and their number: first unknowns with all their strong neighbours where all are free, then what is
/// left joins the aggregate it is most strongly tied to. An unknown without a strong neighbour has no part in the coarse levels:
/// smoothing alone settles it. Blocks of unknowns are put together each for itself, on all threads, at first without ties between blocks.
fn aggregates(matrix: &Matrix, inverse_diagonal: &[f64]) -> (Vec<u32>, usize) {
    let n = matrix.rows();
    let strong = |i: usize| matrix.row(i).filter(move |&(j, a)| j != i && is_strong(i, j, a, inverse_diagonal));
    let mut first = vec![NONE; n];
    let blocks = first.par_chunks_mut(BLOCK).enumerate();
    let counts: Vec<u32> = blocks
        .map(|(block, aggregate)| {
            let begin = block * BLOCK;
            let is_inside = |j: &usize| j.wrapping_sub(begin) < BLOCK;
            let of_block = |i: usize| strong(i).map(|(j, _)| j).filter(is_inside).map(|j| j - begin);
            let mut count = 0;
            for k in 0..aggregate.len() {
                let i = begin + k;
                if aggregate[k] == NONE && strong(i).next().is_some() && of_block(i).all(|j| aggregate[j] == NONE) {
                    of_block(i).for_each(|j| aggregate[j] = count);
                    aggregate[k] = count;
                    count += 1;
                }
            }
            count
        })
        .collect();
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

/// An upper estimate of the largest eigenvalue of `D⁻¹A`.
fn largest_eigenvalue(matrix: &Matrix, inverse_diagonal: &[f64]) -> f64 {
    let n = matrix.rows();
    // Any vector that is not smooth: fractions of the golden ratio, with alternating signs.
    let mut x: Vec<f64> = (0..n).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract() - 0.5).collect();
    let mut image = vec![0.0; n];
    let mut eigenvalue = 1.0;
    for _ in 0..POWER_ITERATIONS {
        let length = norm(&x);
        if length == 0.0 {
            break;
        }
        for_each(&mut x, |_, x| *x /= length);
        matrix.apply(&x, &mut image, |i, ax, _| inverse_diagonal[i] * ax);
        eigenvalue = norm(&image);
        std::mem::swap(&mut x, &mut image);
    }
    // A Laplacian's are at most 2 (Gershgorin), and so little is gained below 1 that no margin is taken off.
    POWER_MARGIN * eigenvalue.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::conjugate_gradient;
    use super::*;

    /// The Laplacian of a cubic lattice of `n³` points; ties along z are `z` times as strong.
    fn lattice(n: usize, z: f64) -> Matrix {
        Matrix::from_rows(
            n * n * n,
            || (),
            |i, (), columns, values| {
                let at = [i % n, i / n % n, i / n / n];
                let diagonal = columns.len();
                columns.push(i as u32);
                values.push(0.0);
                for (k, stride) in [1, n, n * n].into_iter().enumerate() {
                    let tie = if k == 2 { z } else { 1.0 };
                    let there = [(at[k] > 0).then(|| i - stride), (at[k] + 1 < n).then_some(i + stride)];
                    for j in there.into_iter().flatten() {
                        columns.push(j as u32);
                        values.push(-tie);
                        values[diagonal] += tie;
                    }
                }
            },
        )
    }

    fn noise(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        (0..n).map(|_| next()).collect()
    }

    #[test]
    fn a_cycle_is_symmetric_and_positive() {
        let mut multigrid = Multigrid::new(lattice(17, 1.0));
        assert!(multigrid.levels.len() > 1);
        let n = multigrid.finest().rows();
        let (x, y) = (noise(n, 1), noise(n, 2));
        let (mut bx, mut by) = (vec![0.0; n], vec![0.0; n]);
        multigrid.apply(&x, &mut bx);
        multigrid.apply(&y, &mut by);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!((dot(&x, &by) - dot(&bx, &y)).abs() < 1e-12 * dot(&x, &bx), "{} {}", dot(&x, &by), dot(&bx, &y));
        assert!(dot(&x, &bx) > 0.0 && dot(&y, &by) > 0.0);
    }

    #[test]
    fn iterations_hardly_grow_with_the_size_and_solve_the_system() {
        for z in [1.0, 0.03] {
            let counts: Vec<usize> = [10, 22, 46]
                .into_iter()
                .map(|n| {
                    let matrix = lattice(n, z);
                    let mut b = noise(n * n * n, 3);
                    super::super::sparse::center(&mut b);
                    let found =
                        conjugate_gradient::solve(&mut Multigrid::new(matrix.clone()), b.clone(), 1e-10, |_| false);
                    let mut left = b.clone();
                    matrix.apply(&found.solution, &mut left, |_, ax, b| b - ax);
                    assert!(norm(&left) <= 1e-9 * norm(&b), "{}", norm(&left) / norm(&b));
                    found.iterations
                })
                .collect();
            assert!(counts[2] <= counts[0] + counts[0] / 2 && counts[2] <= 30, "{z}: {counts:?}");
        }
    }

    /// Both, not tied to each other.
    fn beside(one: &Matrix, two: &Matrix) -> Matrix {
        let n = one.rows();
        Matrix::from_rows(
            n + two.rows(),
            || (),
            |i, (), columns, values| {
                let (matrix, base) = if i < n { (one, 0) } else { (two, n) };
                for (j, a) in matrix.row(i - base) {
                    columns.push((j + base) as u32);
                    values.push(a);
                }
            },
        )
    }

    #[test]
    fn coarse_levels_serve_for_a_matrix_that_is_like_theirs_and_are_left_where_they_do_not() {
        let matrix = lattice(20, 1.0);
        let n = matrix.rows();
        let mut b = noise(n, 5);
        super::super::sparse::center(&mut b);
        let mut multigrid = Multigrid::new(matrix);
        let other = lattice(20, 0.5);
        multigrid.renew(other.clone());
        let found = conjugate_gradient::solve(&mut multigrid, b.clone(), 1e-6, |_| false);
        let mut left = b.clone();
        other.apply(&found.solution, &mut left, |_, ax, b| b - ax);
        assert!(found.is_solved && norm(&left) <= 2e-6 * norm(&b), "{} {}", found.iterations, norm(&left) / norm(&b));
        // Halves that are not tied any more, of which one is to have what the other has too much: no solution.
        let half = Matrix::from_rows(
            n / 2,
            || (),
            |i, (), columns, values| {
                for (j, a) in lattice(20, 1.0).row(i) {
                    let column = if j < n / 2 { j } else { i };
                    columns.push(column as u32);
                    values.push(a);
                }
            },
        );
        multigrid.renew(beside(&half, &half));
        let unequal = (0..n).map(|i| if i < n / 2 { 1.0 } else { -1.0 }).collect();
        assert!(!conjugate_gradient::solve(&mut multigrid, unequal, 1e-6, |_| false).is_solved);
        multigrid.make_anew();
        assert_eq!(multigrid.parts().unwrap().1, 2);
    }

    #[test]
    fn parts_that_are_not_tied_are_found() {
        let (one, two) = (lattice(11, 1.0), lattice(9, 1.0));
        let n = one.rows();
        let both = beside(&one, &two);
        let (part, count) = Multigrid::new(both).parts().unwrap();
        assert_eq!(count, 2);
        assert!(part.iter().enumerate().all(|(i, &part)| (part == 0) == (i < n)));
        assert!(Multigrid::new(one).parts().is_none());
    }
}
