//! Integrals over a convex cell by six signed tetrahedra per vertex (paper §3), and over its facets.

use super::facet::{FacetSum, add_facet_seconds, add_triangle};
use super::plane::Plane;
use super::quadrature::integrate_function;
use super::status::{COMPLETE, UNCERTAIN};
use super::store::{IntegralStore, Polytope, SignStore};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, cross, dot, larger, norm_1, scale, smaller, sub, v3};
use super::vertex::{Triplet, residual_about};

/// Flags of [`integrate`](super::integrate_cell): volume and first moment alone.
pub const VOLUME_ONLY: u32 = 0;
/// Also every half-space's facet.
pub const FACETS: u32 = 1;
/// Also second moments.
pub const SECOND_MOMENTS: u32 = 2;
/// Also every facet's second moments; with `FACETS`.
pub const FACET_SECOND_MOMENTS: u32 = 4;
/// Also the integral of the store's function.
pub const INTEGRAL: u32 = 8;
/// Of facets no more than their areas, and nothing of the boundary: what the Laplacian is made of. With `FACETS`. (Parts of the surface within a cell are cut out by
/// themselves: without them a transport in the bunny takes a third fewer instructions on the CPU.)
pub const FACET_AREAS: u32 = 16;

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
    /// ∫ of the store's function.
    pub integral: Real,
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

/// Roundings of a refined vertex across its own planes, in units of its distance from the site: 5 for the residual, 2 for the
/// correction, 1 for the sum. (Along its planes an ill-conditioned vertex is off by more, but what one facet gains
/// there another loses; a single facet's area feels it whole, and is measured by the vertex's error radius.) As much as a displacement of
/// the vertex by these does to the two volumes of an edge, so much and no more is lost in computing them from their spoke: 4 for the
/// spoke, whose sides are at right angles, 3 for its product with each foot. Both lengths of the bound are sums of magnitudes.
const ROUNDINGS_ACROSS: Real = 8.0;

/// Roundings of the plane of a triangle of the surface, in units of its reach: 1 for each coordinate relative to the site, 5 for the plane. The
/// planes of two triangles at an edge are not displaced alike, also where both lie in one plane: what a facet loses to one cone it does not gain
/// from the next. Where a cell is a few roundings wide there is nothing larger.
pub(super) const ROUNDINGS_OF_SURFACE: Real = 8.0;

/// What is positive counts as nothing only below this share of its bound, which is several times what rounding does.
pub(super) const SHARE_OF_NOTHING: Real = 0.125;

/// Whether a cell's volume exceeds what rounding alone can make of nothing.
///
/// For a volume that is positive the bound of one of the pieces that it is made of decides: the bounds of all pieces together are far
/// above what rounding does, and would swallow thin slabs that the sum over all cells misses. What is negative is believed only beyond
/// that sum of bounds, which no rounding exceeds (16 times what it did in ten thousand cells of volume 0): few surfaces go around anything the
/// wrong way, but those that fold over themselves do so in slabs as thin as that.
#[inline]
#[cfg_attr(opencl, hot)]
pub fn volume_is_above_bound(sums: CellSums) -> bool {
    if (sums.volume > (SHARE_OF_NOTHING * smaller(sums.rounding, sums.largest_rounding)))
        || (sums.volume < -sums.rounding)
    {
        return true;
    }
    return false;
}

/// Vertices that are summed by themselves before their sum is added to that of the others: a power of two. A sum of n like terms is off by
/// some √n roundings: the volume of a cell of 2,866 vertices was by 16 to 25 roundings so, and is by 1 to 3.
const BLOCK_OF_VERTICES: u32 = 64;

/// Below this share of `|n_f|²|n_g|²`, the square of the angle's sine, the foot on the edge is computed exactly: each step of refinement
/// leaves some roundings over the sine of the error, here 10⁻⁵, and three are made.
#[cfg_attr(opencl, single(9.313225746154785e-10))]
const NEARLY_PARALLEL: Real = 1.3552527156068805e-20;
/// Below this it is refined three times, above once.
#[cfg_attr(opencl, single(9.313225746154785e-10))]
const WORTH_REFINING_MORE: Real = 5.684341886081e-14;
/// Below this it is refined.
#[cfg_attr(opencl, single(2.44140625e-4))]
const WORTH_REFINING_FOOT: Real = 3.814697265625e-6;

/// Roundings of a foot across its line, in units of its distance over the sine of the angle; refined, of its distance.
const ROUNDINGS_OF_FOOT: Real = 8.0;
/// Roundings of the offset of a plane that is moved to the reference point, in units of the distance of that, also over the sine.
const ROUNDINGS_OF_OFFSET: Real = 4.0;

