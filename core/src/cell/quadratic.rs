//! Polynomials of the second degree without mixed terms, which bound weights: their least value over a box, axis by axis.

use super::vector::{Real, UNIT_ROUNDOFF, larger, smaller};

/// Roundings of a sum of some twenty terms, in units of the sum of their sizes.
pub(crate) const FEW_ROUNDINGS_OF_SUM: Real = 64.0 * UNIT_ROUNDOFF;

/// Adds the least of `αt² + gt − (G + Q(t − m))(t − m)` for t from `lo` to `hi`, and the size of its terms. It is where the slope
/// is 0, if that is a minimum, and else at an end.
#[inline(always)]
pub(super) fn add_least(
    lo: Real,
    hi: Real,
    alpha: Real,
    g: Real,
    slope: Real,
    curvature: Real,
    sum: &mut Real,
    size: &mut Real,
) {
    let m: Real = 0.5 * (lo + hi);
    let width: Real = hi - m;
    let bend: Real = alpha - curvature;
    let still: Real = ((0.5 * (slope - g)) - (curvature * m)) / bend;
    let t: Real = smaller(larger(still, lo), hi);
    let mut least: Real = polynomial_at(t, m, alpha, g, slope, curvature);
    if !(bend > 0.0) {
        least =
            smaller(polynomial_at(lo, m, alpha, g, slope, curvature), polynomial_at(hi, m, alpha, g, slope, curvature));
    }
    let far: Real = m.abs() + width;
    *sum += least;
    // (Seen from afar a small box is narrower than the rounding of where it is, by as much of which its weights may differ.)
    let steep: Real = slope.abs() + ((2.0 * curvature.abs()) * width);
    *size += (((alpha * far) + g.abs()) * far) + (steep * far);
}

#[inline(always)]
fn polynomial_at(t: Real, m: Real, alpha: Real, g: Real, slope: Real, curvature: Real) -> Real {
    let u: Real = t - m;
    return (((alpha * t) + g) * t) - ((slope + (curvature * u)) * u);
}
