//! Weights that give all cells the same volume, by a few fixed-point steps.

use laguerre::{Backend, Domain, Request, Result};

use super::diagram;
use crate::evaluate::evaluate;
use crate::lloyd::relative_deviation;

/// Share of the step that would settle the volume of a cubic cell alone. All cells move at once, so a whole one would not settle.
const DAMPING: f64 = 0.7;
/// Share of the last step that is made again: what has to go a long way goes faster.
const MOMENTUM: f64 = 0.8;

/// The sites whose cells meet a domain, and weights for them.
pub(super) struct Inside {
    pub(super) sites: Vec<[f64; 3]>,
    pub(super) weights: Vec<f64>,
    /// Standard deviation of the volumes over their mean, with equal weights and with these.
    pub(super) spread: [f64; 2],
}

/// Keeps the sites whose Voronoi cells are not empty, and finds weights for cells of equal volume.
///
/// A cube of edge `h` has `∂volume/∂weight = Σ area/(2·distance) = 6 h²/(2 h) = 3 h`.
pub(super) fn inside(backend: &dyn Backend, sites: &[[f64; 3]], domain: &Domain, steps: u32) -> Result<Inside> {
    let request = Request::moments();
    let all = evaluate(backend, &diagram(sites, &[], Some(domain))?, &request)?;
    let kept = sites.iter().zip(&all.volume).filter(|&(_, &volume)| volume > 0.0).map(|(&site, _)| site);
    let sites: Vec<[f64; 3]> = kept.collect();
    let target = domain.volume() / sites.len() as f64;
    let rate = DAMPING / (3.0 * target.cbrt());
    let mut weights = vec![0.0; sites.len()];
    let mut last_step = vec![0.0; sites.len()];
    let mut diagram = diagram(&sites, &weights, Some(domain))?;
    let mut spread = [0.0; 2];
    for round in 0..=steps {
        let volumes = evaluate(backend, &diagram, &request)?.volume;
        spread[1] = relative_deviation(&volumes);
        if round == 0 {
            spread[0] = spread[1];
        }
        if round < steps {
            for ((weight, step), volume) in weights.iter_mut().zip(&mut last_step).zip(&volumes) {
                *step = MOMENTUM * *step + rate * (target - volume);
                *weight += *step;
            }
            diagram.set_sites(&sites, &weights)?;
        }
    }
    Ok(Inside { sites, weights, spread })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::open_default;
    use crate::paper::{CUBE, SEED, domain};
    use crate::sample::Sampler;

    #[test]
    fn volumes_become_more_equal() {
        let white = Sampler::new(CUBE, None, SEED).white(1000).unwrap();
        let found = inside(open_default().unwrap().as_ref(), &white, &domain("torus").unwrap(), 20).unwrap();
        assert_eq!(found.sites.len(), found.weights.len());
        assert!((100..900).contains(&found.sites.len()), "{}", found.sites.len());
        assert!(found.spread[1] < 0.2 * found.spread[0], "{:?}", found.spread);
    }
}
