//! Two weighted sites in a tetrahedron: `cargo run --example first_diagram`.

use laguerre::{Domain, PowerDiagram, Request, Selection};

fn main() -> laguerre::Result<()> {
    // Triangles are counterclockwise from outside. `Domain::load("part.stl")` reads a file instead.
    let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let domain = Domain::new(&vertices, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
    // Without weights, `&[]`, it is the Voronoi diagram.
    let diagram = PowerDiagram::new(&[[0.1, 0.1, 0.1], [0.5, 0.2, 0.2]], &[0.0, 0.01])?.restricted_to(&domain);
    let cells = laguerre::open(Selection::Auto)?.evaluate(&diagram, &Request::moments())?;
    for (volume, center) in cells.volume().iter().zip(cells.barycenter()) {
        println!("volume {volume:.6}, barycenter {center:.4?}");
    }
    println!("together {}, the tetrahedron {}", cells.volume().iter().sum::<f64>(), domain.volume());
    Ok(())
}
