//! `laguerre transport`: weights such that each cell has the mass asked for.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args as ClapArgs;
use laguerre::engine::memory;
use laguerre::io::{self, CELLS_ENDINGS, WEIGHTS_ENDINGS};
use laguerre::solvers::transport::{self, Cause, End, Iteration, Options, Solution};
use laguerre::{Backend, BackendInfo, Error, ErrorKind, Result};
use serde::Serialize;

use crate::args::{BackendArgs, ContainerArgs, SitesArgs};
use crate::container::Container;
use crate::density::{DensityArgs, Given};
use crate::files::{check_page, names_same_file, refuse_inputs, share_standard_output};
use crate::outcome::{Outcome, end_well_when_interrupted, note, print, print_json, say};
use crate::page::{self, Page, Plot, Remembering, Timeline};
use crate::report::grouped;
use crate::sites;
use crate::solver::{LARGEST, WithBar, interrupted, open_for_solver, parse_number};

/// Finds weights such that each cell has the mass asked for: semi-discrete optimal transport, by a damped Newton.
///
/// What the sites or --weights give is where it starts. The residual is the largest relative error of a cell's mass.
/// Without --domain, --image or --box, the cells are cut by the bounding box of the sites. Exits with 4 where the residual is not within the
/// tolerance at the end; the weights are still written. Ctrl-C ends after the diagram that is on its way, and writes the weights of the last
/// step; a second one ends at once.
#[derive(ClapArgs, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct TransportArgs {
    #[command(flatten)]
    sites: SitesArgs,

    #[command(flatten)]
    container: ContainerArgs,

    /// The masses asked for, one for each site: .txt or .csv (one a line) or .npy; all equal unless given
    #[arg(long, value_name = "FILE")]
    masses: Option<PathBuf>,

    /// Scale the masses, so that they sum to the domain's; without this they have to
    #[arg(long, requires = "masses")]
    normalize: bool,

    #[command(flatten)]
    density: DensityArgs,

    /// Largest relative error of a cell's mass that is good enough
    #[arg(long, value_name = "T", default_value_t = 1e-9, allow_hyphen_values = true, value_parser = parse_tolerance)]
    tolerance: f64,

    /// Newton steps at most
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    iterations: u32,

    /// Where to write the weights: .txt or .csv (one a line), .npy, or - for standard output; integrate and transport read them with --weights
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Where to write the cells: .csv (site,volume,x,y,z,facets,status), .npy (volume, barycenter) or - for standard output
    #[arg(long, value_name = "FILE")]
    cells: Option<PathBuf>,

    /// Where to write a page that shows the cells in 3D at each Newton step, for any browser, all in the one file: .html, or - for standard output.
    /// Where there are many, some of them, 100 at most, so that the page has no more than 200,000 cells in all, or two; each is computed once more for it
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    #[command(flatten)]
    backend: BackendArgs,

    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  laguerre transport sites.xyz --domain out/swan.off -o weights.txt
  laguerre integrate sites.xyz --weights weights.txt --domain out/swan.off -o cells.csv
  laguerre transport sites.npy --box 0,0,0,1,1,1 --density 1,0,0,0.5 --masses masses.npy --json
  laguerre transport sites.npy --box 0,0,0,1,1,1 --masses shares.txt --normalize -o weights.npy
  laguerre transport sites.npy --box 0,0,0,1,1,1 --gaussians peaks.csv --constant 0.5 -o weights.npy";

/// The object of `--json`.
#[derive(Debug, Serialize)]
struct Report {
    sites: usize,
    /// Newton steps.
    iterations: usize,
    /// Largest relative error of a cell's mass.
    residual: f64,
    converged: bool,
    /// In words; `None` where none is given.
    density: Option<String>,
    /// Of all cells.
    mass: f64,
    /// Σ ∫ ρ ‖x − p_i‖² over the cells.
    cost: Option<f64>,
    evaluations: usize,
    linear_iterations: usize,
    seconds: f64,
    diagram_seconds: f64,
    solver_seconds: f64,
    backend: &'static str,
    device: String,
    precision: &'static str,
    threads: usize,
    history: Vec<Row>,
}

/// One Newton step, the start being the first.
#[derive(Debug, Serialize)]
struct Row {
    residual: f64,
    step: f64,
    evaluations: usize,
    linear_iterations: usize,
    diagram_seconds: f64,
    solver_seconds: f64,
}

/// Bytes for each site: diagrams, and the multigrid of the steps (100,000 sites inside the bunny take 84 MB more than 50,000).
const SITE: u64 = 1_700;

