//! What becomes of a cell whose integrals are known: whether it is empty, and whether a surface that does not meet it goes around it.

use super::integrate::{CellSums, SHARE_OF_NOTHING, volume_is_above_bound};
use super::near::{box_of_cell, outer_box_of_cell};
use super::part::box_is_outside;
use super::status::{COMPLETE, EMPTY};
use super::store::{DomainStore, Polytope};
use super::vector::{Real, V3, add, norm_max, scale, smaller, sub, v3};

/// No quotient of volumes beyond this is a winding number.
const MOST_WINDINGS: Real = 1e9;

/// `COMPLETE` where something is left of the cell, else `EMPTY`.
///
/// A volume that rounding may have made is believed only where its barycenter is near the cell: what rounding makes has it anywhere.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn settle<S: Polytope>(s: &S, sums: &CellSums) -> u32 {
    if !volume_is_above_bound(*sums) {
        return EMPTY;
    }
    if sums.volume.abs() > sums.rounding {
        return COMPLETE;
    }
    let mut low: V3 = v3(0.0, 0.0, 0.0);
    let mut high: V3 = v3(0.0, 0.0, 0.0);
    let radius: Real = box_of_cell(s, &mut low, &mut high);
    let extent: Real = norm_max(sub(high, low)) + radius;
    let middle: V3 = scale(0.5, add(low, high));
    let barycenter: V3 = scale(1.0 / sums.volume, sums.first);
    if norm_max(sub(barycenter, middle)) > extent {
        return EMPTY;
    }
    return COMPLETE;
}

/// Whether the winding number is the same all over a cell that no triangle touches: the nearest integer to the quotient of `sums` and the
/// integrals of the whole cell. A cone so thin that rounding loses it does not tell that its triangle divides the cell; the sum does. Where rounding
/// can make as much of nothing as the whole cell is, no more is believed than 0 and 1 (it was −1,147,767 for a hair of 1e-15 across).
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn is_undivided(sums: CellSums, whole: CellSums, winding: &mut i32) -> bool {
    let quotient: Real = sums.volume / whole.volume;
    let noise: Real = SHARE_OF_NOTHING * smaller(sums.rounding, sums.largest_rounding);
    if !(quotient.abs() < MOST_WINDINGS) {
        return false;
    }
    let is_usual: bool = (quotient > -0.5) && (quotient < 1.5);
    if !(noise < whole.volume) && !is_usual {
        return false;
    }
    let mut inner: i32 = (quotient.abs() + 0.5) as i32;
    if quotient < 0.0 {
        inner = -inner;
    }
    *winding = inner;
    let off: Real = (sums.volume - ((inner as Real) * whole.volume)).abs();
    return off <= (sums.rounding + whole.rounding);
}

/// Whether the present cell, and so all that clipping can leave of it, lies where the domain's winding number is 0.
#[cfg_attr(opencl, outline)]
pub fn lies_outside<S: DomainStore>(s: &S) -> bool {
    if !s.has_domain() {
        return false;
    }
    let mut low: V3 = v3(0.0, 0.0, 0.0);
    let mut high: V3 = v3(0.0, 0.0, 0.0);
    outer_box_of_cell(s, &mut low, &mut high);
    return box_is_outside(s, low, high);
}
