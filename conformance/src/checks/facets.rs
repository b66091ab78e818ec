//! Facets seen from their two sides.

use laguerre_core::{Backend, CellStatus, Output};

use crate::bounds::Bounds;
use crate::checks::sums::has_negative_windings;
use crate::compare::{same_facet, undecided};
use crate::{Case, Scene, Verdict, sanity};

/// [`are_mutual`] on a case.
pub fn mutual(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, are_mutual)
}

/// [`have_distances`] on a case.
pub fn distance(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, have_distances)
}

/// [`are_positive`] on a case.
pub fn positive(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, are_positive)
}

/// Facet (i, j) is facet (j, i): the same area and first moment. Not where it lies in the surface, nor in the plane of
/// a flat cell. A negative one may be missing on one side while it is below what may be not believed there.
pub fn are_mutual(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    for (i, row) in bounds.rows().iter().enumerate() {
        for facet in row {
            let j = facet.neighbor;
            let back = bounds.rows()[j].iter().find(|f| f.neighbor == i).copied();
            let reach = bounds.reach(i).max(bounds.reach(j));
            let least = bounds.least_facet_rounding(i).max(bounds.least_facet_rounding(j));
            if same_facet(Some(*facet), back, least, scene.site(i), reach).is_ok() || undecided(scene, i, j, bounds) {
                continue;
            }
            let mut bound = bounds.area(i).max(bounds.area(j));
            if output.status()[j] == CellStatus::Empty {
                bound = bound.max(bounds.facet_of_empty(j));
            }
            if back.is_none() && facet.area < 0.0 {
                bound = bound.max(bounds.not_believed(j));
            }
            same_facet(Some(*facet), back, bound, scene.site(i), reach)
                .map_err(|reason| format!("facets {i}-{j} and {j}-{i}: {reason}"))?;
        }
    }
    Ok(())
}

/// The distance of a facet is that of its sites, to a rounding.
pub fn have_distances(scene: &Scene, _: &Output, bounds: &Bounds) -> Verdict {
    for (i, row) in bounds.rows().iter().enumerate() {
        for facet in row {
            let distance = scene.site(i).distance(scene.site(facet.neighbor));
            let off = (facet.distance - distance).abs();
            ensure!(
                off <= bounds.displacement(i),
                "facet {i}-{}: {} is not {distance}",
                facet.neighbor,
                facet.distance
            );
        }
    }
    Ok(())
}

/// No facet, where no winding number is negative, and no piece of the boundary has a negative area: what rounding makes of nothing is dropped.
pub fn are_positive(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    let signed = has_negative_windings(&scene.room, scene.len());
    for (i, row) in bounds.rows().iter().enumerate() {
        for facet in row {
            ensure!(
                facet.area > 0.0 || (signed && facet.area < 0.0),
                "facet {i}-{}: area {:e}",
                facet.neighbor,
                facet.area
            );
        }
    }
    for (i, boundary) in output.boundary().into_iter().flatten().enumerate() {
        ensure!(boundary.area >= 0.0, "site {i}: area {:e} of boundary", boundary.area);
    }
    Ok(())
}
