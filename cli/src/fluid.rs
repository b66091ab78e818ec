//! `laguerre fluid`: incompressible fluid by power particles.

mod checkpoint;
mod frames;
mod pages;
mod report;
mod series;

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args as ClapArgs, ValueEnum};
use laguerre::Container;
use laguerre::solvers::fluid::{Fluid, Scene, lattice, settle};
use laguerre::{Backend, Domain, Error, Result, io};

use crate::args::{BackendArgs, Corners, parse_count};
use crate::domains;
use crate::files::{check_page, refuse_inputs, share_standard_output};
use crate::outcome::{Outcome, end_well_when_interrupted, is_interrupted, note, print, print_json, say};
use crate::page;
use crate::sample::{BLUE_SPREAD, MOST_STEPS, Sampler};
use crate::solver::{LARGEST, open_for_solver, parse_from_zero, parse_number};
use checkpoint::Checkpoint;
use frames::{FrameKind, Frames};
use pages::Pages;
use report::{Report, Step};

/// Incompressible fluid by power particles: every particle has a cell of its own, all of the same volume.
///
/// Each time step moves the particles, finds the weights for which all cells have the same volume (to 1e-6), and pulls each particle
/// towards the barycenter of its cell by a spring of time scale ε. Up is +y. Ctrl-C ends after the step, with checkpoint and film written.
#[derive(ClapArgs, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct FluidArgs {
    /// The fluid to begin with
    #[arg(value_name = "SCENE", required_unless_present = "resume")]
    scene: Option<SceneName>,

    /// Number of particles, or as near to it as a lattice comes in a box
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = parse_count::<2, 100_000_000>)]
    particles: u32,

    /// End after step N, counted from the scene's beginning
    #[arg(long, value_name = "N", default_value_t = 300)]
    steps: u64,

    /// The time step; ε√ρ/4, or less where a particle would go farther than half a cell, unless given
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = parse_positive)]
    dt: Option<f64>,

    /// Time scale of the springs; such that the scene stretches them by a quarter of a cell or less, unless given
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = parse_positive)]
    epsilon: Option<f64>,

    /// Kinematic viscosity (length²/time); none for vortices and snow, else such that the waves of a border that grow fastest are six cells
    /// long, unless given
    #[arg(long, value_name = "NU", allow_hyphen_values = true, value_parser = parse_from_zero)]
    viscosity: Option<f64>,

    /// Gravity downwards (length/time²); such that half the container's height is fallen through in a unit of time, unless given
    #[arg(long, value_name = "G", allow_hyphen_values = true, value_parser = parse_finite)]
    gravity: Option<f64>,

    /// A closed triangle mesh that the fluid fills, instead of the scene's box or swan: .obj, .off, .ply, .stl, .vtk or .vtp, or with .gz after that
    #[arg(long, value_name = "MESH")]
    domain: Option<PathBuf>,

    /// Another seed places the particles in a mesh otherwise
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,

    /// Where to write frames, as frame-000123.…; made if it is not there
    #[arg(long, value_name = "DIR")]
    out_dir: Option<PathBuf>,

    /// Steps from one frame, and one checkpoint, to the next
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,

    /// What a frame is: vtu and ply have the particles, png is a slice through the cells; frames.pvd has the times of the .vtu, for ParaView
    #[arg(long, value_name = "KIND,…", value_delimiter = ',', default_values = ["png"], requires = "out_dir")]
    frames: Vec<FrameKind>,

    /// Where to write a film of the slices: .gif. Colours are densities, lighter where a particle is fast; where there is one density, they are speeds,
    /// dark at rest and bright from 1 on
    #[arg(long, value_name = "FILE")]
    film: Option<PathBuf>,

    /// Width of the slices, those of the film and of the .png, in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 480, value_parser = clap::value_parser!(u32).range(64..=3000))]
    width: u32,

    /// Where to write a page that shows the cells in 3D over time, for any browser, all in the one file: .html, or - for standard output.
    /// Where there are many frames, some of them, 100 at most, so that the page has no more than 200,000 cells in all, or two; each is computed once more for it
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    /// Where to write, with every frame and at the end, what is needed to go on: .fluid
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,

    /// Go on from a checkpoint, a .fluid, to the same bits as if it had not been interrupted
    #[arg(long, value_name = "FILE",
          conflicts_with_all = ["scene", "particles", "dt", "epsilon", "viscosity", "gravity", "domain", "seed"])]
    resume: Option<PathBuf>,

    #[command(flatten)]
    backend: BackendArgs,

    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  laguerre fluid rayleigh-taylor --film plumes.gif
  laguerre fluid snow-globe --domain part.stl --particles 20000 --out-dir globe --frames png,vtu --checkpoint globe.fluid
  laguerre fluid dam-break --particles 5000 --html dam.html
  laguerre fluid --resume globe.fluid --steps 400 --out-dir globe --checkpoint globe.fluid";

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SceneName {
    /// Heavy fluid over light
    RayleighTaylor,
    /// Heavy fluid at one side of a box of light fluid, let go
    DamBreak,
    /// Vortices that break up
    TaylorGreen,
    /// One steady vortex, to measure by
    Beltrami,
    /// Snow in a shaken globe: a swan, or --domain
    SnowGlobe,
}