/// One plane as the integrals see it: moved to the reference point, with its foot.
#[derive(Clone, Copy, Debug)]
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
#[cfg_attr(opencl, hot)]
pub(crate) fn integrate<S: IntegralStore + SignStore>(
    s: &mut S,
    weight: Real,
    center: V3,
    reach: Real,
    flags: u32,
    sums: &mut CellSums,
) -> u32 {
    let mut part: CellSums = CellSums::default();
    // What the vertices of earlier blocks have added.
    let mut before: CellSums = CellSums::default();
    let is_in_blocks: bool = s.sums_in_blocks() && (s.vertices() > BLOCK_OF_VERTICES);
    #[cfg(not(opencl))]
    if (flags & SECOND_MOMENTS) == 0 {
        s.prepare_corners(weight, center, reach, flags);
    }
    for v in 0..s.vertices() {
        if is_in_blocks && (v != 0) && ((v & (BLOCK_OF_VERTICES - 1)) == 0) {
            before = both_sums(before, part);
            part = CellSums::default();
        }
        #[cfg(not(opencl))]
        if (flags & SECOND_MOMENTS) == 0 && s.add_corner(v, norm_1(s.position(v)) + reach, flags, &mut part) {
            continue;
        }
        let t: Triplet = s.triplet(v);
        let at: Corner = Corner {
            triplet: t,
            position: sub(s.position(v), center),
            distance: norm_1(s.position(v)) + reach,
            radius: radius_at(s.radius(v), reach),
        };
        let mut f: Side = side(s, t.a, center);
        if s.is_short() {
            #[cfg_attr(opencl, rolled)]
            for edge in 0..3 {
                let mut next: u32 = t.a;
                if edge == 0 {
                    next = t.b;
                } else if edge == 1 {
                    next = t.c;
                }
                let g: Side = side(s, next, center);
                if add_edge(s, f, g, at, weight, center, flags, &mut part) != COMPLETE {
                    return UNCERTAIN;
                }
                f = g;
            }
        } else {
            let b: Side = side(s, t.b, center);
            let c: Side = side(s, t.c, center);
            if add_edge(s, f, b, at, weight, center, flags, &mut part) != COMPLETE {
                return UNCERTAIN;
            }
            if add_edge(s, b, c, at, weight, center, flags, &mut part) != COMPLETE {
                return UNCERTAIN;
            }
            if add_edge(s, c, f, at, weight, center, flags, &mut part) != COMPLETE {
                return UNCERTAIN;
            }
        }
    }
    if is_in_blocks {
        part = both_sums(before, part);
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
    if (flags & FACET_SECOND_MOMENTS) != 0 {
        if add_facet_seconds(s, weight, center) != COMPLETE {
            return UNCERTAIN;
        }
    }
    // A store without nodes says so when it is compiled: what is not asked for is not there.
    if ((flags & INTEGRAL) != 0) && (s.nodes() != 0) {
        sums.integral = sums.integral + (weight * integrate_function(s, center));
    }
    return COMPLETE;
}

/// The sums of two sets of pieces, or of vertices.
#[cfg_attr(opencl, outline)]
pub(super) fn both_sums(a: CellSums, b: CellSums) -> CellSums {
    return CellSums {
        volume: a.volume + b.volume,
        first: add(a.first, b.first),
        second_diagonal: add(a.second_diagonal, b.second_diagonal),
        second_mixed: add(a.second_mixed, b.second_mixed),
        integral: a.integral + b.integral,
        rounding: a.rounding + b.rounding,
        largest_rounding: larger(a.largest_rounding, b.largest_rounding),
        boundary_area: a.boundary_area + b.boundary_area,
        boundary_moment: add(a.boundary_moment, b.boundary_moment),
        boundary_vector: add(a.boundary_vector, b.boundary_vector),
        boundary_flux: a.boundary_flux + b.boundary_flux,
    };
}

/// Plane `f` as seen from `center`.
#[inline(always)]
pub(super) fn side<S: Polytope>(s: &S, f: u32, center: V3) -> Side {
    let plane: Plane = s.plane(f);
    let square: Real = dot(plane.n, plane.n);
    let d: Real = plane.d + dot(plane.n, center);
    return Side { index: f, n: plane.n, d: d, square: square, foot: scale(-(d / square), plane.n) };
}

/// A vertex as the integrals see it.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    /// Its half-spaces.
    pub(super) triplet: Triplet,
    /// Relative to the reference point.
    pub(super) position: V3,
    /// ‖·‖₁ of its way from the site, and the reach of its planes.
    pub(super) distance: Real,
    /// Its error radius.
    pub(super) radius: Real,
}

