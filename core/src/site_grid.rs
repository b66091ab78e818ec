//! The sites, sorted so that neighbours in space are neighbours in memory, with a pyramid over their voxels.

/// Sites per voxel that the resolution aims at, unless a backend asks for another (measured on the CPU: see BENCHMARKS.md).
pub const SITES_PER_VOXEL: f64 = 4.0;

/// Sites in each of the coarse voxels that tell how much of their box the sites fill, where they fill all of it: one in three thousand
/// is empty by chance. How many there are at most, and the smallest share that counts: for the memory of the voxels that stay empty.
const SITES_PER_COARSE_VOXEL: f64 = 8.0;
const MOST_COARSE_VOXELS: f64 = 16384.0;
const SMALLEST_SHARE: f64 = 1.0 / 16.0;

/// A voxel with more sites than this is crowded: a uniform grid is blind inside it, and it gets a tree of its own.
pub const CROWDED: usize = 64;

/// Sites in a leaf of a crowded voxel's tree.
const LEAF: usize = 12;

/// One level of the pyramid: the largest weight of each node's sites, −∞ where there is none. A node of level `l` covers
/// 2ˡ voxels along each axis.
#[derive(Debug)]
pub struct Level {
    /// Nodes along each axis.
    pub dims: [u32; 3],
    /// Largest weight of each node, x fastest.
    pub largest_weight: Vec<f64>,
}

/// A node of the tree inside a crowded voxel: the sites `begin..end`, within a box.
#[derive(Clone, Debug)]
pub struct ClusterNode {
    /// Minimum corner of the sites' bounding box.
    pub lo: [f64; 3],
    /// Maximum corner of the sites' bounding box.
    pub hi: [f64; 3],
    /// Largest weight of the sites.
    pub largest_weight: f64,
    /// First site, in sorted order.
    pub begin: u32,
    /// End of the sites, in sorted order.
    pub end: u32,
    /// Index of the first child, the second follows; 0 for a leaf.
    pub children: u32,
}

/// Cubic voxels over sites.
#[derive(Clone, Copy, Debug)]
pub struct Voxels {
    /// Minimum corner.
    pub lo: [f64; 3],
    /// Width of a voxel.
    pub width: f64,
    /// Number along each axis.
    pub dims: [u32; 3],
    /// How far outside its voxel's box a site can be, by rounding, on each axis. Twice what the rounding of
    /// [`SiteGrid::voxel_of`] can misplace it by: (x − lo)/width errs by 2u relative, at most 2u·dims in voxels, and the
    /// products of the boxes by as much again.
    pub pad: [f64; 3],
}

impl Voxels {
    /// About `wanted` voxels over `[lo, hi]`.
    fn new(lo: [f64; 3], hi: [f64; 3], wanted: f64) -> Self {
        let (width, dims) = resolution(lo, hi, wanted);
        let pad = std::array::from_fn(|k| 8.0 * f64::EPSILON * (f64::from(dims[k]) * width + lo[k].abs()));
        Self { lo, width, dims, pad }
    }

    /// Coarse voxels over `sites` sites within `[lo, hi]`, for [`over_part`](Self::over_part).
    pub fn coarse(lo: [f64; 3], hi: [f64; 3], sites: usize) -> Self {
        Self::new(lo, hi, (sites as f64 / SITES_PER_COARSE_VOXEL).min(MOST_COARSE_VOXELS))
    }

    /// Over `sites` sites within `[lo, hi]`, with about `sites_per_voxel` in each that has any, where of these coarse voxels `filled` have.
    ///
    /// Sites that fill a part of their box, such as those inside a domain, would else crowd in few voxels.
    pub fn over_part(&self, lo: [f64; 3], hi: [f64; 3], sites: usize, filled: usize, sites_per_voxel: f64) -> Self {
        let share = (filled as f64 / self.count() as f64).max(SMALLEST_SHARE);
        Self::new(lo, hi, sites as f64 / (sites_per_voxel * share))
    }

    /// How many voxels.
    pub fn count(&self) -> usize {
        self.dims.iter().map(|&n| n as usize).product()
    }

    /// The voxel that holds position `x`, clamped into the grid.
    pub fn voxel_of(&self, x: [f64; 3]) -> [u32; 3] {
        std::array::from_fn(|k| (((x[k] - self.lo[k]) / self.width) as u32).min(self.dims[k] - 1))
    }

