//! What stays in a device's memory: its linear algebra is the plain one, a Laplacian that it keeps is the one that it would give, transport that is solved
//! there finds what the host finds, and sites that stay there move as those do that come back. `LAGUERRE_REQUIRE=ocl` makes a missing device a failure.
#![cfg(all(feature = "cpu", feature = "ocl"))]

mod sites;

use std::collections::BTreeMap;
use std::ops::ControlFlow::Continue;

use laguerre::algebra::{CELL, Coarsening, Coarser, Smoothed, Smoothing, part, rise};
use laguerre::solvers::density::Density;
use laguerre::solvers::fluid::{Fluid, Scene, State, lattice};
use laguerre::solvers::transport::{Cotangent, End, Options, Solution, pull_back_kept_from, solve};
use laguerre::{Backend, Container, DeviceChoice, Domain, ErrorKind, PowerDiagram, Precision, Request, Selection};
use laguerre_conformance::sites::Random;
use laguerre_core::required::if_available;
use laguerre_core::rows::Rows;
use laguerre_core::shapes::torus;

fn device() -> Option<Box<dyn Backend>> {
    let selection = Selection::Ocl { devices: DeviceChoice::First, precision: Precision::F64 };
    if_available("ocl", laguerre::open(selection))
}

fn white(sites: usize, domain: &Domain) -> PowerDiagram {
    let mut random = Random::new(5);
    let (lo, hi) = domain.bounding_box();
    let mut at = |k: usize| lo[k] + random.unit() * (hi[k] - lo[k]);
    let positions: Vec<[f64; 3]> = (0..sites).map(|_| [at(0), at(1), at(2)]).collect();
    let weights: Vec<f64> = (0..sites).map(|i| (i % 7) as f64 / 1024.0).collect();
    PowerDiagram::new(&positions, &weights).unwrap().restricted_to(domain)
}

fn numbers(count: usize, random: &mut Random) -> Vec<f64> {
    (0..count).map(|_| random.unit() - 0.5).collect()
}

fn assert_near(found: &[f64], right: &[f64]) {
    assert_eq!(found.len(), right.len());
    for (i, (a, b)) in found.iter().zip(right).enumerate() {
        assert!((a - b).abs() <= 1e-13 * (1.0 + b.abs()), "{i}: {a} is not {b}");
    }
}

