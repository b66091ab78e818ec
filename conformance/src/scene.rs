//! A concrete input, evaluated and looked at.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use laguerre_core::diagram::Container;
use laguerre_core::shapes::Mesh;
use laguerre_core::{Backend, Output, PowerDiagram, Request};

use crate::domains::Room;
use crate::moments::{Moments, cut};
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

    /// Area of the surface within the power cell of site `i` (length²): each triangle cut by the bisectors with all other sites, in floating
    /// point and with nothing of the library. What lies on a bisector is the site's of lower index.
    pub fn surface_in_cell(&self, i: usize) -> f64 {
        let mesh = self.room.mesh();
        let corners = |triangle: &[u32; 3]| triangle.map(|v| DVec3::from(mesh.vertices[v as usize])).to_vec();
        mesh.triangles.iter().map(|triangle| vector_area(&self.within(corners(triangle), i, None)).length()).sum()
    }

    /// Area of the facet between the power cells of sites `i` and `j`, at different positions, by winding number (length²): that of the triangles
    /// between a point of their bisector and the segments in which it meets the surface, each cut by the bisectors of `i` with all other sites.
    /// Computed as [`Scene::surface_in_cell`]. Of sites at one position that of largest weight has the facet, of several such the first.
    pub fn facet_area(&self, i: usize, j: usize) -> f64 {
        let goes_before = |k: usize| self.weight(k) > self.weight(j) || (self.weight(k) == self.weight(j) && k < j);
        if (0..self.len()).any(|k| self.site(k) == self.site(j) && goes_before(k)) {
            return 0.0;
        }
        let mesh = self.room.mesh();
        let normal = (self.site(j) - self.site(i)).normalize();
        let (mut area, mut point) = (0.0, None);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| DVec3::from(mesh.vertices[v as usize]));
            let heights = corners.map(|x| self.power_difference(x, i, j));
            let (mut enters, mut leaves) = (None, None);
            for (k, next) in [(0, 1), (1, 2), (2, 0)] {
                if (heights[k] < 0.0) != (heights[next] < 0.0) {
                    let end = if heights[k] < 0.0 { &mut leaves } else { &mut enters };
                    *end = Some(crossing(corners[k], heights[k], corners[next], heights[next]));
                }
            }
            if let (Some(a), Some(b)) = (enters, leaves) {
                let point = *point.get_or_insert(a);
                // The cell's side of the surface goes around the facet the other way.
                area += vector_area(&self.within(vec![point, a, b], i, Some(j))).dot(normal);
            }
        }
        area
    }

    /// What of a convex polygon is in the power cell of site `i`, or would be without the sites where site `but` is.
    fn within(&self, mut polygon: Vec<DVec3>, i: usize, but: Option<usize>) -> Vec<DVec3> {
        let cuts = |j: usize| but.is_none_or(|but| self.site(j) != self.site(but));
        for j in (0..self.len()).filter(|&j| j != i && cuts(j)) {
            let heights: Vec<f64> = polygon.iter().map(|&x| self.power_difference(x, i, j)).collect();
            let inside = |h: f64| h < 0.0 || (h == 0.0 && i < j);
            let mut rest = Vec::with_capacity(polygon.len() + 1);
            for (k, (&x, &h)) in polygon.iter().zip(&heights).enumerate() {
                let next = (k + 1) % polygon.len();
                if inside(h) {
                    rest.push(x);
                }
                if inside(h) != inside(heights[next]) {
                    rest.push(crossing(x, h, polygon[next], heights[next]));
                }
            }
            polygon = rest;
        }
        polygon
    }

    /// Integrals over the room, by winding number, about `middle`; or over what of it is in the power cell of a site. They are those of the
    /// tetrahedra between `middle` and the triangles, cut by the bisectors with all other sites, in floating point and with nothing of the
    /// library. What lies on a bisector is the site's of lower index.
    pub fn moments(&self, middle: DVec3, cell: Option<usize>) -> Moments {
        let mesh = self.room.mesh();
        let mut sums = Moments::default();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| DVec3::from(mesh.vertices[v as usize]) - middle);
            let mut parts = vec![[DVec3::ZERO, a, b, c]];
            for (i, j) in cell.into_iter().flat_map(|i| (0..self.len()).map(move |j| (i, j))).filter(|(i, j)| i != j) {
                let (p, q) = (self.site(i) - middle, self.site(j) - middle);
                let weights = self.weight(i) - self.weight(j);
                let height = |x: DVec3| 2.0 * (self.site(j) - self.site(i)).dot(x - 0.5 * (p + q)) - weights;
                let mut rest = Vec::with_capacity(parts.len());
                parts.iter().for_each(|part| cut(part, height, i < j, &mut rest));
                parts = rest;
            }
            let sign = DMat3::from_cols(a, b, c).determinant().signum();
            parts.iter().for_each(|part| sums.add(sign, part));
        }
        sums
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

/// Where a linear function is 0 between `x`, where it is `h`, and `y`, where it is `g`.
fn crossing(x: DVec3, h: f64, y: DVec3, g: f64) -> DVec3 {
    x + (y - x) * (h / (h - g))
}

