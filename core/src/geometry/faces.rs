//! Faces as lists of corners, and a facet made of the directed segments around it.

use super::Beyond;
use crate::cell::{Real, UNIT_ROUNDOFF, V3, cross, dot, sub, v3};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Faces, one after the other; corners are counterclockwise from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct Faces {
    pub(super) ends: Vec<usize>,
    pub(super) corners: Vec<u32>,
    pub(super) beyond: Vec<Beyond>,
}

impl Faces {
    pub(super) fn clear(&mut self) {
        self.ends.clear();
        self.corners.clear();
        self.beyond.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(super) fn push(&mut self, corners: impl Iterator<Item = u32>, beyond: Beyond) {
        self.corners.extend(corners);
        self.ends.push(self.corners.len());
        self.beyond.push(beyond);
    }

    pub(super) fn corners_of(&self, face: usize) -> &[u32] {
        let begin = if face == 0 { 0 } else { self.ends[face - 1] };
        &self.corners[begin..self.ends[face]]
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&[u32], Beyond)> {
        (0..self.len()).map(|face| (self.corners_of(face), self.beyond[face]))
    }

    /// Adds the face, from its corners after points that count as one have one number, if anything is left of it.
    pub(super) fn push_simplified(&mut self, corners: &mut [u32], beyond: Beyond) {
        let corners = simplify(corners);
        if corners.len() > 2 {
            self.push(corners.iter().copied(), beyond);
        }
    }

    /// Gives corners other numbers, and drops faces of which nothing is left; of each face, and of the end of all, which number it then has.
    pub(super) fn renumber(&mut self, number: impl Fn(u32) -> u32) -> Vec<usize> {
        let mut kept = Faces::default();
        let mut numbers = vec![0];
        let mut corners = Vec::new();
        for face in 0..self.len() {
            corners.clear();
            corners.extend(self.corners_of(face).iter().map(|&corner| number(corner)));
            kept.push_simplified(&mut corners, self.beyond[face]);
            numbers.push(kept.len());
        }
        *self = kept;
        numbers
    }

    /// Adds the part of a plane of outward normal `normal` that is on the left of directed segments, whose ends are numbers of `points`: as often
    /// as its winding number says. The segments must be closed: each point begins as many as it ends.
    pub(super) fn push_chain(&mut self, points: &[V3], normal: V3, chain: &mut Vec<[u32; 2]>, beyond: Beyond) {
        cancel(chain);
        if chain.len() < 3 {
            return;
        }
        if let Some(mut corners) = single_loop(chain)
            && is_convex(points, normal, &corners)
        {
            self.push_simplified(&mut corners, beyond);
            return;
        }
        for triangle in triangulate(points, normal, chain).unwrap_or_else(|| fan(chain)) {
            self.push(triangle.into_iter(), beyond);
        }
    }
}

/// What is left of a loop: a corner that repeats the one before it goes, and so does a way there and back.
fn simplify(corners: &mut [u32]) -> &[u32] {
    let mut n = 0;
    for i in 0..corners.len() {
        let here = corners[i];
        if n > 1 && corners[n - 2] == here {
            n -= 1;
        } else if n == 0 || corners[n - 1] != here {
            corners[n] = here;
            n += 1;
        }
    }
    // The same where the end meets the beginning.
    let (mut begin, mut end) = (0, n);
    while end - begin > 2 {
        if corners[begin] == corners[end - 1] || corners[begin] == corners[end - 2] {
            end -= 1;
        } else if corners[begin + 1] == corners[end - 1] {
            begin += 1;
        } else {
            break;
        }
    }
    &corners[begin..end]
}

/// Drops segments that lead nowhere, and those that another leads back.
fn cancel(chain: &mut Vec<[u32; 2]>) {
    let mut count: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b] in &*chain {
        *count.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
    }
    let turned = |[a, b]: [u32; 2], n: i32| if n > 0 { [a, b] } else { [b, a] };
    chain.clear();
    chain.extend(
        count
            .into_iter()
            .filter(|([a, b], _)| a != b)
            .flat_map(|(s, n)| std::iter::repeat_n(turned(s, n), n.unsigned_abs() as usize)),
    );
    chain.sort_unstable();
}

/// The corners, where the sorted segments are one loop that meets each of them once.
fn single_loop(chain: &[[u32; 2]]) -> Option<Vec<u32>> {
    let mut corners = vec![chain[0][0]];
    let mut here = chain[0][1];
    while here != chain[0][0] {
        if corners.len() == chain.len() {
            return None;
        }
        corners.push(here);
        let next = chain.partition_point(|s| s[0] < here);
        here = chain.get(next).filter(|s| s[0] == here)?[1];
    }
    (corners.len() == chain.len()).then_some(corners)
}

/// Area by which a polygon may be from convex, as a share of the square of its size.
const FLAT: Real = 1024.0 * UNIT_ROUNDOFF;