#[test]
fn a_device_computes_what_plain_loops_do() {
    let Some(backend) = device() else { return };
    let algebra = backend.algebra().unwrap();
    let mut random = Random::new(3);
    // More rows than a group adds up, some of them empty.
    let (n, m) = (9_001, 37);
    let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for i in 0..n {
        for k in 0..i % 7 {
            columns.push(((11 * i + 5 * k) % m) as u32);
            values.push(random.unit() - 0.5);
        }
        offsets.push(columns.len());
    }
    let (x, y) = (numbers(n, &mut random), numbers(n, &mut random));
    let short = numbers(m, &mut random);
    let product: Vec<f64> =
        (0..n).map(|i| (offsets[i]..offsets[i + 1]).map(|k| values[k] * short[columns[k] as usize]).sum()).collect();
    let rows = (offsets, columns, values);
    let matrix = algebra.matrix(rows.clone()).unwrap();
    assert_eq!(algebra.rows(&matrix).unwrap(), rows);
    let held = |x: &[f64]| algebra.vector(x).unwrap();
    let mut out = held(&y);
    assert_eq!(algebra.read(&algebra.zeros(n).unwrap()).unwrap(), vec![0.0; n]);
    algebra.multiply(&matrix, &held(&short), &mut out).unwrap();
    assert_near(&algebra.read(&out).unwrap(), &product);
    // Of three numbers a row, each of them.
    let three = numbers(3 * m, &mut random);
    let mut all = held(&numbers(3 * n, &mut random));
    algebra.multiply(&matrix, &held(&three), &mut all).unwrap();
    let all = algebra.read(&all).unwrap();
    for k in 0..3 {
        let every_third = |x: &[f64]| -> Vec<f64> { x.iter().skip(k).step_by(3).copied().collect() };
        algebra.multiply(&matrix, &held(&every_third(&three)), &mut out).unwrap();
        assert_eq!(every_third(&all), algebra.read(&out).unwrap());
    }
    algebra.write(&y, &mut out).unwrap();
    algebra.subtract(&matrix, &held(&short), &mut out).unwrap();
    let less: Vec<f64> = y.iter().zip(&product).map(|(y, ax)| y - ax).collect();
    assert_near(&algebra.read(&out).unwrap(), &less);
    algebra.write(&y, &mut out).unwrap();
    algebra.combine(0.3, &held(&x), -2.0, &mut out).unwrap();
    let sum: Vec<f64> = (0..n).map(|i| 0.3 * x[i] - 2.0 * y[i]).collect();
    assert_near(&algebra.read(&out).unwrap(), &sum);
    // Whatever is there counts for nothing times zero.
    algebra.write(&vec![f64::NAN; n], &mut out).unwrap();
    algebra.combine_scaled(2.0, &held(&x), &held(&y), 0.0, &mut out).unwrap();
    let scaled: Vec<f64> = (0..n).map(|i| 2.0 * x[i] * y[i]).collect();
    assert_near(&algebra.read(&out).unwrap(), &scaled);
    // A step of a smoother is what it is made of, to the last bit, whatever x is where it begins.
    for (before, beta) in [(Smoothed::WithLast, 0.7), (Smoothed::WithoutLast, 0.0), (Smoothed::Nothing, 0.7)] {
        let [d, s] = [&x, &y].map(|values| held(values));
        let (alpha, solution) = (0.3, numbers(n, &mut random));
        let (mut r, mut t, mut z) = (held(&y), held(&vec![f64::NAN; n]), held(&solution));
        let how = Smoothing { matrix: &matrix, inverse_diagonal: &d, last: &s, alpha, beta, before };
        algebra.smooth(how, &mut r, &mut t, &mut z).unwrap();
        let (mut left, mut step) = (held(&y), held(&y));
        algebra.subtract(&matrix, &s, &mut left).unwrap();
        algebra.combine_scaled(alpha, &d, &left, beta, &mut step).unwrap();
        let mut there = held(&if before == Smoothed::Nothing { vec![0.0; n] } else { solution });
        if before != Smoothed::WithLast {
            algebra.combine(1.0, &s, 1.0, &mut there).unwrap();
        }
        algebra.combine(1.0, &step, 1.0, &mut there).unwrap();
        for (found, made) in [(r, left), (t, step), (z, there)] {
            assert_eq!(algebra.read(&found).unwrap(), algebra.read(&made).unwrap());
        }
    }
    let dot: f64 = x.iter().zip(&y).map(|(x, y)| x * y).sum();
    let found = algebra.dot(&held(&x), &held(&y)).unwrap();
    assert!((found - dot).abs() <= 1e-12 * n as f64);
    assert_eq!(found.to_bits(), algebra.dot(&held(&x), &held(&y)).unwrap().to_bits());
    algebra.write(&x, &mut out).unwrap();
    let square = algebra.center(&mut out).unwrap();
    assert_eq!(square.to_bits(), algebra.dot(&out, &out).unwrap().to_bits());
    let mean = x.iter().sum::<f64>() / n as f64;
    let centered = algebra.read(&out).unwrap();
    assert_near(&centered, &x.iter().map(|x| x - mean).collect::<Vec<_>>());
    assert_eq!(algebra.center(&mut out).unwrap().to_bits(), square.to_bits());
    assert_eq!(algebra.read(&out).unwrap(), centered);
    assert!(algebra.is_within(&held(&[1.0, -2.0, 3.0]), 2.0, &held(&[0.5, 1.0, 1.5])).unwrap());
    assert!(!algebra.is_within(&held(&[1.0, -2.1, 3.0]), 2.0, &held(&[0.5, 1.0, 1.5])).unwrap());
    assert!(!algebra.is_within(&held(&[f64::NAN]), 2.0, &held(&[1.0])).unwrap());
    // A matrix is no vector, and what does not fit is refused.
    assert!(algebra.read(&matrix).is_err());
    assert!(algebra.multiply(&matrix, &held(&short[1..]), &mut out).is_err());
    assert!(algebra.multiply(&matrix, &held(&short), &mut held(&y[1..])).is_err());
    assert!(algebra.combine(1.0, &held(&short), 1.0, &mut out).is_err() && algebra.write(&short, &mut out).is_err());
    assert!(
        algebra.dot(&held(&short), &held(&x)).is_err() && algebra.is_within(&held(&x), 1.0, &held(&short)).is_err()
    );
    assert!(algebra.multiply(&matrix, &held(&three[1..]), &mut held(&vec![0.0; 3 * n])).is_err());
    assert!(algebra.rises_too_far(&matrix, &held(&x), &held(&short), 1.0, 1.0).is_err());
    assert!(algebra.stiffened(&matrix, &held(&x), &held(&short), 1.0, 1.0).is_err());
    assert!(algebra.parted(&matrix, &held(&short), 1.0).is_err());
    assert!(algebra.matrix((vec![], vec![], vec![])).is_err());
    assert!(algebra.matrix((vec![0, 2], vec![1], vec![1.0])).is_err());
}

