//! The law of interrupts: whenever one comes, what is left is the diagram of the last iteration, whole.

use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::{AtomicUsize, Ordering};

use laguerre_core::diagram::Container;
use laguerre_core::{Backend, BackendInfo, ErrorKind, Observer, Output, PowerDiagram, Request, Result};
use laguerre_cpu::Cpu;
use laguerre_solvers::density::Density;
use laguerre_solvers::fluid::{Fluid, Scene, lattice};
use laguerre_solvers::lloyd::{self, Method, relax};
use laguerre_solvers::transport::{self, End, solve};

/// A backend that someone interrupts after some diagrams.
struct Interrupted {
    backend: Cpu,
    left: AtomicUsize,
}

/// Who ends an evaluation at the first cells.
struct Impatient;

impl Observer for Impatient {
    fn advance(&self, _cells: usize) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

impl Interrupted {
    fn after(diagrams: usize) -> Self {
        Self { backend: Cpu::new(Some(1)).unwrap(), left: AtomicUsize::new(diagrams) }
    }
}

impl Backend for Interrupted {
    fn info(&self) -> BackendInfo {
        self.backend.info()
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        match self.left.load(Ordering::Relaxed) {
            0 => self.backend.evaluate_watched(diagram, request, &Impatient),
            left => {
                self.left.store(left - 1, Ordering::Relaxed);
                self.backend.evaluate_watched(diagram, request, observer)
            }
        }
    }
}

/// Sites in the unit cube, crowded in a corner, so that steps have to be tried more than once.
fn crowded() -> PowerDiagram {
    let steps = [0.819_172_513_396_164_5, 0.671_043_606_703_789_2, 0.549_700_477_901_970_4];
    let sites: Vec<[f64; 3]> =
        (0..80).map(|i| steps.map(|s| ((i * i + 7 * i) as f64 * s + 0.37).fract().powi(3))).collect();
    PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap()
}

/// That an output is that of a diagram.
fn check(diagram: &PowerDiagram, output: &Output) {
    let again = Cpu::new(Some(1)).unwrap().evaluate(diagram, &Request::moments()).unwrap();
    assert_eq!(again.volume(), output.volume());
}

#[test]
fn a_relaxation_keeps_its_last_iteration() {
    for method in [Method::Lbfgs, Method::Lloyd] {
        let options = lloyd::Options::default().by(method).until(6, 0.0);
        let whole = relax(&Interrupted::after(usize::MAX), &mut crowded(), &options, &mut |_| Continue(())).unwrap();
        assert!(!whole.interrupted);
        let diagrams = whole.iterations.last().unwrap().evaluations;
        let mut diagram = crowded();
        let error = relax(&Interrupted::after(0), &mut diagram, &options, &mut |_| Continue(())).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Interrupted);
        for count in 1..diagrams {
            let mut diagram = crowded();
            let relaxed = relax(&Interrupted::after(count), &mut diagram, &options, &mut |_| Continue(())).unwrap();
            assert!(relaxed.interrupted && !relaxed.converged);
            let done = relaxed.iterations.len();
            assert_eq!(relaxed.iterations, whole.iterations[..done]);
            assert!(whole.iterations[done].evaluations > count, "the last that was finished");
            check(&diagram, &relaxed.output);
        }
        let mut diagram = crowded();
        let mut told = 0;
        let stopped = relax(&Interrupted::after(usize::MAX), &mut diagram, &options, &mut |_| {
            told += 1;
            if told == 3 { Break(()) } else { Continue(()) }
        });
        let stopped = stopped.unwrap();
        assert!(stopped.interrupted && stopped.iterations == whole.iterations[..3]);
        check(&diagram, &stopped.output);
    }
}

