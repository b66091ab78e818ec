//! Limited-memory quasi-Newton directions (Nocedal, Wright, "Numerical Optimization", algorithm 7.4), the start given by the caller.

use std::collections::VecDeque;

use crate::vectors::{add, dot, for_each, map};

/// Steps that are remembered. Liu et al. take 7; with more the directions hardly change, and each costs six numbers a site.
const DEPTH: usize = 10;

type Vectors = Vec<[f64; 3]>;

/// One step, and how the gradient changed along it.
struct Pair {
    step: Vectors,
    change: Vectors,
    /// `step · change`, positive.
    curvature: f64,
}

/// The last steps.
#[derive(Default)]
pub(super) struct Memory {
    pairs: VecDeque<Pair>,
}

impl Memory {
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Remembers a step, unless the energy is not convex along it, or so little that rounding decides.
    pub(super) fn learn(&mut self, step: Vectors, change: Vectors) {
        let curvature = dot(&step, &change);
        // In the unit of the curvature: the square of a change of the gradient (length⁸) may be out of range.
        let flat = f64::EPSILON * dot(&absolute(&step), &absolute(&change));
        if curvature <= flat {
            return;
        }
        if self.pairs.len() == DEPTH {
            self.pairs.pop_front();
        }
        self.pairs.push_back(Pair { step, change, curvature });
    }

    /// `−H·gradient`, `H` the inverse of the Hessian as far as it is known; without memory that is `scale(i)` for site `i`, with memory
    /// this start is scaled to the curvature of the last step.
    pub(super) fn direction(&self, gradient: &[[f64; 3]], scale: impl Fn(usize) -> f64 + Sync) -> Vectors {
        let mut q = gradient.to_vec();
        let mut shares = Vec::with_capacity(self.pairs.len());
        for pair in self.pairs.iter().rev() {
            let share = dot(&pair.step, &q) / pair.curvature;
            add(&mut q, -share, &pair.change);
            shares.push(share);
        }
        let start = self.pairs.back().map_or(1.0, |last| {
            let scaled: Vectors = map(last.change.len(), |i| last.change[i].map(|x| scale(i) * x));
            last.curvature / dot(&last.change, &scaled)
        });
        for_each(&mut q, |i, q| *q = q.map(|x| -start * scale(i) * x));
        for (pair, share) in self.pairs.iter().zip(shares.into_iter().rev()) {
            let back = dot(&pair.change, &q) / pair.curvature;
            add(&mut q, -share - back, &pair.step);
        }
        q
    }
}

fn absolute(a: &[[f64; 3]]) -> Vectors {
    map(a.len(), |i| a[i].map(f64::abs))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a quadratic function, with exact steps, as many pairs as there are eigenvalues give Newton's step.
    #[test]
    fn a_quadratic_is_learnt() {
        let curvature = [[1.0, 4.0, 9.0]];
        let slope = |x: &[[f64; 3]]| vec![std::array::from_fn(|k| curvature[0][k] * x[0][k])];
        let mut memory = Memory::default();
        for k in 0..3 {
            let mut step = [0.0; 3];
            step[k] = 0.5;
            memory.learn(vec![step], slope(&[step]));
        }
        let at = [[3.0, -2.0, 1.0]];
        let direction = memory.direction(&slope(&at), |_| 0.3);
        assert!((0..3).all(|k| (direction[0][k] + at[0][k]).abs() < 1e-14), "{direction:?}");
        memory.learn(vec![[1.0; 3]], vec![[-1.0; 3]]);
        assert_eq!(memory.pairs.len(), 3, "what is not convex is not learnt");
    }
}
