//! How much rounding each law allows, and why.
//!
//! All bounds are a relative part, the project's promise, plus the rounding of one cell, which matters where cells are few
//! or stand far from their sites. That rounding is `e = ROUNDINGS·u·D`, `D` the reach of the cell: the distance from its
//! site, the origin of its frame, to the farthest corner of the container. All coordinates in the frame are below
//! `D`, so planes and vertices are off by a few `u·D`; a volume by that times an area below `D²`; an area by that times a
//! length below `D`, times the condition number of the facet's vertices.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec3;
pub use laguerre_core::summation::SUM;
use laguerre_core::summation::bound_of_volumes;
use laguerre_core::{Backend, CellStatus, Output, Precision};

use crate::Scene;
use crate::scene::{Facet, rows};

/// u: the relative error of one rounding, 2⁻⁵³.
pub const U: f64 = f64::EPSILON / 2.0;

/// A cell, relative to the mean volume of a cell (moments: times the mean cell's size).
pub const CELL: f64 = 1e-12;

/// What may be called nothing of a cell in one evaluation and something in another, relative to the mean volume, for up to some thousand
/// sites: its own bound, which a volume must exceed to be believed negative. A piece of a cell of size r, cut off behind a triangle of
/// size L, has some 20 vertices, whose 60 edges have spokes of 0.3 r² and 8 roundings of 1.5 L each, a sixth of which is 4·10⁻¹⁵ L r²; a cell
/// has up to a hundred such pieces, and L/r is up to 15.
pub const NOTHING: f64 = 1e-11;

/// A facet, relative to the mean area of a facet.
pub const FACET: f64 = 1e-12;

/// Closure: of one cell, relative to its own area or volume; of all, relative to the area of the surface.
pub const CLOSURE: f64 = 1e-12;

/// Roundings, in units of u·D, that move a plane or a vertex. A bisector's offset takes 5 (three squares, two sums), a
/// difference of positions 1 per coordinate, a well conditioned vertex (three cross products, their sum, a quotient) about 10.
pub const ROUNDINGS: f64 = 16.0;

/// A cell thinner than so many displacements of its planes may be called empty.
pub const FLAT: f64 = 8.0;

/// Area of a facet, in units of u·D², that may not be believed where it is negative. What is negative is believed beyond the bound of its own
/// rounding alone, and that knows the vertices of the cones, which no law of the scene does. It is at most the way from a vertex to a foot,
/// 2√3 D by sums of magnitudes, times what both are off. A vertex is refined where its planes' determinant is below a 512th of the product of
/// their norms; above, Cramer's rule leaves 32·512 roundings of three offsets and a position, D each: 65,536 u·D. A foot is refined where the
/// sine of its planes' angle is below a 512th; above, there are 512 times 8 roundings of the foot (2√3 D) and 4 of the reference point (√3 D):
/// 17,736 u·D. The displacement of the planes and the cross product are hundreds.
const NOT_BELIEVED: f64 = 3e5;

/// Roundings, in units of u·V·a^k, of a moment of order k of a cell that is integrated in one piece, V its volume, a the distance of its site: as
/// many as one of order 2 takes from the reference point c to the site and back. ∫ xxᵀ about the site is c(2m + Vc) and the rest: 4, one for
/// each operation. The first moment is m + Vc: 2, which count twice. Its square over the volume, which is taken off: 2.
const ROUNDINGS_OF_SHIFT: f64 = 10.0;

/// How many times larger the bounds of volumes and barycenters are where a backend's are single numbers.
pub fn of_digits(backend: &dyn Backend) -> f64 {
    if backend.info().precision == Precision::F32 { f64::from(f32::EPSILON) / f64::EPSILON } else { 1.0 }
}

/// How planes of two evaluations that are compared differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planes {
    /// The same sites and weights: planes differ by their own rounding.
    Same,
    /// Sites or weights were rounded anew, to u·D and u·D²: the bisector of sites at distance `s` turns by u·D/s, and moves
    /// by u·D²/s.
    Rounded,
}

/// The bounds that belong to an evaluated scene. Those of areas need its facets.
#[derive(Debug)]
pub struct Bounds<'a> {
    scene: &'a Scene,
    output: &'a Output,
    /// The facets of each cell.
    rows: Vec<Vec<Facet>>,
    /// The facets that others have with each cell: their sites and areas.
    seen: Vec<Vec<(usize, f64)>>,
    /// For each site its reach D.
    reach: Vec<f64>,
    /// For each site how far its planes and vertices may be off.
    displacement: Vec<f64>,
    /// For each cell how much its facets' vertices amplify that: dear, and found when it is first asked for.
    condition: Vec<OnceCell<f64>>,
    mean_volume: f64,
    mean_area: f64,
    /// See [`of_digits`].
    of_digits: f64,
}

