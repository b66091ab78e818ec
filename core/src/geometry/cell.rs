//! The geometry of one cell: its facets and the surface within it, both cut to what is within the domain.
//!
//! A cell that the surface does not meet is as it was clipped. In any other, a facet's part within the domain is what is on the left of
//! directed segments in its plane: those where pieces of the surface end there, turned, and of each edge of the cell what is within the domain, as
//! often as the winding number there says. That is one at one vertex, and changes by one wherever a segment ends on an edge, so the facets
//! close whatever rounding does to the places. The winding number at the first vertex follows from the cell's volume.

use super::Beyond;
use super::faces::{Faces, edges, vector_area};
use super::near::{join_near, unite};
use super::surface::{Key, Line, Pieces, sorted, triangles_near};
use crate::cell::{COMPLETE, DomainStore, Polytope, Real, TAG_BOX, UNCERTAIN, V3, cross, dot, sub};
use foldhash::fast::FixedState;
use std::collections::HashMap;

/// Points nearer than that, in the unit of the frame, count as one: the caller's coordinates have lost as much.
const SAME: Real = 1.0 / (1_u64 << 50) as Real;

/// No quotient of volumes beyond this is a winding number.
const MOST_WINDINGS: Real = 1e4;

/// What tells which winding number the first vertex of a cell has.
pub(super) enum Known<'a> {
    /// The volume of the restricted cell.
    Volume(Real),
    /// Those of some vertices, by their half-spaces.
    Windings(&'a HashMap<[u32; 3], i32>),
}

/// An edge of a facet.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// Its ends, counterclockwise about the facet from outside.
    ends: [u32; 2],
    /// The half-spaces of this facet and the one beyond the edge.
    planes: [u32; 2],
}

/// Where the surface passes through an edge of the cell, whose half-spaces are in ascending order and which goes as the first of them has it.
#[derive(Clone, Copy, Debug)]
struct Passage {
    planes: [u32; 2],
    place: Real,
    point: u32,
    /// How much larger the winding number is behind it.
    jump: i32,
}

/// The geometry of one cell, and room for making it.
#[derive(Clone, Debug, Default)]
pub(super) struct Cell {
    pub(super) keys: Vec<Key>,
    /// In the frame of the site.
    pub(super) points: Vec<V3>,
    /// Of each point the number of the one that it counts as.
    pub(super) same: Vec<u32>,
    pub(super) faces: Faces,
    /// Winding numbers of the cell's vertices, which are its first points.
    pub(super) windings: Vec<i32>,
    /// Triangles that have a piece within the cell.
    pub(super) triangles: Vec<u32>,
    /// Triangles that may have one.
    near: Vec<u32>,
    pieces: Pieces,
    numbers: HashMap<Key, u32, FixedState>,
    edges: Vec<Edge>,
    /// Where the edges of each half-space's facet end.
    edge_ends: Vec<usize>,
    passages: Vec<Passage>,
    /// Segments where pieces of the surface end on a half-space, as its facet has them.
    segments: Vec<(u32, [u32; 2])>,
    around: Vec<(u32, u32, u32)>,
}

impl Cell {
    /// Makes the geometry of a finished cell; `COMPLETE`, or `UNCERTAIN`, which cannot happen while signs are exact.
    pub(super) fn make<S: DomainStore>(&mut self, store: &S, volume: Real) -> u32 {
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        if store.has_domain() {
            triangles_near(store, &mut near);
        }
        let status = self.make_of(store, &near, &Known::Volume(volume));
        self.near = near;
        status
    }

    /// The same, given the triangles that may meet it.
    pub(super) fn make_of<S: DomainStore>(&mut self, store: &S, triangles: &[u32], known: &Known<'_>) -> u32 {
        self.begin(store);
        self.pieces.cut(store, triangles);
        self.triangles.clear();
        self.triangles.extend(self.pieces.iter().map(|(t, _)| t));
        self.add_pieces();
        self.find_passages();
        if !self.find_windings(store, known) {
            return UNCERTAIN;
        }
        self.join_near_points();
        self.add_surface();
        self.add_facets(store);
        COMPLETE
    }

    /// Whether the cell is a convex polytope that the surface does not meet, taken once.
    pub(super) fn is_whole(&self) -> bool {
        self.pieces.is_empty() && self.windings.iter().all(|&w| w == 1)
    }

