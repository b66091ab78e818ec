// Generated from core/src/cell/quadratic.rs by `cargo xtask codegen`; do not edit.

// Adds the least of `αt² + gt − (G + Q(t − m))(t − m)` for what is in the range `[lo, hi]`, `t` being its way from `from` and `m` that of the middle;
// and the size of its terms.
//
// With `t = m + u` that is `(αm + g)m + bu + au²`, where `b = 2αm + g − G` and `a = α − Q`: least where `2au = −b`, if that is a minimum in the
// range, and else at an end.
INLINE void add_least(real lo, real hi, real from, real alpha, real g, real slope, real curvature, real *sum, real *size) {
    const real middle = REAL(0.5) * (lo + hi);
    const real extent = larger(hi - middle, middle - lo);
    const real m = middle - from;
    const real bend = alpha - curvature;
    const real once = alpha * m;
    const real twice = once + once;
    const real steep = fabs((twice + g) - slope);
    const real rise = bend * extent;
    real least = (rise - steep) * extent;
    if ((rise + rise) > steep) {
        least = -(steep * (steep / (REAL(4.0) * bend)));
    }
    *sum += (((once + g) * m) + least);
    // (Also of the way, which is rounded: where it leads to a small box, by more than its width.)
    *size += ((((fabs(twice) + fabs(g)) + fabs(slope)) + fabs(rise)) * (fabs(m) + extent));
}
