//! Densities that are functions, sums of Gaussians among them: known by their values alone, and integrated by quadrature.

use laguerre_core::integrand::Batch;
use laguerre_core::parallel;
use laguerre_core::{
    Backend, Error, ErrorKind, Facet, Facets, Integrand, Observer, Output, PowerDiagram, Request, Result,
};
use std::f64::consts::TAU;
use std::fmt;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use super::Density;

/// What is integrated where there are to be centres of mass and the cost: `ρ`, `ρ (x − o)`, `ρ ‖x − o‖²`.
pub(super) const COLUMNS: usize = 5;

/// A function with the degree of the rule that integrates it: see [`Density::function`]. Two are equal where they are clones.
#[derive(Clone)]
pub struct Function {
    degree: u32,
    value: Value,
}

/// How it is called.
#[derive(Clone)]
enum Value {
    /// Place by place.
    Each(Arc<dyn Fn([f64; 3]) -> f64 + Send + Sync>),
    /// With many places at once.
    Many(Batch),
}

impl Value {
    fn of(&self, places: &[[f64; 3]]) -> Result<Vec<f64>> {
        let values = match self {
            Self::Each(value) => return Ok(places.iter().map(|&x| value(x)).collect()),
            Self::Many(values) => values(places),
        };
        let values = values.map_err(|error| match error.kind() {
            ErrorKind::Input => Error::input(error.to_string()).because(Refused),
            _ => error,
        })?;
        if values.len() != places.len() {
            let message =
                format!("density: {} values for {} places: one for each is needed", values.len(), places.len());
            return Err(Error::input(message).because(Refused));
        }
        Ok(values)
    }
}

/// A normal distribution in space: `mass · N(x; mean, covariance)`, whose integral over all of space is `mass`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Where it is largest.
    pub mean: [f64; 3],
    /// Symmetric and positive definite (length²).
    pub covariance: [[f64; 3]; 3],
    /// Positive. What of it lies in the domain counts for that alone.
    pub mass: f64,
}

impl Gaussian {
    /// A round one of the same standard deviation (length) along every direction.
    pub fn round(mean: [f64; 3], deviation: f64, mass: f64) -> Self {
        let covariance =
            std::array::from_fn(|r| std::array::from_fn(|c| if r == c { deviation * deviation } else { 0.0 }));
        Self { mean, covariance, mass }
    }

    /// Its value at each place.
    fn value(&self) -> Option<impl Fn([f64; 3]) -> f64 + use<>> {
        let Self { mean, covariance: s, mass } = *self;
        let is_symmetric = (0..3).all(|k| s[k][(k + 1) % 3] == s[(k + 1) % 3][k]);
        // Cholesky's factor.
        let a = s[0][0].sqrt();
        let (b, d) = (s[1][0] / a, s[2][0] / a);
        let c = (s[1][1] - b * b).sqrt();
        let e = (s[2][1] - d * b) / c;
        let f = (s[2][2] - d * d - e * e).sqrt();
        let top = mass / (TAU.powf(1.5) * a * c * f);
        let is_one = is_symmetric && top > 0.0 && top.is_finite() && mean.iter().all(|x| x.is_finite());
        is_one.then_some(move |x: [f64; 3]| {
            let [x, y, z]: [f64; 3] = std::array::from_fn(|k| x[k] - mean[k]);
            let u = x / a;
            let v = (y - b * u) / c;
            let w = (z - d * u - e * v) / f;
            top * (-0.5 * (u * u + v * v + w * w)).exp()
        })
    }
}

/// A value that a density must not have.
#[derive(Debug)]
struct NotPositive {
    place: [f64; 3],
    value: f64,
}

impl fmt::Display for NotPositive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the density is {} at {:?}", self.value, self.place)
    }
}

impl std::error::Error for NotPositive {}

/// A function of many places has no values, or not as many as it should.
#[derive(Debug)]
struct Refused;

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the density has no values, or no mass")
    }
}

impl std::error::Error for Refused {}

/// The error of a density that is no fault of a place where it is asked for.
pub(super) fn refused(what: String) -> Error {
    Error::input(what).because(Refused)
}

/// Whether an error of a solver says that a function is not positive and finite where a density has to be, or has no values: no step mends that.
pub fn is_of_density(error: &Error) -> bool {
    std::error::Error::source(error).is_some_and(|source| source.is::<NotPositive>() || source.is::<Refused>())
}

