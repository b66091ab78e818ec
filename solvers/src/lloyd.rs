//! Centroidal Voronoi tessellations: Lloyd, and L-BFGS on their energy.
//!
//! The energy of sites `p_i` with fixed weights is `F = Σ_i ∫_cell i (‖x − p_i‖² − w_i) dx` (length⁵; with equal weights 0 the energy of
//! a centroidal Voronoi tessellation). Its gradient is `∂F/∂p_i = 2 V_i (p_i − b_i)`: how the cells change does not matter to first order,
//! because on their borders the integrands agree. It is zero where every site is the barycenter of its cell.
//!
//! * Lloyd moves each site to its barycenter: Newton's method with the cells held fixed. It never raises the energy, and
//!   slows down as it comes near (linear, and the slower the more sites there are).
//! * L-BFGS (Liu, Wang, Lévy, Sun, Yan, Lu, Yang, "On centroidal Voronoi tessellation", 2009) learns what Lloyd's step leaves out from how
//!   the gradient changed. It starts from Lloyd's step, which is the gradient preconditioned by `1 / 2V_i`.
//!
//! Sums are taken in an order that depends on the number of sites alone, so that results have the same bits for any number of threads.

mod lbfgs;

use laguerre_core::diagram::Container;
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, CellStatus, Error, ErrorKind, Output, PowerDiagram, Request, Result};
use std::ops::ControlFlow;

use crate::vectors::{distance2, dot, inner};
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
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Iterations at most; 0 only looks.
    pub most_iterations: usize,
    /// Stop where [`Iteration::gradient`] is not above this.
    pub tolerance: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { method: Method::default(), most_iterations: 100, tolerance: 1e-3 }
    }
}

