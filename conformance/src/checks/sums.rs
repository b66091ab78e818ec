//! The cells partition their container: their integrals sum to its.

use std::cell::LazyCell;
use std::collections::HashMap;

use glam::DVec3;
use laguerre_core::shapes::{Mesh, cuboid};
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, CellStatus, Output, Request};

use crate::bounds::{Bounds, CLOSURE, Planes, ROUNDINGS, U};
use crate::compare::lies_in_surface;
use crate::domains::{Pose, Room};
use crate::moments::{ENTRIES, Moments};
use crate::sites::Random;
use crate::{Case, Scene, Verdict, sanity};

/// [`volumes`] on a case.
pub fn volume(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, volumes)
}

/// [`first_moments`] on a case.
pub fn first_moment(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, first_moments)
}

/// [`barycenters`] on a case.
pub fn barycenter(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, barycenters)
}

/// [`second_moments`] on a case.
pub fn second_moment(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, second_moments)
}

/// [`boundary_areas`] on a case.
pub fn boundary_area(backend: &dyn Backend, case: &Case) -> Verdict {
    sanity::hold(backend, case, boundary_areas)
}

/// Volumes are not negative where no winding number is, and sum to the container's; where one may be, what is negative and below its rounding
/// may be missing in cells that are called empty.
pub fn volumes(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    let mut sum = Sum::default();
    let signed = has_negative_windings(&scene.room, scene.len());
    for (i, &v) in output.volume().iter().enumerate() {
        ensure!(signed || v >= 0.0, "site {i} has volume {v:e}");
        sum.add(v);
    }
    let (total, volume) = (sum.total(), scene.room.volume());
    let off = (total - volume).abs();
    let mut bound = bounds.volume_sum();
    if total > volume && off > bound && signed {
        bound += bounds.volume_of_empty();
    }
    ensure!(off <= bound, "the volumes sum to {total}, not {volume}: off by {off:e}, bound {bound:e}");
    Ok(())
}

/// Volumes times barycenters sum to the container's, with what cells that are called empty take with them where signs cancel.
pub fn first_moments(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    let middle = DVec3::from(scene.room.barycenter());
    let mut sums = [Sum::default(); 3];
    for (&v, &b) in output.volume().iter().zip(output.barycenter()).filter(|(v, _)| **v != 0.0) {
        let moment = v * (DVec3::from(b) - middle);
        (0..3).for_each(|k| sums[k].add(moment[k]));
    }
    let sum = DVec3::from_array(sums.map(|s| s.total()));
    let off = |empty: &Moments| (sum + empty.first()).length();
    let (off, bound) = with_empty(scene, bounds, middle, 1, off);
    ensure!(off <= bound, "Σ v (b − B) is {off:e}, bound {bound:e}");
    Ok(())
}

/// Where no winding number is negative, a barycenter is the mean of points of the container: within its bounding box. A cell
/// that is so small that rounding could take its barycenter farther away than the container is large is nothing, and to be empty.
pub fn barycenters(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    if has_negative_windings(&scene.room, scene.len()) {
        return Ok(());
    }
    let (lo, hi) = scene.room.bounding_box();
    let (lo, hi) = (DVec3::from(lo), DVec3::from(hi));
    for i in (0..scene.len()).filter(|&i| output.status()[i] != CellStatus::Empty) {
        let place = DVec3::from(output.barycenter()[i]);
        let off = (lo - place).max(place - hi).max_element();
        let rounding = bounds.cell_rounding(i) * bounds.reach(i) / output.volume()[i];
        let bound = bounds.displacement(i) + rounding.min(bounds.reach(i));
        ensure!(
            off <= bound,
            "site {i}: barycenter {place} is {off:e} outside of the container's box, bound {bound:e}"
        );
    }
    Ok(())
}

/// Second moments, moved to a common point, sum to the container's, with what cells that are called empty take with them where signs cancel.
pub fn second_moments(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    let middle = DVec3::from(scene.room.barycenter());
    let moments = output.second_moment().unwrap_or_default();
    let bound = moment_bound(scene, bounds, middle, 2);
    let far = LazyCell::new(|| bounds.far_from_sites(middle, 2));
    let signed = has_negative_windings(&scene.room, scene.len());
    let mut sums = [Sum::default(); 6];
    for (i, moment) in moments.iter().enumerate().filter(|(i, _)| output.volume()[*i] != 0.0) {
        let arm = DVec3::from(output.barycenter()[i]) - middle;
        for (k, [r, c]) in ENTRIES.into_iter().enumerate() {
            sums[k].add(moment[k]);
            sums[k].add(output.volume()[i] * arm[r] * arm[c]);
        }
        // A moment about one's own barycenter: the variance along every axis is that of a measure, where no winding number is negative.
        let least = moment[..3].iter().copied().fold(0.0, f64::min);
        ensure!(signed || least >= -bound || least >= -(bound + *far), "site {i}: second moment {moment:?}");
    }
    let expected = scene.moments(middle, None).second();
    let off = |empty: &Moments| {
        let off = |k: usize| (sums[k].total() + empty.second()[k] - expected[k]).abs();
        (0..6).map(off).fold(0.0, f64::max)
    };
    let (off, bound) = with_empty(scene, bounds, middle, 2, off);
    ensure!(off <= bound, "second moments sum to {:?}, not {expected:?}: bound {bound:e}", sums.map(|s| s.total()));
    Ok(())
}

