//! Sparse linear algebra where a backend's memory is.

use std::any::Any;
use std::fmt::{self, Debug, Formatter};

use crate::rows::Rows;
use crate::{Error, ErrorKind, Laplacian, Result};

/// A vector or a matrix in some backend's memory.
pub struct Held(Box<dyn Any + Send + Sync>);

impl Debug for Held {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("Held")
    }
}

impl Held {
    /// Holds it.
    pub fn new<T: Any + Send + Sync>(what: T) -> Self {
        Self(Box::new(what))
    }

    /// What is held, if it is of this type: to its own algebra it is.
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.0.downcast_ref()
    }

    /// The same for an algebra that is given its own alone.
    ///
    /// # Errors
    /// `Device` where it is another's.
    pub fn own<T: Any>(&self) -> Result<&T> {
        self.get().ok_or_else(strange)
    }

    /// The same, to be changed.
    ///
    /// # Errors
    /// `Device` where it is another's.
    pub fn own_mut<T: Any>(&mut self) -> Result<&mut T> {
        self.0.downcast_mut().ok_or_else(strange)
    }
}

fn strange() -> Error {
    Error::new(ErrorKind::Device, "a vector or matrix is in the memory of another backend")
}

/// The Laplacian of an evaluation that its backend keeps to itself: what an output has of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    order: Vec<u32>,
    evaluation: u64,
}

impl Kept {
    /// Of an evaluation that has a number, which no other in the process has. For backends.
    #[doc(hidden)]
    pub fn new(order: Vec<u32>, evaluation: u64) -> Self {
        Self { order, evaluation }
    }

    /// The site that each row is of.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Which evaluation it was: the next one of its backend takes its place.
    pub fn evaluation(&self) -> u64 {
        self.evaluation
    }
}

/// How unknowns are put together to the next coarser level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coarsening {
    /// `|a_ij| ≥ strong·√(a_ii a_jj)` makes j a strong neighbor of i, where `a_ij` is negative.
    pub strong: f64,
    /// How far piecewise constant vectors are smoothed: by `ω D⁻¹ A` times them, of `A` the strong entries.
    pub omega: f64,
}

/// The next coarser level of a matrix `A`: `P`, `Pᵀ` and `Pᵀ A P`, whose rows sum to zero.
pub struct Coarser {
    /// `P`.
    pub prolongation: Held,
    /// `Pᵀ`.
    pub restriction: Held,
    /// `Pᵀ A P`.
    pub matrix: Held,
}

/// What `x` is before a step of a smoother.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothed {
    /// With the last step.
    WithLast,
    /// Without it.
    WithoutLast,
    /// Nothing, whatever stands there: the last step was the first.
    Nothing,
}

/// A step of a smoother of `A x = b` (Chebyshev's semi-iteration).
#[derive(Clone, Copy, Debug)]
pub struct Smoothing<'a> {
    /// `A`.
    pub matrix: &'a Held,
    /// `D⁻¹`, of `A`'s diagonal.
    pub inverse_diagonal: &'a Held,
    /// The step before, `s`, which the residual does not know yet.
    pub last: &'a Held,
    /// α: of `D⁻¹ r` in the step.
    pub alpha: f64,
    /// β: of `s` in it.
    pub beta: f64,
    /// What x is.
    pub before: Smoothed,
}

/// Numbers of a row's cell that [`Algebra::rises_too_far`], [`Algebra::stiffened`] and [`Algebra::parted`] read: its site, weight, barycenter, and the cube
/// root of its volume. Where the origin is does not matter.
pub const CELL: usize = 8;

/// Vectors and sparse matrices in a backend's memory, and what an iterative solver does with them. Everything has the same bits whenever it is
/// computed.
///
/// # Errors
/// Those of the device, `Device` for what another algebra holds, and `Input` for lengths that do not fit each other.
pub trait Algebra: Send + Sync {
    /// Rows from which on a matrix is better here than in the host's memory, in which solvers compute as well.
    fn worth_from(&self) -> usize {
        0
    }

    /// A vector of these numbers.
    fn vector(&self, values: &[f64]) -> Result<Held>;

    /// A vector of so many zeros.
    fn zeros(&self, length: usize) -> Result<Held> {
        self.vector(&vec![0.0; length])
    }

    /// The numbers of a vector.
    fn read(&self, x: &Held) -> Result<Vec<f64>>;

    /// Other numbers for a vector.
    fn write(&self, values: &[f64], x: &mut Held) -> Result<()>;

    /// A matrix.
    fn matrix(&self, rows: Rows) -> Result<Held>;

    /// The rows of a matrix.
    fn rows(&self, a: &Held) -> Result<Rows>;

    /// How many they are.
    fn row_count(&self, a: &Held) -> Result<usize> {
        Ok(self.rows(a)?.0.len().saturating_sub(1))
    }

    /// The next coarser level of a Laplacian, by smoothed aggregation; `None` where the caller has to make it of its rows: where there is none, and where it
    /// is not made here.
    fn coarser(&self, _a: &Held, _inverse_diagonal: &Held, _how: Coarsening) -> Result<Option<Coarser>> {
        Ok(None)
    }

