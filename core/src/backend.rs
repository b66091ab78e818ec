//! The trait behind which the CPU and GPUs stand.

use crate::{Output, PowerDiagram, Request, Result};

/// Who computes, for reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackendInfo {
    /// `cpu`, `ocl`.
    pub backend: &'static str,
    /// The device in its own words.
    pub device: String,
    /// `f64` or `f32`.
    pub precision: &'static str,
    /// Host threads at work.
    pub threads: usize,
}

/// Which devices of a backend to compute on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// The first GPU that can be used, else the first other device.
    #[default]
    First,
    /// The devices of these numbers, counted from 0 in the order of their listing. One may be named twice.
    Numbers(Vec<usize>),
    /// All that can be used.
    All,
}

/// The numbers that devices compute with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 64 bits.
    #[default]
    F64,
    /// 32 bits: volumes and barycenters alone, each volume within 2⁻¹⁰ of itself by its own bound. No cell is lost: what that leaves
    /// open, the host computes with 64.
    F32,
}

impl Precision {
    /// `f64` or `f32`.
    pub fn word(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}

/// A device, and why it cannot be used if so.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Its name, in its own words.
    pub name: String,
    /// The name of its platform, the driver.
    pub platform: String,
    /// Whether it is a GPU.
    pub is_gpu: bool,
    /// Compute units.
    pub compute_units: u32,
    /// Global memory in bytes.
    pub memory: u64,
    /// Why it cannot be used.
    pub unusable: Option<String>,
}

/// Something that can compute a restricted power diagram.
///
/// # Contract
///
/// *What the caller has already checked.* A [`PowerDiagram`] and its domain exist only validated: sites are finite, the
/// domain closed and oriented. The implementation takes the sites from
/// [`PowerDiagram::prepare`](crate::diagram::PowerDiagram::prepare), which sorts them, sets coincident ones aside and
/// moves everything into the internal frame.
///
/// *What the implementation owes.* Every cell of the output is `Complete` or `Empty`, each by proof; `Uncertified` occurs only
/// where the request's `epsilon` ended the search. Per-cell trouble (a capacity that was too small, a sign that floating
/// point could not decide) is its own to settle and never leaves it. The geometry is [`crate::cell`]; a backend writes
/// storage, scheduling and transfer, and never restates it. The output does not depend on the number of threads,
/// nor on what was evaluated before.
///
/// *Which errors can reach the caller.* `Input`, only from `prepare` (sites out of range of the domain) and for an integrand (a function
/// on a device, an integral that is not finite); `Device` for device, driver and memory. Never a partial result passed as whole. A backend that
/// wraps another one, to watch it, may say `Interrupted`: the solvers then end with the best that they have.
///
/// *Reuse.* Evaluating again with the same backend reuses its buffers; with the same domain, its grid.
pub trait Backend: Send + Sync {
    /// Who computes.
    fn info(&self) -> BackendInfo;

    /// Computes what `request` asks for, for every site of `diagram`.
    ///
    /// # Errors
    /// See the contract above.
    fn evaluate(&self, diagram: &PowerDiagram, request: &Request) -> Result<Output>;
}