    /// Whether no vertex is within the domain more than once, either way.
    pub(super) fn is_at_most_once(&self) -> bool {
        self.windings.iter().all(|w| (-1..=1).contains(w))
    }

    /// The vertices and edges of the clipped cell.
    fn begin<S: Polytope>(&mut self, store: &S) {
        self.keys.clear();
        self.points.clear();
        self.faces.clear();
        self.around.clear();
        self.edges.clear();
        self.edge_ends.clear();
        self.edge_ends.resize(store.planes() as usize, 0);
        for v in 0..store.vertices() {
            let t = store.triplet(v);
            self.keys.push(Key::Vertex(sorted([t.a, t.b, t.c])));
            self.points.push(store.position(v));
            for f in [t.a, t.b, t.c] {
                self.edge_ends[f as usize] += 1;
            }
        }
        // Corners by half-spaces: where those of each end is where its edges do.
        let mut end = 0;
        for count in &mut self.edge_ends {
            (end, *count) = (end + *count, end);
        }
        self.around.resize(end, (0, 0, 0));
        for v in 0..store.vertices() {
            let t = store.triplet(v);
            // Of half-space f: the vertex (f, g, h) begins the edge (f, g) and ends the edge (f, h), counterclockwise from outside.
            for (f, g, h) in [(t.a, t.b, t.c), (t.b, t.c, t.a), (t.c, t.a, t.b)] {
                let next = &mut self.edge_ends[f as usize];
                self.around[*next] = (g, h, v);
                *next += 1;
            }
        }
        let mut begin = 0;
        for (f, &end) in (0..).zip(&self.edge_ends) {
            let corners = &self.around[begin..end];
            let mut here = corners.first().copied();
            for _ in 0..corners.len() {
                let Some((g, _, v)) = here else { break };
                here = corners.iter().find(|c| c.1 == g).copied();
                self.edges.extend(here.map(|next| Edge { ends: [v, next.2], planes: [f, g] }));
            }
            begin = end;
        }
    }

    fn edges_of(&self, f: usize) -> &[Edge] {
        let begin = if f == 0 { 0 } else { self.edge_ends[f - 1] };
        &self.edges[begin..self.edge_ends[f]]
    }

    /// Numbers the corners of the surface's pieces, and finds the segments where they end on half-spaces.
    fn add_pieces(&mut self) {
        self.numbers.clear();
        self.segments.clear();
        let (keys, points) = (&mut self.keys, &mut self.points);
        for (_, corners) in self.pieces.iter() {
            let numbers: Vec<u32> = corners
                .iter()
                .map(|c| {
                    *self.numbers.entry(c.key).or_insert_with(|| {
                        keys.push(c.key);
                        points.push(c.position);
                        (keys.len() - 1) as u32
                    })
                })
                .collect();
            for (corner, [from, to]) in corners.iter().zip(edges(&numbers)) {
                if let Line::HalfSpace(f) = corner.line {
                    self.segments.push((f, [to, from]));
                }
            }
        }
        self.segments.sort_unstable();
    }

    /// The segments on half-space `f`.
    fn segments_on(&self, f: u32) -> &[(u32, [u32; 2])] {
        let begin = self.segments.partition_point(|s| s.0 < f);
        let end = begin + self.segments[begin..].iter().take_while(|s| s.0 == f).count();
        &self.segments[begin..end]
    }

    /// Where the surface passes through edges of the cell.
    fn find_passages(&mut self) {
        self.passages.clear();
        for &(f, ends) in &self.segments {
            for (point, jump) in [(ends[0], -1), (ends[1], 1)] {
                if let Key::Crossing(planes, _) = self.keys[point as usize]
                    && planes[0] == f
                {
                    self.passages.push(Passage { planes, place: 0.0, point, jump });
                }
            }
        }
        if self.passages.is_empty() {
            return;
        }
        for passage in &mut self.passages {
            let edge = self.edges.iter().find(|e| e.planes == passage.planes);
            let Some(Edge { ends: [a, b], .. }) = edge else { continue };
            let [a, b, p] = [*a, *b, passage.point].map(|i| self.points[i as usize]);
            passage.place = dot(sub(p, a), sub(b, a));
        }
        self.passages
            .sort_by(|a, b| a.planes.cmp(&b.planes).then(a.place.total_cmp(&b.place)).then(a.point.cmp(&b.point)));
    }

