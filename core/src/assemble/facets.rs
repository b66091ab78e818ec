//! Facets: what is known of each when its cell is finished, and all of them in order.

use super::units::Units;
use super::{Turn, facet_second_unit, share, share_of, within};
use crate::FacetArrays;
use crate::cell::{CellStore, FACET_AREAS, FACET_SECOND_MOMENTS, FacetSecond, TAG_BOX, facet_is_above_bound, v3};
use crate::parallel;
use crate::summation::CHUNK;
use std::ops::Range;

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

impl<'a> Row<'a> {
    /// What is known of each but moments.
    pub fn records(&self) -> &'a [FacetRecord] {
        self.records
    }

    /// First moments, in the frame of the site; none where they were not asked for.
    pub fn moments(&self) -> &'a [[f64; 3]] {
        self.moments
    }

    /// Second moments, in that frame; none where they were not asked for.
    pub fn second_moments(&self) -> &'a [FacetSecond] {
        self.seconds
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
pub(super) struct AddedFacets {
    /// Of each site; empty while nothing was added.
    places: Vec<Place>,
    parts: Vec<FacetRecords>,
}

impl AddedFacets {
    /// Adds those of some tasks' cells, of some of so many sites.
    pub(super) fn add(&mut self, sites: usize, parts: impl Iterator<Item = FacetRecords>, turns: &[Vec<Turn>]) {
        if self.places.is_empty() {
            self.places = parallel::map(sites, CHUNK, |_| Place::default());
        }
        let before = self.parts.len();
        parallel::each(self.places.chunks_mut(share_of(sites)), |k, places| {
            let sites = share(sites, k);
            for (part, turns) in (before as u32..).zip(turns) {
                for &Turn { site, begin, count, .. } in within(turns, &sites) {
                    places[site as usize - sites.start] = Place { part, begin, count };
                }
            }
        });
        self.parts.extend(parts);
    }

    /// Those of site `i`.
    pub(super) fn row(&self, i: usize) -> Row<'_> {
        let Some(&Place { part, begin, count }) = self.places.get(i) else { return Row::default() };
        let (begin, end) = (begin as usize, (begin + count) as usize);
        self.parts.get(part as usize).map_or_else(Row::default, |part| part.row(begin, end))
    }
}

/// The facets of all sites in one list.
pub(super) fn facet_arrays<'b>(
    units: Units,
    positions: &[[f64; 3]],
    row_of: &(impl Fn(usize) -> Row<'b> + Sync),
) -> FacetArrays {
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
pub(super) fn facet_seconds<'b>(
    units: Units,
    sites: usize,
    row_of: &(impl Fn(usize) -> Row<'b> + Sync),
) -> Vec<[f64; 6]> {
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
