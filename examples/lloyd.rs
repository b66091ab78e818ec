//! Sites that move to the barycenters of their cells: `cargo run --example lloyd --features solvers,shapes`.

use std::ops::ControlFlow;

use laguerre::solvers::lloyd::{self, Method, Options};
use laguerre::{PowerDiagram, Selection, shapes};

fn main() -> laguerre::Result<()> {
    let domain = shapes::swan().domain();
    let (lo, hi) = domain.bounding_box();
    let scattered = |i: i32| {
        let at = [0.819_172_513, 0.671_043_606, 0.549_700_477].map(|x| (f64::from(i) * x).fract());
        std::array::from_fn(|k| lo[k] + at[k] * (hi[k] - lo[k]))
    };
    let sites: Vec<[f64; 3]> = (0..300).map(scattered).collect();
    let backend = laguerre::open(Selection::Auto)?;
    for method in [Method::Lloyd, Method::Lbfgs] {
        let mut diagram = PowerDiagram::new(&sites, &[])?.restricted_to(&domain);
        let options = Options::default().by(method).until(20, 1e-3);
        let relaxed = lloyd::relax(backend.as_ref(), &mut diagram, &options, &mut |_| ControlFlow::Continue(()))?;
        for (number, done) in relaxed.iterations.iter().enumerate().step_by(5) {
            println!("{method:?}, iteration {number}: energy {:.5}, gradient {:.4}", done.energy, done.gradient);
        }
    }
    Ok(())
}
