//! Where a cell lives on the CPU: its vertices by four, so that one plane meets four at a time.

mod together;
mod walk;

use crate::minors::KeptMinors;
use laguerre_core::cell::{
    CellSums, ClipStore, Corners, DomainStore, FACETS, FacetSecond, FacetSum, IntegralStore, Lanes, MARK_CONFLICT,
    MARK_KEEP, MARK_UNCERTAIN, Minors, Plane, Polytope, Real, SEEN_CONFLICT, SEEN_KEEP, SEEN_UNCERTAIN, SignStore,
    TOGETHER, Triplet, UNIT_ROUNDOFF, V3, v3,
};
use laguerre_core::domain_grid::DomainGrid;
use laguerre_core::integrand::FramedIntegrand;
use laguerre_core::passes::Capacities;
use pulp::Arch;
use std::cell::Cell;
use walk::{Edges, MANY};
use wide::f64x4;

/// Vertices tested at once.
const LANES: usize = 4;

/// Four vertices: positions and error radii. (In one place: of arrays of their own for each number, one vertex took four tests of its index to set.)
#[derive(Clone, Copy, Debug, Default)]
struct Four {
    x: [Real; LANES],
    y: [Real; LANES],
    z: [Real; LANES],
    radius: [Real; LANES],
}

impl Four {
    #[inline(always)]
    fn position(&self, lane: usize) -> V3 {
        v3(self.x[lane], self.y[lane], self.z[lane])
    }

    #[inline(always)]
    fn positions(&self) -> [f64x4; 3] {
        [self.x, self.y, self.z].map(f64x4::from)
    }

    /// Adds the bits of its vertices that are in conflict with a half-space, and of those that are certainly not. (An array of each is what becomes one vector: a
    /// bit mask of four comparisons does not.)
    #[inline(always)]
    fn see(&self, side: &Side, bits: [u64; LANES], conflict: &mut [u64; LANES], kept: &mut [u64; LANES]) {
        let Side { plane: Plane { n, d }, size, slack } = *side;
        for k in 0..LANES {
            let value = (((n.x * self.x[k]) + (n.y * self.y[k])) + (n.z * self.z[k])) + d;
            let bound = (size * self.radius[k]) + slack;
            conflict[k] |= if value < -bound { bits[k] } else { 0 };
            kept[k] |= if value > bound { bits[k] } else { 0 };
        }
    }
}

/// A half-space, for four vertices at a time: with the room for roundings that a vertex's radius and the offset ask for.
struct Side {
    plane: Plane,
    size: Real,
    slack: Real,
}

impl Side {
    #[inline(always)]
    fn of(plane: Plane) -> Self {
        let size = (plane.n.x.abs() + plane.n.y.abs()) + plane.n.z.abs();
        Self { plane, size, slack: (4.0 * UNIT_ROUNDOFF) * plane.d.abs() }
    }
}

/// The bits of four lanes as one.
#[inline(always)]
fn joined([a, b, c, d]: [u64; LANES]) -> u64 {
    (a | b) | (c | d)
}

/// A bit for each of the first four vertices.
const FIRST_BITS: [u64; LANES] = [1, 2, 4, 8];

/// Vertices, padded to whole fours.
#[derive(Clone, Debug, Default)]
struct Vertices {
    places: Vec<Four>,
    triplets: Vec<Triplet>,
    count: usize,
}

impl Vertices {
    fn with_room(room: usize) -> Self {
        Self { places: vec![Four::default(); room.div_ceil(LANES)], triplets: vec![Triplet::default(); room], count: 0 }
    }

    fn copy_from(&mut self, other: &Self) {
        let (n, fours) = (other.count, other.count.div_ceil(LANES));
        self.places[..fours].copy_from_slice(&other.places[..fours]);
        self.triplets[..n].copy_from_slice(&other.triplets[..n]);
        self.count = n;
    }
}

