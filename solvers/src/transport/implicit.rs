//! Derivatives through the solve: of weights, barycenters and cost by positions and masses.
//!
//! The weights are those for which `m(w, p) = ν`. So `A δw = δν − ∂m/∂p δp`, with `A = ∂m/∂w` the Laplacian, symmetric, whose kernel are the
//! constants. For a function with the derivatives `u` by weights and `v` by barycenters let `z` solve `A z = u + (∂b/∂w)ᵀ v`. By masses it changes with
//! `z`, and by positions with `(∂b/∂p)ᵀ v − (∂m/∂p)ᵀ z`. The cost is a maximum over weights, and changes with `2 m_i (p_i − b_i)` by a position, with `w_i` by a mass.

use laguerre_core::algebra::Algebra;
use laguerre_core::rows::places;
use laguerre_core::{Backend, CellStatus, Error, ErrorKind, Output, PowerDiagram, Result};

use super::conjugate_gradient;
use super::host::HOST;
use super::laplacian::of_masses;
use super::multigrid::Multigrid;
use super::sparse::{Matrix, center, center_parts, norm};
use super::worthy_algebra;
use crate::density::Density;
use crate::derivatives::{self, Derivatives};
use crate::vectors::{for_each, map};

/// The system is solved to this part of its right-hand side; a solution that is left with more than `TOO_MUCH` of it is none.
const RELATIVE: f64 = 1e-12;
const TOO_MUCH: f64 = 1e-8;

/// What a function of a transport's results changes with (its gradient by each of them).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cotangent {
    /// By each weight; an empty list stands for zeros. Weights are told apart from their mean only.
    pub weights: Vec<f64>,
    /// By each barycenter (of mass), likewise.
    pub barycenters: Vec<[f64; 3]>,
    /// By the cost.
    pub cost: f64,
}

/// What it changes with by what was given.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gradient {
    /// By each position.
    pub positions: Vec<[f64; 3]>,
    /// By each mass, less their mean: masses change so that their sum stays.
    pub masses: Vec<f64>,
}

/// The vector-Jacobian product of a solved transport: `diagram` has the weights that [`solve`](super::solve) found. It takes one diagram, with the second
/// moments of its facets, and one linear system, which of many sites is solved in the memory of a backend that has one of its own.
///
/// These are derivatives as far as the weights are a solution, and where no facet is about to appear on a triangle of the surface, all over that triangle.
/// Where cells are in parts that do not touch, the weights of each are told apart from their own mean only.
///
/// # Errors
/// `Input` where there is not one number for each site, a cell is empty, the density is a function, or is not uniform and the function changes with barycenters, or the system is too
/// ill-conditioned to be solved. What [`Backend::evaluate`] says.
pub fn pull_back(
    backend: &dyn Backend,
    diagram: &PowerDiagram,
    density: &Density,
    cotangent: &Cotangent,
) -> Result<Gradient> {
    pull_back_kept_from(None, backend, diagram, density, cotangent)
}

