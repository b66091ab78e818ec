//! Stands in for the OpenCL loader (`OPENCL_DYLIB_PATH`): hands every call on to the real one, but makes those fail that
//! `LAGUERRE_FAULT` names (see `plan.rs`). What opencl3 does not find here it says is not available.

#![allow(non_snake_case)]

mod plan;

use std::ffi::{c_char, c_void};
use std::ptr;
use std::sync::OnceLock;

use dlopen2::raw::Library;
use plan::fault;

/// Any handle or pointer that is handed on as it is.
type Any = *mut c_void;
/// Where an error code goes, or nothing.
type Code = *mut i32;
/// The size of what is written.
type Size = *mut usize;

/// What functions return where there is no real loader: no platform.
const NO_PLATFORM: i32 = -1001;

const DEVICE_TYPE: u32 = 0x1000;
const DEVICE_TYPE_GPU: u64 = 1 << 2;
const DOUBLE_FP_CONFIG: u32 = 0x1032;
const MAX_WORK_GROUP_SIZE: u32 = 0x1004;
const KERNEL_WORK_GROUP_SIZE: u32 = 0x11B0;
const INVALID_WORK_GROUP_SIZE: i32 = -54;

/// The real loader.
fn loader() -> Option<&'static Library> {
    static LOADER: OnceLock<Option<Library>> = OnceLock::new();
    LOADER.get_or_init(|| Library::open("libOpenCL.so.1").ok()).as_ref()
}

/// Calls the real function.
macro_rules! real {
    ($name:ident($($argument:ident: $type:ty),*) -> $result:ty, else $otherwise:expr) => {{
        type Function = unsafe extern "C" fn($($type),*) -> $result;
        // SAFETY: the OpenCL specification gives the function of this name this type.
        let function = loader().and_then(|loader| unsafe { loader.symbol::<Function>(stringify!($name)) }.ok());
        match function {
            // SAFETY: the arguments are those that the caller, bound by the same specification, passed.
            Some(function) => unsafe { function($($argument),*) },
            None => $otherwise,
        }
    }};
}

/// Functions that return an error code; `size`, where it is given, is what they move.
macro_rules! forward {
    ($($name:ident($($argument:ident: $type:ty),*) $(, size $size:expr)?;)*) => {$(
        /// Fails if it is to, else calls the real function.
        ///
        /// # Safety
        /// As the OpenCL specification says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $type),*) -> i32 {
            match fault(stringify!($name), 0 $(+ $size)?) {
                Some(code) => code,
                None => real!($name($($argument: $type),*) -> i32, else NO_PLATFORM),
            }
        }
    )*};
}

/// Functions that return a handle, and the error code through their last argument; `size` is what they ask for.
macro_rules! forward_handle {
    ($($name:ident($($argument:ident: $type:ty),*), size $size:expr;)*) => {$(
        /// Fails if it is to, else calls the real function.
        ///
        /// # Safety
        /// As the OpenCL specification says.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $type,)* code: Code) -> Any {
            match fault(stringify!($name), $size) {
                Some(error) => {
                    // SAFETY: the caller gives a place for the code, or none.
                    unsafe { set(code, error) };
                    ptr::null_mut()
                }
                None => real!($name($($argument: $type,)* code: Code) -> Any, else ptr::null_mut()),
            }
        }
    )*};
}

/// Sets what a pointer leads to, if it leads anywhere.
///
/// # Safety
/// It leads to a `T`, or is null.
unsafe fn set<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: as the caller promises.
        unsafe { place.write_unaligned(value) };
    }
}

forward! {
    clGetPlatformIDs(room: u32, platforms: Any, count: Any);
    clGetPlatformInfo(platform: Any, name: u32, size: usize, value: Any, needed: Size);
    clGetDeviceIDs(platform: Any, kind: u64, room: u32, devices: Any, count: Any);
    clRetainDevice(device: Any);
    clReleaseDevice(device: Any);
    clGetContextInfo(context: Any, name: u32, size: usize, value: Any, needed: Size);
    clRetainContext(context: Any);
    clReleaseContext(context: Any);
    clGetCommandQueueInfo(queue: Any, name: u32, size: usize, value: Any, needed: Size);
    clRetainCommandQueue(queue: Any);
    clReleaseCommandQueue(queue: Any);
    clFlush(queue: Any);
    clFinish(queue: Any);
    clGetMemObjectInfo(memory: Any, name: u32, size: usize, value: Any, needed: Size);
    clRetainMemObject(memory: Any);
    clReleaseMemObject(memory: Any);
    clGetProgramInfo(program: Any, name: u32, size: usize, value: Any, needed: Size);
    clGetProgramBuildInfo(program: Any, device: Any, name: u32, size: usize, value: Any, needed: Size);
    clRetainProgram(program: Any);
    clReleaseProgram(program: Any);
    clGetKernelInfo(kernel: Any, name: u32, size: usize, value: Any, needed: Size);
    clSetKernelArg(kernel: Any, index: u32, size: usize, value: Any);
    clRetainKernel(kernel: Any);
    clReleaseKernel(kernel: Any);
    clEnqueueReadBuffer(
        queue: Any, buffer: Any, blocking: u32, offset: usize, size: usize, data: Any, waits: u32, wait_list: Any, event: Any
    ), size size;
    clEnqueueWriteBuffer(
        queue: Any, buffer: Any, blocking: u32, offset: usize, size: usize, data: Any, waits: u32, wait_list: Any, event: Any
    ), size size;
    clEnqueueFillBuffer(
        queue: Any, buffer: Any, pattern: Any, pattern_size: usize, offset: usize, size: usize, waits: u32, wait_list: Any,
        event: Any
    ), size size;
    clEnqueueCopyBuffer(
        queue: Any, from: Any, to: Any, from_offset: usize, to_offset: usize, size: usize, waits: u32, wait_list: Any, event: Any
    ), size size;
    clEnqueueUnmapMemObject(queue: Any, memory: Any, mapped: Any, waits: u32, wait_list: Any, event: Any);
    clEnqueueMarkerWithWaitList(queue: Any, waits: u32, wait_list: Any, event: Any);
    clEnqueueBarrierWithWaitList(queue: Any, waits: u32, wait_list: Any, event: Any);
    clWaitForEvents(count: u32, events: Any);
    clGetEventInfo(event: Any, name: u32, size: usize, value: Any, needed: Size);
    clGetEventProfilingInfo(event: Any, name: u32, size: usize, value: Any, needed: Size);
    clRetainEvent(event: Any);
    clReleaseEvent(event: Any);
}

