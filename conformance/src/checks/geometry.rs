//! The geometry of restricted cells: polygons that close each cell and enclose what was integrated, and solids that fill it.

use std::collections::HashMap;

use glam::DVec3;
use laguerre_core::geometry::{Beyond, Face, Geometry};
use laguerre_core::{Backend, CellStatus, Output, Request};

use crate::bounds::{Bounds, Planes, U};
use crate::compare::undecided;
use crate::{Case, Scene, Verdict};

/// Cells are closed: each edge of their faces stands as often in one direction as in the other. So do the solids of a cell.
pub fn closed(backend: &dyn Backend, case: &Case) -> Verdict {
    hold(backend, case, |scene, output, geometry, _| {
        for i in 0..scene.len() {
            ensure!(is_closed(geometry.faces(i)), "the faces of site {i} do not close");
            let is_empty = output.status()[i] == CellStatus::Empty;
            ensure!(!is_empty || geometry.faces(i).len() == 0, "the cell of site {i} is empty, and has faces");
            for solid in geometry.solids(i) {
                ensure!(is_closed(solid.iter().copied()), "a solid of site {i} does not close");
            }
        }
        Ok(())
    })
}

/// What the faces of a cell enclose, and its solids together, has its volume and its barycenter.
pub fn volume(backend: &dyn Backend, case: &Case) -> Verdict {
    hold(backend, case, |scene, output, geometry, bounds| {
        let size = size_of(geometry);
        let mean = scene.room.volume() / scene.len() as f64;
        for i in (0..scene.len()).filter(|&i| output.status()[i] != CellStatus::Empty) {
            let about = DVec3::from(output.barycenter()[i]);
            let sums = Sums::of(geometry, geometry.faces(i), about);
            let expected = output.volume()[i];
            // Coordinates are rounded, and points that are as near as that are one.
            let moved = MOVED * U * size * sums.area;
            let bound = bounds.volume(i) + moved + OF_MEAN * mean;
            let off = (sums.volume - expected).abs();
            ensure!(off <= bound, "site {i}: volume {expected:e}, by its faces off by {off:e}, bound {bound:e}");
            let bound = bounds.first_moment(i) + (moved + OF_MEAN * mean) * (sums.reach + size * U);
            let off = sums.moment.length();
            ensure!(off <= bound, "site {i}: first moment about its barycenter {off:e} by its faces, bound {bound:e}");
            let filled: f64 = geometry.solids(i).map(|solid| Sums::of(geometry, solid.into_iter(), about).volume).sum();
            let (off, bound) = ((filled - sums.volume).abs(), moved + OF_MEAN * mean);
            ensure!(off <= bound, "site {i}: its solids differ from its faces by {off:e}, bound {bound:e}");
        }
        Ok(())
    })
}

/// The faces between two cells have together the area of their facet, and those on the surface that of the boundary. (Of a cell one of whose
/// facets is undecided, some are another's by one count and not by the other: the law does not say.)
pub fn areas(backend: &dyn Backend, case: &Case) -> Verdict {
    hold(backend, case, |scene, output, geometry, bounds| {
        let extent = size_of(geometry);
        for (i, boundary) in output.boundary().into_iter().flatten().enumerate() {
            let mut areas: HashMap<Option<u32>, (DVec3, f64)> = HashMap::new();
            for face in geometry.faces(i) {
                let beyond = if let Beyond::Site(j) = face.beyond { Some(j) } else { None };
                let (vector, size) = areas.entry(beyond).or_default();
                let area = area_of(geometry, &face);
                *vector += area;
                *size += area.length();
            }
            let whole: f64 = areas.values().map(|(_, size)| size).sum();
            let is_undecided = |j: usize| j != i && undecided(scene, i, j, bounds);
            let facets = bounds.rows()[i].iter().map(|f| (Some(f.neighbor as u32), f.area));
            for (beyond, expected) in facets.chain([(None, boundary.area)]) {
                let (vector, size) = areas.get(&beyond).copied().unwrap_or_default();
                // A facet is plane; of the surface each triangle counts for itself.
                let found = if beyond.is_some() { vector.length().copysign(expected) } else { size };
                let bound = bounds.facet_rounding(i)
                    + bounds.area(i)
                    + MOVED * U * extent * whole.sqrt()
                    + OF_MEAN * extent * extent;
                let off = (found - expected).abs();
                ensure!(
                    off <= bound || (0..scene.len()).any(is_undecided),
                    "site {i}: {expected:e} of its surface is towards {beyond:?}, by its faces off by {off:e}, bound {bound:e}"
                );
            }
        }
        Ok(())
    })
}

/// What a point may be off in the geometry: a share of all coordinates' size.
const MOVED: f64 = 64.0;
/// What a cell may be off beyond that, as a share of the mean volume.
const OF_MEAN: f64 = 1e-13;

fn hold(backend: &dyn Backend, case: &Case, law: impl Fn(&Scene, &Output, &Geometry, &Bounds) -> Verdict) -> Verdict {
    let scene = case.scene();
    let output = scene.evaluate(backend, &Request::moments().with_facets().with_solids())?;
    let geometry = output.geometry().ok_or("the output has no geometry")?;
    law(&scene, &output, geometry, &Bounds::new(&scene, &output, Planes::Same))
}

/// The size of coordinates, in units of which they are rounded: the largest of them, and of the box that they fill.
fn size_of(geometry: &Geometry) -> f64 {
    let points = || geometry.points().iter().map(|&p| DVec3::from(p));
    let (lo, hi) = points().fold((DVec3::MAX, DVec3::MIN), |(lo, hi), p| (lo.min(p), hi.max(p)));
    lo.abs().max(hi.abs()).max(2.0 * (hi - lo)).max_element()
}

fn is_closed<'a>(faces: impl Iterator<Item = Face<'a>>) -> bool {
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for face in faces {
        for (k, &a) in face.corners.iter().enumerate() {
            let b = face.corners[(k + 1) % face.corners.len()];
            *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    edges.values().all(|&n| n == 0)
}

fn at(geometry: &Geometry, corner: u32) -> DVec3 {
    DVec3::from(geometry.points()[corner as usize])
}

fn area_of(geometry: &Geometry, face: &Face<'_>) -> DVec3 {
    let first = at(geometry, face.corners[0]);
    let ways = face.corners[1..].windows(2).map(|pair| [pair[0], pair[1]].map(|c| at(geometry, c) - first));
    ways.map(|[a, b]| 0.5 * a.cross(b)).sum()
}

/// Sums over what faces enclose.
#[derive(Default)]
struct Sums {
    volume: f64,
    /// ∫ (x − about).
    moment: DVec3,
    area: f64,
    /// The farthest corner from that point.
    reach: f64,
}

impl Sums {
    fn of<'a>(geometry: &Geometry, faces: impl Iterator<Item = Face<'a>>, about: DVec3) -> Self {
        let mut sums = Self::default();
        for face in faces {
            sums.area += area_of(geometry, &face).length();
            let ways: Vec<DVec3> = face.corners.iter().map(|&c| at(geometry, c) - about).collect();
            sums.reach = ways.iter().map(|w| w.length()).fold(sums.reach, f64::max);
            for pair in ways[1..].windows(2) {
                let [a, b, c] = [ways[0], pair[0], pair[1]];
                let volume = a.dot(b.cross(c)) / 6.0;
                sums.volume += volume;
                sums.moment += volume * (a + b + c) / 4.0;
            }
        }
        sums
    }
}
