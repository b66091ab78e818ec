//! The kernels: their source, built for the room of a pass, and kept.

use crate::handle::Handle;
use crate::interface::data::Params;
use crate::interface::kernels::{
    AddBlocks, BoundBlocks, Cells, CountSites, EnterSites, FitBlocks, GatherSites, LookAbout, MarkVoxels,
    MeasureClearances, PlaceSites, RaiseBounds, RaiseLevel, ScanBlocks, SortVoxels,
};
use crate::launch::Kernel;
use laguerre_core::cell::{FACET_SECOND_MOMENTS, FACETS, INTEGRAL};
use laguerre_core::passes::Capacities;
use laguerre_core::{Error, ErrorKind, Result};
use opencl3::context::Context;
use opencl3::error_codes::{CL_BUILD_PROGRAM_FAILURE, CL_INVALID_BUILD_OPTIONS, ClError};
use opencl3::program::{Program, build_program};
use opencl3::types::cl_device_id;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ffi::CString;
use std::ptr;

const EVALUATE: [&str; 16] = [
    include_str!("kernels/prelude.cl"),
    include_str!("kernels/cell_types.cl"),
    include_str!("kernels/interface.cl"),
    include_str!("kernels/params.cl"),
    include_str!("kernels/ties.cl"),
    include_str!("kernels/store.cl"),
    include_str!("kernels/marks.cl"),
    include_str!("kernels/surface_table.cl"),
    include_str!("kernels/world.cl"),
    include_str!("kernels/further.cl"),
    include_str!("kernels/cell.cl"),
    include_str!("kernels/reach.cl"),
    include_str!("kernels/pyramid.cl"),
    include_str!("kernels/search.cl"),
    include_str!("kernels/output.cl"),
    include_str!("kernels/evaluate.cl"),
];

const TOGETHER: [&str; 24] = [
    include_str!("kernels/prelude.cl"),
    include_str!("kernels/cell_types.cl"),
    include_str!("kernels/interface.cl"),
    include_str!("kernels/params.cl"),
    include_str!("kernels/bounds.cl"),
    include_str!("kernels/ties.cl"),
    include_str!("kernels/lanes_store.cl"),
    include_str!("kernels/surface_table.cl"),
    include_str!("kernels/world.cl"),
    include_str!("kernels/further.cl"),
    include_str!("kernels/cell.cl"),
    include_str!("kernels/reach.cl"),
    include_str!("kernels/output.cl"),
    include_str!("kernels/lanes_exact.cl"),
    include_str!("kernels/lanes_clip.cl"),
    include_str!("kernels/lanes_cap.cl"),
    include_str!("kernels/lanes_reach.cl"),
    include_str!("kernels/lanes_far.cl"),
    include_str!("kernels/lanes.cl"),
    include_str!("kernels/lanes_near.cl"),
    include_str!("kernels/lanes_sums.cl"),
    include_str!("kernels/lanes_surface.cl"),
    include_str!("kernels/lanes_integrate.cl"),
    include_str!("kernels/lanes_evaluate.cl"),
];

const GRID: [&str; 9] = [
    include_str!("kernels/prelude.cl"),
    include_str!("kernels/cell_types.cl"),
    include_str!("kernels/interface.cl"),
    include_str!("kernels/params.cl"),
    include_str!("kernels/bounds.cl"),
    include_str!("kernels/grid.cl"),
    include_str!("kernels/blocks.cl"),
    include_str!("kernels/surface_table.cl"),
    include_str!("kernels/clearance.cl"),
];

/// Most half-spaces that a work-item has room for; what needs more is the host's.
pub(crate) const MOST_PLANES: u32 = 216;

/// Who computes a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Way {
    /// One work-item, with so much room.
    Alone(Capacities),
    /// A group of so many work-items: `LANES` of `lanes_store.cl`.
    Together(usize, Stage),
}

/// What cells that are computed together are built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Stage {
    /// All of them; those are given up that need exact signs, or may meet the surface.
    First,
    /// Those that may meet the surface; those are given up that need exact signs.
    Surface,
    /// Those that need exact signs, or sites beyond the table of offsets.
    Exact,
    /// Those that need more room.
    Wide,
}

/// Work-items of a group where each computes a cell alone. They share nothing; a multiple of what any GPU runs in step.
const GROUP: usize = 64;

/// Stand among the flags for a domain and for weights that differ: the kernels of shared cells are faster if they know that there is none,
/// or that they do not (by 3 % and by 8 %, one NVIDIA H200).
const DOMAIN: u32 = 1 << 31;
const WEIGHTS: u32 = 1 << 30;

/// Cells of a group where several work-items compute one together: as many as fit into 48 KiB, so that they go through the same
/// instructions at about the same time, which are more than the nearest cache holds (of 2 million cells, 5 instead of 4 save 1 %, 2 cost 8 %;
/// one NVIDIA H200); but no more than let registers be used up.
const fn cells_of_group(stage: Stage) -> usize {
    match stage {
        Stage::First => 5,
        Stage::Surface | Stage::Exact => 4,
        Stage::Wide => 1,
    }
}

/// One build, and its kernels.
pub(crate) struct Kernels {
    pub(crate) cells: Kernel<Cells<'static>>,
    /// Work-items of a group, and those that compute one cell.
    pub(crate) group: usize,
    pub(crate) per_cell: usize,
}

