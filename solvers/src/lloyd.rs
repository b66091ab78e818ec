//! Centroidal Voronoi tessellations: Lloyd, and L-BFGS on their energy.
//!
//! The energy of sites `p_i` with fixed weights is `F = Σ_i ∫_cell i ρ (‖x − p_i‖² − w_i) dx` (length⁵ where the density `ρ` is 1; mass·length² else; with equal
//! weights 0 the energy of a centroidal Voronoi tessellation). Its gradient is `∂F/∂p_i = 2 m_i (p_i − b_i)`, with the masses `m_i` and the barycenters of mass `b_i`
//! (volume `V_i` and barycenter where `ρ` is 1): how the cells change does not matter to first order,
//! because on their borders the integrands agree. It is zero where every site is the barycenter of its cell. Of many sites, those per volume are as `ρ^(3/5)`.
//!
//! * Lloyd moves each site to its barycenter: Newton's method with the cells held fixed. It never raises the energy, and
//!   slows down as it comes near (linear, and the slower the more sites there are).
//! * L-BFGS (Liu, Wang, Lévy, Sun, Yan, Lu, Yang, "On centroidal Voronoi tessellation", 2009) learns what Lloyd's step leaves out from how
//!   the gradient changed. It starts from Lloyd's step, which is the gradient preconditioned by `1 / 2m_i`.
//!
//! Sums are taken in an order that depends on the number of sites alone, so that results have the same bits for any number of threads.

mod descent;
mod lbfgs;

pub use laguerre_core::session::relative_deviation;
use laguerre_core::{Backend, Error, ErrorKind, Output, PowerDiagram, Request, Result, Session, Totals};
use std::ops::ControlFlow;

use crate::density::{Density, is_of_density};
use crate::vectors::{dot, map};
use descent::{Descent, OfDensity, State};
use lbfgs::Memory;

/// How to go down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Every site to the barycenter of its cell.
    Lloyd,
    /// Limited-memory quasi-Newton.
    #[default]
    Lbfgs,
}

/// When to stop, and how to go.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Options {
    /// The method.
    pub method: Method,
    /// What the energy is an integral over.
    pub density: Density,
    /// Iterations at most; 0 only looks.
    pub most_iterations: usize,
    /// Stop where [`Iteration::gradient`] is not above this.
    pub tolerance: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { method: Method::default(), density: Density::Uniform, most_iterations: 100, tolerance: 1e-3 }
    }
}

impl Options {
    /// The same by another method.
    #[must_use]
    pub fn by(self, method: Method) -> Self {
        Self { method, ..self }
    }

    /// The same with another density.
    #[must_use]
    pub fn of(self, density: Density) -> Self {
        Self { density, ..self }
    }

    /// The same with another number of iterations and gradient bound.
    #[must_use]
    pub fn until(self, most_iterations: usize, tolerance: f64) -> Self {
        Self { most_iterations, tolerance, ..self }
    }
}

/// What the diagram was like after some iterations.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Iteration {
    /// The energy `F` (length⁵, or mass·length²).
    pub energy: f64,
    /// The gradient without scale: `√(Σ m_i ‖p_i − b_i‖² / Σ m_i)`, the mean distance of sites from barycenters, over the mean cell's
    /// size `(Σ V_i / n)^⅓`, `n` the number of cells that are not empty; of a domain with a density, whose `V_i` are masses, it is that of its volume.
    pub gradient: f64,
    /// Diagrams evaluated so far.
    pub evaluations: usize,
}

/// What came of it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Relaxation {
    /// The diagram at the start, and after each iteration.
    pub iterations: Vec<Iteration>,
    /// Whether the gradient is within the bound.
    pub converged: bool,
    /// Whether someone wanted this to stop: what is here is then of the last iteration.
    pub interrupted: bool,
    /// The last evaluation: volumes, barycenters, second moments, and what [`Density::masses`] and [`Density::centers`] take.
    pub output: Output,
}

