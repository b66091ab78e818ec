//! What to compute: a [`Request`].

use crate::PowerDiagram;
use crate::diagram::Container;
use crate::{Error, Integrand, Result};

/// What to compute for every cell. Volumes and barycenters always; the rest on request.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Request {
    /// Facets with every neighbour, and the cell's piece of the boundary.
    pub facets: bool,
    /// Second moments.
    pub second_moments: bool,
    /// Second moments of the facets; only with `facets`.
    pub facet_second_moments: bool,
    /// The cells as polygons.
    pub geometry: bool,
    /// The cells as convex solids; only with `geometry`.
    pub solids: bool,
    /// A function to be integrated over every cell.
    pub integral: Option<Integrand>,
    /// `Some(ε)`: stop each cell at the paper's security radius enlarged by the factor `1 + ε` (paper §2.3), with no
    /// certificate: cells for which that cannot be shown to suffice are marked `Uncertified`.
    pub epsilon: Option<f64>,
}

impl Request {
    /// Volumes and barycenters.
    pub fn moments() -> Self {
        Self::default()
    }

    /// Also the facets shared with each neighbour, and the cell's piece of the boundary.
    #[must_use]
    pub fn with_facets(self) -> Self {
        Self { facets: true, ..self }
    }

    /// Also the second moments.
    #[must_use]
    pub fn with_second_moments(self) -> Self {
        Self { second_moments: true, ..self }
    }

    /// Also the facets, as [`Request::with_facets`] does, with their second moments.
    #[must_use]
    pub fn with_facet_second_moments(self) -> Self {
        Self { facets: true, facet_second_moments: true, ..self }
    }

    /// Also the geometry of the restricted cells as polygons. The CPU makes it in the pass that integrates, at about the cost of
    /// facets where cells have few triangles of the domain in them; what other backends compute the host then computes once more, for this alone.
    #[must_use]
    pub fn with_geometry(self) -> Self {
        Self { geometry: true, ..self }
    }

    /// Also the geometry, as [`Request::with_geometry`] does, and every cell that is not convex as convex solids.
    #[must_use]
    pub fn with_solids(self) -> Self {
        Self { geometry: true, solids: true, ..self }
    }

    /// Also the integral of a given function over each cell: a polynomial on any backend of double precision, a function of the caller's on
    /// the CPU alone.
    #[must_use]
    pub fn with_integral(self, integrand: Integrand) -> Self {
        Self { integral: Some(integrand), ..self }
    }

    /// Refuses numbers that are none, and what a diagram cannot have. Called by backends.
    ///
    /// # Errors
    /// `Input` where `epsilon` is not a number from 0, or geometry is asked for in a domain that has a density.
    #[doc(hidden)]
    pub fn check(&self, diagram: &PowerDiagram) -> Result<()> {
        if self.geometry && matches!(diagram.container()?, Container::Domain(domain) if domain.has_density()) {
            return Err(Error::input(
                "geometry: cells of a domain with a density have none: ask for it in the domain's mesh, or in a box",
            ));
        }
        match self.epsilon {
            Some(epsilon) if epsilon.is_nan() || epsilon < 0.0 => {
                Err(Error::input(format!("epsilon {epsilon}: a number from 0 is needed")))
            }
            _ => Ok(()),
        }
    }

    /// Stop at the paper's enlarged security radius instead of a proof (see [`Request::epsilon`]).
    #[must_use]
    pub fn with_epsilon(self, epsilon: f64) -> Self {
        Self { epsilon: Some(epsilon), ..self }
    }
}
