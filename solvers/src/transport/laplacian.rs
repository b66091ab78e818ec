//! The Laplacian of transport, from the facets of a diagram.

use laguerre_core::{Facet, Facets};

use super::sparse::Matrix;
use crate::density::Density;

/// `∂m_i/∂w_j = −a_ij` with `a_ij = ∫_facet ρ / (2 ‖p_i − p_j‖)`, and `Σ_j a_ij` on the diagonal: rows and columns in `order`, the
/// diagonal first in each row. Both sides of a facet have the mean of what the two cells found, so that the matrix is symmetric to the
/// last bit; a facet that one of them has alone is below its rounding bound, and left out. Masses are in `unit`, a power of two.
///
/// And for each entry what `limit` says of the site, and of the facet that it sees; zero on the diagonal.
pub(super) fn laplacian(
    facets: &Facets,
    density: &Density,
    order: &[u32],
    place: &[u32],
    unit: f64,
    limit: impl Fn(usize, &Facet) -> f64 + Sync,
) -> (Matrix, Vec<f64>) {
    let coefficient = |facet: Facet| density.at(facet.barycenter) * facet.area / (2.0 * facet.distance);
    Matrix::from_rows_and(
        order.len(),
        || (),
        |row, (), columns, values, limits| {
            let site = order[row] as usize;
            let diagonal = columns.len();
            columns.push(row as u32);
            values.push(0.0);
            limits.push(0.0);
            for facet in facets.of(site) {
                let Some(back) = facets.between(facet.neighbor, site) else { continue };
                let a = (coefficient(facet) + coefficient(facets.get(back))) / 2.0;
                if a > 0.0 {
                    columns.push(place[facet.neighbor]);
                    values.push(-(a / unit));
                    values[diagonal] += a / unit;
                    limits.push(limit(site, &facet));
                }
            }
        },
    )
}
