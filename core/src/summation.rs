//! Compensated sums: plain summation of a million volumes alone misses 1e-14. And sums on all threads, over chunks of a fixed length, so that they have the
//! same bits for every number of threads.

use std::ops::Range;

use crate::parallel;

/// Terms that one thread adds up at a time. Fixed: the order of sums depends on it.
pub const CHUNK: usize = 4096;

/// What `part` makes of each chunk of the numbers below `n`, in their order.
pub fn chunks<T: Send>(n: usize, part: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    parallel::chunks(n, CHUNK, part)
}

/// A running sum with Neumaier's compensation: the error of `n` terms is about one rounding of the result plus
/// `n·u²·Σ|x|`, instead of `n·u·Σ|x|`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    sum: f64,
    compensation: f64,
}

impl Sum {
    /// Adds `x`.
    pub fn add(&mut self, x: f64) {
        let total = self.sum + x;
        let lost = if self.sum.abs() >= x.abs() { (self.sum - total) + x } else { (x - total) + self.sum };
        self.sum = total;
        self.compensation += lost;
    }

    /// Adds `a·b` with the rounding error of the product (Dekker's splitting, so that no fused operation is needed).
    pub fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        let (a_hi, b_hi) = (split(a), split(b));
        let (a_lo, b_lo) = (a - a_hi, b - b_hi);
        let error = ((a_hi * b_hi - product) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo;
        self.add(product);
        self.compensation += error;
    }

    /// Adds what another has, as it stands: a sum, and what that has lost.
    pub fn join(&mut self, other: Self) {
        self.add(other.sum);
        self.compensation += other.compensation;
    }

    /// One that stands at `sum`, and has lost so much: a device's.
    pub fn of_parts(sum: f64, lost: f64) -> Self {
        Self { sum, compensation: lost }
    }

    /// The sum.
    pub fn total(&self) -> f64 {
        self.sum + self.compensation
    }
}

impl Extend<f64> for Sum {
    fn extend<T: IntoIterator<Item = f64>>(&mut self, terms: T) {
        terms.into_iter().for_each(|x| self.add(x));
    }
}

/// The upper 26 bits of `a`.
fn split(a: f64) -> f64 {
    let c = 134_217_729.0 * a;
    c - (c - a)
}

/// What the volumes of all cells may sum to beside the container's, relative to that: what f64 can give where the volume itself, a sum, is
/// rounded.
pub const SUM: f64 = 1e-14;

/// Roundings of the container's surface, as all cells have it in their sites' frames: 1 for each coordinate, 5 for the plane.
pub const ROUNDINGS_OF_SURFACE: f64 = 8.0;

/// Roundings of the tetrahedra that fill the grid of a domain, in units of its volume: within a domain all that the cells have in its grid is
/// integrated, and what is outside subtracted. For a shape that is thin across its grid this is more than the surface's share.
const ROUNDINGS_OF_GRID: f64 = 16.0;

/// THE law of sums: how far the volumes of all cells may be from `volume`, the container's (length³). [`SUM`] of it, and the rounding of
/// its surface of area `area` in the frames of sites of which the farthest is `reach` from the farthest corner of what is integrated: each
/// cell has it displaced by up to [`ROUNDINGS_OF_SURFACE`] of that distance, and where the container is thin against that, it is this that counts;
/// or that of its grid's volume `grid` ([`Domain::grid_volume`](crate::Domain::grid_volume), 0 of a box), which is independent of it.
pub fn bound_of_volumes(volume: f64, area: f64, reach: f64, grid: f64) -> f64 {
    let rounding = 0.5 * f64::EPSILON;
    SUM * volume.abs() + rounding * f64::max(ROUNDINGS_OF_SURFACE * area * reach, ROUNDINGS_OF_GRID * grid)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_terms_survive_large_ones() {
        let mut sum = Sum::default();
        sum.extend([1e16, 1.0, -1e16, 1e-3]);
        assert_eq!(sum.total(), 1.001);
        let mut products = Sum::default();
        products.add_product(1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        products.add(-1.0);
        assert_eq!(products.total(), -f64::EPSILON * f64::EPSILON);
    }

    #[test]
    fn sums_of_chunks_are_compensated_too() {
        // Large terms in chunks of their own, that cancel only together.
        let large = |i: usize| match i {
            7 => 1e16,
            9000 => -1e16,
            _ => 0.25,
        };
        let part = |range: Range<usize>| {
            let mut sum = Sum::default();
            sum.extend(range.map(large));
            sum
        };
        let mut all = Sum::default();
        chunks(9001, part).into_iter().for_each(|part| all.join(part));
        assert_eq!(all.total(), 2249.75);
        assert!(chunks(0, |range| range.len()).is_empty());
    }
}
