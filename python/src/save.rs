//! Cells as files and pages.

use std::path::{Path, PathBuf};

use laguerre::io::{self, GEOMETRY_ENDINGS};
use laguerre::{CellStatus, Output, PowerDiagram, Result};
use laguerre_page::{ENDINGS, Moment, Page, Plot, Timeline, write_run, write_still};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::cells::{Backend, output};
use crate::container::{Container, diagram, rows};
use crate::run::{Stoppable, detached_in_pool, raised};

/// Writes cells, or their facets, as the file's ending says, whole or not at all; cells with geometry where the ending is a geometry's or a page's.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn save<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    weights: Option<PyReadonlyArray1<'py, f64>>,
    container: Option<Container<'py>>,
    cells: &Bound<'py, PyDict>,
    of_facets: bool,
    path: PathBuf,
) -> PyResult<()> {
    check(&path, of_facets).map_err(raised)?;
    let diagram = diagram(&points, weights.as_ref(), container.as_ref())?;
    let has_geometry = io::ending(&path, ENDINGS).or_else(|_| io::ending(&path, GEOMETRY_ENDINGS)).is_ok();
    let output = output(cells, has_geometry)?;
    let backend = backend.get()?;
    detached_in_pool(py, backend.info().threads, |stop| {
        if io::ending(&path, ENDINGS).is_ok() {
            let title = format!("{} cells", output.sites());
            let facts = facts(&output, &diagram, backend)?;
            return write_still(&path, &Page { title, facts, ..Page::default() }, &diagram, &output, stop);
        }
        if io::ending(&path, GEOMETRY_ENDINGS).is_ok() {
            return io::write_geometry_watched(&path, &diagram, &output, stop);
        }
        if of_facets {
            return io::write_facets(&path, &diagram, &output);
        }
        io::write_cells_watched(&path, &diagram, &output, stop)
    })
}

/// Writes the bytes of a file of NumPy's, whole or not at all.
#[pyfunction]
pub(crate) fn write(py: Python<'_>, path: PathBuf, bytes: PyReadonlyArray1<'_, u8>) -> PyResult<()> {
    let bytes = bytes.as_slice()?;
    py.detach(|| io::write_whole(&path, |to| to.write_all(bytes))).map_err(raised)
}

/// A state of a run: what it is called, points, weights, and a number of each point, if there is one.
type State<'py> =
    (String, PyReadonlyArray2<'py, f64>, Option<PyReadonlyArray1<'py, f64>>, Option<PyReadonlyArray1<'py, f64>>);

/// Writes the page of a run: its states, or some of them where they are many, with speeds where they have them, and its `curve`: what its numbers are, and
/// one for each state.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the function of Python has as many")]
pub(crate) fn page<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    container: Option<Container<'py>>,
    states: Vec<State<'py>>,
    has_speeds: bool,
    curve: Option<(String, Vec<f64>)>,
    title: String,
    path: PathBuf,
) -> PyResult<()> {
    io::check_output(&path, ENDINGS).map_err(raised)?;
    let mut first = None;
    let mut timeline = None;
    for (row, (label, points, weights, values)) in states.into_iter().enumerate() {
        let diagram = diagram(&points, weights.as_ref(), container.as_ref())?;
        let timeline = timeline.get_or_insert_with(|| Timeline::new(diagram.positions().len()));
        let positions = rows(points.as_slice()?, "points").map_err(raised)?.to_vec();
        let values = values.map(|values| values.as_slice().map(<[f64]>::to_vec)).transpose()?;
        let weights = diagram.weights().to_vec();
        timeline.add(|| Some(Moment { label, row, positions, weights, values: values.into_iter().collect() }));
        first.get_or_insert(diagram);
    }
    let (Some(diagram), Some(timeline)) = (first, timeline) else { return Ok(()) };
    let (moments, shown) = timeline.finish("states");
    let fields = if has_speeds { vec![("speed", "length/time")] } else { Vec::new() };
    let facts = vec![("sites", diagram.positions().len().to_string())];
    let plot = curve.and_then(|(name, values)| Plot::of(&name, values));
    let page = Page { title, facts, shown, plot, fields, ..Page::default() };
    let backend = backend.get()?;
    detached_in_pool(py, backend.info().threads, |stop| {
        write_run(&path, &page, &Stoppable { backend, stop }, &diagram, &moments)
    })
}

/// What can be said before the work.
fn check(path: &Path, of_facets: bool) -> Result<()> {
    // `.npy` and `.npz` are NumPy's own, and do not come here.
    let mut known = vec![".csv", ".npy", ".npz"];
    if !of_facets {
        known.extend(GEOMETRY_ENDINGS.iter().chain(ENDINGS));
    }
    io::check_output(path, &known)
}

/// The figures of a diagram.
fn facts(
    output: &Output,
    diagram: &PowerDiagram,
    backend: &dyn laguerre::Backend,
) -> Result<Vec<(&'static str, String)>> {
    let empty = output.count(CellStatus::Empty);
    let whole = diagram.container()?.volume();
    let mut sum = laguerre::summation::Sum::default();
    sum.extend(output.volume().iter().copied());
    let info = backend.info();
    Ok(vec![
        ("sites", output.sites().to_string()),
        ("cells", format!("{}, {empty} empty", output.sites() - empty)),
        ("sum of volumes", format!("{} of {whole}", sum.total())),
        ("backend", format!("{}, {}, {}", info.backend, info.precision.word(), info.device)),
        ("version", format!("laguerre {}", env!("CARGO_PKG_VERSION"))),
    ])
}
