//! Whether what devices answer can be believed: compilers and drivers err (`kernels/README.md`), and an error is better than wrong cells.

use laguerre_core::diagram::Container;
use laguerre_core::summation::bound_of_volumes;
use laguerre_core::{Error, ErrorKind, Output, PowerDiagram, Precision, Result};
use rayon::prelude::*;

/// What the volumes of all cells may be off together, as a share of them: far more than rounding does, far less than a cell that is wrong.
const SHARE: f64 = 1e-8;
const SHARE_IN_SINGLE: f64 = 1e-4;

/// Roundings of a cell, in units of u and of the cube of its reach.
const ROUNDINGS_OF_CELL: f64 = 16.0;

/// Whether `sum`, of volumes whose sizes sum to `all`, is near enough to the container's volume for there to be no question.
pub(crate) fn is_near(sum: f64, all: f64, volume: f64, precision: Precision) -> bool {
    (sum - volume).abs() <= share_of(precision) * (all + volume.abs())
}

fn share_of(precision: Precision) -> f64 {
    if precision == Precision::F32 { SHARE_IN_SINGLE } else { SHARE }
}

/// That the volumes of all cells sum to the container's. It takes a look at each volume.
///
/// # Errors
/// `Device` where they do not.
pub(crate) fn check_volumes(diagram: &PowerDiagram, output: &Output, precision: Precision, device: &str) -> Result<()> {
    let container = diagram.container()?;
    let volume = container.volume();
    let add = |(sum, all): (f64, f64), (v, size): (f64, f64)| (sum + v, all + size);
    let (sum, all) = output.volume().par_iter().map(|v| (*v, v.abs())).reduce(|| (0.0, 0.0), add);
    if is_near(sum, all, volume, precision) {
        return Ok(());
    }
    let (area, (lo, hi)) = match &container {
        Container::Domain(domain) => (domain.area(), domain.bounding_box()),
        Container::Box(lo, hi) => {
            let [x, y, z] = [0, 1, 2].map(|k| hi[k] - lo[k]);
            (2.0 * (x * y + y * z + z * x), (*lo, *hi))
        }
    };
    let (off, share) = ((sum - volume).abs(), share_of(precision));
    // Sites far away, and containers that are thin against the way to them, round more.
    let reach_of = |p: &[f64; 3]| (0..3).map(|k| (p[k] - lo[k]).abs().max((p[k] - hi[k]).abs()).powi(2)).sum::<f64>();
    let reach = diagram.positions().par_iter().map(reach_of).reduce(|| 0.0, f64::max).sqrt();
    let rounding = ROUNDINGS_OF_CELL * f64::EPSILON * diagram.positions().len() as f64 * reach.powi(3);
    if off <= share * (all + volume.abs()) + bound_of_volumes(volume, area, reach, 0.0) + rounding {
        return Ok(());
    }
    let message = format!(
        "the volumes of all cells sum to {sum:e}, not to {volume:e}: the compiler or the driver of {device} errs: use the CPU"
    );
    Err(Error::new(ErrorKind::Device, message))
}

#[cfg(test)]
mod tests {
    use super::*;
    use laguerre_core::oracle::Naive;
    use laguerre_core::{Backend, Request};

    #[test]
    fn a_wrong_cell_is_seen() {
        let sites = [[0.2, 0.3, 0.4], [0.7, 0.6, 0.5], [0.1, 0.9, 0.8]];
        let diagram = PowerDiagram::new(&sites, &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        let output = Naive::default().evaluate(&diagram, &Request::moments()).unwrap();
        check_volumes(&diagram, &output, Precision::F64, "a device").unwrap();
        let with_second = |output: &Output, volume: f64| {
            let mut arrays = output.clone().into_arrays();
            arrays.volume[1] = volume;
            Output::new(arrays).unwrap()
        };
        let volume = output.volume()[1];
        let output = with_second(&output, volume + 1e-6);
        let error = check_volumes(&diagram, &output, Precision::F64, "a device").unwrap_err();
        assert!(error.to_string().contains("a device errs: use the CPU"), "{error}");
        check_volumes(&diagram, &output, Precision::F32, "a device").unwrap();
        let output = with_second(&output, -volume);
        check_volumes(&diagram, &output, Precision::F32, "a device").unwrap_err();
    }
}
