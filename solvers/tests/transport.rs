//! Laws of optimal transport: what is asked for is found, and what cannot be is said.

use laguerre_core::shapes;
use laguerre_core::{Backend, Domain, PowerDiagram, Request};
use laguerre_cpu::Cpu;
use laguerre_solvers::density::Density;
use laguerre_solvers::transport::{Cause, End, Iteration, Options, Solution, Worst, solve, targets};
use std::ops::ControlFlow::Continue;

/// Not in the package of this crate (`fixtures/meshes/README.md`).
const BUNNY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/meshes/bunny.obj");

/// White noise in a box: a linear congruential generator (Knuth's MMIX) is random enough.
fn white(count: usize, lo: [f64; 3], hi: [f64; 3], seed: u64) -> Vec<[f64; 3]> {
    let mut state = seed;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count).map(|_| std::array::from_fn(|k| lo[k] + unit() * (hi[k] - lo[k]))).collect()
}

fn cpu() -> Cpu {
    Cpu::new(None).unwrap()
}

fn solved(diagram: &mut PowerDiagram, masses: &[f64], options: &Options) -> Solution {
    let mut seen: Vec<Iteration> = Vec::new();
    let solution = solve(&cpu(), diagram, masses, options, &mut |done| {
        seen.push(*done);
        Continue(())
    })
    .unwrap();
    assert_eq!(seen, solution.iterations);
    assert_eq!(solution.end, End::Converged, "{:?}", solution.iterations);
    assert_eq!(diagram.weights(), solution.weights);
    solution
}

/// Holds the masses of a fresh evaluation against those asked for.
fn check(diagram: &PowerDiagram, solution: &Solution, masses: &[f64], density: &Density) {
    let output = density.evaluate(&cpu(), diagram, &Request::moments()).unwrap();
    for (i, mass) in density.masses(&output).unwrap().iter().enumerate() {
        assert!((mass / masses[i] - 1.0).abs() <= 1e-9, "cell {i}: {mass} for {}", masses[i]);
    }
    assert!(solution.residual <= 1e-9);
    assert!(solution.output.facets().is_none());
    let sum: f64 = solution.weights.iter().sum();
    assert!(sum.abs() <= 1e-12 * solution.weights.iter().map(|w| w.abs()).sum::<f64>());
}

#[test]
fn weights_of_a_known_diagram_are_recovered() {
    let n = 2000;
    let sites = white(n, [0.0; 3], [1.0; 3], 1);
    // Differences of a tenth of a squared cell size: no cell is empty.
    let size2 = (n as f64).powf(-2.0 / 3.0);
    let mut known: Vec<f64> = white(n, [0.0; 3], [0.1 * size2; 3], 2).iter().map(|p| p[0]).collect();
    let mut diagram = PowerDiagram::new(&sites, &known).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let masses = cpu().evaluate(&diagram, &Request::moments()).unwrap().into_arrays().volume;
    assert!(masses.iter().all(|&m| m > 0.0));
    diagram.set_sites(&sites, &[]).unwrap();
    let options = Options::default().until(100, 1e-11);
    let solution = solved(&mut diagram, &masses, &options);
    let mean = known.iter().sum::<f64>() / n as f64;
    known.iter_mut().for_each(|w| *w -= mean);
    let largest = known.iter().zip(&solution.weights).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest <= 1e-8 * size2, "{largest:e} of {size2:e}");
    // From there, there is nothing to do.
    let again = solved(&mut diagram, &masses, &options);
    assert_eq!(again.iterations.len(), 1);
}

