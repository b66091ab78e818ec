//! Algebraic multigrid by smoothed aggregation (Vaněk, Mandel, Brezina 1996), as a preconditioner for the conjugate gradient.
//!
//! A level's unknowns are put together to aggregates of an unknown and its strong neighbours. Piecewise constant vectors over the
//! aggregates, which hold the kernel of a Laplacian, are smoothed by one Jacobi step and make the columns of the prolongation `P`; the
//! next level's matrix is `Pᵀ A P`. A cycle smooths by Chebyshev polynomials, which are symmetric and, unlike Gauss–Seidel, the same for
//! every number of threads.
//!
//! To make a hierarchy takes as long as some 15 iterations, so that it is kept from one matrix to the next while it serves. It is made where the matrix is, if that
//! can, else on the host.

use laguerre_core::Result;
use laguerre_core::algebra::{Algebra, Coarsening, Coarser, Held, Smoothed, Smoothing};
use std::borrow::Cow;
use std::mem;

use super::dense::Dense;
use super::host::HOST;
use super::sparse::{Matrix, norm};
use crate::vectors::map;

/// `|a_ij| ≥ STRONG·√(a_ii a_jj)` makes j a strong neighbour of i. Cells of white noise have 15 neighbours, whose mean is 1/15.
const STRONG: f64 = 0.02;
/// Levels end where a dense factorisation is cheaper than another level.
pub(super) const COARSEST: usize = 300;
/// Power iterations for the largest eigenvalue of `D⁻¹A`, those that go on from the last matrix's, and what is added to their estimate, which is from below.
const POWER_ITERATIONS: usize = 8;
const MORE_POWER_ITERATIONS: usize = 3;
const POWER_MARGIN: f64 = 1.1;
/// A smoother damps the eigenvalues from the largest down to this share of it; the coarse levels see to the rest.
const SMOOTHED_SHARE: f64 = 0.25;
/// Degree of the smoother's polynomial, at least 2.
const DEGREE: usize = 2;
/// Rows from which on nothing is kept from one matrix to the next that is made anew for it: the matrix itself, its diagonal, and vectors of a cycle are 246 bytes a row, of the 1,360 that a transport of 110
/// million sites takes of a device.
const MANY: usize = if cfg!(test) { 1 << 12 } else { 1 << 24 };
const NONE: u32 = u32::MAX;

/// A hierarchy of matrices, in the memory of some algebra.
pub(super) struct Multigrid<'a> {
    algebra: &'a dyn Algebra,
    levels: Vec<Level>,
    /// Solves the last level; `None` where hardly anything is tied to anything, and smoothing is all that is needed.
    coarsest: Option<Coarsest>,
    /// Whether an unknown is tied to no other, of a level that is large enough to have a next one: it has no part in that.
    leaves_out: bool,
    /// Whether all but the finest level was made for another matrix.
    is_of_another: bool,
    /// Whether the finest level has given back what is made anew.
    rests: bool,
    enough: Option<Enough>,
}

/// What the numbers of a residual may be for the system to be solved.
pub(super) struct Enough {
    /// Of which order of rows they are.
    number: usize,
    pub(super) bounds: Held,
    /// The length of these.
    pub(super) norm: f64,
}

struct Level {
    smoother: Smoother,
    /// To the next level, and back; the last level has none.
    transfers: Option<(Held, Held)>,
    scratch: Scratch,
}

/// A matrix, and what smooths with it.
struct Smoother {
    matrix: Held,
    /// 0 where the diagonal is.
    inverse_diagonal: Held,
    /// Bounds of the eigenvalues of `D⁻¹A` that are smoothed, and nearly the eigenvector of the largest.
    smoothed: (f64, f64),
    eigenvector: Held,
}

/// Vectors of a cycle.
struct Scratch {
    solution: Held,
    residual: Held,
    step: Held,
    next: Held,
}

/// The direct solver of the last level.
struct Coarsest {
    factor: Dense,
    /// The inverse, where another than the host computes, unless it is large: it need not wait for the host in each cycle.
    inverse: Option<Held>,
}

