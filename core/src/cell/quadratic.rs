//! Polynomials of the second degree without mixed terms, which bound weights: their least value over a box, axis by axis.

use super::vector::{Real, UNIT_ROUNDOFF, larger};

/// Roundings of a sum of some twenty terms, in units of the sum of their sizes.
pub(crate) const FEW_ROUNDINGS_OF_SUM: Real = 64.0 * UNIT_ROUNDOFF;

/// Adds the least of `αt² + gt − (G + Q(t − m))(t − m)` for what is in the range `[lo, hi]`, `t` being its way from `from` and `m` that of the middle;
/// and the size of its terms.
///
/// With `t = m + u` that is `(αm + g)m + bu + au²`, where `b = 2αm + g − G` and `a = α − Q`: least where `2au = −b`, if that is a minimum in the
/// range, and else at an end.
#[inline(always)]
pub(super) fn add_least(
    lo: Real,
    hi: Real,
    from: Real,
    alpha: Real,
    g: Real,
    slope: Real,
    curvature: Real,
    sum: &mut Real,
    size: &mut Real,
) {
    let middle: Real = 0.5 * (lo + hi);
    let extent: Real = larger(hi - middle, middle - lo);
    let m: Real = middle - from;
    let bend: Real = alpha - curvature;
    let once: Real = alpha * m;
    let twice: Real = once + once;
    let steep: Real = ((twice + g) - slope).abs();
    let rise: Real = bend * extent;
    let mut least: Real = (rise - steep) * extent;
    if (rise + rise) > steep {
        least = -(steep * (steep / (4.0 * bend)));
    }
    *sum += ((once + g) * m) + least;
    // (Also of the way, which is rounded: where it leads to a small box, by more than its width.)
    *size += (((twice.abs() + g.abs()) + slope.abs()) + rise.abs()) * (m.abs() + extent);
}