#[test]
fn a_transport_keeps_its_last_step() {
    let heavier_above = Density::Linear { value: 1.0, gradient: [0.0, 0.0, 2.0] };
    // Outside of the cube most cells would be empty at first, and it begins with groups.
    let mut outside = crowded();
    let shifted: Vec<[f64; 3]> = outside.positions().iter().map(|p| [p[0] + 2.0, p[1], p[2]]).collect();
    outside.set_sites(&shifted, &[]).unwrap();
    for (density, sites, by_groups) in [(Density::Uniform, crowded(), false), (heavier_above, outside, true)] {
        let options = transport::Options::default().of(density);
        let never = Interrupted::after(usize::MAX);
        // Diagrams until each step was done, those of groups of sites among them.
        let mut diagrams = Vec::new();
        let whole = solve(&never, &mut sites.clone(), &[], &options, &mut |_| {
            diagrams.push(usize::MAX - never.left.load(Ordering::Relaxed));
            Continue(())
        })
        .unwrap();
        assert_eq!(whole.end, End::Converged);
        let counted: usize = whole.iterations.iter().map(|step| step.diagram_evaluations).sum();
        assert_eq!(counted < diagrams[whole.iterations.len() - 1], by_groups);
        for count in 0..diagrams[whole.iterations.len() - 1] {
            let mut diagram = sites.clone();
            let mut told = Vec::new();
            let found = solve(&Interrupted::after(count), &mut diagram, &[], &options, &mut |step| {
                told.push(step.residual);
                Continue(())
            });
            if count < diagrams[0] {
                assert_eq!(found.unwrap_err().kind(), ErrorKind::Interrupted);
                assert!(told.is_empty());
                continue;
            }
            let solution = found.unwrap();
            assert_eq!(solution.end, End::Interrupted);
            let residuals: Vec<f64> = whole.iterations[..told.len()].iter().map(|step| step.residual).collect();
            assert_eq!(told, residuals);
            assert!(diagrams[told.len()] > count, "the last that was finished");
            assert_eq!(told.last(), Some(&solution.residual));
            assert_eq!(diagram.weights(), solution.weights);
            check(&diagram, &solution.output);
        }
    }
}

#[test]
fn a_transport_that_stalled_is_not_lost_where_it_is_asked_why() {
    // No rounding is as small as that, and then one more diagram is evaluated.
    let options = transport::Options::default().until(100, 1e-17);
    let never = Interrupted::after(usize::MAX);
    let mut diagram = crowded();
    let whole = solve(&never, &mut diagram, &[], &options, &mut |_| Continue(())).unwrap();
    assert_eq!(whole.end, End::Stalled);
    let diagrams = usize::MAX - never.left.load(Ordering::Relaxed);
    let found = solve(&Interrupted::after(diagrams - 1), &mut crowded(), &[], &options, &mut |_| Continue(())).unwrap();
    assert_eq!((found.end, found.weights), (End::Interrupted, whole.weights));
}

#[test]
fn a_fluid_keeps_its_last_step() {
    let (scene, extent) = (Scene::TaylorGreen, Scene::TaylorGreen.extent().unwrap());
    let centers = lattice(extent, 64);
    let densities = scene.densities(&centers, [0.0; 3], extent);
    let settings = scene.settings(&densities, [0.0; 3], extent, 0.25, None);
    let begin = |backend: &dyn Backend| {
        let start = scene.start(&centers, densities.clone(), &settings);
        Fluid::new(backend, &Container::Box([0.0; 3], extent), start, settings).unwrap()
    };
    let never = Interrupted::after(usize::MAX);
    let mut whole = begin(&never);
    let first = never.left.load(Ordering::Relaxed);
    whole.step(&never).unwrap();
    let diagrams = first - never.left.load(Ordering::Relaxed);
    assert!(diagrams > 1);
    for count in 0..diagrams {
        let mut fluid = begin(&never);
        let before = fluid.state().clone();
        let error = fluid.step(&Interrupted::after(count)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Interrupted);
        assert_eq!(*fluid.state(), before);
        fluid.step(&never).unwrap();
        assert_eq!(fluid.state(), whole.state(), "ended after {count} of {diagrams} diagrams, and gone on");
    }
}
