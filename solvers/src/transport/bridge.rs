//! Cells that fall into parts which do not touch, as in a domain of several components: no Newton step moves mass from one part to
//! another, for no weight changes any mass there to first order.

use laguerre_core::Result;

use super::newton::{Problem, State, is_out_of_range};
use super::sparse::center;

/// Evaluations that are made at most in search of the shift.
const MOST_EVALUATIONS: usize = 80;

/// Raises all weights of a part by so much that some of its cells reach into another part, and no cell loses more than it may; Newton
/// sees to the rest. Mass that the part gains grows with the shift, so that it is found by doubling and bisection. `None` where there
/// is no such shift.
pub(super) fn bridge(problem: &mut Problem<'_>, state: &State, part: &[bool]) -> Result<Option<State>> {
    let sum_of = |x: &[f64]| x.iter().zip(part).filter(|&(_, &inside)| inside).map(|(x, _)| x).sum::<f64>();
    let before = sum_of(&state.masses);
    let lacking = sum_of(&problem.targets) - before;
    let sites = state.masses.len() as f64;
    let total = state.output.volume().iter().sum::<f64>() / problem.mean_density;
    // The size of a cell, squared: less would hardly show.
    let (mut low, mut high, mut shift) = (0.0, f64::INFINITY, (total / sites).powf(2.0 / 3.0));
    for _ in 0..MOST_EVALUATIONS {
        let mut weights = state.weights.clone();
        weights.iter_mut().zip(part).filter(|&(_, &inside)| inside).for_each(|(w, _)| *w += shift);
        center(&mut weights);
        match problem.evaluate(weights) {
            Ok(next) => {
                let gained = sum_of(&next.masses) - before;
                if gained <= problem.tolerance * lacking {
                    low = shift;
                } else if gained <= lacking && next.least >= problem.bound {
                    return Ok(Some(next));
                } else {
                    high = shift;
                }
            }
            // Weights out of range: much too far.
            Err(error) if is_out_of_range(&error) => high = shift,
            Err(error) => return Err(error),
        }
        shift = if high.is_finite() { (low + high) / 2.0 } else { 2.0 * shift };
    }
    Ok(None)
}
