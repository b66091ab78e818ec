//! Memory of a device that grows when it must and is kept from call to call.

use laguerre_core::{Error, ErrorKind, Result};
use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::error_codes::ClError;
use opencl3::memory::{Buffer, CL_MEM_READ_WRITE};
use opencl3::types::CL_BLOCKING;
use std::ptr;

/// Room for a number of `T`.
pub(crate) struct Room<T> {
    what: &'static str,
    buffer: Option<Buffer<T>>,
    length: usize,
}

impl<T: Copy> Room<T> {
    /// No room yet; `what` is for messages.
    pub(crate) const fn new(what: &'static str) -> Self {
        Self { what, buffer: None, length: 0 }
    }

    /// Makes sure that at least `length` fit. What was there is lost if it has to grow.
    pub(crate) fn grow(&mut self, context: &Context, length: usize) -> Result<()> {
        // OpenCL has no empty buffers.
        let length = length.max(1);
        if self.buffer.is_some() && self.length >= length {
            return Ok(());
        }
        self.buffer = None;
        let bytes = length * size_of::<T>();
        // SAFETY: the flags ask for device memory alone, no host pointer is passed.
        let buffer = unsafe { Buffer::create(context, CL_MEM_READ_WRITE, length, ptr::null_mut()) };
        self.buffer = Some(buffer.map_err(|e| failed(&format!("allocating {bytes} bytes for {}", self.what), e))?);
        self.length = length;
        Ok(())
    }

    /// The buffer, as a kernel's argument.
    pub(crate) fn get(&self) -> Result<&Buffer<T>> {
        self.buffer.as_ref().ok_or_else(|| Error::new(ErrorKind::Device, format!("no memory for {}", self.what)))
    }

    /// Makes room for `data` and copies it to the device.
    pub(crate) fn fill(&mut self, context: &Context, queue: &CommandQueue, data: &[T]) -> Result<()> {
        self.grow(context, data.len())?;
        let what = self.what;
        if let (Some(buffer), false) = (&mut self.buffer, data.is_empty()) {
            // SAFETY: the buffer has room for `data`, and the call returns when it is copied.
            unsafe { queue.enqueue_write_buffer(buffer, CL_BLOCKING, 0, data, &[]) }
                .map_err(|e| failed(&format!("copying {what} to the device"), e))?;
        }
        Ok(())
    }

    /// Copies the first `length` back, into memory that is kept from call to call.
    pub(crate) fn read(&self, queue: &CommandQueue, length: usize, data: &mut Vec<T>) -> Result<()>
    where
        T: Default,
    {
        data.resize(length.min(self.length), T::default());
        if !data.is_empty() {
            // SAFETY: `data` is no longer than the buffer, and the call returns when it is filled; any bits are a `T`, which
            // is a number or a struct of numbers.
            unsafe { queue.enqueue_read_buffer(self.get()?, CL_BLOCKING, 0, data, &[]) }
                .map_err(|e| failed(&format!("copying {} from the device", self.what), e))?;
        }
        Ok(())
    }
}

/// A device error in one line.
pub(crate) fn failed(doing: &str, error: ClError) -> Error {
    Error::new(ErrorKind::Device, format!("OpenCL failed {doing}: {error} ({})", error.0))
}
