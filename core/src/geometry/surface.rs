//! What of the domain's surface is within a cell: each triangle near it, cut by the cell's half-spaces.
//!
//! The half-spaces are taken in the order in which they cut the cell, and zero is within, as there (`cell/mod.rs`): each is moved outward by an
//! infinitesimal that dominates all earlier ones. So the pieces of all triangles and the cell itself are those of one arrangement in general
//! position, whatever touches what: two triangles agree about each piece of their common edge, and where a piece ends on two half-spaces
//! the cell has an edge.

use super::heights::Heights;
use crate::cell::{
    DomainStore, Real, UNIT_ROUNDOFF, V3, Voxel, add, dot, is_first_voxel, norm_1, outer_box_of_cell, scale, sub, v3,
    voxels_of_box,
};
use foldhash::fast::FixedState;
use std::collections::HashMap;

/// Roundings of heights beyond which the place where a line comes to 0 is lost in them, and is computed exactly: where a triangle, or its edge, lies
/// nearly in the half-space's plane.
const LINE_IS_LOST: Real = 68_719_476_736.0;

/// What a point is, by what meets there: half-spaces by their numbers in the cell, the domain's triangles and vertices by theirs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Key {
    /// A vertex of the cell: three half-spaces, in ascending order.
    Vertex([u32; 3]),
    /// Two half-spaces, in ascending order, and a triangle.
    Crossing([u32; 2], u32),
    /// A half-space and an edge of the surface, by its ends in ascending order.
    OnEdge(u32, [u32; 2]),
    /// A vertex of the surface.
    Surface(u32),
    /// A point within.
    Inner(u32),
}

/// On what line a piece goes from one corner to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// The triangle's edge from its corner of this number to the next.
    Edge(usize),
    /// A half-space's.
    HalfSpace(u32),
}

/// A corner of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) key: Key,
    /// In the frame of the site.
    pub(super) position: V3,
    /// The line to the next corner.
    pub(super) line: Line,
}

/// The pieces of the surface within one cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    heights: Heights,
    numbers: HashMap<u32, u32, FixedState>,
    corners: Vec<Corner>,
    /// Of each piece its triangle, and where its corners end.
    ends: Vec<(u32, usize)>,
    polygon: Vec<Corner>,
    cut: Vec<Corner>,
}

impl Pieces {
    /// Cuts `triangles` by all half-spaces of the cell.
    pub(super) fn cut<S: DomainStore>(&mut self, store: &S, triangles: &[u32]) {
        let planes = store.planes();
        self.heights.begin(store.site(), (0..planes).map(|f| store.plane(f)));
        self.numbers.clear();
        self.corners.clear();
        self.ends.clear();
        for &t in triangles {
            let triangle = store.triangle(t);
            let ids = [triangle.a, triangle.b, triangle.c];
            let numbers =
                ids.map(|i| *self.numbers.entry(i).or_insert_with(|| self.heights.add(store.domain_point(i))));
            let points = ids.map(|i| sub(store.domain_point(i), store.site()));
            self.polygon.clear();
            self.polygon.extend((0..3).map(|k| Corner {
                key: Key::Surface(ids[k]),
                position: points[k],
                line: Line::Edge(k),
            }));
            if (0..planes).all(|f| self.cut_triangle(t, ids, numbers, points, f)) {
                self.corners.extend_from_slice(&self.polygon);
                self.ends.push((t, self.corners.len()));
            }
        }
    }