    /// The passages of an edge, as the first of its half-spaces has it.
    fn passages_of(&self, planes: [u32; 2]) -> &[Passage] {
        let begin = self.passages.partition_point(|p| p.planes < planes);
        let end = begin + self.passages[begin..].iter().take_while(|p| p.planes == planes).count();
        &self.passages[begin..end]
    }

    /// The parts of an edge, and how often each is within the domain.
    fn parts_of(&self, edge: &Edge) -> impl Iterator<Item = ([u32; 2], i32)> {
        let [a, b] = edge.ends;
        let is_turned = edge.planes[0] > edge.planes[1];
        let passages = self.passages_of(sorted(edge.planes));
        let n = passages.len();
        let passage = move |k: usize| if is_turned { passages[n - 1 - k] } else { passages[k] };
        let mut times = self.windings[a as usize];
        (0..=n).map(move |k| {
            let from = if k == 0 { a } else { passage(k - 1).point };
            let to = if k == n { b } else { passage(k).point };
            let part = ([from, to], times);
            if k < n {
                times += if is_turned { -passage(k).jump } else { passage(k).jump };
            }
            part
        })
    }

    /// The winding numbers of all vertices; whether there are such.
    fn find_windings<S: DomainStore>(&mut self, store: &S, known: &Known<'_>) -> bool {
        let vertices = store.vertices() as usize;
        if self.pieces.is_empty() {
            let times = match known {
                Known::Volume(_) if !store.has_domain() => Some(1),
                Known::Volume(volume) => Some(nearest(volume / self.volume_of_facets(store, false))),
                Known::Windings(known) => self.keys.iter().find_map(|key| match key {
                    Key::Vertex(planes) => known.get(planes).copied(),
                    _ => None,
                }),
            };
            self.windings.clear();
            self.windings.resize(vertices, times.unwrap_or(0));
            return times.is_some();
        }
        let mut found: Vec<Option<i32>> = vec![None; vertices];
        found[0] = Some(0);
        let mut left = vertices - 1;
        let jump = |cell: &Self, e: &Edge| cell.passages_of(e.planes).iter().map(|p| p.jump).sum::<i32>();
        while left > 0 {
            let before = left;
            for e in self.edges.iter().filter(|e| e.planes[0] < e.planes[1]) {
                let [a, b] = e.ends.map(|v| v as usize);
                match (found[a], found[b]) {
                    (Some(w), None) => found[b] = Some(w + jump(self, e)),
                    (None, Some(w)) => found[a] = Some(w - jump(self, e)),
                    _ => continue,
                }
                left -= 1;
            }
            if left == before {
                return false;
            }
        }
        self.windings.clear();
        self.windings.extend(found.iter().flatten());
        let agree = |e: &Edge| self.windings[e.ends[1] as usize] == self.windings[e.ends[0] as usize] + jump(self, e);
        let passages: usize = self.edges.iter().map(|e| self.passages_of(e.planes).len()).sum();
        if passages != self.passages.len() || !self.edges.iter().filter(|e| e.planes[0] < e.planes[1]).all(agree) {
            return false;
        }
        let first = match known {
            Known::Windings(known) => (0..vertices).find_map(|v| match self.keys[v] {
                Key::Vertex(planes) => known.get(&planes).map(|w| w - self.windings[v]),
                _ => None,
            }),
            Known::Volume(volume) => {
                let whole = self.volume_of_facets(store, false);
                let times = (volume - self.volume_of_surface() - self.volume_of_facets(store, true)) / whole;
                Some(nearest(times))
            }
        };
        let Some(first) = first else { return false };
        self.windings.iter_mut().for_each(|w| *w += first);
        true
    }

    /// The volume of the cone from the first vertex over all facets, or over their parts within the domain.
    fn volume_of_facets<S: Polytope>(&self, store: &S, parts: bool) -> Real {
        let of_facet = |f: u32| {
            let facet = self.edges_of(f as usize);
            let Some(first) = facet.first() else { return 0.0 };
            let about = self.points[first.ends[0] as usize];
            let area = if parts {
                let segments = self.segments_on(f).iter().map(|s| (s.1, 1));
                vector_area(&self.points, segments.chain(facet.iter().flat_map(|e| self.parts_of(e))), about)
            } else {
                vector_area(&self.points, facet.iter().map(|e| (e.ends, 1)), about)
            };
            dot(sub(about, self.points[0]), area) / 3.0
        };
        (0..store.planes()).map(of_facet).sum()
    }