#[test]
fn cells_of_equal_mass_in_a_bunny_and_the_end_is_quadratic() {
    let domain = Domain::load(BUNNY).unwrap();
    let (lo, hi) = domain.bounding_box();
    let all = white(4000, lo, hi, 3);
    let cells = cpu().evaluate(&PowerDiagram::new(&all, &[]).unwrap().restricted_to(&domain), &Request::moments());
    let cells = cells.unwrap();
    let mean = (0..3).map(|k| hi[k] - lo[k]).product::<f64>() / 4000.0;
    // Well in the domain; and with sites outside of it whose cells are slivers.
    for (least, most_steps, most_diagrams) in [(0.3, 8, 9), (0.0, 25, 25)] {
        let sites: Vec<[f64; 3]> =
            (0..all.len()).filter(|&i| cells.volume()[i] > least * mean).map(|i| all[i]).collect();
        let n = sites.len();
        let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&domain);
        let solution = solved(&mut diagram, &[], &Options::default());
        check(&diagram, &solution, &vec![domain.volume() / n as f64; n], &Density::Uniform);
        let residuals: Vec<f64> = solution.iterations.iter().map(|done| done.residual).collect();
        assert!(residuals.len() <= most_steps + 1, "{least}: {residuals:?}");
        let diagrams: usize = solution.iterations.iter().map(|done| done.diagram_evaluations).sum();
        assert!(diagrams <= most_diagrams, "{least}: {diagrams} diagrams");
        // The last steps but one square the residual, up to a factor.
        let [.., a, b, _] = residuals[..] else { panic!("{residuals:?}") };
        assert!(b <= 10.0 * a * a && a < 0.1, "{residuals:?}");
    }
}

#[test]
fn sites_outside_of_the_domain_get_cells_too() {
    let domain = shapes::double_torus().domain();
    let sites = white(300, [-1.0; 3], [4.0, 3.0, 2.0], 5);
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&domain);
    let empty = cpu().evaluate(&diagram, &Request::moments()).unwrap().volume().iter().filter(|&&v| v == 0.0).count();
    assert!(empty > 50, "{empty}");
    let solution = solved(&mut diagram, &[], &Options::default());
    check(&diagram, &solution, &[13.0 / 300.0; 300], &Density::Uniform);
    // In a plate so thin that no cell of the first lattices is free of its surface.
    let plate = shapes::plate().domain();
    let sites = white(60, [0.0, 0.0, 0.1], [2.0, 2.0, 0.6], 6);
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&plate);
    let solution = solved(&mut diagram, &[], &Options::default());
    check(&diagram, &solution, &[plate.volume() / 60.0; 60], &Density::Uniform);
}

#[test]
fn weights_that_empty_cells_are_no_start() {
    let sites = white(200, [0.0; 3], [1.0; 3], 7);
    let mut weights = vec![0.0; 200];
    weights[17] = 0.5;
    let mut diagram = PowerDiagram::new(&sites, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let solution = solved(&mut diagram, &[], &Options::default());
    check(&diagram, &solution, &[1.0 / 200.0; 200], &Density::Uniform);
    assert_eq!(solution.iterations[0].diagram_evaluations, 2);
}

#[test]
fn a_few_empty_cells_are_lifted() {
    let mut sites = white(300, [0.0; 3], [1.0; 3], 7);
    // Half way between these two is just outside of the box: the second has nothing of it.
    sites.extend([[0.0299, 0.5, 0.5], [-0.03, 0.5, 0.5]]);
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    assert_eq!(cpu().evaluate(&diagram, &Request::moments()).unwrap().volume()[301], 0.0);
    let solution = solved(&mut diagram, &[], &Options::default());
    check(&diagram, &solution, &[1.0 / 302.0; 302], &Density::Uniform);
    assert_eq!(solution.iterations[0].diagram_evaluations, 2);
}

#[test]
fn parts_that_do_not_touch_exchange_mass() {
    let domain = shapes::two_components(1).domain();
    let mut sites = white(70, [-1.0, -0.5, -0.5], [0.0, 0.5, 0.5], 8);
    sites.extend(white(130, [1.2, -0.3, -0.3], [1.8, 0.3, 0.3], 9));
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&domain);
    let solution = solved(&mut diagram, &[], &Options::default());
    check(&diagram, &solution, &[domain.volume() / 200.0; 200], &Density::Uniform);
}