impl<'a> Multigrid<'a> {
    /// For a symmetric matrix, positive semidefinite with the constants in its kernel; each row has its diagonal first.
    pub(super) fn new(algebra: &'a dyn Algebra, matrix: Held) -> Result<Self> {
        let (mut levels, mut matrix) = (Vec::<Level>::new(), matrix);
        let mut leaves_out = false;
        loop {
            let rows = algebra.row_count(&matrix)?;
            let smoother = Smoother::new(algebra, matrix, rows)?;
            leaves_out = leaves_out || (rows > COARSEST && !smoother.are_all_tied(algebra, rows)?);
            let coarser = if rows > COARSEST { smoother.coarser(algebra)? } else { None };
            let Some(Coarser { prolongation, restriction, matrix: next }) = coarser else {
                let is_small = rows <= 4 * COARSEST;
                let coarsest = if is_small { Some(on_host(algebra, &smoother.matrix)?) } else { None };
                let coarsest = coarsest.map(|matrix| Coarsest::new(algebra, &smoother.matrix, &matrix)).transpose()?;
                levels.push(Level::new(algebra, smoother, None, rows)?);
                return Ok(Self {
                    algebra,
                    levels,
                    coarsest,
                    leaves_out,
                    is_of_another: false,
                    rests: false,
                    enough: None,
                });
            };
            levels.push(Level::new(algebra, smoother, Some((restriction, prolongation)), rows)?);
            matrix = next;
        }
    }

    /// Takes the bounds for rows in an order, which has this number, if it has not those.
    pub(super) fn end_at(&mut self, number: usize, bounds: &[f64]) -> Result<()> {
        if self.enough.as_ref().is_none_or(|enough| enough.number != number) {
            self.enough = Some(Enough { number, norm: norm(bounds), bounds: self.algebra.vector(bounds)? });
        }
        Ok(())
    }

    /// Those bounds.
    pub(super) fn enough(&self) -> Option<&Enough> {
        self.enough.as_ref()
    }

    /// The same for another matrix of as many rows: with these coarse levels where there are some, and no more than one part.
    pub(super) fn renewed(mut self, matrix: Held) -> Result<Self> {
        if self.levels.len() == 1 || !self.is_connected() {
            return self.of(matrix);
        }
        if self.rests {
            self.levels[0].scratch = Scratch::new(self.algebra, self.algebra.row_count(&matrix)?)?;
            self.rests = false;
        }
        self.levels[0].smoother.renew(self.algebra, matrix)?;
        self.is_of_another = true;
        Ok(self)
    }

    /// The same for the next matrix, before which a diagram is to be made: without what is made anew for that, where rows are many.
    pub(super) fn resting(mut self, rows: usize) -> Self {
        if rows >= MANY {
            let (Level { smoother, scratch, .. }, none) = (&mut self.levels[0], || Held::new(()));
            (smoother.matrix, smoother.inverse_diagonal) = (none(), none());
            *scratch = Scratch { solution: none(), residual: none(), step: none(), next: none() };
            (self.rests, self.enough) = (true, None);
        }
        self
    }

    /// The same with coarse levels of its own.
    pub(super) fn made_anew(mut self) -> Result<Self> {
        let finest = self.levels.swap_remove(0);
        self.of(finest.smoother.matrix)
    }

    /// Another for a matrix, with the same bounds.
    fn of(self, matrix: Held) -> Result<Self> {
        Ok(Self { enough: self.enough, ..Self::new(self.algebra, matrix)? })
    }

    /// Whether coarse levels are those of another matrix.
    pub(super) fn is_of_another(&self) -> bool {
        self.is_of_another
    }

