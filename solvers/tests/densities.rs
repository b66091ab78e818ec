//! Laws of densities that are functions: what they are to agree with, and what is refused.

use laguerre_core::{
    Backend, BackendInfo, Capabilities, Integrand, Observer, Output, PowerDiagram, Request, Result, shapes,
};
use laguerre_cpu::Cpu;
use laguerre_solvers::density::{Density, Gaussian};
use laguerre_solvers::derivatives::Derivatives;
use laguerre_solvers::lloyd;
use laguerre_solvers::transport::{Cotangent, End, Options, Solution, pull_back, solve, targets};
use std::ops::ControlFlow::Continue;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// Low discrepancy (Roberts' sequence), so that cells are of nearly one size.
fn even(count: usize) -> Vec<[f64; 3]> {
    let at = |i: usize, step: f64| (0.5 + (i + 1) as f64 * step).fract();
    (0..count).map(|i| [0.819_172_513_396, 0.671_043_606_703, 0.549_700_477_901].map(|step| at(i, step))).collect()
}

fn cube(sites: &[[f64; 3]]) -> PowerDiagram {
    PowerDiagram::new(sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap()
}

fn solved(diagram: &mut PowerDiagram, masses: &[f64], options: &Options) -> Solution {
    let solution = solve(&Cpu::new(None).unwrap(), diagram, masses, options, &mut |_| Continue(())).unwrap();
    assert_eq!(solution.end, End::Converged, "{:?}", solution.iterations);
    solution
}

fn gaussians() -> [Gaussian; 2] {
    let covariance = [[0.01, 0.004, 0.002], [0.004, 0.012, -0.003], [0.002, -0.003, 0.008]];
    [Gaussian { mean: [0.45, 0.5, 0.55], covariance, mass: 0.75 }, Gaussian::round([0.6, 0.45, 0.5], 0.07, 0.25)]
}

#[test]
fn functions_that_are_linear_or_constant_have_their_answers() {
    let gradient = [0.5, -0.25, 1.0];
    let linear = Density::Linear { value: 0.7, gradient };
    let same = linear.clone();
    let of_linear = Density::function(3, move |x| same.at(x)).unwrap();
    let sites: Vec<[f64; 3]> = even(150);
    let torus = shapes::torus(0.6, 0.3, 16, 8).domain();
    let flat = Density::Linear { value: 2.0, gradient: [0.3, -0.5, 0.7] };
    let same = flat.clone();
    let of_flat = Density::function(3, move |x| same.at(x)).unwrap();
    let in_torus = || {
        let spread: Vec<[f64; 3]> = sites.iter().map(|p| p.map(|x| 1.8 * x - 0.9)).collect();
        PowerDiagram::new(&spread, &[]).unwrap().restricted_to(&torus)
    };
    let shares: Vec<f64> = (0..150).map(|i| [1.0, 2.0, 5.0][i % 3]).collect();
    for (exact, function, diagram) in [
        (Density::Uniform, Density::function(2, |_| 1.0).unwrap(), cube(&sites)),
        (linear, of_linear, cube(&sites)),
        (flat, of_flat, in_torus()),
    ] {
        let solved = |density: &Density| {
            let mut diagram = diagram.clone();
            let options = Options::default().of(density.clone()).until(60, 1e-12).normalized();
            let solution = solved(&mut diagram, &shares, &options);
            let centers = density.centers(&diagram, &solution.output).unwrap();
            assert_eq!(density.masses(&solution.output).unwrap(), solution.masses);
            (solution, centers)
        };
        let ((one, centers), (other, others)) = (solved(&exact), solved(&function));
        for i in 0..150 {
            assert!((one.weights[i] - other.weights[i]).abs() < 1e-9, "{function:?}, weight {i}");
            assert!((one.masses[i] / other.masses[i] - 1.0).abs() < 1e-10, "{function:?}, mass {i}");
            assert!((0..3).all(|k| (centers[i][k] - others[i][k]).abs() < 1e-9), "{function:?}, center {i}");
        }
        let [a, b] = [&one, &other].map(|solution| solution.cost.unwrap());
        assert!((a / b - 1.0).abs() < 1e-9, "{function:?}: {a} {b}");
        let cpu = Cpu::new(None).unwrap();
        let [a, b] = [&exact, &function].map(|density| density.total(&cpu, &diagram).unwrap());
        assert!((a / b - 1.0).abs() < 1e-13, "{function:?}: {a} {b}");
    }
}

/// The same answers to the last bit, whichever way it is called; and what is wrong with one ends a solver.
#[test]
fn a_function_of_many_places_is_the_same_function() {
    let at = |[x, y, z]: [f64; 3]| 0.3 + x * x + (3.0 * y).sin() * z;
    let calls = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&calls);
    let many = move |places: &[[f64; 3]]| {
        counted.fetch_add(1, Ordering::Relaxed);
        Ok(places.iter().map(|&x| at(x)).collect())
    };
    let densities = [Density::function(3, at).unwrap(), Density::batches(3, many).unwrap()];
    let [one, other] = [0, 1].map(|k| {
        let options = Options::default().of(densities[k].clone());
        let solution = solved(&mut cube(&even(60)), &[], &options);
        let moving = lloyd::Options::default().of(densities[k].clone()).until(4, 0.0);
        let mut moved = cube(&even(60));
        let cpu = Cpu::new(Some(2)).unwrap();
        let relaxed = lloyd::relax(&cpu, &mut moved, &moving, &mut |_| Continue(())).unwrap();
        (solution.weights, solution.cost, moved.positions().to_vec(), relaxed.iterations)
    });
    assert!(one == other);
    // With some hundred cells, or a few thousand facets, each.
    assert!(calls.load(Ordering::Relaxed) < 100, "{calls:?}");
    let said = |density: Result<Density>| {
        let density = density.unwrap();
        let cpu = Cpu::new(Some(2)).unwrap();
        let options = Options::default().of(density.clone());
        let error = solve(&cpu, &mut cube(&even(60)), &[], &options, &mut |_| Continue(())).unwrap_err();
        let moving = lloyd::Options::default().of(density);
        let other = lloyd::relax(&cpu, &mut cube(&even(60)), &moving, &mut |_| Continue(())).unwrap_err();
        assert_eq!(error.to_string(), other.to_string());
        error.to_string()
    };
    let line = said(Density::batches(3, |_| Ok(vec![1.0])));
    assert!(line.starts_with("density: 1 values for ") && line.ends_with("one for each is needed"), "{line}");
    assert_eq!(said(Density::batches(3, |_| Err(laguerre_core::Error::input("no table")))), "no table");
    assert!(said(Density::batches(3, |places| Ok(vec![0.0; places.len()]))).starts_with("the density is 0 at ["));
    // At a later step it is no reason for a shorter one.
    let seen = AtomicUsize::new(0);
    let late = Density::batches(3, move |places| match seen.fetch_add(1, Ordering::Relaxed) {
        5 => Err(laguerre_core::Error::input("no more")),
        _ => Ok(places.iter().map(|&x| at(x)).collect()),
    });
    let options = Options::default().of(late.unwrap());
    let cpu = Cpu::new(Some(1)).unwrap();
    let error = solve(&cpu, &mut cube(&even(60)), &[], &options, &mut |_| Continue(())).unwrap_err();
    assert_eq!(error.to_string(), "no more");
}

