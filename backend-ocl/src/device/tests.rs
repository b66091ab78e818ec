//! The tree that the device makes over the sites, held to its sites.

use super::Device;
use crate::platform::choose;
use laguerre_core::required::if_available;
use laguerre_core::site_tree::{MadeTree, WIDTH};
use laguerre_core::{DeviceChoice, PowerDiagram, Precision, Request};

type Place = fn([f64; 3]) -> [f64; 3];
type Weight = fn([f64; 3]) -> f64;

const SITES: u32 = 9000;

/// Sites of each kind, with weights of each: spread evenly, on a surface, of four scales, and with a few at one place.
const INPUTS: [(&str, Place, Weight); 5] = [
    ("even", |p| p, |_| 0.0),
    ("affine", |p| p, |[x, y, z]| 0.7 * x - 0.4 * y + 0.1 * z),
    ("on a surface", |[x, y, _]| [x, y, 0.2 * x * x + 0.1 * y], |[x, y, _]| 0.3 * x * x - 0.25 * y * y),
    ("of four scales", |p| p.map(|x| 0.3 + x * 10_f64.powi(-((1e4 * p[0]) as i32 % 4))), |p| (1e4 * p[1]).fract()),
    ("coincident", |p| p.map(|x| (20.0 * x).floor() / 20.0), |p| if p[0] < 0.01 { 0.01 } else { 0.0 }),
];

#[test]
fn what_bounds_a_node_holds_for_its_sites() {
    let Some(mut device) = open() else { return };
    for (name, place, weight) in INPUTS {
        let positions: Vec<[f64; 3]> = spread(SITES).into_iter().map(place).collect();
        let weights: Vec<f64> = positions.iter().map(|&p| weight(p)).collect();
        let diagram = PowerDiagram::new(&positions, &weights).unwrap().in_box([0.0; 3], [2.0; 3]).unwrap();
        let container = diagram.framed_container().unwrap();
        device.bring_sites(&diagram).unwrap();
        device.load(&container, &Request::moments(), None).unwrap();
        let count = device.sort(&|| Ok(false)).unwrap().unwrap();

        let mut places: Vec<[u64; 3]> = positions.iter().map(|p| p.map(f64::to_bits)).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(count, places.len(), "{name}");
        let MadeTree { sites, order, boxes, slabs, weights: bounds, .. } =
            device.sites.read_tree(&device.queue, &device.shared.params).unwrap();
        let frame = &container.frame;
        for (site, &i) in sites.iter().zip(&order) {
            assert_eq!(site[..3], frame.enter(positions[i as usize]), "{name}");
        }
        let mut once = order.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), count, "{name}");

        let params = device.shared.params;
        for (i, &[x, y, z, w]) in sites.iter().enumerate() {
            let (at, more) = ([x, y, z], w - params.smallest_weight);
            for level in 0..=params.tree_top as usize {
                let node = i / WIDTH.pow(level as u32 + 1);
                let (block, k) = (params.tree_begin[level] as usize + node / WIDTH, node % WIDTH);
                let (its_box, slab) = (&boxes[block], &slabs[block]);
                assert!((0..3).all(|axis| its_box.lo[axis][k] <= at[axis] && at[axis] <= its_box.hi[axis][k]));
                let height: f64 = (0..3).map(|axis| slab.normal[axis][k] * at[axis]).sum();
                assert!(slab.lo[k] <= height && height <= slab.hi[k], "{name}, level {level}");
                assert!(more <= slab.largest_weight[k], "{name}, level {level}");
                if params.equal_weights == 0 {
                    let (bound, middle) = (&bounds[block], its_box.middle(k));
                    let term = |axis: usize| {
                        let u = at[axis] - middle[axis];
                        (bound.g[axis][k] + bound.q[axis][k] * u) * u
                    };
                    assert!(more <= bound.c[k] + (term(0) + term(1) + term(2)), "{name}, level {level}");
                }
            }
        }
    }
}

/// Points spread evenly, but not regularly.
fn spread(count: u32) -> Vec<[f64; 3]> {
    let steps = [0.819_172_513_396_164_5, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2];
    (1..=count).map(|i| steps.map(|step| (f64::from(i) * step).fract())).collect()
}

fn open() -> Option<Device> {
    if_available(
        "ocl",
        choose(&DeviceChoice::First, Precision::F64).and_then(|found| Device::open(&found[0], Precision::F64)),
    )
}