/// One cell is a part: with too much and with too little of what all are to have, among more than are solved directly; and with more than the tolerance too
/// much of its own, which is less than that of what the others have.
#[test]
fn a_part_of_one_cell_exchanges_mass() {
    for (count, size, share, tolerance) in
        [(400, 0.2, None, 1e-9), (400, 0.05, None, 1e-9), (200, 0.1, Some(0.5), 1e-2)]
    {
        let domain = shapes::cuboid([0.0; 3], [1.0; 3]).merged(&shapes::cuboid([2.0; 3], [2.0 + size; 3])).domain();
        let mut sites = white(count, [0.0; 3], [1.0; 3], 51);
        sites.push([2.0 + size / 2.0; 3]);
        let its = share.map_or(domain.volume() / (count + 1) as f64, |share| share * size.powi(3));
        let mut masses = vec![(domain.volume() - its) / count as f64; count + 1];
        masses[count] = its;
        let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&domain);
        let mut options = Options::default();
        options.tolerance = tolerance;
        assert!(solved(&mut diagram, &masses, &options).residual <= tolerance);
    }
}

#[test]
fn linear_densities_are_exact() {
    let density = Density::Linear { value: 1.0, gradient: [0.5, -0.25, 2.0] };
    let options = Options::default().of(density.clone());
    let (lo, hi) = ([0.0; 3], [1.0, 2.0, 1.0]);
    let sites = white(500, lo, hi, 11);
    let total = 2.0 * (1.0 + 0.25 - 0.25 + 1.0);
    // Asked for: masses of three kinds.
    let share = |i: usize| [1.0, 2.0, 5.0][i % 3];
    let sum: f64 = (0..500).map(share).sum();
    let masses: Vec<f64> = (0..500).map(|i| total * share(i) / sum).collect();
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box(lo, hi).unwrap();
    let solution = solved(&mut diagram, &masses, &options);
    check(&diagram, &solution, &masses, &density);
    // All that can be asked for comes together.
    let mut all = options.clone().with_facets();
    all.laplacian = true;
    let output = solved(&mut diagram, &masses, &all).output;
    assert!(output.facets().is_some() && output.laplacian().is_some() && output.second_moment().is_some());
    // The centres of mass are those of the whole.
    let centers = density.centers(&diagram, &solution.output).unwrap();
    let first: [f64; 3] = std::array::from_fn(|k| (0..500).map(|i| solution.masses[i] * centers[i][k]).sum());
    // ∫ρx over the box, by hand: the mean of x² is a third of the squared edge.
    let right = [2.0 * (0.5 * 1.75 + 0.5 / 3.0), 2.0 * (2.25 - 0.25 * 4.0 / 3.0), 2.0 * (0.5 + 2.0 / 3.0)];
    for k in 0..3 {
        assert!((first[k] - right[k]).abs() < 1e-12, "{first:?} {right:?}");
    }
    // The cost is the least of all: that of other weights with the same cells' masses is more. For one cell it is known.
    let mut one = PowerDiagram::new(&[[0.5, 1.0, 0.5]], &[]).unwrap().in_box(lo, hi).unwrap();
    let cost = solved(&mut one, &[], &options).cost.unwrap();
    // About the centre odd terms vanish: ρ(centre) times the second moments.
    let right = 2.0 * 2.0 * (1.0 / 12.0 + 4.0 / 12.0 + 1.0 / 12.0);
    assert!((cost - right).abs() < 1e-13 * right, "{cost} {right}");
    // A density that is nearly uniform costs nearly the same, by the other formula.
    let nearly = Density::Linear { value: 1.0, gradient: [1e-14, 0.0, 0.0] };
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box(lo, hi).unwrap();
    let uniform = solved(&mut diagram, &[], &Options::default()).cost.unwrap();
    let linear = solved(&mut diagram, &[], &Options::default().of(nearly)).cost.unwrap();
    assert!((linear / uniform - 1.0).abs() < 1e-10, "{linear} {uniform}");
}