/// Entries of a row, sorted.
fn row((offsets, columns, values): &Rows, i: usize) -> BTreeMap<u32, f64> {
    let range = offsets[i]..offsets[i + 1];
    columns[range.clone()].iter().copied().zip(values[range].iter().copied()).collect()
}

fn product(a: &Rows, b: &Rows) -> Vec<BTreeMap<u32, f64>> {
    let mut rows = Vec::new();
    for i in 0..a.0.len() - 1 {
        let mut sums = BTreeMap::new();
        for (middle, x) in row(a, i) {
            row(b, middle as usize).into_iter().for_each(|(j, y)| *sums.entry(j).or_insert(0.0) += x * y);
        }
        rows.push(sums);
    }
    rows
}

#[test]
fn coarser_levels_of_a_device_are_smoothed_aggregates_of_their_matrix() {
    let Some(backend) = device() else { return };
    let algebra = backend.algebra().unwrap();
    // The graph of a lattice with long ties, of which some are weak, and last an unknown that is tied to none.
    let mut random = Random::new(7);
    let n = 4_001;
    let mut ties = vec![BTreeMap::new(); n];
    for i in 0..n - 1 {
        for step in [1, 2, 17, 289] {
            let j = (i + step) % (n - 1);
            let tie = if random.unit() < 0.1 { 1e-9 } else { 0.5 + random.unit() };
            ties[i].insert(j as u32, -tie);
            ties[j].insert(i as u32, -tie);
        }
    }
    let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for (i, ties) in ties.iter().enumerate() {
        columns.push(i as u32);
        values.push(-ties.values().sum::<f64>());
        columns.extend(ties.keys());
        values.extend(ties.values());
        offsets.push(columns.len());
    }
    let rows = (offsets, columns, values);
    let a = algebra.matrix(rows.clone()).unwrap();
    let inverse = algebra.inverse_diagonal(&a).unwrap();
    let how = Coarsening { strong: 0.02, omega: 0.6 };
    let made = || algebra.coarser(&a, &inverse, how).unwrap().unwrap();
    let Coarser { prolongation, restriction, matrix } = made();
    let (p, r, coarse) =
        (algebra.rows(&prolongation).unwrap(), algebra.rows(&restriction).unwrap(), algebra.rows(&matrix).unwrap());
    let again = made();
    assert_eq!(coarse, algebra.rows(&again.matrix).unwrap(), "not the same bits twice");
    let m = algebra.row_count(&matrix).unwrap();
    assert!(m == r.0.len() - 1 && (n / 40..n / 3).contains(&m), "{m} aggregates");
    // Constants are among what is interpolated, but at an unknown that is tied to none.
    for i in 0..n - 1 {
        let sum: f64 = row(&p, i).values().sum();
        assert!((sum - 1.0).abs() < 1e-14, "{i}: {sum}");
    }
    assert!(row(&p, n - 1).is_empty());
    for i in 0..m {
        let (begin, end) = (r.0[i], r.0[i + 1]);
        assert!(begin < end && r.1[begin..end].is_sorted(), "{i}");
        assert!(row(&r, i).into_iter().all(|(j, value)| row(&p, j as usize)[&(i as u32)] == value), "{i}");
    }
    assert_eq!(p.1.len(), r.1.len());
    let half = product(&rows, &p);
    for i in 0..m {
        let mut right = BTreeMap::new();
        for (middle, x) in row(&r, i) {
            half[middle as usize].iter().for_each(|(&j, y)| *right.entry(j).or_insert(0.0) += x * y);
        }
        let found = row(&coarse, i);
        assert!(found.keys().eq(right.keys()), "{i}");
        assert!(found.iter().all(|(j, value)| (value - right[j]).abs() < 1e-12), "{i}: {found:?} {right:?}");
        assert!(found.values().sum::<f64>().abs() < 1e-13, "{i}");
    }
}

