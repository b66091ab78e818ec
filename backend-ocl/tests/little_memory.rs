//! The Laplacian where a device has no memory for all facets at a time, and a domain that it has none for. A test program of its own, as its OpenCL loader refuses large buffers (`backend-ocl/faults`).
#![cfg(feature = "test-util")]

mod loader;

use std::fs;

use laguerre_core::required::if_available;
use laguerre_core::shapes::icosphere;
use laguerre_core::{Backend, DeviceChoice, PowerDiagram, Precision, Request};
use laguerre_ocl::Ocl;

const SITES: usize = 3000;

/// More than areas of facets of half of them take, and less than those of all. (On devices where lanes share cells, finished cells take more.)
const LARGE: usize = 600_000;

#[test]
fn what_has_no_memory_is_done_without_or_said() {
    let Some(log) = loader::begin("little", &format!("clCreateBuffer:>{LARGE}:-4")) else { return };
    let Some(backend) = if_available("ocl", Ocl::new(&DeviceChoice::First, Precision::F64)) else { return };
    let at = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
    // Of the larger box few cells meet the ball, and their facets have room in half of the memory; of the smaller one they do not.
    for extent in [2.5, 0.8] {
        let site = |i: usize| at.map(|step| extent * (2.0 * (0.5 + i as f64 * step).fract() - 1.0));
        let sites: Vec<[f64; 3]> = (0..SITES).map(site).collect();
        let diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&icosphere(2).domain());
        let facets = backend.evaluate(&diagram, &Request::moments().with_facets()).unwrap();
        let facets = facets.facets().unwrap();
        fs::write(&log, "").unwrap();
        let output = backend.evaluate(&diagram, &Request::moments().with_laplacian()).unwrap();
        let calls = fs::read_to_string(&log).unwrap();
        let is_large = |call: &&str| {
            let size = call.strip_prefix("clCreateBuffer ").and_then(|size| size.parse().ok());
            size.is_some_and(|size: usize| size > LARGE)
        };
        // Asked for before there is a facet, and not again while there are.
        assert!(extent < 1.0 || calls.lines().filter(is_large).count() == 1, "{calls}");
        let laplacian = output.laplacian().unwrap();
        let mut seen = 0;
        for (row, &i) in laplacian.order().iter().enumerate() {
            for k in laplacian.row(row) {
                let j = laplacian.order()[laplacian.columns()[k] as usize];
                let facet = facets.get(facets.between(i as usize, j as usize).unwrap());
                let right = facet.area / facet.distance;
                assert!((laplacian.values()[k] - right).abs() <= 1e-12, "{i}, {j}");
                seen += 1;
            }
        }
        assert!(seen > 1000 && seen + 10 > facets.len(), "{seen} of {}", facets.len());
    }
    // A domain that there is no memory for is an error of its own diagram, and of no other.
    let sites: Vec<[f64; 3]> = (0..100).map(|i| at.map(|step| (0.5 + f64::from(i) * step).fract())).collect();
    let boxed = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let large = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&icosphere(6).domain());
    for (diagram, is_there) in [(&boxed, true), (&large, false), (&boxed, true)] {
        let evaluated = backend.evaluate(diagram, &Request::moments());
        assert_eq!(evaluated.is_ok(), is_there, "{:?}", evaluated.err());
    }
    let _ = fs::remove_file(&log);
}
