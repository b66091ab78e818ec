//! What the dialect's search (`core/src/cell/far.rs`) reads and keeps, on the host: one lane, which looks at eight nodes or sites in one go.

mod look;

use super::one_cell::{Cell, reach_from, rounding_about};
use super::{Candidate, Reaches, gather, in_order, visit_all};
use crate::cell::search::Vantage;
use crate::cell::search_store::{
    Asked, MOST_LEAVES, MOST_OPEN, NO_SITE, NodeBox, NodeSlab, NodeWeights, OctreeNode, OctreeStore, SearchStore,
};
use crate::cell::{self, COMPLETE, CUT, CellStore, EMPTY, Lanes, Real, Rough, UNIT_ROUNDOFF, UNTOUCHED, V3, v3};
use crate::power_octree::PowerOctree;
use crate::site_tree::{SiteTree, WIDTH};
use look::{Look, Measure, Take};
use pulp::Arch;
use std::collections::HashSet;

/// Leaves that an octree lists for a box at most: all may be at hand.
pub(super) const MOST_LISTED: usize = MOST_LEAVES as usize - 1;

/// Vertices that one descent asks for at most.
pub(super) const MOST_ASKED: usize = 8;

/// A block of the tree or a leaf that is still to be looked at: its number, its key, its vertices.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    number: u32,
    key: u32,
    asks: u32,
}

/// What a search keeps from cell to cell: room.
#[derive(Debug)]
pub(super) struct Room {
    open: [Entry; MOST_OPEN as usize],
    leaves: [Entry; MOST_LEAVES as usize],
    candidates: Vec<[u32; 2]>,
    asked: [Asked; MOST_ASKED],
    /// Of the eight nodes or sites that are looked at, the asked vertices where a power may be below the limit, and the key of the least of these powers.
    asks: [u32; WIDTH],
    keys: [u32; WIDTH],
    /// Sites that the cell was tried with: what was tried once cannot cut what is left. (Of sites on a sphere all tie at many vertices of each.)
    tried: HashSet<u32>,
    /// What leaves at hand have of sites that may cut the cell, and these.
    listed: Vec<u32>,
    reaches: Vec<Reaches>,
    reaching: Vec<Candidate>,
    /// Blocks that were looked at.
    opened: u32,
    /// The instructions that the CPU has.
    arch: Arch,
}

impl Default for Room {
    fn default() -> Self {
        Self {
            open: [Entry::default(); MOST_OPEN as usize],
            leaves: [Entry::default(); MOST_LEAVES as usize],
            candidates: Vec::new(),
            asked: [Asked::default(); MOST_ASKED],
            asks: [0; WIDTH],
            keys: [0; WIDTH],
            tried: HashSet::new(),
            listed: Vec::new(),
            reaches: Vec::new(),
            reaching: Vec::new(),
            opened: 0,
            arch: Arch::new(),
        }
    }
}

impl Room {
    /// How many blocks of nodes were looked at for the last cell.
    pub(super) fn opened(&self) -> u32 {
        self.opened
    }
}

/// A cell that is searched.
pub(super) struct Searched<'c, 'a, S> {
    cell: &'c mut Cell<'a, S>,
    tree: &'c SiteTree,
    octree: Option<&'c PowerOctree>,
    room: &'c mut Room,
    /// Whether it is known how far the cell reaches: those that ask for vertices do not need it. (For the 22,000 vertices of a heavy site's cell a fifth of its time.)
    is_measured: bool,
    /// As on devices (`is_swept`).
    #[cfg(test)]
    pub(super) is_swept: bool,
}

impl<'c, 'a, S: CellStore> Searched<'c, 'a, S> {
    /// The cell, of whose vertices those within a radius of its centre are settled: within which it is proven that nothing can cut it.
    pub(super) fn new(
        cell: &'c mut Cell<'a, S>,
        tree: &'c SiteTree,
        octree: Option<&'c PowerOctree>,
        room: &'c mut Room,
        proven: Real,
    ) -> Self {
        room.tried.clear();
        room.opened = 0;
        let Cell { store, center, .. } = &mut *cell;
        for v in 0..store.vertices() {
            let p = store.position(v);
            let away = super::norm(v3(p.x - center.x, p.y - center.y, p.z - center.z));
            // At 0 nothing is proven; a vertex may be at the centre. (Nothing cuts within the radius later, so no later vertex is there.)
            let is_proven = proven > 0.0 && (away + 2.0 * store.radius(v)) * super::SAFE <= proven;
            store.set_settled(v, is_proven);
        }
        Self {
            cell,
            tree,
            octree,
            room,
            is_measured: true,
            #[cfg(test)]
            is_swept: false,
        }
    }

    #[inline(always)]
    fn own(&self) -> V3 {
        let [x, y, z] = self.cell.position;
        v3(x, y, z)
    }

    /// A slab about the sites of node `k` of a block.
    #[inline(always)]
    fn slab(&self, block: usize, k: usize) -> NodeSlab {
        let slabs = self.tree.slabs(block);
        NodeSlab { normal: along(&slabs.normal, k), lo: slabs.lo[k], hi: slabs.hi[k], largest: slabs.largest_weight[k] }
    }

