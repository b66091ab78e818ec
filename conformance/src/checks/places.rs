//! Cells and facets are where the power distance says, and nobody is lost: laws that share nothing with clipping.

use glam::DVec3;
use laguerre_core::{Backend, CellStatus};

use crate::bounds::{Bounds, Planes};
use crate::checks::sums::has_negative_windings;
use crate::domains::Room;
use crate::scene::rows;
use crate::{Case, Scene, Verdict};

/// A power cell is convex, so the barycenter of what the container leaves of it is in it: no other site has less power there. (The mean of what
/// counts by winding numbers of both signs may be anywhere.)
pub fn cell_barycenters(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    if has_negative_windings(&scene.room, scene.len()) {
        return Ok(());
    }
    let output = scene.with_facets(backend)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    for i in (0..scene.len()).filter(|&i| output.status()[i] == CellStatus::Complete) {
        let place = DVec3::from(output.barycenter()[i]);
        let off = bounds.displacement(i) + bounds.cell_rounding(i) * bounds.reach(i) / output.volume()[i].abs();
        no_site_is_nearer(&scene, place, i, off)
            .map_err(|reason| format!("site {i}: its barycenter {place}, off by {off:e} at most, {reason}"))?;
    }
    Ok(())
}

/// The barycenter of a facet has equal power to its two sites, and, where no winding number is negative, no less to any other.
pub fn facet_barycenters(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let output = scene.with_facets(backend)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    let signed = has_negative_windings(&scene.room, scene.len());
    for (i, row) in rows(&output).iter().enumerate() {
        for facet in row {
            let (j, place) = (facet.neighbor, facet.barycenter);
            let off = bounds.displacement(i) + bounds.facet_rounding(i) * bounds.reach(i) / facet.area.abs();
            let height = scene.power_difference(place, i, j) / (2.0 * scene.site(i).distance(scene.site(j)));
            ensure!(height.abs() <= off, "facet {i}-{j}: its barycenter {place} is {height:e} beside its bisector");
            if signed {
                continue;
            }
            no_site_is_nearer(&scene, place, i, off)
                .map_err(|reason| format!("facet {i}-{j}: its barycenter {place}, off by {off:e} at most, {reason}"))?;
        }
    }
    Ok(())
}

/// The site with the least power at a point of the container has a cell.
pub fn random_points(backend: &dyn Backend, case: &Case) -> Verdict {
    /// Points tried in each case.
    const POINTS: usize = 30;
    let scene = case.scene();
    let output = scene.with_facets(backend)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    let twins = scene.twins();
    let (lo, _) = scene.room.bounding_box();
    let mut random = case.random(1);
    for _ in 0..POINTS {
        let place = DVec3::from(lo) + scene.room.extents() * random.point();
        if winding(&scene.room, place) < 0.5 {
            continue;
        }
        let owner =
            (1..scene.len()).fold(0, |best, i| if scene.power_difference(place, i, best) < 0.0 { i } else { best });
        let owned: f64 = (0..scene.len()).filter(|&i| twins[i] == twins[owner]).map(|i| output.volume()[i]).sum();
        // A volume below its rounding may be called empty; a point in such a cell is too rare to be drawn.
        ensure!(
            owned > 0.0 || tied(&scene, place, owner, &bounds),
            "{place} is in the cell of site {owner}, called empty"
        );
    }
    Ok(())
}

/// At `place`, which is known up to `off`, no site at another position has less power than `i`.
fn no_site_is_nearer(scene: &Scene, place: DVec3, i: usize, off: f64) -> Verdict {
    for k in (0..scene.len()).filter(|&k| k != i) {
        let distance = scene.site(i).distance(scene.site(k));
        let difference = scene.power_difference(place, i, k);
        // Where nothing is known of the place, `off` is infinite.
        ensure!(off.is_infinite() || difference <= 2.0 * distance * off, "has {difference:e} less power for site {k}");
    }
    Ok(())
}

/// Whether another position's site has as little power at `place` as its owner, to rounding.
fn tied(scene: &Scene, place: DVec3, owner: usize, bounds: &Bounds) -> bool {
    (0..scene.len()).any(|k| {
        let distance = scene.site(owner).distance(scene.site(k));
        distance > 0.0 && scene.power_difference(place, owner, k) >= -2.0 * distance * bounds.displacement(owner)
    })
}

/// The winding number of a room's surface about `place`, by solid angles (van Oosterom, Strackee 1983).
fn winding(room: &Room, place: DVec3) -> f64 {
    let mesh = room.mesh();
    let solid_angles = mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|v| (DVec3::from(mesh.vertices[v as usize]) - place).normalize());
        2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    });
    solid_angles.sum::<f64>() / (4.0 * std::f64::consts::PI)
}
