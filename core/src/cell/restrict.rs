//! Restriction of a cell to the domain by winding numbers and signed truncated cones (paper §4, with no merge).

use super::clip::compact_planes;
use super::cone::{
    CONE_BEYOND, NONE_BEYOND, TruncatedCone, lies_beyond, make_cone, make_prism, nearest_corner, no_cone,
};
use super::facet::{FacetSum, add_boundary, asks_for_boundary, center_facets, integrate_facet, reset_facets};
use super::integrate::{
    CellSums, FACET_SECOND_MOMENTS, FACETS, INTEGRAL, VOLUME_ONLY, both_sums, integrate, reference_point,
    volume_is_above_bound,
};
use super::near::{is_first_voxel, outer_box_of_cell, row_is_empty, surface_passes_by, voxels_of_box};
use super::plane::Plane;
use super::settle::{is_undivided, settle};
use super::status::{
    BOUNDARY, COMPLETE, CUT, EMPTY, P_FULL, SEEN_CONFLICT, SEEN_KEEP, TAG_BOX, TAG_CONE, TAG_TRIANGLE, UNCERTAIN,
    UNTOUCHED,
};
use super::store::{CellStore, ClipStore, DomainStore, IntegralStore, SignStore, Voxel};
use super::vector::{Real, V3, add, v3};
use super::widest::clip;

/// The integrals of the finished cell over the container: the domain where there is one, weighted by its winding number,
/// else the initial box. Returns `COMPLETE`, `EMPTY`, or what makes the cell be tried again; with `interior_only`, `BOUNDARY`
/// where the cell's voxels hold triangles.
///
/// With the flag `FACETS` the facets' sums of the half-spaces are those of the restricted cell afterwards, with
/// `FACET_SECOND_MOMENTS` their second moments too; with `FACET_AREAS` no more of them than areas is told.
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
        if (status == COMPLETE) && asks_for_boundary(flags) {
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
    // (What a rule of quadrature leaves of a function that is no polynomial does not cancel: a Gaussian in a torus, 30 sites, degree 3, was 7e-3 off by the whole of cells less what is
    // outside, 8e-4 so.)
    let mut apex: Voxel = lo;
    if (flags & INTEGRAL) == 0 {
        apex = nearest_corner(s, add(s.site(), center), lo, hi);
    }
    let of_apex: i32 = s.winding(apex);
    if of_apex != 0 {
        let status: u32 = integrate(s, of_apex as Real, center, 0.0, flags, sums);
        if status != COMPLETE {
            return status;
        }
    }
    let mut touched: bool = false;
    let cones: u32 = add_cones(s, lo, hi, apex, center, flags, &mut touched, sums);
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

/// The integrals of the whole cell, times `weight`.
#[cfg_attr(opencl, outline)]
pub(super) fn integrate_whole<S: IntegralStore + SignStore>(
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
pub(super) fn add_box_faces<S: IntegralStore>(s: &S, sums: &mut CellSums) {
    for f in 0..s.planes() {
        if s.tag(f) == TAG_BOX {
            add_boundary(s.facet(f), s.plane(f), 1.0, sums);
        }
    }
}

/// Subtracts the signed integrals of the cell's intersection with the truncated cone from corner `apex` of every triangle near it; `touched` becomes true
/// where a piece ends at its triangle. (A call of its own: inlined, cells inside the bunny take 2 % more instructions.)
#[inline(never)]
#[cfg_attr(opencl, outline)]
pub(super) fn add_cones<S: CellStore>(
    s: &mut S,
    lo: Voxel,
    hi: Voxel,
    apex: Voxel,
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
            // By rows: of a cell with 3,600 pieces, added one to the next, rounding was 1e-14 of the volume.
            let mut row: CellSums = CellSums::default();
            let is_empty: bool = row_is_empty(s, lo, hi, j, k);
            let mut i: u32 = lo.i;
            while (i <= hi.i) && !is_empty {
                let voxel: Voxel = Voxel { i: i, j: j, k: k };
                let end: u32 = s.list_end(voxel);
                for entry in s.list_begin(voxel)..end {
                    let t: u32 = s.list_entry(entry);
                    if is_first_voxel(s.lowest_voxel(t), lo, voxel) {
                        let beyond: u32 = lies_beyond(s, t, apex);
                        if beyond != CONE_BEYOND {
                            let status: u32 = add_cone(s, t, apex, center, flags, touched, &mut row);
                            if status != COMPLETE {
                                return status;
                            }
                        }
                        if (beyond == NONE_BEYOND) && asks_for_boundary(flags) {
                            let surface: u32 = add_surface(s, t, apex, center, &mut row);
                            if surface != COMPLETE {
                                return surface;
                            }
                        }
                    }
                }
                i += 1;
            }
            if !is_empty {
                *sums = both_sums(*sums, row);
            }
            j += 1;
        }
        k += 1;
    }
    return COMPLETE;
}

