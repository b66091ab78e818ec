//! Semi-discrete optimal transport: weights such that each cell has the mass asked for.
//!
//! The weights are the maximum of a concave function (Aurenhammer, Hoffmann, Aronov 1998) whose gradient is `target − mass` and whose
//! second derivative is minus the Laplacian of the cells (`laplacian.rs`). It is found by the damped Newton of Kitagawa, Mérigot, Thibert, "Convergence
//! of a Newton algorithm for semi-discrete optimal transport", 2019: a step is shortened until no cell's mass falls below a bound and
//! the error falls enough, which it does for some length wherever all cells have mass, so that the error goes to zero, at the end
//! quadratically. On the way there, a number of steps may be limited facet by facet instead (`limited.rs`).

mod aggregation;
mod bridge;
mod conjugate_gradient;
mod dense;
mod host;
mod implicit;
mod laplacian;
mod levels;
mod limited;
mod mend;
mod multigrid;
mod newton;
mod sparse;
mod start;
mod system;
mod tangents;
mod worst;

use std::ops::ControlFlow;
use std::time::Instant;

use laguerre_core::algebra::{Algebra, Held};
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, Error, ErrorKind, Laplacian, Output, PowerDiagram, Request, Result};

use crate::density::Density;
use newton::Problem;

pub(crate) use host::HOST;
#[doc(hidden)]
pub use implicit::pull_back_kept_from;
pub use implicit::{Cotangent, Gradient, pull_back};
pub use worst::{Cause, Worst};

/// How to solve.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Options {
    /// What is transported.
    pub density: Density,
    /// Largest `|mass_i / target_i − 1|` that is good enough.
    pub tolerance: f64,
    /// Newton steps at most.
    pub most_iterations: usize,
    /// Whether the output of the last evaluation has second moments, which [`Solution::cost`] needs; where it was interrupted those of a device may be missing.
    pub second_moments: bool,
    /// Whether it has facets, which takes one more diagram.
    pub facets: bool,
    /// Whether it has the Laplacian.
    pub laplacian: bool,
    /// Whether it is left where it is kept ([`Output::kept`]) where that is not with the host.
    pub(crate) keeps_laplacian: bool,
    /// Sites from which on linear systems stay in the memory of a backend that has one of its own, if not as many as it says.
    #[doc(hidden)]
    pub kept_from: Option<usize>,
    /// Whether masses whose sum is not the domain's are scaled to it, not refused.
    pub normalize: bool,
}

/// Fewer sites have their second moments with each diagram, where these are asked for: to load the builds that a diagram without them takes costs more, 0.02 s (one
/// NVIDIA H200), and a first call ever compiles fewer.
const MOMENTS_APART: usize = 1 << 16;

impl Default for Options {
    fn default() -> Self {
        Self {
            density: Density::Uniform,
            tolerance: 1e-9,
            most_iterations: 100,
            second_moments: true,
            facets: false,
            laplacian: false,
            keeps_laplacian: false,
            kept_from: None,
            normalize: false,
        }
    }
}

impl Options {
    /// The same of another density.
    #[must_use]
    pub fn of(self, density: Density) -> Self {
        Self { density, ..self }
    }

    /// The same with another number of steps and bound on the residual.
    #[must_use]
    pub fn until(self, most_iterations: usize, tolerance: f64) -> Self {
        Self { most_iterations, tolerance, ..self }
    }

    /// The same with the facets of the cells found.
    #[must_use]
    pub fn with_facets(self) -> Self {
        Self { facets: true, ..self }
    }

    /// The same without the second moments of the last evaluation, and so without the cost.
    #[must_use]
    pub fn without_cost(self) -> Self {
        Self { second_moments: false, ..self }
    }

    /// The same for masses that are known up to a factor: they are scaled to sum to the domain's.
    #[must_use]
    pub fn normalized(self) -> Self {
        Self { normalize: true, ..self }
    }
}

/// One Newton step; number 0 is the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Iteration {
    /// 0 for the start, then the number of the step.
    pub number: usize,
    /// Largest `|mass_i / target_i − 1|` after it.
    pub residual: f64,
    /// Which part of the Newton step, or of one whose facets go less far, was gone; 1 is all of it.
    pub step: f64,
    /// Diagrams of all sites that it took; a start may take some of fewer sites besides.
    pub diagram_evaluations: usize,
    /// Iterations of the conjugate gradient.
    pub linear_iterations: usize,
    /// Seconds for the diagrams.
    pub diagram_seconds: f64,
    /// Seconds for everything else.
    pub solver_seconds: f64,
}