/// Against sums over a lattice of points, each with the site of least power.
#[test]
fn equal_masses_of_gaussians_are_those_of_points() {
    let (sites, constant) = (even(40), 0.1);
    let density = Density::gaussians(13, constant, &gaussians()).unwrap();
    let mut diagram = cube(&sites);
    let solution = solved(&mut diagram, &[], &Options::default().of(density.clone()));
    // All but some 1e-5 of the Gaussians is in the cube.
    let total: f64 = solution.masses.iter().sum();
    assert!((total - 1.1).abs() < 2e-4, "{total}");
    assert!(solution.masses.iter().all(|m| (m * 40.0 / total - 1.0).abs() < 1e-9));
    let n = 100;
    let (mut masses, mut firsts, mut cost) = (vec![0.0; 40], vec![[0.0; 3]; 40], 0.0);
    for k in 0..n * n * n {
        let x = [k % n, k / n % n, k / n / n].map(|k| (k as f64 + 0.5) / n as f64);
        let away = |i: usize| (0..3).map(|k| (x[k] - sites[i][k]).powi(2)).sum::<f64>();
        let power = |i: usize| away(i) - solution.weights[i];
        let i = (0..40).min_by(|&i, &j| power(i).total_cmp(&power(j))).unwrap();
        let mass = density.at(x) / (n * n * n) as f64;
        masses[i] += mass;
        (0..3).for_each(|k| firsts[i][k] += mass * x[k]);
        cost += mass * away(i);
    }
    let centers = density.centers(&diagram, &solution.output).unwrap();
    for i in 0..40 {
        assert!((masses[i] / solution.masses[i] - 1.0).abs() < 0.02, "{i}: {} {}", masses[i], solution.masses[i]);
        assert!((0..3).all(|k| (firsts[i][k] / masses[i] - centers[i][k]).abs() < 2e-3), "{i}");
    }
    assert!((cost / solution.cost.unwrap() - 1.0).abs() < 1e-3, "{cost} {:?}", solution.cost);
}