/// A cell's storage, reused from cell to cell.
#[derive(Debug)]
pub(crate) struct CpuStore<'a> {
    room: Capacities,
    planes: Vec<Plane>,
    tags: Vec<u32>,
    /// The numbers, and above them how often bits were turned.
    links: Vec<u64>,
    facets: Vec<FacetSum>,
    /// Empty until they are asked for.
    facet_seconds: Vec<FacetSecond>,
    plane_count: usize,
    vertices: Vertices,
    saved: Vertices,
    /// A bit for each vertex: in conflict with the plane at hand.
    conflict: Vec<u64>,
    /// A bit for each vertex: not decided by floating point.
    uncertain: Vec<u64>,
    /// A bit for each vertex: known to be cut off by no site.
    settled: Vec<u64>,
    minors: KeptMinors,
    edges: Edges,
    corners: Corners,
    /// The instructions that the CPU has.
    arch: Arch,
    domain: Option<&'a DomainGrid>,
    integrand: Option<&'a FramedIntegrand>,
    site: V3,
    /// Whether exact arithmetic was needed for the present cell.
    pub(crate) exact: bool,
    /// Triangles that the present cell has tried, and the last of them: each is tried once, with no other in between.
    triangles: Cell<u32>,
    last_triangle: Cell<Option<u32>>,
}

impl<'a> CpuStore<'a> {
    pub(crate) fn new(room: Capacities, domain: Option<&'a DomainGrid>) -> Self {
        let (p, v) = (room.planes as usize, room.vertices as usize);
        let words = v.div_ceil(64);
        Self {
            room,
            planes: vec![Plane::default(); p],
            tags: vec![0; p],
            links: vec![0; p],
            facets: vec![FacetSum::default(); p],
            facet_seconds: Vec::new(),
            plane_count: 0,
            vertices: Vertices::with_room(v),
            saved: Vertices::with_room(v),
            conflict: vec![0; words],
            uncertain: vec![0; words],
            settled: vec![0; words],
            minors: KeptMinors::with_room(p, v),
            edges: Edges::default(),
            corners: Corners::default(),
            arch: Arch::new(),
            domain,
            integrand: None,
            site: v3(0.0, 0.0, 0.0),
            exact: false,
            triangles: Cell::new(0),
            last_triangle: Cell::new(None),
        }
    }

    /// The same store with a function to be integrated.
    pub(crate) fn with_integrand(self, integrand: Option<&'a FramedIntegrand>) -> Self {
        Self { integrand, ..self }
    }

    /// Turns to the cell of another site.
    pub(crate) fn turn_to(&mut self, site: V3) {
        self.site = site;
        self.exact = false;
        self.minors.turn_to_another();
        self.edges.turn_to_another();
        self.triangles.set(0);
        self.last_triangle.set(None);
    }

    /// Triangles that the present cell has tried.
    pub(crate) fn triangles_tried(&self) -> u32 {
        self.triangles.get()
    }
}

impl Lanes for CpuStore<'_> {}

impl Polytope for CpuStore<'_> {
    #[inline(always)]
    fn cap_p(&self) -> u32 {
        self.room.planes
    }

    #[inline(always)]
    fn cap_v(&self) -> u32 {
        self.room.vertices
    }

    #[inline(always)]
    fn planes(&self) -> u32 {
        self.plane_count as u32
    }

    #[inline(always)]
    fn set_planes(&mut self, count: u32) {
        self.plane_count = count as usize;
    }

    #[inline(always)]
    fn vertices(&self) -> u32 {
        self.vertices.count as u32
    }

    #[inline(always)]
    fn set_vertices(&mut self, count: u32) {
        self.vertices.count = count as usize;
    }

    #[inline(always)]
    fn plane(&self, f: u32) -> Plane {
        self.planes[f as usize]
    }

    #[inline(always)]
    fn set_plane(&mut self, f: u32, plane: Plane) {
        self.planes[f as usize] = plane;
        self.minors.forget_plane(f as usize);
    }

    #[inline(always)]
    fn tag(&self, f: u32) -> u32 {
        self.tags[f as usize]
    }

    #[inline(always)]
    fn set_tag(&mut self, f: u32, tag: u32) {
        self.tags[f as usize] = tag;
    }

    #[inline(always)]
    fn triplet(&self, v: u32) -> Triplet {
        self.vertices.triplets[v as usize]
    }

    #[inline(always)]
    fn set_triplet(&mut self, v: u32, triplet: Triplet) {
        self.vertices.triplets[v as usize] = triplet;
    }

    #[inline(always)]
    fn position(&self, v: u32) -> V3 {
        self.vertices.places[v as usize / LANES].position(v as usize % LANES)
    }

    #[inline(always)]
    fn radius(&self, v: u32) -> Real {
        self.vertices.places[v as usize / LANES].radius[v as usize % LANES]
    }

    #[inline(always)]
    fn set_position(&mut self, v: u32, position: V3, radius: Real) {
        let v = v as usize;
        let (four, lane) = (&mut self.vertices.places[v / LANES], v % LANES);
        (four.x[lane], four.y[lane], four.z[lane]) = (position.x, position.y, position.z);
        four.radius[lane] = radius;
        self.settled[v / 64] &= !(1 << (v % 64));
        self.minors.forget_vertex(v);
    }

    #[inline(always)]
    fn site(&self) -> V3 {
        self.site
    }
}

