mod octree;
mod one_lane;

use super::*;
use crate::PowerDiagram;
use crate::cell::far::{asked_at, least_at};
use crate::cell::search_store::{NO_SITE, SearchStore};
use crate::cell::{CellSums, PlainStore, Polytope as _};

/// Points that fill the unit cube with no pattern.
fn point(i: usize) -> [f64; 3] {
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3].map(|a| (0.5 + i as f64 * a).fract())
}

/// White sites, clusters, and sites in a plane, with weights that are equal, linear, curved, wavy, at random, or one heavy.
fn diagrams() -> Vec<Prepared> {
    let white: Vec<[f64; 3]> = (0..3000).map(point).collect();
    let clusters =
        white.iter().enumerate().map(|(i, p)| p.map(|x| 0.1 + (i % 3) as f64 * 0.3 + x * 0.01_f64.powi(i as i32 % 3)));
    let flat: Vec<[f64; 3]> = white.iter().map(|&[x, y, z]| [x, y, 0.5 + 1e-9 * z]).collect();
    let weights: [fn(&[f64; 3]) -> f64; 6] = [
        |_| 0.0,
        |p| 0.5 * p[0] - 0.2 * p[2],
        |p| 0.9 * p[0] * p[0] + 0.5 * p[1] * p[1] - p[2] * p[2],
        |p| 0.02 * (6.0 * p[0]).sin() * (5.0 * p[1]).cos(),
        |p| 0.01 * (1e5 * p[1]).fract(),
        |p| if p[0] < 1e-3 { 0.09 } else { 0.0 },
    ];
    let places = [white.clone(), clusters.collect(), flat];
    let all = places.iter().flat_map(|places| {
        weights.iter().map(|w| {
            let weights: Vec<f64> = places.iter().map(w).collect();
            PowerDiagram::new(places, &weights).unwrap().in_box([-0.1; 3], [1.1; 3]).unwrap().prepare().unwrap()
        })
    });
    all.collect()
}

/// `h_j − h_i` at the centre of cell `i`, and the distance of the two sites.
fn power_and_distance(group: &Group<'_>, own: [f64; 4], other: [f64; 4]) -> (f64, f64) {
    let g = group.slope_at([own[0], own[1], own[2]]);
    let d: [f64; 3] = std::array::from_fn(|k| other[k] - own[k]);
    let square: f64 = d.iter().map(|x| x * x).sum();
    let along = g.x * d[0] + g.y * d[1] + g.z * d[2];
    (square - (other[3] - own[3]) + along, square.sqrt())
}

/// What is proved of a chunk: no site beyond it cuts within the radius. And it is no idle proof: some site beyond it cuts within three times that.
#[test]
fn no_site_beyond_a_chunk_cuts_within_the_proven_radius() {
    for (n, prepared) in diagrams().iter().enumerate() {
        let tree = &prepared.sites;
        let mut group = Group::new(tree);
        let (mut proofs, mut sharp) = (0, 0);
        for site in (0..tree.len()).step_by(97) {
            group.turn_to(site);
            let own = tree.site(site as u32);
            let mut listed = std::collections::HashSet::<u32>::new();
            for chunk in 0..4 {
                if !group.has_chunk(chunk) {
                    break;
                }
                listed.extend(group.leaves(chunk));
                let radius = group.proven_square(chunk, [own[0], own[1], own[2]], own[3]).max(0.0).sqrt();
                let mut nearest = f64::INFINITY;
                for j in 0..tree.len() as u32 {
                    if !listed.contains(&(j / WIDTH as u32)) {
                        let (power, distance) = power_and_distance(&group, own, tree.site(j));
                        nearest = nearest.min(power / (2.0 * distance));
                    }
                }
                if radius > 0.0 {
                    assert!(nearest >= radius * (1.0 - 1e-9), "{n}: site {site}, chunk {chunk}: {nearest} < {radius}");
                    proofs += 1;
                    sharp += usize::from(nearest < 3.0 * radius);
                }
            }
        }
        assert!(proofs > 20 && sharp > 10, "{n}: {proofs} proofs, {sharp} of them sharp");
    }
}

/// What a descent from a cell's site finds at some places: the site of least power at the first, and a bit for each of the others that stays.
fn descend(tree: &SiteTree, room: &mut Room, site: u32, places: &[V3]) -> (Option<u32>, u32) {
    let [x, y, z, _] = tree.site(site);
    let mut store = PlainStore::new([x, y, z], None);
    assert_eq!(cell::begin(&mut store, v3(-2.0, -2.0, -2.0), v3(2.0, 2.0, 2.0)), cell::COMPLETE);
    let mut cell = Cell::new(&mut store, site, tree.site(site), None, None);
    let mut search = Searched::new(&mut cell, tree, None, room, 0.0);
    for (i, &place) in places.iter().enumerate() {
        let asked = asked_at(search.largest_excess(), 0, place, 0.0);
        search.set_asked(i as u32, asked);
    }
    let (mut ties, mut stay) = (0, 0);
    let found = least_at(&mut search, places.len() as u32, &mut ties, &mut stay);
    ((found != NO_SITE).then_some(found), stay)
}

