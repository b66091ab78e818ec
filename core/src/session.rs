//! A diagram that is evaluated again and again while its sites move, and what a loop asks of it each time: a few numbers.

use rayon::prelude::*;

use crate::summation::{Sum, chunks};
use crate::{Backend, CellStatus, ErrorKind, Output, PowerDiagram, Request, Result};

/// Sums over the cells of a diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Totals {
    /// Cells that are not empty.
    pub cells: usize,
    /// Of all sites those whose cells are.
    pub empty: usize,
    /// Cells that are not certified.
    pub uncertified: usize,
    /// `Σ V_i` (length³).
    pub volume: f64,
    /// `Σ |V_i|` (length³).
    pub size: f64,
    /// Standard deviation of the volumes of all cells over their mean.
    pub spread: f64,
    /// `Σ ∫ (‖x − p_i‖² − w_i) dx` (length⁵); NaN where second moments are not asked for.
    pub energy: f64,
    /// `√(Σ |V_i| ‖p_i − b_i‖² / Σ |V_i|)` (length), how far sites are from the barycenters of their cells.
    pub displacement: f64,
}

impl Totals {
    /// The numbers of cells and what they sum to, in the order of the fields. For backends.
    #[doc(hidden)]
    pub fn new(
        [cells, empty, uncertified]: [usize; 3],
        [volume, size, spread, energy, displacement]: [f64; 5],
    ) -> Self {
        Self { cells, empty, uncertified, volume, size, spread, energy, displacement }
    }

    /// Of lengths in some `unit`, and masses of some density: in the caller's. For backends.
    #[doc(hidden)]
    #[must_use]
    pub fn in_units(self, density: f64, unit: f64) -> Self {
        let (volume, energy) = (density * unit.powi(3), density * unit.powi(5));
        Self {
            volume: self.volume * volume,
            size: self.size * volume,
            energy: self.energy * energy,
            displacement: self.displacement * unit,
            ..self
        }
    }

    /// Of a diagram from what came of its evaluation, compensated, on all threads.
    pub fn of(diagram: &PowerDiagram, output: &Output) -> Self {
        let (positions, weights, volumes) = (diagram.positions(), diagram.weights(), output.volume());
        let second = output.second_moment();
        // (Products of volumes and squares of tiny lengths may be below all numbers.)
        let largest = chunks(volumes.len(), |range| volumes[range].iter().fold(0.0, |a: f64, v| a.max(v.abs())));
        let largest = largest.into_iter().fold(0.0, f64::max);
        let parts = chunks(volumes.len(), |range| {
            let (mut cells, mut uncertified, mut part) = (0, 0, [Sum::default(); 4]);
            let [volume, negative, energy, displacement] = &mut part;
            for i in range.filter(|&i| output.status()[i] != CellStatus::Empty) {
                let (v, p, b) = (volumes[i], positions[i], output.barycenter()[i]);
                let off: f64 = (0..3).map(|k| (p[k] - b[k]) * (p[k] - b[k])).sum();
                cells += 1;
                uncertified += usize::from(output.status()[i] == CellStatus::Uncertified);
                volume.add(v);
                if v < 0.0 {
                    negative.add(v);
                }
                if let Some([xx, yy, zz, ..]) = second.map(|second| second[i]) {
                    let weight = weights.get(i).copied().unwrap_or(0.0);
                    energy.add((xx + yy + zz) + v * (off - weight));
                }
                displacement.add(v.abs() / largest * off);
            }
            (cells, uncertified, part)
        });
        let (mut cells, mut uncertified, mut all) = (0, 0, [Sum::default(); 4]);
        for (more, unsure, part) in parts {
            cells += more;
            uncertified += unsure;
            all.iter_mut().zip(part).for_each(|(sum, part)| sum.join(part));
        }
        let [volume, negative, energy, displacement] = all.map(|sum| sum.total());
        let size = volume - 2.0 * negative;
        Self {
            cells,
            empty: volumes.len() - cells,
            uncertified,
            volume,
            size,
            spread: relative_deviation(volumes),
            energy: if second.is_some() { energy } else { f64::NAN },
            displacement: (displacement / (size / largest)).sqrt(),
        }
    }
}

