//! The search for the sites that cut a cell: the block of voxels around it, then the pyramid from its root, nearest first.

use crate::cell::{self, CellStore, EMPTY, Real, V3, bisector, box_cannot_cut, farthest_vertex, security_reach, v3};
use crate::diagram::Prepared;

/// A block of 3×3×3 voxels with more sites than this is searched by the tree instead.
const CROWDED_BLOCK: usize = 256;

/// Sites in a node from which on the sharp test costs less than what it saves.
const WORTH_SHARP_TEST: usize = 8;

/// Voxels around a site's own, along each axis, up to which rows of voxels are searched instead of the pyramid.
const ROWS: Real = 4.0;

/// Candidates between two looks at whether the cell already lies outside the domain.
const BETWEEN_LOOKS: usize = 8;

/// Voxels from a site to its cell's farthest vertex beyond which what is outside the domain is cut off.
const CAP_FROM: Real = 1.5;

/// The same from which on the cell is cut by a sample of all sites before; and its size.
const SAMPLE_FROM: Real = 4.0;
const SAMPLE: usize = 512;

/// Finds near sites where they are crowded and a uniform grid is blind.
pub trait Nearest: Sync {
    /// Fills `indices` with some sites of least power distance from `point`, as sorted indices, nearest first.
    fn nearest(&self, point: [f64; 3], indices: &mut Vec<u32>);
}

/// A candidate as one number to sort by: its squared distance, rounded to `f32`, then its sorted index.
type Candidate = u64;

/// A box of sites still to be searched.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// A lower bound of the sites' power distance from the cell's site.
    power: Real,
    kind: NodeKind,
}

#[derive(Clone, Copy, Debug)]
enum NodeKind {
    Level(u32, [u32; 3]),
    Cluster(u32),
}

/// The buffers of one thread's searches.
#[derive(Debug, Default)]
pub struct Search {
    candidates: Vec<Candidate>,
    nearest: Vec<u32>,
    nodes: Vec<Node>,
    children: Vec<Node>,
}

/// One cell's search.
struct CellSearch<'a, S> {
    store: &'a mut S,
    prepared: &'a Prepared,
    site: u32,
    position: [f64; 3],
    weight: Real,
    /// Upper bound of the distance to the farthest vertex.
    farthest: Real,
    /// `Some(1 + ε)`: stop at the paper's enlarged security radius, uncertified.
    enlarged: Option<Real>,
    outcome: Outcome,
    /// Whether sites from all over have cut it.
    is_sampled: bool,
}

/// How a search ended.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// `COMPLETE`, `EMPTY`, or what makes the cell be tried again.
    pub status: u32,
    /// Whether `epsilon` left out sites that might cut the cell.
    pub uncertified: bool,
    /// Sites visited.
    pub visited: u32,
}

impl Search {
    /// Cuts the cell of sorted site `site` until no other site can cut it.
    ///
    /// `clusters` helps where sites are crowded; without it the trees inside the voxels do.
    pub fn complete<S: CellStore>(
        &mut self,
        store: &mut S,
        prepared: &Prepared,
        clusters: Option<&dyn Nearest>,
        site: u32,
        epsilon: Option<Real>,
    ) -> Outcome {
        let [x, y, z, weight] = prepared.sites.sites()[site as usize];
        let relative = |c: [f64; 3]| v3(c[0] - x, c[1] - y, c[2] - z);
        let status = cell::begin(store, relative(prepared.container.lo), relative(prepared.container.hi));
        let outcome = Outcome { status, uncertified: false, visited: 0 };
        if status != cell::COMPLETE {
            return outcome;
        }
        let farthest = farthest_vertex(store);
        let enlarged = epsilon.map(|e| 1.0 + e);
        let position = [x, y, z];
        let is_sampled = false;
        let mut search =
            CellSearch { store, prepared, site, position, weight, farthest, enlarged, outcome, is_sampled };
        let block = self.gather_block(&search, clusters);
        // Cells outside the domain need not be complete to be known empty.
        for some in self.candidates.chunks(BETWEEN_LOOKS) {
            for &candidate in some {
                if !search.visit(candidate as u32) {
                    return search.outcome;
                }
            }
            if cell::lies_outside(search.store) != 0 {
                search.outcome.status = EMPTY;
                return search.outcome;
            }
        }
        let width = prepared.sites.voxel_width();
        let is_far = prepared.domain_grid().is_some() && search.farthest >= CAP_FROM * width;
        if !is_far || search.cap(width) {
            self.visit_rest(&mut search, block);
        }
        search.outcome
    }

