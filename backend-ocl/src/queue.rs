//! A device's queue, and how large data goes over it: by way of memory that the device reads and writes itself.
//!
//! Other memory of the host is copied by the driver, with one thread, to such memory of its own. Here all threads copy, one part while the device has others:
//! 360 MB come back in 9 ms instead of 39 (one H100, 16 cores); the other way the driver's copies take 53.

use crate::handle::Handle;
use opencl3::command_queue::{CommandQueue, enqueue_read_buffer};
use opencl3::context::Context;
use opencl3::error_codes::{CL_MAP_FAILURE, ClError};
use opencl3::event::{CommandExecutionStatus, Event};
use opencl3::memory::{Buffer, CL_MAP_READ, CL_MAP_WRITE, CL_MEM_ALLOC_HOST_PTR, CL_MEM_READ_WRITE, ClMem};
use opencl3::types::{CL_BLOCKING, CL_NON_BLOCKING};
use rayon::prelude::*;
use std::ffi::c_void;
use std::mem::MaybeUninit;
use std::ops::Deref;
use std::ptr;
use std::slice;
use std::sync::{Arc, Mutex, PoisonError};

type Result<T> = std::result::Result<T, ClError>;

/// Bytes of a part, parts on their way at a time, and bytes that are worth it.
const PART: usize = 4 << 20;
const PARTS: usize = 8;
const WORTH_IT: usize = PART;

/// Bytes that one thread copies at a time.
const COPIED: usize = 1 << 18;

/// A queue of a device.
pub(crate) struct Queue {
    queue: Handle<CommandQueue>,
    staging: Option<Mutex<Staging>>,
}

impl Deref for Queue {
    type Target = CommandQueue;

    fn deref(&self) -> &CommandQueue {
        &self.queue
    }
}

impl Queue {
    /// `is_apart`: the device's memory is not the host's.
    pub(crate) fn new(context: &Arc<Handle<Context>>, queue: Handle<CommandQueue>, is_apart: bool) -> Self {
        let staging = Staging { context: Arc::clone(context), memory: None, is_refused: false };
        Self { queue, staging: is_apart.then(|| Mutex::new(staging)) }
    }

    /// Copies from a buffer, from number `first` on; returns when all is there. Large data is copied by the threads of a pool, the caller's own or
    /// else rayon's global one: not for whom no thread may be waited for (`Devices::lock`).
    ///
    /// # Safety
    /// The buffer has so many from there on, and any bits are a `T`.
    pub(crate) unsafe fn read<T: Copy + Send + Sync>(
        &self,
        buffer: &Buffer<T>,
        first: usize,
        data: &mut [MaybeUninit<T>],
    ) -> Result<()> {
        let is_staged = self.with_staging(size_of_val(data), |memory| {
            let part = PART / size_of::<T>();
            let (length, parts) = (data.len(), data.len().div_ceil(part));
            let mut ways: Vec<Handle<Event>> = Vec::with_capacity(parts);
            for (k, there) in data.chunks_mut(part).enumerate() {
                for sent in ways.len()..(k + PARTS).min(parts) {
                    let count = part.min(length - sent * part);
                    let place = (first + sent * part) * size_of::<T>();
                    // SAFETY: as the caller promises; nobody looks at the part until the device has filled it.
                    let event = unsafe {
                        let part = memory.part(sent, count);
                        self.queue.enqueue_read_buffer(buffer, CL_NON_BLOCKING, place, part, &[])
                    }?;
                    ways.push(Handle::new(event));
                }
                wait(&ways[k])?;
                // SAFETY: the device has filled this part, and writes no more to it.
                copy(unsafe { memory.part::<MaybeUninit<T>>(k, there.len()) }, there);
            }
            Ok(())
        })?;
        if !is_staged {
            let (place, bytes, to) = (first * size_of::<T>(), size_of_val(data), data.as_mut_ptr());
            // SAFETY: as the caller promises; the call returns when `data` is filled.
            unsafe {
                enqueue_read_buffer(
                    self.queue.get(),
                    buffer.get(),
                    CL_BLOCKING,
                    place,
                    bytes,
                    to.cast(),
                    0,
                    ptr::null(),
                )
            }
            .map(|event| Handle::new(Event::new(event)))?;
        }
        Ok(())
    }

    /// Copies to a buffer, from number `first` on; returns when `data` may change. Large data is copied as by [`Queue::read`].
    ///
    /// # Safety
    /// The buffer has room for so many from there on, and any bits are a `T`.
    pub(crate) unsafe fn write<T: Copy + Send + Sync>(
        &self,
        buffer: &mut Buffer<T>,
        first: usize,
        data: &[T],
    ) -> Result<()> {
        let is_staged = self.with_staging(size_of_val(data), |memory| {
            let mut ways: Vec<Handle<Event>> = Vec::new();
            let part = PART / size_of::<T>();
            for (k, from) in data.chunks(part).enumerate() {
                if let Some(way) = k.checked_sub(PARTS).and_then(|gone| ways.get(gone)) {
                    wait(way)?;
                }
                // SAFETY: the device has read what was there.
                let there = unsafe { memory.part::<T>(k, from.len()) };
                copy(from, there);
                let place = (first + k * part) * size_of::<T>();
                // SAFETY: as the caller promises; nobody changes the part until the device has read it.
                let event = unsafe { self.queue.enqueue_write_buffer(buffer, CL_NON_BLOCKING, place, there, &[]) }?;
                ways.push(Handle::new(event));
            }
            ways.iter().try_for_each(wait)
        })?;
        if !is_staged {
            // SAFETY: as the caller promises; the call returns when `data` is copied.
            unsafe { self.queue.enqueue_write_buffer(buffer, CL_BLOCKING, first * size_of::<T>(), data, &[]) }
                .map(Handle::new)?;
        }
        Ok(())
    }