    /// Index of a voxel, x fastest.
    pub fn index(&self, [i, j, k]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.dims;
        ((k as usize * ny as usize) + j as usize) * nx as usize + i as usize
    }

    /// Nodes along each axis of every level of the pyramid, from the voxels up to one node.
    pub fn levels(&self) -> Vec<[u32; 3]> {
        let halved = |dims: &[u32; 3]| (*dims != [1; 3]).then(|| dims.map(|n| n.div_ceil(2)));
        std::iter::successors(Some(self.dims), halved).collect()
    }
}

/// Sites in the internal frame, sorted by voxel.
///
/// Of sites at one position only the one with the largest weight (on a tie the lowest index) is sorted in; the cells of the
/// others are empty and they cannot cut any cell. The order depends on the positions alone, not on the caller's order.
#[derive(Debug)]
pub struct SiteGrid {
    sites: Vec<[f64; 4]>,
    order: Vec<u32>,
    coincident: Vec<u32>,
    voxels: Voxels,
    offsets: Vec<u32>,
    levels: Vec<Level>,
    clusters: Vec<ClusterNode>,
    roots: Vec<u32>,
}

impl SiteGrid {
    /// Sorts `positions` (at least one, in the frame) with `weights` (one for each, or none).
    pub fn new(positions: &[[f64; 3]], weights: &[f64]) -> Self {
        Self::with_density(positions, weights, SITES_PER_VOXEL)
    }

    /// The same, with about `sites_per_voxel` sites in each voxel that has any.
    pub fn with_density(positions: &[[f64; 3]], weights: &[f64], sites_per_voxel: f64) -> Self {
        let (lo, hi) = crate::diagram::bounding_box(positions);
        let coarse = Voxels::coarse(lo, hi, positions.len());
        let mut is_filled = vec![false; coarse.count()];
        for &p in positions {
            is_filled[coarse.index(coarse.voxel_of(p))] = true;
        }
        let filled = is_filled.iter().filter(|&&filled| filled).count();
        let voxels = coarse.over_part(lo, hi, positions.len(), filled, sites_per_voxel);
        let mut grid = Self {
            sites: Vec::with_capacity(positions.len()),
            order: Vec::with_capacity(positions.len()),
            coincident: Vec::new(),
            voxels,
            offsets: Vec::new(),
            levels: Vec::new(),
            clusters: Vec::new(),
            roots: Vec::new(),
        };
        grid.sort(positions, weights);
        grid.build_levels();
        grid.build_clusters();
        grid
    }

    /// Number of sorted sites: all but the coincident ones.
    pub fn len(&self) -> usize {
        self.sites.len()
    }

    /// Never: a diagram has at least one site.
    pub fn is_empty(&self) -> bool {
        self.sites.is_empty()
    }

    /// The sorted sites: x, y, z, weight.
    pub fn sites(&self) -> &[[f64; 4]] {
        &self.sites
    }

    /// The caller's index of each sorted site.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The caller's indices of the sites that a coincident one empties.
    pub fn coincident(&self) -> &[u32] {
        &self.coincident
    }

    /// The pyramid, from the voxels up to one node.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The largest weight of all sites.
    pub fn largest_weight(&self) -> f64 {
        self.levels.last().map_or(f64::NEG_INFINITY, |top| top.largest_weight[0])
    }

    /// Whether some voxel is crowded.
    pub fn has_clusters(&self) -> bool {
        !self.clusters.is_empty()
    }

    /// The nodes of the trees inside crowded voxels.
    pub fn clusters(&self) -> &[ClusterNode] {
        &self.clusters
    }

    /// The root of a voxel's tree, where it is crowded.
    pub fn cluster_root(&self, voxel: usize) -> Option<u32> {
        self.roots.get(voxel).copied().filter(|&root| root != u32::MAX)
    }

    /// The voxel that holds position `x`, clamped into the grid.
    pub fn voxel_of(&self, x: [f64; 3]) -> [u32; 3] {
        self.voxels.voxel_of(x)
    }

    /// Index of a voxel, x fastest.
    pub fn voxel_index(&self, voxel: [u32; 3]) -> usize {
        self.voxels.index(voxel)
    }

