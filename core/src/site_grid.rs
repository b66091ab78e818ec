//! The sites, sorted so that neighbours in space are neighbours in memory, with a pyramid over their voxels.

mod voxels;

pub use voxels::Voxels;

/// Sites per voxel that the resolution aims at, unless a backend asks for another (measured on the CPU: see BENCHMARKS.md).
pub const SITES_PER_VOXEL: f64 = 4.0;

/// A voxel with more sites than this is crowded: a uniform grid is blind inside it, and the tree over all sites is searched instead.
pub const CROWDED: usize = 64;

/// One level of the pyramid: the largest weight of each node's sites, −∞ where there is none. A node of level `l` covers
/// 2ˡ voxels along each axis.
#[derive(Debug)]
pub struct Level {
    /// Nodes along each axis.
    pub dims: [u32; 3],
    /// Largest weight of each node, x fastest.
    pub largest_weight: Vec<f64>,
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
        };
        grid.sort(positions, weights);
        grid.build_levels();
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
}

#[cfg(test)]
mod tests;
