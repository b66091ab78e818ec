//! One evaluation over several devices, for which one device used more than once stands in where there are not as many: the very bits of
//! one device, and what the naive oracle says. `LAGUERRE_REQUIRE=ocl` makes a missing device a failure.
#![cfg(feature = "test-util")]

use laguerre_core::capacities::{count_cells, sufficient};
use laguerre_core::oracle::Naive;
use laguerre_core::required::if_available;
use laguerre_core::shapes::icosphere;
use laguerre_core::{
    Backend, CellStatus, DeviceChoice, Domain, Facets, Observer, Output, PowerDiagram, Precision, Request,
};
use laguerre_ocl::Ocl;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How far a volume may be off the oracle's, in units of the mean.
const VOLUME: f64 = 1e-12;

/// The devices asked for.
fn open(choice: &DeviceChoice) -> Option<Ocl> {
    if_available("ocl", Ocl::new(choice, Precision::F64))
}

/// One device, and lists of several: it again, all, and more than there are cells in the smallest inputs.
fn devices() -> Option<(Ocl, Vec<Ocl>)> {
    let one = open(&DeviceChoice::First)?;
    let name = one.info().device;
    let number = laguerre_ocl::devices().unwrap().iter().position(|d| d.unusable.is_none() && d.name == name).unwrap();
    let lists = [DeviceChoice::Numbers(vec![number; 2]), DeviceChoice::Numbers(vec![number; 5])];
    Some((one, lists.iter().map(|list| open(list).unwrap()).collect()))
}

/// A low-discrepancy point in the unit cube.
fn point(i: usize) -> [f64; 3] {
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3].map(|a| (0.5 + i as f64 * a).fract())
}

/// A ball within the unit cube.
fn ball() -> Domain {
    let mut mesh = icosphere(2);
    mesh.vertices.iter_mut().flatten().for_each(|x| *x = 0.5 + 0.4 * *x);
    mesh.domain()
}

/// Inputs by name.
fn diagrams() -> Vec<(&'static str, PowerDiagram)> {
    let points = |count| (0..count).map(point).collect::<Vec<_>>();
    let plain = |positions: &[[f64; 3]]| PowerDiagram::new(positions, &[]).unwrap();
    let in_cube = |diagram: PowerDiagram| diagram.in_box([0.0; 3], [1.0; 3]).unwrap();
    let weights: Vec<f64> = (0..900).map(|i| 0.02 * (i as f64 * 0.618_033_988_749_894_9).fract()).collect();
    let thrice: Vec<[f64; 3]> = (0..900).map(|i| point(i % 300)).collect();
    // Voxels so crowded that the host sorts.
    let cluster = |center: f64, size: f64| (0..500).map(move |i| point(i).map(|x| center + size * (x - 0.5)));
    let crowded: Vec<[f64; 3]> = cluster(0.3, 1e-5).chain(cluster(0.8, 1e-3)).chain(points(20)).collect();
    // Sites on a sphere around one in the middle: more half-spaces than a device has room for, so that its cell is the host's.
    let mut around: Vec<[f64; 3]> = (0..300)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 300.0;
            let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            [r * cos, r * sin, z].map(|x| 0.5 + 0.4 * x)
        })
        .collect();
    around.push([0.5; 3]);
    let lattice: Vec<[f64; 3]> = (0..512).map(|i| [i % 8, i / 8 % 8, i / 64].map(|x| f64::from(x) / 7.0)).collect();
    vec![
        ("a box", in_cube(plain(&points(900)))),
        ("a domain", plain(&points(900)).restricted_to(&ball())),
        ("weights", in_cube(PowerDiagram::new(&points(900), &weights).unwrap())),
        ("weights in a domain", PowerDiagram::new(&points(900), &weights).unwrap().restricted_to(&ball())),
        ("coincident sites", in_cube(plain(&thrice))),
        ("coincident sites of several weights", PowerDiagram::new(&thrice, &weights).unwrap().restricted_to(&ball())),
        ("one site", in_cube(plain(&points(1)))),
        ("two sites", plain(&points(2)).restricted_to(&ball())),
        ("four sites at one place", in_cube(plain(&[[0.25; 3]; 4]))),
        ("clusters", in_cube(plain(&crowded))),
        ("clusters in a domain", plain(&crowded).restricted_to(&ball())),
        ("a cell of many facets", in_cube(plain(&around))),
        ("a lattice", plain(&lattice).restricted_to(&ball())),
    ]
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

