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
use crate::cell::octree::{FEW_LISTED, OCTREE_MARGIN, middle_of, part_hi, part_lo, power_at, way_home};
use crate::cell::search_store::{HAS_PARTS, OctreeNode, OctreeStore, UNLISTED};
use crate::cell::tree::octree_box_at;
use crate::cell::{V3, v3};
use crate::parallel;
use crate::site_tree::{Leaf, SiteTree, WIDTH};
use crate::summation::CHUNK;
use lists::{OnHost, least_at, powers_at};
use std::sync::atomic::{AtomicU64, Ordering};

/// A box is split so often at most.
const MOST_DEPTH: usize = 18;
/// A box is not split where it lists more than this share of what the box before lists, twice in a row: sites that nearly tie, as at a sphere's middle.
const BARREN: f64 = 0.8;
const MOST_BARREN: u32 = 2;

/// There is no octree where its boxes would list more leaves than this for each site: where cells lie side by side as slabs do, each part of a box
/// lists half of them. (In a cube some 10.)
const MOST_OF_SITE: usize = 32;

/// A box that is to be split: its corners, and where the leaves that it lists begin among those of all such boxes, and how many there are.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OctreeBox {
    /// Lower corner.
    pub lo: [f64; 3],
    /// Upper corner.
    pub hi: [f64; 3],
    /// Where they begin.
    pub begin: u32,
    /// How many there are.
    pub count: u32,
}

/// Where the leaves of a part go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Among those of the boxes that are split next, from so many on.
    Whole(u32),
    /// Among those that boxes list in the end, from so many on.
    Listed(u32),
    /// They are too many.
    Nowhere,
}

/// Who goes over the leaves that boxes list: the host, or a device. At first there is one box, which lists all.
pub trait Lists {
    /// How many leaves each part of some boxes keeps, eight parts of each box: those with a site that may have the least power there.
    ///
    /// # Errors
    /// A device's.
    fn split(&mut self, front: &[OctreeBox]) -> Result<Vec<u32>>;
    /// Puts the leaves that each of these parts keeps in its place: `whole` of them are of boxes that are split next.
    ///
    /// # Errors
    /// A device's.
    fn place(&mut self, places: &[Place], whole: usize) -> Result<()>;
}

/// The boxes of an octree over a container; the leaves that they list are somewhere else.
#[derive(Debug)]
pub struct OctreeBoxes {
    lo: V3,
    hi: V3,
    margin: f64,
    nodes: Vec<OctreeNode>,
    /// Their middles, about.
    middles: Vec<[f32; 3]>,
    /// Whether every box that has no parts lists its leaves.
    is_whole: bool,
}

/// A box that is split, on its way.
#[derive(Clone, Copy)]
struct Front {
    node: usize,
    barren: u32,
}

impl OctreeBoxes {
    /// The boxes over that from `lo` to `hi`, which list up to `most` of the leaves of so many sites each; `None` where there would be too many.
    ///
    /// # Errors
    /// What `go_on` says, which is asked now and then, and those of `lists`.
    pub fn new(
        lists: &mut dyn Lists,
        sites: usize,
        [lo, hi]: [[f64; 3]; 2],
        most: usize,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Self>> {
        let mut octree = Self {
            lo: of_array(lo),
            hi: of_array(hi),
            margin: margin_of([lo, hi]),
            nodes: vec![OctreeNode { begin: 0, count: UNLISTED }],
            middles: vec![middle_in_single(of_array(lo), of_array(hi))],
            is_whole: true,
        };
        let mut boxes = vec![OctreeBox { lo, hi, begin: 0, count: sites.div_ceil(WIDTH) as u32 }];
        let mut front = vec![Front { node: 0, barren: 0 }];
        let mut listed = 0;
        for depth in 1..=MOST_DEPTH {
            if boxes.is_empty() {
                break;
            }
            go_on()?;
            let counts = lists.split(&boxes)?;
            let middles_of_parts = |whole: &OctreeBox| -> [[f32; 3]; WIDTH] {
                let (lo, hi) = (of_array(whole.lo), of_array(whole.hi));
                let middle = |octant| middle_in_single(part_lo(lo, hi, octant as u32), part_hi(lo, hi, octant as u32));
                std::array::from_fn(middle)
            };
            octree.middles.resize(octree.middles.len() + counts.len(), [0.0; 3]);
            let middles = octree.middles[octree.nodes.len()..].as_chunks_mut::<WIDTH>().0;
            parallel::for_each(middles, CHUNK, |i, middles| *middles = middles_of_parts(&boxes[i]));
            let (mut next_boxes, mut next_front) = (Vec::new(), Vec::new());
            let mut places = Vec::with_capacity(counts.len());
            octree.nodes.reserve(counts.len());
            let mut of_next = 0;
            for ((whole, from), counts) in boxes.iter().zip(&front).zip(counts.chunks_exact(WIDTH)) {
                let first = octree.nodes.len();
                octree.nodes[from.node] = OctreeNode { begin: first as u32, count: HAS_PARTS };
                for (octant, &count) in counts.iter().enumerate() {
                    let is_barren = f64::from(count) > BARREN * f64::from(whole.count);
                    let barren = if is_barren { from.barren + 1 } else { 0 };
                    let mut node = OctreeNode { begin: 0, count: UNLISTED };
                    if count > FEW_LISTED && depth < MOST_DEPTH && barren < MOST_BARREN {
                        places.push(Place::Whole(of_next as u32));
                        let (lo, hi) = (of_array(whole.lo), of_array(whole.hi));
                        let corner_of = |V3 { x, y, z }| [x, y, z];
                        next_boxes.push(OctreeBox {
                            lo: corner_of(part_lo(lo, hi, octant as u32)),
                            hi: corner_of(part_hi(lo, hi, octant as u32)),
                            begin: of_next as u32,
                            count,
                        });
                        next_front.push(Front { node: first + octant, barren });
                        of_next += count as usize;
                    } else if count as usize > most {
                        octree.is_whole = false;
                        places.push(Place::Nowhere);
                    } else {
                        places.push(Place::Listed(listed as u32));
                        node = OctreeNode { begin: listed as u32, count };
                        listed += count as usize;
                    }
                    octree.nodes.push(node);
                }
            }
            let numbers = listed + of_next + 8 * next_boxes.len();
            if numbers > most_listed(sites) {
                return Ok(None);
            }
            lists.place(&places, of_next)?;
            (boxes, front) = (next_boxes, next_front);
        }
        Ok(Some(octree))
    }

    /// How far a place may be off along each axis.
    pub fn off(&self) -> f64 {
        0.25 * self.margin
    }

    /// Whether every box that has no parts lists its leaves: a site that none lists has an empty cell.
    pub fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// The boxes; the first has all in it.
    pub fn nodes(&self) -> &[OctreeNode] {
        &self.nodes
    }

    /// Their middles, in single precision.
    pub fn middles(&self) -> &[[f32; 3]] {
        &self.middles
    }
}

/// How many leaves of the tree over so many sites boxes list at most.
pub fn most_listed(sites: usize) -> usize {
    MOST_OF_SITE.saturating_mul(sites).min(UNLISTED as usize / 8)
}

/// By how much a box over a container is taken to be larger on each side.
pub fn margin_of([lo, hi]: [[f64; 3]; 2]) -> f64 {
    OCTREE_MARGIN * (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max)
}

fn of_array([x, y, z]: [f64; 3]) -> V3 {
    v3(x, y, z)
}

fn middle_in_single(lo: V3, hi: V3) -> [f32; 3] {
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
        if radius.is_nan() || radius > self.boxes.off() {
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
        self.boxes.off()
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
