//! The tetrahedra of all vertices of a cell, on a host: of four vertices at a time, before they are added up one by one, for volumes and first moments. The
//! text is that of `integrate.rs`, and so are the bits. (One by one a white cell takes a tenth more time, by vectors of 32 bytes.)

use super::integrate::{
    CellSums, Piece, Side, add_piece, foot_by, is_plain, piece_of, rounding_across, side, spoke_of,
};
use super::store::Polytope;
use super::vector::{Real, V3, cross, dot, norm_1, sub, v3};
use super::vertex::Triplet;
use pulp::{Arch, NullaryFnOnce};

/// Vertices at a time.
const LANES: usize = 4;

type Four = [Real; LANES];

/// The tetrahedra of the vertices of a cell.
#[derive(Debug)]
pub struct Corners {
    /// Its half-spaces as seen from the reference point.
    sides: Vec<Side>,
    fours: Vec<CornersOfFour>,
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

/// A half-space each.
#[derive(Clone, Copy, Default)]
struct SidesOfFour {
    n: [Four; 3],
    d: Four,
    square: Four,
    foot: [Four; 3],
}

impl SidesOfFour {
    #[inline(always)]
    fn set(&mut self, lane: usize, side: &Side) {
        set(&mut self.n, lane, side.n);
        set(&mut self.foot, lane, side.foot);
        (self.d[lane], self.square[lane]) = (side.d, side.square);
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
        Self { sides: Vec::new(), fours: Vec::new(), arch: Arch::new() }
    }
}

impl Corners {
    /// Those of a polytope, as seen from `center`.
    pub fn set<S: Polytope>(&mut self, s: &S, center: V3) {
        self.sides.clear();
        self.sides.extend((0..s.planes()).map(|f| side(s, f, center)));
        let count = s.vertices().div_ceil(LANES as u32) as usize;
        if self.fours.len() < count {
            self.fours.resize(count, CornersOfFour::default());
        }
        let Self { sides, fours, arch } = self;
        arch.dispatch(Set { s, center, sides, fours: &mut fours[..count] });
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
}

/// Sets the tetrahedra of all vertices by the widest instructions that the CPU has.
struct Set<'a, S> {
    s: &'a S,
    center: V3,
    sides: &'a [Side],
    fours: &'a mut [CornersOfFour],
}

impl<S: Polytope> NullaryFnOnce for Set<'_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { s, center, sides, fours } = self;
        let last = s.vertices().max(1) - 1;
        for (number, four) in fours.iter_mut().enumerate() {
            let mut positions = [[0.0; LANES]; 3];
            let mut corners = [SidesOfFour::default(); 3];
            for lane in 0..LANES {
                // (Places after the last have what it has.)
                let v = ((number * LANES + lane) as u32).min(last);
                let Triplet { a, b, c } = s.triplet(v);
                set(&mut positions, lane, sub(s.position(v), center));
                for (corner, f) in corners.iter_mut().zip([a, b, c]) {
                    corner.set(lane, &sides[f as usize]);
                }
            }
            let [a, b, c] = &corners;
            let mut are_plain = [true; LANES];
            for (edge, [f, g]) in four.edges.iter_mut().zip([[a, b], [b, c], [c, a]]) {
                set_edge(edge, f, g, &positions, &mut are_plain);
            }
            four.are_plain = are_plain;
        }
    }
}

/// (A loop that becomes one over vectors.)
#[inline(always)]
fn set_edge(
    edge: &mut EdgesOfFour,
    f: &SidesOfFour,
    g: &SidesOfFour,
    positions: &[Four; 3],
    are_plain: &mut [bool; LANES],
) {
    let mut made = EdgesOfFour::default();
    for (k, all_plain) in are_plain.iter_mut().enumerate() {
        let (n_f, n_g, position) = (at(&f.n, k), at(&g.n, k), at(positions, k));
        let direction = cross(n_f, n_g);
        let square = dot(direction, direction);
        *all_plain &= is_plain(square, f.square[k] * g.square[k]);
        let foot = foot_by(n_f, f.d[k], n_g, g.d[k], direction, square);
        let spoke = spoke_of(foot, position);
        let (to_g, to_f) = (at(&g.foot, k), at(&f.foot, k));
        made.pieces[0].set(k, piece_of(dot(to_g, spoke), to_g, foot, position));
        made.pieces[1].set(k, piece_of(-dot(to_f, spoke), to_f, foot, position));
        made.spoke[k] = norm_1(spoke);
    }
    *edge = made;
}
