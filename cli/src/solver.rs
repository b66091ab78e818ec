//! What the commands `lloyd`, `transport` and `fluid` share.

use laguerre::diagram::LARGEST_COORDINATE;
use laguerre::{Backend, BackendInfo, Error, ErrorKind, Output, PowerDiagram, Request, Result};

use crate::args::{BackendArgs, Precision};
use crate::evaluate::{evaluate, open};

/// The backend for a solver, and the threads of the solver's own work: as many as the backend's.
pub(crate) fn open_for_solver(args: &BackendArgs) -> Result<(Box<dyn Backend>, rayon::ThreadPool)> {
    let backend = open(args)?;
    if args.precision == Precision::F32 {
        return Err(Error::input(
            "--precision f32: facets and second moments are needed here, which are there in f64 alone; give --precision f64",
        ));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.unwrap_or(0)).build();
    let pool = pool.map_err(|e| Error::new(ErrorKind::Unavailable, format!("cannot start threads: {e}")))?;
    Ok((backend, pool))
}

/// A backend that draws its progress, where there is a terminal.
pub(crate) struct WithBar<'a>(pub(crate) &'a dyn Backend);

impl Backend for WithBar<'_> {
    fn info(&self) -> BackendInfo {
        self.0.info()
    }

    fn evaluate(&self, diagram: &PowerDiagram, request: &Request) -> Result<Output> {
        evaluate(self.0, diagram, request)
    }
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
