//! What the program says about a result: the object of `--json`, and the summary for people.

use laguerre::summation::Sum;
use laguerre::{BackendInfo, CellStatus, Output, PassReport, Selection};
use serde::Serialize;

use crate::container::Whole;

/// The object of `--json`; its fields and their order are a contract.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) sites: usize,
    /// Cells that are not empty.
    pub(crate) cells: usize,
    pub(crate) empty: usize,
    pub(crate) uncertified: usize,
    pub(crate) volume_sum: f64,
    pub(crate) domain_volume: f64,
    /// |volume_sum − domain_volume| / domain_volume.
    pub(crate) relative_error: f64,
    /// max over the axes of |Σ v b / V − B|, over the box's diagonal.
    pub(crate) barycenter_error: f64,
    /// The sum of the integrals, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) integral_sum: Option<f64>,
    /// Cells that needed exact arithmetic.
    pub(crate) exact_cells: usize,
    /// Cells that a device handed back to the host.
    pub(crate) host_cells: usize,
    pub(crate) backend: &'static str,
    pub(crate) device: String,
    pub(crate) precision: &'static str,
    pub(crate) threads: usize,
    pub(crate) seconds: Seconds,
    pub(crate) passes: Vec<Pass>,
}

/// Wall-clock time of each step.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Seconds {
    /// Reading and validating sites and domain.
    pub(crate) read: f64,
    /// Building the domain's grid; 0 without a domain.
    pub(crate) domain_grid: f64,
    /// From validated arrays in memory to results in memory.
    pub(crate) compute: f64,
    /// Of that, what a device computed, from sites on the device to results on the device.
    pub(crate) device: f64,
    pub(crate) write: f64,
}

/// One pass of the scheduler.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Pass {
    #[serde(rename = "K")]
    neighbors: u32,
    #[serde(rename = "P")]
    planes: u32,
    #[serde(rename = "V")]
    vertices: u32,
    #[serde(rename = "T")]
    triangles: u32,
    cells: usize,
    failed: usize,
    seconds: f64,
    /// Of those, seconds that a device computed.
    device_seconds: f64,
    /// Its second substep: the cells near the surface alone.
    second: Second,
}

/// The second substep of a pass.
#[derive(Clone, Copy, Debug, Serialize)]
struct Second {
    cells: usize,
    seconds: f64,
}

impl From<&PassReport> for Pass {
    fn from(pass: &PassReport) -> Self {
        let PassReport {
            neighbors, planes, vertices, triangles, cells, failed, seconds, device_seconds, second, ..
        } = *pass;
        let second = Second { cells: second.cells, seconds: second.seconds };
        Self { neighbors, planes, vertices, triangles, cells, failed, seconds, device_seconds, second }
    }
}

impl Report {
    pub(crate) fn new(output: &Output, whole: &Whole, info: BackendInfo, seconds: Seconds) -> Self {
        let seconds = Seconds { device: output.report().device_seconds, ..seconds };
        let (volume_sum, barycenter_error) = sums(output, whole);
        let empty = output.count(CellStatus::Empty);
        Self {
            sites: output.status().len(),
            cells: output.status().len() - empty,
            empty,
            uncertified: output.count(CellStatus::Uncertified),
            volume_sum,
            domain_volume: whole.volume,
            relative_error: (volume_sum - whole.volume).abs() / whole.volume,
            barycenter_error,
            integral_sum: output.integral().map(total),
            exact_cells: output.report().exact_cells,
            host_cells: output.report().host_cells,
            backend: info.backend,
            device: info.device,
            precision: info.precision.word(),
            threads: info.threads,
            seconds,
            passes: output.report().passes.iter().map(Pass::from).collect(),
        }
    }

