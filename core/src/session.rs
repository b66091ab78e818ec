//! A diagram that is evaluated again and again while its sites move, and what a loop asks of it each time: a few numbers.

mod totals;

use crate::parallel;
use crate::summation::CHUNK;
pub use totals::{Totals, relative_deviation};

use crate::{Backend, CellStatus, ErrorKind, Output, PowerDiagram, Request, Result};

/// Sites that stay in a backend's memory, with what comes of their cells: what a [`Session`] computes with where its backend has it. For backends.
///
/// # Errors
/// Those of the device, after which the session goes the host's way; and `Interrupted`.
pub trait Resident {
    /// Brings the sites of a diagram there.
    fn set_sites(&mut self, diagram: &PowerDiagram) -> Result<()>;

    /// Evaluates the cells of the sites that are there; `None` where they are not all its own to compute, or what it finds is not to be believed.
    fn evaluate(&mut self) -> Result<Option<Totals>>;

    /// Moves each site to the barycenter of its cell, the same that an [`Output`] has, to the bit; whether it could, from an evaluation of its own.
    fn move_to_barycenters(&mut self) -> Result<bool>;

    /// The sites are where they were before that.
    fn step_back(&mut self);

    /// Where the sites are.
    fn positions(&self) -> Result<Vec<[f64; 3]>>;

    /// What an evaluation of the sites would give, which `diagram` has; `None` where it has to be one.
    fn read(&mut self, diagram: &PowerDiagram) -> Result<Option<Output>>;
}

/// Times in a row that sites were evaluated in vain where they stay, after which they stay there no longer: each costs an evaluation.
const MOST_DECLINED: usize = 2;

/// What is known of the sites as they stand.
struct Evaluated {
    totals: Totals,
    /// `None` while it is where the sites are.
    output: Option<Output>,
}

/// The sites before they moved.
enum Before {
    /// With their weights where those changed too.
    OnHost(Vec<[f64; 3]>, Option<Vec<f64>>),
    /// Where they stay.
    Resident,
}

/// A diagram and a backend that evaluates it again and again: the sites are moved, by the caller or each to the barycenter of its cell, and evaluated where
/// they then are. A move that turns out badly, or whose evaluation fails, is undone by [`Session::step_back`].
///
/// Where the backend is one OpenCL device, sites and results stay there: only what is asked for comes back. What the device cannot do alone the session does
/// by [`Backend::evaluate`], as it does on other backends; the answers are the same.
pub struct Session<'a> {
    backend: &'a dyn Backend,
    /// Its positions are old unless `is_read`.
    diagram: &'a mut PowerDiagram,
    request: Request,
    resident: Option<Box<dyn Resident + 'a>>,
    /// Where the sites are as they stand: in the diagram, and where they stay.
    is_read: bool,
    is_brought: bool,
    here: Option<Evaluated>,
    before: Option<(Before, Option<Evaluated>)>,
    /// Times in a row that the backend could not evaluate the sites where they stay.
    declined: usize,
}

impl<'a> Session<'a> {
    /// Of a diagram, for evaluations by `request`. A diagram without a domain or box keeps the bounding box that its sites have now. It has
    /// the sites as they stand when [`Session::positions`] or [`Session::read`] was called, and at the end; until then they may be with the backend.
    ///
    /// # Errors
    /// As [`PowerDiagram::container`].
    pub fn new(backend: &'a dyn Backend, diagram: &'a mut PowerDiagram, request: Request) -> Result<Self> {
        diagram.keep_container()?;
        let resident = backend.resident(&request, &());
        Ok(Self {
            backend,
            diagram,
            request,
            resident,
            is_read: true,
            is_brought: false,
            here: None,
            before: None,
            declined: 0,
        })
    }

    /// Evaluates the cells of the sites where they are, unless that is done.
    ///
    /// # Errors
    /// As [`Backend::evaluate`]; [`Session::step_back`] then leads to where all was well.
    pub fn evaluate(&mut self) -> Result<Totals> {
        let here = self.take()?;
        Ok(self.here.insert(here).totals)
    }

    /// What is known of the sites here, which then has to be put back.
    fn take(&mut self) -> Result<Evaluated> {
        if let Some(here) = self.here.take() {
            return Ok(here);
        }
        match self.evaluate_there() {
            Ok(Some(totals)) => {
                self.declined = 0;
                return Ok(Evaluated { totals, output: None });
            }
            Ok(None) => {
                self.read_sites()?;
                self.declined += usize::from(self.resident.is_some());
                if self.declined == MOST_DECLINED {
                    self.leave()?;
                }
            }
            Err(error) if error.kind() == ErrorKind::Device => self.leave()?,
            Err(error) => return Err(error),
        }
        self.evaluate_here()
    }

    fn evaluate_there(&mut self) -> Result<Option<Totals>> {
        let Some(resident) = &mut self.resident else { return Ok(None) };
        if !self.is_brought {
            resident.set_sites(self.diagram)?;
            self.is_brought = true;
        }
        resident.evaluate()
    }

    fn evaluate_here(&self) -> Result<Evaluated> {
        let output = self.backend.evaluate(self.diagram, &self.request)?;
        Ok(Evaluated { totals: Totals::of(self.diagram, &output), output: Some(output) })
    }

    /// Brings the sites to the diagram.
    fn read_sites(&mut self) -> Result<()> {
        if let (Some(resident), false) = (&self.resident, self.is_read) {
            self.diagram.exchange_sites(&mut resident.positions()?, None)?;
        }
        self.is_read = true;
        Ok(())
    }