    /// Fills the candidates, nearest first, with the sites of the voxels around the cell's own, or with the nearest sites where those
    /// are crowded. Returns the block of voxels that need not be visited again.
    fn gather_block<S: CellStore>(
        &mut self,
        search: &CellSearch<'_, S>,
        clusters: Option<&dyn Nearest>,
    ) -> Option<[[u32; 3]; 2]> {
        let grid = &search.prepared.sites;
        let dims = grid.levels()[0].dims;
        let center = grid.voxel_of(search.position);
        let lo = center.map(|i| i.saturating_sub(1));
        let hi: [u32; 3] = std::array::from_fn(|k| (center[k] + 1).min(dims[k] - 1));
        let mut rows = [const { 0..0 }; 9];
        let mut count = 0;
        for (row, slot) in (lo[2]..=hi[2]).flat_map(|k| (lo[1]..=hi[1]).map(move |j| (j, k))).zip(&mut rows) {
            let (j, k) = row;
            *slot = grid.sites_of_voxels(grid.voxel_index([lo[0], j, k]), grid.voxel_index([hi[0], j, k]));
            count += slot.len();
        }
        self.candidates.clear();
        self.nearest.clear();
        if let Some(clusters) = clusters.filter(|_| count > CROWDED_BLOCK) {
            clusters.nearest(search.position, &mut self.nearest);
            self.candidates.extend(self.nearest.iter().filter(|&&j| j != search.site).map(|&j| u64::from(j)));
            self.nearest.sort_unstable();
            return None;
        }
        for row in rows {
            for j in row {
                if j != search.site as usize {
                    self.candidates.push(search.candidate(j as u32));
                }
            }
        }
        self.candidates.sort_unstable();
        Some([lo, hi])
    }

    /// Visits every site that may cut the cell, but for the voxels of `block`.
    fn visit_rest<S: CellStore>(&mut self, search: &mut CellSearch<'_, S>, block: Option<[[u32; 3]; 2]>) {
        let grid = &search.prepared.sites;
        let reach = security_reach(search.farthest, grid.largest_weight() - search.weight);
        match block {
            Some(block) if search.enlarged.is_none() && reach < ROWS * grid.voxel_width() => search.visit_rows(block),
            _ => self.descend(search, block),
        }
    }

    /// Visits every node that may hold a site that cuts the cell, nearest first, but for the voxels of `block`.
    fn descend<S: CellStore>(&mut self, search: &mut CellSearch<'_, S>, block: Option<[[u32; 3]; 2]>) {
        let grid = &search.prepared.sites;
        self.nodes.clear();
        let root = NodeKind::Level(grid.levels().len() as u32 - 1, [0; 3]);
        self.nodes.push(Node { power: 0.0, kind: root });
        while let Some(node) = self.nodes.pop() {
            let (range, children) = match node.kind {
                NodeKind::Level(level, index) => {
                    if level > 0 {
                        if search.can_skip_level(level as usize, index, true) {
                            continue;
                        }
                        self.push_children(search, level as usize - 1, index);
                        continue;
                    }
                    let inside = |[lo, hi]: [[u32; 3]; 2]| (0..3).all(|k| lo[k] <= index[k] && index[k] <= hi[k]);
                    if block.is_some_and(inside) {
                        continue;
                    }
                    let voxel = grid.voxel_index(index);
                    let range = grid.sites_of_voxels(voxel, voxel);
                    if search.can_skip_level(0, index, range.len() >= WORTH_SHARP_TEST) {
                        continue;
                    }
                    (range, grid.cluster_root(voxel))
                }
                NodeKind::Cluster(index) => {
                    let cluster = &grid.clusters()[index as usize];
                    if search.can_skip(cluster.lo, cluster.hi, cluster.largest_weight, true) {
                        continue;
                    }
                    let range = cluster.begin as usize..cluster.end as usize;
                    (range, Some(cluster.children).filter(|&first| first != 0))
                }
            };
            if let Some(first) = children {
                let is_root = matches!(node.kind, NodeKind::Level(..));
                let pair = if is_root { first..first + 1 } else { first..first + 2 };
                self.children.clear();
                self.children.extend(pair.map(|index| {
                    let cluster = &grid.clusters()[index as usize];
                    let power = search.least_power(cluster.lo, cluster.hi, cluster.largest_weight);
                    Node { power, kind: NodeKind::Cluster(index) }
                }));
                self.push_nearest_last();
                continue;
            }
            for site in range {
                let site = site as u32;
                // A plane must not come twice: its own vertices would all lie on it.
                if site == search.site || self.nearest.binary_search(&site).is_ok() {
                    continue;
                }
                if !search.visit(site) {
                    return;
                }
            }
        }
    }