/// Sites that are not spread as the domain is: Voronoi cells of most are tiny or empty.
#[test]
fn hard_starts_take_few_steps() {
    let cube = || PowerDiagram::new(&[[0.5; 3]], &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let mut clustered = white(300, [0.0; 3], [1.0; 3], 31);
    clustered.iter_mut().for_each(|p| *p = p.map(|x| 0.3 + x * x * x * x * x * 0.3));
    let mut plummer = white(1500, [0.0; 3], [1.0; 3], 36);
    plummer.iter_mut().for_each(|p| {
        // Toward a place on the sphere, as far as a Plummer sphere has that part of its mass.
        let (z, angle, radius) =
            (2.0 * p[0] - 1.0, std::f64::consts::TAU * p[1], 0.005 / (p[2].powf(-2.0 / 3.0) - 1.0).sqrt());
        let across = (1.0 - z * z).sqrt();
        *p = [across * angle.cos(), across * angle.sin(), z].map(|x| 0.5 + radius.min(0.5) * x);
    });
    let apart = shapes::cuboid([0.0; 3], [1.0; 3]).merged(&shapes::cuboid([2.0, 0.0, 0.0], [3.0, 1.0, 1.0]));
    let trefoil = shapes::trefoil(0.3, 96, 8).domain();
    let (lo, hi) = trefoil.bounding_box();
    let cases = [
        ("a cloud of a ten-thousandth", white(500, [0.5; 3], [0.5001; 3], 32), cube()),
        ("clustered", clustered, cube()),
        ("a crowd, and some far from it", plummer.clone(), cube()),
        ("the same in the box that the sites span", plummer, PowerDiagram::new(&[[0.5; 3]], &[]).unwrap()),
        ("outside", white(500, [2.0, 0.0, 0.0], [3.0, 0.3, 1.0], 33), cube()),
        ("two cubes", white(700, [0.0; 3], [3.0, 1.0, 1.0], 34), cube().restricted_to(&apart.domain())),
        ("thin limbs", white(800, lo, hi, 35), cube().restricted_to(&trefoil)),
    ];
    for (name, sites, mut diagram) in cases {
        diagram.set_sites(&sites, &[]).unwrap();
        let mass = targets(&cpu(), &diagram, &[], &Options::default()).unwrap();
        let solution = solved(&mut diagram, &[], &Options::default());
        check(&diagram, &solution, &mass, &Density::Uniform);
        let steps = solution.iterations.len() - 1;
        let diagrams: usize = solution.iterations.iter().map(|iteration| iteration.diagram_evaluations).sum();
        assert!(steps <= 8 && diagrams <= 18, "{name}: {steps} steps, {diagrams} diagrams");
    }
}

/// Equal masses of an image of strong contrast, with voxels where there is nothing.
#[test]
fn an_image_is_shared_out_evenly() {
    let mut values: Vec<f64> =
        white(6 * 6 * 6, [0.0; 3], [1.0; 3], 36).iter().map(|p| (200.0 * p[0].powi(4)).floor()).collect();
    values[..40].fill(0.0);
    let domain = Domain::of_image(&values, [6; 3], [0.0; 3], [1.0; 3]).unwrap();
    let sites = white(300, [0.0; 3], [1.0; 3], 37);
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&domain);
    let solution = solved(&mut diagram, &[], &Options::default());
    let mass = targets(&cpu(), &diagram, &[], &Options::default()).unwrap();
    assert!((mass[0] - values.iter().sum::<f64>() / 216.0 / 300.0).abs() < 1e-15 * values.iter().sum::<f64>());
    check(&diagram, &solution, &mass, &Density::Uniform);
    assert!(solution.iterations.len() <= 16, "{} steps", solution.iterations.len() - 1);
}

#[test]
fn the_result_is_the_same_to_the_last_bit() {
    let sites = white(6000, [0.0; 3], [1.0; 3], 13);
    // Spread unevenly, so that it begins with groups.
    let uneven: Vec<[f64; 3]> = white(800, [0.0; 3], [1.0; 3], 14).iter().map(|p| p.map(|x| x * x * x)).collect();
    for sites in [sites, uneven] {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
            let backend = Cpu::new(Some(threads)).unwrap();
            pool.install(|| solve(&backend, &mut diagram, &[], &Options::default(), &mut |_| Continue(())))
                .unwrap()
                .weights
        };
        let one = run(1);
        assert!(one == run(1));
        assert!(one == run(2));
    }
}

