//! Single cells near to degenerate: what the arithmetic that all backends share promises to its last digits. The laws of whole
//! diagrams allow for the condition of such cells, and so cannot see these promises broken.

use glam::DVec3;
use laguerre_core::cell::bound::{Seer, least_power_of_node, reach_of_bisector};
use laguerre_core::cell::far::asked_at;
use laguerre_core::cell::search_store::{NodeBox, NodeSlab, NodeWeights};
use laguerre_core::cell::{
    self, CellSums, ClipStore, FACETS, IntegralStore, MARK_CONFLICT, MARK_KEEP, PlainStore, Plane, Polytope, Triplet,
    V3, bisector, farthest_vertex, v3,
};
use laguerre_core::exact;
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, CellStatus, Domain, PowerDiagram, Request};

use crate::Verdict;
use crate::bounds::{SUM, U, of_digits};
use crate::domains::{self, Pose, Room, Shape};
use crate::sites::Random;

/// Cells that each law is tried on.
const CELLS: usize = 1500;

/// Every vertex is where its planes meet, to its error radius, and lies on them to a rounding: Cramer's rule is off by the
/// inverse of the normals' determinant, and one step of refinement squares that.
pub fn vertices_lie_on_their_planes(_: &dyn Backend) -> Verdict {
    let mut random = Random::new(1);
    for _ in 0..CELLS {
        let store = hard_cell(&mut random);
        for v in 0..store.vertices() {
            let [a, b, c] = planes_of(&store, v);
            let share = vector(a.n).dot(vector(b.n).cross(vector(c.n))) / (size(a.n) * size(b.n) * size(c.n));
            let cramer = 16.0 * U / share;
            let rest = match share {
                s if s > REFINED_BELOW => cramer,
                s if s > EXACT_BELOW / 2.0 => cramer * cramer,
                _ => 0.0,
            };
            let (at, mut exactly) = (vector(store.position(v)), v3(0.0, 0.0, 0.0));
            ensure!(exact::position(a, b, c, &mut exactly) == cell::COMPLETE, "a vertex without a position");
            let (off, radius) = ((vector(exactly) - at).abs().max_element(), store.radius(v));
            ensure!(off <= radius, "a vertex of share {share:e} is {off:e} off, not within {radius:e}");
            // As devices ask: for less where less will do.
            for most in [6e-8, 4e-12, 1.2e-15] {
                let (mut place, mut radius) = (v3(0.0, 0.0, 0.0), 0.0);
                let told = cell::find_vertex_closely(&store, store.triplet(v), most, &mut place, &mut radius);
                let (off, at) =
                    ((vector(exactly) - vector(place)).abs().max_element(), vector(place).abs().max_element());
                ensure!(told == cell::COMPLETE || share < TOLD_CLOSELY, "a vertex of share {share:e} is not told");
                ensure!(
                    told != cell::COMPLETE || (off <= radius && radius <= most * at),
                    "a vertex of share {share:e} is {off:e} off, not within {radius:e}, or more than {most:e} of {at:e}"
                );
            }
            // And as a sweep does of its new vertices.
            let (mut place, mut radius) = (v3(0.0, 0.0, 0.0), 0.0);
            let told = cell::find_vertex_once(&store, store.triplet(v), TOLD_ROUGHLY, &mut place, &mut radius);
            let off = (vector(exactly) - vector(place)).abs().max_element();
            ensure!(told == cell::COMPLETE || share < 1.1 * TOLD_ROUGHLY, "a vertex of share {share:e} is not told");
            ensure!(
                told != cell::COMPLETE || off <= radius,
                "a vertex of share {share:e} is roughly {off:e} off, not within {radius:e}"
            );
            for plane in [a, b, c] {
                let off = height(plane, store.position(v)).abs();
                // 4 roundings for what is measured here, 8 for the position's correction.
                let bound = (12.0 * U + rest) * (size(plane.n) * at.abs().max_element() + plane.d.abs());
                ensure!(off <= bound, "a vertex of share {share:e} is {off:e} off its plane, bound {bound:e}");
            }
        }
    }
    Ok(())
}

