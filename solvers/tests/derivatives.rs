//! Derivatives against differences, and the laws that they obey.

use laguerre_core::{Backend, CellStatus, Output, PowerDiagram, shapes};
use laguerre_cpu::Cpu;
use laguerre_solvers::density::Density;
use laguerre_solvers::derivatives::{Derivatives, Rows};

const LINEAR: Density = Density::Linear { value: 2.0, gradient: [0.3, -0.5, 0.7] };

/// Differences are of steps h = 1e-5, about the cube root of the unit roundoff: what they leave out, h² times third derivatives, is about what
/// rounding adds, 1e-16/h, some 1e-10 of derivatives that are of size 1; near a corner of the surface third derivatives are a hundred times that.
const STEP: f64 = 1e-5;
const BOUND: f64 = 1e-7;

/// Sites with weights in the box of a torus that is not convex: some cells are in several pieces, some empty.
fn scene() -> (Vec<[f64; 3]>, Vec<f64>) {
    let fraction = |i: usize, step: f64| ((i * i) as f64 * step).fract();
    let point = |i: usize| [2_f64, 3.0, 5.0].map(|x| 2.0 * fraction(i, x.sqrt()) - 1.0);
    let positions = (1..=60).map(point).map(|[x, y, z]| [1.4 * x, 1.4 * y, 0.4 * z]).collect();
    (positions, (1..=60).map(|i| 0.1 * fraction(i, 7_f64.sqrt())).collect())
}

fn evaluate(positions: &[[f64; 3]], weights: &[f64], density: &Density) -> (PowerDiagram, Output) {
    let torus = shapes::torus(1.0, 0.4, 16, 8).domain();
    let diagram = PowerDiagram::new(positions, weights).unwrap().restricted_to(&torus);
    let output = Cpu::new(Some(2)).unwrap().evaluate(&diagram, &Derivatives::request(density)).unwrap();
    (diagram, output)
}

/// Holds the column of `site` of some rows to what the cells' `value` changes by when `moved` moves it.
fn hold<const M: usize, const N: usize>(
    rows: &Rows<N>,
    site: usize,
    block: impl Fn([f64; N]) -> [f64; M],
    value: impl Fn(&Output, usize) -> [f64; M],
    moved: impl Fn(f64) -> Output,
) {
    let (less, more) = (moved(-STEP), moved(STEP));
    for i in 0..less.status().len() {
        if [&less, &more].iter().any(|output| output.status()[i] == CellStatus::Empty) {
            continue;
        }
        let found = rows.row(i).find(|(j, _)| *j == site).map_or([0.0; M], |(_, found)| block(found));
        let (low, high) = (value(&less, i), value(&more, i));
        for k in 0..M {
            let wanted = (high[k] - low[k]) / (2.0 * STEP);
            let off = (found[k] - wanted).abs();
            assert!(off <= BOUND * (1.0 + wanted.abs()), "cell {i} by site {site}, {k}: {} is not {wanted}", found[k]);
        }
    }
}

#[test]
fn derivatives_are_what_differences_tend_to() {
    let (positions, weights) = scene();
    for density in [Density::Uniform, LINEAR] {
        let (diagram, output) = evaluate(&positions, &weights, &density);
        assert!(output.count(CellStatus::Empty) < 30);
        let all = Derivatives::new(&diagram, &output, &density).unwrap();
        let mass = |output: &Output, i: usize| [density.masses(output).unwrap()[i]];
        let center = |output: &Output, i: usize| density.centers(&diagram, output).unwrap()[i];
        let (by_weights, centers_by_weights) = (all.masses_by_weights(), all.barycenters_by_weights());
        let by_positions = all.masses_by_positions();
        for site in (0..positions.len()).step_by(7) {
            let heavier = |step: f64| {
                let mut weights = weights.clone();
                weights[site] += step;
                evaluate(&positions, &weights, &density).1
            };
            hold(&by_weights, site, |found| found, mass, heavier);
            hold(&centers_by_weights, site, |found| found, center, heavier);
            for axis in 0..3 {
                let moved = |step: f64| {
                    let mut positions = positions.clone();
                    positions[site][axis] += step;
                    evaluate(&positions, &weights, &density).1
                };
                hold(&by_positions, site, |found| [found[axis]], mass, moved);
                if let Ok(centers) = all.barycenters_by_positions() {
                    hold(&centers, site, |found| [0, 1, 2].map(|r| found[3 * r + axis]), center, moved);
                }
            }
        }
        assert_eq!(all.barycenters_by_positions().is_ok(), density == Density::Uniform);
    }
}

