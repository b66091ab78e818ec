//! What the search needs: the cell, the sites, and the tree over them.
//!
//! Like `store.rs` the boundary of the dialect.

use super::boxes::visit_leaves;
use super::lanes::Lanes;
use super::search::Vantage;
use super::tree::asks_by_powers;
use super::vector::{Real, Rough, V3};

/// Sites in a leaf of the tree, and nodes in a block.
pub const WIDTH: u32 = 8;

/// A site's number that no site has.
pub const NO_SITE: u32 = 0xFFFF_FFFF;

/// Open blocks, leaves at hand, and candidates that there is room for: see `search.rs`.
pub const MOST_OPEN: u32 = 124;
/// Leaves.
pub const MOST_LEAVES: u32 = 40;
/// Candidates.
pub const MOST_CANDIDATES: u32 = 112;

/// Leaves whose sites become candidates at one time.
pub const LEAVES_AT_ONCE: u32 = 4;
/// Sites that are kept, or come from all over, that become candidates at a time: no more than there is room for.
pub const KEPT_AT_ONCE: u32 = 96;

/// The box of a node's sites, in the diagram's frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct NodeBox {
    /// Minimum corner.
    pub lo: V3,
    /// Maximum corner.
    pub hi: V3,
}

/// An upper bound of the weights of a node's sites, less the least weight of all: `c + g·(x − m) + Σ q_k (x − m)_k²`, m the middle of its box.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct NodeWeights {
    /// c, with room for the roundings of evaluating it.
    pub offset: Real,
    /// g.
    pub slope: V3,
    /// q.
    pub curvature: V3,
}

/// A slab `lo ≤ n·x ≤ hi` that holds a node's sites, and the largest of their weights, less the least of all.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct NodeSlab {
    /// n, a unit vector.
    pub normal: V3,
    /// Rounded down.
    pub lo: Real,
    /// Rounded up.
    pub hi: Real,
    /// Of the weights.
    pub largest: Real,
}

/// A vertex at which the search asks for the site of least power.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked {
    /// Its number in the store.
    pub vertex: u32,
    /// Its place, from the cell's site.
    pub place: V3,
    /// The cell's own power there.
    pub own: Real,
    /// What its error radius takes from a power: this, and this share of the square of the site's distance.
    pub lost: Real,
    /// The share.
    pub lost_of_square: Real,
    /// How far along each axis the place is off at most.
    pub radius: Real,
    /// Beyond this power no site can have less than the cell; of the first, also not less than the site that was found.
    pub limit: Real,
}

/// A vertex in the precision of bounds.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct RoughVertex {
    /// Its place, from the cell's site.
    pub x: Rough,
    /// The same.
    pub y: Rough,
    /// The same.
    pub z: Rough,
    /// How far along each axis it is off that place at most.
    pub radius: Rough,
}

/// What is found at an asked vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Answer {
    /// Its number in the store, or `NO_SITE` where none was asked for.
    pub vertex: u32,
    /// The site that certainly has less power there, or `NO_SITE`.
    pub found: u32,
    /// How many candidates may have: that site alone, or where there is none those that tie; `NO_SITE` where the vertex is not known well.
    pub ties: u32,
    /// How many of those that tie, from the first on, were tried before, as far as it was looked: where there is one team it is not.
    pub tried: u32,
}

/// The count of a box of the octree over the container that has parts, and of one that lists too many leaves.
pub const HAS_PARTS: u32 = 0xFFFF_FFFF;
/// Too many.
pub const UNLISTED: u32 = 0xFFFF_FFFE;

/// A box of the octree over the container: where the leaves that it lists begin, and how many there are; or where its eight parts begin.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct OctreeNode {
    /// Where they begin.
    pub begin: u32,
    /// How many leaves, or [`HAS_PARTS`], or [`UNLISTED`].
    pub count: u32,
}

/// What the octree over the container tells of a site's cell: nothing; where it is; or that no box lists the site, whose cell is empty.
pub const HOME_UNKNOWN: u32 = 0;
/// Where it is.
pub const HOME_KNOWN: u32 = 1;
/// It is empty.
pub const HOME_NOWHERE: u32 = 2;

/// The octree over the container (`core/src/power_octree.rs`), which lists the sites that may have the least power in each of its boxes.
pub trait OctreeStore {
    /// The lower corner of its first box, in the diagram's frame.
    fn octree_lo(&self) -> V3;
    /// The upper corner.
    fn octree_hi(&self) -> V3;
    /// How far along each axis a place may be off.
    fn octree_off(&self) -> Real;
    /// Box `i`, the first of all being 0.
    fn octree_node(&self, i: u32) -> OctreeNode;
    /// Leaf `i` of all that boxes list.
    fn octree_leaf(&self, i: u32) -> u32;
}

/// A cell that is searched, the sites and the tree over them. What a method gives is alike in all lanes unless it says otherwise.
pub trait SearchStore: Lanes {
    /// A number in the order of numbers, rounded down.
    fn key_below(&self, x: Real) -> u32;
    /// The same rounded up.
    fn key_above(&self, x: Real) -> u32;