/// Moves the sites of a diagram, their weights held, down the energy until the gradient is within a bound; `on_iteration` is told how
/// each iteration ended, the start included.
///
/// No step raises the energy by more than its rounding. L-BFGS takes no step of its own that empties a cell, but a shorter one; that of
/// Lloyd, which it falls back on, may where weights differ. Sites stay where they are while their cells are empty. A site may leave a domain that is not convex: it goes where
/// the barycenter of its cell is. A diagram without a domain or box keeps the bounding box of its sites at the start.
///
/// With a density that is a function energies, masses and barycenters are those of its quadrature, which differs a little from diagram to diagram: then the energy may rise by as much, by L-BFGS 1e-6 of it, and
/// a tolerance far below is out of reach. Each cell is computed six times an evaluation, on the CPU. The density of a domain (of voxels, of tetrahedra) is heeded without any here.
///
/// `Break` from `on_iteration`, or a watched backend that says [`ErrorKind::Interrupted`], ends it: the diagram is then that of the last
/// iteration, and [`Relaxation::interrupted`] is true.
///
/// # Errors
/// `Interrupted` where there is not even the diagram at the start; `Input` where the tolerance is no number from 0, and where the density is not positive wherever it is evaluated; else as [`Backend::evaluate`].
pub fn relax(
    backend: &dyn Backend,
    diagram: &mut PowerDiagram,
    options: &Options,
    on_iteration: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
) -> Result<Relaxation> {
    if options.tolerance.is_nan() || options.tolerance < 0.0 {
        return Err(Error::input(format!("tolerance {}: a number from 0 is needed", options.tolerance)));
    }
    let backend = OfDensity { backend, density: &options.density };
    let mut descent = Descent::new(&backend, diagram)?;
    let mut memory = Memory::default();
    let mut here = descent.look()?;
    let mut iterations = Vec::new();
    loop {
        let State { energy, gradient, evaluations, .. } = here;
        let done = Iteration { energy: descent.unit * energy, gradient, evaluations };
        let mut interrupted = on_iteration(&done).is_break();
        iterations.push(done);
        let converged = done.gradient <= options.tolerance;
        if !(converged || interrupted || iterations.len() > options.most_iterations) {
            match step(&mut descent, options.method, &here, &mut memory) {
                Ok(next) => {
                    here = next;
                    continue;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {
                    descent.step_back_unless_evaluated();
                    interrupted = true;
                }
                Err(error) => return Err(error),
            }
        }
        return Ok(Relaxation { iterations, converged, interrupted, output: descent.finish()? });
    }
}

/// One iteration from `here`.
fn step(descent: &mut Descent<'_>, method: Method, here: &State, memory: &mut Memory) -> Result<State> {
    if method == Method::Lbfgs {
        if let Some(next) = descend(descent, here, memory)? {
            return Ok(next);
        }
        memory.clear();
    }
    descent.move_to_barycenters()?;
    descent.look()
}

/// How far [`equalize`] came.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Equalized {
    /// Steps taken.
    pub steps: usize,
    /// Standard deviation of the cells' volumes over their mean.
    pub spread: f64,
}

/// Lloyd's algorithm until the volumes of the cells vary by less than `spread`, at most `most_steps` times: blue noise from white, with
/// no need of second moments. A site whose cell is empty, or whose barycenter `accept` refuses if it is given, stays where it is.
///
/// # Errors
/// As [`Backend::evaluate`].
pub fn equalize(
    backend: &dyn Backend,
    diagram: &mut PowerDiagram,
    spread: f64,
    most_steps: usize,
    accept: Option<&(dyn Fn([f64; 3]) -> bool + Sync)>,
) -> Result<Equalized> {
    let mut session = Session::new(backend, diagram, Request::moments())?;
    let mut steps = 0;
    loop {
        let found = session.evaluate()?.spread;
        if found < spread || steps == most_steps {
            session.positions()?;
            return Ok(Equalized { steps, spread: found });
        }
        match accept {
            Some(accept) => session.move_to_barycenters_in(accept)?,
            None => session.move_to_barycenters()?,
        }
        steps += 1;
    }
}

/// What [`energy`] and [`gradient`] need of an evaluation.
pub fn energy_request() -> Request {
    Request::moments().with_second_moments()
}

/// The energy `Σ ∫ (‖x − p_i‖² − w_i) dx` (length⁵) of a diagram from its evaluation by [`energy_request`]: the trace of each cell's
/// second moment about its barycenter, and `V_i (‖p_i − b_i‖² − w_i)`.
pub fn energy(diagram: &PowerDiagram, output: &Output) -> f64 {
    Totals::of(diagram, output).energy
}

/// The energy's gradient `2 V_i (p_i − b_i)` (length⁴) at every site; zero where the cell is empty.
pub fn gradient(diagram: &PowerDiagram, output: &Output) -> Vec<[f64; 3]> {
    gradient_of(diagram, output.volume(), output.barycenter())
}

