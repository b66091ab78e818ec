//! Volumes and moments of tetrahedra, and of what bisectors leave of them: with nothing of the library.

use glam::{DMat3, DVec3};
use laguerre_core::summation::Sum;

/// Rows and columns of the entries of a second moment, as the output orders them.
pub const ENTRIES: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];

/// Corners, relative to some point.
pub type Tetrahedron = [DVec3; 4];

/// Integrals over something, about some point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    volume: Sum,
    first: [Sum; 3],
    second: [Sum; 6],
}

impl Moments {
    /// Adds the integrals over `tetrahedron` times `weight`.
    pub fn add(&mut self, weight: f64, tetrahedron: &Tetrahedron) {
        let [a, b, c, d] = *tetrahedron;
        let volume = weight * DMat3::from_cols(b - a, c - a, d - a).determinant().abs() / 6.0;
        let sum = a + b + c + d;
        self.volume.add(volume);
        (0..3).for_each(|k| self.first[k].add(volume / 4.0 * sum[k]));
        for (k, [r, s]) in ENTRIES.into_iter().enumerate() {
            let products = a[r] * a[s] + b[r] * b[s] + c[r] * c[s] + d[r] * d[s];
            self.second[k].add(volume / 20.0 * (products + sum[r] * sum[s]));
        }
    }

    /// Adds `other`.
    pub fn merge(&mut self, other: &Self) {
        self.volume.add(other.volume());
        (0..3).for_each(|k| self.first[k].add(other.first()[k]));
        (0..6).for_each(|k| self.second[k].add(other.second()[k]));
    }

    /// Volume (length³).
    pub fn volume(&self) -> f64 {
        self.volume.total()
    }

    /// ∫ x (length⁴).
    pub fn first(&self) -> DVec3 {
        DVec3::from_array(self.first.map(|s| s.total()))
    }

    /// ∫ x xᵀ (length⁵).
    pub fn second(&self) -> [f64; 6] {
        self.second.map(|s| s.total())
    }
}

/// Adds to `rest` what of `tetrahedron` is below 0 by the linear function `height`, and what is at 0 where `at_0` is set.
pub fn cut(tetrahedron: &Tetrahedron, height: impl Fn(DVec3) -> f64, at_0: bool, rest: &mut Vec<Tetrahedron>) {
    let mut corners = tetrahedron.map(|x| (height(x), x));
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [a, b, c, d] = corners.map(|(_, x)| x);
    let on_edge = |k: usize, l: usize| {
        let ((h, x), (g, y)) = (corners[k], corners[l]);
        x + (y - x) * (h / (h - g))
    };
    // Of a prism with the one triangle above the other.
    let mut prism = |[a, b, c]: [DVec3; 3], [x, y, z]: [DVec3; 3]| {
        rest.extend([[a, b, c, z], [a, b, y, z], [a, x, y, z]]);
    };
    match corners.iter().filter(|(h, _)| *h < 0.0 || (*h == 0.0 && at_0)).count() {
        0 => (),
        1 => rest.push([a, on_edge(0, 1), on_edge(0, 2), on_edge(0, 3)]),
        2 => prism([a, on_edge(0, 2), on_edge(0, 3)], [b, on_edge(1, 2), on_edge(1, 3)]),
        3 => prism([a, b, c], [on_edge(0, 3), on_edge(1, 3), on_edge(2, 3)]),
        _ => rest.push([a, b, c, d]),
    }
}