pub(crate) fn run(args: &TransportArgs) -> Result<Outcome> {
    check(args)?;
    let (backend, pool) = open_for_solver(&args.backend)?;
    let of_sites = |e: Error| if e.kind() == ErrorKind::Input { e.at(sites::name(&args.sites)) } else { e };
    let mut diagram = Container::read(&args.container)?.restrict(sites::read(&args.sites)?)?;
    memory::probe(diagram.positions().len() as u64, SITE, "sites of a transport").map_err(of_sites)?;
    page::check_cells(args.html.as_ref(), &diagram)?;
    let masses = args.masses.as_ref().map(io::read_weights).transpose()?.unwrap_or_default();
    let given = args.density.read(backend.as_ref(), &diagram.container().map_err(of_sites)?)?;
    let options = Options::default().of(given.density.clone()).until(args.iterations as usize, args.tolerance);
    let options = if args.normalize { options.normalized() } else { options };
    // (Text counts them.)
    let is_text = args.cells.as_ref().is_some_and(|path| path.extension().is_none_or(|ending| ending != "npy"));
    let options = if is_text { options.with_facets() } else { options };
    if let Some(path) = &args.masses {
        let aimed = transport::targets(backend.as_ref(), &diagram, &masses, &options);
        let aimed = aimed.map_err(|e| given.place(e, path.display()))?;
        let factor = aimed[0] / masses[0];
        if (factor - 1.0).abs() > args.tolerance {
            note(&format!("{}: each mass is multiplied by {factor:?}: they then sum to the domain's", path.display()));
        }
    }
    let with_bar = WithBar(backend.as_ref());
    let remembering = Remembering::new(&with_bar, diagram.positions().len());
    let mut timeline = args.html.as_ref().map(|_| Timeline::new(diagram.positions().len()));
    let mut row = |done: &Iteration| {
        if done.number == 0 && args.output.is_none() && !args.json {
            // Not before: what is wrong is said in one line.
            note("the weights are not kept; name a file with -o for them");
        }
        if !args.json {
            let header = if done.number == 0 { HEADER } else { "" };
            // Where nobody reads, the work goes on.
            let _ = print(&format!("{header}{}", line(done)));
        }
        if let Some(timeline) = &mut timeline {
            timeline.add(|| remembering.moment(format!("step {}", done.number), done.number));
        }
        ControlFlow::Continue(())
    };
    let start = Instant::now();
    end_well_when_interrupted();
    // (What is remembered is a copy each time.)
    let watched: &dyn Backend = if args.html.is_some() { &remembering } else { &with_bar };
    let solution = pool.install(|| transport::solve(watched, &mut diagram, &masses, &options, &mut row));
    let solution = solution.map_err(|e| given.place(e, sites::name(&args.sites)))?;
    let seconds = start.elapsed().as_secs_f64();

    if let Some(path) = &args.output {
        io::write_weights(path, &solution.weights)?;
    }
    if let Some(path) = &args.cells {
        io::write_cells(path, &diagram, &solution.output)?;
    }
    let report = Report::new(&solution, given, backend.info(), seconds);
    if let (Some(path), Some(timeline)) = (&args.html, timeline) {
        let (moments, shown) = timeline.finish("steps");
        let page = report.page(args, shown);
        pool.install(|| page::write_run(path, &page, backend.as_ref(), &diagram, &moments))?;
    }
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.summary())?;
    }
    let Solution { end, residual, worst, .. } = solution;
    let why = match end {
        End::Converged => return Ok(Outcome::Done),
        End::Interrupted => return Ok(interrupted(report.iterations, "weights", args.output.as_ref())),
        End::Stalled => {
            let advice = match worst.cause {
                Some(Cause::Rounding { .. }) => "; give a larger --tolerance, or move or remove one of them",
                _ => "",
            };
            format!("no shorter step makes it smaller: {worst}{advice}")
        }
        End::MostIterations => {
            format!("{worst}; give more --iterations, or these weights back with --weights")
        }
        _ => worst.to_string(),
    };
    say(&format!("the residual is {residual:.1e} and not within the tolerance of {:.1e}; {why}", args.tolerance));
    Ok(Outcome::Uncertified)
}

