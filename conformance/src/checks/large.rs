//! A few inputs with more sites than a generated case has.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use laguerre_core::oracle::Naive;
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, CellStatus, Output, Request};

use crate::backends::are_lanes_emulated;
use crate::bounds::{Planes, SUM, of_digits};
use crate::checks::facets::have_a_laplacian;
use crate::compare::{same, same_cells};
use crate::domains::{Pose, Room, Shape};
use crate::sites::{Random, Sites};
use crate::weights::Weights;
use crate::{Case, Scene, Verdict};

/// 2,000 sites with weights within 0.1 L², most of them hidden, in a box and in a mesh: the oracle's answer, cell by cell.
pub fn hiding_weights(backend: &dyn Backend) -> Verdict {
    for shape in [Shape::Box, Shape::Torus] {
        let scene = white(2000, Weights::Hiding, shape);
        let output = scene.with_facets(backend)?;
        ensure!(output.count(CellStatus::Empty) > 1000, "{} cells are empty", output.count(CellStatus::Empty));
        same(&scene, &scene.with_facets(&Naive::default())?, &output, Planes::Same)
            .map_err(|reason| format!("{shape:?}: {reason}"))?;
    }
    Ok(())
}

/// Sites of which one has w = 0.09 L²: enough that its cell has more than the 512 half-spaces that a device has room for.
fn around_a_heavy_one(backend: &dyn Backend) -> Scene {
    white(if are_lanes_emulated(backend) { 12_000 } else { 20_000 }, Weights::OneHeavy, Shape::Box)
}

/// Sites of which one has w = 0.09 L², 0.04 L² or 0.4 L²: where its cell ends is far from it, but in the second case few voxels of a site grid,
/// and in the third half across. The oracle's answer in every 67th cell, in its own, and in its neighbours'.
pub fn one_heavy_site(backend: &dyn Backend) -> Verdict {
    for share in [1.0, 4.0 / 9.0, 40.0 / 9.0] {
        let mut scene = around_a_heavy_one(backend);
        scene.weights.iter_mut().for_each(|w| *w *= share);
        let output = scene.with_facets(backend)?;
        let heavy = (0..scene.len()).find(|&i| scene.weight(i) > 0.0).unwrap_or_default();
        let facets = output.facets().cloned().unwrap_or_default();
        let mut cells: Vec<usize> = (0..scene.len()).step_by(67).chain([heavy]).collect();
        cells.extend(facets.of(heavy).map(|facet| facet.neighbor).take(100));
        as_the_oracle_says(&scene, &output, &cells)?;
    }
    Ok(())
}

/// The Laplacian where a cell has so many facets that a device leaves it to the host.
pub fn heavy_laplacian(backend: &dyn Backend) -> Verdict {
    let scene = around_a_heavy_one(backend);
    let facets = scene.with_facets(backend)?.facets().cloned().unwrap_or_default();
    let most = (0..scene.len()).map(|i| facets.row(i).len()).max();
    ensure!(most > Some(512), "the largest cell has {most:?} facets");
    have_a_laplacian(&scene, backend)
}

/// Of 2,000 sites, first ones with small weights, then one of them a hundred times, and one with a large weight: the oracle's answer in every
/// 13th cell. (A hundred sites of which one has a cell look like a crowd, but are none.)
pub fn many_at_one_place(backend: &dyn Backend) -> Verdict {
    let light = white(2000, Weights::Mild, Shape::Box);
    light.evaluate(backend, &Request::moments())?;
    let mut scene = white(2000, Weights::OneHeavy, Shape::Box);
    scene.positions.extend([scene.positions[7]; 99]);
    scene.weights.extend([scene.weights[7]; 99]);
    let output = scene.with_facets(backend)?;
    fills(&scene, backend, &output)?;
    as_the_oracle_says(&scene, &output, &(0..scene.len()).step_by(13).collect::<Vec<_>>())
}

