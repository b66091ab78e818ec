//! Diagrams of uneven sites and weights, and of folded meshes: clusters of many scales, sites on lines, planes and spheres, weights far from
//! uniform; often so many sites that the search is completed by the cell's vertices (`core/src/cell/far.rs`).

use glam::DVec3;
use laguerre_conformance::domains::{Pose, Room, Shape, room};
use laguerre_conformance::sites::Random;

use crate::case::{Also, Structured};

/// Rooms; a third of the cases are in prisms that fold over themselves.
const ROOMS: [Option<Shape>; 12] = [
    None,
    None,
    Some(Shape::Box),
    Some(Shape::Box),
    Some(Shape::FlatBox),
    Some(Shape::LongBox),
    Some(Shape::BoxMesh),
    Some(Shape::Tetrahedron),
    Some(Shape::Plate),
    Some(Shape::Sphere),
    Some(Shape::Cavity),
    Some(Shape::TouchingInPartOfFace),
];

/// Powers of ten by which the caps of folded prisms are off their planes, at most. The thinner the slabs, the more cells have nothing but one that
/// is empty to rounding.
const LEAST_OFF: usize = 9;

/// A case of a random stream.
pub fn uneven(random: &mut Random) -> Structured {
    let shape = if random.below(3) == 0 {
        let powers = 1 + random.below(LEAST_OFF) as u8;
        let folded = [Shape::FoldedStar(powers), Shape::FoldedCorner(powers), Shape::FoldedComb(powers)];
        Some(folded[random.below(3)])
    } else {
        ROOMS[random.below(ROOMS.len())]
    };
    let pose = Pose::ALL[random.below(2)];
    let also = match random.below(16) {
        0..4 => Also::Oracle,
        4..6 => Also::SecondMoments,
        6 => Also::NoFacets,
        _ => Also::Nothing,
    };
    let count = match random.below(20) {
        0..12 => 1 + random.below(12),
        12..18 => 13 + random.below(40),
        _ => 60 + random.below(141),
    };
    let within = shape.map_or(Room::Box([0.0; 3], [1.0; 3]), |shape| room(shape, pose));
    let (lo, _) = within.bounding_box();
    let (lo, extents) = (DVec3::from(lo), within.extents());
    let mut places = place(count, lo, extents, random);
    if random.below(8) == 0 {
        // An outlier, some within the room and some far outside.
        let last = places.len() - 1;
        places[last] = lo + extents * (0.5 + power(random, -1.0, 1.0) * random.direction());
    }
    let weights = weigh(&places, lo, extents, random);
    let positions = places.into_iter().map(Into::into).collect();
    Structured::new(shape, pose, positions, weights, also)
}

/// Ten to a power between two.
fn power(random: &mut Random, least: f64, most: f64) -> f64 {
    10_f64.powf(least + (most - least) * random.unit())
}

/// Sites in the box, and some beside it.
fn place(count: usize, lo: DVec3, extents: DVec3, random: &mut Random) -> Vec<DVec3> {
    let white = |random: &mut Random| lo + extents * random.point();
    let width = extents.max_element();
    let middle = white(random);
    match random.below(7) {
        0 => {
            // Plummer's sphere: half of the sites within 1.3 of its radius, some far away.
            let radius = width * power(random, -4.0, -1.0);
            let distance = |random: &mut Random| (random.unit().max(1e-4).powf(-2.0 / 3.0) - 1.0).max(0.0).sqrt();
            (0..count)
                .map(|_| {
                    let reach = radius / distance(random).max(1e-9);
                    middle + reach.min(3.0 * width) * random.direction()
                })
                .collect()
        }
        1 => {
            // Clusters of many scales, each about a site of those before it.
            let mut sites = vec![middle];
            let (mut center, mut scale) = (middle, width * power(random, -9.0, -3.0));
            while sites.len() < count {
                if random.below(1 + count / 4) == 0 {
                    center = if random.below(2) == 0 { white(random) } else { sites[random.below(sites.len())] };
                    scale = width * power(random, -9.0, -3.0);
                }
                sites.push(center + scale * (random.point() - 0.5));
            }
            sites
        }
        2 => {
            // Ever nearer to a point.
            let shrink = 0.1 + 0.85 * random.unit();
            (0..count).map(|i| middle + width * shrink.powi(i as i32).max(1e-12) * random.direction()).collect()
        }
        3 => {
            // A line, a plane or a box, as flat as that.
            let turn = random.rotation();
            let flat = DVec3::new(1.0, power(random, -17.0, 0.0), power(random, -17.0, 0.0));
            let turn = |x: DVec3| if flat.z < 1e-16 { x } else { turn * x };
            (0..count).map(|_| middle + turn(width * flat * (random.point() - 0.5))).collect()
        }
        4 => {
            // A sphere, up to rounding or less round.
            let (radius, off) = (width * power(random, -6.0, 0.0), power(random, -17.0, -1.0));
            (0..count).map(|_| middle + radius * (1.0 + off * random.unit()) * random.direction()).collect()
        }
        5 => {
            // White, and a cluster.
            let scale = power(random, -9.0, -2.0);
            let spread = |random: &mut Random| if random.below(2) == 0 { 1.0 } else { scale };
            (0..count).map(|_| middle + spread(random) * (white(random) - middle)).collect()
        }
        _ => (0..count).map(|_| white(random)).collect(),
    }
}

/// Weights, or none.
fn weigh(places: &[DVec3], lo: DVec3, extents: DVec3, random: &mut Random) -> Vec<f64> {
    let count = places.len();
    let largest_2 = extents.max_element().powi(2);
    let spacing_2 = (extents.element_product() / count as f64).powf(2.0 / 3.0);
    let middle = lo + extents * random.point();
    let mut weights = vec![0.0; count];
    let parts = random.below(3);
    for _ in 0..parts {
        match random.below(4) {
            0 => {
                // From cells that are three times as wide as without to cells a twentieth.
                let curvature = -2.0 + 2.95 * random.unit();
                weights.iter_mut().zip(places).for_each(|(w, x)| *w += curvature * x.distance_squared(middle));
            }
            1 => {
                let slope = extents.max_element() * power(random, -6.0, 0.5) * random.direction();
                weights.iter_mut().zip(places).for_each(|(w, x)| *w += slope.dot(*x - middle));
            }
            2 => weights[random.below(count)] += largest_2 * power(random, -6.0, 0.5),
            _ => {
                let range = spacing_2 * power(random, -12.0, 1.5);
                weights.iter_mut().for_each(|w| *w += range * random.unit());
            }
        }
    }
    if parts == 0 { Vec::new() } else { weights }
}
