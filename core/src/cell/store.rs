//! Where a cell lives: the trait that the algorithm is written over.
//!
//! This file is the boundary of the dialect: every backend writes its own storage behind these names.

use super::TOGETHER;
use super::facet::{FacetSecond, FacetSum};
use super::integrate::CellSums;
use super::lanes::Lanes;
use super::plane::Plane;
use super::quadrature::{Node, polynomial};
use super::status::{MARK_CONFLICT, MARK_KEEP, MARK_UNCERTAIN, SEEN_CONFLICT, SEEN_KEEP, SEEN_UNCERTAIN, SIGN_UNKNOWN};
use super::vector::{Real, UNIT_ROUNDOFF, V3, add, dot, norm_1, sub, v3};
use super::vertex::Triplet;
use super::wide::Minors;
use super::widest::clip;
use crate::domain_grid::DomainGrid;
use crate::exact;
use crate::integrand::FramedIntegrand;
use pulp::Arch;

/// A triangle of the domain: the indices of its vertices, outward oriented, and how often it stands.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Triangle {
    /// First vertex.
    pub a: u32,
    /// Second vertex.
    pub b: u32,
    /// Third vertex.
    pub c: u32,
    /// By so much the winding number is larger behind it, seen from outside.
    pub times: i32,
}

/// A voxel of the domain's grid.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Voxel {
    /// Index along x.
    pub i: u32,
    /// Index along y.
    pub j: u32,
    /// Index along z.
    pub k: u32,
}

/// The cell under construction, as a convex polytope: half-spaces, and vertices that each lie on three of them.
///
/// Indices are below the counts that the store itself reports; writes at the count append. All positions and planes
/// are in the frame of the cell's site (the site at 0); the domain is in the diagram's frame.
pub trait Polytope {
    /// Room for half-spaces.
    fn cap_p(&self) -> u32;
    /// Room for vertices.
    fn cap_v(&self) -> u32;
    /// Number of half-spaces.
    fn planes(&self) -> u32;
    /// Sets the number of half-spaces.
    fn set_planes(&mut self, count: u32);
    /// Number of vertices.
    fn vertices(&self) -> u32;
    /// Sets the number of vertices.
    fn set_vertices(&mut self, count: u32);
    /// Half-space `f`.
    fn plane(&self, f: u32) -> Plane;
    /// Sets half-space `f`.
    fn set_plane(&mut self, f: u32, plane: Plane);
    /// What half-space `f` belongs to: a site, or one of the `TAG_` constants.
    fn tag(&self, f: u32) -> u32;
    /// Sets what half-space `f` belongs to.
    fn set_tag(&mut self, f: u32, tag: u32);
    /// The three half-spaces of vertex `v`.
    fn triplet(&self, v: u32) -> Triplet;
    /// Sets the three half-spaces of vertex `v`.
    fn set_triplet(&mut self, v: u32, triplet: Triplet);
    /// Position of vertex `v`.
    fn position(&self, v: u32) -> V3;
    /// Error radius of vertex `v`, see `place_vertex`.
    fn radius(&self, v: u32) -> Real;
    /// Sets position and error radius of vertex `v`.
    fn set_position(&mut self, v: u32, position: V3, radius: Real);
    /// The cell's site, in the diagram's frame.
    fn site(&self) -> V3;
}

/// What clipping by one work-item needs beside the polytope. (Lanes that share a cell clip in a way of their own: `lanes_clip.cl`.)
pub trait ClipStore: Polytope {
    /// Makes half-space `to` what `from` is.
    #[inline(always)]
    fn move_plane(&mut self, from: u32, to: u32) {
        self.set_plane(to, self.plane(from));
        self.set_tag(to, self.tag(from));
    }