/// The first bit of some words that is set, from one on; `end` where there is none before that.
#[inline(always)]
fn next_bit(from: u32, end: u32, bits_of: impl Fn(usize) -> u64) -> u32 {
    if from >= end {
        return end;
    }
    let mut word = from as usize / 64;
    let mut bits = bits_of(word) >> (from % 64) << (from % 64);
    while bits == 0 {
        word += 1;
        if word * 64 >= end as usize {
            return end;
        }
        bits = bits_of(word);
    }
    (word as u32 * 64 + bits.trailing_zeros()).min(end)
}

impl CpuStore<'_> {
    /// `mark_conflicts`, vertex by vertex.
    #[inline(always)]
    fn mark_all(&mut self, plane: Plane) -> u32 {
        let side = Side::of(plane);
        let count = self.vertices.count;
        let (mut any_conflict, mut any_uncertain, mut any_keep) = (0, 0, 0);
        let words = self.conflict.iter_mut().zip(self.uncertain.iter_mut());
        for (w, ((conflict_word, uncertain_word), fours)) in
            words.zip(self.vertices.places[..count.div_ceil(LANES)].chunks(64 / LANES)).enumerate()
        {
            let here = (count - w * 64).min(64);
            let (mut conflict, mut kept, mut bits) = ([0; LANES], [0; LANES], FIRST_BITS);
            for four in fours {
                four.see(&side, bits, &mut conflict, &mut kept);
                bits = bits.map(|bit| bit << LANES);
            }
            let (conflict, kept) = (joined(conflict), joined(kept));
            // The padding's lanes hold old numbers.
            let valid = u64::MAX >> (64 - here);
            *conflict_word = conflict & valid;
            *uncertain_word = !(conflict | kept) & valid;
            any_conflict |= *conflict_word;
            any_uncertain |= *uncertain_word;
            any_keep |= kept & valid;
        }
        let seen = |bits: u64, flag: u32| if bits == 0 { 0 } else { flag };
        seen(any_conflict, SEEN_CONFLICT) | seen(any_uncertain, SEEN_UNCERTAIN) | seen(any_keep, SEEN_KEEP)
    }
}

