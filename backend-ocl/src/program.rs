//! The kernels: built as they are needed, and kept.

use crate::ahead::{Ahead, Key};
use crate::builds::{Asked, Build, Way};
use crate::handle::Handle;
use crate::interface::algebra::{
    BalanceRows, ChooseRoots, Combine, CountColumns, DotParts, FindBeyond, FindRisen, InvertDiagonal, JoinRest,
    JoinRoots, ListColumns, Multiply, MultiplyRows, PartCells, Prolong, RankFree, Smooth, SortColumns, SpreadRanks,
    Stiffen, SubtractNumber, SumParts,
};
use crate::interface::data::Params;
use crate::interface::kernels::{
    AddBlocks, BoundNodes, Cells, ChooseLeaders, CountDigits, CountFacets, CountRows, EnterSites, FillLaplacian,
    FindHomes, FindLeasts, FindVoxels, GatherCells, GatherSites, JudgeParts, ListFacets, LookAbout, LookAtRings,
    MarkSlices, MarkVoxels, MatchFacets, MeasureClearances, MoveSites, PackFacets, PlaceDigits, PlaceLeaves, RankSites,
    ScanBlocks, SettleRuns, SortFacets, SplitBoxes, SumCells, TightenSlabs, WriteRows,
};
use crate::launch::Kernel;
use crate::platform::DeviceId;
use laguerre_core::{Error, ErrorKind, Result};
use opencl3::context::Context;
use opencl3::error_codes::{CL_BUILD_PROGRAM_FAILURE, CL_INVALID_BUILD_OPTIONS, ClError};
use opencl3::program::{Program, build_program};
use opencl3::types::cl_device_id;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ffi::CString;
use std::ptr;
use std::sync::Arc;
use std::time::Instant;

/// Most half-spaces that a work-item has room for; what needs more is the host's.
pub(crate) const MOST_PLANES: u32 = 216;

/// One build, and its kernels.
pub(crate) struct Kernels {
    pub(crate) cells: Kernel<Cells<'static>>,
    /// Work-items of a group, and those that compute one cell.
    pub(crate) group: usize,
    pub(crate) per_cell: usize,
}

/// Kernels of one build.
pub(crate) trait Built: Sized {
    const BUILD: Build;

    fn of(program: &Program) -> Result<Self>;

    fn build(context: &Context, device: cl_device_id) -> Result<Self> {
        Self::of(&*compile(context, device, Self::BUILD)?)
    }
}

