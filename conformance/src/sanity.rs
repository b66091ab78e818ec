//! One output, held against every law that needs no second computation.

use laguerre_core::{Backend, CellStatus, Output, PowerDiagram, Request};

use crate::bounds::{Bounds, Planes};
use crate::checks::{closure, facets, sums};
use crate::{Case, Scene, Verdict};

/// A law of one output with facets, within the bounds that belong to it.
pub type OutputLaw = fn(&Scene, &Output, &Bounds) -> Verdict;

/// Laws of every output: volumes, first moments, statuses.
const ALWAYS: &[OutputLaw] = &[coincident_sites, sums::volumes, sums::first_moments, sums::barycenters];

/// Laws of every output with facets.
const OF_FACETS: &[OutputLaw] = &[
    facets::are_positive,
    facets::have_distances,
    facets::are_mutual,
    closure::of_areas,
    closure::of_volumes,
    sums::boundary_areas,
];

/// What design and documents promise of `output`, the answer of a backend to `request` about `diagram`.
///
/// # Errors
/// The first law that is broken, and where. Also where the diagram has no container, which no output has come from.
pub fn sanity_check(diagram: &PowerDiagram, request: &Request, output: &Output) -> Verdict {
    check(&Scene::of(diagram)?, request, output)
}

/// [`sanity_check`] of a scene.
///
/// # Errors
/// The first law that is broken, and where.
pub fn check(scene: &Scene, request: &Request, output: &Output) -> Verdict {
    form(scene.len(), request, output)?;
    if output.count(CellStatus::Uncertified) > 0 {
        // Cells that may be too large: all that is promised is said in their status.
        return Ok(());
    }
    let bounds = Bounds::new(scene, output, Planes::Same);
    let second: &[OutputLaw] = if request.second_moments() { &[sums::second_moments] } else { &[] };
    let of_facets = if request.facets() { OF_FACETS } else { &[] };
    ALWAYS.iter().chain(of_facets).chain(second).try_for_each(|law| law(scene, output, &bounds))
}

/// Holds what `backend` makes of a case, asked for everything, to one law.
///
/// # Errors
/// The library's, or how the law is broken.
pub fn hold(backend: &dyn Backend, case: &Case, law: OutputLaw) -> Verdict {
    let scene = case.scene();
    let output = scene.evaluate(backend, &Request::moments().with_facets().with_second_moments())?;
    law(&scene, &output, &Bounds::new(&scene, &output, Planes::Same))
}

/// The form of an output, whatever the input: lengths agree, an empty cell has volume 0 and barycenter NaN, nothing
/// else is NaN, facets are sorted rows of known sites, and `Uncertified` occurs only where it was asked for.
///
/// # Errors
/// The first thing out of order.
pub fn form(count: usize, request: &Request, output: &Output) -> Verdict {
    // That its arrays fit each other is `Output`'s own to hold.
    ensure!(output.sites() == count, "{count} sites, but an output of {}", output.sites());
    for i in 0..count {
        let (status, volume, barycenter) = (output.status()[i], output.volume()[i], output.barycenter()[i]);
        ensure!(volume.is_finite(), "site {i}: volume {volume}");
        match status {
            CellStatus::Empty => {
                ensure!(volume == 0.0, "site {i} is empty with volume {volume}");
                ensure!(barycenter.iter().all(|x| x.is_nan()), "site {i} is empty with barycenter {barycenter:?}");
            }
            CellStatus::Complete => {
                // Negative where the winding number is.
                ensure!(volume != 0.0, "site {i} is complete with volume 0");
                ensure!(barycenter.iter().all(|x| x.is_finite()), "site {i}: barycenter {barycenter:?}");
            }
            CellStatus::Uncertified => {
                ensure!(request.epsilon().is_some(), "site {i} is uncertified without `epsilon`")
            }
        }
    }
    ensure!(output.facets().is_some() == request.facets(), "facets are there: {}", output.facets().is_some());
    ensure!(
        output.second_moment().is_some() == request.second_moments(),
        "second moments are there: {}",
        output.second_moment().is_some()
    );
    if let Some(moments) = output.second_moment() {
        ensure!(moments.iter().flatten().all(|x| x.is_finite()), "a second moment is not finite");
    }
    if let Some(boundary) = output.boundary() {
        for (i, b) in boundary.iter().enumerate() {
            let numbers = b.barycenter.iter().chain(&b.vector_area).chain([&b.area, &b.flux]);
            ensure!(numbers.into_iter().all(|x| x.is_finite()), "site {i}: boundary {b:?}");
        }
    }
    let Some(facets) = output.facets() else { return Ok(()) };
    for i in 0..count {
        for facet in facets.of(i) {
            let other = facet.neighbor;
            ensure!(other != i, "site {i} has itself as a neighbour");
            ensure!(facet.area.is_finite(), "facet {i}-{other}: area {}", facet.area);
            ensure!(facet.barycenter.iter().all(|x| x.is_finite()), "facet {i}-{other}: no barycenter");
        }
    }
    Ok(())
}

/// Of the sites at one position only the one of largest weight may have a cell, of several such the first.
///
/// # Errors
/// A site that has a cell where another has it.
fn coincident_sites(scene: &Scene, output: &Output, _: &Bounds) -> Verdict {
    let twins = scene.twins();
    // Of each position the site that may have its cell, by the lowest index there.
    let mut best: Vec<usize> = (0..scene.len()).collect();
    for (i, &first) in twins.iter().enumerate() {
        if scene.weight(i) > scene.weight(best[first]) {
            best[first] = i;
        }
    }
    for (i, &first) in twins.iter().enumerate() {
        let empty = output.status()[i] == CellStatus::Empty;
        ensure!(empty || best[first] == i, "site {i} has a cell where site {} stands", best[first]);
    }
    Ok(())
}
