//! From sums in the frame of each site to the output in the caller's order and unit. Written once for all backends.

mod units;

use crate::PowerDiagram;
use crate::algebra::Kept;
use crate::cell::{
    CellStore, CellSums, FACET_AREAS, FACET_SECOND_MOMENTS, FacetSecond, TAG_BOX, facet_is_above_bound, v3,
};
use crate::diagram::FramedContainer;
use crate::frame::Frame;
use crate::geometry::Geometry;
use crate::parallel;
use crate::request::Request;
use crate::summation::CHUNK;
use crate::{Boundary, CellStatus, Error, FacetArrays, Facets, Laplacian, Output, OutputArrays, Report, Result};
use std::ops::Range;
use units::Units;

/// One facet of a finished cell, in the frame of its site. Devices write the same. (16 bytes: with its moment, which the Laplacian has no use for, it took
/// 40, and ten million sites have 155 million facets.)
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct FacetRecord {
    /// Area.
    pub area: f64,
    /// The caller's index of the site beyond it.
    pub neighbor: u32,
    /// Zero.
    pub unused: u32,
}

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

/// FacetRecords of finished cells, one after the other.
#[derive(Clone, Debug, Default)]
pub struct FacetRecords {
    /// What there is of each.
    pub records: Vec<FacetRecord>,
    /// Their first moments, ∫ x dA in the frame of the cell's site, as many, or none where areas alone are asked for.
    pub moments: Vec<[f64; 3]>,
    /// Their second moments about their own barycenters, as many, or none where they are not asked for.
    pub seconds: Vec<FacetSecond>,
}

impl FacetRecords {
    /// Appends the facets of the finished cell that exceed their rounding bound, as `flags` ask for; the tags are sorted indices, and
    /// `order` the caller's.
    pub fn collect<S: CellStore>(&mut self, store: &S, flags: u32, order: &[u32]) {
        for f in 0..store.planes() {
            let (tag, sum) = (store.tag(f), store.facet(f));
            if tag < TAG_BOX && facet_is_above_bound(sum) {
                let neighbor = order[tag as usize];
                self.records.push(FacetRecord { area: sum.area, neighbor, unused: 0 });
                if flags & FACET_AREAS == 0 {
                    self.moments.push([sum.moment.x, sum.moment.y, sum.moment.z]);
                }
                if flags & FACET_SECOND_MOMENTS != 0 {
                    self.seconds.push(store.facet_second(f));
                }
            }
        }
    }

    /// Those from `begin` to before `end`.
    pub fn row(&self, begin: usize, end: usize) -> Row<'_> {
        let (moments, seconds) = (self.moments.get(begin..end), self.seconds.get(begin..end));
        Row {
            records: &self.records[begin..end],
            moments: moments.unwrap_or_default(),
            seconds: seconds.unwrap_or_default(),
        }
    }

    /// Gives back what room is left.
    pub fn shrink(&mut self) {
        self.records.shrink_to_fit();
        self.moments.shrink_to_fit();
        self.seconds.shrink_to_fit();
    }
}

/// Some facets of [`FacetRecords`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Row<'a> {
    records: &'a [FacetRecord],
    moments: &'a [[f64; 3]],
    seconds: &'a [FacetSecond],
}

impl Row<'_> {
    /// What is known of each but moments.
    pub fn records(&self) -> &[FacetRecord] {
        self.records
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }
}

/// Rows of facets that are worth a task of their own.
const ROWS_AT_ONCE: usize = 4096;

/// Where the facets of a cell stand: in which part, from where on, and how many they are.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    part: u32,
    begin: u32,
    count: u32,
}

/// The facets of cells that were added with them.
#[derive(Debug, Default)]
struct AddedFacets {
    /// Of each site; empty while nothing was added.
    places: Vec<Place>,
    parts: Vec<FacetRecords>,
}

