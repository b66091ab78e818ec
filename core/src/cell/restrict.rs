//! Restriction of a cell to the domain by winding numbers and signed truncated cones (paper §4, with no merge).

use super::cap::box_is_outside;
use super::clip::compact_planes;
use super::cone::{add_cone, add_surface};
use super::facet::{add_boundary, center_facets, reset_facets};
use super::integrate::{
    CellSums, FACET_SECOND_MOMENTS, FACETS, SHARE_OF_NOTHING, VOLUME_ONLY, integrate, reference_point,
    volume_is_above_bound,
};
use super::near::{is_first_voxel, surface_passes_by};
use super::status::{BOUNDARY, COMPLETE, EMPTY, P_FULL, TAG_BOX};
use super::store::{CellStore, Voxel};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, larger, norm_max, scale, smaller, sub, v3};

/// The integrals of the finished cell over the container: the domain where there is one, weighted by its winding number,
/// else the initial box. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again; with `interior_only`, `BOUNDARY`
/// where the cell's voxels hold triangles.
///
/// With the flag `FACETS` the facets' sums of the half-spaces are those of the restricted cell afterwards, with
/// `FACET_SECOND_MOMENTS` their second moments too.
#[cfg_attr(opencl, outline)]
pub fn integrate_cell<S: CellStore>(s: &mut S, flags: u32, interior_only: u32, sums: &mut CellSums) -> u32 {
    *sums = CellSums::default();
    compact_planes(s);
    let center: V3 = reference_point(s);
    let status: u32 = integrate_restricted(s, center, flags, interior_only, sums);
    if (status == COMPLETE) && ((flags & FACET_SECOND_MOMENTS) != 0) {
        center_facets(s, center);
    }
    return status;
}

/// The same about a given point.
#[cfg_attr(opencl, outline)]
pub(super) fn integrate_restricted<S: CellStore>(
    s: &mut S,
    center: V3,
    flags: u32,
    interior_only: u32,
    sums: &mut CellSums,
) -> u32 {
    if !s.has_domain() {
        let status: u32 = integrate_whole(s, 1.0, center, flags, sums);
        if (status == COMPLETE) && ((flags & FACETS) != 0) {
            add_box_faces(s, sums);
        }
        return status;
    }
    let mut lo: Voxel = Voxel { i: 0, j: 0, k: 0 };
    let mut hi: Voxel = Voxel { i: 0, j: 0, k: 0 };
    let mut low: V3 = v3(0.0, 0.0, 0.0);
    let mut high: V3 = v3(0.0, 0.0, 0.0);
    outer_box_of_cell(s, &mut low, &mut high);
    voxels_of_box(s, low, high, &mut lo, &mut hi);
    let winding: i32 = s.winding(lo);
    // Where no triangle is near or meets the cell, the winding number is the same all over it.
    if s.surface_voxels(lo, hi) == 0 {
        return integrate_whole(s, winding as Real, center, flags, sums);
    }
    let mut inner: i32 = winding;
    if surface_passes_by(s, low, high, lo, hi, &mut inner) {
        return integrate_whole(s, inner as Real, center, flags, sums);
    }
    if interior_only != 0 {
        return BOUNDARY;
    }
    // Room for the four planes of a cone, whose indices must not move.
    if (s.cap_p() - s.planes()) < 4 {
        return P_FULL;
    }
    if (flags & FACETS) != 0 {
        reset_facets(s, flags);
    }
    if winding != 0 {
        let status: u32 = integrate(s, winding as Real, center, 0.0, flags, sums);
        if status != COMPLETE {
            return status;
        }
    }
    let mut touched: bool = false;
    let cones: u32 = add_cones(s, lo, hi, center, flags, &mut touched, sums);
    if cones != COMPLETE {
        return cones;
    }
    if !touched {
        // No piece ends at its triangle: the surface does not meet the cell, and the winding number within is the nearest
        // integer to the quotient.
        let mut whole: CellSums = CellSums::default();
        let status: u32 = integrate(s, 1.0, center, 0.0, VOLUME_ONLY, &mut whole);
        if status != COMPLETE {
            return status;
        }
        if !volume_is_above_bound(whole) {
            return EMPTY;
        }
        if is_undivided(*sums, whole, &mut inner) {
            *sums = CellSums::default();
            return integrate_whole(s, inner as Real, center, flags, sums);
        }
    }
    return settle(s, sums);
}

/// No quotient of volumes beyond this is a winding number.
const MOST_WINDINGS: Real = 1e9;

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