forward_handle! {
    clCreateContext(properties: Any, count: u32, devices: Any, notify: Any, data: Any), size 0;
    clCreateCommandQueue(context: Any, device: Any, properties: u64), size 0;
    clCreateCommandQueueWithProperties(context: Any, device: Any, properties: Any), size 0;
    clCreateBuffer(context: Any, flags: u64, size: usize, host: Any), size size;
    clCreateSubBuffer(buffer: Any, flags: u64, kind: u32, region: Any), size 0;
    clCreateProgramWithSource(context: Any, count: u32, texts: Any, lengths: Any), size 0;
    clCreateProgramWithBinary(context: Any, count: u32, devices: Any, lengths: Any, binaries: Any, states: Any), size 0;
    clCreateKernel(program: Any, name: Any), size 0;
    clEnqueueMapBuffer(
        queue: Any, buffer: Any, blocking: u32, flags: u64, offset: usize, size: usize, waits: u32, wait_list: Any, event: Any
    ), size 0;
}

/// As the real function, but for what a device is not to have.
///
/// # Safety
/// As the OpenCL specification says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn clGetDeviceInfo(device: Any, name: u32, size: usize, value: Any, needed: Size) -> i32 {
    if let Some(code) = fault("clGetDeviceInfo", 0) {
        return code;
    }
    let status =
        real!(clGetDeviceInfo(device: Any, name: u32, size: usize, value: Any, needed: Size) -> i32, else NO_PLATFORM);
    if status == 0 && name == DOUBLE_FP_CONFIG && plan::no_doubles() {
        // SAFETY: this value is 64 bits, and the real function has written them here unless the pointer is null.
        unsafe { set(value.cast(), 0_u64) };
    }
    if status == 0 && name == DEVICE_TYPE && plan::gpu() {
        // SAFETY: this value is 64 bits, likewise.
        unsafe { set(value.cast(), DEVICE_TYPE_GPU) };
    }
    if let (0, MAX_WORK_GROUP_SIZE, Some(largest)) = (status, name, plan::largest_group()) {
        // SAFETY: this value is a `size_t`, likewise.
        unsafe { set(value.cast(), largest) };
    }
    status
}

/// As the real function, but for the size of a work-group.
///
/// # Safety
/// As the OpenCL specification says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn clGetKernelWorkGroupInfo(
    kernel: Any,
    device: Any,
    name: u32,
    size: usize,
    value: Any,
    needed: Size,
) -> i32 {
    if let Some(code) = fault("clGetKernelWorkGroupInfo", 0) {
        return code;
    }
    let status = real!(
        clGetKernelWorkGroupInfo(kernel: Any, device: Any, name: u32, size: usize, value: Any, needed: Size) -> i32,
        else NO_PLATFORM
    );
    if let (0, KERNEL_WORK_GROUP_SIZE, Some(largest)) = (status, name, plan::largest_group()) {
        // SAFETY: this value is a `size_t`, and the real function has written it here unless the pointer is null.
        unsafe { set(value.cast(), largest) };
    }
    status
}

/// As the real function, but for groups that are too large.
///
/// # Safety
/// As the OpenCL specification says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn clEnqueueNDRangeKernel(
    queue: Any,
    kernel: Any,
    dimensions: u32,
    offset: *const usize,
    global: *const usize,
    local: *const usize,
    waits: u32,
    wait_list: Any,
    event: Any,
) -> i32 {
    if let Some(code) = fault("clEnqueueNDRangeKernel", 0) {
        return code;
    }
    // SAFETY: where it is not null, it leads to a size for each of the dimensions, of which there is at least one.
    let group = (!local.is_null()).then(|| unsafe { *local });
    if group > plan::largest_group().or(group) {
        plan::note("clEnqueueNDRangeKernel: too large a group");
        return INVALID_WORK_GROUP_SIZE;
    }
    real!(
        clEnqueueNDRangeKernel(
            queue: Any, kernel: Any, dimensions: u32, offset: *const usize, global: *const usize, local: *const usize,
            waits: u32, wait_list: Any, event: Any
        ) -> i32,
        else NO_PLATFORM
    )
}

/// As the real function, but perhaps without the options.
///
/// # Safety
/// As the OpenCL specification says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn clBuildProgram(
    program: Any,
    count: u32,
    devices: Any,
    options: *const c_char,
    notify: Any,
    data: Any,
) -> i32 {
    if let Some(code) = fault("clBuildProgram", 0) {
        return code;
    }
    let options = if plan::no_build() { ptr::null() } else { options };
    real!(
        clBuildProgram(program: Any, count: u32, devices: Any, options: *const c_char, notify: Any, data: Any) -> i32,
        else NO_PLATFORM
    )
}
