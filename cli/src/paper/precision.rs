//! The precision paragraph of §6.3: the sums over all cells against the domain's, and each cell against another computation.

use laguerre::summation::Sum;
use laguerre::{CellStatus, Domain, Output, Request, Result, Selection};

use super::{Lab, diagram, head, row};
use crate::args::BackendArgs;
use crate::evaluate::evaluate;
use crate::report::grouped;

/// The paper's formulas, and what it gives for each (n cells, V and B volume and barycenter of the domain).
const FIGURES: [(&str, &str); 6] = [
    ("\\|Σ v − V\\| / V", "3e-15"),
    ("max over axes \\|Σ v b / V − B\\| / B", "3e-14"),
    ("max over cells \\|v − v′\\| / (V/n)", "6e-11"),
    ("max over axes and cells \\|b − b′\\| / B", "2e-6"),
    ("Σ \\|v − v′\\| / V", "3e-12"),
    ("max over axes Σ \\|b − b′\\| / (n B)", "2e-11"),
];

pub(super) fn run(lab: &mut Lab, count: u32, args: &BackendArgs) -> Result<String> {
    let inside = lab.power(count)?;
    let domain = &lab.bunny;
    let request = Request::moments();
    let ours = evaluate(lab.backend.as_ref(), &diagram(&inside.sites, &inside.weights, Some(domain))?, &request)?;
    let (theirs, whose) = if lab.backend.info().backend == "cpu" {
        // A quarter turn is exact, and the grids, the cones' apexes and the order of all sums are others then.
        let sites: Vec<[f64; 3]> = inside.sites.iter().copied().map(turned).collect();
        let vertices: Vec<[f64; 3]> = domain.vertices().iter().copied().map(turned).collect();
        let domain = Domain::new(&vertices, domain.triangles())?;
        let output = evaluate(lab.backend.as_ref(), &diagram(&sites, &inside.weights, Some(&domain))?, &request)?;
        let mut arrays = output.into_arrays();
        arrays.barycenter.iter_mut().for_each(|b| *b = turned_back(*b));
        (
            Output::new(arrays)?,
            "the same program on the input turned by 90°, which is exact and makes all grids, cones and sums others",
        )
    } else {
        let cpu = laguerre::open(Selection::Cpu { threads: args.threads })?;
        let output = evaluate(cpu.as_ref(), &diagram(&inside.sites, &inside.weights, Some(domain))?, &request)?;
        (output, "the backend `cpu`")
    };
    let apart = ours.status().iter().zip(theirs.status()).filter(|(a, b)| a != b).count();
    let mut text = format!(
        "**§6.3, precision**: the power diagram of Fig. 11, v and b volume and barycenter of each cell, against v′ and b′: {whose}. {} of {} \
         cells differ in status. The paper compares with Geogram.\n\n",
        grouped(apart as u64),
        grouped(ours.status().len() as u64)
    );
    text.push_str(&head(&["figure", "paper", "here"]));
    for ((formula, paper), here) in FIGURES.into_iter().zip(figures(&ours, &theirs, domain)) {
        text.push_str(&row(&[formula.into(), paper.into(), format!("{here:.1e}")]));
    }
    Ok(text)
}

/// The figures of the paragraph, in its order.
fn figures(ours: &Output, theirs: &Output, domain: &Domain) -> [f64; 6] {
    let (whole, center) = (domain.volume(), domain.barycenter());
    let mut volume = Sum::default();
    let mut moment = [Sum::default(); 3];
    let mut off_volume = Sum::default();
    let mut off_barycenter = [Sum::default(); 3];
    let mut most_volume = 0.0_f64;
    let mut most_barycenter = 0.0_f64;
    let mut cells = 0_usize;
    for i in 0..ours.status().len() {
        let (v, b, other) = (ours.volume()[i], ours.barycenter()[i], theirs.barycenter()[i]);
        let is_cell = ours.status()[i] != CellStatus::Empty;
        cells += usize::from(is_cell);
        volume.add(v);
        let off = (v - theirs.volume()[i]).abs();
        most_volume = most_volume.max(off);
        off_volume.add(off);
        for k in 0..3 {
            if is_cell {
                moment[k].add_product(v / whole, b[k]);
            }
            // A cell that only one of them has counts by its volume alone.
            if is_cell && theirs.status()[i] != CellStatus::Empty {
                let off = (b[k] - other[k]).abs() / center[k];
                most_barycenter = most_barycenter.max(off);
                off_barycenter[k].add(off);
            }
        }
    }
    let n = cells as f64;
    let most = |numbers: [f64; 3]| numbers.into_iter().fold(0.0, f64::max);
    [
        (volume.total() - whole).abs() / whole,
        most(std::array::from_fn(|k| (moment[k].total() - center[k]).abs() / center[k])),
        most_volume / (whole / n),
        most_barycenter,
        off_volume.total() / whole,
        most(off_barycenter.map(|sum| sum.total() / n)),
    ]
}

/// A quarter turn about the z axis.
fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
    [-y, x, z]
}

fn turned_back([x, y, z]: [f64; 3]) -> [f64; 3] {
    [y, -x, z]
}

#[cfg(test)]
mod tests {
    use laguerre::OutputArrays;

    use super::*;
    use crate::paper::domain;

    #[test]
    fn figures_are_those_of_the_formulas() {
        // Two halves of a torus's volume, one of them off by a thousandth of it, and its barycenter by 0.01 along y.
        let torus = domain("torus").unwrap();
        let (v, b) = (torus.volume(), torus.barycenter());
        let mut ours = OutputArrays::default();
        (ours.status, ours.volume, ours.barycenter) = (vec![CellStatus::Complete; 2], vec![0.5 * v; 2], vec![b; 2]);
        let mut theirs = ours.clone();
        theirs.volume[1] += 1e-3 * v;
        theirs.barycenter[1][1] += 0.01;
        let (ours, theirs) = (Output::new(ours).unwrap(), Output::new(theirs).unwrap());
        let off = figures(&ours, &theirs, &torus);
        let expected = [0.0, 0.0, 2e-3, 0.01 / b[1], 1e-3, 0.005 / b[1]];
        assert!((0..6).all(|i| (off[i] - expected[i]).abs() < 1e-12), "{off:?} for {expected:?}");
        let off = figures(&theirs, &theirs, &torus);
        assert!((off[0] - 1e-3).abs() < 1e-12 && off[1] > 1e-4 && off[2..] == [0.0; 4], "{off:?}");
    }

    #[test]
    fn turns_come_back() {
        assert_eq!(turned_back(turned([1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]);
    }
}
