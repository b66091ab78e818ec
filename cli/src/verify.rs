//! `laguerre verify`: whether a result file, whoever wrote it, is right.
//!
//! Its sums are held against the container, its cells against an evaluation of all and, some of them, against the naive oracle: those
//! of a random sample, and those that seem wrong. Where the two disagree, the oracle is believed.

mod bounds;
mod facets;
mod wrong;

use std::collections::BTreeSet;
use std::time::Instant;

use laguerre::engine::parallel;
use laguerre::io::{self, CellRow};
use laguerre::oracle::Naive;
use laguerre::summation::Sum;
use laguerre::{Backend, CellStatus, Error, ErrorKind, Output, OutputArrays, PowerDiagram, Request, Result};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use serde::Serialize;

use crate::args::VerifyArgs;
use crate::container::{Container, Whole, note_if_merged};
use crate::evaluate::{evaluate, open_default};
use crate::npz;
use crate::outcome::{Outcome, print, print_json, say};
use crate::report::{Report, Seconds, grouped};
use crate::sites;
use bounds::Bounds;
use facets::FacetsFile;
use wrong::Wrong;

/// Cells that seem wrong and are computed again by the oracle, at most; the others are held against the backend alone.
const MOST_SUSPECTS: usize = 256;
/// Wrong cells and facets that are listed, for people and in the object of `--json`.
const LISTED: usize = 20;
const LISTED_IN_JSON: usize = 1000;

/// The object of `--json`.
#[derive(Debug, Serialize)]
struct Findings {
    right: bool,
    sites: usize,
    /// Cells that are not empty, by the file.
    cells: usize,
    /// Cells that the file calls uncertified.
    uncertified: usize,
    /// Cells held against the naive oracle; all are held against the backend.
    checked_by_oracle: usize,
    wrong_cells: usize,
    wrong_facets: usize,
    laws: Vec<Law>,
    /// The worst first, the first thousand.
    wrong: Vec<Wrong>,
    seconds: f64,
}

/// A law of the file as a whole.
#[derive(Debug, Serialize)]
struct Law {
    law: &'static str,
    /// What the file's numbers sum to, and what they should; for barycenters, how far their mean is off over the diagonal, and 0.
    file: f64,
    expected: f64,
    off: f64,
    bound: f64,
    holds: bool,
}

pub(crate) fn run(args: &VerifyArgs) -> Result<Outcome> {
    let start = Instant::now();
    parallel::start()?;
    let diagram = sites::read(&args.sites)?;
    let diagram = Container::read(&args.container)?.restrict(diagram)?;
    let of_sites = |e: Error| if e.kind() == ErrorKind::Input { e.at(sites::name(&args.sites)) } else { e };
    let whole = Whole::of(&diagram).map_err(of_sites)?;
    note_if_merged(&diagram)?;
    let n = diagram.positions().len();
    let file = npz::read_cells(&args.results)?;
    check_rows(&file.rows, n).map_err(|e| e.at(args.results.display()))?;
    let facets = args.facets.as_ref().map(|path| {
        let rows = npz::read_facets(path)?;
        // An array has no lines.
        let unit = if io::ending(path, &[".csv"]).is_ok() { "line" } else { "row (from 1)" };
        FacetsFile::new(rows, n, unit).map_err(|e| e.at(path.display()))
    });
    let facets = facets.transpose()?;

    let backend = open_default()?;
    let request = Request::moments().with_facets().with_second_moments();
    let again = evaluate(backend.as_ref(), &diagram, &request).map_err(of_sites)?;
    let bounds = Bounds::new(&diagram, &whole, &again, args.tolerance, file.single)?;

    let check = Check { diagram: &diagram, rows: &file.rows, facets: facets.as_ref(), bounds: &bounds };
    let (wrong, checked_by_oracle) = check.cells(&again, args)?;
    let report = Report::new(&output_of(&file.rows)?, &whole, backend.info(), Seconds::default());
    let laws = laws(&report, &check, &again);
    let wrong_facets = wrong.iter().filter(|w| w.is_facet()).count();
    let wrong_cells: BTreeSet<usize> = wrong.iter().filter(|w| !w.is_facet()).map(Wrong::site).collect();
    let mut findings = Findings {
        right: wrong.is_empty() && laws.iter().all(|law| law.holds),
        sites: n,
        cells: report.cells,
        uncertified: report.uncertified,
        checked_by_oracle,
        wrong_cells: wrong_cells.len(),
        wrong_facets,
        laws,
        wrong,
        seconds: start.elapsed().as_secs_f64(),
    };
    findings.wrong.sort_by(Wrong::worst_first);
    if args.json {
        findings.wrong.truncate(LISTED_IN_JSON);
        print_json(&findings)?;
    } else {
        print(&findings.summary())?;
    }
    if findings.right {
        return Ok(Outcome::Done);
    }
    say(&format!("{}: {}", args.results.display(), findings.verdict()));
    Ok(Outcome::Refuted)
}