impl ClipStore for CpuStore<'_> {
    #[inline(always)]
    fn instructions(&self) -> Arch {
        self.arch
    }

    #[inline(always)]
    fn begin_at(&mut self, v: u32) {
        self.edges.begin_at(v);
    }

    fn renumber(&mut self, v: u32, triplet: Triplet) {
        self.edges.forget();
        self.set_triplet(v, triplet);
    }

    #[inline(always)]
    fn link(&self, f: u32) -> u32 {
        self.links[f as usize] as u32
    }

    #[inline(always)]
    fn set_link(&mut self, f: u32, link: u32) {
        self.links[f as usize] = u64::from(link);
    }

    #[inline(always)]
    fn toggle_link(&mut self, f: u32, change: u32) {
        let link = &mut self.links[f as usize];
        *link = (*link ^ u64::from(change)) + (1 << 32);
    }

    #[inline(always)]
    fn was_toggled_once(&self, f: u32) -> bool {
        self.links[f as usize] >> 32 == 1
    }

    #[inline(always)]
    fn settled(&self, v: u32) -> bool {
        self.settled[v as usize / 64] >> (v % 64) & 1 != 0
    }

    #[inline(always)]
    fn set_settled(&mut self, v: u32, settled: bool) {
        let word = &mut self.settled[v as usize / 64];
        *word = (*word & !(1 << (v % 64))) | u64::from(settled) << (v % 64);
    }

    #[inline(always)]
    fn next_open(&self, v: u32) -> u32 {
        next_bit(v, self.vertices(), |word| !self.settled[word])
    }

    #[inline(always)]
    fn mark(&self, v: u32) -> u32 {
        let (word, bit) = (v as usize / 64, v % 64);
        if self.conflict[word] >> bit & 1 != 0 {
            MARK_CONFLICT
        } else if self.uncertain[word] >> bit & 1 != 0 {
            MARK_UNCERTAIN
        } else {
            MARK_KEEP
        }
    }

    #[inline(always)]
    fn set_mark(&mut self, v: u32, mark: u32) {
        let (word, bit) = (v as usize / 64, v % 64);
        let set = |bits: &mut u64, on: bool| *bits = (*bits & !(1 << bit)) | u64::from(on) << bit;
        set(&mut self.conflict[word], mark == MARK_CONFLICT);
        set(&mut self.uncertain[word], mark == MARK_UNCERTAIN);
    }

    #[inline(always)]
    fn save(&mut self) {
        self.saved.copy_from(&self.vertices);
    }

    #[inline(always)]
    fn restore(&mut self) {
        self.vertices.copy_from(&self.saved);
        self.minors.forget_vertices();
        self.edges.forget();
    }

    #[inline(always)]
    fn next_conflict(&self, from: u32, end: u32) -> u32 {
        next_bit(from, end, |word| self.conflict[word])
    }

    #[inline(always)]
    fn mark_conflicts(&mut self, k: u32) -> u32 {
        let plane = self.planes[k as usize];
        if self.vertices.count >= MANY { self.mark_of_many(k, plane) } else { self.mark_all(plane) }
    }

    /// (By the first four.)
    #[inline(always)]
    fn keeps_some(&self, plane: Plane) -> bool {
        let valid = u64::MAX >> (64 - self.vertices.count.clamp(1, LANES));
        let (mut conflict, mut kept) = ([0; LANES], [0; LANES]);
        self.vertices.places[0].see(&Side::of(plane), FIRST_BITS, &mut conflict, &mut kept);
        joined(kept) & valid != 0
    }

    #[inline(always)]
    fn may_be_cut_by(&self, planes: &[[Real; TOGETHER]; 4]) -> u8 {
        self.together(planes)
    }

    #[inline(always)]
    fn farthest_from(&self, center: V3) -> V3 {
        let (mut square, mut radius) = (f64x4::splat(0.0), f64x4::splat(0.0));
        let (cx, cy, cz) = (f64x4::splat(center.x), f64x4::splat(center.y), f64x4::splat(center.z));
        let (whole, rest) = (self.vertices.count / LANES, self.vertices.count % LANES);
        for four in &self.vertices.places[..whole] {
            let [x, y, z] = four.positions();
            let (x, y, z) = (x - cx, y - cy, z - cz);
            square = square.fast_max(((x * x) + (y * y)) + (z * z));
            radius = radius.fast_max(f64x4::from(four.radius));
        }
        let largest = |lanes: f64x4| lanes.to_array().into_iter().fold(0.0, Real::max);
        let (mut square, mut radius) = (largest(square), largest(radius));
        if let Some(four) = self.vertices.places.get(whole) {
            for lane in 0..rest {
                let p = four.position(lane);
                let (x, y, z) = (p.x - center.x, p.y - center.y, p.z - center.z);
                square = square.max(((x * x) + (y * y)) + (z * z));
                radius = radius.max(four.radius[lane]);
            }
        }
        v3(square, radius, 0.0)
    }
}

impl SignStore for CpuStore<'_> {
    #[inline(always)]
    fn keeps_minors(&self) -> bool {
        true
    }

    #[inline(always)]
    fn minors(&self, v: u32) -> Minors {
        self.minors.wide(v as usize)
    }

    #[inline(always)]
    fn keep_minors(&mut self, v: u32, minors: Minors) {
        self.minors.keep_wide(v as usize, minors);
    }

    #[inline(always)]
    fn narrow_sign(&mut self, t: Triplet, v: u32, k: u32) -> i32 {
        // (The plane that is tried may stand behind the others.)
        let planes = &self.planes[..self.plane_count.max(k as usize + 1)];
        self.minors.narrow_sign(planes, v as usize, t, k as usize)
    }

    #[inline(always)]
    fn note_exact(&mut self) {
        self.exact = true;
    }
}

