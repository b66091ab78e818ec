//! Trees in crowded voxels.

use super::{CROWDED, SiteGrid};

/// Sites in a leaf of a crowded voxel's tree.
const LEAF: usize = 12;

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

impl SiteGrid {
    pub(super) fn build_clusters(&mut self) {
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
