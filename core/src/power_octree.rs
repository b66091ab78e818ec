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

use crate::Result;
use crate::cell::UNIT_ROUNDOFF;
use crate::site_tree::{Leaf, SiteTree, WIDTH};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// A box that lists so many leaves of eight sites, or fewer, is not split. (With 10 the octree takes twice as long, with 32 the cells do.)
const FEW: usize = 20;
/// A box is split so often at most.
const MOST_DEPTH: usize = 18;
/// A box is not split where it lists more than this share of what the box before lists, twice in a row: sites that nearly tie, as at a sphere's middle.
const BARREN: f64 = 0.8;
const MOST_BARREN: u32 = 2;

/// There is no octree where its boxes would list more leaves than this for each site: where cells lie side by side as slabs do, each part of a box
/// lists half of them. (In a cube some 10.)
const MOST_OF_SITE: usize = 32;

/// By how much a box is taken to be larger on each side, as a share of the container's extent: a place may be off by a quarter of it.
const MARGIN: f64 = 1e-9;

/// Roundings of a difference of powers.
const ROUNDINGS: f64 = 32.0 * UNIT_ROUNDOFF;

/// The count of a node that has parts, and of one that lists too many.
const HAS_PARTS: u32 = u32::MAX;
const UNLISTED: u32 = u32::MAX - 1;

/// A box of the octree: where the leaves that it lists begin, and how many there are; or where its eight parts begin.
#[derive(Clone, Copy, Debug)]
struct Node {
    begin: u32,
    count: u32,
}

/// A box in space.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    lo: [f64; 3],
    hi: [f64; 3],
}

/// A box that may yet be split.
struct Front {
    node: usize,
    bounds: Bounds,
    leaves: Vec<u32>,
    barren: u32,
}

/// Where a site's cell is.
#[derive(Clone, Copy, Debug)]
pub enum Home<'a> {
    /// Around a place: the leaves that are listed there.
    At(&'a [u32], [f64; 3]),
    /// No box lists the site: its cell is empty.
    Nowhere,
    /// That is not known.
    Unknown,
}

/// The octree over a container.
#[derive(Debug)]
pub struct PowerOctree {
    bounds: Bounds,
    margin: f64,
    nodes: Vec<Node>,
    /// The middles of the nodes, about.
    middles: Vec<[f32; 3]>,
    /// The leaves of the tree over the sites that the nodes list.
    listed: Vec<u32>,
    /// The node that each site's cell is in, or that it comes nearest to having the least power in.
    homes: Vec<u32>,
    /// Whether every node that has no parts lists its leaves.
    is_whole: bool,
}

