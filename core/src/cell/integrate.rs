//! Integrals over a convex cell by six signed tetrahedra per vertex (paper §3), and over its facets.

use super::plane::Plane;
use super::status::{COMPLETE, UNCERTAIN};
use super::store::CellStore;
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, cross, dot, larger, norm_1, scale, smaller, sub, v3};
use super::vertex::{Triplet, residual};

/// Flags of [`integrate`](super::integrate_cell): volume and first moment alone.
pub const VOLUME_ONLY: u32 = 0;
/// Also every half-space's facet.
pub const FACETS: u32 = 1;
/// Also second moments.
pub const SECOND_MOMENTS: u32 = 2;

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

/// Sums over one restricted cell, in the frame of its site.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellSums {
    /// Volume.
    pub volume: Real,
    /// ∫ x dx.
    pub first: V3,
    /// ∫ x², y², z² dx.
    pub second_diagonal: V3,
    /// ∫ xy, xz, yz dx.
    pub second_mixed: V3,
    /// What rounding may have added to the volume, at most.
    pub rounding: Real,
    /// The largest that rounding may have added to one of the pieces that were added and subtracted.
    pub largest_rounding: Real,
    /// Area of the boundary within the cell.
    pub boundary_area: Real,
    /// ∫ x dA over the boundary.
    pub boundary_moment: V3,
    /// ∫ n dA over the boundary, `n` outward.
    pub boundary_vector: V3,
    /// ∫ n·x dA over the boundary.
    pub boundary_flux: Real,
}

/// Roundings that one signed volume has gone through, at most: about ten each for the feet H and I and the
/// vertex, eight for the determinant, the rest for the sum of up to some hundred terms of mixed sign.
const ROUNDINGS: Real = 64.0;

/// The same for the area of a triangle, in units of the product of its two sides at H, which is what a cross product loses where
/// they are nearly parallel: one for each side, two for the cross product, three for its product with the normal, two for the
/// quotient, halved; twice that for the sum. (What a foot is off, one triangle gains and its neighbour loses.)
const ROUNDINGS_OF_TRIANGLE: Real = 8.0;

/// Roundings of a refined vertex across its own planes, in units of its distance from the site: 5 for the residual, 2 for the
/// correction, 1 for the sum. (Along its planes an ill-conditioned vertex is off by more, but what one facet gains
/// there another loses; a single facet's area feels it whole, and is measured by the vertex's error radius.)
const ROUNDINGS_ACROSS: Real = 8.0;

/// What is positive counts as nothing only below this share of its bound, which is several times what rounding does.
const SHARE_OF_NOTHING: Real = 0.125;

/// What is negative, where winding numbers are not, is made by rounding: by more than its bound only where nearly degenerate planes meet, and
/// never by so many times.
const NEGATIVE_ROUNDINGS: Real = 1024.0;

/// Whether (1) a cell's volume exceeds what rounding alone can make of nothing.
///
/// For a volume that is positive the bound of one of the pieces that it is made of decides: the bounds of all pieces together are far
/// above what rounding does, and would swallow thin slabs that the sum over all cells misses.
#[inline]
pub fn volume_is_above_bound(sums: CellSums) -> u32 {
    if (sums.volume > (SHARE_OF_NOTHING * smaller(sums.rounding, sums.largest_rounding)))
        || (sums.volume < -(NEGATIVE_ROUNDINGS * sums.rounding))
    {
        return 1;
    }
    return 0;
}

/// The same share for a facet, of the bound of its largest triangle. Of many roundings most cancel: what some hundred triangles
/// leave of nothing is below this, but for one in some thousand, while the sum of their bounds would swallow thin facets that the
/// other cell, cut by other cones, keeps.
const SHARE_OF_NO_FACET: Real = 0.0625;

/// Whether (1) a facet's area exceeds what rounding alone can make of nothing.
pub fn facet_is_above_bound(sum: FacetSum) -> u32 {
    if (sum.area > (SHARE_OF_NO_FACET * sum.rounding)) || (sum.area < -(NEGATIVE_ROUNDINGS * sum.rounding)) {
        return 1;
    }
    return 0;
}

/// Below this share of `|n_f|²|n_g|²`, `|n_f × n_g|²` has lost its digits and the foot on the edge is computed exactly; between the two it
/// is refined once. The squares of the vertices' bounds.
///
/// Single: `9.313225746154785e-10`.
const NEARLY_PARALLEL: Real = 5.684341886081e-14;
/// Single: `2.44140625e-4`.
const WORTH_REFINING_FOOT: Real = 3.814697265625e-6;