#[test]
fn gaussians_are_normal_distributions() {
    // Of one that is wholly within: mass, mean and second moments about it.
    let all = gaussians();
    let density = Density::gaussians(13, 1e-9, &all[..1]).unwrap();
    let cpu = Cpu::new(None).unwrap();
    let wide = PowerDiagram::new(&even(300), &[]).unwrap().in_box([-0.3; 3], [1.3; 3]).unwrap();
    let output = density.evaluate_moments(&cpu, &wide, &Request::moments()).unwrap();
    let (masses, centers) = (density.masses(&output).unwrap(), density.centers(&wide, &output).unwrap());
    let total: f64 = masses.iter().sum();
    assert!((total - 0.75).abs() < 1e-6, "{total}");
    for (k, wanted) in all[0].mean.into_iter().enumerate() {
        let mean = masses.iter().zip(&centers).map(|(m, c)| m * c[k]).sum::<f64>() / total;
        assert!((mean - wanted).abs() < 1e-6, "{mean}");
    }
    let one = PowerDiagram::new(&[all[0].mean], &[]).unwrap().in_box([-0.3; 3], [1.3; 3]).unwrap();
    let fine = Density::gaussians(31, 1e-9, &all[..1]).unwrap();
    let output = fine.evaluate_moments(&cpu, &one, &Request::moments()).unwrap();
    let cost = fine.cost(&one, &output).unwrap();
    let trace: f64 = (0..3).map(|k| all[0].covariance[k][k]).sum();
    assert!((cost / (0.75 * trace) - 1.0).abs() < 1e-3, "{cost} {trace}");
    // With z = Σu it falls from the mean to z by the factor exp(−½ uᵀΣu).
    let (alone, u) = (Density::gaussians(1, 0.0, &all[..1]).unwrap(), [5.0, -4.0, 7.0]);
    let times = |row: [f64; 3]| (0..3).map(|k| row[k] * u[k]).sum::<f64>();
    let z = all[0].covariance.map(times);
    let fall = (alone.at(std::array::from_fn(|k| all[0].mean[k] + z[k])) / alone.at(all[0].mean)).ln();
    assert!((fall + 0.5 * times(z)).abs() < 1e-12 && fall < -0.1, "{fall}");
}

/// Sites that begin with groups, in a domain that is not convex, to the last bit for any number of threads.
#[test]
fn hard_starts_come_to_an_end_and_do_not_depend_on_threads() {
    let sites: Vec<[f64; 3]> = even(80).iter().map(|p| p.map(|x| 0.8 * x * x * x)).collect();
    let torus = shapes::torus(0.6, 0.3, 16, 8).domain();
    let peak = Gaussian::round([0.6, 0.0, 0.0], 0.25, 0.5);
    let density = Density::gaussians(3, 0.5, &[peak]).unwrap();
    let run = |threads: usize| {
        let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&torus);
        let (cpu, options) = (Cpu::new(Some(threads)).unwrap(), Options::default().of(density.clone()));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let solution = pool.install(|| solve(&cpu, &mut diagram, &[], &options, &mut |_| Continue(()))).unwrap();
        assert_eq!(solution.end, End::Converged, "{:?}", solution.iterations);
        solution.weights
    };
    assert!(run(1) == run(2));
}

