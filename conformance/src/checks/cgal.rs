//! The cells are CGAL's, to a part in 10¹² of the mean cell: no allowance for rounding beside that. The mean is over the cells
//! that there are, not over sites whose cells are empty.

use std::collections::BTreeMap;
use std::fmt;

use glam::DVec3;
use laguerre_core::{Backend, CellStatus, Output};

use crate::Verdict;
use crate::bounds::{CELL, CLOSURE, FACET, SUM};
use crate::fixtures::Fixture;
use crate::scene::rows;

/// Holds every number of the fixture `name`. With the environment variable `LAGUERRE_WORST` it also prints, quantity by
/// quantity, the largest error, its share of the bound, and where it is; `cargo xtask fixtures --worst` sorts these lines.
pub fn hold(backend: &dyn Backend, name: &str) -> Verdict {
    let fixture = Fixture::load(name)?;
    let output = fixture.scene.with_facets(backend)?;
    let deviations = deviations(&fixture, &output)?;
    if std::env::var_os("LAGUERRE_WORST").is_some() {
        let worst = worst(&deviations);
        // In one piece, as other checks print at the same time.
        let lines: String = worst.values().map(|d| format!("worst {:.1e} {name}: {d}\n", d.ratio())).collect();
        eprint!("{lines}");
    }
    match deviations.iter().find(|deviation| !deviation.is_within()) {
        Some(first) => Err(first.to_string()),
        None => Ok(()),
    }
}

/// How far one number is from its exact value.
#[derive(Clone, Debug)]
struct Deviation {
    /// What was measured.
    quantity: &'static str,
    /// The site, if it is one's, and the neighbour of its facet, if it is a facet's.
    place: (Option<usize>, Option<usize>),
    exact: f64,
    error: f64,
    bound: f64,
}

impl Deviation {
    /// Not so for NaN.
    fn is_within(&self) -> bool {
        self.error <= self.bound
    }

    /// The error in units of its bound.
    fn ratio(&self) -> f64 {
        self.error / self.bound
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { quantity, place, exact, error, bound } = self;
        write!(f, "{quantity}")?;
        match place {
            (Some(i), Some(j)) => write!(f, " {i}-{j}")?,
            (Some(i), None) => write!(f, " of site {i}")?,
            _ => {}
        }
        write!(f, " ({exact:.3e}) is off by {error:.1e}, bound {bound:.1e}")
    }
}

/// The largest of each quantity, by its share of the bound.
fn worst(deviations: &[Deviation]) -> BTreeMap<&'static str, &Deviation> {
    let mut worst: BTreeMap<&'static str, &Deviation> = BTreeMap::new();
    for deviation in deviations {
        let held = worst.entry(deviation.quantity).or_insert(deviation);
        if deviation.ratio() > held.ratio() {
            *held = deviation;
        }
    }
    worst
}

