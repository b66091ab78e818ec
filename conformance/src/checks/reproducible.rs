//! The same bits, from run to run and for any number of threads.

use laguerre_core::{Backend, Request};

use crate::compare::identical;
use crate::domains::{Pose, Shape};
use crate::sites::Sites;
use crate::weights::Weights;
use crate::{Case, Verdict, backends};

/// Evaluating again gives the same bits, whatever was evaluated between.
pub fn again(backend: &dyn Backend, case: &Case) -> Verdict {
    let request = Request::moments().with_facets().with_second_moments();
    let scene = case.scene();
    let first = scene.evaluate(backend, &request)?;
    let other = Case { seed: case.seed + 1, count: case.count + 7, shape: Shape::Box, ..*case };
    other.scene().evaluate(backend, &request)?;
    identical(&first, &scene.evaluate(backend, &request)?)
}

/// One, two and five threads give the same bits.
pub fn any_number_of_threads(backend: &dyn Backend) -> Verdict {
    let name = backend.info().backend;
    let request = Request::moments().with_facets().with_second_moments();
    let mut others = Vec::new();
    for threads in [1, 2, 5] {
        let opened = backends::open(name, Some(threads)).ok_or_else(|| format!("{name} is not built"))?;
        others.push((threads, opened.map_err(|error| error.to_string())?));
    }
    let small = Sites::ALL.into_iter().flat_map(|sites| Weights::ALL.map(|weights| (sites, weights, 50)));
    for (sites, weights, count) in small.chain([(Sites::White, Weights::Mild, 5000)]) {
        let case = Case { seed: 7, count, sites, weights, shape: Shape::Torus, pose: Pose::Turned };
        let scene = case.scene();
        let reference = scene.evaluate(backend, &request)?;
        for (threads, other) in &others {
            identical(&reference, &scene.evaluate(&**other, &request)?)
                .map_err(|reason| format!("with {threads} threads {reason}: {case:?}"))?;
        }
    }
    Ok(())
}
