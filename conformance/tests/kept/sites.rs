//! Sites that stay.

use std::ops::ControlFlow::{self, Continue};
use std::sync::atomic::{AtomicUsize, Ordering};

use laguerre::solvers::lloyd::{self, Method, energy_request, equalize, relax};
use laguerre::{
    Backend, BackendInfo, CellStatus, Domain, Observer, Output, PowerDiagram, Request, Resident, Result, Selection,
    Session, Totals,
};
use laguerre_conformance::sites::Random;
use laguerre_core::shapes::torus;

use super::{device, white};

/// A backend that keeps no sites, whatever the one that it asks does: the plain loop.
struct Plain<'a>(&'a dyn Backend);

impl Backend for Plain<'_> {
    fn info(&self) -> BackendInfo {
        self.0.info()
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        self.0.evaluate_watched(diagram, request, observer)
    }
}

fn both() -> Vec<Box<dyn Backend>> {
    let host = laguerre::open(Selection::Cpu { threads: Some(2) }).unwrap();
    std::iter::once(host).chain(device()).collect()
}

/// Each site at the barycenter of its cell, one by one.
fn moved(diagram: &PowerDiagram, output: &Output) -> Vec<[f64; 3]> {
    let at = |i: usize| match output.status()[i] {
        CellStatus::Empty => diagram.positions()[i],
        _ => output.barycenter()[i],
    };
    (0..output.sites()).map(at).collect()
}

fn bits(output: &Output) -> Vec<u64> {
    let second = output.second_moment().into_iter().flatten().flatten();
    output.volume().iter().chain(output.barycenter().iter().flatten()).chain(second).map(|x| x.to_bits()).collect()
}

fn assert_same(totals: &Totals, right: &Totals) {
    assert_eq!((totals.cells, totals.empty, totals.uncertified), (right.cells, right.empty, right.uncertified));
    for (a, b) in [
        (totals.volume, right.volume),
        (totals.size, right.size),
        (totals.energy, right.energy),
        (totals.displacement, right.displacement),
        (totals.spread, right.spread),
    ] {
        assert!((a - b).abs() <= 1e-12 * b.abs(), "{totals:?} {right:?}");
    }
}

