//! Incompressible fluids by power particles, with a callback at each step.

use laguerre::solvers::fluid::{Energy, Fluid, Gravity, Scene, Settings, Start, State, lattice};
use laguerre::{Backend as _, Error, Request};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::callback::Callback;
use crate::cells::{Backend, arrays};
use crate::container::{Container, diagram, rows, table};
use crate::run::{Stoppable, detached_in_pool, raised};

/// A shake: its acceleration, how long a swing takes, and how many there are.
type Shake = ([f64; 3], f64, f64);
/// What a fluid goes on from beside its particles: steps, time, weights, their rates, the Hamiltonian at the start, and what was brought in.
type Before<'py> = (u64, f64, PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>, f64, f64);

/// What is kept of each step.
struct Row {
    time: f64,
    residual: f64,
    energy: Energy,
    drift: f64,
}

impl Row {
    fn of(fluid: &Fluid) -> Self {
        let (time, residual) = (fluid.state().time, fluid.residual());
        Self { time, residual, energy: fluid.energy(), drift: fluid.drift() }
    }
}

/// The columns of rows, under the names that a callback has.
type Column = (&'static str, fn(&Row) -> f64);
const COLUMNS: [Column; 6] = [
    ("time", |row| row.time),
    ("residual", |row| row.residual),
    ("kinetic", |row| row.energy.kinetic),
    ("spring", |row| row.energy.spring),
    ("potential", |row| row.energy.potential),
    ("drift", |row| row.drift),
];

/// Steps of a fluid: a dictionary of its state, its settings, columns of its history and its cells.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python's keywords, one by one")]
pub(crate) fn fluid<'py>(
    py: Python<'py>,
    backend: PyRef<'py, Backend>,
    points: PyReadonlyArray2<'py, f64>,
    container: Option<Container<'py>>,
    velocities: PyReadonlyArray2<'py, f64>,
    densities: PyReadonlyArray1<'py, f64>,
    epsilon: Option<f64>,
    viscosity: f64,
    gravity: [f64; 3],
    shake: Option<Shake>,
    time_step: Option<f64>,
    before: Option<Before<'py>>,
    steps: u64,
    callback: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let container = diagram(&points, None, container.as_ref())?.container().map_err(raised)?;
    let start = Start {
        positions: rows(points.as_slice()?, "points").map_err(raised)?.to_vec(),
        velocities: rows(velocities.as_slice()?, "velocities").map_err(raised)?.to_vec(),
        densities: densities.as_slice()?.to_vec(),
    };
    let (shake, period, swings) = shake.unwrap_or_default();
    let mut acting = Gravity::default();
    (acting.steady, acting.shake, acting.period, acting.swings) = (gravity, shake, period, swings);
    let mut settings = Settings::new(epsilon.unwrap_or_else(|| start.epsilon(&container, &acting)));
    (settings.viscosity, settings.gravity, settings.time_step) = (viscosity, acting, time_step);
    let before = before.map(|before| state(&start, &before)).transpose()?;
    let callback = Callback::new(callback);
    let (backend, told) = (backend.get()?, &callback);
    let done = detached_in_pool(py, backend.info().threads, |stop| {
        let backend = Stoppable { backend, stop };
        let mut fluid = match before {
            Some(state) => Fluid::resume(&backend, &container, state, settings)?,
            None => Fluid::new(&backend, &container, start, settings)?,
        };
        let mut history = vec![Row::of(&fluid)];
        let mut ends = told.call_with(|py, told| tell(py, told, &fluid, &history[0])).is_break();
        let last = fluid.state().steps + steps;
        while !ends && fluid.state().steps < last {
            let number = fluid.state().steps + 1;
            fluid.step(&backend).map_err(|error| error.at(format!("step {number}")))?;
            let row = Row::of(&fluid);
            ends = told.call_with(|py, told| tell(py, told, &fluid, &row)).is_break();
            history.push(row);
        }
        let output = backend.evaluate(fluid.diagram(), &Request::moments().with_facets())?;
        Ok((fluid, history, ends, output))
    });
    let (fluid, history, ends, output) = callback.or_raise(done)?;
    let found = PyDict::new(py);
    put_state(py, &found, fluid.state())?;
    found.set_item("epsilon", settings.epsilon)?;
    found.set_item("end", if ends { "stopped" } else { "steps" })?;
    for (name, column) in COLUMNS {
        found.set_item(name, PyArray1::from_vec(py, history.iter().map(column).collect()))?;
    }
    found.set_item("cells", arrays(py, output.into_arrays())?)?;
    Ok(found)
}

