//! The search by one lane, over a plain store: for tests.

use super::plane::bisector;
use super::search_store::{
    MOST_CANDIDATES, MOST_LEAVES, MOST_OPEN, NodeBox, NodeSlab, NodeWeights, SearchStore, WIDTH,
};
use super::security::SAFE;
use super::store::CellStore;
use super::vector::{Real, UNIT_ROUNDOFF, V3, dot, v3};
use super::{COMPLETE, EMPTY, PlainStore, cap_outside, clip, lies_outside};
use crate::site_tree::SiteTree;

/// What a plain store searches.
#[derive(Clone, Debug)]
pub(super) struct PlainSearch<'a> {
    tree: &'a SiteTree,
    site: u32,
    open: Vec<[u32; 2]>,
    leaves: Vec<[u32; 2]>,
    candidates: Vec<[u32; 2]>,
}

impl<'a> PlainSearch<'a> {
    /// For the cell of sorted site `site`.
    pub(super) fn new(tree: &'a SiteTree, site: u32) -> Self {
        Self {
            tree,
            site,
            open: vec![[0; 2]; MOST_OPEN as usize],
            leaves: vec![[0; 2]; MOST_LEAVES as usize],
            candidates: vec![[0; 2]; MOST_CANDIDATES as usize],
        }
    }
}

impl PlainStore<'_> {
    fn search(&self) -> &PlainSearch<'_> {
        self.search.as_ref().expect("a store that searches")
    }

    fn tree(&self) -> &SiteTree {
        self.search().tree
    }

    fn own(&self) -> [f64; 4] {
        self.tree().site(self.search().site)
    }

    /// The block of a node of the tree, and its number there.
    fn block(&self, level: u32, node: u32) -> (usize, usize) {
        let width = WIDTH as usize;
        (self.tree().level_begin(level as usize) + node as usize / width, node as usize % width)
    }
}

fn along(axes: &[[f64; 8]; 3], k: usize) -> V3 {
    v3(axes[0][k], axes[1][k], axes[2][k])
}

/// A number's upper bits in the order of numbers.
fn in_order(x: Real) -> u32 {
    let bits = (x.to_bits() >> 32) as u32;
    bits ^ (((bits as i32 >> 31) as u32) | 1 << 31)
}

impl SearchStore for PlainStore<'_> {
    fn lanes(&self) -> u32 {
        1
    }
    fn lane(&self) -> u32 {
        0
    }
    fn lanes_with(&self, bit: u32) -> u32 {
        u32::from(bit != 0)
    }
    fn count_of(&self, lanes: u32) -> u32 {
        lanes.count_ones()
    }
    fn rank_in(&self, _: u32) -> u32 {
        0
    }
    fn first_of(&self, _: u32) -> u32 {
        0
    }
    fn least_of_lanes(&self, x: u32) -> u32 {
        x
    }
    fn lane_value(&self, x: u32, _: u32) -> u32 {
        x
    }
    fn lane_real(&self, x: Real, _: u32) -> Real {
        x
    }
    fn lanes_wait(&self) {}

    fn key_below(&self, x: Real) -> u32 {
        in_order(x)
    }
    fn key_above(&self, x: Real) -> u32 {
        in_order(x) + 1
    }

    fn sites(&self) -> u32 {
        self.tree().len() as u32
    }
    fn own_site(&self) -> u32 {
        self.search().site
    }
    fn way_to(&self, j: u32) -> V3 {
        let ([x, y, z, _], [px, py, pz, _]) = (self.tree().site(j), self.own());
        v3(x - px, y - py, z - pz)
    }
    fn excess_of(&self, j: u32) -> Real {
        self.tree().site(j)[3] - self.own()[3]
    }
    fn own_excess(&self) -> Real {
        self.own()[3] - self.tree().base_weight()
    }
    fn largest_excess(&self) -> Real {
        self.tree().largest_weight() - self.own()[3]
    }
    fn has_weights(&self) -> u32 {
        u32::from(self.tree().has_weights())
    }

    fn top_level(&self) -> u32 {
        self.tree().top_level() as u32
    }
    fn node_box(&self, level: u32, node: u32) -> NodeBox {
        let (block, k) = self.block(level, node);
        let boxes = self.tree().boxes(block);
        NodeBox { lo: along(&boxes.lo, k), hi: along(&boxes.hi, k) }
    }
    fn node_weights(&self, level: u32, node: u32) -> NodeWeights {
        let (block, k) = self.block(level, node);
        let bounds = self.tree().weights(block);
        NodeWeights { offset: bounds.c[k], slope: along(&bounds.g, k), curvature: along(&bounds.q, k) }
    }
    fn node_slab(&self, level: u32, node: u32) -> NodeSlab {
        let (block, k) = self.block(level, node);
        let slabs = self.tree().slabs(block);
        NodeSlab { normal: along(&slabs.normal, k), lo: slabs.lo[k], hi: slabs.hi[k], largest: slabs.largest_weight[k] }
    }

    fn open_block(&self, i: u32) -> u32 {
        self.search().open[i as usize][0]
    }
    fn open_key(&self, i: u32) -> u32 {
        self.search().open[i as usize][1]
    }
    fn set_open_block(&mut self, i: u32, block: u32, key: u32) {
        if let Some(search) = &mut self.search {
            search.open[i as usize] = [block, key];
        }
    }
    fn leaf(&self, i: u32) -> u32 {
        self.search().leaves[i as usize][0]
    }
    fn leaf_key(&self, i: u32) -> u32 {
        self.search().leaves[i as usize][1]
    }
    fn set_leaf(&mut self, i: u32, leaf: u32, key: u32) {
        if let Some(search) = &mut self.search {
            search.leaves[i as usize] = [leaf, key];
        }
    }
    fn candidate(&self, i: u32) -> u32 {
        self.search().candidates[i as usize][0]
    }
    fn candidate_key(&self, i: u32) -> u32 {
        self.search().candidates[i as usize][1]
    }
    fn set_candidate(&mut self, i: u32, site: u32, key: u32) {
        if let Some(search) = &mut self.search {
            search.candidates[i as usize] = [site, key];
        }
    }

    fn square_of_reach(&self, center: V3) -> f64 {
        let V3 { x: square, y: radius, .. } = self.farthest_from(center);
        // The radius bounds each component, √3 < 2; a vertex less the centre is rounded.
        let reach = (square.sqrt() + 2.0 * radius + 8.0 * UNIT_ROUNDOFF * dot(center, center).sqrt()) * SAFE;
        reach * reach * SAFE
    }
    fn cut_by(&mut self, j: u32) -> u32 {
        let plane = bisector(self.way_to(j), -self.excess_of(j));
        clip(self, plane, j)
    }
    fn cut_outside(&mut self, radius: Real) -> u32 {
        if lies_outside(self) != 0 {
            return EMPTY;
        }
        cap_outside(self, radius)
    }
    fn fine_position(&self, v: u32, position: &mut V3, radius: &mut Real) -> u32 {
        (*position, *radius) = (self.position(v), self.radius(v));
        COMPLETE
    }
    fn has_cut(&self, j: u32) -> u32 {
        u32::from((0..self.planes()).any(|f| self.tag(f) == j))
    }
    fn leaves_out(&self) -> u32 {
        0
    }
}
