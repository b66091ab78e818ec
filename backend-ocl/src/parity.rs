//! Runs the device's own functions of the algorithm one by one, on words that the host's were run on (`laguerre_core::cell::parity`).

use crate::buffer::{Room, failed};
use crate::handle::Handle;
use crate::launch::{Kernel, enqueue};
use crate::platform::{self, choose};
use crate::program::compile;
use laguerre_core::cell::parity::{Calls, NEIGHBORS, PLANES, VERTICES, World};
use laguerre_core::{DeviceChoice, Error, ErrorKind, Precision, Result};
use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::program::Program;

/// The generated functions, as a device gets them.
pub const FUNCTIONS: &str = include_str!("kernels/cell.cl");

const SOURCES: [&str; 16] = [
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
    FUNCTIONS,
    include_str!("kernels/reach.cl"),
    include_str!("kernels/pyramid.cl"),
    include_str!("kernels/search.cl"),
    include_str!("kernels/parity_state.cl"),
    include_str!("kernels/parity.cl"),
];

/// At least as large as `Params` of `params.cl`, in numbers.
const ROOM_FOR_PARAMS: usize = 1024;

/// Work-items of a group: a device on the host has the stores of a whole group on one stack.
const GROUP: usize = 32;

/// A device with the kernels that call its functions.
pub struct Parity {
    name: String,
    program: Handle<Program>,
    queue: Handle<CommandQueue>,
    context: Handle<Context>,
    params: Room<f64>,
    vertices: Room<[f64; 3]>,
    table: Room<u32>,
    integrand: Room<f64>,
}

impl Parity {
    /// Opens the first device of a choice and builds the kernels for it, from `functions` (normally [`FUNCTIONS`]).
    ///
    /// # Errors
    /// `Unavailable` where there is no OpenCL or no device; `Device` where it fails.
    pub fn open(choice: &DeviceChoice, world: &World, functions: &str) -> Result<Self> {
        let chosen = choose(choice, Precision::F64)?;
        let found = chosen.first().ok_or_else(|| Error::new(ErrorKind::Unavailable, "no device was chosen"))?;
        let (context, queue) = platform::open(found)?;
        let with = "-D WITH_FACETS=1 -D WITH_FACET_SECOND=1 -D WITH_INTEGRAL=1";
        let options = format!("-D CAP_P={PLANES} -D CAP_V={VERTICES} {with} -D NEIGHBORS={NEIGHBORS}");
        let source = SOURCES.map(|part| if part == FUNCTIONS { functions } else { part }).concat();
        let program = compile(&context, found.id.0, &source, &options)?;
        let numbers = filled(&context, &queue, &world.numbers)?;
        let parity = Self {
            name: found.info.name.clone(),
            params: filled(&context, &queue, &[0.0; ROOM_FOR_PARAMS])?,
            vertices: filled(&context, &queue, &world.vertices)?,
            table: filled(&context, &queue, &world.table)?,
            integrand: filled(&context, &queue, &world.integrand.table())?,
            program,
            queue,
            context,
        };
        let kernel = parity.kernel("prepare")?;
        enqueue!(&parity.queue, &kernel, 1, 1; parity.params.get()?, numbers.get()?);
        parity.queue.finish().map_err(|e| failed("running parity_prepare", e))?;
        Ok(parity)
    }

    /// The device's name.
    pub fn device(&self) -> &str {
        &self.name
    }

    /// The results of a function of the device on the arguments of `calls`, call after call.
    ///
    /// # Errors
    /// `Device` where it fails.
    pub fn run(&self, function: &str, calls: &Calls) -> Result<Vec<u64>> {
        let (context, queue) = (&self.context, &self.queue);
        let kernel = self.kernel(function)?;
        let mut results = vec![0; calls.outputs.len()];
        let count = results.len() / calls.output_width.max(1);
        let inputs = filled(context, queue, &calls.inputs)?;
        let outputs = filled(context, queue, &results)?;
        // As `PARITY_ARGUMENTS` in `parity_state.cl` has them; the words of `count` calls stand in both buffers.
        enqueue!(queue, &kernel, count, GROUP;
            self.params.get()?, self.vertices.get()?, self.table.get()?, self.integrand.get()?, inputs.get()?, &(calls.input_width as u32),
            outputs.get()?, &(calls.output_width as u32), &(count as u32));
        outputs.read(queue, count * calls.output_width, &mut results)?;
        Ok(results)
    }

    fn kernel(&self, function: &str) -> Result<Kernel> {
        Kernel::new(&self.program, &format!("parity_{function}"))
    }
}

/// Memory with `data` in it.
fn filled<T: Copy>(context: &Context, queue: &CommandQueue, data: &[T]) -> Result<Room<T>> {
    let mut room = Room::new("the parity kernels");
    room.fill(context, queue, data)?;
    Ok(room)
}
