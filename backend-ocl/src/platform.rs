//! Which devices there are, and which can be used.

use laguerre_core::{DeviceChoice, DeviceInfo, Error, ErrorKind, Result};
use opencl3::device::{CL_DEVICE_TYPE_ALL, CL_DEVICE_TYPE_GPU, Device};
use opencl3::error_codes::ClError;
use opencl3::platform::get_platforms;
use opencl3::types::cl_device_id;

/// A device that was found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) info: DeviceInfo,
    pub(crate) id: DeviceId,
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

fn find() -> Result<Vec<Found>> {
    let platforms = get_platforms().map_err(|error| {
        let why = match error.0 {
            -2000 => "the OpenCL loader (libOpenCL.so.1) was not found".to_owned(),
            -1001 => "no OpenCL platform is installed".to_owned(),
            _ => format!("OpenCL platforms cannot be listed ({error})"),
        };
        Error::new(ErrorKind::Unavailable, format!("{why}: install the driver of your device, or use --backend cpu"))
    })?;
    let mut found = Vec::new();
    for platform in platforms {
        let name = platform.name().unwrap_or_default();
        // A platform without devices says so by an error.
        for id in platform.get_devices(CL_DEVICE_TYPE_ALL).unwrap_or_default() {
            found.push(describe(id, &name));
        }
    }
    if found.is_empty() {
        let message = "OpenCL is there, but no platform has a device: check the driver, or use --backend cpu";
        return Err(Error::new(ErrorKind::Unavailable, message));
    }
    Ok(found)
}

fn describe(id: cl_device_id, platform: &str) -> Found {
    let device = Device::new(id);
    let unusable = why_unusable(&device).unwrap_or_else(|error| Some(format!("it does not answer ({error})")));
    let info = DeviceInfo {
        name: device.name().unwrap_or_default().trim().to_owned(),
        platform: platform.trim().to_owned(),
        is_gpu: device.dev_type().is_ok_and(|kind| kind & CL_DEVICE_TYPE_GPU != 0),
        compute_units: device.max_compute_units().unwrap_or(0),
        memory: device.global_mem_size().unwrap_or(0),
        unusable,
    };
    Found { info, id: DeviceId(id) }
}

fn why_unusable(device: &Device) -> std::result::Result<Option<String>, ClError> {
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
    // Without doubles the query is 0, or an error.
    if device.double_fp_config().unwrap_or(0) == 0 {
        return why("it has no double precision");
    }
    Ok(None)
}

/// The devices of a choice.
///
/// # Errors
/// `Unavailable` where there is none, or one asked for cannot be used.
pub(crate) fn choose(choice: &DeviceChoice) -> Result<Vec<Found>> {
    let found = find()?;
    let unavailable = |message: String| Err(Error::new(ErrorKind::Unavailable, message));
    let usable: Vec<&Found> = found.iter().filter(|device| device.info.unusable.is_none()).collect();
    match choice {
        DeviceChoice::Numbers(numbers) => {
            let mut chosen = Vec::new();
            for &number in numbers {
                let Some(device) = found.get(number) else {
                    return unavailable(format!("device {number}: there are only {}, counted from 0", found.len()));
                };
                if let Some(why) = &device.info.unusable {
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
    format!("no OpenCL device can be used ({name}: {why}): use --backend cpu")
}
