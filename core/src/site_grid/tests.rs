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
