//! Cells that are swept where a device has no memory for the records of all that are at a time. A test program of its own, as its OpenCL loader refuses large buffers (`backend-ocl/faults`).
#![cfg(feature = "test-util")]

mod loader;

use std::fs;

use laguerre_core::required::if_available;
use laguerre_core::{Backend, CellStatus, DeviceChoice, ErrorKind, PowerDiagram, Precision, Request};
use laguerre_ocl::Ocl;

const SITES: usize = 3000;

/// More than the records of 256 cells take, and less than those of 512.
const LARGE: usize = 600_000;

#[test]
fn fewer_are_swept_where_there_is_no_room() {
    let Some(log) = loader::begin("swept", &format!("clCreateBuffer:>{LARGE}:-4")) else { return };
    // (Where lanes share cells anyway it is not another backend.)
    let opened = Ocl::sharing_cells(&DeviceChoice::First, Precision::F64).or_else(|error| match error.kind() {
        ErrorKind::Unavailable => Ocl::new(&DeviceChoice::First, Precision::F64),
        _ => Err(error),
    });
    let Some(backend) = if_available("ocl", opened) else { return };
    // On a line along an axis of the box each cell is a slab, between the middles of the ways to its neighbors.
    let along: Vec<f64> = (0..SITES).map(|i| (0.5 + i as f64 * 0.819_172_513_396_164_4).fract()).collect();
    let sites: Vec<[f64; 3]> = along.iter().map(|&x| [x, 0.5, 0.5]).collect();
    let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    let output = backend.evaluate(&diagram, &Request::moments()).unwrap();
    let mut order: Vec<usize> = (0..SITES).collect();
    order.sort_by(|&i, &j| along[i].total_cmp(&along[j]));
    for (k, &i) in order.iter().enumerate() {
        let lo = if k == 0 { 0.0 } else { 0.5 * (along[order[k - 1]] + along[i]) };
        let hi = order.get(k + 1).map_or(1.0, |&next| 0.5 * (along[i] + along[next]));
        assert_eq!(output.status()[i], CellStatus::Complete, "site {i}");
        assert!((output.volume()[i] - (hi - lo)).abs() <= 1e-14, "site {i}: {} of {}", output.volume()[i], hi - lo);
    }
    let calls = fs::read_to_string(&log).unwrap();
    let sizes = calls.lines().filter_map(|call| call.strip_prefix("clCreateBuffer ")?.parse::<usize>().ok());
    let refused = sizes.filter(|&size| size > LARGE).count();
    // (Room for cells that one stage keeps for another, and for those that are swept at a time.)
    assert_eq!(refused, 2, "{calls}");
    let _ = fs::remove_file(&log);
}
