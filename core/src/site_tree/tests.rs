use super::*;

/// Points of several scales and a plane, with weights that curve, vary at random, or are all equal.
fn clouds() -> Vec<(Vec<[f64; 3]>, Vec<f64>)> {
    let point = |i: usize| [2_f64, 3.0, 5.0].map(|x| ((i * i) as f64 * x.sqrt()).fract());
    let white: Vec<[f64; 3]> = (1..=1500).map(point).collect();
    let scales =
        white.iter().enumerate().map(|(i, p)| p.map(|x| 0.3 + x * 10_f64.powi(-((i % 4) as i32) * 3))).collect();
    let flat: Vec<[f64; 3]> = white.iter().map(|&[x, y, _]| [x, y, 0.25 * x + 0.5 * y]).collect();
    let curved = |p: &[f64; 3]| 0.8 * p[0] * p[0] - 2.0 * p[1] * p[1] + 0.3 * p[2] + 100.0;
    let random = |p: &[f64; 3]| (1e4 * p[0]).fract();
    vec![
        (white.clone(), Vec::new()),
        (white.clone(), white.iter().map(curved).collect()),
        (white.clone(), white.iter().map(random).collect()),
        (flat.clone(), flat.iter().map(curved).collect()),
        (scales, white.iter().map(random).collect()),
        (white[..5].to_vec(), white[..5].iter().map(curved).collect()),
    ]
}

/// Every bound of a node holds for each of its sites: box, slab, weight.
#[test]
fn what_bounds_a_node_holds_for_its_sites() {
    for (positions, weights) in clouds() {
        let tree = SiteTree::new(&positions, &weights);
        assert_eq!(tree.has_weights(), !weights.is_empty());
        let mut held = 0;
        for (i, [x, y, z, w]) in tree.sites().enumerate() {
            let (mut block, mut k) = (i / (WIDTH * WIDTH), i / WIDTH % WIDTH);
            assert_eq!(tree.around(i / WIDTH).0 == block, tree.root() == block);
            loop {
                let (boxes, slabs) = (tree.boxes(block), tree.slabs(block));
                let (at, middle) = ([x, y, z], boxes.middle(k));
                assert!((0..3).all(|axis| boxes.lo[axis][k] <= at[axis] && at[axis] <= boxes.hi[axis][k]));
                let height: f64 = (0..3).map(|axis| slabs.normal[axis][k] * at[axis]).sum();
                assert!(slabs.lo[k] <= height && height <= slabs.hi[k], "{} {height} {}", slabs.lo[k], slabs.hi[k]);
                let more = w - tree.base_weight();
                assert!(more <= slabs.largest_weight[k]);
                if tree.has_weights() {
                    let bounds = tree.weights(block);
                    let term = |axis: usize| {
                        let u = at[axis] - middle[axis];
                        (bounds.g[axis][k] + bounds.q[axis][k] * u) * u
                    };
                    assert!(more <= bounds.c[k] + (term(0) + term(1) + term(2)));
                }
                held += 1;
                if block == tree.root() {
                    break;
                }
                let parent = (block + 1..=tree.root())
                    .find(|&b| !tree.is_leaf(b) && (0..WIDTH).any(|child| tree.child(b, child) == block));
                let parent = parent.unwrap();
                k = (0..WIDTH).find(|&child| tree.child(parent, child) == block).unwrap();
                block = parent;
            }
        }
        assert!(held >= positions.len());
    }
}

/// A quadratic bound follows quadratic weights: it is not the largest weight everywhere.
#[test]
fn bounds_follow_smooth_weights() {
    let (positions, weights) = clouds().swap_remove(1);
    let tree = SiteTree::new(&positions, &weights);
    let bounds = tree.weights(tree.root());
    let constant = (0..WIDTH).all(|k| (0..3).all(|axis| bounds.g[axis][k] == 0.0 && bounds.q[axis][k] == 0.0));
    assert!(!constant);
}

#[test]
fn blocks_of_leaves_are_bounded_before_their_leaves() {
    for (levels, order) in [(1, vec![0]), (2, vec![1, 0]), (5, vec![1, 0, 2, 3, 4])] {
        assert_eq!(order_of_levels(levels).collect::<Vec<_>>(), order);
    }
}

/// Leaves, of eight sites, have the curvature of the block that they are in: what bounds quadratic weights are these.
#[test]
fn bounds_of_leaves_curve_as_their_block_does() {
    let (positions, _) = clouds().swap_remove(0);
    let weight = |[x, y, z]: [f64; 3]| 0.9 * x * x - 2.0 * y * y + 0.5 * z * z + x;
    let weights: Vec<f64> = positions.iter().map(|&p| weight(p)).collect();
    let tree = SiteTree::new(&positions, &weights);
    // (The last block may have too few sites.)
    for (i, [x, y, z, w]) in tree.sites().enumerate().take(positions.len() / (WIDTH * WIDTH) * WIDTH * WIDTH) {
        let (block, k) = (i / (WIDTH * WIDTH), i / WIDTH % WIDTH);
        let (bounds, middle) = (tree.weights(block), tree.boxes(block).middle(k));
        let u = [x - middle[0], y - middle[1], z - middle[2]];
        let bound: f64 = bounds.c[k] + (0..3).map(|a| (bounds.g[a][k] + bounds.q[a][k] * u[a]) * u[a]).sum::<f64>();
        let over = bound - (w - tree.base_weight());
        assert!((0.0..1e-6).contains(&over), "{over:e}");
    }
}

/// Of sites at one position the heaviest is in the tree, and on a tie the first; the order does not depend on the caller's.
#[test]
fn one_site_of_a_place_is_in_the_tree() {
    let positions = [[0.5; 3], [0.1, 0.2, 0.3], [0.5; 3], [0.5; 3], [0.1, 0.2, 0.3]];
    let tree = SiteTree::new(&positions, &[1.0, 0.0, 2.0, 2.0, 0.0]);
    let mut order = tree.order().to_vec();
    order.sort_unstable();
    assert_eq!(order, [1, 2]);
    let mut coincident = tree.coincident().to_vec();
    coincident.sort_unstable();
    assert_eq!(coincident, [0, 3, 4]);
    let (positions, _) = clouds().swap_remove(4);
    let mut backward = positions.clone();
    backward.reverse();
    let (one, other) = (SiteTree::new(&positions, &[]), SiteTree::new(&backward, &[]));
    assert!(one.sites().eq(other.sites()));
}