/// What a callback is told.
fn tell(py: Python<'_>, told: &Bound<'_, PyDict>, fluid: &Fluid, row: &Row) -> PyResult<()> {
    let State { steps, positions, velocities, weights, .. } = fluid.state();
    told.set_item("step", steps)?;
    COLUMNS.iter().try_for_each(|(name, column)| told.set_item(name, column(row)))?;
    told.set_item("points", table(py, positions.clone())?)?;
    told.set_item("velocities", table(py, velocities.clone())?)?;
    told.set_item("weights", PyArray1::from_slice(py, weights))
}

/// All that a fluid goes on from.
fn put_state(py: Python<'_>, found: &Bound<'_, PyDict>, state: &State) -> PyResult<()> {
    found.set_item("steps", state.steps)?;
    found.set_item("points", table(py, state.positions.clone())?)?;
    found.set_item("velocities", table(py, state.velocities.clone())?)?;
    found.set_item("densities", PyArray1::from_slice(py, &state.densities))?;
    found.set_item("weights", PyArray1::from_slice(py, &state.weights))?;
    found.set_item("weight_rates", PyArray1::from_slice(py, &state.weight_rates))?;
    found.set_item("_at_start", (state.hamiltonian_at_start, state.brought_in))
}

fn state(start: &Start, before: &Before<'_>) -> PyResult<State> {
    let (steps, time, weights, rates, hamiltonian_at_start, brought_in) = before;
    let Start { positions, velocities, densities } = start.clone();
    let mut state = State::default();
    (state.steps, state.time, state.hamiltonian_at_start, state.brought_in) =
        (*steps, *time, *hamiltonian_at_start, *brought_in);
    (state.positions, state.velocities, state.densities) = (positions, velocities, densities);
    (state.weights, state.weight_rates) = (weights.as_slice()?.to_vec(), rates.as_slice()?.to_vec());
    Ok(state)
}

/// A scene as the program's command `fluid` has it: the arguments of a fluid, but for its container, and the extent of the scene's box.
///
/// `centers` are where cells are to be; without, a lattice of about `count` in the box.
#[pyfunction]
pub(crate) fn scene<'py>(
    py: Python<'py>,
    name: &str,
    count: usize,
    centers: Option<PyReadonlyArray2<'py, f64>>,
    container: Option<Container<'py>>,
    gravity: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let wrong = |message: String| raised(Error::input(message));
    let Some(scene) = Scene::named(name) else {
        let names = Scene::ALL.map(|scene| format!("'{}'", scene.name())).join(", ");
        return Err(wrong(format!("scene '{name}': one of {names} is needed")));
    };
    if container.is_some() && !scene.has_two_densities() {
        return Err(wrong(format!("{name} is a flow in the unit cube; leave domain out")));
    }
    let centers = match (&centers, scene.extent()) {
        (Some(centers), _) => rows(centers.as_slice()?, "points").map_err(raised)?.to_vec(),
        (None, Some(extent)) if container.is_none() => lattice(extent, count),
        _ => {
            return Err(wrong(format!(
                "{name} in a domain: give the points that fill it in the place of their number"
            )));
        }
    };
    let container = match (&container, scene.extent()) {
        (None, Some(extent)) => laguerre::Container::Box([0.0; 3], extent),
        (None, None) => return Err(wrong(format!("{name} has no box of its own: give a domain"))),
        (Some(Container::Box(lo, hi)), _) => laguerre::Container::Box(*lo, *hi),
        (Some(Container::Domain(domain)), _) => laguerre::Container::Domain(domain.0.clone()),
    };
    let (lo, hi) = match &container {
        laguerre::Container::Box(lo, hi) => (*lo, *hi),
        laguerre::Container::Domain(domain) => domain.bounding_box(),
    };
    let densities = scene.densities(&centers, lo, hi);
    let size = (container.volume() / container.mean_density() / centers.len() as f64).cbrt();
    let settings = scene.settings(&densities, lo, hi, size, gravity);
    let start = scene.start(&centers, densities, &settings);
    let found = PyDict::new(py);
    found.set_item("points", table(py, start.positions)?)?;
    found.set_item("velocities", table(py, start.velocities)?)?;
    found.set_item("densities", PyArray1::from_vec(py, start.densities))?;
    found.set_item("epsilon", settings.epsilon)?;
    found.set_item("viscosity", settings.viscosity)?;
    let Gravity { steady, shake, period, swings, .. } = settings.gravity;
    found.set_item("gravity", steady)?;
    found.set_item("shake", (swings > 0.0).then_some((shake, period, swings)))?;
    found.set_item("extent", scene.extent())?;
    Ok(found)
}
