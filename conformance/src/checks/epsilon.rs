//! The paper's enlarged radius instead of a proof.

use laguerre_core::summation::Sum;
use laguerre_core::{Backend, CellStatus, Request};

use crate::bounds::Planes;
use crate::compare::same;
use crate::domains::{Pose, Shape};
use crate::sites::Sites;
use crate::weights::Weights;
use crate::{Case, Verdict};

/// With a radius that reaches every site nothing is missed, and that is known.
pub fn generous(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let request = Request::moments().with_facets().with_epsilon(1e6);
    let output = scene.evaluate(backend, &request)?;
    let uncertified = output.count(CellStatus::Uncertified);
    ensure!(uncertified == 0, "{uncertified} cells are uncertified though every site was within reach");
    same(&scene, &scene.with_facets(backend)?, &output, Planes::Same)
}

/// With strong weights and the bare radius sites are missed: cells are marked, and too large, so that the volumes sum to more
/// than there is. What looks for errors can find one.
pub fn zero_is_seen(backend: &dyn Backend) -> Verdict {
    let case = Case {
        seed: 1,
        count: 3000,
        sites: Sites::White,
        weights: Weights::Hiding,
        shape: Shape::Box,
        pose: Pose::Plain,
    };
    let scene = case.scene();
    let output = scene.evaluate(backend, &Request::moments().with_epsilon(0.0))?;
    ensure!(output.count(CellStatus::Uncertified) > 0, "no cell is uncertified");
    let mut sum = Sum::default();
    sum.extend(output.volume().iter().copied());
    let (total, volume) = (sum.total(), scene.room.volume());
    // Far above rounding: a missed site is a volume of the order of a cell.
    ensure!(total > volume * (1.0 + 1e-6), "the volumes sum to {total} of {volume}: nothing was missed");
    let certified = scene.evaluate(backend, &Request::moments())?;
    for i in (0..scene.len()).filter(|&i| output.status()[i] == CellStatus::Complete) {
        let (a, b) = (output.volume()[i], certified.volume()[i]);
        ensure!((a - b).abs() <= 1e-12 * volume / scene.len() as f64, "site {i} is called complete: {a:e}, is {b:e}");
    }
    Ok(())
}