#[test]
fn what_is_no_density_is_said() {
    let sites = even(60);
    let said = |density: Density| {
        let run = |threads: usize| {
            let cpu = Cpu::new(Some(threads)).unwrap();
            let options = Options::default().of(density.clone());
            solve(&cpu, &mut cube(&sites), &[], &options, &mut |_| Continue(())).unwrap_err()
        };
        let (error, other) = (run(1), run(2));
        assert_eq!(error.kind(), laguerre_core::ErrorKind::Input);
        assert_eq!(error.to_string(), other.to_string());
        error.to_string()
    };
    // The place is named, and the value there.
    let dips = |[x, y, z]: [f64; 3]| x + y * z - 0.2;
    // It is the least of all such places.
    let least = Arc::new(Mutex::new([f64::INFINITY; 3]));
    let noted = Arc::clone(&least);
    let noting = move |x: [f64; 3]| {
        let mut least = noted.lock().unwrap();
        if dips(x) <= 0.0 && x < *least {
            *least = x;
        }
        dips(x)
    };
    let line = said(Density::function(3, noting).unwrap());
    let number = |text: &str| text.parse::<f64>().unwrap();
    let (value, place) = line.strip_prefix("the density is ").unwrap().split_once(" at [").unwrap();
    let place: Vec<f64> = place.split_once(']').unwrap().0.split(", ").map(number).collect();
    assert_eq!(place, *least.lock().unwrap(), "{line}");
    assert_eq!(number(value), dips([place[0], place[1], place[2]]), "{line}");
    assert!(
        said(Density::function(3, |[x, _, _]| if x > 0.9 { f64::NAN } else { 1.0 }).unwrap()).contains("is NaN at")
    );
    let infinite = |[x, _, _]: [f64; 3]| if x > 0.9 { f64::INFINITY } else { 1.0 };
    assert!(said(Density::function(3, infinite).unwrap()).contains("is inf at"));
    // So narrow a Gaussian is 0 far from it.
    let narrow = Gaussian::round([0.5; 3], 1e-3, 1.0);
    assert!(said(Density::gaussians(3, 0.0, &[narrow]).unwrap()).contains("is 0 at ["));
    // What is found at a later step only is no reason to take a shorter one.
    let calls = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&calls);
    let good = Density::function(2, move |x| {
        counted.fetch_add(1, Ordering::Relaxed);
        1.0 + x[0]
    });
    let cpu = Cpu::new(Some(1)).unwrap();
    good.unwrap().total(&cpu, &cube(&sites)).unwrap();
    let (one, seen) = (calls.load(Ordering::Relaxed), AtomicUsize::new(0));
    let late = Density::function(2, move |x| {
        // Bad while the third diagram is evaluated, a step's; good again after it.
        let seen = seen.fetch_add(1, Ordering::Relaxed);
        if (5 * one / 2..3 * one).contains(&seen) { -1.0 } else { 1.0 + x[0] }
    });
    let options = Options::default().of(late.unwrap());
    let error = solve(&cpu, &mut cube(&sites), &[], &options, &mut |_| Continue(())).unwrap_err();
    assert!(error.to_string().starts_with("the density is -1 at ["), "{error}");
    let refused = |density: Result<Density>| density.unwrap_err().to_string();
    assert!(refused(Density::function(32, |_| 1.0)).contains("degree 32"));
    assert!(refused(Density::gaussians(3, -1.0, &[narrow])).starts_with("the constant -1 of Gaussians"));
    for wrong in [
        Gaussian { mass: -1.0, ..narrow },
        Gaussian { mass: f64::NAN, ..narrow },
        Gaussian { mean: [0.0, f64::INFINITY, 0.0], ..narrow },
        Gaussian::round([0.5; 3], 0.0, 1.0),
        Gaussian { covariance: [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]], ..narrow },
        Gaussian { covariance: [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], ..narrow },
    ] {
        assert!(refused(Density::gaussians(3, 1.0, &[narrow, wrong])).starts_with("Gaussian 1, "), "{wrong:?}");
    }
}

