//! The Laplacian of a diagram: how each cell's volume changes with the weights.

use std::ops::Range;

use crate::rows::{self, Rows, gather};

/// The Laplacian, without its diagonal: for cells i and j that share a facet `A_ij / d_ij`, its area over the distance of their sites (length).
///
/// `∂V_i/∂w_j = −A_ij / (2 d_ij)`, and `∂V_i/∂w_i` is minus the sum of these; of Voronoi cells it is the two-point flux Laplacian of finite volumes.
/// It is symmetric to the last bit: both sides of a facet have the mean of what the two cells found, and a facet that only one of them has, which is below the
/// rounding bound of the other's, is left out. In a domain with a density areas are the density's integrals.
///
/// Rows and columns stand in an order of their own, in which neighbours are near each other: row `r` is of the site `order()[r]`. That depends on the
/// positions alone. Coincident sites have a row for the one of them that has a cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Laplacian {
    order: Vec<u32>,
    offsets: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Laplacian {
    /// Of rows that are made to fit: columns sorted within each.
    #[doc(hidden)]
    pub fn of_fitting(order: Vec<u32>, (offsets, columns, values): Rows) -> Self {
        debug_assert!(offsets.len() == order.len() + 1 && offsets.last() == Some(&columns.len()));
        debug_assert!(columns.len() == values.len());
        Self { order, offsets, columns, values }
    }

    /// From the facets' areas. `areas(i)` are the neighbours of the cell of site `i`, by the caller's index, with the areas of their facets,
    /// and `value` is what an entry is for two sites whose facet has some area.
    pub(crate) fn of_areas<'a, I: Iterator<Item = (u32, f64)> + 'a>(
        order: &[u32],
        sites: usize,
        areas: impl Fn(usize) -> I + Sync,
        value: impl Fn(usize, usize, f64) -> f64 + Sync,
    ) -> Self {
        let place = rows::places(order, sites);
        let (begins, columns, areas) = gather(order.len(), Vec::new, |row, facets, columns, values| {
            facets.clear();
            facets.extend(areas(order[row] as usize).map(|(j, area)| (place[j as usize], area)));
            facets.sort_unstable_by_key(|(column, _)| *column);
            columns.extend(facets.iter().map(|(column, _)| *column));
            values.extend(facets.iter().map(|(_, area)| *area));
        });
        let range = |row: usize| begins[row]..begins[row + 1];
        let seen_back = |row: usize, column: u32| {
            let there = range(column as usize);
            columns[there.clone()].binary_search(&(row as u32)).ok().map(|k| areas[there.start + k])
        };
        let both = gather(
            order.len(),
            || (),
            |row, (), all, values| {
                for k in range(row) {
                    let Some(other) = seen_back(row, columns[k]) else { continue };
                    all.push(columns[k]);
                    let mean = (areas[k] + other) / 2.0;
                    values.push(value(order[row] as usize, order[columns[k] as usize] as usize, mean));
                }
            },
        );
        Self::of_fitting(order.to_vec(), both)
    }

    /// The site that each row, and column, is of.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Where the rows begin; one more than rows.
    pub fn offsets(&self) -> &[usize] {
        &self.offsets
    }

    /// The column of each entry, sorted within a row.
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// `A_ij / d_ij` (length) of each entry.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The numbers of the entries of a row.
    ///
    /// # Panics
    /// Where there is no such row.
    pub fn row(&self, row: usize) -> Range<usize> {
        self.offsets[row]..self.offsets[row + 1]
    }

    /// The whole matrix of so many sites, in the caller's order: where rows begin, columns, which are sorted in each, and values, `−A_ij / d_ij` and the sum of
    /// these ratios on the diagonal. The row of a site without a cell is empty, but for a zero there.
    ///
    /// # Panics
    /// Where a row is of a site beyond these.
    pub fn whole(&self, sites: usize) -> Rows {
        let place = rows::places(&self.order, sites);
        gather(sites, Vec::new, |i, entries: &mut Vec<(u32, f64)>, columns, values| {
            entries.clear();
            let row = place[i] as usize;
            let own = if row < self.order.len() { self.row(row) } else { 0..0 };
            entries.extend(own.map(|k| (self.order[self.columns[k] as usize], -self.values[k])));
            let sum = -entries.iter().map(|(_, value)| value).sum::<f64>();
            entries.push((i as u32, sum + 0.0));
            entries.sort_unstable_by_key(|(column, _)| *column);
            columns.extend(entries.iter().map(|(column, _)| *column));
            values.extend(entries.iter().map(|(_, value)| *value));
        })
    }

    /// Its arrays: the order, where rows begin, columns and values.
    pub fn into_arrays(self) -> (Vec<u32>, Vec<usize>, Vec<u32>, Vec<f64>) {
        (self.order, self.offsets, self.columns, self.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_have_their_mean_and_what_one_has_alone_is_left_out() {
        // Sites 0, 1, 3 have a cell; they stand as 3, 0, 1.
        let of_site: [&[(u32, f64)]; 4] = [&[(1, 2.0), (3, 1.0)], &[(0, 4.0)], &[], &[(0, 1.0), (1, 0.5)]];
        let areas = |i: usize| of_site[i].iter().copied();
        let found = Laplacian::of_areas(&[3, 0, 1], 4, areas, |i, j, area| (10 * i.min(j) + i.max(j)) as f64 + area);
        let whole =
            (vec![0, 3, 5, 6, 8], vec![0, 1, 3, 0, 1, 2, 0, 3], vec![8.0, -4.0, -4.0, -4.0, 4.0, 0.0, -4.0, 4.0]);
        assert_eq!(found.whole(4), whole);
        assert_eq!(found.into_arrays(), (vec![3, 0, 1], vec![0, 1, 3, 4], vec![1, 0, 2, 1], vec![4.0, 4.0, 4.0, 4.0]));
    }
}
