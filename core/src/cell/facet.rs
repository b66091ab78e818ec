//! Sums over the facets of a convex cell: areas, moments, second moments, and what of them is the domain's boundary.

use super::integrate::{
    CellSums, Corner, FACET_AREAS, FACET_SECOND_MOMENTS, FACETS, Side, foot_on_edge, radius_at, second_diagonal,
    second_mixed, side,
};
use super::plane::Plane;
use super::status::{COMPLETE, UNCERTAIN};
use super::store::{IntegralStore, SignStore};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, cross, dot, larger, norm_1, scale, sub, v3};
use super::vertex::Triplet;

/// Sums over one facet.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacetSum {
    /// Area.
    pub area: Real,
    /// ∫ x dA, in the frame of the site.
    pub moment: V3,
    /// The largest that rounding may have added to one of the triangles that were added and subtracted.
    pub rounding: Real,
}

/// Second moments of one facet: while sums are added up about the point that the tetrahedra share, afterwards about the facet's own
/// barycenter.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacetSecond {
    /// ∫ x², y², z² dA.
    pub diagonal: V3,
    /// ∫ xy, xz, yz dA.
    pub mixed: V3,
}

/// The same for the area of a triangle, in units of the product of its two sides at H, which is what a cross product loses where
/// they are nearly parallel: one for each side, two for the cross product, three for its product with the normal, one for that with
/// one over its length, which is off alike for all triangles of a facet, halved; twice that for the sum. (What H is off, one triangle gains and its
/// neighbour loses.)
const ROUNDINGS_OF_TRIANGLE: Real = 8.0;

/// The same share for a facet, of the bound of its largest triangle. Of many roundings most cancel: what some hundred triangles
/// leave of nothing is below this, but for one in some thousand, while the sum of their bounds would swallow thin facets that the
/// other cell, cut by other cones, keeps.
const SHARE_OF_NO_FACET: Real = 0.0625;

/// What is negative is believed beyond so many of these bounds. In 1.8 million small diagrams full of ties the noise of one facet came to more than
/// a quarter of its bound, and to less than all of it (to 128 where the bound leaves out what feet are off). Of 44,000 diagrams in prisms
/// that fold over themselves in slabs of 1e-15 to 1e-2 none has a facet that only one of its cells keeps, or a cell that does not close for one
/// that was dropped; with 2 bounds there are 2, with 4 there are 6, with 16 there are 34.
const BOUNDS_OF_NEGATIVE: Real = 1.0;

/// Whether a facet's area exceeds what rounding alone can make of nothing.
#[cfg_attr(opencl, outline)]
pub fn facet_is_above_bound(sum: FacetSum) -> bool {
    return (sum.area > (SHARE_OF_NO_FACET * sum.rounding)) || (sum.area < -(BOUNDS_OF_NEGATIVE * sum.rounding));
}

/// Adds the triangle (H, I, v) to a facet of plane `f`: signed area `sign·½ (I − H)×(v − H)·n/|n|`, moment
/// `area·(H + I + v)/3` but where areas alone are summed. The foot I is off its edge by up to `off`.
///
/// What I and v are off counts with the way between them: the two triangles of a vertex lose its error times the way between their feet,
/// those of an edge the foot's times the edge's length. The vertex has been rounded once more on its way to the reference point.
#[inline(always)]
pub(super) fn add_triangle(
    f: Side,
    foot: V3,
    off: Real,
    at: Corner,
    sign: Real,
    center: V3,
    area_alone: bool,
    sum: &mut FacetSum,
) {
    let area: Real = area_of_triangle(f, per_length(f), sub(foot, f.foot), sub(at.position, f.foot), sign);
    sum.area = sum.area + area;
    if !area_alone {
        sum.moment = add(sum.moment, moment_of_triangle(f, foot, at.position, center, area));
    }
    sum.rounding = larger(sum.rounding, rounding_of_triangle(f, foot, off, at.position, at.radius));
}

/// `area·(H + I + v)/3`.
#[inline(always)]
pub(super) fn moment_of_triangle(f: Side, foot: V3, position: V3, center: V3, area: Real) -> V3 {
    return scale(area, add(scale(1.0 / 3.0, add(add(f.foot, foot), position)), center));
}

