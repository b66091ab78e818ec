//! Small diagrams where everything ties: sites on coarse lattices, weights from a small set, rooms made by code.

use arbitrary::{Result, Unstructured};
use glam::{DMat3, DVec3};
use laguerre_conformance::domains::{Pose, Room, Shape, room};

use crate::case::{Also, Structured};

/// The rooms, and how many of 256 cases are in each: few where a case costs much. `None`: no room is given.
const ROOMS: [(u8, Option<Shape>); 16] = [
    (50, None),
    (60, Some(Shape::Box)),
    (28, Some(Shape::FlatBox)),
    (24, Some(Shape::BoxMesh)),
    (36, Some(Shape::Tetrahedron)),
    (14, Some(Shape::Plate)),
    (8, Some(Shape::LongBox)),
    (8, Some(Shape::TouchingInFace)),
    (8, Some(Shape::TouchingInPartOfFace)),
    (6, Some(Shape::TouchingInEdge)),
    (4, Some(Shape::TouchingInVertex)),
    (2, Some(Shape::DoubleTorus)),
    (2, Some(Shape::Cavity)),
    (2, Some(Shape::TwoComponents)),
    (2, Some(Shape::NestedSpheres)),
    (2, Some(Shape::Sphere)),
];

/// Lattices over the bounding box of a room: lowest and highest index, and how many steps make the box.
const LATTICES: [(i32, i32, i32); 6] = [(0, 4, 4), (0, 2, 2), (0, 3, 3), (0, 8, 8), (-2, 6, 4), (1, 7, 8)];

/// Angles by which the sites are turned about the middle of the room: from below a rounding to no longer small.
const ANGLES: [f64; 8] = [0.0, 0.0, 0.0, 1e-17, 1e-15, 1e-12, 1e-7, 0.8];

/// Weights, in units of one of [`SCALES`] (length²).
const WEIGHTS: [f64; 6] = [0.0, 0.0625, 0.25, 1.0, -1.0, 0.0625 + f64::EPSILON / 16.0];

/// Units of weights (length²).
const SCALES: [f64; 4] = [1.0, 0.0625, 1e-9, 64.0];

/// The case of some bytes.
///
/// # Errors
/// There are too few.
pub fn tied(bytes: &mut Unstructured<'_>) -> Result<Structured> {
    let mut place = bytes.arbitrary::<u8>()?;
    let of_place = |&(share, shape): &(u8, Option<Shape>)| match place.checked_sub(share) {
        None => Some(shape),
        Some(rest) => {
            place = rest;
            None
        }
    };
    let shape = ROOMS.iter().find_map(of_place).flatten();
    let pose = if bytes.ratio(1, 3)? { Pose::Turned } else { Pose::Plain };
    let also = match bytes.int_in_range(0..=15_u8)? {
        0 => Also::Oracle,
        1 | 2 => Also::SecondMoments,
        3 => Also::NoFacets,
        _ => Also::Nothing,
    };
    let count = match bytes.int_in_range(0..=255_u8)? {
        n @ 0..160 => 1 + n % 4,
        n @ 160..230 => 5 + n % 4,
        n @ 230..252 => 9 + n % 6,
        n => 16 + 8 * (n % 4),
    };
    let &(lowest, highest, steps) = bytes.choose(&LATTICES)?;
    let &angle = bytes.choose(&ANGLES)?;
    let nudged = bytes.ratio(1, 4)?;
    let &scale = bytes.choose(&SCALES)?;
    let weighting = bytes.int_in_range(0..=7_u8)?;

    let within = shape.map_or(Room::Box([0.0; 3], [1.0; 3]), |shape| room(shape, Pose::Plain));
    let (lo, _) = within.bounding_box();
    let (lo, extents) = (DVec3::from(lo), within.extents());
    let middle = lo + 0.5 * extents;
    let turn = DMat3::from_axis_angle(DVec3::new(0.3, -1.0, 0.7).normalize(), angle);
    // Boxes that are given as boxes stay where they are.
    let (matrix, shift) = match within {
        Room::Box(..) => Pose::Plain.motion(),
        Room::Mesh(..) => pose.motion(),
    };
    let (mut positions, mut weights) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let mut at = DVec3::ZERO;
        for k in 0..3 {
            at[k] = f64::from(bytes.int_in_range(lowest..=highest)?) / f64::from(steps);
        }
        let place = matrix * (middle + turn * (lo + extents * at - middle)) + shift;
        let nudge = if nudged { bytes.int_in_range(0..=26_u8)? } else { 13 };
        let nudges = [nudge / 9, nudge / 3 % 3, nudge % 3];
        positions
            .push(std::array::from_fn(|k| [place[k].next_down(), place[k], place[k].next_up()][nudges[k] as usize]));
        match weighting {
            0 | 1 => {}
            2 => weights.push(DVec3::from(positions[positions.len() - 1]).distance_squared(matrix * middle + shift)),
            3 => weights.push(scale),
            _ => weights.push(scale * bytes.choose(&WEIGHTS)?),
        }
    }
    Ok(Structured::new(shape, pose, positions, weights, also))
}