    /// The box of its sites.
    #[inline(always)]
    fn boxed(&self, block: usize, k: usize) -> NodeBox {
        let boxes = self.tree.boxes(block);
        NodeBox { lo: along(&boxes.lo, k), hi: along(&boxes.hi, k) }
    }

    /// What bounds their weights.
    #[inline(always)]
    fn weights(&self, block: usize, k: usize) -> NodeWeights {
        let bounds = self.tree.weights(block);
        NodeWeights { offset: bounds.c[k], slope: along(&bounds.g, k), curvature: along(&bounds.q, k) }
    }

    /// The block of a node of the tree, and its number there.
    fn block(&self, level: u32, node: u32) -> (usize, usize) {
        (self.tree.level_begin(level as usize) + node as usize / WIDTH, node as usize % WIDTH)
    }
}

#[inline(always)]
fn along(axes: &[[Real; WIDTH]; 3], k: usize) -> V3 {
    v3(axes[0][k], axes[1][k], axes[2][k])
}

impl<S: CellStore> Lanes for Searched<'_, '_, S> {}

/// (That of a search that has one.)
impl<S: CellStore> OctreeStore for Searched<'_, '_, S> {
    #[inline(always)]
    fn octree_lo(&self) -> V3 {
        self.octree.map_or(V3::default(), OctreeStore::octree_lo)
    }
    #[inline(always)]
    fn octree_hi(&self) -> V3 {
        self.octree.map_or(V3::default(), OctreeStore::octree_hi)
    }
    #[inline(always)]
    fn octree_off(&self) -> Real {
        self.octree.map_or(0.0, OctreeStore::octree_off)
    }
    #[inline(always)]
    fn octree_node(&self, i: u32) -> OctreeNode {
        self.octree.map_or(OctreeNode::default(), |octree| octree.octree_node(i))
    }
    #[inline(always)]
    fn octree_leaf(&self, i: u32) -> u32 {
        self.octree.map_or(0, |octree| octree.octree_leaf(i))
    }
}

impl<S: CellStore> SearchStore for Searched<'_, '_, S> {
    fn key_below(&self, x: Real) -> u32 {
        in_order(x)
    }
    fn key_above(&self, x: Real) -> u32 {
        in_order(x) + 1
    }

    #[cfg(test)]
    fn is_swept(&self) -> bool {
        self.is_swept
    }

    fn sites(&self) -> u32 {
        self.tree.len() as u32
    }
    fn own_site(&self) -> u32 {
        self.cell.site
    }
    fn site(&self) -> V3 {
        self.own()
    }
    fn way_to(&self, j: u32) -> V3 {
        self.cell.difference(self.tree.site(j)).0
    }
    fn excess_of(&self, j: u32) -> Real {
        self.cell.difference(self.tree.site(j)).1
    }
    // (What this answers is asked in tests alone.)
    fn leaves_if_far(&self) -> u32 {
        4
    }
    fn own_excess(&self) -> Real {
        self.cell.weight - self.tree.base_weight()
    }
    fn largest_excess(&self) -> Real {
        self.tree.largest_weight() - self.cell.weight
    }
    fn has_weights(&self) -> bool {
        self.tree.has_weights()
    }

    fn top_level(&self) -> u32 {
        self.tree.top_level() as u32
    }
    fn node_box(&self, level: u32, node: u32) -> NodeBox {
        let (block, k) = self.block(level, node);
        self.boxed(block, k)
    }
    fn node_weights(&self, level: u32, node: u32) -> NodeWeights {
        if !self.tree.has_weights() {
            return NodeWeights::default();
        }
        let (block, k) = self.block(level, node);
        self.weights(block, k)
    }
    fn node_slab(&self, level: u32, node: u32) -> NodeSlab {
        let (block, k) = self.block(level, node);
        self.slab(block, k)
    }
    #[inline(always)]
    fn asks_of_node(&mut self, level: u32, node: u32, asks: u32, key: &mut u32) -> u32 {
        let (block, k) = self.block(level, node);
        if k == 0 {
            let arch = self.room.arch;
            arch.dispatch(Look::<S, false> { search: self, number: block, asks });
        }
        *key = self.room.keys[k];
        self.room.asks[k]
    }
    #[inline(always)]
    fn asks_of_site(&mut self, j: u32, asks: u32) -> u32 {
        let (leaf, k) = (j as usize / WIDTH, j as usize % WIDTH);
        if k == 0 {
            let arch = self.room.arch;
            arch.dispatch(Look::<S, true> { search: self, number: leaf, asks });
        }
        self.room.asks[k]
    }

    #[inline(always)]
    fn set_listed_leaves(&mut self, asks: u32) -> u32 {
        let Some(octree) = self.octree.filter(|_| asks == 1) else { return 0 };
        let (Asked { place, radius, .. }, own) = (self.room.asked[0], self.own());
        let at = v3(own.x + place.x, own.y + place.y, own.z + place.z);
        let rounding = UNIT_ROUNDOFF * ((at.x.abs() + at.y.abs()) + at.z.abs());
        let leaves = octree.leaves_at(at, radius + rounding);
        let arch = self.room.arch;
        arch.dispatch(Take { search: self, leaves, asks })
    }

