//! What the Python package `laguerre` is made of: arrays in, arrays out. How it looks to its users is in `laguerre/`.

mod callback;
mod cells;
mod container;
mod fluid;
mod geometry;
mod integral;
mod run;
mod save;
mod solvers;

use pyo3::prelude::*;

// Without Python's lock, too: what threads share is frozen or behind a lock, and arrays are of one call, or constant.
#[pymodule(gil_used = false)]
mod _laguerre {
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use super::cells::{Backend, devices, evaluate, jacobian, pull_back_cells};
    #[pymodule_export]
    use super::container::Domain;
    #[pymodule_export]
    use super::fluid::{fluid, scene};
    #[pymodule_export]
    use super::geometry::Geometry;
    #[pymodule_export]
    use super::integral::integrate;
    #[pymodule_export]
    use super::save::{page, save, write};
    #[pymodule_export]
    use super::solvers::{lloyd, pull_back, transport};
}
