//! A diagram whose sites go down the energy, with or without a density.

use crate::vectors::map;
use std::borrow::Cow;

use laguerre_core::diagram::Container;
use laguerre_core::summation::Sum;
use laguerre_core::{
    Backend, BackendInfo, CellStatus, Error, Observer, Output, PowerDiagram, Request, Result, Session,
};

use super::{energy_request, gradient_of, minus};
use crate::density::Density;

type Places = Vec<[f64; 3]>;
type Masses<'a> = Cow<'a, [f64]>;

/// What one evaluation says of the sites where they are.
#[derive(Clone, Copy)]
pub(super) struct State {
    /// Over [`Descent::unit`].
    pub(super) energy: f64,
    /// [`super::Iteration::gradient`].
    pub(super) gradient: f64,
    pub(super) empty: usize,
    /// Diagrams evaluated until then.
    pub(super) evaluations: usize,
}

/// A diagram in a [`Session`]. A density that is the same everywhere changes nothing but the unit of the energy, and leaves the sites where the backend
/// has them; with any other they are on the host.
pub(super) struct Descent<'a> {
    session: Session<'a>,
    density: Option<Varying<'a>>,
    /// What energies are to be multiplied by.
    pub(super) unit: f64,
    /// Mass per volume of the domain's own density, where there is any: volumes are masses there.
    mean_density: f64,
    evaluations: usize,
}

/// What the error of a quadrature may make of an energy, relative to it, for all that is known. A change within that is told from the slopes at both ends of a step (the approximate
/// Wolfe condition of Hager and Zhang, "A new conjugate gradient method with guaranteed descent and an efficient line search", 2005, with their number): 40 cells
/// with two Gaussians of a cell's deviation and degree 5 come to a gradient of 1e-6 by 72 diagrams; by their energies alone, which stop steps that are good, by 1,016.
const NOISE: f64 = 1e-6;

/// A density that is not the same everywhere.
struct Varying<'a> {
    density: &'a Density,
    /// [`Density::spread`].
    spread: f64,
    /// The box about the container.
    bounds: [[f64; 3]; 2],
}

/// A backend whose evaluations have what the moments of a density take.
pub(super) struct OfDensity<'a> {
    pub(super) backend: &'a dyn Backend,
    pub(super) density: &'a Density,
}

impl Backend for OfDensity<'_> {
    fn info(&self) -> BackendInfo {
        self.backend.info()
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        self.density.evaluate_moments_watched(self.backend, diagram, request, observer)
    }
}

impl<'a> Descent<'a> {
    /// Of a diagram, which keeps its container from now on.
    ///
    /// # Errors
    /// As [`Session::new`] and [`Density::check`].
    pub(super) fn new(backend: &'a OfDensity<'a>, diagram: &'a mut PowerDiagram) -> Result<Self> {
        diagram.keep_container()?;
        let (density, container) = (backend.density, diagram.container()?);
        density.check(&container)?;
        let (mean_density, bounds) = match &container {
            Container::Domain(domain) => (domain.mean_density(), domain.bounding_box().into()),
            Container::Box(lo, hi) => (1.0, [*lo, *hi]),
        };
        let (backend, density, unit): (&dyn Backend, _, _) = match density.constant() {
            Some(unit) => (backend.backend, None, unit),
            None => {
                let spread = density.spread(backend.backend, diagram)?;
                (backend, Some(Varying { density, spread, bounds }), 1.0)
            }
        };
        let session = Session::new(backend, diagram, energy_request())?;
        Ok(Self { session, density, unit, mean_density, evaluations: 0 })
    }

    /// Evaluates the sites where they are.
    ///
    /// # Errors
    /// As [`Session::evaluate`].
    pub(super) fn look(&mut self) -> Result<State> {
        self.evaluations += 1;
        let totals = self.session.evaluate()?;
        let (energy, displacement) = match &self.density {
            None => (totals.energy, totals.displacement),
            Some(varying) => {
                let (diagram, output) = self.session.read()?;
                varying.totals(diagram, output)?
            }
        };
        let size = (totals.size / self.mean_density / totals.cells as f64).cbrt();
        Ok(State { energy, gradient: displacement / size, empty: totals.empty, evaluations: self.evaluations })
    }

    /// The gradient at every site, and the masses of the cells; both are 0 where a site is to stay.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub(super) fn slopes(&mut self) -> Result<(Places, Masses<'_>)> {
        let (diagram, output) = self.session.read()?;
        let Some(varying) = &self.density else {
            return Ok((gradient_of(diagram, output.volume(), output.barycenter()), output.volume().into()));
        };
        let (masses, centers) = varying.moments(diagram, output)?;
        Ok((gradient_of(diagram, &masses, &centers), masses.into()))
    }

    /// Lloyd's step.
    ///
    /// # Errors
    /// As [`Session::move_to_barycenters`].
    pub(super) fn move_to_barycenters(&mut self) -> Result<()> {
        let Some(varying) = &self.density else { return self.session.move_to_barycenters() };
        let (diagram, output) = self.session.read()?;
        let (masses, centers) = varying.moments(diagram, output)?;
        let sites = diagram.positions();
        let moved = map(sites.len(), |i| if masses[i] == 0.0 { sites[i] } else { centers[i] });
        self.session.set_sites(moved, None)
    }

    /// By how much of itself an energy is not to be believed, where it is a quadrature's.
    pub(super) fn noise(&self) -> Option<f64> {
        let density = self.density.as_ref()?.density;
        matches!(density, Density::Function(_)).then_some(NOISE)
    }

    /// Where the sites are.
    ///
    /// # Errors
    /// As [`Session::positions`].
    pub(super) fn positions(&mut self) -> Result<&[[f64; 3]]> {
        self.session.positions()
    }

    /// Puts the sites elsewhere.
    ///
    /// # Errors
    /// As [`Session::set_sites`].
    pub(super) fn set_sites(&mut self, positions: Vec<[f64; 3]>) -> Result<()> {
        self.session.set_sites(positions, None)
    }

    /// Undoes the last move.
    pub(super) fn step_back(&mut self) {
        self.session.step_back();
    }

    /// Undoes it where its evaluation did not come to an end.
    pub(super) fn step_back_unless_evaluated(&mut self) {
        if !self.session.is_evaluated() {
            self.session.step_back();
        }
    }

    /// The last evaluation.
    ///
    /// # Errors
    /// As [`Session::finish`].
    pub(super) fn finish(self) -> Result<Output> {
        self.session.finish()
    }
}

