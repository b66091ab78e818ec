//! The geometry of restricted cells: polygons with shared corners, and convex solids.
//!
//! `cell` makes the faces of one cell, `solids` the convex solids of one that is not convex; `collect` puts those of all cells together, `host`
//! makes them where the cells themselves are computed elsewhere.

mod cell;
mod collect;
mod faces;
mod heights;
mod host;
mod near;
mod solids;
mod surface;

pub use collect::{GeometryAssembler, Shaper, Shapes};
pub use host::on_host;

use faces::Faces;
use std::ops::Range;

/// What is on the other side of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Beyond {
    /// The cell of another site, by its index.
    Site(u32),
    /// The outside of the domain, behind this triangle of its surface.
    Surface(u32),
    /// The outside of the box, behind its face of this number: 0 to 5 for low x, high x, low y, high y, low z, high z.
    Box(u8),
    /// Another solid of the same cell.
    Nothing,
}

/// A polygon, planar to rounding. It is convex, or a triangle of what is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Face<'a> {
    /// Its corners, as indices of [`Geometry::points`], counterclockwise from outside its cell.
    pub corners: &'a [u32],
    /// What is on its other side.
    pub beyond: Beyond,
}

/// The restricted cells as polygons, in the caller's coordinates: of each cell its facets, cut to what is within the domain, and its piece of the
/// domain's surface.
///
/// The faces of a cell close it: the volume that they enclose, and its barycenter, are those of the cell, but for the rounding of coordinates.
/// Where the winding number is not one they stand as often as it says, turned where it is negative. Cells share the corners that they have in common,
/// also where more than four meet in one, as in a lattice.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    points: Vec<[f64; 3]>,
    faces: Faces,
    /// Of each site its faces.
    rows: Vec<Range<usize>>,
    has_solids: bool,
    solid_faces: Faces,
    /// Of each solid its faces.
    solids: Vec<Range<usize>>,
    /// Of each site its solids; none where it is convex.
    solid_rows: Vec<Range<usize>>,
}

impl Geometry {
    /// The corners of all faces (length).
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The number of sites.
    pub fn sites(&self) -> usize {
        self.rows.len()
    }

    /// The faces of the cell of site `i`; none where it is empty.
    ///
    /// # Panics
    /// Where there is no such site.
    pub fn faces(&self, i: usize) -> impl ExactSizeIterator<Item = Face<'_>> + Clone {
        range_of(&self.faces, self.rows[i].clone())
    }

    /// Whether there are solids, which [`Request::with_solids`](crate::Request::with_solids) asks for.
    pub fn has_solids(&self) -> bool {
        self.has_solids
    }

    /// The cell of site `i` as convex solids: itself where it is convex, else pyramids, or larger ones where those would not do. They stand as often as
    /// the winding number says, turned inside out where it is negative. None where solids were not asked for.
    ///
    /// # Panics
    /// Where there is no such site.
    pub fn solids(&self, i: usize) -> impl Iterator<Item = Vec<Face<'_>>> {
        let pieces = self.solid_rows[i].clone();
        let itself =
            (self.has_solids && pieces.is_empty() && !self.rows[i].is_empty()).then(|| self.faces(i).collect());
        itself.into_iter().chain(pieces.map(|k| range_of(&self.solid_faces, self.solids[k].clone()).collect()))
    }
}

fn range_of(faces: &Faces, range: Range<usize>) -> impl ExactSizeIterator<Item = Face<'_>> + Clone {
    range.map(|face| Face { corners: faces.corners_of(face), beyond: faces.beyond[face] })
}

#[cfg(test)]
mod tests;
