//! How many voxels, and which of them a place is in.

/// Sites in each of the coarse voxels that tell how much of their box the sites fill, where they fill all of it: one in three thousand
/// is empty by chance. How many there are at most, and the smallest share that counts: for the memory of the voxels that stay empty.
const SITES_PER_COARSE_VOXEL: f64 = 8.0;
const MOST_COARSE_VOXELS: f64 = 16384.0;
const SMALLEST_SHARE: f64 = 1.0 / 16.0;

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
    /// [`Self::voxel_of`] can misplace it by: (x − lo)/width errs by 2u relative, at most 2u·dims in voxels, and the
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
        Self::new(lo, hi, Self::most_coarse(sites) as f64)
    }

    /// How many of these there are at most.
    pub fn most_coarse(sites: usize) -> usize {
        (sites as f64 / SITES_PER_COARSE_VOXEL).clamp(1.0, MOST_COARSE_VOXELS) as usize
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