impl Varying<'_> {
    /// Masses and centres of mass; the mass is 0 where the site is to stay: where the cell is empty, or so small that the error of the quadrature is all
    /// that there is (its mass has not the sign of its volume, or its centre is outside of the container's box).
    fn moments(&self, diagram: &PowerDiagram, output: &Output) -> Result<(Vec<f64>, Places)> {
        let found = self.density.masses(output).zip(self.density.centers(diagram, output));
        let (mut masses, centers) = found.ok_or_else(missing)?;
        let [lo, hi] = self.bounds;
        for (i, mass) in masses.iter_mut().enumerate() {
            let is_of_cell = output.status()[i] != CellStatus::Empty && (*mass > 0.0) == (output.volume()[i] > 0.0);
            if !(is_of_cell && (0..3).all(|k| (lo[k]..=hi[k]).contains(&centers[i][k]))) {
                *mass = 0.0;
            }
        }
        Ok((masses, centers))
    }

    /// The energy, and how far sites are from centres: what [`Totals`](laguerre_core::Totals) has without a density.
    fn totals(&self, diagram: &PowerDiagram, output: &Output) -> Result<(f64, f64)> {
        let cost = self.density.cost_of(self.spread, diagram, output).ok_or_else(missing)?;
        let (masses, centers) = self.moments(diagram, output)?;
        let largest = masses.iter().fold(0.0, |a: f64, m| a.max(m.abs()));
        let (mut energy, mut size, mut displacement) = (Sum::default(), Sum::default(), Sum::default());
        energy.add(cost);
        for (i, &mass) in masses.iter().enumerate().filter(|(_, mass)| **mass != 0.0) {
            energy.add_product(-mass, diagram.weights().get(i).copied().unwrap_or(0.0));
            let share = mass.abs() / largest;
            size.add(share);
            let off = minus(diagram.positions()[i], centers[i]);
            displacement.add(share * off.iter().map(|x| x * x).sum::<f64>());
        }
        Ok((energy.total(), (displacement.total() / size.total()).sqrt()))
    }
}

/// What a backend is wrong in that wraps another one.
fn missing() -> Error {
    Error::input("the backend's output is without the integrals or second moments that were asked for")
}

#[cfg(test)]
mod tests {
    use laguerre_core::shapes::double_torus;
    use laguerre_cpu::Cpu;

    use super::*;
    use crate::density::Gaussian;

    /// Also where weights differ, and where the domain cuts the cells.
    #[test]
    fn slopes_are_those_of_the_energy() {
        let steps = [0.819_172_513_396_164_5, 0.671_043_606_703_789_2, 0.549_700_477_901_970_4];
        let sites: Vec<[f64; 3]> =
            (0..60).map(|i| steps.map(|s| (f64::from(i * i + 7 * i) * s + 0.37).fract())).collect();
        let weights: Vec<f64> = sites.iter().map(|p| 0.01 * p[0] * p[1]).collect();
        let in_slab: Vec<[f64; 3]> = sites.iter().map(|p| [5.0 * p[0], 3.0 * p[1], p[2]]).collect();
        let cube = PowerDiagram::new(&sites, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        let slab = PowerDiagram::new(&in_slab, &[]).unwrap().restricted_to(&double_torus().domain());
        let linear = Density::Linear { value: 0.1, gradient: [0.7, 0.2, 1.5] };
        let peak = Gaussian::round([0.4, 0.5, 0.6], 0.3, 1.0);
        let gaussians = Density::gaussians(9, 0.2, &[peak]).unwrap();
        let cpu = Cpu::new(Some(2)).unwrap();
        for (density, mut diagram, within) in
            [(&linear, cube.clone(), 1e-6), (&linear, slab, 1e-5), (&gaussians, cube, 1e-4)]
        {
            let positions = diagram.positions().to_vec();
            let backend = OfDensity { backend: &cpu, density };
            let mut descent = Descent::new(&backend, &mut diagram).unwrap();
            descent.look().unwrap();
            let slopes = descent.slopes().unwrap().0;
            let largest = slopes.iter().flatten().fold(0.0, |a: f64, x| a.max(x.abs()));
            for (i, k) in [(0, 0), (23, 2), (59, 1)] {
                let step = 1e-4;
                let mut at = |by: f64| {
                    let mut moved = positions.clone();
                    moved[i][k] += by;
                    descent.set_sites(moved).unwrap();
                    descent.look().unwrap().energy
                };
                let measured = (at(step) - at(-step)) / (2.0 * step);
                let error = (measured - slopes[i][k]).abs() / largest;
                assert!(error < within, "{density:?}, {i} {k}: {measured} {}", slopes[i][k]);
            }
        }
    }
}
