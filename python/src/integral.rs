//! Integrals of functions of Python's, which are called with many points at once.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use laguerre::{Error, ErrorKind, Integrand, Request, Result};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::cells::{Backend, arrays};
use crate::container::{Container, diagram, table};
use crate::run::{detached, raised};

/// A function of points, (K, 3), that returns (K, C) doubles, and what it raised.
pub(crate) struct Called {
    function: Py<PyAny>,
    raised: Mutex<Option<PyErr>>,
}

impl Called {
    pub(crate) fn new(function: Py<PyAny>) -> Arc<Self> {
        Arc::new(Self { function, raised: Mutex::new(None) })
    }

    /// Its values; it is not called again once it has raised.
    pub(crate) fn values(&self, points: &[[f64; 3]]) -> Result<Vec<f64>> {
        let values = Python::attach(|py| -> PyResult<Option<Vec<f64>>> {
            if self.raised().is_some() {
                return Ok(None);
            }
            let values = self.function.bind(py).call1((table(py, points.to_vec())?,))?;
            let values: PyReadonlyArray2<'_, f64> = values.extract()?;
            Ok(Some(values.as_slice()?.to_vec()))
        });
        let values = values.unwrap_or_else(|error| {
            self.raised().get_or_insert(error);
            None
        });
        values.ok_or_else(|| Error::new(ErrorKind::Interrupted, "the function has raised an error"))
    }

    pub(crate) fn raised(&self) -> MutexGuard<'_, Option<PyErr>> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The cells of a diagram with the integral of a function of `columns` values over each: a dictionary of arrays.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn integrate<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    container: Option<Container<'py>>,
    function: Py<PyAny>,
    degree: u32,
    columns: usize,
    epsilon: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let diagram = diagram(&points, weights.as_ref(), container.as_ref())?;
    let called = Called::new(function);
    let calls = Arc::clone(&called);
    let integrand = Integrand::batches(degree, columns, move |points| calls.values(points)).map_err(raised)?;
    let mut request = Request::moments().with_integral(integrand);
    if let Some(epsilon) = epsilon {
        request = request.with_epsilon(epsilon);
    }
    let backend = backend.get()?;
    let done = detached(py, |stop| backend.evaluate_watched(&diagram, &request, stop));
    let error = called.raised().take();
    match error {
        Some(error) => Err(error),
        None => arrays(py, done?.into_arrays()),
    }
}
