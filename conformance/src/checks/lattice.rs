//! Lattices, where every vertex is shared by eight cells.

use glam::{DMat3, DVec3};
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, CellStatus, Request};

use crate::backends::are_lanes_emulated;
use crate::bounds::SUM;
use crate::domains::Room;
use crate::{Scene, Verdict};

/// Sites along an edge of the large lattices.
fn side(backend: &dyn Backend) -> usize {
    if are_lanes_emulated(backend) { 30 } else { 40 }
}

/// How much a lattice's volumes may differ, relative to a cell: a coordinate in the unit box is off by u, a cell 1/40 wide by
/// 40 times that in each direction, in two faces: some 240 u, rounded up.
const EQUAL: f64 = 1e-13;

/// A lattice in its box: all volumes are equal.
pub fn equal_volumes(backend: &dyn Backend) -> Verdict {
    let side = side(backend);
    let scene = Scene { positions: lattice([side; 3]), weights: Vec::new(), room: unit_box() };
    let output = scene.with_facets(backend)?;
    all_equal(output.volume())?;
    let facets = output.facets().map_or(0, |f| f.area().len());
    ensure!(facets == 6 * side * side * (side - 1), "{facets} facets, each cell has six but for those on the faces");
    Ok(())
}

/// The same, every site twice: the second ones are empty, the rest unchanged.
pub fn duplicated(backend: &dyn Backend) -> Verdict {
    let once = Scene { positions: lattice([side(backend); 3]), weights: Vec::new(), room: unit_box() };
    let mut twice = once.clone();
    twice.positions.extend_from_slice(&once.positions);
    let (single, double) =
        (once.evaluate(backend, &Request::moments())?, twice.evaluate(backend, &Request::moments())?);
    let (first, second) = double.status().split_at(once.len());
    ensure!(first.iter().all(|s| *s == CellStatus::Complete), "a site that stood first has lost its cell");
    ensure!(second.iter().all(|s| *s == CellStatus::Empty), "a duplicate has a cell");
    let unit = 1.0 / once.len() as f64;
    for i in 0..once.len() {
        let off = (single.volume()[i] - double.volume()[i]).abs();
        ensure!(off <= EQUAL * unit, "site {i}: its duplicate changed its volume by {off:e}");
    }
    all_equal(&double.volume()[..once.len()])
}

/// The lattice turned, in a box that stays and in one that turns with it: sums to rounding, and (with it) equal volumes.
pub fn turned(backend: &dyn Backend) -> Verdict {
    let turn = DMat3::from_axis_angle(DVec3::new(0.3, -1.0, 0.7).normalize(), 0.8);
    let middle = DVec3::splat(0.5);
    let go = |p: [f64; 3]| <[f64; 3]>::from(middle + turn * (DVec3::from(p) - middle));
    let positions: Vec<[f64; 3]> = lattice([side(backend); 3]).into_iter().map(go).collect();
    let resting = Scene { positions: positions.clone(), weights: Vec::new(), room: unit_box() };
    let turning = unit_box().mesh().transformed(turn, middle - turn * middle);
    let together = Scene { positions, weights: Vec::new(), room: Room::of(turning) };
    for (scene, has_all) in [(&resting, false), (&together, true)] {
        let output = scene.evaluate(backend, &Request::moments())?;
        let volume = scene.room.volume();
        let barycenter = DVec3::from(scene.room.barycenter());
        let mut sums = [Sum::default(); 4];
        for (&v, &b) in output.volume().iter().zip(output.barycenter()).filter(|(v, _)| **v != 0.0) {
            let moment = v * (DVec3::from(b) - barycenter);
            [v, moment.x, moment.y, moment.z].into_iter().zip(&mut sums).for_each(|(x, sum)| sum.add(x));
        }
        let [v, x, y, z] = sums.map(|s| s.total());
        ensure!((v - volume).abs() <= SUM * volume, "volumes sum to {v} of {volume}");
        let off = DVec3::new(x, y, z).length() / (volume * scene.room.extents().length());
        ensure!(off <= SUM, "barycenters are off by {off:e} of the diagonal");
        let is_lost = has_all && output.count(CellStatus::Complete) != scene.len();
        ensure!(!is_lost, "a cell of the lattice is lost");
    }
    Ok(())
}

/// The cells of a lattice of 5 × 4 × 3 are boxes of known second moments: V·extent²/12 on the diagonal, 0 beside it.
pub fn second_moments(backend: &dyn Backend) -> Verdict {
    let dims = [5, 4, 3];
    for room in [unit_box(), Room::of((*unit_box().mesh()).clone())] {
        let scene = Scene { positions: lattice(dims), weights: Vec::new(), room };
        let output = scene.evaluate(backend, &Request::moments().with_second_moments())?;
        for (i, moment) in output.second_moment().into_iter().flatten().enumerate() {
            let volume = 1.0 / 60.0;
            for k in 0..6 {
                let expected = if k < 3 { volume / (12.0 * (dims[k] * dims[k]) as f64) } else { 0.0 };
                // As for volumes, and the cell's extents squared are at most 1/9.
                ensure!(
                    (moment[k] - expected).abs() <= EQUAL * volume / 9.0,
                    "site {i}: {moment:?}, entry {k} is {expected}"
                );
            }
        }
    }
    Ok(())
}

fn all_equal(volumes: &[f64]) -> Verdict {
    let unit = 1.0 / volumes.len() as f64;
    let off = volumes.iter().map(|v| (v - unit).abs()).fold(0.0, f64::max);
    ensure!(off <= EQUAL * unit, "a volume is off by {:e} of a cell", off / unit);
    Ok(())
}

fn unit_box() -> Room {
    Room::Box([0.0; 3], [1.0; 3])
}

fn lattice(dims: [usize; 3]) -> Vec<[f64; 3]> {
    let [a, b, c] = dims;
    let indices = (0..a).flat_map(|i| (0..b).flat_map(move |j| (0..c).map(move |k| [i, j, k])));
    indices.map(|index| std::array::from_fn(|k| (index[k] as f64 + 0.5) / dims[k] as f64)).collect()
}
