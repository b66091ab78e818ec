//! Whether the work-items of a sub-group can compute a cell together (`lanes_talk.cl`).

use crate::buffer::Room;
use crate::builds::{Build, Lanes};
use crate::interface::kernels::TryLanes;
use crate::launch::Kernel;
use crate::program::compile;
use crate::queue::Queue;
use laguerre_core::Result;
use opencl3::context::Context;
use opencl3::device::Device;
use opencl3::types::cl_device_id;

/// Sizes of sub-groups that are tried: vertices of a cell are shared out among 32 best, and more have no place in a number's bits.
const SIZES: [u32; 3] = [32, 16, 8];

/// Local memory that the cells of a group take, at most.
const LOCAL_MEMORY: u64 = 48 << 10;

/// Cells of a group that tries lanes (`lanes_trial.cl`), as many as the teams of the largest cells, and groups.
const CELLS: usize = 8;
const GROUPS: usize = 16;

/// What sub-groups need to have.
const EXTENSIONS: [&str; 2] = ["cl_khr_subgroup_ballot", "cl_khr_subgroup_shuffle"];

/// The largest sub-group of the device that is what the kernels take it for, if there is one.
pub(crate) fn sub_group(id: cl_device_id, context: &Context, queue: &Queue) -> Option<Lanes> {
    first_right(SIZES.map(Lanes::SubGroup), id, context, queue)
}

/// The smallest for tests on a CPU, where fewer lanes take less time, by a compiler that does not optimise.
#[cfg(feature = "test-util")]
pub(crate) fn sub_group_as_written(id: cl_device_id, context: &Context, queue: &Queue) -> Option<Lanes> {
    let [large, middle, small] = SIZES;
    first_right([small, middle, large].map(Lanes::SubGroupAsWritten), id, context, queue)
}

fn first_right(lanes: [Lanes; 3], id: cl_device_id, context: &Context, queue: &Queue) -> Option<Lanes> {
    let device = Device::new(id);
    let extensions = device.extensions().ok()?;
    let has = |name: &&str| extensions.split_whitespace().any(|word| word == *name);
    if !EXTENSIONS.iter().all(has) || device.local_mem_size().ok()? < LOCAL_MEMORY {
        return None;
    }
    // (A size that the device does not have does not build, or is answered by another.)
    lanes.into_iter().find(|&lanes| are_right(lanes, id, context, queue).unwrap_or(false))
}

fn are_right(lanes: Lanes, id: cl_device_id, context: &Context, queue: &Queue) -> Result<bool> {
    let program = compile(context, id, Build::Trial(lanes))?;
    let kernel: Kernel<TryLanes<'static>> = Kernel::new(&program)?;
    let group = CELLS * lanes.count();
    if kernel.largest_group(id)? < group {
        return Ok(false);
    }
    let mut right = Room::new("a trial of sub-groups");
    right.fill(context, queue, &vec![0; GROUPS * group])?;
    kernel.run(queue, GROUPS * group, group, TryLanes { right: &right })?;
    let mut all = Vec::new();
    right.read(queue, GROUPS * group, &mut all)?;
    Ok(all.iter().all(|&is_right: &u32| is_right == 1))
}
