//! Repeated evaluations of one diagram: the median, and what it lies between.

use std::time::Instant;

use laguerre::{Backend, Output, PowerDiagram, Request, Result};
use serde::Serialize;

use crate::evaluate::evaluate;

/// Seconds of some evaluations.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Timing {
    /// Of the whole call: from validated arrays in memory to results in memory.
    pub(crate) median: f64,
    pub(crate) min: f64,
    pub(crate) max: f64,
    /// The median of what a device computed, from sites on the device to results on the device; none without a device.
    pub(crate) device: Option<f64>,
    /// The first call, which builds what later ones reuse.
    pub(crate) first: f64,
}

/// Evaluates once to warm up and then `repetitions` (at least one) times; returns the output of the last. The backend takes the sites for others each time, as they are in a loop that moves them: a device that
/// knows them neither brings them nor puts them in order again.
///
/// # Errors
/// As [`Backend::evaluate`].
pub(crate) fn measure(
    backend: &dyn Backend,
    diagram: &mut PowerDiagram,
    request: &Request,
    repetitions: u32,
) -> Result<(Timing, Output)> {
    let mut same = diagram.positions().to_vec();
    let mut timed = || -> Result<(f64, Output)> {
        diagram.exchange_sites(&mut same, None)?;
        let start = Instant::now();
        let output = evaluate(backend, diagram, request)?;
        Ok((start.elapsed().as_secs_f64(), output))
    };
    let (first, mut output) = timed()?;
    let (mut whole, mut device) = (Vec::new(), Vec::new());
    for _ in 0..repetitions.max(1) {
        // The last output must not be held beside this one: memory is what ends a large run.
        drop(output);
        let seconds;
        (seconds, output) = timed()?;
        whole.push(seconds);
        device.push(output.report().device_seconds);
    }
    let median_of_device = median(&mut device);
    let timing = Timing {
        median: median(&mut whole),
        min: whole[0],
        max: whole[whole.len() - 1],
        device: (median_of_device > 0.0).then_some(median_of_device),
        first,
    };
    Ok((timing, output))
}

/// Sorts the numbers (at least one) and returns the middle one, of an even count the mean of both.
fn median(numbers: &mut [f64]) -> f64 {
    numbers.sort_unstable_by(f64::total_cmp);
    let half = numbers.len() / 2;
    if numbers.len() % 2 == 1 { numbers[half] } else { (numbers[half - 1] + numbers[half]) / 2.0 }
}

impl Timing {
    /// What evaluations are compared by: the device's time, or the fastest call, which other work on the machine disturbs least.
    pub(crate) fn own(&self) -> f64 {
        self.device.unwrap_or(self.min)
    }

    /// The median, and in brackets what it lies between, in one unit.
    pub(crate) fn spread(&self) -> String {
        let unit = unit(self.median);
        format!("{} [{}, {}]", seconds(self.median), in_unit(self.min, unit), in_unit(self.max, unit))
    }
}

/// A time with three digits.
pub(crate) fn seconds(time: f64) -> String {
    let unit = unit(time);
    format!("{} {}", in_unit(time, unit), unit.name)
}

/// How times are written: a factor from seconds, digits after the point, a name.
#[derive(Clone, Copy)]
struct Unit {
    factor: f64,
    digits: usize,
    name: &'static str,
}

/// The unit in which `time` has three digits, or a few more before the point.
fn unit(time: f64) -> Unit {
    // Half a unit of the last digit below each power of ten, so that what is rounded up to it has its digits.
    let (factor, digits, name) = match time {
        t if t >= 99.95 => (1.0, 0, "s"),
        t if t >= 9.995 => (1.0, 1, "s"),
        t if t >= 0.9995 => (1.0, 2, "s"),
        t if t >= 0.099_95 => (1.0, 3, "s"),
        t if t >= 0.009_995 => (1e3, 1, "ms"),
        _ => (1e3, 2, "ms"),
    };
    Unit { factor, digits, name }
}

fn in_unit(time: f64, unit: Unit) -> String {
    format!("{:.*}", unit.digits, time * unit.factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_in_the_middle() {
        assert_eq!([median(&mut [3.0, 1.0, 2.0]), median(&mut [4.0, 1.0]), median(&mut [7.0])], [2.0, 2.5, 7.0]);
    }

    #[test]
    fn a_spread_is_in_one_unit() {
        let timing = Timing { median: 0.0994, min: 0.0789, max: 0.1234, device: None, first: 1.0 };
        assert_eq!(timing.spread(), "99.4 ms [78.9, 123.4]");
    }

    #[test]
    fn times_have_three_digits() {
        let texts = [123.0, 12.34, 1.234, 0.1234, 0.01234, 0.001_234].map(seconds);
        assert_eq!(texts, ["123 s", "12.3 s", "1.23 s", "0.123 s", "12.3 ms", "1.23 ms"]);
    }
}