    /// What computes.
    pub(super) fn algebra(&self) -> &'a dyn Algebra {
        self.algebra
    }

    /// The matrix that is solved.
    pub(super) fn finest(&self) -> &Held {
        &self.levels[0].smoother.matrix
    }

    /// The same as the host has it, or a copy.
    pub(super) fn finest_on_host(&self) -> Result<Cow<'_, Matrix>> {
        on_host(self.algebra, self.finest())
    }

    /// Whether the coarsest matrix has but the constants in its kernel, and all unknowns have a part in it.
    fn is_connected(&self) -> bool {
        !self.leaves_out && self.coarsest.as_ref().is_some_and(|coarsest| coarsest.factor.kernel() <= 1)
    }

    /// The connected part that each unknown is in, and the number of parts. Looked for only where the coarsest matrix has more than the
    /// constants in its kernel, or a level an unknown that is tied to no other, as one of them then does, and not where that is another's.
    pub(super) fn parts(&self) -> Result<Option<(Vec<u32>, usize)>> {
        if self.is_connected() {
            return Ok(None);
        }
        let matrix = self.finest_on_host()?;
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
        Ok((count > 1).then_some((part, count as usize)))
    }

    /// One symmetric V-cycle: `A⁻¹ b`, nearly.
    pub(super) fn apply(&mut self, b: &Held) -> Result<&Held> {
        self.algebra.combine(1.0, b, 0.0, &mut self.levels[0].scratch.residual)?;
        self.cycle(0)?;
        Ok(&self.levels[0].scratch.solution)
    }

    /// From the residual to the solution of a level.
    fn cycle(&mut self, depth: usize) -> Result<()> {
        let algebra = self.algebra;
        let (upper, lower) = self.levels.split_at_mut(depth + 1);
        let level = &mut upper[depth];
        let (Some(next), Some((restriction, _))) = (lower.first_mut(), &level.transfers) else {
            return match &self.coarsest {
                Some(coarsest) => coarsest.solve(algebra, &mut level.scratch),
                None => level.smoother.smooth_from_zero(algebra, &mut level.scratch),
            };
        };
        level.smoother.smooth_from_zero(algebra, &mut level.scratch)?;
        algebra.subtract(&level.smoother.matrix, &level.scratch.step, &mut level.scratch.residual)?;
        algebra.multiply(restriction, &level.scratch.residual, &mut next.scratch.residual)?;
        self.cycle(depth + 1)?;
        let (upper, lower) = self.levels.split_at_mut(depth + 1);
        let level = &mut upper[depth];
        if let Some((_, prolongation)) = &level.transfers {
            algebra.multiply(prolongation, &lower[0].scratch.solution, &mut level.scratch.step)?;
        }
        level.smoother.smooth_on(algebra, &mut level.scratch)
    }
}

impl Coarsest {
    /// Of a matrix, as the host has it as well.
    fn new(algebra: &dyn Algebra, held: &Held, matrix: &Matrix) -> Result<Self> {
        let factor = Dense::factorised(matrix);
        let is_worth_it = held.get::<Matrix>().is_none() && matrix.rows() <= COARSEST;
        let inverse = if is_worth_it { Some(algebra.matrix(factor.inverse().into_rows())?) } else { None };
        Ok(Self { factor, inverse })
    }

    fn solve(&self, algebra: &dyn Algebra, scratch: &mut Scratch) -> Result<()> {
        let Scratch { residual, solution, .. } = scratch;
        if let Some(inverse) = &self.inverse {
            return algebra.multiply(inverse, residual, solution);
        }
        let residual = algebra.read(residual)?;
        let mut solved = vec![0.0; residual.len()];
        self.factor.solve(&residual, &mut solved);
        algebra.write(&solved, solution)
    }
}

/// A matrix as the host has it, or a copy.
fn on_host<'a>(algebra: &dyn Algebra, matrix: &'a Held) -> Result<Cow<'a, Matrix>> {
    match matrix.get::<Matrix>() {
        Some(own) => Ok(Cow::Borrowed(own)),
        None => Ok(Cow::Owned(Matrix::of(algebra.rows(matrix)?))),
    }
}

impl Level {
    fn new(algebra: &dyn Algebra, smoother: Smoother, transfers: Option<(Held, Held)>, rows: usize) -> Result<Self> {
        Ok(Self { smoother, transfers, scratch: Scratch::new(algebra, rows)? })
    }
}

impl Scratch {
    fn new(algebra: &dyn Algebra, rows: usize) -> Result<Self> {
        let zeros = || algebra.zeros(rows);
        Ok(Self { solution: zeros()?, residual: zeros()?, step: zeros()?, next: zeros()? })
    }
}

impl Smoother {
    /// For a matrix of so many rows.
    fn new(algebra: &dyn Algebra, matrix: Held, rows: usize) -> Result<Self> {
        let (inverse_diagonal, eigenvector) = (algebra.inverse_diagonal(&matrix)?, algebra.zeros(rows)?);
        let mut made = Self { matrix, inverse_diagonal, smoothed: (0.0, 0.0), eigenvector };
        made.bound_eigenvalues(algebra)?;
        Ok(made)
    }