/// The same of masses and their barycenters; zero where the mass is.
fn gradient_of(diagram: &PowerDiagram, masses: &[f64], centers: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let sites = diagram.positions();
    map(sites.len(), |i| match masses[i] {
        0.0 => [0.0; 3],
        mass => minus(sites[i], centers[i]).map(|x| 2.0 * mass * x),
    })
}

/// A step that lowers the energy by less than this share of what the slope promises is too long (Armijo's rule, with Liu et al.'s number).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Steps that are tried along one direction. Each is a diagram; Lloyd's step, which needs no trial, stands by.
const MOST_TRIES: usize = 6;
/// What a step that was too long is shortened by, at least and at most.
const SHORTEN: [f64; 2] = [0.5, 0.1];

/// A step down the direction that `memory` proposes, from `here`; `None`, with the diagram as it was, where none of
/// those tried is good enough.
fn descend(descent: &mut Descent<'_>, here: &State, memory: &mut Memory) -> Result<Option<State>> {
    let start = descent.positions()?.to_vec();
    let (slopes, masses) = descent.slopes()?;
    // `1 / 2m_i`: times the gradient, Lloyd's step.
    let lloyd_scale = |i: usize| if masses[i] == 0.0 { 0.0 } else { 0.5 / masses[i] };
    let direction = memory.direction(&slopes, lloyd_scale);
    let slope = dot(&slopes, &direction);
    if slope.is_nan() || slope >= 0.0 {
        return Ok(None);
    }
    let mut step = 1.0;
    for _ in 0..MOST_TRIES {
        let moved = map(start.len(), |i| std::array::from_fn(|k| start[i][k] + step * direction[i][k]));
        if descent.set_sites(moved).is_err() {
            // Some site is out of all range.
            step *= SHORTEN[0];
            continue;
        }
        let there = match descent.look() {
            Ok(reached) if reached.empty <= here.empty => reached,
            Err(error) if error.kind() != ErrorKind::Input || is_of_density(&error) => return Err(error),
            _ => {
                descent.step_back();
                step *= SHORTEN[0];
                continue;
            }
        };
        let is_lower = there.energy <= here.energy + SUFFICIENT_DECREASE * step * slope;
        let is_noise = descent.noise().is_some_and(|noise| there.energy <= here.energy + noise * here.energy.abs());
        if is_lower || is_noise {
            let new = descent.slopes()?.0;
            if is_lower || dot(&new, &direction) <= (2.0 * SUFFICIENT_DECREASE - 1.0) * slope {
                memory.learn(differences(descent.positions()?, &start), differences(&new, &slopes));
                return Ok(Some(there));
            }
        }
        descent.step_back();
        // The lowest point of the parabola through both energies and the slope here.
        let rise = there.energy - here.energy - step * slope;
        step *= (-0.5 * step * slope / rise).clamp(SHORTEN[1], SHORTEN[0]);
    }
    Ok(None)
}

fn differences(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    map(a.len(), |i| minus(a[i], b[i]))
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

#[cfg(test)]
mod tests {
    use laguerre_cpu::Cpu;

    use std::ops::ControlFlow::Continue;

    use super::*;

    #[test]
    fn deviation_is_relative() {
        assert_eq!(relative_deviation(&[3.0, 3.0]), 0.0);
        assert_eq!(relative_deviation(&[1e-200, 3e-200]), 0.5);
    }

    /// Near the ends of the range of coordinates, where squares of the gradient overflow, steps are the same but for the unit.
    #[test]
    fn the_unit_changes_no_bit() {
        let relaxed = |unit: f64| {
            let sites: Vec<[f64; 3]> =
                (0..60).map(|i| [0.754_877, 0.569_840, 0.430_159].map(|s| unit * (f64::from(i) * s).fract())).collect();
            let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [unit; 3]).unwrap();
            let backend = Cpu::new(Some(1)).unwrap();
            relax(&backend, &mut diagram, &Options::default().until(20, 1e-3), &mut |_| Continue(())).unwrap();
            diagram.positions().iter().map(|p| p.map(|x| x / unit)).collect::<Vec<_>>()
        };
        let [small, large] = [-190, 190].map(|power| relaxed(2.0_f64.powi(power)));
        let one = relaxed(1.0);
        assert!(one == small && one == large);
    }
}