/// Exact positions are rounded once: where planes along the axes meet, they are the quotients of IEEE arithmetic.
pub fn exact_positions_are_rounded_once(_: &dyn Backend) -> Verdict {
    let mut random = Random::new(7);
    // Of some 2,000 quotients one is so near to the middle of two numbers that only the division's remainder tells.
    for _ in 0..10 * CELLS {
        let [n, d] = [0, 1].map(|_| [0, 1, 2].map(|_| 1.0 + random.unit()));
        let axes = [[n[0], 0.0, 0.0], [0.0, n[1], 0.0], [0.0, 0.0, n[2]]];
        let [a, b, c] = [0, 1, 2].map(|k| Plane { n: plain(axes[k].into()), d: d[k] });
        let mut position = v3(0.0, 0.0, 0.0);
        ensure!(exact::position(a, b, c, &mut position) == cell::COMPLETE, "axes that do not meet");
        let quotients = [0, 1, 2].map(|k| -d[k] / n[k]);
        ensure!(vector(position) == DVec3::from(quotients), "{position:?} is not {quotients:?}");
    }
    Ok(())
}

/// What floating point decides about a vertex and a plane is the exact sign.
pub fn signs_are_exact(_: &dyn Backend) -> Verdict {
    let mut random = Random::new(2);
    let mut decided = 0;
    for _ in 0..CELLS {
        let mut store = hard_cell(&mut random);
        let k = store.planes();
        for _ in 0..16 {
            // Past a vertex, by a little of what floating point cannot see, or of the vertex's error radius.
            let v = random.below(store.vertices() as usize) as u32;
            let (p, n) = (vector(store.position(v)), random.direction());
            let step = match random.below(2) {
                0 => U * size(plain(n)) * p.abs().max_element(),
                _ => size(plain(n)) * store.radius(v),
            };
            let plane = Plane { n: plain(n), d: -n.dot(p) + step * (2.5 * random.unit() - 1.25) };
            store.set_plane(k, plane);
            store.mark_conflicts(k);
            for v in 0..store.vertices() {
                let Triplet { a, b, c } = store.triplet(v);
                let sign = exact::sign_of_planes(store.plane(a), store.plane(b), store.plane(c), plane);
                let is_true = match store.mark(v) {
                    MARK_KEEP => sign > 0,
                    MARK_CONFLICT => sign < 0,
                    _ => continue,
                };
                decided += 1;
                ensure!(
                    is_true,
                    "mark {} for the exact sign {sign} of {plane:?} at {:?}",
                    store.mark(v),
                    store.triplet(v)
                );
            }
        }
    }
    ensure!(decided > CELLS, "only {decided} signs were decided by floating point");
    Ok(())
}

