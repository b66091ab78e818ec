//! The plain store.

use super::facet::{FacetSecond, FacetSum};
use super::lanes::Lanes;
use super::plane::Plane;
use super::store::{ClipStore, DomainStore, IntegralStore, Polytope, SignStore};
use super::vector::{Real, V3};
use super::vertex::Triplet;
use crate::domain_grid::DomainGrid;
use crate::integrand::FramedIntegrand;
use std::cell::Cell;

/// The plain store: growing arrays of structs, no capacities but `u32`. Slow and obvious; for tests, for the oracle, to count what a cell needs, and
/// where devices' cells are asked for their geometry.
#[derive(Clone, Debug, Default)]
pub struct PlainStore<'a> {
    /// Each with its tag, its scratch number and above that how often bits of it were turned, and its facet.
    planes: Vec<(Plane, u32, u64, FacetSum)>,
    plane_count: usize,
    vertices: Vec<PlainVertex>,
    vertex_count: usize,
    saved: Vec<PlainVertex>,
    /// None where none were set.
    facet_seconds: Vec<FacetSecond>,
    domain: Option<&'a DomainGrid>,
    integrand: Option<&'a FramedIntegrand>,
    site: V3,
    room: Option<(u32, u32)>,
    most_planes: u32,
    most_vertices: u32,
    triangles: Cell<u32>,
    last_triangle: Cell<Option<u32>>,
}

#[derive(Clone, Copy, Debug, Default)]
struct PlainVertex {
    triplet: Triplet,
    position: V3,
    radius: Real,
    mark: u32,
    settled: bool,
}

impl<'a> PlainStore<'a> {
    /// An empty store for the cell of `site` (in the diagram's frame).
    pub fn new(site: [f64; 3], domain: Option<&'a DomainGrid>) -> Self {
        let [x, y, z] = site;
        Self { domain, site: V3 { x, y, z }, ..Self::default() }
    }

    /// The same store with room for so many half-spaces and vertices only.
    #[must_use]
    pub fn with_room(self, planes: u32, vertices: u32) -> Self {
        Self { room: Some((planes, vertices)), ..self }
    }

    /// The same store with a function to be integrated.
    #[must_use]
    pub fn with_integrand(self, integrand: Option<&'a FramedIntegrand>) -> Self {
        Self { integrand, ..self }
    }

    /// The most half-spaces that the cell has had at once, with the one being added and without those that no vertex lies on.
    pub fn most_planes(&self) -> u32 {
        self.most_planes
    }

    /// The most vertices that the cell has had at once.
    pub fn most_vertices(&self) -> u32 {
        self.most_vertices
    }

    /// Triangles that were asked for so far; a row of questions about one counts once.
    pub fn triangles_tried(&self) -> u32 {
        self.triangles.get()
    }

    /// Whether the cell was to be cut by cones.
    pub fn was_saved(&self) -> bool {
        !self.saved.is_empty()
    }

    fn plane_slot(&mut self, f: u32) -> &mut (Plane, u32, u64, FacetSum) {
        let f = f as usize;
        if f >= self.planes.len() {
            self.planes.resize(f + 1, Default::default());
        }
        &mut self.planes[f]
    }

    fn vertex_slot(&mut self, v: u32) -> &mut PlainVertex {
        let v = v as usize;
        if v >= self.vertices.len() {
            self.vertices.resize(v + 1, PlainVertex::default());
        }
        &mut self.vertices[v]
    }
}

