//! The backend: passes over chunks of sites in grid order.

use crate::store::CpuStore;
use laguerre_core::assemble::{Assembler, CellRecord, FinishedCells};
use laguerre_core::backend::MOST_THREADS;
use laguerre_core::cell::{self, CellSums, v3};
use laguerre_core::diagram::Prepared;
use laguerre_core::geometry::{GeometryAssembler, Shaper, Shapes};
use laguerre_core::integrand::FramedIntegrand;
use laguerre_core::passes::{Capacities, FEW_CELLS, PassOutcome, run_passes};
use laguerre_core::search::Search;
use laguerre_core::{
    Backend, BackendInfo, Capabilities, CellStatus, Error, Integrand, Observer, Output, PassReport, PowerDiagram,
    Report, Request, Result, Watched, parallel,
};
use rayon::prelude::*;
use std::collections::HashMap;

/// Cells that one task computes: enough to hide the scheduling, few enough to share the work evenly. In the first pass they are whole blocks
/// of the tree, whose cells share what they find ([`Search::begin_row`]), but for functions that are called in batches.
const CHUNK: usize = 256;

/// Tasks, at most, for few cells that are left, of which each may take long.
const TASKS: usize = 256;

/// Cells that are computed before their results are put together: enough that the threads' waiting for each other at its end does not count.
const WAVE: usize = 512 * CHUNK;

/// The same where their geometry is asked for, which takes some kilobytes a cell.
const WAVE_WITH_GEOMETRY: usize = 32 * CHUNK;

/// That of the cells that a device leaves to the host, mostly for their size, where they are few (`FEW_CELLS`): some 0.4 ms for each to make.
const LEFT: Capacities = Capacities { planes: 4096, vertices: 8192 };

/// The CPU backend: rayon over sites, SIMD inside a cell.
#[derive(Debug)]
pub struct Cpu {
    pool: rayon::ThreadPool,
}

/// What one chunk of cells yields.
#[derive(Default)]
struct ChunkResult {
    finished: FinishedCells,
    shapes: Shapes,
    failed: Vec<u32>,
    exact_cells: usize,
    visited: u32,
    triangles: u32,
}

/// One thread's storage.
struct Worker<'a> {
    store: CpuStore<'a>,
    search: Search<'a>,
    /// Where cells' geometry is asked for.
    shaper: Option<Shaper>,
}

/// What the cells of a pass are computed with.
#[derive(Clone, Copy)]
struct Pass<'a> {
    room: Capacities,
    /// Cells that one task computes, and whether they are whole blocks of the tree: what a cell of a list comes to is to depend on no other that is in it.
    chunk: usize,
    are_blocks: bool,
    prepared: &'a Prepared,
    request: &'a Watched<'a>,
    integrand: Option<&'a FramedIntegrand>,
    has_geometry: bool,
}

impl<'a> Worker<'a> {
    fn new(pass: Pass<'a>) -> Self {
        let Pass { room, prepared, request, integrand, has_geometry, .. } = pass;
        Self {
            store: CpuStore::new(room, prepared.domain_grid()).with_integrand(integrand),
            search: Search::new(prepared),
            shaper: has_geometry.then(|| Shaper::new(request.solids())),
        }
    }
}

impl Cpu {
    /// A backend with the given number of threads, or one for each core, as far as they can be started.
    ///
    /// # Errors
    /// `Device` where the threads cannot be started, `Input` for 0 threads, or more than [`MOST_THREADS`].
    pub fn new(threads: Option<usize>) -> Result<Self> {
        if let Some(threads) = threads.filter(|threads| !(1..=MOST_THREADS).contains(threads)) {
            return Err(Error::input(format!("{threads} threads: from 1 to {MOST_THREADS} are needed")));
        }
        Ok(Self { pool: parallel::pool(threads)? })
    }
}

impl Backend for Cpu {
    fn info(&self) -> BackendInfo {
        let threads = self.pool.current_num_threads();
        BackendInfo::of_host("cpu", device_name(), threads)
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        Capabilities::ALL.check(request, diagram)?;
        self.pool.install(|| evaluate(diagram, Watched::new(request, observer)))
    }
}