    /// The instructions that a host clips by.
    #[inline(always)]
    fn instructions(&self) -> Arch {
        Arch::Scalar
    }
    /// Scratch number of half-space `f`, zero between calls of `clip`.
    fn link(&self, f: u32) -> u32;
    /// Sets the scratch number of half-space `f`.
    fn set_link(&mut self, f: u32, link: u32);
    /// Turns the bits `change` of the scratch number of half-space `f`.
    #[inline(always)]
    fn toggle_link(&mut self, f: u32, change: u32) {
        let link = self.link(f) ^ change;
        self.set_link(f, link);
    }
    /// Whether that was done once since the number was set; `false` where a store does not count.
    #[inline(always)]
    fn was_toggled_once(&self, _f: u32) -> bool {
        false
    }
    /// Makes vertex `to` what `from` is.
    #[inline(always)]
    fn move_vertex(&mut self, from: u32, to: u32) {
        self.set_triplet(to, self.triplet(from));
        self.set_position(to, self.position(from), self.radius(from));
        self.set_settled(to, self.settled(from));
    }

    /// Sets the triplet of vertex `v`, whose half-spaces have new numbers: it stays settled where it was. (Not as it stands in a store that keeps that
    /// beside the triplet.)
    #[inline(always)]
    fn renumber(&mut self, v: u32, triplet: Triplet) {
        self.set_triplet(v, triplet);
    }

    /// Whether it is known that no site cuts vertex `v` off. For searches on the host: `set_position` makes it `false`.
    fn settled(&self, v: u32) -> bool;
    /// Sets whether that is known.
    fn set_settled(&mut self, v: u32, settled: bool);
    /// From vertex `v` on the first of which that is not known; as many as there are where it is known of all. (Of the 20,000 vertices of a heavy site's cell
    /// it is known of most, and to ask each of them was four fifths of the time that the cell took.)
    fn next_open(&self, v: u32) -> u32 {
        (v..self.vertices()).find(|&v| !self.settled(v)).unwrap_or(self.vertices())
    }
    /// Says that the next half-space likely cuts off vertex `v`, to a host's store that finds those that are cut off from one of them on.
    #[inline(always)]
    fn begin_at(&mut self, _v: u32) {}
    /// Which of eight half-spaces may cut the cell, a bit each: of the others it is known that `clip` leaves it untouched, now and when others have cut it.
    /// For searches on the host; all, where a store does not look. Their normals' coordinates and offsets, see [`Plane`].
    #[inline(always)]
    fn may_be_cut_by(&self, _planes: &[[Real; TOGETHER]; 4]) -> u8 {
        u8::MAX
    }
    /// Whether one of some vertices, as a host looks at once, is certainly not in conflict with a half-space; `false` where a store does not look.
    #[inline(always)]
    fn keeps_some(&self, _plane: Plane) -> bool {
        false
    }
    /// Mark of vertex `v`, one of the `MARK_` constants.
    fn mark(&self, v: u32) -> u32;
    /// Sets the mark of vertex `v`.
    fn set_mark(&mut self, v: u32, mark: u32);
    /// Keeps a copy of the vertices, for `restore`.
    fn save(&mut self);
    /// Puts the vertices back as they were at `save`.
    fn restore(&mut self);
    /// First marked vertex in conflict at or after `from` and below `end`; `end` if there is none.
    #[inline(always)]
    fn next_conflict(&self, from: u32, end: u32) -> u32 {
        let mut v = from;
        while v < end && self.mark(v) != MARK_CONFLICT {
            v += 1;
        }
        v
    }

    /// The mark of vertex `v`, by its side of a plane, and the `SEEN_` bit of that mark.
    ///
    /// Uncertain: `|n·v + d|` at most `‖n‖₁·radius + 4u|d|`.
    #[inline(always)]
    fn mark_by(&self, plane: Plane, v: u32) -> (u32, u32) {
        let slack = (4.0 * UNIT_ROUNDOFF) * plane.d.abs();
        let value = dot(plane.n, self.position(v)) + plane.d;
        let bound = (norm_1(plane.n) * self.radius(v)) + slack;
        if value > bound {
            (MARK_KEEP, SEEN_KEEP)
        } else if value < -bound {
            (MARK_CONFLICT, SEEN_CONFLICT)
        } else {
            (MARK_UNCERTAIN, SEEN_UNCERTAIN)
        }
    }

