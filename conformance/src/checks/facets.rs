//! Facets seen from their two sides.

use laguerre_core::Backend;

use crate::bounds::{Bounds, Planes};
use crate::compare::{same_facet, undecided};
use crate::scene::rows;
use crate::{Case, Verdict};

/// Facet (i, j) is facet (j, i): the same area and barycenter. Not where it lies in the surface, nor in the plane of
/// a flat cell.
pub fn mutual(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let output = scene.with_facets(backend)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    let rows = rows(&output);
    for (i, row) in rows.iter().enumerate() {
        for facet in row {
            let j = facet.neighbor;
            if undecided(&scene, i, j, &bounds) {
                continue;
            }
            let back = rows[j].iter().find(|f| f.neighbor == i).copied();
            let bound = bounds.area(i).max(bounds.area(j));
            let reach = bounds.reach(i).max(bounds.reach(j));
            same_facet(Some(*facet), back, bound, reach)
                .map_err(|reason| format!("facets {i}-{j} and {j}-{i}: {reason}"))?;
        }
    }
    Ok(())
}

/// The distance of a facet is that of its sites, to a rounding.
pub fn distance(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let output = scene.with_facets(backend)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    for (i, row) in rows(&output).iter().enumerate() {
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

/// No facet and no piece of the boundary has a negative area: what rounding makes of nothing is dropped.
pub fn positive(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let output = scene.with_facets(backend)?;
    for (i, row) in rows(&output).iter().enumerate() {
        for facet in row {
            ensure!(facet.area > 0.0, "facet {i}-{}: area {:e}", facet.neighbor, facet.area);
        }
    }
    for (i, boundary) in output.boundary.iter().flatten().enumerate() {
        ensure!(boundary.area >= 0.0, "site {i}: area {:e} of boundary", boundary.area);
    }
    Ok(())
}
