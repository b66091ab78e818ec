//! Who has a cell and who has not.

use laguerre_core::{Backend, CellStatus, Facets, Output, PowerDiagram, Request};

use crate::bounds::{Bounds, Planes};
use crate::{Case, Verdict, compare};

/// Of the sites at one position only the one of largest weight may have a cell, of several such the first; and the others
/// change nothing for anyone else.
pub fn duplicates(backend: &dyn Backend, case: &Case) -> Verdict {
    let mut scene = case.scene();
    let count = scene.len();
    // Every third site once more, a few with another weight.
    let mut random = case.random(8);
    for i in (0..count).step_by(3) {
        scene.positions.push(scene.positions[i]);
        if !scene.weights.is_empty() {
            let weight = scene.weights[i];
            scene.weights.push(if random.below(2) == 0 { weight } else { weight * random.unit() });
        }
    }
    let output = scene.with_facets(backend)?;
    let twins = scene.twins();
    let mut kept = Vec::new();
    for i in 0..scene.len() {
        let beaten = (0..scene.len()).find(|&j| {
            let (v, w) = (scene.weight(i), scene.weight(j));
            j != i && twins[j] == twins[i] && (w > v || (w == v && j < i))
        });
        match beaten {
            Some(j) => ensure!(output.status()[i] == CellStatus::Empty, "site {i} has a cell where site {j} stands"),
            None => kept.push(i),
        }
    }
    // The scene without them, its cells put back in their places.
    let mut alone = scene.clone();
    alone.positions = kept.iter().map(|&i| scene.positions[i]).collect();
    if !scene.weights.is_empty() {
        alone.weights = kept.iter().map(|&i| scene.weights[i]).collect();
    }
    let without = alone.with_facets(backend)?;
    let bounds = Bounds::new(&alone, &without, Planes::Same);
    for (k, &i) in kept.iter().enumerate() {
        let (a, b, bound) = (without.volume()[k], output.volume()[i], bounds.volume(k));
        ensure!((a - b).abs() <= bound, "site {i}: volume {b:e}, without duplicates {a:e}, bound {bound:e}");
    }
    Ok(())
}

/// One site alone has everything, wherever it stands and whatever it weighs.
pub fn one_site_has_everything(backend: &dyn Backend, case: &Case) -> Verdict {
    let scene = Case { count: 1, ..*case }.scene();
    let output = scene.with_facets(backend)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    ensure!(output.status() == [CellStatus::Complete], "the only site is {:?}", output.status());
    let (volume, all, bound) = (output.volume()[0], scene.room.volume(), bounds.volume_sum());
    ensure!((volume - all).abs() <= bound, "the only site has {volume} of {all}, bound {bound:e}");
    let facets = output.facets().map_or(0, |f| f.area().len());
    ensure!(facets == 0, "the only site has {facets} neighbours");
    // Twice the same site: the second adds nothing.
    let mut twice = scene.clone();
    twice.positions.push(scene.positions[0]);
    twice.weights.extend(scene.weights.first().copied());
    let both = twice.with_facets(backend)?;
    ensure!(both.status()[1] == CellStatus::Empty, "the second of two equal sites is {:?}", both.status()[1]);
    let mut first = both.into_arrays();
    first.status.truncate(1);
    first.volume.truncate(1);
    first.barycenter.truncate(1);
    first.facets = first.facets.map(|facets| {
        let mut facets = facets.into_arrays();
        facets.offsets.truncate(2);
        facets.boundary.truncate(1);
        Facets::new(facets).expect("one row")
    });
    compare::identical(&output, &Output::new(first).expect("one cell"))
}

/// Two sites near a corner of the box: down to any distance the one that is nearer to everything has it, or the diagram says that they
/// are not told apart, and the first has it.
pub fn told_apart_or_said(backend: &dyn Backend) -> Verdict {
    let mut said = 0;
    for (lo, hi, corner) in [(0.0, 1.0, 0.0), (0.0, 3e9, 0.0), (1000.0, 1001.0, 0.0), (1000.0, 1001.0, 1000.0)] {
        for exponent in 1..=300 {
            let positions = [[corner; 3], [corner + 0.1_f64.powi(exponent), corner, corner]];
            let diagram = PowerDiagram::new(&positions, &[]).and_then(|d| d.in_box([lo; 3], [hi; 3]));
            let diagram = diagram.map_err(|error| error.to_string())?;
            let merged = diagram.merged_sites().map_err(|error| error.to_string())?;
            let output = backend.evaluate(&diagram, &Request::moments()).map_err(|error| error.to_string())?;
            // What rounds to one place before it is a diagram's is one.
            let winner = if positions[0] == positions[1] {
                ensure!(merged.is_none(), "1e-{exponent} from {corner}: {merged:?} of sites at one place");
                0
            } else if let Some(merged) = merged {
                ensure!((merged.count, merged.first) == (1, [0, 1]), "1e-{exponent} from {corner}: {merged:?}");
                said += 1;
                0
            } else {
                1
            };
            let near = 0.5 * 0.1_f64.powi(exponent) / (hi - lo);
            let share = output.volume()[winner] / (hi - lo).powi(3);
            let all = (corner != lo) || (share - (1.0 - near)).abs() <= 1e-12;
            let everything = output.volume()[winner] > output.volume()[1 - winner];
            ensure!(all && everything, "1e-{exponent} from {corner}: volumes {:?}, {merged:?}", output.volume());
        }
    }
    ensure!(said > 500, "{said} pairs are not told apart");
    Ok(())
}