/// The cells' pieces of the boundary have together the area of the surface; no more is missing than lies in cells that are called empty.
pub fn boundary_areas(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    let mut sum = Sum::default();
    sum.extend(output.boundary().into_iter().flatten().map(|b| b.area));
    let (total, area) = (sum.total(), scene.room.area());
    let off = (total - area).abs();
    let in_surface = |i: usize, j: usize| lies_in_surface(scene, i, j, bounds);
    // In the surface, areas count as facets of some cells or as boundary of others: the law does not say.
    if off <= CLOSURE * area || (0..scene.len()).any(|i| (0..i).any(|j| in_surface(i, j))) {
        return Ok(());
    }
    let mut bound = bounds.area_sum();
    if total < area && off > bound {
        bound += bounds.area_of_empty();
    }
    ensure!(off <= bound, "the boundaries' areas sum to {total}, not {area}: off by {off:e}, bound {bound:e}");
    Ok(())
}

/// Plates, and tetrahedra that are slivers, as thin as a billionth of their width: the law of sums is one of their surface then.
pub fn thin(backend: &dyn Backend) -> Verdict {
    for thickness in [1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9] {
        let sliver = Mesh {
            vertices: vec![[0.0; 3], [1.0, 1.0, 0.0], [1.0, 0.0, thickness], [0.0, 1.0, thickness]],
            triangles: vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        };
        for (name, mesh) in [("plate", cuboid([0.0; 3], [2.0, 2.0, thickness])), ("sliver", sliver)] {
            for (pose, count) in
                [(Pose::Plain, 1), (Pose::Plain, 300), (Pose::Plain, 3000), (Pose::Turned, 300), (Pose::Turned, 3000)]
            {
                let (turn, shift) = pose.motion();
                let room = Room::of(if pose == Pose::Plain { mesh.clone() } else { mesh.transformed(turn, shift) });
                let (lo, hi) = room.bounding_box();
                let mut random = Random::new(11);
                let place = |_| (DVec3::from(lo) + random.point() * (DVec3::from(hi) - DVec3::from(lo))).into();
                let positions = (0..count).map(place).collect();
                let scene = Scene { positions, weights: Vec::new(), room };
                let output = scene.evaluate(backend, &Request::moments())?;
                let mut sum = Sum::default();
                sum.extend(output.volume().iter().copied());
                let (volume, bounds) = (scene.room.volume(), Bounds::new(&scene, &output, Planes::Same));
                let (off, bound) = ((sum.total() - volume).abs(), bounds.volume_sum());
                if std::env::var_os("LAGUERRE_WORST").is_some() {
                    eprintln!(
                        "worst {:.1e} {name} {thickness:e} {pose:?} {count}: {:.1e} of the volume",
                        off / bound,
                        off / volume
                    );
                }
                ensure!(
                    off <= bound,
                    "{name} of {thickness:e}, {pose:?}, {count} sites: off by {off:e}, bound {bound:e}"
                );
            }
        }
    }
    Ok(())
}

/// Bound of a sum of moments of the given order about `middle` (length³⁺ᵒʳᵈᵉʳ): that of volumes times the diagonal to the
/// order. Barycenters are coordinates besides: rounded to u times their distance from the origin.
fn moment_bound(scene: &Scene, bounds: &Bounds, middle: DVec3, order: i32) -> f64 {
    let arm = scene.room.extents().length();
    let coordinates = ROUNDINGS * U * middle.length() * scene.room.volume() * arm.powi(order - 1);
    bounds.volume_sum() * arm.powi(order) + coordinates
}