    /// Marks every vertex with its side of plane `k` and returns the summary: which of the `SEEN_` bits occurred. The door
    /// for SIMD: an override returns the same marks.
    #[inline(always)]
    fn mark_conflicts(&mut self, k: u32) -> u32 {
        let plane = self.plane(k);
        let mut seen = 0;
        for v in 0..self.vertices() {
            let (mark, bit) = self.mark_by(plane, v);
            self.set_mark(v, mark);
            seen |= bit;
        }
        seen
    }

    /// The largest squared distance of a vertex from the site, and the largest error radius, as x and y.
    #[inline(always)]
    fn farthest(&self) -> V3 {
        self.farthest_from(V3::default())
    }

    /// The same from `center`. The other door for SIMD: a maximum does not depend on the order.
    #[inline(always)]
    fn farthest_from(&self, center: V3) -> V3 {
        let mut square: Real = 0.0;
        let mut radius: Real = 0.0;
        for v in 0..self.vertices() {
            let way = sub(self.position(v), center);
            square = square.max(dot(way, way));
            radius = radius.max(self.radius(v));
        }
        V3 { x: square, y: radius, z: 0.0 }
    }
}

/// Signs and positions in more digits than two doubles have.
pub trait SignStore: Polytope {
    /// Notes that the cell needed exact arithmetic.
    #[inline(always)]
    fn note_exact(&mut self) {}

    /// The sign of `det [n|d]` of the planes of vertex `v`, whose triplet is `t`, and plane `k` by integers, where their coefficients have few digits
    /// (`core/src/narrow.rs`); else, and on a device, `SIGN_UNKNOWN`.
    fn narrow_sign(&mut self, _t: Triplet, _v: u32, _k: u32) -> i32 {
        SIGN_UNKNOWN
    }

    /// Whether the minors of a vertex's planes are kept, which decide the sign of each further plane at a sixth of the cost.
    fn keeps_minors(&self) -> bool {
        false
    }

    /// Those of vertex `v`, if they were kept since its position was set.
    fn minors(&self, _v: u32) -> Minors {
        Minors::default()
    }

    /// Keeps them.
    fn keep_minors(&mut self, _v: u32, _minors: Minors) {}

    /// The same sign by integers that wrap, where double-double left it open; `SIGN_UNKNOWN` where they do not suffice.
    fn tie_sign(&mut self, t: Triplet, k: u32) -> i32 {
        exact::sign_of_tie(self.plane(t.a), self.plane(t.b), self.plane(t.c), self.plane(k))
    }

    /// The exact sign of `det [n|d]` of the planes of `t` and plane `k`. On a device: `SIGN_UNKNOWN`.
    fn exact_sign(&mut self, t: Triplet, k: u32) -> i32 {
        exact::sign_of_planes(self.plane(t.a), self.plane(t.b), self.plane(t.c), self.plane(k))
    }

    /// The exact position of the vertex with triplet `t`, rounded once; returns `COMPLETE`. On a device: `UNCERTAIN`.
    fn exact_position(&mut self, t: Triplet, position: &mut V3) -> u32 {
        exact::position(self.plane(t.a), self.plane(t.b), self.plane(t.c), position)
    }

    /// The exact foot, relative to `center`, of the perpendicular from `center` to the line of planes `f` and `g`, rounded
    /// once; returns `COMPLETE`. On a device: `UNCERTAIN`.
    fn exact_foot(&mut self, f: u32, g: u32, center: V3, foot: &mut V3) -> u32 {
        exact::foot(self.plane(f), self.plane(g), center, foot)
    }
}

