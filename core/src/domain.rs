//! The domain: a closed triangle mesh, validated once.

mod density;
mod moments;
mod orient;
mod topology;

use std::fmt;
use std::sync::{Arc, OnceLock};

use crate::diagram::{LARGEST_COORDINATE, bounding_box};
use crate::domain_grid::DomainGrid;
use crate::frame::Frame;
use crate::{Error, Result, memory};

/// Most triangles that a domain may have: the grid's lists, at most 8 entries a triangle and voxel, are indexed by `u32`.
pub const MOST_TRIANGLES: usize = 1 << 28;

/// What validation takes of memory for each: half a vertex in a table (80), three edges (48), the mesh itself and a copy in its frame.
const BYTES_OF_TRIANGLE: u64 = 192;

/// Grids are made for 2¹⁰ to 2²³ sites.
const FEWEST: usize = 10;
const LEVELS: usize = 14;

/// The smallest share of its bounding box that a domain is taken to fill, for the memory of a grid whose voxels are as far apart as sites inside.
const SMALLEST_SHARE: f64 = 1.0 / 16.0;

/// A closed triangle mesh with its integrals, shared and never copied: cloning it is cheap.
///
/// The domain is the function `winding(x)` on space: 1 inside a simple closed surface whose triangles are
/// counterclockwise seen from outside, 0 outside; shells add up. Its volume is `∫ winding`.
///
/// It may also be a density `ρ(x)`, constant in each voxel of an image ([`Domain::of_image`]) or in each tetrahedron
/// ([`Domain::of_tetrahedra`]): a winding number times a unit. Then all integrals are weighted by it, and exact: volumes are masses `∫ ρ`,
/// barycenters and second moments are those of mass, areas of facets are `∫ ρ` over them.
#[derive(Clone)]
pub struct Domain {
    inner: Arc<Inner>,
}

struct Inner {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    times: Vec<i32>,
    /// Mass per volume where the winding number is one.
    density: f64,
    mean_density: Option<f64>,
    volume: f64,
    barycenter: [f64; 3],
    area: f64,
    lo: [f64; 3],
    hi: [f64; 3],
    notes: Vec<String>,
    frame: Frame,
    /// One for each power of two of sites.
    grids: [OnceLock<Arc<DomainGrid>>; LEVELS],
}

impl Domain {
    /// The domain bounded by `triangles`, indices into `vertices`, counterclockwise seen from outside.
    ///
    /// Vertices at identical positions become one; triangles with two equal vertices and vertices of no triangle are
    /// dropped. Every edge must then belong to an even number of triangles, which is to be closed: several components,
    /// shells, surfaces that touch and edges shared by four triangles are legal.
    ///
    /// Where every edge is met equally often in each direction, the orientation is the caller's, and only a mesh whose volume is negative is
    /// turned inside out, with a note. Where not, there is no winding number, and the triangles are oriented as [`Domain::oriented`] does,
    /// with a note.
    ///
    /// # Errors
    /// `Input` where an index or a coordinate is out of range, the surface is open or one-sided, or
    /// nothing is enclosed. Triangles and vertices are counted from 0 in the order given.
    pub fn new(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self> {
        Ok(Self::of(Inner::validated(vertices, triangles, None, false)?))
    }

    /// The domain bounded by `triangles` as [`Domain::new`] makes it, whatever their orientation is: those that share an edge are made to agree, and
    /// every component is turned outward, or inward where it lies within an odd number of others, so that the shell of a cavity is one. Time
    /// `O(T log T)` for `T` triangles.
    ///
    /// # Errors
    /// As [`Domain::new`].
    pub fn oriented(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self> {
        Ok(Self::of(Inner::validated(vertices, triangles, None, true)?))
    }

    /// The same where each triangle stands so many times, and a winding number of one is so much mass per volume; there is mass in a volume of `support`. It is closed.
    fn of_density(
        vertices: &[[f64; 3]],
        triangles: &[[u32; 3]],
        times: &[i32],
        density: f64,
        support: f64,
        note: Option<String>,
    ) -> Result<Self> {
        let mut inner = Inner::validated(vertices, triangles, Some((times, density)), false)?;
        inner.mean_density = Some(inner.volume / support);
        inner.notes.extend(note);
        Ok(Self::of(inner))
    }

    fn of(inner: Inner) -> Self {
        Self { inner: Arc::new(inner) }
    }

    /// The vertices, each once, in the caller's unit and order of first appearance.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.inner.vertices
    }

    /// The triangles as indices into [`Domain::vertices`], counterclockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.inner.triangles
    }

