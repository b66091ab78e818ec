//! Memory of a device that grows when it must and is kept from call to call.

use crate::fresh;
use crate::handle::Handle;
use crate::queue::Queue;
use laguerre_core::summation::CHUNK;
use laguerre_core::{Error, ErrorKind, Result};
use opencl3::context::Context;
use opencl3::error_codes::{
    CL_INVALID_BUFFER_SIZE, CL_MEM_OBJECT_ALLOCATION_FAILURE, CL_OUT_OF_HOST_MEMORY, CL_OUT_OF_RESOURCES, ClError,
};
use opencl3::memory::{Buffer, CL_MEM_READ_WRITE};
use rayon::prelude::*;
use std::mem::MaybeUninit;
use std::ptr;

/// What OpenCL says where memory does not suffice: no such object can be allocated, the host is out of it, or a buffer cannot be so large.
const OUT_OF_MEMORY: [i32; 3] = [CL_MEM_OBJECT_ALLOCATION_FAILURE, CL_OUT_OF_HOST_MEMORY, CL_INVALID_BUFFER_SIZE];

/// What drivers that allocate late say where a kernel is run.
const OUT_OF_MEMORY_LATE: [i32; 2] = [CL_MEM_OBJECT_ALLOCATION_FAILURE, CL_OUT_OF_RESOURCES];

/// Room for a number of `T`.
pub(crate) struct Room<T> {
    what: &'static str,
    buffer: Option<Handle<Buffer<T>>>,
    length: usize,
}

impl<T: Copy + Send + Sync> Room<T> {
    /// No room yet; `what` is for messages.
    pub(crate) const fn new(what: &'static str) -> Self {
        Self { what, buffer: None, length: 0 }
    }

    /// Makes sure that at least `length` fit. What was there is lost if it has to grow.
    pub(crate) fn grow(&mut self, context: &Context, length: usize) -> Result<()> {
        self.create(context, length).map_err(|error| {
            failed(&format!("allocating {} bytes for {}", room_for(length) * size_of::<T>(), self.what), error)
        })
    }

    /// The same where the device has the memory; says whether.
    pub(crate) fn grow_if_possible(&mut self, context: &Context, length: usize) -> Result<bool> {
        match self.create(context, length) {
            Err(error) if OUT_OF_MEMORY.contains(&error.0) => Ok(false),
            _ => self.grow(context, length).map(|()| true),
        }
    }

    /// Makes sure that at least `length` fit; the first `kept` stay what they are. It grows by half of what it had at least, where the device has
    /// the memory.
    pub(crate) fn extend(&mut self, context: &Context, queue: &Queue, kept: usize, length: usize) -> Result<()> {
        if length <= self.length {
            return Ok(());
        }
        debug_assert!(kept <= self.length, "{} end before", self.what);
        let mut larger = Self::new(self.what);
        if !larger.grow_if_possible(context, length.max(self.length + self.length / 2))? {
            larger.grow(context, length)?;
        }
        if let (Some(from), Some(to), 1..) = (&self.buffer, &mut larger.buffer, kept) {
            // SAFETY: both hold as many, and neither is freed before what is enqueued is done.
            unsafe { queue.enqueue_copy_buffer(from, to, 0, 0, kept * size_of::<T>(), &[]) }
                .map(Handle::new)
                .map_err(|e| failed(&format!("copying {}", self.what), e))?;
        }
        *self = larger;
        Ok(())
    }

    /// Gives the memory back.
    pub(crate) fn free(&mut self) {
        self.buffer = None;
        self.length = 0;
    }

    fn create(&mut self, context: &Context, length: usize) -> std::result::Result<(), ClError> {
        let length = room_for(length);
        if self.buffer.is_none() || self.length < length {
            self.free();
            // SAFETY: the flags ask for device memory alone, no host pointer is passed.
            let buffer = unsafe { Buffer::create(context, CL_MEM_READ_WRITE, length, ptr::null_mut()) }?;
            self.buffer = Some(Handle::new(buffer));
            self.length = length;
        }
        Ok(())
    }

    /// How many of it.
    pub(crate) fn length(&self) -> usize {
        self.length
    }

    /// Bytes of it.
    pub(crate) fn bytes(&self) -> u64 {
        (self.length * size_of::<T>()) as u64
    }

    /// Whether there is room for anything yet.
    pub(crate) fn is_made(&self) -> bool {
        self.buffer.is_some()
    }

    /// The buffer, as a kernel's argument.
    pub(crate) fn get(&self) -> Result<&Buffer<T>> {
        self.buffer.as_deref().ok_or_else(|| Error::new(ErrorKind::Device, format!("no memory for {}", self.what)))
    }

    /// Makes room for `data` and copies it to the device.
    pub(crate) fn fill(&mut self, context: &Context, queue: &Queue, data: &[T]) -> Result<()> {
        self.grow(context, data.len())?;
        let what = self.what;
        if let (Some(buffer), false) = (&mut self.buffer, data.is_empty()) {
            // SAFETY: the buffer has room for `data`.
            unsafe { queue.write(buffer, 0, data) }.map_err(|e| failed(&format!("copying {what} to the device"), e))?;
        }
        Ok(())
    }

