//! `laguerre tune`: what the cells of an input need, and the capacities that most of them are content with (paper §6.1).

use laguerre::engine::capacities::{CellCounts, count_cells, sufficient};
use laguerre::{Request, Result, io};
use serde::Serialize;

use crate::args::TuneArgs;
use crate::container::Container;
use crate::outcome::{Outcome, print, print_json};
use crate::plot::{self, Curve};
use crate::report::grouped;
use crate::sites;

/// A count: its letter, what it counts, and how to get it.
pub(crate) type Count = (&'static str, &'static str, fn(&CellCounts) -> u32);

/// The counts, in the order of the paper, with the triangles.
pub(crate) const COUNTS: [Count; 4] = [
    ("K", "sites visited", |cell| cell.neighbors),
    ("P", "half-spaces at once", |cell| cell.planes),
    ("V", "vertices at once", |cell| cell.vertices),
    ("T", "triangles tried", |cell| cell.triangles),
];

/// Bins of a printed histogram at most, and the signs of its longest bar.
const BINS: u32 = 16;
const LONGEST_BAR: f64 = 40.0;

/// The object of `--json`.
#[derive(Serialize)]
struct Report {
    sites: usize,
    /// Percent of the cells that the proposed capacities suffice for, each by itself.
    share: f64,
    proposed: Numbers<u32>,
    most: Numbers<u32>,
    /// For each count its values, ascending, each with the number of cells.
    histograms: Numbers<Vec<(u32, usize)>>,
}

#[derive(Serialize)]
struct Numbers<T> {
    #[serde(rename = "K")]
    neighbors: T,
    #[serde(rename = "P")]
    planes: T,
    #[serde(rename = "V")]
    vertices: T,
    #[serde(rename = "T")]
    triangles: T,
}

impl<T> Numbers<T> {
    fn of(number: impl Fn(Count) -> T) -> Self {
        let [neighbors, planes, vertices, triangles] = COUNTS.map(number);
        Self { neighbors, planes, vertices, triangles }
    }
}

pub(crate) fn run(args: &TuneArgs) -> Result<Outcome> {
    if let Some(path) = &args.output {
        io::check_output(path, plot::ENDINGS)?;
    }
    let diagram = sites::read(&args.sites)?;
    let diagram = Container::read(&args.container)?.restrict(diagram)?;
    let prepared = diagram.prepare().map_err(|e| e.at(sites::name(&args.sites)))?;
    // Coincident sites have no cell that would need anything.
    let all: Vec<u32> = (0..prepared.sites.len() as u32).collect();
    let counts = count_cells(&prepared, &Request::moments(), &all);
    let share = args.share / 100.0;
    if let Some(path) = &args.output {
        let name = sites::name(&args.sites);
        plot::draw(path, &[Curve { name, color: 0, dashed: false, counts: counts.clone() }], share)?;
    }
    if args.json {
        let proposed = sufficient(&counts, share);
        let most = sufficient(&counts, 1.0);
        let report = Report {
            sites: diagram.positions().len(),
            share: args.share,
            proposed: Numbers::of(|(.., count)| count(&proposed)),
            most: Numbers::of(|(.., count)| count(&most)),
            histograms: Numbers::of(|(.., count)| histogram(&counts, count)),
        };
        print_json(&report)?;
    } else {
        print(&text(&counts, share))?;
    }
    Ok(Outcome::Done)
}

/// Every value that occurs, ascending, with the number of cells.
pub(crate) fn histogram(counts: &[CellCounts], count: fn(&CellCounts) -> u32) -> Vec<(u32, usize)> {
    let mut values: Vec<u32> = counts.iter().map(count).collect();
    values.sort_unstable();
    values.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
}

fn text(counts: &[CellCounts], share: f64) -> String {
    let mut text = String::new();
    for (letter, meaning, count) in COUNTS {
        text.push_str(&format!("{letter}  {meaning}\n"));
        let values = histogram(counts, count);
        let (Some(&(lo, _)), Some(&(hi, _))) = (values.first(), values.last()) else { continue };
        let width = (hi - lo) / BINS + 1;
        let bins = values.chunk_by(|a, b| (a.0 - lo) / width == (b.0 - lo) / width);
        let bins: Vec<(u32, usize)> =
            bins.map(|bin| ((bin[0].0 - lo) / width * width + lo, bin.iter().map(|value| value.1).sum())).collect();
        let fullest = bins.iter().map(|bin| bin.1).max().unwrap_or(1);
        for (from, cells) in bins {
            let range = if width == 1 { from.to_string() } else { format!("{from} to {}", from + width - 1) };
            let bar = "#".repeat((LONGEST_BAR * cells as f64 / fullest as f64).round() as usize);
            let percent = 100.0 * cells as f64 / counts.len() as f64;
            text.push_str(format!("   {range:>14}  {percent:6.2} %  {bar}").trim_end());
            text.push('\n');
        }
    }
    let (proposed, most) = (sufficient(counts, share), sufficient(counts, 1.0));
    let numbers = |of: &CellCounts| COUNTS.map(|(letter, _, count)| format!("{letter} {}", count(of))).join(", ");
    text.push_str(&format!(
        "cells      {}\nmost       {}\nproposed   {} (each enough for {} % of the cells)\n",
        grouped(counts.len() as u64),
        numbers(&most),
        numbers(&proposed),
        100.0 * share
    ));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_hold_every_cell_once() {
        let counts: Vec<CellCounts> =
            (0..1000).map(|n| CellCounts { neighbors: n % 100, ..CellCounts::default() }).collect();
        let values = histogram(&counts, |cell| cell.neighbors);
        assert_eq!((values.len(), values[3]), (100, (3, 10)));
        let text = text(&counts, 0.95);
        let percent =
            |line: &str| line.split_once(" %").and_then(|(start, _)| start.rsplit(' ').next()?.parse::<f64>().ok());
        let total: f64 = text.lines().take_while(|line| !line.starts_with('P')).filter_map(percent).sum();
        assert!((total - 100.0).abs() < 0.1, "{text}");
        assert!(text.contains("proposed   K 94, P 0, V 0, T 0"), "{text}");
    }
}
