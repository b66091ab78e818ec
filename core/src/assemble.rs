//! From sums in the frame of each site to the output in the caller's order and unit. Written once for all backends.

use crate::PowerDiagram;
use crate::algebra::Kept;
use crate::cell::{CellStore, CellSums, FACET_SECOND_MOMENTS, FacetSecond, TAG_BOX, V3, facet_is_above_bound};
use crate::diagram::FramedContainer;
use crate::frame::Frame;
use crate::geometry::Geometry;
use crate::parallel;
use crate::request::Request;
use crate::summation::CHUNK;
use crate::{Boundary, CellStatus, Error, FacetArrays, Facets, Laplacian, Output, OutputArrays, Report, Result};
use rayon::iter::{ParallelIterator, repeat_n};
use std::ops::Range;

/// One facet of a finished cell, in the frame of its site. Devices write the same.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct FacetRecord {
    /// Area.
    pub area: f64,
    /// ∫ x dA.
    pub moment: V3,
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
    /// Their sums.
    pub records: Vec<FacetRecord>,
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
                self.records.push(FacetRecord { area: sum.area, moment: sum.moment, neighbor, unused: 0 });
                if flags & FACET_SECOND_MOMENTS != 0 {
                    self.seconds.push(store.facet_second(f));
                }
            }
        }
    }

    /// Those from `begin` to before `end`.
    pub fn row(&self, begin: usize, end: usize) -> Row<'_> {
        Row { records: &self.records[begin..end], seconds: self.seconds.get(begin..end).unwrap_or_default() }
    }

    /// All of them.
    pub fn all(&self) -> Row<'_> {
        self.row(0, self.records.len())
    }
}

/// Some facets of [`FacetRecords`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Row<'a> {
    records: &'a [FacetRecord],
    seconds: &'a [FacetSecond],
}

impl Row<'_> {
    /// What is known of each but second moments.
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

/// Collects finished cells into an [`Output`].
#[derive(Debug)]
pub struct Assembler<'a> {
    positions: &'a [[f64; 3]],
    frame: Frame,
    /// Mass per volume where the winding number is one.
    density: f64,
    output: OutputArrays,
    boundary: Option<Vec<Boundary>>,
    /// For each site where its facets begin in `facets`, and how many they are; empty where none are asked for.
    rows: Vec<(u64, u32)>,
    facets: FacetRecords,
    has_seconds: bool,
    has_laplacian: bool,
}

/// The integrals of one finished cell in the caller's frame and unit.
struct Finished {
    volume: f64,
    barycenter: [f64; 3],
    second_moment: [f64; 6],
    integral: f64,
    boundary: Boundary,
}

impl<'a> Assembler<'a> {
    /// For all cells of a diagram; cells that are never added, as those of coincident sites, stay empty.
    pub fn new(diagram: &'a PowerDiagram, container: &FramedContainer, request: &Request) -> Self {
        let n = diagram.positions().len();
        let output = OutputArrays {
            status: vec![CellStatus::Empty; n],
            volume: vec![0.0; n],
            // (Written on all threads: no memory that comes as zeros.)
            barycenter: repeat_n([f64::NAN; 3], n).collect(),
            second_moment: request.second_moments().then(|| vec![[0.0; 6]; n]),
            integral: request.integral().map(|f| vec![0.0; n * f.columns()]),
            ..OutputArrays::default()
        };
        let boundary = request.facets().then(|| vec![Boundary::default(); n]);
        let rows = if request.needs_facets() { vec![(0, 0); n] } else { Vec::new() };
        Self {
            positions: diagram.positions(),
            frame: container.frame,
            density: container.density,
            output,
            boundary,
            rows,
            facets: FacetRecords::default(),
            has_seconds: request.facet_second_moments(),
            has_laplacian: request.laplacian(),
        }
    }

    /// The facets of the cell of a site that was added with them.
    pub fn row(&self, site: u32) -> Row<'_> {
        let (begin, count) =
            self.rows.get(site as usize).map_or((0, 0), |&(begin, count)| (begin as usize, count as usize));
        self.facets.row(begin, begin + count)
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

    /// How each cell ended that was added; others are empty.
    pub fn status(&self) -> &[CellStatus] {
        &self.output.status
    }

