//! How many voxels the table over the sites has.

/// Sites in each of the coarse voxels that tell how much of their box the sites fill, where they fill all of it: one in three thousand
/// is empty by chance. How many there are at most, and the smallest share that counts: for the memory of the voxels that stay empty.
const SITES_PER_COARSE_VOXEL: f64 = 8.0;
const MOST_COARSE_VOXELS: f64 = 16384.0;
const SMALLEST_SHARE: f64 = 1.0 / 16.0;

/// Cubic voxels over sites.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Voxels {
    /// Minimum corner.
    pub(crate) lo: [f64; 3],
    /// Width of a voxel.
    pub(crate) width: f64,
    /// Number along each axis.
    pub(crate) dims: [u32; 3],
}

impl Voxels {
    /// About `wanted` voxels over `[lo, hi]`.
    fn new(lo: [f64; 3], hi: [f64; 3], wanted: f64) -> Self {
        let (width, dims) = resolution(lo, hi, wanted);
        Self { lo, width, dims }
    }

    /// Coarse voxels over `sites` sites within `[lo, hi]`, for [`over_part`](Self::over_part).
    pub(crate) fn coarse(lo: [f64; 3], hi: [f64; 3], sites: usize) -> Self {
        Self::new(lo, hi, Self::most_coarse(sites) as f64)
    }

    /// How many of these there are at most.
    pub(crate) fn most_coarse(sites: usize) -> usize {
        (sites as f64 / SITES_PER_COARSE_VOXEL).clamp(1.0, MOST_COARSE_VOXELS) as usize
    }

    /// Over `sites` sites within `[lo, hi]`, with about `sites_per_voxel` in each that has any, where of these coarse voxels `filled` have.
    ///
    /// Sites that fill a part of their box, such as those inside a domain, would else crowd in few voxels.
    pub(crate) fn over_part(
        &self,
        lo: [f64; 3],
        hi: [f64; 3],
        sites: usize,
        filled: usize,
        sites_per_voxel: f64,
    ) -> Self {
        let share = (filled as f64 / self.count() as f64).max(SMALLEST_SHARE);
        Self::new(lo, hi, sites as f64 / (sites_per_voxel * share))
    }

    /// How many voxels.
    pub(crate) fn count(&self) -> usize {
        self.dims.iter().map(|&n| n as usize).product()
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

    /// Sites in each voxel that has any, on average.
    fn mean(positions: &[[f64; 3]]) -> f64 {
        let filled = |voxels: &Voxels| {
            let voxel = |p: &[f64; 3]| -> [u32; 3] {
                std::array::from_fn(|k| (((p[k] - voxels.lo[k]) / voxels.width) as u32).min(voxels.dims[k] - 1))
            };
            positions.iter().map(voxel).collect::<std::collections::HashSet<_>>().len()
        };
        let (lo, hi) = laguerre_core::diagram::bounding_box(positions);
        let coarse = Voxels::coarse(lo, hi, positions.len());
        let voxels = coarse.over_part(lo, hi, positions.len(), filled(&coarse), 4.0);
        positions.len() as f64 / filled(&voxels) as f64
    }

    #[test]
    fn voxels_are_sized_for_the_part_that_sites_fill() {
        let roberts = |i: u32| [0.819_173, 0.671_044, 0.549_700].map(|a| (f64::from(i) * a).fract());
        let all: Vec<_> = (0..20_000).map(roberts).collect();
        let part: Vec<_> = all.iter().map(|p| p.map(|x| 0.5 * x)).chain([[1.0; 3]]).collect();
        assert!((mean(&part) / mean(&all) - 1.0).abs() < 0.25, "{} and {}", mean(&part), mean(&all));
    }
}
