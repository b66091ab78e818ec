//! Fig. 10: three distributions, without a domain and in several, pass by pass.

use laguerre::{CellStatus, Output, Request, Result};

use super::{Lab, diagram, domain, head, row};
use crate::args::Distribution;
use crate::bench::word;
use crate::domains;
use crate::report::grouped;
use crate::timing::{Timing, measure, seconds};

pub(super) fn run(lab: &mut Lab, count: u32) -> Result<String> {
    let mut text =
        "**Fig. 10**: Voronoi cells of three distributions, without a domain (the cube) and in six.\n\n".to_owned();
    text.push_str(&head(&["sites", "domain", "cells", "whole call", "device", "against none", "passes"]));
    for distribution in [Distribution::Blue, Distribution::Perturbed, Distribution::White] {
        let sites = lab.sites(distribution, count)?;
        let mut none = None;
        for name in std::iter::once("none").chain(domains::OF_THE_PAPER) {
            let domain = if name == "none" { None } else { Some(domain(name)?) };
            let mut diagram = diagram(&sites, &[], domain.as_ref())?;
            let (timing, output) = measure(lab.backend.as_ref(), &mut diagram, &Request::moments(), lab.repetitions)?;
            let own = timing.own();
            let against = *none.get_or_insert(own);
            text.push_str(&row(&[
                format!("{}, {}", word(distribution), grouped(sites.len() as u64)),
                name.into(),
                grouped((output.status().len() - output.count(CellStatus::Empty)) as u64),
                timing.spread(),
                device(&timing),
                format!("{:+.0} %", 100.0 * (own / against - 1.0)),
                passes(&output),
            ]));
        }
    }
    Ok(text)
}

/// The device's time, where there is one.
pub(super) fn device(timing: &Timing) -> String {
    timing.device.map_or_else(|| "–".into(), seconds)
}

/// What each pass of the last evaluation did.
fn passes(output: &Output) -> String {
    let passes = output.report().passes.iter().enumerate().map(|(i, pass)| {
        let time = if pass.device_seconds > 0.0 { pass.device_seconds } else { pass.seconds };
        let mut text = format!(
            "{}: P {}, V {}; {} cells, {} failed, {}",
            i + 1,
            pass.planes,
            pass.vertices,
            grouped(pass.cells as u64),
            grouped(pass.failed as u64),
            seconds(time)
        );
        if pass.second.cells > 0 {
            let (cells, time) = (grouped(pass.second.cells as u64), seconds(pass.second.seconds));
            text.push_str(&format!(" (second substep {cells} cells, {time})"));
        }
        text
    });
    passes.collect::<Vec<_>>().join("<br>")
}