    /// Adds one finished cell with its facets.
    pub fn add(&mut self, cell: &CellRecord, facets: Row<'_>) {
        let i = cell.site as usize;
        self.output.status[i] = cell.status;
        if cell.status == CellStatus::Empty {
            return;
        }
        let finished = finish(&self.frame, self.density, self.positions[i], &cell.sums);
        self.output.volume[i] = finished.volume;
        self.output.barycenter[i] = finished.barycenter;
        if let Some(second) = &mut self.output.second_moment {
            second[i] = finished.second_moment;
        }
        if let Some(integral) = &mut self.output.integral {
            let columns = integral.len() / self.positions.len();
            integral[i * columns] = finished.integral;
        }
        if let Some(boundary) = &mut self.boundary {
            boundary[i] = finished.boundary;
        }
        if let Some(row) = self.rows.get_mut(i) {
            *row = (self.facets.records.len() as u64, facets.records.len() as u32);
            self.facets.records.extend_from_slice(facets.records);
            self.facets.seconds.extend_from_slice(facets.seconds);
        }
    }

    /// Adds one more column of the integrals over cells that were added, in the frame's unit.
    pub fn add_column(&mut self, column: usize, cells: &[CellRecord], integrals: &[f64]) {
        let Some(all) = &mut self.output.integral else { return };
        let columns = all.len() / self.positions.len();
        for (cell, integral) in cells.iter().zip(integrals).filter(|(cell, _)| cell.status != CellStatus::Empty) {
            all[cell.site as usize * columns + column] = integral * (self.density * self.frame.unit().powi(3));
        }
    }