    /// A few lines for people.
    pub(crate) fn summary(&self) -> String {
        let rate = self.sites as f64 / self.seconds.compute.max(f64::MIN_POSITIVE);
        let threads = if self.threads == 1 { "1 thread".into() } else { format!("{} threads", self.threads) };
        let integral = self.integral_sum.map_or_else(String::new, |sum| format!("integral     {sum}\n"));
        format!(
            "sites        {}: {} cells, {} empty, {} not certified\n\
             volume       {} of {}, relative error {:.1e}\n\
             barycenter   off by {:.1e} of the diagonal\n\
             {integral}\
             exact        {} cells needed exact arithmetic\n\
             compute      {:.3} s, {} sites/s ({}, {}, {}, {})\n",
            grouped(self.sites as u64),
            grouped(self.cells as u64),
            grouped(self.empty as u64),
            grouped(self.uncertified as u64),
            self.volume_sum,
            self.domain_volume,
            self.relative_error,
            self.barycenter_error,
            grouped(self.exact_cells as u64),
            self.seconds.compute,
            grouped(rate as u64),
            self.backend,
            self.precision,
            threads,
            self.device,
        )
    }
}

/// The sum of the volumes, and how far the barycenter of all cells together is from the whole's, over the diagonal.
fn sums(output: &Output, whole: &Whole) -> (f64, f64) {
    let center: [f64; 3] = std::array::from_fn(|k| whole.lo[k] + (whole.hi[k] - whole.lo[k]) / 2.0);
    let mut volume = Sum::default();
    let mut moment = [Sum::default(); 3];
    for (&v, b) in output.volume().iter().zip(output.barycenter()) {
        // An empty cell has no barycenter.
        if v == 0.0 {
            continue;
        }
        volume.add(v);
        // Shares of the whole, about the box's centre: no digit is lost to where the box stands, and nothing overflows.
        for k in 0..3 {
            moment[k].add_product(v / whole.volume, b[k] - center[k]);
        }
    }
    let off = |k: usize| (moment[k].total() - (whole.barycenter[k] - center[k])).abs();
    (volume.total(), off(0).max(off(1)).max(off(2)) / whole.diagonal())
}

/// A sum that does not depend on what is large and what is small.
fn total(numbers: &[f64]) -> f64 {
    let mut sum = Sum::default();
    sum.extend(numbers.iter().copied());
    sum.total()
}

/// The processor in its own words, and the threads that it has.
pub(crate) fn machine() -> (String, usize) {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    // The CPU backend knows; a build without it need not.
    let info = laguerre::open(Selection::Cpu { threads: Some(1) }).map(|backend| backend.info());
    (info.map_or_else(|_| std::env::consts::ARCH.to_owned(), |info| info.device), threads)
}

/// 1234567 as 1,234,567.
pub(crate) fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use laguerre::OutputArrays;

    use super::*;

    #[test]
    fn sums_of_a_far_box_keep_their_digits() {
        // A row of cells of equal size, 1e6 from the origin: neither sum may show more than a rounding.
        let n = 1000;
        let whole = Whole {
            lo: [1e6, 0.0, 0.0],
            hi: [1e6 + 1.0, 1.0, 1.0],
            volume: 1.0,
            barycenter: [1e6 + 0.5, 0.5, 0.5],
            has_density: false,
        };
        let mut arrays = OutputArrays::default();
        for i in 0..n {
            arrays.status.push(CellStatus::Complete);
            arrays.volume.push(1.0 / f64::from(n));
            arrays.barycenter.push([1e6 + (f64::from(i) + 0.5) / f64::from(n), 0.5, 0.5]);
        }
        arrays.status.push(CellStatus::Empty);
        arrays.volume.push(0.0);
        arrays.barycenter.push([f64::NAN; 3]);
        let output = Output::new(arrays.clone()).unwrap();
        let (volume, barycenter_error) = sums(&output, &whole);
        assert!((volume - 1.0).abs() <= f64::EPSILON, "{volume}");
        // Barycenters this far out are themselves rounded by 1e-10.
        assert!(barycenter_error < 1e6 * f64::EPSILON, "{barycenter_error}");
        arrays.volume[3] *= 2.0;
        assert!(sums(&Output::new(arrays).unwrap(), &whole).1 > 1e-4, "the check can fail");
    }

    #[test]
    fn digits_are_grouped_in_threes() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }
}