/// Rounds in which particles in a mesh settle in cells of equal volume before they move.
const SETTLING: usize = 3;

pub(crate) fn run(args: &FluidArgs) -> Result<Outcome> {
    check(args)?;
    let (backend, pool) = open_for_solver(&args.backend)?;
    pool.install(|| play(args, backend.as_ref()))
}

/// The scene from its beginning, or from where it was, to its end.
fn play(args: &FluidArgs, backend: &dyn Backend) -> Result<Outcome> {
    let start = Instant::now();
    let (scene, container, mut fluid) = match &args.resume {
        Some(path) => Checkpoint::read(path)?.fluid(backend).map_err(|e| e.at(path.display()))?,
        None => begin(args, backend)?,
    };
    page::check_cells(args.html.as_ref(), fluid.diagram())?;
    let first = fluid.state().steps;
    if let (Some(path), true) = (&args.resume, first >= args.steps) {
        note(&format!("{} is at step {first} already; give --steps beyond that to go on", path.display()));
    }
    let resumed = args.resume.as_ref().map(|_| first);
    let mut frames = Frames::new(args, scene, &container, resumed)?;
    // Until now there was nothing to lose.
    end_well_when_interrupted();
    frames.add(&fluid, args.resume.is_none())?;
    let mut pages = Pages::new(args.html.as_deref(), scene, &fluid);
    pages.add(&fluid);
    let mut report = Report::new(scene, &fluid, backend.info());
    if args.out_dir.is_none() && args.film.is_none() && args.html.is_none() && args.checkpoint.is_none() && !args.json {
        // Not before: what is wrong is said in one line.
        note("only energies are printed; name --film, --html, --out-dir or --checkpoint to keep the motion");
    }
    if !args.json {
        print(&report.header())?;
    }
    let flown = flow(args, backend, &mut fluid, &mut report, |fluid| {
        frames.add(fluid, true)?;
        pages.add(fluid);
        save(args, scene, &container, fluid)
    });
    // What was before a step that failed is not lost.
    if flown.is_ok() || fluid.state().steps > first {
        let kept = save(args, scene, &container, &fluid).and(frames.finish());
        flown.and(kept)?;
    } else {
        flown?;
    }
    report.finish(&fluid, is_interrupted(), start.elapsed().as_secs_f64());
    pages.finish(&fluid, backend, &report)?;
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.summary())?;
    }
    if !is_interrupted() {
        return Ok(Outcome::Done);
    }
    let how = match &args.checkpoint {
        Some(path) => format!("--resume {} goes on", path.display()),
        None => "there is no --checkpoint to go on from".into(),
    };
    say(&format!("interrupted after step {}; {how}", fluid.state().steps));
    Ok(Outcome::Interrupted)
}

/// Steps until the last or an interrupt, each in the report; `keep` is called when a frame is due.
fn flow(
    args: &FluidArgs,
    backend: &dyn Backend,
    fluid: &mut Fluid,
    report: &mut Report,
    mut keep: impl FnMut(&Fluid) -> Result<()>,
) -> Result<()> {
    while fluid.state().steps < args.steps && !is_interrupted() {
        let start = Instant::now();
        let number = fluid.state().steps + 1;
        let taken = fluid.step(backend).map_err(|e| e.at(format!("step {number}")))?;
        let row = Step::new(fluid, &taken, start.elapsed().as_secs_f64());
        let is_due = number.is_multiple_of(args.every);
        if !args.json && (is_due || number == args.steps) {
            print(&row.line())?;
        }
        report.add(row);
        if is_due {
            keep(fluid)?;
        }
    }
    Ok(())
}

