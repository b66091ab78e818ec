//! How far a number of a result file may be off, and why.
//!
//! Each bound is a tolerance, the project's promise unless the user gave his own, plus what rounding does to one cell. The planes of
//! cell i are off by some roundings of its reach `R`, the largest length that goes into them: for a cell inside, its own size and
//! the distance of its neighbours; for one at the boundary, the distance from its site to the farthest corner of the container, whose
//! coordinates all go through the site's frame. A volume is off by that times the cell's surface, a moment by that times `R` again, an
//! area by that times a length and the condition number of its vertices. Last comes the rounding of the file's numbers, which a
//! tolerance given by the user is taken for, too.

use std::f64::consts::TAU;

use laguerre::Container;
use laguerre::summation::{SUM, bound_of_volumes};
use laguerre::{Output, PowerDiagram, Result};

use crate::container::Whole;

/// u: the relative error of one rounding, 2⁻⁵³, and of one to a 32-bit float.
const U: f64 = f64::EPSILON / 2.0;
const U_SINGLE: f64 = f32::EPSILON as f64 / 2.0;

/// What a cell may be off, relative to the mean volume (moment: times the mean cell's size), and a facet, relative to the mean area.
pub(crate) const CELL: f64 = 1e-12;
/// Roundings of a plane or a vertex, in units of u·R: 5 for a bisector's offset, 1 for each coordinate, 10 for a vertex.
const ROUNDINGS: f64 = 16.0;
/// Displacements of planes by which two may be apart and still be one.
const FEW: f64 = 8.0;

/// The bounds for a file about one diagram.
#[derive(Clone)]
pub(super) struct Bounds<'a> {
    diagram: &'a PowerDiagram,
    again: &'a Output,
    cells: Vec<Scale>,
    /// Triangles of the container's surface.
    faces: Vec<[[f64; 3]; 3]>,
    /// Area of the container's surface.
    pub(super) surface: f64,
    cell: f64,
    sum: f64,
    /// What the file's numbers may be off relative to themselves.
    stored: f64,
    mean_volume: f64,
    mean_area: f64,
    volume: f64,
    diagonal: f64,
    /// The largest distance of a site from a corner of what is integrated.
    farthest_corner: f64,
    /// Largest magnitude of a coordinate of the container.
    coordinate: f64,
}

/// The lengths and areas of one cell that rounding acts on.
#[derive(Clone, Copy)]
struct Scale {
    reach: f64,
    /// Of the whole cell, 0 where it is empty, and the part of it in the container's surface.
    surface: f64,
    boundary: f64,
}

impl<'a> Bounds<'a> {
    /// The bounds for `diagram`, of which `again` is an output with facets and second moments. `single` says that the file's
    /// numbers went through 32-bit floats.
    pub(super) fn new(
        diagram: &'a PowerDiagram,
        whole: &Whole,
        again: &'a Output,
        tolerance: Option<f64>,
        single: bool,
    ) -> Result<Self> {
        let faces = faces(&diagram.container()?);
        let n = diagram.positions().len();
        let cells: Vec<Scale> = (0..n).map(|i| scale(diagram, whole, again, i)).collect();
        let areas = again.facets().map_or(&[][..], |f| f.area());
        let surface = faces.iter().map(|&[a, b, c]| length(cross(sub(b, a), sub(c, a))) / 2.0).sum();
        Ok(Self {
            diagram,
            again,
            cells,
            faces,
            surface,
            cell: tolerance.unwrap_or(CELL),
            sum: tolerance.unwrap_or(SUM),
            stored: tolerance.unwrap_or(0.0).max(if single { U_SINGLE } else { U }),
            mean_volume: whole.volume / n as f64,
            mean_area: if areas.is_empty() { surface } else { areas.iter().sum::<f64>() / areas.len() as f64 },
            volume: whole.volume,
            diagonal: whole.diagonal(),
            farthest_corner: (0..n).map(|i| farthest_corner(diagram, whole, i)).fold(0.0, f64::max),
            coordinate: whole.lo.iter().chain(&whole.hi).fold(0.0, |m, x| x.abs().max(m)),
        })
    }

    /// The bounds for some cells of a diagram within a domain, given with `convex`, an output of these cells in the domain's
    /// grid: a cell's pieces outside the domain are taken off again, and their rounding stays.
    pub(super) fn widened(&self, some: impl IntoIterator<Item = usize>, convex: &Output) -> Self {
        let mut wide = self.clone();
        let (Some(facets), Some(boundary)) = (convex.facets(), convex.boundary()) else { return wide };
        for i in some {
            let surface = facets.of(i).map(|facet| facet.area).sum::<f64>() + boundary[i].area;
            let scale = &mut wide.cells[i];
            if scale.boundary > 0.0 {
                scale.surface = scale.surface.max(surface);
            }
        }
        wide
    }

