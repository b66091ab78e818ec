//! Cells of sites, and the derivatives of their masses.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use laguerre::solvers::density::Density;
use laguerre::solvers::derivatives::{Derivatives, Rows};
use laguerre::{
    Boundary, CellStatus, DeviceChoice, FacetArrays, Facets, Integrand, Output, OutputArrays, Precision, Request,
    Selection,
};
use numpy::ndarray::Dimension;
use numpy::{Element, Ix1, Ix2, PyArray1, PyArray2, PyReadonlyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::container::{self, Container, diagram, table};
use crate::geometry::Geometry;
use crate::run::{detached, detached_in_pool, raised};

/// Where to compute: `name` is "auto" (a GPU if there is one), "cpu" or "ocl"; `devices` are the numbers of OpenCL devices, as laguerre.devices() counts
/// them; `precision` is "f64", or "f32" for volumes and centroids on OpenCL; `threads` are the CPU's, all without. Diagrams take it as `backend=`.
#[pyclass(frozen, module = "laguerre")]
pub(crate) struct Backend {
    backend: Box<dyn laguerre::Backend>,
    /// What it was opened with, to open it again elsewhere.
    arguments: (String, Option<Vec<usize>>, String, Option<usize>),
    /// The process that has its threads.
    process: u32,
}

impl Backend {
    /// The backend, in the process that opened it.
    pub(crate) fn get(&self) -> PyResult<&dyn laguerre::Backend> {
        if self.process != std::process::id() {
            return Err(PyRuntimeError::new_err(
                "this backend was opened before a fork, and has no threads here: open another, or let new processes be spawned",
            ));
        }
        Ok(self.backend.as_ref())
    }
}

#[pymethods]
impl Backend {
    #[new]
    #[pyo3(signature = (name="auto", devices=None, precision="f64", threads=None))]
    fn new(
        py: Python<'_>,
        name: &str,
        devices: Option<Vec<usize>>,
        precision: &str,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let arguments = (name.to_owned(), devices.clone(), precision.to_owned(), threads);
        let precision = match precision {
            "f64" => Precision::F64,
            "f32" => Precision::F32,
            other => return Err(PyValueError::new_err(format!("precision '{other}': 'f64' or 'f32' is needed"))),
        };
        let on_devices = devices.is_some() || precision == Precision::F32;
        let choice = devices.map_or(DeviceChoice::First, DeviceChoice::Numbers);
        let selection = match name {
            "auto" if on_devices && threads.is_none() => Selection::Ocl { devices: choice, precision },
            "auto" if threads.is_none() => Selection::Auto,
            "auto" | "cpu" if !on_devices => Selection::Cpu { threads },
            "ocl" if threads.is_none() => Selection::Ocl { devices: choice, precision },
            "cpu" => return Err(PyValueError::new_err("backend 'cpu' has no devices and computes in f64: take 'ocl'")),
            "auto" | "ocl" => return Err(PyValueError::new_err("threads: they are of backend 'cpu' alone")),
            other => return Err(PyValueError::new_err(format!("backend '{other}': 'auto', 'cpu' or 'ocl' is needed"))),
        };
        let is_auto = selection == Selection::Auto;
        let selection = match selection {
            Selection::Cpu { .. } => selection,
            Selection::Auto if check_opencl().is_err() && AUTO_IS_CPU.load(Ordering::Relaxed) => {
                Selection::Cpu { threads: None }
            }
            _ => check_opencl().map(|()| selection)?,
        };
        let backend = py.detach(|| laguerre::open(selection)).map_err(raised)?;
        if is_auto {
            AUTO_IS_CPU.store(backend.info().backend == "cpu", Ordering::Relaxed);
        }
        Ok(Self { backend, arguments, process: std::process::id() })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let arguments = slf.get().arguments.clone().into_pyobject(slf.py())?.into_any();
        Ok((slf.get_type().into_any(), arguments))
    }

    /// "cpu" or "ocl": what "auto" came to.
    #[getter]
    fn name(&self) -> &'static str {
        self.backend.info().backend
    }

    /// What the processor or the OpenCL devices are called.
    #[getter]
    fn device(&self) -> String {
        self.backend.info().device
    }

    /// "f64" or "f32".
    #[getter]
    fn precision(&self) -> &'static str {
        self.backend.info().precision.word()
    }

    /// How many threads of the host it has.
    #[getter]
    fn threads(&self) -> usize {
        self.backend.info().threads
    }
}

/// The process that has used OpenCL first; 0 before.
static OPENCL_OF: AtomicU32 = AtomicU32::new(0);
/// Whether "auto" has come to the CPU, as it will again.
static AUTO_IS_CPU: AtomicBool = AtomicBool::new(false);

/// Refuses OpenCL in a process that was forked after it was used: its drivers do not outlive that, and calls end in deadlock.
fn check_opencl() -> PyResult<()> {
    let own = std::process::id();
    let (Ok(of) | Err(of)) = OPENCL_OF.compare_exchange(0, own, Ordering::Relaxed, Ordering::Relaxed);
    if of == 0 || of == own {
        return Ok(());
    }
    Err(PyRuntimeError::new_err(
        "OpenCL was used before this process was forked, and does not work in it: take backend 'cpu', or let processes be \
         spawned, as by multiprocessing.get_context('spawn')",
    ))
}

