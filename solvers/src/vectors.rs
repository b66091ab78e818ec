//! Vectors on all threads, to the same bits for every number of them: each entry of a result is computed by one thread, and sums go over
//! chunks of a fixed length. And what single points need.

use laguerre_core::parallel;
pub(crate) use laguerre_core::summation::CHUNK;
use laguerre_core::summation::{Sum, chunks};
use std::ops::Range;

/// Calls `f` with each entry and its index.
pub(crate) fn for_each<T: Send>(x: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    parallel::for_each(x, CHUNK, f);
}

/// `f(i)` for i below `n`.
pub(crate) fn map<T: Send>(n: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    parallel::map(n, CHUNK, f)
}

/// A copy of `x`.
pub(crate) fn copied<T: Copy + Send + Sync>(x: &[T]) -> Vec<T> {
    map(x.len(), |i| x[i])
}

/// Whether `is(i)` for some i below `n`.
pub(crate) fn any(n: usize, is: impl Fn(usize) -> bool + Sync) -> bool {
    chunks(n, |mut part: Range<usize>| part.any(&is)).contains(&true)
}

/// The number of those i below `n` that `is(i)`.
pub(crate) fn count(n: usize, is: impl Fn(usize) -> bool + Sync) -> usize {
    chunks(n, |part| part.filter(|&i| is(i)).count()).into_iter().sum()
}

/// The largest of `f(i)` for i below `n`, and of 0.
pub(crate) fn largest(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    chunks(n, |part| part.map(&f).fold(0.0, f64::max)).into_iter().fold(0.0, f64::max)
}

/// `Σ f(i)` for i below `n`.
pub(crate) fn sum(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    chunks(n, |part| part.map(&f).sum::<f64>()).iter().sum()
}

/// `Σ f(i)` for i below `n`, compensated.
pub(crate) fn total(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    sum_of(n, |i, sum| sum.add(f(i))).total()
}

/// What `add` adds for each i below `n`.
pub(crate) fn sum_of(n: usize, add: impl Fn(usize, &mut Sum) + Sync) -> Sum {
    let parts = chunks(n, |part| {
        let mut sum = Sum::default();
        part.for_each(|i| add(i, &mut sum));
        sum
    });
    let mut all = Sum::default();
    parts.into_iter().for_each(|part| all.join(part));
    all
}

/// `Σ_i a_i · b_i`.
pub(crate) fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    sum(a.len(), |i| inner(a[i], b[i]))
}

/// Adds `factor · b` to `a`.
pub(crate) fn add(a: &mut [[f64; 3]], factor: f64, b: &[[f64; 3]]) {
    for_each(a, |i, a| (0..3).for_each(|k| a[k] += factor * b[i][k]));
}

/// `a · b`.
#[inline(always)]
pub(crate) fn inner(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `‖p − q‖²`.
pub(crate) fn distance2(p: [f64; 3], q: [f64; 3]) -> f64 {
    let way = std::array::from_fn(|k| p[k] - q[k]);
    inner(way, way)
}
