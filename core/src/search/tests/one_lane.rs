//! What the dialect's search finds, near and far, by one lane over a plain store, against a cut by every site.

use super::super::store::{MOST_ASKED, Room, Searched};
use super::super::*;
use crate::cell::bound::{Seer, least_power_of_node};
use crate::cell::far::{asked_at, search_far, settle_near};
use crate::cell::search::{KEPT, NEAR, SWEEP, search_near, vantage_of};
use crate::cell::search_store::SearchStore;
use crate::cell::sweep::may_cut_weighted;
use crate::cell::tree::asks_by_powers;
use crate::cell::{
    COMPLETE, CUT, CellSums, PlainStore, UNCERTAIN, UNTOUCHED, VOLUME_ONLY, begin, bisector, clip, integrate_cell,
};

const WIDTH: u32 = crate::site_tree::WIDTH as u32;

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

fn begun<'a>(tree: &SiteTree, site: u32) -> PlainStore<'a> {
    let [x, y, z, _] = tree.site(site);
    let mut store = PlainStore::new([x, y, z], None);
    let status = begin(&mut store, v3(-1.0 - x, -1.0 - y, -1.0 - z), v3(1.0 - x, 1.0 - y, 1.0 - z));
    assert_eq!(status, COMPLETE);
    store
}

/// The way from a site to another, and what that one weighs more.
fn difference(tree: &SiteTree, site: u32, j: u32) -> (V3, f64) {
    let ([x, y, z, w], [a, b, c, more]) = (tree.site(site), tree.site(j));
    (v3(a - x, b - y, c - z), more - w)
}

fn cut_by_all(tree: &SiteTree, site: u32) -> Option<f64> {
    let mut store = begun(tree, site);
    for j in (0..tree.len() as u32).filter(|&j| j != site) {
        let (d, more) = difference(tree, site, j);
        match clip(&mut store, bisector(d, -more), j) {
            UNTOUCHED | CUT => {}
            _ => return None,
        }
    }
    Some(volume(&mut store))
}

/// What is searched, and from what on.
#[derive(Clone, Copy, Debug)]
enum Way {
    /// Near, and then far where it is not complete.
    Near,
    /// The same, with what is left when those near have cut it swept before.
    NearAndSwept,
    /// Far at once, which asks for so many vertices at first.
    Far(u32),
}

fn searched(tree: &SiteTree, site: u32, way: Way) -> Option<f64> {
    let mut store = begun(tree, site);
    let mut cell = Cell::new(&mut store, site, tree.site(site), None, None);
    let mut room = Room::default();
    let mut search = Searched::new(&mut cell, tree, None, &mut room, 0.0);
    search.is_swept = matches!(way, Way::NearAndSwept);
    let vantage = vantage_of(&search);
    let (mut visited, mut proven) = (0, 0.0);
    let (mut status, mut first_asked) = (UNTOUCHED, 1);
    match way {
        Way::Far(asked) => first_asked = asked,
        _ => status = search_near(&mut search, vantage, NEAR, &mut visited, &mut proven),
    }
    if status == UNTOUCHED {
        settle_near(&mut search, vantage.center, proven);
        status = search_far(&mut search, vantage.center, first_asked, &mut visited);
    }
    assert_ne!(status, UNCERTAIN);
    (status == COMPLETE).then(|| volume(&mut store))
}

/// Near, and ended by a look at all that can still cut it; `None` where that is given up. (None are kept of another cell here.)
fn swept(tree: &SiteTree, site: u32) -> Option<Option<f64>> {
    let mut store = begun(tree, site);
    let mut cell = Cell::new(&mut store, site, tree.site(site), None, None);
    let mut room = Room::default();
    let mut search = Searched::new(&mut cell, tree, None, &mut room, 0.0);
    let vantage = vantage_of(&search);
    let (mut visited, mut proven) = (0, 0.0);
    let mut status = search_near(&mut search, vantage, NEAR, &mut visited, &mut proven);
    if status == UNTOUCHED {
        settle_near(&mut search, vantage.center, proven);
        status = search_near(&mut search, vantage, KEPT, &mut visited, &mut proven);
    }
    if status == UNTOUCHED {
        status = search_near(&mut search, vantage, SWEEP, &mut visited, &mut proven);
    }
    assert_ne!(status, UNCERTAIN);
    (status != UNTOUCHED).then(|| (status == COMPLETE).then(|| volume(&mut store)))
}

#[test]
fn a_sweep_finds_all_sites_that_cut() {
    let mut given_up = 0;
    for (name, positions, weights) in inputs() {
        let tree = SiteTree::new(&positions, &weights);
        for site in (0..tree.len() as u32).step_by(3) {
            match swept(&tree, site) {
                Some(found) => {
                    let (found, all) = (found.unwrap_or(0.0), cut_by_all(&tree, site).unwrap_or(0.0));
                    assert!((found - all).abs() <= 1e-14 * all + 1e-17, "{name}, {site}: {found} instead of {all}");
                }
                None => given_up += 1,
            }
        }
    }
    assert!(given_up < 30, "{given_up}");
}

