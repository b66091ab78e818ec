//! A cell that is not convex as convex solids, which is what most programs take a polyhedron for (VTK's volumes are those of convex hulls).
//!
//! Where the winding number is negative a solid is turned inside out, as its faces are: its volume is negative, and all below is meant so.
//!
//! What is star-shaped about some point becomes pyramids over its faces with their apex there. What is not is cut in two, and the halves are made as
//! cells are: what has many triangles in the middle of those, so that there are few on each side, else by the plane of a triangle that turns its back
//! to where the apex would be best. (By planes of triangles alone, each of which goes on through all that is beyond, one cell of a hollow ball of 6,144
//! triangles took 18 s and 3 GB, and was not done.)

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

/// Cuts one after the other at most.
const MOST_CUTS: usize = 256;

/// Solids of one cell at most, or so many for each of its triangles. What is left then is one, though it is not convex.
const MOST_SOLIDS: usize = 20_000;
const MOST_OF_TRIANGLE: usize = 32;

/// Triangles more than these are parted by halves.
const MANY_TRIANGLES: usize = 24;

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

/// A convex part of a cell: the triangles whose planes have cut it are used.
struct Part<'a> {
    store: PlainStore<'a>,
    cell: Cell,
    /// Of each of its points the number among the solids'.
    numbers: Vec<u32>,
    used: Vec<u32>,
}