/// The same, with the number of sites from which on the linear system stays with the backend, if not as many as it says.
#[doc(hidden)]
pub fn pull_back_kept_from(
    kept_from: Option<usize>,
    backend: &dyn Backend,
    diagram: &PowerDiagram,
    density: &Density,
    cotangent: &Cotangent,
) -> Result<Gradient> {
    derivatives::check(density)?;
    let n = diagram.positions().len();
    let output = backend.evaluate(diagram, &Derivatives::request(density))?;
    if let Some(i) = output.status().iter().position(|status| *status == CellStatus::Empty) {
        return Err(
            Error::input(format!("the cell of site {i} is empty: a transport that is solved has none")).of_site(i)
        );
    }
    let derivatives = Derivatives::new(diagram, &output, density)?;
    let mut by_weights = derivatives.pull_back_to_weights(&vec![0.0; n], &cotangent.barycenters)?;
    match cotangent.weights.len() {
        0 => {}
        length if length == n => for_each(&mut by_weights, |i, u| *u += cotangent.weights[i]),
        length => {
            return Err(Error::input(format!(
                "derivatives by weights: {length} of them for {n} sites: give one for each"
            )));
        }
    }
    let system = System::new(diagram, &output, density, &by_weights)?;
    let mut masses = match worthy_algebra(backend, n, kept_from) {
        // (What it has no memory for, the host has.)
        Some(algebra) => match system.solved(algebra) {
            Err(error) if error.kind() == ErrorKind::Device => system.solved(&HOST)?,
            found => found?,
        },
        None => system.solved(&HOST)?,
    };
    let less: Vec<f64> = masses.iter().map(|z| -z).collect();
    let (mut positions, _) = derivatives.pull_back(&less, &cotangent.barycenters)?;
    if cotangent.cost != 0.0 {
        let (cells, centers) =
            (density.masses(&output).unwrap_or_default(), density.centers(diagram, &output).unwrap_or_default());
        for_each(&mut positions, |i, by| {
            let p = diagram.positions()[i];
            (0..3).for_each(|k| by[k] += cotangent.cost * 2.0 * cells[i] * (p[k] - centers[i][k]));
        });
        for_each(&mut masses, |i, by| *by += cotangent.cost * diagram.weights()[i]);
    }
    center(&mut masses);
    Ok(Gradient { positions, masses })
}

/// `A z = b`, in the order along the curve.
struct System {
    matrix: Matrix,
    b: Vec<f64>,
    /// Where each site stands there.
    place: Vec<u32>,
}

impl System {
    fn new(diagram: &PowerDiagram, output: &Output, density: &Density, b: &[f64]) -> Result<Self> {
        let Some(facets) = output.facets() else {
            return Err(Error::input("derivatives: the cells are without facets"));
        };
        let sorted = diagram.prepare()?.sites;
        let order = sorted.order();
        let place = places(order, b.len());
        let matrix = of_masses(facets, density, None, order, &place, 1.0)?;
        Ok(Self { matrix, b: order.iter().map(|&i| b[i as usize]).collect(), place })
    }

    /// `A⁺ b`, in the caller's order.
    fn solved(&self, algebra: &dyn Algebra) -> Result<Vec<f64>> {
        let mut multigrid = Multigrid::new(algebra, algebra.matrix(self.matrix.clone().into_rows())?)?;
        // Of each part that touches no other the mean is its own.
        let parts = multigrid.parts()?;
        let center = |x: &mut [f64]| match &parts {
            Some((parts, count)) => center_parts(x, parts, *count),
            None => center(x),
        };
        let mut b = self.b.clone();
        center(&mut b);
        if !b.iter().all(|b| b.is_finite()) {
            // Whatever comes of what is no number is none.
            return Ok(vec![f64::NAN; self.place.len()]);
        }
        let largest = b.iter().fold(0.0, |largest: f64, b| largest.max(b.abs()));
        if largest == 0.0 {
            return Ok(vec![0.0; self.place.len()]);
        }
        // (Squares of 1e-160 are nothing, and of 1e160 infinite.)
        let unit = power_of_two_below(largest);
        for_each(&mut b, |_, b| *b /= unit);
        let mut solution = conjugate_gradient::solve(&mut multigrid, &b, RELATIVE, 0.0)?.solution;
        let left = left_over(&self.matrix, &solution, &b);
        if left > TOO_MUCH * norm(&b) {
            return Err(Error::input(format!(
                "derivatives: {:.1e} of the linear system is left: the cells' masses differ too much",
                left / norm(&b)
            )));
        }
        center(&mut solution);
        Ok(map(self.place.len(), |i| unit * solution[self.place[i] as usize]))
    }
}

/// The largest power of two that is not above a positive number; of one without all digits the least that has them.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits((x.to_bits() & f64::INFINITY.to_bits()).max(f64::MIN_POSITIVE.to_bits()))
}

/// `‖b − A x‖`.
fn left_over(matrix: &Matrix, x: &[f64], b: &[f64]) -> f64 {
    let mut left = b.to_vec();
    matrix.apply(x, &mut left, |_, ax, b| b - ax);
    norm(&left)
}