    /// The sorted sites in the voxels from index `first` to `last`, inclusive.
    pub fn sites_of_voxels(&self, first: usize, last: usize) -> std::ops::Range<usize> {
        self.offsets[first] as usize..self.offsets[last + 1] as usize
    }

    /// The box of a node: its minimum and maximum corner. Padded by the rounding of [`voxel_of`](Self::voxel_of), so that it
    /// holds each of the node's sites.
    pub fn node_box(&self, level: usize, node: [u32; 3]) -> ([f64; 3], [f64; 3]) {
        let corner = |k: usize, i: u32| self.voxels.lo[k] + f64::from(i << level) * self.voxels.width;
        (
            std::array::from_fn(|k| corner(k, node[k]) - self.voxels.pad[k]),
            std::array::from_fn(|k| corner(k, node[k] + 1) + self.voxels.pad[k]),
        )
    }

    /// Width of a voxel.
    pub fn voxel_width(&self) -> f64 {
        self.voxels.width
    }

    /// The voxels.
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// Where the sites of each voxel begin; one more at the end.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// The root of each voxel's tree, `u32::MAX` where it has none; empty where no voxel is crowded.
    pub fn roots(&self) -> &[u32] {
        &self.roots
    }

    /// The range of voxels along axis `k` that hold every site whose coordinate is within `reach` of `x`.
    pub fn voxels_within(&self, k: usize, x: f64, reach: f64) -> std::ops::RangeInclusive<u32> {
        let index = |x: f64| (((x - self.voxels.lo[k]) / self.voxels.width) as u32).min(self.voxels.dims[k] - 1);
        index(x - reach - self.voxels.pad[k])..=index(x + reach + self.voxels.pad[k])
    }

    /// How far `x` is from the slab of voxels `i` along axis `k`, at least.
    pub fn distance_to_voxel(&self, k: usize, i: u32, x: f64) -> f64 {
        let lo = self.voxels.lo[k] + f64::from(i) * self.voxels.width - self.voxels.pad[k];
        let hi = self.voxels.lo[k] + f64::from(i + 1) * self.voxels.width + self.voxels.pad[k];
        (lo - x).max(x - hi).max(0.0)
    }

    /// Counting sort by voxel; within a voxel by position, so that coincident sites stand together.
    fn sort(&mut self, positions: &[[f64; 3]], weights: &[f64]) {
        let voxels: Vec<u32> = positions.iter().map(|&p| self.voxel_index(self.voxel_of(p)) as u32).collect();
        let count = self.voxels.count();
        let mut starts = vec![0_u32; count + 1];
        for &voxel in &voxels {
            starts[voxel as usize + 1] += 1;
        }
        for voxel in 0..count {
            starts[voxel + 1] += starts[voxel];
        }
        let mut next = starts.clone();
        let mut order = vec![0_u32; positions.len()];
        for (i, &voxel) in voxels.iter().enumerate() {
            let slot = &mut next[voxel as usize];
            order[*slot as usize] = i as u32;
            *slot += 1;
        }
        let weight = |i: u32| weights.get(i as usize).copied().unwrap_or(0.0);
        self.offsets = Vec::with_capacity(count + 1);
        self.offsets.push(0);
        for voxel in 0..count {
            let slice = &mut order[starts[voxel] as usize..starts[voxel + 1] as usize];
            slice.sort_unstable_by(|&i, &j| {
                let ([ax, ay, az], [bx, by, bz]) = (positions[i as usize], positions[j as usize]);
                (ax.total_cmp(&bx).then(ay.total_cmp(&by)).then(az.total_cmp(&bz)))
                    .then(weight(j).total_cmp(&weight(i)))
                    .then(i.cmp(&j))
            });
            let mut last = None;
            for &i in slice.iter() {
                let [x, y, z] = positions[i as usize];
                if last == Some([x, y, z]) {
                    self.coincident.push(i);
                } else {
                    self.sites.push([x, y, z, weight(i)]);
                    self.order.push(i);
                    last = Some([x, y, z]);
                }
            }
            self.offsets.push(self.sites.len() as u32);
        }
    }