/// Lattices of which one site is heavy: their sites stand at the walls of a site grid's voxels, which rounding may take for the one beside. The
/// sums, and the oracle's answer in the cells of the heavy site's row, and of the rows beside it.
pub fn heavy_site_in_a_lattice(backend: &dyn Backend) -> Verdict {
    for (side, heavy) in [(26, [2, 10, 10]), (21, [4, 10, 10]), (26, [10, 17, 10])] {
        let at = |i: usize| (i as f64 + 0.5) / side as f64;
        let index = |[i, j, k]: [usize; 3]| (k * side + j) * side + i;
        let places = (0..side * side * side).map(|n| [at(n % side), at(n / side % side), at(n / side / side)]);
        let mut scene =
            Scene { positions: places.collect(), weights: vec![0.0; side.pow(3)], room: Room::Box([0.0; 3], [1.0; 3]) };
        scene.weights[index(heavy)] = 60.0 / (side * side) as f64;
        let [i, j, k] = heavy;
        let cells: Vec<usize> = (0..side)
            .flat_map(|n| [[n, j, k], [n, j + 1, k], [i, n, k], [i, n, k + 1], [i, j, n]])
            .map(index)
            .collect();
        fills(&scene, backend, &scene.evaluate(backend, &Request::moments())?)?;
        as_the_oracle_says(&scene, &scene.with_facets(backend)?, &cells)?;
    }
    Ok(())
}

/// 3,000 sites near a sphere, with a hollow inside: there cells are cut by sites from all over. The sums, and the oracle's answer in every 31st cell.
pub fn hollow(backend: &dyn Backend) -> Verdict {
    for (shape, weights) in [(Shape::Box, Weights::None), (Shape::Box, Weights::Mild), (Shape::Sphere, Weights::Mild)] {
        let mut scene = white(3000, weights, shape);
        let (lo, hi) = scene.room.bounding_box();
        for p in &mut scene.positions {
            let way: [f64; 3] = std::array::from_fn(|k| (p[k] - lo[k]) / (hi[k] - lo[k]) - 0.5);
            let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
            *p = std::array::from_fn(|k| {
                0.5 * (lo[k] + hi[k]) + (hi[k] - lo[k]) * way[k] * (0.35 + 0.02 * length) / length
            });
        }
        fills_and_is_the_oracles(&scene, backend).map_err(|reason| format!("{shape:?}: {reason}"))?;
    }
    Ok(())
}

/// 2,000 sites on a bumpy surface, on a sphere whose radius varies, or in clusters along a way, in a corner of the box: cells of most reach far, and many sites are nearly as far from a
/// vertex as its own. The sums, the oracle's answer in every 31st cell, and without facets, which devices may compute another way, the same cells.
pub fn surfaces_in_a_corner(backend: &dyn Backend) -> Verdict {
    let bumpy = |[x, y, _]: [f64; 3]| [x, y, 0.5 + 0.1 * (9.0 * x).sin() * (7.0 * y).cos()];
    let round = |[x, y, z]: [f64; 3]| {
        let (height, turn) = (2.0 * x - 1.0, std::f64::consts::TAU * y);
        let (flat, radius) = ((1.0 - height * height).sqrt(), 0.45 + 0.02 * z);
        [flat * turn.cos(), flat * turn.sin(), height].map(|c| 0.5 + radius * c)
    };
    let along = |[x, y, z]: [f64; 3]| {
        let at = (20.0 * x).floor();
        [
            (0.37 * at).fract() + 0.01 * y,
            (0.61 * at).fract() + 0.01 * z,
            0.5 + 0.4 * (3.0 * at).sin() + 0.01 * (20.0 * x - at),
        ]
    };
    type Place = fn([f64; 3]) -> [f64; 3];
    for (name, place) in [("bumpy", bumpy as Place), ("round", round), ("along", along)] {
        let mut scene = white(2000, Weights::None, Shape::Box);
        let (lo, hi) = scene.room.bounding_box();
        for p in &mut scene.positions {
            let part = place(std::array::from_fn(|k| (p[k] - lo[k]) / (hi[k] - lo[k])));
            *p = std::array::from_fn(|k| lo[k] + (hi[k] - lo[k]) * (0.01 + 0.05 * part[k]));
        }
        let (moments, facets) = (scene.evaluate(backend, &Request::moments())?, scene.with_facets(backend)?);
        let said = fills(&scene, backend, &moments)
            .and_then(|()| as_the_oracle_says(&scene, &facets, &(0..scene.len()).step_by(31).collect::<Vec<_>>()))
            // (In single precision facets are computed in double.)
            .and_then(
                |()| if of_digits(backend) > 1.0 { Ok(()) } else { same(&scene, &facets, &moments, Planes::Same) },
            );
        said.map_err(|reason| format!("{name}: {reason}"))?;
    }
    Ok(())
}

