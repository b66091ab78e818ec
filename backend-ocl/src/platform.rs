//! Which devices there are, and which can be used.

use crate::grid::GROUP;
use crate::handle::Handle;
use crate::queue::Queue;
use laguerre_core::{DeviceChoice, DeviceInfo, Error, ErrorKind, Precision, Result};
use opencl3::command_queue::{CommandQueue, create_command_queue};
use opencl3::context::Context;
use opencl3::context::context::create_context;
use opencl3::device::{CL_DEVICE_TYPE_ALL, CL_DEVICE_TYPE_GPU, Device};
use opencl3::error_codes::{CL_INVALID_VALUE, ClError};
use opencl3::platform::get_platforms;
use opencl3::types::cl_device_id;
use std::ptr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A device that was found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) info: DeviceInfo,
    pub(crate) id: DeviceId,
}

/// Why a device can compute in single precision alone.
const NO_DOUBLES: &str = "it has no double precision: compute in f32";

impl Found {
    /// Why it cannot compute with the given numbers, if so.
    pub(crate) fn unusable(&self, precision: Precision) -> Option<&str> {
        self.info.unusable.as_deref().filter(|&why| precision == Precision::F64 || why != NO_DOUBLES)
    }

    /// Whether its work-items run in warps whose assembler is known: a GPU behind NVIDIA's own driver.
    pub(crate) fn has_warps(&self) -> bool {
        self.info.is_gpu && self.info.platform == "NVIDIA CUDA"
    }
}

/// A device's handle: valid as long as the program runs, on any thread.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DeviceId(pub(crate) cl_device_id);

// SAFETY: the OpenCL specification makes all API calls but `clSetKernelArg` safe on any thread; a root device is never freed.
unsafe impl Send for DeviceId {}
// SAFETY: as above.
unsafe impl Sync for DeviceId {}

/// All devices of all platforms, in the loader's order.
///
/// # Errors
/// `Unavailable` where there is no OpenCL, or no device.
pub fn devices() -> Result<Vec<DeviceInfo>> {
    Ok(find()?.into_iter().map(|found| found.info).collect())
}

/// Lets one thread at a time list and open devices: PoCL 3.1 crashes where two ask for its devices for the first time.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn find() -> Result<Vec<Found>> {
    let _alone = alone();
    let platforms = get_platforms().map_err(|error| {
        let why = match error.0 {
            -2000 => "the OpenCL loader (libOpenCL.so.1) was not found".to_owned(),
            -1001 => "no OpenCL platform is installed".to_owned(),
            code => format!("OpenCL platforms cannot be listed: {error} ({code})"),
        };
        Error::new(ErrorKind::Unavailable, format!("{why}: install the driver of your device, or use the CPU"))
    })?;
    let (mut found, mut silent) = (Vec::new(), Vec::new());
    for platform in platforms {
        let name = platform.name().unwrap_or_else(|_| "a platform without a name".to_owned());
        match platform.get_devices(CL_DEVICE_TYPE_ALL) {
            Ok(ids) => found.extend(ids.into_iter().map(|id| describe(id, &name))),
            Err(error) => silent.push(unlisted(&name, error)),
        }
    }
    // After the devices, which keep their numbers when it speaks again.
    found.append(&mut silent);
    if found.is_empty() {
        let message = "OpenCL is there, but no platform has a device: check the driver, or use the CPU";
        return Err(Error::new(ErrorKind::Unavailable, message));
    }
    Ok(found)
}

fn describe(id: cl_device_id, platform: &str) -> Found {
    let device = Device::new(id);
    let name = device.name().unwrap_or_else(|_| "a device without a name".to_owned());
    let mut info = DeviceInfo::new(&name, platform);
    info.unusable = examine(&device, &mut info)
        .unwrap_or_else(|error| Some(format!("OpenCL does not answer for it: {error} ({})", error.0)));
    Found { info, id: DeviceId(id) }
}

/// Stands for the devices of a platform that does not list them: that it fails is to be seen beside those that can be used.
fn unlisted(platform: &str, error: ClError) -> Found {
    let mut info = DeviceInfo::new("unknown devices", platform);
    info.unusable = Some(format!("OpenCL cannot list the devices of {}: {error} ({})", info.platform, error.0));
    Found { info, id: DeviceId(ptr::null_mut()) }
}

