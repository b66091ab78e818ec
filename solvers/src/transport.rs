//! Semi-discrete optimal transport: weights such that each cell has the mass asked for.
//!
//! The weights are the maximum of a concave function (Aurenhammer, Hoffmann, Aronov 1998) whose gradient is `target − mass` and whose
//! second derivative is minus the Laplacian of the cells (`laplacian.rs`). It is found by the damped Newton of Kitagawa, Mérigot, Thibert, "Convergence
//! of a Newton algorithm for semi-discrete optimal transport", 2019: a step is shortened until no cell's mass falls below a bound and
//! the error falls enough, which it does for some length wherever all cells have mass, so that the error goes to zero, at the end
//! quadratically. On the way there, a number of steps may be limited facet by facet instead (`limited.rs`).

mod bridge;
mod conjugate_gradient;
mod dense;
mod laplacian;
mod limited;
mod multigrid;
mod sparse;
mod start;
mod system;

use std::ops::ControlFlow;
use std::time::Instant;

use laguerre_core::summation::Sum;
use laguerre_core::{Backend, Error, ErrorKind, Output, PowerDiagram, Request, Result};

use crate::density::Density;
use crate::vectors::{for_each, sum};
use laplacian::{laplacian, limits};
use multigrid::Multigrid;
use sparse::center;
use system::System;

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
    /// Whether the output of the last evaluation has second moments, which [`Solution::cost`] needs.
    pub second_moments: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { density: Density::Uniform, tolerance: 1e-9, most_iterations: 100, second_moments: true }
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

    /// The same without the second moments of the last evaluation, and so without the cost.
    #[must_use]
    pub fn without_cost(self) -> Self {
        Self { second_moments: false, ..self }
    }
}

/// One Newton step; number 0 is the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Iteration {
    /// Number of the step, from 1.
    pub number: usize,
    /// Largest `|mass_i / target_i − 1|` after it.
    pub residual: f64,
    /// Which part of the Newton step, or of one whose facets go less far, was gone; 1 is all of it.
    pub step: f64,
    /// Diagrams that it took.
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
pub enum End {
    /// The residual is within the tolerance.
    Converged,
    /// There was no shorter step that made the error smaller: what is left is rounding, or the targets are out of reach.
    Stalled,
    /// The number of steps was not enough.
    MostIterations,
    /// The backend said that someone wants this to stop.
    Interrupted,
}

/// Weights, and the cells that they make.
#[derive(Clone, Debug)]
pub struct Solution {
    /// One for each site (length²); their mean is 0.
    pub weights: Vec<f64>,
    /// The diagram of these weights, with facets; without where [`End::Interrupted`], for they may be used up by then.
    pub output: Output,
    /// Mass of each cell.
    pub masses: Vec<f64>,
    /// The start and each Newton step.
    pub iterations: Vec<Iteration>,
    /// Largest `|mass_i / target_i − 1|`.
    pub residual: f64,
    /// `Σ_i ∫_i ρ(x) ‖x − p_i‖² dx` (mass·length²), the transport cost; `None` where the options did not ask for second moments,
    /// and where it was interrupted with a density that takes another diagram.
    pub cost: Option<f64>,
    /// How the iteration ended.
    pub end: End,
}