/// The triangles of what is not star-shaped, that first which found it out, and the sign of its volume.
struct Turned {
    triangles: Vec<u32>,
    sign: Real,
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
        if cell.is_at_most_once() && is_convex(cell, &all) {
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
            self.add_all(Part { store: copy(store), cell: cell.clone(), numbers, used: Vec::new() });
        }
    }

    /// Adds a part, and what it is cut into, of which the list holds no more than one for each cut.
    fn add_all(&mut self, whole: Part<'_>) {
        let most = MOST_SOLIDS.max(MOST_OF_TRIANGLE * whole.cell.triangles.len());
        let mut parts = vec![whole];
        while let Some(part) = parts.pop() {
            parts.extend(self.add(part, most).into_iter().flatten());
        }
    }

    /// Adds a part, or returns its halves; while there are fewer than `most` solids.
    fn add<'a>(&mut self, part: Part<'a>, most: usize) -> Option<[Part<'a>; 2]> {
        let components = components(&part.cell);
        let apexes: Vec<_> = components.iter().map(|faces| apex(&part.store, &part.cell, faces)).collect();
        // What the whole cell has none of does not count.
        let counts = |faces: &[usize]| volume_of(&part.cell, faces).abs() > NOTHING * self.volume;
        let turned = components.iter().zip(&apexes).filter(|c| counts(c.0)).find_map(|c| c.1.as_ref().err());
        if let Some(turned) = turned
            && self.ends.len() < most
            && part.used.len() < MOST_CUTS
            && let Some(halves) = self.split(&part, turned)
        {
            return Some(halves);
        }
        let Part { cell, numbers, .. } = &part;
        for (faces, apex) in components.iter().zip(apexes) {
            if volume_of(cell, faces).abs() <= NOTHING * self.volume {
                continue;
            }
            match apex {
                Ok(apex) if !(cell.is_at_most_once() && is_convex(cell, faces)) => {
                    self.push_pyramids(cell, numbers, faces, apex)
                }
                _ => self.push(cell, numbers, faces),
            }
        }
        None
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

    /// Cuts a part in the middle of its triangles where they are many, else by the plane of the first of those that parts it; `None` where none does.
    fn split<'a>(&mut self, part: &Part<'a>, turned: &Turned) -> Option<[Part<'a>; 2]> {
        let is_many = part.cell.triangles.len() > MANY_TRIANGLES;
        if let Some(planes) = middle_of_surface(&part.cell).filter(|_| is_many)
            && let Some(halves) = self.cut(part, planes, TAG_CAP)
        {
            return Some(halves);
        }
        let fresh = turned.triangles.iter().filter(|t| !part.used.contains(t));
        fresh.into_iter().find_map(|&t| self.cut(part, planes_before(&part.store, t, turned.sign), t))
    }

    /// Cuts a part by a plane, which is that of triangle `used`, if that is one.
    fn cut<'a>(&mut self, part: &Part<'a>, planes: [Plane; 2], used: u32) -> Option<[Part<'a>; 2]> {
        let (mut front, mut back) = (again(&part.store), again(&part.store));
        if clip(&mut front, planes[0], TAG_CAP) != CUT || clip(&mut back, planes[1], TAG_CAP) != CUT {
            return None;
        }
        let vertices = part.cell.keys.iter().zip(&part.cell.windings);
        let windings = vertices.filter_map(|(key, &w)| match key {
            Key::Vertex(planes) => Some((*planes, w)),
            _ => None,
        });
        let windings: HashMap<[u32; 3], i32> = windings.collect();
        let mut made = [front, back].map(|store| {
            let mut cell = Cell::default();
            let status = cell.make_of(&store, &part.cell.triangles, &Known::Windings(&windings));
            (status == COMPLETE).then_some((store, cell))
        });
        let mut half = |made: &mut Option<(PlainStore<'a>, Cell)>| {
            let (store, cell) = made.take()?;
            let numbers = self.numbers_of(&cell);
            let used = part.used.iter().copied().chain([used]).collect();
            Some(Part { store, cell, numbers, used })
        };
        let [front, back] = &mut made;
        if front.is_none() || back.is_none() {
            return None;
        }
        // That in front is the first to be taken from the list.
        Some([half(back)?, half(front)?])
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

/// The two half-spaces of a plane across the axis along which the surface within a cell is longest: in the widest gap between its corners among
/// the middle half of them, so that none is in the plane.
fn middle_of_surface(cell: &Cell) -> Option<[Plane; 2]> {
    let corners = cell.points.iter().skip(cell.windings.len());
    let along = |axis: usize| -> Vec<Real> {
        let mut all: Vec<Real> = corners.clone().map(|x| [x.x, x.y, x.z][axis]).collect();
        all.sort_unstable_by(Real::total_cmp);
        all
    };
    let length = |all: &[Real]| all.last().zip(all.first()).map_or(0.0, |(hi, lo)| hi - lo);
    let all: Vec<(usize, Vec<Real>)> = (0..3).map(|axis| (axis, along(axis))).collect();
    let (axis, all) = all.into_iter().max_by(|a, b| length(&a.1).total_cmp(&length(&b.1)))?;
    let middle = &all[all.len() / 4..all.len() - all.len() / 4];
    let gap = middle.windows(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    let place = 0.5 * (gap[0] + gap[1]);
    let unit = [0, 1, 2].map(|k| if k == axis { 1.0 } else { 0.0 });
    let plane = |sign: Real| Plane { n: v3(sign * unit[0], sign * unit[1], sign * unit[2]), d: -sign * place };
    (gap[0] < place && place < gap[1]).then(|| [plane(1.0), plane(-1.0)])
}

/// The two half-spaces of a plane just before a triangle, or just behind it where `sign` is negative: that with the triangle, and the other.
fn planes_before<S: DomainStore>(store: &S, t: u32, sign: Real) -> [Plane; 2] {
    let site = store.site();
    let [a, b, c] = [0, 1, 2].map(|k| sub(store.triangle_point(t, k), site));
    let mut plane = triangle_plane(a, b, c, -sign);
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

/// The same of a store that is a copy.
fn again<'a>(store: &PlainStore<'a>) -> PlainStore<'a> {
    let mut copy = store.clone();
    (0..store.planes()).for_each(|f| copy.set_link(f, 0));
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
    if volume == 0.0 {
        return false;
    }
    let (mut before, sign) = (0.0, volume.signum());
    for face in &seen {
        before += corners.iter().map(|&x| -sign * face.volume(x)).fold(0.0, Real::max);
        if before > NOTHING * volume.abs() {
            return false;
        }
    }
    true
}

/// A point from which all faces of a component are seen, or what stands against it.
///
/// Such points are in the cell and behind all of its surface: what is left of the clipped cell by those half-spaces.
fn apex<S: DomainStore>(store: &S, cell: &Cell, faces: &[usize]) -> Result<V3, Turned> {
    let triangle = |face: &usize| match cell.faces.beyond[*face] {
        Beyond::Surface(t) => Some(t),
        _ => None,
    };
    let mut triangles: Vec<u32> = faces.iter().filter_map(triangle).collect();
    let volume = volume_of(cell, faces);
    let sign = volume.signum();
    let mut kernel = copy(store);
    for k in 0..triangles.len() {
        if clip(&mut kernel, planes_before(store, triangles[k], sign)[0], TAG_CAP) == EMPTY {
            triangles.rotate_left(k);
            return Err(Turned { triangles, sign });
        }
    }
    let n = Real::from(kernel.vertices());
    let sum = (0..kernel.vertices()).map(|v| kernel.position(v)).fold(V3::default(), add);
    let apex = v3(sum.x / n, sum.y / n, sum.z / n);
    let is_seen = |&face: &usize| sign * seen(cell, face).volume(apex) >= -NOTHING * volume.abs();
    if faces.iter().all(is_seen) { Ok(apex) } else { Err(Turned { triangles, sign }) }
}