/// Whatever the unit of length: a power of two of it changes no bit.
#[test]
fn units_change_nothing() {
    let sites = white(60, [0.0; 3], [1.0; 3], 12);
    let weights_in = |unit: f64| {
        let scaled: Vec<[f64; 3]> = sites.iter().map(|p| p.map(|x| x * unit)).collect();
        let mut diagram = PowerDiagram::new(&scaled, &[]).unwrap().in_box([0.0; 3], [unit; 3]).unwrap();
        let solution = solved(&mut diagram, &[], &Options::default());
        let mass = unit * unit * unit / 60.0;
        assert!(solution.masses.iter().all(|m| (m / mass - 1.0).abs() < 1e-9));
        solution.weights.iter().map(|w| w / unit / unit).collect::<Vec<f64>>()
    };
    let weights = weights_in(1.0);
    for power in [-180, 180] {
        assert_eq!(weights_in(2_f64.powi(power)), weights);
    }
}

#[test]
fn what_cannot_be_is_said() {
    let sites = white(10, [0.0; 3], [1.0; 3], 17);
    let said = |sites: &[[f64; 3]], masses: &[f64], options: &Options| {
        let mut diagram = PowerDiagram::new(sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        solve(&cpu(), &mut diagram, masses, options, &mut |_| Continue(())).unwrap_err().to_string()
    };
    let plain = Options::default();
    assert_eq!(said(&sites, &[0.1; 9], &plain), "9 masses for 10 sites: give one for each");
    let mut masses = [0.1; 10];
    masses[3] = 0.0;
    assert_eq!(said(&sites, &masses, &plain), "the mass of site 3 is 0: masses must be positive numbers");
    masses[3] = f64::NAN;
    assert_eq!(said(&sites, &masses, &plain), "the mass of site 3 is NaN: masses must be positive numbers");
    assert_eq!(
        said(&sites, &[0.125; 10], &plain),
        "the masses sum to 1.25, but the domain has 1.0: multiply each by 0.8, or have them normalized"
    );
    assert!(said(&sites, &[], &plain.clone().until(5, f64::NAN)).starts_with("tolerance NaN: "));
    // Sums that overflow are no sums, and what becomes 0 is no mass.
    for masses in [[1e308; 10], [1e-310; 10]] {
        for options in [plain.clone(), plain.clone().normalized()] {
            assert!(said(&sites, &masses, &options).contains("no double is the factor"));
        }
    }
    let mut masses = [1e200; 10];
    masses[4] = 1e-200;
    assert!(said(&sites, &masses, &plain.clone().normalized()).contains("no double is the factor"));
    let mut twice = sites.clone();
    twice[8] = twice[2];
    assert!(said(&twice, &[], &plain).starts_with("sites 2 and 8 are at the same place ["));
    let density = Density::Linear { value: 0.5, gradient: [0.0, -0.5, 0.0] };
    assert!(said(&sites, &[], &plain.clone().of(density)).starts_with("the density is 0 at [0.0, 1.0, 0.0]: "));
    // What is off by less than the tolerance is scaled.
    let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let aimed = targets(&cpu(), &diagram, &[0.1 * (1.0 + 1e-10); 10], &plain).unwrap();
    assert!((aimed.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    // And what is off by any factor, where the options say so.
    let shares: Vec<f64> = (1..11).map(|i| 3.0 * f64::from(i)).collect();
    let aimed = targets(&cpu(), &diagram, &shares, &plain.normalized()).unwrap();
    assert!(aimed.iter().zip(&shares).all(|(a, share)| (a * 165.0 - share).abs() < 1e-12));
}

/// Masses of six decades.
#[test]
fn unequal_masses_are_met() {
    let sites = white(300, [0.0; 3], [1.0; 3], 42);
    let masses: Vec<f64> = white(300, [-6.0; 3], [0.0; 3], 43).iter().map(|p| 10_f64.powf(p[0])).collect();
    let options = Options::default().normalized();
    for domain in [None, Some(shapes::torus(0.6, 0.3, 24, 12).domain())] {
        let diagram = PowerDiagram::new(&sites, &[]).unwrap();
        let mut diagram = match &domain {
            None => diagram.in_box([0.0; 3], [1.0; 3]).unwrap(),
            Some(domain) => diagram.restricted_to(domain),
        };
        let aimed = targets(&cpu(), &diagram, &masses, &options).unwrap();
        let solution = solved(&mut diagram, &masses, &options);
        check(&diagram, &solution, &aimed, &Density::Uniform);
    }
}

/// Pairs and fives of sites that are nearly at one place: solved where doubles can say the weights, else it is said which sites are too near, and how
/// little could be moved between them.
#[test]
fn sites_nearly_at_one_place_are_solved_or_named() {
    let run = |distance: f64| {
        let mut sites = white(150, [0.0; 3], [1.0; 3], 44);
        let mut others = white(150, [-distance; 3], [distance; 3], 45).into_iter();
        let mut near = |of: usize, to: usize| {
            let (p, way) = (sites[of], others.next().unwrap());
            sites[to] = std::array::from_fn(|k| p[k] + way[k]);
        };
        (1..5).for_each(|to| near(0, to));
        (10..20).step_by(2).for_each(|of| near(of, of + 1));
        let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        solve(&cpu(), &mut diagram, &[], &Options::default(), &mut |_| Continue(())).unwrap()
    };
    let wide = run(1e-6);
    assert_eq!((wide.end, &wide.worst.cause), (End::Converged, &None), "{}", wide.worst);
    for distance in [1e-9, 1e-12, 1e-14] {
        let solution = run(distance);
        assert_eq!(solution.end, End::Stalled, "{distance}: {}", solution.worst);
        let Worst { mass, target, cause, .. } = &solution.worst;
        assert!(((mass / target - 1.0).abs() - solution.residual).abs() <= 1e-15 && *target == 1.0 / 150.0);
        let Some(Cause::Rounding { sites: [a, b], distance: away, change }) = cause else {
            panic!("{}", solution.worst)
        };
        let group = |site: usize| if site < 5 { 0 } else { site / 2 };
        assert!(a != b && group(*a) == group(*b) && (*a < 5 || (10..20).contains(a)), "{}", solution.worst);
        assert!(*away <= 4.0 * distance && *change > 0.0, "{}", solution.worst);
        // What is left is in proportion to what rounding is of the distance.
        assert!(solution.residual <= 1e-16 / distance * 10.0, "{distance}: {:e}", solution.residual);
    }
}

/// The cells that lack mass, and which others do not reach, are named.
#[test]
fn the_worst_cell_is_named() {
    let sites = white(300, [0.0; 3], [1.0; 3], 19);
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let solution = solve(&cpu(), &mut diagram, &[], &Options::default().until(1, 1e-9), &mut |_| Continue(())).unwrap();
    let worst = &solution.worst;
    assert_eq!((worst.mass, worst.position, &worst.cause), (solution.masses[worst.site], sites[worst.site], &None));
    assert!(((worst.mass * 300.0 - 1.0).abs() - solution.residual).abs() < 1e-12);
    let line =
        format!("site {} at {:?} has the mass {:?}, not {:?}", worst.site, worst.position, worst.mass, worst.target);
    assert_eq!(worst.to_string(), line);
}

#[test]
fn without_enough_steps_the_best_is_returned() {
    let sites = white(300, [0.0; 3], [1.0; 3], 19);
    let mut diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let run = |diagram: &mut PowerDiagram, options: &Options| {
        solve(&cpu(), diagram, &[], options, &mut |_| Continue(())).unwrap()
    };
    let short = run(&mut diagram, &Options::default().with_facets().until(2, 1e-9));
    assert_eq!((short.end, short.iterations.len()), (End::MostIterations, 3));
    assert!(short.residual > 1e-9 && short.output.facets().is_some());
    // No rounding is as small as that.
    let deep = run(&mut diagram, &Options::default().with_facets().until(100, 1e-17));
    assert_eq!(deep.end, End::Stalled);
    assert!(deep.residual < 1e-11, "{:e}", deep.residual);
    assert!(deep.output.facets().is_some() && deep.cost.is_some());
}
