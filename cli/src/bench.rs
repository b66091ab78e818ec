//! `laguerre bench`: backend × distribution × number of sites × domain, on this machine.

mod clock;
mod uneven;

use laguerre::{Backend, Domain, Error, ErrorKind, PowerDiagram, Precision, Request, Result, Selection};
use serde::Serialize;

use crate::args::{BenchArgs, BenchBackend, BenchRequest, Corners, Distribution};
use crate::domains;
use crate::outcome::{Outcome, note, print, print_json};
use crate::report::{grouped, machine};
use crate::sample::Sampler;
use crate::timing::{Timing, measure};

/// The name of no domain.
const BOX: &str = "box";
const SEED: u64 = 1;

/// The object of `--json`.
#[derive(Serialize)]
struct Table<Row> {
    /// The processor, in its own words.
    machine: String,
    threads: usize,
    rows: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    backend: &'static str,
    device: String,
    distribution: String,
    sites: usize,
    domain: String,
    request: &'static str,
    seconds: Timing,
    sites_per_second: f64,
    /// Cycles of all threads together, of the fastest call, at the clock that one core has afterwards; none of a device.
    cycles_per_site: Option<f64>,
}

pub(crate) fn run(args: &BenchArgs) -> Result<Outcome> {
    if let Some(chosen) = &args.uneven {
        return uneven::run(args, chosen);
    }
    let containers = args.domains.iter().map(|name| Ok((name, container(name)?))).collect::<Result<Vec<_>>>()?;
    let backends = backends(args)?;
    let (machine, cores) = machine();
    let mut table = Table { machine, threads: args.threads.unwrap_or(cores), rows: Vec::new() };
    if !args.json {
        print(&format!("{}, {} threads\n\n{}", table.machine, table.threads, line(&HEADER.map(str::to_owned))))?;
    }
    for &distribution in &args.distributions {
        for &count in &args.sites {
            for (name, domain) in &containers {
                let mut diagram = input(distribution, count, domain.as_ref())?;
                for (backend, &request) in backends.iter().flat_map(|b| args.requests.iter().map(move |r| (b, r))) {
                    let row = row(backend.as_ref(), distribution, &mut diagram, name, request, args, cores)?;
                    if !args.json {
                        print(&line(&row.cells()))?;
                    }
                    table.rows.push(row);
                }
            }
        }
    }
    if args.json {
        print_json(&table)?;
    }
    Ok(Outcome::Done)
}

/// The word for a distribution on the command line.
pub(crate) fn word(distribution: Distribution) -> &'static str {
    match distribution {
        Distribution::White => "white",
        Distribution::Perturbed => "perturbed",
        Distribution::Blue => "blue",
        Distribution::Lattice => "lattice",
        Distribution::Mirrored => "mirrored",
    }
}

fn row(
    backend: &dyn Backend,
    distribution: Distribution,
    diagram: &mut PowerDiagram,
    domain: &str,
    request: BenchRequest,
    args: &BenchArgs,
    cores: usize,
) -> Result<Row> {
    let (name, asked) = match request {
        BenchRequest::Moments => ("moments", Request::moments()),
        BenchRequest::Facets => ("facets", Request::moments().with_facets()),
        BenchRequest::Laplacian => ("laplacian", Request::moments().with_laplacian()),
        BenchRequest::LaplacianKept => ("laplacian-kept", Request::moments().with_laplacian_kept()),
    };
    let (seconds, _) = measure(backend, diagram, &asked, args.repetitions)?;
    let info = backend.info();
    let sites = diagram.positions().len();
    let threads = info.threads.min(cores);
    let cycles = || seconds.min * clock::cycles_per_second() * threads as f64 / sites as f64;
    Ok(Row {
        backend: info.backend,
        device: info.device,
        distribution: word(distribution).into(),
        sites,
        domain: domain.into(),
        request: name,
        seconds,
        sites_per_second: sites as f64 / seconds.median.max(f64::MIN_POSITIVE),
        cycles_per_site: (info.backend == "cpu").then(cycles),
    })
}

/// The domain of a name or file; none for the box.
fn container(name: &str) -> Result<Option<Domain>> {
    if name == BOX {
        return Ok(None);
    }
    let domain = match domains::named(name) {
        Some(domain) => domain?,
        // What has no ending is no file, but a name.
        None if !name.contains('.') => {
            let known: Vec<&str> = [BOX].into_iter().chain(domains::names()).collect();
            return Err(Error::input(format!(
                "--domains {name}: not one of {}; or name a mesh file",
                known.join(", ")
            )));
        }
        None => Domain::load(name)?,
    };
    Ok(Some(domain))
}

/// The backends asked for, or those that are there.
fn backends(args: &BenchArgs) -> Result<Vec<Box<dyn Backend>>> {
    let asked = if args.backends.is_empty() { &[BenchBackend::Cpu, BenchBackend::Ocl][..] } else { &args.backends };
    let mut opened = Vec::new();
    for &name in asked {
        let selection = match name {
            BenchBackend::Cpu => Selection::Cpu { threads: args.threads },
            BenchBackend::Ocl => {
                Selection::Ocl { devices: args.device.clone().unwrap_or_default(), precision: Precision::F64 }
            }
        };
        match laguerre::open(selection) {
            Ok(backend) => opened.push(backend),
            Err(error) if args.backends.is_empty() && error.kind() == ErrorKind::Unavailable => {
                note(&error.to_string());
            }
            Err(error) => return Err(error),
        }
    }
    if opened.is_empty() {
        return Err(Error::new(ErrorKind::Unavailable, "no backend is there; see laguerre devices"));
    }
    Ok(opened)
}

/// Sites that fill the domain's box, or the unit cube.
fn input(distribution: Distribution, count: u32, domain: Option<&Domain>) -> Result<PowerDiagram> {
    let corners = domain.map_or(Corners::UNIT_CUBE, |domain| {
        let (lo, hi) = domain.bounding_box();
        Corners { lo, hi }
    });
    let positions = Sampler::new(corners, None, SEED).sample(distribution, count)?;
    let diagram = PowerDiagram::new(&positions, &[])?;
    match domain {
        Some(domain) => Ok(diagram.restricted_to(domain)),
        None => diagram.in_box(corners.lo, corners.hi),
    }
}

const COLUMNS: usize = 9;
const HEADER: [&str; COLUMNS] =
    ["backend", "distribution", "sites", "domain", "request", "median [min, max]", "sites/s", "cycles/site", "device"];
const WIDTHS: [usize; COLUMNS] = [7, 12, 11, 12, 14, 30, 11, 11, 9];

impl Row {
    fn cells(&self) -> [String; COLUMNS] {
        let device = self.seconds.device.map_or_else(|| "-".into(), crate::timing::seconds);
        [
            self.backend.into(),
            self.distribution.clone(),
            grouped(self.sites as u64),
            self.domain.clone(),
            self.request.into(),
            self.seconds.spread(),
            grouped(self.sites_per_second as u64),
            self.cycles_per_site.map_or_else(|| "-".into(), |cycles| grouped(cycles as u64)),
            device,
        ]
    }
}

fn line(cells: &[String; COLUMNS]) -> String {
    let mut line = String::new();
    for (cell, width) in cells.iter().zip(WIDTHS) {
        line.push_str(&format!("{cell:<width$}  "));
    }
    format!("{}\n", line.trim_end())
}