    /// `∫ winding(x) dx`, positive, in the caller's unit cubed, to two roundings.
    pub fn volume(&self) -> f64 {
        self.inner.volume
    }

    /// `∫ winding(x) x dx / volume`, in the caller's unit, to a few roundings of the box's coordinates.
    pub fn barycenter(&self) -> [f64; 3] {
        self.inner.barycenter
    }

    /// Mass per volume where the winding number is one: 1 of a mesh.
    #[doc(hidden)]
    pub fn density(&self) -> f64 {
        self.inner.density
    }

    /// Whether it has a density of its own ([`Domain::of_image`], [`Domain::of_tetrahedra`]), so that what is said to be a volume is a mass.
    pub fn has_density(&self) -> bool {
        self.inner.mean_density.is_some()
    }

    /// Mass per volume where there is any: 1 of a mesh.
    pub fn mean_density(&self) -> f64 {
        self.inner.mean_density.unwrap_or(1.0)
    }

    /// The sum of the areas of all triangles, in the caller's unit squared.
    pub fn area(&self) -> f64 {
        self.inner.area
    }

    /// The smallest box around the triangles: its minimum and maximum corners, in the caller's unit.
    pub fn bounding_box(&self) -> ([f64; 3], [f64; 3]) {
        (self.inner.lo, self.inner.hi)
    }

    /// What was changed on the way in, one line each; empty where the mesh was taken as it is.
    pub fn notes(&self) -> &[String] {
        &self.inner.notes
    }

    /// The frame in which cells are computed: that of the bounding box.
    #[doc(hidden)]
    pub fn frame(&self) -> &Frame {
        &self.inner.frame
    }

    /// Volume of the grid for so many sites (length³): all that cells have in it is integrated. (Its first call for such a number builds the grid, as an evaluation does, which is kept.)
    pub fn grid_volume(&self, sites: usize) -> f64 {
        let grid = self.grid(sites);
        grid.dims().iter().map(|&n| f64::from(n) * grid.voxel_width() * self.inner.frame.unit()).product()
    }

    /// The grid over the domain for so many sites inside, in the coordinates of [`Domain::frame`]: about one voxel for each, and voxels
    /// of that size around it, so that few cells seem to meet the surface that do not. Built on the first call for the next power of two, and kept.
    #[doc(hidden)]
    pub fn grid(&self, sites: usize) -> &Arc<DomainGrid> {
        let level = (sites.max(1).next_power_of_two().trailing_zeros() as usize).clamp(FEWEST, FEWEST + LEVELS - 1);
        let kept = &self.inner.grids[level - FEWEST];
        if let Some(grid) = kept.get() {
            return grid;
        }
        // (Before it is kept, not while others wait for it: a thread of a pool that waits for parts of a grid may take up a task that asks for the same grid.)
        let made = self.made_grid(level);
        kept.get_or_init(|| Arc::new(made))
    }

    fn made_grid(&self, level: usize) -> DomainGrid {
        let vertices: Vec<[f64; 3]> = self.inner.vertices.iter().map(|&v| self.inner.frame.enter(v)).collect();
        let (lo, hi) = self.bounding_box();
        let unit = self.inner.frame.unit();
        let extent = (0..3).map(|k| (hi[k] - lo[k]) / unit).product::<f64>();
        let share =
            (self.inner.volume / self.mean_density() / (unit * unit * unit) / extent).clamp(SMALLEST_SHARE, 1.0);
        let in_box = f64::from(1_u32 << level) / share;
        DomainGrid::new(&vertices, &self.inner.triangles, &self.inner.times, in_box as usize)
    }
}

