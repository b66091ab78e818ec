//! The fastest backend that is there, and another for what it cannot do.

use crate::{Backend, Result};
#[cfg(all(feature = "cpu", feature = "ocl"))]
use crate::{
    BackendInfo, Capabilities, DeviceChoice, Integrand, Observer, Output, PowerDiagram, Precision, Request, Resident,
};

/// A GPU that can be used, else the CPU.
#[cfg(all(feature = "cpu", feature = "ocl"))]
pub(crate) fn open() -> Result<Box<dyn Backend>> {
    let cpu = crate::open_cpu(None)?;
    let has_gpu = laguerre_ocl::devices().is_ok_and(|all| all.iter().any(|d| d.is_gpu && d.unusable.is_none()));
    // One that cannot be opened is not there.
    let gpu = has_gpu.then(|| crate::open_ocl(DeviceChoice::First, Precision::F64).ok()).flatten();
    Ok(match gpu {
        Some(gpu) => Box::new(Fastest { gpu, cpu }),
        None => cpu,
    })
}

/// The backend that was built.
#[cfg(not(all(feature = "cpu", feature = "ocl")))]
pub(crate) fn open() -> Result<Box<dyn Backend>> {
    #[cfg(feature = "ocl")]
    return crate::open_ocl(crate::DeviceChoice::First, crate::Precision::F64);
    #[cfg(not(feature = "ocl"))]
    crate::open_cpu(None)
}

/// A GPU, and the CPU for functions of the caller's, which no device can call.
#[cfg(all(feature = "cpu", feature = "ocl"))]
struct Fastest {
    gpu: Box<dyn Backend>,
    cpu: Box<dyn Backend>,
}

#[cfg(all(feature = "cpu", feature = "ocl"))]
impl Backend for Fastest {
    fn info(&self) -> BackendInfo {
        self.gpu.info().with(Capabilities::ALL)
    }

    fn algebra(&self) -> Option<&dyn crate::algebra::Algebra> {
        self.gpu.algebra()
    }

    fn resident<'a>(&'a self, request: &Request, observer: &'a dyn Observer) -> Option<Box<dyn Resident + 'a>> {
        self.gpu.resident(request, observer)
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        let backend = if request.integral().is_some_and(Integrand::is_function) { &self.cpu } else { &self.gpu };
        backend.evaluate_watched(diagram, request, observer)
    }
}

#[cfg(all(test, feature = "cpu"))]
mod tests {
    use crate::{Integrand, PowerDiagram, Request, Selection};

    /// Whatever it opens: functions are integrated, and what it is is said.
    #[test]
    fn every_request_is_served() {
        let backend = crate::open(Selection::Auto).unwrap();
        let devices = crate::devices().unwrap_or_default();
        let has_gpu = devices.iter().any(|d| d.is_gpu && d.unusable.is_none());
        assert_eq!(backend.info().backend, if has_gpu { "ocl" } else { "cpu" });
        let diagram = PowerDiagram::new(&[[0.2; 3], [0.8; 3]], &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        let two = Integrand::function(1, |_| 2.0).unwrap();
        let polynomial = Integrand::polynomial([0.0; 3], &[([0; 3], 2.0)]).unwrap();
        for integrand in [two, polynomial] {
            let output =
                backend.evaluate(&diagram, &Request::moments().with_facets().with_integral(integrand)).unwrap();
            assert!(output.integral().unwrap().iter().all(|x| (x - 1.0).abs() < 1e-14));
        }
    }
}