impl Function {
    pub(super) fn new(degree: u32, value: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Result<Self> {
        Self::called(degree, Value::Each(Arc::new(value)))
    }

    fn called(degree: u32, value: Value) -> Result<Self> {
        // What is beyond the largest degree is said there.
        Integrand::function(degree, |_| 0.0)?;
        Ok(Self { degree, value })
    }

    pub(super) fn of_gaussians(degree: u32, constant: f64, gaussians: &[Gaussian]) -> Result<Self> {
        if !(constant >= 0.0 && constant.is_finite()) {
            return Err(Error::input(format!("the constant {constant} of Gaussians: a number from 0 is needed")));
        }
        let value = |(i, gaussian): (usize, &Gaussian)| {
            gaussian.value().ok_or_else(|| {
                let Gaussian { mean, covariance, mass } = gaussian;
                Error::input(format!(
                    "Gaussian {i}, of mean {mean:?}, covariance {covariance:?} and mass {mass:?}: a finite mean, a symmetric positive definite covariance and a positive mass are needed"
                ))
            })
        };
        let each = gaussians.iter().enumerate().map(value).collect::<Result<Vec<_>>>()?;
        Self::new(degree, move |x| constant + each.iter().map(|gaussian| gaussian(x)).sum::<f64>())
    }

    /// The function at `x`; NaN where it answers with an error.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        match &self.value {
            Value::Each(value) => value(x),
            Value::Many(_) => self.value.of(&[x]).map_or(f64::NAN, |values| values[0]),
        }
    }

    /// Up to which total degree the rule is exact.
    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// The mass of each facet, which has this second moment: the mean by Gauss's rule of three nodes a side of the parallelogram that has the moment, exact to the second
    /// degree, and to the third where the facet is its own mirror image. The function is called within `bounds` alone, where they are given.
    ///
    /// It is for the matrix of a Newton step alone, which need not be exact: each step leaves of the error the part that the matrix is off, some `(h/ℓ)³`, where `h`
    /// is a facet's size and `ℓ` the length over which ρ changes. Of 300 white sites in a cube, with three Gaussians whose deviations are two cells, one
    /// and a half, it takes 5, 10 and 11 steps to 1e-9; with ρ at the facet's barycenter, which leaves `(h/ℓ)²`, it took 7, 26 and 33.
    ///
    /// # Errors
    /// That of a function of many places.
    pub(super) fn of_facets(
        &self,
        facets: &Facets,
        seconds: &[[f64; 6]],
        bounds: Option<[[f64; 3]; 2]>,
    ) -> Result<Vec<f64>> {
        let masses = |range: Range<usize>| {
            let places: Vec<[f64; 3]> =
                range.clone().flat_map(|k| nodes(&facets.get(k), &seconds[k], bounds)).collect();
            let values = self.value.of(&places)?;
            let each = range.zip(values.as_chunks().0);
            Ok(each.map(|(k, values)| mean(values) * facets.get(k).area).collect::<Vec<f64>>())
        };
        let chunks = parallel::chunks(seconds.len(), FACETS_AT_ONCE, masses);
        Ok(chunks.into_iter().collect::<Result<Vec<_>>>()?.concat())
    }

    /// Evaluates a diagram with the masses of its cells as integrals, or with all [`COLUMNS`] about `o`.
    pub(super) fn evaluate(
        &self,
        backend: &dyn Backend,
        diagram: &PowerDiagram,
        request: &Request,
        about: Option<[f64; 3]>,
        observer: &dyn Observer,
    ) -> Result<Output> {
        if request.integral().is_some() {
            return Err(Error::input(
                "the request has an integral of its own beside that of the density: evaluate them one after the other",
            ));
        }
        let found = Arc::new(Mutex::new(None));
        let noted = Arc::clone(&found);
        let checked = move |x: [f64; 3], value: f64| {
            if value > 0.0 && value.is_finite() {
                return value;
            }
            // Noted and gone on from, so that what is said does not depend on threads.
            let mut noted = noted.lock().unwrap_or_else(PoisonError::into_inner);
            if noted.is_none_or(|(first, _)| x < first) {
                *noted = Some((x, value));
            }
            0.0
        };
        let values = self.value.clone();
        let integrand = match (about, &self.value) {
            (None, Value::Each(value)) => {
                let value = Arc::clone(value);
                Integrand::function(self.degree, move |x| checked(x, value(x)))?
            }
            (None, Value::Many(_)) => Integrand::batches(self.degree, 1, move |places| {
                let found = values.of(places)?;
                Ok(places.iter().zip(found).map(|(&x, value)| checked(x, value)).collect())
            })?,
            (Some(o), _) => Integrand::batches(self.degree, COLUMNS, move |places| {
                let columns = |(&x, value): (&[f64; 3], f64)| {
                    let (rho, [a, b, c]): (f64, [f64; 3]) = (checked(x, value), std::array::from_fn(|k| x[k] - o[k]));
                    [rho, rho * a, rho * b, rho * c, rho * (a * a + b * b + c * c)]
                };
                Ok(places.iter().zip(values.of(places)?).flat_map(columns).collect())
            })?,
        };
        let output = backend.evaluate_watched(diagram, &request.clone().with_integral(integrand), observer);
        let first = *found.lock().unwrap_or_else(PoisonError::into_inner);
        match first {
            None => output,
            Some((place, value)) => {
                let wrong = NotPositive { place, value };
                let message = format!(
                    "{wrong}: it must be positive and finite wherever it is evaluated, which is up to half of a domain's extent beyond it, too; a constant added to it may help"
                );
                Err(Error::input(message).because(wrong))
            }
        }
    }
}