fn evaluate(diagram: &PowerDiagram, request: Watched<'_>) -> Result<Output> {
    let prepared = diagram.prepare()?.with_octree_if_hard(&|| request.advance(0))?;
    let mut assembler = Assembler::new(diagram, &prepared.container, &request);
    let mut geometry = request
        .geometry()
        .then(|| GeometryAssembler::new(diagram.positions().len(), &prepared.container.frame, request.solids()));
    let all = (0..prepared.sites.len() as u32).collect();
    let (passes, exact_cells) =
        run(&prepared, &request, (all, Capacities::FIRST, true), &mut assembler, geometry.as_mut())?;
    let report = Report::of_host(exact_cells, passes);
    assembler.finish(prepared.sites.order(), report, geometry.map(GeometryAssembler::finish).transpose()?)
}

/// Computes the cells of some sorted sites, in their order, on the threads of the pool at hand, but not their geometry: those that a device leaves to
/// the host. None depends on which others are among them.
///
/// # Errors
/// `Input` where a function cannot be integrated, `Device` where a cell cannot be decided, and what the observer says.
pub fn compute_cells(
    prepared: &Prepared,
    request: &Watched<'_>,
    sites: Vec<u32>,
    assembler: &mut Assembler<'_>,
) -> Result<()> {
    let room = if sites.len() <= FEW_CELLS { LEFT } else { Capacities::FIRST };
    run(prepared, request, (sites, room, false), assembler, None).map(|_| ())
}

/// The passes over some sorted sites, of which is said the room that the first has, and whether they are all; and how many cells needed exact arithmetic.
fn run(
    prepared: &Prepared,
    request: &Watched<'_>,
    (sites, first, are_all): (Vec<u32>, Capacities, bool),
    assembler: &mut Assembler<'_>,
    mut geometry: Option<&mut GeometryAssembler>,
) -> Result<(Vec<PassReport>, usize)> {
    let integrand = request.integral().map(|f| f.framed(&prepared.container.frame)).transpose()?;
    let (mut exact_cells, has_geometry) = (0, geometry.is_some());
    let passes = run_passes(first, sites, Capacities::grown_for, |room, cells: &Vec<u32>| -> Result<PassOutcome> {
        let mut outcome: PassOutcome = PassOutcome::default();
        let are_blocks = are_all && room == Capacities::FIRST;
        let chunk = if are_blocks { CHUNK } else { cells.len().div_ceil(TASKS).min(CHUNK) };
        let pass = Pass { room, chunk, are_blocks, prepared, request, integrand: integrand.as_ref(), has_geometry };
        // Wave by wave: what a cell leaves behind takes several times the room of its results.
        let wave = if has_geometry { WAVE_WITH_GEOMETRY } else { WAVE };
        let mut shapes: Vec<Shapes> = Vec::new();
        for wave in cells.chunks(wave) {
            // The shapes of one wave are put together while the next is computed.
            let (results, ()) = rayon::join(
                || run_chunks(pass, wave),
                || geometry.iter_mut().for_each(|geometry| shapes.drain(..).for_each(|shapes| geometry.add(&shapes))),
            );
            let mut finished = Vec::new();
            for result in results? {
                finished.push(result.finished);
                shapes.push(result.shapes);
                outcome.failed.extend(result.failed);
                outcome.neighbors = outcome.neighbors.max(result.visited);
                outcome.triangles = outcome.triangles.max(result.triangles);
                exact_cells += result.exact_cells;
            }
            assembler.add(finished);
        }
        geometry.iter_mut().for_each(|geometry| shapes.drain(..).for_each(|shapes| geometry.add(&shapes)));
        Ok(outcome)
    })?;
    Ok((passes, exact_cells))
}

/// Computes some cells of a pass, chunk by chunk, the results in order.
fn run_chunks(pass: Pass<'_>, cells: &[u32]) -> Result<Vec<ChunkResult>> {
    let request = pass.request;
    if let Some(batch) = request.integral().and_then(Integrand::batch) {
        return cells.par_chunks(batch.min(CHUNK)).map(|batch| run_batch(pass, batch)).collect();
    }
    cells
        .par_chunks(pass.chunk)
        .map_init(
            || Worker::new(pass),
            |worker, chunk| {
                let result = run_chunk(worker, chunk, pass)?;
                request.advance(result.finished.cells.len())?;
                Ok(result)
            },
        )
        .collect()
}