/// The difference of a site's power and another's at a place from the other, and the first one's.
fn least_other_power(tree: &SiteTree, site: u32, place: V3) -> (f64, f64) {
    let [x, y, z, _] = tree.site(site);
    let power = |j: u32| {
        let [a, b, c, w] = tree.site(j);
        square(v3(x + place.x - a, y + place.y - b, z + place.z - c)) - w
    };
    let least = (0..tree.len() as u32).filter(|&j| j != site).map(power).fold(f64::INFINITY, f64::min);
    (least, power(site))
}

/// The site of least power at a vertex is found, or there is none of less than the cell's own.
#[test]
fn a_descent_finds_the_least_power() {
    let (mut found, mut none) = (0, 0);
    let mut room = Room::default();
    for (n, prepared) in diagrams().iter().enumerate() {
        let tree = &prepared.sites;
        for site in (0..tree.len() as u32).step_by(37) {
            let [x, y, z, _] = tree.site(site);
            for scale in [1e-4, 1e-2, 0.3, 1.0] {
                let [dx, dy, dz] = point(site as usize + 77).map(|c| scale * (c - 0.5));
                let (least, own) = least_other_power(tree, site, v3(dx, dy, dz));
                if let Some(j) = descend(tree, &mut room, site, &[v3(dx, dy, dz)]).0 {
                    let [a, b, c, w] = tree.site(j);
                    let power = square(v3(x + dx - a, y + dy - b, z + dz - c)) - w;
                    assert!(power <= least + 1e-12 && least < own, "{n}: {site}: {power} {least}");
                    found += 1;
                } else {
                    assert!(own <= least + 1e-12, "{n}: {site}, {scale}: {own} {least}");
                    none += 1;
                }
            }
        }
    }
    assert!(found > 1000 && none > 500, "{found} {none}");
}

/// What one descent tells of several vertices is so: those that stay are those where no site has less power than the cell's own.
#[test]
fn a_descent_for_several_vertices_tells_which_stay() {
    let (mut stay, mut go) = (0, 0);
    let mut room = Room::default();
    for (n, prepared) in diagrams().iter().enumerate() {
        let tree = &prepared.sites;
        for site in (0..tree.len() as u32).step_by(61) {
            let places: [V3; MOST_ASKED] = std::array::from_fn(|i| {
                let scale = 10_f64.powi(-(i as i32 % 4) - 1);
                let [x, y, z] = point(site as usize + 7 * i).map(|c| scale * (c - 0.5));
                v3(x, y, z)
            });
            let bits = descend(tree, &mut room, site, &places).1;
            for (i, &place) in places.iter().enumerate().skip(1) {
                let (least, own) = least_other_power(tree, site, place);
                let more = least - own;
                assert!(more.abs() < 1e-12 || (more > 0.0) == (bits >> i & 1 != 0), "{n}: {site}, {place:?}: {more}");
                *(if more > 0.0 { &mut stay } else { &mut go }) += 1;
            }
        }
    }
    assert!(stay > 1000 && go > 1000, "{stay} {go}");
}