impl<'a> Bounds<'a> {
    /// The bounds for comparing `output` with another evaluation of `scene`.
    pub fn new(scene: &'a Scene, output: &'a Output, planes: Planes) -> Self {
        let rows = rows(output);
        let reach: Vec<f64> = (0..scene.len()).map(|i| reach(scene, i)).collect();
        let displacement = (0..scene.len())
            .map(|i| {
                let closeness = match planes {
                    Planes::Same => 1.0,
                    Planes::Rounded => 1.0 + reach[i] / nearest(scene, i),
                };
                ROUNDINGS * U * reach[i] * closeness
            })
            .collect();
        let mut seen = vec![Vec::new(); scene.len()];
        for (k, row) in rows.iter().enumerate() {
            row.iter().for_each(|f| seen[f.neighbor].push((k, f.area)));
        }
        let areas: Vec<f64> = rows.iter().flatten().map(|f| f.area).collect();
        Self {
            condition: vec![OnceCell::new(); scene.len()],
            reach,
            displacement,
            mean_volume: scene.room.volume() / scene.len() as f64,
            mean_area: areas.iter().sum::<f64>() / areas.len().max(1) as f64,
            rows,
            seen,
            scene,
            output,
            of_digits: 1.0,
        }
    }

    /// The same for numbers of fewer digits, see [`of_digits`].
    #[must_use]
    pub fn in_digits(mut self, of_digits: f64) -> Self {
        self.displacement.iter_mut().for_each(|displacement| *displacement *= of_digits);
        self.of_digits = of_digits;
        self
    }

    /// The facets of each cell.
    pub fn rows(&self) -> &[Vec<Facet>] {
        &self.rows
    }

    /// Distance from site `i` to the farthest point of the container (length).
    pub fn reach(&self, i: usize) -> f64 {
        self.reach[i]
    }

    /// Bound of a volume (length³).
    pub fn volume(&self, i: usize) -> f64 {
        self.of_digits * CELL * self.mean_volume + self.cell_rounding(i)
    }

    /// Bound of a first moment about the site's own cell (length⁴).
    pub fn first_moment(&self, i: usize) -> f64 {
        self.of_digits * CELL * self.mean_volume * self.mean_volume.cbrt() + self.cell_rounding(i) * self.reach[i]
    }

    /// Bound of an area of cell `i`'s facets or boundary (length²); infinite for a cell without thickness.
    pub fn area(&self, i: usize) -> f64 {
        FACET * self.mean_area + self.facet_rounding(i)
    }

    /// What rounding alone does to a volume (length³).
    pub fn cell_rounding(&self, i: usize) -> f64 {
        self.displacement[i] * self.reach[i].powi(2)
    }

    /// What rounding alone does to an area (length²).
    pub fn facet_rounding(&self, i: usize) -> f64 {
        self.least_facet_rounding(i) * self.condition(i)
    }

    /// How much the vertices of cell `i` amplify a displacement of its planes.
    fn condition(&self, i: usize) -> f64 {
        *self.condition[i].get_or_init(|| condition(self, i))
    }

    /// What rounding does to an area of the best condition, 1 (length²): at most [`Bounds::facet_rounding`], and cheap. What is
    /// within this need not be held against that.
    pub fn least_facet_rounding(&self, i: usize) -> f64 {
        self.displacement[i] * self.reach[i]
    }

    /// Bound of the area of a facet that another cell shares with cell `i`, if that is empty (length²): a cell may be called so
    /// while its volume V is below its rounding. The height of a convex cell over a point of its facet is at least the distance
    /// to the facet's edge times sin θ, the smallest angle between two of its planes; the mean of that distance is a third of the
    /// facet's inradius or more, and that at least area/(πd), d the diameter, at most 2D. So V ≥ sin θ area²/(6πD).
    pub fn facet_of_empty(&self, i: usize) -> f64 {
        (6.0 * PI * self.reach[i] * self.cell_rounding(i) * self.condition(i)).sqrt()
    }

    /// Area of a negative facet of cell `i` that may be missing there (length²): `NOT_BELIEVED`.
    pub fn not_believed(&self, i: usize) -> f64 {
        NOT_BELIEVED * U * self.reach[i].powi(2)
    }