/// Pulling back is the product with the transposed matrices.
#[test]
fn what_is_pulled_back_is_what_the_transposed_matrices_make() {
    let (positions, weights) = scene();
    let n = positions.len();
    let fraction = |i: usize, step: f64| 2.0 * ((i * i) as f64 * step).fract() - 1.0;
    let u: Vec<f64> = (0..n).map(|i| fraction(i, 11_f64.sqrt())).collect();
    let v: Vec<[f64; 3]> = (0..n).map(|i| [13_f64, 17.0, 19.0].map(|x| fraction(i, x.sqrt()))).collect();
    for density in [Density::Uniform, LINEAR] {
        let (diagram, output) = evaluate(&positions, &weights, &density);
        let all = Derivatives::new(&diagram, &output, &density).unwrap();
        let (by_weights, centers_by_weights) = (all.masses_by_weights(), all.barycenters_by_weights());
        let by_positions = all.masses_by_positions();
        let centers_by_positions = all.barycenters_by_positions().ok();
        let (mut points, mut heights) = (vec![[0.0; 3]; n], vec![0.0; n]);
        for i in 0..n {
            by_weights.row(i).for_each(|(j, [x])| heights[j] += u[i] * x);
            centers_by_weights.row(i).for_each(|(j, x)| heights[j] += (0..3).map(|r| v[i][r] * x[r]).sum::<f64>());
            by_positions.row(i).for_each(|(j, x)| (0..3).for_each(|c| points[j][c] += u[i] * x[c]));
            for (j, x) in centers_by_positions.iter().flat_map(|rows| rows.row(i)) {
                (0..9).for_each(|k| points[j][k % 3] += v[i][k / 3] * x[k]);
            }
        }
        let found = match &centers_by_positions {
            Some(_) => all.pull_back(&u, &v).unwrap(),
            None => {
                assert!(all.pull_back(&u, &v).is_err());
                (all.pull_back(&u, &[]).unwrap().0, all.pull_back_to_weights(&u, &v).unwrap())
            }
        };
        for i in 0..n {
            let off = (found.1[i] - heights[i]).abs();
            assert!(off < 1e-11 * (1.0 + heights[i].abs()), "weight {i}: {} and {}", found.1[i], heights[i]);
            for (found, wanted) in found.0[i].iter().zip(points[i]) {
                assert!((found - wanted).abs() < 1e-11 * (1.0 + wanted.abs()), "site {i}: {found} and {wanted}");
            }
        }
        assert!(all.pull_back(&u[1..], &[]).is_err() && all.pull_back_to_weights(&u, &v[1..]).is_err());
    }
}

/// The mass of all is the domain's; a shift of all weights changes nothing; what one cell gains, the other loses.
#[test]
fn masses_are_conserved() {
    let (positions, weights) = scene();
    for density in [Density::Uniform, LINEAR] {
        let (diagram, output) = evaluate(&positions, &weights, &density);
        let all = Derivatives::new(&diagram, &output, &density).unwrap();
        let (by_weights, by_positions) = (all.masses_by_weights(), all.masses_by_positions());
        let mut columns = vec![[0.0; 4]; positions.len()];
        for i in 0..positions.len() {
            let sum: f64 = by_weights.row(i).map(|(_, [x])| x).sum();
            assert!(sum.abs() < 1e-13, "row {i} sums to {sum}");
            for (j, [x]) in by_weights.row(i) {
                columns[j][3] += x;
                let back = by_weights.row(j).find(|(k, _)| *k == i).unwrap().1[0];
                assert!((x - back).abs() < 1e-12, "{i}, {j}: {x} and {back}");
                assert!(if i == j { x > 0.0 } else { x < 0.0 });
            }
            by_positions.row(i).for_each(|(j, x)| (0..3).for_each(|k| columns[j][k] += x[k]));
        }
        assert!(columns.as_flattened().iter().all(|x| x.abs() < 1e-12), "{columns:?}");
    }
}

/// Sites that all move alike take their cells with them: masses change by what passes the boundary, and a cell that does not meet it moves as it is.
#[test]
fn translations_are_translations() {
    let at = |i: usize| (i as f64 + 0.5) / 4.0;
    let (noise, weights) = scene();
    let jittered = |i: usize| {
        let jitter = noise[i % 60].map(|x| 0.03 * x);
        [at(i % 4) + jitter[0], at(i / 4 % 4) + jitter[1], at(i / 16) + jitter[2]]
    };
    let positions: Vec<[f64; 3]> = (0..64).map(jittered).collect();
    let weights: Vec<f64> = (0..64).map(|i| 0.05 * weights[i % 60]).collect();
    let diagram = PowerDiagram::new(&positions, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let density = Density::Uniform;
    let output = Cpu::new(Some(2)).unwrap().evaluate(&diagram, &Derivatives::request(&density)).unwrap();
    let all = Derivatives::new(&diagram, &output, &density).unwrap();
    let (masses, barycenters) = (all.masses_by_positions(), all.barycenters_by_positions().unwrap());
    let mut inner = 0;
    for (i, boundary) in output.boundary().unwrap().iter().enumerate() {
        let mut sum = [0.0; 3];
        masses.row(i).for_each(|(_, x)| (0..3).for_each(|k| sum[k] += x[k]));
        assert!((0..3).all(|k| (sum[k] + boundary.vector_area[k]).abs() < 1e-13), "site {i}: {sum:?}, {boundary:?}");
        if boundary.area == 0.0 {
            inner += 1;
            let mut sum = [0.0; 9];
            barycenters.row(i).for_each(|(_, x)| (0..9).for_each(|k| sum[k] += x[k]));
            let identity = |k: usize| if k.is_multiple_of(4) { 1.0 } else { 0.0 };
            assert!((0..9).all(|k| (sum[k] - identity(k)).abs() < 1e-12), "site {i}: {sum:?}");
        }
    }
    assert_eq!(inner, 8);
}

#[test]
fn what_is_missing_is_said() {
    let (positions, weights) = scene();
    let (diagram, output) = evaluate(&positions, &weights, &Density::Uniform);
    let error = Derivatives::new(&diagram, &output, &LINEAR).unwrap_err();
    assert!(error.to_string().contains("request"), "{error}");
    let (other, _) = evaluate(&positions[1..], &weights[1..], &Density::Uniform);
    let error = Derivatives::new(&other, &output, &Density::Uniform).unwrap_err();
    assert!(error.to_string().contains("60 cells of 59 sites"), "{error}");
}