#[test]
fn a_laplacian_that_is_kept_is_the_one_that_comes_back() {
    let Some(backend) = device() else { return };
    let algebra = backend.algebra().unwrap();
    let diagram = white(3_000, &torus(1.0, 0.4, 24, 12).domain());
    let given = backend.evaluate(&diagram, &Request::moments().with_laplacian()).unwrap();
    let output = backend.evaluate(&diagram, &Request::moments().with_laplacian_kept()).unwrap();
    let (laplacian, kept) = (given.laplacian().unwrap(), output.kept().unwrap());
    assert_eq!(algebra.read_laplacian(kept).unwrap().as_ref(), Some(laplacian));
    assert!(output.laplacian().is_none() && kept.order() == laplacian.order() && output.volume() == given.volume());
    let matrix = algebra.laplacian(kept, 0.25).unwrap().unwrap();
    let (offsets, columns, values) = algebra.rows(&matrix).unwrap();
    for row in 0..kept.order().len() {
        let (begin, entries) = (offsets[row], laplacian.row(row));
        assert_eq!(columns[begin] as usize, row);
        assert_eq!(columns[begin + 1..offsets[row + 1]], laplacian.columns()[entries.clone()]);
        let ties: Vec<f64> = laplacian.values()[entries].iter().map(|a| 0.25 * a).collect();
        assert!(values[begin + 1..offsets[row + 1]].iter().zip(&ties).all(|(value, tie)| *value == -tie));
        assert_eq!(values[begin], ties.iter().sum::<f64>());
    }
    let inverse = algebra.read(&algebra.inverse_diagonal(&matrix).unwrap()).unwrap();
    assert!(
        (0..inverse.len()).all(|i| inverse[i] == if values[offsets[i]] > 0.0 { 1.0 / values[offsets[i]] } else { 0.0 })
    );
    // The cells are those of the output.
    let density = 0.3;
    let cells = algebra.read(&algebra.cells(kept, density).unwrap().unwrap()).unwrap();
    let (sites, barycenters) = (diagram.positions(), output.barycenter());
    let shift: [f64; 3] = std::array::from_fn(|k| sites[kept.order()[0] as usize][k] - cells[k]);
    for (cell, &i) in cells.chunks(CELL).zip(kept.order()) {
        let i = i as usize;
        let places =
            (0..3).flat_map(|k| [cell[k] + shift[k] - sites[i][k], cell[4 + k] + shift[k] - barycenters[i][k]]);
        let is_there = output.volume()[i] > 0.0;
        assert!(
            places.enumerate().all(|(at, off)| off.abs() < 1e-14 || (at % 2 == 1 && !is_there && off.is_nan())),
            "{i}"
        );
        assert!((cell[7].powi(3) * density - output.volume()[i]).abs() < 1e-15 && cell[3] == diagram.weights()[i]);
    }
    // How far each site may rise above its neighbours: to the limit, and no farther.
    let mut random = Random::new(8);
    let mut cells = numbers(CELL * kept.order().len(), &mut random);
    cells.iter_mut().skip(CELL - 1).step_by(CELL).for_each(|size| *size = size.abs());
    let cell = |row: usize| &cells[CELL * row..][..CELL];
    let row = (0..kept.order().len()).find(|&row| !laplacian.row(row).is_empty()).unwrap();
    let limit = |k: usize| rise(cell(row), cell(laplacian.columns()[k] as usize), 0.7, 0.1);
    let least = laplacian.row(row).map(limit).fold(f64::INFINITY, f64::min);
    let rises = |by: f64| {
        let mut x = vec![0.0; kept.order().len()];
        x[row] = by;
        let (x, cells) = (algebra.vector(&x).unwrap(), algebra.vector(&cells).unwrap());
        algebra.rises_too_far(&matrix, &x, &cells, 0.7, 0.1).unwrap()
    };
    assert!(least > 0.0 && !rises(least * (1.0 - 1e-12)) && rises(least * (1.0 + 1e-12)), "{least}");
    // What rises too far is larger by as much, in both rows, which sum to 0.
    let x: Vec<f64> = (0..kept.order().len()).map(|i| if i == row { 3.0 * least } else { 0.0 }).collect();
    let stiffened = |x: &[f64]| {
        let (x, cells) = (algebra.vector(x).unwrap(), algebra.vector(&cells).unwrap());
        algebra.rows(&algebra.stiffened(&matrix, &x, &cells, 0.7, 0.1).unwrap()).unwrap()
    };
    let (_, _, within) = stiffened(&x.iter().map(|x| x / 4.0).collect::<Vec<_>>());
    assert!((0..values.len()).all(|k| (within[k] - values[k]).abs() <= 1e-14 * values[k].abs()));
    let (stiff_offsets, stiff_columns, stiff) = stiffened(&x);
    assert!(stiff_offsets == offsets && stiff_columns == columns);
    let mut larger = 0;
    for i in 0..kept.order().len() {
        let entries = offsets[i]..offsets[i + 1];
        let others = || entries.clone().skip(1);
        for k in others() {
            let j = columns[k] as usize;
            let other = if i == row { j } else { i };
            let factor = match i == row || j == row {
                true => (3.0 * least / rise(cell(row), cell(other), 0.7, 0.1)).max(1.0),
                false => 1.0,
            };
            larger += usize::from(factor > 1.0);
            assert!((stiff[k] - factor * values[k]).abs() <= 1e-14 * stiff[k].abs(), "{i}, {j}");
        }
        assert_eq!(stiff[entries.start], -others().map(|k| stiff[k]).sum::<f64>());
    }
    assert!(larger >= 2 && larger % 2 == 0, "{larger}");
    // What weights change by for barycenters to be in their cells.
    let changes = algebra.parted(&matrix, &algebra.vector(&cells).unwrap(), 0.1).unwrap();
    let right = |row: usize| -> f64 {
        let ties = laplacian.row(row).filter(|&k| laplacian.values()[k] > 0.0);
        ties.map(|k| part(cell(row), cell(laplacian.columns()[k] as usize), 0.1)).sum()
    };
    let changes = algebra.read(&changes).unwrap();
    assert!(changes.iter().any(|change| *change != 0.0));
    for (row, change) in changes.into_iter().enumerate() {
        assert!((change - right(row)).abs() <= 1e-13 * (1.0 + change.abs()), "{row}: {change}");
    }
    // Another takes its place.
    backend.evaluate(&diagram, &Request::moments().with_laplacian_kept()).unwrap();
    assert!(algebra.laplacian(kept, 1.0).unwrap().is_none() && algebra.cells(kept, 1.0).unwrap().is_none());
}

