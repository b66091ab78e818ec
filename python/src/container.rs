//! Domains, boxes and sites from arrays.

use std::path::PathBuf;

use laguerre::{Error, PowerDiagram, Result};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::run::raised;

/// A closed triangle mesh.
#[pyclass(frozen, module = "laguerre")]
pub(crate) struct Domain(pub(crate) laguerre::Domain);

#[pymethods]
impl Domain {
    #[new]
    fn new(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        triangles: PyReadonlyArray2<'_, u32>,
        orient: bool,
    ) -> PyResult<Self> {
        let vertices = rows(vertices.as_slice()?, "vertices").map_err(raised)?;
        let triangles = rows(triangles.as_slice()?, "triangles").map_err(raised)?;
        let make = if orient { laguerre::Domain::oriented } else { laguerre::Domain::new };
        py.detach(|| make(vertices, triangles)).map(Self).map_err(raised)
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, orient: bool) -> PyResult<Self> {
        let load = || if orient { laguerre::Domain::load_oriented(path) } else { laguerre::Domain::load(path) };
        py.detach(load).map(Self).map_err(raised)
    }

    #[staticmethod]
    fn image(
        py: Python<'_>,
        values: PyReadonlyArray1<'_, f64>,
        shape: [usize; 3],
        lo: [f64; 3],
        hi: [f64; 3],
    ) -> PyResult<Self> {
        let values = values.as_slice()?;
        py.detach(|| laguerre::Domain::of_image(values, shape, lo, hi)).map(Self).map_err(raised)
    }

    #[staticmethod]
    fn tetrahedra(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        tetrahedra: PyReadonlyArray2<'_, u32>,
        values: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let vertices = rows(vertices.as_slice()?, "vertices").map_err(raised)?;
        let (tetrahedra, values) = (rows(tetrahedra.as_slice()?, "tetrahedra").map_err(raised)?, values.as_slice()?);
        py.detach(|| laguerre::Domain::of_tetrahedra(vertices, tetrahedra, values)).map(Self).map_err(raised)
    }

    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.0.vertices().to_vec())
    }

    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        table(py, self.0.triangles().to_vec())
    }

    #[getter]
    fn volume(&self) -> f64 {
        self.0.volume()
    }

    #[getter]
    fn area(&self) -> f64 {
        self.0.area()
    }

    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.barycenter())
    }

    #[getter]
    fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        self.0.bounding_box()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes().to_vec()
    }
}

/// A domain, the corners of a box, or nothing: the box of the sites.
#[derive(FromPyObject)]
pub(crate) enum Container<'py> {
    Domain(PyRef<'py, Domain>),
    Box([f64; 3], [f64; 3]),
}

/// Weighted sites in their container.
pub(crate) fn diagram(
    points: &PyReadonlyArray2<'_, f64>,
    weights: Option<&PyReadonlyArray1<'_, f64>>,
    container: Option<&Container<'_>>,
) -> PyResult<PowerDiagram> {
    let points = rows(points.as_slice()?, "points").map_err(raised)?;
    let weights = weights.map(|weights| weights.as_slice()).transpose()?.unwrap_or_default();
    let diagram = PowerDiagram::new(points, weights).map_err(raised)?;
    match container {
        None => Ok(diagram),
        Some(Container::Domain(domain)) => Ok(diagram.restricted_to(&domain.0)),
        Some(Container::Box(lo, hi)) => diagram.in_box(*lo, *hi).map_err(raised),
    }
}

/// The rows of an array of so many columns.
pub(crate) fn rows<'a, T, const N: usize>(numbers: &'a [T], what: &str) -> Result<&'a [[T; N]]> {
    match numbers.as_chunks() {
        (rows, []) => Ok(rows),
        _ => Err(Error::input(format!("{what}: an array of shape (N, {N}) is needed"))),
    }
}

/// An array of rows, which takes their memory.
pub(crate) fn table<T: numpy::Element, const N: usize>(
    py: Python<'_>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, N])
}
