//! The cells of one diagram as bytes that the page's `data.js` reads: compact, so that a file of 100,000 cells stays below 20 MB.
//!
//! Cells stand along a Morton curve, points in the order of their first use, so that what is near in space is near in the block: a corner is
//! then most often one byte. A facet between two cells stands once. The whole is deflated, which every browser of this decade undoes by itself.

use std::collections::HashMap;
use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use laguerre::geometry::{Beyond, Face};
use laguerre::{Geometry, Output, PowerDiagram};
use serde::Serialize;

/// The corners and the size of what a page shows: positions are relative to the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) lo: [f64; 3],
    pub(super) hi: [f64; 3],
    pub(super) size: f64,
}

/// A coordinate is one of so many along the size: as fine as the 24 bits of a 32-bit float, which is what a graphics card computes with.
const STEPS: f64 = ((1_u32 << 24) - 1) as f64;
/// Bits of each coordinate in the order of the cells.
const MORTON_BITS: u32 = 10;

/// How long the parts of a block are.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Lengths {
    pub(super) cells: usize,
    points: usize,
    faces: usize,
    corners: usize,
    /// Bytes of the four streams of whole numbers: faces of each cell; what is beyond each face; its number of corners; the corners.
    streams: [usize; 4],
}

/// The cells of one diagram.
#[derive(Debug)]
pub(super) struct Block {
    pub(super) lengths: Lengths,
    /// Of each field its values, cell by cell.
    pub(super) fields: Vec<Vec<f32>>,
    pub(super) deflated: Vec<u8>,
}

impl Block {
    /// The cells that have faces; `fields` are numbers of sites, each with what they are in units of.
    pub(super) fn new(
        diagram: &PowerDiagram,
        output: &Output,
        geometry: &Geometry,
        frame: Frame,
        fields: &[(&[f64], f64)],
    ) -> io::Result<Self> {
        let order = order(output, geometry, frame);
        let faces = Faces::new(geometry, &order);
        let values =
            |&(numbers, unit): &(&[f64], f64)| order.iter().map(|&i| (numbers[i as usize] / unit) as f32).collect();
        let fields: Vec<Vec<f32>> = fields.iter().map(values).collect();
        let mut w = ZlibEncoder::new(Vec::new(), Compression::default());
        order.iter().try_for_each(|i| w.write_all(&i.to_le_bytes()))?;
        for positions in [diagram.positions(), output.barycenter()] {
            for &i in &order {
                let relative = |k: usize| ((positions[i as usize][k] - frame.lo[k]) / frame.size) as f32;
                (0..3).try_for_each(|k| w.write_all(&relative(k).to_le_bytes()))?;
            }
        }
        fields.iter().flatten().try_for_each(|x| w.write_all(&x.to_le_bytes()))?;
        order.iter().try_for_each(|&i| w.write_all(&[output.status()[i as usize].number()]))?;
        // Byte by byte: of the high ones deflating leaves little.
        for k in 0..3 {
            for byte in 0..3 {
                let of = |&point: &u32| frame.step(geometry.points()[point as usize], k).to_le_bytes()[byte];
                w.write_all(&faces.points.iter().map(of).collect::<Vec<u8>>())?;
            }
        }
        faces.streams.iter().try_for_each(|stream| w.write_all(stream))?;
        let lengths = Lengths {
            cells: order.len(),
            points: faces.points.len(),
            faces: faces.count,
            corners: faces.corners,
            streams: faces.streams.each_ref().map(Vec::len),
        };
        Ok(Self { lengths, fields, deflated: w.finish()? })
    }
}

impl Frame {
    /// A coordinate in steps from the corner.
    fn step(&self, point: [f64; 3], k: usize) -> u32 {
        ((point[k] - self.lo[k]) / self.size * STEPS).round().clamp(0.0, STEPS) as u32
    }
}

/// The sites whose cells have faces, so that those near in space are near in the order.
fn order(output: &Output, geometry: &Geometry, frame: Frame) -> Vec<u32> {
    let mut order: Vec<u32> =
        (0..geometry.sites()).filter(|&i| geometry.faces(i).len() > 0).map(|i| i as u32).collect();
    order.sort_by_cached_key(|&i| {
        let steps = [0, 1, 2].map(|k| frame.step(output.barycenter()[i as usize], k) >> (24 - MORTON_BITS));
        (0..3 * MORTON_BITS).fold(0_u32, |code, bit| code | (steps[bit as usize % 3] >> (bit / 3) & 1) << bit)
    });
    order
}

/// The faces of all cells, each between two cells once.
#[derive(Default)]
struct Faces {
    count: usize,
    corners: usize,
    /// Points of the geometry, in the order of their first use.
    points: Vec<u32>,
    streams: [Vec<u8>; 4],
}

const NONE: u32 = u32::MAX;

impl Faces {
    fn new(geometry: &Geometry, order: &[u32]) -> Self {
        let mut all = Self::default();
        let mut place = vec![NONE; geometry.sites()];
        (0..).zip(order).for_each(|(cell, &i)| place[i as usize] = cell);
        let mut numbers = vec![NONE; geometry.points().len()];
        let mut edges = HashMap::new();
        for (cell, &i) in (0_u32..).zip(order) {
            let beyond = |face: &Face<'_>| match face.beyond {
                // One after it in the order: 1 and more.
                Beyond::Site(j) => place[j as usize].wrapping_sub(cell),
                _ => 0,
            };
            soft_edges(geometry.faces(i as usize), &mut edges);
            let own = geometry.faces(i as usize).filter(|face| match face.beyond {
                Beyond::Site(j) => place[j as usize] > cell && place[j as usize] != NONE,
                _ => true,
            });
            let before = all.count;
            for face in own {
                all.count += 1;
                all.corners += face.corners.len();
                put(&mut all.streams[1], beyond(&face));
                put(&mut all.streams[2], face.corners.len() as u32);
                for (k, &point) in face.corners.iter().enumerate() {
                    let next = face.corners[(k + 1) % face.corners.len()];
                    let is_soft = edges.get(&edge(point, next)).is_some_and(|&(_, is_soft)| is_soft);
                    let number = &mut numbers[point as usize];
                    let back = if *number == NONE { 0 } else { all.points.len() as u32 - *number };
                    if back == 0 {
                        *number = all.points.len() as u32;
                        all.points.push(point);
                    }
                    put(&mut all.streams[3], 2 * back + u32::from(is_soft));
                }
            }
            put(&mut all.streams[0], (all.count - before) as u32);
        }
        all
    }
}

/// Of each edge of a cell what is beyond a face at it, and whether it is drawn: not where both of its faces are of one facet, or of the surface.
fn soft_edges<'a>(faces: impl Iterator<Item = Face<'a>>, edges: &mut HashMap<(u32, u32), (u32, bool)>) {
    edges.clear();
    for face in faces {
        let beyond = match face.beyond {
            Beyond::Site(j) => j,
            Beyond::Box(side) => NONE - 2 - u32::from(side),
            Beyond::Surface(_) => NONE - 1,
            Beyond::Nothing => NONE,
        };
        for (k, &point) in face.corners.iter().enumerate() {
            let next = face.corners[(k + 1) % face.corners.len()];
            edges.entry(edge(point, next)).and_modify(|known| known.1 = known.0 == beyond).or_insert((beyond, false));
        }
    }
}

fn edge(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// A whole number in seven bits a byte, the lowest first; the eighth bit says that there is more.
fn put(stream: &mut Vec<u8>, mut number: u32) {
    while number >= 0x80 {
        stream.push(number as u8 | 0x80);
        number >>= 7;
    }
    stream.push(number as u8);
}
