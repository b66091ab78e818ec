//! The geometry of all cells, put together: points that several cells have are found by what meets there.

use super::cell::Cell;
use super::faces::Faces;
use super::near::{join_near, unite};
use super::solids::Solids;
use super::surface::Key;
use super::{Beyond, Geometry};
use crate::cell::{COMPLETE, DomainStore, TAG_BOX, v3};
use crate::frame::Frame;
use crate::{Error, Result};
use foldhash::fast::FixedState;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// What meets in a point: sites by their numbers, faces of the box by those from `FACE_OF_BOX` on, then triangles and vertices of the domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Meeting {
    of: [u32; 4],
    kind: u8,
}

/// Where cells have a point that they share, in the unit of the frame. It is farther apart where planes are nearly parallel: each cell has rounded
/// them for itself, and where a triangle lies in a facet's plane, but for rounding, that decides where it passes through.
const AGREED: f64 = 1.0 / (1_u64 << 47) as f64;

const FACE_OF_BOX: u32 = 1 << 31;
/// No such entry.
const NONE: u32 = u32::MAX;

/// A point that other cells may have, too: what meets there, how many cells that are, and its number among the cell's.
#[derive(Clone, Copy, Debug)]
struct Shared {
    meeting: Meeting,
    cells: u8,
    point: u32,
}

/// The geometry of some cells, of one after the other.
#[derive(Debug, Default)]
pub struct Shapes {
    cells: Vec<Shape>,
    /// In the caller's coordinates.
    points: Vec<[f64; 3]>,
    shared: Vec<Shared>,
    faces: Faces,
    solid_faces: Faces,
    solid_ends: Vec<usize>,
}

/// Where what a cell has ends.
#[derive(Clone, Copy, Debug)]
struct Shape {
    /// The caller's index of its site.
    site: u32,
    points: usize,
    shared: usize,
    faces: usize,
    solids: usize,
}

/// Makes the geometry of cells, one after the other, and keeps its room.
#[derive(Debug, Default)]
pub struct Shaper {
    with_solids: bool,
    cell: Cell,
    solids: Solids,
    /// Of each point of the cell its number among those that are used.
    numbers: Vec<u32>,
}

impl Shaper {
    /// For cells as polygons, or as solids, too.
    pub fn new(with_solids: bool) -> Self {
        Self { with_solids, ..Self::default() }
    }

    /// Adds the geometry of a finished cell, of sorted site `site` and of restricted volume `volume` (in the frame), to `shapes`. The tags are sorted
    /// sites, and `order` the caller's. Returns `COMPLETE`, or `UNCERTAIN`, which cannot happen while signs are exact.
    pub fn add<S: DomainStore>(
        &mut self,
        store: &S,
        site: u32,
        volume: f64,
        order: &[u32],
        frame: &Frame,
        shapes: &mut Shapes,
    ) -> u32 {
        let status = self.cell.make(store, volume);
        if status != COMPLETE {
            return status;
        }
        if self.with_solids {
            self.solids.make(store, &self.cell);
        }
        let (cell, solids) = (&self.cell, &self.solids);
        let (keys, points) =
            if solids.ends.is_empty() { (&cell.keys, &cell.points) } else { (&solids.keys, &solids.points) };
        let first = shapes.points.len();
        self.numbers.clear();
        self.numbers.resize(points.len(), NONE);
        let numbers = &mut self.numbers;
        let p = store.site();
        let Shapes { points: placed, faces, solid_faces, .. } = shapes;
        let mut number = |&i: &u32| {
            let number = &mut numbers[i as usize];
            if *number == NONE {
                *number = (placed.len() - first) as u32;
                let x = points[i as usize];
                placed.push(frame.leave([p.x + x.x, p.y + x.y, p.z + x.z]));
            }
            *number
        };
        let caller = |beyond: Beyond| match beyond {
            Beyond::Site(tag) => Beyond::Site(order[tag as usize]),
            other => other,
        };
        for (corners, beyond) in cell.faces.iter() {
            faces.push(corners.iter().map(&mut number), caller(beyond));
        }
        for (corners, beyond) in solids.faces.iter() {
            solid_faces.push(corners.iter().map(&mut number), caller(beyond));
        }
        let before = shapes.solid_faces.len() - solids.faces.len();
        shapes.solid_ends.extend(solids.ends.iter().map(|end| before + end));
        for (i, key) in keys.iter().enumerate() {
            let point = cell.same.get(i).map_or(NONE, |&same| self.numbers[same as usize]);
            if point != NONE
                && let Some((meeting, cells)) = meeting(store, site, *key)
            {
                shapes.shared.push(Shared { meeting, cells, point });
            }
        }
        shapes.cells.push(Shape {
            site: order[site as usize],
            points: shapes.points.len(),
            shared: shapes.shared.len(),
            faces: shapes.faces.len(),
            solids: shapes.solid_ends.len(),
        });
        COMPLETE
    }
}