/// What is integrated, and the sums of facets.
pub trait IntegralStore: Polytope {
    /// The sums of half-space `f`'s facet.
    fn facet(&self, f: u32) -> FacetSum;
    /// Sets the sums of half-space `f`'s facet.
    fn set_facet(&mut self, f: u32, sum: FacetSum);
    /// The same sums while `integrate` is at a vertex, whose triplet is `t`. Where lanes share out the vertices, each vertex has sums of its own, in a place for each
    /// half-space of its triplet, to be added up once all lanes are through: they cannot add to one facet at the same time.
    #[inline(always)]
    fn facet_at(&self, _t: Triplet, f: u32) -> FacetSum {
        self.facet(f)
    }
    /// Sets them.
    #[inline(always)]
    fn set_facet_at(&mut self, _t: Triplet, f: u32, sum: FacetSum) {
        self.set_facet(f, sum);
    }
    /// Whether of facets areas alone are worth summing, where the flag `FACET_AREAS` says that no more is asked for. On the CPU they are not: for lanes it is less
    /// that they leave for each other, here asking took 1 % more instructions of all integrals, of facets or not.
    #[inline(always)]
    fn sums_areas_alone(&self) -> bool {
        false
    }
    /// Computes the tetrahedra of all vertices for volumes and first moments, as [`integrate`](super::integrate_cell) has them, and with `FACETS` their
    /// triangles, where a host does that for several vertices at a time.
    #[inline(always)]
    fn prepare_corners(&mut self, _weight: Real, _center: V3, _reach: Real, _flags: u32) {}
    /// Adds those of vertex `v`, whose way from the site is that long; `false` where they are not there.
    #[inline(always)]
    fn add_corner(&mut self, _v: u32, _distance: Real, _flags: u32, _part: &mut CellSums) -> bool {
        false
    }
    /// The second moments of half-space `f`'s facet. Asked for only with the flag `FACET_SECOND_MOMENTS`.
    fn facet_second(&self, f: u32) -> FacetSecond;
    /// Sets the second moments of half-space `f`'s facet.
    fn set_facet_second(&mut self, f: u32, second: FacetSecond);
    /// The function to be integrated, where there is one.
    #[inline(always)]
    fn integrand(&self) -> Option<&FramedIntegrand> {
        None
    }

    /// Number of nodes of the quadrature rule; 0 where no function is to be integrated.
    #[inline(always)]
    fn nodes(&self) -> u32 {
        self.integrand().map_or(0, |integrand| integrand.nodes().len() as u32)
    }

    /// Node `q` of the quadrature rule.
    #[inline(always)]
    fn node(&self, q: u32) -> Node {
        self.integrand().map_or(Node::default(), |integrand| integrand.nodes()[q as usize])
    }

    /// The function at `x`, in the frame of the site. The door for a function of the caller's; all others, and on a device there are no such,
    /// are polynomials (`quadrature.rs`).
    #[inline(always)]
    fn function(&self, x: V3) -> Real
    where
        Self: Sized,
    {
        match self.integrand().and_then(FramedIntegrand::function) {
            Some(function) => function(add(self.site(), x)),
            None => polynomial(self, x),
        }
    }

    /// Total degree of the polynomial.
    #[inline(always)]
    fn degree(&self) -> u32 {
        self.integrand().map_or(0, FramedIntegrand::degree)
    }

    /// The point that the polynomial's monomials are about, in the diagram's frame.
    #[inline(always)]
    fn origin(&self) -> V3 {
        self.integrand().map_or(V3::default(), |integrand| {
            let [x, y, z] = integrand.origin();
            v3(x, y, z)
        })
    }

    /// Coefficient `i` of the polynomial, in the order of [`FramedIntegrand::coefficients`].
    #[inline(always)]
    fn coefficient(&self, i: u32) -> Real {
        self.integrand().map_or(0.0, |integrand| integrand.coefficients()[i as usize])
    }

    /// Whether the vertices of a large cell are summed in blocks. Lanes have few of them each.
    #[inline(always)]
    fn sums_in_blocks(&self) -> bool {
        true
    }

    /// Whether the edges of a vertex are gone through in a loop by the integrals: on a GPU three times the text is more than its nearest cache of
    /// instructions holds.
    #[inline(always)]
    fn is_short(&self) -> bool {
        true
    }
}

/// The domain that the cell is restricted to, where there is one.
pub trait DomainStore: Polytope {
    /// The domain's grid, where there is one.
    fn domain(&self) -> Option<&DomainGrid>;
    /// Whether the cell is restricted to a domain (1) or to its initial box alone (0).
    #[inline(always)]
    fn has_domain(&self) -> bool {
        self.domain().is_some()
    }

    /// The voxel that holds `x` (in the diagram's frame), clamped into the grid.
    fn voxel_of(&self, x: V3) -> Voxel {
        self.domain().map_or(Voxel::default(), |grid| Voxel {
            i: grid.voxel_of(0, x.x),
            j: grid.voxel_of(1, x.y),
            k: grid.voxel_of(2, x.z),
        })
    }

