//! Laws of the centroidal tessellations.

use laguerre_core::shapes::{cuboid, double_torus};
use laguerre_core::{Backend, CellStatus, Domain, PowerDiagram};
use laguerre_cpu::Cpu;
use laguerre_solvers::density::{Density, Gaussian};
use laguerre_solvers::lloyd::{
    Method, Options, Relaxation, energy, energy_request, equalize, gradient, relative_deviation, relax,
};
use std::ops::ControlFlow::Continue;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Numbers in [0, 1) that are spread evenly and look random: multiples of irrational numbers.
fn spread(count: usize) -> Vec<[f64; 3]> {
    // Powers of the root of x⁴ = x + 1.
    let steps = [0.819_172_513_396_164_5, 0.671_043_606_703_789_2, 0.549_700_477_901_970_4];
    (0..count).map(|i| steps.map(|s| ((i * i + 7 * i) as f64 * s + 0.37).fract())).collect()
}

/// So that some cells are empty.
fn weights(count: usize) -> Vec<f64> {
    spread(count).iter().map(|p| 0.1 * p[0] * p[1]).collect()
}

fn cube(sites: &[[f64; 3]], weights: &[f64]) -> PowerDiagram {
    PowerDiagram::new(sites, weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap()
}

fn cpu() -> Cpu {
    Cpu::new(Some(2)).unwrap()
}

#[test]
fn the_gradient_is_that_of_the_energy() {
    let sites = spread(60);
    let weights: Vec<f64> = sites.iter().map(|p| 0.01 * p[0] * p[1]).collect();
    let slab = double_torus().domain();
    let in_slab: Vec<[f64; 3]> = sites.iter().map(|p| [5.0 * p[0], 3.0 * p[1], p[2]]).collect();
    let diagrams =
        [cube(&sites, &[]), cube(&sites, &weights), PowerDiagram::new(&in_slab, &[]).unwrap().restricted_to(&slab)];
    for mut diagram in diagrams {
        let (positions, weights) = (diagram.positions().to_vec(), diagram.weights().to_vec());
        let output = cpu().evaluate(&diagram, &energy_request()).unwrap();
        let slopes = gradient(&diagram, &output);
        let largest = slopes.iter().flatten().fold(0.0, |a: f64, x| a.max(x.abs()));
        for (i, k) in [(0, 0), (7, 1), (23, 2), (41, 0), (59, 1)] {
            // The difference of third order is of the order of the step squared.
            let step = 1e-4;
            let mut at = |by: f64| {
                let mut moved = positions.clone();
                moved[i][k] += by;
                diagram.set_sites(&moved, &weights).unwrap();
                energy(&diagram, &cpu().evaluate(&diagram, &energy_request()).unwrap())
            };
            let measured = (at(step) - at(-step)) / (2.0 * step);
            assert!((measured - slopes[i][k]).abs() < 1e-5 * largest, "{i} {k}: {measured} {}", slopes[i][k]);
        }
    }
}

#[test]
fn no_step_raises_the_energy() {
    let domain = double_torus().domain();
    let sites: Vec<[f64; 3]> = spread(400).iter().map(|p| [5.0 * p[0], 3.0 * p[1], p[2]]).collect();
    let start = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&domain);
    let mut ends = Vec::new();
    for method in [Method::Lloyd, Method::Lbfgs] {
        let mut diagram = start.clone();
        let mut told = Vec::new();
        let options = Options::default().by(method).until(40, 0.0);
        let relaxed = relax(&cpu(), &mut diagram, &options, &mut |i| {
            told.push(*i);
            Continue(())
        })
        .unwrap();
        assert_eq!(told, relaxed.iterations);
        let energies: Vec<f64> = told.iter().map(|i| i.energy).collect();
        assert!(energies.windows(2).all(|e| e[1] <= e[0] * (1.0 + 1e-14)), "{method:?}: {energies:?}");
        let empty = |d: &PowerDiagram| cpu().evaluate(d, &energy_request()).unwrap().count(CellStatus::Empty);
        assert!(empty(&diagram) <= empty(&start));
        ends.push(told[40]);
    }
    assert!(ends[1].energy < ends[0].energy && ends[1].gradient < 0.7 * ends[0].gradient, "{ends:?}");
}

