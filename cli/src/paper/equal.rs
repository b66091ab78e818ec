//! Weights that give all cells the same volume: optimal transport.

use laguerre::solvers::transport::{End, Options, solve};
use laguerre::{Backend, Domain, Error, Request, Result};
use std::ops::ControlFlow::Continue;

use super::diagram;
use crate::evaluate::evaluate;
use crate::solver::WithBar;
use laguerre::solvers::lloyd::relative_deviation;

/// The sites whose cells meet a domain, and weights for them.
pub(super) struct Inside {
    pub(super) sites: Vec<[f64; 3]>,
    pub(super) weights: Vec<f64>,
    /// Standard deviation of the volumes over their mean, with equal weights and with these.
    pub(super) spread: [f64; 2],
    /// Newton steps that it took.
    pub(super) steps: usize,
}

/// Keeps the sites whose Voronoi cells are not empty, and finds the weights for which all their cells have the same volume.
pub(super) fn inside(backend: &dyn Backend, sites: &[[f64; 3]], domain: &Domain) -> Result<Inside> {
    let all = evaluate(backend, &diagram(sites, &[], Some(domain))?, &Request::moments())?;
    let kept = sites.iter().zip(all.volume()).filter(|&(_, &volume)| volume > 0.0);
    let (sites, volumes): (Vec<[f64; 3]>, Vec<f64>) = kept.map(|(&site, &volume)| (site, volume)).unzip();
    let mut diagram = diagram(&sites, &[], Some(domain))?;
    let options = Options::default().without_cost();
    let solution = solve(&WithBar(backend), &mut diagram, &[], &options, &mut |_| Continue(()))?;
    if solution.end != End::Converged {
        return Err(Error::input(format!("no weights for equal volumes: the residual stays at {}", solution.residual)));
    }
    let spread = [relative_deviation(&volumes), relative_deviation(&solution.masses)];
    Ok(Inside { sites, weights: solution.weights, spread, steps: solution.iterations.len() - 1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::Corners;
    use crate::evaluate::open_default;
    use crate::paper::{SEED, domain};
    use crate::sample::Sampler;

    #[test]
    fn volumes_become_equal() {
        let white = Sampler::new(Corners::UNIT_CUBE, None, SEED).white(1000).unwrap();
        let found = inside(open_default().unwrap().as_ref(), &white, &domain("torus").unwrap()).unwrap();
        assert_eq!(found.sites.len(), found.weights.len());
        assert!((100..900).contains(&found.sites.len()), "{}", found.sites.len());
        assert!(found.spread[0] > 0.1 && found.spread[1] < 1e-9, "{:?}", found.spread);
        assert!(found.steps < 30, "{}", found.steps);
    }
}