    /// Of the volume `v` of cell `i` (length³).
    pub(super) fn volume(&self, i: usize, v: f64) -> f64 {
        self.cell * self.mean_volume + self.cell_rounding(i) + self.stored * v.abs()
    }

    /// Of volume `v` times the barycenter of cell `i` (length⁴).
    pub(super) fn moment(&self, i: usize, v: f64) -> f64 {
        self.cell * self.mean_volume * self.mean_volume.cbrt()
            + self.cell_rounding(i) * self.cells[i].reach
            + self.moved(v)
    }

    /// Of the sum of all volumes, relative to the container's: the law of sums, and the rounding of the file's numbers.
    pub(super) fn volume_sum(&self) -> f64 {
        self.sum + self.stored + {
            let grid = self.diagram.domain().map_or(0.0, |domain| domain.grid_volume(self.cells.len()));
            bound_of_volumes(0.0, self.surface, self.farthest_corner, grid) / self.volume
        }
    }

    /// Of the barycenter of all cells together, relative to the diagonal.
    pub(super) fn barycenter_sum(&self) -> f64 {
        self.volume_sum() + (ROUNDINGS * U + self.stored) * self.coordinate / self.diagonal
    }

    /// Of the sum of the areas of the boundary (length²).
    pub(super) fn boundary_sum(&self) -> f64 {
        let rounding = self.cells.iter().map(|s| ROUNDINGS * U * s.reach * s.boundary.sqrt()).sum::<f64>();
        (self.cell + self.stored) * self.surface + rounding
    }

    /// Of an area `area` of a facet of cells `i` and `j` (length²). What the vertices' condition adds is looked for only where
    /// `off` exceeds the rest.
    pub(super) fn area(&self, i: usize, j: usize, area: f64, off: f64) -> f64 {
        let of = |condition: [f64; 2]| {
            // A facet's rim is no longer than that of the disc of its reach.
            let rounding = |i: usize, c: f64| ROUNDINGS * U * TAU * self.cells[i].reach.powi(2) * c;
            self.cell * self.mean_area
                + rounding(i, condition[0]).max(rounding(j, condition[1]))
                + self.stored * area.abs()
        };
        let simple = of([1.0; 2]);
        if off <= simple { simple } else { of([self.condition(i), self.condition(j)]) }
    }

    /// What the rounding of coordinates does to the moment of a volume or area `size` (its unit times length).
    pub(super) fn moved(&self, size: f64) -> f64 {
        (ROUNDINGS * U + self.stored) * self.coordinate * size.abs()
    }

    /// Of the distance `d` of two sites, of which `i` is one.
    pub(super) fn distance(&self, i: usize, d: f64) -> f64 {
        (self.cell + self.stored) * d + ROUNDINGS * U * self.cells[i].reach
    }

    /// The reach of cell `i` (length).
    pub(super) fn reach(&self, i: usize) -> f64 {
        self.cells[i].reach
    }

    /// Whether nothing but rounding decides what the facet of `i` and `j` is: its bisector contains a triangle of the surface, so that
    /// it is facet or boundary; or it is also that of a third site, whose cell is flat between them: then any two of the three may
    /// have the facet.
    pub(super) fn is_undecided(&self, i: usize, j: usize) -> bool {
        let rounding = FEW * ROUNDINGS * U * self.farthest(i).max(self.farthest(j));
        let in_surface = self.faces.iter().any(|face| face.iter().all(|&x| self.height(x, i, j).abs() <= rounding));
        in_surface || self.has_flat_cell_between(i, j, rounding) || self.has_flat_cell_between(j, i, rounding)
    }

    /// Whether some third site's bisector with `i` is that of `j`, to rounding, all over the container.
    fn has_flat_cell_between(&self, i: usize, j: usize, rounding: f64) -> bool {
        let corners: Vec<([f64; 3], f64)> = self.faces.iter().flatten().map(|&x| (x, self.height(x, i, j))).collect();
        (0..self.cells.len()).any(|k| {
            k != i && k != j && corners.iter().all(|&(x, height)| (self.height(x, i, k) - height).abs() <= rounding)
        })
    }

    fn cell_rounding(&self, i: usize) -> f64 {
        let Scale { reach, surface, .. } = self.cells[i];
        ROUNDINGS * U * reach * if surface > 0.0 { surface } else { reach * reach }
    }

    /// The distance from site `i` to the farthest vertex of the container.
    fn farthest(&self, i: usize) -> f64 {
        let p = self.diagram.positions()[i];
        self.faces.iter().flatten().map(|&x| length(sub(x, p))).fold(0.0, f64::max)
    }