    /// The same for another matrix of as many rows, much like this one.
    fn renew(&mut self, algebra: &dyn Algebra, matrix: Held) -> Result<()> {
        self.inverse_diagonal = algebra.inverse_diagonal(&matrix)?;
        self.matrix = matrix;
        self.bound_eigenvalues(algebra)
    }

    /// Finds the bounds of the smoothed eigenvalues: the upper is an estimate of the largest of all, by power iterations.
    fn bound_eigenvalues(&mut self, algebra: &dyn Algebra) -> Result<()> {
        let Self { matrix, inverse_diagonal, eigenvector: x, .. } = self;
        let rows = algebra.row_count(matrix)?;
        let mut image = algebra.zeros(rows)?;
        let (mut eigenvalue, mut iterations) = (1.0, MORE_POWER_ITERATIONS);
        let mut length = algebra.dot(x, x)?.sqrt();
        if length == 0.0 || !length.is_finite() {
            // Any vector that is not smooth: fractions of the golden ratio, with alternating signs.
            let start: Vec<f64> = map(rows, |i| (i as f64 * 0.618_033_988_749_894_9).fract() - 0.5);
            algebra.write(&start, x)?;
            length = algebra.dot(x, x)?.sqrt();
            iterations = POWER_ITERATIONS;
        }
        for _ in 0..iterations {
            if length == 0.0 {
                break;
            }
            algebra.multiply(matrix, x, &mut image)?;
            // (Of length one.)
            algebra.combine_scaled(1.0 / length, inverse_diagonal, &image, 0.0, x)?;
            length = algebra.dot(x, x)?.sqrt();
            eigenvalue = length;
        }
        // A Laplacian's are at most 2 (Gershgorin), and so little is gained below 1 that no margin is taken off.
        let largest = POWER_MARGIN * f64::max(eigenvalue, 1.0);
        self.smoothed = (SMOOTHED_SHARE * largest, largest);
        Ok(())
    }

    /// Whether each unknown is tied to another: one that is not has nothing on its diagonal, and no part in the next level.
    fn are_all_tied(&self, algebra: &dyn Algebra, rows: usize) -> Result<bool> {
        algebra.is_within(&algebra.vector(&vec![1.0; rows])?, f64::MAX, &self.inverse_diagonal)
    }

    /// The next level; `None` where there is none.
    fn coarser(&self, algebra: &dyn Algebra) -> Result<Option<Coarser>> {
        let how = Coarsening { strong: STRONG, omega: 4.0 / 3.0 / self.smoothed.1 };
        let made = algebra.coarser(&self.matrix, &self.inverse_diagonal, how)?;
        if made.is_some() || self.matrix.get::<Matrix>().is_some() {
            return Ok(made);
        }
        let matrix = HOST.matrix(algebra.rows(&self.matrix)?)?;
        let inverse = HOST.vector(&algebra.read(&self.inverse_diagonal)?)?;
        let Some(made) = HOST.coarser(&matrix, &inverse, how)? else { return Ok(None) };
        let brought = |matrix: &Held| algebra.matrix(HOST.rows(matrix)?);
        Ok(Some(Coarser {
            prolongation: brought(&made.prolongation)?,
            restriction: brought(&made.restriction)?,
            matrix: brought(&made.matrix)?,
        }))
    }

    /// Sets the solution by Chebyshev's polynomial for the smoothed eigenvalues. The residual is that of zeros, and then lags behind by the last `step`.
    fn smooth_from_zero(&self, algebra: &dyn Algebra, scratch: &mut Scratch) -> Result<()> {
        let Scratch { residual, step, .. } = scratch;
        algebra.combine_scaled(self.middle().recip(), &self.inverse_diagonal, residual, 0.0, step)?;
        self.go_on(algebra, scratch, Smoothed::Nothing)
    }

    /// Improves the solution in the same way. Neither the solution nor the residual knows the last `step` yet; the residual then lags behind as well.
    fn smooth_on(&self, algebra: &dyn Algebra, scratch: &mut Scratch) -> Result<()> {
        self.smooth(algebra, scratch, (self.middle().recip(), 0.0), Smoothed::WithoutLast)?;
        self.go_on(algebra, scratch, Smoothed::WithLast)
    }

    /// The middle of the smoothed eigenvalues.
    fn middle(&self) -> f64 {
        (self.smoothed.1 + self.smoothed.0) / 2.0
    }

