//! `laguerre bench --uneven`: what a site of each uneven input takes, over one of white noise in the same run.

use laguerre::oracle::Naive;
use laguerre::{Backend, CellStatus, Output, PowerDiagram, Request, Result};
use rayon::prelude::*;
use serde::Serialize;

use super::{SEED, Table, backends};
use crate::args::Corners;
use crate::args::{BenchArgs, Distribution};
use crate::outcome::{Outcome, note, print, print_json, say};
use crate::report::{grouped, machine};
use crate::sample::Sampler;
use crate::timing::{Timing, measure};
use crate::uneven::{INPUTS, Uneven};

/// Cells of each input that all sites cut, for `--check`.
const CHECKED: usize = 500;
/// How far the volume of a cell may be off the oracle's, in units of the mean volume.
const BOUND: f64 = 1e-12;
/// And besides in units of its own: some roundings, which show where one cell is nearly all of the cube.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// What the inputs are compared with.
const WHITE: &str = "white";

#[derive(Serialize)]
struct Row {
    input: &'static str,
    backend: &'static str,
    device: String,
    sites: usize,
    seconds: Timing,
    /// Of the fastest call, or of what the device computed.
    seconds_per_site: f64,
    /// That over what a site of as many white ones takes.
    over_white: f64,
    /// What that is to be at most.
    limit: Option<f64>,
    uncertified: usize,
    /// None without `--check`.
    oracle: Option<Verdict>,
}

#[derive(Clone, Copy, Serialize)]
struct Verdict {
    checked: usize,
    wrong: usize,
    /// The largest difference of a volume from the oracle's, in units of the mean volume.
    volume_off: f64,
}