/// The slope of weights with mixed terms is known at the middle of each group.
#[test]
fn the_slope_of_weights_with_mixed_terms_is_known() {
    let places: Vec<[f64; 3]> = (0..3000).map(point).collect();
    let weights: Vec<f64> = places.iter().map(|p| 0.6 * p[0] * p[1] - 0.4 * p[1] * p[2] + 0.1 * p[2]).collect();
    let prepared = PowerDiagram::new(&places, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap().prepare().unwrap();
    let tree = &prepared.sites;
    let mut group = Group::new(tree);
    for site in (0..tree.len()).step_by(13) {
        group.turn_to(site);
        let middle = group.middle();
        let g = group.slope_at(middle);
        let first = (site / WIDTH * WIDTH) as u32;
        let sites = (first..(first + WIDTH as u32).min(tree.len() as u32)).map(|j| tree.site(j));
        let (mut lo, mut hi, mut reach) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for [x, y, z, w] in sites {
            let d = v3(x - middle[0], y - middle[1], z - middle[2]);
            let rest = w - (g.x * d.x + g.y * d.y + g.z * d.z);
            (lo, hi, reach) = (lo.min(rest), hi.max(rest), reach.max(square(d)));
        }
        // What is left about the middle is half the Hessian's, whose eigenvalues are ±0.72.
        assert!(hi - lo <= 0.73 * reach, "{site}: {} {reach}", hi - lo);
    }
}

/// Cells of a row are bounded by the sites that bound them alone, and fewer nodes are looked at.
#[test]
fn cells_of_a_row_are_what_they_are_alone() {
    let places: Vec<[f64; 3]> =
        (0..3000).map(point).map(|[x, y, _]| [x, y, 0.5 + 0.1 * (7.0 * x).sin() * (5.0 * y).cos()]).collect();
    for weight in [0.0, 1e-3] {
        let weights: Vec<f64> = places.iter().map(|p| weight * (9.0 * p[0]).sin()).collect();
        let diagram = PowerDiagram::new(&places, &weights).unwrap().in_box([-0.1; 3], [1.1; 3]).unwrap();
        let prepared = diagram.prepare().unwrap();
        let bounds = |search: &mut Search<'_>, site: u32| {
            let [x, y, z, _] = prepared.sites.site(site);
            let mut store = PlainStore::new([x, y, z], None);
            let outcome = search.complete(&mut store, site, None);
            let meets = (0..store.vertices()).map(|v| store.triplet(v)).flat_map(|t| [t.a, t.b, t.c]);
            let mut tags: Vec<u32> = meets.map(|f| store.tag(f)).collect();
            tags.sort_unstable();
            tags.dedup();
            ((outcome.status, tags), outcome.opened)
        };
        let (mut alone, mut row) = (Search::new(&prepared), Search::new(&prepared));
        row.begin_row();
        let mut opened = [0; 2];
        for site in 0..3000 {
            let [(one, its), (other, of_row)] = [&mut alone, &mut row].map(|search| bounds(search, site));
            assert_eq!(one, other, "{site}");
            opened[0] += its;
            opened[1] += of_row;
        }
        assert!(4 * opened[1] < 3 * opened[0], "{opened:?}");
    }
}

/// In a domain, where weights are at random, and of sites on a surface, whose cells reach far, cells of a row are what they are alone.
#[test]
fn cells_of_a_row_in_a_domain_are_what_they_are_alone() {
    let ball = crate::shapes::icosphere(2)
        .transformed(glam::DMat3::from_diagonal(glam::DVec3::splat(0.4)), glam::DVec3::splat(0.5));
    let domain = ball.domain();
    let wavy = |[x, y, _]: [f64; 3]| [x, y, 0.5 + 0.1 * (7.0 * x).sin() * (5.0 * y).cos()];
    let mut far = 0;
    for (is_on_a_surface, weight) in [(false, 0.03), (true, 1e-3)] {
        let place = |p| if is_on_a_surface { wavy(p) } else { p };
        let places: Vec<[f64; 3]> = (0..3000).map(point).map(place).collect();
        let weights: Vec<f64> = places.iter().map(|p| weight * (1e5 * p[1]).fract()).collect();
        let prepared = PowerDiagram::new(&places, &weights).unwrap().restricted_to(&domain).prepare().unwrap();
        let (mut alone, mut row) = (Search::new(&prepared), Search::new(&prepared));
        row.begin_row();
        for site in 0..3000 {
            let [x, y, z, _] = prepared.sites.site(site);
            let [one, other] = [&mut alone, &mut row].map(|search| {
                let mut store = PlainStore::new([x, y, z], prepared.domain_grid());
                let outcome = search.complete(&mut store, site, None);
                let mut sums = CellSums::default();
                let status = match outcome.status {
                    cell::COMPLETE => cell::integrate_cell(&mut store, 0, 0, &mut sums),
                    other => other,
                };
                far += usize::from(outcome.opened > 0);
                (status, sums.volume)
            });
            assert_eq!(one.0, other.0, "{site}");
            assert!((one.1 - other.1).abs() < 1e-15, "{site}: {one:?}, {other:?}");
        }
    }
    assert!(far > 1000, "{far}");
}

/// Where one site in fifty is heavy, what is known of the nodes that hold one says little: more leaves are found, until the first chunk proves something for all cells of a group
/// whose own sites are alike.
#[test]
fn a_first_chunk_proves_something_where_weights_are_rough() {
    let places: Vec<[f64; 3]> = (0..20_000).map(point).collect();
    let weights: Vec<f64> = (0..20_000).map(|i| if i % 50 == 7 { 0.02 } else { 0.0 }).collect();
    let prepared = PowerDiagram::new(&places, &weights).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap().prepare().unwrap();
    let tree = &prepared.sites;
    let mut group = Group::new(tree);
    let (mut alike, mut proven) = (0, 0);
    for first in (0..tree.len() as u32).step_by(WIDTH) {
        let sites = || (first..first + WIDTH as u32).map(|j| tree.site(j));
        if sites().all(|site| site[3] == sites().next().unwrap()[3]) {
            group.turn_to(first as usize);
            alike += 1;
            let proves = |[x, y, z, weight]: [f64; 4]| group.proven_square(0, [x, y, z], weight) > 0.0;
            proven += usize::from(sites().all(proves));
        }
    }
    assert!(alike > 1000 && 100 * proven > 95 * alike, "{proven} of {alike}");
}