    /// From now on nothing stays with the backend, which has no memory for it, or worse. Where the sites do not come back there is none to step back to.
    fn leave(&mut self) -> Result<()> {
        self.is_brought = false;
        let (resident, before) = (self.resident.take(), self.before.take());
        if let (Some(resident), false) = (&resident, self.is_read) {
            self.diagram.exchange_sites(&mut resident.positions()?, None)?;
        }
        self.is_read = true;
        self.before = match (resident, before) {
            (Some(mut resident), Some((Before::Resident, evaluated))) => {
                resident.step_back();
                Some((Before::OnHost(resident.positions()?, None), evaluated))
            }
            (_, before) => before,
        };
        Ok(())
    }

    /// Puts the sites elsewhere, with other weights where they are given.
    ///
    /// # Errors
    /// As [`PowerDiagram::set_sites`]; nothing is changed then.
    pub fn set_sites(&mut self, mut positions: Vec<[f64; 3]>, mut weights: Option<Vec<f64>>) -> Result<()> {
        self.read_sites()?;
        self.diagram.exchange_sites(&mut positions, weights.as_mut())?;
        self.before = Some((Before::OnHost(positions, weights), self.here.take()));
        self.is_brought = false;
        Ok(())
    }

    /// Moves each site to the barycenter of its cell; it stays where that is empty.
    ///
    /// # Errors
    /// As [`Session::evaluate`], where that was not done, and [`PowerDiagram::set_sites`].
    pub fn move_to_barycenters(&mut self) -> Result<()> {
        self.evaluate()?;
        // (What is moved there takes the place of the sites before the last move.)
        self.before = None;
        let resident = self.resident.as_mut().filter(|_| self.is_brought);
        match resident.map_or(Ok(false), |resident| resident.move_to_barycenters()) {
            Ok(true) => {
                self.before = Some((Before::Resident, self.here.take()));
                self.is_read = false;
                return Ok(());
            }
            Ok(false) => {}
            Err(error) if error.kind() == ErrorKind::Device => self.leave()?,
            Err(error) => return Err(error),
        }
        self.move_to_barycenters_in(&|_| true)
    }

    /// The same of those alone whose barycenter `accept` accepts; others stay too.
    ///
    /// # Errors
    /// As [`Session::move_to_barycenters`].
    pub fn move_to_barycenters_in(&mut self, accept: &(dyn Fn([f64; 3]) -> bool + Sync)) -> Result<()> {
        let (diagram, output) = self.read()?;
        let (sites, centers, status) = (diagram.positions(), output.barycenter(), output.status());
        let is_to_move = |i: usize| status[i] != CellStatus::Empty && accept(centers[i]);
        let moved = parallel::map(sites.len(), CHUNK, |i| if is_to_move(i) { centers[i] } else { sites[i] });
        self.set_sites(moved, None)
    }

    /// Whether the sites where they are were evaluated.
    pub fn is_evaluated(&self) -> bool {
        self.here.is_some()
    }

    /// The sites are where they were before the last move, as if that had not been.
    pub fn step_back(&mut self) {
        let Some((before, evaluated)) = self.before.take() else { return };
        match before {
            Before::OnHost(mut positions, mut weights) => {
                // (They were accepted before.)
                let _ = self.diagram.exchange_sites(&mut positions, weights.as_mut());
                (self.is_read, self.is_brought) = (true, false);
            }
            Before::Resident => {
                self.resident.iter_mut().for_each(|resident| resident.step_back());
                (self.is_read, self.is_brought) = (false, true);
            }
        }
        self.here = evaluated;
    }

    /// Where the sites are.
    ///
    /// # Errors
    /// `Device` where they do not come back from there.
    pub fn positions(&mut self) -> Result<&[[f64; 3]]> {
        self.read_sites()?;
        Ok(self.diagram.positions())
    }

    /// The diagram as it is now, and what came of its evaluation, all of it.
    ///
    /// # Errors
    /// As [`Session::evaluate`], where that was not done.
    pub fn read(&mut self) -> Result<(&PowerDiagram, &Output)> {
        let (totals, output) = self.take_whole()?;
        let here = self.here.insert(Evaluated { totals, output: None });
        Ok((self.diagram, here.output.insert(output)))
    }

    fn take_whole(&mut self) -> Result<(Totals, Output)> {
        let Evaluated { totals, output } = self.take()?;
        let output = match output {
            Some(output) => self.read_sites().map(|()| output),
            None => self.read_output(),
        };
        if output.is_err() {
            self.here = Some(Evaluated { totals, output: None });
        }
        Ok((totals, output?))
    }

    fn read_output(&mut self) -> Result<Output> {
        self.read_sites()?;
        let resident = self.resident.as_mut().filter(|_| self.is_brought);
        match resident.map_or(Ok(None), |resident| resident.read(self.diagram)) {
            Err(error) if error.kind() != ErrorKind::Device => Err(error),
            Ok(Some(output)) => Ok(output),
            _ => self.backend.evaluate(self.diagram, &self.request),
        }
    }

    /// What came of the evaluation, at the end.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub fn finish(mut self) -> Result<Output> {
        Ok(self.take_whole()?.1)
    }
}

/// The diagram has the sites as they stand, also where a loop ends with an error.
impl Drop for Session<'_> {
    fn drop(&mut self) {
        let _ = self.read_sites();
    }
}

#[cfg(test)]
mod tests;