    /// The pieces: of each its triangle and its corners, counterclockwise from outside the domain.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, &[Corner])> {
        let begins = std::iter::once(0).chain(self.ends.iter().map(|&(_, end)| end));
        begins.zip(&self.ends).map(|(begin, &(t, end))| (t, &self.corners[begin..end]))
    }

    /// Whether there is none.
    pub(super) fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Cuts the present piece, of triangle `t`, by half-space `f`; whether something is left.
    fn cut_triangle(&mut self, t: u32, ids: [u32; 3], numbers: [u32; 3], points: [V3; 3], f: u32) -> bool {
        let heights = &self.heights;
        let of_corners = numbers.map(|i| heights.of(i, f));
        if of_corners.iter().all(|h| h.value > h.error) {
            return true;
        }
        if of_corners.iter().all(|h| h.value < -h.error) {
            return false;
        }
        let n = self.polygon.len();
        let is_within: Vec<bool> = (0..n)
            .map(|i| is_within(heights, numbers, [self.polygon[(i + n - 1) % n].line, self.polygon[i].line], f))
            .collect();
        if is_within.iter().all(|&w| w) {
            return true;
        }
        let plane = heights.planes()[f as usize];
        let height = |x: V3| dot(plane.n, x) + plane.d;
        let rounding = LINE_IS_LOST
            * UNIT_ROUNDOFF
            * (norm_1(plane.n) * points.iter().map(|&x| norm_1(x)).fold(0.0, Real::max) + plane.d.abs());
        self.cut.clear();
        for i in 0..n {
            let (here, next) = (self.polygon[i], self.polygon[(i + 1) % n]);
            let (keep, keep_next) = (is_within[i], is_within[(i + 1) % n]);
            if keep {
                self.cut.push(here);
            }
            if keep != keep_next {
                let key = match here.line {
                    Line::Edge(k) => Key::OnEdge(f, sorted([ids[k], ids[(k + 1) % 3]])),
                    Line::HalfSpace(g) => Key::Crossing(sorted([g, f]), t),
                };
                let (a, b) = (height(here.position), height(next.position));
                let shares = if (a - b).abs() > rounding { None } else { heights.shares(numbers, here.line, f) };
                let position = match shares {
                    Some(shares) => shares.iter().zip(points).fold(V3::default(), |x, (s, p)| add(x, scale(*s, p))),
                    None => between(here.position, next.position, a, b),
                };
                self.cut.push(Corner { key, position, line: if keep { Line::HalfSpace(f) } else { here.line } });
            }
        }
        std::mem::swap(&mut self.polygon, &mut self.cut);
        self.polygon.len() > 2
    }
}

/// The point of the segment where heights `a` and `b` at its ends come to 0. It is on the segment whatever they are: what two half-spaces that
/// are nearly parallel on a triangle lose there is lost along both.
fn between(p: V3, q: V3, a: Real, b: Real) -> V3 {
    let share = if a == b { 0.5 } else { (a / (a - b)).clamp(0.0, 1.0) };
    let mix = |x: Real, y: Real| if share < 0.5 { x + share * (y - x) } else { y - (1.0 - share) * (y - x) };
    v3(mix(p.x, q.x), mix(p.y, q.y), mix(p.z, q.z))
}

/// Whether the corner where two lines of a piece meet, the second after the first, is within half-space `f`, which is later than all of them.
fn is_within(heights: &Heights, numbers: [u32; 3], lines: [Line; 2], f: u32) -> bool {
    let edge = |k: usize| [numbers[k], numbers[(k + 1) % 3]];
    match lines {
        [Line::Edge(_), Line::Edge(k)] => heights.is_within(numbers[k], f),
        // The piece leaves the edge for half-space g, beyond which the edge goes on; or comes back to it from there.
        [Line::Edge(k), Line::HalfSpace(g)] => heights.is_within_on_edge(edge(k), g, f),
        [Line::HalfSpace(g), Line::Edge(k)] => heights.is_within_on_edge([edge(k)[1], edge(k)[0]], g, f),
        [Line::HalfSpace(g), Line::HalfSpace(h)] => heights.is_within_on_triangle(numbers, [g, h, f]),
    }
}

pub(super) fn sorted<const N: usize>(mut numbers: [u32; N]) -> [u32; N] {
    numbers.sort_unstable();
    numbers
}

/// The triangles whose bounding boxes share a voxel with that of the cell.
pub(super) fn triangles_near<S: DomainStore>(store: &S, triangles: &mut Vec<u32>) {
    triangles.clear();
    let (mut low, mut high) = (V3::default(), V3::default());
    let (mut lo, mut hi) = (Voxel::default(), Voxel::default());
    outer_box_of_cell(store, &mut low, &mut high);
    voxels_of_box(store, low, high, &mut lo, &mut hi);
    if store.surface_voxels(lo, hi) == 0 {
        return;
    }
    for (k, j) in (lo.k..=hi.k).flat_map(|k| (lo.j..=hi.j).map(move |j| (k, j))) {
        for i in lo.i..=hi.i {
            let voxel = Voxel { i, j, k };
            let entries = store.list_begin(voxel)..store.list_end(voxel);
            let all = entries.map(|entry| store.list_entry(entry));
            triangles.extend(all.filter(|&t| is_first_voxel(store.lowest_voxel(t), lo, voxel)));
        }
    }
}