/// One plane as the integrals see it: moved to the reference point, with its foot.
#[derive(Clone, Copy)]
pub(super) struct Side {
    pub(super) index: u32,
    pub(super) n: V3,
    pub(super) d: Real,
    pub(super) square: Real,
    /// H = −d n/|n|².
    pub(super) foot: V3,
}

/// Adds `weight` times the integrals of the present polytope to `sums`, and to the facets' sums.
///
/// `center` is the point that the tetrahedra share; any point will do, one in or near the polytope keeps the digits.
/// For each vertex and each of its edges (f, g): `I` the foot of `center` on the edge's line, `H_f` on the plane;
/// signed volumes `+det(H_g, I, v)/6` and `−det(H_f, I, v)/6`.
///
/// `reach` is the distance to the farthest point that a plane was made from, where that is not a site beyond the plane.
#[inline]
pub(crate) fn integrate<S: CellStore>(
    s: &mut S,
    weight: Real,
    center: V3,
    reach: Real,
    flags: u32,
    sums: &mut CellSums,
) -> u32 {
    let mut part: CellSums = CellSums::default();
    let mut v: u32 = 0;
    while v < s.vertices() {
        let t: Triplet = s.triplet(v);
        let at: Corner = Corner {
            position: sub(s.position(v), center),
            distance: norm_1(s.position(v)) + reach,
            radius: s.radius(v) + (UNIT_ROUNDOFF * reach),
        };
        let a: Side = side(s, t.a, center);
        let b: Side = side(s, t.b, center);
        let c: Side = side(s, t.c, center);
        if add_edge(s, a, b, at, weight, center, flags, &mut part) != COMPLETE {
            return UNCERTAIN;
        }
        if add_edge(s, b, c, at, weight, center, flags, &mut part) != COMPLETE {
            return UNCERTAIN;
        }
        if add_edge(s, c, a, at, weight, center, flags, &mut part) != COMPLETE {
            return UNCERTAIN;
        }
        v += 1;
    }
    // `part` holds sixfold volumes, and moments about `center` scaled alike: 24 of the first, 120 of the second.
    let volume: Real = (weight / 6.0) * part.volume;
    let first: V3 = scale(weight / 24.0, part.first);
    let about: V3 = scale(volume, center);
    sums.volume = sums.volume + volume;
    sums.first = add(sums.first, add(first, about));
    sums.rounding = sums.rounding + (part.rounding / 6.0);
    sums.largest_rounding = larger(sums.largest_rounding, part.rounding / 6.0);
    if (flags & SECOND_MOMENTS) != 0 {
        // ∫ (y + c)(y + c)ᵀ = ∫ yyᵀ + c mᵀ + m cᵀ + V ccᵀ, m = ∫ y.
        let twice: V3 = add(add(first, first), about);
        let diagonal: V3 = v3(center.x * twice.x, center.y * twice.y, center.z * twice.z);
        let both: V3 = add(first, about);
        let mixed: V3 = v3(
            (center.x * both.y) + (first.x * center.y),
            (center.x * both.z) + (first.x * center.z),
            (center.y * both.z) + (first.y * center.z),
        );
        sums.second_diagonal = add(sums.second_diagonal, add(scale(weight / 120.0, part.second_diagonal), diagonal));
        sums.second_mixed = add(sums.second_mixed, add(scale(weight / 120.0, part.second_mixed), mixed));
    }
    return COMPLETE;
}

/// Plane `f` as seen from `center`.
#[inline(always)]
pub(super) fn side<S: CellStore>(s: &S, f: u32, center: V3) -> Side {
    let plane: Plane = s.plane(f);
    let square: Real = dot(plane.n, plane.n);
    let d: Real = plane.d + dot(plane.n, center);
    return Side { index: f, n: plane.n, d: d, square: square, foot: scale(-(d / square), plane.n) };
}

/// A vertex as the integrals see it.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    /// Relative to the reference point.
    pub(super) position: V3,
    /// ‖·‖₁ of its way from the site, and the reach of its planes.
    pub(super) distance: Real,
    /// Its error radius.
    pub(super) radius: Real,
}

