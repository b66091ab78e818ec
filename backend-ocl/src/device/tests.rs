//! What the device finds out about weights before it searches, held to all pairs of sites.

use super::Device;
use crate::grid::SITES_PER_VOXEL;
use crate::interface::data::{Block, SHELL_RADIUS};
use crate::platform::choose;
use laguerre_core::required::if_available;
use laguerre_core::{DeviceChoice, PowerDiagram, Precision, Request};

type Weight = fn([f64; 3]) -> f64;

/// Weights of each kind, and how far vertices may be at least where they are the same for all cells but a shift, in voxels.
const WEIGHTS: [(&str, Weight, f64); 5] = [
    ("affine", |[x, y, z]| 0.7 * x - 0.4 * y + 0.1 * z, 2.5),
    ("convex", |[x, y, z]| 0.2 * (x * x + y * y + z * z), 0.8),
    ("with a step", |[x, y, z]| 0.3 * x - 0.25 * y * y + 0.2 * z * z + if x > 0.5 { 0.02 } else { 0.0 }, f64::MIN),
    ("at random", |[x, y, z]| 0.01 * (1e4 * (x + 2.0 * y + 3.0 * z)).fract(), f64::MIN),
    ("one heavy", |[x, y, z]| if x.max(y).max(z) < 0.1 { 0.09 } else { 0.0 }, f64::MIN),
];

#[test]
fn no_pair_of_sites_breaks_the_bounds_of_a_block() {
    let Some(mut device) = open() else { return };
    for (name, weight, least) in WEIGHTS {
        let positions = sites(3000);
        let weights: Vec<f64> = positions.iter().map(|&p| weight(p)).collect();
        let diagram = PowerDiagram::new(&positions, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        let container = diagram.framed_container().unwrap();
        device.load(&diagram, &container, &Request::moments(), None).unwrap();
        assert_eq!(device.sort(&diagram, &container).unwrap(), Some(positions.len()));
        let grid = diagram.prepare_grid(SITES_PER_VOXEL).unwrap().sites;
        let [nx, ny, nz] = grid.levels()[1].dims;
        let mut blocks: Vec<Block> = Vec::new();
        device.sites.blocks.read(&device.queue, (nx * ny * nz) as usize, &mut blocks).unwrap();
        let width = grid.voxel_width();
        for &[x, y, z, w] in grid.sites() {
            let center = grid.voxel_of([x, y, z]);
            let [bx, by, bz] = center.map(|i| i / 2);
            let Block { slope: [gx, gy, gz], excess, growth, proved } = blocks[(bx + nx * (by + ny * bz)) as usize];
            assert!(proved >= least * width, "{name}: {} voxels", proved / width);
            let excess = excess - w + (gx * x + gy * y + gz * z);
            for &[ox, oy, oz, other] in grid.sites() {
                let d = [ox - x, oy - y, oz - z];
                let square = d.iter().map(|d| d * d).sum::<f64>();
                let more = other - w - (gx * d[0] + gy * d[1] + gz * d[2]);
                let off = grid.voxel_of([ox, oy, oz]).iter().zip(center).map(|(&i, c)| i.abs_diff(c)).max();
                if square == 0.0 {
                    continue;
                }
                if off <= Some(SHELL_RADIUS) {
                    assert!(more <= excess + growth * square, "{name}: {more} is above {excess} + {growth}·{square}");
                } else {
                    let bisector = (square - more) / (2.0 * square.sqrt());
                    assert!(bisector >= proved, "{name}: a bisector at {bisector}, none was to be within {proved}");
                }
            }
        }
    }
}

/// Sites spread evenly, but not regularly.
fn sites(count: u32) -> Vec<[f64; 3]> {
    let steps = [0.819_172_513_396_164_5, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2];
    (1..=count).map(|i| steps.map(|step| (f64::from(i) * step).fract())).collect()
}

fn open() -> Option<Device> {
    if_available("ocl", choose(&DeviceChoice::First, Precision::F64).and_then(|found| Device::open(&found[0])))
}
