//! Incompressible fluid by power particles (Gallouët, Mérigot, "A Lagrangian scheme à la Brenier for the incompressible Euler equations",
//! 2018; de Goes, Wallez, Huang, Pavlov, Desbrun, "Power particles", 2015).
//!
//! Each particle `p_i` of density `ρ_i` owns a cell of the same volume `V`, its power cell with the weights that optimal transport finds. It is
//! tied to the barycenter `b_i` of that cell by a spring, whose stiffness keeps it near a motion of constant volumes; with gravity `g`
//! and the mean density `ρ̄`
//!
//! `ρ_i dv_i/dt = (b_i − p_i)/ε² + (ρ_i − ρ̄) g`.
//!
//! (Gravity on the mean density would do no more than add to the pressure of a fluid that fills a closed container.) These are the equations of
//! motion of the Hamiltonian
//!
//! `H = Σ ρ_i V ‖v_i‖²/2 + (1/2ε²) Σ_i ∫_cell i ‖x − p_i‖² dx − Σ (ρ_i − ρ̄) V g·p_i`,
//!
//! because the middle sum, the cost of transport, has the gradient `2V (p_i − b_i)`: weights that are the best do not matter to first order. They are
//! integrated by the velocity form of Störmer and Verlet, which is symplectic and asks for one transport a step. The cost is the least of
//! many functions `‖p‖² + …`, so no spring swings faster than `1/(ε√ρ)`: steps below `2ε√ρ` are stable.
//!
//! Viscosity, if any, is a step of its own: `ρ_i V dv_i/dt = ρ̄ν Σ_j (A_ij / ‖p_i − p_j‖) (v_j − v_i)` over the facets, of area `A_ij`, by the implicit Euler
//! method. It conserves momentum, never adds energy, and leaves the walls slippery.

mod cells;
mod neighbors;
mod scene;
mod viscosity;
mod warm;

use laguerre_core::diagram::Container;
use laguerre_core::{Backend, Error, PowerDiagram, Result};

use crate::vectors::{copied, for_each, inner, largest, map, total};

use cells::{Cells, check_places, equal_volumes, within};
pub use cells::{VOLUME_TOLERANCE, settle};
pub use scene::{Scene, Start, lattice};
use warm::Moved;

/// What the fluid is moved by.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// `ε`, the time scale of the springs (time): small is stiff.
    pub epsilon: f64,
    /// Kinematic viscosity `ν` (length²/time) of fluid of the mean density; 0 for none.
    pub viscosity: f64,
    /// Gravity.
    pub gravity: Gravity,
    /// The time step (time); `None` for one that follows the springs and the fastest particle.
    pub time_step: Option<f64>,
}

impl Settings {
    /// Springs of that time scale, without viscosity and gravity, and a time step that follows them and the particles.
    pub fn new(epsilon: f64) -> Self {
        Self { epsilon, viscosity: 0.0, gravity: Gravity::default(), time_step: None }
    }
}

/// Acceleration that acts on density.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Gravity {
    /// The one that stays (length/time²).
    pub steady: [f64; 3],
    /// The one at the top of a shake; zero for none.
    pub shake: [f64; 3],
    /// How long one swing to and fro takes (time).
    pub period: f64,
    /// Number of swings, from time 0.
    pub swings: f64,
}

impl Gravity {
    /// At some time.
    pub fn at(&self, time: f64) -> [f64; 3] {
        let phase = time / self.period;
        let swing = if phase < self.swings { (std::f64::consts::TAU * phase).sin() } else { 0.0 };
        std::array::from_fn(|k| self.steady[k] + swing * self.shake[k])
    }
}

/// All that the motion depends on at one time, beside the container and [`Settings`]: what a checkpoint has to hold.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct State {
    /// Steps so far.
    pub steps: u64,
    /// Time.
    pub time: f64,
    /// Positions `p_i`.
    pub positions: Vec<[f64; 3]>,
    /// Velocities `v_i`.
    pub velocities: Vec<[f64; 3]>,
    /// Densities `ρ_i`.
    pub densities: Vec<f64>,
    /// Weights of the cells of equal volume (length²).
    pub weights: Vec<f64>,
    /// How fast the weights changed in the last step (length²/time).
    pub weight_rates: Vec<f64>,
    /// The Hamiltonian at the start (mass·length²/time²).
    pub hamiltonian_at_start: f64,
    /// Energy that gravity's change brought in, less what viscosity took out (mass·length²/time²): what the Hamiltonian may differ by from its start.
    pub brought_in: f64,
}