/// What rounding may have added to its area, where the vertex is off by up to `radius`.
#[inline(always)]
pub(super) fn rounding_of_triangle(f: Side, foot: V3, off: Real, position: V3, radius: Real) -> Real {
    let to_foot: V3 = sub(foot, f.foot);
    let to_vertex: V3 = sub(position, f.foot);
    let lost: Real = (ROUNDINGS_OF_TRIANGLE * UNIT_ROUNDOFF) * (norm_1(to_foot) * norm_1(to_vertex));
    let moved: Real = (radius + off) + (UNIT_ROUNDOFF * norm_1(position));
    return lost + (moved * norm_1(sub(position, foot)));
}

/// 1/|n|.
#[inline(always)]
pub(super) fn per_length(f: Side) -> Real {
    return 1.0 / f.square.sqrt();
}

/// `sign·½ (I − H)×(v − H)·n/|n|`, given 1/|n| and the two sides at H.
#[inline(always)]
pub(super) fn area_of_triangle(f: Side, per_length: Real, to_foot: V3, to_vertex: V3, sign: Real) -> Real {
    let normal: V3 = cross(to_foot, to_vertex);
    return ((0.5 * sign) * dot(normal, f.n)) * per_length;
}

/// The sums of the facet of plane `index` alone; `reach` as of `integrate`.
#[cfg_attr(opencl, outline)]
pub(crate) fn integrate_facet<S: SignStore>(s: &mut S, index: u32, center: V3, reach: Real, sum: &mut FacetSum) -> u32 {
    *sum = FacetSum::default();
    let f: Side = side(s, index, center);
    for v in 0..s.vertices() {
        let mut t: Triplet = s.triplet(v);
        if t.b == index {
            t = Triplet { a: t.b, b: t.c, c: t.a };
        } else if t.c == index {
            t = Triplet { a: t.c, b: t.a, c: t.b };
        }
        if t.a == index {
            // Vertex (f, b, c): of its edges (f, b) begins here and (c, f) ends here.
            let at: Corner = Corner {
                triplet: t,
                position: sub(s.position(v), center),
                distance: norm_1(s.position(v)) + reach,
                radius: radius_at(s.radius(v), reach),
            };
            let b: Side = side(s, t.b, center);
            let c: Side = side(s, t.c, center);
            let mut foot: V3 = v3(0.0, 0.0, 0.0);
            let mut off: Real = 0.0;
            if foot_on_edge(s, f, b, center, true, &mut foot, &mut off) != COMPLETE {
                return UNCERTAIN;
            }
            add_triangle(f, foot, off, at, 1.0, center, false, sum);
            if foot_on_edge(s, c, f, center, true, &mut foot, &mut off) != COMPLETE {
                return UNCERTAIN;
            }
            add_triangle(f, foot, off, at, -1.0, center, false, sum);
        }
    }
    return COMPLETE;
}

/// Sets the facets' sums to zero.
#[cfg_attr(opencl, outline)]
pub(crate) fn reset_facets<S: IntegralStore>(s: &mut S, flags: u32) {
    for f in 0..s.planes() {
        s.set_facet(f, FacetSum::default());
        if (flags & FACET_SECOND_MOMENTS) != 0 {
            s.set_facet_second(f, FacetSecond::default());
        }
    }
}

/// Whether the parts of the boundary within the cell are to be summed.
#[inline(always)]
pub(crate) fn asks_for_boundary(flags: u32) -> bool {
    return (flags & (FACETS | FACET_AREAS)) == FACETS;
}

