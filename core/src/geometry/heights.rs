//! How high the vertices of the domain's surface are over the half-spaces of a cell, and exact signs of determinants of that.
//!
//! On a triangle of the surface a half-space is an affine function, given by its heights `L = n·(x − p) + d` at the three corners: a row. In such
//! coordinates an edge of the triangle is a row, too, (1, 0, 0) for that across the first corner, and whether the point where two lines meet is
//! within a third is the sign of the determinant of three rows. Two triangles at an edge ask the same numbers of its ends.

use super::surface::Line;
use crate::cell::{Plane, Real, UNIT_ROUNDOFF, V3, v3};
use crate::exact::{self, Dyadic};

/// Roundings of a height: one for each difference, four for the sum of products.
const ROUNDINGS: Real = 16.0 * UNIT_ROUNDOFF;

/// A height as computed, and how far it may be off.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Height {
    pub(super) value: Real,
    pub(super) error: Real,
}

/// Heights of some vertices of the surface over all half-spaces of a cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Heights {
    site: V3,
    planes: Vec<Plane>,
    points: Vec<V3>,
    heights: Vec<Height>,
}

impl Heights {
    /// Begins with a cell of these half-spaces, in the frame of its site.
    pub(super) fn begin(&mut self, site: V3, planes: impl Iterator<Item = Plane>) {
        self.site = site;
        self.planes.clear();
        self.planes.extend(planes);
        self.points.clear();
        self.heights.clear();
    }

    /// Adds a vertex, in the diagram's frame; its number.
    pub(super) fn add(&mut self, point: V3) -> u32 {
        let x = v3(point.x - self.site.x, point.y - self.site.y, point.z - self.site.z);
        for plane in &self.planes {
            let n = plane.n;
            let products = [n.x * x.x, n.y * x.y, n.z * x.z];
            self.heights.push(Height {
                value: (products[0] + products[1]) + products[2] + plane.d,
                error: ROUNDINGS * (products.iter().map(|p| p.abs()).sum::<Real>() + plane.d.abs()),
            });
        }
        self.points.push(point);
        (self.points.len() - 1) as u32
    }

    /// That of vertex `i` over half-space `f`.
    pub(super) fn of(&self, i: u32, f: u32) -> Height {
        self.heights[i as usize * self.planes.len() + f as usize]
    }

    /// The half-spaces.
    pub(super) fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// Whether vertex `i` is within half-space `f`: zero is.
    pub(super) fn is_within(&self, i: u32, f: u32) -> bool {
        let Height { value, error } = self.of(i, f);
        if value.abs() > error { value > 0.0 } else { self.exact(i, f).sign() >= 0 }
    }

    /// Whether `L_g(i) L_f(j) − L_g(j) L_f(i)` is not negative.
    pub(super) fn is_within_on_edge(&self, [i, j]: [u32; 2], g: u32, f: u32) -> bool {
        let [gi, gj, fi, fj] = [self.of(i, g), self.of(j, g), self.of(i, f), self.of(j, f)];
        let value = gi.value * fj.value - gj.value * fi.value;
        let size = |x: Height| x.value.abs() + x.error;
        let most = size(gi) * size(fj) + size(gj) * size(fi);
        let least = (gi.value * fj.value).abs() + (gj.value * fi.value).abs();
        if value.abs() > (most - least) + ROUNDINGS * most {
            return value > 0.0;
        }
        let [gi, gj, fi, fj] = [(i, g), (j, g), (i, f), (j, f)].map(|(i, f)| self.exact(i, f));
        gi.times(&fj).plus(&gj.times(&fi).negated()).sign() >= 0
    }

    /// Whether the determinant of the rows of half-spaces `f` on the triangle of three vertices is not negative.
    pub(super) fn is_within_on_triangle(&self, corners: [u32; 3], f: [u32; 3]) -> bool {
        let rows = f.map(|f| corners.map(|i| self.of(i, f)));
        let value = determinant(rows.map(|row| row.map(|x| x.value)), -1.0);
        let most = determinant(rows.map(|row| row.map(|x| x.value.abs() + x.error)), 1.0);
        let least = determinant(rows.map(|row| row.map(|x| x.value.abs())), 1.0);
        if value.abs() > (most - least) + ROUNDINGS * most {
            return value > 0.0;
        }
        exact::determinant_of_rows(&f.map(|f| corners.map(|i| self.exact(i, f)))).sign() >= 0
    }

    /// Where a line of the triangle of three vertices meets half-space `f`, as shares of the vertices, each rounded once: along an edge, given by
    /// the number of its first corner, or along half-space `g`. `None` where they are parallel.
    pub(super) fn shares(&self, corners: [u32; 3], line: Line, f: u32) -> Option<[Real; 3]> {
        let row = |f: u32| corners.map(|i| self.exact(i, f));
        let other = match line {
            Line::Edge(k) => [0, 1, 2].map(|i| Dyadic::new(if i == (k + 2) % 3 { 1.0 } else { 0.0 })),
            Line::HalfSpace(g) => row(g),
        };
        let shares = exact::cross(&other, &row(f));
        let sum = shares[0].plus(&shares[1]).plus(&shares[2]);
        (sum.sign() != 0).then(|| shares.map(|share| share.over(&sum)))
    }

    /// The height itself, no digit lost.
    fn exact(&self, i: u32, f: u32) -> Dyadic {
        let (x, site, plane) = (self.points[i as usize], self.site, self.planes[f as usize]);
        let term = |n: Real, x: Real, site: Real| Dyadic::new(n).times(&Dyadic::new(x).plus(&Dyadic::new(-site)));
        let n = plane.n;
        let [a, b, c] = [term(n.x, x.x, site.x), term(n.y, x.y, site.y), term(n.z, x.z, site.z)];
        a.plus(&b).plus(&c).plus(&Dyadic::new(plane.d))
    }
}

/// The determinant, or with `sign` 1 the permanent.
fn determinant([a, b, c]: [[Real; 3]; 3], sign: Real) -> Real {
    let minor = |i: usize, j: usize| b[i] * c[j] + sign * (b[j] * c[i]);
    a[0] * minor(1, 2) + sign * (a[1] * minor(0, 2)) + a[2] * minor(0, 1)
}