/// How the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum End {
    /// The residual is within the tolerance.
    Converged,
    /// There was no shorter step that made the error smaller: what is left is rounding, or the targets are out of reach ([`Solution::worst`]).
    Stalled,
    /// The number of steps was not enough.
    MostIterations,
    /// The backend said that someone wants this to stop.
    Interrupted,
}

/// Weights, and the cells that they make.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solution {
    /// One for each site (length²); their mean is 0.
    pub weights: Vec<f64>,
    /// The diagram of these weights, with facets, the Laplacian and second moments where the options ask for them; where [`End::Interrupted`] without the first two, which may be used up by then, and on a device without the third.
    pub output: Output,
    /// Mass of each cell.
    pub masses: Vec<f64>,
    /// The start and each Newton step.
    pub iterations: Vec<Iteration>,
    /// Largest `|mass_i / target_i − 1|`.
    pub residual: f64,
    /// The cell whose residual that is, with what stands in its way; where cells that touch no others lack mass, the worst of those.
    pub worst: Worst,
    /// `Σ_i ∫_i ρ(x) ‖x − p_i‖² dx` (mass·length²), the transport cost; `None` where the options did not ask for second moments,
    /// and where it was interrupted with a density that takes another diagram, or on a device.
    pub cost: Option<f64>,
    /// How the iteration ended.
    pub end: End,
}

/// Finds weights for which the cell of each site of `diagram` has the mass asked for in `masses` (an empty slice stands for all equal).
/// The diagram's own weights are the first; where they leave a tenth of the cells tiny or empty, others are taken. Afterwards it has the weights found,
/// converged or not. `on_iteration` sees each step when it is done.
///
/// The result does not depend on the number of threads.
///
/// Masses of a density that is a function ([`Density::function`]) are those of a quadrature, whose sum differs a little from diagram to diagram: what is asked for are
/// shares of it, and the residual that of shares. Newton's matrix is not exact then, so that the end is not quadratic: steps divide
/// the error by a factor, a large one where cells are smaller than the length over which the density changes. Where the rule's degree is too low for
/// that, masses jump by the rule's error, and it is [`End::Stalled`] with residuals of that size: give a higher degree. It computes the last diagram six times more
/// for centres of mass and cost, unless [`Options::without_cost`].
///
/// `Break` from `on_iteration`, or a watched backend that says [`Interrupted`](laguerre_core::ErrorKind::Interrupted), ends it, with the weights of the last step.
///
/// # Errors
/// `Interrupted` where there are not even first weights; `Input` where the tolerance is no number from 0, the masses are not positive, or do not sum to the domain's (by more than the tolerance, where the options do not
/// say that they are to be scaled; by less they are), where two sites coincide, the density is not positive wherever it is evaluated, or no first weights without empty cells are found. What
/// [`Backend::evaluate`] says.
pub fn solve(
    backend: &dyn Backend,
    diagram: &mut PowerDiagram,
    masses: &[f64],
    options: &Options,
    on_iteration: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
) -> Result<Solution> {
    if options.tolerance.is_nan() || options.tolerance < 0.0 {
        return Err(Error::input(format!("tolerance {}: a number from 0 is needed", options.tolerance)));
    }
    let begin = Instant::now();
    let masses = targets(backend, diagram, masses, options)?;
    let mut problem = Problem::new(backend, diagram, masses, options)?;
    let state = start::first(&mut problem)?;
    let mut iterations = Vec::new();
    let (mut state, mut end) = problem.run(state, begin, options.most_iterations, &mut |iteration| {
        iterations.push(*iteration);
        on_iteration(iteration)
    })?;
    if end != End::Interrupted {
        match problem.complete(&mut state, end, options) {
            Err(error) if error.kind() == ErrorKind::Interrupted => end = End::Interrupted,
            other => other?,
        }
    }
    let worst = Worst::new(&problem, &state, end);
    if !options.facets {
        state.output.take_facets();
    }
    if !options.laplacian || end == End::Interrupted {
        state.output.take_laplacian();
    }
    let density = &options.density;
    diagram.set_weights(&state.weights)?;
    let found = density.masses(&state.output);
    let found = found.unwrap_or_else(|| state.masses.iter().map(|mass| mass / state.scale).collect());
    let cost = match end {
        End::Interrupted => density.cost(diagram, &state.output),
        _ => match density.transport_cost(backend, diagram, &state.output) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {
                end = End::Interrupted;
                None
            }
            other => other?,
        },
    };
    Ok(Solution {
        cost,
        weights: state.weights,
        output: state.output,
        masses: found,
        iterations,
        residual: state.residual,
        worst,
        end,
    })
}

