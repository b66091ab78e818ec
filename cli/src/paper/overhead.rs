//! Fig. 11: what power diagrams cost over Voronoi diagrams.

use laguerre::{CellStatus, Request, Result};

use super::timings::device;
use super::{Lab, diagram, head, row};
use crate::args::Distribution;
use crate::report::grouped;
use crate::timing::measure;

pub(super) fn run(lab: &mut Lab, count: u32) -> Result<String> {
    let sites = lab.sites(Distribution::Blue, count)?;
    let inside = lab.power(count)?;
    let mut text = format!(
        "**Fig. 11**: blue noise in the bunny. The weights of the power diagram, for the sites with cells in it, are those of optimal \
         transport to equal volumes ({} Newton steps).\n\n",
        inside.steps
    );
    text.push_str(&head(&[
        "diagram",
        "sites",
        "cells",
        "spread of the volumes",
        "whole call",
        "device",
        "against Voronoi",
    ]));
    let cases = [
        ("Voronoi, all sites", &*sites, &[][..], None),
        ("Voronoi, sites with a cell", &inside.sites, &[], Some(inside.spread[0])),
        ("power, the same sites", &inside.sites, &inside.weights, Some(inside.spread[1])),
    ];
    let mut voronoi = None;
    for (name, sites, weights, spread) in cases {
        let mut diagram = diagram(sites, weights, Some(&lab.bunny))?;
        let (timing, output) = measure(lab.backend.as_ref(), &mut diagram, &Request::moments(), lab.repetitions)?;
        let own = timing.own();
        let against = spread.map(|_| *voronoi.get_or_insert(own));
        text.push_str(&row(&[
            name.into(),
            grouped(sites.len() as u64),
            grouped((output.status().len() - output.count(CellStatus::Empty)) as u64),
            spread.map_or_else(|| "–".into(), |spread| format!("{:.2} %", 100.0 * spread)),
            timing.spread(),
            device(&timing),
            against.map_or_else(|| "–".into(), |against| format!("{:+.0} %", 100.0 * (own / against - 1.0))),
        ]));
    }
    Ok(text)
}
