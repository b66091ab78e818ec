//! From sums in the frame of each site to the output in the caller's order and unit. Written once for all backends.

use crate::cell::{CellStore, CellSums, FacetSum, TAG_BOX, V3, facet_is_above_bound};
use crate::diagram::Prepared;
use crate::output::{Boundary, CellStatus, FacetList, Neighbor, Output};
use crate::request::Request;

/// One facet of a finished cell, in the frame of its site.
#[derive(Clone, Copy, Debug)]
pub struct FacetRecord {
    /// The sorted index of the site beyond it.
    pub neighbor: u32,
    /// Its sums.
    pub sum: FacetSum,
}

/// One finished cell, in the frame of its site.
#[derive(Clone, Copy, Debug)]
pub struct CellRecord {
    /// The sorted index of its site.
    pub site: u32,
    /// How it ended.
    pub status: CellStatus,
    /// Its sums.
    pub sums: CellSums,
}

/// Appends the facets of the finished cell that exceed their rounding bound.
pub fn collect_facets<S: CellStore>(store: &S, facets: &mut Vec<FacetRecord>) {
    for f in 0..store.planes() {
        let (neighbor, sum) = (store.tag(f), store.facet(f));
        if neighbor < TAG_BOX && facet_is_above_bound(sum) != 0 {
            facets.push(FacetRecord { neighbor, sum });
        }
    }
}

/// Collects finished cells into an [`Output`].
#[derive(Debug)]
pub struct Assembler<'a> {
    prepared: &'a Prepared,
    output: Output,
    /// Rows of facets as they came: the caller's index of the site, and the facets' range in `facets`.
    rows: Vec<(u32, usize)>,
    facets: Vec<FacetRecord>,
}

impl<'a> Assembler<'a> {
    /// For all cells of a diagram; cells that are never added, as those of coincident sites, stay empty.
    pub fn new(prepared: &'a Prepared, request: &Request) -> Self {
        let n = prepared.sites.len() + prepared.sites.coincident().len();
        let output = Output {
            status: vec![CellStatus::Empty; n],
            volume: vec![0.0; n],
            barycenter: vec![[f64::NAN; 3]; n],
            second_moment: request.second_moments.then(|| vec![[0.0; 6]; n]),
            facets: request.facets.then(FacetList::default),
            boundary: request.facets.then(|| vec![Boundary::default(); n]),
            ..Output::default()
        };
        Self { prepared, output, rows: Vec::new(), facets: Vec::new() }
    }

    /// Adds one finished cell with its facets.
    pub fn add(&mut self, cell: &CellRecord, facets: &[FacetRecord]) {
        let i = self.prepared.sites.order()[cell.site as usize] as usize;
        self.output.status[i] = cell.status;
        if cell.status == CellStatus::Empty {
            return;
        }
        let frame = &self.prepared.frame;
        let unit = frame.unit();
        let [x, y, z, _] = self.prepared.sites.sites()[cell.site as usize];
        let place = |m: V3, mass: f64| frame.leave([x + m.x / mass, y + m.y / mass, z + m.z / mass]);
        let sums = &cell.sums;
        self.output.volume[i] = sums.volume * unit.powi(3);
        self.output.barycenter[i] = place(sums.first, sums.volume);
        if let Some(second) = &mut self.output.second_moment {
            let (s, m, v) = (sums, sums.first, sums.volume);
            second[i] = [
                s.second_diagonal.x - m.x * m.x / v,
                s.second_diagonal.y - m.y * m.y / v,
                s.second_diagonal.z - m.z * m.z / v,
                s.second_mixed.x - m.x * m.y / v,
                s.second_mixed.y - m.x * m.z / v,
                s.second_mixed.z - m.y * m.z / v,
            ]
            .map(|x| x * unit.powi(5));
        }
        if let Some(boundary) = &mut self.output.boundary
            && sums.boundary_area != 0.0
        {
            let n = sums.boundary_vector;
            boundary[i] = Boundary {
                area: sums.boundary_area * unit.powi(2),
                barycenter: place(sums.boundary_moment, sums.boundary_area),
                vector_area: [n.x, n.y, n.z].map(|a| a * unit.powi(2)),
                flux: sums.boundary_flux * unit.powi(3),
            };
        }
        if self.output.facets.is_some() {
            self.rows.push((cell.site, self.facets.len()));
            self.facets.extend_from_slice(facets);
        }
    }

    /// The output; `exact_cells` and `passes` are the caller's to fill in.
    pub fn finish(mut self) -> Output {
        if let Some(list) = &mut self.output.facets {
            *list = facet_list(self.prepared, self.output.status.len(), &self.rows, &self.facets);
        }
        self.output
    }
}

/// Sorts rows into the caller's order and each row by neighbour.
fn facet_list(prepared: &Prepared, n: usize, rows: &[(u32, usize)], facets: &[FacetRecord]) -> FacetList {
    let order = prepared.sites.order();
    let sites = prepared.sites.sites();
    let (frame, unit) = (&prepared.frame, prepared.frame.unit());
    let mut by_site = vec![0..0; n];
    for (r, &(site, begin)) in rows.iter().enumerate() {
        let end = rows.get(r + 1).map_or(facets.len(), |next| next.1);
        by_site[order[site as usize] as usize] = begin..end;
    }
    let mut sorted_of = vec![0_u32; n];
    order.iter().enumerate().for_each(|(sorted, &i)| sorted_of[i as usize] = sorted as u32);
    let mut list = FacetList { offsets: vec![0], ..FacetList::default() };
    let mut row: Vec<FacetRecord> = Vec::new();
    for (i, range) in by_site.into_iter().enumerate() {
        row.clear();
        row.extend_from_slice(&facets[range]);
        row.sort_unstable_by_key(|facet| order[facet.neighbor as usize]);
        let [x, y, z, _] = sites[sorted_of[i] as usize];
        for facet in &row {
            let [nx, ny, nz, _] = sites[facet.neighbor as usize];
            let (area, m) = (facet.sum.area, facet.sum.moment);
            list.neighbor.push(Neighbor { site: order[facet.neighbor as usize], image: [0; 3] });
            list.area.push(area * unit.powi(2));
            list.barycenter.push(frame.leave([x + m.x / area, y + m.y / area, z + m.z / area]));
            list.distance.push(((nx - x).powi(2) + (ny - y).powi(2) + (nz - z).powi(2)).sqrt() * unit);
        }
        list.offsets.push(list.area.len());
    }
    list
}
