//! Laws of the cell alone: combinatorics, exactness of signs, integrals of shapes known in closed form.

use super::*;
use super::{
    bound::{Seer, least_power_of_node, reach_of_bisector},
    cone::{CONE_BEYOND, NONE_BEYOND, lies_beyond, nearest_corner},
    facet::reset_facets,
    far::asked_at,
    integrate::{Corner, add_edge, foot_on_edge, integrate, reference_point, side},
    quadratic::{FEW_ROUNDINGS_OF_SUM, add_least},
    restrict::{add_cone, add_surface},
    search_store::{NodeBox, NodeSlab, NodeWeights},
    vector::{cross, dot, norm_1, sub},
};

fn unit_box<'a>() -> PlainStore<'a> {
    let mut store = PlainStore::new([0.0; 3], None);
    assert_eq!(begin(&mut store, v3(-0.5, -0.5, -0.5), v3(0.5, 0.5, 0.5)), COMPLETE);
    store
}

/// V = 2F − 4, every triplet positive exactly, every directed edge met by its reverse.
fn assert_simple(store: &PlainStore<'_>) {
    let mut edges = std::collections::HashSet::new();
    let mut used = std::collections::HashSet::new();
    for v in 0..store.vertices() {
        let t = store.triplet(v);
        let row = |f: u32| store.plane(f);
        // det [n|d] with a last row (0, 0, 0, 1) is det(n_a, n_b, n_c).
        let unit = Plane { n: v3(0.0, 0.0, 0.0), d: 1.0 };
        assert_eq!(crate::exact::sign_of_planes(row(t.a), row(t.b), row(t.c), unit), 1, "{t:?}");
        for (a, b) in [(t.a, t.b), (t.b, t.c), (t.c, t.a)] {
            assert!(edges.insert((a, b)), "edge {a}→{b} twice");
            used.insert(a);
        }
    }
    assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
    assert_eq!(store.vertices() as usize, 2 * used.len() - 4);
}

#[test]
fn a_corner_cut_off() {
    let mut store = unit_box();
    // x + y + z ≤ 1: cuts off a corner tetrahedron with legs ½.
    assert_eq!(clip(&mut store, Plane { n: v3(-1.0, -1.0, -1.0), d: 1.0 }, 7), CUT);
    assert_simple(&store);
    let mut sums = CellSums::default();
    reset_facets(&mut store, FACETS);
    assert_eq!(integrate(&mut store, 1.0, v3(0.1, -0.2, 0.05), 0.0, FACETS | SECOND_MOMENTS, &mut sums), COMPLETE);
    let leg: f64 = 0.5;
    let corner = leg.powi(3) / 6.0;
    // The corner's centroid is ¼ leg from the corner along each axis.
    let first = -corner * (0.5 - leg / 4.0);
    // ∫x² over the corner: legs measured from the corner, ∫t² = leg⁵/60, ∫t = leg⁴/24.
    let second = 1.0 / 12.0 - (0.25 * corner - leg.powi(4) / 24.0 + leg.powi(5) / 60.0);
    // ∫xy: ∫(½−s)(½−t) = ¼V − ½·2·leg⁴/24 + leg⁵/120.
    let mixed = -(0.25 * corner - leg.powi(4) / 24.0 + leg.powi(5) / 120.0);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} is not {b}");
    close(sums.volume, 1.0 - corner);
    for x in [sums.first.x, sums.first.y, sums.first.z] {
        close(x, first);
    }
    for x in [sums.second_diagonal.x, sums.second_diagonal.y, sums.second_diagonal.z] {
        close(x, second);
    }
    for x in [sums.second_mixed.x, sums.second_mixed.y, sums.second_mixed.z] {
        close(x, mixed);
    }
    let facet = store.facet(6);
    close(facet.area, 3.0_f64.sqrt() / 2.0 * 0.5 * leg * leg * 2.0);
    close(facet.moment.x / facet.area, 0.5 - leg / 3.0);
    close(store.facet(1).area, 1.0 - leg * leg / 2.0);
}