/// Subtracts the signed integrals of the cell's intersection with the truncated cone over triangle `t` from corner `apex`.
#[cfg_attr(opencl, outline)]
pub(crate) fn add_cone<S: CellStore>(
    s: &mut S,
    t: u32,
    apex: Voxel,
    center: V3,
    flags: u32,
    touched: &mut bool,
    sums: &mut CellSums,
) -> u32 {
    let mut cone: TruncatedCone = no_cone();
    if make_cone(s, t, apex, &mut cone) != COMPLETE {
        return UNCERTAIN;
    }
    if cone.sign == 0.0 {
        // The cone is flat, but the surface may still divide the cell.
        *touched = true;
        return COMPLETE;
    }
    // Cull before cutting: most candidates have the whole cell on the wrong side of one of the four planes.
    let base: u32 = s.planes();
    if all_in_conflict(s, base, cone.end)
        || all_in_conflict(s, base, cone.side_0)
        || all_in_conflict(s, base, cone.side_1)
        || all_in_conflict(s, base, cone.side_2)
    {
        return COMPLETE;
    }
    let mut status: u32 = clip_by_sides(s, cone);
    if status == COMPLETE {
        status = clip(s, cone.end, TAG_TRIANGLE);
        if status == CUT {
            *touched = true;
        }
        if (status == CUT) || (status == UNTOUCHED) {
            status = integrate(s, -cone.jump, center, cone.reach, flags, sums);
        }
    }
    s.restore();
    s.set_planes(base);
    if status == EMPTY {
        return COMPLETE;
    }
    return status;
}

/// Clips by the three sides; `COMPLETE` where something is left.
#[cfg_attr(opencl, outline)]
pub(super) fn clip_by_sides<S: ClipStore + SignStore>(s: &mut S, cone: TruncatedCone) -> u32 {
    let mut status: u32 = clip(s, cone.side_0, TAG_CONE);
    if (status == CUT) || (status == UNTOUCHED) {
        status = clip(s, cone.side_1, TAG_CONE);
    }
    if (status == CUT) || (status == UNTOUCHED) {
        status = clip(s, cone.side_2, TAG_CONE);
    }
    if (status == CUT) || (status == UNTOUCHED) {
        return COMPLETE;
    }
    return status;
}

/// Adds the part of triangle `t` within the cell to the boundary's sums: the facet on the triangle's plane of the cell's intersection
/// with the prism behind it. (The cone would do, but its sides can be nearly parallel to the triangle.)
#[cfg_attr(opencl, outline)]
pub(crate) fn add_surface<S: ClipStore + DomainStore + SignStore>(
    s: &mut S,
    t: u32,
    apex: Voxel,
    center: V3,
    sums: &mut CellSums,
) -> u32 {
    let mut prism: TruncatedCone = no_cone();
    if make_prism(s, t, apex, &mut prism) != COMPLETE {
        return UNCERTAIN;
    }
    let base: u32 = s.planes();
    s.set_plane(base, prism.end);
    let seen: u32 = s.mark_conflicts(base);
    if (seen == SEEN_CONFLICT) || (seen == SEEN_KEEP) {
        return COMPLETE;
    }
    if (all_in_conflict(s, base, prism.side_0))
        || (all_in_conflict(s, base, prism.side_1))
        || (all_in_conflict(s, base, prism.side_2))
    {
        return COMPLETE;
    }
    let mut status: u32 = clip_by_sides(s, prism);
    let end_index: u32 = s.planes();
    if status == COMPLETE {
        status = clip(s, prism.end, TAG_TRIANGLE);
    }
    if status == CUT {
        let mut facet: FacetSum = FacetSum::default();
        status = integrate_facet(s, end_index, center, 0.0, &mut facet);
        if status == COMPLETE {
            add_boundary(facet, prism.end, -prism.jump, sums);
        }
    }
    s.restore();
    s.set_planes(base);
    if (status == EMPTY) || (status == UNTOUCHED) {
        return COMPLETE;
    }
    return status;
}

/// Whether every vertex is certainly in conflict with `plane`; uses the slot of plane `k`.
#[inline(always)]
pub(super) fn all_in_conflict<S: ClipStore>(s: &mut S, k: u32, plane: Plane) -> bool {
    #[cfg(not(opencl))]
    if s.keeps_some(plane) {
        return false;
    }
    s.set_plane(k, plane);
    return s.mark_conflicts(k) == SEEN_CONFLICT;
}
