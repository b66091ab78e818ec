//! Second moments of facets.

use glam::{DMat3, DVec3};
use laguerre_core::oracle::Naive;
use laguerre_core::{Backend, CellStatus, Output, Request};

use crate::bounds::{Bounds, CLOSURE, Planes};
use crate::compare::undecided;
use crate::domains::Room;
use crate::{Case, Scene, Verdict};

/// Seen from its two sides a facet has the same second moment.
pub fn mutual(backend: &dyn Backend, case: &Case) -> Verdict {
    let (scene, output) = evaluated(backend, case)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    let rows = rows(&output)?;
    for (i, row) in rows.iter().enumerate() {
        for &(j, moment) in row {
            let Some(&(_, back)) = rows[j].iter().find(|(k, _)| *k == i) else { continue };
            let reach = bounds.reach(i).max(bounds.reach(j));
            let bound = bounds.area(i).max(bounds.area(j)) * reach * reach;
            if let Err(reason) = same(moment, back, bound)
                && !undecided(&scene, i, j, &bounds)
            {
                return Err(format!("facets {i}-{j} and {j}-{i}: {reason}"));
            }
        }
    }
    Ok(())
}

/// Every facet's second moment is the naive oracle's.
pub fn like_the_oracle(backend: &dyn Backend, case: &Case) -> Verdict {
    let (scene, output) = evaluated(backend, case)?;
    let naive = scene.evaluate(&Naive::default(), &Request::moments().with_facet_second_moments())?;
    let bounds = Bounds::new(&scene, &naive, Planes::Same);
    let (rows, wanted) = (rows(&output)?, rows(&naive)?);
    for (i, row) in rows.iter().enumerate() {
        for &(j, moment) in row {
            let Some(&(_, there)) = wanted[i].iter().find(|(k, _)| *k == j) else { continue };
            let bound = bounds.area(i).max(bounds.area(j)) * bounds.reach(i).powi(2);
            if let Err(reason) = same(moment, there, bound)
                && !undecided(&scene, i, j, &bounds)
            {
                return Err(format!("facet {i}-{j}: {reason}"));
            }
        }
    }
    Ok(())
}

/// A facet is flat, across the line between its sites, and no larger than its cell's reach: nothing of its moment is along that line, and no
/// variance is negative nor larger than reach² (where no winding number is).
pub fn flat(backend: &dyn Backend, case: &Case) -> Verdict {
    let (scene, output) = evaluated(backend, case)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    for (i, (row, facets)) in rows(&output)?.iter().zip(bounds.rows()).enumerate() {
        for (&(j, moment), facet) in row.iter().zip(facets) {
            let normal = (scene.site(j) - scene.site(i)).normalize();
            let arm = bounds.reach(i);
            let turned = facet.area * arm * arm * bounds.turn(i, j).min(2.0);
            let bound = bounds.area(i).max(bounds.area(j)) * arm * arm + turned;
            let along = (matrix(moment) * normal).length();
            ensure!(along <= bound, "facet {i}-{j}: {moment:?} has {along:e} along its normal, bound {bound:e}");
            let trace: f64 = moment[..3].iter().sum();
            let most = facet.area.abs() * arm * arm + bound;
            ensure!(trace.abs() <= most, "facet {i}-{j}: {moment:?} of area {:e}, bound {most:e}", facet.area);
        }
    }
    Ok(())
}