/// Every number of `output` against the fixture's.
///
/// # Errors
/// Where a cell is empty and should not be, or the other way round, though its volume is above the bound.
fn deviations(fixture: &Fixture, output: &Output) -> Result<Vec<Deviation>, String> {
    let Fixture { scene, volume, area, cells } = fixture;
    let mean_volume = volume / cells.iter().flatten().count() as f64;
    let facets: Vec<f64> = cells.iter().flatten().flat_map(|cell| &cell.facets).map(|(_, area)| *area).collect();
    let mean_area = facets.iter().sum::<f64>() / facets.len().max(1) as f64;
    let volume_bound = CELL * mean_volume;
    let moment_bound = volume_bound * mean_volume.cbrt();

    let container = |quantity, value: f64, exact: f64| Deviation {
        quantity,
        place: (None, None),
        exact,
        error: (value - exact).abs(),
        bound: SUM * exact,
    };
    let mut deviations = vec![
        container("volume of the container", scene.room.volume(), *volume),
        container("area of the container", scene.room.area(), *area),
    ];
    let boundary = output.boundary().ok_or("no boundary was computed")?;
    for (i, row) in rows(output).iter().enumerate() {
        let mut add = |quantity, neighbor: Option<usize>, error: f64, exact: f64, bound: f64| {
            deviations.push(Deviation { quantity, place: (Some(i), neighbor), exact, error: error.abs(), bound });
        };
        let is_empty = output.status()[i] == CellStatus::Empty;
        let Some(cell) = &cells[i] else {
            ensure!(
                is_empty,
                "site {i} has no cell, but is {:?} with volume {:e}",
                output.status()[i],
                output.volume()[i]
            );
            continue;
        };
        ensure!(!is_empty || cell.volume <= volume_bound, "site {i} is empty, its volume is {:e}", cell.volume);
        add("volume", None, output.volume()[i] - cell.volume, cell.volume, volume_bound);
        if !is_empty {
            let barycenter = DVec3::from(cell.barycenter);
            let off = DVec3::from(output.barycenter()[i]).distance(barycenter);
            add("first moment", None, cell.volume * off, cell.volume * barycenter.length(), moment_bound);
        }
        let boundary_bound = FACET * mean_area + CLOSURE * cell.boundary;
        add("boundary", None, boundary[i].area - cell.boundary, cell.boundary, boundary_bound);
        // One absent is one of area 0.
        let mut pairs: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        row.iter().for_each(|facet| pairs.entry(facet.neighbor).or_default()[0] = facet.area);
        cell.facets.iter().for_each(|&(j, area)| pairs.entry(j).or_default()[1] = area);
        for (j, [value, exact]) in pairs {
            add("facet", Some(j), value - exact, exact, FACET * mean_area);
        }
    }
    Ok(deviations)
}

#[cfg(test)]
mod tests {
    use laguerre_core::oracle::Naive;

    use super::*;
    use crate::{CHECKS, fixtures};

    #[test]
    fn every_fixture_has_its_check() {
        let mut checks: Vec<&str> = CHECKS.iter().filter_map(|(name, _)| name.strip_prefix("cgal::")).collect();
        checks.sort_unstable();
        assert_eq!(checks, fixtures::names().unwrap());
    }

    /// What is wrong once `change` was made to the answers.
    fn changed(change: impl Fn(&mut Fixture)) -> Option<String> {
        let mut fixture = Fixture::load("torus_few").unwrap();
        let output = fixture.scene.with_facets(&Naive::default()).unwrap();
        change(&mut fixture);
        match deviations(&fixture, &output) {
            Ok(deviations) => deviations.iter().find(|d| !d.is_within()).map(ToString::to_string),
            Err(reason) => Some(reason),
        }
    }

    #[test]
    fn an_error_beyond_the_bound_is_seen_wherever_it_is() {
        assert_eq!(changed(|_| ()), None);
        let told = |words: &str, change: fn(&mut crate::fixtures::Cell)| {
            let reason = changed(|fixture| change(fixture.cells[1].as_mut().unwrap())).unwrap_or_default();
            assert!(reason.starts_with(words), "{reason}");
        };
        // The cells are of about the mean size, so a relative error of 1e-11 is ten bounds.
        let off = 1.0 + 1e-11;
        told("volume of site 1", |cell| cell.volume *= 1.0 + 1e-11);
        told("first moment of site 1", |cell| cell.barycenter[1] *= 1.0 + 1e-11);
        told("boundary of site 1", |cell| cell.boundary *= 1.0 + 1e-11);
        told("facet 1-", |cell| cell.facets[0].1 *= 1.0 + 1e-11);
        told("facet 1-", |cell| cell.facets.clear());
        assert!(changed(|fixture| fixture.volume *= off).is_some_and(|r| r.starts_with("volume of the container")));
        assert!(changed(|fixture| fixture.area *= off).is_some_and(|r| r.starts_with("area of the container")));
        assert!(changed(|fixture| fixture.cells[1] = None).is_some_and(|r| r.starts_with("site 1 has no cell")));
    }
}
