//! Whether two evaluations of a scene give the same answer, to rounding.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use laguerre_core::{Boundary, Facets, Output};

use crate::bounds::{Bounds, CLOSURE, FACET, FLAT, Planes};
use crate::scene::{Facet, rows};
use crate::{Scene, Verdict};

/// Holds `other` against `reference`, an output with facets, cell by cell: volume, barycenter, status, and where both have
/// them facets, boundary and second moments.
///
/// # Errors
/// The first cell that differs by more than its bound.
pub fn same(scene: &Scene, reference: &Output, other: &Output, planes: Planes) -> Verdict {
    let cells: Vec<usize> = (0..scene.len()).collect();
    same_cells(scene, reference, other, planes, &cells)
}

/// [`same`] for the given cells alone.
///
/// # Errors
/// The first cell that differs by more than its bound.
pub fn same_cells(scene: &Scene, reference: &Output, other: &Output, planes: Planes, cells: &[usize]) -> Verdict {
    same_within(&Bounds::new(scene, reference, planes), scene, reference, other, cells)
}

/// [`same_cells`], within the given bounds.
///
/// # Errors
/// The first cell that differs by more than its bound.
pub fn same_within(bounds: &Bounds<'_>, scene: &Scene, reference: &Output, other: &Output, cells: &[usize]) -> Verdict {
    let (rows, other_rows) = (rows(reference), rows(other));
    let has_facets = reference.facets().is_some() && other.facets().is_some();
    for &i in cells {
        same_moments(reference, other, i, bounds)?;
        // A cell that one of the two calls empty, while its volume is within its rounding.
        let empty = reference.status()[i] != other.status()[i];
        let nothing = if empty { bounds.facet_of_empty(i) } else { 0.0 };
        // (What rounding alone decides is looked for where two answers differ: it takes a look at all sites.)
        let pairs = if has_facets { pairs(&rows[i], &other_rows[i]) } else { BTreeMap::new() };
        for (&j, &[a, b]) in &pairs {
            let bound = bounds.area(i).max(bounds.area(j)).max(nothing);
            let verdict = same_facet(a, b, bound, scene.site(i), bounds.reach(i));
            if let Err(reason) = verdict
                && !undecided(scene, i, j, bounds)
            {
                return Err(format!("facet {i}-{j}: {reason}"));
            }
        }
        if let (Some(a), Some(b)) = (reference.boundary(), other.boundary()) {
            let bound = bounds.area(i).max(nothing) + CLOSURE * a[i].area;
            // (One that is called empty takes its boundary with it.)
            let missing = || if empty { scene.surface_in_cell(i) } else { 0.0 };
            let verdict = same_boundary(a[i], b[i], bound, bounds.reach(i), missing);
            if let Err(reason) = verdict
                && !pairs.keys().any(|&j| undecided(scene, i, j, bounds))
            {
                return Err(format!("site {i}: {reason}"));
            }
        }
        if let (Some(a), Some(b)) = (reference.second_moment(), other.second_moment()) {
            // About the site: where negative volumes cancel most of a cell, its barycenter is anywhere, and the rounding of the volume counts with the
            // square of its distance.
            let about_site = |output: &Output, moment: &[[f64; 6]]| {
                let away = DVec3::from(output.barycenter()[i]) - scene.site(i);
                let (d, v) = (if away.is_finite() { away } else { DVec3::ZERO }, output.volume()[i]);
                let shift = [d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.x * d.z, d.y * d.z];
                std::array::from_fn::<f64, 6, _>(|k| moment[i][k] + v * shift[k])
            };
            let (about, other_about) = (about_site(reference, a), about_site(other, b));
            let off = (0..6).map(|k| (about[k] - other_about[k]).abs()).fold(0.0, f64::max);
            let bound = bounds.first_moment(i) * bounds.reach(i);
            ensure!(off <= bound, "site {i}: second moments {:?} and {:?}, bound {bound:e}", a[i], b[i]);
        }
    }
    Ok(())
}