impl PowerOctree {
    /// The octree over the box from `lo` to `hi`, which lists up to `most` leaves a box; `None` where there would be too many.
    ///
    /// # Errors
    /// What `go_on` says, which is asked now and then.
    pub fn new(
        tree: &SiteTree,
        [lo, hi]: [[f64; 3]; 2],
        most: usize,
        go_on: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Self>> {
        let bounds = Bounds { lo, hi };
        let margin = MARGIN * (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max);
        let mut octree = Self {
            bounds,
            margin,
            nodes: vec![Node { begin: 0, count: UNLISTED }],
            middles: vec![bounds.middle().map(|x| x as f32)],
            listed: Vec::new(),
            homes: Vec::new(),
            is_whole: true,
        };
        let leaves = (0..tree.len().div_ceil(WIDTH) as u32).collect();
        let mut front = vec![Front { node: 0, bounds, leaves, barren: 0 }];
        for depth in 0..=MOST_DEPTH {
            go_on()?;
            let of_front: usize = front.iter().map(|part| part.leaves.len()).sum();
            let numbers = octree.listed.len() + of_front + 8 * front.len();
            if numbers > MOST_OF_SITE.saturating_mul(tree.len()) || numbers > UNLISTED as usize / 8 {
                return Ok(None);
            }
            let (whole, done): (Vec<Front>, Vec<Front>) =
                front.into_iter().partition(|b| depth < MOST_DEPTH && b.leaves.len() > FEW && b.barren < MOST_BARREN);
            done.iter().for_each(|done| octree.list(done, most));
            let first = octree.nodes.len();
            for (i, whole) in whole.iter().enumerate() {
                octree.nodes[whole.node] = Node { begin: (first + 8 * i) as u32, count: HAS_PARTS };
                for octant in 0..8 {
                    octree.nodes.push(Node { begin: 0, count: UNLISTED });
                    octree.middles.push(whole.bounds.part(octant).middle().map(|x| x as f32));
                }
            }
            let part = |i: usize| {
                let (whole, bounds) = (&whole[i / 8], whole[i / 8].bounds.part(i % 8));
                let leaves = with_least_power(tree, bounds, margin, &whole.leaves);
                let is_barren = leaves.len() as f64 > BARREN * whole.leaves.len() as f64;
                Front { node: first + i, bounds, leaves, barren: if is_barren { whole.barren + 1 } else { 0 } }
            };
            front = (0..8 * whole.len()).into_par_iter().map(part).collect();
        }
        octree.find_homes(tree);
        Ok(Some(octree))
    }

    fn list(&mut self, done: &Front, most: usize) {
        if done.leaves.len() > most {
            self.is_whole = false;
            return;
        }
        self.nodes[done.node] = Node { begin: self.listed.len() as u32, count: done.leaves.len() as u32 };
        self.listed.extend(&done.leaves);
    }

    fn leaves_of(&self, node: usize) -> &[u32] {
        match self.nodes[node] {
            Node { count: HAS_PARTS | UNLISTED, .. } => &[],
            Node { begin, count } => &self.listed[begin as usize..][..count as usize],
        }
    }

    /// Finds for each site the node in whose middle its power exceeds the least by the shortest way to their bisector.
    fn find_homes(&mut self, tree: &SiteTree) {
        let homes: Vec<AtomicU64> = (0..tree.len().div_ceil(WIDTH) * WIDTH).map(|_| AtomicU64::new(u64::MAX)).collect();
        (0..self.nodes.len()).into_par_iter().for_each(|node| {
            let (leaves, middle) = (self.leaves_of(node), self.middles[node].map(f64::from));
            let Some(first) = least_at(tree, [middle], leaves).first().copied().filter(|_| !leaves.is_empty()) else {
                return;
            };
            let [px, py, pz, weight] = tree.site(first);
            let (x, y, z) = (px - middle[0], py - middle[1], pz - middle[2]);
            let least = ((x * x) + (y * y) + (z * z)) - weight;
            for &leaf in leaves {
                let (powers, Leaf { at: [xs, ys, zs], .. }) = (powers_at(tree.leaf(leaf), middle), tree.leaf(leaf));
                for k in 0..WIDTH {
                    let (x, y, z) = (xs[k] - px, ys[k] - py, zs[k] - pz);
                    let way = (powers[k] - least) / ((x * x) + (y * y) + (z * z)).sqrt();
                    // (Not a number for that site itself.)
                    let key = if way > 0.0 { (way as f32).to_bits() } else { 0 };
                    let entry = u64::from(key) << 32 | node as u64;
                    homes[leaf as usize * WIDTH + k].fetch_min(entry, Ordering::Relaxed);
                }
            }
        });
        self.homes = homes.into_iter().map(|home| home.into_inner() as u32).collect();
    }

    /// The leaves of all sites that may have the least power at a place that is off by up to `radius` along each axis; none where that is not known.
    #[inline(always)]
    pub fn leaves_at(&self, place: [f64; 3], radius: f64) -> &[u32] {
        let Bounds { mut lo, mut hi } = self.bounds;
        let off = 0.25 * self.margin;
        let is_within = (0..3).all(|k| place[k] >= lo[k] - off && place[k] <= hi[k] + off);
        if !is_within || radius.is_nan() || radius > off {
            return &[];
        }
        let mut node = 0;
        while self.nodes[node].count == HAS_PARTS {
            let mut octant = 0;
            for k in 0..3 {
                let middle = 0.5 * (lo[k] + hi[k]);
                let is_upper = place[k] >= middle;
                (lo[k], hi[k]) = if is_upper { (middle, hi[k]) } else { (lo[k], middle) };
                octant |= usize::from(is_upper) << k;
            }
            node = self.nodes[node].begin as usize + octant;
        }
        self.leaves_of(node)
    }

    /// Where the cell of a sorted site is.
    pub fn home(&self, site: u32) -> Home<'_> {
        match self.homes[site as usize] {
            u32::MAX if self.is_whole => Home::Nowhere,
            u32::MAX => Home::Unknown,
            node => Home::At(self.leaves_of(node as usize), self.middles[node as usize].map(f64::from)),
        }
    }
}

impl Bounds {
    fn middle(&self) -> [f64; 3] {
        std::array::from_fn(|k| 0.5 * (self.lo[k] + self.hi[k]))
    }

    /// The part that is upper along the axes whose bits are set.
    fn part(&self, octant: usize) -> Self {
        let (middle, is_upper) = (self.middle(), |k: usize| octant >> k & 1 == 1);
        Self {
            lo: std::array::from_fn(|k| if is_upper(k) { middle[k] } else { self.lo[k] }),
            hi: std::array::from_fn(|k| if is_upper(k) { self.hi[k] } else { middle[k] }),
        }
    }
}