    /// Copies `data` to the device, from `place` on, where there is room for it.
    pub(crate) fn write_at(&mut self, queue: &Queue, place: usize, data: &[T]) -> Result<()> {
        debug_assert!(place + data.len() <= self.length, "{} end before", self.what);
        let what = self.what;
        if let (Some(buffer), false) = (&mut self.buffer, data.is_empty() || place + data.len() > self.length) {
            // SAFETY: the buffer has room for `data` there.
            unsafe { queue.write(buffer, place, data) }
                .map_err(|e| failed(&format!("copying {what} to the device"), e))?;
        }
        Ok(())
    }

    /// Makes room for `length` numbers and sets all of them to `value`.
    pub(crate) fn fill_with(&mut self, context: &Context, queue: &Queue, value: T, length: usize) -> Result<()> {
        self.grow(context, length)?;
        let what = self.what;
        if let (Some(buffer), 1..) = (&mut self.buffer, length) {
            let bytes = length * size_of::<T>();
            // SAFETY: the buffer holds at least `bytes`, and the pattern is copied before the call returns.
            unsafe { queue.enqueue_fill_buffer(buffer, &[value], 0, bytes, &[]) }
                .map(Handle::new)
                .map_err(|e| failed(&format!("clearing {what}"), e))?;
        }
        Ok(())
    }

    /// Copies the first `length` to `data` from `place` on; `data` ends with them.
    pub(crate) fn read_at(&self, queue: &Queue, length: usize, data: &mut Vec<T>, place: usize) -> Result<()>
    where
        T: Default,
    {
        data.truncate(place);
        self.append(queue, 0, length, data)
    }

    /// Copies the first `length` back, into memory that is kept from call to call.
    pub(crate) fn read(&self, queue: &Queue, length: usize, data: &mut Vec<T>) -> Result<()>
    where
        T: Default,
    {
        self.read_from(queue, 0, length, data)
    }

    /// The same for `length` from `first` on.
    pub(crate) fn read_from(&self, queue: &Queue, first: usize, length: usize, data: &mut Vec<T>) -> Result<()>
    where
        T: Default,
    {
        data.clear();
        self.append(queue, first, length, data)
    }

    /// The same behind what is in `data`.
    fn append(&self, queue: &Queue, first: usize, length: usize, data: &mut Vec<T>) -> Result<()>
    where
        T: Default,
    {
        let length = length.min(self.length - first.min(self.length));
        make_room(data, length);
        let begin = data.len();
        self.read_into(queue, first, &mut data.spare_capacity_mut()[..length])?;
        // SAFETY: so many are there now.
        unsafe { data.set_len(begin + length) };
        Ok(())
    }

    /// That at a place.
    pub(crate) fn number(&self, queue: &Queue, place: usize) -> Result<T>
    where
        T: Default,
    {
        self.get()?;
        let mut data = Vec::with_capacity(1);
        self.read_from(queue, place, 1, &mut data)?;
        Ok(data.first().copied().unwrap_or_default())
    }

    /// The first.
    pub(crate) fn first(&self, queue: &Queue) -> Result<T>
    where
        T: Default,
    {
        self.number(queue, 0)
    }

    fn read_into(&self, queue: &Queue, first: usize, data: &mut [MaybeUninit<T>]) -> Result<()> {
        if !data.is_empty() {
            // SAFETY: `data` ends before the buffer does; any bits are a `T`, which is a number or a struct of numbers.
            unsafe { queue.read(self.get()?, first, data) }
                .map_err(|e| failed(&format!("copying {} from the device", self.what), e))?;
        }
        Ok(())
    }
}

impl Room<u32> {
    /// Where so many rows begin, and the last one ends.
    pub(crate) fn read_offsets(&self, queue: &Queue, rows: usize) -> Result<Vec<usize>> {
        let mut offsets = Vec::new();
        self.read(queue, rows + 1, &mut offsets)?;
        Ok(offsets.par_iter().with_min_len(CHUNK).map(|&offset| offset as usize).collect())
    }
}

/// Bytes from which on threads of a pool may be waited for: what is fewer may be read and written where none may (`Devices::lock`).
pub(crate) const LARGE: usize = 1 << 20;

/// Makes room for so many more.
fn make_room<T>(data: &mut Vec<T>, more: usize) {
    if data.is_empty() && more > data.capacity() {
        // (Not both at a time.)
        *data = Vec::new();
        *data = fresh::room(more);
    }
    data.reserve(more);
}

/// A struct of memory, each with what it holds, and its name in messages.
macro_rules! rooms {
    ($vis:vis struct $Name:ident { $($(#[$attribute:meta])* $fieldvis:vis $field:ident: $ty:ty = $what:literal,)* }) => {
        $vis struct $Name {
            $($(#[$attribute])* $fieldvis $field: crate::buffer::Room<$ty>,)*
        }

        impl $Name {
            $vis const fn new() -> Self {
                Self { $($field: crate::buffer::Room::new($what),)* }
            }
        }
    };
}
pub(crate) use rooms;

/// Elements that a buffer for `length` has: OpenCL has no empty ones.
fn room_for(length: usize) -> usize {
    length.max(1)
}

/// Whether a kernel did not run for lack of memory.
pub(crate) fn lacked_memory(error: &ClError) -> bool {
    OUT_OF_MEMORY_LATE.contains(&error.0)
}

/// A device error in one line.
pub(crate) fn failed(doing: &str, error: ClError) -> Error {
    let or = if OUT_OF_MEMORY.contains(&error.0) || lacked_memory(&error) { ", or fewer sites" } else { "" };
    Error::new(ErrorKind::Device, format!("OpenCL failed {doing}: {error} ({}): use the CPU{or}", error.0))
}