    fn push_children<S: CellStore>(&mut self, search: &CellSearch<'_, S>, level: usize, parent: [u32; 3]) {
        let dims = search.prepared.sites.levels()[level].dims;
        self.children.clear();
        for child in 0..8_u32 {
            let index = [parent[0] * 2 + (child & 1), parent[1] * 2 + (child >> 1 & 1), parent[2] * 2 + (child >> 2)];
            if (0..3).any(|k| index[k] >= dims[k]) {
                continue;
            }
            let largest = search.largest_weight(level, index);
            if largest == Real::NEG_INFINITY {
                continue;
            }
            let (lo, hi) = search.prepared.sites.node_box(level, index);
            let power = search.least_power(lo, hi, largest);
            self.children.push(Node { power, kind: NodeKind::Level(level as u32, index) });
        }
        self.push_nearest_last();
    }

    /// Moves the children to the stack such that the nearest is popped first.
    fn push_nearest_last(&mut self) {
        self.children.sort_unstable_by(|a, b| b.power.total_cmp(&a.power));
        self.nodes.append(&mut self.children);
    }
}

impl<S: CellStore> CellSearch<'_, S> {
    #[inline(always)]
    fn difference(&self, site: u32) -> (V3, Real) {
        let [x, y, z, w] = self.prepared.sites.sites()[site as usize];
        let [px, py, pz] = self.position;
        (v3(x - px, y - py, z - pz), w)
    }

    #[inline(always)]
    fn candidate(&self, site: u32) -> Candidate {
        let (d, _) = self.difference(site);
        // The bits of a positive number are in its order.
        u64::from((square(d) as f32).to_bits()) << 32 | u64::from(site)
    }

    /// Visits the sites of the voxels that the ball of the security radius meets, row by row, but for those of `block`.
    fn visit_rows(&mut self, [lo, hi]: [[u32; 3]; 2]) {
        let grid = &self.prepared.sites;
        let [x, y, z] = self.position;
        let extra = grid.largest_weight() - self.weight;
        let reach = security_reach(self.farthest, extra);
        for k in grid.voxels_within(2, z, reach) {
            for j in grid.voxels_within(1, y, reach) {
                let (dy, dz) = (grid.distance_to_voxel(1, j, y), grid.distance_to_voxel(2, k, z));
                let reach = security_reach(self.farthest, extra);
                let left = reach * reach - (dy * dy + dz * dz);
                if left <= 0.0 {
                    continue;
                }
                let across = grid.voxels_within(0, x, left.sqrt());
                let (first, last) = (*across.start(), *across.end());
                let in_block = (lo[1]..=hi[1]).contains(&j) && (lo[2]..=hi[2]).contains(&k);
                let ranges =
                    if in_block { [(first, lo[0]), (hi[0] + 1, last + 1)] } else { [(first, last + 1), (0, 0)] };
                for (begin, end) in ranges {
                    if begin >= end {
                        continue;
                    }
                    let row = grid.sites_of_voxels(grid.voxel_index([begin, j, k]), grid.voxel_index([end - 1, j, k]));
                    for site in row {
                        if !self.visit(site as u32) {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// Cuts off what of the cell is far outside the domain; `false` ends the search. (Apart from what all cells need, which would else be
    /// a tenth slower.)
    #[cold]
    #[inline(never)]
    fn cap(&mut self, width: Real) -> bool {
        if !self.cap_once(CAP_FROM * width) {
            return false;
        }
        if self.farthest < SAMPLE_FROM * width {
            return true;
        }
        // It still reaches to other parts of the domain, which keep it from being cut off: some sites there make it end half-way.
        self.is_sampled = true;
        let sites = self.prepared.sites.len();
        let sample = (0..SAMPLE.min(sites)).map(|i| (i * sites / SAMPLE.min(sites)) as u32);
        for site in sample {
            if site != self.site && !self.visit(site) {
                return false;
            }
        }
        self.cap_once(CAP_FROM * width)
    }

    fn cap_once(&mut self, radius: Real) -> bool {
        match cell::cap_outside(self.store, radius) {
            cell::UNTOUCHED => true,
            cell::CUT => {
                self.farthest = farthest_vertex(self.store);
                true
            }
            status => {
                self.outcome.status = status;
                false
            }
        }
    }

    /// Cuts the cell by the bisector with `site` unless it is out of reach; `false` ends the search.
    #[inline(always)]
    fn visit(&mut self, site: u32) -> bool {
        let (d, w) = self.difference(site);
        if self.out_of_reach(square(d), w) {
            return true;
        }
        // A plane must not come twice: its own vertices would all lie on it.
        if self.is_sampled && self.has_cut(site) {
            return true;
        }
        self.outcome.visited += 1;
        let status = cell::clip(self.store, bisector(d, self.weight - w), site);
        match status {
            cell::UNTOUCHED => true,
            cell::CUT => {
                self.farthest = farthest_vertex(self.store);
                true
            }
            _ => {
                self.outcome.status = status;
                false
            }
        }
    }

    #[cold]
    fn has_cut(&self, site: u32) -> bool {
        (0..self.store.planes()).any(|f| self.store.tag(f) == site)
    }

    /// Whether sites of weight at most `largest`, at squared distance at least `square`, can be left out: by the quick test, or because
    /// `epsilon` says so.
    #[inline(always)]
    fn out_of_reach(&mut self, square: Real, largest: Real) -> bool {
        let reach = security_reach(self.farthest, largest - self.weight);
        if square >= reach * reach {
            return true;
        }
        if let Some(enlarged) = self.enlarged {
            let reach = enlarged * security_reach(self.farthest, 0.0);
            if square >= reach * reach {
                self.outcome.uncertified = true;
                return true;
            }
        }
        false
    }

    fn largest_weight(&self, level: usize, [i, j, k]: [u32; 3]) -> Real {
        let level = &self.prepared.sites.levels()[level];
        let [nx, ny, _] = level.dims;
        level.largest_weight[(k as usize * ny as usize + j as usize) * nx as usize + i as usize]
    }

    fn can_skip_level(&mut self, level: usize, index: [u32; 3], sharp: bool) -> bool {
        let (lo, hi) = self.prepared.sites.node_box(level, index);
        self.can_skip(lo, hi, self.largest_weight(level, index), sharp)
    }

    /// Whether no site in the box can cut the cell: the quick test, then the sharp one.
    fn can_skip(&mut self, lo: [f64; 3], hi: [f64; 3], largest: Real, sharp: bool) -> bool {
        if largest == Real::NEG_INFINITY {
            return true;
        }
        if self.out_of_reach(self.square_distance(lo, hi), largest) {
            return true;
        }
        let [x, y, z] = self.position;
        let relative = |c: [f64; 3]| v3(c[0] - x, c[1] - y, c[2] - z);
        sharp && box_cannot_cut(self.store, relative(lo), relative(hi), largest - self.weight) != 0
    }

    /// A lower bound of the power distance from the cell's site to any site in the box.
    fn least_power(&self, lo: [f64; 3], hi: [f64; 3], largest: Real) -> Real {
        self.square_distance(lo, hi) - largest
    }

    /// Squared distance from the cell's site to the box.
    fn square_distance(&self, lo: [f64; 3], hi: [f64; 3]) -> Real {
        let gap = |k: usize| (lo[k] - self.position[k]).max(self.position[k] - hi[k]).max(0.0);
        ((gap(0) * gap(0)) + (gap(1) * gap(1))) + (gap(2) * gap(2))
    }
}

#[inline(always)]
fn square(d: V3) -> Real {
    ((d.x * d.x) + (d.y * d.y)) + (d.z * d.z)
}