/// What can be said before the work.
fn check(args: &TransportArgs) -> Result<()> {
    args.output.iter().try_for_each(|path| io::check_output(path, WEIGHTS_ENDINGS))?;
    args.cells.iter().try_for_each(|path| io::check_output(path, CELLS_ENDINGS))?;
    if let (Some(path), Some(cells)) = (&args.output, &args.cells)
        && names_same_file(path, cells)
    {
        return Err(Error::input(format!("{}: named for weights and for cells; give two files", path.display())));
    }
    let inputs = [
        Some(&args.sites.path),
        args.sites.weights.as_ref(),
        args.container.file(),
        args.masses.as_ref(),
        args.density.file(),
    ];
    check_page(args.html.as_ref(), args.output.iter().chain(&args.cells))?;
    let outputs = || args.output.iter().chain(&args.cells).chain(&args.html);
    outputs().try_for_each(|path| refuse_inputs(path, &inputs))?;
    share_standard_output(outputs(), args.json)
}

impl Report {
    fn new(solution: &Solution, given: Given, info: BackendInfo, seconds: f64) -> Self {
        let history: Vec<Row> = solution.iterations.iter().map(Row::from).collect();
        Self {
            sites: solution.weights.len(),
            iterations: history.len().saturating_sub(1),
            residual: solution.residual,
            converged: solution.end == End::Converged,
            density: given.words,
            mass: solution.masses.iter().sum(),
            cost: solution.cost,
            evaluations: history.iter().map(|row| row.evaluations).sum(),
            linear_iterations: history.iter().map(|row| row.linear_iterations).sum(),
            seconds,
            diagram_seconds: history.iter().map(|row| row.diagram_seconds).sum(),
            solver_seconds: history.iter().map(|row| row.solver_seconds).sum(),
            backend: info.backend,
            device: info.device,
            precision: info.precision.word(),
            threads: info.threads,
            history,
        }
    }

    /// What the page says beside the cells.
    fn page(&self, args: &TransportArgs, shown: String) -> Page {
        let mut facts = vec![
            ("sites", grouped(self.sites as u64)),
            ("steps", format!("{} of Newton, {} diagrams", self.iterations, self.evaluations)),
            ("residual", format!("{:.1e}", self.residual)),
            ("computed in", format!("{:.3} s", self.seconds)),
        ];
        facts.extend(self.density.iter().map(|density| ("density", density.clone())));
        facts.extend(self.cost.map(|cost| ("cost", format!("{cost:e}"))));
        facts.extend(page::made_by(self.backend, &self.device, self.precision, self.threads));
        let values = self.history.iter().map(|row| row.residual).collect();
        Page {
            title: page::title("Transport to", &sites::name(&args.sites), args.container.file().map(PathBuf::as_path)),
            facts,
            shown,
            plot: Plot::of("residual", values),
            ..Page::default()
        }
    }

    /// A few lines for people.
    fn summary(&self) -> String {
        let cost = self.cost.map_or_else(|| "not computed".into(), |cost| format!("{cost:e}"));
        let density = self.density.as_ref();
        let density = density.map(|words| format!("density      {words}; mass {:?}\n", self.mass)).unwrap_or_default();
        format!(
            "sites        {}\n\
             {density}\
             residual     {:.1e} after {} Newton steps\n\
             cost         {cost}\n\
             compute      {:.3} s: {} diagrams {:.3} s, solver {:.3} s ({}, {}, {})\n",
            grouped(self.sites as u64),
            self.residual,
            self.iterations,
            self.seconds,
            self.evaluations,
            self.diagram_seconds,
            self.solver_seconds,
            self.backend,
            self.precision,
            self.device,
        )
    }
}

impl From<&Iteration> for Row {
    fn from(done: &Iteration) -> Self {
        let Iteration { residual, step, linear_iterations, diagram_seconds, solver_seconds, .. } = *done;
        let evaluations = done.diagram_evaluations;
        Self { residual, step, evaluations, linear_iterations, diagram_seconds, solver_seconds }
    }
}

/// Above the rows of the table.
const HEADER: &str = "iteration  residual      step  diagrams  linear  seconds: diagram   solver\n";

/// A row of the table.
fn line(done: &Iteration) -> String {
    format!(
        "{:9}  {:8.2e}  {:8.2e}  {:8}  {:6}  {:16.3}  {:7.3}\n",
        done.number,
        done.residual,
        done.step,
        done.diagram_evaluations,
        done.linear_iterations,
        done.diagram_seconds,
        done.solver_seconds
    )
}

fn parse_tolerance(text: &str) -> std::result::Result<f64, String> {
    parse_number(text, |x| x > 0.0, &format!("above 0, at most {LARGEST:e},"))
}