/// The cells of a batch, whose function is called once for all of them: as often as it has columns, and once more to learn its places.
fn run_batch(pass: Pass<'_>, cells: &[u32]) -> Result<ChunkResult> {
    let Pass { prepared, request, .. } = pass;
    let taped = request.integral().and_then(|f| f.taped(&prepared.container.frame));
    let Some((integrand, tape)) = &taped else { return Ok(ChunkResult::default()) };
    // How many cells are a batch depends on the function's degree, and the last bits of a volume do on which cells are a row with its own.
    let pass = Pass { integrand: Some(integrand), are_blocks: false, ..pass };
    let run = || run_chunk(&mut Worker::new(pass), cells, pass);
    run()?;
    tape.call()?;
    tape.turn_to(0);
    let mut result = run()?;
    for column in 1..request.integral().map_or(1, Integrand::columns) {
        tape.turn_to(column);
        result.finished.columns.push(run()?.finished.cells.iter().map(|cell| cell.sums.integral).collect());
    }
    request.advance(result.finished.cells.len())?;
    Ok(result)
}

fn run_chunk(worker: &mut Worker<'_>, cells: &[u32], pass: Pass<'_>) -> Result<ChunkResult> {
    let mut result = ChunkResult::default();
    if pass.are_blocks {
        worker.search.begin_row();
    }
    for &site in cells {
        run_cell(worker, site, pass, &mut result)?;
    }
    // (They stay until all cells are computed.)
    result.finished.facets.shrink();
    Ok(result)
}

fn run_cell(
    worker: &mut Worker<'_>,
    site: u32,
    Pass { prepared, request, .. }: Pass<'_>,
    result: &mut ChunkResult,
) -> Result<()> {
    let [x, y, z, _] = prepared.sites.site(site);
    let store = &mut worker.store;
    store.turn_to(v3(x, y, z));
    let outcome = worker.search.complete(store, site, request.epsilon());
    let mut sums = CellSums::default();
    let flags = cell::flags_of(request);
    let status = match outcome.status {
        cell::COMPLETE => cell::integrate_cell(store, flags, 0, &mut sums),
        other => other,
    };
    result.visited = result.visited.max(outcome.visited);
    result.triangles = result.triangles.max(store.triangles_tried());
    let status = match status {
        cell::COMPLETE if outcome.uncertified => CellStatus::Uncertified,
        cell::COMPLETE => CellStatus::Complete,
        cell::EMPTY => CellStatus::Empty,
        cell::P_FULL | cell::V_FULL => {
            result.failed.push(site);
            return Ok(());
        }
        _ => return Err(Error::undecided("cell", prepared.sites.order()[site as usize])),
    };
    let order = prepared.sites.order();
    if let Some(shaper) = worker.shaper.as_mut().filter(|_| status != CellStatus::Empty) {
        let frame = &prepared.container.frame;
        if shaper.add(store, site, sums.volume, order, frame, &mut result.shapes) != cell::COMPLETE {
            return Err(Error::undecided("geometry", order[site as usize]));
        }
    }
    result.exact_cells += usize::from(store.exact);
    result.finished.push(CellRecord { site: order[site as usize], status, sums }, store, flags, order);
    Ok(())
}

/// The processor in its own words, where the system tells.
fn device_name() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let fields: HashMap<&str, &str> =
        info.lines().filter_map(|line| line.split_once(':')).map(|(k, v)| (k.trim(), v.trim())).collect();
    fields.get("model name").map_or_else(|| std::env::consts::ARCH.to_string(), ToString::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;
    use laguerre_core::capacities::{count_cells, sufficient};
    use laguerre_core::shapes::icosphere;

    #[test]
    fn passes_report_what_cells_visit_and_try() {
        let point = |i: usize| [0.819_172, 0.671_043, 0.549_7].map(|step| 2.0 * (i as f64 * step).fract() - 1.0);
        let positions: Vec<[f64; 3]> = (0..2000).map(point).collect();
        let diagram = PowerDiagram::new(&positions, &[]).unwrap().restricted_to(&icosphere(2).domain());
        for request in [Request::moments(), Request::moments().with_facets()] {
            let prepared = diagram.prepare().unwrap();
            let all: Vec<u32> = (0..prepared.sites.len() as u32).collect();
            let most = sufficient(&count_cells(&prepared, &request, &all), 1.0);
            let pass = Cpu::new(Some(2)).unwrap().evaluate(&diagram, &request).unwrap().report().passes[0];
            assert!(most.triangles > 0 && most.planes <= pass.planes, "{most:?}");
            assert_eq!((pass.neighbors, pass.triangles), (most.neighbors, most.triangles));
        }
    }
}