#[test]
fn planes_through_vertices_do_not_cut() {
    let mut store = unit_box();
    for n in [v3(-1.0, -1.0, -1.0), v3(1.0, 1.0, 1.0), v3(-1.0, 0.0, 0.0)] {
        let d = 0.5 * (n.x.abs() + n.y.abs() + n.z.abs());
        assert_eq!(clip(&mut store, Plane { n, d }, 0), UNTOUCHED);
    }
    // Through four vertices: halves the box, the vertices on the plane are kept.
    assert_eq!(clip(&mut store, Plane { n: v3(1.0, 1.0, 0.0), d: 0.0 }, 0), CUT);
    assert_simple(&store);
    // The other half space of the same plane leaves a flat polytope, which is still simple, of volume zero.
    assert_eq!(clip(&mut store, Plane { n: v3(-1.0, -1.0, 0.0), d: 0.0 }, 0), CUT);
    assert_simple(&store);
    let mut sums = CellSums::default();
    assert_eq!(integrate_cell(&mut store, VOLUME_ONLY, 0, &mut sums), EMPTY);
}

/// A cell of thousands of vertices is the sum of what each adds, to some roundings: summed one after the other the 3,000 here lose 31.
#[test]
fn what_many_vertices_add_is_summed_to_some_roundings() {
    let mut store = unit_box();
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    for i in 0..1500 {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 1500.0;
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        assert_eq!(clip(&mut store, bisector(v3(0.7 * r * cos, 0.7 * r * sin, 0.7 * z), 0.0), 0), CUT);
    }
    let center = v3(0.01, -0.02, 0.015);
    let mut one = crate::summation::Sum::default();
    for v in 0..store.vertices() {
        let t = store.triplet(v);
        let at = Corner { triplet: t, position: sub(store.position(v), center), distance: 1.0, radius: 0.0 };
        for (f, g) in [(t.a, t.b), (t.b, t.c), (t.c, t.a)] {
            let (f, g) = (side(&store, f, center), side(&store, g, center));
            let mut part = CellSums::default();
            assert_eq!(add_edge(&mut store, f, g, at, 1.0, center, VOLUME_ONLY, &mut part), COMPLETE);
            one.add(part.volume / 6.0);
        }
    }
    let mut sums = CellSums::default();
    assert_eq!(integrate(&mut store, 1.0, center, 0.0, VOLUME_ONLY, &mut sums), COMPLETE);
    let roundings = (sums.volume - one.total()).abs() / (0.5 * f64::EPSILON * sums.volume);
    assert!(roundings <= 4.0, "{roundings} roundings");
}

/// All neighbours in a lattice block, whose bisectors meet by the dozen in single points.
fn lattice_planes(n: i32, rotation: [[f64; 3]; 3]) -> Vec<Plane> {
    let mut planes = Vec::new();
    for i in -n..=n {
        for j in -n..=n {
            for k in -n..=n {
                if (i, j, k) != (0, 0, 0) {
                    let p = [i, j, k].map(|c| 0.2 * f64::from(c));
                    let r = rotation.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2]);
                    planes.push(bisector(v3(r[0], r[1], r[2]), 0.0));
                }
            }
        }
    }
    planes
}

#[test]
fn lattices_stay_simple_in_any_order() {
    let (c, s) = (0.6_f64.cos(), 0.6_f64.sin());
    let tilted = [[c, -s * 0.8, s * 0.6], [s, c * 0.8, -c * 0.6], [0.0, 0.6, 0.8]];
    for rotation in [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], tilted] {
        let planes = lattice_planes(2, rotation);
        for stride in [1, 7, 37, 101] {
            let mut store = unit_box();
            for i in 0..planes.len() {
                let status = clip(&mut store, planes[i * stride % planes.len()], 0);
                assert!(status == CUT || status == UNTOUCHED);
                assert_simple(&store);
            }
            let mut sums = CellSums::default();
            assert_eq!(integrate_cell(&mut store, FACETS, 0, &mut sums), COMPLETE);
            assert!((sums.volume - 0.008).abs() < 1e-17, "{}", sums.volume);
            let faces = (0..store.planes()).filter(|&f| facet_is_above_bound(store.facet(f)));
            let area: f64 = faces.map(|f| store.facet(f).area).sum();
            assert!((area - 0.24).abs() < 1e-14, "{area}");
        }
    }
}

