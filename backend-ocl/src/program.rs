//! The kernels: built as they are needed, and kept.

use crate::ahead::{Ahead, Key};
use crate::builds::{Asked, Build, Way};
use crate::handle::Handle;
use crate::interface::algebra::{
    BalanceRows, ChooseRoots, Combine, CountColumns, DotParts, FindBeyond, FindRisen, InvertDiagonal, JoinRest,
    JoinRoots, ListColumns, Multiply, MultiplyRows, PartCells, Prolong, RankFree, SortColumns, SpreadRanks,
    SubtractNumber, SumParts,
};
use crate::interface::data::Params;
use crate::interface::kernels::{
    AddBlocks, BoundNodes, Cells, ChooseLeaders, CountDigits, CountFacets, CountRows, EnterSites, FillLaplacian,
    FindHomes, FindVoxels, GatherCells, GatherSites, JudgeParts, ListFacets, LookAbout, LookAtRings, MarkVoxels,
    MatchFacets, MeasureClearances, MoveSites, PackFacets, PlaceDigits, PlaceLeaves, RankSites, ScanBlocks, SettleRuns,
    SortFacets, SplitBoxes, SumCells, TightenSlabs, WriteRows,
};
use crate::launch::Kernel;
use crate::platform::DeviceId;
use laguerre_core::{Error, ErrorKind, Result};
use opencl3::context::Context;
use opencl3::error_codes::{CL_BUILD_PROGRAM_FAILURE, CL_INVALID_BUILD_OPTIONS, ClError};
use opencl3::program::{Program, build_program};
use opencl3::types::cl_device_id;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ffi::CString;
use std::ptr;
use std::sync::Arc;

/// Most half-spaces that a work-item has room for; what needs more is the host's.
pub(crate) const MOST_PLANES: u32 = 216;

/// One build, and its kernels.
pub(crate) struct Kernels {
    pub(crate) cells: Kernel<Cells<'static>>,
    /// Work-items of a group, and those that compute one cell.
    pub(crate) group: usize,
    pub(crate) per_cell: usize,
}

/// The kernels that sort sites, those that find how near the surface is to them, and those of the Laplacian.
pub(crate) struct GridKernels {
    pub(crate) enter_sites: Kernel<EnterSites<'static>>,
    pub(crate) mark_voxels: Kernel<MarkVoxels<'static>>,
    pub(crate) rank_sites: Kernel<RankSites<'static>>,
    pub(crate) count_digits: Kernel<CountDigits<'static>>,
    pub(crate) place_digits: Kernel<PlaceDigits<'static>>,
    pub(crate) scan_blocks: Kernel<ScanBlocks<'static>>,
    pub(crate) add_blocks: Kernel<AddBlocks<'static>>,
    pub(crate) settle_runs: Kernel<SettleRuns<'static>>,
    pub(crate) gather_sites: Kernel<GatherSites<'static>>,
    pub(crate) find_voxels: Kernel<FindVoxels<'static>>,
    pub(crate) look_at_rings: Kernel<LookAtRings<'static>>,
    pub(crate) bound_nodes: Kernel<BoundNodes<'static>>,
    pub(crate) tighten_slabs: Kernel<TightenSlabs<'static>>,
    pub(crate) split_boxes: Kernel<SplitBoxes<'static>>,
    pub(crate) judge_parts: Kernel<JudgeParts<'static>>,
    pub(crate) place_leaves: Kernel<PlaceLeaves<'static>>,
    pub(crate) find_homes: Kernel<FindHomes<'static>>,
    pub(crate) measure_clearances: Kernel<MeasureClearances<'static>>,
    pub(crate) choose_leaders: Kernel<ChooseLeaders<'static>>,
    pub(crate) look_about: Kernel<LookAbout<'static>>,
    pub(crate) count_rows: Kernel<CountRows<'static>>,
    pub(crate) write_rows: Kernel<WriteRows<'static>>,
    pub(crate) count_facets: Kernel<CountFacets<'static>>,
    pub(crate) list_facets: Kernel<ListFacets<'static>>,
    pub(crate) sort_facets: Kernel<SortFacets<'static>>,
    pub(crate) match_facets: Kernel<MatchFacets<'static>>,
    pub(crate) pack_facets: Kernel<PackFacets<'static>>,
    pub(crate) fill_laplacian: Kernel<FillLaplacian<'static>>,
    pub(crate) gather_cells: Kernel<GatherCells<'static>>,
    pub(crate) sum_cells: Kernel<SumCells<'static>>,
    pub(crate) move_sites: Kernel<MoveSites<'static>>,
    pub(crate) multiply: Kernel<Multiply<'static>>,
    pub(crate) combine: Kernel<Combine<'static>>,
    pub(crate) dot_parts: Kernel<DotParts<'static>>,
    pub(crate) sum_parts: Kernel<SumParts<'static>>,
    pub(crate) subtract_number: Kernel<SubtractNumber<'static>>,
    pub(crate) invert_diagonal: Kernel<InvertDiagonal<'static>>,
    pub(crate) find_beyond: Kernel<FindBeyond<'static>>,
    pub(crate) find_risen: Kernel<FindRisen<'static>>,
    pub(crate) part_cells: Kernel<PartCells<'static>>,
    pub(crate) rank_free: Kernel<RankFree<'static>>,
    pub(crate) spread_ranks: Kernel<SpreadRanks<'static>>,
    pub(crate) choose_roots: Kernel<ChooseRoots<'static>>,
    pub(crate) join_roots: Kernel<JoinRoots<'static>>,
    pub(crate) join_rest: Kernel<JoinRest<'static>>,
    pub(crate) prolong: Kernel<Prolong<'static>>,
    pub(crate) count_columns: Kernel<CountColumns<'static>>,
    pub(crate) list_columns: Kernel<ListColumns<'static>>,
    pub(crate) sort_columns: Kernel<SortColumns<'static>>,
    pub(crate) multiply_rows: Kernel<MultiplyRows<'static>>,
    pub(crate) balance_rows: Kernel<BalanceRows<'static>>,
}