/// Adds the two tetrahedra of one vertex and its edge (f, g).
#[inline(always)]
pub(super) fn add_edge<S: IntegralStore + SignStore>(
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
    let mut off: Real = 0.0;
    if foot_on_edge(s, f, g, center, (flags & FACETS) != 0, &mut foot, &mut off) != COMPLETE {
        return UNCERTAIN;
    }
    let spoke: V3 = spoke_of(foot, at.position);
    add_tetrahedron(dot(g.foot, spoke), g.foot, foot, at.position, flags, part);
    add_tetrahedron(-dot(f.foot, spoke), f.foot, foot, at.position, flags, part);
    part.rounding = part.rounding + rounding_across(at.distance, norm_1(spoke));
    if (flags & FACETS) != 0 {
        let mut sum: FacetSum = s.facet_at(at.triplet, g.index);
        add_triangle(g, foot, off, at, -weight, center, s.sums_areas_alone(), &mut sum);
        s.set_facet_at(at.triplet, g.index, sum);
        sum = s.facet_at(at.triplet, f.index);
        add_triangle(f, foot, off, at, weight, center, s.sums_areas_alone(), &mut sum);
        s.set_facet_at(at.triplet, f.index, sum);
    }
    return COMPLETE;
}

/// `I×v`, but the foot is at right angles to the edge: nothing cancels, however far away a small piece is.
#[inline(always)]
pub(super) fn spoke_of(foot: V3, position: V3) -> V3 {
    return cross(foot, sub(position, foot));
}

/// What rounding across a vertex's planes does to the volumes of one of its edges.
#[inline(always)]
pub(super) fn rounding_across(distance: Real, spoke: Real) -> Real {
    return ((ROUNDINGS_ACROSS * UNIT_ROUNDOFF) * distance) * spoke;
}

/// The foot of the perpendicular from the reference point to the line of planes f and g:
/// `I = (−d_f n_g×x − d_g x×n_f) / |x|²`, `x = n_f×n_g`; and, if that `is_bounded`, how far it may be off that line.
/// (Bounds are of facets alone; their root and quotient are 3 % of a white cell on the CPU.)
///
/// `x` is off by 3u over the sine of the angle between the planes, and the foot by as much of its length, however far away the planes are:
/// what two nearly parallel planes have in common cancels. Each step of refinement multiplies that by itself, until roundings are left.
#[inline(always)]
pub(super) fn foot_on_edge<S: SignStore>(
    s: &mut S,
    f: Side,
    g: Side,
    center: V3,
    is_bounded: bool,
    foot: &mut V3,
    off: &mut Real,
) -> u32 {
    let direction: V3 = cross(f.n, g.n);
    let square: Real = dot(direction, direction);
    let whole: Real = f.square * g.square;
    if !(square > (NEARLY_PARALLEL * whole)) {
        let status: u32 = s.exact_foot(f.index, g.index, center, foot);
        *off = UNIT_ROUNDOFF * norm_1(*foot);
        return status;
    }
    let per_square: Real = 1.0 / square;
    *foot = foot_by(f.n, f.d, g.n, g.d, direction, per_square);
    if is_plain(square, whole) {
        if is_bounded {
            *off = off_plain_foot(*foot, per_square * whole, center);
        }
        return COMPLETE;
    }
    *off = (ROUNDINGS_OF_FOOT * UNIT_ROUNDOFF) * norm_1(*foot);
    let to_f: V3 = scale(-per_square, cross(g.n, direction));
    let to_g: V3 = scale(-per_square, cross(direction, f.n));
    let mut steps: u32 = 1;
    if square < (WORTH_REFINING_MORE * whole) {
        steps = 3;
    }
    // Of the planes themselves: what their offsets have lost on the way to the reference point would count over the sine.
    let plane_f: Plane = s.plane(f.index);
    let plane_g: Plane = s.plane(g.index);
    while steps > 0 {
        let rest_f: Real = residual_about(plane_f, center, *foot);
        let rest_g: Real = residual_about(plane_g, center, *foot);
        *foot = add(*foot, add(scale(rest_f, to_f), scale(rest_g, to_g)));
        steps -= 1;
    }
    return COMPLETE;
}

/// The foot by the planes' normals and offsets, the normals' product and one over its square.
#[inline(always)]
pub(super) fn foot_by(n_f: V3, d_f: Real, n_g: V3, d_g: Real, direction: V3, per_square: Real) -> V3 {
    let to_f: V3 = scale(-per_square, cross(n_g, direction));
    let to_g: V3 = scale(-per_square, cross(direction, n_f));
    return add(scale(d_f, to_f), scale(d_g, to_g));
}