/// That there is a row for each site, before anything is computed.
fn check_rows(rows: &[CellRow], n: usize) -> Result<()> {
    if rows.len() == n {
        return Ok(());
    }
    let mut seen = vec![false; n];
    for row in rows {
        if let Some(seen) = usize::try_from(row.site).ok().and_then(|i| seen.get_mut(i)) {
            *seen = true;
        }
    }
    let missing =
        seen.iter().position(|seen| !seen).map(|i| format!("; there is none for site {i}")).unwrap_or_default();
    Err(Error::input(format!("{} rows for {n} sites{missing}: is it of these sites, and whole?", rows.len())))
}

/// The file's cells as an output, for their sums.
fn output_of(rows: &[CellRow]) -> Result<Output> {
    let mut output = OutputArrays::default();
    for row in rows {
        let by_volume = if row.volume == 0.0 { CellStatus::Empty } else { CellStatus::Complete };
        output.status.push(row.status.unwrap_or(by_volume));
        output.volume.push(row.volume);
        output.barycenter.push(row.barycenter);
    }
    Output::new(output)
}

/// A file to be checked.
#[derive(Clone, Copy)]
struct Check<'a> {
    diagram: &'a PowerDiagram,
    rows: &'a [CellRow],
    facets: Option<&'a FacetsFile>,
    bounds: &'a Bounds<'a>,
}