impl GridKernels {
    pub(crate) fn build(context: &Context, device: cl_device_id) -> Result<Self> {
        let program = compile(context, device, Build::Grid)?;
        Ok(Self {
            enter_sites: Kernel::new(&program)?,
            mark_voxels: Kernel::new(&program)?,
            rank_sites: Kernel::new(&program)?,
            count_digits: Kernel::new(&program)?,
            place_digits: Kernel::new(&program)?,
            scan_blocks: Kernel::new(&program)?,
            add_blocks: Kernel::new(&program)?,
            settle_runs: Kernel::new(&program)?,
            gather_sites: Kernel::new(&program)?,
            find_voxels: Kernel::new(&program)?,
            look_at_rings: Kernel::new(&program)?,
            bound_nodes: Kernel::new(&program)?,
            tighten_slabs: Kernel::new(&program)?,
            split_boxes: Kernel::new(&program)?,
            judge_parts: Kernel::new(&program)?,
            place_leaves: Kernel::new(&program)?,
            find_homes: Kernel::new(&program)?,
            measure_clearances: Kernel::new(&program)?,
            choose_leaders: Kernel::new(&program)?,
            look_about: Kernel::new(&program)?,
            count_rows: Kernel::new(&program)?,
            write_rows: Kernel::new(&program)?,
            count_facets: Kernel::new(&program)?,
            list_facets: Kernel::new(&program)?,
            sort_facets: Kernel::new(&program)?,
            match_facets: Kernel::new(&program)?,
            pack_facets: Kernel::new(&program)?,
            fill_laplacian: Kernel::new(&program)?,
            gather_cells: Kernel::new(&program)?,
            sum_cells: Kernel::new(&program)?,
            move_sites: Kernel::new(&program)?,
            multiply: Kernel::new(&program)?,
            combine: Kernel::new(&program)?,
            dot_parts: Kernel::new(&program)?,
            sum_parts: Kernel::new(&program)?,
            subtract_number: Kernel::new(&program)?,
            invert_diagonal: Kernel::new(&program)?,
            find_beyond: Kernel::new(&program)?,
            find_risen: Kernel::new(&program)?,
            part_cells: Kernel::new(&program)?,
            rank_free: Kernel::new(&program)?,
            spread_ranks: Kernel::new(&program)?,
            choose_roots: Kernel::new(&program)?,
            join_roots: Kernel::new(&program)?,
            join_rest: Kernel::new(&program)?,
            prolong: Kernel::new(&program)?,
            count_columns: Kernel::new(&program)?,
            list_columns: Kernel::new(&program)?,
            sort_columns: Kernel::new(&program)?,
            multiply_rows: Kernel::new(&program)?,
            balance_rows: Kernel::new(&program)?,
        })
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
