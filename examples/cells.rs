//! The cells of scattered sites in a swan, and the largest of them: `cargo run --example cells --features shapes`.

use laguerre::{PowerDiagram, Request, Selection, shapes};

fn main() -> laguerre::Result<()> {
    // A domain made by code; `Domain::load` reads one from a file, `Domain::new` takes vertices and triangles.
    let domain = shapes::swan().domain();
    let (lo, hi) = domain.bounding_box();
    // Multiples of three irrational numbers spread evenly over the box.
    let scattered = |i: i32| {
        let at = [0.819_172_513, 0.671_043_606, 0.549_700_477].map(|x| (f64::from(i) * x).fract());
        std::array::from_fn(|k| lo[k] + at[k] * (hi[k] - lo[k]))
    };
    let sites: Vec<[f64; 3]> = (0..1000).map(scattered).collect();

    let diagram = PowerDiagram::new(&sites, &[])?.restricted_to(&domain);
    let cells = laguerre::open(Selection::Auto)?.evaluate(&diagram, &Request::moments())?;

    let within = cells.volume().iter().filter(|&&volume| volume > 0.0).count();
    let sum: f64 = cells.volume().iter().sum();
    println!("{within} of {} cells meet the swan; their volumes sum to {sum} of {}", sites.len(), domain.volume());
    if let Some((site, volume)) = cells.volume().iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) {
        println!("the largest is that of site {site}: volume {volume}, barycenter {:?}", cells.barycenter()[site]);
    }
    Ok(())
}
