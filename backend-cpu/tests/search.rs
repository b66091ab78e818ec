//! The search paths that ordinary inputs do not take, against the naive oracle: crowded voxels, heavy sites, cells of many facets.

use laguerre_core::oracle::Naive;
use laguerre_core::{Backend, CellStatus, Output, PowerDiagram, Request};
use laguerre_cpu::Cpu;

/// A low-discrepancy point in the unit cube.
fn point(i: usize) -> [f64; 3] {
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3].map(|a| (0.5 + i as f64 * a).fract())
}

fn assert_same(diagram: &PowerDiagram) -> Output {
    let request = Request::moments().with_facets();
    let found = Cpu::new(Some(2)).unwrap().evaluate(diagram, &request).unwrap();
    let right = Naive::default().evaluate(diagram, &request).unwrap();
    assert_eq!(found.status, right.status);
    let mean = right.volume.iter().sum::<f64>() / right.count(CellStatus::Complete) as f64;
    for i in 0..right.volume.len() {
        assert!((found.volume[i] - right.volume[i]).abs() <= 1e-12 * mean, "cell {i}");
        let count = |o: &Output| o.facets.as_ref().map(|f| f.offsets[i + 1] - f.offsets[i]);
        assert!(count(&found).is_some() && right.volume[i] >= 0.0);
    }
    let total: f64 = found.volume.iter().sum();
    assert!((total - 1.0).abs() < 1e-13, "{total}");
    found
}

fn in_unit_box(positions: &[[f64; 3]], weights: &[f64]) -> PowerDiagram {
    PowerDiagram::new(positions, weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap()
}

#[test]
fn two_dense_clusters_far_apart() {
    let cluster = |center: f64, size: f64| (0..500).map(move |i| point(i).map(|x| center + size * (x - 0.5)));
    let mut positions: Vec<[f64; 3]> = cluster(0.3, 1e-5).chain(cluster(0.8, 1e-3)).collect();
    positions.extend((0..20).map(|i| point(1000 + i)));
    assert_same(&in_unit_box(&positions, &[]));
    let weights: Vec<f64> = (0..positions.len()).map(|i| 1e-8 * (i % 7) as f64).collect();
    assert_same(&in_unit_box(&positions, &weights));
}

#[test]
fn one_heavy_site_among_many() {
    let positions: Vec<[f64; 3]> = (0..1500).map(point).collect();
    let mut weights = vec![0.0; positions.len()];
    weights[700] = 0.09;
    let output = assert_same(&in_unit_box(&positions, &weights));
    assert!(output.count(CellStatus::Empty) > 20);
}

#[test]
fn a_cell_of_many_facets_outgrows_the_first_pass() {
    // Sites on a sphere around one in the middle, whose cell touches them all.
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let n = 600;
    let mut positions: Vec<[f64; 3]> = (0..n)
        .map(|i| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
            let r = (1.0 - z * z).sqrt();
            let (sin, cos) = (golden * i as f64).sin_cos();
            [r * cos, r * sin, z].map(|x| 0.5 + 0.4 * x)
        })
        .collect();
    positions.push([0.5; 3]);
    let output = assert_same(&in_unit_box(&positions, &[]));
    assert!(output.passes.len() > 3, "{:?}", output.passes);
    let facets = output.facets.unwrap();
    assert_eq!(facets.offsets[n + 1] - facets.offsets[n], n);
}