macro_rules! built {
    ($($(#[$doc:meta])* $name:ident of $build:ident { $($kernel:ident: $type:ident,)* })*) => { $(
        $(#[$doc])*
        pub(crate) struct $name {
            $(pub(crate) $kernel: Kernel<$type<'static>>,)*
        }

        impl Built for $name {
            const BUILD: Build = Build::$build;

            fn of(program: &Program) -> Result<Self> {
                Ok(Self { $($kernel: Kernel::new(program)?,)* })
            }
        }
    )* };
}

built! {
    /// The kernels that sort sites and make the tree, and those that find how near the surface is to them.
    GridKernels of Grid {
        enter_sites: EnterSites,
        mark_voxels: MarkVoxels,
        rank_sites: RankSites,
        count_digits: CountDigits,
        place_digits: PlaceDigits,
        scan_blocks: ScanBlocks,
        add_blocks: AddBlocks,
        settle_runs: SettleRuns,
        gather_sites: GatherSites,
        find_voxels: FindVoxels,
        look_at_rings: LookAtRings,
        bound_nodes: BoundNodes,
        tighten_slabs: TightenSlabs,
        measure_clearances: MeasureClearances,
        choose_leaders: ChooseLeaders,
        look_about: LookAbout,
    }

    /// Those that make the octree over the container.
    OctreeKernels of Octree {
        split_boxes: SplitBoxes,
        find_leasts: FindLeasts,
        mark_slices: MarkSlices,
        judge_parts: JudgeParts,
        place_leaves: PlaceLeaves,
        find_homes: FindHomes,
    }

    /// Those that make rows of facets, and of the Laplacian.
    RowKernels of Rows {
        count_rows: CountRows,
        write_rows: WriteRows,
        count_facets: CountFacets,
        list_facets: ListFacets,
        sort_facets: SortFacets,
        match_facets: MatchFacets,
        pack_facets: PackFacets,
    }

    /// Those of sites that stay.
    TotalKernels of Totals {
        sum_cells: SumCells,
        move_sites: MoveSites,
    }

    /// Linear algebra.
    AlgebraKernels of Algebra {
        fill_laplacian: FillLaplacian,
        gather_cells: GatherCells,
        multiply: Multiply,
        combine: Combine,
        smooth: Smooth,
        dot_parts: DotParts,
        sum_parts: SumParts,
        subtract_number: SubtractNumber,
        invert_diagonal: InvertDiagonal,
        find_beyond: FindBeyond,
        find_risen: FindRisen,
        stiffen: Stiffen,
        part_cells: PartCells,
        rank_free: RankFree,
        spread_ranks: SpreadRanks,
        choose_roots: ChooseRoots,
        join_roots: JoinRoots,
        join_rest: JoinRest,
        prolong: Prolong,
        count_columns: CountColumns,
        list_columns: ListColumns,
        sort_columns: SortColumns,
        multiply_rows: MultiplyRows,
        balance_rows: BalanceRows,
    }
}

/// Kernels that are built when they are needed. (Where all but those of cells were one build, the first call ever, ten sites in a box, took 5.9 instead of 3.9 s on one NVIDIA H200.)
pub(crate) struct Later<K> {
    context: Arc<Handle<Context>>,
    device: cl_device_id,
    kernels: OnceCell<K>,
}

impl<K: Built> Later<K> {
    pub(crate) fn new(context: &Arc<Handle<Context>>, device: cl_device_id) -> Self {
        Self { context: context.clone(), device, kernels: OnceCell::new() }
    }

    pub(crate) fn get(&self) -> Result<&K> {
        if let Some(kernels) = self.kernels.get() {
            return Ok(kernels);
        }
        let built = K::build(&self.context, self.device)?;
        Ok(self.kernels.get_or_init(|| built))
    }
}

/// All builds so far, and those that are being made.
#[derive(Default)]
pub(crate) struct Programs {
    built: HashMap<Key, Kernels>,
    ahead: Option<Ahead>,
}

impl Programs {
    /// The kernels that compute cells in the given way, with what the parameters ask for and no more; built if they are not.
    pub(crate) fn get(
        &mut self,
        context: &Context,
        device: cl_device_id,
        way: Way,
        params: &Params,
    ) -> Result<&mut Kernels> {
        let key = (way, Asked::of(params, way));
        match self.built.entry(key) {
            Entry::Occupied(built) => Ok(built.into_mut()),
            Entry::Vacant(place) => {
                let ahead = self.ahead.as_mut().and_then(|ahead| ahead.take(key));
                let built = ahead.unwrap_or_else(|| build(context, device, key.0, key.1));
                Ok(place.insert(built?))
            }
        }
    }

    /// Begins to build what these ways ask for, as far as it is not there, for whoever asks until [`settle`](Self::settle) is called.
    pub(crate) fn build_ahead(
        &mut self,
        context: &Arc<Handle<Context>>,
        device: DeviceId,
        ways: &[Way],
        params: &Params,
    ) {
        self.settle();
        let keys = ways.iter().map(|&way| (way, Asked::of(params, way)));
        let keys: Vec<Key> = keys.filter(|key| !self.built.contains_key(key)).collect();
        if !keys.is_empty() {
            self.ahead = Ahead::begin(context.clone(), device, keys);
        }
    }

    /// Begins no more builds, and keeps those that nobody has asked for. (No thread may be in the driver when a process ends.)
    pub(crate) fn settle(&mut self) {
        for (key, built) in self.ahead.take().into_iter().flat_map(Ahead::end) {
            if let Ok(kernels) = built {
                self.built.insert(key, kernels);
            }
        }
    }
}

impl Drop for Programs {
    fn drop(&mut self) {
        self.settle();
    }
}

pub(crate) fn build(context: &Context, device: cl_device_id, way: Way, asked: Asked) -> Result<Kernels> {
    let program = compile(context, device, Build::Cells(way, asked))?;
    let cells = Kernel::new(&program)?;
    let (group, per_cell) = way.group();
    let group = match way {
        Way::Alone(_) => group.min(cells.largest_group(device)?),
        Way::Together(..) => group,
    };
    Ok(Kernels { cells, group, per_cell })
}

/// Tells a logger that a device's driver compiles kernels, which may take a minute where it has not kept them (`Info`), and that it has (`Debug`): the program's bar goes by that.
struct Compiling(Instant);

impl Compiling {
    fn begin() -> Self {
        log::info!(target: "laguerre::kernels", "a device's driver compiles kernels");
        Self(Instant::now())
    }
}

impl Drop for Compiling {
    fn drop(&mut self) {
        log::debug!(target: "laguerre::kernels", "the driver had kernels after {:.2} s", self.0.elapsed().as_secs_f64());
    }
}

/// Most characters of a build log that stand in a message.
const MOST_OF_A_LOG: usize = 1000;

/// Builds a program for a device.
pub(crate) fn compile(context: &Context, device: cl_device_id, build: Build) -> Result<Handle<Program>> {
    compile_text(context, device, &build.text().whole()?, &build.options())
}

/// The same from another text.
pub(crate) fn compile_text(
    context: &Context,
    device: cl_device_id,
    source: &str,
    options: &str,
) -> Result<Handle<Program>> {
    let failed = |error: ClError, log: &str| {
        let message = format!("the OpenCL kernels do not build: {error} ({}): use the CPU{log}", error.0);
        Error::new(ErrorKind::Device, message)
    };
    let _compiling = Compiling::begin();
    // As one string: given several, opencl3 0.12 passes their lengths wrongly.
    let program = Program::create_from_source(context, source).map(Handle::new).map_err(|e| failed(e, ""))?;
    let options = CString::new(options).map_err(|_| failed(ClError(CL_INVALID_BUILD_OPTIONS), ""))?;
    // Not `Program::build`, which also keeps the kernels' names: see `Handle`.
    build_program(program.get(), &[device], &options, None, ptr::null_mut()).map_err(|code| {
        let log = if code == CL_BUILD_PROGRAM_FAILURE { program.get_build_log(device).ok() } else { None };
        let log = log.map(|log| beginning(&log)).filter(|log| !log.is_empty());
        failed(ClError(code), &log.map_or(String::new(), |log| format!("; the compiler says: {log}")))
    })?;
    Ok(program)
}

/// The beginning of a build log, from its first error on where there is one, as one line.
fn beginning(log: &str) -> String {
    let lines: Vec<&str> = log.lines().collect();
    let first = lines.iter().position(|line| line.to_lowercase().contains("error")).unwrap_or(0);
    let words = lines[first..].iter().flat_map(|line| line.split_whitespace()).collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(MOST_OF_A_LOG) {
        Some((end, _)) => format!("{} …", &words[..end]),
        None => words,
    }
}
