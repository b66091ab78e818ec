//! The Laplacian of transport, from the cells of a diagram.

use laguerre_core::{Facets, Laplacian, Result};

use super::sparse::Matrix;
use crate::density::Density;

/// `∂m_i/∂w_j = −a_ij` and `Σ_j a_ij` on the diagonal, the first in each row, where masses are volumes in `unit`, a power of two. A facet of no area, or
/// less, is left out.
pub(super) fn of_volumes(laplacian: &Laplacian, unit: f64) -> Matrix {
    Matrix::from_rows(
        laplacian.order().len(),
        || (),
        |row, (), columns, values| {
            let entries = laplacian.row(row);
            let each = laplacian.columns()[entries.clone()].iter().zip(&laplacian.values()[entries]);
            append(row, each.map(|(&column, value)| (column, value / 2.0)), unit.recip(), columns, values);
        },
    )
}

/// The same for a density, where masses are times `scale` and a function is not to be called outside of some bounds, with `a_ij = ∫_facet ρ / (2 ‖p_i − p_j‖)`: rows and columns in `order`. Both sides of a facet have the mean of what the two
/// cells found, so that the matrix is symmetric to the last bit; a facet that one of them has alone is below its rounding bound, and left out.
pub(super) fn of_masses(
    facets: &Facets,
    density: &Density,
    bounds: Option<[[f64; 3]; 2]>,
    order: &[u32],
    place: &[u32],
    scale: f64,
) -> Result<Matrix> {
    let masses = density.of_facets(facets, bounds)?;
    let coefficient = |k: usize| masses[k] / (2.0 * facets.get(k).distance);
    Ok(Matrix::from_rows(
        order.len(),
        || (),
        |row, (), columns, values| {
            let site = order[row] as usize;
            let each = facets.of(site).filter_map(|facet| {
                let back = facets.between(facet.neighbor, site)?;
                Some((place[facet.neighbor], (coefficient(facet.number) + coefficient(back)) / 2.0))
            });
            append(row, each, scale, columns, values);
        },
    ))
}

/// Appends a row of the matrix whose other entries, of facets with some area, are these, negative.
fn append(
    row: usize,
    others: impl Iterator<Item = (u32, f64)>,
    scale: f64,
    columns: &mut Vec<u32>,
    values: &mut Vec<f64>,
) {
    let diagonal = columns.len();
    columns.push(row as u32);
    values.push(0.0);
    for (column, a) in others.filter(|(_, a)| *a > 0.0) {
        columns.push(column);
        values.push(-(a * scale));
        values[diagonal] += a * scale;
    }
}
