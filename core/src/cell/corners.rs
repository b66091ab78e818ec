//! The tetrahedra of all vertices of a cell, on a host: of four vertices at a time, before they are added up one by one, for volumes and first moments, and
//! the triangles of its facets. The text is that of `integrate.rs` and `facet.rs`, and so are the bits. (One by one a white cell takes a tenth more time,
//! by vectors of 32 bytes.)

use super::facet::{FacetSum, area_of_triangle, moment_of_triangle, per_length, rounding_of_triangle};
use super::integrate::{
    CellSums, FACETS, Piece, Side, add_piece, foot_by, is_plain, off_plain_foot, piece_of, radius_at, rounding_across,
    side, spoke_of,
};
use super::store::Polytope;
use super::vector::{Real, V3, add, cross, dot, larger, norm_1, sub, v3};
use super::vertex::Triplet;
use pulp::{Arch, NullaryFnOnce};

/// Vertices at a time.
const LANES: usize = 4;

type Four = [Real; LANES];

/// The tetrahedra of the vertices of a cell.
#[derive(Debug)]
pub struct Corners {
    /// Its half-spaces as seen from the reference point, and where facets are asked for one over the lengths of their normals.
    sides: Vec<Side>,
    per_length: Vec<Real>,
    fours: Vec<CornersOfFour>,
    /// Of each edge the triangles on its two half-spaces, where facets are asked for.
    facets: Vec<[[TrianglesOfFour; 2]; 3]>,
    /// The instructions that the CPU has.
    arch: Arch,
}

/// Of four vertices.
#[derive(Clone, Copy, Debug, Default)]
struct CornersOfFour {
    edges: [EdgesOfFour; 3],
    /// Whether all edges of a vertex are plain: no foot is to be refined.
    are_plain: [bool; LANES],
}

/// An edge each: its two tetrahedra, and the length of its spoke.
#[derive(Clone, Copy, Debug, Default)]
struct EdgesOfFour {
    pieces: [PiecesOfFour; 2],
    spoke: Four,
}

#[derive(Clone, Copy, Debug, Default)]
struct PiecesOfFour {
    volume: Four,
    rounding: Four,
    first: [Four; 3],
}

/// A triangle each: its signed area, its moment, and what rounding may have added to that area.
#[derive(Clone, Copy, Debug, Default)]
struct TrianglesOfFour {
    area: Four,
    moment: [Four; 3],
    rounding: Four,
}

/// A vertex each: relative to the reference point, and its error radius.
#[derive(Default)]
struct PlacesOfFour {
    position: [Four; 3],
    radius: Four,
}

/// A half-space each.
#[derive(Clone, Copy, Default)]
struct SidesOfFour {
    n: [Four; 3],
    d: Four,
    square: Four,
    foot: [Four; 3],
}

/// The foot on an edge each, and one over the square of the sine of the angle of its half-spaces.
#[derive(Clone, Copy, Default)]
struct FeetOfFour {
    foot: [Four; 3],
    per_sine_square: Four,
}

impl SidesOfFour {
    #[inline(always)]
    fn set(&mut self, lane: usize, side: &Side) {
        set(&mut self.n, lane, side.n);
        set(&mut self.foot, lane, side.foot);
        (self.d[lane], self.square[lane]) = (side.d, side.square);
    }

    /// (Without its number.)
    #[inline(always)]
    fn side(&self, lane: usize) -> Side {
        let (n, foot) = (at(&self.n, lane), at(&self.foot, lane));
        Side { index: 0, n, d: self.d[lane], square: self.square[lane], foot }
    }
}

impl PiecesOfFour {
    #[inline(always)]
    fn set(&mut self, lane: usize, piece: Piece) {
        (self.volume[lane], self.rounding[lane]) = (piece.volume, piece.rounding);
        set(&mut self.first, lane, piece.first);
    }

    #[inline(always)]
    fn piece(&self, lane: usize) -> Piece {
        Piece { volume: self.volume[lane], rounding: self.rounding[lane], first: at(&self.first, lane) }
    }
}

