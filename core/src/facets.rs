//! The facets between restricted cells, and each cell's piece of the boundary.

use std::ops::Range;

use crate::{Error, Result};

/// The part of the domain's boundary that lies in one restricted cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Boundary {
    /// Area (length²).
    pub area: f64,
    /// Barycenter; zero where the area is zero.
    pub barycenter: [f64; 3],
    /// ∫ n dA (length²), `n` the outward unit normal of the domain.
    pub vector_area: [f64; 3],
    /// ∫ n·(x − p) dA (length³), `p` the cell's site: three times the part of the volume that the boundary closes.
    pub flux: f64,
}

/// One facet, seen from the cell of one of its two sites.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Facet {
    /// Its number: the index into the arrays of [`Facets`].
    pub number: usize,
    /// The site beyond it.
    pub neighbor: usize,
    /// Area (length²) within the domain.
    pub area: f64,
    /// Barycenter of what is within the domain.
    pub barycenter: [f64; 3],
    /// Distance between the two sites (length).
    pub distance: f64,
}

/// Facets as flat arrays: compressed sparse rows, those of site `i` at `offsets[i]..offsets[i + 1]`, sorted by neighbour.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FacetArrays {
    /// Row starts; one more than sites.
    pub offsets: Vec<usize>,
    /// The site beyond each facet.
    pub neighbor: Vec<u32>,
    /// Area (length²) of the facet within the domain.
    pub area: Vec<f64>,
    /// Barycenter of the facet within the domain.
    pub barycenter: Vec<[f64; 3]>,
    /// Distance between the two sites (length).
    pub distance: Vec<f64>,
    /// Where requested: ∫ (x − b)(x − b)ᵀ dA about each facet's own barycenter `b`, as xx, yy, zz, xy, xz, yz (length⁴).
    pub second_moment: Option<Vec<[f64; 6]>>,
    /// The piece of the boundary in the cell of each site.
    pub boundary: Vec<Boundary>,
}

/// The facets between restricted cells, row by row, and the piece of the boundary in each cell. Every facet stands once in each of its two rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Facets(FacetArrays);

impl Default for Facets {
    /// Of no sites.
    fn default() -> Self {
        Self(FacetArrays { offsets: vec![0], ..FacetArrays::default() })
    }
}

impl Facets {
    /// Facets from arrays.
    ///
    /// # Errors
    /// `Input` where these do not fit together: their lengths, the order of rows, or of the neighbours in a row.
    pub fn new(arrays: FacetArrays) -> Result<Self> {
        check(&arrays)?;
        Ok(Self(arrays))
    }

    /// The same of arrays that are made to fit.
    pub(crate) fn of_fitting(arrays: FacetArrays) -> Self {
        debug_assert!(check(&arrays).is_ok(), "facets do not fit together");
        Self(arrays)
    }

    /// Its arrays, to be taken along or changed.
    pub fn into_arrays(self) -> FacetArrays {
        self.0
    }

    /// The number of sites.
    pub fn sites(&self) -> usize {
        self.0.boundary.len()
    }

    /// The number of facets, each counted from both sides.
    pub fn len(&self) -> usize {
        self.0.neighbor.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.neighbor.is_empty()
    }

    /// The numbers of the facets of the cell of site `i`.
    ///
    /// # Panics
    /// Where there is no such site.
    pub fn row(&self, i: usize) -> Range<usize> {
        self.0.offsets[i]..self.0.offsets[i + 1]
    }

    /// The facets of the cell of site `i`, sorted by neighbour.
    ///
    /// # Panics
    /// Where there is no such site.
    pub fn of(&self, i: usize) -> impl ExactSizeIterator<Item = Facet> + Clone {
        self.row(i).map(|k| self.get(k))
    }

    /// The facet of number `k`.
    ///
    /// # Panics
    /// Where there is no such facet.
    pub fn get(&self, k: usize) -> Facet {
        let FacetArrays { neighbor, area, barycenter, distance, .. } = &self.0;
        Facet {
            number: k,
            neighbor: neighbor[k] as usize,
            area: area[k],
            barycenter: barycenter[k],
            distance: distance[k],
        }
    }

    /// The number of the facet of site `i` with site `j`, if there is one.
    ///
    /// # Panics
    /// Where there is no site `i`.
    pub fn between(&self, i: usize, j: usize) -> Option<usize> {
        let row = self.row(i);
        let found = self.0.neighbor[row.clone()].binary_search(&u32::try_from(j).ok()?);
        found.ok().map(|k| row.start + k)
    }