    /// The same over the surface within the cell.
    fn volume_of_surface(&self) -> Real {
        let of_piece = |corners: &[super::surface::Corner]| {
            let about = corners[0].position;
            let fan = corners[1..].windows(2).map(|pair| {
                let [a, b] = [pair[0].position, pair[1].position].map(|p| sub(p, about));
                dot(sub(about, self.points[0]), cross(a, b)) / 6.0
            });
            fan.sum::<Real>()
        };
        self.pieces.iter().map(|(_, corners)| of_piece(corners)).sum()
    }

    /// Lets points count as one where they are as near as rounding: of a cell that the surface does not meet those that an edge joins, else all.
    fn join_near_points(&mut self) {
        self.same.clear();
        self.same.extend(0..self.points.len() as u32);
        let (points, same) = (&self.points, &mut self.same);
        if self.pieces.is_empty() {
            for &Edge { ends: [a, b], .. } in &self.edges {
                let way = sub(points[a as usize], points[b as usize]);
                if way.x.abs() <= SAME && way.y.abs() <= SAME && way.z.abs() <= SAME {
                    unite(same, a, b);
                }
            }
        } else {
            join_near((0..).zip(points.iter().copied()), SAME, |a, b| unite(same, a, b));
        }
        for i in 0..self.same.len() {
            self.same[i] = self.same[self.same[i] as usize];
        }
    }

    /// The pieces of the surface as faces.
    fn add_surface(&mut self) {
        let mut corners = Vec::new();
        for (t, piece) in self.pieces.iter() {
            corners.clear();
            corners.extend(piece.iter().map(|c| self.same[self.numbers[&c.key] as usize]));
            self.faces.push_simplified(&mut corners, Beyond::Surface(t));
        }
    }

    /// The facets' parts within the domain as faces.
    fn add_facets<S: Polytope>(&mut self, store: &S) {
        let mut faces = std::mem::take(&mut self.faces);
        let mut corners = Vec::new();
        for f in 0..store.planes() {
            let facet = self.edges_of(f as usize);
            let Some(first) = facet.first() else { continue };
            let beyond = self.beyond(store, f);
            let segments = self.segments_on(f);
            let is_whole = segments.is_empty() && facet.iter().all(|e| self.passages_of(sorted(e.planes)).is_empty());
            let same = |i: u32| self.same[i as usize];
            if is_whole {
                let times = self.windings[first.ends[0] as usize];
                for _ in 0..times.abs() {
                    corners.clear();
                    corners.extend(facet.iter().map(|e| same(e.ends[0])));
                    if times < 0 {
                        corners.reverse();
                    }
                    faces.push_simplified(&mut corners, beyond);
                }
            } else {
                let parts = facet.iter().flat_map(|e| self.parts_of(e));
                let turned = |[a, b]: [u32; 2], times: i32| if times < 0 { [b, a] } else { [a, b] };
                let parts = parts.flat_map(|(s, n)| std::iter::repeat_n(turned(s, n), n.unsigned_abs() as usize));
                let all = segments.iter().map(|s| s.1).chain(parts);
                let mut chain = all.map(|s| s.map(same)).collect();
                let n = store.plane(f).n;
                faces.push_chain(&self.points, V3 { x: -n.x, y: -n.y, z: -n.z }, &mut chain, beyond);
            }
        }
        self.faces = faces;
    }

    /// What is beyond half-space `f`; a site by the tag that the half-space has.
    fn beyond<S: Polytope>(&self, store: &S, f: u32) -> Beyond {
        match store.tag(f) {
            TAG_BOX => Beyond::Box(face_of_box(store.plane(f).n)),
            tag if tag < TAG_BOX => Beyond::Site(tag),
            _ => Beyond::Nothing,
        }
    }
}

/// The winding number that a quotient of volumes is, but for rounding. Where the cell itself is no larger than that, it may be anything.
fn nearest(times: Real) -> i32 {
    if times.abs() < MOST_WINDINGS { times.round() as i32 } else { 1 }
}

/// The number of the box's face with this inward normal: 0 to 5 for low x, high x, low y, high y, low z, high z.
pub(super) fn face_of_box(n: V3) -> u8 {
    let n = [n.x, n.y, n.z];
    let axis = (0..3).find(|&k| n[k] != 0.0).unwrap_or(0);
    2 * axis as u8 + u8::from(n[axis] < 0.0)
}
