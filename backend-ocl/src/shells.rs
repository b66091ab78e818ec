//! The table of voxel offsets, nearest first, that the kernels go through.

use crate::interface::data::SHELL_RADIUS;

/// Offsets of up to [`SHELL_RADIUS`] along each axis, plus that, and a lower bound of the squared distance in voxels between the nearest points of this voxel and the first, and
/// of any later one and the first, in the table or not; sorted by that distance, then by the distance of their centers.
pub(crate) fn table() -> Vec<[u8; 4]> {
    let radius = SHELL_RADIUS as i32;
    let span = -radius..=radius;
    let mut offsets: Vec<[i32; 3]> =
        span.clone().flat_map(|x| span.clone().flat_map(move |y| (-radius..=radius).map(move |z| [x, y, z]))).collect();
    let apart = |o: &[i32; 3]| o.iter().map(|&i| (i.abs() - 1).max(0).pow(2)).sum::<i32>();
    let centers = |o: &[i32; 3]| o.iter().map(|&i| i * i).sum::<i32>();
    offsets.sort_by_key(|o| (apart(o), centers(o)));
    let entry = |o: &[i32; 3]| {
        let [x, y, z] = o.map(|i| (i + radius) as u8);
        // Beyond the table there are voxels nearer than its corners: none may be left out for one of these being too far.
        [x, y, z, apart(o).min(radius.pow(2)) as u8]
    };
    offsets.iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use crate::interface::data::{INNER_SHELLS, SHELL_RADIUS, SHELLS};
    use laguerre_core::cell::table::TRIED_OFFSETS;

    #[test]
    fn the_first_rings_are_where_the_search_looks() {
        let (table, center, last) = (super::table(), SHELL_RADIUS as u8, SHELL_RADIUS.pow(2) as u8);
        assert_eq!(table.len(), SHELLS as usize);
        assert_eq!(table[0], [center, center, center, 0]);
        // After the own voxel: 6 faces, 12 edges, 8 corners, all at distance 0.
        assert_eq!([INNER_SHELLS, TRIED_OFFSETS], [27; 2]);
        assert!(table[..27].iter().all(|e| e[3] == 0) && table[27][3] == 1);
        assert!(table.is_sorted_by_key(|e| e[3]));
        // Between the nearest voxel that is not in the table and the first there are as many others as the radius.
        assert!(table.iter().all(|e| e[3] <= last));
    }
}