    /// The facets that cell `i` has but its row may leave out, whether the other cell, which may be empty, has them or not: the other site, and the
    /// area as the surface has it (length²). A negative one is left out where it may be not believed. A positive one is nothing below a sixteenth
    /// of the bound of its largest triangle, which is within what rounding does to an area of this cell ([`Bounds::facet_rounding`]). That bounds
    /// one facet, and not the sum of many of one direction: where sites are on a sphere the tip of a cell has some fifty, of which half may be left
    /// out. Nearly parallel bisectors cut off noise on one side of a facet, not on the other: it is the lesser of what the two sides make of it,
    /// and nothing where their signs differ.
    pub fn unseen_facets(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let (scene, most) = (self.scene, self.not_believed(i));
        let within = -most..=self.facet_rounding(i).min(most);
        let seen = move |j: usize| self.rows[i].iter().any(|f| f.neighbor == j);
        let others = (0..scene.len()).filter(move |&j| scene.site(j) != scene.site(i) && !seen(j));
        let area = move |j: usize| {
            let (here, there) = (scene.facet_area(i, j), scene.facet_area(j, i));
            here.min(there).max(0.0) + here.max(there).min(0.0)
        };
        others.map(move |j| (j, area(j))).filter(move |(_, area)| *area != 0.0 && within.contains(area))
    }

    /// How far a bisector of site `i` may be off (length).
    pub fn displacement(&self, i: usize) -> f64 {
        self.displacement[i]
    }

    /// Bound of the sum of all volumes (length³): the promise ([`bound_of_volumes`]). A container of less volume than the rounding of a cell
    /// leaves nothing that may not be called empty, nor a digit of a cell that an oblique bisector cuts: the tetrahedra over the foot of the
    /// reference point on that bisector reach far out of the needle.
    pub fn volume_sum(&self) -> f64 {
        let volume = self.scene.room.volume();
        let reach = self.reach.iter().copied().fold(0.0, f64::max);
        let cells = || (0..self.scene.len()).map(|i| self.cell_rounding(i));
        let is_needle = volume <= cells().fold(0.0, f64::max);
        let nothing = if is_needle { volume } else { 0.0 };
        let grid = self.scene.room.grid_volume(self.scene.len());
        bound_of_volumes(volume, self.scene.room.area(), reach, grid) + nothing
    }

    /// What of negative volumes may be missing in cells that are called empty (length³), where the surface goes around something the wrong way. A
    /// negative volume is believed beyond the sum of the bounds of its pieces alone: no less tells it from the rounding of a sliver, which comes
    /// to half of that. Up to there it is within its cell's rounding. Only where the surface goes through a cell can it have one.
    pub fn volume_of_empty(&self) -> f64 {
        self.empty_with_surface().map(|i| self.cell_rounding(i)).sum()
    }

    /// What moments of the given order about `middle` may be off because each cell has its own about its site, which may be far away
    /// (length³⁺ᵒʳᵈᵉʳ).
    ///
    /// A site at the distance a from the middle has V, ∫ x and ∫ xxᵀ as sums of pieces: truncated cones over the triangles from a corner of the
    /// grid, each with its volume times 1, about a and about a². Sums are plain, one piece after
    /// the other, and each partial sum, of up to G, what the cell has in the grid, is rounded. Of T triangles these are T roundings of either sign, a
    /// walk of √T steps (Higham and Mary, 2019): √T·u·G of the volume, a times that of ∫ x, a² times that of ∫ xxᵀ, each by itself. About the
    /// middle ∫ xxᵀ is S + 2m(p − M) + V(p − M)², whatever it is by way of the barycenter; so it is off by 1 + 2 + 1 times √T·u·G·a², and ∫ x by
    /// 1 + 1 times √T·u·G·a. And the cell is moved (`ROUNDINGS_OF_SHIFT`). What is of the order of the diagonal times a is below the bound of
    /// the volumes, of u·A·D, times the diagonal to the order.
    ///
    /// Of sites 1 to 900 extents away from all shapes, and from spheres of 1,280, 5,120 and 20,480 triangles, ∫ xxᵀ is off by up to 2.4·√T·u·G·a², as
    /// much with 4 triangles as with 5,120, and by 0.42 of the whole bound; ∫ x by 0.40 of it.
    pub fn far_from_sites(&self, middle: DVec3, order: i32) -> f64 {
        let scene = self.scene;
        let grid = scene.room.grid_box(scene.len()).map(|room| Scene { room, ..scene.clone() });
        let walk = 2_f64.powi(order) * (scene.room.mesh().triangles.len() as f64).sqrt();
        let present = (0..scene.len()).filter(|&i| self.output.status()[i] != CellStatus::Empty);
        let terms = present.map(|i| {
            let in_grid = grid.as_ref().map_or(0.0, |grid| grid.moments(middle, Some(i)).volume().abs());
            let volumes = ROUNDINGS_OF_SHIFT * self.output.volume()[i].abs() + walk * in_grid;
            U * volumes * scene.site(i).distance(middle).powi(order)
        });
        terms.sum()
    }

    /// The cells that are called empty and that the surface goes through.
    pub fn empty_with_surface(&self) -> impl Iterator<Item = usize> {
        let empty = (0..self.scene.len()).filter(|&i| self.output.status()[i] == CellStatus::Empty);
        empty.filter(|&i| self.scene.surface_in_cell(i) > 0.0)
    }

