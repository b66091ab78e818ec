//! What to compute: a [`Request`].

use crate::PowerDiagram;
use crate::diagram::Container;
use crate::{Error, Integrand, Result};

/// What to compute for every cell. Volumes and barycenters always; the rest on request.
#[derive(Clone, Debug, Default)]
pub struct Request {
    facets: bool,
    laplacian: bool,
    /// Only with `laplacian`.
    keeps_laplacian: bool,
    weights_will_differ: bool,
    second_moments: bool,
    /// Only with `facets`.
    facet_second_moments: bool,
    geometry: bool,
    /// Only with `geometry`.
    solids: bool,
    integral: Option<Integrand>,
    epsilon: Option<f64>,
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

    /// Also the [`Laplacian`](crate::Laplacian): of the facets no more than what their areas come to. A device keeps all else for itself: a whole call takes
    /// two thirds of what it does with facets.
    #[must_use]
    pub fn with_laplacian(self) -> Self {
        Self { laplacian: true, keeps_laplacian: false, ..self }
    }

    /// Also the Laplacian, which stays in the memory of a backend that has an [`algebra`](crate::Backend::algebra) and room for it: the output then says
    /// [`kept`](crate::Output::kept). Of others it comes back.
    #[must_use]
    pub fn with_laplacian_kept(self) -> Self {
        Self { laplacian: true, keeps_laplacian: true, ..self }
    }

    /// The same, where weights will differ in what is evaluated next, as by a solver that begins with equal ones: a device then has no kernels built for
    /// equal weights, but takes those for any. (Last bits may be others than without.)
    #[must_use]
    pub fn with_weights_to_differ(self) -> Self {
        Self { weights_will_differ: true, ..self }
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
    ///
    /// Not in a domain that has a density, which evaluations refuse: faces stand as often as the winding number says, and there that is the density,
    /// as a multiple of a unit, of up to 2²⁸.
    #[must_use]
    pub fn with_geometry(self) -> Self {
        Self { geometry: true, ..self }
    }

    /// Also the geometry, as [`Request::with_geometry`] does, and every cell that is not convex as convex solids; where
    /// the winding number is negative, they are turned inside out.
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

    /// Stop each cell at the paper's security radius enlarged by the factor `1 + ε` (paper §2.3), with no certificate: cells for which that
    /// cannot be shown to suffice are marked `Uncertified`.
    #[must_use]
    pub fn with_epsilon(self, epsilon: f64) -> Self {
        Self { epsilon: Some(epsilon), ..self }
    }

    /// The same with a proof for every cell.
    #[must_use]
    pub fn without_epsilon(self) -> Self {
        Self { epsilon: None, ..self }
    }

    /// Whether facets are asked for, with every neighbour, and the cell's piece of the boundary.
    pub fn facets(&self) -> bool {
        self.facets
    }

    /// Whether the Laplacian is.
    pub fn laplacian(&self) -> bool {
        self.laplacian
    }

    /// Whether it may stay with the backend.
    pub fn keeps_laplacian(&self) -> bool {
        self.keeps_laplacian
    }

    /// Whether weights will differ in what is evaluated next.
    pub fn weights_will_differ(&self) -> bool {
        self.weights_will_differ
    }

    /// Whether facets are to be integrated, for themselves or for the Laplacian.
    #[doc(hidden)]
    pub fn needs_facets(&self) -> bool {
        self.facets || self.laplacian
    }

    /// Whether second moments are.
    pub fn second_moments(&self) -> bool {
        self.second_moments
    }

    /// Whether second moments of the facets are, which are then asked for.
    pub fn facet_second_moments(&self) -> bool {
        self.facet_second_moments
    }

    /// Whether the cells as polygons are.
    pub fn geometry(&self) -> bool {
        self.geometry
    }

    /// Whether the cells as convex solids are, and as polygons then.
    pub fn solids(&self) -> bool {
        self.solids
    }

    /// The function that is to be integrated over every cell.
    pub fn integral(&self) -> Option<&Integrand> {
        self.integral.as_ref()
    }

    /// The ε of [`Request::with_epsilon`].
    pub fn epsilon(&self) -> Option<f64> {
        self.epsilon
    }
}