/// 8,000 sites with weights that are a smooth function with a step, or grow with the square of the place: cells three spacings from their sites, as
/// optimal transport has them, or shrunk to half. The sums, and the oracle's answer in every 31st cell.
pub fn cells_far_from_their_sites(backend: &dyn Backend) -> Verdict {
    let wavy = |[x, y, z]: [f64; 3]| 0.3 * x - 0.25 * y * y + 0.2 * z * z + if x > 0.5 { 0.02 } else { 0.0 };
    let convex = |[x, y, z]: [f64; 3]| 0.48 * (x * x + y * y + z * z);
    type Weight = fn([f64; 3]) -> f64;
    for (shape, weight) in [(Shape::Box, wavy as Weight), (Shape::Trefoil, wavy), (Shape::Box, convex)] {
        let mut scene = white(8000, Weights::None, shape);
        let (lo, hi) = scene.room.bounding_box();
        let longest = (0..3).fold(0.0_f64, |longest, k| longest.max(hi[k] - lo[k]));
        let of = |p: &[f64; 3]| longest * longest * weight(std::array::from_fn(|k| (p[k] - lo[k]) / longest));
        scene.weights = scene.positions.iter().map(of).collect();
        fills_and_is_the_oracles(&scene, backend).map_err(|reason| format!("{shape:?}: {reason}"))?;
    }
    Ok(())
}

/// Sites that fill a part of their container, those near its inside or those on one side of it: cells at the edge of the cloud reach far
/// beyond it, outside the container or within. The sums, and the oracle's answer in every 31st cell.
pub fn clouds(backend: &dyn Backend) -> Verdict {
    for (shape, weights) in [
        (Shape::Trefoil, Weights::None),
        (Shape::Cavity, Weights::Mild),
        (Shape::Sphere, Weights::None),
        (Shape::Torus, Weights::Mild),
    ] {
        let all = white(6000, weights, shape);
        let cells = all.evaluate(backend, &Request::moments())?;
        let (lo, hi) = all.room.bounding_box();
        let near: Vec<usize> = (0..all.len()).filter(|&i| cells.volume()[i] > 0.0).collect();
        let aside = (0..all.len()).filter(|&i| all.positions[i][0] < lo[0] + 0.3 * (hi[0] - lo[0])).collect();
        for cloud in [near, aside] {
            let scene = Scene {
                positions: cloud.iter().map(|&i| all.positions[i]).collect(),
                weights: cloud.iter().filter_map(|&i| all.weights.get(i).copied()).collect(),
                room: all.room.clone(),
            };
            fills_and_is_the_oracles(&scene, backend).map_err(|reason| format!("{shape:?}: {reason}"))?;
        }
    }
    Ok(())
}

/// 20,000 sites in a knot: the sums, to 1e-14.
pub fn many_sites_in_a_mesh(backend: &dyn Backend) -> Verdict {
    let scene = white(20_000, Weights::Mild, Shape::Trefoil);
    fills(&scene, backend, &scene.evaluate(backend, &Request::moments())?)
}

