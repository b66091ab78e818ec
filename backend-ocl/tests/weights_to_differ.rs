//! Equal weights by the kernels for any, where who asks says that they will differ.
#![cfg(feature = "test-util")]

use laguerre_core::required::if_available;
use laguerre_core::shapes::icosphere;
use laguerre_core::{Backend, DeviceChoice, ErrorKind, PowerDiagram, Precision, Request};
use laguerre_ocl::Ocl;

#[test]
fn the_cells_are_the_same() {
    // (Where lanes share cells anyway it is not another backend.)
    let opened = Ocl::sharing_cells(&DeviceChoice::First, Precision::F64).or_else(|error| match error.kind() {
        ErrorKind::Unavailable => Ocl::new(&DeviceChoice::First, Precision::F64),
        _ => Err(error),
    });
    let Some(backend) = if_available("ocl", opened) else { return };
    let point = |i: usize| {
        [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3]
            .map(|a| (0.5 + i as f64 * a).fract() * 2.0 - 1.0)
    };
    // A solver's first level has one site, which is far from where the domain is.
    let inputs = [vec![[3.0, -2.0, 1.0]], (0..2).map(point).collect(), (0..300).map(point).collect::<Vec<_>>()];
    for sites in &inputs {
        let diagram = PowerDiagram::new(sites, &[]).unwrap().restricted_to(&icosphere(2).domain());
        let asked = Request::moments().with_laplacian();
        let right = backend.evaluate(&diagram, &asked).unwrap();
        let output = backend.evaluate(&diagram, &asked.with_weights_to_differ()).unwrap();
        assert_eq!(output.status(), right.status());
        let pairs = output.volume().iter().zip(right.volume());
        assert!(pairs.clone().all(|(volume, right)| (volume - right).abs() <= 1e-13), "{:?}", sites.len());
        let (ties, right) = (output.laplacian().unwrap(), right.laplacian().unwrap());
        assert!(ties.order() == right.order() && ties.columns() == right.columns());
        assert!(ties.values().iter().zip(right.values()).all(|(tie, right)| (tie - right).abs() <= 1e-12 * right));
    }
}
