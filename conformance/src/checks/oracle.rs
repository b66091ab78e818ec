//! No site is missed: every cell is the one that all sites have clipped.

use laguerre_core::oracle::Naive;
use laguerre_core::{Backend, Request};

use crate::bounds::Planes;
use crate::{Case, Verdict, compare};

/// Every cell, its facets and its boundary are the naive oracle's.
pub fn every_cell(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let request = Request::moments().with_facets().with_second_moments();
    let naive = scene.evaluate(&Naive::default(), &request)?;
    compare::same(&scene, &naive, &scene.evaluate(backend, &request)?, Planes::Same)
}
