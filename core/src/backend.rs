//! The trait behind which the CPU and GPUs stand.

use std::ops::{ControlFlow, Deref};

use crate::algebra::Algebra;
use crate::session::Resident;
use crate::{Error, Output, PowerDiagram, Request, Result};

/// Threads at most: more than any machine has would only exhaust it.
pub const MOST_THREADS: usize = 4096;

/// What a backend can be asked for beside volumes, barycenters and geometry, which all give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Capabilities {
    /// Facets, Laplacians, second moments of cells and facets, and integrals of polynomials.
    pub further: bool,
    /// Integrals of functions of the caller's.
    pub functions: bool,
}

impl Capabilities {
    /// All.
    pub const ALL: Self = Self { further: true, functions: true };
    /// All but functions of the caller's, which no device can call.
    pub const OF_DEVICES: Self = Self { further: true, functions: false };
    /// Volumes, barycenters and geometry.
    pub const MOMENTS: Self = Self { further: false, functions: false };

    /// Whether a request is within them. Called by backends.
    ///
    /// # Errors
    /// `Input` where not, or where a number of the request is none.
    pub fn check(self, request: &Request, diagram: &PowerDiagram) -> Result<()> {
        request.check(diagram)?;
        let wants_function = request.integral().is_some_and(crate::Integrand::is_function);
        if !self.further && (request.needs_facets() || request.second_moments() || request.integral().is_some()) {
            return Err(Error::input(
                "in f32 there are volumes, barycenters and geometry only: compute facets, Laplacians, second moments and integrals in f64",
            ));
        }
        if !self.functions && wants_function {
            return Err(Error::input(
                "integrand: a device cannot call a function: give the coefficients of a polynomial, or compute on the CPU",
            ));
        }
        Ok(())
    }
}

/// Watches an evaluation, or the writing of a file, from outside, and may end it: a progress bar, a button.
pub trait Observer: Sync {
    /// `cells` more of the diagram's are finished (while a file is written always 0); called often, by any thread. `Break` ends the work soon, with
    /// an error of the kind [`Interrupted`](crate::ErrorKind::Interrupted).
    fn advance(&self, cells: usize) -> ControlFlow<()>;
}

impl dyn Observer + '_ {
    /// Tells that `cells` more are finished.
    ///
    /// # Errors
    /// `Interrupted` where that ends the work.
    pub fn tell(&self, cells: usize) -> Result<()> {
        match self.advance(cells) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::interrupted()),
        }
    }
}

/// Nobody.
impl Observer for () {
    fn advance(&self, _cells: usize) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// A request, with who watches while it is served: what a backend hands on to its parts.
#[derive(Clone, Copy)]
pub struct Watched<'a> {
    request: &'a Request,
    observer: &'a dyn Observer,
}

impl<'a> Watched<'a> {
    /// A request, watched by an observer.
    pub fn new(request: &'a Request, observer: &'a dyn Observer) -> Self {
        Self { request, observer }
    }

    /// `cells` more are finished.
    ///
    /// # Errors
    /// `Interrupted` where the observer ends the evaluation.
    pub fn advance(&self, cells: usize) -> Result<()> {
        self.observer.tell(cells)
    }

    /// The same observer of another request.
    pub fn of<'b>(&self, request: &'b Request) -> Watched<'b>
    where
        'a: 'b,
    {
        Watched { request, observer: self.observer }
    }
}

impl Deref for Watched<'_> {
    type Target = Request;

    fn deref(&self) -> &Request {
        self.request
    }
}

/// Who computes, and what it can.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BackendInfo {
    /// `cpu`, `ocl`.
    pub backend: &'static str,
    /// The device in its own words.
    pub device: String,
    /// What numbers it computes with.
    pub precision: Precision,
    /// Host threads at work.
    pub threads: usize,
    /// What it can be asked for.
    pub capabilities: Capabilities,
}

impl BackendInfo {
    /// A backend that computes on the host, in double precision, all that there is.
    pub fn of_host(backend: &'static str, device: String, threads: usize) -> Self {
        Self { backend, device, precision: Precision::F64, threads, capabilities: Capabilities::ALL }
    }

    /// A backend that computes on devices, all but functions.
    pub fn of_devices(backend: &'static str, device: String, precision: Precision) -> Self {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Self { backend, device, precision, threads, capabilities: Capabilities::OF_DEVICES }
    }

