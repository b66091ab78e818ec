//! `laguerre demo`: the main job on built-in input.

use std::fmt::Write as _;
use std::fs;
use std::time::Instant;

use laguerre::{Domain, Error, ErrorKind, PowerDiagram, Request, Result, io};

use crate::args::{Corners, DemoArgs};
use crate::container::Whole;
use crate::domains;
use crate::evaluate::{evaluate, open_default};
use crate::integrate::{outcome, write_cells};
use crate::outcome::{Outcome, print, print_json};
use crate::page::{self, Page};
use crate::picture::draw;
use crate::report::{Report, Seconds, grouped};
use crate::sample::Sampler;
use crate::slice::SlicePlane;

/// Lloyd steps from random sites: cells of different sizes still, but no slivers.
const STEPS: usize = 3;
/// Where the picture cuts the swan: in the plane that mirrors it, from beak to tail.
const CUT: SlicePlane = SlicePlane { origin: [0.0; 3], u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] };
/// Width of the picture in pixels.
const WIDTH: u32 = 1200;

pub(crate) fn run(args: &DemoArgs) -> Result<Outcome> {
    let backend = open_default()?;
    let mut seconds = Seconds::default();
    let start = Instant::now();
    let domain = domains::swan()?;
    let (lo, hi) = domain.bounding_box();
    seconds.read = start.elapsed().as_secs_f64();
    let start = Instant::now();
    domain.grid(args.sites as usize);
    seconds.domain_grid = start.elapsed().as_secs_f64();

    let (sites, _) = Sampler::new(Corners { lo, hi }, Some(&domain), 1).blue(args.sites, 0.0, STEPS)?;
    let diagram = PowerDiagram::new(&sites, &[])?.restricted_to(&domain);
    let start = Instant::now();
    let output = evaluate(backend.as_ref(), &diagram, &Request::moments().with_facets().with_solids())?;
    seconds.compute = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let folder = &args.out_dir;
    fs::create_dir_all(folder)
        .map_err(|e| Error::new(ErrorKind::Io, format!("{}: cannot make this folder: {e}", folder.display())))?;
    let names = ["swan.off", "cells.csv", "cells.vtu", "cells.png", "cells.html"].map(|name| folder.join(name));
    let mesh = off(&domain);
    io::write_whole(&names[0], |w| w.write_all(mesh.as_bytes()))?;
    for path in &names[1..3] {
        write_cells(path, &diagram, &output)?;
    }
    draw(&names[3], &diagram, &output, &CUT, WIDTH)?;
    let whole = Whole::of(&diagram)?;
    let facts = page::facts(&Report::new(&output, &whole, backend.info(), seconds));
    let page =
        Page { title: format!("Cells of {} sites in a swan", grouped(args.sites.into())), facts, ..Page::default() };
    page::write_still(&names[4], &page, &diagram, &output, &())?;
    seconds.write = start.elapsed().as_secs_f64();

    let report = Report::new(&output, &whole, backend.info(), seconds);
    if args.json {
        print_json(&report)?;
    } else {
        let written = names.map(|path| path.display().to_string()).join(", ");
        print(&format!("{}written      {written}\n", report.summary()))?;
    }
    Ok(outcome(&report))
}

/// A domain as the text of an OFF file; `{:?}` is the shortest text that reads back to the same number.
fn off(domain: &Domain) -> String {
    let mut text = format!("OFF\n{} {} 0\n", domain.vertices().len(), domain.triangles().len());
    for [x, y, z] in domain.vertices() {
        let _ = writeln!(text, "{x:?} {y:?} {z:?}");
    }
    for [a, b, c] in domain.triangles() {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text
}