/// Sites of which one, heavier than the others that lie on a sphere about it, has more facets than a work-item has room for; in a box.
fn one_with_many_facets() -> PowerDiagram {
    let mut random = Random::new(4);
    let mut sites = vec![[0.5; 3]];
    while sites.len() < 700 {
        let way = [0, 1, 2].map(|_| random.unit() - 0.5);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.1 && length < 0.5 {
            sites.push(way.map(|x| 0.5 + 0.4 * x / length));
        }
    }
    let weights: Vec<f64> = (0..sites.len()).map(|i| if i == 0 { 0.05 } else { 0.0 }).collect();
    PowerDiagram::new(&sites, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap()
}

#[test]
fn sites_that_stay_are_those_that_come_back() {
    let scaled = |domain: &Domain| {
        // Far from zero, in another unit, and half of the cells empty.
        let diagram = white(500, domain);
        let weights: Vec<f64> = (0..500).map(|i| if i % 2 == 0 { 4.0 } else { 0.0 }).collect();
        let positions: Vec<[f64; 3]> = diagram.positions().iter().map(|p| p.map(|x| 1000.0 + 8.0 * x)).collect();
        PowerDiagram::new(&positions, &weights).unwrap().in_box([993.0; 3], [1007.0; 3]).unwrap()
    };
    let torus = torus(1.0, 0.4, 24, 12).domain();
    let dense = Domain::of_image(&[1.0, 3.0, 0.5, 7.0], [2, 2, 1], [-1.0; 3], [1.0; 3]).unwrap();
    for backend in both() {
        let large = one_with_many_facets();
        let of_host = backend.evaluate(&large, &Request::moments()).unwrap().report().host_cells;
        // (GPUs have room for it.)
        let is_on_gpu = laguerre::devices().is_ok_and(|all| all.iter().any(|device| device.is_gpu));
        assert!(of_host > 0 || is_on_gpu || backend.info().backend == "cpu");
        for (start, has_empty) in
            [(white(700, &torus), true), (white(60, &dense), false), (scaled(&torus), true), (large, false)]
        {
            let (mut plain, mut stays) = (start.clone(), start.clone());
            let mut session = Session::new(&*backend, &mut stays, energy_request()).unwrap();
            for step in 0..3 {
                let output = backend.evaluate(&plain, &energy_request()).unwrap();
                assert_eq!(output.count(CellStatus::Empty) > 0, has_empty);
                // (The last evaluation was of other sites, whose results took the place of these.)
                let totals = session.evaluate().unwrap();
                assert_same(&totals, &Totals::of(&plain, &output));
                if step == 1 {
                    backend.evaluate(&start, &Request::moments()).unwrap();
                    let (diagram, read) = session.read().unwrap();
                    assert!(diagram.positions() == plain.positions() && bits(read) == bits(&output));
                }
                session.move_to_barycenters().unwrap();
                plain.set_sites(&moved(&plain, &output), start.weights()).unwrap();
                assert!(session.positions().unwrap() == plain.positions(), "step {step}");
            }
            // There and back.
            let totals = session.evaluate().unwrap();
            session.move_to_barycenters().unwrap();
            session.evaluate().unwrap();
            session.step_back();
            assert_eq!(session.evaluate().unwrap(), totals);
            let mut other = plain.clone();
            other.set_sites(start.positions(), &[]).unwrap();
            session.set_sites(start.positions().to_vec(), Some(Vec::new())).unwrap();
            let right = backend.evaluate(&other, &energy_request()).unwrap();
            assert_same(&session.evaluate().unwrap(), &Totals::of(&other, &right));
            session.step_back();
            let output = session.finish().unwrap();
            assert!(stays.positions() == plain.positions() && stays.weights() == start.weights());
            assert!(bits(&output) == bits(&backend.evaluate(&plain, &energy_request()).unwrap()));
        }
    }
}

#[test]
fn what_is_wrong_is_said_of_sites_that_stay() {
    for backend in both() {
        let mut diagram = white(50, &torus(1.0, 0.4, 24, 12).domain());
        let mut session = Session::new(&*backend, &mut diagram, energy_request()).unwrap();
        session.evaluate().unwrap();
        let mut far = session.positions().unwrap().to_vec();
        far[7] = [1e9; 3];
        session.set_sites(far, None).unwrap();
        let error = session.evaluate().unwrap_err().to_string();
        assert!(error.contains("site 7"), "{error}");
        session.step_back();
        session.evaluate().unwrap();
        assert!(session.set_sites(vec![[f64::NAN; 3]; 50], None).is_err());
        assert_eq!(session.evaluate().unwrap().cells + session.evaluate().unwrap().empty, 50);
    }
}

#[test]
fn relaxation_on_a_device_is_the_plain_loop() {
    for backend in both() {
        let start = white(400, &torus(1.0, 0.4, 24, 12).domain());
        for method in [Method::Lloyd, Method::Lbfgs] {
            let options = lloyd::Options::default().by(method).until(4, 0.0);
            let run = |backend: &dyn Backend| {
                let mut diagram = start.clone();
                let relaxed = relax(backend, &mut diagram, &options, &mut |_| Continue(())).unwrap();
                (diagram.positions().to_vec(), relaxed.iterations, bits(&relaxed.output))
            };
            let ((here, iterations, output), there) = (run(&Plain(&*backend)), run(&*backend));
            assert!(there == run(&*backend), "the same bits twice");
            for (a, b) in iterations.iter().zip(&there.1) {
                assert!((a.energy - b.energy).abs() <= 1e-12 * a.energy, "{a:?} {b:?}");
                assert!((a.gradient - b.gradient).abs() <= 1e-9 * a.gradient, "{a:?} {b:?}");
                assert_eq!(a.evaluations, b.evaluations);
            }
            // Quasi-Newton steps are as long as the energies say, which differ by a rounding.
            let is_same = here == there.0 && output == there.2;
            assert!(is_same || method == Method::Lbfgs);
        }
        let spread = |backend: &dyn Backend| {
            let mut diagram = start.clone();
            let done = equalize(backend, &mut diagram, 0.3, 8, None).unwrap();
            (diagram.positions().to_vec(), done.steps)
        };
        assert!(spread(&Plain(&*backend)) == spread(&*backend));
    }
}

/// A backend that someone interrupts after so many cells, and then whenever it is asked.
struct Interrupted<'a> {
    backend: &'a dyn Backend,
    left: AtomicUsize,
}

impl Observer for Interrupted<'_> {
    fn advance(&self, cells: usize) -> ControlFlow<()> {
        let less = |left: usize| Some(left.saturating_sub(cells));
        match self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less) {
            Ok(left) if left > cells => Continue(()),
            _ => ControlFlow::Break(()),
        }
    }
}

impl Backend for Interrupted<'_> {
    fn info(&self) -> BackendInfo {
        self.backend.info()
    }

    fn resident<'a>(&'a self, request: &Request, _: &'a dyn Observer) -> Option<Box<dyn Resident + 'a>> {
        self.backend.resident(request, self)
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, _: &dyn Observer) -> Result<Output> {
        self.backend.evaluate_watched(diagram, request, self)
    }
}

#[test]
fn an_interrupt_leaves_the_last_iteration_whole() {
    let Some(backend) = device() else { return };
    let start = white(300, &torus(1.0, 0.4, 24, 12).domain());
    for method in [Method::Lloyd, Method::Lbfgs] {
        let run = |backend: &dyn Backend, most: usize| {
            let (mut diagram, options) = (start.clone(), lloyd::Options::default().by(method).until(most, 0.0));
            let relaxed = relax(backend, &mut diagram, &options, &mut |_| Continue(())).unwrap();
            (diagram, relaxed)
        };
        // In the middle of the third diagram.
        let stopping = Interrupted { backend: &*backend, left: AtomicUsize::new(700) };
        let ((diagram, relaxed), (right, whole)) = (run(&stopping, 9), run(&*backend, 1));
        assert!(relaxed.interrupted && relaxed.iterations == whole.iterations);
        assert!(diagram.positions() == right.positions() && bits(&relaxed.output) == bits(&whole.output));
    }
}