    /// By what angle the bisector of sites `i` and `j` is turned, and by what share of it their distance is off: coordinates
    /// enter the library's frame without rounding where they are within the container's box, else off by u times their
    /// distance from it.
    pub fn turn(&self, i: usize, j: usize) -> f64 {
        let (lo, hi) = self.scene.room.bounding_box();
        let off = |s: usize| {
            let site = self.scene.positions[s];
            let outside = (0..3).filter(|&k| site[k] < lo[k] || site[k] > hi[k]).count();
            U * self.reach[s] * (outside as f64).sqrt()
        };
        (off(i) + off(j)) / self.scene.site(i).distance(self.scene.site(j))
    }

    /// Bound of the sum of all boundaries' areas (length²): the promise, and the roundings of all cells.
    pub fn area_sum(&self) -> f64 {
        CLOSURE * self.scene.room.area() + (0..self.scene.len()).map(|i| self.facet_rounding(i)).sum::<f64>()
    }

    /// Area of the surface that lies in cells that are called empty (length²). One whose volume is below its rounding takes its boundary with it,
    /// which need not be small: a cell may have nothing but a slab between folds, or the edge of a wedge.
    pub fn area_of_empty(&self) -> f64 {
        let empty = (0..self.scene.len()).filter(|&i| self.output.status()[i] == CellStatus::Empty);
        empty.map(|i| self.scene.surface_in_cell(i)).sum()
    }
}

/// Distance from site `i` to the farthest point of the initial cell (length). A domain's grid encloses it by up to a
/// voxel, at most half an extent, on every side.
fn reach(scene: &Scene, i: usize) -> f64 {
    let (lo, hi) = scene.room.bounding_box();
    let margin = 0.5 * scene.room.extents().max_element();
    let farthest = (DVec3::from(hi) - scene.site(i)).abs().max((DVec3::from(lo) - scene.site(i)).abs());
    farthest.length() + margin
}

/// Distance from site `i` to the nearest other site at another position (length).
fn nearest(scene: &Scene, i: usize) -> f64 {
    let distances = scene.positions.iter().map(|&p| DVec3::from(p).distance(scene.site(i)));
    distances.filter(|&d| d > 0.0).fold(f64::INFINITY, f64::min)
}

/// How much the vertices of cell `i`'s facets amplify a displacement of planes: the inverse of the smallest sine of the angle
/// between two planes that may meet. Two facets on one side; a facet and a triangle that it touches; and, in a cell of
/// thickness t = V/A, its two sides, with sine about t/D. A facet that only the other side sees is one too.
///
/// Of an empty cell no more is known than what others see of it, that it is no thicker than the container, and that its volume
/// is below its rounding: then any two of its facets may meet, and a triangle may be the other side of a slab.
fn condition(bounds: &Bounds, i: usize) -> f64 {
    let Bounds { scene, output, rows, .. } = bounds;
    let (mesh, reach) = (scene.room.mesh(), bounds.reach[i]);
    let empty = output.status()[i] == CellStatus::Empty;
    let boundary = output.boundary().map_or(0.0, |b| b[i].area);
    let surface: f64 = rows[i].iter().map(|f| f.area).sum::<f64>() + boundary;
    let (surface, volume) =
        if empty { (scene.room.area(), scene.room.volume()) } else { (surface, output.volume()[i]) };
    let mut worst = (surface * reach / volume.abs()).max(1.0);
    // Neighbours and areas, as either side sees them.
    let mut seen: BTreeMap<usize, f64> = rows[i].iter().map(|f| (f.neighbor, f.area)).collect();
    for &(k, area) in &bounds.seen[i] {
        seen.entry(k).or_insert(area);
    }
    let normals: Vec<DVec3> = seen.keys().map(|&j| (scene.site(j) - scene.site(i)).normalize()).collect();
    for (k, a) in normals.iter().enumerate() {
        for b in normals[..k].iter().filter(|b| empty || a.dot(**b) > 0.0) {
            worst = worst.max(1.0 / a.cross(*b).length());
        }
    }
    for ((&j, area), normal) in seen.iter().zip(&normals) {
        let distance = scene.site(i).distance(scene.site(j));
        let thickness = if empty { bounds.cell_rounding(i) / area } else { 0.0 };
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| DVec3::from(mesh.vertices[v as usize]));
            let heights = [a, b, c].map(|x| scene.power_difference(x, i, j) / (2.0 * distance));
            let near = (ROUNDINGS * U * reach).max(thickness);
            if heights.iter().any(|h| *h >= -near) && heights.iter().any(|h| *h <= near) {
                worst = worst.max(1.0 / (b - a).cross(c - a).normalize().cross(*normal).length());
            }
        }
    }
    worst
}