#[test]
fn quasi_newton_needs_a_quarter_of_the_diagrams() {
    let start = cube(&spread(1000), &[]);
    let run = |method, iterations| {
        let options = Options::default().by(method).until(iterations, 0.0);
        relax(&cpu(), &mut start.clone(), &options, &mut |_| Continue(())).unwrap().iterations
    };
    let lloyd = run(Method::Lloyd, 100);
    let goal = lloyd.last().unwrap();
    let lbfgs = run(Method::Lbfgs, 25);
    let reached = lbfgs.iter().find(|i| i.energy <= goal.energy).expect("the energy of 100 Lloyd steps");
    assert!(reached.evaluations <= 25, "{reached:?}");
}

/// Eight sites find the lattice, to the last digits, and its energy is 8 cubes' of edge ½: each a⁵/4.
#[test]
fn a_known_optimum_is_found() {
    let near: Vec<[f64; 3]> = (0..8)
        .zip(spread(8))
        .map(|(i, p)| std::array::from_fn(|k| 0.25 + 0.5 * f64::from(i >> k & 1) + 0.2 * (p[k] - 0.5)))
        .collect();
    let mut diagram = cube(&near, &[]);
    let options = Options::default().until(100, 1e-12);
    let relaxed = relax(&cpu(), &mut diagram, &options, &mut |_| Continue(())).unwrap();
    assert!(relaxed.converged, "{:?}", relaxed.iterations.last());
    assert!((relaxed.iterations.last().unwrap().energy - 1.0 / 16.0).abs() < 1e-15);
    for (i, p) in diagram.positions().iter().enumerate() {
        assert!((0..3).all(|k| (p[k] - 0.25 - 0.5 * f64::from(i as u32 >> k & 1)).abs() < 1e-11), "{p:?}");
    }
}

#[test]
fn unit_and_place_change_nothing() {
    let run = |scale: f64, shift: f64| {
        let sites: Vec<[f64; 3]> = spread(200).iter().map(|p| p.map(|x| scale * x + shift)).collect();
        let mut diagram = PowerDiagram::new(&sites, &[]).unwrap();
        diagram = diagram.in_box([shift; 3], [scale + shift; 3]).unwrap();
        relax(&cpu(), &mut diagram, &Options::default().until(10, 0.0), &mut |_| Continue(())).unwrap().iterations
    };
    let (one, other) = (run(1.0, 0.0), run(1e-6, 3e-6));
    for (a, b) in one.iter().zip(&other) {
        assert!((a.gradient - b.gradient).abs() < 1e-6 * a.gradient, "{a:?} {b:?}");
        assert!((a.energy - b.energy * 1e30).abs() < 1e-8 * a.energy, "{a:?} {b:?}");
    }
}

#[test]
fn empty_cells_stay_and_harm_nobody() {
    let mut sites = spread(100);
    sites.extend_from_within(..10);
    // Hidden by the heavier ones, whose cells are smaller than this.
    let weights: Vec<f64> = (0..110).map(|i| if i < 100 { 0.2 } else { 0.0 }).collect();
    let mut diagram = cube(&sites, &weights);
    let relaxed = relax(&cpu(), &mut diagram, &Options::default().until(20, 0.0), &mut |_| Continue(())).unwrap();
    let empty = |i: &usize| relaxed.output.status()[*i] == CellStatus::Empty;
    assert!((0..100).all(|i| !empty(&i)), "no step empties a cell");
    assert!((100..110).any(|i| empty(&i)) && (100..110).filter(empty).all(|i| diagram.positions()[i] == sites[i]));
    assert!(relaxed.iterations.iter().all(|i| i.energy.is_finite() && i.gradient.is_finite()));
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let run = |threads| {
        let mut diagram = cube(&spread(5000), &[]);
        let options = Options::default().until(6, 0.0);
        let backend = Cpu::new(Some(threads)).unwrap();
        let relaxed = relax(&backend, &mut diagram, &options, &mut |_| Continue(())).unwrap();
        (diagram.positions().to_vec(), relaxed.iterations)
    };
    let first = run(1);
    assert!(first == run(3) && first == run(3));
}

