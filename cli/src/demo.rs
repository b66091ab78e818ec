//! `laguerre demo`: the main job on built-in input.

use std::fs;
use std::time::Instant;

use laguerre::{Error, ErrorKind, PowerDiagram, Request, Result};

use crate::args::{Corners, DemoArgs};
use crate::container::Whole;
use crate::domains;
use crate::evaluate::{evaluate, open_default};
use crate::integrate::{outcome, write_cells};
use crate::outcome::{Outcome, print};
use crate::picture::draw;
use crate::report::{Report, Seconds};
use crate::sample::Sampler;
use crate::slice::SlicePlane;

/// Lloyd steps from random sites: cells of different sizes still, but no slivers.
const STEPS: usize = 3;
/// Where the picture cuts the bunny: across its z axis, turned and tilted (degrees) so as to meet nose, one whole ear,
/// foot and tail.
const CUT_AT: [f64; 3] = [0.0, 4.83, 0.34];
const CUT_TURNED: f64 = -8.0;
const CUT_TILTED: f64 = -11.0;
/// Width of the picture in pixels.
const WIDTH: u32 = 1200;

pub(crate) fn run(args: &DemoArgs) -> Result<Outcome> {
    let backend = open_default()?;
    let mut seconds = Seconds::default();
    let start = Instant::now();
    let domain = domains::bunny()?;
    let (lo, hi) = domain.bounding_box();
    seconds.read = start.elapsed().as_secs_f64();
    let start = Instant::now();
    domain.grid(args.sites as usize);
    seconds.domain_grid = start.elapsed().as_secs_f64();

    let (sites, _) = Sampler::new(Corners { lo, hi }, Some(&domain), 1).blue(args.sites, 0.0, STEPS)?;
    let diagram = PowerDiagram::new(&sites, &[])?.restricted_to(&domain);
    let start = Instant::now();
    let output = evaluate(backend.as_ref(), &diagram, &Request::moments().with_facets())?;
    seconds.compute = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let folder = &args.out_dir;
    fs::create_dir_all(folder)
        .map_err(|e| Error::new(ErrorKind::Io, format!("{}: cannot make this folder: {e}", folder.display())))?;
    let names = ["cells.csv", "cells.vtu", "cells.png"].map(|name| folder.join(name));
    for path in &names[..2] {
        write_cells(path, backend.as_ref(), &diagram, &output)?;
    }
    draw(&names[2], &diagram, &output, &cut(), WIDTH)?;
    seconds.write = start.elapsed().as_secs_f64();

    let report = Report::new(&output, &Whole::of(&diagram)?, backend.info(), seconds);
    let written = names.map(|path| path.display().to_string()).join(", ");
    print(&format!("{}written      {written}\n", report.summary()))?;
    Ok(outcome(&report))
}

fn cut() -> SlicePlane {
    let (sin_turn, cos_turn) = CUT_TURNED.to_radians().sin_cos();
    let (sin_tilt, cos_tilt) = CUT_TILTED.to_radians().sin_cos();
    SlicePlane {
        origin: CUT_AT,
        u: [cos_turn, 0.0, sin_turn],
        v: [-sin_tilt * sin_turn, cos_tilt, sin_tilt * cos_turn],
    }
}