/// Of some leaves those with a site that may have the least power somewhere in a box, by the widest instructions that the CPU has.
fn with_least_power(tree: &SiteTree, bounds: Bounds, margin: f64, leaves: &[u32]) -> Vec<u32> {
    struct Job<'a> {
        tree: &'a SiteTree,
        middle: [f64; 3],
        half: [f64; 3],
        leaves: &'a [u32],
    }
    impl NullaryFnOnce for Job<'_> {
        type Output = Vec<u32>;

        #[inline(always)]
        fn call(self) -> Vec<u32> {
            let Self { tree, middle, half, leaves } = self;
            let kept = undominated(tree, middle, half, leaves, least_at(tree, [middle], leaves));
            if kept.len() <= FEW {
                return kept;
            }
            let faces: [[f64; 3]; 6] = std::array::from_fn(|i| {
                let mut place = middle;
                place[i / 2] += if i % 2 == 0 { half[i / 2] } else { -half[i / 2] };
                place
            });
            undominated(tree, middle, half, &kept, least_at(tree, faces, &kept))
        }
    }
    let middle = bounds.middle();
    let half = std::array::from_fn(|k| 0.5 * (bounds.hi[k] - bounds.lo[k]) + margin);
    Arch::new().dispatch(Job { tree, middle, half, leaves })
}

/// The powers of the sites of a leaf at a place.
#[inline(always)]
fn powers_at(leaf: &Leaf, [x, y, z]: [f64; 3]) -> [f64; WIDTH] {
    let Leaf { at: [xs, ys, zs], weight } = leaf;
    std::array::from_fn(|k| {
        let (x, y, z) = (xs[k] - x, ys[k] - y, zs[k] - z);
        ((x * x) + (y * y) + (z * z)) - weight[k]
    })
}

/// The sites of least power at some places, of equals one; 0 where there are none.
#[inline(always)]
fn least_at<const N: usize>(tree: &SiteTree, places: [[f64; 3]; N], leaves: &[u32]) -> [u32; N] {
    let mut least = [[f64::INFINITY; WIDTH]; N];
    let mut of = [[0_u32; WIDTH]; N];
    for &leaf in leaves {
        for (place, &at) in places.iter().enumerate() {
            let powers = powers_at(tree.leaf(leaf), at);
            for k in 0..WIDTH {
                let is_less = powers[k] < least[place][k];
                least[place][k] = if is_less { powers[k] } else { least[place][k] };
                of[place][k] = if is_less { leaf } else { of[place][k] };
            }
        }
    }
    std::array::from_fn(|place| {
        let best = (1..WIDTH).fold(0, |best, k| if least[place][k] < least[place][best] { k } else { best });
        of[place][best] * WIDTH as u32 + best as u32
    })
}

/// Those leaves with a site that has certainly more power than none of some `others`, everywhere in the box `middle ± half`.
#[inline(always)]
fn undominated<const N: usize>(
    tree: &SiteTree,
    middle: [f64; 3],
    half: [f64; 3],
    leaves: &[u32],
    others: [u32; N],
) -> Vec<u32> {
    let base = tree.base_weight();
    let others = others.map(|other| {
        let [x, y, z, weight] = tree.site(other);
        let (a, b, c) = (x - middle[0], y - middle[1], z - middle[2]);
        ([x, y, z], weight - base, (a * a) + (b * b) + (c * c))
    });
    let [hx, hy, hz] = half.map(|h| 2.0 * h);
    let mut kept = Vec::with_capacity(leaves.len());
    for &leaf in leaves {
        let Leaf { at: [xs, ys, zs], weight } = tree.leaf(leaf);
        let (mut squares, mut excesses) = ([0.0; WIDTH], [0.0; WIDTH]);
        for k in 0..WIDTH {
            let (x, y, z) = (xs[k] - middle[0], ys[k] - middle[1], zs[k] - middle[2]);
            squares[k] = (x * x) + (y * y) + (z * z);
            excesses[k] = weight[k] - base;
        }
        // By how much each has more power than one of the others at least.
        let mut most = [f64::NEG_INFINITY; WIDTH];
        for ([px, py, pz], excess, square) in others {
            for k in 0..WIDTH {
                let change = (hx * (xs[k] - px).abs()) + (hy * (ys[k] - py).abs()) + (hz * (zs[k] - pz).abs());
                let size = (squares[k] + square) + (excesses[k] + excess);
                let more = (((squares[k] - square) - (excesses[k] - excess)) - change) - (ROUNDINGS * size);
                most[k] = if more > most[k] { more } else { most[k] };
            }
        }
        if most.iter().any(|&more| more <= 0.0) {
            kept.push(leaf);
        }
    }
    kept
}
