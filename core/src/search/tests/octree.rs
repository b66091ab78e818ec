//! What the octree over the container says of the sites, and the cells that it leads to.

use super::*;
use crate::cell::{CellSums, VOLUME_ONLY, integrate_cell};
use crate::power_octree::{Home, PowerOctree};
use crate::search::store::MOST_LISTED;
use glam::{DMat3, DVec3};

/// Sites `∇φ(x)` of a convex `φ` at even points `x`, each with the weight with which `x` is in its cell: `|p|² − 2 (p·x − φ(x))`. They crowd about the
/// middle, as those of transport from a cluster do; with some noise, as on the way to it; and some way off.
fn transported(noise: f64, way: [f64; 3]) -> Prepared {
    crowded(noise, way).in_box([0.0; 3], [1.0; 3]).unwrap().prepare().unwrap()
}

/// The same cut by a sphere that reaches out of that box.
fn in_a_sphere() -> Prepared {
    let sphere = crate::shapes::icosphere(2).transformed(DMat3::from_diagonal(DVec3::splat(0.6)), DVec3::splat(0.5));
    crowded(1e-4, [0.0; 3]).restricted_to(&sphere.domain()).prepare().unwrap()
}

fn crowded(noise: f64, way: [f64; 3]) -> PowerDiagram {
    let (mut places, mut weights) = (Vec::new(), Vec::new());
    for i in 0..3000 {
        let x = point(i).map(|c| c - 0.5);
        let square: f64 = x.iter().map(|x| x * x).sum();
        let p = x.map(|x| 4.0 * square * x);
        let along: f64 = p.iter().zip(x).map(|(p, x)| p * x).sum();
        let own: f64 = p.iter().map(|p| p * p).sum();
        let weight = own - 2.0 * (along - square * square) + noise * point(3 * i)[1];
        let p = p.map(|p| p + 0.5);
        // Moved with weights of slope 2 way, which moves all cells back.
        weights.push(weight + 2.0 * p.iter().zip(way).map(|(p, t)| p * t).sum::<f64>());
        places.push(std::array::from_fn(|k| p[k] + way[k]));
    }
    PowerDiagram::new(&places, &weights).unwrap()
}

fn all_diagrams() -> Vec<Prepared> {
    let mut all = diagrams();
    all.extend([transported(0.0, [0.0; 3]), transported(1e-4, [0.0; 3]), transported(1e-4, [500.0, -300.0, 100.0])]);
    all
}

fn octree_of(prepared: &Prepared) -> Option<PowerOctree> {
    PowerOctree::new(&prepared.sites, [prepared.container.lo, prepared.container.hi], MOST_LISTED, &|| Ok(())).unwrap()
}

/// Where leaves are listed for a place, the site of least power there is in one of them, on the boxes' faces, too.
#[test]
fn the_site_of_least_power_is_listed() {
    for (n, prepared) in all_diagrams().iter().enumerate() {
        let (tree, octree) = (&prepared.sites, octree_of(prepared).unwrap());
        let (lo, hi) = (prepared.container.lo, prepared.container.hi);
        let mut listed = 0;
        for i in 0..600 {
            let share = if i % 2 == 0 { point(i) } else { point(i).map(|c| (c * 32.0).round() / 32.0) };
            let place: [f64; 3] = std::array::from_fn(|k| lo[k] + share[k] * (hi[k] - lo[k]));
            let power = |j: u32| {
                let [x, y, z, w] = tree.site(j);
                square(v3(x - place[0], y - place[1], z - place[2])) - w
            };
            let least = (0..tree.len() as u32).map(power).fold(f64::INFINITY, f64::min);
            let leaves = octree.leaves_at(v3(place[0], place[1], place[2]), 0.0);
            listed += usize::from(!leaves.is_empty());
            let of_leaves = leaves.iter().flat_map(|leaf| leaf * 8..(leaf * 8 + 8).min(tree.len() as u32));
            let found = of_leaves.map(power).fold(f64::INFINITY, f64::min);
            assert!(leaves.is_empty() || found <= least, "{n}: {place:?}: {found} {least}");
        }
        assert!(listed > 300, "{n}: {listed}");
    }
}

