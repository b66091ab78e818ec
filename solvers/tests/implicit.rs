//! Derivatives through a solved transport, against differences of solves.

use std::ops::ControlFlow::Continue;

use laguerre_core::{Domain, PowerDiagram, shapes};
use laguerre_cpu::Cpu;
use laguerre_solvers::density::Density;
use laguerre_solvers::transport::{self, Cotangent, Options, Solution};

const SITES: usize = 30;
/// Of a difference: what it leaves out is this squared, and rounding of a solve adds 1e-13 over this.
const STEP: f64 = 1e-4;

fn fraction(i: usize, step: f64) -> f64 {
    (((i + 1) * (i + 1)) as f64 * step.sqrt()).fract()
}

/// A transport to masses that differ, solved to rounding.
fn solved(domain: &Domain, positions: &[[f64; 3]], masses: &[f64], density: Density) -> (PowerDiagram, Solution) {
    let mut diagram = PowerDiagram::new(positions, &[]).unwrap().restricted_to(domain);
    let options = Options::default().of(density).until(60, 1e-13);
    let cpu = Cpu::new(Some(2)).unwrap();
    let solution = transport::solve(&cpu, &mut diagram, masses, &options, &mut |_| Continue(())).unwrap();
    assert!(solution.residual < 1e-11, "{}", solution.residual);
    (diagram, solution)
}

#[test]
fn gradients_are_what_differences_of_solves_tend_to() {
    let domain = shapes::torus(1.0, 0.4, 16, 8).domain();
    let at = |i: usize| [2.0, 3.0, 5.0].map(|x| 2.0 * fraction(i, x) - 1.0);
    let positions: Vec<[f64; 3]> = (0..SITES).map(at).map(|[x, y, z]| [1.4 * x, 1.4 * y, 0.4 * z]).collect();
    let linear = Density::Linear { value: 2.0, gradient: [0.3, -0.5, 0.7] };
    for density in [Density::Uniform, linear] {
        let mut masses: Vec<f64> = (0..SITES).map(|i| 0.5 + fraction(i, 7.0)).collect();
        let total = density
            .total(&Cpu::new(Some(2)).unwrap(), &PowerDiagram::new(&positions, &[]).unwrap().restricted_to(&domain))
            .unwrap();
        let scale = total / masses.iter().sum::<f64>();
        masses.iter_mut().for_each(|m| *m *= scale);
        let cotangent = Cotangent {
            weights: (0..SITES).map(|i| fraction(i, 11.0) - 0.5).collect(),
            barycenters: match density {
                Density::Uniform => (0..SITES).map(|i| [13.0, 17.0, 19.0].map(|x| fraction(i, x) - 0.5)).collect(),
                _ => Vec::new(),
            },
            cost: 0.7,
        };
        let value = |positions: &[[f64; 3]], masses: &[f64]| {
            let (diagram, solution) = solved(&domain, positions, masses, density.clone());
            let by_weights: f64 = solution.weights.iter().zip(&cotangent.weights).map(|(w, u)| w * u).sum();
            let centers = density.centers(&diagram, &solution.output).unwrap();
            let by_centers: f64 =
                centers.as_flattened().iter().zip(cotangent.barycenters.as_flattened()).map(|(b, v)| b * v).sum();
            by_weights + by_centers + cotangent.cost * solution.cost.unwrap()
        };
        let (diagram, _) = solved(&domain, &positions, &masses, density.clone());
        let cpu = Cpu::new(Some(2)).unwrap();
        let found = transport::pull_back(&cpu, &diagram, &density, &cotangent).unwrap();
        assert!(found.masses.iter().sum::<f64>().abs() < 1e-10);
        for i in (0..SITES).step_by(5) {
            for k in 0..3 {
                let moved = |step: f64| {
                    let mut positions = positions.clone();
                    positions[i][k] += step;
                    value(&positions, &masses)
                };
                let wanted = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
                let off = (found.positions[i][k] - wanted).abs();
                assert!(off < 1e-6 * (1.0 + wanted.abs()), "site {i}, {k}: {} and {wanted}", found.positions[i][k]);
            }
            // What one mass gains, another loses.
            let j = (i + 7) % SITES;
            let given = |step: f64| {
                let mut masses = masses.clone();
                masses[i] += step;
                masses[j] -= step;
                value(&positions, &masses)
            };
            let wanted = (given(STEP) - given(-STEP)) / (2.0 * STEP);
            let found = found.masses[i] - found.masses[j];
            assert!((found - wanted).abs() < 1e-5 * (1.0 + wanted.abs()), "masses {i}, {j}: {found} and {wanted}");
        }
    }
}

#[test]
fn what_has_no_gradient_is_said() {
    let cpu = Cpu::new(Some(1)).unwrap();
    let positions = [[0.2, 0.5, 0.5], [0.8, 0.5, 0.5]];
    let diagram =
        |weight: f64| PowerDiagram::new(&positions, &[weight, 0.0]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let said = |weight: f64, cotangent: &Cotangent| {
        transport::pull_back(&cpu, &diagram(weight), &Density::Uniform, cotangent).unwrap_err().to_string()
    };
    let one = Cotangent { cost: 1.0, ..Cotangent::default() };
    assert!(said(-9.0, &one).contains("the cell of site 0 is empty"));
    let short = Cotangent { weights: vec![1.0], ..Cotangent::default() };
    assert!(said(0.0, &short).contains("derivatives by weights: 1 of them for 2 sites"));
}

/// What comes back is in proportion to what was asked, to the bit by powers of two, also where squares of it are nothing or infinite; and is no number where that is none.
#[test]
fn gradients_are_in_proportion_and_never_silently_zero() {
    let cpu = Cpu::new(Some(1)).unwrap();
    let positions: Vec<[f64; 3]> = (0..20).map(|i| [2.0, 3.0, 5.0].map(|step| fraction(i, step))).collect();
    let diagram = PowerDiagram::new(&positions, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let of = |unit: f64, last: f64| {
        let mut weights: Vec<f64> = (0..20).map(|i| unit * fraction(i, 7.0)).collect();
        weights[19] *= last;
        let asked = Cotangent { weights, ..Cotangent::default() };
        transport::pull_back(&cpu, &diagram, &Density::Uniform, &asked).unwrap()
    };
    let one = of(1.0, 1.0);
    for power in [-900, -600, 600, 900] {
        let unit = 2.0_f64.powi(power);
        let scaled = of(unit, 1.0);
        assert!(scaled.masses.iter().zip(&one.masses).all(|(a, b)| *a == unit * b), "2^{power}");
        assert!(scaled.positions.as_flattened().iter().zip(one.positions.as_flattened()).all(|(a, b)| *a == unit * b));
    }
    for none in [f64::NAN, f64::INFINITY] {
        assert!(of(1.0, none).masses.iter().all(|by| by.is_nan()), "{none}");
    }
    let nothing = of(0.0, 1.0);
    assert!(nothing.masses.iter().chain(nothing.positions.as_flattened()).all(|by| *by == 0.0));
}