/// A site that the search leaves out, near or far, is in conflict with no vertex, though it miss one by a rounding.
pub fn no_false_proof(_: &dyn Backend) -> Verdict {
    let mut random = Random::new(3);
    let mut proofs = [0; 2];
    for _ in 0..CELLS {
        let store = hard_cell(&mut random);
        let farthest = farthest_vertex(&store);
        for v in 0..store.vertices() {
            let mut exact_position = v3(0.0, 0.0, 0.0);
            let [a, b, c] = planes_of(&store, v);
            if exact::position(a, b, c, &mut exact_position) != cell::COMPLETE {
                return Err("a vertex without a position".into());
            }
            let distance = vector(exact_position).length();
            // A rounding of each component, three of the length.
            ensure!(farthest >= distance * (1.0 - 4.0 * U), "a vertex is {distance:e} away, not within {farthest:e}");
        }
        for _ in 0..16 {
            // A site whose bisector passes through a vertex, but for some roundings; mostly the farthest one.
            let at = |v: u32| vector(store.position(v));
            let all = 0..store.vertices();
            let v = match random.below(3) {
                0 => random.below(store.vertices() as usize) as u32,
                _ => all.max_by(|&v, &w| at(v).length().total_cmp(&at(w).length())).unwrap_or(0),
            };
            let toward = (at(v).normalize() + [0.0, 0.1][random.below(2)] * random.direction()).normalize();
            let along = at(v).dot(toward);
            let difference = [0.0, 0.5, -0.5][random.below(3)] * along * along * random.unit();
            let distance = along + (along * along - difference).sqrt();
            let roundings = 10_f64.powf(4.0 * random.unit()) * (2.0 * random.unit() - 1.0);
            let site = plain(toward * distance * (1.0 + U * roundings));
            let plane = bisector(site, difference);
            let conflicts = (0..store.vertices()).any(|v| {
                let [a, b, c] = planes_of(&store, v);
                exact::sign_of_planes(a, b, c, plane) < 0
            });
            let near = reach_of_bisector(v3(0.0, 0.0, 0.0), site, -difference) >= 4.0 * farthest * farthest;
            let far = (0..store.vertices()).all(|v| power_is_beyond(&store, v, site, -difference));
            proofs[0] += usize::from(near);
            proofs[1] += usize::from(far);
            ensure!(
                !(near && conflicts),
                "the search near leaves out {site:?}, which cuts; weights differ by {difference}"
            );
            ensure!(
                !(far && conflicts),
                "the search far leaves out {site:?}, which cuts; weights differ by {difference}"
            );
        }
    }
    ensure!(proofs.iter().all(|&p| p > 0), "{proofs:?} sites were left out");
    Ok(())
}

/// Whether a node of one site, which weighs `excess` more than the cell's, is not opened for vertex `v`.
fn power_is_beyond(store: &PlainStore<'_>, v: u32, site: V3, excess: f64) -> bool {
    let seer = Seer { site: v3(0.0, 0.0, 0.0), excess: (-excess).max(0.0), has_weights: true };
    let more = excess + seer.excess;
    let bounds = NodeBox { lo: site, hi: site };
    let slab = NodeSlab { normal: v3(1.0, 0.0, 0.0), lo: site.x, hi: site.x, largest: more };
    let weights = NodeWeights { offset: more, ..NodeWeights::default() };
    let place = store.position(v);
    least_power_of_node(seer, place, bounds, slab, weights) >= asked_at(excess, v, place, store.radius(v)).limit
}

/// Areas and volume are those of the polygons that the vertices span, however far the site is and however nearly parallel two
/// planes are.
pub fn integrals_are_of_the_polygons(_: &dyn Backend) -> Verdict {
    let mut random = Random::new(4);
    for _ in 0..CELLS {
        let mut store = hard_cell(&mut random);
        let mut sums = CellSums::default();
        if cell::integrate_cell(&mut store, FACETS, 0, &mut sums) != cell::COMPLETE {
            continue;
        }
        let at = |v: u32| vector(store.position(v));
        let vertices = store.vertices();
        let middle = (0..vertices).map(at).sum::<DVec3>() / f64::from(vertices);
        let size = (0..vertices).map(|v| at(v).distance(middle)).fold(0.0, f64::max);
        let reach = (0..vertices).map(|v| at(v).length()).fold(0.0, f64::max);
        let (mut volume, mut surface) = (0.0, 0.0);
        for f in 0..store.planes() {
            let cycle = cycle(&store, f);
            let (normal, mut polygon) = (vector(store.plane(f).n).normalize(), 0.0);
            for k in 2..cycle.len() {
                let [a, b, c] = [cycle[0], cycle[k - 1], cycle[k]].map(at);
                let double = (b - a).cross(c - a);
                polygon += double.dot(normal) / 2.0;
                volume -= (a - middle).dot(double) / 6.0;
            }
            surface += polygon.abs();
            // The feet on the edges are off by the inverse of the sine between their planes, down to where they are exact.
            let sines = cycle.iter().flat_map(|&v| planes_of(&store, v)).map(|g| {
                let sine = vector(g.n).normalize().cross(normal).length();
                if sine > EXACT_BELOW { sine } else { 1.0 }
            });
            let foot = 1.0 / sines.fold(1.0, f64::min);
            let bound = ROUNDINGS * cycle.len() as f64 * U * reach * size * foot;
            let off = (store.facet(f).area - polygon).abs();
            ensure!(
                off <= bound,
                "facet {f} of area {:e}, its polygon {polygon:e}: bound {bound:e}",
                store.facet(f).area
            );
        }
        let (off, bound) =
            ((sums.volume - volume).abs(), ROUNDINGS * f64::from(vertices) * U * reach * (surface + U * reach * reach));
        ensure!(off <= bound, "volume {:e}, of the polygons {volume:e}: bound {bound:e}", sums.volume);
    }
    Ok(())
}

