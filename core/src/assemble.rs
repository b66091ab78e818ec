//! From sums in the frame of each site to the output in the caller's order and unit. Written once for all backends.

mod facets;
mod units;

use crate::PowerDiagram;
use crate::algebra::Kept;
use crate::cell::{CellStore, CellSums, FACETS};
use crate::diagram::FramedContainer;
use crate::frame::Frame;
use crate::geometry::Geometry;
use crate::parallel;
use crate::request::Request;
use crate::summation::CHUNK;
use crate::{Boundary, CellStatus, Error, FacetArrays, Facets, Laplacian, Output, OutputArrays, Report, Result};
use facets::{AddedFacets, facet_arrays, facet_seconds};
pub use facets::{FacetRecord, FacetRecords, Row};
use std::ops::Range;
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

/// The finished cells of a task.
#[derive(Clone, Debug, Default)]
pub struct FinishedCells {
    /// What there is of each.
    pub cells: Vec<CellRecord>,
    /// Of a function of several columns: of each but the first the integral over each cell, in the frame's unit.
    pub columns: Vec<Vec<f64>>,
    /// Where they are asked for, the facets of one cell after the other.
    pub facets: FacetRecords,
    /// How many each cell has.
    pub facet_counts: Vec<u32>,
}

/// A cell among those of a task: its site, its number, and where its facets stand.
#[derive(Clone, Copy, Debug)]
struct Turn {
    site: u32,
    cell: u32,
    begin: u32,
    count: u32,
}

impl FinishedCells {
    /// Takes one more, and where `flags` ask for them its facets from where it lives; see [`FacetRecords::collect`].
    pub fn push<S: CellStore>(&mut self, cell: CellRecord, store: &S, flags: u32, order: &[u32]) {
        self.cells.push(cell);
        if flags & FACETS != 0 {
            let before = self.facets.records.len();
            if cell.status != CellStatus::Empty {
                self.facets.collect(store, flags, order);
            }
            self.facet_counts.push((self.facets.records.len() - before) as u32);
        }
    }

    /// Those that are not empty, by site.
    fn turns(&self) -> Vec<Turn> {
        let (mut turns, mut begin) = (Vec::with_capacity(self.cells.len()), 0);
        for (k, cell) in self.cells.iter().enumerate() {
            let count = self.facet_counts.get(k).copied().unwrap_or_default();
            if cell.status != CellStatus::Empty {
                turns.push(Turn { site: cell.site, cell: k as u32, begin, count });
            }
            begin += count;
        }
        turns.sort_unstable_by_key(|turn| turn.site);
        turns
    }
}

/// Those of some sites.
fn within<'t>(turns: &'t [Turn], sites: &Range<usize>) -> &'t [Turn] {
    let at = |site: usize| turns.partition_point(|turn| (turn.site as usize) < site);
    &turns[at(sites.start)..at(sites.end)]
}

/// Into how many ranges sites are shared out, at most, whose columns a task writes.
const SHARES: usize = 256;

/// The length of such a range.
fn share_of(sites: usize) -> usize {
    CHUNK.max(sites.div_ceil(SHARES))
}

/// The `k`th of them.
fn share(sites: usize, k: usize) -> Range<usize> {
    let length = share_of(sites);
    k * length..((k + 1) * length).min(sites)
}

/// Takes a cell: its site, how it ended, and its sums.
type SetCell<'s> = &'s mut dyn FnMut(usize, CellStatus, &CellSums);

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

    /// Adds finished cells, on all threads: one thread by itself took a tenth of the time of a million blue cells on 16 threads, with facets a fifth. (Facets
    /// stay where they are: a copy of all took a tenth of the time of white cells with facets on two threads.)
    pub fn add(&mut self, parts: Vec<FinishedCells>) {
        let turns = parallel::results(parts.len(), |k| parts[k].turns());
        self.set_all(&|sites, set| {
            for (part, turns) in parts.iter().zip(&turns) {
                for turn in within(turns, &sites) {
                    let CellRecord { status, sums, .. } = &part.cells[turn.cell as usize];
                    set(turn.site as usize, *status, sums);
                }
            }
        });
        for (part, turns) in parts.iter().zip(&turns) {
            for (column, integrals) in part.columns.iter().enumerate() {
                self.add_column(column + 1, turns, integrals);
            }
        }
        if self.has_rows {
            self.facets.add(self.positions.len(), parts.into_iter().map(|part| part.facets), &turns);
        }
    }

    /// One more column of the integrals over a task's cells.
    fn add_column(&mut self, column: usize, turns: &[Turn], integrals: &[f64]) {
        let Some(all) = &mut self.output.integral else { return };
        let columns = all.len() / self.positions.len();
        for turn in turns {
            all[turn.site as usize * columns + column] = self.units.volume(integrals[turn.cell as usize]);
        }
    }

    /// Adds, for every site `i` where `cell(i, sums)` is something that is not empty, that cell, whose sums it has put there, without its facets. (Sums that
    /// it returned were copied three times: a million cells took 65 ms of a core, now 17.)
    pub fn add_all(&mut self, cell: impl Fn(usize, &mut CellSums) -> Option<CellStatus> + Sync) {
        self.set_all(&|sites, set| {
            let mut sums = CellSums::default();
            for i in sites {
                if let Some(status) = cell(i, &mut sums).filter(|&status| status != CellStatus::Empty) {
                    set(i, status, &sums);
                }
            }
        });
    }

    /// Sets what `finished` tells of some sites: which of them have cells, how those ended, and their sums.
    fn set_all(&mut self, finished: &(dyn Fn(Range<usize>, SetCell<'_>) + Sync)) {
        let Self { positions, units, output, boundary, .. } = self;
        let (positions, units, length) = (*positions, *units, share_of(self.positions.len()));
        let each = |k: usize, set: &mut dyn FnMut(usize, usize, CellStatus, &CellSums)| {
            let sites = share(positions.len(), k);
            let first = sites.start;
            finished(sites, &mut |i, status, sums| set(i - first, i, status, sums));
        };
        let columns = output.status.chunks_mut(length).zip(output.volume.chunks_mut(length));
        let columns = columns.zip(output.barycenter.chunks_mut(length));
        parallel::each(columns, |k, ((status, volume), barycenter)| {
            each(k, &mut |at, i, how, sums| {
                status[at] = how;
                (volume[at], barycenter[at]) = (units.volume(sums.volume), units.barycenter(positions[i], sums));
            });
        });
        if let Some(second) = &mut output.second_moment {
            parallel::each(second.chunks_mut(length), |k, second| {
                each(k, &mut |at, _, _, sums| second[at] = units.second_moment(sums));
            });
        }
        if let Some(integral) = &mut output.integral {
            let columns = integral.len() / positions.len();
            parallel::each(integral.chunks_mut(length * columns), |k, integral| {
                each(k, &mut |at, _, _, sums| integral[at * columns] = units.volume(sums.integral));
            });
        }
        if let Some(boundary) = boundary {
            parallel::each(boundary.chunks_mut(length), |k, boundary| {
                each(k, &mut |at, i, _, sums| boundary[at] = units.boundary(positions[i], sums));
            });
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