/// 68,921 sites of a lattice that a flow along two axes has moved by less than a thousandth of their distance, and along the third by 1e-8 to 1e-14 of it, with
/// weights that are smooth up to as much of its square, as a fluid's particles have them: nearly all cells have open signs and vertices of nearly dependent
/// planes. The sums, and the oracle's answer in some cells.
pub fn moved_lattice(backend: &dyn Backend) -> Verdict {
    let side = 41;
    let width = 1.0 / f64::from(side);
    let at = |n: i32| (f64::from(n % side) + 0.5) * width;
    let flow = |x: f64, y: f64| 6e-4 * width * (3.0 * x + 5.0 * y).sin();
    let noise = |random: &mut Random| 10_f64.powf(-8.0 - 6.0 * random.unit());
    for shape in [Shape::Box, Shape::Sphere] {
        let mut random = Random::new(3);
        let mut scene = white(1, Weights::None, shape);
        let (lo, hi) = scene.room.bounding_box();
        let size = hi[0] - lo[0];
        let (positions, weights) = (0..side.pow(3))
            .map(|n| {
                let [x, y, z] = [at(n), at(n / side), at(n / side / side)];
                let place = [x + flow(x, y), y - flow(y, x), z + width * noise(&mut random)];
                let weight = width * width * (0.01 * (4.0 * x).cos() + noise(&mut random));
                (std::array::from_fn(|k| lo[k] + size * place[k]), size * size * weight)
            })
            .unzip();
        (scene.positions, scene.weights) = (positions, weights);
        fills(&scene, backend, &scene.evaluate(backend, &Request::moments())?)?;
        let output = scene.with_facets(backend)?;
        fills(&scene, backend, &output)?;
        as_the_oracle_says(&scene, &output, &(0..scene.len()).step_by(4999).collect::<Vec<_>>())
            .map_err(|reason| format!("{shape:?}: {reason}"))?;
    }
    Ok(())
}

/// With facets and without them the volumes sum to the container's, and every 31st cell is the oracle's.
fn fills_and_is_the_oracles(scene: &Scene, backend: &dyn Backend) -> Verdict {
    fills(scene, backend, &scene.evaluate(backend, &Request::moments())?)?;
    let output = scene.with_facets(backend)?;
    fills(scene, backend, &output)?;
    as_the_oracle_says(scene, &output, &(0..scene.len()).step_by(31).collect::<Vec<_>>())
}

/// Some cells are the oracle's. Facets are compared from the sides of those; the reference for the bounds is the backend's own, whole output.
fn as_the_oracle_says(scene: &Scene, output: &Output, cells: &[usize]) -> Verdict {
    same_cells(scene, output, &*asked(scene, cells)?, Planes::Same, cells)
}

/// The oracle's answer in some cells, which every backend of a run asks for: looked up where one has.
fn asked(scene: &Scene, cells: &[usize]) -> Result<Arc<Output>, String> {
    static ANSWERS: LazyLock<Mutex<HashMap<Vec<u64>, Arc<Output>>>> = LazyLock::new(Mutex::default);
    let mesh = scene.room.mesh();
    let numbers = [&scene.positions, &mesh.vertices].into_iter().flat_map(|points| points.as_flattened());
    let numbers = numbers.chain(&scene.weights).map(|x| x.to_bits());
    let kind = [scene.len() as u64, scene.weights.len() as u64, u64::from(matches!(scene.room, Room::Box(..)))];
    let key: Vec<u64> = kind.into_iter().chain(numbers).chain(cells.iter().map(|&i| i as u64)).collect();
    let answers = || ANSWERS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(answer) = answers().get(&key) {
        return Ok(Arc::clone(answer));
    }
    let only: Vec<u32> = cells.iter().map(|&i| i as u32).collect();
    let naive = Naive::only(&only).evaluate(&scene.diagram()?, &Request::moments().with_facets());
    let answer = Arc::new(naive.map_err(|error| error.to_string())?);
    answers().insert(key, Arc::clone(&answer));
    Ok(answer)
}

/// The volumes sum to the container's.
fn fills(scene: &Scene, backend: &dyn Backend, output: &Output) -> Verdict {
    let mut sum = Sum::default();
    sum.extend(output.volume().iter().copied());
    let (total, volume) = (sum.total(), scene.room.volume());
    let off = (total - volume).abs() / volume;
    ensure!(off <= of_digits(backend) * SUM, "volumes sum to {total} of {volume}: off by {off:e}");
    Ok(())
}

fn white(count: u32, weights: Weights, shape: Shape) -> Scene {
    Case { seed: 3, count, sites: Sites::White, weights, shape, pose: Pose::Plain }.scene()
}
