//! Domains with a density: images, whose integrals are weighted.

use laguerre_core::summation::Sum;
use laguerre_core::{Backend, Domain, Output, PowerDiagram, Request};

use crate::Verdict;
use crate::bounds::of_digits;
use crate::sites::Random;

const LO: [f64; 3] = [-1.0, 0.5, 2.0];
const HI: [f64; 3] = [1.0, 2.0, 3.0];

/// Of values of size 1, of some tens of roundings each.
const BOUND: f64 = 1e-12;

fn image(values: &[f64], shape: [usize; 3]) -> Result<Domain, String> {
    Domain::of_image(values, shape, LO, HI).map_err(|error| error.to_string())
}

/// White sites in and about the box, with weights.
fn diagram(sites: usize, seed: u64) -> Result<PowerDiagram, String> {
    let mut random = Random::new(seed);
    let mut at = |k: usize| LO[k] + (HI[k] - LO[k]) * (1.2 * random.unit() - 0.1);
    let positions: Vec<[f64; 3]> = (0..sites).map(|_| [at(0), at(1), at(2)]).collect();
    let weights: Vec<f64> = (0..sites).map(|_| random.unit() / (sites as f64).powf(2.0 / 3.0)).collect();
    PowerDiagram::new(&positions, &weights).map_err(|error| error.to_string())
}

fn evaluate(backend: &dyn Backend, sites: &PowerDiagram, domain: &Domain, request: &Request) -> Result<Output, String> {
    backend.evaluate(&sites.clone().restricted_to(domain), request).map_err(|error| error.to_string())
}

/// Integrals over an image are the weighted sums of those over its voxels, one by one: masses, moments, facets, the flux of the boundary.
pub fn parts(backend: &dyn Backend) -> Verdict {
    let (shape, count) = ([3, 2, 2], 12);
    let bound = BOUND.max(of_digits(backend));
    let request = Request::moments().with_facets().with_second_moments();
    let sites = diagram(60, 11)?;
    let mut random = Random::new(12);
    // Some voxels are empty, and some have the density of a neighbour.
    let values: Vec<f64> =
        (0..count).map(|i| if i % 4 == 1 { 0.0 } else { (random.unit() * 6.0).floor() / 4.0 }).collect();
    let whole = evaluate(backend, &sites, &image(&values, shape)?, &request)?;
    let n = whole.volume().len();
    let facets = whole.facets().ok_or("no facets")?;
    let (mut sums, mut areas) = (vec![[0.0; 8]; n], vec![0.0; facets.len()]);
    for (i, value) in values.iter().enumerate() {
        let alone: Vec<f64> = (0..count).map(|k| if k == i { 1.0 } else { 0.0 }).collect();
        let part = evaluate(backend, &sites, &image(&alone, shape)?, &request)?;
        for (cell, sums) in sums.iter_mut().enumerate() {
            let own = integrals(&part, cell);
            (0..8).for_each(|k| sums[k] += value * own[k]);
            for facet in part.facets().ok_or("no facets")?.of(cell) {
                match facets.between(cell, facet.neighbor) {
                    Some(k) => areas[k] += value * facet.area,
                    None => ensure!(
                        value * facet.area <= bound,
                        "cell {cell}: its facet with {} is missing",
                        facet.neighbor
                    ),
                }
            }
        }
    }
    for (cell, sums) in sums.iter().enumerate() {
        for (k, (found, right)) in integrals(&whole, cell).into_iter().zip(sums).enumerate() {
            ensure!((found - right).abs() <= bound, "cell {cell}: integral {k} is {found}, its parts sum to {right}");
        }
        for facet in facets.of(cell) {
            let (found, right) = (facet.area, areas[facet.number]);
            ensure!(
                (found - right).abs() <= bound,
                "facet {cell}, {}: {found}, its parts sum to {right}",
                facet.neighbor
            );
        }
    }
    Ok(())
}

/// Mass, first moment, second moment's trace, the boundary's vector area and flux.
fn integrals(output: &Output, cell: usize) -> [f64; 8] {
    let mass = output.volume()[cell];
    if mass == 0.0 {
        return [0.0; 8];
    }
    let [x, y, z] = output.barycenter()[cell].map(|b| mass * b);
    // About the origin, so that it adds up.
    let second = output.second_moment().map_or([0.0; 6], |second| second[cell]);
    let trace = second[0] + second[1] + second[2] + (x * x + y * y + z * z) / mass;
    let piece = output.boundary().map(|boundary| boundary[cell]).unwrap_or_default();
    let [u, v, w] = piece.vector_area;
    [mass, x, y, z, trace, u, v, w]
}

/// Many cells in an image of strong contrast: their masses sum to the image's, and where density is the same all over, they are volumes.
pub fn contrast(backend: &dyn Backend) -> Verdict {
    let shape = [9, 8, 7];
    let count = shape.iter().product::<usize>();
    let bound = BOUND.max(of_digits(backend));
    let mut random = Random::new(21);
    let values: Vec<f64> = (0..count).map(|_| (255.0 * random.unit().powi(6)).floor()).collect();
    let domain = image(&values, shape)?;
    let sites = diagram(3000, 22)?;
    let request = Request::moments().with_facets();
    let output = evaluate(backend, &sites, &domain, &request)?;
    let voxel = (0..3).map(|k| HI[k] - LO[k]).product::<f64>() / count as f64;
    let right = values.iter().sum::<f64>() * voxel;
    ensure!((domain.volume() - right).abs() <= 1e-14 * right, "the image has {}, not {right}", domain.volume());
    let mut sum = Sum::default();
    sum.extend(output.volume().iter().copied());
    ensure!((sum.total() - right).abs() <= bound * right, "masses sum to {}, not to {right}", sum.total());
    let facets = output.facets().ok_or("no facets")?;
    for cell in 0..output.volume().len() {
        ensure!(output.volume()[cell] >= 0.0, "cell {cell} has {}", output.volume()[cell]);
        for facet in facets.of(cell) {
            let back = facets.opposite(facet.number).map(|k| facets.area()[k]);
            let off = back.map_or(facet.area, |back| (back - facet.area).abs());
            ensure!(off <= 256.0 * bound, "facet {cell}, {}: {} and {back:?}", facet.neighbor, facet.area);
        }
    }
    let flat = evaluate(backend, &sites, &image(&vec![3.0; count], shape)?, &request)?;
    let boxed = sites.clone().in_box(LO, HI).map_err(|error| error.to_string())?;
    let boxed = backend.evaluate(&boxed, &request).map_err(|error| error.to_string())?;
    for (cell, (mass, volume)) in flat.volume().iter().zip(boxed.volume()).enumerate() {
        ensure!(
            (mass - 3.0 * volume).abs() <= bound,
            "cell {cell}: {mass} where the density is 3, its volume is {volume}"
        );
    }
    Ok(())
}
