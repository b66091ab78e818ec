//! Densities over a domain: uniform or linear.

use laguerre_core::diagram::Container;
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, Error, Integrand, Output, PowerDiagram, Request, Result};

/// A density `ρ` (mass per volume) on the whole of a container.
///
/// Both kinds need no more than the integrals that [`Output`] has, and are exact: with `V` the volume and `b` the barycenter of a
/// cell, its mass is `ρ(b)·V`, its first moment `V ρ(b) b + M₂ g`, where `M₂` is its second moment about `b`; a facet has the mass
/// `ρ(b_f)·area`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Density {
    /// 1 everywhere: masses are volumes.
    #[default]
    Uniform,
    /// `ρ(x) = value + gradient · x`.
    Linear {
        /// At the origin of the coordinates.
        value: f64,
        /// Change per length.
        gradient: [f64; 3],
    },
}

impl Density {
    /// `ρ(x)`.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        match *self {
            Self::Uniform => 1.0,
            Self::Linear { value, gradient: [a, b, c] } => value + (a * x[0] + b * x[1] + c * x[2]),
        }
    }

    /// Checks that the density is positive on all of `container`: its least value is at a vertex or a corner.
    ///
    /// # Errors
    /// `Input`, naming the place where it is not.
    pub fn check(&self, container: &Container) -> Result<()> {
        let Self::Linear { .. } = self else { return Ok(()) };
        let is_wrong = |x: &[f64; 3]| {
            let rho = self.at(*x);
            !(rho > 0.0 && rho.is_finite())
        };
        let found = match container {
            Container::Domain(domain) => domain.vertices().iter().copied().find(is_wrong),
            Container::Box(lo, hi) => corners(*lo, *hi).find(is_wrong),
        };
        found.map_or(Ok(()), |x| {
            Err(Error::input(format!(
                "the density is {} at {x:?}: it must be positive on the whole domain; raise its value or flatten its gradient",
                self.at(x)
            )))
        })
    }

    /// The mass of all of `container`.
    pub fn total(&self, container: &Container) -> f64 {
        match container {
            Container::Domain(domain) => self.at(middle(container)) * domain.volume(),
            Container::Box(lo, hi) => self.at(middle(container)) * (0..3).map(|k| hi[k] - lo[k]).product::<f64>(),
        }
    }

    /// The mass of each cell; 0 where it is empty.
    pub fn masses(&self, output: &Output) -> Vec<f64> {
        match self {
            Self::Uniform => output.volume().to_vec(),
            Self::Linear { .. } => {
                // An empty cell has no barycenter.
                let mass = |(&v, &b)| if v == 0.0 { 0.0 } else { self.at(b) * v };
                output.volume().iter().zip(output.barycenter()).map(mass).collect()
            }
        }
    }

    /// The centre of mass of each cell, NaN where it is empty. `None` where the density is not uniform and `output` is without second
    /// moments.
    pub fn centers(&self, output: &Output) -> Option<Vec<[f64; 3]>> {
        let Self::Linear { gradient: g, .. } = *self else { return Some(output.barycenter().to_vec()) };
        let moments = output.second_moment()?;
        let center = |i: usize| {
            let (b, [xx, yy, zz, xy, xz, yz]) = (output.barycenter()[i], moments[i]);
            let mass = self.at(b) * output.volume()[i];
            let pulled = [
                xx * g[0] + xy * g[1] + xz * g[2],
                xy * g[0] + yy * g[1] + yz * g[2],
                xz * g[0] + yz * g[1] + zz * g[2],
            ];
            std::array::from_fn(|k| b[k] + pulled[k] / mass)
        };
        Some((0..output.volume().len()).map(center).collect())
    }

    /// The transport cost `Σ_i ∫_i ‖x − p_i‖² dx` (length⁵) of a uniform density, from what `output` holds. `None` where that is without
    /// second moments, and for a linear density, which takes more: see [`Density::transport_cost`].
    pub fn cost(&self, positions: &[[f64; 3]], output: &Output) -> Option<f64> {
        let Self::Uniform = self else { return None };
        let mut cost = Sum::default();
        for (i, m) in output.second_moment()?.iter().enumerate() {
            let (v, b, p) = (output.volume()[i], output.barycenter()[i], positions[i]);
            if v != 0.0 {
                let d: [f64; 3] = std::array::from_fn(|k| b[k] - p[k]);
                cost.add(m[0] + m[1] + m[2] + v * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
            }
        }
        Some(cost.total())
    }

    /// The transport cost `Σ_i ∫_i ρ(x) ‖x − p_i‖² dx` (mass·length²) of the cells of `diagram` that `output` holds. `None` where that is
    /// without second moments.
    ///
    /// With a linear density this takes third moments, though only of the whole: with `o` its barycenter, `m_i` and `c_i` mass and centre
    /// of mass of a cell, it is `∫ρ‖x − o‖² + Σ_i m_i (p_i − o)·(p_i + o − 2 c_i)`. The terms are as large as the domain's size squared and
    /// cancel to a cell's; of the digits, as many are lost.
    ///
    /// # Errors
    /// As [`Backend::evaluate`].
    pub fn transport_cost(
        &self,
        backend: &dyn Backend,
        diagram: &PowerDiagram,
        output: &Output,
    ) -> Result<Option<f64>> {
        let Self::Linear { gradient: g, .. } = *self else { return Ok(self.cost(diagram.positions(), output)) };
        let (Some(_), Some(centers)) = (output.second_moment(), self.centers(output)) else { return Ok(None) };
        let mut cost = Sum::default();
        let container = diagram.container()?;
        let o = middle(&container);
        let rho = self.at(o);
        let mut terms = Vec::new();
        for k in 0..3 {
            let power = |j: usize, n: u32| {
                std::array::from_fn(|axis| if axis == k { 2 } else { 0 } + if axis == j { n } else { 0 })
            };
            terms.push((power(k, 0), rho));
            terms.extend((0..3).map(|j| (power(j, 1), g[j])));
        }
        let one = PowerDiagram::new(&[o], &[])?;
        let one = match container {
            Container::Domain(domain) => one.restricted_to(&domain),
            Container::Box(lo, hi) => one.in_box(lo, hi)?,
        };
        let request = Request::moments().with_integral(Integrand::polynomial(o, &terms)?);
        cost.extend(backend.evaluate(&one, &request)?.integral().into_iter().flatten().copied());
        for (i, mass) in self.masses(output).into_iter().enumerate() {
            if mass != 0.0 {
                let (c, p) = (centers[i], diagram.positions()[i]);
                (0..3).for_each(|k| cost.add_product(mass * (p[k] - o[k]), (p[k] - c[k]) + (o[k] - c[k])));
            }
        }
        Ok(Some(cost.total()))
    }
}

/// The barycenter of a container.
fn middle(container: &Container) -> [f64; 3] {
    match container {
        Container::Domain(domain) => domain.barycenter(),
        Container::Box(lo, hi) => std::array::from_fn(|k| lo[k] + (hi[k] - lo[k]) / 2.0),
    }
}

fn corners(lo: [f64; 3], hi: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    (0..8).map(move |c| std::array::from_fn(|k| if c >> k & 1 == 1 { hi[k] } else { lo[k] }))
}
