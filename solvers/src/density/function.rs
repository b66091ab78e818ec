//! Densities that are functions, sums of Gaussians among them: known by their values alone, and integrated by quadrature.

use laguerre_core::{Backend, Error, Facet, Integrand, Observer, Output, PowerDiagram, Request, Result};
use std::f64::consts::TAU;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use super::Density;

/// What is integrated where there are to be centres of mass and the cost: `ρ`, `ρ (x − o)`, `ρ ‖x − o‖²`.
pub(super) const COLUMNS: usize = 5;

/// A function with the degree of the rule that integrates it: see [`Density::function`]. Two are equal where they are clones.
#[derive(Clone)]
pub struct Function {
    degree: u32,
    value: Arc<dyn Fn([f64; 3]) -> f64 + Send + Sync>,
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

/// Whether an error of a solver says that a function is not positive and finite where a density has to be: no step mends that.
pub fn is_of_density(error: &Error) -> bool {
    std::error::Error::source(error).is_some_and(|source| source.is::<NotPositive>())
}

impl Function {
    pub(super) fn new(degree: u32, value: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Result<Self> {
        // What is beyond the largest degree is said there.
        Integrand::function(degree, |_| 0.0)?;
        Ok(Self { degree, value: Arc::new(value) })
    }

    pub(super) fn of_gaussians(degree: u32, constant: f64, gaussians: &[Gaussian]) -> Result<Self> {
        if !(constant >= 0.0 && constant.is_finite()) {
            return Err(Error::input(format!("the constant {constant} of Gaussians: a number from 0 is needed")));
        }
        let value = |(i, gaussian): (usize, &Gaussian)| {
            gaussian.value().ok_or_else(|| {
                Error::input(format!(
                    "Gaussian {i}, {gaussian:?}: a finite mean, a symmetric positive definite covariance and a positive mass are needed"
                ))
            })
        };
        let each = gaussians.iter().enumerate().map(value).collect::<Result<Vec<_>>>()?;
        Self::new(degree, move |x| constant + each.iter().map(|gaussian| gaussian(x)).sum::<f64>())
    }

    /// The function at `x`.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        (self.value)(x)
    }

    /// Up to which total degree the rule is exact.
    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// The mean over a facet of this second moment: by Gauss's rule of three nodes a side of the parallelogram that has the moment, exact to the second
    /// degree, and to the third where the facet is its own mirror image.
    ///
    /// It is for the matrix of a Newton step alone, which need not be exact: each step leaves of the error the part that the matrix is off, some `(h/ℓ)³`, where `h`
    /// is a facet's size and `ℓ` the length over which ρ changes. Of 300 white sites in a cube, with three Gaussians whose deviations are two cells, one
    /// and a half, it takes 5, 10 and 11 steps to 1e-9; with ρ at the facet's barycenter, which leaves `(h/ℓ)²`, it took 7, 26 and 33.
    pub(super) fn mean(&self, facet: &Facet, second: &[f64; 6], bounds: Option<[[f64; 3]; 2]>) -> f64 {
        let [lo, hi] = bounds.unwrap_or([[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]]);
        let spread = sides(second.map(|m| m / facet.area));
        let mut mean = 0.0;
        for (u, share_u) in GAUSS {
            for (v, share_v) in GAUSS {
                // (The parallelogram reaches a little beyond the facet.)
                let node = |k: usize| facet.barycenter[k] + u * spread[0][k] + v * spread[1][k];
                let value = self.at(std::array::from_fn(|k| node(k).clamp(lo[k], hi[k])));
                if value.is_nan() || value <= 0.0 {
                    return self.at(facet.barycenter);
                }
                mean += share_u * share_v * value;
            }
        }
        // A facet that the domain cuts may have nodes where ρ is not asked for otherwise, and need not be positive.
        if mean.is_finite() { mean } else { self.at(facet.barycenter) }
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
        let (function, noted) = (Arc::clone(&self.value), Arc::clone(&found));
        let value = move |x: [f64; 3]| {
            let value = function(x);
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
        let integrand = match about {
            None => Integrand::function(self.degree, value)?,
            Some(o) => Integrand::batches(self.degree, COLUMNS, move |places| {
                let columns = |&x: &[f64; 3]| {
                    let (rho, [a, b, c]): (f64, [f64; 3]) = (value(x), std::array::from_fn(|k| x[k] - o[k]));
                    [rho, rho * a, rho * b, rho * c, rho * (a * a + b * b + c * c)]
                };
                Ok(places.iter().flat_map(columns).collect())
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
        self.degree == other.degree && Arc::ptr_eq(&self.value, &other.value)
    }
}