/// The nodes of Gauss's rule in standard deviations of what is spread evenly from −√3 to √3, and their shares.
const GAUSS: [(f64, f64); 3] =
    [(-1.341_640_786_499_874, 5.0 / 18.0), (0.0, 4.0 / 9.0), (1.341_640_786_499_874, 5.0 / 18.0)];

/// Places at which a facet asks for ρ: the nodes of the rule on each side of its parallelogram, and its barycenter.
const NODES: usize = 10;
/// So many that calling a function of many places costs nothing, and their places are some megabytes.
const FACETS_AT_ONCE: usize = 10_000;

fn nodes(facet: &Facet, second: &[f64; 6], bounds: Option<[[f64; 3]; 2]>) -> [[f64; 3]; NODES] {
    let [lo, hi] = bounds.unwrap_or([[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]]);
    let spread = sides(second.map(|m| m / facet.area));
    std::array::from_fn(|n| match n {
        // (The parallelogram reaches a little beyond the facet.)
        0..9 => std::array::from_fn(|k| {
            let node = facet.barycenter[k] + GAUSS[n / 3].0 * spread[0][k] + GAUSS[n % 3].0 * spread[1][k];
            node.clamp(lo[k], hi[k])
        }),
        _ => facet.barycenter,
    })
}

/// The mean of ρ over a facet from its values at the nodes.
fn mean(values: &[f64; NODES]) -> f64 {
    let mut mean = 0.0;
    for (n, &value) in values[..NODES - 1].iter().enumerate() {
        // A facet that the domain cuts may have nodes where ρ is not asked for otherwise, and need not be positive.
        if value.is_nan() || value <= 0.0 {
            return values[NODES - 1];
        }
        mean += GAUSS[n / 3].1 * GAUSS[n % 3].1 * value;
    }
    if mean.is_finite() { mean } else { values[NODES - 1] }
}

/// Two vectors a and b with `a aᵀ + b bᵀ` a second moment of something flat: the columns of Cholesky's factor, the largest pivots first.
fn sides([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [[f64; 3]; 2] {
    let mut m = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    std::array::from_fn(|_| {
        let pivot = (0..3).max_by(|&i, &j| m[i][i].total_cmp(&m[j][j])).unwrap_or(0);
        if m[pivot][pivot] <= 0.0 {
            return [0.0; 3];
        }
        let column = m[pivot].map(|x| x / m[pivot][pivot].sqrt());
        (0..3).for_each(|r| (0..3).for_each(|c| m[r][c] -= column[r] * column[c]));
        column
    })
}

impl Density {
    /// A function of place, which is called from all threads, integrated over each cell by a quadrature rule that is exact for polynomials up to
    /// `degree` (0 to 31; see [`Integrand`] for its cost and error). Centres of mass and the cost are integrated by the same rule, which
    /// is exact for them where ρ is a polynomial of a degree lower by 1 and 2.
    ///
    /// # Errors
    /// `Input` where the degree is beyond [`LARGEST_DEGREE`](laguerre_core::integrand::LARGEST_DEGREE).
    pub fn function(degree: u32, value: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Result<Self> {
        Ok(Self::Function(Function::new(degree, value)?))
    }

    /// The same of a function that is called with many places at once, and has a value for each. Where an error is its answer, that is the solver's.
    ///
    /// # Errors
    /// As [`Density::function`].
    pub fn batches(
        degree: u32,
        values: impl Fn(&[[f64; 3]]) -> Result<Vec<f64>> + Send + Sync + 'static,
    ) -> Result<Self> {
        Ok(Self::Function(Function::called(degree, Value::Many(Arc::new(values)))?))
    }

    /// The function `constant + Σ mass · N(x; mean, covariance)`, as [`Density::function`]. All Gaussians are summed up at every node. What
    /// underflows to 0, some 38 deviations from every mean, takes a constant. Cells are to be no larger than the deviations, or the degree is
    /// to be high: over 300 cells in a cube, three of a cell's deviation and a constant sum to the exact mass within 4e-5 of it with degree 3, 7e-6 with 5; of half
    /// that deviation within 5e-3 and 1.3e-4.
    ///
    /// # Errors
    /// `Input` where the degree is beyond [`LARGEST_DEGREE`](laguerre_core::integrand::LARGEST_DEGREE), the constant is no number from 0, or a Gaussian is not one.
    pub fn gaussians(degree: u32, constant: f64, gaussians: &[Gaussian]) -> Result<Self> {
        Ok(Self::Function(Function::of_gaussians(degree, constant, gaussians)?))
    }
}

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Function of degree {}", self.degree)
    }
}

impl PartialEq for Function {
    fn eq(&self, other: &Self) -> bool {
        let is_same = match (&self.value, &other.value) {
            (Value::Each(one), Value::Each(other)) => Arc::ptr_eq(one, other),
            (Value::Many(one), Value::Many(other)) => Arc::ptr_eq(one, other),
            _ => false,
        };
        self.degree == other.degree && is_same
    }
}