#[test]
fn the_search_has_no_false_proof() {
    let mut store = unit_box();
    let r = farthest_vertex(&store);
    assert!((r - 0.75_f64.sqrt()).abs() < 1e-13 && r >= 0.75_f64.sqrt());
    // A site, as heavy or heavier, that the cell just reaches cuts it in the direction of a corner; one just beyond does not.
    let origin = v3(0.0, 0.0, 0.0);
    for excess in [0.0, 0.3] {
        let reach = r + (r * r + excess).sqrt();
        for (share, end) in [(1.0 - 1e-12, CUT), (1.0 + 1e-12, UNTOUCHED)] {
            let site = scale_to(reach * share);
            assert_eq!(reach_of_bisector(origin, site, excess) >= 4.0 * r * r, end == UNTOUCHED);
            assert_eq!(clip(&mut store, bisector(site, -excess), 0), end);
            store = unit_box();
        }
    }
    // A wall of sites beyond a face cuts its corners when it stands nearer to them than the site does.
    let seer = Seer { site: origin, excess: 0.0, has_weights: false };
    for (off, is_left_out) in [(1e-12, true), (-1e-12, false)] {
        let x = 0.5 + 0.75_f64.sqrt() + off;
        let wall = NodeBox { lo: v3(x, -0.5, -0.5), hi: v3(x, 0.5, 0.5) };
        let slab = NodeSlab { normal: v3(1.0, 0.0, 0.0), lo: x, hi: x, largest: 0.0 };
        let least = |corner: V3| least_power_of_node(seer, corner, wall, slab, NodeWeights::default());
        let is_out = |v: u32| least(store.position(v)) >= asked_at(0.0, v, store.position(v), store.radius(v)).limit;
        assert_eq!((0..store.vertices()).all(is_out), is_left_out);
    }
}

/// The least of a polynomial over a range is not above its values there, and one of them, to few roundings: convex or not, seen from within or from afar, least within or at an end.
#[test]
fn least_of_a_polynomial_over_a_range() {
    let mut next = numbers();
    for turn in 0..20_000 {
        let extent = 10_f64.powi(-(turn % 9));
        let lo = next();
        let hi = lo + extent * next().abs();
        let from = if turn % 2 == 0 { lo + extent * next() } else { next() };
        let alpha = [-1.0, 0.0, 0.05, 0.5, 1.0][turn as usize % 5];
        let curvature = if turn % 3 == 0 { alpha - 1e-9 * next() } else { 3.0 * next() };
        let (g, slope) = (next(), next() * 10_f64.powi(turn % 4 - 2));
        let (mut least, mut size) = (0.0, 0.0);
        add_least(lo, hi, from, alpha, g, slope, curvature, &mut least, &mut size);
        let middle = 0.5 * (lo + hi);
        let value = |p: f64| {
            let (t, u) = (p - from, p - middle);
            (alpha * t + g) * t - (slope + curvature * u) * u
        };
        let still = middle - 0.5 * (2.0 * alpha * (middle - from) + g - slope) / (alpha - curvature);
        let places = (0..=16).map(|k| lo + (hi - lo) * f64::from(k) / 16.0).chain([still.clamp(lo, hi), hi]);
        let found = places.filter(|p| (lo..=hi).contains(p)).map(value).fold(f64::INFINITY, f64::min);
        let rounding = FEW_ROUNDINGS_OF_SUM * size;
        // (The middle is rounded, and the range is taken to be as long on either side.)
        let range = -rounding..=rounding + 1e-14;
        assert!(range.contains(&(found - least)), "{turn}: {found:e} {least:e} {size:e}");
    }
}

/// Numbers from −1 to 1, the same each time.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 0.0_f64;
    move || {
        state += 1.0;
        2.0 * (state * state * 0.618_033_988_749_894_9).fract() - 1.0
    }
}

fn scale_to(distance: f64) -> V3 {
    let c = distance / 3.0_f64.sqrt();
    v3(c, c, c)
}