    /// The number of the same facet seen from its other side. Who knows the site on this side asks [`Facets::between`], which need not look for it.
    ///
    /// # Panics
    /// Where there is no facet `k`.
    pub fn opposite(&self, k: usize) -> Option<usize> {
        let site = self.0.offsets.partition_point(|&begin| begin <= k) - 1;
        self.between(self.0.neighbor[k] as usize, site)
    }

    /// Row starts; one more than sites.
    pub fn offsets(&self) -> &[usize] {
        &self.0.offsets
    }

    /// The site beyond each facet.
    pub fn neighbor(&self) -> &[u32] {
        &self.0.neighbor
    }

    /// Area (length²) of each facet within the domain.
    pub fn area(&self) -> &[f64] {
        &self.0.area
    }

    /// Barycenter of each facet within the domain.
    pub fn barycenter(&self) -> &[[f64; 3]] {
        &self.0.barycenter
    }

    /// Distance between the two sites of each facet (length).
    pub fn distance(&self) -> &[f64] {
        &self.0.distance
    }

    /// Where requested: ∫ (x − b)(x − b)ᵀ dA about each facet's own barycenter `b`, as xx, yy, zz, xy, xz, yz (length⁴).
    pub fn second_moment(&self) -> Option<&[[f64; 6]]> {
        self.0.second_moment.as_deref()
    }

    /// The piece of the boundary in the cell of each site.
    pub fn boundary(&self) -> &[Boundary] {
        &self.0.boundary
    }
}

/// Whether arrays fit together.
fn check(arrays: &FacetArrays) -> Result<()> {
    let FacetArrays { offsets, neighbor, .. } = arrays;
    let wrong = |what: &str| Err(Error::input(format!("facets: {what}")));
    let (Some(0), Some(&count)) = (offsets.first(), offsets.last()) else {
        return wrong("the offsets of their rows begin with 0");
    };
    let sites = offsets.len() - 1;
    let lengths = [neighbor.len(), arrays.area.len(), arrays.barycenter.len(), arrays.distance.len()];
    let seconds = arrays.second_moment.as_ref().map_or(count, Vec::len);
    if lengths != [count; 4] || seconds != count || arrays.boundary.len() != sites {
        return wrong("their arrays differ in length");
    }
    if !offsets.is_sorted() {
        return wrong("a row ends before it begins");
    }
    let is_row = |row: &[u32]| row.is_sorted_by(|a, b| a < b) && row.last().is_none_or(|&j| (j as usize) < sites);
    match offsets.windows(2).position(|row| !is_row(&neighbor[row[0]..row[1]])) {
        Some(i) => {
            Err(Error::input(format!("facets: the neighbours of site {i} are not sorted, or no sites")).of_site(i))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three sites in a row, each with a piece of the boundary.
    fn three() -> FacetArrays {
        FacetArrays {
            offsets: vec![0, 1, 3, 4],
            neighbor: vec![1, 0, 2, 1],
            area: vec![1.0, 1.0, 2.0, 2.0],
            barycenter: vec![[0.0; 3]; 4],
            distance: vec![0.5; 4],
            second_moment: None,
            boundary: vec![Boundary::default(); 3],
        }
    }

    #[test]
    fn facets_are_found_from_either_side() {
        let facets = Facets::new(three()).unwrap();
        assert_eq!([0, 1, 2, 3].map(|k| facets.opposite(k)), [1, 0, 3, 2].map(Some));
        let row: Vec<_> = facets.of(1).map(|f| (f.number, f.neighbor, f.area)).collect();
        assert_eq!(row, [(1, 0, 1.0), (2, 2, 2.0)]);
        assert_eq!((facets.between(0, 2), facets.between(2, 1), facets.len()), (None, Some(3), 4));
        // An empty row before it does not hide a facet's site.
        let mut arrays = three();
        arrays.offsets.insert(0, 0);
        arrays.boundary.push(Boundary::default());
        arrays.neighbor.iter_mut().for_each(|j| *j += 1);
        assert_eq!(Facets::new(arrays).unwrap().opposite(0), Some(1));
    }

    #[test]
    fn arrays_that_do_not_fit_are_refused() {
        let spoil: [fn(&mut FacetArrays); 7] = [
            |a| a.offsets.clear(),
            |a| a.offsets[3] = 5,
            |a| a.offsets[1] = 4,
            |a| a.area.truncate(3),
            |a| a.boundary.truncate(2),
            |a| a.neighbor[2] = 0,
            |a| a.neighbor[3] = 3,
        ];
        for (case, spoil) in spoil.iter().enumerate() {
            let mut arrays = three();
            spoil(&mut arrays);
            assert!(Facets::new(arrays).is_err(), "{case}");
        }
    }
}