/// What cannot call a function, as devices cannot.
struct Device(Cpu);

impl Backend for Device {
    fn info(&self) -> BackendInfo {
        self.0.info()
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        Capabilities::OF_DEVICES.check(request, diagram)?;
        self.0.evaluate_watched(diagram, request, observer)
    }
}

#[test]
fn what_functions_do_not_have_is_said() {
    let (cpu, diagram) = (Cpu::new(Some(1)).unwrap(), cube(&even(30)));
    let density = Density::function(3, |[x, ..]| 1.0 + x * x).unwrap();
    let output = cpu.evaluate(&diagram, &Derivatives::request(&density)).unwrap();
    let why = "derivatives are there for uniform and linear densities";
    assert!(Derivatives::new(&diagram, &output, &density).unwrap_err().to_string().starts_with(why));
    let cotangent = Cotangent { cost: 1.0, ..Cotangent::default() };
    assert!(pull_back(&cpu, &diagram, &density, &cotangent).unwrap_err().to_string().starts_with(why));
    assert_eq!((density.masses(&output), density.centers(&diagram, &output)), (None, None));
    let options = Options::default().of(density.clone());
    let device = Device(Cpu::new(Some(1)).unwrap());
    let error = solve(&device, &mut diagram.clone(), &[], &options, &mut |_| Continue(())).unwrap_err().to_string();
    assert!(error.contains("a device cannot call a function") && error.ends_with("compute on the CPU"), "{error}");
    let moving = lloyd::Options::default().of(density.clone());
    let error = lloyd::relax(&device, &mut diagram.clone(), &moving, &mut |_| Continue(())).unwrap_err().to_string();
    assert!(error.contains("a device cannot call a function"), "{error}");
    let error = density.evaluate(&cpu, &diagram, &density_request()).unwrap_err().to_string();
    assert!(error.starts_with("the request has an integral of its own"), "{error}");
    // Masses are shares.
    let aimed = targets(&cpu, &diagram, &[0.1; 30], &options).unwrap();
    assert!(aimed.iter().all(|mass| (mass - 4.0 / 90.0).abs() < 1e-12), "{aimed:?}");
}

fn density_request() -> Request {
    Request::moments().with_integral(Integrand::function(1, |[x, ..]| x).unwrap())
}

/// A start that sees hardly anything of the density leads to the same end, in about as many steps; and a function is called in the box alone.
#[test]
fn what_the_start_sees_of_a_function_does_not_matter() {
    let cpu = Cpu::new(None).unwrap();
    let is_outside = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&is_outside);
    let density = Density::function(5, move |x| {
        if x.iter().any(|&x| !(0.0..=1.0).contains(&x)) {
            seen.store(true, Relaxed);
        }
        0.1 + (-((x[0] - 0.7).powi(2) + (x[1] - 0.6).powi(2) + (x[2] - 0.4).powi(2)) / (2.0 * 0.12 * 0.12)).exp()
    })
    .unwrap();
    let sites = even(300);
    let mut steps = Vec::new();
    for weight in [0.0, 3.0] {
        // With this one cell is all of the cube.
        let mut weights = vec![0.0; 300];
        weights[0] = weight;
        let mut diagram = PowerDiagram::new(&sites, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        let options = Options::default().of(density.clone());
        let solution = solve(&cpu, &mut diagram, &[], &options, &mut |_| Continue(())).unwrap();
        assert_eq!(solution.end, End::Converged, "{} after {}", solution.residual, solution.iterations.len());
        let worst = &solution.worst;
        assert_eq!(worst.mass, solution.masses[worst.site]);
        steps.push(solution.iterations.len());
    }
    eprintln!("{steps:?}");
    assert!(steps[0].abs_diff(steps[1]) <= 3, "{steps:?}");
    assert!(!is_outside.load(Relaxed));
}