/// Adds the two tetrahedra of one vertex and its edge (f, g).
#[inline(always)]
pub(super) fn add_edge<S: CellStore>(
    s: &mut S,
    f: Side,
    g: Side,
    at: Corner,
    weight: Real,
    center: V3,
    flags: u32,
    part: &mut CellSums,
) -> u32 {
    let mut foot: V3 = v3(0.0, 0.0, 0.0);
    if foot_on_edge(s, f, g, center, &mut foot) != COMPLETE {
        return UNCERTAIN;
    }
    let spoke: V3 = cross(foot, at.position);
    add_tetrahedron(dot(g.foot, spoke), g.foot, foot, at.position, flags, part);
    add_tetrahedron(-dot(f.foot, spoke), f.foot, foot, at.position, flags, part);
    part.rounding = part.rounding + (((ROUNDINGS_ACROSS * UNIT_ROUNDOFF) * at.distance) * norm_1(spoke));
    if (flags & FACETS) != 0 {
        let mut sum: FacetSum = s.facet(g.index);
        add_triangle(g, foot, at, -weight, center, &mut sum);
        s.set_facet(g.index, sum);
        sum = s.facet(f.index);
        add_triangle(f, foot, at, weight, center, &mut sum);
        s.set_facet(f.index, sum);
    }
    return COMPLETE;
}

/// The foot of the perpendicular from the reference point to the line of planes f and g:
/// `I = (−d_f n_g×x − d_g x×n_f) / |x|²`, `x = n_f×n_g`.
#[inline(always)]
pub(super) fn foot_on_edge<S: CellStore>(s: &mut S, f: Side, g: Side, center: V3, foot: &mut V3) -> u32 {
    let direction: V3 = cross(f.n, g.n);
    let square: Real = dot(direction, direction);
    let whole: Real = f.square * g.square;
    if !(square > (NEARLY_PARALLEL * whole)) {
        return s.exact_foot(f.index, g.index, center, foot);
    }
    let to_f: V3 = scale(-1.0 / square, cross(g.n, direction));
    let to_g: V3 = scale(-1.0 / square, cross(direction, f.n));
    *foot = add(scale(f.d, to_f), scale(g.d, to_g));
    if square < (WORTH_REFINING_FOOT * whole) {
        let rest_f: Real = residual(Plane { n: f.n, d: f.d }, *foot);
        let rest_g: Real = residual(Plane { n: g.n, d: g.d }, *foot);
        *foot = add(*foot, add(scale(rest_f, to_f), scale(rest_g, to_g)));
    }
    return COMPLETE;
}

/// Adds the tetrahedron (center, h, i, v) of sixfold signed volume `volume`: first moment `U(h+i+v)/4`, second
/// `U(hhᵀ+iiᵀ+vvᵀ+ssᵀ)/20`, `s = h+i+v`.
#[inline(always)]
pub(super) fn add_tetrahedron(volume: Real, h: V3, i: V3, v: V3, flags: u32, part: &mut CellSums) {
    let sum: V3 = add(add(h, i), v);
    part.volume = part.volume + volume;
    part.rounding = part.rounding + ((ROUNDINGS * UNIT_ROUNDOFF) * volume.abs());
    part.first = add(part.first, scale(volume, sum));
    if (flags & SECOND_MOMENTS) != 0 {
        let diagonal: V3 = v3(
            squares(h.x, i.x, v.x) + (sum.x * sum.x),
            squares(h.y, i.y, v.y) + (sum.y * sum.y),
            squares(h.z, i.z, v.z) + (sum.z * sum.z),
        );
        let mixed: V3 = v3(
            products(h.x, h.y, i.x, i.y, v.x, v.y) + (sum.x * sum.y),
            products(h.x, h.z, i.x, i.z, v.x, v.z) + (sum.x * sum.z),
            products(h.y, h.z, i.y, i.z, v.y, v.z) + (sum.y * sum.z),
        );
        part.second_diagonal = add(part.second_diagonal, scale(volume, diagonal));
        part.second_mixed = add(part.second_mixed, scale(volume, mixed));
    }
}

#[inline(always)]
pub(super) fn squares(a: Real, b: Real, c: Real) -> Real {
    return ((a * a) + (b * b)) + (c * c);
}

#[inline(always)]
pub(super) fn products(a: Real, b: Real, c: Real, d: Real, e: Real, f: Real) -> Real {
    return ((a * b) + (c * d)) + (e * f);
}

