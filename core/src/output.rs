//! What comes back: flat arrays in the caller's order and units.

use crate::geometry::Geometry;
use crate::{Error, Result};

/// How the computation of one cell ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CellStatus {
    /// The cell is complete, by proof: no site was missed and every sign was decided exactly.
    Complete,
    /// The cell is empty, by proof, or its volume is below its own rounding bound.
    Empty,
    /// The search was ended by `--epsilon` before completeness was proved; the cell may be too large.
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

/// A neighbour: the site beyond a facet, and in which periodic image of the box it stands (zero: the box itself).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Neighbor {
    /// Index of the site in the caller's order.
    pub site: u32,
    /// Periodic image, zero unless the box is periodic.
    pub image: [i8; 3],
}

/// Facets between restricted cells, in compressed rows: those of site `i` are `offsets[i]..offsets[i + 1]`, sorted by
/// neighbour. Every interior facet stands once in each of its two rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FacetList {
    /// Row starts; one more than sites.
    pub offsets: Vec<usize>,
    /// The site beyond each facet.
    pub neighbor: Vec<Neighbor>,
    /// Area (length²) of the facet within the domain.
    pub area: Vec<f64>,
    /// Barycenter of the facet within the domain.
    pub barycenter: Vec<[f64; 3]>,
    /// Distance between the two sites.
    pub distance: Vec<f64>,
    /// Where requested: ∫ (x − b)(x − b)ᵀ dA about each facet's own barycenter `b`, as xx, yy, zz, xy, xz, yz (length⁴).
    pub second_moment: Option<Vec<[f64; 6]>>,
}

/// The part of the domain's boundary that lies in one restricted cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Boundary {
    /// Area (length²).
    pub area: f64,
    /// Barycenter; zero where the area is zero.
    pub barycenter: [f64; 3],
    /// ∫ n dA, `n` the outward unit normal of the domain.
    pub vector_area: [f64; 3],
    /// ∫ n·(x − p) dA, `p` the cell's site: three times the part of the volume that the boundary closes.
    pub flux: f64,
}

/// The part of a pass that computes the cells near the surface alone (paper §1); zeros where the backend does not part its passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Substep {
    /// Cells tried.
    pub cells: usize,
    /// Seconds that it took, by the clock that the backend has for its kernels.
    pub seconds: f64,
}

/// One pass of the scheduler: the capacities it had, how many cells it tried, how many did not fit, and what it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// The integrals of all cells, in the caller's order, lengths in the caller's unit.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Output {
    /// How each cell ended.
    pub status: Vec<CellStatus>,
    /// Volume (length³) of each restricted cell: the integral of the domain's winding number.
    pub volume: Vec<f64>,
    /// Barycenter of each restricted cell; NaN where the cell is empty.
    pub barycenter: Vec<[f64; 3]>,
    /// Where requested: ∫ (x − b)(x − b)ᵀ dx about the cell's own barycenter `b`, as xx, yy, zz, xy, xz, yz (length⁵).
    pub second_moment: Option<Vec<[f64; 6]>>,
    /// Where requested: the integral of the given function over each restricted cell (its unit times length³), 0 where the cell is
    /// empty; [`Integrand`](crate::Integrand) says how near it is.
    pub integral: Option<Vec<f64>>,
    /// Where requested: the facets between cells.
    pub facets: Option<FacetList>,
    /// Where requested: each cell's piece of the boundary.
    pub boundary: Option<Vec<Boundary>>,
    /// Where requested: the restricted cells as polygons.
    pub geometry: Option<Geometry>,
    /// Cells for which floating point did not suffice and exact arithmetic decided.
    pub exact_cells: usize,
    /// Cells that a device handed back to the host, which has all the room and arithmetic that there is.
    pub host_cells: usize,
    /// Seconds that a device computed, from sites on the device to results on the device; 0 where there is none but the host.
    pub device_seconds: f64,
    /// The passes of the scheduler.
    pub passes: Vec<PassReport>,
}

impl Output {
    /// Refuses integrals that are no numbers: the given function is not one everywhere. Called by backends.
    ///
    /// # Errors
    /// `Input` for the first site whose integral is not finite.
    #[doc(hidden)]
    pub fn check_integrals(&self) -> Result<()> {
        match self.integral.iter().flatten().position(|x| !x.is_finite()) {
            None => Ok(()),
            Some(i) => Err(Error::input(format!(
                "integrand: its integral over the cell of site {i} is not finite: it must be so in all of the box, and of the box of the \
                 domain's grid"
            ))
            .of_site(i)),
        }
    }

    /// Number of cells with the given status.
    pub fn count(&self, status: CellStatus) -> usize {
        self.status.iter().filter(|&&s| s == status).count()
    }
}
