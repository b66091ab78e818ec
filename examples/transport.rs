//! Weights for cells of equal volume, told step by step: `cargo run --example transport --features solvers,shapes`.

use std::ops::ControlFlow;

use laguerre::solvers::transport::{self, Options};
use laguerre::{PowerDiagram, Selection, shapes};

fn main() -> laguerre::Result<()> {
    let domain = shapes::swan().domain();
    let (lo, hi) = domain.bounding_box();
    let scattered = |i: i32| {
        let at = [0.819_172_513, 0.671_043_606, 0.549_700_477].map(|x| (f64::from(i) * x).fract());
        std::array::from_fn(|k| lo[k] + at[k] * (hi[k] - lo[k]))
    };
    let sites: Vec<[f64; 3]> = (0..300).map(scattered).collect();
    let mut diagram = PowerDiagram::new(&sites, &[])?.restricted_to(&domain);

    let backend = laguerre::open(Selection::Auto)?;
    // No masses stand for equal ones. `Break` ends it with the weights of the last step.
    let solved = transport::solve(backend.as_ref(), &mut diagram, &[], &Options::default(), &mut |done| {
        println!("step {}: residual {:.1e}", done.number, done.residual);
        if done.number < 60 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    println!("{:?}: residual {:.1e}, cost {:.6}", solved.end, solved.residual, solved.cost.unwrap_or(f64::NAN));
    Ok(())
}