impl State {
    /// A copy without the densities, which do not change.
    fn but_densities(&self) -> Self {
        Self {
            positions: copied(&self.positions),
            velocities: copied(&self.velocities),
            densities: Vec::new(),
            weights: copied(&self.weights),
            weight_rates: copied(&self.weight_rates),
            ..*self
        }
    }
}

/// The parts of the Hamiltonian (mass·length²/time²).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Energy {
    /// `Σ ρ_i V ‖v_i‖²/2`.
    pub kinetic: f64,
    /// The cost of transport over `2ε²`. Cells of equal volume have more than none.
    pub spring: f64,
    /// `−Σ (ρ_i − ρ̄) V g·p_i`.
    pub potential: f64,
}

impl Energy {
    /// The Hamiltonian.
    pub fn total(&self) -> f64 {
        self.kinetic + self.spring + self.potential
    }
}

/// What one step took.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StepReport {
    /// The time step.
    pub time_step: f64,
    /// Largest relative error of a volume.
    pub residual: f64,
    /// Newton steps of the transport.
    pub iterations: usize,
    /// Diagrams.
    pub evaluations: usize,
}

/// Step of the fastest spring, in units of `ε√ρ`: an eighth of what is stable. The energy then swings by the square of it.
const SPRING_STEP: f64 = 0.25;
/// How far the fastest particle goes in a step, in mean cell sizes: most cells then keep their neighbours, and the weights are good to start from.
const FASTEST_STEP: f64 = 0.5;

/// A fluid in its container.
#[derive(Clone, Debug)]
pub struct Fluid {
    diagram: PowerDiagram,
    settings: Settings,
    state: State,
    cells: Cells,
    /// Volume of each cell.
    volume: f64,
    size: f64,
    mean_density: f64,
    lightest: f64,
}

impl Fluid {
    /// Particles in a container.
    ///
    /// # Errors
    /// `Input` where lengths differ, a density or setting is not positive, or no cells of equal volume are found; as [`transport::solve`](crate::transport::solve).
    pub fn new(backend: &dyn Backend, container: &Container, start: Start, settings: Settings) -> Result<Self> {
        let Start { positions, velocities, densities } = start;
        let weight_rates = vec![0.0; positions.len()];
        let state = State { positions, velocities, densities, weight_rates, ..State::default() };
        let find = |diagram: &mut PowerDiagram, _| equal_volumes(backend, diagram).map(|(cells, _)| cells);
        let mut fluid = Self::with(container, state, settings, find)?;
        fluid.state.weights = fluid.diagram.weights().to_vec();
        fluid.state.hamiltonian_at_start = fluid.energy().total();
        Ok(fluid)
    }

    /// A fluid that goes on from a state: with the same container and settings it takes the same steps, to the last bit, as the one that the
    /// state is of.
    ///
    /// # Errors
    /// `Input` where lengths differ, a density or setting is not positive, or the weights do not give cells of equal volume.
    pub fn resume(backend: &dyn Backend, container: &Container, state: State, settings: Settings) -> Result<Self> {
        let n = state.positions.len();
        if [state.weights.len(), state.weight_rates.len()] != [n; 2] {
            return Err(Error::input(format!("{n} particles: a weight and its rate are needed for each")));
        }
        Self::with(container, state, settings, |diagram, volume| Cells::again(backend, diagram, volume))
    }