/// Expects the same cells, to the last bit, and the same account of them.
fn assert_identical(one: &Output, several: &Output, what: &str) {
    assert_eq!(several.status(), one.status(), "{what}");
    assert_eq!(bits(several.volume()), bits(one.volume()), "{what}");
    assert_eq!(bits(several.barycenter().as_flattened()), bits(one.barycenter().as_flattened()), "{what}");
    assert_eq!(several.second_moment(), one.second_moment(), "{what}");
    assert_eq!(several.facets(), one.facets(), "{what}");
    assert_eq!(several.boundary(), one.boundary(), "{what}");
    assert_eq!(
        (several.report().exact_cells, several.report().host_cells),
        (one.report().exact_cells, one.report().host_cells),
        "{what}"
    );
    // However many devices, each cell is tried as often.
    let tried =
        |output: &Output| output.report().passes.iter().map(|pass| (pass.cells, pass.failed)).collect::<Vec<_>>();
    assert_eq!(tried(several), tried(one), "{what}");
    let most =
        |output: &Output| output.report().passes.iter().map(|pass| (pass.neighbors, pass.planes)).collect::<Vec<_>>();
    assert_eq!(most(several), most(one), "{what}");
}

/// Counts finished cells.
#[derive(Default)]
struct Count(AtomicUsize);

impl Observer for Count {
    fn advance(&self, cells: usize) -> ControlFlow<()> {
        self.0.fetch_add(cells, Ordering::Relaxed);
        ControlFlow::Continue(())
    }
}

#[test]
fn several_devices_find_the_cells_of_one() {
    let Some((one, several)) = devices() else { return };
    for (name, diagram) in diagrams() {
        for asked in [Request::moments, || Request::moments().with_facets().with_second_moments()] {
            let request = asked();
            let count = Count::default();
            let alone = one.evaluate_watched(&diagram, &request, &count).unwrap();
            // (Of sites at one place, one is told of.)
            assert_eq!(count.0.load(Ordering::Relaxed), diagram.prepare().unwrap().sites.len(), "{name}");
            for many in &several {
                let again = Count::default();
                let found = many.evaluate_watched(&diagram, &request, &again).unwrap();
                let what = format!("{name}, on {}, facets: {}", many.info().device, request.facets());
                assert_identical(&alone, &found, &what);
                assert_eq!(again.0.load(Ordering::Relaxed), count.0.load(Ordering::Relaxed), "{what}");
            }
        }
    }
}

#[test]
fn passes_report_the_most_triangles_tried() {
    let Some((one, several)) = devices() else { return };
    let diagram = PowerDiagram::new(&(0..900).map(point).collect::<Vec<_>>(), &[]).unwrap().restricted_to(&ball());
    for request in [Request::moments(), Request::moments().with_facets()] {
        let prepared = diagram.prepare().unwrap();
        let all: Vec<u32> = (0..prepared.sites.len() as u32).collect();
        let most = sufficient(&count_cells(&prepared, &request, &all), 1.0).triangles;
        for backend in several.iter().chain([&one]) {
            let passes = backend.evaluate(&diagram, &request).unwrap().report().passes.clone();
            assert_eq!((passes.len(), passes[0].triangles), (1, most), "{}", backend.info().device);
        }
    }
}

#[test]
fn several_devices_agree_with_the_oracle() {
    let Some((_, several)) = devices() else { return };
    for (name, diagram) in diagrams() {
        let request = Request::moments().with_facets();
        let right = Naive::default().evaluate(&diagram, &request).unwrap();
        let found = several[0].evaluate(&diagram, &request).unwrap();
        assert_eq!(found.status(), right.status(), "{name}");
        let mean = right.volume().iter().sum::<f64>() / right.count(CellStatus::Complete) as f64;
        for (i, (a, b)) in found.volume().iter().zip(right.volume()).enumerate() {
            assert!((a - b).abs() <= VOLUME * mean, "{name}: cell {i}: {a:e} and {b:e}");
        }
        assert_eq!(rows(&found), rows(&right), "{name}");
    }
}

/// For each site its neighbours, but for facets that are nothing beside a mean one.
fn rows(output: &Output) -> Vec<Vec<u32>> {
    let facets: &Facets = output.facets().unwrap();
    let mean = facets.area().iter().sum::<f64>() / facets.len().max(1) as f64;
    let row = |i: usize| {
        let large = facets.of(i).filter(|facet| facet.area > VOLUME * mean);
        large.map(|facet| facet.neighbor as u32).collect()
    };
    (0..facets.sites()).map(row).collect()
}