/// Finds weights for which the cell of each site of `diagram` has the mass asked for in `masses` (an empty slice stands for all equal).
/// The diagram's own weights are the first; where they leave a cell empty, others are taken. Afterwards it has the weights found,
/// converged or not. `on_iteration` sees each step when it is done.
///
/// The result does not depend on the number of threads.
///
/// `Break` from `on_iteration`, or a watched backend that says [`ErrorKind::Interrupted`], ends it, with the weights of the last step.
///
/// # Errors
/// `Interrupted` where there are not even first weights; `Input` where the tolerance is no number from 0, the masses are not positive, or do not sum to the domain's (by more than the tolerance; by less they are scaled), where
/// two sites coincide, the density is not positive, or no first weights without empty cells are found. What
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
    let mut problem = Problem::new(backend, diagram, masses, options)?;
    let mut state = start::first(&mut problem)?;
    problem.bound = state.least.min(problem.least_target) / 2.0;
    let mut iterations = Vec::new();
    let mut iteration = Iteration { residual: state.residual, ..problem.take_costs(begin) };
    let end = loop {
        let goes_on = on_iteration(&iteration).is_continue();
        iterations.push(iteration);
        if state.residual <= options.tolerance {
            break End::Converged;
        }
        if !goes_on {
            break End::Interrupted;
        }
        if iteration.number == options.most_iterations {
            break End::MostIterations;
        }
        let begin = Instant::now();
        let (step, linear_iterations, next) = match problem.next(&mut state) {
            Ok(Some(next)) => next,
            Ok(None) => break End::Stalled,
            Err(error) if error.kind() == ErrorKind::Interrupted => break End::Interrupted,
            Err(error) => return Err(error),
        };
        state = next;
        let number = iteration.number + 1;
        iteration =
            Iteration { number, residual: state.residual, step, linear_iterations, ..problem.take_costs(begin) };
    };
    let (density, unit, positions) = (options.density, problem.unit, std::mem::take(&mut problem.positions));
    diagram.set_sites(&positions, &state.weights)?;
    if state.output.facets().is_none() && end != End::Interrupted {
        // A stalled step has taken them apart.
        state.output = backend.evaluate(diagram, &problem_request(options))?;
    }
    let cost = match end {
        End::Interrupted => density.cost(diagram.positions(), &state.output),
        _ => density.transport_cost(backend, diagram, &state.output)?,
    };
    Ok(Solution {
        cost,
        weights: state.weights,
        output: state.output,
        masses: state.masses.iter().map(|mass| mass * unit).collect(),
        iterations,
        residual: state.residual,
        end,
    })
}

/// The masses that [`solve`] aims at: those asked for, checked, and scaled to sum to the domain's; all equal for an empty slice.
///
/// # Errors
/// `Input` where the density is not positive, or the masses are not one for each site, not positive, or do not sum to the domain's.
pub fn targets(diagram: &PowerDiagram, masses: &[f64], options: &Options) -> Result<Vec<f64>> {
    let container = diagram.container()?;
    options.density.check(&container)?;
    let (sites, total) = (diagram.positions().len(), options.density.total(&container));
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
    let scale = total / asked.total();
    // Scaling changes what each cell is asked for by as much, no more than the tolerance leaves open.
    let is_near = (scale - 1.0).abs() <= options.tolerance;
    if !is_near {
        return Err(Error::input(format!(
            "the masses sum to {:?}, but the domain has {total:?}: multiply each by {scale:?}",
            asked.total()
        )));
    }
    Ok(masses.iter().map(|m| m * scale).collect())
}

fn problem_request(options: &Options) -> Request {
    let request = Request::moments().with_facets();
    if options.second_moments { request.with_second_moments() } else { request }
}

/// Weights, and what they give.
struct State {
    weights: Vec<f64>,
    output: Output,
    masses: Vec<f64>,
    /// Least of the masses.
    least: f64,
    /// Largest `|mass / target − 1|`.
    residual: f64,
    /// `‖target − mass‖`.
    error: f64,
}

/// Where to go from a state.
enum Direction {
    Newton(System),
    /// The cells fall into parts that do not touch, and this (true for each of its sites) has to gain mass from the others.
    Apart(Vec<bool>),
}

/// What does not change from step to step.
struct Problem<'a> {
    backend: &'a dyn Backend,
    diagram: &'a mut PowerDiagram,
    density: Density,
    tolerance: f64,
    request: Request,
    positions: Vec<[f64; 3]>,
    targets: Vec<f64>,
    least_target: f64,
    /// The power of two near the mean target: masses here are in units of it, so that their squares are in range.
    unit: f64,
    /// No cell's mass may fall below this, half of what the first state or the targets had; 0 until there is a first state.
    bound: f64,
    /// The sites so that neighbours in space are neighbours in memory, and where each stands there.
    order: Vec<u32>,
    place: Vec<u32>,
    /// The last step that was taken.
    step: f64,
    /// Limited steps that were tried.
    limited_steps: usize,
    evaluations: usize,
    seconds: f64,
}

/// A Newton step is not made shorter than this, nor so short that no weight changes by more than a rounding of the largest.
const SHORTEST_STEP: f64 = 1.0 / (1_u64 << 24) as f64;
/// The linear system is solved to this part of its right-hand side at least (with 0.1 steps have to be shorter); closer to the end to the
/// error's own relative size, which leaves convergence quadratic.
const LOOSEST: f64 = 0.01;

