//! A session whose sites stay nowhere, and one where they stay with what fails.

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

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
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
        let staying = |fails_at| Staying { naive: Naive::default(), calls: AtomicUsize::new(0), fails_at, with_error };
        let well = staying(usize::MAX);
        assert!(walk(&well).unwrap() == right);
        most = well.calls.into_inner().min(most);
        for fails_at in 0..most {
            assert!(walk(&staying(fails_at)).unwrap() == right, "{fails_at}");
        }
    }
    assert!(most > 15, "{most}");
}
