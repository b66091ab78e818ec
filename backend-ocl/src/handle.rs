//! OpenCL's objects, held so that letting go of them never panics.

use opencl3::command_queue::{CommandQueue, release_command_queue};
use opencl3::context::Context;
use opencl3::context::context::release_context;
use opencl3::event::{Event, release_event};
use opencl3::kernel::{Kernel, release_kernel};
use opencl3::memory::{Buffer, ClMem, release_mem_object};
use opencl3::program::{Program, release_program};
use opencl3::types::cl_int;
use std::mem::ManuallyDrop;
use std::ops::{Deref, DerefMut};

/// An object of opencl3, released when it is dropped, whatever OpenCL says to that: opencl3 0.12 panics where OpenCL refuses, and once
/// a device is lost it refuses everything.
///
/// The object's own `Drop` never runs, so it must have no memory but OpenCL's: a context without its list of devices, a program
/// without its kernels' names.
pub(crate) struct Handle<T: Release>(ManuallyDrop<T>);

impl<T: Release> Handle<T> {
    pub(crate) const fn new(object: T) -> Self {
        Self(ManuallyDrop::new(object))
    }
}

impl<T: Release> Deref for Handle<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T: Release> DerefMut for Handle<T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.0
    }
}

impl<T: Release> Drop for Handle<T> {
    fn drop(&mut self) {
        // What OpenCL does not take back is lost with its device; nobody could do anything about it.
        // SAFETY: the object was created by OpenCL and is used by nobody any more.
        let _ = unsafe { self.0.release() };
    }
}

/// An object that is given back to OpenCL.
pub(crate) trait Release {
    /// Gives it back.
    ///
    /// # Safety
    /// It is not used, nor given back, again.
    unsafe fn release(&self) -> Result<(), cl_int>;
}

macro_rules! release {
    ($($object:ty $([$item:ident])?, $release:path;)*) => {$(
        impl$(<$item>)? Release for $object {
            unsafe fn release(&self) -> Result<(), cl_int> {
                // SAFETY: as the caller promises.
                unsafe { $release(self.get()) }
            }
        }
    )*};
}

release! {
    Context, release_context;
    CommandQueue, release_command_queue;
    Program, release_program;
    Kernel, release_kernel;
    Event, release_event;
    Buffer<T> [T], release_mem_object;
}