/// How far a sum of moments of the given order about `middle` is off, and its bound (length³⁺ᵒʳᵈᵉʳ), which where it does not hold is also what is
/// lost of cells far from their sites ([`Bounds::far_from_sites`]); `off` is told what cells that are called empty have of the moments. That is 0
/// where no sign can cancel, and where the bound holds without; else it is [`of_empty`], to the rounding of those cells.
fn with_empty(scene: &Scene, bounds: &Bounds, middle: DVec3, order: i32, off: impl Fn(&Moments) -> f64) -> (f64, f64) {
    let (without, near) = (off(&Moments::default()), moment_bound(scene, bounds, middle, order));
    if without <= near {
        return (without, near);
    }
    let bound = near + bounds.far_from_sites(middle, order);
    if without <= bound || !has_negative_windings(&scene.room, scene.len()) {
        return (without, bound);
    }
    let rounding = bounds.volume_of_empty() * scene.room.extents().length().powi(order);
    (off(&of_empty(scene, bounds, middle)), bound + rounding)
}

/// What cells that are called empty have of the room's moments about `middle`. A volume below its rounding bounds no moment: slabs of opposite
/// sign and of one volume each have that volume times their distance, which is up to the cell's extent, and there is no barycenter that a cell
/// without a volume could say it by. A cell of a volume above its rounding is not to be called empty, and has no part in this.
fn of_empty(scene: &Scene, bounds: &Bounds, middle: DVec3) -> Moments {
    let mut sums = Moments::default();
    for i in bounds.empty_with_surface() {
        let cell = scene.moments(middle, Some(i));
        if cell.volume().abs() <= bounds.cell_rounding(i) {
            sums.merge(&cell);
        }
    }
    sums
}

/// Whether the surface may go around some point the wrong way: as far as the corners of the domain's grid tell, or where it folds over itself.
pub(super) fn has_negative_windings(room: &Room, sites: usize) -> bool {
    let Room::Mesh(mesh, domain) = room else { return false };
    let grid = domain.grid(sites);
    let [nx, ny, nz] = grid.dims();
    folds(mesh) || (0..nz).any(|k| (0..ny).any(|j| (0..nx).any(|i| grid.winding([i, j, k]) < 0)))
}

/// Cosine of the angle of two triangles' normals below which they lie nearly on each other.
const FOLDED: f64 = -0.999;

/// Whether two triangles at an edge lie nearly on each other.
fn folds(mesh: &Mesh) -> bool {
    let mut normals: HashMap<[u32; 2], Vec<DVec3>> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        let [x, y, z] = [a, b, c].map(|v| DVec3::from(mesh.vertices[v as usize]));
        let normal = (y - x).cross(z - x).normalize_or_zero();
        for [v, w] in [[a, b], [b, c], [c, a]] {
            normals.entry([v.min(w), v.max(w)]).or_default().push(normal);
        }
    }
    normals.values().any(|at| at.iter().any(|n| at.iter().any(|m| n.dot(*m) < FOLDED)))
}

#[cfg(test)]
mod tests {
    use laguerre_core::Facets;
    use laguerre_core::oracle::Naive;
    use laguerre_core::shapes::icosphere;

    use super::*;
    use crate::domains::{self, Shape};
    use crate::regressions::SCENES;

    /// Where cells are called empty the law of boundaries allows what is theirs, and nothing of another cell's.
    /// Which cells are depends on the bounds on their volumes, so all regressions are asked.
    #[test]
    fn boundary_of_a_cell_that_is_not_empty_is_missed() {
        let mut seen = 0;
        for (name, given) in SCENES {
            let scene = given.scene();
            let output = scene.with_facets(&Naive::default()).expect("an output");
            let bounds = Bounds::new(&scene, &output, Planes::Same);
            let hidden = bounds.area_of_empty();
            if hidden <= 10.0 * bounds.area_sum() {
                continue;
            }
            seen += 1;
            assert_eq!(boundary_areas(&scene, &output, &bounds), Ok(()), "{name}");
            // As much again, of a cell that is there.
            let lost = 2.0 * hidden + 2.0 * bounds.area_sum();
            let mut arrays = output.into_arrays();
            let mut facets = arrays.facets.take().expect("facets").into_arrays();
            let largest = facets.boundary.iter_mut().max_by(|x, y| x.area.total_cmp(&y.area)).expect("a cell");
            largest.area -= lost;
            arrays.facets = Some(Facets::new(facets).expect("facets"));
            let output = Output::new(arrays).expect("an output");
            let bounds = Bounds::new(&scene, &output, Planes::Same);
            assert!(boundary_areas(&scene, &output, &bounds).is_err(), "{name}");
        }
        assert!(seen >= 2, "of all regressions {seen} have a boundary of empty cells to see");
    }

    /// The output of a cell that has a moment without a volume.
    fn slabs_that_cancel() -> (Scene, Output) {
        let name = "moment_of_an_empty_cell_of_both_signs";
        let (_, given) = SCENES.iter().find(|(of, _)| *of == name).expect("a regression of this name");
        let scene = given.scene();
        let output = scene.evaluate(&Naive::default(), &Request::moments()).expect("an output");
        (scene, output)
    }