/// A cell that the surface does not meet has, to the last bit, the integrals of the whole cell times a winding number, though
/// the cones over the triangles around it cut it to pieces.
pub fn untouched_cells_are_whole(_: &dyn Backend) -> Verdict {
    let mut random = Random::new(5);
    for shape in [Shape::BoxMesh, Shape::Sphere, Shape::Torus, Shape::NestedSpheres, Shape::Plate] {
        let Room::Mesh(_, domain) = domains::room(shape, Pose::Plain) else { return Err("no mesh".into()) };
        let grid = domain.grid(1);
        let [lo, hi] = [[0; 3], grid.dims()].map(|voxel| DVec3::from(grid.corner(voxel)));
        let mut pieces = 0;
        for _ in 0..CELLS {
            let site = lo + random.point() * (hi - lo);
            let half = 0.6 * grid.voxel_width();
            let planes: Vec<Plane> = (0..4).map(|_| bisector(plain(half * random.direction()), 0.0)).collect();
            let [near, far] = [(lo - site).max(DVec3::splat(-half)), (hi - site).min(DVec3::splat(half))].map(plain);
            let sums_in = |domain| {
                let mut store = PlainStore::new(site.into(), domain);
                let mut sums = CellSums::default();
                cell::begin(&mut store, near, far);
                planes.iter().for_each(|&plane| _ = cell::clip(&mut store, plane, 0));
                (cell::integrate_cell(&mut store, FACETS, 0, &mut sums), sums)
            };
            let ((status, part), (_, whole)) = (sums_in(Some(grid)), sums_in(None));
            if status != cell::COMPLETE || part.boundary_area != 0.0 {
                continue;
            }
            pieces += 1;
            let winding = (part.volume / whole.volume).round();
            ensure!(part.volume == winding * whole.volume, "{shape:?}: {:e} of {:e}", part.volume, whole.volume);
        }
        ensure!(pieces > 10 || shape == Shape::Plate, "{shape:?}: {pieces} cells inside");
    }
    Ok(())
}

