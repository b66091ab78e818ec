//! Where the voxels are.

/// Cubic voxels whose corners `lo + i·width` are exact in f64: both are multiples of 2⁻⁴⁰ and their sum is below 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    pub(super) lo: [f64; 3],
    pub(super) width: f64,
    pub(super) dims: [u32; 3],
}

/// Spacing of the numbers that corners are taken from, 2⁻⁴⁰, and its inverse.
const QUANTUM: f64 = 1.0 / QUANTA;
const QUANTA: f64 = 1_099_511_627_776.0;

impl Lattice {
    /// Voxels around the box `[lo, hi]` (a frame's: within ±2, largest extent in (½, 1]), about `resolution` along its
    /// largest extent. The low margin is `0.5 + 0.25 · fraction` voxels on each axis, the high one at least ¼.
    pub(super) fn around(lo: [f64; 3], hi: [f64; 3], resolution: f64, fractions: [f64; 3]) -> Self {
        let extent = (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max);
        let width = (extent / resolution * QUANTA).ceil().max(1.0) * QUANTUM;
        let lo = std::array::from_fn(|k| ((lo[k] - width * (0.5 + 0.25 * fractions[k])) * QUANTA).floor() * QUANTUM);
        let dims = std::array::from_fn(|k| ((hi[k] + 0.25 * width - lo[k]) / width).ceil() as u32);
        Self { lo, width, dims }
    }

    pub(super) fn voxels(&self) -> usize {
        self.dims.iter().map(|&d| d as usize).product()
    }

    pub(super) fn coordinate(&self, axis: usize, i: u32) -> f64 {
        self.lo[axis] + f64::from(i) * self.width
    }

    pub(super) fn voxel_of(&self, axis: usize, x: f64) -> u32 {
        let i = (((x - self.lo[axis]) / self.width) as u32).min(self.dims[axis] - 1);
        // Rounding is monotone and leaves corners as they are, so the quotient may only be rounded up to the next one.
        if i > 0 && self.coordinate(axis, i) > x { i - 1 } else { i }
    }

    pub(super) fn voxel_index(&self, [i, j, k]: [u32; 3]) -> usize {
        i as usize + self.dims[0] as usize * (j as usize + self.dims[1] as usize * k as usize)
    }
}
