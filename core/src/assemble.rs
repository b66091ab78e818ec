//! From sums in the frame of each site to the output in the caller's order and unit. Written once for all backends.

mod facets;
mod units;

use crate::PowerDiagram;
use crate::algebra::Kept;
use crate::cell::CellSums;
use crate::diagram::FramedContainer;
use crate::frame::Frame;
use crate::geometry::Geometry;
use crate::parallel;
use crate::request::Request;
use crate::summation::CHUNK;
use crate::{Boundary, CellStatus, Error, FacetArrays, Facets, Laplacian, Output, OutputArrays, Report, Result};
use facets::{AddedFacets, facet_arrays, facet_seconds};
pub use facets::{FacetRecord, FacetRecords, Row};
use units::Units;

/// One finished cell, in the frame of its site.
#[derive(Clone, Copy, Debug)]
pub struct CellRecord {
    /// The caller's index of its site.
    pub site: u32,
    /// How it ended.
    pub status: CellStatus,
    /// Its sums.
    pub sums: CellSums,
}

/// Collects finished cells into an [`Output`].
#[derive(Debug)]
pub struct Assembler<'a> {
    positions: &'a [[f64; 3]],
    units: Units,
    output: OutputArrays,
    boundary: Option<Vec<Boundary>>,
    has_rows: bool,
    facets: AddedFacets,
    /// Those of all cells, in order, where a device has put them so.
    ordered: Option<FacetArrays>,
    has_seconds: bool,
    has_laplacian: bool,
}

impl<'a> Assembler<'a> {
    /// For all cells of a diagram; cells that are never added, as those of coincident sites, stay empty.
    pub fn new(diagram: &'a PowerDiagram, container: &FramedContainer, request: &Request) -> Self {
        let n = diagram.positions().len();
        let output = OutputArrays {
            status: parallel::map(n, CHUNK, |_| CellStatus::Empty),
            volume: parallel::map(n, CHUNK, |_| 0.0),
            barycenter: parallel::map(n, CHUNK, |_| [f64::NAN; 3]),
            second_moment: request.second_moments().then(|| parallel::map(n, CHUNK, |_| [0.0; 6])),
            integral: request.integral().map(|f| parallel::map(n * f.columns(), CHUNK, |_| 0.0)),
            ..OutputArrays::default()
        };
        let boundary = request.facets().then(|| parallel::map(n, CHUNK, |_| Boundary::default()));
        Self {
            positions: diagram.positions(),
            units: Units { frame: container.frame, density: container.density },
            output,
            boundary,
            has_rows: request.needs_facets(),
            facets: AddedFacets::default(),
            ordered: None,
            has_seconds: request.facet_second_moments(),
            has_laplacian: request.laplacian(),
        }
    }