    /// Adds, for every site `i` where `cell(i)` is something that is not empty, that cell without its facets.
    pub fn add_all(&mut self, cell: impl Fn(usize) -> Option<(CellStatus, CellSums)> + Sync) {
        let Self { positions, frame, density, output, boundary, .. } = self;
        let finished = |i: usize| {
            let (status, sums) = cell(i).filter(|(status, _)| *status != CellStatus::Empty)?;
            Some((status, finish(frame, *density, positions[i], &sums)))
        };
        let columns = output.status.chunks_mut(CHUNK).zip(output.volume.chunks_mut(CHUNK));
        let columns = columns.zip(output.barycenter.chunks_mut(CHUNK));
        parallel::each(columns, |chunk, ((status, volume), barycenter)| {
            for k in 0..status.len() {
                if let Some((how, cell)) = finished(chunk * CHUNK + k) {
                    (status[k], volume[k], barycenter[k]) = (how, cell.volume, cell.barycenter);
                }
            }
        });
        if let Some(second) = &mut output.second_moment {
            let set = |i: usize, second: &mut [f64; 6]| {
                finished(i).into_iter().for_each(|(_, cell)| *second = cell.second_moment);
            };
            parallel::for_each(second, CHUNK, set);
        }
        if let Some(integral) = &mut output.integral {
            let set = |i: usize, integral: &mut f64| {
                finished(i).into_iter().for_each(|(_, cell)| *integral = cell.integral);
            };
            parallel::for_each(integral, CHUNK, set);
        }
        if let Some(boundary) = boundary {
            let set = |i: usize, boundary: &mut Boundary| {
                finished(i).into_iter().for_each(|(_, cell)| *boundary = cell.boundary);
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
        let row_of = |i: usize| match self.rows[i] {
            (_, 0) => row(i),
            (begin, count) => self.facets.row(begin as usize, begin as usize + count as usize),
        };
        if self.has_laplacian {
            let areas = |i: usize| row_of(i).records.iter().map(|facet| (facet.neighbor, facet.area));
            let value = |i: usize, j: usize, area: f64| {
                let (p, q) = (self.frame.enter(self.positions[i]), self.frame.enter(self.positions[j]));
                area / distance(p, q) * laplacian_unit(&self.frame, self.density)
            };
            self.output.laplacian = Some(Laplacian::of_areas(order, self.positions.len(), areas, value));
        }
        if let Some(boundary) = self.boundary.take() {
            let mut arrays = facet_arrays(&self.frame, self.density, self.positions, &|i| row_of(i).records);
            arrays.second_moment =
                self.has_seconds.then(|| facet_seconds(&self.frame, self.density, self.positions.len(), &row_of));
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

/// The integrals of the cell of the site at `position` (the caller's) from its sums.
fn finish(frame: &Frame, density: f64, position: [f64; 3], sums: &CellSums) -> Finished {
    let unit = frame.unit();
    let [x, y, z] = frame.enter(position);
    let place = |m: V3, mass: f64| frame.leave([x + m.x / mass, y + m.y / mass, z + m.z / mass]);
    let (s, m, v) = (sums, sums.first, sums.volume);
    let second_moment = [
        s.second_diagonal.x - m.x * m.x / v,
        s.second_diagonal.y - m.y * m.y / v,
        s.second_diagonal.z - m.z * m.z / v,
        s.second_mixed.x - m.x * m.y / v,
        s.second_mixed.y - m.x * m.z / v,
        s.second_mixed.z - m.y * m.z / v,
    ];
    let mut boundary = Boundary::default();
    if sums.boundary_area != 0.0 {
        let n = sums.boundary_vector;
        boundary = Boundary {
            area: sums.boundary_area * (density * unit.powi(2)),
            barycenter: place(sums.boundary_moment, sums.boundary_area),
            vector_area: [n.x, n.y, n.z].map(|a| a * (density * unit.powi(2))),
            flux: sums.boundary_flux * (density * unit.powi(3)),
        };
    }
    Finished {
        volume: sums.volume * (density * unit.powi(3)),
        barycenter: place(sums.first, sums.volume),
        second_moment: second_moment.map(|x| x * (density * unit.powi(5))),
        integral: sums.integral * (density * unit.powi(3)),
        boundary,
    }
}

/// What the Laplacian is in units of, where areas and distances are in the frame's.
pub fn laplacian_unit(frame: &Frame, density: f64) -> f64 {
    density * frame.unit()
}

/// Of two sites, in the frame.
fn distance([x, y, z]: [f64; 3], [a, b, c]: [f64; 3]) -> f64 {
    ((a - x).powi(2) + (b - y).powi(2) + (c - z).powi(2)).sqrt()
}

/// The facets of all sites in one list.
fn facet_arrays<'b>(
    frame: &Frame,
    density: f64,
    positions: &[[f64; 3]],
    row_of: &(impl Fn(usize) -> &'b [FacetRecord] + Sync),
) -> FacetArrays {
    let mut offsets = vec![0; positions.len() + 1];
    parallel::for_each(&mut offsets[1..], CHUNK, |i, count| *count = row_of(i).len());
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
        let mut row: Vec<FacetRecord> = Vec::new();
        let mut next = 0;
        for i in sites.clone() {
            row.clear();
            row.extend_from_slice(row_of(i));
            row.sort_unstable_by_key(|facet| facet.neighbor);
            let [x, y, z] = frame.enter(positions[i]);
            for facet in &row {
                let there = frame.enter(positions[facet.neighbor as usize]);
                let (a, m) = (facet.area, facet.moment);
                neighbor[next] = facet.neighbor;
                area[next] = a * (density * frame.unit().powi(2));
                barycenter[next] = frame.leave([x + m.x / a, y + m.y / a, z + m.z / a]);
                distance[next] = self::distance([x, y, z], there) * frame.unit();
                next += 1;
            }
        }
    });
    list
}

/// The second moments of the facets of all sites, in the order of [`facet_arrays`].
fn facet_seconds<'b>(
    frame: &Frame,
    density: f64,
    sites: usize,
    row_of: &(impl Fn(usize) -> Row<'b> + Sync),
) -> Vec<[f64; 6]> {
    let unit = density * frame.unit().powi(4);
    let rows_in_order = |range: Range<usize>| {
        let mut all: Vec<[f64; 6]> = Vec::new();
        for i in range {
            let Row { records, seconds } = row_of(i);
            let mut row: Vec<_> = records.iter().map(|facet| facet.neighbor).zip(seconds).collect();
            row.sort_unstable_by_key(|(neighbor, _)| *neighbor);
            let of_facet = |FacetSecond { diagonal: d, mixed: m }: FacetSecond| [d.x, d.y, d.z, m.x, m.y, m.z];
            all.extend(row.into_iter().map(|(_, second)| of_facet(*second).map(|entry| entry * unit)));
        }
        all
    };
    parallel::chunks(sites, ROWS_AT_ONCE, rows_in_order).concat()
}