/// The kernels that sort sites, and those that find how near the surface is to them.
pub(crate) struct GridKernels {
    pub(crate) enter_sites: Kernel<EnterSites<'static>>,
    pub(crate) mark_voxels: Kernel<MarkVoxels<'static>>,
    pub(crate) count_sites: Kernel<CountSites<'static>>,
    pub(crate) scan_blocks: Kernel<ScanBlocks<'static>>,
    pub(crate) add_blocks: Kernel<AddBlocks<'static>>,
    pub(crate) place_sites: Kernel<PlaceSites<'static>>,
    pub(crate) sort_voxels: Kernel<SortVoxels<'static>>,
    pub(crate) gather_sites: Kernel<GatherSites<'static>>,
    pub(crate) raise_level: Kernel<RaiseLevel<'static>>,
    pub(crate) fit_blocks: Kernel<FitBlocks<'static>>,
    pub(crate) raise_bounds: Kernel<RaiseBounds<'static>>,
    pub(crate) bound_blocks: Kernel<BoundBlocks<'static>>,
    pub(crate) measure_clearances: Kernel<MeasureClearances<'static>>,
    pub(crate) look_about: Kernel<LookAbout<'static>>,
}

impl GridKernels {
    pub(crate) fn build(context: &Context, device: cl_device_id) -> Result<Self> {
        let program = compile(context, device, &GRID.concat(), "")?;
        Ok(Self {
            enter_sites: Kernel::new(&program)?,
            mark_voxels: Kernel::new(&program)?,
            count_sites: Kernel::new(&program)?,
            scan_blocks: Kernel::new(&program)?,
            add_blocks: Kernel::new(&program)?,
            place_sites: Kernel::new(&program)?,
            sort_voxels: Kernel::new(&program)?,
            gather_sites: Kernel::new(&program)?,
            raise_level: Kernel::new(&program)?,
            fit_blocks: Kernel::new(&program)?,
            raise_bounds: Kernel::new(&program)?,
            bound_blocks: Kernel::new(&program)?,
            measure_clearances: Kernel::new(&program)?,
            look_about: Kernel::new(&program)?,
        })
    }
}

/// All builds so far.
#[derive(Default)]
pub(crate) struct Programs {
    built: HashMap<(Way, u32), Kernels>,
}

impl Programs {
    /// The kernels that compute cells in the given way, with what the flags of `integrate_cell` ask for and no more, and where cells
    /// are shared with a domain or without, and for weights that differ or not; built if they are not.
    pub(crate) fn get(
        &mut self,
        context: &Context,
        device: cl_device_id,
        way: Way,
        params: &Params,
    ) -> Result<&mut Kernels> {
        let mut compiled = params.flags & (FACETS | FACET_SECOND_MOMENTS | INTEGRAL);
        if matches!(way, Way::Together(..)) {
            compiled |= if params.has_domain == 0 { 0 } else { DOMAIN };
            compiled |= if params.equal_weights == 0 { WEIGHTS } else { 0 };
        }
        match self.built.entry((way, compiled)) {
            Entry::Occupied(built) => Ok(built.into_mut()),
            Entry::Vacant(place) => Ok(place.insert(build(context, device, way, compiled)?)),
        }
    }
}

fn build(context: &Context, device: cl_device_id, way: Way, flags: u32) -> Result<Kernels> {
    let with = |name: &str, flag: u32| format!("-D WITH_{name}={}", u32::from(flags & flag != 0));
    let asked = [
        ("FACETS", FACETS),
        ("FACET_SECOND", FACET_SECOND_MOMENTS),
        ("INTEGRAL", INTEGRAL),
        ("DOMAIN", DOMAIN),
        ("WEIGHTS", WEIGHTS),
    ];
    let asked = asked.map(|(name, flag)| with(name, flag)).join(" ");
    let program = match way {
        Way::Alone(Capacities { planes, vertices }) => {
            let options = format!("-D CAP_P={planes} -D CAP_V={vertices} {asked}");
            compile(context, device, &EVALUATE.concat(), &options)?
        }
        Way::Together(lanes, stage) => {
            // More registers each, and fewer cells are computed at a time (measured for each stage; an option of NVIDIA's alone).
            let registers = match stage {
                _ if lanes == 1 => String::new(),
                Stage::First => "-cl-nv-maxrregcount=96".into(),
                Stage::Surface => "-cl-nv-maxrregcount=168".into(),
                Stage::Exact => "-cl-nv-maxrregcount=128".into(),
                Stage::Wide => String::new(),
            };
            // The facets of a cell that the surface cuts are not computed together.
            let surface = stage != Stage::First && flags & DOMAIN != 0 && flags & FACETS == 0;
            let exact = matches!(stage, Stage::Exact | Stage::Wide);
            let [exact, surface, room] = [exact, surface, stage == Stage::Wide].map(u32::from);
            let cells = cells_of_group(stage);
            let options = format!(
                "-D LANES={lanes}u -D CELLS={cells} -D WITH_EXACT={exact} -D WITH_SURFACE={surface} -D WITH_ROOM={room} {asked} \
                 {registers}"
            );
            compile(context, device, &TOGETHER.concat(), &options)?
        }
    };
    let cells = Kernel::new(&program)?;
    let largest = cells.largest_group(device)?;
    let (group, per_cell) = match way {
        Way::Alone(_) => (GROUP.min(largest), 1),
        Way::Together(lanes, stage) => (lanes * cells_of_group(stage), lanes),
    };
    Ok(Kernels { cells, group, per_cell })
}

/// Most characters of a build log that stand in a message.
const MOST_OF_A_LOG: usize = 1000;

/// Builds a program for a device.
pub(crate) fn compile(context: &Context, device: cl_device_id, source: &str, options: &str) -> Result<Handle<Program>> {
    let failed = |error: ClError, log: &str| {
        let message = format!("the OpenCL kernels do not build: {error} ({}): use --backend cpu{log}", error.0);
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