    /// The facets of the cell of a site that was added with them.
    pub fn row(&self, site: u32) -> Row<'_> {
        self.facets.row(site as usize)
    }

    /// Says of a Laplacian that a device has made, and keeps, where it is.
    pub fn keep(&mut self, kept: Kept) {
        self.output.kept = Some(kept);
        self.has_laplacian = false;
    }

    /// Takes a Laplacian that a device has made.
    pub fn take_laplacian(&mut self, laplacian: Laplacian) {
        self.output.laplacian = Some(laplacian);
        self.has_laplacian = false;
    }

    /// Takes the facets of all cells as a device has put them in order, but for the boundary.
    pub fn take_facets(&mut self, ordered: FacetArrays) {
        self.ordered = Some(ordered);
    }

    /// How each cell ended that was added; others are empty.
    pub fn status(&self) -> &[CellStatus] {
        &self.output.status
    }

    /// Adds finished cells, and where they are asked for their facets, one cell after the other: `counts[k]` of cell k. (They stay where they are: a copy of all
    /// took a tenth of the time of white cells with facets on two threads.)
    pub fn add(&mut self, cells: &[CellRecord], facets: FacetRecords, counts: &[u32]) {
        cells.iter().for_each(|cell| self.add_cell(cell));
        if self.has_rows {
            self.facets.add(self.positions.len(), cells, facets, counts);
        }
    }

    fn add_cell(&mut self, cell: &CellRecord) {
        let i = cell.site as usize;
        self.output.status[i] = cell.status;
        if cell.status == CellStatus::Empty {
            return;
        }
        let (units, sums, position) = (self.units, &cell.sums, self.positions[i]);
        self.output.volume[i] = units.volume(sums.volume);
        self.output.barycenter[i] = units.barycenter(position, sums);
        if let Some(second) = &mut self.output.second_moment {
            second[i] = units.second_moment(sums);
        }
        if let Some(integral) = &mut self.output.integral {
            let columns = integral.len() / self.positions.len();
            integral[i * columns] = units.volume(sums.integral);
        }
        if let Some(boundary) = &mut self.boundary {
            boundary[i] = units.boundary(position, sums);
        }
    }

    /// Adds one more column of the integrals over cells that were added, in the frame's unit.
    pub fn add_column(&mut self, column: usize, cells: &[CellRecord], integrals: &[f64]) {
        let Some(all) = &mut self.output.integral else { return };
        let columns = all.len() / self.positions.len();
        for (cell, integral) in cells.iter().zip(integrals).filter(|(cell, _)| cell.status != CellStatus::Empty) {
            all[cell.site as usize * columns + column] = self.units.volume(*integral);
        }
    }

    /// Adds, for every site `i` where `cell(i)` is something that is not empty, that cell without its facets.
    pub fn add_all(&mut self, cell: impl Fn(usize) -> Option<(CellStatus, CellSums)> + Sync) {
        let Self { positions, units, output, boundary, .. } = self;
        let (positions, units) = (*positions, *units);
        let finished = |i: usize| cell(i).filter(|(status, _)| *status != CellStatus::Empty);
        let columns = output.status.chunks_mut(CHUNK).zip(output.volume.chunks_mut(CHUNK));
        let columns = columns.zip(output.barycenter.chunks_mut(CHUNK));
        parallel::each(columns, |chunk, ((status, volume), barycenter)| {
            for k in 0..status.len() {
                let i = chunk * CHUNK + k;
                if let Some((how, sums)) = finished(i) {
                    status[k] = how;
                    (volume[k], barycenter[k]) = (units.volume(sums.volume), units.barycenter(positions[i], &sums));
                }
            }
        });
        if let Some(second) = &mut output.second_moment {
            let set = |i: usize, second: &mut [f64; 6]| {
                finished(i).into_iter().for_each(|(_, sums)| *second = units.second_moment(&sums));
            };
            parallel::for_each(second, CHUNK, set);
        }
        if let Some(integral) = &mut output.integral {
            let set = |i: usize, integral: &mut f64| {
                finished(i).into_iter().for_each(|(_, sums)| *integral = units.volume(sums.integral));
            };
            parallel::for_each(integral, CHUNK, set);
        }
        if let Some(boundary) = boundary {
            let set = |i: usize, boundary: &mut Boundary| {
                finished(i).into_iter().for_each(|(_, sums)| *boundary = units.boundary(positions[i], &sums));
            };
            parallel::for_each(boundary, CHUNK, set);
        }
    }

    /// The output; `order` is that of the sites along the curve.
    ///
    /// # Errors
    /// `Input` for the first site whose integral is not finite: the given function is not one everywhere.
    pub fn finish(self, order: &[u32], report: Report, geometry: Option<Geometry>) -> Result<Output> {
        self.finish_with(|_| Row::default(), order, report, geometry)
    }

    /// The same where the facets of cells that were added without stand elsewhere: `row(i)` are those of site `i`.
    ///
    /// # Errors
    /// As [`Assembler::finish`].
    pub fn finish_with<'b>(
        mut self,
        row: impl Fn(usize) -> Row<'b> + Sync,
        order: &[u32],
        report: Report,
        geometry: Option<Geometry>,
    ) -> Result<Output> {
        check_integrals(self.output.integral.as_deref().unwrap_or_default(), self.positions.len())?;
        let Units { frame, density } = self.units;
        let row_of = |i: usize| match self.facets.row(i) {
            added if added.is_empty() => row(i),
            added => added,
        };
        if self.has_laplacian {
            let areas = |i: usize| row_of(i).records().iter().map(|facet| (facet.neighbor, facet.area));
            let value = |i: usize, j: usize, area: f64| {
                area / self.units.framed_distance(self.positions[i], self.positions[j])
                    * laplacian_unit(&frame, density)
            };
            self.output.laplacian = Some(Laplacian::of_areas(order, self.positions.len(), areas, value));
        }
        if let Some(boundary) = self.boundary.take() {
            let arrays = self.ordered.take().unwrap_or_else(|| FacetArrays {
                second_moment: self.has_seconds.then(|| facet_seconds(self.units, self.positions.len(), &row_of)),
                ..facet_arrays(self.units, self.positions, &row_of)
            });
            self.output.facets = Some(Facets::of_fitting(FacetArrays { boundary, ..arrays }));
        }
        Output::new(OutputArrays { report, geometry, ..self.output })
    }
}

fn check_integrals(integrals: &[f64], sites: usize) -> Result<()> {
    match integrals.iter().position(|x| !x.is_finite()).map(|k| k / (integrals.len() / sites)) {
        None => Ok(()),
        Some(i) => Err(Error::input(format!(
            "integrand: its integral over the cell of site {i} is not finite: it must be so in all of the box, and of the box of the \
             domain's grid"
        ))
        .of_site(i)),
    }
}

/// What areas of facets are in units of, where they are of the frame's lengths.
pub fn area_unit(frame: &Frame, density: f64) -> f64 {
    density * frame.unit().powi(2)
}

/// The same of their second moments.
pub fn facet_second_unit(frame: &Frame, density: f64) -> f64 {
    density * frame.unit().powi(4)
}

/// What the Laplacian is in units of, where areas and distances are in the frame's.
pub fn laplacian_unit(frame: &Frame, density: f64) -> f64 {
    density * frame.unit()
}
