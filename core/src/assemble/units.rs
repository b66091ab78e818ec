//! Lengths and places of the caller's.

use super::area_unit;
use crate::Boundary;
use crate::cell::{CellSums, V3};
use crate::frame::Frame;

/// What takes the sums of a finished cell, in the frame of its site, to the caller's lengths and place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Units {
    pub(super) frame: Frame,
    /// Mass per volume where the winding number is one.
    pub(super) density: f64,
}

impl Units {
    /// A volume, or an integral over one.
    pub(super) fn volume(&self, volume: f64) -> f64 {
        volume * (self.density * self.frame.unit().powi(3))
    }

    /// An area.
    pub(super) fn area(&self, area: f64) -> f64 {
        area * area_unit(&self.frame, self.density)
    }

    /// The barycenter of the cell of the site at `position` (the caller's).
    pub(super) fn barycenter(&self, position: [f64; 3], sums: &CellSums) -> [f64; 3] {
        self.place(position, sums.first, sums.volume)
    }

    /// The place of a first moment about a site.
    pub(super) fn place(&self, position: [f64; 3], m: V3, mass: f64) -> [f64; 3] {
        let [x, y, z] = self.frame.enter(position);
        self.frame.leave([x + m.x / mass, y + m.y / mass, z + m.z / mass])
    }

    /// The distance of two sites.
    pub(super) fn distance(&self, p: [f64; 3], q: [f64; 3]) -> f64 {
        self.framed_distance(p, q) * self.frame.unit()
    }

    /// The same in the frame's lengths.
    pub(super) fn framed_distance(&self, p: [f64; 3], q: [f64; 3]) -> f64 {
        let ([x, y, z], [a, b, c]) = (self.frame.enter(p), self.frame.enter(q));
        ((a - x).powi(2) + (b - y).powi(2) + (c - z).powi(2)).sqrt()
    }

    /// The second moments about the barycenter. What the sums about the site have lost is lost: of one site 16 radii from a sphere of 320 triangles
    /// these are 30 roundings of the volume times that distance squared, of which this difference has 0.3.
    pub(super) fn second_moment(&self, sums: &CellSums) -> [f64; 6] {
        let (s, m, v) = (sums, sums.first, sums.volume);
        let second_moment = [
            s.second_diagonal.x - m.x * m.x / v,
            s.second_diagonal.y - m.y * m.y / v,
            s.second_diagonal.z - m.z * m.z / v,
            s.second_mixed.x - m.x * m.y / v,
            s.second_mixed.y - m.x * m.z / v,
            s.second_mixed.z - m.y * m.z / v,
        ];
        second_moment.map(|x| x * (self.density * self.frame.unit().powi(5)))
    }

    /// The piece of the boundary.
    pub(super) fn boundary(&self, position: [f64; 3], sums: &CellSums) -> Boundary {
        if sums.boundary_area == 0.0 {
            return Boundary::default();
        }
        let n = sums.boundary_vector;
        Boundary {
            area: self.area(sums.boundary_area),
            barycenter: self.place(position, sums.boundary_moment, sums.boundary_area),
            vector_area: [n.x, n.y, n.z].map(|a| self.area(a)),
            flux: self.volume(sums.boundary_flux),
        }
    }
}
