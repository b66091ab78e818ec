//! A concrete input, evaluated and looked at.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use laguerre_core::diagram::Container;
use laguerre_core::shapes::Mesh;
use laguerre_core::{Backend, Output, PowerDiagram, Request};

use crate::domains::Room;
use crate::sanity;

/// Sites, weights and what the cells are restricted to.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Sites (length).
    pub positions: Vec<[f64; 3]>,
    /// Weights (length²), or none.
    pub weights: Vec<f64>,
    /// The container.
    pub room: Room,
}

impl Scene {
    /// The scene of a diagram.
    ///
    /// # Errors
    /// The library's, in words, where there is no container.
    pub fn of(diagram: &PowerDiagram) -> Result<Self, String> {
        let room = match diagram.container().map_err(|error| error.to_string())? {
            Container::Box(lo, hi) => Room::Box(lo, hi),
            Container::Domain(domain) => {
                let mesh = Mesh { vertices: domain.vertices().to_vec(), triangles: domain.triangles().to_vec() };
                Room::Mesh(Arc::new(mesh), domain)
            }
        };
        Ok(Self { positions: diagram.positions().to_vec(), weights: diagram.weights().to_vec(), room })
    }

    /// The diagram of this scene.
    ///
    /// # Errors
    /// The library's, in words.
    pub fn diagram(&self) -> Result<PowerDiagram, String> {
        let diagram = PowerDiagram::new(&self.positions, &self.weights).map_err(|error| error.to_string())?;
        match &self.room {
            Room::Box(lo, hi) => diagram.in_box(*lo, *hi).map_err(|error| error.to_string()),
            Room::Mesh(_, domain) => Ok(diagram.restricted_to(domain)),
        }
    }

    /// What `backend` makes of this scene, and a look at whether it is in order ([`sanity::form`]).
    ///
    /// # Errors
    /// The library's, or what is out of order.
    pub fn evaluate(&self, backend: &dyn Backend, request: &Request) -> Result<Output, String> {
        let output = backend.evaluate(&self.diagram()?, request).map_err(|error| error.to_string())?;
        sanity::form(self.positions.len(), request, &output)?;
        Ok(output)
    }

    /// Volumes, barycenters and facets.
    ///
    /// # Errors
    /// As [`Scene::evaluate`].
    pub fn with_facets(&self, backend: &dyn Backend) -> Result<Output, String> {
        self.evaluate(backend, &Request::moments().with_facets())
    }

    /// Number of sites.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is no site.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Position of site `i`.
    pub fn site(&self, i: usize) -> DVec3 {
        DVec3::from(self.positions[i])
    }

    /// Weight of site `i`.
    pub fn weight(&self, i: usize) -> f64 {
        self.weights.get(i).copied().unwrap_or(0.0)
    }

    /// Power of `x` with respect to site `i` less that with respect to site `j` (length²): negative where `x` is `i`'s.
    /// Written as a difference, so that it loses nothing where both sites are far.
    pub fn power_difference(&self, x: DVec3, i: usize, j: usize) -> f64 {
        let (p, q) = (self.site(i), self.site(j));
        2.0 * (q - p).dot(x - 0.5 * (p + q)) - (self.weight(i) - self.weight(j))
    }

    /// For each site the lowest index of a site at the same position: itself, unless it is a duplicate.
    pub fn twins(&self) -> Vec<usize> {
        let mut first = HashMap::new();
        let key = |p: &[f64; 3]| p.map(|x| (x + 0.0).to_bits());
        self.positions.iter().enumerate().map(|(i, p)| *first.entry(key(p)).or_insert(i)).collect()
    }

    /// The same scene with its box given as a mesh; a scene in a mesh stays.
    #[must_use]
    pub fn meshed(&self) -> Self {
        match self.room {
            Room::Box(..) => Self { room: Room::of((*self.room.mesh()).clone()), ..self.clone() },
            Room::Mesh(..) => self.clone(),
        }
    }

    /// The scene moved by `x ↦ scale · turn · x + shift`, weights times scale². A box stays one where `turn` is the identity.
    #[must_use]
    pub fn moved(&self, turn: DMat3, scale: f64, shift: DVec3) -> Self {
        let matrix = scale * turn;
        let go = |x: [f64; 3]| <[f64; 3]>::from(matrix * DVec3::from(x) + shift);
        let room = match &self.room {
            Room::Box(lo, hi) if turn == DMat3::IDENTITY => Room::Box(go(*lo), go(*hi)),
            room => Room::of(room.mesh().transformed(matrix, shift)),
        };
        Self {
            positions: self.positions.iter().map(|&p| go(p)).collect(),
            weights: self.weights.iter().map(|w| w * scale * scale).collect(),
            room,
        }
    }
}

/// One facet of an output.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// The site beyond it.
    pub neighbor: usize,
    /// Area (length²).
    pub area: f64,
    /// Barycenter.
    pub barycenter: DVec3,
    /// Distance of the two sites (length).
    pub distance: f64,
}

/// The facets of each cell of an output that has them.
pub fn rows(output: &Output) -> Vec<Vec<Facet>> {
    let Some(facets) = &output.facets else { return vec![Vec::new(); output.status.len()] };
    let facet = |f: usize| Facet {
        neighbor: facets.neighbor[f].site as usize,
        area: facets.area[f],
        barycenter: DVec3::from(facets.barycenter[f]),
        distance: facets.distance[f],
    };
    facets.offsets.windows(2).map(|row| (row[0]..row[1]).map(facet).collect()).collect()
}