/// Fills in what a device has, and says why it cannot be used, if so.
fn examine(device: &Device, info: &mut DeviceInfo) -> std::result::Result<Option<String>, ClError> {
    info.is_gpu = device.dev_type()? & CL_DEVICE_TYPE_GPU != 0;
    info.compute_units = device.max_compute_units()?;
    info.memory = device.global_mem_size()?;
    let why = |text: &str| Ok(Some(text.to_owned()));
    if !device.available()? {
        return why("it is not available");
    }
    if !device.compiler_available()? {
        return why("it has no compiler");
    }
    if !device.endian_little()? {
        return why("it is big-endian");
    }
    let largest = device.max_work_group_size()?;
    if largest < GROUP {
        return why(&format!("its work-groups are of at most {largest} work-items, and {GROUP} are needed"));
    }
    // A device without doubles says 0, or does not know the question.
    match device.double_fp_config() {
        Ok(0) | Err(ClError(CL_INVALID_VALUE)) => return why(NO_DOUBLES),
        answer => answer?,
    };
    Ok(None)
}

/// Opens a device: its context, and a queue of its own.
///
/// # Errors
/// `Device` where OpenCL fails.
pub(crate) fn open(found: &Found) -> Result<(Arc<Handle<Context>>, Queue)> {
    let failed = |what: &str, code| {
        let message =
            format!("OpenCL failed creating {what}: {} ({code}): use another device, or the CPU", ClError(code));
        Error::new(ErrorKind::Device, message)
    };
    let _alone = alone();
    let id = found.id.0;
    let context =
        create_context(&[id], ptr::null(), None, ptr::null_mut()).map_err(|code| failed("a context", code))?;
    // Without a list of devices: see `Handle`.
    let context = Arc::new(Handle::new(Context::new(context, &[])));
    // SAFETY: the context is of this device, and no properties are asked for that it could lack.
    let queue = unsafe { create_command_queue(context.get(), id, 0) }.map_err(|code| failed("a queue", code))?;
    // One dimension is all that is ever asked for.
    let queue = Handle::new(CommandQueue::new(queue, 1));
    let is_apart = found.info.is_gpu && matches!(Device::new(id).host_unified_memory(), Ok(false));
    let queue = Queue::new(&context, queue, is_apart);
    Ok((context, queue))
}

/// The devices of a choice.
///
/// # Errors
/// `Input` where numbers are asked for and none is given; `Unavailable` where there is none, or one asked for cannot be used.
pub(crate) fn choose(choice: &DeviceChoice, precision: Precision) -> Result<Vec<Found>> {
    if matches!(choice, DeviceChoice::Numbers(numbers) if numbers.is_empty()) {
        return Err(Error::input("devices: an empty list; give the number of one at least, or all"));
    }
    let found = find()?;
    let unavailable = |message: String| Err(Error::new(ErrorKind::Unavailable, message));
    let usable: Vec<&Found> = found.iter().filter(|device| device.unusable(precision).is_none()).collect();
    match choice {
        DeviceChoice::Numbers(numbers) => {
            let mut chosen = Vec::new();
            for &number in numbers {
                let Some(device) = found.get(number) else {
                    return unavailable(format!("device {number}: there are only {}, counted from 0", found.len()));
                };
                if let Some(why) = device.unusable(precision) {
                    return unavailable(format!("device {number} ({}) cannot be used: {why}", device.info.name));
                }
                chosen.push(device.clone());
            }
            Ok(chosen)
        }
        DeviceChoice::First => match usable.iter().find(|device| device.info.is_gpu).or(usable.first()) {
            Some(&device) => Ok(vec![device.clone()]),
            None => unavailable(none_usable(&found)),
        },
        DeviceChoice::All if usable.is_empty() => unavailable(none_usable(&found)),
        DeviceChoice::All => Ok(usable.into_iter().cloned().collect()),
    }
}

fn none_usable(found: &[Found]) -> String {
    let why = found.first().and_then(|device| device.info.unusable.as_deref()).unwrap_or_default();
    let name = found.first().map_or("", |device| device.info.name.as_str());
    format!("no OpenCL device can be used ({name}: {why}): use the CPU")
}