/// Name, platform, whether it is a GPU, and why it cannot be used, if so.
type Device = (String, String, bool, Option<String>);

/// The OpenCL devices that are there.
#[pyfunction]
pub(crate) fn devices() -> PyResult<Vec<Device>> {
    check_opencl()?;
    // Where there is no OpenCL there are none.
    let found = laguerre::devices().unwrap_or_default();
    Ok(found.into_iter().map(|d| (d.name, d.platform, d.is_gpu, d.unusable)).collect())
}

/// Terms of a polynomial: exponents and coefficient.
type Terms = Vec<([u32; 3], f64)>;

/// The cells of a diagram, as a dictionary of arrays.
#[pyfunction]
#[pyo3(signature = (backend, points, weights, container, facets, laplacian, second_moments, facet_second_moments, geometry, solids, polynomial, epsilon))]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn evaluate<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    container: Option<Container<'py>>,
    facets: bool,
    laplacian: bool,
    second_moments: bool,
    facet_second_moments: bool,
    geometry: bool,
    solids: bool,
    polynomial: Option<(Terms, [f64; 3])>,
    epsilon: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let diagram = diagram(&points, weights.as_ref(), container.as_ref())?;
    let mut request = Request::moments();
    for (is_wanted, with) in [
        (facets, Request::with_facets as fn(Request) -> Request),
        (laplacian, Request::with_laplacian),
        (second_moments, Request::with_second_moments),
        (facet_second_moments, Request::with_facet_second_moments),
        (geometry, Request::with_geometry),
        (solids, Request::with_solids),
    ] {
        request = if is_wanted { with(request) } else { request };
    }
    if let Some(epsilon) = epsilon {
        request = request.with_epsilon(epsilon);
    }
    if let Some((terms, origin)) = polynomial {
        request = request.with_integral(Integrand::polynomial(origin, &terms).map_err(raised)?);
    }
    let backend = backend.get()?;
    let output = detached(py, |stop| backend.evaluate_watched(&diagram, &request, stop))?;
    arrays(py, output.into_arrays())
}

/// An output as a dictionary, which takes its memory.
pub(crate) fn arrays(py: Python<'_>, output: OutputArrays) -> PyResult<Bound<'_, PyDict>> {
    let found = PyDict::new(py);
    let sites = output.status.len();
    let status: Vec<u8> = output.status.into_iter().map(CellStatus::number).collect();
    found.set_item("status", PyArray1::from_vec(py, status))?;
    found.set_item("volume", PyArray1::from_vec(py, output.volume))?;
    found.set_item("centroid", table(py, output.barycenter)?)?;
    if let Some(moments) = output.second_moment {
        found.set_item("second_moment", table(py, moments)?)?;
    }
    if let Some(laplacian) = &output.laplacian {
        let (offsets, columns, values) = laplacian.whole(sites);
        found.set_item("laplacian_offsets", PyArray1::from_vec(py, offsets))?;
        found.set_item("laplacian_columns", PyArray1::from_vec(py, columns))?;
        found.set_item("laplacian", PyArray1::from_vec(py, values))?;
    }
    if let Some(integral) = output.integral {
        found.set_item("integral", PyArray1::from_vec(py, integral))?;
    }
    if let Some(facets) = output.facets {
        let facets = facets.into_arrays();
        found.set_item("offsets", PyArray1::from_vec(py, facets.offsets))?;
        found.set_item("neighbor", PyArray1::from_vec(py, facets.neighbor))?;
        found.set_item("area", PyArray1::from_vec(py, facets.area))?;
        found.set_item("facet_centroid", table(py, facets.barycenter)?)?;
        found.set_item("distance", PyArray1::from_vec(py, facets.distance))?;
        if let Some(moments) = facets.second_moment {
            found.set_item("facet_second_moment", table(py, moments)?)?;
        }
        let boundary = &facets.boundary;
        found.set_item("boundary_area", PyArray1::from_vec(py, boundary.iter().map(|b| b.area).collect()))?;
        found.set_item("boundary_centroid", table(py, boundary.iter().map(|b| b.barycenter).collect())?)?;
        found.set_item("boundary_vector_area", table(py, boundary.iter().map(|b| b.vector_area).collect())?)?;
    }
    if let Some(geometry) = output.geometry {
        found.set_item("geometry", Geometry(geometry))?;
    }
    Ok(found)
}

/// By points, and a number of each.
pub(crate) type Gradient<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

/// A sparse matrix of blocks: row starts, columns, values.
type Sparse<'py> = (Bound<'py, PyArray1<usize>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyAny>);