impl<'a> Problem<'a> {
    fn new(backend: &'a dyn Backend, diagram: &'a mut PowerDiagram, masses: &[f64], options: &Options) -> Result<Self> {
        let mut targets = targets(diagram, masses, options)?;
        let unit = (targets.iter().sum::<f64>() / targets.len() as f64).log2().round().exp2();
        targets.iter_mut().for_each(|target| *target /= unit);
        let positions = diagram.positions().to_vec();
        let sorted = diagram.prepare()?.sites;
        start::check_coincident(&positions, &sorted)?;
        let order = sorted.order().to_vec();
        let mut place = vec![0; order.len()];
        for (row, &site) in order.iter().enumerate() {
            place[site as usize] = row as u32;
        }
        Ok(Self {
            backend,
            diagram,
            density: options.density,
            tolerance: options.tolerance,
            request: problem_request(options),
            least_target: targets.iter().copied().fold(f64::INFINITY, f64::min),
            positions,
            targets,
            unit,
            bound: 0.0,
            order,
            place,
            step: 1.0,
            limited_steps: 0,
            evaluations: 0,
            seconds: 0.0,
        })
    }

    /// The state after a step from `state`, which loses its facets, with the part of the step that leads there and the iterations that it took;
    /// `None` where no step makes the error smaller.
    fn next(&mut self, state: &mut State) -> Result<Option<(f64, usize, State)>> {
        match self.direction(state)? {
            Direction::Newton(system) => self.advance(state, &system),
            Direction::Apart(part) => Ok(bridge::bridge(self, state, &part)?.map(|next| (0.0, 0, next))),
        }
    }

    /// The diagram of some weights.
    fn evaluate(&mut self, weights: Vec<f64>) -> Result<State> {
        let begin = Instant::now();
        self.diagram.set_sites(&self.positions, &weights)?;
        let output = self.backend.evaluate(self.diagram, &self.request)?;
        self.seconds += begin.elapsed().as_secs_f64();
        self.evaluations += 1;
        let mut masses = self.density.masses(&output);
        masses.iter_mut().for_each(|mass| *mass /= self.unit);
        let least = masses.iter().copied().fold(f64::INFINITY, f64::min);
        let each = || masses.iter().zip(&self.targets);
        let residual = each().map(|(m, t)| (m / t - 1.0).abs()).fold(0.0, f64::max);
        let error = sum(masses.len(), |i| (self.targets[i] - masses[i]).powi(2)).sqrt();
        Ok(State { weights, output, masses, least, residual, error })
    }

    /// Where to go from a state, whose facets are taken out to make room.
    fn direction(&self, state: &mut State) -> Result<Direction> {
        let Some(facets) = state.output.take_facets() else {
            return Err(Error::new(ErrorKind::Device, "the backend gave no facets though asked to"));
        };
        let matrix = laplacian(&facets, &self.density, &self.order, &self.place, self.unit);
        let limit = |site: usize, other: usize, k: usize| {
            limited::limit(self, state, site, other, facets.barycenter()[k], facets.distance()[k])
        };
        let limits = limits(&facets, &self.density, &self.order, &self.place, limit);
        drop(facets);
        let multigrid = Multigrid::new(matrix);
        let targets: Vec<f64> = self.order.iter().map(|&i| self.targets[i as usize]).collect();
        let (mut missing, mut slope) = self.aims(state, &targets);
        if let Some((parts, count)) = multigrid.parts() {
            let exact: Vec<f64> =
                self.order.iter().zip(&targets).map(|(&i, target)| target - state.masses[i as usize]).collect();
            let (mut lacking, mut asked, mut rows) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
            for (row, &part) in parts.iter().enumerate() {
                lacking[part as usize] += exact[row];
                asked[part as usize] += targets[row];
                rows[part as usize] += 1.0;
            }
            let share = |part: &usize| lacking[*part] / asked[*part];
            let poorest = (0..count).max_by(|a, b| share(a).total_cmp(&share(b))).unwrap_or(0);
            if share(&poorest) > self.tolerance {
                return Ok(Direction::Apart(
                    self.place.iter().map(|&row| parts[row as usize] == poorest as u32).collect(),
                ));
            }
            // Each part for itself: its constants are in the kernel.
            missing = exact;
            slope = 1.0;
            missing.iter_mut().zip(&parts).for_each(|(m, &part)| *m -= lacking[part as usize] / rows[part as usize]);
        }
        let whole = sum(targets.len(), |i| targets[i] * targets[i]).sqrt();
        let relative = LOOSEST.min(state.error / whole);
        let system = System::solved(multigrid, limits, missing, targets, relative, self.tolerance, slope);
        Ok(Direction::Newton(system))
    }

