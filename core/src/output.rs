//! What comes back: flat arrays in the caller's order and units.

use crate::algebra::Kept;
use crate::facets::{Boundary, Facets};
use crate::geometry::Geometry;
use crate::laplacian::Laplacian;
use crate::{Error, Result};

/// How the computation of one cell ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CellStatus {
    /// The cell is complete, by proof: no site was missed and every sign was decided exactly.
    Complete,
    /// The cell is empty, by proof, or its volume is below its own rounding bound.
    Empty,
    /// The search was ended by [`Request::with_epsilon`](crate::Request::with_epsilon) before completeness was proved; the cell may be too large.
    Uncertified,
}

impl CellStatus {
    /// The number that result files use: 0 complete, 1 empty, 2 not certified.
    pub fn number(self) -> u8 {
        match self {
            Self::Complete => 0,
            Self::Empty => 1,
            Self::Uncertified => 2,
        }
    }

    /// The word that messages use, and files of results may.
    pub fn word(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Empty => "empty",
            Self::Uncertified => "uncertified",
        }
    }
}

/// The part of a pass that computes the cells near the surface alone (paper §1); zeros where the backend does not part its passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Substep {
    /// Cells tried.
    pub cells: usize,
    /// Seconds that it took, by the clock that the backend has for its kernels.
    pub seconds: f64,
}

/// One pass of the scheduler: the capacities it had, how many cells it tried, how many did not fit, and what it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct PassReport {
    /// Most neighbours of one cell. A backend that does not bound them reports the most that a cell visited.
    pub neighbors: u32,
    /// Most half-spaces of one cell.
    pub planes: u32,
    /// Most vertices of one cell.
    pub vertices: u32,
    /// Most triangles of one cell. A backend that does not bound them reports the most that a cell visited.
    pub triangles: u32,
    /// Cells tried.
    pub cells: usize,
    /// Cells that did not fit and went to the next pass.
    pub failed: usize,
    /// Seconds of the whole pass, by the host's clock.
    pub seconds: f64,
    /// Of those, seconds that a device computed; 0 where there is none but the host.
    pub device_seconds: f64,
    /// Its second substep.
    pub second: Substep,
}

/// How an output was computed.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// Cells for which floating point did not suffice and exact arithmetic decided.
    pub exact_cells: usize,
    /// Cells that a device handed back to the host, which has all the room and arithmetic that there is.
    pub host_cells: usize,
    /// Seconds that a device computed, from sites on the device to results on the device; 0 where there is none but the host.
    pub device_seconds: f64,
    /// The passes of the scheduler.
    pub passes: Vec<PassReport>,
}

impl Report {
    /// Of a backend that computes on the host.
    pub fn of_host(exact_cells: usize, passes: Vec<PassReport>) -> Self {
        Self { exact_cells, passes, ..Self::default() }
    }

    /// Of a backend that computes on devices, and leaves some cells to the host.
    pub fn of_devices(exact_cells: usize, host_cells: usize, device_seconds: f64, passes: Vec<PassReport>) -> Self {
        Self { exact_cells, host_cells, device_seconds, passes }
    }
}

/// What an [`Output`] is made of: begin with none of it, `OutputArrays::default()`, and put in what there is.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct OutputArrays {
    /// How each cell ended.
    pub status: Vec<CellStatus>,
    /// Volume (length³) of each restricted cell: the integral of the domain's winding number.
    pub volume: Vec<f64>,
    /// Barycenter of each restricted cell; NaN where the cell is empty.
    pub barycenter: Vec<[f64; 3]>,
    /// Where requested: ∫ (x − b)(x − b)ᵀ dx about the cell's own barycenter `b`, as xx, yy, zz, xy, xz, yz (length⁵).
    /// They are summed about the site: off by roundings of the volume times the square of the site's distance from the cell, about as many as the
    /// root of the number of triangles in it. Those of a sphere of 320 triangles are right to 4e-12 from a site 8 diameters away, to 1e-7 from 900.
    pub second_moment: Option<Vec<[f64; 6]>>,
    /// Where requested: the integral of the given function over each restricted cell (its unit times length³), 0 where the cell is
    /// empty; [`Integrand`](crate::Integrand) says how near it is. Of a function of several columns those of the first site, then of the second.
    pub integral: Option<Vec<f64>>,
    /// Where requested: the facets between cells, and each cell's piece of the boundary.
    pub facets: Option<Facets>,
    /// Where requested: the Laplacian.
    pub laplacian: Option<Laplacian>,
    /// Where it was to stay with the backend, and does: which one it is.
    pub kept: Option<Kept>,
    /// Where requested: the restricted cells as polygons.
    pub geometry: Option<Geometry>,
    /// How it was computed.
    pub report: Report,
}