/// Standard deviation over mean. Two passes, so that plain sums suffice for a figure that is compared with a tenth, and nothing overflows.
pub fn relative_deviation(volumes: &[f64]) -> f64 {
    let n = volumes.len() as f64;
    let sum = |term: &(dyn Fn(f64) -> f64 + Sync)| -> f64 {
        chunks(volumes.len(), |range| volumes[range].iter().map(|&v| term(v)).sum::<f64>()).iter().sum()
    };
    let mean = sum(&|v| v) / n;
    (sum(&|v| (v / mean - 1.0).powi(2)) / n).sqrt()
}

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
    /// the sites as they stand when [`Session::positions`], [`Session::read`] or [`Session::finish`] was called; until then they may be with the backend.
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
        let sites = diagram.positions().par_iter().zip(output.barycenter()).zip(output.status());
        let moved =
            sites.map(|((&old, &new), &status)| if status != CellStatus::Empty && accept(new) { new } else { old });
        let moved = moved.collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::Naive;
    use crate::{BackendInfo, Error, Observer};
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A backend whose sites stay, until a call of some number, which fails in some way, or fails and so do all after it.
    struct Staying {
        naive: Naive,
        calls: AtomicUsize,
        fails_at: usize,
        with_error: bool,
    }

    struct Stay<'a> {
        backend: &'a Staying,
        diagram: Option<PowerDiagram>,
        request: Request,
        before: Vec<[f64; 3]>,
        output: Option<Output>,
        output_before: Option<Output>,
    }

    impl Staying {
        /// Whether the next call does what it is to do.
        fn works(&self) -> Result<bool> {
            let is_well = self.calls.fetch_add(1, Ordering::Relaxed) != self.fails_at;
            if is_well || !self.with_error { Ok(is_well) } else { Err(Error::new(ErrorKind::Device, "a fault")) }
        }
    }

    impl Backend for Staying {
        fn info(&self) -> BackendInfo {
            self.naive.info()
        }

        fn resident<'a>(&'a self, request: &Request, _: &'a dyn Observer) -> Option<Box<dyn Resident + 'a>> {
            let (request, before) = (request.clone(), Vec::new());
            Some(Box::new(Stay { backend: self, diagram: None, request, before, output: None, output_before: None }))
        }

        fn evaluate_watched(
            &self,
            diagram: &PowerDiagram,
            request: &Request,
            observer: &dyn Observer,
        ) -> Result<Output> {
            self.naive.evaluate_watched(diagram, request, observer)
        }
    }

    impl Resident for Stay<'_> {
        fn set_sites(&mut self, diagram: &PowerDiagram) -> Result<()> {
            self.backend.works()?;
            (self.diagram, self.output) = (Some(diagram.clone()), None);
            Ok(())
        }

        fn evaluate(&mut self) -> Result<Option<Totals>> {
            self.output = None;
            if !self.backend.works()? {
                return Ok(None);
            }
            let diagram = self.diagram.as_ref().unwrap();
            let output = self.output.insert(self.backend.naive.evaluate(diagram, &self.request)?);
            Ok(Some(Totals::of(diagram, output)))
        }

        fn move_to_barycenters(&mut self) -> Result<bool> {
            let (Some(output), true) = (self.output.take(), self.backend.works()?) else { return Ok(false) };
            self.before = output.barycenter().to_vec();
            self.diagram.as_mut().unwrap().exchange_sites(&mut self.before, None)?;
            self.output_before = Some(output);
            Ok(true)
        }

        fn step_back(&mut self) {
            self.diagram.as_mut().unwrap().exchange_sites(&mut self.before, None).unwrap();
            self.output = self.output_before.take();
        }

        fn positions(&self) -> Result<Vec<[f64; 3]>> {
            Ok(self.diagram.as_ref().unwrap().positions().to_vec())
        }

        fn read(&mut self, diagram: &PowerDiagram) -> Result<Option<Output>> {
            assert_eq!(diagram.positions(), self.diagram.as_ref().unwrap().positions());
            Ok(if self.backend.works()? { self.output.clone() } else { None })
        }
    }

    fn sites(count: usize) -> PowerDiagram {
        let at = |i: usize| [0.754_877, 0.569_840, 0.430_159].map(|s| (i as f64 * s).fract());
        let sites: Vec<[f64; 3]> = (1..=count).map(at).collect();
        PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap()
    }

    /// Every kind of step, what is known after each, and positions and volumes at the end.
    fn walk(backend: &dyn Backend) -> Result<(Vec<Totals>, Vec<f64>)> {
        let mut diagram = sites(9);
        let other = sites(7);
        let mut session = Session::new(backend, &mut diagram, Request::moments().with_second_moments())?;
        let mut known = Vec::new();
        for step in 0..3 {
            known.push(session.evaluate()?);
            session.move_to_barycenters()?;
            if step == 1 {
                session.positions()?;
            }
        }
        known.push(session.evaluate()?);
        session.move_to_barycenters()?;
        session.step_back();
        known.push(session.evaluate()?);
        session.move_to_barycenters()?;
        known.push(session.evaluate()?);
        session.step_back();
        let (now, output) = session.read()?;
        known.push(Totals::of(now, output));
        session.move_to_barycenters_in(&|p| p[0] < 0.5)?;
        known.push(session.evaluate()?);
        session.set_sites(other.positions().to_vec(), Some(vec![0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.02]))?;
        session.move_to_barycenters()?;
        known.push(session.evaluate()?);
        session.step_back();
        known.push(session.evaluate()?);
        session.move_to_barycenters()?;
        session.step_back();
        let output = session.finish()?;
        Ok((known, diagram.positions().iter().flatten().chain(output.volume()).copied().collect()))
    }

    /// Whatever fails where sites stay, and whenever: the session goes the host's way, to the same end.
    #[test]
    fn what_fails_where_sites_stay_is_done_here() {
        let right = walk(&Naive::default()).unwrap();
        let mut most = usize::MAX;
        for with_error in [false, true] {
            let staying =
                |fails_at| Staying { naive: Naive::default(), calls: AtomicUsize::new(0), fails_at, with_error };
            let well = staying(usize::MAX);
            assert!(walk(&well).unwrap() == right);
            most = well.calls.into_inner().min(most);
            for fails_at in 0..most {
                assert!(walk(&staying(fails_at)).unwrap() == right, "{fails_at}");
            }
        }
        assert!(most > 15, "{most}");
    }
}