impl TrianglesOfFour {
    #[inline(always)]
    fn add(&self, lane: usize, sum: &mut FacetSum) {
        sum.area += self.area[lane];
        sum.moment = add(sum.moment, at(&self.moment, lane));
        sum.rounding = larger(sum.rounding, self.rounding[lane]);
    }
}

#[inline(always)]
fn at(fours: &[Four; 3], lane: usize) -> V3 {
    v3(fours[0][lane], fours[1][lane], fours[2][lane])
}

#[inline(always)]
fn set(fours: &mut [Four; 3], lane: usize, x: V3) {
    (fours[0][lane], fours[1][lane], fours[2][lane]) = (x.x, x.y, x.z);
}

impl Default for Corners {
    fn default() -> Self {
        let (sides, per_length) = (Vec::new(), Vec::new());
        Self { sides, per_length, fours: Vec::new(), facets: Vec::new(), arch: Arch::new() }
    }
}

impl Corners {
    /// Those of a polytope, as `integrate` takes it.
    pub fn set<S: Polytope>(&mut self, s: &S, weight: Real, center: V3, reach: Real, flags: u32) {
        self.sides.clear();
        self.sides.extend((0..s.planes()).map(|f| side(s, f, center)));
        self.per_length.clear();
        if flags & FACETS != 0 {
            self.per_length.extend(self.sides.iter().map(|&f| per_length(f)));
        }
        let count = s.vertices().div_ceil(LANES as u32) as usize;
        let with_facets = if flags & FACETS == 0 { 0 } else { count };
        if self.fours.len() < count {
            self.fours.resize(count, CornersOfFour::default());
        }
        if self.facets.len() < with_facets {
            self.facets.resize(with_facets, Default::default());
        }
        let Self { sides, per_length, fours, facets, arch } = self;
        let (fours, facets) = (&mut fours[..count], &mut facets[..with_facets]);
        arch.dispatch(Set { s, weight, center, reach, sides, per_length, fours, facets });
    }

    /// Adds the tetrahedra of vertex `v`, whose way from the site is that long; `false` if one of its feet is to be refined.
    #[inline(always)]
    pub fn add(&self, v: u32, distance: Real, part: &mut CellSums) -> bool {
        let (four, lane) = (&self.fours[v as usize / LANES], v as usize % LANES);
        if !four.are_plain[lane] {
            return false;
        }
        for edge in &four.edges {
            add_piece(edge.pieces[0].piece(lane), part);
            add_piece(edge.pieces[1].piece(lane), part);
            part.rounding += rounding_across(distance, edge.spoke[lane]);
        }
        true
    }

    /// Adds the triangles of vertex `v`, of that triplet, to its facets.
    #[inline(always)]
    pub fn add_facets(&self, v: u32, Triplet { a, b, c }: Triplet, facets: &mut [FacetSum]) {
        let (edges, lane) = (&self.facets[v as usize / LANES], v as usize % LANES);
        for (triangles, [f, g]) in edges.iter().zip([[a, b], [b, c], [c, a]]) {
            triangles[0].add(lane, &mut facets[g as usize]);
            triangles[1].add(lane, &mut facets[f as usize]);
        }
    }
}

/// Sets all of them by the widest instructions that the CPU has.
struct Set<'a, S> {
    s: &'a S,
    weight: Real,
    center: V3,
    reach: Real,
    sides: &'a [Side],
    per_length: &'a [Real],
    fours: &'a mut [CornersOfFour],
    facets: &'a mut [[[TrianglesOfFour; 2]; 3]],
}

