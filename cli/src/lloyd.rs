//! `laguerre lloyd`: sites moved until each is the barycenter of its cell.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use clap::{Args as ClapArgs, ValueEnum};
use laguerre::io::{self, SITES_ENDINGS};
use laguerre::solvers::lloyd::{self, Iteration, Options, Relaxation};
use laguerre::{Backend, BackendInfo, CellStatus, Error, ErrorKind, Result};
use serde::Serialize;

use crate::args::{BackendArgs, ContainerArgs, SitesArgs};
use crate::container::{Container, Whole};
use crate::density::{DensityArgs, Given};
use crate::files::{check_page, refuse_inputs, share_standard_output};
use crate::outcome::{Outcome, end_well_when_interrupted, note, print, print_json, say};
use crate::page::{self, Page, Plot, Remembering, Timeline};
use crate::report::grouped;
use crate::sites;
use crate::solver::{WithBar, interrupted, open_for_solver, parse_from_zero};

/// Moves sites until each is the barycenter of its cell: a centroidal tessellation. Weights stay as they are.
///
/// The energy is the sum over all cells of the integral of ρ (‖x − p_i‖² − w_i), ρ the density, and barycenters are those of mass: sites crowd where it is high.
/// The gradient that --tolerance bounds has no scale: it is
/// the mean distance (root of the mean square, by mass) of sites from barycenters over the size of the mean cell.
/// Without --domain, --image or --box, the cells are cut by the bounding box that the sites have at the start. Exits with 4 where the gradient is not
/// within the tolerance at the end; the sites are still written. Ctrl-C ends after the diagram that is on its way, and writes the sites of the
/// last iteration; a second one ends at once.
#[derive(ClapArgs, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct LloydArgs {
    #[command(flatten)]
    sites: SitesArgs,

    #[command(flatten)]
    container: ContainerArgs,

    #[command(flatten)]
    density: DensityArgs,

    /// How
    #[arg(long, value_name = "METHOD", default_value = "lbfgs")]
    method: Method,

    /// Iterations at most
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    iterations: u32,

    /// The gradient that is good enough
    #[arg(long, value_name = "G", default_value_t = 1e-3, allow_hyphen_values = true, value_parser = parse_from_zero)]
    tolerance: f64,

    /// Where to write the sites: .xyz, .txt, .csv, .npy or .ply; - for standard output, as .csv
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Where to write a page that shows the cells in 3D at each iteration, for any browser, all in the one file: .html, or - for standard output.
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
  laguerre sample white 10000 --domain out/swan.off --inside -o sites.xyz
  laguerre lloyd sites.xyz --domain out/swan.off -o even.xyz
  laguerre lloyd sites.npy --box 0,0,0,1,1,1 --method lloyd --iterations 20 --json
  laguerre lloyd sites.npy --box 0,0,0,1,1,1 --density 0.1,0,0,1 -o lower.npy
  laguerre lloyd sites.npy --box 0,0,0,1,1,1 --gaussians peaks.csv --constant 0.5 -o crowded.npy";

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Each site to the barycenter of its cell
    Lloyd,
    /// Quasi-Newton on the energy: far fewer diagrams for the same energy
    Lbfgs,
}

/// The object of `--json`.
#[derive(Debug, Serialize)]
struct Report {
    sites: usize,
    method: &'static str,
    iterations: usize,
    /// The last gradient.
    residual: f64,
    converged: bool,
    /// In words; `None` where none is given.
    density: Option<String>,
    energy: f64,
    /// The energy for cells of equal volume, without scale: energy over 3·n·(V/n)^(5/3); 0.0785 for the best lattice. `None` with a density, also the domain's own.
    normalized_energy: Option<f64>,
    evaluations: usize,
    empty: usize,
    seconds: f64,
    backend: &'static str,
    device: String,
    precision: &'static str,
    threads: usize,
    history: Vec<Row>,
}

/// One iteration, the start being the first.
#[derive(Debug, Serialize)]
struct Row {
    energy: f64,
    gradient: f64,
    evaluations: usize,
}

