//! The order of sites along a Hilbert curve.

use super::WIDTH;
use crate::diagram::bounding_box;
use crate::parallel;
use crate::summation::CHUNK;
use rayon::prelude::*;

/// Bits of the curve along each axis; sites that it cannot tell apart have a curve of their own.
const BITS: u32 = 21;

/// Indices of `positions` along the curve. Sites at one position stand together, the one with the largest weight, then the lowest index, first.
pub(super) fn curve_order(positions: &[[f64; 3]], weight: &(impl Fn(u32) -> f64 + Sync)) -> Vec<u32> {
    let cube = Cube::about(bounding_box(positions));
    let mut keyed: Vec<(u64, u32)> = parallel::map(positions.len(), CHUNK, |i| (cube.key(positions[i]), i as u32));
    keyed.par_sort_unstable();
    let mut order: Vec<u32> = parallel::map(keyed.len(), CHUNK, |k| keyed[k].1);
    for_each_run(&keyed, |run| settle(positions, weight, &mut order[run]));
    order
}

/// Puts sites in order that have one key on a coarser curve.
fn settle(positions: &[[f64; 3]], weight: &(impl Fn(u32) -> f64 + Sync), order: &mut [u32]) {
    let place = |i: u32| positions[i as usize];
    let (lo, hi) = order.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(lo, hi), &i| {
        let p = place(i);
        (std::array::from_fn(|k| f64::min(lo[k], p[k])), std::array::from_fn(|k| f64::max(hi[k], p[k])))
    });
    if order.len() <= WIDTH || lo == hi {
        order.sort_unstable_by(|&i, &j| {
            let ([ax, ay, az], [bx, by, bz]) = (place(i), place(j));
            (ax.total_cmp(&bx).then(ay.total_cmp(&by)).then(az.total_cmp(&bz)))
                .then(weight(j).total_cmp(&weight(i)))
                .then(i.cmp(&j))
        });
        return;
    }
    let cube = Cube::about((lo, hi));
    let mut keyed: Vec<(u64, u32)> = order.iter().map(|&i| (cube.key(place(i)), i)).collect();
    keyed.sort_unstable();
    for (slot, &(_, i)) in order.iter_mut().zip(&keyed) {
        *slot = i;
    }
    for_each_run(&keyed, |run| settle(positions, weight, &mut order[run]));
}

/// Calls `each` with every range of more than one element that have one key.
fn for_each_run(keyed: &[(u64, u32)], mut each: impl FnMut(std::ops::Range<usize>)) {
    let mut begin = 0;
    for chunk in keyed.chunk_by(|a, b| a.0 == b.0) {
        if chunk.len() > 1 {
            each(begin..begin + chunk.len());
        }
        begin += chunk.len();
    }
}

/// A cube of 2^`BITS` voxels along each axis.
struct Cube {
    lo: [f64; 3],
    per_length: f64,
}

impl Cube {
    fn about((lo, hi): ([f64; 3], [f64; 3])) -> Self {
        let extent = (0..3).fold(0.0_f64, |extent, k| extent.max(hi[k] - lo[k]));
        // Of a smallest extent the quotient may be infinite; what overflows is clamped, and the two ends are still told apart.
        let per_length = f64::from(1_u32 << BITS) / extent;
        Self { lo, per_length: if extent > 0.0 { per_length } else { 0.0 } }
    }

    /// Where the curve meets the voxel of `p`.
    fn key(&self, p: [f64; 3]) -> u64 {
        // The cast takes what is not a number for 0, and clamps.
        let axes = std::array::from_fn(|k| (((p[k] - self.lo[k]) * self.per_length) as u32).min((1 << BITS) - 1));
        along_curve(axes)
    }
}

/// The rank of a voxel along the Hilbert curve: level by level that of its octant, as the levels above have turned the curve.
fn along_curve([x, y, z]: [u32; 3]) -> u64 {
    let (mut rank, mut turn) = (0, 0);
    for level in (0..BITS).rev() {
        let octant = x >> level & 1 | (y >> level & 1) << 1 | (z >> level & 1) << 2;
        let (of_octant, inner) = TURNS[turn][octant as usize];
        rank = rank << 3 | u64::from(of_octant);
        turn = usize::from(inner);
    }
    rank
}

/// For each turn of the curve and octant its rank, and the turn within it. A turn is three times the octant where the curve enters, and the axis
/// along which it goes through (Hamilton & Rau-Chaplin 2008).
pub const TURNS: [[(u8, u8); 8]; 24] = turns();

const fn turns() -> [[(u8, u8); 8]; 24] {
    const fn gray(i: u8) -> u8 {
        i ^ i >> 1
    }
    const fn rotated(octant: u8, by: u8) -> u8 {
        (octant << by | octant >> (3 - by)) & 7
    }
    let mut table = [[(0, 0); 8]; 24];
    let mut turn = 0;
    while turn < 24 {
        let (entry, axis) = (turn / 3, turn % 3);
        let by = (axis + 1) % 3;
        let mut octant = 0;
        while octant < 8 {
            let seen = rotated(octant ^ entry, (3 - by) % 3);
            let rank = seen ^ seen >> 1 ^ seen >> 2;
            let (inner_entry, inner_axis) = if rank == 0 {
                (0, 0)
            } else {
                // Of two octants in a row the first is left along the axis that leads to the second.
                (gray((rank - 1) / 2 * 2), (rank - 1 + rank % 2).trailing_ones() as u8 % 3)
            };
            let inner = 3 * (entry ^ rotated(inner_entry, by)) + (axis + inner_axis + 1) % 3;
            table[turn as usize][octant as usize] = (rank, inner);
            octant += 1;
        }
        turn += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Consecutive voxels of a cube of 8³ are neighbours, and each is met once.
    #[test]
    fn the_curve_goes_from_neighbor_to_neighbor() {
        let coarse = 1 << (BITS - 3);
        let mut voxels: Vec<[u32; 3]> = (0..512_u32).map(|n| [n & 7, n >> 3 & 7, n >> 6]).collect();
        voxels.sort_unstable_by_key(|voxel| along_curve(voxel.map(|i| i * coarse)));
        for pair in voxels.windows(2) {
            let steps: u32 = (0..3).map(|k| pair[0][k].abs_diff(pair[1][k])).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
    }

    /// Sites that one curve cannot tell apart are told apart by the next; the order of the caller does not matter.
    #[test]
    fn scales_that_differ_by_any_factor_are_told_apart() {
        let mut positions = vec![[1.0; 3]];
        for scale in [1e-3, 1e-12, 1e-30, 1e-44] {
            positions.extend((1..=40).map(|i| [f64::from(i * i) * scale, f64::from(i) * scale, 0.0]));
        }
        let no_weight = |_: u32| 0.0;
        let order = curve_order(&positions, &no_weight);
        let along: Vec<[f64; 3]> = order.iter().map(|&i| positions[i as usize]).collect();
        let mut backward = positions.clone();
        backward.reverse();
        let again: Vec<[f64; 3]> = curve_order(&backward, &no_weight).iter().map(|&i| backward[i as usize]).collect();
        assert_eq!(along, again);
        // Each scale is one stretch of the curve.
        let changes = along.windows(2).filter(|pair| (pair[0][1].log10() - pair[1][1].log10()).abs() > 5.0).count();
        assert_eq!(changes, 4 - 1, "{along:?}");
    }
}
