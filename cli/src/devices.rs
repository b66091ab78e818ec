//! The command `devices`: what can compute on this machine, and why what cannot, cannot.

use laguerre::{BackendInfo, DeviceInfo, Result, Selection};
use serde::Serialize;

use crate::args::DevicesArgs;
use crate::outcome::{Outcome, print, print_json};

/// The object of `--json`.
#[derive(Serialize)]
struct Report {
    cpu: Cpu,
    ocl: Ocl,
}

#[derive(Default, Serialize)]
struct Cpu {
    name: Option<String>,
    threads: Option<usize>,
    /// Why it cannot be used.
    unusable: Option<String>,
}

#[derive(Default, Serialize)]
struct Ocl {
    /// In the order of the numbers that `--device` takes.
    devices: Vec<Device>,
    /// Why there are none.
    unusable: Option<String>,
}

#[derive(Serialize)]
struct Device {
    /// What `--device` calls it.
    number: usize,
    name: String,
    platform: String,
    gpu: bool,
    compute_units: u32,
    /// Bytes.
    memory: u64,
    /// Why it cannot be used.
    unusable: Option<String>,
}

pub(crate) fn run(args: &DevicesArgs) -> Result<Outcome> {
    let cpu = laguerre::open(Selection::Cpu { threads: None }).map_or_else(
        |error| Cpu { unusable: Some(error.to_string()), ..Cpu::default() },
        |backend| {
            let BackendInfo { device, threads, .. } = backend.info();
            Cpu { name: Some(device), threads: Some(threads), unusable: None }
        },
    );
    let ocl = laguerre::devices().map_or_else(
        |error| Ocl { unusable: Some(error.to_string()), ..Ocl::default() },
        |devices| Ocl { devices: devices.into_iter().enumerate().map(Device::from).collect(), unusable: None },
    );
    let report = Report { cpu, ocl };
    if args.json {
        print_json(&report)?
    } else {
        print(&report.lines())?
    }
    Ok(Outcome::Done)
}

impl From<(usize, DeviceInfo)> for Device {
    fn from((number, device): (usize, DeviceInfo)) -> Self {
        let DeviceInfo { name, platform, is_gpu, compute_units, memory, unusable, .. } = device;
        Self { number, name, platform, gpu: is_gpu, compute_units, memory, unusable }
    }
}

impl Report {
    /// A few lines for people.
    fn lines(&self) -> String {
        let mut lines = Vec::new();
        match &self.cpu {
            Cpu { name: Some(name), threads: Some(threads), .. } => {
                lines.push(format!("cpu      {name}, {threads} threads"))
            }
            cpu => lines.push(format!("cpu      cannot be used: {}", cpu.unusable.as_deref().unwrap_or_default())),
        }
        for Device { number, name, platform, gpu, compute_units, memory, unusable } in &self.ocl.devices {
            let kind = if *gpu { "GPU" } else { "no GPU" };
            let gib = *memory as f64 / f64::from(1 << 30);
            lines.push(format!(
                "ocl {number:<4} {name} ({platform}; {kind}, {compute_units} compute units, {gib:.1} GiB)"
            ));
            if let Some(why) = unusable {
                lines.push(format!("         cannot be used: {why}"));
            }
        }
        if let Some(why) = &self.ocl.unusable {
            lines.push(format!("ocl      cannot be used: {why}"));
        }
        lines.join("\n") + "\n"
    }
}
