//! Which sites have the least power where: an octree over the container, whose boxes list the sites that may have the least power in them.
//!
//! The tree over the sites (`site_tree.rs`) bounds weights by polynomials of the sites' places. Where sites are crowded, weights of transport, and
//! more so those on the way to them, are too rough for that: 10,000 sites of a Plummer cluster opened 800 blocks of nodes a cell, where the very
//! minima of the nodes would open 120, and took 40 times as long as white noise. Seen from the container they are as even as their cells.
//!
//! Over a box `c ± h` site `j` has more power than site `k` everywhere if
//!
//! `(|c − p_j|² − w_j) − (|c − p_k|² − w_k) > 2 Σ_a h_a |p_j − p_k|_a`,
//!
//! as a difference of powers is affine. From each box to its eight parts those sites are left out that have more than one of the sites that have the
//! least power in the part's middle and in the middles of its faces. So a site that is not listed has more power at each point of the box than one
//! that is; a vertex that no listed site cuts off stays.

mod lists;

use crate::Result;
use crate::cell::octree::{
    MOST_DEPTH, OCTREE_MARGIN, barren_of_part, middle_of, part_hi, part_is_split, part_lo, power_at, way_home,
};
use crate::cell::search_store::{HAS_PARTS, OctreeNode, OctreeStore, UNLISTED};
use crate::cell::tree::octree_box_at;
use crate::cell::{V3, v3};
use crate::parallel;
use crate::site_tree::{Leaf, SiteTree, WIDTH};
use lists::{OnHost, Place, least_at, powers_at};
use std::sync::atomic::{AtomicU64, Ordering};

/// There is no octree where its boxes would list more leaves than this for each site: where cells lie side by side as slabs do, each part of a box
/// lists half of them. (In a cube some 10.)
const MOST_OF_SITE: usize = 32;

/// A box that is to be split.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OctreeBox {
    /// Lower corner.
    pub lo: [f64; 3],
    /// Upper corner.
    pub hi: [f64; 3],
    /// Where the leaves that it lists begin among those of all such boxes.
    pub begin: u32,
    /// How many there are.
    pub count: u32,
    /// Its number among all boxes.
    pub node: u32,
    /// How often in a row it and those before have listed nearly as much as the box before.
    pub barren: u32,
}

impl OctreeBox {
    /// That about all, which lists all leaves of the tree over so many sites.
    pub fn of_all([lo, hi]: [[f64; 3]; 2], sites: usize) -> Self {
        Self { lo, hi, begin: 0, count: sites.div_ceil(WIDTH) as u32, node: 0, barren: 0 }
    }

    fn part(&self, octant: usize) -> [V3; 2] {
        let (lo, hi) = (of_array(self.lo), of_array(self.hi));
        [part_lo(lo, hi, octant as u32), part_hi(lo, hi, octant as u32)]
    }
}

/// The boxes of an octree over a container; the leaves that they list are somewhere else.
#[derive(Debug)]
struct OctreeBoxes {
    lo: V3,
    hi: V3,
    margin: f64,
    nodes: Vec<OctreeNode>,
    /// Their middles, about.
    middles: Vec<[f32; 3]>,
    /// Whether every box that has no parts lists its leaves.
    is_whole: bool,
}

impl OctreeBoxes {
    /// The boxes over that from `lo` to `hi`, which list up to `most` leaves each; `None` where there would be too many. (Devices make the same:
    /// `backend-ocl/src/octree.rs`.)
    fn new(
        lists: &mut OnHost<'_>,
        sites: usize,
        bounds: [[f64; 3]; 2],
        most: usize,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Self>> {
        let [lo, hi] = bounds.map(of_array);
        let mut octree = Self {
            lo,
            hi,
            margin: margin_of(bounds),
            nodes: vec![OctreeNode { begin: 0, count: UNLISTED }],
            middles: vec![middle_in_single([lo, hi])],
            is_whole: true,
        };
        let mut boxes = vec![OctreeBox::of_all(bounds, sites)];
        let mut listed = 0;
        for depth in 1..=MOST_DEPTH {
            if boxes.is_empty() {
                break;
            }
            go_on()?;
            let counts = lists.split(&boxes);
            let (mut next, mut places, mut whole) = (Vec::new(), Vec::with_capacity(counts.len()), 0);
            for (its, counts) in boxes.iter().zip(counts.chunks_exact(WIDTH)) {
                octree.nodes[its.node as usize] = OctreeNode { begin: octree.nodes.len() as u32, count: HAS_PARTS };
                for (octant, &count) in counts.iter().enumerate() {
                    let [lo, hi] = its.part(octant);
                    let barren = barren_of_part(its.barren, count, its.count);
                    let mut node = OctreeNode { begin: 0, count: UNLISTED };
                    if part_is_split(count, barren, depth) {
                        let [lo, hi] = [lo, hi].map(|V3 { x, y, z }| [x, y, z]);
                        let (begin, node) = (whole as u32, octree.nodes.len() as u32);
                        next.push(OctreeBox { lo, hi, begin, count, node, barren });
                        places.push(Place::Whole);
                        whole += count as usize;
                    } else if count as usize > most {
                        octree.is_whole = false;
                        places.push(Place::Nowhere);
                    } else {
                        node = OctreeNode { begin: listed as u32, count };
                        places.push(Place::Listed);
                        listed += count as usize;
                    }
                    octree.middles.push(middle_in_single([lo, hi]));
                    octree.nodes.push(node);
                }
            }
            if are_too_many(listed, whole, next.len(), sites) {
                return Ok(None);
            }
            lists.place(&places);
            boxes = next;
        }
        Ok(Some(octree))
    }
}

/// How many leaves of the tree over so many sites boxes list at most.
pub fn most_listed(sites: usize) -> usize {
    MOST_OF_SITE.saturating_mul(sites).min(UNLISTED as usize / 8)
}

/// Whether boxes are too many, or list too many leaves: those of the boxes that are split next, and of all that are not.
pub fn are_too_many(listed: usize, whole: usize, boxes: usize, sites: usize) -> bool {
    listed + whole + WIDTH * boxes > most_listed(sites)
}

/// By how much a box over a container is taken to be larger on each side.
pub fn margin_of([lo, hi]: [[f64; 3]; 2]) -> f64 {
    OCTREE_MARGIN * (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max)
}

/// How far a place may be off along each axis where boxes are taken to be so much larger.
pub fn off_of(margin: f64) -> f64 {
    0.25 * margin
}

fn of_array([x, y, z]: [f64; 3]) -> V3 {
    v3(x, y, z)
}

fn middle_in_single([lo, hi]: [V3; 2]) -> [f32; 3] {
    let V3 { x, y, z } = middle_of(lo, hi);
    [x, y, z].map(|x| x as f32)
}

/// Where a site's cell is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Home {
    /// Around a place.
    At([f64; 3]),
    /// No box lists the site: its cell is empty.
    Nowhere,
    /// That is not known.
    Unknown,
}