fn is_convex(points: &[V3], normal: V3, corners: &[u32]) -> bool {
    let n = corners.len();
    let at = |i: usize| points[corners[i % n] as usize];
    let unit = 1.0 / dot(normal, normal).sqrt();
    let twice_area = |a: V3, b: V3, c: V3| dot(cross(sub(b, a), sub(c, a)), normal) * unit;
    let size = (1..n).map(|i| sub(at(i), at(0))).map(|way| dot(way, way)).fold(0.0, Real::max);
    // All corners on the left of each edge; a corner may be straight, but not back.
    let is_forward = |a: V3, b: V3, c: V3| dot(sub(b, a), sub(c, b)) >= 0.0;
    (0..n).all(|i| {
        let (a, b, c) = (at(i), at(i + 1), at(i + 2));
        (twice_area(a, b, c) > FLAT * size || is_forward(a, b, c))
            && (2..n).all(|k| twice_area(a, b, at(i + k)) >= -FLAT * size)
    })
}

/// Triangles with one corner in common: right as a sum, though they may cover each other.
fn fan(chain: &[[u32; 2]]) -> Vec<[u32; 3]> {
    let apex = chain[0][0];
    chain.iter().filter(|s| !s.contains(&apex)).map(|&[a, b]| [apex, a, b]).collect()
}

/// A constrained Delaunay triangulation of what is on the left of the segments; `None` where they cross each other, or two points are one.
fn triangulate(points: &[V3], normal: V3, chain: &[[u32; 2]]) -> Option<Vec<[u32; 3]>> {
    // Seen along the axis that the normal is nearest to, no digit is lost.
    let n = [normal.x, normal.y, normal.z];
    let axis = (0..3).fold(0, |best, k| if n[k].abs() > n[best].abs() { k } else { best });
    let (mut x, mut y) = ((axis + 1) % 3, (axis + 2) % 3);
    if n[axis] < 0.0 {
        (x, y) = (y, x);
    }
    let origin = points[chain[0][0] as usize];
    let coordinate = |p: V3, k: usize| {
        let way = sub(p, origin);
        let c = [way.x, way.y, way.z][k];
        if c.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { c }
    };
    let mut plane = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = HashMap::new();
    let mut numbers = HashMap::new();
    for &[point, _] in chain {
        if let Entry::Vacant(entry) = handles.entry(point) {
            let p = points[point as usize];
            let handle = plane.insert(Point2::new(coordinate(p, x), coordinate(p, y))).ok()?;
            entry.insert(handle);
            if numbers.insert(handle, point).is_some() {
                return None;
            }
        }
    }
    // Of each edge of the triangulation how many segments go along it, less those against it.
    let mut along: HashMap<_, i32> = HashMap::new();
    let mut triangles = Vec::new();
    for [from, to] in chain {
        let edges = plane.try_add_constraint(handles[from], handles[to]);
        if edges.is_empty() && handles[from] != handles[to] {
            return None;
        }
        // Where a segment passes through other points, triangles of no area keep it whole for the face beyond it.
        let stops: Vec<u32> = edges.iter().map(|&e| numbers[&plane.directed_edge(e).to().fix()]).collect();
        triangles.extend(stops.windows(2).map(|pair| [*from, pair[1], pair[0]]));
        for edge in edges {
            *along.entry(edge).or_default() += 1;
            *along.entry(edge.rev()).or_default() -= 1;
        }
    }
    // From the outside inward: what is on the left of an edge is covered as often as what is on its right, and by what goes along.
    let mut covered = HashMap::from([(plane.outer_face().fix(), 0_i32)]);
    let mut open = vec![plane.outer_face().fix()];
    let edges_of = |face: spade::handles::FixedFaceHandle<spade::handles::PossiblyOuterTag>| -> Vec<_> {
        match plane.face(face).as_inner() {
            Some(inner) => inner.adjacent_edges().map(|e| e.fix()).to_vec(),
            None => plane.convex_hull().map(|e| if e.is_outer_edge() { e.fix() } else { e.fix().rev() }).collect(),
        }
    };
    while let Some(face) = open.pop() {
        let here = covered[&face];
        for edge in edges_of(face) {
            let beyond = plane.directed_edge(edge).rev().face();
            if covered.contains_key(&beyond.fix()) {
                continue;
            }
            let times = here - along.get(&edge).copied().unwrap_or(0);
            covered.insert(beyond.fix(), times);
            open.push(beyond.fix());
            if let Some(inner) = beyond.as_inner() {
                let [a, b, c] = inner.vertices().map(|v| numbers[&v.fix()]);
                let triangle = if times > 0 { [a, b, c] } else { [a, c, b] };
                triangles.extend(std::iter::repeat_n(triangle, times.unsigned_abs() as usize));
            }
        }
    }
    triangles.sort_unstable();
    Some(triangles)
}

/// The vector area of a polygon, or of a chain: half the sum of cross products, about its first point.
pub(super) fn vector_area(points: &[V3], segments: impl Iterator<Item = ([u32; 2], i32)>, about: V3) -> V3 {
    segments.fold(V3::default(), |sum, ([a, b], times)| {
        let c = cross(sub(points[a as usize], about), sub(points[b as usize], about));
        let half = 0.5 * Real::from(times);
        v3(sum.x + half * c.x, sum.y + half * c.y, sum.z + half * c.z)
    })
}

/// The directed edges of a polygon.
pub(super) fn edges(corners: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]])
}
