//! A concrete input, evaluated and looked at.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use laguerre_core::{Backend, CellStatus, Output, PowerDiagram, Request};

use crate::Verdict;
use crate::domains::Room;

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

    /// What `backend` makes of this scene, and a look at whether it is in order ([`sanity_check`]).
    ///
    /// # Errors
    /// The library's, or what is out of order.
    pub fn evaluate(&self, backend: &dyn Backend, request: &Request) -> Result<Output, String> {
        let output = backend.evaluate(&self.diagram()?, request).map_err(|error| error.to_string())?;
        sanity_check(self.positions.len(), request, &output)?;
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

/// What is true of every output, whatever the input: lengths agree, an empty cell has volume 0 and barycenter NaN, nothing
/// else is NaN, facets are sorted rows of known sites, and `Uncertified` occurs only where it was asked for.
///
/// # Errors
/// The first thing out of order.
pub fn sanity_check(count: usize, request: &Request, output: &Output) -> Verdict {
    let Output { status, volume, barycenter, .. } = output;
    ensure!(
        [status.len(), volume.len(), barycenter.len()] == [count; 3],
        "{count} sites, but {} statuses, {} volumes, {} barycenters",
        status.len(),
        volume.len(),
        barycenter.len()
    );
    for i in 0..count {
        let (status, volume, barycenter) = (status[i], volume[i], barycenter[i]);
        ensure!(volume.is_finite(), "site {i}: volume {volume}");
        match status {
            CellStatus::Empty => {
                ensure!(volume == 0.0, "site {i} is empty with volume {volume}");
                ensure!(barycenter.iter().all(|x| x.is_nan()), "site {i} is empty with barycenter {barycenter:?}");
            }
            CellStatus::Complete => {
                // Negative where the winding number is.
                ensure!(volume != 0.0, "site {i} is complete with volume 0");
                ensure!(barycenter.iter().all(|x| x.is_finite()), "site {i}: barycenter {barycenter:?}");
            }
            CellStatus::Uncertified => ensure!(request.epsilon.is_some(), "site {i} is uncertified without `epsilon`"),
        }
    }
    ensure!(output.facets.is_some() == request.facets, "facets are there: {}", output.facets.is_some());
    ensure!(output.boundary.is_some() == request.facets, "boundaries are there: {}", output.boundary.is_some());
    ensure!(
        output.second_moment.is_some() == request.second_moments,
        "second moments are there: {}",
        output.second_moment.is_some()
    );
    if let Some(moments) = &output.second_moment {
        ensure!(moments.len() == count, "{count} sites, but {} second moments", moments.len());
        ensure!(moments.iter().flatten().all(|x| x.is_finite()), "a second moment is not finite");
    }
    if let Some(boundary) = &output.boundary {
        ensure!(boundary.len() == count, "{count} sites, but {} boundaries", boundary.len());
        for (i, b) in boundary.iter().enumerate() {
            let numbers = b.barycenter.iter().chain(&b.vector_area).chain([&b.area, &b.flux]);
            ensure!(numbers.into_iter().all(|x| x.is_finite()), "site {i}: boundary {b:?}");
        }
    }
    let Some(facets) = &output.facets else { return Ok(()) };
    ensure!(facets.offsets.len() == count + 1 && facets.offsets[0] == 0, "facet rows: {:?}", facets.offsets);
    let total = facets.offsets[count];
    let lengths = [facets.neighbor.len(), facets.area.len(), facets.barycenter.len(), facets.distance.len()];
    ensure!(lengths == [total; 4], "{total} facets, but columns of {lengths:?}");
    for i in 0..count {
        ensure!(facets.offsets[i] <= facets.offsets[i + 1], "facet row {i} ends before it starts");
        let row = facets.offsets[i]..facets.offsets[i + 1];
        ensure!(facets.neighbor[row.clone()].is_sorted_by(|a, b| a < b), "site {i}: neighbours are not sorted");
        for f in row {
            let site = facets.neighbor[f].site as usize;
            ensure!(site < count && site != i, "site {i} has neighbour {site} of {count}");
            ensure!(facets.area[f].is_finite(), "facet {i}-{site}: area {}", facets.area[f]);
            ensure!(facets.barycenter[f].iter().all(|x| x.is_finite()), "facet {i}-{site}: no barycenter");
        }
    }
    Ok(())
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
