//! Laws of the fluid.

use laguerre_core::diagram::Container;
use laguerre_core::shapes::icosphere;
use laguerre_core::{Backend, PowerDiagram, Request};
use laguerre_cpu::Cpu;
use laguerre_solvers::fluid::{Fluid, Scene, Settings, Start, State, VOLUME_TOLERANCE, lattice, settle};
use laguerre_solvers::transport;
use std::ops::ControlFlow::Continue;

const SCENES_IN_BOXES: [Scene; 4] = [Scene::RayleighTaylor, Scene::DamBreak, Scene::TaylorGreen, Scene::Beltrami];

fn cpu() -> Cpu {
    Cpu::new(Some(2)).unwrap()
}

/// A scene of about `count` particles in its box, and its settings changed.
fn fluid(scene: Scene, count: usize, change: impl Fn(&mut Settings)) -> Fluid {
    let extent = scene.extent().unwrap();
    let centers = lattice(extent, count);
    let densities = scene.densities(&centers, [0.0; 3], extent);
    let size = (extent.iter().product::<f64>() / centers.len() as f64).cbrt();
    let mut settings = scene.settings(&densities, [0.0; 3], extent, size, None);
    change(&mut settings);
    let start = scene.start(&centers, densities, &settings);
    Fluid::new(&cpu(), &Container::Box([0.0; 3], extent), start, settings).unwrap()
}

/// Runs, and returns the largest drift of the Hamiltonian over the largest kinetic energy.
fn run(fluid: &mut Fluid, steps: usize) -> f64 {
    let backend = cpu();
    let (mut drift, mut kinetic) = (0.0_f64, fluid.energy().kinetic);
    for _ in 0..steps {
        let taken = fluid.step(&backend).unwrap();
        assert!(taken.residual <= VOLUME_TOLERANCE, "{taken:?}");
        drift = drift.max(fluid.drift().abs());
        kinetic = kinetic.max(fluid.energy().kinetic);
    }
    drift / kinetic
}

/// The derivative of `f` along axis `k`.
fn slope(f: impl Fn([f64; 3]) -> f64, x: [f64; 3], k: usize) -> f64 {
    let step = 1e-5;
    let at = |by: f64| f(std::array::from_fn(|j| if j == k { x[j] + by } else { x[j] }));
    (at(step) - at(-step)) / (2.0 * step)
}

#[test]
fn vortices_are_incompressible_and_tangent_to_the_walls() {
    for scene in [Scene::TaylorGreen, Scene::Beltrami] {
        let u = |x| scene.velocity(x);
        let convected = |x, k: usize| (0..3).map(|j| u(x)[j] * slope(|y| u(y)[k], x, j)).sum::<f64>();
        for x in lattice([1.0; 3], 125) {
            let divergence = |f: &dyn Fn([f64; 3], usize) -> f64| (0..3).map(|k| slope(|y| f(y, k), x, k)).sum::<f64>();
            assert!(divergence(&|y, k| u(y)[k]).abs() < 1e-9, "{scene:?} {x:?}");
            // The acceleration is minus the pressure's gradient: what it takes that the flow stays incompressible and tangent.
            let missing = divergence(&|y, k| scene.acceleration(y)[k] - convected(y, k));
            assert!(missing.abs() < 1e-4, "{scene:?} {x:?} {missing}");
            if scene == Scene::Beltrami {
                assert!((0..3).all(|k| (scene.acceleration(x)[k] - convected(x, k)).abs() < 1e-9), "it is steady");
            }
            for k in 0..3 {
                for side in [0.0, 1.0] {
                    let mut wall = x;
                    wall[k] = side;
                    assert!(u(wall)[k].abs() < 1e-15, "{scene:?} {wall:?}");
                    assert!((scene.acceleration(wall)[k] - convected(wall, k)).abs() < 1e-9, "{scene:?} {wall:?}");
                }
            }
        }
    }
}

