//! What single precision is worth: against double precision on the CPU, the same statuses, and volumes within their bound. And what cells
//! far from heavy sites are worth on a device in double precision. `LAGUERRE_REQUIRE=ocl` makes a missing device a failure.
#![cfg(all(feature = "cpu", feature = "ocl"))]

use laguerre::{
    Backend, CellStatus, DeviceChoice, Domain, Error, ErrorKind, Integrand, Output, PowerDiagram, Precision, Request,
    Selection,
};
use laguerre_conformance::bounds::{CELL, NOTHING};
use laguerre_conformance::case::Case;
use laguerre_conformance::domains::{Pose, Shape};
use laguerre_conformance::sites::{Random, Sites};
use laguerre_conformance::weights::Weights;
use laguerre_core::required::if_available;
use laguerre_core::shapes::{icosphere, torus};

/// What a volume may be off, in units of itself: `SHARE_OF_VOLUME` of `rough.cl`.
const SHARE: f64 = 1.0 / 1024.0;

/// The same in units of the mean for cells of about one size: their bound is some hundred roundings, and that is some 1e-6; measured 2e-6.
const OF_MEAN: f64 = 1e-5;

fn open(precision: Precision) -> Option<Box<dyn Backend>> {
    if_available("ocl", laguerre::open(Selection::Ocl { devices: DeviceChoice::First, precision }))
}

fn evaluate(backend: &dyn Backend, diagram: &PowerDiagram) -> Output {
    backend.evaluate(diagram, &Request::moments()).unwrap()
}

/// On the CPU, in double precision.
fn exact(diagram: &PowerDiagram) -> Output {
    evaluate(&*laguerre::open(Selection::Cpu { threads: None }).unwrap(), diagram)
}

/// Single precision by the kernel of its own, and as the first stage of those that share a cell.
fn singles() -> Vec<Box<dyn Backend>> {
    let sharing = || if_available("ocl", laguerre::open_sharing_cells(Precision::F32));
    open(Precision::F32).into_iter().chain(sharing()).collect()
}

/// Compares single precision with double; returns the largest error of a volume in units of the mean, and the share of cells that the host
/// computed.
fn compare(name: &str, diagram: &PowerDiagram) -> Option<(f64, f64)> {
    let compared = singles().iter().map(|single| compare_with(&**single, name, diagram)).collect::<Vec<_>>();
    compared.into_iter().reduce(|(worst, share), (off, of_host)| (worst.max(off), share.max(of_host)))
}

fn compare_with(single: &dyn Backend, name: &str, diagram: &PowerDiagram) -> (f64, f64) {
    let kind = single.info().backend;
    assert_eq!(single.info().precision, Precision::F32);
    let (found, wanted) = (evaluate(single, diagram), exact(diagram));
    assert_eq!(found.status(), wanted.status(), "{name}");
    let count = wanted.count(CellStatus::Complete) as f64;
    let mean = wanted.volume().iter().sum::<f64>() / count;
    let mut worst = 0.0_f64;
    for (i, (a, b)) in found.volume().iter().zip(wanted.volume()).enumerate() {
        assert!((a - b).abs() <= SHARE * b.abs(), "{name}: the volume of cell {i} is {a}, not {b}");
        worst = worst.max((a - b).abs() / mean);
    }
    let off = (found.volume().iter().sum::<f64>() - wanted.volume().iter().sum::<f64>()).abs() / (count * mean);
    assert!(off <= OF_MEAN, "{name}: the sum is off by {off:e}");
    let size = mean.cbrt();
    for (i, (a, b)) in found.barycenter().iter().zip(wanted.barycenter()).enumerate() {
        let near = (0..3).all(|k| (a[k].is_nan() && b[k].is_nan()) || (a[k] - b[k]).abs() <= SHARE * size);
        assert!(near, "{name}: the barycenter of cell {i} is {a:?}, not {b:?}");
    }
    let share = found.report().host_cells as f64 / found.status().len() as f64;
    println!(
        "{name} ({kind}): off by {worst:.1e} of the mean volume, the sum by {off:.1e}; {share:.3} of the cells on the host"
    );
    (worst, share)
}

fn white(count: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    (0..count).map(|_| random.point().into()).collect()
}