impl Inner {
    /// Of triangles that stand once, or as often as is said, where a winding number of one is so much mass per volume. What is said is closed.
    fn validated(
        vertices: &[[f64; 3]],
        triangles: &[[u32; 3]],
        said: Option<(&[i32], f64)>,
        orient: bool,
    ) -> Result<Self> {
        check_numbers(vertices, triangles)?;
        memory::probe(triangles.len() as u64, BYTES_OF_TRIANGLE, "triangles of the domain")?;
        let mut mesh = topology::weld(vertices, triangles, said.map(|(times, _)| times));
        let density = said.map_or(1.0, |(_, density)| density);
        if mesh.triangles.is_empty() {
            return Err(Error::input(format!(
                "all {} triangles of the domain have two vertices at one place: nothing is enclosed; check the scale of \
                 the mesh",
                triangles.len()
            )));
        }
        // (What is said is made by code.)
        let edges = said.is_none().then(|| topology::Edges::of(&mesh));
        edges.as_ref().map_or(Ok(()), |edges| topology::check_closed(&mesh, edges))?;
        let (lo, hi) = bounding_box(&mesh.vertices);
        let extent = (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max);
        if extent < 1.0 / LARGEST_COORDINATE {
            return Err(Error::input(format!(
                "the domain's largest extent is {extent:e}: it must be at least 1e-60; scale the mesh up"
            )));
        }
        let frame = Frame::of_box(lo, hi);
        let inside: Vec<[f64; 3]> = mesh.vertices.iter().map(|&v| frame.enter(v)).collect();
        let agree = edges.as_ref().is_none_or(topology::Edges::are_balanced);
        let turned = match &edges {
            Some(edges) if !agree || orient => orient::orient(&mut mesh, &inside, edges)?,
            _ => 0,
        };
        drop(edges);
        let moments = moments::Moments::of_mesh(&inside, &mesh.triangles, &mesh.times);
        let unit = frame.unit();
        let mut volume = moments.volume * unit * unit * unit * density;
        if volume == 0.0 {
            return Err(Error::input(format!(
                "the domain's {} triangles enclose volume 0: give a closed surface that bounds a solid",
                mesh.triangles.len()
            )));
        }
        let mut notes = Vec::new();
        let dropped = triangles.len() - mesh.triangles.len();
        if dropped > 0 {
            notes.push(format!("{dropped} triangles with two vertices at one place were dropped"));
        }
        if turned > 0 {
            let why = if agree { "" } else { ", for they were not consistently oriented" };
            notes.push(format!(
                "{turned} of {} triangles were turned{why}: every part of the surface is outward now, or inward within an odd number of others",
                mesh.triangles.len()
            ));
        }
        if volume < 0.0 {
            volume = -volume;
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            notes.push("the mesh was oriented inward: all its triangles were flipped".to_owned());
        }
        Ok(Self {
            volume,
            barycenter: frame.leave(moments.barycenter),
            area: moments.area * unit * unit * density,
            vertices: mesh.vertices,
            triangles: mesh.triangles,
            times: mesh.times,
            density,
            mean_density: None,
            lo,
            hi,
            notes,
            frame,
            grids: [const { OnceLock::new() }; LEVELS],
        })
    }
}

impl fmt::Debug for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let inner = &self.inner;
        f.debug_struct("Domain")
            .field("vertices", &inner.vertices.len())
            .field("triangles", &inner.triangles.len())
            .field("volume", &inner.volume)
            .field("bounding_box", &(inner.lo, inner.hi))
            .field("notes", &inner.notes)
            .finish()
    }
}

fn check_numbers(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<()> {
    if triangles.is_empty() {
        return Err(Error::input("the domain has no triangles: give a closed triangle mesh"));
    }
    if triangles.len() > MOST_TRIANGLES {
        return Err(Error::input(format!(
            "the domain has {} triangles: at most {MOST_TRIANGLES} are possible; simplify the mesh",
            triangles.len()
        )));
    }
    for (i, v) in vertices.iter().enumerate() {
        if let Some(x) = v.iter().find(|x| x.is_nan() || x.abs() > LARGEST_COORDINATE) {
            return Err(Error::input(format!(
                "vertex {i} of the domain: coordinate {x:e} is not a number within ±1e60; choose another unit"
            )));
        }
    }
    for (f, t) in triangles.iter().enumerate() {
        if let Some(i) = t.iter().find(|&&i| i as usize >= vertices.len()) {
            return Err(Error::input(format!(
                "triangle {f} of the domain: vertex index {i} (counted from 0) is out of range; there are {} vertices",
                vertices.len()
            ))
            .of_triangle(f));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