/// What meets in a point of the cell of `site`, and how many cells do; `None` where no other cell can know it.
fn meeting<S: DomainStore>(store: &S, site: u32, key: Key) -> Option<(Meeting, u8)> {
    let of_plane = |f: u32| match store.tag(f) {
        TAG_BOX => Some(FACE_OF_BOX + u32::from(super::cell::face_of_box(store.plane(f).n))),
        tag if tag < TAG_BOX => Some(tag),
        _ => None,
    };
    let sorted = |mut cells: [u32; 4], n: usize| {
        cells[..n].sort_unstable();
        (cells, cells[..n].iter().filter(|&&c| c < FACE_OF_BOX).count() as u8)
    };
    let ((of, cells), kind) = match key {
        Key::Vertex([f, g, h]) => (sorted([site, of_plane(f)?, of_plane(g)?, of_plane(h)?], 4), 0),
        Key::Crossing([f, g], t) => (sorted([site, of_plane(f)?, of_plane(g)?, t], 3), 1),
        Key::OnEdge(f, [v, w]) => (sorted([site, of_plane(f)?, v, w], 2), 2),
        Key::Surface(v) => (([v, 0, 0, 0], u8::MAX), 3),
        Key::Inner(_) => return None,
    };
    Some((Meeting { of, kind }, cells))
}

/// Collects the geometry of all cells into a [`Geometry`].
#[derive(Debug, Default)]
pub struct GeometryAssembler {
    geometry: Geometry,
    /// Points that more cells are still to come to, and how many.
    waiting: HashMap<Meeting, (u32, u8), FixedState>,
    /// Numbers of points that a cell has as one.
    same: Vec<[u32; 2]>,
    /// How near a point is to where another cell has it, to be the same.
    agreed: f64,
    most_points: usize,
}

impl GeometryAssembler {
    /// For so many sites, with the frame of their container; `with_solids` as those who make the shapes have it.
    pub fn new(sites: usize, frame: &Frame, with_solids: bool) -> Self {
        let geometry = Geometry {
            has_solids: with_solids,
            rows: vec![0..0; sites],
            solid_rows: vec![0..0; sites],
            ..Geometry::default()
        };
        let (waiting, same) = (HashMap::default(), Vec::new());
        Self { geometry, waiting, same, agreed: AGREED * frame.unit(), most_points: NONE as usize }
    }

    #[cfg(test)]
    pub(super) fn with_most_points(self, most_points: usize) -> Self {
        Self { most_points, ..self }
    }