    /// All steps of a polynomial but the first, after which the solution is what is said.
    fn go_on(&self, algebra: &dyn Algebra, scratch: &mut Scratch, mut before: Smoothed) -> Result<()> {
        let half = (self.smoothed.1 - self.smoothed.0) / 2.0;
        let sigma = self.middle() / half;
        let mut rho = 1.0 / sigma;
        for _ in 1..DEGREE {
            let next = 1.0 / (2.0 * sigma - rho);
            self.smooth(algebra, scratch, (2.0 * next / half, next * rho), before)?;
            (rho, before) = (next, Smoothed::WithLast);
        }
        Ok(())
    }

    fn smooth(
        &self,
        algebra: &dyn Algebra,
        scratch: &mut Scratch,
        (alpha, beta): (f64, f64),
        before: Smoothed,
    ) -> Result<()> {
        let Scratch { solution, residual, step, next } = scratch;
        let (matrix, inverse_diagonal, last) = (&self.matrix, &self.inverse_diagonal, &*step);
        let how = Smoothing { matrix, inverse_diagonal, last, alpha, beta, before };
        algebra.smooth(how, residual, next, solution)?;
        mem::swap(step, next);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::conjugate_gradient::{self, Found};
    use super::super::host::Host;
    use super::*;

    fn held(matrix: Matrix) -> Held {
        Host.matrix(matrix.into_rows()).unwrap()
    }

    fn new(matrix: Matrix) -> Multigrid<'static> {
        Multigrid::new(&Host, held(matrix)).unwrap()
    }

    fn solve(multigrid: &mut Multigrid<'_>, b: &[f64], relative: f64) -> Found {
        conjugate_gradient::solve(multigrid, b, relative, 0.0).unwrap()
    }

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
        let mut multigrid = new(lattice(17, 1.0));
        assert!(multigrid.levels.len() > 1);
        let n = 17 * 17 * 17;
        let (x, y) = (noise(n, 1), noise(n, 2));
        let mut applied = |x: &[f64]| Host.read(multigrid.apply(&Host.vector(x).unwrap()).unwrap()).unwrap();
        let (bx, by) = (applied(&x), applied(&y));
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
                    let found = solve(&mut new(matrix.clone()), &b, 1e-10);
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
        let other = lattice(20, 0.5);
        let mut multigrid = new(matrix.clone()).renewed(held(other.clone())).unwrap();
        let found = solve(&mut multigrid, &b, 1e-6);
        // To the same bits where nothing was kept that is made anew.
        assert!(n >= MANY);
        let mut rested = new(matrix).resting(n).renewed(held(other.clone())).unwrap();
        assert_eq!(solve(&mut rested, &b, 1e-6).solution, found.solution);
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
        let mut multigrid = multigrid.renewed(held(beside(&half, &half))).unwrap();
        let unequal: Vec<f64> = (0..n).map(|i| if i < n / 2 { 1.0 } else { -1.0 }).collect();
        assert!(!solve(&mut multigrid, &unequal, 1e-6).is_solved);
        assert_eq!(multigrid.made_anew().unwrap().parts().unwrap().unwrap().1, 2);
    }

    #[test]
    fn parts_that_are_not_tied_are_found() {
        let (one, two) = (lattice(11, 1.0), lattice(9, 1.0));
        let n = one.rows();
        let both = beside(&one, &two);
        let (part, count) = new(both).parts().unwrap().unwrap();
        assert_eq!(count, 2);
        assert!(part.iter().enumerate().all(|(i, &part)| (part == 0) == (i < n)));
        assert!(new(one).parts().unwrap().is_none());
        // One that is tied to no other, of the finest level or of one that parts of a few unknowns come to, has no part in the coarsest matrix.
        let alone = Matrix::from_rows(1, || (), |_, (), columns, values| (columns.push(0), values.push(0.0)).1);
        for few in [alone, lattice(2, 1.0)] {
            let (n, all) = (lattice(11, 1.0).rows(), beside(&lattice(11, 1.0), &few));
            let (part, count) = new(all).parts().unwrap().unwrap();
            assert_eq!(count, 2);
            assert!(part.iter().enumerate().all(|(i, &part)| (part == 0) == (i < n)));
        }
    }
}
