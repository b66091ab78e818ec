//! Lloyd's relaxation and optimal transport, with a callback at each iteration.

use std::sync::Arc;

use laguerre::Result;
use laguerre::solvers::density::{Density, Gaussian};
use laguerre::solvers::lloyd::{self as relaxation, Method};
use laguerre::solvers::transport::{self as solution, Cotangent, End};
use laguerre_page::Remembering;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::callback::Callback;
use crate::cells::{Backend, Gradient, arrays};
use crate::container::{Container, diagram, rows, table};
use crate::integral::Called;
use crate::run::{Stoppable, detached_in_pool, raised};

/// Sites that are the centroids of their cells: a dictionary of points, history and cells.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn lloyd<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    container: Option<Container<'py>>,
    density: Option<Given>,
    method: &str,
    iterations: usize,
    tolerance: f64,
    callback: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let method = match method {
        "lbfgs" => Method::Lbfgs,
        "lloyd" => Method::Lloyd,
        other => return Err(PyValueError::new_err(format!("method '{other}': 'lbfgs' or 'lloyd' is needed"))),
    };
    let mut diagram = diagram(&points, weights.as_ref(), container.as_ref())?;
    let (density, called) = density_of(density).map_err(raised)?;
    let options = relaxation::Options::default().by(method).of(density).until(iterations, tolerance);
    let callback = Callback::new(callback);
    let (backend, told) = (backend.get()?, &callback);
    let done = detached_in_pool(py, backend.info().threads, |stop| {
        let stoppable = Stoppable { backend, stop };
        let remembering = Remembering::new(&stoppable, diagram.positions().len());
        // (What is remembered comes back from where it could stay.)
        let backend: &dyn laguerre::Backend = if told.is_there() { &remembering } else { &stoppable };
        let relaxed = relaxation::relax(backend, &mut diagram, &options, &mut |done| {
            let numbers =
                [("energy", done.energy), ("gradient", done.gradient), ("evaluations", done.evaluations as f64)];
            told.call(&numbers, &remembering)
        })?;
        let masses = options.density.masses(&relaxed.output).unwrap_or_default();
        Ok((relaxed, diagram, masses))
    });
    or_raise(called)?;
    let (relaxed, diagram, masses) = callback.or_raise(done)?;
    let found = PyDict::new(py);
    found.set_item("points", table(py, diagram.positions().to_vec())?)?;
    found.set_item("energy", PyArray1::from_vec(py, relaxed.iterations.iter().map(|i| i.energy).collect()))?;
    found.set_item("gradient", PyArray1::from_vec(py, relaxed.iterations.iter().map(|i| i.gradient).collect()))?;
    let end = match (relaxed.converged, relaxed.interrupted) {
        (true, _) => "converged",
        (_, true) => "stopped",
        _ => "iterations",
    };
    found.set_item("end", end)?;
    found.set_item("masses", PyArray1::from_vec(py, masses))?;
    found.set_item("cells", arrays(py, relaxed.output.into_arrays())?)?;
    Ok(found)
}