#[test]
fn volumes_are_equalized_and_refused_places_not_entered() {
    let mut diagram = cube(&spread(500), &[]);
    let done = equalize(&cpu(), &mut diagram, 0.1, 60, Some(&|p| p[0] < 0.9)).unwrap();
    assert!(done.steps > 0 && done.steps <= 60, "{done:?}");
    let volumes = cpu().evaluate(&diagram, &energy_request()).unwrap().into_arrays().volume;
    assert_eq!(relative_deviation(&volumes), done.spread);
    let before = spread(500);
    assert!(diagram.positions().iter().zip(&before).all(|(p, q)| p[0] < 0.9 || p == q));
}

#[test]
fn wrong_bounds_are_refused() {
    let mut diagram = cube(&spread(10), &[]);
    for bound in [-1.0, f64::NAN] {
        let error =
            relax(&cpu(), &mut diagram, &Options::default().until(1, bound), &mut |_| Continue(())).unwrap_err();
        assert!(error.to_string().contains("a number from 0"), "{error}");
    }
    // Nothing to be done at the optimum.
    let mut middle = PowerDiagram::new(&[[0.5; 3]], &[]).unwrap().restricted_to(&box_domain());
    let relaxed = relax(&cpu(), &mut middle, &Options::default(), &mut |_| Continue(())).unwrap();
    assert!(relaxed.converged && relaxed.iterations.len() == 1);
}

fn box_domain() -> Domain {
    cuboid([0.0; 3], [1.0; 3]).domain()
}

fn relaxed(diagram: &PowerDiagram, options: &Options) -> (PowerDiagram, Relaxation) {
    let mut diagram = diagram.clone();
    let relaxed = relax(&cpu(), &mut diagram, options, &mut |_| Continue(())).unwrap();
    (diagram, relaxed)
}

/// How far energies rise at most, relative to themselves.
fn rise(relaxed: &Relaxation) -> f64 {
    relaxed.iterations.windows(2).map(|i| (i[1].energy - i[0].energy) / i[0].energy.abs()).fold(f64::MIN, f64::max)
}

fn peaks(degree: u32) -> Density {
    let peaks = [Gaussian::round([0.2, 0.2, 0.3], 0.2, 1.0), Gaussian::round([0.8, 0.6, 0.5], 0.25, 0.5)];
    Density::gaussians(degree, 0.1, &peaks).unwrap()
}