/// Of a node that is said to cut off no place no site has less power than the cell's own wherever that place may be, off by its radius; and of one that is said to, some often has.
#[test]
fn what_cannot_cut_a_place_has_no_less_power_there() {
    for (name, positions, weights) in inputs().into_iter().filter(|(_, _, weights)| !weights.is_empty()) {
        let tree = SiteTree::new(&positions, &weights);
        let (mut cannot, mut may, mut does) = (0, 0, 0);
        for site in (0..tree.len() as u32).step_by(41) {
            let mut store = begun(&tree, site);
            let mut cell = Cell::new(&mut store, site, tree.site(site), None, None);
            let mut room = Room::default();
            let search = Searched::new(&mut cell, &tree, None, &mut room, 0.0);
            let seer = Seer { site: search.site(), excess: search.own_excess(), has_weights: true };
            let leaves = (tree.len() as u32).div_ceil(WIDTH);
            for (leaf, &[x, y, z]) in (0..leaves).cycle().zip(positions.iter().take(200)) {
                let (bounds, node_weights) = (search.node_box(0, leaf), search.node_weights(0, leaf));
                for radius in [0.0, 1e-6, 0.05] {
                    let place = v3(0.5 * x, 0.5 * y, 0.5 * z);
                    let said = may_cut_weighted(seer, place, radius, bounds, node_weights);
                    let signs = (0..8_u32).map(|i| [0, 1, 2].map(|k| if (i >> k) & 1 == 0 { radius } else { -radius }));
                    let less = signs.flat_map(|[a, b, c]| {
                        let p = v3(place.x + a, place.y + b, place.z + c);
                        let sites = leaf * WIDTH..((leaf + 1) * WIDTH).min(tree.len() as u32);
                        let (tree, others) = (&tree, sites.filter(move |&j| j != site));
                        others.map(move |j| {
                            let (d, more) = difference(tree, site, j);
                            square(d) - 2.0 * (p.x * d.x + p.y * d.y + p.z * d.z) - more
                        })
                    });
                    let least = less.fold(f64::INFINITY, f64::min);
                    assert!(said || least > -1e-15, "{name}: {site}, {leaf}, {radius}: {least}");
                    cannot += u32::from(!said);
                    may += u32::from(said);
                    does += u32::from(said && least <= 0.0);
                }
            }
        }
        assert!(positions.len() < 100 || (cannot > 100 && 3 * does > may), "{name}: {cannot}, {does} of {may}");
    }
}

#[test]
fn the_search_finds_all_sites_that_cut() {
    for (name, positions, weights) in inputs() {
        let tree = SiteTree::new(&positions, &weights);
        for site in (0..tree.len() as u32).step_by(3) {
            let all = cut_by_all(&tree, site);
            for way in [Way::Near, Way::NearAndSwept, Way::Far(1), Way::Far(MOST_ASKED as u32)] {
                let (found, all) = (searched(&tree, site, way).unwrap_or(0.0), all.unwrap_or(0.0));
                assert!(
                    (found - all).abs() <= 1e-14 * all + 1e-17,
                    "{name}, {site}, {way:?}: {found} instead of {all}"
                );
            }
        }
    }
}

/// What is true of a node is true of its sites, and the store says of eight nodes at once what the text says of each.
#[test]
fn no_site_of_a_node_comes_to_less_than_its_bound() {
    for (name, positions, weights) in inputs() {
        let tree = SiteTree::new(&positions, &weights);
        for site in (0..tree.len() as u32).step_by(31) {
            let mut store = begun(&tree, site);
            let mut cell = Cell::new(&mut store, site, tree.site(site), None, None);
            let mut room = Room::default();
            let mut search = Searched::new(&mut cell, &tree, None, &mut room, 0.0);
            let seer = Seer { site: search.site(), excess: search.own_excess(), has_weights: search.has_weights() };
            let places = [v3(0.0, 0.0, 0.0), v3(0.3, -0.2, 0.1), v3(-1.5, 1.0, 1.2)];
            for (i, place) in places.into_iter().enumerate() {
                let asked = asked_at(search.largest_excess(), 0, place, 0.0);
                search.set_asked(i as u32, asked);
            }
            for level in 0..=tree.top_level() as u32 {
                let width = WIDTH.pow(level + 1);
                for node in 0..(tree.len() as u32).div_ceil(width) {
                    let (bounds, slab) = (search.node_box(level, node), search.node_slab(level, node));
                    for place in places {
                        let bound = least_power_of_node(seer, place, bounds, slab, search.node_weights(level, node));
                        for j in node * width..((node + 1) * width).min(tree.len() as u32) {
                            let (d, more) = difference(&tree, site, j);
                            let power = square(v3(place.x - d.x, place.y - d.y, place.z - d.z)) - more;
                            assert!(bound <= power + 1e-15 * power.abs(), "{name}: {bound} above {power} of {j}");
                        }
                    }
                    let (mut key, mut its_key) = (0, 0);
                    let asks = asks_by_powers(&search, level, node, 0b111, &mut key);
                    assert_eq!(search.asks_of_node(level, node, 0b111, &mut its_key), asks, "{name}: {level}, {node}");
                    assert!(asks == 0 || key == its_key, "{name}: {level}, {node}");
                }
            }
        }
    }
}
