//! Kernels, and how they are run.

use crate::buffer::failed;
use crate::handle::Handle;
use laguerre_core::{Error, Result};
use opencl3::command_queue::CommandQueue;
use opencl3::error_codes::ClError;
use opencl3::kernel::Kernel as Object;
use opencl3::program::Program;
use opencl3::types::cl_device_id;
use std::ptr;

/// A kernel, and its name for messages: a lost device would not tell it.
pub(crate) struct Kernel {
    object: Handle<Object>,
    name: String,
}

impl Kernel {
    /// The kernel of that name, which has no NUL in it.
    pub(crate) fn new(program: &Program, name: &str) -> Result<Self> {
        let object = Object::create(program, name).map_err(|e| failed(&format!("creating {name}"), e))?;
        Ok(Self { object: Handle::new(object), name: name.to_owned() })
    }

    /// Work-items of a group at most.
    pub(crate) fn largest_group(&self, device: cl_device_id) -> Result<usize> {
        let asking = || format!("asking for the work-groups of {}", self.name);
        self.object.get_work_group_size(device).map_err(|e| failed(&asking(), e))
    }

    /// The error of a launch.
    pub(crate) fn failed(&self, error: ClError) -> Error {
        failed(&format!("running {}", self.name), error)
    }
}

/// A kernel that gets its arguments one by one and is then enqueued: by [`launch`] and [`enqueue`].
pub(crate) struct Launch<'a> {
    kernel: &'a Kernel,
    arguments: u32,
    status: std::result::Result<(), ClError>,
}

impl<'a> Launch<'a> {
    pub(crate) const fn new(kernel: &'a Kernel) -> Self {
        Self { kernel, arguments: 0, status: Ok(()) }
    }

    /// Sets the next argument. What fails is said by [`enqueue`](Self::enqueue).
    ///
    /// # Safety
    /// The kernel has this argument, and it is of this type.
    pub(crate) unsafe fn argument<T>(&mut self, value: &T) {
        if self.status.is_ok() {
            // SAFETY: as the caller promises.
            self.status = unsafe { self.kernel.object.set_arg(self.arguments, value) };
            self.arguments += 1;
        }
    }

    /// Enqueues `items` work-items, rounded up to whole groups.
    ///
    /// # Safety
    /// All arguments are set, and as the kernel expects them.
    pub(crate) unsafe fn enqueue(
        self,
        queue: &CommandQueue,
        items: usize,
        group: usize,
    ) -> std::result::Result<(), ClError> {
        self.status?;
        let (items, kernel) = (items.next_multiple_of(group), self.kernel.object.get());
        // SAFETY: both sizes are of the one dimension, and there is no offset; the rest is as the caller promises.
        let event = unsafe { queue.enqueue_nd_range_kernel(kernel, 1, ptr::null(), &items, &group, &[]) };
        event.map(Handle::new).map(drop)
    }
}

/// Enqueues `items` work-items of a kernel, rounded up to whole groups, with its arguments in their order; OpenCL's answer.
macro_rules! launch {
    ($queue:expr, $kernel:expr, $items:expr, $group:expr; $($argument:expr),* $(,)?) => {{
        let mut launch = crate::launch::Launch::new($kernel);
        // SAFETY: the arguments are those that the kernel declares, in its order and of its types; every buffer has the length that
        // the kernel is told, and kernels leave the rest of the last group alone.
        unsafe {
            $(launch.argument($argument);)*
            launch.enqueue($queue, $items, $group)
        }
    }};
}
pub(crate) use launch;

/// The same; a failure leaves the function.
macro_rules! enqueue {
    ($queue:expr, $kernel:expr, $($rest:tt)*) => {
        crate::launch::launch!($queue, $kernel, $($rest)*).map_err(|error| ($kernel).failed(error))?
    };
}
pub(crate) use enqueue;