/// Area times normal of a plane polygon (length²).
fn vector_area(polygon: &[DVec3]) -> DVec3 {
    let fan = polygon.windows(2).skip(1).map(|edge| (edge[0] - polygon[0]).cross(edge[1] - polygon[0]));
    0.5 * fan.sum::<DVec3>()
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
    let Some(facets) = output.facets() else { return vec![Vec::new(); output.status().len()] };
    let facet = |f: laguerre::Facet| Facet {
        neighbor: f.neighbor,
        area: f.area,
        barycenter: DVec3::from(f.barycenter),
        distance: f.distance,
    };
    (0..facets.sites()).map(|i| facets.of(i).map(facet).collect()).collect()
}

#[cfg(test)]
mod tests {
    use laguerre_core::oracle::Naive;

    use super::*;
    use crate::domains::{Pose, Shape, room};
    use crate::moments::ENTRIES;
    use crate::sites::Random;

    /// A room and 20 sites in its box, the last where the first is.
    fn with_twins(shape: Shape, random: &mut Random) -> (Room, Vec<[f64; 3]>) {
        let room = room(shape, Pose::Turned);
        let lo = DVec3::from(room.bounding_box().0);
        let mut positions: Vec<[f64; 3]> = (0..20).map(|_| (lo + room.extents() * random.point()).into()).collect();
        positions[19] = positions[0];
        (room, positions)
    }

    #[test]
    fn cells_share_the_surface() {
        let mut random = Random::new(1);
        for shape in [Shape::Box, Shape::Cavity, Shape::FoldedStar(2), Shape::FoldedComb(6)] {
            let (room, positions) = with_twins(shape, &mut random);
            // Of the two of one place the first has all.
            let weights = (0..19).map(|_| 0.01 * random.unit()).chain([0.0]).collect::<Vec<_>>();
            let scene = Scene { positions, weights, room };
            let parts: Vec<f64> = (0..20).map(|i| scene.surface_in_cell(i)).collect();
            let (sum, area) = (parts.iter().sum::<f64>(), scene.room.area());
            assert!((sum - area).abs() <= 1e-13 * area, "{shape:?}: {sum}, not {area}");
            assert!(parts[19] == 0.0 && parts.iter().filter(|part| **part > 0.0).count() > 5, "{shape:?}: {parts:?}");
        }
    }

    #[test]
    fn facets_are_cut_out_of_the_surface() {
        let mut random = Random::new(3);
        for shape in [Shape::Box, Shape::Cavity, Shape::FoldedStar(2), Shape::FoldedComb(6)] {
            let (room, positions) = with_twins(shape, &mut random);
            let mut weights: Vec<f64> = (0..20).map(|_| 0.01 * random.unit()).collect();
            weights[19] = weights[0];
            let scene = Scene { positions, weights, room };
            let rows = rows(&scene.with_facets(&Naive::default()).expect("an output"));
            let bound = 1e-13 * scene.room.area();
            for (i, row) in rows.iter().enumerate() {
                for j in (0..20).filter(|&j| scene.site(j) != scene.site(i)) {
                    let listed = row.iter().find(|f| f.neighbor == j).map_or(0.0, |f| f.area);
                    let area = scene.facet_area(i, j);
                    assert!((area - listed).abs() <= bound, "{shape:?}: facet {i}-{j}: {area:e}, not {listed:e}");
                }
            }
        }
    }

    #[test]
    fn cells_share_the_moments() {
        let mut random = Random::new(2);
        for shape in [Shape::Box, Shape::Cavity, Shape::FoldedStar(2), Shape::FoldedComb(6)] {
            let (room, positions) = with_twins(shape, &mut random);
            let weights = (0..19).map(|_| 0.01 * random.unit()).chain([0.0]).collect::<Vec<_>>();
            let scene = Scene { positions, weights, room };
            let (middle, volume) = (DVec3::from(scene.room.barycenter()), scene.room.volume());
            let whole = scene.moments(middle, None);
            assert!((whole.volume() - volume).abs() <= 1e-14 * volume, "{shape:?}: {}, not {volume}", whole.volume());
            let first = whole.first().length();
            assert!(first <= 1e-14 * volume * scene.room.extents().length(), "{shape:?}: barycenter off by {first:e}");
            // Each is the cell's, by the library, and they have the whole together.
            let output =
                scene.evaluate(&Naive::default(), &Request::moments().with_second_moments()).expect("an output");
            let mut sum = Moments::default();
            for i in 0..20 {
                let (cell, v, away) =
                    (scene.moments(middle, Some(i)), output.volume()[i], DVec3::from(output.barycenter()[i]) - middle);
                sum.merge(&cell);
                assert!((cell.volume() - v).abs() <= 1e-13 * volume, "{shape:?}, {i}: {}, not {v}", cell.volume());
                if v != 0.0 {
                    let off = cell.first().distance(v * away);
                    assert!(off <= 1e-13 * volume, "{shape:?}, {i}: first moment off by {off:e}");
                    let second = output.second_moment().expect("second moments")[i];
                    for (k, [r, c]) in ENTRIES.into_iter().enumerate() {
                        let off = (cell.second()[k] - (second[k] + v * away[r] * away[c])).abs();
                        assert!(off <= 1e-13 * volume, "{shape:?}, {i}: second moment off by {off:e}");
                    }
                }
            }
            assert!((sum.volume() - volume).abs() <= 1e-14 * volume, "{shape:?}: {}, not {volume}", sum.volume());
            let off = (0..6).map(|k| (sum.second()[k] - whole.second()[k]).abs()).fold(0.0, f64::max);
            assert!(off <= 1e-14 * volume, "{shape:?}: second moments off by {off:e}");
        }
    }
}