    /// The Laplacian that was kept, times `scale`, as a matrix: the diagonal first in each row, then `−scale·A_ij / d_ij` of facets with some area. (With a half it is `∂V/∂w`.)
    /// `None` where it is not there any more.
    fn laplacian(&self, kept: &Kept, scale: f64) -> Result<Option<Held>>;

    /// The same as it would have come back.
    fn read_laplacian(&self, kept: &Kept) -> Result<Option<Laplacian>>;

    /// The cells of the evaluation whose Laplacian was kept, [`CELL`] numbers a row, volumes being over `density`; `None` where they are not there any more.
    fn cells(&self, kept: &Kept, density: f64) -> Result<Option<Held>>;

    /// `y = A x`. Where y has three numbers a row so has x, and it is of each of the three.
    fn multiply(&self, a: &Held, x: &Held, y: &mut Held) -> Result<()>;

    /// `y ← y − A x`.
    fn subtract(&self, a: &Held, x: &Held, y: &mut Held) -> Result<()>;

    /// `y ← α x + β y`.
    fn combine(&self, alpha: f64, x: &Held, beta: f64, y: &mut Held) -> Result<()>;

    /// `y_i ← α d_i x_i + β y_i`.
    fn combine_scaled(&self, alpha: f64, d: &Held, x: &Held, beta: f64, y: &mut Held) -> Result<()>;

    /// `r ← r − A s`, `t ← α D⁻¹ r + β s`, and `x ← x + t`, `(x + s) + t` or `s + t`, by what x is.
    fn smooth(&self, how: Smoothing<'_>, r: &mut Held, t: &mut Held, x: &mut Held) -> Result<()>;

    /// `x · y`.
    fn dot(&self, x: &Held, y: &Held) -> Result<f64>;

    /// Subtracts the mean, unless that is but rounding: what is centered stays as it is. Returns `x · x` of the result.
    fn center(&self, x: &mut Held) -> Result<f64>;

    /// The inverse of a matrix's diagonal, 0 where that is not positive.
    fn inverse_diagonal(&self, a: &Held) -> Result<Held>;

    /// Whether `|x_i| ≤ factor·bound_i` for all i.
    fn is_within(&self, x: &Held, factor: f64, bound: &Held) -> Result<bool>;

    /// Whether for some entry (i, j) of `a` site i rises above j, by `x_i − x_j`, so far that their facet goes into the cell of j by more than `share` of the
    /// way to the barycenter, or of `flattest` of that cell's size where it is flatter. `cells` has [`CELL`] numbers a row.
    fn rises_too_far(&self, a: &Held, x: &Held, cells: &Held, share: f64, flattest: f64) -> Result<bool>;

    /// `a` with each entry (i, j) larger by as much as `|x_i − x_j|` is larger than [`Self::rises_too_far`] allows, and diagonal entries, which come first in
    /// their rows, such that rows sum to 0.
    fn stiffened(&self, a: &Held, x: &Held, cells: &Held, share: f64, flattest: f64) -> Result<Held>;

    /// By how much each weight has to change for the barycenters of the cells that have entries of `a` in common to be on their own sides of the bisector, `depth`
    /// away from it, or as far as half of what there is between them: the sums of [`part`] over the rows' entries. `cells` has [`CELL`] numbers a row.
    fn parted(&self, a: &Held, cells: &Held, depth: f64) -> Result<Held>;
}

/// Whether lengths fit each other. (Kernels are told them, and trust them.) For backends.
///
/// # Errors
/// `Input` where they do not.
#[doc(hidden)]
pub fn check_lengths(fit: bool) -> Result<()> {
    if fit { Ok(()) } else { Err(Error::input("linear algebra: the lengths of vectors and matrices do not fit")) }
}

/// The distance of two cells' sites, and from the first along the way to the other the plane where their powers are equal and the barycenter of either cell.
fn between(own: &[f64], other: &[f64]) -> [f64; 4] {
    let way: [f64; 3] = std::array::from_fn(|k| other[k] - own[k]);
    let along = |to: [f64; 3]| to[0] * way[0] + to[1] * way[1] + to[2] * way[2];
    let distance = along(way).sqrt();
    let plane = (distance * distance + (own[3] - other[3])) / (2.0 * distance);
    let center = |cell: &[f64]| along(std::array::from_fn(|k| cell[4 + k] - own[k])) / distance;
    [distance, plane, center(own), center(other)]
}

/// The weight by which one site may rise above another, of [`Algebra::rises_too_far`]: from the numbers of both cells. (The plane of equal powers goes by the
/// weights' difference over twice the distance.)
pub fn rise(own: &[f64], other: &[f64], share: f64, flattest: f64) -> f64 {
    let [distance, plane, _, center] = between(own, other);
    2.0 * distance * share * (center - plane).max(flattest * other[7])
}

/// What one of two cells adds to its weight, of [`Algebra::parted`], half of what the plane between them has to go: from the numbers of both cells. The other
/// adds as much less.
pub fn part(own: &[f64], other: &[f64], depth: f64) -> f64 {
    let [distance, plane, mine, theirs] = between(own, other);
    let (mine, theirs) = (plane - mine, theirs - plane);
    let wanted = depth.min((mine + theirs) / 2.0);
    distance * ((wanted - mine).max(0.0) - (wanted - theirs).max(0.0))
}