/// Corners of the domain's grid lie in the plane of a face, outside the face, exactly or to a rounding. The face's cone from there
/// is flat, or so thin that it is lost, but the face still divides the cells that it meets.
pub fn face_in_line_with_corners(backend: &dyn Backend) -> Verdict {
    // A prism along y. Of its section the lower edge is drawn so that its line passes through the grid's lowest corner, and,
    // being inclined by 1025/1024, through no other.
    let prism = |section: &[[f64; 2]]| {
        let n = section.len() as u32;
        let vertices: Vec<[f64; 3]> =
            [0.0, 1.0].iter().flat_map(|&y| section.iter().map(move |&[x, z]| [x, y, z])).collect();
        let caps = (2..n).flat_map(|k| [[0, k - 1, k], [n, n + k, n + k - 1]]);
        let sides = (0..n).map(|k| (k, (k + 1) % n)).flat_map(|(k, next)| [[k, n + k, next], [next, n + k, n + next]]);
        Domain::new(&vertices, &caps.chain(sides).collect::<Vec<_>>()).map_err(|e| e.to_string())
    };
    let corner_of = |domain: &Domain| domain.grid(300).corner([0; 3]);
    let [x, y, z] = corner_of(&prism(&[[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])?);
    let on_line = |t: f64| [x + t, z + (t + t / 1024.0)];
    let point = |[x, z]: [f64; 2], y: f64| v3(x, y, z);
    let mut signs = [0; 3];
    for [l, r] in (-3..=3).flat_map(|l| (-3..=3).map(move |r| [l, r])) {
        let [left, right] = [(-x, l), (0.5, r)].map(|(t, roundings)| {
            let [x, z] = on_line(t);
            [x, z + f64::from(roundings) * U * z]
        });
        let domain = prism(&[[0.0, 1.0], left, right, [1.0, 0.0], [1.0, 1.0]])?;
        ensure!(corner_of(&domain) == [x, y, z], "another grid");
        let sign = exact::sign_of_cone(point(left, 0.0), point(right, 0.0), point(left, 1.0), v3(x, y, z));
        signs[(sign + 1) as usize] += 1;
        // Cells of a third of a voxel, where the face begins.
        let mut random = Random::new(6);
        let width = domain.grid(300).voxel_width();
        let place = |at: DVec3| [2.0 * width * at.x, 0.4 + 2.0 * width * at.y, 2.0 * width * at.z];
        let sites: Vec<[f64; 3]> = (0..300).map(|_| place(random.point())).collect();
        sums_to(backend, &domain, &sites).map_err(|e| format!("{e}; {l} and {r} roundings off the line"))?;
    }
    ensure!(signs.iter().all(|&count| count > 0), "corners on the sides of the face: {signs:?}");
    Ok(())
}

/// A line of the grid's corners, along which winding numbers are counted, would run through vertices of the domain: the grid is
/// shifted.
pub fn vertices_in_line_with_corners(backend: &dyn Backend) -> Verdict {
    // A box, and in it an octahedron of which two vertices are on such a line of the box's grid.
    let corners: Vec<[f64; 3]> = (0..8).map(|c| [0, 1, 2].map(|k| f64::from(c >> k & 1))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let cube: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let alone = Domain::new(&corners, &cube).map_err(|e| e.to_string())?;
    let [_, y, z] = alone.grid(300).corner([0, 6, 6]);
    let axes = [0, 1, 2].map(|k| if k == 0 { 0.375 } else { 0.25 });
    let tips = (0..6).map(|tip| {
        let mut at = [0.5, y, z];
        at[tip / 2] += axes[tip / 2] * if tip % 2 == 0 { 1.0 } else { -1.0 };
        at
    });
    let vertices: Vec<[f64; 3]> = corners.iter().copied().chain(tips).collect();
    let octants = (0..8_u32).map(|o| {
        let [a, b, c] = [8 + (o & 1), 10 + (o >> 1 & 1), 12 + (o >> 2)];
        if o.count_ones() % 2 == 0 { [a, b, c] } else { [a, c, b] }
    });
    let triangles: Vec<[u32; 3]> = cube.iter().copied().chain(octants).collect();
    let domain = Domain::new(&vertices, &triangles).map_err(|e| e.to_string())?;
    let mut random = Random::new(8);
    let sites: Vec<[f64; 3]> = (0..300).map(|_| random.point().into()).collect();
    sums_to(backend, &domain, &sites)
}

/// That the volumes of the cells of `sites` sum to that of the domain.
fn sums_to(backend: &dyn Backend, domain: &Domain, sites: &[[f64; 3]]) -> Verdict {
    let diagram = PowerDiagram::new(sites, &[]).map_err(|e| e.to_string())?.restricted_to(domain);
    let output = backend.evaluate(&diagram, &Request::moments()).map_err(|e| e.to_string())?;
    ensure!(output.count(CellStatus::Complete) > 150, "{} cells", output.count(CellStatus::Complete));
    let mut sum = Sum::default();
    sum.extend(output.volume().iter().copied());
    let (total, volume) = (sum.total(), domain.volume());
    ensure!((total - volume).abs() <= of_digits(backend) * SUM * volume, "the volumes sum to {total}, not {volume}");
    Ok(())
}

/// Below this share of the norms' product the library refines what Cramer's rule gives.
const REFINED_BELOW: f64 = 1.0 / 512.0;

/// From this share on steps of Newton's method lead to any place.
const TOLD_CLOSELY: f64 = 1e-10;

/// From this share on a device that sweeps cells takes what Cramer's rule tells: 2⁻³².
const TOLD_ROUGHLY: f64 = 2.328_306_436_538_696_3e-10;

/// Below this share it computes positions exactly, and below this sine feet on edges.
const EXACT_BELOW: f64 = 1e-10;

/// Roundings of the signed areas at a corner of a facet, or of the volumes there.
const ROUNDINGS: f64 = 64.0;

/// A cell of few to many facets, some of them nearly parallel to others and crossing them inside it; its site may be far outside.
fn hard_cell(random: &mut Random) -> PlainStore<'static> {
    let mut store = PlainStore::new([0.0; 3], None);
    let away = random.direction() * [0.0, 0.0, 1.0, 30.0, 1000.0][random.below(5)];
    let half = DVec3::splat(0.5) + random.point();
    cell::begin(&mut store, plain(away - half), plain(away + half));
    let mut last = DVec3::Z;
    for _ in 0..4 + random.below(30) {
        let toward = match random.below(3) {
            0 => last + random.direction() * 10_f64.powf(-14.0 * random.unit()),
            _ => away + 2.0 * random.direction(),
        };
        // Through a point of the cell, near its rim for most.
        let v = random.below(store.vertices() as usize) as u32;
        let inner = [0.0, 0.1, 0.3, 0.9][random.below(4)];
        let through = vector(store.position(v)).lerp(away, inner);
        let weight = 2.0 * toward.dot(through) - toward.length_squared();
        let before = store.clone();
        if !matches!(cell::clip(&mut store, bisector(plain(toward), weight), 0), cell::CUT | cell::UNTOUCHED) {
            store = before;
        }
        last = toward;
    }
    store
}

fn planes_of(store: &PlainStore<'_>, v: u32) -> [Plane; 3] {
    let Triplet { a, b, c } = store.triplet(v);
    [a, b, c].map(|f| store.plane(f))
}

/// The vertices of facet `f`, one after the other, counterclockwise about its inward normal.
fn cycle(store: &PlainStore<'_>, f: u32) -> Vec<u32> {
    // As (the plane before, the plane after, vertex): the triplet is clockwise from outside.
    let mut corners: Vec<(u32, u32, u32)> = Vec::new();
    for v in 0..store.vertices() {
        let Triplet { a, b, c } = store.triplet(v);
        let around = [(a, b, c), (b, c, a), (c, a, b)].into_iter().find(|t| t.0 == f);
        corners.extend(around.map(|(_, g, h)| (g, h, v)));
    }
    for i in 1..corners.len() {
        let after = corners[i - 1].1;
        if let Some(next) = corners[i..].iter().position(|c| c.0 == after) {
            corners.swap(i, i + next);
        }
    }
    corners.iter().map(|c| c.2).collect()
}

fn vector(a: V3) -> DVec3 {
    DVec3::new(a.x, a.y, a.z)
}

fn plain(a: DVec3) -> V3 {
    v3(a.x, a.y, a.z)
}

fn dot(a: V3, b: V3) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// ‖n‖₁.
fn size(n: V3) -> f64 {
    n.x.abs() + n.y.abs() + n.z.abs()
}

fn height(plane: Plane, x: V3) -> f64 {
    dot(plane.n, x) + plane.d
}
