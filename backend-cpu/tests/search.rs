//! The search paths that ordinary inputs do not take, against the naive oracle and a k-d tree: clusters, heavy sites, weights that curve, cells of
//! many facets.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use laguerre_core::oracle::Naive;
use laguerre_core::shapes::icosphere;
use laguerre_core::{Backend, CellStatus, Integrand, Output, PowerDiagram, Request};
use laguerre_cpu::Cpu;
use std::num::NonZero;

/// A low-discrepancy point in the unit cube.
fn point(i: usize) -> [f64; 3] {
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3].map(|a| (0.5 + i as f64 * a).fract())
}

fn assert_same(diagram: &PowerDiagram) -> Output {
    let request = Request::moments().with_facets();
    let found = Cpu::new(Some(2)).unwrap().evaluate(diagram, &request).unwrap();
    let right = Naive::default().evaluate(diagram, &request).unwrap();
    assert_eq!(found.status(), right.status());
    let mean = right.volume().iter().sum::<f64>() / right.count(CellStatus::Complete) as f64;
    for i in 0..right.volume().len() {
        assert!((found.volume()[i] - right.volume()[i]).abs() <= 1e-12 * mean, "cell {i}");
        let count = |o: &Output| o.facets().map(|f| f.row(i).len());
        assert!(count(&found).is_some() && right.volume()[i] >= 0.0);
    }
    let total: f64 = found.volume().iter().sum();
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
    let planes: Vec<u32> = output.report().passes.iter().map(|pass| pass.planes).collect();
    assert_eq!(planes, [64, 1024]);
    let facets = output.facets().unwrap();
    assert_eq!(facets.row(n).len(), n);
}

/// Weights that make cells lie far from their sites, or hide most of them; sites in a plane, whose cells reach across the box.
#[test]
fn weights_that_curve_and_sites_in_a_plane() {
    let positions: Vec<[f64; 3]> = (0..1200).map(point).collect();
    let flat: Vec<[f64; 3]> = positions.iter().map(|&[x, y, _]| [x, y, 0.5]).collect();
    let square = |&[x, y, z]: &[f64; 3]| x * x + y * y + z * z;
    for places in [&positions, &flat] {
        assert_same(&in_unit_box(places, &[]));
        for curvature in [0.9, 0.5, -2.0] {
            let weights: Vec<f64> = places.iter().map(|p| curvature * square(p)).collect();
            assert_same(&in_unit_box(places, &weights));
        }
        let slanted: Vec<f64> = places.iter().map(|&[x, y, z]| 0.6 * x - 0.3 * y + 0.2 * z * y).collect();
        assert_same(&in_unit_box(places, &slanted));
    }
}

/// A hollow: each cell reaches to its middle, where sites from all over cut it.
#[test]
fn sites_near_a_sphere() {
    let on_sphere = |p: [f64; 3]| {
        let way = p.map(|x| x - 0.5);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        way.map(|x| 0.5 + 0.4 * (1.0 + 1e-3 * length) * x / length)
    };
    assert_same(&in_unit_box(&(1..=700).map(|i| on_sphere(point(i))).collect::<Vec<_>>(), &[]));
}

/// At the barycenter of a facet its two sites have less power than all others, says a k-d tree over the sites lifted to four dimensions: at
/// height √(W − w), `W` the largest weight, the squared distance is the power distance plus `W`.
#[test]
fn no_site_is_nearer_to_a_facet_than_its_own() {
    let cluster = |center: f64, size: f64| (0..4000).map(move |i| point(i).map(|x| center + size * (x - 0.5)));
    let positions: Vec<[f64; 3]> = cluster(0.5, 1.0).chain(cluster(0.3, 1e-3)).collect();
    let curved = |&[x, y, z]: &[f64; 3]| 0.7 * x * x + 0.2 * y - z * z;
    for weights in [vec![0.0; positions.len()], positions.iter().map(curved).collect()] {
        let largest = weights.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let lifted: Vec<[f64; 4]> =
            positions.iter().zip(&weights).map(|(&[x, y, z], w)| [x, y, z, (largest - w).sqrt()]).collect();
        let tree: ImmutableKdTree<f64, 4> = ImmutableKdTree::new_from_slice(&lifted).unwrap();
        let request = Request::moments().with_facets();
        let output = Cpu::new(Some(2)).unwrap().evaluate(&in_unit_box(&positions, &weights), &request).unwrap();
        let facets = output.facets().unwrap();
        let mut looked = 0;
        for i in (0..positions.len()).step_by(7) {
            // Of slivers the barycenter has few digits.
            let largest = facets.of(i).fold(0.0_f64, |area, facet| area.max(facet.area));
            for facet in facets.of(i).filter(|facet| facet.area > 1e-6 * largest) {
                let [x, y, z] = facet.barycenter;
                let power = |j: usize| {
                    let [a, b, c] = positions[j];
                    (x - a).powi(2) + (y - b).powi(2) + (z - c).powi(2) - weights[j]
                };
                let one = NonZero::new(1).unwrap();
                let least = tree.query(&[x, y, z, 0.0]).nearest_n::<SquaredEuclidean<f64>>(one).execute();
                let found = least[0].item as usize;
                // A site that was left out would be nearer by some 1e-7, the square of the cluster's spacing.
                assert!(power(i) - power(found) <= 1e-11, "site {found} is nearer to a facet of {i}");
                looked += 1;
            }
        }
        assert!(looked > 5000, "{looked}");
    }
}

/// Which cells are a batch depends on the degree of the function; the volumes do not.
#[test]
fn volumes_do_not_depend_on_the_degree_of_a_function() {
    let sites: Vec<[f64; 3]> = (0..3000).map(point).collect();
    let weights: Vec<f64> = sites.iter().map(|p| 0.03 * (1e5 * p[1]).fract()).collect();
    let diagram = PowerDiagram::new(&sites, &weights).unwrap().restricted_to(&icosphere(2).domain());
    let volumes = |degree| {
        let sum = |places: &[[f64; 3]]| Ok(places.iter().map(|p| p[0] + p[1] + p[2]).collect());
        let request = Request::moments().with_integral(Integrand::batches(degree, 1, sum).unwrap());
        Cpu::new(Some(2)).unwrap().evaluate(&diagram, &request).unwrap().volume().to_vec()
    };
    assert!(volumes(1) == volumes(12));
}