fn in_cube(positions: &[[f64; 3]], weights: &[f64]) -> PowerDiagram {
    PowerDiagram::new(positions, weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap()
}

fn in_domain(positions: &[[f64; 3]], domain: &Domain) -> PowerDiagram {
    PowerDiagram::new(positions, &[]).unwrap().restricted_to(domain)
}

/// Weights up to `largest`.
fn weights(count: usize, largest: f64) -> Vec<f64> {
    let mut random = Random::new(7);
    (0..count).map(|_| largest * random.unit()).collect()
}

/// Asserts that volumes of about one size are good, and that the host had at most `most` of the cells.
fn assert_good(name: &str, diagram: &PowerDiagram, most: f64) {
    if let Some((worst, share)) = compare(name, diagram) {
        assert!(worst <= OF_MEAN, "{name}: a volume is off by {worst:e} of the mean");
        assert!(share <= most, "{name}: {share} of the cells are the host's");
    }
}

#[test]
fn white_sites() {
    assert_good("white", &in_cube(&white(10_000, 1), &[]), 0.001);
    let far: Vec<[f64; 3]> = white(2000, 2).iter().map(|p| p.map(|x| 1e9 + 1e3 * x)).collect();
    let diagram = PowerDiagram::new(&far, &[]).unwrap().in_box([1e9; 3], [1e9 + 1e3; 3]).unwrap();
    assert_good("white, far from the origin", &diagram, 0.001);
}

/// Cells that are computed together are so in single precision: nearly all volumes are single numbers.
#[test]
fn volumes_are_single_numbers() {
    let sharing = laguerre::open_sharing_cells(Precision::F32);
    let Some(single) = if_available("ocl", sharing) else { return };
    let volumes = evaluate(&*single, &in_cube(&white(10_000, 1), &[])).into_arrays().volume;
    let are_single = volumes.iter().filter(|&&v| f64::from(v as f32) == v).count();
    assert!(are_single > 9500, "{are_single}");
}

/// Most signs are zero, and decided on the device.
#[test]
fn symmetric_sites() {
    let at = |i: usize| (i as f64 + 0.5) / 20.0;
    let lattice: Vec<[f64; 3]> = (0..8000).map(|i| [at(i % 20), at(i / 20 % 20), at(i / 400)]).collect();
    assert_good("lattice", &in_cube(&lattice, &[]), 0.001);
    let mirrored: Vec<[f64; 3]> = white(1000, 3)
        .iter()
        .flat_map(|p| {
            (0..8).map(|m| std::array::from_fn(|k| if m >> k & 1 == 0 { 0.5 * p[k] } else { 1.0 - 0.5 * p[k] }))
        })
        .collect();
    assert_good("mirrored", &in_cube(&mirrored, &[]), 0.01);
}

#[test]
fn weighted_sites() {
    let positions = white(5000, 4);
    assert_good("mild weights", &in_cube(&positions, &weights(5000, 1e-4)), 0.001);
    let _ = compare("weights that empty half of the cells", &in_cube(&positions, &weights(5000, 1e-2)));
    let _ = compare("weights that empty nearly all cells", &in_cube(&positions, &weights(5000, 1.0)));
}

#[test]
fn coincident_and_clustered_sites() {
    let mut positions = white(1000, 5);
    positions.extend_from_within(..);
    // As near as no difference of single numbers could tell.
    positions.extend(white(200, 5).iter().map(|p| p.map(|x| x * (1.0 + 1e-13))));
    let _ = compare("coincident", &in_cube(&positions, &[]));
    let mut positions = white(1000, 6);
    positions.extend(white(1000, 8).iter().map(|p| p.map(|x| 0.3 + 1e-4 * x)));
    let _ = compare("clustered", &in_cube(&positions, &[]));
    let _ = compare("one", &in_cube(&[[0.1, 0.2, 0.3]], &[]));
}

/// Interior cells are the device's, cells at the surface the host's, and cells outside are known to be empty.
#[test]
fn domains() {
    for (name, mesh) in [("sphere", icosphere(4)), ("torus", torus(1.0, 0.4, 60, 30))] {
        let positions: Vec<[f64; 3]> = white(10_000, 9).iter().map(|p| p.map(|x| 3.2 * x - 1.6)).collect();
        assert_good(name, &in_domain(&positions, &mesh.domain()), 0.4);
    }
}

/// A site many million spacings away empties the cells of sites that crowd about a place: its power, squared, is beyond single numbers.
#[test]
fn a_site_far_from_a_crowd() {
    let tiny = 1.0 / f64::from(1 << 22);
    let mut positions: Vec<[f64; 3]> = white(16, 11).iter().map(|p| p.map(|x| 0.5 + tiny * (x - 0.5))).collect();
    positions.push([-10.0, 0.5, 0.5]);
    let heavy_far: Vec<f64> = (0..17).map(|i| if i < 16 { 0.01 } else { 200.0 }).collect();
    let heavy_near: Vec<f64> = (0..17).map(|i| if i < 16 { 0.01 } else { 0.0 }).collect();
    let _ = compare("a heavy site far from a crowd", &in_cube(&positions, &heavy_far));
    let _ = compare("a light site far from a crowd", &in_cube(&positions, &heavy_near));
    positions[16] = [0.75, 0.5, 0.5];
    let _ = compare("a site some spacings from a crowd", &in_cube(&positions, &heavy_near));
}

/// Whatever the arrangement of sites and weights, in a box and in a domain: the same statuses, but of cells that may be called nothing, and volumes within their bound.
#[test]
fn every_arrangement() {
    singles().iter().for_each(|single| every_arrangement_of(&**single));
}

fn every_arrangement_of(single: &dyn Backend) {
    let double = laguerre::open(Selection::Cpu { threads: None }).unwrap();
    let (mut cells, mut of_host) = (0, 0);
    for (seed, (&sites, &weights)) in
        Sites::ALL.iter().flat_map(|sites| Weights::ALL.iter().map(move |weights| (sites, weights))).enumerate()
    {
        for shape in [Shape::Box, Shape::Torus] {
            let case = Case { seed: seed as u64, count: 300, sites, weights, shape, pose: Pose::Plain };
            let diagram = case.scene().diagram().unwrap();
            let (found, wanted) = (evaluate(single, &diagram), evaluate(&*double, &diagram));
            let mean = wanted.volume().iter().sum::<f64>() / 300.0;
            for (i, (a, b)) in found.volume().iter().zip(wanted.volume()).enumerate() {
                let (status, expected) = (found.status()[i], wanted.status()[i]);
                let is_nothing = a.abs().max(b.abs()) <= NOTHING * mean;
                assert!(status == expected || is_nothing, "{case:?}: cell {i} is {status:?}, not {expected:?}");
                let bound = SHARE * b.abs() + CELL * mean;
                assert!((a - b).abs() <= bound, "{case:?}: the volume of cell {i} is {a}, not {b}");
            }
            cells += found.status().len();
            of_host += found.report().host_cells;
        }
    }
    println!("{of_host} of {cells} cells on the host");
}

#[test]
fn facets_are_refused() {
    let Some(single) = open(Precision::F32) else { return };
    let diagram = in_cube(&white(10, 1), &[]);
    let integrand = Integrand::polynomial([0.0; 3], &[([1, 0, 0], 1.0)]).unwrap();
    let integral = Request::moments().with_integral(integrand);
    for request in [Request::moments().with_facets(), Request::moments().with_second_moments(), integral] {
        let error: Error = single.evaluate(&diagram, &request).unwrap_err();
        assert!(
            error.kind() == ErrorKind::Input && error.to_string().contains("volumes, barycenters and geometry only"),
            "{error}"
        );
    }
}

/// A few heavy sites cut cells that are five voxels of the grid away and more, where their own neighbours end the search after four: the
/// corners of the block of voxels that is searched first are farther than the nearest voxels beyond it.
#[test]
fn heavy_sites_reach_beyond_the_first_voxels() {
    let mut positions = white(1003, 10);
    let mut weights = vec![0.0; 1003];
    for (i, heavy) in [[0.3, 0.5, 0.93], [0.62, 0.81, 0.87], [0.35, 0.81, 0.85]].into_iter().enumerate() {
        (positions[i], weights[i]) = (heavy, 0.3);
    }
    let diagram = in_cube(&positions, &weights);
    let _ = compare("a few heavy", &diagram);
    let Some(double) = open(Precision::F64) else { return };
    let (found, wanted) = (evaluate(&*double, &diagram), exact(&diagram));
    assert_eq!(found.status(), wanted.status());
    for (i, (a, b)) in found.volume().iter().zip(wanted.volume()).enumerate() {
        assert!((a - b).abs() <= 1e-12 / 1003.0, "the volume of cell {i} is {a}, not {b}");
    }
}