    /// Number of sites in the tree.
    fn sites(&self) -> u32;
    /// The sorted index of the cell's site.
    fn own_site(&self) -> u32;
    /// The place of the cell's site, in the diagram's frame.
    fn site(&self) -> V3;
    /// The way from the cell's site to site `j`.
    fn way_to(&self, j: u32) -> V3;
    /// What site `j` weighs more than the cell's.
    fn excess_of(&self, j: u32) -> Real;
    /// What the cell's site weighs more than the lightest of all.
    fn own_excess(&self) -> Real;
    /// What the heaviest site weighs more than the cell's.
    fn largest_excess(&self) -> Real;
    /// Whether weights differ.
    fn has_weights(&self) -> bool;

    /// The level of the tree's root, 0 that of the leaves.
    fn top_level(&self) -> u32;
    /// The box of node `node` of a level.
    fn node_box(&self, level: u32, node: u32) -> NodeBox;
    /// What bounds its weights, where weights differ.
    fn node_weights(&self, level: u32, node: u32) -> NodeWeights;
    /// A slab about its sites.
    fn node_slab(&self, level: u32, node: u32) -> NodeSlab;
    /// Those of some asked vertices, a bit each, at which a site of a node may have a power below the limit, and a key: what
    /// `asks_by_powers` says. Of the nodes of a block, the first is asked first. Not alike.
    fn asks_of_node(&mut self, level: u32, node: u32, asks: u32, key: &mut u32) -> u32
    where
        Self: Sized,
    {
        asks_by_powers(self, level, node, asks, key)
    }
    /// Those of some asked vertices, a bit each, at which site `j` may have a power below the limit: all are always right. Of the sites of a leaf
    /// the first is asked first. Not alike.
    fn asks_of_site(&mut self, _j: u32, asks: u32) -> u32 {
        asks
    }

    /// Puts the leaves at hand of all sites that may have less power at the asked vertex, for the asked vertices, a bit each; returns how many, 0 where
    /// they are not listed or several vertices are asked for.
    fn set_listed_leaves(&mut self, _asks: u32) -> u32 {
        0
    }
    /// What the octree tells of the own cell: `HOME_KNOWN` with a place that it is about, from its site (that itself where weights do
    /// not differ); `HOME_NOWHERE`, or `HOME_UNKNOWN`.
    fn home(&self, _place: &mut V3) -> u32 {
        HOME_UNKNOWN
    }
    /// Cuts the cell by those sites of the first so many leaves at hand that may cut it, which is still the container where that `is_home`: `UNTOUCHED`,
    /// or how it ended.
    fn visit_leaves(&mut self, vantage: Vantage, leaves: u32, is_home: bool, visited: &mut u32) -> u32
    where
        Self: Sized,
    {
        visit_leaves(self, vantage, leaves, is_home, visited)
    }

    /// Open block `i` (see `tree.rs`).
    fn open_block(&self, i: u32) -> u32;
    /// Its key, that of the least power that was found there for an asked vertex; 0 where keys are not kept.
    fn open_key(&self, i: u32) -> u32;
    /// The asked vertices that its sites may cut off, a bit each.
    fn open_asks(&self, i: u32) -> u32;
    /// Sets open block `i`, its key and its vertices.
    fn set_open_block(&mut self, i: u32, block: u32, key: u32, asks: u32);
    /// Leaf `i` at hand.
    fn leaf(&self, i: u32) -> u32;
    /// Its key, as those of blocks.
    fn leaf_key(&self, i: u32) -> u32;
    /// Its vertices, as those of blocks.
    fn leaf_asks(&self, i: u32) -> u32;
    /// Sets leaf `i`, its key and its vertices.
    fn set_leaf(&mut self, i: u32, leaf: u32, key: u32, asks: u32);
    /// Site of candidate `i`.
    fn candidate(&self, i: u32) -> u32;
    /// Its key.
    fn candidate_key(&self, i: u32) -> u32;
    /// Sets candidate `i` and its key.
    fn set_candidate(&mut self, i: u32, site: u32, key: u32);
    /// How many of `count` candidates this lane holds: number `c` of lane `l` is candidate `c·lanes + l`. Not alike.
    fn held(&self, count: u32) -> u32 {
        count
    }
    /// The site of candidate `c` of this lane: not alike.
    fn held_site(&self, c: u32) -> u32 {
        self.candidate(c)
    }
    /// Its key: not alike.
    fn held_key(&self, c: u32) -> u32 {
        self.candidate_key(c)
    }
    /// Takes it out: its key becomes `NO_SITE`.
    fn let_go(&mut self, c: u32) {
        self.set_candidate(c, self.candidate(c), NO_SITE);
    }
    /// Cuts by the sites around a cell's own since the last [`drop_held`](Self::drop_held) after which it is worth its time: where many lanes look at the same time.
    fn cuts_before_look(&self) -> u32 {
        NO_SITE
    }
    /// Whether sites around are looked at before they cut, as those far off are: where most cells reach far, and what does not cut a cell takes as long to find out as what does.
    fn checks_near(&self) -> bool {
        false
    }
    /// Takes out those that certainly leave the cell untouched, each lane its own, as far as it is looked: where none is, all within reach are visited. Returns how
    /// many candidates there are then, which may have moved: a lane may hold others.
    fn drop_held(&mut self, count: u32) -> u32 {
        count
    }
    /// Room for candidates that tie, at least [`MOST_CANDIDATES`].
    fn most_ties(&self) -> u32;

