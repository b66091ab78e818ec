//! Lloyd's algorithm: sites moved to the barycenters of their cells, again and again.

use laguerre::{Backend, CellStatus, Output, PowerDiagram, Request, Result};

use crate::evaluate::evaluate;

/// How far the sites were moved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relaxation {
    pub(crate) steps: usize,
    /// Standard deviation of the cells' volumes over their mean.
    pub(crate) spread: f64,
}

/// Moves the sites of a diagram until the volumes of its cells vary by less than `spread`, at most `most_steps` times.
/// A site whose barycenter `accept` refuses, or whose cell is empty, stays where it is.
///
/// # Errors
/// As [`Backend::evaluate`].
pub(crate) fn relax(
    backend: &dyn Backend,
    diagram: &mut PowerDiagram,
    spread: f64,
    most_steps: usize,
    accept: impl Fn([f64; 3]) -> bool,
) -> Result<Relaxation> {
    let mut steps = 0;
    loop {
        let output = evaluate(backend, diagram, &Request::moments())?;
        let found = relative_deviation(&output.volume);
        if found < spread || steps == most_steps {
            return Ok(Relaxation { steps, spread: found });
        }
        let moved = step(diagram, &output, &accept);
        let weights = diagram.weights().to_vec();
        diagram.set_sites(&moved, &weights)?;
        steps += 1;
    }
}

fn step(diagram: &PowerDiagram, output: &Output, accept: impl Fn([f64; 3]) -> bool) -> Vec<[f64; 3]> {
    let sites = diagram.positions().iter().enumerate();
    sites
        .map(|(i, &old)| {
            let new = output.barycenter[i];
            if output.status[i] != CellStatus::Empty && accept(new) { new } else { old }
        })
        .collect()
}

/// Standard deviation over mean. Two passes, so that plain sums suffice for a figure that is compared with a tenth.
pub(crate) fn relative_deviation(volumes: &[f64]) -> f64 {
    let n = volumes.len() as f64;
    let mean = volumes.iter().sum::<f64>() / n;
    let variance = volumes.iter().map(|v| (v / mean - 1.0).powi(2)).sum::<f64>() / n;
    variance.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviation_is_relative() {
        assert_eq!(relative_deviation(&[3.0, 3.0]), 0.0);
        assert_eq!(relative_deviation(&[1e-200, 3e-200]), 0.5);
    }
}