    /// Where slabs cancel the law of first moments takes what is an empty cell's, and nothing else is missing or too much.
    #[test]
    fn moment_of_a_cell_that_is_not_empty_is_missed() {
        let (scene, output) = slabs_that_cancel();
        let bounds = Bounds::new(&scene, &output, Planes::Same);
        let middle = DVec3::from(scene.room.barycenter());
        let lost = of_empty(&scene, &bounds, middle).first();
        let (_, bound) = with_empty(&scene, &bounds, middle, 1, |_| f64::INFINITY);
        assert!(lost.length() > bound, "nothing to see: {lost}, bound {bound:e}");
        assert_eq!(first_moments(&scene, &output, &bounds), Ok(()));
        // A barycenter that is off by as much as the bound twice, along that moment or against it.
        let moved = |moment: DVec3| {
            let mut arrays = output.clone().into_arrays();
            let largest =
                (0..scene.len()).max_by(|&i, &j| output.volume()[i].total_cmp(&output.volume()[j])).expect("a cell");
            let to = DVec3::from(output.barycenter()[largest]) + moment / output.volume()[largest];
            arrays.barycenter[largest] = to.into();
            let output = Output::new(arrays).expect("an output");
            first_moments(&scene, &output, &Bounds::new(&scene, &output, Planes::Same))
        };
        let by = 2.0 * bound * lost.normalize();
        assert_eq!(moved(0.1 * by), Ok(()));
        assert!(moved(by).is_err() && moved(-by).is_err());
    }

    /// A cell of a volume is no empty cell, whatever it is called.
    #[test]
    fn cell_that_is_dropped_is_missed() {
        let (scene, output) = slabs_that_cancel();
        for i in (0..scene.len()).filter(|&i| output.status()[i] != CellStatus::Empty) {
            let mut arrays = output.clone().into_arrays();
            (arrays.status[i], arrays.volume[i], arrays.barycenter[i]) = (CellStatus::Empty, 0.0, [f64::NAN; 3]);
            let output = Output::new(arrays).expect("an output");
            let bounds = Bounds::new(&scene, &output, Planes::Same);
            assert!(volumes(&scene, &output, &bounds).is_err(), "volume of cell {i}");
            assert!(first_moments(&scene, &output, &bounds).is_err(), "moment of cell {i}");
        }
    }

    /// One site, and some that are near to each other, `away` extents from the middle of a room.
    fn far_away(room: &Room, away: f64, count: usize, random: &mut Random) -> Scene {
        let width = room.extents().max_element();
        let middle = DVec3::from(room.barycenter()) + width * away * random.direction();
        let positions = (0..count).map(|_| (middle + width * (random.point() - 0.5)).into()).collect();
        Scene { positions, weights: Vec::new(), room: room.clone() }
    }

    /// Wherever sites are, moments are the container's to the roundings that moments about the sites have, and no more than that is allowed.
    #[test]
    fn moments_of_sites_far_away() {
        let mut random = Random::new(17);
        let rooms = Shape::ALL.into_iter().flat_map(|shape| Pose::ALL.map(|pose| domains::room(shape, pose)));
        for room in rooms.chain([Room::of(icosphere(4))]) {
            for (away, count) in [(1.0, 1), (3.0, 1), (10.0, 1), (10.0, 20), (100.0, 1), (100.0, 20), (900.0, 1)] {
                let scene = far_away(&room, away, count, &mut random);
                let output =
                    scene.evaluate(&Naive::default(), &Request::moments().with_second_moments()).expect("an output");
                let bounds = Bounds::new(&scene, &output, Planes::Same);
                assert_eq!(first_moments(&scene, &output, &bounds), Ok(()), "{away} extents, {count} sites");
                assert_eq!(second_moments(&scene, &output, &bounds), Ok(()), "{away} extents, {count} sites");
                // As much again, twice: one of the entries beside the diagonal.
                let middle = DVec3::from(room.barycenter());
                let bound = moment_bound(&scene, &bounds, middle, 2) + bounds.far_from_sites(middle, 2);
                let mut arrays = output.clone().into_arrays();
                let present = (0..count).find(|&i| output.volume()[i] != 0.0).expect("a cell");
                arrays.second_moment.as_mut().expect("second moments")[present][3] += 2.0 * bound;
                let output = Output::new(arrays).expect("an output");
                assert!(has_negative_windings(&room, count) || second_moments(&scene, &output, &bounds).is_err());
            }
        }
    }
}
