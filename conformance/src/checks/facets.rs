//! Facets seen from their two sides.

use laguerre_core::{Backend, CellStatus, Output, Request};

use crate::bounds::Bounds;
use crate::checks::sums::has_negative_windings;
use crate::compare::{same_facet, undecided};
use crate::domains::Room;
use crate::sites::Random;
use crate::{Case, Scene, Verdict, compare, sanity};

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

/// [`have_a_laplacian`] on a case.
pub fn laplacian(backend: &dyn Backend, case: &Case) -> Verdict {
    have_a_laplacian(&case.scene(), backend)
}

/// The Laplacian of a lattice whose sites are off by a few roundings: some of its smallest facets only one of their cells has.
pub fn laplacian_where_one_side_sees(backend: &dyn Backend) -> Verdict {
    let side = 6;
    let mut random = Random::new(1);
    let mut at = |k: usize| (k as f64 + 0.5) / side as f64 + (random.unit() - 0.5) * 2.0_f64.powi(-50);
    let positions = (0..side * side * side).map(|n| [at(n % side), at(n / side % side), at(n / side / side)]).collect();
    let room = Room::Box([0.0; 3], [1.0; 3]);
    let scene = Scene { positions, weights: vec![0.0; side.pow(3)], room };
    let output = scene.with_facets(backend)?;
    let facets = output.facets().ok_or("no facets")?;
    let lone = |i: usize| facets.of(i).filter(|facet| facets.between(facet.neighbor, i).is_none()).count();
    let lone: usize = (0..scene.len()).map(lone).sum();
    ensure!(lone > 20, "{lone} facets are seen from one side alone");
    have_a_laplacian(&scene, backend)
}

/// Roundings of an entry of the Laplacian, however it is made.
const ROUNDINGS: f64 = 16.0;

/// The Laplacian, asked for with volumes alone, or with second moments, is what the facets' areas and distances come to, and symmetric to the last bit; where facets are
/// asked for, too, it is the same. All else is as with facets.
pub fn have_a_laplacian(scene: &Scene, backend: &dyn Backend) -> Verdict {
    let with_facets = scene.with_facets(backend)?;
    let facets = with_facets.facets().ok_or("no facets")?;
    let n = scene.len();
    let requests = [Request::moments(), Request::moments().with_second_moments(), Request::moments().with_facets()];
    for request in requests {
        let output = scene.evaluate(backend, &request.clone().with_laplacian())?;
        let made = output.laplacian().ok_or("no Laplacian")?;
        let mut all = output.clone();
        ensure!(all.take_laplacian().is_some() && all.laplacian().is_none(), "it cannot be taken out");
        match request.facets() {
            true => compare::identical(&with_facets, &all)?,
            false => {
                let mut like = scene.evaluate(backend, &request.clone().with_facets())?;
                like.take_facets();
                compare::identical(&like, &all)?;
            }
        }
        let mut place = vec![n; n];
        for (row, &i) in made.order().iter().enumerate() {
            ensure!(std::mem::replace(&mut place[i as usize], row) == n, "site {i} stands twice in the order");
        }
        for (row, &i) in made.order().iter().enumerate() {
            let i = i as usize;
            let columns = &made.columns()[made.row(row)];
            ensure!(columns.is_sorted_by(|a, b| a < b), "row {row} is not sorted");
            for k in made.row(row) {
                let (column, value) = (made.columns()[k] as usize, made.values()[k]);
                let there = made.row(column);
                let back = made.columns()[there.clone()].binary_search(&(row as u32)).map(|back| there.start + back);
                ensure!(
                    back.is_ok_and(|back| made.values()[back].to_bits() == value.to_bits()),
                    "rows {row} and {column} differ"
                );
                let j = made.order()[column] as usize;
                let both = facets.between(i, j).zip(facets.between(j, i));
                let (k, back) = both.ok_or_else(|| format!("cells {i} and {j} do not share a facet"))?;
                let (here, there) = (facets.get(k), facets.get(back));
                let right = (here.area + there.area) / 2.0 / here.distance;
                let size = (here.area.abs() + there.area.abs()) / here.distance;
                ensure!(
                    (value - right).abs() <= ROUNDINGS * f64::EPSILON * size,
                    "entry {i}, {j}: {value:e} is not {right:e}"
                );
            }
        }
        let shared = |i: usize| facets.of(i).filter(|facet| facets.between(facet.neighbor, i).is_some()).count();
        for (i, &row) in place.iter().enumerate() {
            let entries = if row == n { 0 } else { made.row(row).len() };
            ensure!(entries == shared(i), "cell {i} has {entries} entries for {} facets", shared(i));
        }
    }
    Ok(())
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