/// Whether the foot on the edge of two planes needs no refinement: `square` as above, `whole` the product of the normals' squares.
#[inline(always)]
pub(super) fn is_plain(square: Real, whole: Real) -> bool {
    return square >= (WORTH_REFINING_FOOT * whole);
}

/// How far such a foot may be off its line, where one over the square of the angle's sine is that.
#[inline(always)]
pub(super) fn off_plain_foot(foot: V3, per_sine_square: Real, center: V3) -> Real {
    let amplified: Real = UNIT_ROUNDOFF * per_sine_square.sqrt();
    return amplified * ((ROUNDINGS_OF_FOOT * norm_1(foot)) + (ROUNDINGS_OF_OFFSET * norm_1(center)));
}

/// How far a vertex whose planes reach so far is off, at most, where its triangles are.
#[inline(always)]
pub(super) fn radius_at(radius: Real, reach: Real) -> Real {
    return radius + ((ROUNDINGS_OF_SURFACE * UNIT_ROUNDOFF) * reach);
}

/// A tetrahedron with a corner at the reference point: its sixfold signed volume, what rounding may have added to that, and its first moment, times four.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    pub(super) volume: Real,
    pub(super) rounding: Real,
    pub(super) first: V3,
}

/// The tetrahedron (center, h, i, v): first moment `U(h+i+v)/4`.
#[inline(always)]
pub(super) fn piece_of(volume: Real, h: V3, i: V3, v: V3) -> Piece {
    let bound: Real = (ROUNDINGS * UNIT_ROUNDOFF) * volume.abs();
    return Piece { volume: volume, rounding: bound, first: scale(volume, add(add(h, i), v)) };
}

#[inline(always)]
pub(super) fn add_piece(piece: Piece, part: &mut CellSums) {
    part.volume = part.volume + piece.volume;
    part.rounding = part.rounding + piece.rounding;
    part.first = add(part.first, piece.first);
}

/// Adds the tetrahedron (center, h, i, v) of sixfold signed volume `volume`; second moment `U(hhᵀ+iiᵀ+vvᵀ+ssᵀ)/20`, `s = h+i+v`.
#[inline(always)]
pub(super) fn add_tetrahedron(volume: Real, h: V3, i: V3, v: V3, flags: u32, part: &mut CellSums) {
    add_piece(piece_of(volume, h, i, v), part);
    if (flags & SECOND_MOMENTS) != 0 {
        let sum: V3 = add(add(h, i), v);
        part.second_diagonal = add(part.second_diagonal, scale(volume, second_diagonal(h, i, v, sum)));
        part.second_mixed = add(part.second_mixed, scale(volume, second_mixed(h, i, v, sum)));
    }
}

/// The diagonal of `hhᵀ + iiᵀ + vvᵀ + ssᵀ`.
#[inline(always)]
pub(super) fn second_diagonal(h: V3, i: V3, v: V3, s: V3) -> V3 {
    return v3(
        squares(h.x, i.x, v.x) + (s.x * s.x),
        squares(h.y, i.y, v.y) + (s.y * s.y),
        squares(h.z, i.z, v.z) + (s.z * s.z),
    );
}

/// The entries xy, xz, yz of `hhᵀ + iiᵀ + vvᵀ + ssᵀ`.
#[inline(always)]
pub(super) fn second_mixed(h: V3, i: V3, v: V3, s: V3) -> V3 {
    return v3(
        products(h.x, h.y, i.x, i.y, v.x, v.y) + (s.x * s.y),
        products(h.x, h.z, i.x, i.z, v.x, v.z) + (s.x * s.z),
        products(h.y, h.z, i.y, i.z, v.y, v.z) + (s.y * s.z),
    );
}

#[inline(always)]
pub(super) fn squares(a: Real, b: Real, c: Real) -> Real {
    return ((a * a) + (b * b)) + (c * c);
}

#[inline(always)]
pub(super) fn products(a: Real, b: Real, c: Real, d: Real, e: Real, f: Real) -> Real {
    return ((a * b) + (c * d)) + (e * f);
}

/// The point that the tetrahedra of the present polytope share: the site where it is inside, else the mean of the vertices.
#[cfg_attr(opencl, outline)]
pub(crate) fn reference_point<S: Polytope>(s: &S) -> V3 {
    let mut inside: bool = true;
    for f in 0..s.planes() {
        if s.plane(f).d < 0.0 {
            inside = false;
        }
    }
    let mut mean: V3 = v3(0.0, 0.0, 0.0);
    if inside {
        return mean;
    }
    for v in 0..s.vertices() {
        mean = add(mean, s.position(v));
    }
    return scale(1.0 / (s.vertices() as Real), mean);
}
