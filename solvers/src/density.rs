//! Densities over a domain: uniform, linear, or any function.

mod function;

use crate::vectors::{copied, distance2, map, sum_of, total};
use laguerre_core::diagram::Container;
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, Error, Facets, Integrand, Observer, Output, PowerDiagram, Request, Result};

use function::COLUMNS;
pub use function::{Function, Gaussian, is_of_density};

/// A density `ρ` (mass per volume) on the whole of a container.
///
/// The uniform and the linear need no more than the integrals that [`Output`] has, and are exact: with `V` the volume and `b` the barycenter of a
/// cell, its mass is `ρ(b)·V`, its first moment `V ρ(b) b + M₂ g`, where `M₂` is its second moment about `b`; a facet has the mass
/// `ρ(b_f)·area`.
///
/// A function is integrated over the cells by quadrature ([`Integrand`]), in the evaluation that [`Density::evaluate`] asks for, and only by a backend
/// that can call it: the CPU's. What is not within the rule's degree is off by what [`Integrand`] leaves out, and so are masses, centres and cost.
///
/// Where a domain has a density of its own (of voxels, of tetrahedra), the two are multiplied.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// Any that is positive: [`Density::function`], [`Density::batches`], [`Density::gaussians`].
    Function(Function),
}

impl Density {
    /// `ρ(x)`.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Linear { value, gradient: [a, b, c] } => value + (a * x[0] + b * x[1] + c * x[2]),
            Self::Function(function) => function.at(x),
        }
    }

    /// Checks that the density is positive on all of `container`: the least value of a linear one is at a vertex or a corner. Of a function nothing is
    /// known before it is evaluated: then its first value that is not positive and finite, in the order of places, is an error.
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

    /// The mass of all of the container of `diagram`. That of a function is the sum over the cells of `diagram`, which takes an evaluation: the more
    /// cells, the nearer.
    ///
    /// # Errors
    /// With a function as [`Density::evaluate`]; `Input` where its mass is beyond all numbers.
    pub fn total(&self, backend: &dyn Backend, diagram: &PowerDiagram) -> Result<f64> {
        let container = diagram.container()?;
        let Self::Function(_) = self else { return Ok(self.at(middle(&container)) * container.volume()) };
        let mut total = Sum::default();
        let output = self.evaluate(backend, diagram, &Request::moments())?;
        total.extend(self.masses(&output).into_iter().flatten());
        let total = total.total();
        if total > 0.0 && total.is_finite() {
            return Ok(total);
        }
        Err(function::refused(format!(
            "the density's mass over the domain is {total:?}: give a higher degree, or choose another unit of mass"
        )))
    }

    /// Evaluates `diagram` for what `request` asks, and for what [`Density::masses`] needs.
    ///
    /// # Errors
    /// As [`Backend::evaluate`], which refuses a function where it cannot call one; `Input` for a function that is somewhere not positive or not finite, or where `request` has an
    /// integral of its own beside it.
    pub fn evaluate(&self, backend: &dyn Backend, diagram: &PowerDiagram, request: &Request) -> Result<Output> {
        match self {
            Self::Uniform | Self::Linear { .. } => backend.evaluate(diagram, request),
            Self::Function(function) => function.evaluate(backend, diagram, request, None, &()),
        }
    }

    /// The same for what also [`Density::centers`] and [`Density::transport_cost`] need. With a function each cell is computed six times.
    ///
    /// # Errors
    /// As [`Density::evaluate`].
    pub fn evaluate_moments(&self, backend: &dyn Backend, diagram: &PowerDiagram, request: &Request) -> Result<Output> {
        self.evaluate_moments_watched(backend, diagram, request, &())
    }

    /// The same, watched.
    pub(crate) fn evaluate_moments_watched(
        &self,
        backend: &dyn Backend,
        diagram: &PowerDiagram,
        request: &Request,
        observer: &dyn Observer,
    ) -> Result<Output> {
        let request = request.clone().with_second_moments();
        match self {
            Self::Uniform | Self::Linear { .. } => backend.evaluate_watched(diagram, &request, observer),
            Self::Function(function) => {
                function.evaluate(backend, diagram, &request, Some(middle(&diagram.container()?)), observer)
            }
        }
    }

    /// What it is everywhere, if it is the same.
    pub(crate) fn constant(&self) -> Option<f64> {
        match *self {
            Self::Uniform => Some(1.0),
            Self::Linear { value, gradient: [0.0, 0.0, 0.0] } => Some(value),
            _ => None,
        }
    }

    /// The mass of each cell; 0 where it is empty. `None` where the density is a function and `output` has no integrals, as those of [`Density::evaluate`] have.
    pub fn masses(&self, output: &Output) -> Option<Vec<f64>> {
        match self {
            Self::Uniform => Some(copied(output.volume())),
            Self::Linear { .. } => {
                // An empty cell has no barycenter.
                let mass = |v: f64, b| if v == 0.0 { 0.0 } else { self.at(b) * v };
                Some(map(output.sites(), |i| mass(output.volume()[i], output.barycenter()[i])))
            }
            Self::Function(_) => {
                let integrals = output.integral()?;
                let columns = integrals.len() / output.sites();
                Some(map(output.sites(), |i| integrals[i * columns]))
            }
        }
    }

    /// The mass of each facet: of a function near it, and nearer where there are second moments; it is called within `bounds` alone, where they are given.
    ///
    /// # Errors
    /// That of a function of many places.
    pub(crate) fn of_facets(&self, facets: &Facets, bounds: Option<[[f64; 3]; 2]>) -> Result<Vec<f64>> {
        if let (Self::Function(function), Some(seconds)) = (self, facets.second_moment()) {
            return function.of_facets(facets, seconds, bounds);
        }
        let mass = |k: usize| {
            let facet = facets.get(k);
            self.at(facet.barycenter) * facet.area
        };
        Ok(map(facets.len(), mass))
    }

    /// The centre of mass of each cell of `diagram`, NaN where it is empty. `None` where the density is not uniform and `output` is not of
    /// [`Density::evaluate_moments`], which has second moments.
    pub fn centers(&self, diagram: &PowerDiagram, output: &Output) -> Option<Vec<[f64; 3]>> {
        let g = match self {
            Self::Uniform => return Some(output.barycenter().to_vec()),
            Self::Linear { gradient, .. } => gradient,
            Self::Function(_) => {
                let o = middle(&diagram.container().ok()?);
                let center = |&[m, x, y, z, _]: &[f64; COLUMNS]| [x / m + o[0], y / m + o[1], z / m + o[2]];
                return Some(columns(output)?.iter().map(center).collect());
            }
        };
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

    /// The transport cost `Σ_i ∫_i ρ(x) ‖x − p_i‖² dx` (mass·length²) from what `output` holds. `None` where that is not of [`Density::evaluate_moments`],
    /// which has second moments, and for a linear density, which takes more: see [`Density::transport_cost`].
    pub fn cost(&self, diagram: &PowerDiagram, output: &Output) -> Option<f64> {
        match self {
            Self::Linear { .. } => None,
            _ => self.cost_of(0.0, diagram, output),
        }
    }

    /// The same for any density, a linear one's from its [`Density::spread`].
    pub(crate) fn cost_of(&self, spread: f64, diagram: &PowerDiagram, output: &Output) -> Option<f64> {
        let (n, positions) = (output.sites(), diagram.positions());
        match self {
            Self::Uniform => {
                let (volumes, centers, moments) = (output.volume(), output.barycenter(), output.second_moment()?);
                let cost = |i: usize| {
                    let [xx, yy, zz, ..] = moments[i];
                    xx + yy + zz + volumes[i] * distance2(centers[i], positions[i])
                };
                Some(total(n, |i| if volumes[i] == 0.0 { 0.0 } else { cost(i) }))
            }
            Self::Linear { .. } => {
                let o = middle(&diagram.container().ok()?);
                let (centers, masses) = (self.centers(diagram, output)?, self.masses(output)?);
                let mut all = sum_of(n, |i, cost| {
                    if masses[i] != 0.0 {
                        let (m, c, p) = (masses[i], centers[i], positions[i]);
                        (0..3).for_each(|k| cost.add_product(m * (p[k] - o[k]), (p[k] - c[k]) + (o[k] - c[k])));
                    }
                });
                all.add(spread);
                Some(all.total())
            }
            Self::Function(_) => {
                let o = middle(&diagram.container().ok()?);
                let columns = columns(output)?;
                let cost = |i: usize, cost: &mut Sum| {
                    let [m, x, y, z, square] = columns[i];
                    let d: [f64; 3] = std::array::from_fn(|k| positions[i][k] - o[k]);
                    cost.add(square);
                    (0..3).for_each(|k| cost.add_product(d[k], d[k] * m - 2.0 * [x, y, z][k]));
                };
                Some(sum_of(n, cost).total())
            }
        }
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
        if output.second_moment().is_none() {
            return Ok(None);
        }
        Ok(self.cost_of(self.spread(backend, diagram)?, diagram, output))
    }

    /// Of a linear density `∫ρ ‖x − o‖² dx` over the container of `diagram`, `o` its barycenter: what the cost takes of third moments. It does not depend on the
    /// sites, and is 0 with other densities.
    ///
    /// # Errors
    /// As [`Backend::evaluate`].
    pub(crate) fn spread(&self, backend: &dyn Backend, diagram: &PowerDiagram) -> Result<f64> {
        let Self::Linear { gradient: g, .. } = *self else { return Ok(0.0) };
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
        Ok(backend.evaluate(&one, &request)?.integral().into_iter().flatten().sum())
    }
}

/// What [`Density::evaluate_moments`] has of each cell, with a function.
fn columns(output: &Output) -> Option<&[[f64; COLUMNS]]> {
    let (columns, rest) = output.integral()?.as_chunks();
    (rest.is_empty() && columns.len() == output.sites()).then_some(columns)
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