/// The cells that the search with an octree finds are those that it finds without; and a site that no box lists has none.
#[test]
fn an_octree_leads_to_the_same_cells() {
    for (n, mut prepared) in all_diagrams().into_iter().chain([in_a_sphere()]).enumerate() {
        let volumes = |prepared: &Prepared| -> Vec<f64> {
            let mut search = Search::new(prepared);
            let volume = |site: usize| {
                let [x, y, z, _] = prepared.sites.site(site as u32);
                let mut store = PlainStore::new([x, y, z], prepared.domain_grid());
                let mut sums = CellSums::default();
                let mut status = search.complete(&mut store, site as u32, None).status;
                if status == cell::COMPLETE {
                    status = integrate_cell(&mut store, VOLUME_ONLY, 0, &mut sums);
                }
                assert!(status == cell::COMPLETE || status == EMPTY, "{n}: {site}: {status}");
                sums.volume
            };
            (0..prepared.sites.len()).step_by(19).map(volume).collect()
        };
        let without = volumes(&prepared);
        let octree = octree_of(&prepared).unwrap();
        let nowhere = (0..prepared.sites.len() as u32).filter(|&site| matches!(octree.home(site), Home::Nowhere));
        assert!(nowhere.count() < prepared.sites.len());
        prepared.octree = Some(octree);
        for (i, (with, without)) in volumes(&prepared).iter().zip(without).enumerate() {
            assert!((with - without).abs() <= 1e-11 * without + 1e-18, "{n}: {}: {with}, not {without}", 19 * i);
        }
    }
}

/// Sites on a line whose cells are slabs, which an octree would list over and over: there is none, however many they are.
#[test]
fn slabs_have_no_octree() {
    let (mut at, mut potential) = (0.0, 0.0);
    let gap = |i: usize| point(i)[0].powf(-1.3);
    let (n, total) = (4000, (0..4000).map(gap).sum::<f64>());
    let mut sites = Vec::new();
    for i in 0..n {
        // As `transported`, along one axis.
        let x = (i as f64 + 0.5) / n as f64;
        sites.push(([at, 0.5, 0.5], at * at + 0.5 - 2.0 * (x * at - potential)));
        let way = gap(i) / total;
        potential += (at + 0.5 * way) / n as f64;
        at += way;
    }
    let (places, weights): (Vec<_>, Vec<_>) = sites.into_iter().unzip();
    let diagram = PowerDiagram::new(&places, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
    assert!(octree_of(&diagram.prepare().unwrap()).is_none());
    let go_on = || Err(crate::Error::input("no"));
    let prepared = diagram.prepare().unwrap();
    assert!(PowerOctree::new(&prepared.sites, [[0.0; 3], [1.0; 3]], MOST_LISTED, &go_on).is_err());
}

/// An octree is made for weights as of transport, and not for white sites.
#[test]
fn an_octree_is_made_where_it_is_worth_while() {
    for (n, prepared) in all_diagrams().into_iter().enumerate() {
        let opened = {
            let mut search = Search::new(&prepared);
            let opened = |site: usize| {
                let [x, y, z, _] = prepared.sites.site(site as u32);
                search.complete(&mut PlainStore::new([x, y, z], None), site as u32, None).opened
            };
            (0..prepared.sites.len()).step_by(41).map(opened).sum::<u32>() / 74
        };
        let has = prepared.with_octree_if_hard(&|| Ok(())).unwrap().octree.is_some();
        assert!(has || n != 18 && n != 19, "{n}: {opened}");
        assert!(!has || n >= 6, "{n}: {opened}");
    }
}