/// Adds the triangle (H, I, v) to a facet of plane `f`: signed area `sign·½ (I − H)×(v − H)·n/|n|`, moment
/// `area·(H + I + v)/3`.
#[inline(always)]
pub(super) fn add_triangle(f: Side, foot: V3, at: Corner, sign: Real, center: V3, sum: &mut FacetSum) {
    let to_foot: V3 = sub(foot, f.foot);
    let to_vertex: V3 = sub(at.position, f.foot);
    let normal: V3 = cross(to_foot, to_vertex);
    let area: Real = ((0.5 * sign) * dot(normal, f.n)) / f.square.sqrt();
    let middle: V3 = add(scale(1.0 / 3.0, add(add(f.foot, foot), at.position)), center);
    sum.area = sum.area + area;
    sum.moment = add(sum.moment, scale(area, middle));
    let lost: Real = (ROUNDINGS_OF_TRIANGLE * UNIT_ROUNDOFF) * (norm_1(to_foot) * norm_1(to_vertex));
    sum.rounding = larger(sum.rounding, lost + (at.radius * norm_1(sub(at.position, foot))));
}

/// The sums of the facet of plane `index` alone.
pub(crate) fn integrate_facet<S: CellStore>(s: &mut S, index: u32, center: V3, sum: &mut FacetSum) -> u32 {
    *sum = FacetSum::default();
    let f: Side = side(s, index, center);
    let mut v: u32 = 0;
    while v < s.vertices() {
        let mut t: Triplet = s.triplet(v);
        if t.b == index {
            t = Triplet { a: t.b, b: t.c, c: t.a };
        } else if t.c == index {
            t = Triplet { a: t.c, b: t.a, c: t.b };
        }
        if t.a == index {
            // Vertex (f, b, c): of its edges (f, b) begins here and (c, f) ends here.
            let at: Corner =
                Corner { position: sub(s.position(v), center), distance: norm_1(s.position(v)), radius: s.radius(v) };
            let b: Side = side(s, t.b, center);
            let c: Side = side(s, t.c, center);
            let mut foot: V3 = v3(0.0, 0.0, 0.0);
            if foot_on_edge(s, f, b, center, &mut foot) != COMPLETE {
                return UNCERTAIN;
            }
            add_triangle(f, foot, at, 1.0, center, sum);
            if foot_on_edge(s, c, f, center, &mut foot) != COMPLETE {
                return UNCERTAIN;
            }
            add_triangle(f, foot, at, -1.0, center, sum);
        }
        v += 1;
    }
    return COMPLETE;
}

/// Sets the facets' sums to zero.
pub(crate) fn reset_facets<S: CellStore>(s: &mut S) {
    let mut f: u32 = 0;
    while f < s.planes() {
        s.set_facet(f, FacetSum::default());
        f += 1;
    }
}

/// Adds a facet of the half-space `plane`, which bounds the domain, to the boundary's sums; `outward` is +1 where the half-space
/// keeps the domain's inside, −1 where it keeps its outside.
pub(crate) fn add_boundary(sum: FacetSum, plane: Plane, outward: Real, sums: &mut CellSums) {
    // The surface has no negative area.
    if (facet_is_above_bound(sum) == 0) || (sum.area < 0.0) {
        return;
    }
    let share: Real = (outward * sum.area) / dot(plane.n, plane.n).sqrt();
    sums.boundary_area = sums.boundary_area + sum.area;
    sums.boundary_moment = add(sums.boundary_moment, sum.moment);
    sums.boundary_vector = sub(sums.boundary_vector, scale(share, plane.n));
    sums.boundary_flux = sums.boundary_flux + (share * plane.d);
}

/// The point that the tetrahedra of the present polytope share: the site where it is inside, else the mean of the vertices.
pub(crate) fn reference_point<S: CellStore>(s: &S) -> V3 {
    let mut inside: u32 = 1;
    let mut f: u32 = 0;
    while f < s.planes() {
        if s.plane(f).d < 0.0 {
            inside = 0;
        }
        f += 1;
    }
    let mut mean: V3 = v3(0.0, 0.0, 0.0);
    if inside != 0 {
        return mean;
    }
    let mut v: u32 = 0;
    while v < s.vertices() {
        mean = add(mean, s.position(v));
        v += 1;
    }
    return scale(1.0 / (s.vertices() as Real), mean);
}