    /// Minimum corner of a voxel, in the diagram's frame.
    fn corner(&self, voxel: Voxel) -> V3 {
        self.domain().map_or(V3::default(), |grid| {
            let [x, y, z] = grid.corner([voxel.i, voxel.j, voxel.k]);
            V3 { x, y, z }
        })
    }

    /// Winding number of a voxel's minimum corner.
    fn winding(&self, voxel: Voxel) -> i32 {
        self.domain().map_or(1, |grid| grid.winding([voxel.i, voxel.j, voxel.k]))
    }

    /// How many voxels from `lo` to `hi` (inclusive) the surface meets.
    fn surface_voxels(&self, lo: Voxel, hi: Voxel) -> u32 {
        self.domain().map_or(0, |grid| grid.surface_voxels([lo.i, lo.j, lo.k], [hi.i, hi.j, hi.k]))
    }

    /// Where the triangle list of a voxel begins.
    fn list_begin(&self, voxel: Voxel) -> u32 {
        self.domain().map_or(0, |grid| grid.offsets()[grid.voxel_index([voxel.i, voxel.j, voxel.k])])
    }

    /// Where the triangle list of a voxel ends.
    fn list_end(&self, voxel: Voxel) -> u32 {
        self.domain().map_or(0, |grid| grid.offsets()[grid.voxel_index([voxel.i, voxel.j, voxel.k]) + 1])
    }

    /// The triangle at entry `e` of the lists.
    fn list_entry(&self, e: u32) -> u32 {
        self.domain().map_or(0, |grid| grid.entries()[e as usize])
    }

    /// The lowest voxel whose list holds triangle `t`, componentwise.
    fn lowest_voxel(&self, t: u32) -> Voxel {
        self.domain().map_or(Voxel::default(), |grid| {
            let [i, j, k] = grid.lowest_voxels()[t as usize];
            Voxel { i, j, k }
        })
    }

    /// Notes that the cell tries triangle `t`.
    #[inline(always)]
    fn note_tried(&self, _t: u32) {}

    /// Triangle `t`.
    #[inline(always)]
    fn triangle(&self, t: u32) -> Triangle {
        self.note_tried(t);
        self.domain().map_or(Triangle::default(), |grid| {
            let [a, b, c, times] = grid.triangles()[t as usize];
            Triangle { a, b, c, times: times as i32 }
        })
    }

    /// Vertex `i` of the domain, in the diagram's frame.
    fn domain_point(&self, i: u32) -> V3 {
        self.domain().map_or(V3::default(), |grid| {
            let [x, y, z] = grid.vertices()[i as usize];
            V3 { x, y, z }
        })
    }

    /// Corner `corner` (0, 1, 2) of triangle `t`, in the diagram's frame.
    fn triangle_point(&self, t: u32, corner: u32) -> V3 {
        let triangle = self.triangle(t);
        self.domain_point([triangle.a, triangle.b, triangle.c][corner as usize])
    }

    /// The exact sign of `det(a − o, b − o, c − o)` for triangle `t` and voxel corner `o`.
    fn exact_cone_sign(&mut self, t: u32, corner: Voxel) -> i32 {
        let (a, b, c) = (self.triangle_point(t, 0), self.triangle_point(t, 1), self.triangle_point(t, 2));
        exact::sign_of_cone(a, b, c, self.corner(corner))
    }
}

/// A cell that can be cut, by one lane or many.
pub trait CutStore: Polytope + Lanes {
    /// Cuts by a half-space, as [`clip`] does; `tag` says whose it is.
    fn cut(&mut self, plane: Plane, tag: u32) -> u32;
}

impl<S: ClipStore + SignStore + Lanes> CutStore for S {
    #[inline(always)]
    fn cut(&mut self, plane: Plane, tag: u32) -> u32 {
        clip(self, plane, tag)
    }
}

/// All that the cell of one work-item needs.
pub trait CellStore: ClipStore + SignStore + IntegralStore + DomainStore + Lanes {}

impl<S: ClipStore + SignStore + IntegralStore + DomainStore + Lanes> CellStore for S {}