/// Weights for cells of given masses: a dictionary of weights, masses, history, cost and cells.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn transport<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    container: Option<Container<'py>>,
    masses: Option<PyReadonlyArray1<'py, f64>>,
    density: Option<Given>,
    iterations: usize,
    tolerance: f64,
    normalize: bool,
    facets: bool,
    callback: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut diagram = diagram(&points, weights.as_ref(), container.as_ref())?;
    let masses = masses.as_ref().map(|masses| masses.as_slice().map(<[f64]>::to_vec)).transpose()?.unwrap_or_default();
    let (density, called) = density_of(density).map_err(raised)?;
    let options = solution::Options::default().of(density).until(iterations, tolerance);
    let options = if normalize { options.normalized() } else { options };
    let options = if facets { options.with_facets() } else { options };
    let callback = Callback::new(callback);
    let (backend, told) = (backend.get()?, &callback);
    let done = detached_in_pool(py, backend.info().threads, |stop| -> Result<_> {
        let stoppable = Stoppable { backend, stop };
        let remembering = Remembering::new(&stoppable, diagram.positions().len());
        // (What is remembered is a copy each time.)
        let backend: &dyn laguerre::Backend = if told.is_there() { &remembering } else { &stoppable };
        solution::solve(backend, &mut diagram, &masses, &options, &mut |done| {
            let numbers = [("step", done.number as f64), ("residual", done.residual), ("fraction", done.step)];
            told.call(&numbers, &remembering)
        })
    });
    or_raise(called)?;
    let solved = callback.or_raise(done)?;
    let found = PyDict::new(py);
    let end = match solved.end {
        End::Converged => "converged",
        End::MostIterations => "iterations",
        End::Interrupted => "stopped",
        _ => "stalled",
    };
    found.set_item("end", end)?;
    found.set_item("reason", (solved.end != End::Converged).then(|| solved.worst.to_string()))?;
    found.set_item("weights", PyArray1::from_vec(py, solved.weights))?;
    found.set_item("masses", PyArray1::from_vec(py, solved.masses))?;
    found.set_item("residual", solved.residual)?;
    found.set_item("cost", solved.cost)?;
    found.set_item("residuals", PyArray1::from_vec(py, solved.iterations.iter().map(|i| i.residual).collect()))?;
    found.set_item("cells", arrays(py, solved.output.into_arrays())?)?;
    Ok(found)
}

/// The gradient of a function of a transport's weights, centroids and cost, by points and masses.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn pull_back<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    weights: PyReadonlyArray1<'py, f64>,
    container: Option<Container<'py>>,
    density: Option<Given>,
    by_weights: Option<PyReadonlyArray1<'py, f64>>,
    by_centroids: Option<PyReadonlyArray2<'py, f64>>,
    by_cost: f64,
) -> PyResult<Gradient<'py>> {
    let diagram = diagram(&points, Some(&weights), container.as_ref())?;
    let mut cotangent = Cotangent { cost: by_cost, ..Cotangent::default() };
    if let Some(by_weights) = &by_weights {
        cotangent.weights = by_weights.as_slice()?.to_vec();
    }
    if let Some(by_centroids) = &by_centroids {
        cotangent.barycenters = rows(by_centroids.as_slice()?, "centroid").map_err(raised)?.to_vec();
    }
    let (density, _) = density_of(density).map_err(raised)?;
    let backend = backend.get()?;
    let found = detached_in_pool(py, backend.info().threads, |stop| {
        solution::pull_back(&Stoppable { backend, stop }, &diagram, &density, &cotangent)
    })?;
    Ok((table(py, found.positions)?, PyArray1::from_vec(py, found.masses)))
}

/// A density as Python gives it.
#[derive(FromPyObject)]
pub(crate) enum Given {
    /// A value and a gradient.
    Linear(f64, [f64; 3]),
    /// The degree of the rule, and a function of points, (K, 3), that returns (K, 1) doubles.
    Function(u32, Py<PyAny>),
    /// The degree of the rule, a constant, and mean, covariance and mass of each.
    Gaussians(u32, f64, Vec<([f64; 3], [[f64; 3]; 3], f64)>),
}

/// Uniform, where none is given; with the function of Python's that it calls.
fn density_of(given: Option<Given>) -> Result<(Density, Option<Arc<Called>>)> {
    let density = match given {
        None => Density::Uniform,
        Some(Given::Linear(value, gradient)) => Density::Linear { value, gradient },
        Some(Given::Function(degree, function)) => {
            let called = Called::new(function);
            let calls = Arc::clone(&called);
            return Ok((Density::batches(degree, move |points| calls.values(points))?, Some(called)));
        }
        Some(Given::Gaussians(degree, constant, each)) => {
            let one = |(mean, covariance, mass)| Gaussian { mean, covariance, mass };
            Density::gaussians(degree, constant, &each.into_iter().map(one).collect::<Vec<_>>())?
        }
    };
    Ok((density, None))
}

/// What the density's function has raised.
fn or_raise(called: Option<Arc<Called>>) -> PyResult<()> {
    let error = called.and_then(|called| called.raised().take());
    error.map_or(Ok(()), Err)
}
