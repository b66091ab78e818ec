// Generated from core/src/cell/settle.rs by `cargo xtask codegen`; do not edit.

// `COMPLETE` where something is left of the cell, else `EMPTY`.
//
// A volume that rounding may have made is believed only where its barycenter is near the cell: what rounding makes has it anywhere.
HOT uint settle(Store *s, CellSums *sums) {
    if (!volume_is_above_bound(*sums)) {
        return EMPTY;
    }
    if (fabs(sums->volume) > sums->rounding) {
        return COMPLETE;
    }
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    const real radius = box_of_cell(s, &low, &high);
    const real extent = norm_max(sub(high, low)) + radius;
    const V3 middle = scale(REAL(0.5), add(low, high));
    const V3 barycenter = scale(REAL(1.0) / sums->volume, sums->first);
    if (norm_max(sub(barycenter, middle)) > extent) {
        return EMPTY;
    }
    return COMPLETE;
}

// Whether the winding number is the same all over a cell that no triangle touches: the nearest integer to the quotient of `sums` and the
// integrals of the whole cell. A cone so thin that rounding loses it does not tell that its triangle divides the cell; the sum does. Where rounding
// can make as much of nothing as the whole cell is, no more is believed than 0 and 1 (it was −1,147,767 for a hair of 1e-15 across).
HOT bool is_undivided(CellSums sums, CellSums whole, int *winding) {
    const real quotient = sums.volume / whole.volume;
    const real noise = SHARE_OF_NOTHING * smaller(sums.rounding, sums.largest_rounding);
    if (!(fabs(quotient) < MOST_WINDINGS)) {
        return 0;
    }
    const bool is_usual = (quotient > -REAL(0.5)) && (quotient < REAL(1.5));
    if (!(noise < whole.volume) && !is_usual) {
        return 0;
    }
    int inner = (int)(fabs(quotient) + REAL(0.5));
    if (quotient < REAL(0.0)) {
        inner = -inner;
    }
    *winding = inner;
    const real off = fabs(sums.volume - (((real)inner) * whole.volume));
    return off <= (sums.rounding + whole.rounding);
}

// Whether the present cell, and so all that clipping can leave of it, lies where the domain's winding number is 0.
OUTLINE bool lies_outside(Store *s) {
    if (!store_has_domain(s)) {
        return 0;
    }
    V3 low = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    V3 high = v3(REAL(0.0), REAL(0.0), REAL(0.0));
    outer_box_of_cell(s, &low, &high);
    return box_is_outside(s, low, high);
}
