//! Kernels, and how they are run.

use crate::buffer::{Room, failed};
use crate::handle::Handle;
use laguerre_core::{Error, Result};
use opencl3::command_queue::CommandQueue;
use opencl3::error_codes::ClError;
use opencl3::kernel::Kernel as Object;
use opencl3::program::Program;
use opencl3::types::cl_device_id;
use std::marker::PhantomData;
use std::ptr;

/// A kernel that takes the arguments `K`, and its name for messages: a lost device would not tell it.
pub(crate) struct Kernel<K> {
    object: Handle<Object>,
    name: String,
    arguments: PhantomData<K>,
}

/// What the parameters of a kernel are given: a buffer, a number, or several of them.
pub(crate) trait Argument {
    /// Sets it, or them, as the next arguments; fails where a buffer has no memory. What OpenCL says is known at the end.
    fn set(&self, launch: &mut Launch<'_>) -> Result<()>;
}

/// All that a kernel is given: made by `kernels!` alone, from the table that the kernel's own parameters are generated from.
pub(crate) trait Arguments: Argument {
    /// The kernel's name.
    const KERNEL: &'static str;
    /// These arguments whatever they borrow.
    type Kernel: 'static;
}

impl<T: Copy + Send + Sync> Argument for &Room<T> {
    fn set(&self, launch: &mut Launch<'_>) -> Result<()> {
        let buffer = self.get()?;
        // SAFETY: the kernel's parameter, which is next in the table, is a pointer to global memory.
        unsafe { launch.argument(buffer) };
        Ok(())
    }
}

impl Argument for u32 {
    fn set(&self, launch: &mut Launch<'_>) -> Result<()> {
        // SAFETY: the kernel's parameter, which is next in the table, is a `uint`.
        unsafe { launch.argument(self) };
        Ok(())
    }
}

impl Argument for f64 {
    fn set(&self, launch: &mut Launch<'_>) -> Result<()> {
        // SAFETY: the kernel's parameter, which is next in the table, is a `double`.
        unsafe { launch.argument(self) };
        Ok(())
    }
}

impl<K: Arguments> Kernel<K> {
    /// The kernel that takes these arguments.
    pub(crate) fn new(program: &Program) -> Result<Self> {
        Self::named(program, K::KERNEL)
    }
}

impl<K> Kernel<K> {
    /// A kernel by its name, which has no NUL in it; it takes these arguments.
    pub(crate) fn named(program: &Program, name: &str) -> Result<Self> {
        let object = Object::create(program, name).map_err(|e| failed(&format!("creating {name}"), e))?;
        Ok(Self { object: Handle::new(object), name: name.to_owned(), arguments: PhantomData })
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

    /// Enqueues `items` work-items, rounded up to whole groups.
    pub(crate) fn run<A>(&self, queue: &CommandQueue, items: usize, group: usize, arguments: A) -> Result<()>
    where
        A: Arguments<Kernel = K>,
    {
        self.launch(queue, items, group, arguments)?.map_err(|error| self.failed(error))
    }

    /// The same; gives OpenCL's answer. Buffers have the lengths that the kernel is told.
    pub(crate) fn launch<A>(
        &self,
        queue: &CommandQueue,
        items: usize,
        group: usize,
        arguments: A,
    ) -> Result<std::result::Result<(), ClError>>
    where
        A: Arguments<Kernel = K>,
    {
        let mut launch = Launch { kernel: &self.object, arguments: 0, status: Ok(()) };
        arguments.set(&mut launch)?;
        // SAFETY: all arguments are set, in the order and of the types that the kernel declares, which come from the same table;
        // kernels leave the rest of the last group alone.
        Ok(unsafe { launch.enqueue(queue, items, group) })
    }
}

/// A kernel that gets its arguments one by one and is then enqueued.
pub(crate) struct Launch<'a> {
    kernel: &'a Object,
    arguments: u32,
    status: std::result::Result<(), ClError>,
}

impl Launch<'_> {
    /// Sets the next argument.
    ///
    /// # Safety
    /// The kernel has this argument, and it is of this type.
    unsafe fn argument<T>(&mut self, value: &T) {
        if self.status.is_ok() {
            // SAFETY: as the caller promises.
            self.status = unsafe { self.kernel.set_arg(self.arguments, value) };
            self.arguments += 1;
        }
    }

    /// Enqueues `items` work-items, rounded up to whole groups.
    ///
    /// # Safety
    /// All arguments are set, and as the kernel expects them.
    unsafe fn enqueue(self, queue: &CommandQueue, items: usize, group: usize) -> std::result::Result<(), ClError> {
        self.status?;
        let (items, kernel) = (items.next_multiple_of(group), self.kernel.get());
        // SAFETY: both sizes are of the one dimension, and there is no offset; the rest is as the caller promises.
        let event = unsafe { queue.enqueue_nd_range_kernel(kernel, 1, ptr::null(), &items, &group, &[]) };
        event.map(Handle::new).map(drop)
    }
}
