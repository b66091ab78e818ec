//! Equal masses of a density that is a function, two normal distributions on a constant: `cargo run --example gaussians --features solvers`.

use laguerre::solvers::density::{Density, Gaussian};
use laguerre::solvers::transport::{self, Options};
use laguerre::{PowerDiagram, Selection};
use std::ops::ControlFlow;

fn main() -> laguerre::Result<()> {
    let positions: Vec<[f64; 3]> =
        (0..300).map(|i| [0.819, 0.671, 0.549].map(|step| (0.5 + f64::from(i) * step) % 1.0)).collect();
    let mut diagram = PowerDiagram::new(&positions, &[])?.in_box([0.0; 3], [1.0; 3])?;
    // Round ones by their deviation; others have a covariance. Their masses are those over all of space. By a rule of degree 5.
    let peaks = [Gaussian::round([0.5; 3], 0.2, 1.0), Gaussian::round([0.3, 0.6, 0.7], 0.15, 0.5)];
    let density = Density::gaussians(5, 0.5, &peaks)?;
    // Or any function: Density::function(5, |[x, y, z]| 2.0 + (3.0 * x).sin() * (y * z).cos()).
    let options = Options::default().of(density.clone());
    // A device cannot call a function: it goes to the CPU.
    let backend = laguerre::open(Selection::Auto)?;
    let solution = transport::solve(backend.as_ref(), &mut diagram, &[], &options, &mut |step| {
        println!("step {}: residual {:.1e}", step.number, step.residual);
        ControlFlow::Continue(())
    })?;
    let centers = density.centers(&diagram, &solution.output).unwrap_or_default();
    println!("{:?}, cost {:?}", solution.end, solution.cost);
    println!("the first cell has the mass {:.6}, its centre of mass is {:.3?}", solution.masses[0], centers[0]);
    Ok(())
}