impl<S: Polytope> NullaryFnOnce for Set<'_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { s, weight, center, reach, sides, per_length: lengths, fours, facets } = self;
        let last = s.vertices().max(1) - 1;
        for (number, four) in fours.iter_mut().enumerate() {
            let mut places = PlacesOfFour::default();
            let mut corners = [SidesOfFour::default(); 3];
            for lane in 0..LANES {
                // (Places after the last have what it has.)
                let v = ((number * LANES + lane) as u32).min(last);
                let Triplet { a, b, c } = s.triplet(v);
                set(&mut places.position, lane, sub(s.position(v), center));
                places.radius[lane] = radius_at(s.radius(v), reach);
                for (corner, f) in corners.iter_mut().zip([a, b, c]) {
                    corner.set(lane, &sides[f as usize]);
                }
            }
            let mut are_plain = [true; LANES];
            let mut triangles = facets.get_mut(number);
            let mut per_length = [[0.0; LANES]; 3];
            if triangles.is_some() {
                for lane in 0..LANES {
                    let Triplet { a, b, c } = s.triplet(((number * LANES + lane) as u32).min(last));
                    for (corner, f) in per_length.iter_mut().zip([a, b, c]) {
                        corner[lane] = lengths[f as usize];
                    }
                }
            }
            let ([a, b, c], [per_a, per_b, per_c]) = (&corners, &per_length);
            let edges = [([a, b], [per_a, per_b]), ([b, c], [per_b, per_c]), ([c, a], [per_c, per_a])];
            for (e, (edge, per_length)) in edges.into_iter().enumerate() {
                let feet = set_edge(&mut four.edges[e], edge, &places, &mut are_plain);
                if let Some(triangles) = &mut triangles {
                    set_triangles(&mut triangles[e], &feet, edge, per_length, &places, weight, center);
                }
            }
            four.are_plain = are_plain;
        }
    }
}

/// Sets the tetrahedra of an edge; its feet. (A loop that becomes one over vectors.)
#[inline(always)]
fn set_edge(
    edge: &mut EdgesOfFour,
    [f, g]: [&SidesOfFour; 2],
    places: &PlacesOfFour,
    are_plain: &mut [bool; LANES],
) -> FeetOfFour {
    let (mut made, mut feet) = (EdgesOfFour::default(), FeetOfFour::default());
    for (k, all_plain) in are_plain.iter_mut().enumerate() {
        let (f, g, position) = (f.side(k), g.side(k), at(&places.position, k));
        let direction = cross(f.n, g.n);
        let square = dot(direction, direction);
        let (per_square, whole) = (1.0 / square, f.square * g.square);
        let foot = foot_by(f.n, f.d, g.n, g.d, direction, per_square);
        set(&mut feet.foot, k, foot);
        feet.per_sine_square[k] = per_square * whole;
        *all_plain &= is_plain(square, whole);
        let spoke = spoke_of(foot, position);
        made.pieces[0].set(k, piece_of(dot(g.foot, spoke), g.foot, foot, position));
        made.pieces[1].set(k, piece_of(-dot(f.foot, spoke), f.foot, foot, position));
        made.spoke[k] = norm_1(spoke);
    }
    *edge = made;
    feet
}

/// (So does this: of half-space g first, as they are added.)
#[inline(always)]
fn set_triangles(
    triangles: &mut [TrianglesOfFour; 2],
    feet: &FeetOfFour,
    [f, g]: [&SidesOfFour; 2],
    [per_f, per_g]: [&Four; 2],
    places: &PlacesOfFour,
    weight: Real,
    center: V3,
) {
    let mut made = [TrianglesOfFour::default(); 2];
    for k in 0..LANES {
        let (f, g) = (f.side(k), g.side(k));
        let (position, radius) = (at(&places.position, k), places.radius[k]);
        let foot = at(&feet.foot, k);
        let off = off_plain_foot(foot, feet.per_sine_square[k], center);
        set_triangle(&mut made[0], k, g, per_g[k], foot, off, position, radius, -weight, center);
        set_triangle(&mut made[1], k, f, per_f[k], foot, off, position, radius, weight, center);
    }
    *triangles = made;
}

#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "those of a triangle")]
fn set_triangle(
    triangle: &mut TrianglesOfFour,
    k: usize,
    side: Side,
    per_length: Real,
    foot: V3,
    off: Real,
    position: V3,
    radius: Real,
    sign: Real,
    center: V3,
) {
    let area = area_of_triangle(side, per_length, sub(foot, side.foot), sub(position, side.foot), sign);
    triangle.area[k] = area;
    set(&mut triangle.moment, k, moment_of_triangle(side, foot, position, center, area));
    triangle.rounding[k] = rounding_of_triangle(side, foot, off, position, radius);
}