    /// Does something with the memory, where that is worth it for so many bytes and the memory is to be had; says whether.
    fn with_staging(&self, bytes: usize, work: impl FnOnce(&Mapped) -> Result<()>) -> Result<bool> {
        let Some(staging) = self.staging.as_ref().filter(|_| bytes >= WORTH_IT) else { return Ok(false) };
        let mut staging = staging.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(memory) = staging.memory(&self.queue) else { return Ok(false) };
        let done = work(memory);
        // (Whatever is still on its way is to end before another uses the memory.)
        if done.is_err() && self.queue.finish().is_err() {
            staging.is_refused = true;
            std::mem::forget(staging.memory.take());
        }
        done.map(|()| true)
    }
}

/// Copies on all threads.
fn copy<T: Copy + Send + Sync>(from: &[T], to: &mut [T]) {
    let some = COPIED / size_of::<T>();
    to.par_chunks_mut(some).zip(from.par_chunks(some)).for_each(|(to, from)| to.copy_from_slice(from));
}

/// Waits until a part is there. (Of what failed the event itself says why; of waiting for it OpenCL says no more than that.)
fn wait(event: &Handle<Event>) -> Result<()> {
    event.wait().map_err(|error| match event.command_execution_status() {
        Ok(CommandExecutionStatus(code @ ..0)) => ClError(code),
        _ => error,
    })
}

/// The memory, once it was asked for.
struct Staging {
    context: Arc<Handle<Context>>,
    memory: Option<Mapped>,
    is_refused: bool,
}

impl Staging {
    fn memory(&mut self, queue: &CommandQueue) -> Option<&Mapped> {
        if self.memory.is_none() && !self.is_refused {
            self.memory = Mapped::new(&self.context, queue).ok();
            self.is_refused = self.memory.is_none();
        }
        self.memory.as_ref()
    }
}

/// Memory of the host that the device reads and writes itself, mapped for as long as it is there.
struct Mapped {
    /// (Drivers unmap what is given back.)
    _buffer: Handle<Buffer<u8>>,
    at: *mut c_void,
}

// SAFETY: the memory is this struct's alone, and OpenCL's objects may be used from any thread.
unsafe impl Send for Mapped {}

impl Mapped {
    fn new(context: &Context, queue: &CommandQueue) -> Result<Self> {
        let flags = CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR;
        // SAFETY: no host pointer is passed.
        let buffer = Handle::new(unsafe { Buffer::<u8>::create(context, flags, PARTS * PART, ptr::null_mut()) }?);
        let mut at = ptr::null_mut();
        // SAFETY: the whole buffer is mapped, when the call returns.
        unsafe {
            let how = CL_MAP_READ | CL_MAP_WRITE;
            queue.enqueue_map_buffer(&buffer, CL_BLOCKING, how, 0, PARTS * PART, &mut at, &[])
        }
        .map(Handle::new)?;
        if at.is_null() { Err(ClError(CL_MAP_FAILURE)) } else { Ok(Self { _buffer: buffer, at }) }
    }

    /// The room of part `k` of what is copied, which was that of part `k - PARTS`.
    ///
    /// # Safety
    /// Nobody else has it, and `count` of `T` are at most [`PART`] bytes.
    #[allow(clippy::mut_from_ref, reason = "parts are handed out one by one, as the caller promises")]
    unsafe fn part<T>(&self, k: usize, count: usize) -> &mut [T] {
        debug_assert!(count * size_of::<T>() <= PART, "a part has no more room");
        // SAFETY: it lies within the memory, which is aligned to pages, as each part is; its bytes were set by the driver, the device or `copy`.
        unsafe { slice::from_raw_parts_mut(self.at.byte_add(k % PARTS * PART).cast::<T>(), count) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buffer::Room;
    use crate::platform::{choose, open};
    use laguerre_core::required::if_available;
    use laguerre_core::{DeviceChoice, Precision};

    /// Copies there and back, of few and of many parts, all of a buffer and some of it, by way of the memory and without.
    #[test]
    fn what_comes_back_is_what_went() {
        let Some(chosen) = if_available("ocl", choose(&DeviceChoice::First, Precision::F64)) else { return };
        let (context, queue) = open(&chosen[0]).unwrap();
        let staged = Queue::new(&context, queue.queue, true);
        let in_part = PART / size_of::<[u32; 3]>();
        for length in [1, in_part, in_part + 1, 3 * in_part - 1, (2 * PARTS + 1) * in_part + 5] {
            let number = |i: usize| [i as u32, (i as u32).wrapping_mul(2_654_435_761), !(i as u32)];
            let data: Vec<[u32; 3]> = (0..length).map(number).collect();
            let mut room = Room::new("a test");
            room.fill(&context, &staged, &data).unwrap();
            let mut back = Vec::new();
            room.read(&staged, length, &mut back).unwrap();
            assert!(back == data, "{length}");
            let first = length / 3;
            room.write_at(&staged, first, &data[..length - first]).unwrap();
            room.read_from(&staged, first, length, &mut back).unwrap();
            assert!(back == data[..length - first], "{length}");
            room.read(&staged, first, &mut back).unwrap();
            assert!(back == data[..first], "{length}");
        }
        assert!(staged.staging.unwrap().lock().unwrap().memory.is_some());
    }
}