    /// Distance from site `i` to the nearest other site at another position (length).
    fn nearest(&self, i: usize) -> f64 {
        let p = self.diagram.positions()[i];
        let distances = self.diagram.positions().iter().map(|&q| length(sub(q, p)));
        distances.filter(|&d| d > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// Signed distance of `x` from the bisector of sites `i` and `j`, negative on the side of `i`.
    fn height(&self, x: [f64; 3], i: usize, j: usize) -> f64 {
        let (p, q) = (self.diagram.positions()[i], self.diagram.positions()[j]);
        let weight = |i: usize| self.diagram.weights().get(i).copied().unwrap_or(0.0);
        let (d, middle) = (sub(q, p), [0, 1, 2].map(|k| 0.5 * (p[k] + q[k])));
        (2.0 * dot(d, sub(x, middle)) - (weight(i) - weight(j))) / (2.0 * length(d))
    }

    /// How much the vertices of cell `i`'s facets amplify a displacement of planes: the inverse of the smallest sine of the angle between
    /// two planes that may meet. Two facets on one side; those of a neighbour and of the site nearest to it, which may be listed
    /// nowhere, but cut the facet outside the container; a facet and a triangle that it touches; and in a cell of thickness t = V/A
    /// its two sides, with sine about t/R.
    fn condition(&self, i: usize) -> f64 {
        let Some(facets) = self.again.facets() else { return 1.0 };
        let Scale { reach, surface, boundary } = self.cells[i];
        let volume = self.again.volume()[i].abs();
        let mut worst = if volume > 0.0 { (surface * reach / volume).max(1.0) } else { 1.0 };
        let p = self.diagram.positions()[i];
        let neighbors: Vec<usize> = facets.of(i).map(|facet| facet.neighbor).collect();
        let normals: Vec<[f64; 3]> = neighbors.iter().map(|&j| unit(sub(self.diagram.positions()[j], p))).collect();
        for (k, &a) in normals.iter().enumerate() {
            for &b in normals[..k].iter().filter(|b| dot(a, **b) > 0.0) {
                worst = worst.max(1.0 / length(cross(a, b)));
            }
        }
        for &j in &neighbors {
            let q = self.diagram.positions()[j];
            worst = worst.max(length(sub(q, p)) / self.nearest(j));
        }
        if boundary > 0.0 {
            let rounding = ROUNDINGS * U * reach;
            for (&j, &normal) in neighbors.iter().zip(&normals) {
                for face in &self.faces {
                    let heights = face.map(|x| self.height(x, i, j));
                    if heights.iter().any(|h| *h >= -rounding) && heights.iter().any(|h| *h <= rounding) {
                        let [a, b, c] = *face;
                        worst = worst.max(1.0 / length(cross(unit(cross(sub(b, a), sub(c, a))), normal)));
                    }
                }
            }
        }
        worst
    }
}

/// The scale of cell `i`. The reach of one that is empty is to the whole container: nothing is known of where it almost is.
fn scale(diagram: &PowerDiagram, whole: &Whole, again: &Output, i: usize) -> Scale {
    let p = diagram.positions()[i];
    let (Some(facets), Some(boundary), Some(second)) = (again.facets(), again.boundary(), again.second_moment()) else {
        return Scale { reach: 0.0, surface: 0.0, boundary: 0.0 };
    };
    let far = farthest_corner(diagram, whole, i);
    let volume = again.volume()[i];
    if volume == 0.0 {
        return Scale { reach: far, surface: 0.0, boundary: 0.0 };
    }
    let surface = facets.of(i).map(|facet| facet.area).sum::<f64>() + boundary[i].area;
    let neighbors = facets.of(i).map(|facet| facet.distance).fold(0.0, f64::max);
    let variance = second[i][..3].iter().sum::<f64>() / volume;
    // A convex body in three dimensions reaches from its barycenter at most √15 deviations along any direction (Kannan, Lovász,
    // Simonovits, 1995).
    let reach = length(sub(again.barycenter()[i], p)) + 4.0 * variance.max(0.0).sqrt() + neighbors;
    let reach = if boundary[i].area > 0.0 { far + neighbors } else { reach };
    Scale { reach, surface, boundary: boundary[i].area }
}

/// The distance from site `i` to the farthest corner of what is integrated.
fn farthest_corner(diagram: &PowerDiagram, whole: &Whole, i: usize) -> f64 {
    let p = diagram.positions()[i];
    let far = [0, 1, 2].map(|k| (whole.hi[k] - p[k]).abs().max((whole.lo[k] - p[k]).abs()));
    // A domain's grid encloses it by up to a voxel, at most half an extent.
    let margin = (0..3).map(|k| 0.5 * (whole.hi[k] - whole.lo[k])).fold(0.0, f64::max);
    length(far) + margin
}

/// The triangles of the container's surface.
fn faces(container: &Container) -> Vec<[[f64; 3]; 3]> {
    match container {
        Container::Domain(domain) => {
            domain.triangles().iter().map(|t| t.map(|v| domain.vertices()[v as usize])).collect()
        }
        Container::Box(lo, hi) => {
            let corner = |c: usize| [0, 1, 2].map(|k| if c >> k & 1 == 1 { hi[k] } else { lo[k] });
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(corner)).collect()
        }
    }
}

pub(super) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn length(a: [f64; 3]) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let l = length(a);
    a.map(|x| x / l)
}