    /// Adds some cells.
    pub fn add(&mut self, shapes: &Shapes) {
        if self.geometry.points.len() + shapes.points.len() > self.most_points {
            // `finish` says so.
            self.most_points = 0;
            return;
        }
        let mut begin = Shape { site: 0, points: 0, shared: 0, faces: 0, solids: 0 };
        let mut numbers: Vec<u32> = Vec::new();
        for end in &shapes.cells {
            numbers.clear();
            numbers.resize(end.points - begin.points, NONE);
            let shared = &shapes.shared[begin.shared..end.shared];
            for s in shared {
                let number = &mut numbers[s.point as usize];
                if let Some(&(known, _)) = self.waiting.get(&s.meeting) {
                    let here = shapes.points[begin.points + s.point as usize];
                    let there = self.geometry.points[known as usize];
                    // The caller's coordinates are rounded, too.
                    let near = |k: usize| self.agreed + 2.0 * f64::EPSILON * there[k].abs();
                    if (0..3).any(|k| (here[k] - there[k]).abs() > near(k)) {
                        continue;
                    }
                    if *number == NONE {
                        *number = known;
                    } else if *number != known {
                        self.same.push([*number, known]);
                    }
                }
            }
            let geometry = &mut self.geometry;
            for (number, point) in numbers.iter_mut().zip(&shapes.points[begin.points..end.points]) {
                if *number == NONE {
                    *number = geometry.points.len() as u32;
                    geometry.points.push(*point);
                }
            }
            // A point waits until all cells that meet there have come, which, in the order of the sites along a curve, is soon.
            for s in shared {
                match self.waiting.entry(s.meeting) {
                    Entry::Vacant(entry) if s.cells > 1 => {
                        entry.insert((numbers[s.point as usize], s.cells - 1));
                    }
                    Entry::Vacant(_) => {}
                    Entry::Occupied(mut entry) => {
                        if s.cells < u8::MAX {
                            entry.get_mut().1 -= 1;
                        }
                        if entry.get().1 == 0 {
                            entry.remove();
                        }
                    }
                }
            }
            let i = end.site as usize;
            let number = |corner: &u32| numbers[*corner as usize];
            let mut corners = Vec::new();
            let first = geometry.faces.len();
            for face in begin.faces..end.faces {
                // Points that this cell tells apart may be one to another.
                corners.clear();
                corners.extend(shapes.faces.corners_of(face).iter().map(number));
                geometry.faces.push_simplified(&mut corners, shapes.faces.beyond[face]);
            }
            geometry.rows[i] = first..geometry.faces.len();
            let first = geometry.solids.len();
            for solid in begin.solids..end.solids {
                let from = if solid == 0 { 0 } else { shapes.solid_ends[solid - 1] };
                let first = geometry.solid_faces.len();
                for face in from..shapes.solid_ends[solid] {
                    corners.clear();
                    corners.extend(shapes.solid_faces.corners_of(face).iter().map(number));
                    geometry.solid_faces.push_simplified(&mut corners, shapes.solid_faces.beyond[face]);
                }
                geometry.solids.push(first..geometry.solid_faces.len());
            }
            geometry.solid_rows[i] = first..geometry.solids.len();
            begin = *end;
        }
    }

    /// All of it.
    ///
    /// # Errors
    /// `Input` where there are more points than their numbers can tell apart, 2³².
    pub fn finish(mut self) -> Result<Geometry> {
        if self.most_points == 0 {
            let message = "the geometry of these sites has more than 4,294,967,295 points; take fewer sites, or a part of the domain";
            return Err(Error::input(message));
        }
        self.join_points();
        Ok(self.geometry)
    }

    /// Makes one of points that are in one place, though no two cells know them by the same meeting. Where more than four cells meet, each has decided
    /// for itself which of them are its vertex; so there points wait for cells that do not come, or a cell has one that two others have apart.
    fn join_points(&mut self) {
        let geometry = &mut self.geometry;
        let mut waiting: Vec<u32> = self.waiting.values().map(|&(point, _)| point).collect();
        waiting.sort_unstable();
        waiting.dedup();
        let largest =
            waiting.iter().flat_map(|&i| geometry.points[i as usize]).fold(0.0, |most: f64, x| most.max(x.abs()));
        let near = self.agreed + 2.0 * f64::EPSILON * largest;
        let place = |&i: &u32| {
            let [x, y, z] = geometry.points[i as usize];
            (i, v3(x, y, z))
        };
        join_near(waiting.iter().map(place), near, |a, b| self.same.push([a, b]));
        if self.same.is_empty() {
            return;
        }
        let mut numbers: Vec<u32> = (0..geometry.points.len() as u32).collect();
        self.same.iter().for_each(|&[a, b]| unite(&mut numbers, a, b));
        // Lesser numbers come first, so each that stands for others has its new one before them.
        let mut kept = 0;
        for i in 0..numbers.len() {
            numbers[i] = if numbers[i] == i as u32 {
                geometry.points[kept] = geometry.points[i];
                kept += 1;
                (kept - 1) as u32
            } else {
                numbers[numbers[i] as usize]
            };
        }
        geometry.points.truncate(kept);
        let number = |i: u32| numbers[i as usize];
        for (faces, rows) in
            [(&mut geometry.faces, &mut geometry.rows), (&mut geometry.solid_faces, &mut geometry.solids)]
        {
            let kept = faces.renumber(number);
            rows.iter_mut().for_each(|row| *row = kept[row.start]..kept[row.end]);
        }
    }
}