/// `COMPLETE` where something is left of the cell, else `EMPTY`.
///
/// A volume that rounding may have made is believed only where its barycenter is near the cell: what rounding makes has it anywhere.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn settle<S: CellStore>(s: &S, sums: &CellSums) -> u32 {
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

/// Whether the present cell, and so all that clipping can leave of it, lies where the domain's winding number is 0.
#[cfg_attr(opencl, outline)]
pub fn lies_outside<S: CellStore>(s: &S) -> bool {
    if !s.has_domain() {
        return false;
    }
    let mut low: V3 = v3(0.0, 0.0, 0.0);
    let mut high: V3 = v3(0.0, 0.0, 0.0);
    outer_box_of_cell(s, &mut low, &mut high);
    return box_is_outside(s, low, high);
}

/// The integrals of the whole cell, times `weight`.
#[cfg_attr(opencl, outline)]
pub(super) fn integrate_whole<S: CellStore>(
    s: &mut S,
    weight: Real,
    center: V3,
    flags: u32,
    sums: &mut CellSums,
) -> u32 {
    if weight == 0.0 {
        return EMPTY;
    }
    if (flags & FACETS) != 0 {
        reset_facets(s, flags);
    }
    let status: u32 = integrate(s, weight, center, 0.0, flags, sums);
    if status != COMPLETE {
        return status;
    }
    return settle(s, sums);
}

/// The faces of the initial box are the boundary where there is no domain.
#[cfg_attr(opencl, outline)]
pub(super) fn add_box_faces<S: CellStore>(s: &S, sums: &mut CellSums) {
    for f in 0..s.planes() {
        if s.tag(f) == TAG_BOX {
            add_boundary(s.facet(f), s.plane(f), 1.0, sums);
        }
    }
}

/// The bounding box of the vertices; returns their largest error radius.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn box_of_cell<S: CellStore>(s: &S, low: &mut V3, high: &mut V3) -> Real {
    *low = s.position(0);
    *high = *low;
    let mut radius: Real = s.radius(0);
    for v in 1..s.vertices() {
        let p: V3 = s.position(v);
        *low = v3(smaller(low.x, p.x), smaller(low.y, p.y), smaller(low.z, p.z));
        *high = v3(larger(high.x, p.x), larger(high.y, p.y), larger(high.z, p.z));
        radius = larger(radius, s.radius(v));
    }
    return radius;
}

/// The bounding box of the cell, rounded outward.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn outer_box_of_cell<S: CellStore>(s: &S, low: &mut V3, high: &mut V3) {
    let radius: Real = box_of_cell(s, low, high);
    // The vertices' error, and the rounding of moving them into the diagram's frame.
    let margin: Real =
        radius + ((4.0 * UNIT_ROUNDOFF) * (norm_max(s.site()) + larger(norm_max(*low), norm_max(*high))));
    let outward: V3 = v3(margin, margin, margin);
    *low = sub(*low, outward);
    *high = add(*high, outward);
}

/// The voxels that a box in the frame of the site meets.
#[inline]
#[cfg_attr(opencl, hot)]
pub(super) fn voxels_of_box<S: CellStore>(s: &S, low: V3, high: V3, lo: &mut Voxel, hi: &mut Voxel) {
    *lo = s.voxel_of(add(s.site(), low));
    *hi = s.voxel_of(add(s.site(), high));
}

/// Subtracts the signed integrals of the cell's intersection with the truncated cone of every triangle near it; `touched` becomes true
/// where a piece ends at its triangle.
#[cfg_attr(opencl, outline)]
pub(super) fn add_cones<S: CellStore>(
    s: &mut S,
    lo: Voxel,
    hi: Voxel,
    center: V3,
    flags: u32,
    touched: &mut bool,
    sums: &mut CellSums,
) -> u32 {
    s.save();
    let mut k: u32 = lo.k;
    while k <= hi.k {
        let mut j: u32 = lo.j;
        while j <= hi.j {
            let mut i: u32 = lo.i;
            while i <= hi.i {
                let voxel: Voxel = Voxel { i: i, j: j, k: k };
                let end: u32 = s.list_end(voxel);
                for entry in s.list_begin(voxel)..end {
                    let t: u32 = s.list_entry(entry);
                    if is_first_voxel(s.lowest_voxel(t), lo, voxel) {
                        let status: u32 = add_cone(s, t, lo, center, flags, touched, sums);
                        if status != COMPLETE {
                            return status;
                        }
                        if (flags & FACETS) != 0 {
                            let surface: u32 = add_surface(s, t, lo, center, sums);
                            if surface != COMPLETE {
                                return surface;
                            }
                        }
                    }
                }
                i += 1;
            }
            j += 1;
        }
        k += 1;
    }
    return COMPLETE;
}