#[test]
fn with_a_density_sites_go_down_to_the_centers_of_mass() {
    let linear = Density::Linear { value: 0.01, gradient: [0.0, 0.3, 1.0] };
    let start = cube(&spread(40), &[]);
    let weighted = cube(&spread(40), &weights(40));
    for (density, start) in [(&linear, &start), (&linear, &weighted), (&peaks(5), &start)] {
        // (Rounding, and the error of the quadrature.)
        let most = if *density == linear { 1e-13 } else { 1e-6 };
        let (_, lloyd) = relaxed(start, &Options::default().by(Method::Lloyd).of(density.clone()).until(20, 0.0));
        assert!(rise(&lloyd) <= most, "{density:?}: {:?}", lloyd.iterations);
        let (diagram, lbfgs) = relaxed(start, &Options::default().of(density.clone()).until(200, 1e-6));
        assert!(lbfgs.converged && rise(&lbfgs) <= most, "{density:?}: {:?}", lbfgs.iterations);
        // No steps are tried in vain because a quadrature's energies are not that exact.
        assert!(lbfgs.iterations.last().unwrap().evaluations < 150);
        assert!(lbfgs.iterations.last().unwrap().energy < lloyd.iterations[20].energy);
        // The mean distance by mass, over the mean cell's size.
        let output = density.evaluate_moments(&cpu(), start, &energy_request()).unwrap();
        let (masses, centers) = (density.masses(&output).unwrap(), density.centers(start, &output).unwrap());
        let cells = || masses.iter().enumerate().filter(|(_, mass)| **mass > 0.0);
        let off = |i: usize| (0..3).map(|k| (start.positions()[i][k] - centers[i][k]).powi(2)).sum::<f64>();
        let mean = cells().map(|(i, mass)| mass * off(i)).sum::<f64>() / masses.iter().sum::<f64>();
        let gradient = mean.sqrt() * (cells().count() as f64).cbrt();
        assert!((lbfgs.iterations[0].gradient / gradient - 1.0).abs() < 1e-12, "{density:?}: {gradient}");
        // As a fresh evaluation has them.
        let output = density.evaluate_moments(&cpu(), &diagram, &energy_request()).unwrap();
        let (masses, centers) = (density.masses(&output).unwrap(), density.centers(&diagram, &output).unwrap());
        for (i, p) in diagram.positions().iter().enumerate().filter(|(i, _)| masses[*i] > 0.0) {
            assert!((0..3).all(|k| (p[k] - centers[i][k]).abs() < 3e-6), "{density:?}, {i}: {p:?} {:?}", centers[i]);
        }
        assert_eq!(density.masses(&lbfgs.output).unwrap(), masses);
        if start.weights().iter().all(|w| *w == 0.0) {
            let cost = density.transport_cost(&cpu(), &diagram, &output).unwrap().unwrap();
            assert!((lbfgs.iterations.last().unwrap().energy / cost - 1.0).abs() < 1e-13);
        }
    }
}

#[test]
fn a_constant_density_changes_no_bit_but_the_energy() {
    for method in [Method::Lloyd, Method::Lbfgs] {
        let options = Options::default().by(method).until(15, 0.0);
        let run = |density: Density| relaxed(&cube(&spread(80), &[]), &options.clone().of(density));
        let (plain, one) = run(Density::Uniform);
        let (twice, two) = run(Density::Linear { value: 2.0, gradient: [0.0; 3] });
        assert!(plain.positions() == twice.positions());
        for (a, b) in one.iterations.iter().zip(&two.iterations) {
            assert_eq!((2.0 * a.energy, a.gradient, a.evaluations), (b.energy, b.gradient, b.evaluations));
        }
    }
}

/// Whose volumes are masses: of any unit, and times a density that is asked for.
#[test]
fn the_density_of_a_domain_is_heeded() {
    let image =
        |unit: f64, values: [f64; 8]| Domain::of_image(&values.map(|v| unit * v), [2; 3], [0.0; 3], [1.0; 3]).unwrap();
    let run = |domain: &Domain, density: &Density| {
        let start = PowerDiagram::new(&spread(60), &[]).unwrap().restricted_to(domain);
        relaxed(&start, &Options::default().of(density.clone()).until(8, 0.0))
    };
    let uneven = [1.0, 3.0, 0.0, 2.0, 5.0, 1.0, 1.0, 4.0];
    let [(one, light), (other, heavy)] = [1.0, 1024.0].map(|unit| run(&image(unit, uneven), &Density::Uniform));
    assert!(one.positions() == other.positions());
    for (a, b) in light.iterations.iter().zip(&heavy.iterations) {
        assert_eq!((1024.0 * a.energy, a.evaluations), (b.energy, b.evaluations));
        assert!((a.gradient / b.gradient - 1.0).abs() < 1e-14, "{a:?} {b:?}");
    }
    let linear = Density::Linear { value: 0.1, gradient: [0.5, -0.02, 1.0] };
    let (twice, heavy) = run(&image(1.0, [2.0; 8]), &linear);
    let (plain, light) = relaxed(&cube(&spread(60), &[]), &Options::default().of(linear).until(8, 0.0));
    for (a, b) in light.iterations.iter().zip(&heavy.iterations) {
        assert!((2.0 * a.energy / b.energy - 1.0).abs() < 1e-11, "{a:?} {b:?}");
        assert!((a.gradient / b.gradient - 1.0).abs() < 1e-9, "{a:?} {b:?}");
    }
    for (p, q) in plain.positions().iter().zip(twice.positions()) {
        assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-9), "{p:?} {q:?}");
    }
}