    /// Vertices that are asked for at once, at most: up to 32.
    fn most_asked(&self) -> u32;
    /// Asked vertex `i`.
    fn asked(&self, i: u32) -> Asked;
    /// Sets it.
    fn set_asked(&mut self, i: u32, asked: Asked);

    /// How many sites are tried before all that can cut the cell: such as bound another cell beside it far off, or some from all over.
    fn kept_count(&self) -> u32 {
        0
    }
    /// Such a site: not alike.
    fn kept_site(&self, _i: u32) -> u32 {
        NO_SITE
    }
    /// Teams of lanes, which call [`search_far`](super::far::search_far) at the same time. All else the first does alone.
    fn teams(&self) -> u32 {
        1
    }
    /// Whether each team looks for its vertex among a share of them, where they are many.
    fn shares_vertices(&self) -> bool {
        false
    }
    /// This lane's team: not alike in all teams.
    fn team(&self) -> u32 {
        0
    }
    /// Teams see from here on what the others wrote.
    fn teams_wait(&self) {}
    /// What the first team says; the others see from here on what it made of the cell.
    fn first_says(&mut self, what: u32) -> u32 {
        what
    }
    /// What a team found, where there are several.
    fn answer(&self, _team: u32) -> Answer {
        Answer::default()
    }
    /// Sets what this one did.
    fn set_answer(&mut self, _answer: Answer) {}
    /// Candidate `i` of a team.
    fn tied(&self, _team: u32, i: u32) -> u32 {
        self.candidate(i)
    }

    /// How many leaves are looked at, near ones again among them, for a cell that still reaches far when those near were, before it is completed by its vertices.
    fn leaves_if_far(&self) -> u32;
    /// Whether a cell that reaches far when those near have cut it is cut by what may cut it at a vertex (`sweep.rs`), before it is completed by its vertices; by all that it reaches if not.
    fn is_swept(&self) -> bool {
        return false;
    }
    /// Whether the cell is restricted to a domain.
    fn has_domain(&self) -> bool;
    /// The square of the cell's reach about a place, rounded up: of twice the distance of its farthest vertex. No site as heavy that is beyond can
    /// cut it.
    fn square_of_reach(&self, center: V3) -> Rough;
    /// The key from which on a candidate is beyond.
    fn key_of_reach(&self, square: Rough) -> u32;
    /// Cuts the cell by the bisector with site `j`: as `clip`; `EMPTY` also where it is known to be outside the domain.
    fn cut_by(&mut self, j: u32) -> u32;
    /// Cuts off what of the cell is outside the domain, where it reaches farther than `radius` from its site: as `cap_outside`; `EMPTY` where it
    /// is known to be outside.
    fn cut_outside(&mut self, radius: Real) -> u32;
    /// Number of vertices.
    fn vertices(&self) -> u32;
    /// The place of vertex `v`, roughly.
    fn position(&self, v: u32) -> V3;
    /// How far along each axis it is off that place at most.
    fn radius(&self, v: u32) -> Real;
    /// The same two.
    fn rough_vertex(&self, v: u32) -> RoughVertex {
        let p = self.position(v);
        RoughVertex { x: p.x, y: p.y, z: p.z, radius: self.radius(v) }
    }
    /// Its place and its error radius in double precision: `COMPLETE`, or `UNCERTAIN`.
    fn fine_position(&self, v: u32, position: &mut V3, radius: &mut Real) -> u32;
    /// Whether vertex `v` is known to be cut off by no site.
    fn settled(&self, v: u32) -> bool;
    /// Sets it.
    fn set_settled(&mut self, v: u32, settled: bool);
    /// From vertex `v` on the first that is not, for a host; as many as there are where there is none.
    fn next_open(&self, v: u32) -> u32;
    /// Sets it of a vertex of this lane's own: not alike.
    fn settle_own(&mut self, v: u32) {
        self.set_settled(v, true);
    }
    /// Whether vertex `v` lies on the bisector with site `j`.
    fn touches(&self, v: u32, j: u32) -> bool;
    /// Whether the bisector with site `j` was tried: it is among the cell's half-spaces.
    fn was_tried(&self, j: u32) -> bool;
    /// Whether sites are left out that might cut the cell.
    fn leaves_out(&self) -> bool;
}
