//! Cells of equal volume.

use laguerre_core::diagram::Container;
use laguerre_core::{Backend, Error, ErrorKind, Output, PowerDiagram, Request, Result};
use std::ops::ControlFlow::Continue;

use super::StepReport;
use super::neighbors::Neighbors;
use crate::density::Density;
use crate::transport::{self, End, Solution};

/// Largest relative error of a volume that a step is content with.
pub const VOLUME_TOLERANCE: f64 = 1e-6;
/// The same while particles still settle.
const SETTLED: f64 = 1e-2;
/// What the volumes of another backend may differ by, as a share: they agree to 1e-12.
const OTHER_BACKEND: f64 = 1e-12;
/// Newton steps for one transport; a handful are usual.
const MOST_ITERATIONS: usize = 100;

/// Places for particles to begin at rest from: `rounds` times, cells of equal volume are found and every particle is moved to its
/// cell's barycenter (de Goes, Breeden, Ostromoukhov, Desbrun, "Blue noise through optimal transport", 2012).
///
/// # Errors
/// As [`transport::solve`].
pub fn settle(
    backend: &dyn Backend,
    container: &Container,
    positions: &[[f64; 3]],
    rounds: usize,
) -> Result<Vec<[f64; 3]>> {
    let mut positions = positions.to_vec();
    let mut diagram = within(PowerDiagram::new(&positions, &[])?, container)?;
    for _ in 0..rounds {
        let options = transport::Options { tolerance: SETTLED, second_moments: false, ..Default::default() };
        let solved = solved(backend, &mut diagram, &options)?;
        positions = solved.output.into_arrays().barycenter;
        diagram.set_sites(&positions, &solved.weights)?;
    }
    Ok(positions)
}

/// What the forces need of the cells of equal volume.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// `b_i`.
    pub(super) barycenters: Vec<[f64; 3]>,
    /// Their Laplacian.
    pub(super) neighbors: Neighbors,
    /// The cost of transport, `Σ_i ∫_cell i ‖x − p_i‖² dx`.
    pub(super) cost: f64,
    /// Largest relative error of a volume.
    pub(super) residual: f64,
}

impl Cells {
    /// Those of a diagram whose weights are known: the same as when they were found, for a diagram has the same output whenever it
    /// is computed.
    ///
    /// # Errors
    /// `Input` where the weights do not give cells of `volume`.
    pub(super) fn again(backend: &dyn Backend, diagram: &PowerDiagram, volume: f64) -> Result<Self> {
        let request = Request::moments().with_second_moments().with_weights_to_differ();
        let request = transport::with_laplacian(request, backend, diagram.positions().len(), None);
        let output = backend.evaluate(diagram, &request)?;
        let error = |v: &f64| (v / volume - 1.0).abs();
        if let Some(i) = output.volume().iter().position(|v| error(v) > VOLUME_TOLERANCE + OTHER_BACKEND) {
            return Err(Error::input(format!(
                "the weights are not those of these positions: particle {i} has volume {:e}, not {volume:e}; begin anew",
                output.volume()[i]
            )));
        }
        let cost = Density::Uniform.cost(diagram, &output);
        let residual = output.volume().iter().map(error).fold(0.0, f64::max);
        Self::of((backend, diagram), output, cost, residual)
    }

    fn of(
        (backend, diagram): (&dyn Backend, &PowerDiagram),
        output: Output,
        cost: Option<f64>,
        residual: f64,
    ) -> Result<Self> {
        let missing = || Error::new(ErrorKind::Device, "the backend gave no second moments though asked to");
        let cost = cost.ok_or_else(missing)?;
        let mut arrays = output.into_arrays();
        let neighbors = Neighbors::of(backend, diagram, &mut arrays)?;
        Ok(Self { barycenters: arrays.barycenter, neighbors, cost, residual })
    }
}

/// Changes the weights of a diagram for cells of equal volume, and returns these.
pub(super) fn equal_volumes(backend: &dyn Backend, diagram: &mut PowerDiagram) -> Result<(Cells, StepReport)> {
    let options = transport::Options {
        tolerance: VOLUME_TOLERANCE,
        most_iterations: MOST_ITERATIONS,
        laplacian: true,
        keeps_laplacian: true,
        ..transport::Options::default()
    };
    let solved = solved(backend, diagram, &options)?;
    let report = StepReport {
        time_step: 0.0,
        residual: solved.residual,
        iterations: solved.iterations.len().saturating_sub(1),
        evaluations: solved.iterations.iter().map(|i| i.diagram_evaluations).sum(),
    };
    if solved.residual.is_nan() || solved.residual > VOLUME_TOLERANCE {
        return Err(Error::input(format!(
            "volumes differ by {:.1e} of the mean after {} Newton steps; take smaller time steps or another epsilon",
            report.residual, report.iterations
        )));
    }
    Ok((Cells::of((backend, diagram), solved.output, solved.cost, report.residual)?, report))
}

/// Weights for equal volumes; half of the way there is of no use here.
fn solved(backend: &dyn Backend, diagram: &mut PowerDiagram, options: &transport::Options) -> Result<Solution> {
    let solved = transport::solve(backend, diagram, &[], options, &mut |_| Continue(()))?;
    match solved.end {
        End::Interrupted => Err(Error::new(ErrorKind::Interrupted, "interrupted before all volumes are equal")),
        _ => Ok(solved),
    }
}

/// Restricts a diagram to a container.
pub(super) fn within(diagram: PowerDiagram, container: &Container) -> Result<PowerDiagram> {
    match container {
        Container::Domain(domain) => Ok(diagram.restricted_to(domain)),
        Container::Box(lo, hi) => diagram.in_box(*lo, *hi),
    }
}

/// Checks that no particle is farther from a container's box than that is wide: springs keep those that are pulled back in time much
/// nearer.
///
/// # Errors
/// `Input`, naming the particle.
pub(super) fn check_places(container: &Container, positions: &[[f64; 3]]) -> Result<()> {
    let (lo, hi) = match container {
        Container::Domain(domain) => domain.bounding_box(),
        Container::Box(lo, hi) => (*lo, *hi),
    };
    let width = (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max);
    // Not a number is nowhere.
    let is_near = |p: &[f64; 3]| (0..3).all(|k| lo[k] - width <= p[k] && p[k] <= hi[k] + width);
    positions.iter().position(|p| !is_near(p)).map_or(Ok(()), |i| {
        Err(Error::input(format!(
            "particle {i} is thrown far out of the container: take smaller time steps, another epsilon or less gravity"
        )))
    })
}