/// By exact moments and by quadrature, which has no error here.
#[test]
fn a_linear_density_and_the_same_function_move_the_sites_alike() {
    let linear = Density::Linear { value: 0.1, gradient: [0.5, -0.02, 1.0] };
    let same = linear.clone();
    let function = Density::function(3, move |x| same.at(x)).unwrap();
    let slab = double_torus().domain();
    let in_slab: Vec<[f64; 3]> = spread(60).iter().map(|p| [5.0 * p[0], 3.0 * p[1], p[2]]).collect();
    let in_slab = PowerDiagram::new(&in_slab, &[]).unwrap().restricted_to(&slab);
    for start in [cube(&spread(40), &weights(40)), in_slab] {
        let run = |density: &Density| relaxed(&start, &Options::default().of(density.clone()).until(6, 0.0));
        let ((one, exact), (other, rule)) = (run(&linear), run(&function));
        for (p, q) in one.positions().iter().zip(other.positions()) {
            assert!((0..3).all(|k| (p[k] - q[k]).abs() < 1e-9), "{p:?} {q:?}");
        }
        for (a, b) in exact.iterations.iter().zip(&rule.iterations) {
            assert!((a.energy - b.energy).abs() < 1e-11 * a.energy.abs(), "{a:?} {b:?}");
            assert!((a.gradient - b.gradient).abs() < 1e-9 && a.evaluations == b.evaluations, "{a:?} {b:?}");
        }
    }
}

/// Of many sites those per volume are as ρ^(3/5): below the middle of a cube whose density is its height, 0.5^(8/5) of them.
#[test]
fn sites_crowd_where_the_density_is_high() {
    let density = Density::Linear { value: 1e-3, gradient: [0.0, 0.0, 1.0] };
    let (diagram, relaxation) = relaxed(&cube(&spread(400), &[]), &Options::default().of(density));
    assert!(relaxation.converged);
    let low = diagram.positions().iter().filter(|p| p[2] < 0.5).count() as f64 / 400.0;
    assert!((low - 0.330).abs() < 0.015, "{low}");
}

#[test]
fn what_is_no_density_is_said() {
    let said = |density: Density| {
        let options = Options::default().of(density).until(5, 0.0);
        relax(&cpu(), &mut cube(&spread(30), &[]), &options, &mut |_| Continue(())).unwrap_err().to_string()
    };
    let line = said(Density::Linear { value: 1.0, gradient: [0.0, 0.0, -1.0] });
    assert!(line.starts_with("the density is 0 at [0.0, 0.0, 1.0]: it must be positive"), "{line}");
    assert!(said(Density::Linear { value: -1.0, gradient: [0.0; 3] }).starts_with("the density is -1 at ["));
    let line = said(Density::gaussians(3, 0.0, &[Gaussian::round([0.5; 3], 1e-3, 1.0)]).unwrap());
    assert!(line.starts_with("the density is 0 at [") && line.contains("a constant"), "{line}");
    // What is found at a later step only is no reason to take a shorter one.
    let calls = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&calls);
    let good = Density::function(2, move |[x, ..]| {
        counted.fetch_add(1, Relaxed);
        1.0 + x
    });
    relaxed(&cube(&spread(30), &[]), &Options::default().of(good.unwrap()).until(0, 0.0));
    let (one, seen) = (calls.load(Relaxed), AtomicUsize::new(0));
    let late = Density::function(2, move |[x, ..]| {
        // Bad while the third diagram is evaluated, a step's; good again after it.
        let seen = seen.fetch_add(1, Relaxed);
        if (5 * one / 2..3 * one).contains(&seen) { -1.0 } else { 1.0 + x }
    });
    assert!(said(late.unwrap()).starts_with("the density is -1 at ["));
}
