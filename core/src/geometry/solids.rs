//! A cell that is not convex as convex solids, which is what most programs take a polyhedron for (VTK's volumes are those of convex hulls).
//!
//! What is star-shaped about some point becomes pyramids over its faces with their apex there. What is not is cut in two by the plane of a triangle
//! that turns its back to where the apex would be best, and the halves are made as cells are.

use super::Beyond;
use super::cell::{Cell, Known};
use super::faces::{Faces, edges, vector_area};
use super::surface::Key;
use crate::cell::{
    COMPLETE, CUT, ClipStore, DomainStore, EMPTY, PlainStore, Plane, Polytope, Real, TAG_CAP, V3, add, clip, dot, sub,
    triangle_plane, v3,
};
use std::collections::HashMap;

/// Volume that counts as nothing, as a share of the cell's.
const NOTHING: Real = 1e-13;

/// The same of a pyramid, of which there are many.
const NO_PYRAMID: Real = 1e-16;

/// How far before a triangle the plane is that cuts a cell by it, as a share of the cell's size: triangles that lie in that plane but for rounding are
/// then behind it, and leave no sheets of nothing before it.
const BEFORE: Real = 2e-14;

/// Cuts one after the other at most: the stack has room for some 700.
const MOST_CUTS: usize = 256;

/// Solids of one cell at most. What is left then is one, though it is not convex.
const MOST_SOLIDS: usize = 20_000;

/// The solids of one cell; none where it is convex itself.
#[derive(Debug, Default)]
pub(super) struct Solids {
    pub(super) keys: Vec<Key>,
    pub(super) points: Vec<V3>,
    pub(super) faces: Faces,
    /// Where the faces of each solid end.
    pub(super) ends: Vec<usize>,
    numbers: HashMap<Key, u32>,
    planes: u32,
    volume: Real,
}

/// A face as seen from a point: its vector area, and a point of its plane.
struct Seen {
    area: V3,
    point: V3,
}

impl Seen {
    /// The volume of the pyramid from `x`.
    fn volume(&self, x: V3) -> Real {
        dot(sub(self.point, x), self.area) / 3.0
    }
}

impl Solids {
    /// The solids of a cell; the first of their points are the cell's.
    pub(super) fn make<S: DomainStore>(&mut self, store: &S, cell: &Cell) {
        self.faces.clear();
        self.ends.clear();
        self.keys.clear();
        self.points.clear();
        if cell.is_whole() || cell.faces.len() == 0 {
            return;
        }
        let all: Vec<usize> = (0..cell.faces.len()).collect();
        if cell.is_once() && is_convex(cell, &all) {
            return;
        }
        self.keys.extend_from_slice(&cell.keys);
        self.points.extend_from_slice(&cell.points);
        self.planes = store.planes();
        self.volume = volume_of(cell, &all).abs();
        let numbers: Vec<u32> = (0..cell.points.len() as u32).collect();
        self.numbers.clear();
        self.numbers.extend(cell.keys.iter().copied().zip(cell.same.iter().copied()));
        if cell.triangles.is_empty() {
            // Whole, but taken other than once.
            let times = cell.windings[0].unsigned_abs() as usize;
            for copy in 0..times {
                let faces: Vec<usize> = all.iter().copied().filter(|face| face % times == copy).collect();
                self.push(cell, &numbers, &faces);
            }
        } else {
            self.add(store, cell, &numbers, &mut Vec::new());
        }
    }

    /// Adds all of a cell, whose points have these numbers; `used` are triangles whose planes have cut it.
    fn add<S: DomainStore>(&mut self, store: &S, cell: &Cell, numbers: &[u32], used: &mut Vec<u32>) {
        let components = components(cell);
        let apexes: Vec<_> = components.iter().map(|faces| apex(store, cell, faces)).collect();
        // What the whole cell has none of does not count.
        let counts = |faces: &[usize]| volume_of(cell, faces).abs() > NOTHING * self.volume;
        if let Some(turned) = components.iter().zip(&apexes).filter(|c| counts(c.0)).find_map(|c| c.1.as_ref().err())
            && self.ends.len() < MOST_SOLIDS
            && used.len() < MOST_CUTS
            && self.split(store, cell, turned, used)
        {
            return;
        }
        for (faces, apex) in components.iter().zip(apexes) {
            if volume_of(cell, faces).abs() <= NOTHING * self.volume {
                continue;
            }
            match apex {
                Ok(apex) if !(cell.is_once() && is_convex(cell, faces)) => {
                    self.push_pyramids(cell, numbers, faces, apex)
                }
                _ => self.push(cell, numbers, faces),
            }
        }
    }

