//! How the sites of a case are weighted.

use glam::DVec3;

use crate::domains::Room;
use crate::sites::Random;

/// A choice of weights (length²), in units of the spacing squared (volume per site)^⅔, or of the room's largest extent L.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// None given: a Voronoi diagram.
    None,
    /// All equal, but not zero.
    Equal,
    /// Within a tenth of the spacing².
    Mild,
    /// Within four spacings²: many cells do not contain their site, some are hidden.
    Strong,
    /// Within 0.1 L²: most cells are hidden.
    Hiding,
    /// One of four values: ties between weighted sites.
    Ties,
    /// One site has 0.09 L², the others nothing.
    OneHeavy,
    /// ‖p − m‖², m the middle of the room: every bisector passes through m.
    Concurrent,
}

impl Weights {
    /// All choices, the simplest first.
    pub const ALL: [Self; 8] =
        [Self::None, Self::Equal, Self::Mild, Self::Strong, Self::Hiding, Self::Ties, Self::OneHeavy, Self::Concurrent];
}

/// Weights for `positions` in `room`.
pub fn weigh(weights: Weights, positions: &[[f64; 3]], room: &Room, random: &mut Random) -> Vec<f64> {
    let extents = room.extents();
    let count = positions.len();
    let spacing2 = (extents.element_product() / count as f64).powf(2.0 / 3.0);
    let largest2 = extents.max_element().powi(2);
    let mut each = |range: f64| (0..count).map(|_| range * random.unit()).collect();
    match weights {
        Weights::None => Vec::new(),
        Weights::Equal => vec![0.375 * largest2; count],
        Weights::Mild => each(0.1 * spacing2),
        Weights::Strong => each(4.0 * spacing2),
        Weights::Hiding => each(0.1 * largest2),
        Weights::Ties => (0..count).map(|_| 0.25 * spacing2 * random.below(4) as f64).collect(),
        Weights::OneHeavy => {
            let heavy = random.below(count);
            (0..count).map(|i| if i == heavy { 0.09 * largest2 } else { 0.0 }).collect()
        }
        Weights::Concurrent => {
            let (lo, hi) = room.bounding_box();
            let middle = 0.5 * (DVec3::from(lo) + DVec3::from(hi));
            positions.iter().map(|&p| DVec3::from(p).distance_squared(middle)).collect()
        }
    }
}