pub(crate) fn run(args: &LloydArgs) -> Result<Outcome> {
    check(args)?;
    let (backend, pool) = open_for_solver(&args.backend)?;
    let mut diagram = Container::read(&args.container)?.restrict(sites::read(&args.sites)?)?;
    let of_sites = |e: Error| if e.kind() == ErrorKind::Input { e.at(sites::name(&args.sites)) } else { e };
    page::check_cells(args.html.as_ref(), &diagram)?;
    let whole = Whole::of(&diagram).map_err(of_sites)?;
    let has_weights = diagram.weights().iter().any(|&weight| weight != 0.0);

    let method = match args.method {
        Method::Lloyd => lloyd::Method::Lloyd,
        Method::Lbfgs => lloyd::Method::Lbfgs,
    };
    let given = args.density.read(backend.as_ref(), &diagram.container().map_err(of_sites)?)?;
    let options =
        Options::default().by(method).of(given.density.clone()).until(args.iterations as usize, args.tolerance);
    let start = Instant::now();
    end_well_when_interrupted();
    let mut count = 0;
    let with_bar = WithBar(backend.as_ref());
    let remembering = Remembering::new(&with_bar, diagram.positions().len());
    let mut timeline = args.html.as_ref().map(|_| Timeline::new(diagram.positions().len()));
    let mut table = |done: &Iteration| {
        if count == 0 && args.output.is_none() && !args.json {
            // Not before: what is wrong is said in one line.
            note("only the energies are printed; name a file with -o to keep the sites");
        }
        if !args.json {
            let header = if count == 0 { "iteration  diagrams        energy      gradient\n" } else { "" };
            let Iteration { energy, gradient, evaluations, .. } = *done;
            // Where nobody reads, the work goes on.
            let _ = print(&format!("{header}{count:9}  {evaluations:8}  {energy:12.6e}  {gradient:12.4e}\n"));
        }
        if let Some(timeline) = &mut timeline {
            timeline.add(|| remembering.moment(format!("iteration {count}"), count));
        }
        count += 1;
        ControlFlow::Continue(())
    };
    // (What is remembered comes back from where it could stay.)
    let watched: &dyn Backend = if args.html.is_some() { &remembering } else { &with_bar };
    let relaxed = pool.install(|| lloyd::relax(watched, &mut diagram, &options, &mut table));
    let relaxed = relaxed.map_err(|e| given.place(e, sites::name(&args.sites)))?;
    let seconds = start.elapsed().as_secs_f64();

    if let Some(path) = &args.output {
        io::write_sites(path, diagram.positions(), diagram.weights())?;
    }
    let report = Report::new(&relaxed, args.method, given, (&whole, has_weights), backend.info(), seconds);
    if let (Some(path), Some(timeline)) = (&args.html, timeline) {
        let (moments, shown) = timeline.finish("iterations");
        let page = report.page(args, shown);
        pool.install(|| page::write_run(path, &page, backend.as_ref(), &diagram, &moments))?;
    }
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.summary())?;
    }
    if report.empty > 0 {
        note(&format!("{} of {} sites have empty cells, and stayed where they were", report.empty, report.sites));
    }
    if relaxed.interrupted {
        return Ok(interrupted(report.iterations, "sites", args.output.as_ref()));
    }
    if report.converged {
        return Ok(Outcome::Done);
    }
    say(&format!(
        "the gradient is {:.1e} of a cell and not within the tolerance of {:.1e}; give more --iterations, or these sites back",
        report.residual, args.tolerance
    ));
    Ok(Outcome::Uncertified)
}

/// What can be said before the work.
fn check(args: &LloydArgs) -> Result<()> {
    args.output.iter().try_for_each(|path| io::check_output(path, SITES_ENDINGS))?;
    check_page(args.html.as_ref(), args.output.iter())?;
    let inputs = [Some(&args.sites.path), args.sites.weights.as_ref(), args.container.file(), args.density.file()];
    args.output.iter().chain(&args.html).try_for_each(|path| refuse_inputs(path, &inputs))?;
    share_standard_output(args.output.iter().chain(&args.html), args.json)
}

impl Report {
    fn new(
        relaxed: &Relaxation,
        method: Method,
        given: Given,
        (whole, has_weights): (&Whole, bool),
        info: BackendInfo,
        seconds: f64,
    ) -> Self {
        let history: Vec<Row> = relaxed
            .iterations
            .iter()
            .map(|&Iteration { energy, gradient, evaluations, .. }| Row { energy, gradient, evaluations })
            .collect();
        let (energy, residual, evaluations) =
            history.last().map_or((0.0, 0.0, 0), |last| (last.energy, last.gradient, last.evaluations));
        let sites = relaxed.output.volume().len();
        let empty = relaxed.output.count(CellStatus::Empty);
        let cells = (sites - empty) as f64;
        let is_plain = given.words.is_none() && !whole.has_density && !has_weights;
        let normalized = energy / (3.0 * whole.volume) / (whole.volume / cells).powf(2.0 / 3.0);
        Self {
            sites,
            method: if method == Method::Lloyd { "lloyd" } else { "lbfgs" },
            iterations: history.len().saturating_sub(1),
            residual,
            converged: relaxed.converged,
            energy,
            normalized_energy: is_plain.then_some(normalized),
            density: given.words,
            evaluations,
            empty,
            seconds,
            backend: info.backend,
            device: info.device,
            precision: info.precision.word(),
            threads: info.threads,
            history,
        }
    }

    fn energy_in_words(&self) -> String {
        let normalized = self.normalized_energy.map(|energy| format!(", {energy:.6} for cells of size 1"));
        format!("{:e}{}", self.energy, normalized.unwrap_or_default())
    }

    /// What the page says beside the cells.
    fn page(&self, args: &LloydArgs, shown: String) -> Page {
        let mut facts = vec![
            ("sites", grouped(self.sites as u64)),
            ("empty cells", grouped(self.empty as u64)),
            ("iterations", format!("{}, {} diagrams", self.iterations, self.evaluations)),
            ("gradient", format!("{:.3e} of a cell", self.residual)),
            ("energy", self.energy_in_words()),
            ("computed in", format!("{:.3} s", self.seconds)),
        ];
        facts.extend(self.density.iter().map(|density| ("density", density.clone())));
        facts.extend(page::made_by(self.backend, &self.device, self.precision, self.threads));
        let values = self.history.iter().map(|row| row.gradient).collect();
        Page {
            title: page::title(
                "Lloyd's cells of",
                &sites::name(&args.sites),
                args.container.file().map(PathBuf::as_path),
            ),
            facts,
            shown,
            plot: Plot::of("gradient", values),
            ..Page::default()
        }
    }

    /// A few lines for people.
    fn summary(&self) -> String {
        let end = if self.converged { "within the tolerance" } else { "not within the tolerance" };
        let density = self.density.as_ref().map(|words| format!("density      {words}\n")).unwrap_or_default();
        format!(
            "sites        {}\n\
             {density}\
             energy       {}\n\
             gradient     {:.3e} of a cell: {end}\n\
             compute      {:.3} s, {} iterations, {} diagrams ({}, {}, {})\n",
            grouped(self.sites as u64),
            self.energy_in_words(),
            self.residual,
            self.seconds,
            self.iterations,
            self.evaluations,
            self.backend,
            self.precision,
            self.device,
        )
    }
}