/// The integrals of all cells, in the caller's order, lengths in the caller's unit.
#[derive(Clone, Debug, Default)]
pub struct Output(OutputArrays);

impl Output {
    /// An output of arrays, which each have a place for each site.
    ///
    /// # Errors
    /// `Input` where their lengths differ.
    pub fn new(arrays: OutputArrays) -> Result<Self> {
        let n = arrays.volume.len();
        let OutputArrays { status, barycenter, second_moment, integral, facets, geometry, .. } = &arrays;
        let lengths = [
            Some(status.len()),
            Some(barycenter.len()),
            second_moment.as_ref().map(Vec::len),
            integral.as_ref().map(|all| if n > 0 && all.len() % n == 0 { n } else { all.len() }),
            facets.as_ref().map(Facets::sites),
            geometry.as_ref().map(Geometry::sites),
        ];
        match lengths.into_iter().flatten().find(|&length| length != n) {
            Some(other) => {
                Err(Error::input(format!("an output has volumes of {n} cells, but something else of {other}")))
            }
            None => Ok(Self(arrays)),
        }
    }

    /// Its arrays, to be taken along or changed.
    pub fn into_arrays(self) -> OutputArrays {
        self.0
    }

    /// Takes the facets out, for who needs their memory before that of the rest.
    pub fn take_facets(&mut self) -> Option<Facets> {
        self.0.facets.take()
    }

    /// Puts a Laplacian of these cells in, which then is no more with the backend. For solvers.
    #[doc(hidden)]
    pub fn put_laplacian(&mut self, laplacian: Laplacian) {
        self.0.laplacian = Some(laplacian);
        self.0.kept = None;
    }

    /// Takes the Laplacian out; one that is with the backend is left there, and no more known of.
    pub fn take_laplacian(&mut self) -> Option<Laplacian> {
        self.0.kept = None;
        self.0.laplacian.take()
    }

    /// The number of sites.
    pub fn sites(&self) -> usize {
        self.0.volume.len()
    }

    /// Number of cells with the given status.
    pub fn count(&self, status: CellStatus) -> usize {
        self.0.status.iter().filter(|&&s| s == status).count()
    }

    /// How each cell ended.
    pub fn status(&self) -> &[CellStatus] {
        &self.0.status
    }

    /// Volume (length³) of each restricted cell: the integral of the domain's winding number.
    pub fn volume(&self) -> &[f64] {
        &self.0.volume
    }

    /// Barycenter of each restricted cell; NaN where the cell is empty.
    pub fn barycenter(&self) -> &[[f64; 3]] {
        &self.0.barycenter
    }

    /// Where requested: ∫ (x − b)(x − b)ᵀ dx about the cell's own barycenter `b`, as xx, yy, zz, xy, xz, yz (length⁵).
    /// They are summed about the site: off by roundings of the volume times the square of the site's distance from the cell, about as many as the
    /// root of the number of triangles in it. Those of a sphere of 320 triangles are right to 4e-12 from a site 8 diameters away, to 1e-7 from 900.
    pub fn second_moment(&self) -> Option<&[[f64; 6]]> {
        self.0.second_moment.as_deref()
    }

    /// Where requested: the integral of the given function over each restricted cell (its unit times length³), 0 where the cell is
    /// empty; [`Integrand`](crate::Integrand) says how near it is. Of a function of several columns those of the first site, then of the second.
    pub fn integral(&self) -> Option<&[f64]> {
        self.0.integral.as_deref()
    }

    /// Where requested: the facets between cells, and each cell's piece of the boundary.
    pub fn facets(&self) -> Option<&Facets> {
        self.0.facets.as_ref()
    }

    /// Where requested: the Laplacian, how each volume changes with the weights.
    pub fn laplacian(&self) -> Option<&Laplacian> {
        self.0.laplacian.as_ref()
    }

    /// Where the Laplacian was to stay with the backend, and does: which one it is.
    pub fn kept(&self) -> Option<&Kept> {
        self.0.kept.as_ref()
    }

    /// Where facets were requested: each cell's piece of the boundary.
    pub fn boundary(&self) -> Option<&[Boundary]> {
        self.facets().map(Facets::boundary)
    }

    /// Where requested: the restricted cells as polygons.
    pub fn geometry(&self) -> Option<&Geometry> {
        self.0.geometry.as_ref()
    }

    /// How it was computed.
    pub fn report(&self) -> &Report {
        &self.0.report
    }
}