#[test]
fn transport_on_a_device_is_that_of_the_host() {
    let Some(backend) = device() else { return };
    let host = laguerre::open(Selection::Cpu { threads: None }).unwrap();
    let start = white(2_000, &torus(1.0, 0.4, 24, 12).domain());
    let run = |backend: &dyn Backend| -> Solution {
        let mut options = Options::default();
        options.kept_from = Some(0);
        options.laplacian = true;
        let mut diagram = start.clone();
        let found = solve(backend, &mut diagram, &[], &options, &mut |_| Continue(())).unwrap();
        let again = backend.evaluate(&diagram, &Request::moments().with_laplacian()).unwrap();
        assert_eq!(found.output.laplacian(), again.laplacian());
        assert_eq!(found.end, End::Converged, "{:?}", found.iterations);
        found
    };
    let (here, there) = (run(&*host), run(&*backend));
    let largest = here.weights.iter().map(|w| w.abs()).fold(0.0, f64::max);
    assert!(here.weights.iter().zip(&there.weights).all(|(a, b)| (a - b).abs() <= 1e-7 * largest));
    assert_eq!(there.weights, run(&*backend).weights);
    assert!(there.iterations.len() <= here.iterations.len() + 1);
}

#[test]
fn derivatives_through_the_solve_are_those_of_the_host() {
    let Some(backend) = device() else { return };
    let host = laguerre::open(Selection::Cpu { threads: None }).unwrap();
    let mut diagram = white(1_000, &torus(1.0, 0.4, 24, 12).domain());
    solve(&*host, &mut diagram, &[], &Options::default(), &mut |_| Continue(())).unwrap();
    let n = diagram.positions().len();
    let weights = (0..n).map(|i| (i as f64 * 0.618).fract() - 0.5).collect();
    let cotangent = Cotangent { weights, ..Cotangent::default() };
    let run =
        |backend: &dyn Backend| pull_back_kept_from(Some(0), backend, &diagram, &Density::Uniform, &cotangent).unwrap();
    let (here, there) = (run(&*host), run(&*backend));
    let largest = here.masses.iter().map(|x| x.abs()).fold(0.0, f64::max);
    assert!(here.masses.iter().zip(&there.masses).all(|(a, b)| (a - b).abs() <= 1e-8 * largest));
    let numbers = |all: &[[f64; 3]]| all.iter().flatten().copied().collect::<Vec<f64>>();
    let (ours, theirs) = (numbers(&here.positions), numbers(&there.positions));
    let largest = ours.iter().map(|x| x.abs()).fold(0.0, f64::max);
    assert!(ours.iter().zip(&theirs).all(|(a, b)| (a - b).abs() <= 1e-8 * largest));
    assert_eq!(there, run(&*backend));
}