/// Whether the two outputs agree to the last bit.
///
/// # Errors
/// Which part differs.
pub fn identical(a: &Output, b: &Output) -> Verdict {
    let bits = |xs: &[f64]| xs.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let flat = |xs: &[[f64; 3]]| bits(xs.as_flattened());
    ensure!(a.status() == b.status(), "the statuses differ");
    ensure!(bits(a.volume()) == bits(b.volume()), "the volumes differ in bits");
    ensure!(flat(a.barycenter()) == flat(b.barycenter()), "the barycenters differ in bits");
    ensure!(a.second_moment() == b.second_moment(), "the second moments differ in bits");
    ensure!(a.facets() == b.facets(), "the facets differ in bits");
    ensure!(a.boundary() == b.boundary(), "the boundaries differ in bits");
    Ok(())
}

/// `output`, which was made of a scene moved by `x ↦ scale · turn · x + shift`, as it would be of the scene before.
pub fn moved_back(output: &Output, turn: DMat3, scale: f64, shift: DVec3) -> Output {
    let inverse = turn.transpose();
    let point = |x: [f64; 3]| <[f64; 3]>::from(inverse * ((DVec3::from(x) - shift) / scale));
    let mut back = output.clone().into_arrays();
    back.second_moment = None;
    back.volume.iter_mut().for_each(|v| *v /= scale.powi(3));
    back.barycenter.iter_mut().for_each(|b| *b = point(*b));
    back.facets = back.facets.map(|facets| {
        let mut facets = facets.into_arrays();
        facets.area.iter_mut().for_each(|a| *a /= scale * scale);
        facets.distance.iter_mut().for_each(|d| *d /= scale);
        facets.barycenter.iter_mut().for_each(|b| *b = point(*b));
        for b in &mut facets.boundary {
            b.area /= scale * scale;
            b.flux /= scale.powi(3);
            b.vector_area = (inverse * DVec3::from(b.vector_area) / (scale * scale)).into();
            b.barycenter = if b.area == 0.0 { [0.0; 3] } else { point(b.barycenter) };
        }
        Facets::new(facets).expect("rows of facets")
    });
    Output::new(back).expect("an output")
}

/// The facets of two rows side by side, by neighbour.
pub fn pairs(a: &[Facet], b: &[Facet]) -> BTreeMap<usize, [Option<Facet>; 2]> {
    let mut pairs: BTreeMap<usize, [Option<Facet>; 2]> = BTreeMap::new();
    for (side, row) in [a, b].into_iter().enumerate() {
        for facet in row {
            pairs.entry(facet.neighbor).or_default()[side] = Some(*facet);
        }
    }
    pairs
}

/// Holds two views of a facet against each other, one absent where its area was below its bound: areas within `bound`,
/// first moments about `site` within `bound · reach`. (Moments, not barycenters: where negative areas cancel most of a facet, its barycenter is
/// the quotient of what is left, anywhere, and the two areas' difference counts with its distance.)
///
/// # Errors
/// How they differ.
pub fn same_facet(a: Option<Facet>, b: Option<Facet>, bound: f64, site: DVec3, reach: f64) -> Verdict {
    let area = |facet: Option<Facet>| facet.map_or(0.0, |f| f.area);
    let (x, y) = (area(a), area(b));
    ensure!((x - y).abs() <= bound, "areas {x:e} and {y:e} differ by {:e}, bound {bound:e}", (x - y).abs());
    if let (Some(a), Some(b)) = (a, b) {
        let [p, q] = [a, b].map(|facet| facet.barycenter);
        let moment = (x * (p - site)).distance(y * (q - site));
        let bound = bound * reach;
        ensure!(
            moment <= bound,
            "barycenters {p} and {q} of areas {x:e} and {y:e}: off by {moment:e}, bound {bound:e}"
        );
        let off = (a.distance - b.distance).abs();
        ensure!(off <= FACET * reach, "distances {} and {}", a.distance, b.distance);
    }
    Ok(())
}

