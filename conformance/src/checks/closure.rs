//! Every restricted cell is closed: the divergence theorem for a constant and for x − p.

use glam::DVec3;
use laguerre_core::{Backend, Output};

use crate::bounds::{Bounds, CLOSURE};
use crate::{Case, Scene, Verdict, sanity};

/// [`of_areas`] on a case.
pub fn areas(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, of_areas)
}

/// [`of_volumes`] on a case.
pub fn volume(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, of_volumes)
}

/// Σ area · outward normal over facets and boundary is 0. The normals are those of the sites as the library has them in its
/// frame: of sites next to each other and outside of the container they may be turned by any angle ([`Bounds::turn`]).
pub fn of_areas(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    let boundary = output.boundary.as_deref().unwrap_or_default();
    for (i, row) in bounds.rows().iter().enumerate() {
        let mut sum = DVec3::from(boundary[i].vector_area);
        let (mut area, mut turned) = (boundary[i].area, 0.0);
        for facet in row {
            // The difference of two unit vectors is at most 2.
            turned += facet.area.abs() * bounds.turn(i, facet.neighbor).min(2.0);
            sum += facet.area * (scene.site(facet.neighbor) - scene.site(i)).normalize();
            area += facet.area.abs();
        }
        let off = sum.length();
        let promise = CLOSURE * area + turned;
        if off <= promise + bounds.least_facet_rounding(i) {
            continue;
        }
        let missing: f64 = bounds.not_believed_facets(i).map(|(_, area)| area).sum();
        let bound = promise + bounds.facet_rounding(i) + missing;
        ensure!(off <= bound, "site {i}: Σ area·normal is {sum}, bound {bound:e}");
    }
    Ok(())
}

/// (Σ height · area + flux through the boundary) / 3 is the volume, the height that of the bisector over the site.
pub fn of_volumes(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    let boundary = output.boundary.as_deref().unwrap_or_default();
    for (i, row) in bounds.rows().iter().enumerate() {
        let (mut sum, mut moved) = (boundary[i].flux, 0.0);
        for facet in row {
            let j = facet.neighbor;
            let distance = scene.site(i).distance(scene.site(j));
            let shift = (scene.weight(i) - scene.weight(j)) / distance;
            sum += 0.5 * (distance + shift) * facet.area;
            moved += bounds.turn(i, j) * 0.5 * (distance + shift.abs()) * facet.area.abs();
        }
        let (closed, volume) = (sum / 3.0, output.volume[i]);
        let (off, promise) = ((closed - volume).abs(), CLOSURE * volume.abs() + moved / 3.0);
        if off <= promise + bounds.least_facet_rounding(i) * bounds.reach(i) {
            continue;
        }
        let missing = bounds.not_believed_facets(i).map(|(j, area)| {
            let height =
                scene.power_difference(scene.site(i), i, j).abs() / (2.0 * scene.site(i).distance(scene.site(j)));
            height * area / 3.0
        });
        let bound = promise + bounds.facet_rounding(i) * bounds.reach(i) + missing.sum::<f64>();
        ensure!(off <= bound, "site {i}: volume {volume:e}, by its facets {closed:e}: off by {off:e}, bound {bound:e}");
    }
    Ok(())
}