    /// With the cells of that volume that `find` finds.
    fn with(
        container: &Container,
        state: State,
        settings: Settings,
        find: impl FnOnce(&mut PowerDiagram, f64) -> Result<Cells>,
    ) -> Result<Self> {
        check_places(container, &state.positions)?;
        let mut diagram = within(PowerDiagram::new(&state.positions, &state.weights)?, container)?;
        let n = state.positions.len();
        if state.velocities.len() != n || state.densities.len() != n {
            return Err(Error::input(format!("{n} particles: a velocity and a density are needed for each")));
        }
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if let Some(i) = state.densities.iter().position(|&d| !positive(d)) {
            return Err(Error::input(format!("particle {i}: density {} is not a positive number", state.densities[i])));
        }
        if let Some(i) = state.velocities.iter().position(|v| v.iter().any(|x| !x.is_finite())) {
            return Err(Error::input(format!("particle {i}: velocity {:?} is not finite", state.velocities[i])));
        }
        let Settings { epsilon, viscosity, time_step, .. } = settings;
        for (what, number) in [("epsilon", Some(epsilon)), ("time step", time_step)] {
            if let Some(number) = number.filter(|&number| !positive(number)) {
                return Err(Error::input(format!("{what} {number:e}: a positive number is needed")));
            }
        }
        if !(viscosity >= 0.0 && viscosity.is_finite()) {
            return Err(Error::input(format!("viscosity {viscosity:e}: 0 or a positive number is needed")));
        }
        let Gravity { steady, shake, period, swings } = settings.gravity;
        if !steady.iter().chain(&shake).chain(&[swings]).all(|x| x.is_finite()) {
            return Err(Error::input("gravity: a number is not finite"));
        }
        if swings > 0.0 && !positive(period) {
            return Err(Error::input(format!("gravity: a period of {period:e}: a positive number is needed")));
        }
        let container = diagram.container()?;
        let volume = container.volume() / n as f64;
        let size = (volume / container.mean_density()).cbrt();
        let mean_density = total(n, |i| state.densities[i]) / n as f64;
        let lightest = state.densities.iter().copied().fold(f64::INFINITY, f64::min);
        let cells = find(&mut diagram, volume)?;
        Ok(Self { diagram, settings, state, cells, volume, size, mean_density, lightest })
    }

    /// One step.
    ///
    /// # Errors
    /// As [`transport::solve`](crate::transport::solve), and `Input` where no cells of equal volume are found; the state is then that before the step.
    pub fn step(&mut self, backend: &dyn Backend) -> Result<StepReport> {
        let h = self.time_step();
        let (state, weights) = (self.state.but_densities(), copied(self.diagram.weights()));
        let result = self.try_step(backend, h);
        if result.is_err() {
            self.diagram.set_sites(&state.positions, &weights)?;
            self.state = State { densities: std::mem::take(&mut self.state.densities), ..state };
        }
        result
    }

    fn try_step(&mut self, backend: &dyn Backend, h: f64) -> Result<StepReport> {
        self.kick(h / 2.0);
        let State { positions, velocities, weights, weight_rates, .. } = &self.state;
        let moved = |from: &[[f64; 3]]| map(from.len(), |i| along(from[i], h, velocities[i]));
        let (positions, expected) = (moved(positions), moved(&self.cells.barycenters));
        let start = map(weights.len(), |i| weights[i] + h * weight_rates[i]);
        let moved = Moved { positions: &positions, expected: &expected, size: self.cell_size() };
        let start = moved.mended(&start, backend, &self.diagram, &mut self.cells.neighbors)?;
        check_places(&self.diagram.container()?, &positions)?;
        self.diagram.set_sites(&positions, &start)?;
        let (cells, report) = equal_volumes(backend, &mut self.diagram)?;

        let [old, new] = [self.state.time, self.state.time + h].map(|t| self.settings.gravity.at(t));
        if old != new {
            // What the potential gains at rest, halfway.
            let halfway = |i: usize| along(self.state.positions[i], h / 2.0, self.state.velocities[i]);
            self.state.brought_in += self.potential(std::array::from_fn(|k| new[k] - old[k]), halfway);
        }
        let weights = copied(self.diagram.weights());
        self.state.weight_rates = map(weights.len(), |i| (weights[i] - self.state.weights[i]) / h);
        (self.state.weights, self.state.positions) = (weights, positions);
        let cells_before = std::mem::replace(&mut self.cells, cells);
        self.state.time += h;
        self.state.steps += 1;
        self.kick(h / 2.0);
        if self.settings.viscosity > 0.0 {
            let before = self.energy().kinetic;
            let masses = map(self.state.densities.len(), |i| self.state.densities[i] * self.volume);
            let strength = h * self.mean_density * self.settings.viscosity;
            let place = (backend, &self.diagram);
            let slowed = viscosity::slowed(place, &mut self.cells.neighbors, &masses, strength, &self.state.velocities);
            self.state.velocities = slowed.inspect_err(|_| self.cells = cells_before)?;
            self.state.brought_in -= before - self.energy().kinetic;
        }
        Ok(StepReport { time_step: h, ..report })
    }

    /// What a checkpoint has to hold.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The cells of equal volume of the particles.
    pub fn diagram(&self) -> &PowerDiagram {
        &self.diagram
    }

    /// The barycenters `b_i` of these cells.
    pub fn barycenters(&self) -> &[[f64; 3]] {
        &self.cells.barycenters
    }

    /// The largest relative error of a volume of these cells.
    pub fn residual(&self) -> f64 {
        self.cells.residual
    }