/// Holds two views of a cell's boundary against each other: areas and vector areas within `bound`, and where they are not, with what may be `missing`; first
/// moments and fluxes within that times `reach`.
fn same_boundary(a: Boundary, b: Boundary, bound: f64, reach: f64, missing: impl FnOnce() -> f64) -> Verdict {
    let vector = DVec3::from(a.vector_area).distance(DVec3::from(b.vector_area));
    let moment = a.area.min(b.area) * DVec3::from(a.barycenter).distance(DVec3::from(b.barycenter));
    let off = (a.area - b.area).abs().max(vector);
    let bound = if off > bound { bound + missing() } else { bound };
    ensure!(off <= bound, "boundary {a:?} and {b:?} differ by more than {bound:e}");
    let (off, bound) = (moment.max((a.flux - b.flux).abs()), bound * reach);
    ensure!(off <= bound, "boundary {a:?} and {b:?} differ by more than {bound:e} in moment or flux");
    Ok(())
}

/// Whether nothing but rounding, or the order in which planes are taken, decides what the facet of sites `i` and `j` is. Its
/// bisector contains a triangle of the surface: then it is facet or boundary, of one cell or of the other. Or it is also
/// the bisector of a third site, whose cell is flat: then any two of the three may have the facet.
pub fn undecided(scene: &Scene, i: usize, j: usize, bounds: &Bounds) -> bool {
    lies_in_surface(scene, i, j, bounds)
        || has_flat_cell_between(scene, i, j, bounds)
        || has_flat_cell_between(scene, j, i, bounds)
}

/// Whether the bisector of sites `i` and `j` contains a triangle of the surface, to rounding.
pub fn lies_in_surface(scene: &Scene, i: usize, j: usize, bounds: &Bounds) -> bool {
    let mesh = scene.room.mesh();
    let distance = scene.site(i).distance(scene.site(j));
    let rounding = 2.0 * distance * bounds.displacement(i).max(bounds.displacement(j));
    let on = |v: u32| scene.power_difference(DVec3::from(mesh.vertices[v as usize]), i, j).abs() <= rounding;
    distance > 0.0 && mesh.triangles.iter().any(|t| t.iter().all(|&v| on(v)))
}

/// Whether some third site's bisector with `i` is that of `j`, to rounding, all over the container.
fn has_flat_cell_between(scene: &Scene, i: usize, j: usize, bounds: &Bounds) -> bool {
    let (lo, hi) = scene.room.bounding_box();
    let corners: [DVec3; 8] = std::array::from_fn(|c| {
        DVec3::from_array(std::array::from_fn(|k| if c >> k & 1 == 1 { hi[k] } else { lo[k] }))
    });
    let height = |x: DVec3, j: usize| scene.power_difference(x, i, j) / (2.0 * scene.site(i).distance(scene.site(j)));
    let heights = corners.map(|x| height(x, j));
    (0..scene.len()).any(|k| {
        let rounding = FLAT * [i, j, k].map(|s| bounds.displacement(s)).into_iter().fold(0.0, f64::max);
        let known = [i, j].iter().any(|&s| scene.positions[s] == scene.positions[k]);
        !known && corners.iter().zip(heights).all(|(&x, h)| (height(x, k) - h).abs() <= rounding)
    })
}

fn same_moments(reference: &Output, other: &Output, i: usize, bounds: &Bounds) -> Verdict {
    let (a, b, bound) = (reference.volume()[i], other.volume()[i], bounds.volume(i));
    let off = (a - b).abs();
    ensure!(off <= bound, "site {i}: volumes {a:e} and {b:e} differ by {off:e}, bound {bound:e}");
    let (s, t) = (reference.status()[i], other.status()[i]);
    ensure!(s == t || a.abs().max(b.abs()) <= bound, "site {i}: statuses {s:?} and {t:?}, volumes {a:e} and {b:e}");
    if a != 0.0 && b != 0.0 {
        let [p, q] = [reference, other].map(|output| DVec3::from(output.barycenter()[i]));
        let (moment, bound) = (a.abs().min(b.abs()) * p.distance(q), bounds.first_moment(i));
        ensure!(moment <= bound, "site {i}: barycenters {p} and {q} of volume {a:e}, bound {bound:e}");
    }
    Ok(())
}
