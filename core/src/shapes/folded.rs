//! Prisms whose caps fold over themselves, nearly in a plane.

use std::f64::consts::TAU;

use super::{Mesh, index};

/// A concave section of a prism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// A star of twelve corners, every other one at four tenths of the radius.
    Star,
    /// An L of six corners.
    Corner,
    /// A comb of twelve corners, with three teeth.
    Comb,
}

impl Section {
    /// All sections.
    pub const ALL: [Self; 3] = [Self::Star, Self::Corner, Self::Comb];

    /// The corners, counterclockwise. From the first of them not all others are seen.
    fn corners(self) -> Vec<[f64; 2]> {
        match self {
            Self::Star => {
                let corner = |k: u32| {
                    let radius = if k.is_multiple_of(2) { 0.5 } else { 0.2 };
                    let (sin, cos) = (TAU * f64::from(k) / 12.0).sin_cos();
                    [0.5 + radius * cos, 0.5 + radius * sin]
                };
                (0..12).map(corner).collect()
            }
            Self::Corner => vec![[1.0, 0.0], [1.0, 0.3], [0.4, 0.35], [0.3, 1.0], [0.0, 1.0], [0.0, 0.0]],
            Self::Comb => vec![
                [1.0, 1.0],
                [0.8, 1.0],
                [0.75, 0.3],
                [0.6, 0.35],
                [0.6, 0.9],
                [0.4, 1.0],
                [0.4, 0.25],
                [0.2, 0.3],
                [0.2, 1.0],
                [0.0, 0.95],
                [0.0, 0.0],
                [1.0, 0.0],
            ],
        }
    }
}

/// A prism of height ½ along z. Each cap is a fan about the section's first corner, from which not all of it is seen, so that the fan
/// folds over itself; and each corner is off the cap's plane by up to `off` (length). Between the folds are slabs, as thin as that, around
/// which the surface goes −1, 0, 1 or 2 times. The volume is whatever the corners make it.
pub fn folded_prism(section: Section, off: f64) -> Mesh {
    let section = section.corners();
    let n = index(section.len());
    // SplitMix64: as good as any, and the same everywhere.
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        2.0 * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
    };
    let mut vertices = Vec::new();
    for height in [0.0, 0.5] {
        vertices.extend(section.iter().map(|&[x, y]| [x, y, height + off * random()]));
    }
    let caps = (2..n).flat_map(|k| [[0, k, k - 1], [n, n + k - 1, n + k]]);
    let sides = (0..n).map(|k| (k, (k + 1) % n)).flat_map(|(k, next)| [[k, next, n + next], [k, n + next, n + k]]);
    let triangles = caps.chain(sides).collect();
    Mesh { vertices, triangles }
}