impl IntegralStore for CpuStore<'_> {
    #[inline(always)]
    fn facet(&self, f: u32) -> FacetSum {
        self.facets[f as usize]
    }

    #[inline(always)]
    fn set_facet(&mut self, f: u32, sum: FacetSum) {
        self.facets[f as usize] = sum;
    }

    #[inline(always)]
    fn prepare_corners(&mut self, weight: Real, center: V3, reach: Real, flags: u32) {
        let mut corners = std::mem::take(&mut self.corners);
        corners.set(self, weight, center, reach, flags);
        self.corners = corners;
    }

    #[inline(always)]
    fn add_corner(&mut self, v: u32, distance: Real, flags: u32, part: &mut CellSums) -> bool {
        let t = self.vertices.triplets[v as usize];
        let is_there = self.corners.add(v, distance, part);
        if is_there && flags & FACETS != 0 {
            self.corners.add_facets(v, t, &mut self.facets);
        }
        is_there
    }

    #[inline(always)]
    fn facet_second(&self, f: u32) -> FacetSecond {
        self.facet_seconds.get(f as usize).copied().unwrap_or_default()
    }

    #[inline(always)]
    fn set_facet_second(&mut self, f: u32, second: FacetSecond) {
        if self.facet_seconds.is_empty() {
            self.facet_seconds = vec![FacetSecond::default(); self.facets.len()];
        }
        self.facet_seconds[f as usize] = second;
    }

    #[inline(always)]
    fn integrand(&self) -> Option<&FramedIntegrand> {
        self.integrand
    }
}

impl DomainStore for CpuStore<'_> {
    #[inline(always)]
    fn domain(&self) -> Option<&DomainGrid> {
        self.domain
    }

    #[inline(always)]
    fn note_tried(&self, t: u32) {
        if self.last_triangle.replace(Some(t)) != Some(t) {
            self.triangles.set(self.triangles.get() + 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use laguerre_core::cell::{
        COMPLETE, PlainStore, SECOND_MOMENTS, VOLUME_ONLY, begin, bisector, clip, integrate_cell,
    };

    /// The doors for SIMD do what their plain bodies do, to the bit, at every count of vertices.
    #[test]
    fn doors_agree_with_their_plain_bodies() {
        let room = Capacities { planes: 200, vertices: 400 };
        let mut fast = CpuStore::new(room, None);
        let mut plain = PlainStore::new([0.0; 3], None);
        let (lo, hi) = (v3(-0.5, -0.4, -0.3), v3(0.3, 0.4, 0.5));
        assert_eq!(begin(&mut fast, lo, hi), begin(&mut plain, lo, hi));
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        for i in 0..150 {
            let z = 1.0 - f64::from(2 * i + 1) / 150.0;
            let (sin, cos) = (golden * f64::from(i)).sin_cos();
            let r = 0.4 * (1.0 - z * z).sqrt();
            let plane = bisector(v3(r * cos, r * sin, 0.4 * z), 0.0);
            assert_eq!(clip(&mut fast, plane, 0), clip(&mut plain, plane, 0));
            let k = plane_through_a_vertex(&mut fast, &mut plain);
            assert_eq!(fast.mark_conflicts(k), plain.mark_conflicts(k));
            let count = plain.vertices();
            assert_eq!(fast.vertices(), count);
            for v in 0..count {
                assert_eq!(fast.mark(v), plain.mark(v), "vertex {v} of {count}");
                assert_eq!(fast.next_conflict(v, count), plain.next_conflict(v, count));
            }
            // All settled but some, among which is none or is the last.
            for v in 0..count {
                let is_settled = v % (i as u32 + 2) != 1;
                fast.set_settled(v, is_settled);
                plain.set_settled(v, is_settled);
            }
            for v in 0..=count {
                assert_eq!(fast.next_open(v), plain.next_open(v), "vertex {v} of {count}");
            }
            assert_eq!(fast.farthest(), plain.farthest());
            let center = v3(0.1, -0.7, 0.4);
            assert_eq!(fast.farthest_from(center), plain.farthest_from(center));
            // The tetrahedra of several vertices at once: those of thin facets are not among them.
            for flags in [VOLUME_ONLY, FACETS, SECOND_MOMENTS] {
                let mut sums = [CellSums::default(); 2];
                assert_eq!(integrate_cell(&mut fast, flags, 0, &mut sums[0]), COMPLETE);
                assert_eq!(integrate_cell(&mut plain, flags, 0, &mut sums[1]), COMPLETE);
                assert_eq!(sums[0], sums[1]);
            }
        }
        assert!(fast.vertices() > 200);
    }

    /// A plane with vertices on both sides and one on it, in the slot after the last.
    fn plane_through_a_vertex(fast: &mut CpuStore<'_>, plain: &mut PlainStore<'_>) -> u32 {
        let k = plain.planes();
        let p = plain.position(plain.vertices() / 2);
        let n = v3(0.3, -0.7, 0.2);
        let plane = Plane { n, d: -((n.x * p.x) + (n.y * p.y) + (n.z * p.z)) };
        fast.set_plane(k, plane);
        plain.set_plane(k, plane);
        k
    }
}
