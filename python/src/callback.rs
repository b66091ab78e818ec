//! Callbacks of the user's, which may end a solver.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use laguerre_page::Remembering;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::container::table;

/// A callback, and what it raised.
pub(crate) struct Callback {
    function: Option<Py<PyAny>>,
    raised: Mutex<Option<PyErr>>,
}

impl Callback {
    pub(crate) fn new(function: Option<Py<PyAny>>) -> Self {
        Self { function, raised: Mutex::new(None) }
    }

    /// Whether there is one.
    pub(crate) fn is_there(&self) -> bool {
        self.function.is_some()
    }

    /// Calls it with numbers by their names, and the points and weights of the diagram that they are of.
    pub(crate) fn call(&self, numbers: &[(&str, f64)], backend: &Remembering<'_>) -> ControlFlow<()> {
        self.call_with(|py, told| {
            numbers.iter().try_for_each(|(name, number)| told.set_item(name, number))?;
            if let Some(moment) = backend.moment(String::new(), 0) {
                told.set_item("points", table(py, moment.positions)?)?;
                let weights = (!moment.weights.is_empty()).then(|| PyArray1::from_vec(py, moment.weights));
                told.set_item("weights", weights)?;
            }
            Ok(())
        })
    }

    /// Calls it with what `tell` puts into a dictionary; what it raises, or a true answer, ends the solver.
    pub(crate) fn call_with(
        &self,
        tell: impl FnOnce(Python<'_>, &Bound<'_, PyDict>) -> PyResult<()>,
    ) -> ControlFlow<()> {
        let Some(function) = &self.function else { return ControlFlow::Continue(()) };
        let stops = Python::attach(|py| -> PyResult<bool> {
            let told = PyDict::new(py);
            tell(py, &told)?;
            function.bind(py).call1((told,))?.is_truthy()
        });
        match stops {
            Ok(false) => ControlFlow::Continue(()),
            Ok(true) => ControlFlow::Break(()),
            Err(error) => {
                *self.raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                ControlFlow::Break(())
            }
        }
    }

    /// What a solver came to, or what the callback raised.
    pub(crate) fn or_raise<T>(self, done: PyResult<T>) -> PyResult<T> {
        match self.raised.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => done,
        }
    }
}