    /// What a step is to add to each mass, in `order`, and how fast that makes the error fall: by `slope·t` of itself with a small part t
    /// of the step.
    ///
    /// It is `target − mass` where there is too much. Where there is too little, a mass that is far from its target would be aimed at by its
    /// tangent, though it grows much faster: like the third power of the weight, where a cell has only just appeared (along a
    /// line of weights its cube root is concave, by Brunn and Minkowski). There it is the tangent of the cube root that is followed to
    /// the target, `3 m ((t/m)^⅓ − 1)`, which is less, and the others give as much less. Both are one at the target, up to what is
    /// quadratic in the error, so that the end stays quadratic; far from it, steps are many times longer.
    fn aims(&self, state: &State, targets: &[f64]) -> (Vec<f64>, f64) {
        let n = targets.len();
        let mass = |row: usize| state.masses[self.order[row] as usize];
        let mut aims = vec![0.0; n];
        for_each(&mut aims, |row, aim| {
            let (t, m) = (targets[row], mass(row));
            *aim = if m < t { 3.0 * m * ((t / m).cbrt() - 1.0) } else { t - m };
        });
        let share = sum(n, |row| aims[row].max(0.0)) / sum(n, |row| (-aims[row]).max(0.0));
        if !share.is_finite() {
            return (aims, 1.0);
        }
        for_each(&mut aims, |_, aim| *aim *= if *aim < 0.0 { share } else { 1.0 });
        let error2 = state.error * state.error;
        let slope = sum(n, |row| (targets[row] - mass(row)) * aims[row]) / error2;
        (aims, slope)
    }

    /// The next state: which part of a step leads there, and the iterations that it took. Newton's step if it is good as it is, once that
    /// failed a limited one, and where that fails too Newton's, shortened.
    fn advance(&mut self, state: &State, system: &System) -> Result<Option<(f64, usize, State)>> {
        let mut iterations = system.newton.iterations;
        let solution = &system.newton.solution;
        let newton: Vec<f64> = self.place.iter().map(|&row| solution[row as usize]).collect();
        if limited::is_to_be(self, system) {
            if self.limited_steps == 0
                && let Some((step, next)) = self.damped(state, &newton, system.slope, 1.0)?
            {
                return Ok(Some((step, iterations, next)));
            }
            let limited = limited::step(self, state, system)?;
            iterations += limited.iterations;
            if let Some((step, next)) = limited.reached {
                return Ok(Some((step, iterations, next)));
            }
        }
        let found = self.damped(state, &newton, system.slope, SHORTEST_STEP)?;
        Ok(found.map(|(step, next)| {
            self.step = step;
            (step, iterations, next)
        }))
    }

    /// The longest step, of twice the last one halved again and again, after which no cell has too little mass and the error has fallen
    /// enough; none shorter than `shortest`.
    fn damped(&mut self, state: &State, direction: &[f64], slope: f64, shortest: f64) -> Result<Option<(f64, State)>> {
        let largest = |x: &[f64]| x.iter().map(|x| x.abs()).fold(0.0, f64::max);
        let (reach, rounding) = (largest(direction), f64::EPSILON * largest(&state.weights));
        let mut step = (2.0 * self.step).min(1.0);
        while step >= shortest && step * reach > rounding {
            let mut weights: Vec<f64> = state.weights.iter().zip(direction).map(|(w, d)| w + step * d).collect();
            center(&mut weights);
            match self.evaluate(weights) {
                Ok(next) if next.residual <= self.tolerance => return Ok(Some((step, next))),
                Ok(next) if next.least >= self.bound && next.error <= (1.0 - slope * step / 2.0) * state.error => {
                    return Ok(Some((step, next)));
                }
                Ok(_) => {}
                // Weights out of range: much too far.
                Err(error) if error.kind() == ErrorKind::Input => {}
                Err(error) => return Err(error),
            }
            step /= 2.0;
        }
        Ok(None)
    }

    /// What was spent since `begin`, and the counters at zero again.
    fn take_costs(&mut self, begin: Instant) -> Iteration {
        let diagram_seconds = std::mem::take(&mut self.seconds);
        Iteration {
            diagram_evaluations: std::mem::take(&mut self.evaluations),
            diagram_seconds,
            solver_seconds: begin.elapsed().as_secs_f64() - diagram_seconds,
            ..Iteration::default()
        }
    }
}
