//! What the commands `lloyd`, `transport` and `fluid` share.

use std::path::PathBuf;

use laguerre::algebra::Algebra;
use laguerre::engine::parallel;
use laguerre::limits::LARGEST_COORDINATE;
use laguerre::{Backend, BackendInfo, Error, Observer, Output, PowerDiagram, Request, Resident, Result};

use crate::args::{BackendArgs, Precision};
use crate::evaluate::{Interruptible, evaluate, open};
use crate::outcome::{Outcome, say};

/// The backend for a solver, and the threads of the solver's own work: as many as the backend's.
pub(crate) fn open_for_solver(args: &BackendArgs) -> Result<(Box<dyn Backend>, rayon::ThreadPool)> {
    let backend = open(args)?;
    if args.precision == Precision::F32 {
        return Err(Error::input(
            "--precision f32: facets and second moments are needed here, which are there in f64 alone; give --precision f64",
        ));
    }
    Ok((backend, parallel::pool(args.threads)?))
}

/// A backend that draws its progress, where there is a terminal, and that a Ctrl-C stops, if the command ends by itself.
pub(crate) struct WithBar<'a>(pub(crate) &'a dyn Backend);

impl Backend for WithBar<'_> {
    fn info(&self) -> BackendInfo {
        self.0.info()
    }

    fn algebra(&self) -> Option<&dyn Algebra> {
        self.0.algebra()
    }

    /// (Without a bar: where sites stay with the backend, diagrams take less time than lines of a table.)
    fn resident<'a>(&'a self, request: &Request, _nobody: &'a dyn Observer) -> Option<Box<dyn Resident + 'a>> {
        self.0.resident(request, &Interruptible)
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, _nobody: &dyn Observer) -> Result<Output> {
        evaluate(self.0, diagram, request)
    }
}

/// Says what an interrupt has left, and how the program is to end.
pub(crate) fn interrupted(iterations: usize, what: &str, output: Option<&PathBuf>) -> Outcome {
    let kept = output.map_or_else(
        || format!("no file was named with -o to keep the {what}"),
        |path| match path.as_os_str() == "-" {
            true => format!("the {what} as they were then are written"),
            false => format!("the {what} as they were then are in {}", path.display()),
        },
    );
    let iterations = if iterations == 1 { "1 iteration".into() } else { format!("{iterations} iterations") };
    say(&format!("interrupted after {iterations}; {kept}"));
    Outcome::Interrupted
}

/// Numbers of the solvers' command lines are within this, as coordinates are: their squares are in range.
pub(crate) const LARGEST: f64 = LARGEST_COORDINATE;

pub(crate) fn parse_number(
    text: &str,
    is_good: impl Fn(f64) -> bool,
    needed: &str,
) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.abs() <= LARGEST && is_good(x) => Ok(x),
        _ => Err(format!("a number {needed} is needed")),
    }
}

pub(crate) fn parse_from_zero(text: &str) -> std::result::Result<f64, String> {
    parse_number(text, |x| x >= 0.0, &format!("from 0 to {LARGEST:e}"))
}
