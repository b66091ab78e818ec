//! The restricted cells as polygons.

use laguerre::geometry::{self, Beyond};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::container::table;

/// The restricted cells as polygons with shared corners.
#[pyclass(frozen, module = "laguerre")]
pub(crate) struct Geometry(pub(crate) geometry::Geometry);

/// Faces: where each begins in the corners; the corners; the site of each; what is beyond (a site, or −1 for the boundary).
type Faces<'py> =
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>);

#[pymethods]
impl Geometry {
    /// The corners of all faces, (P, 3).
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.0.points().to_vec())
    }

    /// All faces, cell by cell, counterclockwise from outside.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> Faces<'py> {
        let (mut offsets, mut corners, mut sites, mut beyond) = (vec![0], Vec::new(), Vec::new(), Vec::new());
        for site in 0..self.0.sites() {
            for face in self.0.faces(site) {
                corners.extend(face.corners.iter().map(|&corner| i64::from(corner)));
                offsets.push(corners.len() as i64);
                sites.push(site as i64);
                beyond.push(match face.beyond {
                    Beyond::Site(other) => i64::from(other),
                    _ => -1,
                });
            }
        }
        let array = |numbers| PyArray1::from_vec(py, numbers);
        (array(offsets), array(corners), array(sites), array(beyond))
    }
}