impl Check<'_> {
    /// What is wrong with single cells and facets, and how many cells the oracle was asked about.
    fn cells(&self, again: &Output, args: &VerifyArgs) -> Result<(Vec<Wrong>, usize)> {
        let n = self.rows.len();
        let mut found: Vec<Vec<Wrong>> = (0..n).into_par_iter().map(|i| self.cell(i, again)).collect();
        let mut suspects: Vec<&Wrong> = found.iter().flatten().collect();
        suspects.sort_by(|a, b| a.worst_first(b));
        let mut asked: BTreeSet<usize> = sample(n, args.cells, args.seed);
        let mut more = BTreeSet::new();
        for wrong in suspects {
            if more.len() < MOST_SUSPECTS && !asked.contains(&wrong.site()) {
                more.insert(wrong.site());
            }
        }
        asked.append(&mut more);
        let asked: Vec<u32> = asked.into_iter().map(|i| i as u32).collect();
        // Each share sorts the sites anew.
        let share = asked.len().div_ceil(rayon::current_num_threads()).max(1);
        let request = Request::moments().with_facets();
        let ask = |diagram: &PowerDiagram| -> Result<Vec<(&[u32], Output)>> {
            let judge = |some| Ok((some, Naive::only(some).evaluate(diagram, &request)?));
            asked.par_chunks(share).map(judge).collect()
        };
        let mut bounds = self.bounds.clone();
        if let Some(domain) = self.diagram.domain() {
            let grid = domain.grid(self.diagram.positions().len());
            let [lo, hi] = [[0; 3], grid.dims()].map(|voxel| domain.frame().leave(grid.corner(voxel)));
            let boxed = PowerDiagram::new(self.diagram.positions(), self.diagram.weights())?.in_box(lo, hi)?;
            for (some, convex) in ask(&boxed)? {
                bounds = bounds.widened(some.iter().map(|&i| i as usize), &convex);
            }
        }
        let check = Check { bounds: &bounds, ..*self };
        for (some, oracle) in ask(self.diagram)? {
            for &i in some {
                found[i as usize] = check.cell(i as usize, &oracle);
            }
        }
        Ok((found.into_iter().flatten().collect(), asked.len()))
    }

    /// What is wrong with cell `i` and its facets, by their own laws and by `reference`.
    fn cell(&self, i: usize, reference: &Output) -> Vec<Wrong> {
        let row = &self.rows[i];
        let mut wrong: Vec<Wrong> = self.difference(i, row, reference).into_iter().collect();
        if let Some(facets) = self.facets {
            facets.differences(i, reference, self.bounds, &mut wrong);
            let known = wrong.len();
            facets.own_laws(i, self.diagram, self.bounds, &mut wrong);
            // One reason for a facet is enough.
            let mut k = 0;
            let (before, _) = wrong.split_at(known);
            let before: Vec<_> = before.iter().map(Wrong::place).collect();
            wrong.retain(|w| {
                k += 1;
                k <= known || !before.contains(&w.place())
            });
            let listed = facets.row(i).len() as u64;
            match row.facets {
                Some(count) if count != listed && wrong.iter().all(Wrong::is_facet) => {
                    wrong.push(Wrong::count(i, listed, count));
                }
                _ => {}
            }
        }
        wrong
    }

    fn difference(&self, i: usize, row: &CellRow, reference: &Output) -> Option<Wrong> {
        let (v, expected, status) = (row.volume, reference.volume()[i], reference.status()[i]);
        let off = (v - expected).abs();
        let bound = self.bounds.volume(i, expected);
        let wrong = |what, off, bound| Some(Wrong::cell(row, reference, i, what, [off, bound]));
        if row.site != i as u64 {
            return wrong("order", f64::INFINITY, 0.0);
        }
        // A comparison with NaN does not hold.
        let is_near = off <= bound;
        if !is_near || (v < 0.0 && expected >= 0.0) {
            return wrong("volume", off, bound);
        }
        let nothing = v.abs().max(expected.abs()) <= bound;
        match row.status {
            Some(CellStatus::Empty) if v != 0.0 => return wrong("status", f64::INFINITY, 0.0),
            Some(CellStatus::Empty | CellStatus::Complete) if row.status != Some(status) && !nothing => {
                return wrong("status", f64::INFINITY, 0.0);
            }
            _ => {}
        }
        if v == 0.0 {
            return None;
        }
        if !row.barycenter.iter().all(|x| x.is_finite()) {
            return wrong("barycenter", f64::INFINITY, 0.0);
        }
        if expected == 0.0 {
            return None;
        }
        let distance = bounds::length(bounds::sub(row.barycenter, reference.barycenter()[i]));
        let (off, bound) = (v.abs().min(expected.abs()) * distance, self.bounds.moment(i, expected));
        if off <= bound { None } else { wrong("barycenter", off, bound) }
    }
}

/// `count` of `n` indices at random, all where there are no more.
fn sample(n: usize, count: usize, seed: u64) -> BTreeSet<usize> {
    if count >= n {
        return (0..n).collect();
    }
    // Floyd's algorithm: each set of `count` is as likely as any other, but for the bias of the remainder, below n/2⁶⁴.
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut chosen = BTreeSet::new();
    for last in n - count..n {
        let pick = (random.next_u64() % (last as u64 + 1)) as usize;
        if !chosen.insert(pick) {
            chosen.insert(last);
        }
    }
    chosen
}

