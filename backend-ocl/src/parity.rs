//! Runs the device's own functions of the algorithm one by one, on words that the host's were run on (`laguerre_core::cell::parity`).

use crate::buffer::Room;
use crate::builds::Build;
use crate::handle::Handle;
use crate::interface::data::Params;
use crate::interface::parity::Parity as Call;
use crate::launch::Kernel;
use crate::platform::{self, choose};
use crate::program::compile_text;
use crate::queue::Queue;
use laguerre_core::cell::parity::{Calls, NEIGHBORS, PLANES, VERTICES, World};
use laguerre_core::passes::Capacities;
use laguerre_core::{DeviceChoice, Error, ErrorKind, Precision, Result};
use opencl3::context::Context;
use opencl3::program::Program;
use std::sync::Arc;

/// The generated functions of a cell, as a device gets them.
pub fn functions() -> String {
    crate::sources::generated("generated/cell_alone.cl")
}

/// Work-items of a group: a device on the host has the stores of a whole group on one stack.
const GROUP: usize = 32;

/// A device with the kernels that call its functions.
pub struct Parity {
    name: String,
    program: Handle<Program>,
    queue: Queue,
    context: Arc<Handle<Context>>,
    params: Room<Params>,
    vertices: Room<[f64; 3]>,
    table: Room<u32>,
    integrand: Room<f64>,
}

impl Parity {
    /// Opens the first device of a choice and builds the kernels for it, their text as `changed` leaves it.
    ///
    /// # Errors
    /// `Unavailable` where there is no OpenCL or no device; `Device` where it fails.
    pub fn open(choice: &DeviceChoice, world: &World, changed: impl Fn(String) -> String) -> Result<Self> {
        let chosen = choose(choice, Precision::F64)?;
        let found = chosen.first().ok_or_else(|| Error::new(ErrorKind::Unavailable, "no device was chosen"))?;
        let (context, queue) = platform::open(found)?;
        let room = Capacities { planes: PLANES, vertices: VERTICES };
        let build = Build::Parity(room, NEIGHBORS as u32);
        let text = changed(build.text().whole()?);
        let program = compile_text(&context, found.id.0, &text, &build.options())?;
        Ok(Self {
            name: found.info.name.clone(),
            params: filled(&context, &queue, &[params_of(world)])?,
            vertices: filled(&context, &queue, &world.vertices)?,
            table: filled(&context, &queue, &world.table)?,
            integrand: filled(&context, &queue, &world.integrand.table())?,
            program,
            queue,
            context,
        })
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
        // The words of `count` calls stand in both buffers.
        let arguments = Call {
            params: &self.params,
            domain_vertices: &self.vertices,
            table: &self.table,
            integrand: &self.integrand,
            inputs: &inputs,
            input_width: calls.input_width as u32,
            outputs: &outputs,
            output_width: calls.output_width as u32,
            count: count as u32,
        };
        kernel.run(queue, count, GROUP, arguments)?;
        outputs.read(queue, count * calls.output_width, &mut results)?;
        Ok(results)
    }

    fn kernel(&self, function: &str) -> Result<Kernel<Call<'static>>> {
        Kernel::named(&self.program, &format!("parity_{function}"))
    }
}

/// What the store reads, of the numbers of a world.
fn params_of(world: &World) -> Params {
    let (numbers, integrand) = (&world.numbers, &world.integrand);
    let three = |at: usize| [numbers[at], numbers[at + 1], numbers[at + 2]];
    Params {
        box_lo: three(0),
        box_hi: three(3),
        domain_lo: three(0),
        domain_width: numbers[6],
        domain_dims: three(7).map(|n| n as u32),
        has_domain: 1,
        nodes: integrand.nodes().len() as u32,
        degree: integrand.degree(),
        origin: integrand.origin(),
        ..Params::default()
    }
}

/// Memory with `data` in it.
fn filled<T: Copy + Send + Sync>(context: &Context, queue: &Queue, data: &[T]) -> Result<Room<T>> {
    let mut room = Room::new("the parity kernels");
    room.fill(context, queue, data)?;
    Ok(room)
}
