//! Fig. 9: what cells need, by distribution, as Voronoi and as power cells of equal volume.

use std::path::Path;

use laguerre::engine::capacities::{CellCounts, PROPOSED_SHARE, count_cells, sufficient};
use laguerre::{PowerDiagram, Request, Result};

use super::{Lab, diagram, equal, head, row};
use crate::args::Distribution;
use crate::bench::word;
use crate::evaluate::evaluate;
use crate::plot::{self, Curve};
use crate::report::grouped;
use crate::tune::COUNTS;

/// Sites at most: more would only smooth the curves.
const MOST_SITES: u32 = 1_000_000;

pub(super) fn run(lab: &mut Lab, count: u32, picture: Option<&Path>) -> Result<String> {
    let count = count.min(MOST_SITES);
    let mut text = format!(
        "**Fig. 9**: what the cells in the bunny need, of {} sites in the cube; the power cells are of equal volume. K: sites \
         visited (by the search on the host); P, V: the most half-spaces and vertices at once; T: triangles tried, of cells that try any. Median, 95 % (the \
         capacity proposed), most.\n\n",
        grouped(count.into())
    );
    text.push_str(&head(&["sites", "diagram", "cells", "K", "P", "V", "T"]));
    let mut found = Vec::new();
    let distributions = [Distribution::Blue, Distribution::Perturbed, Distribution::White, Distribution::Lattice];
    for (color, distribution) in distributions.into_iter().enumerate() {
        let sites = lab.sites(distribution, count)?;
        let inside = equal::inside(lab.backend.as_ref(), &sites, &lab.bunny)?;
        for (name, sites, weights) in [("Voronoi", &*sites, &[][..]), ("power", &inside.sites, &inside.weights)] {
            let counts = of_cells(lab, &diagram(sites, weights, Some(&lab.bunny))?)?;
            text.push_str(&row(&cells(word(distribution), name, &counts)));
            let label = format!("{}, {name}", word(distribution));
            found.push(Curve { name: label, color, dashed: name == "power", counts });
        }
    }
    if let Some(path) = picture {
        plot::draw(path, &found, PROPOSED_SHARE)?;
    }
    Ok(text)
}

/// The counts of the cells that are not empty.
fn of_cells(lab: &Lab, diagram: &PowerDiagram) -> Result<Vec<CellCounts>> {
    let request = Request::moments();
    let output = evaluate(lab.backend.as_ref(), diagram, &request)?;
    let prepared = diagram.prepare()?;
    let order = prepared.sites.order();
    let is_cell = |&sorted: &u32| output.volume()[order[sorted as usize] as usize] > 0.0;
    let sites: Vec<u32> = (0..order.len() as u32).filter(is_cell).collect();
    Ok(count_cells(&prepared, &request, &sites))
}

fn cells(distribution: &str, name: &str, counts: &[CellCounts]) -> Vec<String> {
    let near: Vec<CellCounts> = counts.iter().filter(|cell| cell.triangles > 0).copied().collect();
    let mut cells = vec![distribution.to_owned(), name.to_owned(), grouped(counts.len() as u64)];
    cells.extend(COUNTS.map(|(letter, _, count)| {
        let counts = if letter == "T" { &near } else { counts };
        [0.5, PROPOSED_SHARE, 1.0].map(|share| count(&sufficient(counts, share)).to_string()).join(", ")
    }));
    cells
}