    fn build_levels(&mut self) {
        let largest =
            |range: std::ops::Range<usize>| self.sites[range].iter().fold(f64::NEG_INFINITY, |w, s| w.max(s[3]));
        let voxels = self.offsets.len() - 1;
        let mut nodes: Vec<f64> = (0..voxels).map(|v| largest(self.sites_of_voxels(v, v))).collect();
        for dims in self.voxels.levels() {
            if let Some(below) = self.levels.last() {
                nodes = vec![f64::NEG_INFINITY; dims.iter().map(|&n| n as usize).product()];
                let [nx, ny, _] = below.dims.map(|n| n as usize);
                for (node, &w) in below.largest_weight.iter().enumerate() {
                    let (i, j, k) = (node % nx / 2, node / nx % ny / 2, node / nx / ny / 2);
                    let parent = &mut nodes[(k * dims[1] as usize + j) * dims[0] as usize + i];
                    *parent = parent.max(w);
                }
            }
            self.levels.push(Level { dims, largest_weight: std::mem::take(&mut nodes) });
        }
    }

    fn build_clusters(&mut self) {
        for voxel in 0..self.offsets.len() - 1 {
            let range = self.sites_of_voxels(voxel, voxel);
            if range.len() > CROWDED {
                if self.roots.is_empty() {
                    // Node 0 is no root and no child, so that 0 can stand for "leaf".
                    self.clusters.push(self.cluster_node(0..0));
                    self.roots = vec![u32::MAX; self.offsets.len() - 1];
                }
                self.roots[voxel] = self.clusters.len() as u32;
                let root = self.cluster_node(range.clone());
                self.clusters.push(root);
                self.split(self.roots[voxel] as usize);
            }
        }
    }

    fn cluster_node(&self, range: std::ops::Range<usize>) -> ClusterNode {
        let mut node = ClusterNode {
            lo: [f64::INFINITY; 3],
            hi: [f64::NEG_INFINITY; 3],
            largest_weight: f64::NEG_INFINITY,
            begin: range.start as u32,
            end: range.end as u32,
            children: 0,
        };
        for &[x, y, z, w] in &self.sites[range] {
            for (k, coordinate) in [x, y, z].into_iter().enumerate() {
                node.lo[k] = node.lo[k].min(coordinate);
                node.hi[k] = node.hi[k].max(coordinate);
            }
            node.largest_weight = node.largest_weight.max(w);
        }
        node
    }