/// What can be said before the work.
fn check(args: &FluidArgs) -> Result<()> {
    if let Some(path) = &args.film {
        io::check_output(path, &[".gif"])?;
    }
    if let Some(path) = &args.checkpoint {
        io::check_output(path, &[checkpoint::ENDING])?;
    }
    check_page(args.html.as_ref(), args.film.iter().chain(&args.checkpoint))?;
    args.html.iter().try_for_each(|path| refuse_inputs(path, &[args.domain.as_ref(), args.resume.as_ref()]))?;
    share_standard_output(&args.html, args.json)?;
    if let Some(folder) = args.out_dir.as_ref().filter(|folder| folder.is_dir()) {
        io::check_output(&folder.join("frame.png"), &[".png"])?;
    }
    let vortex = args.scene.filter(|&name| !scene_of(name).has_two_densities());
    if let (Some(name), Some(path)) = (vortex, &args.domain) {
        return Err(Error::input(format!(
            "{}: {} is a flow in the unit cube; leave --domain out",
            path.display(),
            scene_of(name).name()
        )));
    }
    if let (Some(name), Some(_)) = (vortex, args.gravity) {
        note(&format!("{} has one density: gravity moves nothing there", scene_of(name).name()));
    }
    Ok(())
}

/// The scene of the command line.
fn begin(args: &FluidArgs, backend: &dyn Backend) -> Result<(Scene, Container, Fluid)> {
    // Required unless there is a checkpoint.
    let scene = args.scene.map_or(Scene::RayleighTaylor, scene_of);
    let domain = match (&args.domain, scene.extent()) {
        (Some(path), _) => {
            let domain = Domain::load(path)?;
            domain.notes().iter().for_each(|remark| note(&format!("{}: {remark}", path.display())));
            Some(domain)
        }
        (None, None) => Some(domains::swan()?),
        (None, Some(_)) => None,
    };
    let count = args.particles as usize;
    let (container, centers) = match domain {
        Some(domain) => {
            let (lo, hi) = domain.bounding_box();
            let mut sampler = Sampler::new(Corners { lo, hi }, Some(&domain), args.seed).relaxed_by(backend);
            let (blue, _) = sampler.blue(args.particles, BLUE_SPREAD, MOST_STEPS)?;
            let container = Container::Domain(domain.clone());
            let centers = settle(backend, &container, &blue, SETTLING)?;
            (container, centers)
        }
        None => {
            let extent = scene.extent().unwrap_or([1.0; 3]);
            (Container::Box([0.0; 3], extent), lattice(extent, count))
        }
    };
    if centers.len() != count {
        note(&format!("{} particles, as near to {count} as a lattice comes in this box", centers.len()));
    }
    let (lo, hi, volume) = extents(&container);
    let densities = scene.densities(&centers, lo, hi);
    let size = (volume / centers.len() as f64).cbrt();
    let mut settings = scene.settings(&densities, lo, hi, size, args.gravity);
    settings.epsilon = args.epsilon.unwrap_or(settings.epsilon);
    settings.viscosity = args.viscosity.unwrap_or(settings.viscosity);
    settings.time_step = args.dt;
    let start = scene.start(&centers, densities, &settings);
    let fluid = Fluid::new(backend, &container, start, settings)?;
    Ok((scene, container, fluid))
}

fn save(args: &FluidArgs, scene: Scene, container: &Container, fluid: &Fluid) -> Result<()> {
    args.checkpoint.as_ref().map_or(Ok(()), |path| checkpoint::write(path, scene, container, fluid))
}

/// Corners of the container's box, and its volume.
fn extents(container: &Container) -> ([f64; 3], [f64; 3], f64) {
    let (lo, hi) = match container {
        Container::Domain(domain) => domain.bounding_box(),
        Container::Box(lo, hi) => (*lo, *hi),
    };
    (lo, hi, container.volume())
}

fn scene_of(name: SceneName) -> Scene {
    match name {
        SceneName::RayleighTaylor => Scene::RayleighTaylor,
        SceneName::DamBreak => Scene::DamBreak,
        SceneName::TaylorGreen => Scene::TaylorGreen,
        SceneName::Beltrami => Scene::Beltrami,
        SceneName::SnowGlobe => Scene::SnowGlobe,
    }
}

/// The inverse of the largest number.
const SMALLEST: f64 = 1e-60;

fn parse_positive(text: &str) -> std::result::Result<f64, String> {
    parse_number(text, |x| x >= SMALLEST, &format!("above 0, from {SMALLEST:e} to {LARGEST:e},"))
}

fn parse_finite(text: &str) -> std::result::Result<f64, String> {
    parse_number(text, |_| true, &format!("within ±{LARGEST:e}"))
}