    /// The same with other capabilities.
    #[must_use]
    pub fn with(self, capabilities: Capabilities) -> Self {
        Self { capabilities, ..self }
    }
}

/// Which devices of a backend to compute on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// The first GPU that can be used, else the first other device.
    #[default]
    First,
    /// The devices of these numbers, counted from 0 in the order of their listing. One may be named twice.
    Numbers(Vec<usize>),
    /// All that can be used.
    All,
}

/// The numbers that devices compute with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Precision {
    /// 64 bits.
    #[default]
    F64,
    /// 32 bits: volumes, barycenters and geometry alone, or, where lanes share a cell, a first try of those cells; each volume within 2⁻¹⁰ of itself by its own bound. No cell is lost: what that leaves
    /// open, the host computes with 64.
    F32,
}

impl Precision {
    /// `f64` or `f32`.
    pub fn word(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}

/// A device, and why it cannot be used if so.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct DeviceInfo {
    /// Its name, in its own words.
    pub name: String,
    /// The name of its platform, the driver.
    pub platform: String,
    /// Whether it is a GPU.
    pub is_gpu: bool,
    /// Compute units.
    pub compute_units: u32,
    /// Global memory in bytes.
    pub memory: u64,
    /// Why it cannot be used.
    pub unusable: Option<String>,
}

impl DeviceInfo {
    /// A device of a platform, nothing else known of it yet.
    pub fn new(name: &str, platform: &str) -> Self {
        Self { name: name.trim().to_owned(), platform: platform.trim().to_owned(), ..Self::default() }
    }
}

/// Something that can compute a restricted power diagram.
///
/// # Contract
///
/// *What the caller has already checked.* A [`PowerDiagram`] and its domain exist only validated: sites are finite, the
/// domain closed and oriented. The implementation takes the sites from
/// [`PowerDiagram::prepare`](crate::diagram::PowerDiagram::prepare), which sorts them, sets coincident ones aside and
/// moves everything into the internal frame, or does that itself.
///
/// *What the implementation owes.* Every cell of the output is `Complete` or `Empty`, each by proof; `Uncertified` occurs only
/// where the request's `epsilon` ended the search. Per-cell trouble (a capacity that was too small, a sign that floating
/// point could not decide) is its own to settle and never leaves it. The geometry is [`crate::cell`]; a backend writes
/// storage, scheduling and transfer, and never restates it. The output does not depend on the number of threads,
/// nor on what was evaluated before.
///
/// *Which errors can reach the caller.* `Input`, only for sites out of range of the domain, for what cannot be asked for together
/// ([`Request::check`]) or is not among the backend's [`Capabilities`], and for an integral that is not finite; `Device` for device, driver and memory; `Interrupted` where the observer ends the
/// evaluation. Never a partial result passed as whole.
///
/// *To watch a solver*, give it a backend that wraps another one and adds an observer to each evaluation. Where that ends one, the solver ends
/// with the best that it has.
///
/// *At the same time.* Any threads may evaluate, tasks of a pool too; those that need the same devices wait for each other, whatever pool they are of. (An
/// observer or an integrand does not evaluate with the backend that calls it.)
///
/// *Reuse.* Evaluating again with the same backend reuses its buffers; with the same domain, its grid.
pub trait Backend: Send + Sync {
    /// Who computes.
    fn info(&self) -> BackendInfo;

    /// Linear algebra in this backend's memory, if that is not the host's. (A backend that wraps another one hands on what that has.)
    fn algebra(&self) -> Option<&dyn Algebra> {
        None
    }

    /// Room for sites that stay in this backend's memory with what `request` asks for of their cells, each evaluation watched by `observer`: for a
    /// [`Session`](crate::Session), which does without where there is none. (A backend that wraps another one hands on what that has, with its own observer.)
    fn resident<'a>(&'a self, _request: &Request, _observer: &'a dyn Observer) -> Option<Box<dyn Resident + 'a>> {
        None
    }

    /// Computes what `request` asks for, for every site of `diagram`, watched by `observer`.
    ///
    /// # Errors
    /// See the contract above.
    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output>;

    /// Computes what `request` asks for, for every site of `diagram`.
    ///
    /// # Errors
    /// See the contract above.
    fn evaluate(&self, diagram: &PowerDiagram, request: &Request) -> Result<Output> {
        self.evaluate_watched(diagram, request, &())
    }
}