/// `chosen` inputs, or all, and white noise of each number of sites before.
pub(super) fn run(args: &BenchArgs, chosen: &[&'static Uneven]) -> Result<Outcome> {
    let chosen = available(chosen)?;
    let backends = backends(args)?;
    let (machine, threads) = machine();
    let mut table = Table { machine, threads: args.threads.unwrap_or(threads), rows: Vec::new() };
    if !args.json {
        print(&format!(
            "{}, {} threads\n\n{}{}",
            table.machine,
            table.threads,
            line(&HEADER.map(str::to_owned)),
            RULE
        ))?;
    }
    for &count in &args.sites {
        for input in &chosen {
            let count = count.min(input.most.unwrap_or(count));
            // What white noise of that number takes, once; and what is bounded runs once for all larger numbers.
            for input in [None, Some(*input)] {
                let name = input.map_or(WHITE, |input| input.name);
                if !table.rows.iter().any(|row: &Row| (row.input, row.sites) == (name, count as usize)) {
                    rows(args, &backends, input, count, &mut table.rows)?;
                }
            }
        }
    }
    if args.json {
        print_json(&table)?;
    }
    Ok(outcome(&table.rows))
}

/// Those of `chosen`; where none is, all, but for such as cannot be made here: one needs a file that is no part of the program.
fn available(chosen: &[&'static Uneven]) -> Result<Vec<&'static Uneven>> {
    if !chosen.is_empty() {
        chosen.iter().try_for_each(|input| input.sites(1, SEED).map(drop))?;
        return Ok(chosen.to_vec());
    }
    let mut inputs: Vec<&Uneven> = INPUTS.iter().collect();
    inputs.retain(|input| match input.sites(1, SEED) {
        Ok(_) => true,
        Err(error) => {
            note(&format!("{} is left out: {error}", input.name));
            false
        }
    });
    Ok(inputs)
}

/// A row of each backend for an input, white noise where there is none.
fn rows(
    args: &BenchArgs,
    backends: &[Box<dyn Backend>],
    input: Option<&'static Uneven>,
    count: u32,
    rows: &mut Vec<Row>,
) -> Result<()> {
    let diagram = match input {
        Some(input) => {
            let cloud = input.sites(count, SEED)?;
            PowerDiagram::new(&cloud.positions, &cloud.weights)?
        }
        None => {
            PowerDiagram::new(&Sampler::new(Corners::UNIT_CUBE, None, SEED).sample(Distribution::White, count)?, &[])?
        }
    };
    let mut diagram = diagram.in_box(Corners::UNIT_CUBE.lo, Corners::UNIT_CUBE.hi)?;
    let oracle = if args.check { Some(Oracle::ask(&diagram)?) } else { None };
    let known = rows.len();
    for (k, backend) in backends.iter().enumerate() {
        let (seconds, output) = measure(backend.as_ref(), &mut diagram, &Request::moments(), args.repetitions)?;
        let info = backend.info();
        let seconds_per_site = seconds.own() / f64::from(count);
        // White rows are there for all backends before those of an input, in the same order.
        let white = rows[..known].iter().filter(|row| (row.input, row.sites) == (WHITE, count as usize)).nth(k);
        let row = Row {
            input: input.map_or(WHITE, |input| input.name),
            backend: info.backend,
            device: info.device,
            sites: count as usize,
            seconds,
            seconds_per_site,
            over_white: white.map_or(1.0, |white| seconds_per_site / white.seconds_per_site.max(f64::MIN_POSITIVE)),
            limit: input.and_then(|input| input.limit),
            uncertified: output.count(CellStatus::Uncertified),
            oracle: oracle.as_ref().map(|oracle| oracle.judge(&output)),
        };
        if !args.json {
            print(&line(&row.cells()))?;
        }
        rows.push(row);
    }
    Ok(())
}

/// Some cells as all sites cut them.
struct Oracle {
    /// The site of each, its volume and status.
    cells: Vec<(usize, f64, CellStatus)>,
    mean: f64,
}

impl Oracle {
    /// Computes evenly spaced cells, [`CHECKED`] or all there are.
    fn ask(diagram: &PowerDiagram) -> Result<Self> {
        let n = diagram.positions().len();
        let checked = n.min(CHECKED);
        let asked: Vec<u32> = (0..checked).map(|i| (i * n / checked) as u32).collect();
        // Each share sorts the sites anew.
        let share = checked.div_ceil(rayon::current_num_threads()).max(1);
        let shares: Vec<Vec<_>> = asked
            .par_chunks(share)
            .map(|some| {
                let output = Naive::only(some).evaluate(diagram, &Request::moments())?;
                let cell =
                    |&site: &u32| (site as usize, output.volume()[site as usize], output.status()[site as usize]);
                Ok(some.iter().map(cell).collect())
            })
            .collect::<Result<_>>()?;
        Ok(Self { cells: shares.concat(), mean: 1.0 / n as f64 })
    }

    fn judge(&self, output: &Output) -> Verdict {
        let mut verdict = Verdict { checked: self.cells.len(), wrong: 0, volume_off: 0.0 };
        for &(site, volume, status) in &self.cells {
            let off = (output.volume()[site] - volume).abs() / self.mean;
            verdict.volume_off = verdict.volume_off.max(off);
            // A comparison with NaN does not hold.
            let is_near = off <= BOUND + ROUNDING * volume.abs() / self.mean;
            if !is_near || output.status()[site] != status {
                verdict.wrong += 1;
            }
        }
        verdict
    }
}

/// How the program is to end, after saying which inputs are wrong.
fn outcome(rows: &[Row]) -> Outcome {
    let wrong = |row: &Row| row.oracle.is_some_and(|oracle| oracle.wrong > 0);
    let names = |bad: &dyn Fn(&Row) -> bool| {
        let mut names: Vec<&str> = rows.iter().filter(|&row| bad(row)).map(|row| row.input).collect();
        names.dedup();
        names.join(", ")
    };
    if rows.iter().any(wrong) {
        say(&format!("cells are not the oracle's: {}", names(&wrong)));
        return Outcome::Refuted;
    }
    if rows.iter().any(|row| row.uncertified > 0) {
        say(&format!("cells are not certified: {}", names(&|row| row.uncertified > 0)));
        return Outcome::Uncertified;
    }
    Outcome::Done
}

const HEADER: [&str; 9] =
    ["input", "backend", "sites", "median [min, max]", "µs/site", "over white", "limit", "uncertified", "oracle"];
const WIDTHS: [usize; 9] = [17, 7, 10, 26, 8, 10, 5, 11, 14];
const RULE: &str = "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |\n";

impl Row {
    fn cells(&self) -> [String; 9] {
        let over = format!("{:.2}", self.over_white);
        let oracle = self.oracle.map_or_else(
            || "-".into(),
            |Verdict { checked, wrong, .. }| match wrong {
                0 => format!("{checked} equal"),
                _ => format!("**{wrong} of {checked} wrong**"),
            },
        );
        [
            self.input.into(),
            self.backend.into(),
            grouped(self.sites as u64),
            self.seconds.spread(),
            format!("{:.3}", 1e6 * self.seconds_per_site),
            if self.limit.is_some_and(|limit| self.over_white > limit) { format!("**{over}**") } else { over },
            self.limit.map_or_else(|| "-".into(), |limit| limit.to_string()),
            grouped(self.uncertified as u64),
            oracle,
        ]
    }
}

fn line(cells: &[String; 9]) -> String {
    let cells: Vec<String> = cells.iter().zip(WIDTHS).map(|(cell, width)| format!("{cell:width$}")).collect();
    format!("| {} |\n", cells.join(" | "))
}