    /// The size of a cell: its edge, were it a cube.
    pub fn cell_size(&self) -> f64 {
        self.size
    }

    /// The mean density.
    pub fn mean_density(&self) -> f64 {
        self.mean_density
    }

    /// The parts of the Hamiltonian now.
    pub fn energy(&self) -> Energy {
        let state = &self.state;
        let kinetic =
            |i: usize| 0.5 * state.densities[i] * self.volume * inner(state.velocities[i], state.velocities[i]);
        Energy {
            kinetic: total(state.velocities.len(), kinetic),
            spring: self.cells.cost / (2.0 * self.settings.epsilon * self.settings.epsilon),
            potential: self.potential(self.settings.gravity.at(state.time), |i| state.positions[i]),
        }
    }

    /// How far the Hamiltonian is from what it was at the start, less what came in and went out (mass·length²/time²).
    pub fn drift(&self) -> f64 {
        self.energy().total() - self.state.hamiltonian_at_start - self.state.brought_in
    }

    /// The next time step. Unless given it is `ε√ρ/4` of the lightest particles, halved until the fastest goes no farther than half a cell: it
    /// then changes seldom, which the energy is the better for.
    fn time_step(&self) -> f64 {
        if let Some(given) = self.settings.time_step {
            return given;
        }
        let velocities = &self.state.velocities;
        let fastest = largest(velocities.len(), |i| inner(velocities[i], velocities[i])).sqrt();
        let mut h = SPRING_STEP * self.settings.epsilon * self.lightest.sqrt();
        while h * fastest > FASTEST_STEP * self.cell_size() && h.is_normal() {
            h /= 2.0;
        }
        h
    }

    /// Velocities after the time `h` under the forces of now.
    fn kick(&mut self, h: f64) {
        let gravity = self.settings.gravity.at(self.state.time);
        let (stiffness, mean) = (self.settings.epsilon.powi(-2), self.mean_density);
        let State { positions, velocities, densities, .. } = &mut self.state;
        for_each(velocities, |i, v| {
            let (p, b, density) = (positions[i], self.cells.barycenters[i], densities[i]);
            let force: [f64; 3] = std::array::from_fn(|k| (b[k] - p[k]) * stiffness + (density - mean) * gravity[k]);
            *v = along(*v, h / density, force);
        });
    }

    /// `−Σ (ρ_i − ρ̄) V g·p_i`.
    fn potential(&self, gravity: [f64; 3], position: impl Fn(usize) -> [f64; 3] + Sync) -> f64 {
        let densities = &self.state.densities;
        let of = |i: usize| -(densities[i] - self.mean_density) * self.volume * inner(gravity, position(i));
        total(densities.len(), of)
    }
}

fn along(p: [f64; 3], t: f64, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| p[k] + t * v[k])
}

#[cfg(test)]
mod tests {
    use laguerre_cpu::Cpu;

    use super::*;

    fn vortex(viscosity: f64) -> Fluid {
        let centers = lattice([1.0; 3], 27);
        let scene = Scene::Beltrami;
        let settings = scene.settings(&[1.0; 27], [0.0; 3], [1.0; 3], 1.0 / 3.0, None);
        let start = scene.start(&centers, vec![1.0; 27], &settings);
        let settings = Settings { viscosity, ..settings };
        Fluid::new(&Cpu::new(Some(1)).unwrap(), &Container::Box([0.0; 3], [1.0; 3]), start, settings).unwrap()
    }

    #[test]
    fn a_step_that_fails_late_leaves_all_as_it_was() {
        let backend = Cpu::new(Some(1)).unwrap();
        let mut fluid = vortex(1e300);
        let (state, barycenters, energy) = (fluid.state().clone(), fluid.barycenters().to_vec(), fluid.energy());
        let error = fluid.step(&backend).unwrap_err();
        assert!(error.to_string().contains("viscosity"), "{error}");
        assert!(*fluid.state() == state && fluid.barycenters() == barycenters && fluid.energy() == energy);
    }

    #[test]
    fn weights_of_other_positions_are_refused() {
        let backend = Cpu::new(Some(1)).unwrap();
        let fluid = vortex(0.0);
        let mut state = fluid.state().clone();
        state.weights[13] += 1e-6;
        let container = Container::Box([0.0; 3], [1.0; 3]);
        let error = Fluid::resume(&backend, &container, state, *fluid.settings()).unwrap_err().to_string();
        assert!(error.contains("the weights are not those of these positions"), "{error}");
    }
}