/// However small the angle between two planes, the foot is on their line, to a few roundings of its distance; where it is not refined, over the sine.
#[test]
fn feet_between_nearly_parallel_planes() {
    let mut next = numbers();
    for power in 0..900 {
        let angle = 10_f64.powf(-0.01 * f64::from(power));
        let n = v3(next(), next(), next());
        let turned = v3(n.x + angle * next(), n.y + angle * next(), n.z + angle * next());
        let mut store = unit_box();
        store.set_plane(6, Plane { n, d: next() });
        store.set_plane(7, Plane { n: turned, d: next() });
        let center = v3(next(), next(), next());
        let (f, g) = (side(&store, 6, center), side(&store, 7, center));
        let ([mut found, mut exact], mut bound) = ([V3::default(); 2], 0.0);
        assert_eq!(foot_on_edge(&mut store, f, g, center, true, &mut found, &mut bound), COMPLETE);
        crate::exact::foot(store.plane(6), store.plane(7), center, &mut exact);
        // Along the line, whose direction is right by this product, any foot will do.
        let line = cross(f.n, sub(g.n, f.n));
        let off = norm_1(cross(sub(found, exact), line)) / norm_1(line);
        assert!(off <= bound, "{off:e} is above its bound {bound:e}");
        let sine = (dot(line, line) / (dot(f.n, f.n) * dot(g.n, g.n))).sqrt();
        let length = 8.0 * norm_1(exact);
        // Not refined, the planes are as they are seen from the center: their distances are rounded.
        let lost = if sine > 0.00195 { (length + 4.0 * norm_1(center)) / sine } else { length };
        assert!(off <= lost * UNIT_ROUNDOFF, "sine {sine:e}: {off:e}");
    }
}

/// What `lies_beyond` leaves out has nothing of the cell behind it, or on it; and it leaves out most.
#[test]
fn nothing_of_a_cell_is_behind_triangles_beyond_it() {
    let golden = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
    let sites: Vec<[f64; 3]> =
        (0..400).map(|i| golden.map(|a| (1.6 * (0.5 + f64::from(i) * a).fract()) - 0.8)).collect();
    let weights: Vec<f64> = (0..400).map(|i| 0.02 * (f64::from(i) * 0.618_033_988_749_895).fract()).collect();
    let ball = crate::shapes::icosphere(3).domain();
    let prepared = crate::PowerDiagram::new(&sites, &weights).unwrap().restricted_to(&ball).prepare().unwrap();
    let all: Vec<[f64; 4]> = prepared.sites.sites().collect();
    let (mut tried, mut left_out) = (0, 0);
    for (i, &[x, y, z, w]) in all.iter().enumerate() {
        let mut store = PlainStore::new([x, y, z], prepared.domain_grid());
        let corner = |c: [f64; 3]| v3(c[0] - x, c[1] - y, c[2] - z);
        let mut status = begin(&mut store, corner(prepared.container.lo), corner(prepared.container.hi));
        for (j, &[a, b, c, d]) in all.iter().enumerate().filter(|&(j, _)| j != i) {
            if status != EMPTY {
                status = clip(&mut store, bisector(v3(a - x, b - y, c - z), w - d), j as u32);
            }
        }
        if status == EMPTY {
            continue;
        }
        compact_planes(&mut store);
        let center = reference_point(&store);
        let (mut low, mut high) = (v3(0.0, 0.0, 0.0), v3(0.0, 0.0, 0.0));
        let (mut lo, mut hi) = (Voxel::default(), Voxel::default());
        outer_box_of_cell(&store, &mut low, &mut high);
        voxels_of_box(&store, low, high, &mut lo, &mut hi);
        let near = nearest_corner(&store, add(store.site(), center), lo, hi);
        store.save();
        let triangles = 0..ball.triangles().len() as u32;
        for (t, apex) in triangles.flat_map(|t| [(t, near), (t, lo)]) {
            tried += 1;
            let beyond = lies_beyond(&store, t, apex);
            let (mut touched, mut sums) = (false, CellSums::default());
            if beyond == CONE_BEYOND {
                left_out += 1;
                assert_eq!(add_cone(&mut store, t, apex, center, FACETS, &mut touched, &mut sums), COMPLETE);
            }
            if beyond != NONE_BEYOND {
                assert_eq!(add_surface(&mut store, t, apex, center, &mut sums), COMPLETE);
            }
            assert_eq!((sums, touched), (CellSums::default(), false), "cell {i}, triangle {t}");
        }
    }
    assert!(4 * left_out > 3 * tried, "{left_out} of {tried}");
}