impl AddedFacets {
    /// Those of site `i`.
    fn row(&self, i: usize) -> Row<'_> {
        let Some(&Place { part, begin, count }) = self.places.get(i) else { return Row::default() };
        let (begin, end) = (begin as usize, (begin + count) as usize);
        self.parts.get(part as usize).map_or_else(Row::default, |part| part.row(begin, end))
    }
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
        let (part, mut begin) = (self.facets.parts.len() as u32, 0);
        if self.has_rows && self.facets.places.is_empty() {
            self.facets.places = parallel::map(self.positions.len(), CHUNK, |_| Place::default());
        }
        for (k, cell) in cells.iter().enumerate() {
            self.add_cell(cell);
            let count = counts.get(k).copied().unwrap_or(0);
            let place = self.facets.places.get_mut(cell.site as usize);
            if let Some(place) = place.filter(|_| cell.status != CellStatus::Empty) {
                *place = Place { part, begin, count };
            }
            begin += count;
        }
        if self.has_rows {
            self.facets.parts.push(facets);
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
            let areas = |i: usize| row_of(i).records.iter().map(|facet| (facet.neighbor, facet.area));
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

/// The facets of all sites in one list.
fn facet_arrays<'b>(units: Units, positions: &[[f64; 3]], row_of: &(impl Fn(usize) -> Row<'b> + Sync)) -> FacetArrays {
    let mut offsets = vec![0; positions.len() + 1];
    parallel::for_each(&mut offsets[1..], CHUNK, |i, count| *count = row_of(i).records.len());
    let mut total = 0;
    for end in &mut offsets {
        total += *end;
        *end = total;
    }
    let mut list = FacetArrays {
        offsets,
        neighbor: vec![0; total],
        area: vec![0.0; total],
        barycenter: vec![[0.0; 3]; total],
        distance: vec![0.0; total],
        second_moment: None,
        boundary: Vec::new(),
    };
    // Each task has its own part of the columns.
    let mut parts = Vec::new();
    let (mut neighbor, mut area) = (&mut list.neighbor[..], &mut list.area[..]);
    let (mut barycenter, mut distance) = (&mut list.barycenter[..], &mut list.distance[..]);
    for first in (0..positions.len()).step_by(ROWS_AT_ONCE) {
        let last = (first + ROWS_AT_ONCE).min(positions.len());
        let count = list.offsets[last] - list.offsets[first];
        let columns = (
            neighbor.split_off_mut(..count).unwrap_or_default(),
            area.split_off_mut(..count).unwrap_or_default(),
            barycenter.split_off_mut(..count).unwrap_or_default(),
            distance.split_off_mut(..count).unwrap_or_default(),
        );
        parts.push((first..last, columns));
    }
    parallel::each(parts, |_, (sites, (neighbor, area, barycenter, distance))| {
        let (mut near, mut turns, mut next) = (NearRows::default(), Vec::new(), 0);
        for first in sites.clone().step_by(NEAR_ROWS) {
            let some = first..(first + NEAR_ROWS).min(sites.end);
            near.gather(some.clone(), positions, row_of);
            for (i, &[begin, end]) in some.zip(&near.rows) {
                turns.clear();
                turns.extend((begin..end).map(|k| (near.records[k].neighbor, k)));
                turns.sort_unstable();
                for &(beyond, k) in &turns {
                    let (facet, [x, y, z]) = (near.records[k], near.moments[k]);
                    neighbor[next] = beyond;
                    area[next] = units.area(facet.area);
                    barycenter[next] = units.place(positions[i], v3(x, y, z), facet.area);
                    distance[next] = units.distance(positions[i], near.beyond[k]);
                    next += 1;
                }
            }
        }
    });
    list
}

/// Rows that are brought near at a time.
const NEAR_ROWS: usize = 64;

/// Some rows of facets, one after the other, and the places of the sites beyond them. What is read here stands anywhere in memory: it comes sooner where
/// all of it is asked for before any is waited for.
#[derive(Default)]
struct NearRows {
    rows: Vec<[usize; 2]>,
    records: Vec<FacetRecord>,
    moments: Vec<[f64; 3]>,
    beyond: Vec<[f64; 3]>,
}

impl NearRows {
    fn gather<'b>(&mut self, sites: Range<usize>, positions: &[[f64; 3]], row_of: &impl Fn(usize) -> Row<'b>) {
        self.rows.clear();
        self.records.clear();
        self.moments.clear();
        self.beyond.clear();
        for row in sites.map(row_of) {
            debug_assert_eq!(row.records.len(), row.moments.len());
            let begin = self.records.len();
            self.records.extend_from_slice(row.records);
            self.moments.extend_from_slice(row.moments);
            self.rows.push([begin, self.records.len()]);
        }
        self.beyond.extend(self.records.iter().map(|facet| positions[facet.neighbor as usize]));
    }
}

/// The second moments of the facets of all sites, in the order of [`facet_arrays`].
fn facet_seconds<'b>(units: Units, sites: usize, row_of: &(impl Fn(usize) -> Row<'b> + Sync)) -> Vec<[f64; 6]> {
    let unit = facet_second_unit(&units.frame, units.density);
    let rows_in_order = |range: Range<usize>| {
        let mut all: Vec<[f64; 6]> = Vec::new();
        for i in range {
            let Row { records, seconds, .. } = row_of(i);
            let mut row: Vec<_> = records.iter().map(|facet| facet.neighbor).zip(seconds).collect();
            row.sort_unstable_by_key(|(neighbor, _)| *neighbor);
            let of_facet = |FacetSecond { diagonal: d, mixed: m }: FacetSecond| [d.x, d.y, d.z, m.x, m.y, m.z];
            all.extend(row.into_iter().map(|(_, second)| of_facet(*second).map(|entry| entry * unit)));
        }
        all
    };
    parallel::chunks(sites, ROWS_AT_ONCE, rows_in_order).concat()
}