/// The masses that [`solve`] aims at: those asked for, checked, and scaled to sum to the domain's ([`Density::total`], which takes an evaluation where the density is
/// a function); all equal for an empty slice.
///
/// # Errors
/// What [`Density::total`] says;
/// `Input` where the density is not positive, or the masses are not one for each site, not positive, or do not sum to the domain's and
/// neither the options say that they are to be scaled nor the density is a function, of whose quadrature masses are shares.
pub fn targets(backend: &dyn Backend, diagram: &PowerDiagram, masses: &[f64], options: &Options) -> Result<Vec<f64>> {
    let container = diagram.container()?;
    options.density.check(&container)?;
    let (sites, total) = (diagram.positions().len(), options.density.total(backend, diagram)?);
    if masses.is_empty() {
        return Ok(vec![total / sites as f64; sites]);
    }
    if masses.len() != sites {
        return Err(Error::input(format!("{} masses for {sites} sites: give one for each", masses.len())));
    }
    if let Some(i) = masses.iter().position(|m| !(*m > 0.0 && m.is_finite())) {
        return Err(
            Error::input(format!("the mass of site {i} is {}: masses must be positive numbers", masses[i])).of_site(i)
        );
    }
    let mut asked = Sum::default();
    asked.extend(masses.iter().copied());
    let (sum, scale) = (asked.total(), total / asked.total());
    let scaled: Vec<f64> = masses.iter().map(|m| m * scale).collect();
    if !scale.is_normal() || scaled.contains(&0.0) {
        return Err(Error::input(format!(
            "the masses sum to {sum:?}, but the domain has {total:?}: no double is the factor between; give masses of its order"
        )));
    }
    // Scaling changes what each cell is asked for by as much, no more than the tolerance leaves open.
    let are_shares = options.normalize || matches!(options.density, Density::Function(_));
    if !are_shares && (scale - 1.0).abs() > options.tolerance {
        return Err(Error::input(format!(
            "the masses sum to {sum:?}, but the domain has {total:?}: multiply each by {scale:?}, or have them normalized"
        )));
    }
    Ok(scaled)
}

/// What the diagram of each step is asked for. Where its Laplacian is kept, second moments of many sites come with the last ones alone (`newton.rs`).
fn request(options: &Options, backend: &dyn Backend, sites: usize) -> Request {
    let asked = Request::moments().with_weights_to_differ();
    let request = match options.density {
        Density::Uniform => with_laplacian(asked, backend, sites, options.kept_from),
        Density::Linear { .. } => asked.with_facets(),
        Density::Function(_) => asked.with_facet_second_moments(),
    };
    let are_apart = request.keeps_laplacian() && sites >= MOMENTS_APART;
    if options.second_moments && !are_apart { request.with_second_moments() } else { request }
}

/// The same request with the Laplacian, which a backend keeps that is to do the linear algebra of so many sites.
pub(crate) fn with_laplacian(
    request: Request,
    backend: &dyn Backend,
    sites: usize,
    kept_from: Option<usize>,
) -> Request {
    if worthy_algebra(backend, sites, kept_from).is_some() {
        request.with_laplacian_kept()
    } else {
        request.with_laplacian()
    }
}

/// The algebra of a backend that is to do that of so many sites: from `kept_from` on, if that is given.
pub(crate) fn worthy_algebra(backend: &dyn Backend, sites: usize, kept_from: Option<usize>) -> Option<&dyn Algebra> {
    backend.algebra().filter(|algebra| sites >= kept_from.unwrap_or_else(|| algebra.worth_from()))
}

/// A Laplacian, times `scale`, with its diagonal, in the host's memory.
pub(crate) fn host_matrix(laplacian: &Laplacian, scale: f64) -> Result<Held> {
    HOST.matrix(laplacian::of_volumes(laplacian, 0.5 / scale).into_rows())
}
