//! meshless_voronoi: volume and centroid of each cell in the unit cube. Reads rows of x, y, z; says seconds of the second of two runs, the sum of the
//! volumes and that of their squares.

use glam::DVec3;
use meshless_voronoi::{Dimensionality, Voronoi};
use std::time::Instant;

fn main() {
    let path = std::env::args().nth(1).expect("a file of sites");
    let text = std::fs::read_to_string(path).expect("a file that can be read");
    let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().expect("numbers")).collect();
    let sites: Vec<DVec3> = numbers.as_chunks::<3>().0.iter().map(|&site| DVec3::from(site)).collect();
    let mut said = String::new();
    for _ in 0..2 {
        let begin = Instant::now();
        let voronoi = Voronoi::build(&sites, DVec3::ZERO, DVec3::ONE, Dimensionality::ThreeD, false);
        let seconds = begin.elapsed().as_secs_f64();
        let volumes = || voronoi.cells().iter().map(|cell| cell.volume());
        let (sum, squares) = (volumes().sum::<f64>(), volumes().map(|volume| volume * volume).sum::<f64>());
        said = format!("{seconds:.6} {sum:e} {squares:e}");
    }
    println!("{said}");
}