impl Options {
    /// The same by another method.
    #[must_use]
    pub fn by(self, method: Method) -> Self {
        Self { method, ..self }
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
    /// The energy `F` (length⁵).
    pub energy: f64,
    /// The gradient without scale: `√(Σ V_i ‖p_i − b_i‖² / Σ V_i)`, the mean distance of sites from barycenters, over the mean cell's
    /// size `(Σ V_i / n)^⅓`, `n` the number of cells that are not empty.
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
    /// The last evaluation: volumes, barycenters, second moments.
    pub output: Output,
}

/// Moves the sites of a diagram, their weights held, down the energy until the gradient is within a bound; `on_iteration` is told how
/// each iteration ended, the start included.
///
/// No step raises the energy by more than its rounding. L-BFGS takes no step of its own that empties a cell, but a shorter one; that of
/// Lloyd, which it falls back on, may where weights differ. Sites stay where they are while their cells are empty. A site may leave a domain that is not convex: it goes where
/// the barycenter of its cell is. A diagram without a domain or box keeps the bounding box of its sites at the start.
///
/// `Break` from `on_iteration`, or a watched backend that says [`ErrorKind::Interrupted`], ends it: the diagram is then that of the last
/// iteration, and [`Relaxation::interrupted`] is true.
///
/// # Errors
/// `Interrupted` where there is not even the diagram at the start; `Input` where the tolerance is no number from 0; else as [`Backend::evaluate`].
pub fn relax(
    backend: &dyn Backend,
    diagram: &mut PowerDiagram,
    options: &Options,
    on_iteration: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
) -> Result<Relaxation> {
    if options.tolerance.is_nan() || options.tolerance < 0.0 {
        return Err(Error::input(format!("gradient bound {}: a number from 0 is needed", options.tolerance)));
    }
    if let Container::Box(lo, hi) = diagram.container()? {
        *diagram = diagram.clone().in_box(lo, hi)?;
    }
    let mut evaluations = 0;
    let mut look = |diagram: &PowerDiagram| {
        evaluations += 1;
        Ok((Landscape::of(diagram, backend.evaluate(diagram, &energy_request())?), evaluations))
    };
    let mut memory = Memory::default();
    let (mut here, mut evaluated) = look(diagram)?;
    let mut iterations = Vec::new();
    loop {
        let done = Iteration { energy: here.energy, gradient: here.residual(), evaluations: evaluated };
        let interrupted = on_iteration(&done).is_break();
        iterations.push(done);
        let converged = done.gradient <= options.tolerance;
        if converged || interrupted || iterations.len() > options.most_iterations {
            return Ok(Relaxation { iterations, converged, interrupted, output: here.output });
        }
        let start = diagram.positions().to_vec();
        let mut next = || {
            let next = match options.method {
                Method::Lloyd => None,
                Method::Lbfgs => descend(diagram, &here, &mut memory, &mut look)?,
            };
            if let Some(next) = next {
                return Ok(next);
            }
            memory.clear();
            move_to(diagram, &barycenters(diagram, &here.output, |_| true))?;
            look(diagram)
        };
        match next() {
            Ok(next) => (here, evaluated) = next,
            Err(error) if error.kind() == ErrorKind::Interrupted => {
                move_to(diagram, &start)?;
                return Ok(Relaxation { iterations, converged, interrupted: true, output: here.output });
            }
            Err(error) => return Err(error),
        }
    }
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
/// no need of second moments. A site whose barycenter `accept` refuses, or whose cell is empty, stays where it is.
///
/// # Errors
/// As [`Backend::evaluate`].
pub fn equalize(
    backend: &dyn Backend,
    diagram: &mut PowerDiagram,
    spread: f64,
    most_steps: usize,
    accept: impl Fn([f64; 3]) -> bool,
) -> Result<Equalized> {
    let mut steps = 0;
    loop {
        let output = backend.evaluate(diagram, &Request::moments())?;
        let found = relative_deviation(output.volume());
        if found < spread || steps == most_steps {
            return Ok(Equalized { steps, spread: found });
        }
        move_to(diagram, &barycenters(diagram, &output, &accept))?;
        steps += 1;
    }
}

/// Standard deviation over mean. Two passes, so that plain sums suffice for a figure that is compared with a tenth.
pub fn relative_deviation(volumes: &[f64]) -> f64 {
    let n = volumes.len() as f64;
    let mean = volumes.iter().sum::<f64>() / n;
    let variance = volumes.iter().map(|v| (v / mean - 1.0).powi(2)).sum::<f64>() / n;
    variance.sqrt()
}

/// What [`energy`] and [`gradient`] need of an evaluation.
pub fn energy_request() -> Request {
    Request::moments().with_second_moments()
}

/// The energy `Σ ∫ (‖x − p_i‖² − w_i) dx` (length⁵) of a diagram from its evaluation by [`energy_request`]: the trace of each cell's
/// second moment about its barycenter, and `V_i (‖p_i − b_i‖² − w_i)`.
pub fn energy(diagram: &PowerDiagram, output: &Output) -> f64 {
    let mut sum = Sum::default();
    let second = output.second_moment().unwrap_or_default();
    for (i, &p) in diagram.positions().iter().enumerate() {
        if output.status()[i] == CellStatus::Empty {
            continue;
        }
        if let Some([xx, yy, zz, ..]) = second.get(i) {
            sum.extend([*xx, *yy, *zz]);
        }
        let weight = diagram.weights().get(i).copied().unwrap_or(0.0);
        sum.add(output.volume()[i] * (distance2(p, output.barycenter()[i]) - weight));
    }
    sum.total()
}

/// The energy's gradient `2 V_i (p_i − b_i)` (length⁴) at every site; zero where the cell is empty.
pub fn gradient(diagram: &PowerDiagram, output: &Output) -> Vec<[f64; 3]> {
    let sites = diagram.positions().iter().enumerate();
    sites
        .map(|(i, &p)| match output.status()[i] {
            CellStatus::Empty => [0.0; 3],
            _ => minus(p, output.barycenter()[i]).map(|x| 2.0 * output.volume()[i] * x),
        })
        .collect()
}

/// A step that lowers the energy by less than this share of what the slope promises is too long (Armijo's rule, with Liu et al.'s number).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Steps that are tried along one direction. Each is a diagram; Lloyd's step, which needs no trial, stands by.
const MOST_TRIES: usize = 6;
/// What a step that was too long is shortened by, at least and at most.
const SHORTEN: [f64; 2] = [0.5, 0.1];

/// The energy about a diagram.
struct Landscape {
    output: Output,
    energy: f64,
    gradient: Vec<[f64; 3]>,
}

impl Landscape {
    fn of(diagram: &PowerDiagram, output: Output) -> Self {
        Self { energy: energy(diagram, &output), gradient: gradient(diagram, &output), output }
    }

    /// [`Iteration::gradient`].
    fn residual(&self) -> f64 {
        let (mut volume, mut moved, mut cells) = (Sum::default(), Sum::default(), 0_usize);
        for (&v, &g) in self.output.volume().iter().zip(&self.gradient).filter(|&(&v, _)| v > 0.0) {
            volume.add(v);
            // The unit cancels before anything is squared, so that nothing overflows.
            let way = g.map(|x| x / (2.0 * v));
            moved.add(v * inner(way, way));
            cells += 1;
        }
        let size = (volume.total() / cells as f64).cbrt();
        (moved.total() / volume.total()).sqrt() / size
    }

    /// `1 / 2V_i`: times the gradient, Lloyd's step.
    fn lloyd_scale(&self, i: usize) -> f64 {
        if self.output.status()[i] == CellStatus::Empty { 0.0 } else { 0.5 / self.output.volume()[i] }
    }
}

/// A step down the direction that `memory` proposes, from the diagram of `here`; `None`, with the diagram as it was, where none of
/// those tried is good enough.
fn descend(
    diagram: &mut PowerDiagram,
    here: &Landscape,
    memory: &mut Memory,
    look: &mut impl FnMut(&PowerDiagram) -> Result<(Landscape, usize)>,
) -> Result<Option<(Landscape, usize)>> {
    let start = diagram.positions().to_vec();
    let direction = memory.direction(&here.gradient, |i| here.lloyd_scale(i));
    let slope = dot(&here.gradient, &direction);
    if slope.is_nan() || slope >= 0.0 {
        return Ok(None);
    }
    let empty = here.output.count(CellStatus::Empty);
    let mut step = 1.0;
    for _ in 0..MOST_TRIES {
        let moved: Vec<[f64; 3]> =
            start.iter().zip(&direction).map(|(p, d)| std::array::from_fn(|k| p[k] + step * d[k])).collect();
        let (there, evaluated) = match move_to(diagram, &moved).and_then(|()| look(diagram)) {
            Ok(reached) if reached.0.output.count(CellStatus::Empty) <= empty => reached,
            // Some site is out of all range.
            Err(error) if error.kind() != ErrorKind::Input => return Err(error),
            _ => {
                step *= SHORTEN[0];
                continue;
            }
        };
        if there.energy <= here.energy + SUFFICIENT_DECREASE * step * slope {
            let step = moved.iter().zip(&start).map(|(&p, &q)| minus(p, q)).collect();
            let change = there.gradient.iter().zip(&here.gradient).map(|(&g, &h)| minus(g, h)).collect();
            memory.learn(step, change);
            return Ok(Some((there, evaluated)));
        }
        // The lowest point of the parabola through both energies and the slope here.
        let rise = there.energy - here.energy - step * slope;
        step *= (-0.5 * step * slope / rise).clamp(SHORTEN[1], SHORTEN[0]);
    }
    move_to(diagram, &start)?;
    Ok(None)
}

/// The barycenters of the cells; the site where its cell is empty or `accept` refuses it.
fn barycenters(diagram: &PowerDiagram, output: &Output, accept: impl Fn([f64; 3]) -> bool) -> Vec<[f64; 3]> {
    let sites = diagram.positions().iter().enumerate();
    sites
        .map(|(i, &old)| {
            let new = output.barycenter()[i];
            if output.status()[i] != CellStatus::Empty && accept(new) { new } else { old }
        })
        .collect()
}

fn move_to(diagram: &mut PowerDiagram, positions: &[[f64; 3]]) -> Result<()> {
    let weights = diagram.weights().to_vec();
    diagram.set_sites(positions, &weights)
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