/// Adds a facet of the half-space `plane`, which bounds the domain, to the boundary's sums; `outward` is by how much the winding number is
/// larger in the half-space: +1 where it keeps the domain's inside, −1 where it keeps its outside.
#[cfg_attr(opencl, outline)]
pub(crate) fn add_boundary(sum: FacetSum, plane: Plane, outward: Real, sums: &mut CellSums) {
    // The surface has no negative area.
    if !facet_is_above_bound(sum) || (sum.area < 0.0) {
        return;
    }
    let share: Real = (outward * sum.area) / dot(plane.n, plane.n).sqrt();
    sums.boundary_area = sums.boundary_area + (outward.abs() * sum.area);
    sums.boundary_moment = add(sums.boundary_moment, scale(outward.abs(), sum.moment));
    sums.boundary_vector = sub(sums.boundary_vector, scale(share, plane.n));
    sums.boundary_flux = sums.boundary_flux + (share * plane.d);
}

/// Adds the triangles that `integrate` adds to the facets to their second moments. By itself: few ask for it, and what all do is not to pay
/// for that.
#[cold]
#[cfg_attr(opencl, outline)]
pub(super) fn add_facet_seconds<S: IntegralStore + SignStore>(s: &mut S, weight: Real, center: V3) -> u32 {
    for v in 0..s.vertices() {
        let t: Triplet = s.triplet(v);
        let position: V3 = sub(s.position(v), center);
        let a: Side = side(s, t.a, center);
        let b: Side = side(s, t.b, center);
        let c: Side = side(s, t.c, center);
        if add_edge_second(s, a, b, position, weight, center) != COMPLETE {
            return UNCERTAIN;
        }
        if add_edge_second(s, b, c, position, weight, center) != COMPLETE {
            return UNCERTAIN;
        }
        if add_edge_second(s, c, a, position, weight, center) != COMPLETE {
            return UNCERTAIN;
        }
    }
    return COMPLETE;
}

/// Adds the two triangles of one vertex and its edge (f, g).
#[cfg_attr(opencl, outline)]
pub(super) fn add_edge_second<S: IntegralStore + SignStore>(
    s: &mut S,
    f: Side,
    g: Side,
    position: V3,
    weight: Real,
    center: V3,
) -> u32 {
    let mut foot: V3 = v3(0.0, 0.0, 0.0);
    let mut off: Real = 0.0;
    if foot_on_edge(s, f, g, center, false, &mut foot, &mut off) != COMPLETE {
        return UNCERTAIN;
    }
    add_triangle_second(s, g, foot, position, -weight);
    add_triangle_second(s, f, foot, position, weight);
    return COMPLETE;
}

/// Adds the triangle (H, I, v) to the second moments of the facet of plane `f`: `area·(HHᵀ + IIᵀ + vvᵀ + ssᵀ)/12`, `s = H + I + v`,
/// about the point that all are relative to.
#[cfg_attr(opencl, outline)]
pub(super) fn add_triangle_second<S: IntegralStore>(s: &mut S, f: Side, foot: V3, position: V3, sign: Real) {
    let share: Real = area_of_triangle(f, per_length(f), sub(foot, f.foot), sub(position, f.foot), sign) / 12.0;
    let sum: V3 = add(add(f.foot, foot), position);
    let mut second: FacetSecond = s.facet_second(f.index);
    second.diagonal = add(second.diagonal, scale(share, second_diagonal(f.foot, foot, position, sum)));
    second.mixed = add(second.mixed, scale(share, second_mixed(f.foot, foot, position, sum)));
    s.set_facet_second(f.index, second);
}

/// Moves the facets' second moments from `center` to the facets' own barycenters: `∫ (x − b)(x − b)ᵀ = ∫ xxᵀ − mmᵀ/A`, `m = ∫ x`.
#[cfg_attr(opencl, outline)]
pub(super) fn center_facets<S: IntegralStore>(s: &mut S, center: V3) {
    for f in 0..s.planes() {
        let sum: FacetSum = s.facet(f);
        if facet_is_above_bound(sum) {
            let m: V3 = sub(sum.moment, scale(sum.area, center));
            let b: V3 = scale(1.0 / sum.area, m);
            let mut second: FacetSecond = s.facet_second(f);
            second.diagonal = sub(second.diagonal, v3(m.x * b.x, m.y * b.y, m.z * b.z));
            second.mixed = sub(second.mixed, v3(m.x * b.y, m.x * b.z, m.y * b.z));
            s.set_facet_second(f, second);
        }
    }
}