    /// Splits the sites of a node at the median of its widest axis, down to leaves. The depth is logarithmic.
    fn split(&mut self, index: usize) {
        let node = self.clusters[index].clone();
        let range = node.begin as usize..node.end as usize;
        if range.len() <= LEAF {
            return;
        }
        let extent = |k: &usize| node.hi[*k] - node.lo[*k];
        let axis = (0..3).max_by(|a, b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
        let mut sorted: Vec<([f64; 4], u32)> = range.clone().map(|s| (self.sites[s], self.order[s])).collect();
        let half = sorted.len() / 2;
        sorted.select_nth_unstable_by(half, |(a, _), (b, _)| {
            let compare = |k: usize| a[k].total_cmp(&b[k]);
            compare(axis).then(compare(0)).then(compare(1)).then(compare(2))
        });
        for (slot, (site, order)) in range.clone().zip(sorted) {
            self.sites[slot] = site;
            self.order[slot] = order;
        }
        let children = self.clusters.len();
        self.clusters[index].children = children as u32;
        for part in [range.start..range.start + half, range.start + half..range.end] {
            let child = self.cluster_node(part);
            self.clusters.push(child);
        }
        self.split(children);
        self.split(children + 1);
    }
}

/// Width of the cubic voxels and their number along each axis, such that there are about `voxels`.
fn resolution(lo: [f64; 3], hi: [f64; 3], voxels: f64) -> (f64, [u32; 3]) {
    let extent: [f64; 3] = std::array::from_fn(|k| hi[k] - lo[k]);
    let longest = extent.iter().fold(0.0_f64, |a, &b| a.max(b));
    let wanted = voxels.max(1.0);
    if longest == 0.0 || wanted < 2.0 {
        return (longest.max(f64::MIN_POSITIVE) * 2.0, [1; 3]);
    }
    let dims = |width: f64| extent.map(|e| (e / width).floor() + 1.0);
    let (mut fine, mut coarse) = (longest / (wanted + 1.0), longest * 1.5);
    for _ in 0..60 {
        let middle = (fine * coarse).sqrt();
        if dims(middle).iter().product::<f64>() > wanted {
            fine = middle;
        } else {
            coarse = middle;
        }
    }
    (coarse, dims(coarse).map(|n| n as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scattered(n: usize) -> Vec<[f64; 3]> {
        (0..n).map(|i| [0.754_877, 0.569_840, 0.430_159].map(|a| (i as f64 * a).fract())).collect()
    }

    #[test]
    fn every_site_stands_once_in_its_voxel() {
        let positions = scattered(1000);
        let weights: Vec<f64> = (0..1000).map(|i| f64::from(i % 17)).collect();
        let grid = SiteGrid::new(&positions, &weights);
        let mut seen = vec![false; 1000];
        for (sorted, &original) in grid.order().iter().enumerate() {
            let [x, y, z, w] = grid.sites()[sorted];
            assert_eq!((positions[original as usize], weights[original as usize]), ([x, y, z], w));
            assert!(!std::mem::replace(&mut seen[original as usize], true));
            let voxel = grid.voxel_of([x, y, z]);
            let index = grid.voxel_index(voxel);
            assert!(grid.sites_of_voxels(index, index).contains(&sorted));
            for level in 0..grid.levels().len() {
                let node = voxel.map(|i| i >> level);
                let (lo, hi) = grid.node_box(level, node);
                assert!((0..3).all(|k| lo[k] <= [x, y, z][k] && [x, y, z][k] <= hi[k]));
                let dims = grid.levels()[level].dims;
                let index = (node[2] * dims[1] + node[1]) * dims[0] + node[0];
                assert!(grid.levels()[level].largest_weight[index as usize] >= w);
            }
        }
        assert!(seen.iter().all(|&s| s));
    }

    #[test]
    fn voxels_are_sized_for_the_part_that_sites_fill() {
        let mean = |positions: &[[f64; 3]]| {
            let grid = SiteGrid::new(positions, &[]);
            let filled = grid.offsets().windows(2).filter(|pair| pair[0] < pair[1]).count();
            positions.len() as f64 / filled as f64
        };
        let roberts = |i: u32| [0.819_173, 0.671_044, 0.549_700].map(|a| (f64::from(i) * a).fract());
        let all: Vec<_> = (0..20_000).map(roberts).collect();
        let part: Vec<_> = all.iter().map(|p| p.map(|x| 0.5 * x)).chain([[1.0; 3]]).collect();
        assert!((mean(&part) / mean(&all) - 1.0).abs() < 0.25, "{} and {}", mean(&part), mean(&all));
    }

    #[test]
    fn the_order_is_that_of_the_positions() {
        let positions = scattered(500);
        let reversed: Vec<_> = positions.iter().rev().copied().collect();
        assert_eq!(SiteGrid::new(&positions, &[]).sites(), SiteGrid::new(&reversed, &[]).sites());
    }

    #[test]
    fn of_coincident_sites_the_heaviest_then_the_first_remains() {
        let p = [0.5; 3];
        let q = [0.25; 3];
        let grid = SiteGrid::new(&[p, q, p, p, q], &[1.0, 0.0, 3.0, 3.0, 0.0]);
        let mut order = grid.order().to_vec();
        order.sort_unstable();
        assert_eq!(order, [1, 2]);
        let mut coincident = grid.coincident().to_vec();
        coincident.sort_unstable();
        assert_eq!(coincident, [0, 3, 4]);
    }

    #[test]
    fn crowded_voxels_are_covered_by_leaves() {
        let mut positions: Vec<[f64; 3]> = scattered(2000).iter().map(|p| p.map(|x| x * 1e-6)).collect();
        positions.push([1.0; 3]);
        let grid = SiteGrid::new(&positions, &[]);
        let root = grid.cluster_root(0).expect("one voxel holds all but one site");
        let mut stack = vec![root];
        let mut covered = 0;
        while let Some(index) = stack.pop() {
            let node = &grid.clusters()[index as usize];
            for site in &grid.sites()[node.begin as usize..node.end as usize] {
                assert!((0..3).all(|k| node.lo[k] <= site[k] && site[k] <= node.hi[k]));
            }
            if node.children == 0 {
                covered += node.end - node.begin;
            } else {
                stack.extend([node.children, node.children + 1]);
            }
        }
        assert_eq!(covered, 2000);
    }
}