    /// Adds some faces as one solid.
    fn push(&mut self, cell: &Cell, numbers: &[u32], faces: &[usize]) {
        for &face in faces {
            let corners = cell.faces.corners_of(face).iter().map(|&i| numbers[i as usize]);
            self.faces.push(corners, cell.faces.beyond[face]);
        }
        self.ends.push(self.faces.len());
    }

    /// Adds a pyramid for each face.
    fn push_pyramids(&mut self, cell: &Cell, numbers: &[u32], faces: &[usize], apex: V3) {
        let top = self.inner(apex);
        for &face in faces {
            if seen(cell, face).volume(apex).abs() <= NO_PYRAMID * self.volume {
                continue;
            }
            let corners: Vec<u32> = cell.faces.corners_of(face).iter().map(|&i| numbers[i as usize]).collect();
            self.faces.push(corners.iter().copied(), cell.faces.beyond[face]);
            for [a, b] in edges(&corners) {
                self.faces.push([b, a, top].into_iter(), Beyond::Nothing);
            }
            self.ends.push(self.faces.len());
        }
    }

    fn inner(&mut self, point: V3) -> u32 {
        self.keys.push(Key::Inner(self.points.len() as u32));
        self.points.push(point);
        (self.points.len() - 1) as u32
    }

    /// Cuts the cell by the plane of the first triangle that parts it, and adds both halves; whether one does.
    fn split<S: DomainStore>(&mut self, store: &S, cell: &Cell, turned: &[u32], used: &mut Vec<u32>) -> bool {
        for &t in turned {
            if used.contains(&t) {
                continue;
            }
            used.push(t);
            let [plane, behind] = planes_before(store, t);
            let (mut front, mut back) = (copy(store), copy(store));
            if clip(&mut front, plane, TAG_CAP) == CUT && clip(&mut back, behind, TAG_CAP) == CUT {
                let vertices = cell.keys.iter().zip(&cell.windings);
                let windings = vertices.filter_map(|(key, &w)| match key {
                    Key::Vertex(planes) => Some((*planes, w)),
                    _ => None,
                });
                let windings: HashMap<[u32; 3], i32> = windings.collect();
                let mut halves = [Cell::default(), Cell::default()];
                let made = [&front, &back]
                    .into_iter()
                    .zip(&mut halves)
                    .all(|(half, made)| made.make_of(half, &cell.triangles, &Known::Windings(&windings)) == COMPLETE);
                if made {
                    for (half, made) in [front, back].iter().zip(&halves) {
                        let numbers = self.numbers_of(made);
                        self.add(half, made, &numbers, used);
                    }
                    used.pop();
                    return true;
                }
            }
            used.pop();
        }
        false
    }

    /// The numbers of a half's points: those that the whole cell has keep theirs.
    fn numbers_of(&mut self, half: &Cell) -> Vec<u32> {
        let is_known = |key: &Key| match key {
            Key::Vertex(planes) => planes[2] < self.planes,
            Key::Crossing(planes, _) => planes[1] < self.planes,
            Key::OnEdge(plane, _) => *plane < self.planes,
            Key::Surface(_) => true,
            Key::Inner(_) => false,
        };
        let known: Vec<Option<u32>> =
            half.keys.iter().map(|key| self.numbers.get(key).copied().filter(|_| is_known(key))).collect();
        known
            .into_iter()
            .zip(&half.points)
            .map(|(number, &point)| number.unwrap_or_else(|| self.inner(point)))
            .collect()
    }
}

/// The two half-spaces of a plane just before a triangle: that with the triangle, and the other.
fn planes_before<S: DomainStore>(store: &S, t: u32) -> [Plane; 2] {
    let site = store.site();
    let [a, b, c] = [0, 1, 2].map(|k| sub(store.triangle_point(t, k), site));
    let mut plane = triangle_plane(a, b, c, -1.0);
    let first = store.position(0);
    let ways = (0..store.vertices()).map(|v| sub(store.position(v), first));
    let size = ways.map(|way| dot(way, way)).fold(0.0, Real::max).sqrt();
    plane.d += BEFORE * size * dot(plane.n, plane.n).sqrt();
    [plane, Plane { n: v3(-plane.n.x, -plane.n.y, -plane.n.z), d: -plane.d }]
}