/// The octree over a container.
#[derive(Debug)]
pub struct PowerOctree {
    boxes: OctreeBoxes,
    /// The leaves of the tree over the sites that the boxes list.
    listed: Vec<u32>,
    /// The box that each site's cell is in, or that it comes nearest to having the least power in.
    homes: Vec<u32>,
}

impl PowerOctree {
    /// The octree over the box from `lo` to `hi`, which lists up to `most` leaves a box; `None` where there would be too many.
    ///
    /// # Errors
    /// What `go_on` says, which is asked now and then.
    pub fn new(
        tree: &SiteTree,
        bounds: [[f64; 3]; 2],
        most: usize,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Self>> {
        let mut lists = OnHost::new(tree, margin_of(bounds));
        let boxes = OctreeBoxes::new(&mut lists, tree.len(), bounds, most, go_on)?;
        Ok(boxes.map(|boxes| {
            let mut octree = Self { boxes, listed: lists.listed, homes: Vec::new() };
            octree.find_homes(tree);
            octree
        }))
    }

    /// The leaves that a box lists; none where it has parts.
    pub fn leaves_of(&self, OctreeNode { begin, count }: OctreeNode) -> &[u32] {
        match count {
            HAS_PARTS | UNLISTED => &[],
            count => &self.listed[begin as usize..][..count as usize],
        }
    }

    /// Finds for each site the box in whose middle its power exceeds the least by the shortest way to their bisector.
    fn find_homes(&mut self, tree: &SiteTree) {
        let homes: Vec<AtomicU64> = (0..tree.len().div_ceil(WIDTH) * WIDTH).map(|_| AtomicU64::new(u64::MAX)).collect();
        parallel::tasks(self.boxes.nodes.len(), &|node| {
            let leaves = self.leaves_of(self.boxes.nodes[node]);
            let middle = of_array(self.boxes.middles[node].map(f64::from));
            let Some(first) = least_at(tree, [middle], leaves).first().copied().filter(|_| !leaves.is_empty()) else {
                return;
            };
            let [x, y, z, weight] = tree.site(first);
            let place = v3(x, y, z);
            let least = power_at(place, weight, middle);
            for &leaf in leaves {
                let (powers, Leaf { at: [xs, ys, zs], .. }) = (powers_at(tree.leaf(leaf), middle), tree.leaf(leaf));
                for k in 0..WIDTH {
                    let key = way_home(v3(xs[k], ys[k], zs[k]), powers[k], place, least).to_bits();
                    let entry = u64::from(key) << 32 | node as u64;
                    homes[leaf as usize * WIDTH + k].fetch_min(entry, Ordering::Relaxed);
                }
            }
        });
        self.homes = homes.into_iter().map(|home| home.into_inner() as u32).collect();
    }

    /// The leaves of all sites that may have the least power at a place that is off by up to `radius` along each axis; none where that is not known.
    #[inline(always)]
    pub fn leaves_at(&self, place: V3, radius: f64) -> &[u32] {
        if radius.is_nan() || radius > off_of(self.boxes.margin) {
            return &[];
        }
        self.leaves_of(octree_box_at(self, place).node)
    }

    /// The middle of a box, about.
    pub fn middle(&self, node: u32) -> [f64; 3] {
        self.boxes.middles[node as usize].map(f64::from)
    }

    /// Where the cell of a sorted site is.
    pub fn home(&self, site: u32) -> Home {
        match self.homes[site as usize] {
            u32::MAX if self.boxes.is_whole => Home::Nowhere,
            u32::MAX => Home::Unknown,
            node => Home::At(self.middle(node)),
        }
    }
}

impl OctreeStore for PowerOctree {
    #[inline(always)]
    fn octree_lo(&self) -> V3 {
        self.boxes.lo
    }
    #[inline(always)]
    fn octree_hi(&self) -> V3 {
        self.boxes.hi
    }
    #[inline(always)]
    fn octree_off(&self) -> f64 {
        off_of(self.boxes.margin)
    }
    #[inline(always)]
    fn octree_node(&self, i: u32) -> OctreeNode {
        self.boxes.nodes[i as usize]
    }
    #[inline(always)]
    fn octree_leaf(&self, i: u32) -> u32 {
        self.listed[i as usize]
    }
}