#[test]
fn a_fluid_on_a_device_is_that_of_the_host() {
    let Some(backend) = device() else { return };
    let host = laguerre::open(Selection::Cpu { threads: None }).unwrap();
    // As many particles as linear systems stay on a device for.
    let (lo, hi, side) = ([0.0; 3], [1.0; 3], 32_usize);
    let densities: Vec<f64> = (0..side.pow(3)).map(|n| if n % 2 == 0 { 1.0 } else { 1.5 }).collect();
    let scene = Scene::Beltrami;
    let mut settings = scene.settings(&densities, lo, hi, 1.0 / side as f64, None);
    settings.viscosity = 1e-2;
    let start = || scene.start(&lattice(hi, side.pow(3)), densities.clone(), &settings);
    let container = Container::Box(lo, hi);
    let begun = |backend: &dyn Backend| Fluid::new(backend, &container, start(), settings).unwrap();
    let (mut here, mut there) = (begun(&*host), begun(&*backend));
    here.step(&*host).unwrap();
    there.step(&*backend).unwrap();
    let assert_same = |here: &Fluid, there: &Fluid, bound: f64| {
        let all = |fluid: &Fluid| -> Vec<f64> {
            let State { positions, velocities, weights, .. } = fluid.state();
            positions.iter().chain(velocities).flatten().chain(weights).copied().collect()
        };
        let (ours, theirs) = (all(here), all(there));
        let off = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= bound, "off by {off:e}");
    };
    assert_same(&here, &there, 1e-7);
    // It goes on from its state to the same bits; and with other devices, or the host, which do not have what the first has left.
    let mut again = Fluid::resume(&*backend, &container, there.state().clone(), settings).unwrap();
    let (mut elsewhere, mut of_host) = (there.clone(), there.clone());
    there.step(&*backend).unwrap();
    again.step(&*backend).unwrap();
    assert_eq!(again.state(), there.state());
    elsewhere.step(&*device().unwrap()).unwrap();
    assert_same(&elsewhere, &there, 1e-9);
    of_host.step(&*host).unwrap();
    assert_same(&of_host, &there, 1e-7);
}

#[test]
fn what_is_with_other_devices_is_refused() {
    let (Some(backend), Some(other)) = (device(), device()) else { return };
    let (algebra, other) = (backend.algebra().unwrap(), other.algebra().unwrap());
    let (mut x, y) = (algebra.vector(&[1.0, 2.0]).unwrap(), other.vector(&[3.0, 4.0]).unwrap());
    for error in [other.read(&x).err(), algebra.dot(&x, &y).err(), other.write(&[0.0; 2], &mut x).err()] {
        assert!(error.is_some_and(|error| error.kind() == ErrorKind::Device));
    }
    assert_eq!(algebra.read(&x).unwrap(), [1.0, 2.0]);
}