/// The laws of the file as a whole.
fn laws(report: &Report, check: &Check<'_>, again: &Output) -> Vec<Law> {
    let bounds = check.bounds;
    let law = |law, file: f64, expected: f64, off: f64, bound: f64| Law {
        law,
        file,
        expected,
        off,
        bound,
        holds: off <= bound,
    };
    let volume = report.domain_volume;
    let mut laws = vec![
        law("volumes", report.volume_sum, volume, report.relative_error * volume, bounds.volume_sum() * volume),
        law("barycenters", report.barycenter_error, 0.0, report.barycenter_error, bounds.barycenter_sum()),
    ];
    if let Some(facets) = check.facets {
        let total = |areas: &mut dyn Iterator<Item = f64>| {
            let mut sum = Sum::default();
            sum.extend(areas);
            sum.total()
        };
        let sum = total(&mut facets.boundary());
        // A bisector that lies in the surface takes its area from it.
        let with_facets = total(&mut again.boundary().into_iter().flatten().map(|b| b.area));
        let expected =
            if (sum - bounds.surface).abs() <= (sum - with_facets).abs() { bounds.surface } else { with_facets };
        laws.push(law("boundaries", sum, expected, (sum - expected).abs(), bounds.boundary_sum()));
    }
    laws
}

impl Findings {
    /// What is wrong, and a few lines for people.
    fn summary(&self) -> String {
        let mut text: String = self.wrong.iter().take(LISTED).map(|w| format!("{}\n", w.line())).collect();
        if self.wrong.len() > LISTED {
            text += &format!("… and {} more, none worse\n", grouped((self.wrong.len() - LISTED) as u64));
        }
        for law in &self.laws {
            let Law { law, file, expected, off, bound, holds } = law;
            let mark = if *holds { "" } else { "  WRONG" };
            text += &match *law {
                "barycenters" => format!("{law:12} off by {off:.1e} of the diagonal (bound {bound:.1e}){mark}\n"),
                _ => format!("{law:12} {file} of {expected}, off by {off:.1e} (bound {bound:.1e}){mark}\n"),
            };
        }
        let asked = grouped(self.checked_by_oracle as u64);
        text + &format!(
            "oracle       {asked} cells clipped by every site, {:.3} s\nverdict      {}\n",
            self.seconds,
            self.verdict()
        )
    }

    /// One line.
    fn verdict(&self) -> String {
        let uncertified = match self.uncertified {
            0 => String::new(),
            count => format!(", {} marked as not certified", grouped(count as u64)),
        };
        if self.right {
            return format!("all {} cells are right{uncertified}", grouped(self.sites as u64));
        }
        let mut parts = Vec::new();
        let first =
            |facet: bool| self.wrong.iter().find(|w| w.is_facet() == facet).map(Wrong::name).unwrap_or_default();
        if self.wrong_cells > 0 {
            let (wrong, sites) = (grouped(self.wrong_cells as u64), grouped(self.sites as u64));
            parts.push(format!("{wrong} of {sites} cells (first {})", first(false)));
        }
        if self.wrong_facets > 0 {
            let plural = if self.wrong_facets == 1 { "" } else { "s" };
            parts.push(format!("{} facet{plural} (first {})", grouped(self.wrong_facets as u64), first(true)));
        }
        for law in self.laws.iter().filter(|law| !law.holds) {
            parts.push(format!("the sum of {}, by {:.1e}", law.law, law.off));
        }
        format!("wrong: {}{uncertified}", parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_of_the_size_asked_for_and_the_same_for_a_seed() {
        assert_eq!(sample(5, 9, 1), (0..5).collect());
        let some = sample(1000, 200, 7);
        assert_eq!((some.len(), &some), (200, &sample(1000, 200, 7)));
        assert!(some != sample(1000, 200, 8) && some.iter().all(|&i| i < 1000));
    }
}
