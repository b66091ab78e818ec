//! The command `devices`: what can compute on this machine, and why what cannot, cannot.

use laguerre::{Result, Selection};

use crate::outcome::{self, Outcome};

pub(crate) fn run() -> Result<Outcome> {
    let mut lines = Vec::new();
    match laguerre::open(Selection::Cpu { threads: None }) {
        Ok(backend) => {
            let info = backend.info();
            lines.push(format!("cpu      {}, {} threads", info.device, info.threads));
        }
        Err(error) => lines.push(format!("cpu      cannot be used: {error}")),
    }
    match laguerre::devices() {
        Ok(devices) => {
            for (number, device) in devices.iter().enumerate() {
                let kind = if device.is_gpu { "GPU" } else { "no GPU" };
                let gib = device.memory as f64 / f64::from(1 << 30);
                let (name, platform, units) = (&device.name, &device.platform, device.compute_units);
                lines.push(format!("ocl {number:<4} {name} ({platform}; {kind}, {units} compute units, {gib:.1} GiB)"));
                if let Some(why) = &device.unusable {
                    lines.push(format!("         cannot be used: {why}"));
                }
            }
        }
        Err(error) => lines.push(format!("ocl      cannot be used: {error}")),
    }
    outcome::print(&format!("{}\n", lines.join("\n")))?;
    Ok(Outcome::Done)
}
