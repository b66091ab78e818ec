//! The weighted Laplacian, and the derivatives of volumes, as sparse rows: `cargo run --example laplacian --features solvers`.

use laguerre::solvers::density::Density;
use laguerre::solvers::derivatives::Derivatives;
use laguerre::{PowerDiagram, Request, Selection};

fn main() -> laguerre::Result<()> {
    // A lattice of 4 × 4 × 4 sites: cells are cubes of side 1/4, facets squares of area 1/16 between sites 1/4 apart.
    let site = |i: usize| [i % 4, i / 4 % 4, i / 16].map(|k| (k as f64 + 0.5) / 4.0);
    let sites: Vec<[f64; 3]> = (0..64).map(site).collect();
    let diagram = PowerDiagram::new(&sites, &[])?.in_box([0.0; 3], [1.0; 3])?;
    let backend = laguerre::open(Selection::Auto)?;

    // By hand: area over distance, row by row.
    let cells = backend.evaluate(&diagram, &Request::moments().with_facets())?;
    if let Some(facets) = cells.facets() {
        for facet in facets.of(0) {
            println!("cell 0, cell {}: area / distance {:.4}", facet.neighbor, facet.area / facet.distance);
        }
    }

    // As matrices, in compressed rows: offsets, columns, values.
    let cells = backend.evaluate(&diagram, &Derivatives::request(&Density::Uniform))?;
    let derivatives = Derivatives::new(&diagram, &cells, &Density::Uniform)?;
    let by_weights = derivatives.masses_by_weights();
    for (j, [slope]) in by_weights.row(0) {
        println!("dV_0/dw_{j} = {slope:.4}");
    }
    println!("{} numbers in {} rows", by_weights.values.len(), by_weights.offsets.len() - 1);
    Ok(())
}