    /// All of them, nearest first.
    fn visit_leaves(&mut self, _vantage: Vantage, leaves: u32, is_home: bool, _visited: &mut u32) -> u32 {
        self.room.listed.clear();
        self.room.listed.extend(self.room.leaves[..leaves as usize].iter().map(|leaf| leaf.number));
        let arch = self.room.arch;
        arch.dispatch(Measure { search: self, is_container: is_home });
        let Self { cell, tree, room, .. } = self;
        if !self.is_measured {
            cell.measure();
            self.is_measured = true;
        }
        let reaching = gather(&room.listed, &room.reaches, Real::NEG_INFINITY, cell.reach_square, &mut room.reaching);
        match visit_all::<S, true>(tree, cell, reaching, Real::INFINITY, true) {
            true => UNTOUCHED,
            false => cell.outcome.status,
        }
    }

    fn open_block(&self, i: u32) -> u32 {
        self.room.open[i as usize].number
    }
    fn open_key(&self, i: u32) -> u32 {
        self.room.open[i as usize].key
    }
    fn open_asks(&self, i: u32) -> u32 {
        self.room.open[i as usize].asks
    }
    fn set_open_block(&mut self, i: u32, number: u32, key: u32, asks: u32) {
        self.room.open[i as usize] = Entry { number, key, asks };
    }
    fn leaf(&self, i: u32) -> u32 {
        self.room.leaves[i as usize].number
    }
    fn leaf_key(&self, i: u32) -> u32 {
        self.room.leaves[i as usize].key
    }
    fn leaf_asks(&self, i: u32) -> u32 {
        self.room.leaves[i as usize].asks
    }
    fn set_leaf(&mut self, i: u32, number: u32, key: u32, asks: u32) {
        self.room.leaves[i as usize] = Entry { number, key, asks };
    }
    fn candidate(&self, i: u32) -> u32 {
        self.room.candidates[i as usize][0]
    }
    fn candidate_key(&self, i: u32) -> u32 {
        self.room.candidates[i as usize][1]
    }
    fn set_candidate(&mut self, i: u32, site: u32, key: u32) {
        let i = i as usize;
        if i >= self.room.candidates.len() {
            self.room.candidates.resize(i + 1, [0; 2]);
        }
        self.room.candidates[i] = [site, key];
    }
    fn most_ties(&self) -> u32 {
        NO_SITE - 1
    }

    fn most_asked(&self) -> u32 {
        // (One at a time, they are looked up; together, two clusters with weights of transport took five times as long, for a few boxes that list none.)
        if self.octree.is_some() { 1 } else { MOST_ASKED as u32 }
    }
    fn asked(&self, i: u32) -> Asked {
        self.room.asked[i as usize]
    }
    fn set_asked(&mut self, i: u32, asked: Asked) {
        self.room.asked[i as usize] = asked;
    }

    fn has_domain(&self) -> bool {
        self.cell.store.has_domain()
    }
    fn square_of_reach(&self, center: V3) -> Rough {
        let far = reach_from(self.cell.store, center, rounding_about(center));
        4.0 * (far * far * super::SAFE)
    }
    fn key_of_reach(&self, square: Rough) -> u32 {
        self.key_above(square * super::SAFE)
    }
    fn cut_by(&mut self, j: u32) -> u32 {
        self.room.tried.insert(j);
        self.cell.store.begin_at(self.room.asked[0].vertex);
        let status = self.cell.cut(self.tree.site(j), j);
        self.is_measured &= status != CUT;
        status
    }
    fn cut_outside(&mut self, radius: Real) -> u32 {
        if cell::lies_outside(self.cell.store) {
            return EMPTY;
        }
        cell::cap_outside(self.cell.store, radius)
    }
    fn vertices(&self) -> u32 {
        self.cell.store.vertices()
    }
    fn position(&self, v: u32) -> V3 {
        self.cell.store.position(v)
    }
    fn radius(&self, v: u32) -> Real {
        self.cell.store.radius(v)
    }
    fn fine_position(&self, v: u32, position: &mut V3, radius: &mut Real) -> u32 {
        (*position, *radius) = (self.cell.store.position(v), self.cell.store.radius(v));
        COMPLETE
    }
    fn settled(&self, v: u32) -> bool {
        self.cell.store.settled(v)
    }
    fn set_settled(&mut self, v: u32, settled: bool) {
        self.cell.store.set_settled(v, settled);
    }
    #[inline(always)]
    fn next_open(&self, v: u32) -> u32 {
        self.cell.store.next_open(v)
    }
    fn touches(&self, v: u32, j: u32) -> bool {
        let t = self.cell.store.triplet(v);
        [t.a, t.b, t.c].iter().any(|&f| self.cell.store.tag(f) == j)
    }
    fn was_tried(&self, j: u32) -> bool {
        self.room.tried.contains(&j) || self.cell.is_cut_by(j)
    }
    fn leaves_out(&self) -> bool {
        self.cell.enlarged.is_some()
    }
}
