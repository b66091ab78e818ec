// Generated from core/src/cell/quadratic.rs by `cargo xtask codegen`; do not edit.

// Adds the least of `αt² + gt − (G + Q(t − m))(t − m)` for t from `lo` to `hi`, and the size of its terms. It is where the slope
// is 0, if that is a minimum, and else at an end.
INLINE void add_least(real lo, real hi, real alpha, real g, real slope, real curvature, real *sum, real *size) {
    const real m = REAL(0.5) * (lo + hi);
    const real width = hi - m;
    const real bend = alpha - curvature;
    const real still = ((REAL(0.5) * (slope - g)) - (curvature * m)) / bend;
    const real t = smaller(larger(still, lo), hi);
    real least = polynomial_at(t, m, alpha, g, slope, curvature);
    if (!(bend > REAL(0.0))) {
        least = smaller(polynomial_at(lo, m, alpha, g, slope, curvature), polynomial_at(hi, m, alpha, g, slope, curvature));
    }
    const real far = fabs(m) + width;
    *sum += least;
    // (Seen from afar a small box is narrower than the rounding of where it is, by as much of which its weights may differ.)
    const real steep = fabs(slope) + ((REAL(2.0) * fabs(curvature)) * width);
    *size += ((((alpha * far) + fabs(g)) * far) + (steep * far));
}

INLINE real polynomial_at(real t, real m, real alpha, real g, real slope, real curvature) {
    const real u = t - m;
    return (((alpha * t) + g) * t) - ((slope + (curvature * u)) * u);
}
