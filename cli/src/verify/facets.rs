//! A file of facets, held against its own laws and against another evaluation.

use laguerre::io::FacetRow;
use laguerre::{Error, Output, PowerDiagram, Result};

use super::Wrong;
use super::bounds::{Bounds, length, sub};

/// The facets of a file, sorted by site and neighbour, the boundary first.
pub(super) struct FacetsFile {
    rows: Vec<FacetRow>,
    /// Those of site `i` are `offsets[i]..offsets[i + 1]`.
    offsets: Vec<usize>,
}

/// A facet as it is compared.
#[derive(Clone, Copy)]
struct Facet {
    /// `None`: the boundary.
    neighbor: Option<u32>,
    area: f64,
    barycenter: [f64; 3],
}

impl FacetsFile {
    /// Sorts the rows of a file about `n` sites; `unit` is what counts them there.
    ///
    /// # Errors
    /// `Input`, by line, for sites that there are not.
    pub(super) fn new(mut rows: Vec<FacetRow>, n: usize, unit: &str) -> Result<Self> {
        for row in &rows {
            if let Some(i) = [Some(row.site), row.neighbor].into_iter().flatten().find(|&i| i as usize >= n) {
                return Err(Error::input(format!("{unit} {}: site {i}, but there are {n} sites, from 0", row.line)));
            }
        }
        rows.sort_by_key(|row| (row.site, row.neighbor.map(|j| j + 1)));
        let mut offsets = vec![0; n + 1];
        rows.iter().for_each(|row| offsets[row.site as usize + 1] += 1);
        (0..n).for_each(|i| offsets[i + 1] += offsets[i]);
        Ok(Self { rows, offsets })
    }

    /// The rows of site `i`.
    pub(super) fn row(&self, i: usize) -> &[FacetRow] {
        &self.rows[self.offsets[i]..self.offsets[i + 1]]
    }

    /// Area of the boundary that the file lists.
    pub(super) fn boundary(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().filter(|row| row.neighbor.is_none()).map(|row| row.area)
    }

    /// What is wrong in the rows of site `i` by themselves and by those of the neighbours: a facet listed twice or of a site with
    /// itself, a negative area, a wrong distance, a facet whose other side is missing or of another area.
    pub(super) fn own_laws(&self, i: usize, diagram: &PowerDiagram, bounds: &Bounds<'_>, wrong: &mut Vec<Wrong>) {
        let row = self.row(i);
        for (k, facet) in row.iter().enumerate() {
            let says = |what, file: f64, expected: f64, off: f64, bound: f64| {
                Wrong::facet(i, facet.neighbor, what, [file, expected], [off, bound])
            };
            if k > 0 && row[k - 1].neighbor == facet.neighbor {
                wrong.push(says("listed twice", facet.area, 0.0, facet.area, 0.0));
            }
            // A comparison with NaN does not hold.
            let has_area = facet.area >= 0.0 && facet.area.is_finite();
            if !has_area {
                wrong.push(says("area", facet.area, 0.0, f64::INFINITY, 0.0));
            }
            let Some(j) = facet.neighbor.map(|j| j as usize) else { continue };
            if i == j {
                wrong.push(says("facet with itself", facet.area, 0.0, facet.area, 0.0));
                continue;
            }
            let distance = length(sub(diagram.positions()[i], diagram.positions()[j]));
            let found = facet.distance.unwrap_or(f64::NAN);
            let (off, bound) = ((found - distance).abs(), bounds.distance(i, distance));
            let is_near = off <= bound;
            if !is_near {
                wrong.push(says("distance", found, distance, off, bound));
            }
            let back = self.row(j).iter().find(|back| back.neighbor == Some(i as u32)).map_or(0.0, |back| back.area);
            let off = (facet.area - back).abs();
            // The larger side says it, once.
            if has_area && (facet.area > back || (back.is_nan() && i < j)) {
                let bound = bounds.area(i, j, facet.area, off);
                if off > bound && !bounds.is_undecided(i, j) {
                    wrong.push(says("area on the other side", facet.area, back, off, bound));
                }
            }
        }
    }

    /// Where the rows of site `i` differ from those of `reference`.
    pub(super) fn differences(&self, i: usize, reference: &Output, bounds: &Bounds<'_>, wrong: &mut Vec<Wrong>) {
        let file: Vec<Facet> = self.row(i).iter().map(Facet::from).collect();
        let expected = facets_of(reference, i);
        let mut open = false;
        let mut boundary = None;
        let sides = |neighbor| [&file, &expected].map(|row| row.iter().copied().find(|f| f.neighbor == neighbor));
        let all = file.iter().chain(expected.iter().filter(|f| file.iter().all(|g| f.neighbor != g.neighbor)));
        for neighbor in all.map(|f| f.neighbor) {
            let j = neighbor.map_or(i, |j| j as usize);
            let [a, b] = sides(neighbor);
            let [x, y] = [a, b].map(|f| f.map_or(0.0, |f| f.area));
            let mut off = (x - y).abs();
            let mut bound = bounds.area(i, j, y, off);
            let mut found = (off > bound).then(|| Wrong::facet(i, neighbor, "area", [x, y], [off, bound]));
            if let (Some(a), Some(b), None) = (a, b, &found) {
                off = x.min(y) * length(sub(a.barycenter, b.barycenter));
                bound = bounds.area(i, j, y, off / bounds.reach(i)) * bounds.reach(i) + bounds.moved(y);
                let is_near = off <= bound;
                found = (!is_near).then(|| Wrong::facet_place(i, neighbor, a.barycenter, b.barycenter, [off, bound]));
            }
            match (found, neighbor) {
                (None, _) => {}
                (found, None) => boundary = found,
                (Some(_), Some(_)) if bounds.is_undecided(i, j) => open = true,
                (Some(found), Some(_)) => wrong.push(found),
            }
        }
        // What is facet or boundary is neither's fault.
        wrong.extend(boundary.filter(|_| !open));
    }
}

impl From<&FacetRow> for Facet {
    fn from(row: &FacetRow) -> Self {
        Self { neighbor: row.neighbor, area: row.area, barycenter: row.barycenter }
    }
}

/// The facets of cell `i` of an output, its boundary first.
fn facets_of(output: &Output, i: usize) -> Vec<Facet> {
    let boundary = output.boundary().map(|b| b[i]).filter(|b| b.area > 0.0);
    let boundary = boundary.map(|b| Facet { neighbor: None, area: b.area, barycenter: b.barycenter });
    let inner = output.facets().into_iter().flat_map(|facets| facets.of(i)).map(|facet| Facet {
        neighbor: Some(facet.neighbor as u32),
        area: facet.area,
        barycenter: facet.barycenter,
    });
    boundary.into_iter().chain(inner).collect()
}
