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
    let boundary = output.boundary().unwrap_or_default();
    (0..scene.len()).try_for_each(|i| {
        closes(bounds, i, 1.0, |facets| {
            let mut sum = DVec3::from(boundary[i].vector_area);
            let (mut area, mut turned) = (boundary[i].area, 0.0);
            for &(j, facet) in facets {
                // The difference of two unit vectors is at most 2.
                turned += facet.abs() * bounds.turn(i, j).min(2.0);
                sum += facet * (scene.site(j) - scene.site(i)).normalize();
                area += facet.abs();
            }
            (sum.length(), CLOSURE * area + turned)
        })
        .map_err(|reason| format!("site {i}: Σ area·normal is not 0: {reason}"))
    })
}

/// (Σ height · area + flux through the boundary) / 3 is the volume, the height that of the bisector over the site.
pub fn of_volumes(scene: &Scene, output: &Output, bounds: &Bounds) -> Verdict {
    let boundary = output.boundary().unwrap_or_default();
    (0..scene.len()).try_for_each(|i| {
        let volume = output.volume()[i];
        closes(bounds, i, bounds.reach(i), |facets| {
            let (mut sum, mut moved) = (boundary[i].flux, 0.0);
            for &(j, area) in facets {
                let distance = scene.site(i).distance(scene.site(j));
                let shift = (scene.weight(i) - scene.weight(j)) / distance;
                sum += 0.5 * (distance + shift) * area;
                moved += bounds.turn(i, j) * 0.5 * (distance + shift.abs()) * area.abs();
            }
            ((sum / 3.0 - volume).abs(), CLOSURE * volume.abs() + moved / 3.0)
        })
        .map_err(|reason| format!("site {i}: volume {volume:e} is not that by its facets: {reason}"))
    })
}

/// Holds cell `i` to a law of its facets: `miss` says by how much they, each the other site and the area, miss it, and what is promised. The
/// roundings of areas count times `length`. A row that misses it must fulfil it together with the facets that it may leave out
/// ([`Bounds::unseen_facets`]): they count as facets, and nothing more is allowed.
fn closes(bounds: &Bounds, i: usize, length: f64, miss: impl Fn(&[(usize, f64)]) -> (f64, f64)) -> Verdict {
    let mut facets: Vec<(usize, f64)> = bounds.rows()[i].iter().map(|f| (f.neighbor, f.area)).collect();
    let (off, promise) = miss(&facets);
    if off <= promise + bounds.least_facet_rounding(i) * length {
        return Ok(());
    }
    let rounding = bounds.facet_rounding(i) * length;
    if off <= promise + rounding {
        return Ok(());
    }
    facets.extend(bounds.unseen_facets(i));
    let (off, promise) = miss(&facets);
    let bound = promise + rounding;
    ensure!(off <= bound, "off by {off:e}, bound {bound:e}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use laguerre_core::Facets;
    use laguerre_core::oracle::Naive;

    use super::*;
    use crate::bounds::Planes;
    use crate::domains::{Pose, Shape, room};
    use crate::regressions::SCENES;

    /// Drops facets `i`-`j` and `j`-`i`.
    fn drop_facet(output: &mut Output, i: usize, j: usize) {
        let mut facets = output.facets().cloned().expect("facets");
        for (i, j) in [(i, j), (j, i)] {
            let Some(at) = facets.between(i, j) else { continue };
            let mut arrays = facets.into_arrays();
            arrays.neighbor.remove(at);
            arrays.area.remove(at);
            arrays.barycenter.remove(at);
            arrays.distance.remove(at);
            arrays.offsets[i + 1..].iter_mut().for_each(|offset| *offset -= 1);
            facets = Facets::new(arrays).expect("rows of facets");
        }
        let mut arrays = output.clone().into_arrays();
        arrays.facets = Some(facets);
        *output = Output::new(arrays).expect("an output");
    }

    /// Whether the facets of `scene` close; whether they do without facet `i`-`j`; and whether a facet of its area, negated, may be missing.
    fn with_and_without(scene: &Scene, i: usize, j: usize) -> [bool; 3] {
        let mut output = scene.with_facets(&Naive::default()).expect("an output");
        let with = of_areas(scene, &output, &Bounds::new(scene, &output, Planes::Same)).is_ok();
        drop_facet(&mut output, i, j);
        let (bounds, area) = (Bounds::new(scene, &output, Planes::Same), scene.facet_area(i, j).abs());
        let rounding = CLOSURE * scene.room.area() + bounds.facet_rounding(i);
        assert!(area > 2.0 * rounding, "nothing to see: {area:e}, {rounding:e}");
        [with, of_areas(scene, &output, &bounds).is_ok(), area <= bounds.not_believed(i)]
    }

    /// A negative facet may be missing on both sides up to the area that may be not believed, and no farther.
    #[test]
    fn negative_facet_that_is_believed_is_missed() {
        let name = "negative_facet_of_an_empty_cell_is_not_believed";
        let (_, given) = SCENES.iter().find(|(of, _)| *of == name).expect("a regression of this name");
        // The farther the folds are off their planes, the larger is the facet.
        for (powers, may_be_missing) in [(6, true), (5, false)] {
            let scene = Scene { room: room(Shape::FoldedStar(powers), Pose::Plain), ..given.scene() };
            assert!(scene.facet_area(2, 3) < 0.0, "{powers}");
            assert_eq!(with_and_without(&scene, 2, 3), [true, may_be_missing, may_be_missing], "{powers}");
        }
    }

    /// A positive facet beyond its cell's rounding may be missing nowhere, however small: the one here cuts off a corner of the cube.
    #[test]
    fn positive_facet_is_missed() {
        let depth = 4e-6;
        let scene = Scene {
            positions: vec![[1.0; 3], [0.0; 3]],
            weights: vec![3.0 - 12.0_f64.sqrt() * depth, 0.0],
            room: room(Shape::Box, Pose::Plain),
        };
        let area = 6.75_f64.sqrt() * depth * depth;
        assert!((scene.facet_area(0, 1) / area - 1.0).abs() < 1e-9, "{:e}, not {area:e}", scene.facet_area(0, 1));
        assert_eq!(with_and_without(&scene, 0, 1), [true, false, true]);
    }

    /// Of many positive facets each may be missing that is within the cell's rounding, and none beyond.
    #[test]
    fn positive_facet_among_many_is_missed() {
        let name = "facets_within_their_rounding_at_a_tip";
        let (_, given) = SCENES.iter().find(|(of, _)| *of == name).expect("a regression of this name");
        let (scene, i) = (given.scene(), 49);
        let output = scene.with_facets(&Naive::default()).expect("an output");
        let bounds = Bounds::new(&scene, &output, Planes::Same);
        let (mut sum, mut count) = (DVec3::ZERO, 0);
        for (j, area) in bounds.unseen_facets(i) {
            (sum, count) = (sum + area * (scene.site(j) - scene.site(i)).normalize(), count + 1);
        }
        assert!(count > 20 && sum.length() > 1.5 * bounds.facet_rounding(i), "nothing to see: {count}, {sum}");
        // One facet of the row has some thirty times that sum.
        assert_eq!(with_and_without(&scene, i, 48), [true, false, true]);
    }
}