/// The divergence theorem for (x − p)(x − p)ᵀ(x − p) where the boundary is nowhere near: Σ height ∫ (x − p)(x − p)ᵀ dA over the facets is five
/// times the cell's own second moment about its site p.
pub fn closure(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = case.scene();
    let request = Request::moments().with_facet_second_moments().with_second_moments();
    let output = scene.evaluate(backend, &request)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    let second = output.second_moment().unwrap_or_default();
    for (i, (row, facets)) in rows(&output)?.iter().zip(bounds.rows()).enumerate() {
        let is_inner = output.boundary().is_some_and(|b| b[i].area == 0.0);
        if !is_inner || output.status()[i] == CellStatus::Empty {
            continue;
        }
        let site = scene.site(i);
        let (mut sum, mut moved) = (DMat3::ZERO, 0.0);
        for (&(j, moment), facet) in row.iter().zip(facets) {
            let shift = (scene.weight(i) - scene.weight(j)) / facet.distance;
            let height = 0.5 * (facet.distance + shift);
            sum += height * (matrix(moment) + facet.area * square(facet.barycenter - site));
            moved += bounds.turn(i, j) * 0.5 * (facet.distance + shift.abs()) * facet.area;
        }
        let own = matrix(second[i]) + output.volume()[i] * square(DVec3::from(output.barycenter()[i]) - site);
        let off = (sum / 5.0 - own).to_cols_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let arm = bounds.reach(i);
        let bound = (CLOSURE * output.volume()[i].abs() + moved + bounds.facet_rounding(i) * arm) * arm * arm;
        ensure!(off <= bound, "site {i}: second moment {own}, by its facets {}: bound {bound:e}", sum / 5.0);
    }
    Ok(())
}

/// Two sites in a box of 1 × 2 × 3: their facet is a rectangle, its moments 2 · 3³/12 and 3 · 2³/12.
pub fn rectangle(backend: &dyn Backend) -> Verdict {
    let positions = vec![[0.3, 1.9, 0.2], [0.5, 1.9, 0.2]];
    let scene = Scene { positions, weights: vec![0.01, 0.0], room: Room::Box([0.0; 3], [1.0, 2.0, 3.0]) };
    let output = scene.evaluate(backend, &Request::moments().with_facet_second_moments())?;
    for row in rows(&output)? {
        ensure!(row.len() == 1, "{} facets", row.len());
        same(row[0].1, [0.0, 2.0, 4.5, 0.0, 0.0, 0.0], 1e-14)?;
    }
    Ok(())
}

/// They are there only where they are asked for.
pub fn only_where_asked_for(backend: &dyn Backend) -> Verdict {
    let scene = Scene { positions: vec![[0.3; 3], [0.6; 3]], weights: vec![], room: Room::Box([0.0; 3], [1.0; 3]) };
    for (request, wanted) in [
        (Request::moments().with_facets().with_second_moments(), false),
        (Request::moments().with_facet_second_moments(), true),
        (Request::moments().with_facets(), false),
    ] {
        let output = scene.evaluate(backend, &request)?;
        let facets = output.facets().ok_or("no facets")?;
        let length = facets.second_moment().map(<[_]>::len);
        ensure!(length == wanted.then_some(facets.area().len()), "{length:?} second moments of {request:?}");
    }
    Ok(())
}

fn evaluated(backend: &dyn Backend, case: &Case) -> Result<(Scene, Output), String> {
    let scene = case.scene();
    let output = scene.evaluate(backend, &Request::moments().with_facet_second_moments())?;
    Ok((scene, output))
}

/// The facets of a cell: neighbours and second moments.
type Row = Vec<(usize, [f64; 6])>;

/// The rows of all cells.
fn rows(output: &Output) -> Result<Vec<Row>, String> {
    let facets = output.facets().ok_or("no facets")?;
    let moments = facets.second_moment().ok_or("no second moments of facets")?;
    ensure!(moments.len() == facets.area().len(), "{} moments of {} facets", moments.len(), facets.area().len());
    let of = |f: usize| (facets.neighbor()[f] as usize, moments[f]);
    Ok((0..facets.sites()).map(|i| facets.row(i).map(of).collect()).collect())
}

fn matrix([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> DMat3 {
    DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
}

fn square(x: DVec3) -> DMat3 {
    DMat3::from_cols(x * x.x, x * x.y, x * x.z)
}

fn same(a: [f64; 6], b: [f64; 6], bound: f64) -> Verdict {
    let off = (0..6).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max);
    ensure!(off <= bound, "second moments {a:?} and {b:?} differ by {off:e}, bound {bound:e}");
    Ok(())
}
