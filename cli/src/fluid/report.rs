//! What is said about a fluid: a row for each step, and the object of `--json`.

use laguerre::BackendInfo;
use laguerre::solvers::fluid::{Fluid, Scene, StepReport};
use serde::Serialize;

use crate::page::{self, Plot};
use crate::report::grouped;

/// One step.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Step {
    step: u64,
    time: f64,
    time_step: f64,
    kinetic: f64,
    spring: f64,
    potential: f64,
    /// How far the Hamiltonian is from its start, less what came in and went out.
    drift: f64,
    /// Largest relative error of a volume.
    residual: f64,
    /// Newton steps.
    iterations: usize,
    evaluations: usize,
    seconds: f64,
}

impl Step {
    pub(super) fn new(fluid: &Fluid, taken: &StepReport, seconds: f64) -> Self {
        let energy = fluid.energy();
        Self {
            step: fluid.state().steps,
            time: fluid.state().time,
            time_step: taken.time_step,
            kinetic: energy.kinetic,
            spring: energy.spring,
            potential: energy.potential,
            drift: fluid.drift(),
            residual: taken.residual,
            iterations: taken.iterations,
            evaluations: taken.evaluations,
            seconds,
        }
    }

    /// For people.
    pub(super) fn line(&self) -> String {
        format!(
            "{:7}  {:9.4}  {:12.5e}  {:12.5e}  {:12.5e}  {:10.2e}  {:8.1e}  {:8}\n",
            self.step,
            self.time,
            self.kinetic,
            self.spring,
            self.potential,
            self.drift,
            self.residual,
            self.evaluations
        )
    }
}

/// The object of `--json`.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    scene: &'static str,
    particles: usize,
    /// Since the scene's beginning.
    steps: u64,
    time: f64,
    /// Newton steps of this run.
    iterations: usize,
    /// Largest relative error of a volume in this run.
    residual: f64,
    seconds: f64,
    evaluations: usize,
    /// Largest drift of the Hamiltonian in this run, over the largest kinetic energy.
    hamiltonian_drift: f64,
    epsilon: f64,
    viscosity: f64,
    interrupted: bool,
    backend: &'static str,
    device: String,
    precision: &'static str,
    threads: usize,
    /// This run, step by step.
    history: Vec<Step>,
    #[serde(skip)]
    first_kinetic: f64,
    #[serde(skip)]
    largest_kinetic: f64,
    #[serde(skip)]
    largest_drift: f64,
}

impl Report {
    pub(super) fn new(scene: Scene, fluid: &Fluid, info: BackendInfo) -> Self {
        Self {
            scene: scene.name(),
            particles: fluid.state().positions.len(),
            steps: 0,
            time: 0.0,
            iterations: 0,
            residual: 0.0,
            seconds: 0.0,
            evaluations: 0,
            hamiltonian_drift: 0.0,
            epsilon: fluid.settings().epsilon,
            viscosity: fluid.settings().viscosity,
            interrupted: false,
            backend: info.backend,
            device: info.device,
            precision: info.precision.word(),
            threads: info.threads,
            history: Vec::new(),
            first_kinetic: fluid.energy().kinetic,
            largest_kinetic: fluid.energy().kinetic,
            largest_drift: 0.0,
        }
    }

    /// Above the lines of the steps.
    pub(super) fn header(&self) -> String {
        format!(
            "{}, {} particles, epsilon {:.4e}\n\
             {:>7}  {:>9}  {:>12}  {:>12}  {:>12}  {:>10}  {:>8}  {:>8}\n",
            self.scene,
            grouped(self.particles as u64),
            self.epsilon,
            "step",
            "time",
            "kinetic",
            "spring",
            "potential",
            "drift",
            "volumes",
            "diagrams"
        )
    }

    pub(super) fn add(&mut self, step: Step) {
        self.iterations += step.iterations;
        self.evaluations += step.evaluations;
        self.residual = self.residual.max(step.residual);
        self.largest_kinetic = self.largest_kinetic.max(step.kinetic);
        self.largest_drift = self.largest_drift.max(step.drift.abs());
        self.history.push(step);
    }

    pub(super) fn finish(&mut self, fluid: &Fluid, interrupted: bool, seconds: f64) {
        (self.steps, self.time) = (fluid.state().steps, fluid.state().time);
        if self.largest_kinetic > 0.0 {
            self.hamiltonian_drift = self.largest_drift / self.largest_kinetic;
        }
        (self.interrupted, self.seconds) = (interrupted, seconds);
    }

    /// The figures that a page shows.
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = vec![
            ("particles", grouped(self.particles as u64)),
            ("steps", format!("{}, to time {:.4}", self.steps, self.time)),
            ("volumes", format!("equal to {:.1e} at every step", self.residual)),
            ("energy", format!("drifts by {:.1e} of the largest kinetic energy", self.hamiltonian_drift)),
            ("epsilon", format!("{:.4e}", self.epsilon)),
            ("viscosity", format!("{:.4e}", self.viscosity)),
            ("computed in", format!("{:.3} s", self.seconds)),
        ];
        facts.extend(page::made_by(self.backend, &self.device, self.precision, self.threads));
        facts
    }

    /// The kinetic energy, step by step: its row 0 is the state at which this run began.
    pub(super) fn plot(&self) -> Option<Plot> {
        let values = [self.first_kinetic].into_iter().chain(self.history.iter().map(|step| step.kinetic)).collect();
        Plot::of("kinetic", values)
    }

    pub(super) fn summary(&self) -> String {
        format!(
            "volumes      equal to {:.1e} at every step\n\
             energy       drifts by {:.1e} of the largest kinetic energy\n\
             compute      {:.3} s, {} steps, {} Newton steps, {} diagrams ({}, {}, {})\n",
            self.residual,
            self.hamiltonian_drift,
            self.seconds,
            self.history.len(),
            self.iterations,
            self.evaluations,
            self.backend,
            self.precision,
            self.device,
        )
    }
}
