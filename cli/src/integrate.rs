//! `laguerre integrate`: the main job.

use std::path::{Path, PathBuf};
use std::time::Instant;

use laguerre::io::{self, CELLS_ENDINGS, FACETS_ENDINGS, GEOMETRY_ENDINGS};
use laguerre::{Error, ErrorKind, Output, PowerDiagram, Request, Result};

use crate::args::IntegrateArgs;
use crate::container::{Container, Whole, note_if_coincident, note_if_merged};
use crate::derivatives;
use crate::evaluate::{evaluate, open};
use crate::files::{check_page, names_same_file, refuse_inputs, share_standard_output};
use crate::npz;
use crate::outcome::{Outcome, note, print, print_json, say};
use crate::page::{self, Page};
use crate::report::{Report, Seconds};
use crate::sites;

pub(crate) fn run(args: &IntegrateArgs) -> Result<Outcome> {
    check(args)?;
    let backend = open(&args.backend)?;
    let mut seconds = Seconds::default();

    let start = Instant::now();
    let diagram = sites::read(&args.sites)?;
    let container = Container::read(&args.container)?;
    let diagram = container.restrict(diagram)?;
    page::check_cells(args.html.as_ref(), &diagram)?;
    let whole = Whole::of(&diagram).map_err(|e| e.at(sites::name(&args.sites)))?;
    note_if_apart(&diagram, &whole);
    note_if_merged(&diagram)?;
    seconds.read = start.elapsed().as_secs_f64();

    if let Some(domain) = container.domain() {
        let start = Instant::now();
        domain.grid(diagram.positions().len());
        seconds.domain_grid = start.elapsed().as_secs_f64();
    }

    let request = Request::moments();
    let request = if args.facets.is_some() { request.with_facets() } else { request };
    let request = if args.second_moments { request.with_second_moments() } else { request };
    let has_geometry = args.output.as_deref().is_some_and(|path| io::ending(path, GEOMETRY_ENDINGS).is_ok());
    let request = if has_geometry || args.html.is_some() { request.with_geometry() } else { request };
    let request = if args.derivatives.is_empty() { request } else { derivatives::request(request) };
    let request = args.integral.iter().cloned().fold(request, Request::with_integral);
    let has_solids = args.output.as_deref().is_some_and(|path| io::ending(path, &[".vtu"]).is_ok());
    let request = if has_solids { request.with_solids() } else { request };
    let request = args.epsilon.into_iter().fold(request, Request::with_epsilon);
    let start = Instant::now();
    request.check(&diagram)?;
    // What is wrong with valid input only now: a site out of the container's range, or too many for the memory.
    let of_sites = |e: Error| if e.kind() == ErrorKind::Input { e.at(sites::name(&args.sites)) } else { e };
    let output = evaluate(backend.as_ref(), &diagram, &request).map_err(of_sites)?;
    seconds.compute = start.elapsed().as_secs_f64();
    note_if_coincident(&diagram, &output);

    let start = Instant::now();
    if let Some(path) = &args.output {
        write_cells(path, &diagram, &output)?;
    }
    if let Some(path) = &args.facets {
        npz::write_facets(path, &diagram, &output)?;
    }
    args.derivatives.iter().try_for_each(|asked| derivatives::write(asked, &diagram, &output))?;
    if let Some(path) = &args.html {
        let report = Report::new(&output, &whole, backend.info(), seconds);
        let title = page::title("Cells of", &sites::name(&args.sites), args.container.file().map(PathBuf::as_path));
        page::write_still(
            path,
            &Page { title, facts: page::facts(&report), ..Page::default() },
            &diagram,
            &output,
            &(),
        )?;
    }
    seconds.write = start.elapsed().as_secs_f64();

    let report = Report::new(&output, &whole, backend.info(), seconds);
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.summary())?;
    }
    if outputs(args).next().is_none() && !args.json && report.uncertified == 0 {
        note("only the summary is printed; name a file with -o to keep the cells");
    }
    Ok(outcome(&report))
}

/// Says what a user must know of the result, and how the program is to end.
pub(crate) fn outcome(report: &Report) -> Outcome {
    if report.uncertified == 0 {
        return Outcome::Done;
    }
    say(&format!(
        "{} of {} cells are not certified and may be too large (the volumes sum to the domain's but for {:.1e}); \
         leave --epsilon out for cells that are complete by proof",
        report.uncertified, report.sites, report.relative_error
    ));
    Outcome::Uncertified
}

/// Writes the cells by the file's ending.
pub(crate) fn write_cells(path: &Path, diagram: &PowerDiagram, output: &Output) -> Result<()> {
    if io::ending(path, &[npz::ENDING]).is_ok() {
        return npz::write_cells(path, output);
    }
    if io::output_ending(path, CELLS_ENDINGS).is_ok() {
        return io::write_cells(path, diagram, output);
    }
    io::write_geometry(path, diagram, output)
}

/// What can be said before the work.
fn check(args: &IntegrateArgs) -> Result<()> {
    if let Some(path) = &args.output {
        let known = CELLS_ENDINGS.iter().chain(&[npz::ENDING]).chain(GEOMETRY_ENDINGS).copied();
        let known: Vec<&'static str> = known.collect();
        io::check_output(path, &known)?;
    }
    if let Some(path) = &args.facets {
        io::check_output(path, &npz::with_npz(FACETS_ENDINGS))?;
        if args.output.as_ref().is_some_and(|cells| names_same_file(cells, path)) {
            return Err(Error::input(format!("{}: named for cells and for facets; give two files", path.display())));
        }
    }
    for asked in &args.derivatives {
        io::check_output(&asked.path, &[npz::ENDING])?;
        if outputs(args).filter(|path| names_same_file(path, &asked.path)).count() > 1 {
            return Err(Error::input(format!("{}: named for two outputs; give two files", asked.path.display())));
        }
    }
    let others = args.output.iter().chain(&args.facets).chain(args.derivatives.iter().map(|asked| &asked.path));
    check_page(args.html.as_ref(), others)?;
    let has_room = args.output.as_ref().is_some_and(|path| io::ending(path, &[npz::ENDING]).is_ok());
    if args.second_moments && !has_room {
        return Err(Error::input("--second-moments: only .npz has room for them; name one with -o"));
    }
    let inputs = [Some(&args.sites.path), args.sites.weights.as_ref(), args.container.file()];
    outputs(args).try_for_each(|path| refuse_inputs(path, &inputs))?;
    share_standard_output(outputs(args), args.json)
}

/// All files that are to be written.
fn outputs(args: &IntegrateArgs) -> impl Iterator<Item = &PathBuf> {
    args.output.iter().chain(&args.facets).chain(&args.html).chain(args.derivatives.iter().map(|asked| &asked.path))
}

/// Every point of a domain belongs to some cell, so sites that are all elsewhere give an answer; it is seldom the one wanted.
fn note_if_apart(diagram: &PowerDiagram, whole: &Whole) {
    let inside = |p: &[f64; 3]| (0..3).all(|k| whole.lo[k] <= p[k] && p[k] <= whole.hi[k]);
    if !diagram.positions().iter().any(inside) {
        note("no site is in the domain's box; are sites and domain in the same unit and place?");
    }
}
