//! The Laplacian of transport, from the facets of a diagram.

use laguerre_core::{Facet, Facets};

use super::sparse::Matrix;
use crate::density::Density;

/// `∂m_i/∂w_j = −a_ij` with `a_ij = ∫_facet ρ / (2 ‖p_i − p_j‖)`, and `Σ_j a_ij` on the diagonal: rows and columns in `order`, the
/// diagonal first in each row. Both sides of a facet have the mean of what the two cells found, so that the matrix is symmetric to the
/// last bit; a facet that one of them has alone is below its rounding bound, and left out. Masses are in `unit`, a power of two.
pub(super) fn laplacian(facets: &Facets, density: &Density, order: &[u32], place: &[u32], unit: f64) -> Matrix {
    entries(facets, density, order, place, |_, _, a| -(a / unit))
}

/// For each entry of the [`laplacian`] what `limit` says of the site, its neighbour and their facet; anything on the diagonal.
pub(super) fn limits(
    facets: &Facets,
    density: &Density,
    order: &[u32],
    place: &[u32],
    limit: impl Fn(usize, usize, usize) -> f64 + Sync,
) -> Vec<f64> {
    let entry = |site: u32, k: usize, _| limit(site as usize, facets.neighbor()[k] as usize, k);
    entries(facets, density, order, place, entry).values
}

/// A matrix with an entry for each facet that both sides have, and minus their sum on the diagonal.
fn entries(
    facets: &Facets,
    density: &Density,
    order: &[u32],
    place: &[u32],
    entry: impl Fn(u32, usize, f64) -> f64 + Sync,
) -> Matrix {
    let coefficient = |facet: Facet| density.at(facet.barycenter) * facet.area / (2.0 * facet.distance);
    Matrix::from_rows(
        order.len(),
        || (),
        |row, (), columns, values| {
            let site = order[row];
            let diagonal = columns.len();
            columns.push(row as u32);
            values.push(0.0);
            for facet in facets.of(site as usize) {
                let Some(back) = facets.between(facet.neighbor, site as usize) else { continue };
                let a = (coefficient(facet) + coefficient(facets.get(back))) / 2.0;
                if a > 0.0 {
                    columns.push(place[facet.neighbor]);
                    let value = entry(site, facet.number, a);
                    values.push(value);
                    values[diagonal] -= value;
                }
            }
        },
    )
}
