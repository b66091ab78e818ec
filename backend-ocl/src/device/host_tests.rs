//! A few cells that are the host's, among those of the device.

use super::tests::spread;
use crate::evaluate::Ocl;
use laguerre_core::required::if_available;
use laguerre_core::shapes::icosphere;
use laguerre_core::{Backend as _, DeviceChoice, Output, PowerDiagram, Precision, Request};

/// Facets of a cell of the host's stand in the rows that the device puts in order, which are the CPU's.
#[test]
fn facets_of_the_hosts_cells_are_put_in_order_on_the_device() {
    let Some(mut backend) = if_available("ocl", Ocl::new(&DeviceChoice::First, Precision::F64)) else { return };
    let positions = spread(3000);
    let weights: Vec<f64> = (0..positions.len()).map(|i| if i == 7 { 0.1 } else { 1e-4 * (i % 3) as f64 }).collect();
    let diagram = PowerDiagram::new(&positions, &weights).unwrap();
    let in_box = diagram.clone().in_box([0.0; 3], [1.0; 3]).unwrap();
    let request = Request::moments().with_facets().with_facet_second_moments().with_laplacian();
    for diagram in [in_box, diagram.restricted_to(&icosphere(2).domain())] {
        let right = laguerre_cpu::Cpu::new(None).unwrap().evaluate(&diagram, &request).unwrap();
        let found = backend.evaluate(&diagram, &request).unwrap();
        let first = &mut backend.devices.get_mut()[0];
        assert!(found.report().host_cells > 0 && first.facets_are_kept && first.lengths.of(positions.len()).facets > 0);
        let (facets, whole) = (found.facets().unwrap(), right.facets().unwrap());
        assert_eq!((facets.offsets(), facets.neighbor()), (whole.offsets(), whole.neighbor()));
        let are_near = |a: &[f64], b: &[f64], most: f64| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= most);
        assert!(are_near(facets.area(), whole.area(), 1e-12));
        assert!(are_near(facets.barycenter().as_flattened(), whole.barycenter().as_flattened(), 1e-6));
        let seconds = [facets, whole].map(|facets| facets.second_moment().unwrap().as_flattened());
        assert!(are_near(seconds[0], seconds[1], 1e-12));
        let laplacian_of = |output: &Output| output.laplacian().unwrap().whole(positions.len());
        let ((_, columns, values), (_, its_columns, its_values)) = (laplacian_of(&found), laplacian_of(&right));
        assert_eq!(columns, its_columns);
        assert!(are_near(&values, &its_values, 1e-9));
    }
}
