//! What the search finds, by one lane over a plain store, against a cut by every site.

use super::super::far::search_far;
use super::super::search_store::SearchStore;
use super::super::status::UNCERTAIN;
use super::super::tree::least_of_node;
use super::super::{CellSums, PlainSearch, PlainStore, VOLUME_ONLY, begin, bisector, clip, integrate_cell};
use super::*;
use crate::site_tree::SiteTree;

/// Points of a low-discrepancy row in [−1, 1]³.
fn even(n: usize) -> Vec<[f64; 3]> {
    (0..n).map(|i| [0.819_172, 0.671_043, 0.549_7].map(|step| 2.0 * (i as f64 * step).fract() - 1.0)).collect()
}

type Input = (&'static str, Vec<[f64; 3]>, Vec<f64>);

fn inputs() -> Vec<Input> {
    let even = even(400);
    let square = |p: &[f64; 3]| p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    let map = |f: &dyn Fn(&[f64; 3]) -> [f64; 3]| even.iter().map(f).collect::<Vec<_>>();
    let weigh = |f: &dyn Fn(&[f64; 3]) -> f64| even.iter().map(f).collect::<Vec<_>>();
    let lattice = (0..343).map(|i| [i % 7, i / 7 % 7, i / 49].map(|k| f64::from(k) / 3.5 - 0.9)).collect();
    // Seen from the others a leaf of the sites at the middle is a point, and its weights differ: of one of these numbers the heaviest is the last of a leaf.
    let steep = (17..25).map(|n| {
        let middle = (0..n).map(|k| [f64::from(k) * 1e-18, 0.0, 0.0]);
        let weights = (0..n).map(|k| 0.3 * f64::from(k) / f64::from(n)).chain(std::iter::repeat_n(0.0, 400));
        ("steep in a point", middle.chain(even.iter().copied()).collect(), weights.collect())
    });
    let mut inputs: Vec<Input> = vec![
        ("even", even.clone(), Vec::new()),
        ("cluster", map(&|p| p.map(|x| x * square(p) * square(p))), Vec::new()),
        ("plane", map(&|p| [p[0], p[1], 0.1]), Vec::new()),
        ("line", map(&|p| [p[0], 0.3, 0.1]), Vec::new()),
        ("bumpy", map(&|p| [p[0], p[1], 0.1 * (7.0 * p[0]).sin() * (5.0 * p[1]).cos()]), Vec::new()),
        ("sphere", map(&|p| p.map(|x| 0.7 * x / square(p).sqrt())), Vec::new()),
        ("lattice", lattice, Vec::new()),
        ("affine", even.clone(), weigh(&|p| p[0] - 0.3 * p[2])),
        ("quadratic", even.clone(), weigh(&|p| 0.9 * square(p))),
        ("outward", even.clone(), weigh(&|p| -2.0 * square(p))),
        ("saddle", even.clone(), weigh(&|p| p[0] * p[1] - 0.5 * p[2] * p[2])),
        // A vertex of the first cell is its site, and the last site cuts it off.
        (
            "vertex at a site",
            vec![[0.0; 3], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5], [0.25; 3]],
            vec![0.0, 0.25, 0.25, 0.25, 0.2],
        ),
        ("one heavy", even.clone(), (0..400).map(|i| if i == 7 { 0.3 } else { 0.0 }).collect()),
    ];
    inputs.extend(steep);
    inputs
}

/// The volume of a finished cell.
fn volume(s: &mut PlainStore<'_>) -> f64 {
    let mut sums = CellSums::default();
    assert_eq!(integrate_cell(s, VOLUME_ONLY, 0, &mut sums), COMPLETE);
    sums.volume
}

fn begun<'a>(tree: &'a SiteTree, site: u32) -> PlainStore<'a> {
    let [x, y, z, _] = tree.site(site);
    let mut store = PlainStore::new([x, y, z], None).searching(PlainSearch::new(tree, site));
    let status = begin(&mut store, v3(-1.0 - x, -1.0 - y, -1.0 - z), v3(1.0 - x, 1.0 - y, 1.0 - z));
    assert_eq!(status, COMPLETE);
    store
}

fn cut_by_all(tree: &SiteTree, site: u32) -> Option<f64> {
    let mut store = begun(tree, site);
    for j in (0..tree.len() as u32).filter(|&j| j != site) {
        let plane = bisector(store.way_to(j), -store.excess_of(j));
        match clip(&mut store, plane, j) {
            UNTOUCHED | CUT => {}
            _ => return None,
        }
    }
    Some(volume(&mut store))
}

/// Near, and then far where it is not complete; or far at once.
///
/// `UNCERTAIN` where there are too many ties: on a sphere all sites tie at its centre.
fn searched(tree: &SiteTree, site: u32, is_far: bool) -> Result<Option<f64>, u32> {
    let mut store = begun(tree, site);
    let vantage = vantage_of(&store);
    let mut visited = 0;
    let mut status = UNTOUCHED;
    if !is_far {
        status = search_near(&mut store, vantage, &mut visited);
    }
    if status == UNTOUCHED {
        status = search_far(&mut store, vantage, &mut visited);
    }
    match status {
        COMPLETE => Ok(Some(volume(&mut store))),
        UNCERTAIN => Err(status),
        _ => Ok(None),
    }
}

#[test]
fn the_search_finds_all_sites_that_cut() {
    for (name, positions, weights) in inputs() {
        let tree = SiteTree::new(&positions, &weights);
        for site in (0..tree.len() as u32).step_by(3) {
            let all = cut_by_all(&tree, site);
            for is_far in [false, true] {
                match searched(&tree, site, is_far) {
                    Ok(found) => {
                        let (found, all) = (found.unwrap_or(0.0), all.unwrap_or(0.0));
                        assert!(
                            (found - all).abs() <= 1e-14 * all + 1e-17,
                            "{name}, {site}, {is_far}: {found} instead of {all}"
                        );
                    }
                    Err(_) => assert_eq!(name, "sphere"),
                }
            }
        }
    }
}

#[test]
fn no_site_of_a_node_comes_to_less_than_its_bound() {
    for (name, positions, weights) in inputs() {
        let tree = SiteTree::new(&positions, &weights);
        for site in (0..tree.len() as u32).step_by(31) {
            let store = begun(&tree, site);
            for place in [v3(0.0, 0.0, 0.0), v3(0.3, -0.2, 0.1), v3(-1.5, 1.0, 1.2)] {
                let question = Question { square: 1.0, slope: v3(0.0, 0.0, 0.0), limit: 0.0, place, is_power: 1 };
                for level in 0..=tree.top_level() as u32 {
                    let width = WIDTH.pow(level + 1);
                    for node in 0..(tree.len() as u32).div_ceil(width) {
                        let bound = least_of_node(&store, question, level, node);
                        for j in node * width..((node + 1) * width).min(tree.len() as u32) {
                            let way = sub(place, store.way_to(j));
                            let power = dot(way, way) - store.excess_of(j);
                            assert!(bound <= power + 1e-15 * power.abs(), "{name}: {bound} above {power} of {j}");
                        }
                    }
                }
            }
        }
    }
}