impl Polytope for PlainStore<'_> {
    fn cap_p(&self) -> u32 {
        self.room.map_or(u32::MAX >> 4, |room| room.0)
    }
    fn cap_v(&self) -> u32 {
        self.room.map_or(u32::MAX >> 4, |room| room.1)
    }
    fn planes(&self) -> u32 {
        self.plane_count as u32
    }
    fn set_planes(&mut self, count: u32) {
        self.plane_count = count as usize;
    }
    fn vertices(&self) -> u32 {
        self.vertex_count as u32
    }
    fn set_vertices(&mut self, count: u32) {
        self.vertex_count = count as usize;
        self.most_vertices = self.most_vertices.max(count);
    }
    fn plane(&self, f: u32) -> Plane {
        self.planes[f as usize].0
    }
    fn set_plane(&mut self, f: u32, plane: Plane) {
        if f == self.planes() {
            // The cell is simple: of v vertices and v/2 + 2 faces.
            self.most_planes = self.most_planes.max(self.vertices() / 2 + 2 + 1);
        }
        self.plane_slot(f).0 = plane;
    }
    fn tag(&self, f: u32) -> u32 {
        self.planes[f as usize].1
    }
    fn set_tag(&mut self, f: u32, tag: u32) {
        self.plane_slot(f).1 = tag;
    }
    fn triplet(&self, v: u32) -> Triplet {
        self.vertices[v as usize].triplet
    }
    fn set_triplet(&mut self, v: u32, triplet: Triplet) {
        self.vertex_slot(v).triplet = triplet;
    }
    fn position(&self, v: u32) -> V3 {
        self.vertices[v as usize].position
    }
    fn radius(&self, v: u32) -> Real {
        self.vertices[v as usize].radius
    }
    fn set_position(&mut self, v: u32, position: V3, radius: Real) {
        let slot = self.vertex_slot(v);
        slot.position = position;
        slot.radius = radius;
        slot.settled = false;
    }
    fn site(&self) -> V3 {
        self.site
    }
}

impl ClipStore for PlainStore<'_> {
    fn link(&self, f: u32) -> u32 {
        self.planes[f as usize].2 as u32
    }
    fn set_link(&mut self, f: u32, link: u32) {
        self.plane_slot(f).2 = u64::from(link);
    }
    fn toggle_link(&mut self, f: u32, change: u32) {
        let link = &mut self.plane_slot(f).2;
        *link = (*link ^ u64::from(change)) + (1 << 32);
    }
    fn was_toggled_once(&self, f: u32) -> bool {
        self.planes[f as usize].2 >> 32 == 1
    }
    fn settled(&self, v: u32) -> bool {
        self.vertices[v as usize].settled
    }
    fn set_settled(&mut self, v: u32, settled: bool) {
        self.vertex_slot(v).settled = settled;
    }
    fn mark(&self, v: u32) -> u32 {
        self.vertices[v as usize].mark
    }
    fn set_mark(&mut self, v: u32, mark: u32) {
        self.vertex_slot(v).mark = mark;
    }
    fn save(&mut self) {
        self.saved.clear();
        self.saved.extend_from_slice(&self.vertices[..self.vertex_count]);
    }
    fn restore(&mut self) {
        self.vertices.clone_from(&self.saved);
        self.vertex_count = self.saved.len();
    }
}

impl SignStore for PlainStore<'_> {}

impl Lanes for PlainStore<'_> {}

impl IntegralStore for PlainStore<'_> {
    fn facet(&self, f: u32) -> FacetSum {
        self.planes[f as usize].3
    }
    fn set_facet(&mut self, f: u32, sum: FacetSum) {
        self.plane_slot(f).3 = sum;
    }
    fn facet_second(&self, f: u32) -> FacetSecond {
        self.facet_seconds.get(f as usize).copied().unwrap_or_default()
    }
    fn set_facet_second(&mut self, f: u32, second: FacetSecond) {
        let f = f as usize;
        if f >= self.facet_seconds.len() {
            self.facet_seconds.resize(f + 1, FacetSecond::default());
        }
        self.facet_seconds[f] = second;
    }
    fn integrand(&self) -> Option<&FramedIntegrand> {
        self.integrand
    }
}

impl DomainStore for PlainStore<'_> {
    fn domain(&self) -> Option<&DomainGrid> {
        self.domain
    }
    fn note_tried(&self, t: u32) {
        if self.last_triangle.replace(Some(t)) != Some(t) {
            self.triangles.set(self.triangles.get() + 1);
        }
    }
}