/// The clipped cell in a store of its own, its half-spaces with the same numbers.
fn copy<'a, S: DomainStore>(store: &'a S) -> PlainStore<'a> {
    let site = store.site();
    let mut copy = PlainStore::new([site.x, site.y, site.z], store.domain());
    for f in 0..store.planes() {
        copy.set_plane(f, store.plane(f));
        copy.set_tag(f, store.tag(f));
        copy.set_link(f, 0);
    }
    copy.set_planes(store.planes());
    for v in 0..store.vertices() {
        copy.set_triplet(v, store.triplet(v));
        copy.set_position(v, store.position(v), store.radius(v));
    }
    copy.set_vertices(store.vertices());
    copy
}

/// The faces of each component: those that have points in common.
fn components(cell: &Cell) -> Vec<Vec<usize>> {
    let mut root: Vec<u32> = (0..cell.points.len() as u32).collect();
    let find = |root: &[u32], mut i: u32| {
        while root[i as usize] != i {
            i = root[i as usize];
        }
        i
    };
    for (corners, _) in cell.faces.iter() {
        for &corner in &corners[1..] {
            let [a, b] = [find(&root, corners[0]), find(&root, corner)];
            root[a.max(b) as usize] = a.min(b);
        }
    }
    let mut numbers = HashMap::new();
    let mut components: Vec<Vec<usize>> = Vec::new();
    for (face, (corners, _)) in cell.faces.iter().enumerate() {
        let number = *numbers.entry(find(&root, corners[0])).or_insert(components.len());
        if number == components.len() {
            components.push(Vec::new());
        }
        components[number].push(face);
    }
    components
}

fn volume_of(cell: &Cell, faces: &[usize]) -> Real {
    let about = faces.first().map_or(V3::default(), |&face| seen(cell, face).point);
    faces.iter().map(|&face| seen(cell, face).volume(about)).sum()
}

fn seen(cell: &Cell, face: usize) -> Seen {
    let corners = cell.faces.corners_of(face);
    let point = cell.points[corners[0] as usize];
    Seen { area: vector_area(&cell.points, edges(corners).map(|e| (e, 1)), point), point }
}

/// Whether some faces are those of a convex solid: a convex hull has no more volume than all that stands before a face.
fn is_convex(cell: &Cell, faces: &[usize]) -> bool {
    let seen: Vec<Seen> = faces.iter().map(|&f| seen(cell, f)).collect();
    let corners: Vec<V3> =
        faces.iter().flat_map(|&f| cell.faces.corners_of(f)).map(|&i| cell.points[i as usize]).collect();
    let volume: Real = seen.iter().map(|s| s.volume(corners[0])).sum();
    if volume <= 0.0 {
        return false;
    }
    let mut before = 0.0;
    for face in &seen {
        before += corners.iter().map(|&x| -face.volume(x)).fold(0.0, Real::max);
        if before > NOTHING * volume {
            return false;
        }
    }
    true
}

/// A point from which all faces of a component are seen, or the triangles of those that leave none, that first which found it out.
///
/// Such points are in the cell and behind all of its surface: what is left of the clipped cell by those half-spaces.
fn apex<S: DomainStore>(store: &S, cell: &Cell, faces: &[usize]) -> Result<V3, Vec<u32>> {
    let triangle = |face: &usize| match cell.faces.beyond[*face] {
        Beyond::Surface(t) => Some(t),
        _ => None,
    };
    let mut triangles: Vec<u32> = faces.iter().filter_map(triangle).collect();
    let volume = volume_of(cell, faces);
    let mut kernel = copy(store);
    for k in 0..triangles.len() {
        if volume < 0.0 || clip(&mut kernel, planes_before(store, triangles[k])[0], TAG_CAP) == EMPTY {
            triangles.rotate_left(k);
            return Err(triangles);
        }
    }
    let n = Real::from(kernel.vertices());
    let sum = (0..kernel.vertices()).map(|v| kernel.position(v)).fold(V3::default(), add);
    let apex = v3(sum.x / n, sum.y / n, sum.z / n);
    if faces.iter().all(|&face| seen(cell, face).volume(apex) >= -NOTHING * volume) { Ok(apex) } else { Err(triangles) }
}