#[test]
fn springs_are_the_gradient_of_the_cost() {
    let fluid = fluid(Scene::TaylorGreen, 64, |_| {});
    let state = fluid.state();
    let volume = 1.0 / 64.0;
    for (i, k) in [(0, 0), (21, 1), (42, 2), (63, 0)] {
        let options = transport::Options::default().until(100, 1e-12);
        let cost = |by: f64| {
            let mut positions = state.positions.clone();
            positions[i][k] += by;
            let mut diagram = PowerDiagram::new(&positions, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
            transport::solve(&cpu(), &mut diagram, &[], &options, &mut |_| Continue(())).unwrap().cost.unwrap()
        };
        let step = 1e-4;
        let measured = (cost(step) - cost(-step)) / (2.0 * step);
        let force = 2.0 * volume * (state.positions[i][k] - fluid.barycenters()[i][k]);
        assert!((measured - force).abs() < 1e-4 * volume * 0.25, "{measured} {force}");
    }
}

#[test]
fn particles_begin_where_springs_give_the_flow_its_acceleration() {
    let fluid = fluid(Scene::Beltrami, 512, |_| {});
    let stiffness = fluid.settings().epsilon.powi(-2);
    for (p, b) in fluid.state().positions.iter().zip(fluid.barycenters()) {
        let a = Scene::Beltrami.acceleration(*b);
        assert!((0..3).all(|k| ((b[k] - p[k]) * stiffness - a[k]).abs() < 0.1), "{p:?} {b:?} {a:?}");
    }
}

#[test]
fn the_hamiltonian_drifts_by_the_square_of_the_step() {
    let drift = |share: f64, steps| {
        let mut fluid = fluid(Scene::Beltrami, 512, |s| s.time_step = Some(share * s.epsilon));
        run(&mut fluid, steps)
    };
    let (long, short) = (drift(0.4, 10), drift(0.2, 20));
    assert!(long < 5e-3 && short < long / 2.5, "{long} {short}");
}

#[test]
fn time_can_be_turned_back() {
    let mut fluid = fluid(Scene::TaylorGreen, 216, |s| s.time_step = Some(0.25 * s.epsilon));
    let (start, size) = (fluid.state().positions.clone(), fluid.cell_size());
    run(&mut fluid, 8);
    let moved = |fluid: &Fluid| {
        let pairs = fluid.state().positions.iter().zip(&start);
        pairs.map(|(p, q)| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()).fold(0.0, f64::max) / size
    };
    assert!(moved(&fluid) > 0.5);
    let mut state = fluid.state().clone();
    state.velocities.iter_mut().for_each(|v| *v = v.map(|x| -x));
    let mut back = Fluid::resume(&cpu(), &Container::Box([0.0; 3], [1.0; 3]), state, *fluid.settings()).unwrap();
    run(&mut back, 8);
    // What is left is that volumes are equal to a tolerance only.
    assert!(moved(&back) < 1e-4, "{}", moved(&back));
}

#[test]
fn heavy_fluid_sinks_and_energy_is_kept() {
    for scene in [Scene::RayleighTaylor, Scene::DamBreak] {
        let mut fluid = fluid(scene, 400, |_| {});
        let before = fluid.energy();
        let drift = run(&mut fluid, 25);
        let after = fluid.energy();
        assert!(after.potential < before.potential && after.kinetic > before.kinetic, "{before:?} {after:?}");
        assert!(drift < 0.02, "{scene:?} {drift}");
        // The volumes are what they are said to be.
        let volumes = cpu().evaluate(fluid.diagram(), &Request::moments()).unwrap().into_arrays().volume;
        let mean = volumes.iter().sum::<f64>() / volumes.len() as f64;
        assert!(volumes.iter().all(|v| (v / mean - 1.0).abs() < 1.1 * VOLUME_TOLERANCE));
    }
}

#[test]
fn any_gravity_has_settings() {
    for scene in SCENES_IN_BOXES.into_iter().chain([Scene::SnowGlobe]) {
        for gravity in [0.0, -3.0, 1e-3] {
            let settings = scene.settings(&[1.0, 3.0], [0.0; 3], [1.0; 3], 0.1, Some(gravity));
            assert!(settings.epsilon > 0.0 && settings.epsilon.is_finite(), "{scene:?} {settings:?}");
            assert!(settings.viscosity >= 0.0 && settings.viscosity.is_finite(), "{scene:?} {settings:?}");
            assert!(settings.gravity.period.is_finite());
            assert!([0.0, 0.7].iter().all(|&t| settings.gravity.at(t).iter().all(|x| x.is_finite())), "{settings:?}");
        }
    }
}

#[test]
fn particles_of_any_kind_have_the_epsilon_of_the_scene_that_they_are() {
    for scene in SCENES_IN_BOXES {
        let fluid = fluid(scene, 1000, |_| {});
        let State { positions, velocities, densities, .. } = fluid.state().clone();
        let container = Container::Box([0.0; 3], scene.extent().unwrap());
        let found = Start { positions, velocities, densities }.epsilon(&container, &fluid.settings().gravity);
        // The fastest place of a vortex is seldom a particle's.
        assert!((found / fluid.settings().epsilon - 1.0).abs() < 0.1, "{scene:?} {found} {:?}", fluid.settings());
        assert_eq!(Scene::named(scene.name()), Some(scene));
    }
}

#[test]
fn viscosity_takes_energy_and_no_momentum() {
    let momentum = |fluid: &Fluid| -> [f64; 3] {
        let each = fluid.state().velocities.iter().zip(&fluid.state().densities);
        each.fold([0.0; 3], |sum, (v, d)| std::array::from_fn(|k| sum[k] + d * v[k]))
    };
    let step = |viscosity: f64| {
        let mut fluid = fluid(Scene::DamBreak, 300, |s| {
            s.viscosity = viscosity;
            s.time_step = Some(0.02);
        });
        for _ in 0..4 {
            fluid.step(&cpu()).unwrap();
        }
        fluid
    };
    let (without, with) = (step(0.0), step(0.05));
    assert!(with.energy().kinetic < 0.99 * without.energy().kinetic);
    assert!(with.state().brought_in < 0.0 && without.state().brought_in == 0.0);
    assert!(with.drift().abs() < 0.02 * without.energy().kinetic, "what it took is accounted for: {}", with.drift());
    // One step from the same state, with and without.
    let state = with.state().clone();
    let mut others = [0.0, 0.5].map(|viscosity| {
        let mut settings = *with.settings();
        settings.viscosity = viscosity;
        Fluid::resume(&cpu(), &Container::Box([0.0; 3], [2.0, 1.0, 0.25]), state.clone(), settings).unwrap()
    });
    for fluid in &mut others {
        fluid.step(&cpu()).unwrap();
    }
    let [free, slowed] = others.map(|fluid| (momentum(&fluid), fluid.energy().kinetic));
    assert!(slowed.1 < free.1);
    let scale = state.velocities.len() as f64 * free.1.sqrt();
    assert!((0..3).all(|k| (free.0[k] - slowed.0[k]).abs() < 1e-9 * scale), "{free:?} {slowed:?}");
}

#[test]
fn a_globe_is_shaken_and_what_shaking_brings_in_is_known() {
    let domain = icosphere(2).domain();
    let container = Container::Domain(domain.clone());
    let sites = lattice([2.0; 3], 512).into_iter().map(|p| p.map(|x| x - 1.0 + 1e-3));
    let inside: Vec<[f64; 3]> = sites.filter(|p| p.iter().map(|x| x * x).sum::<f64>() < 0.8).collect();
    let centers = settle(&cpu(), &container, &inside, 3).unwrap();
    let ((lo, hi), scene) = (domain.bounding_box(), Scene::SnowGlobe);
    let densities = scene.densities(&centers, lo, hi);
    let snow = densities.iter().filter(|&&d| d > 1.0).count();
    assert!((snow as f64 / centers.len() as f64 - 0.15).abs() < 0.01);
    let settings = scene.settings(&densities, lo, hi, (domain.volume() / centers.len() as f64).cbrt(), None);
    let start = scene.start(&centers, densities, &settings);
    let mut fluid = Fluid::new(&cpu(), &container, start, settings).unwrap();
    let drift = run(&mut fluid, 15);
    assert!(fluid.state().brought_in != 0.0 && drift < 0.05, "{drift}");
}

#[test]
fn going_on_is_as_if_never_stopped_for_any_number_of_threads() {
    for scene in SCENES_IN_BOXES {
        let start = fluid(scene, 150, |s| s.viscosity = 1e-3);
        let steps = |mut fluid: Fluid, steps: usize, threads: usize| {
            let backend = Cpu::new(Some(threads)).unwrap();
            for _ in 0..steps {
                fluid.step(&backend).unwrap();
            }
            fluid
        };
        let whole = steps(start.clone(), 5, 1);
        let half = steps(start.clone(), 2, 3);
        let container = Container::Box([0.0; 3], scene.extent().unwrap());
        let resumed = Fluid::resume(&cpu(), &container, half.state().clone(), *half.settings()).unwrap();
        assert!(steps(resumed, 3, 2).state() == whole.state(), "{scene:?}");
    }
}

#[test]
fn what_cannot_flow_is_refused() {
    let good = || Start { positions: vec![[0.2; 3], [0.7; 3]], velocities: vec![[0.0; 3]; 2], densities: vec![1.0; 2] };
    let settings = fluid(Scene::Beltrami, 8, |_| {}).settings().to_owned();
    let refused = |start: Start, settings: Settings| {
        Fluid::new(&cpu(), &Container::Box([0.0; 3], [1.0; 3]), start, settings).unwrap_err().to_string()
    };
    assert!(refused(Start { densities: vec![1.0], ..good() }, settings).contains("a density are needed for each"));
    assert!(refused(Start { densities: vec![1.0, -1.0], ..good() }, settings).contains("particle 1: density -1"));
    let nan = vec![[0.0; 3], [0.0, f64::NAN, 0.0]];
    assert!(refused(Start { velocities: nan, ..good() }, settings).contains("particle 1: velocity"));
    assert!(refused(Start { positions: vec![[0.2; 3]; 2], ..good() }, settings).contains("same place"));
    assert!(refused(good(), Settings::new(0.0)).contains("epsilon 0"));
    let mut backwards = settings;
    backwards.time_step = Some(-1.0);
    assert!(refused(good(), backwards).contains("-1"));
    // A step that throws particles out of all range leaves the state as it was.
    let mut fluid = fluid(Scene::Beltrami, 8, |s| s.time_step = Some(1e9));
    let before = fluid.state().clone();
    assert!(fluid.step(&cpu()).is_err());
    assert!(*fluid.state() == before);
}