/// The derivatives of `of` ("mass" or "centroid") by `by` ("weights" or "points") of cells that were evaluated with the facets' second moments.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn jacobian<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    container: Option<Container<'py>>,
    cells: &Bound<'py, PyDict>,
    of: &str,
    by: &str,
) -> PyResult<Sparse<'py>> {
    let threads = backend.get()?.info().threads;
    let diagram = diagram(&points, weights.as_ref(), container.as_ref())?;
    let output = output(cells, false)?;
    let derivatives = Derivatives::new(&diagram, &output, &Density::Uniform).map_err(raised)?;
    let derivatives = &derivatives;
    match (of, by) {
        ("mass", "weights") => sparse(py, detached_in_pool(py, threads, |_| Ok(derivatives.masses_by_weights()))?),
        ("mass", "points") => sparse(py, detached_in_pool(py, threads, |_| Ok(derivatives.masses_by_positions()))?),
        ("centroid", "weights") => {
            sparse(py, detached_in_pool(py, threads, |_| Ok(derivatives.barycenters_by_weights()))?)
        }
        _ => sparse(py, detached_in_pool(py, threads, |_| derivatives.barycenters_by_positions())?),
    }
}

/// The gradient of a function of masses and centroids of such cells, by points and weights.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn pull_back_cells<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    container: Option<Container<'py>>,
    cells: &Bound<'py, PyDict>,
    by_masses: PyReadonlyArray1<'py, f64>,
    by_centroids: PyReadonlyArray2<'py, f64>,
) -> PyResult<Gradient<'py>> {
    let threads = backend.get()?.info().threads;
    let diagram = diagram(&points, weights.as_ref(), container.as_ref())?;
    let output = output(cells, false)?;
    let derivatives = Derivatives::new(&diagram, &output, &Density::Uniform).map_err(raised)?;
    let by_masses = by_masses.as_slice()?;
    let by_centroids = container::rows(by_centroids.as_slice()?, "centroid").map_err(raised)?;
    let (points, weights) = detached_in_pool(py, threads, |_| derivatives.pull_back(by_masses, by_centroids))?;
    Ok((table(py, points)?, PyArray1::from_vec(py, weights)))
}

/// A dictionary of arrays as the output that it came from, with its geometry if need be.
pub(crate) fn output(cells: &Bound<'_, PyDict>, with_geometry: bool) -> PyResult<Output> {
    let has = |name| cells.contains(name);
    let facets = || -> PyResult<Facets> {
        let areas = column(cells, "boundary_area")?;
        let (centroids, vectors) = (rows(cells, "boundary_centroid")?, rows(cells, "boundary_vector_area")?);
        let pieces = areas.into_iter().zip(centroids).zip(vectors);
        let piece = |((area, barycenter), vector_area)| {
            let mut piece = Boundary::default();
            (piece.area, piece.barycenter, piece.vector_area) = (area, barycenter, vector_area);
            piece
        };
        let mut facets = FacetArrays::default();
        facets.offsets = column(cells, "offsets")?;
        facets.neighbor = column(cells, "neighbor")?;
        facets.area = column(cells, "area")?;
        facets.barycenter = rows(cells, "facet_centroid")?;
        facets.distance = column(cells, "distance")?;
        facets.second_moment = has("facet_second_moment")?.then(|| rows(cells, "facet_second_moment")).transpose()?;
        facets.boundary = pieces.map(piece).collect();
        Facets::new(facets).map_err(raised)
    };
    let status = |number| match number {
        0 => CellStatus::Complete,
        1 => CellStatus::Empty,
        _ => CellStatus::Uncertified,
    };
    let geometry = || -> PyResult<Option<_>> {
        let Some(geometry) = cells.get_item("geometry")? else { return Ok(None) };
        Ok(Some(geometry.cast::<Geometry>()?.get().0.clone()))
    };
    let mut arrays = OutputArrays::default();
    arrays.status = column::<u8>(cells, "status")?.into_iter().map(status).collect();
    arrays.volume = column(cells, "volume")?;
    arrays.barycenter = rows(cells, "centroid")?;
    arrays.second_moment = has("second_moment")?.then(|| rows(cells, "second_moment")).transpose()?;
    arrays.integral = has("integral")?.then(|| column(cells, "integral")).transpose()?;
    arrays.facets = has("offsets")?.then(facets).transpose()?;
    arrays.geometry = if with_geometry { geometry()? } else { None };
    Output::new(arrays).map_err(raised)
}

fn array<'py, T: Element, D: Dimension>(
    cells: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<PyReadonlyArray<'py, T, D>> {
    let missing = || PyValueError::new_err(format!("the cells have no '{name}'"));
    cells.get_item(name)?.ok_or_else(missing)?.extract()
}

fn column<T: Element + Copy>(cells: &Bound<'_, PyDict>, name: &str) -> PyResult<Vec<T>> {
    Ok(array::<T, Ix1>(cells, name)?.as_slice()?.to_vec())
}

fn rows<const N: usize>(cells: &Bound<'_, PyDict>, name: &str) -> PyResult<Vec<[f64; N]>> {
    Ok(array::<f64, Ix2>(cells, name)?.as_slice()?.as_chunks().0.to_vec())
}

fn sparse<'py, const N: usize>(py: Python<'py>, rows: Rows<N>) -> PyResult<Sparse<'py>> {
    let values = table(py, rows.values)?.into_any();
    Ok((PyArray1::from_vec(py, rows.offsets), PyArray1::from_vec(py, rows.columns), values))
}
