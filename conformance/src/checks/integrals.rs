//! Integrals of given functions.

use std::sync::{Arc, Mutex};

use glam::{DMat3, DVec3};
use laguerre_core::oracle::Naive;
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, CellStatus, Error, ErrorKind, Integrand, Output, Request};

use crate::bounds::{Bounds, Planes, ROUNDINGS, U};
use crate::domains::Room;
use crate::sites::Random;
use crate::{Case, Scene, Verdict};

/// Largest degree of the polynomials that are tried: even and odd ones are.
const LARGEST_DEGREE: usize = 6;

/// The cells' integrals of a polynomial of any degree sum to the container's.
pub fn sum(backend: &dyn Backend, case: &Case) -> Verdict {
    let mut random = case.random(20);
    let degree = random.below(LARGEST_DEGREE + 1);
    let scene = case.scene();
    let f = Polynomial::random(&scene, degree, &mut random);
    let output = scene.evaluate(backend, &Request::moments().with_facets().with_integral(f.integrand()?))?;
    let mut sum = Sum::default();
    sum.extend(integrals(&output)?.iter().copied());
    let (total, wanted) = (sum.total(), f.over(&scene.room));
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    // Coordinates are rounded to u times their distance from the origin.
    let coordinates = f.slope() * ROUNDINGS * U * f.origin.length() * scene.room.volume();
    let bound = f.size() * bounds.volume_sum() + coordinates;
    let off = (total - wanted).abs();
    ensure!(off <= bound, "{f:?}: integrals sum to {total:e}, not {wanted:e}: off by {off:e}, bound {bound:e}");
    Ok(())
}

/// Of a polynomial up to degree 2 each cell's integral is what its moments say.
pub fn moments(backend: &dyn Backend, case: &Case) -> Verdict {
    let (scene, mut random) = (case.scene(), case.random(21));
    let f = Polynomial::random(&scene, 2, &mut random);
    let request = Request::moments().with_facets().with_second_moments().with_integral(f.integrand()?);
    let output = scene.evaluate(backend, &request)?;
    let bounds = Bounds::new(&scene, &output, Planes::Same);
    let second = output.second_moment().unwrap_or_default();
    for (i, &found) in integrals(&output)?.iter().enumerate() {
        let empty = output.status()[i] == CellStatus::Empty;
        ensure!(!empty || found == 0.0, "site {i} is empty with integral {found:e}");
        if empty {
            continue;
        }
        let (v, b, s) = (output.volume()[i], DVec3::from(output.barycenter()[i]) - f.origin, second[i]);
        let moment = |powers: [u32; 3]| {
            let axes: Vec<usize> = (0..3).flat_map(|k| vec![k; powers[k] as usize]).collect();
            match axes[..] {
                [] => v,
                [k] => v * b[k],
                [k, l] => v * b[k] * b[l] + s[if k == l { k } else { k + l + 2 }],
                _ => f64::NAN,
            }
        };
        let wanted: f64 = f.terms.iter().map(|(powers, c)| c * moment(*powers)).sum();
        let off = (found - wanted).abs();
        let bound = cell_bound(&bounds, i, &f) + f.slope() * ROUNDINGS * U * f.origin.length() * v.abs();
        ensure!(off <= bound, "site {i}, {f:?}: {found:e}, by moments {wanted:e}: off by {off:e}, bound {bound:e}");
    }
    Ok(())
}

/// Every cell's integral is the naive oracle's.
pub fn like_the_oracle(backend: &dyn Backend, case: &Case) -> Verdict {
    let (scene, mut random) = (case.scene(), case.random(22));
    let f = Polynomial::random(&scene, 3, &mut random);
    let request = Request::moments().with_facets().with_integral(f.integrand()?);
    let (naive, output) = (scene.evaluate(&Naive::default(), &request)?, scene.evaluate(backend, &request)?);
    same(&Bounds::new(&scene, &naive, Planes::Same), &f, integrals(&naive)?, integrals(&output)?)
}

/// A translation of everything, the function included, changes nothing but rounding.
pub fn translation(backend: &dyn Backend, case: &Case) -> Verdict {
    let (scene, mut random) = (case.scene(), case.random(23));
    let f = Polynomial::random(&scene, 3, &mut random);
    let shift = scene.room.extents() * (4.0 * random.point() - 2.0);
    let moved = Polynomial { origin: f.origin + shift, ..f.clone() };
    let request = |f: &Polynomial| Ok::<_, String>(Request::moments().with_facets().with_integral(f.integrand()?));
    let here = scene.evaluate(backend, &request(&f)?)?;
    let there = scene.moved(DMat3::IDENTITY, 1.0, shift).evaluate(backend, &request(&moved)?)?;
    same(&Bounds::new(&scene, &here, Planes::Rounded), &f, integrals(&here)?, integrals(&there)?)
}

/// On the CPU a function is integrated as the polynomial that it is, and asked for within the container's box alone; elsewhere it is refused.
pub fn functions(backend: &dyn Backend, case: &Case) -> Verdict {
    let (scene, mut random) = (case.scene(), case.random(24));
    let f = Polynomial::random(&scene, 3, &mut random);
    let (inner, seen) = (f.clone(), Arc::new(Mutex::new((DVec3::INFINITY, DVec3::NEG_INFINITY))));
    let note = Arc::clone(&seen);
    let function = move |x: [f64; 3]| {
        let x = DVec3::from(x);
        let mut seen = note.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *seen = (seen.0.min(x), seen.1.max(x));
        inner.value(x)
    };
    let function = Integrand::function(3, function).map_err(|error| error.to_string())?;
    let request = |f: Integrand| Request::moments().with_facets().with_integral(f);
    if backend.info().backend != "cpu" {
        return is_refused(backend, &scene, &request(function));
    }
    // Called with many places at once it is the same to the last bit, column by column.
    let (inner, batches) = (f.clone(), Arc::new(Mutex::new(0)));
    let count = Arc::clone(&batches);
    let of_many = move |places: &[[f64; 3]]| {
        *count.lock().unwrap_or_else(std::sync::PoisonError::into_inner) += 1;
        Ok(places.iter().map(|&x| inner.value(DVec3::from(x))).flat_map(|value| [value, -2.0 * value]).collect())
    };
    let of_many = Integrand::batches(3, 2, of_many).map_err(|error| error.to_string())?;
    let of_polynomial = scene.evaluate(backend, &request(f.integrand()?))?;
    let of_function = scene.evaluate(backend, &request(function))?;
    let bounds = Bounds::new(&scene, &of_polynomial, Planes::Same);
    same(&bounds, &f, integrals(&of_polynomial)?, integrals(&of_function)?)?;
    let of_many = scene.evaluate(backend, &request(of_many))?;
    let doubled: Vec<f64> = integrals(&of_function)?.iter().flat_map(|&value| [value, -2.0 * value]).collect();
    ensure!(of_many.integral() == Some(&doubled[..]), "in batches it is another");
    let batches = *batches.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    ensure!(batches <= scene.len(), "{batches} calls for {} sites", scene.len());
    let (lo, hi) = grid_box(&scene.room);
    let margin = DVec3::splat((0..scene.len()).map(|i| bounds.displacement(i)).fold(0.0, f64::max));
    let (low, high) = *seen.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let inside = low.cmpge(lo - margin).all() && high.cmple(hi + margin).all();
    ensure!(inside, "the function was asked for in {low} to {high}, the box is {lo} to {hi}");
    Ok(())
}

/// What is no polynomial converges with the degree: exp(x + y + z) over the unit cube, from 30 sites.
pub fn converges(backend: &dyn Backend) -> Verdict {
    let mut random = Random::new(25);
    let positions: Vec<[f64; 3]> = (0..30).map(|_| random.point().into()).collect();
    let scene = Scene { positions, weights: Vec::new(), room: Room::Box([0.0; 3], [1.0; 3]) };
    let wanted = 1_f64.exp_m1().powi(3);
    // What one cell's size h leaves of a rule of degree n is about h^(n + 1)/(n + 1)! of the whole, h here about 0.6.
    for (degree, bound) in [(1, 2e-2), (3, 2e-4), (5, 1e-6), (7, 1e-8), (9, 1e-10), (13, 1e-13)] {
        let f = Integrand::function(degree, |[x, y, z]| (x + y + z).exp()).map_err(|error| error.to_string())?;
        let request = Request::moments().with_integral(f);
        if backend.info().backend != "cpu" {
            return is_refused(backend, &scene, &request);
        }
        let output = scene.evaluate(backend, &request)?;
        let mut sum = Sum::default();
        sum.extend(integrals(&output)?.iter().copied());
        let off = (sum.total() / wanted - 1.0).abs();
        ensure!(off <= bound, "degree {degree}: {} is not {wanted}: off by {off:e}, bound {bound:e}", sum.total());
    }
    Ok(())
}

/// A function that is not finite everywhere is said not to be.
pub fn not_finite(backend: &dyn Backend) -> Verdict {
    let scene = Scene { positions: vec![[0.5; 3]], weights: Vec::new(), room: Room::Box([0.0; 3], [1.0; 3]) };
    let f = Integrand::function(2, |_| f64::NAN).map_err(|error| error.to_string())?;
    match backend.evaluate(&scene.diagram()?, &Request::moments().with_integral(f)) {
        Err(error) if error.kind() == ErrorKind::Input && error.to_string().contains("integrand") => Ok(()),
        other => Err(format!("instead of an error: {other:?}")),
    }?;
    // What a function of many places says is wrong is the evaluation's error, where it can be called.
    if backend.info().backend != "cpu" {
        return Ok(());
    }
    let fails = |columns, answer: fn(usize) -> laguerre_core::Result<Vec<f64>>, said: &str| {
        let f = Integrand::batches(2, columns, move |places| answer(places.len())).map_err(|e| e.to_string())?;
        match backend.evaluate(&scene.diagram()?, &Request::moments().with_integral(f)) {
            Err(error) if error.to_string().contains(said) => Ok(()),
            other => Err(format!("instead of an error, {said}: {other:?}")),
        }
    };
    fails(1, |_| Err(Error::input("no more")), "no more")?;
    fails(2, |n| Ok(vec![1.0; n]), "2 for each are needed")?;
    fails(2, |n| Ok([1.0, f64::NAN].repeat(n)), "site 0 is not finite")
}

fn is_refused(backend: &dyn Backend, scene: &Scene, request: &Request) -> Verdict {
    match backend.evaluate(&scene.diagram()?, request) {
        Err(error) if error.kind() == ErrorKind::Input && error.to_string().contains("cannot call a function") => {
            Ok(())
        }
        Err(error) => Err(format!("a function is refused by `{error}`")),
        Ok(_) => Err("a function is integrated without its being called".to_owned()),
    }
}

fn integrals(output: &Output) -> Result<&[f64], String> {
    output.integral().filter(|all| all.len() == output.status().len()).ok_or("integrals are missing".to_owned())
}

/// Bound of one cell's integral: of its volume, times the size of the function.
fn cell_bound(bounds: &Bounds, i: usize, f: &Polynomial) -> f64 {
    bounds.volume(i) * f.size()
}

fn same(bounds: &Bounds, f: &Polynomial, a: &[f64], b: &[f64]) -> Verdict {
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        let (off, bound) = ((a - b).abs(), cell_bound(bounds, i, f));
        ensure!(off <= bound, "site {i}, {f:?}: integrals {a:e} and {b:e} differ by {off:e}, bound {bound:e}");
    }
    Ok(())
}

/// Where a function may be asked for: the box, or that of the domain's grid.
fn grid_box(room: &Room) -> (DVec3, DVec3) {
    let Room::Mesh(_, domain) = room else {
        let (lo, hi) = room.bounding_box();
        return (lo.into(), hi.into());
    };
    let (grid, frame) = (domain.grid(1), domain.frame());
    (frame.leave(grid.corner([0; 3])).into(), frame.leave(grid.corner(grid.dims())).into())
}

/// A polynomial about a point near the container's middle. Coordinates are relative to its diagonal: all over the box of its grid they are
/// at most 1, so that no monomial is larger than its coefficient.
#[derive(Clone, Debug)]
struct Polynomial {
    origin: DVec3,
    diagonal: f64,
    terms: Vec<([u32; 3], f64)>,
}

impl Polynomial {
    /// A few terms, one of the full degree among them; for degree 2 all.
    fn random(scene: &Scene, degree: usize, random: &mut Random) -> Self {
        let (lo, hi) = scene.room.bounding_box();
        let origin = 0.5 * (DVec3::from(lo) + DVec3::from(hi));
        let diagonal = scene.room.extents().length();
        let mut all: Vec<[u32; 3]> = Vec::new();
        let n = degree as u32;
        for a in 0..=n {
            for b in 0..=n - a {
                all.extend((0..=n - a - b).map(|c| [a, b, c]));
            }
        }
        let full: Vec<[u32; 3]> = all.iter().copied().filter(|p| p.iter().sum::<u32>() == n).collect();
        let mut chosen = if degree > 2 { (0..4).map(|_| all[random.below(all.len())]).collect() } else { all };
        chosen.push(full[random.below(full.len())]);
        let coefficient = |powers: [u32; 3], c: f64| c / diagonal.powi(powers.iter().sum::<u32>() as i32);
        let terms = chosen.iter().map(|&powers| (powers, coefficient(powers, 2.0 * random.unit() - 1.0))).collect();
        Self { origin, diagonal, terms }
    }

    fn integrand(&self) -> Result<Integrand, String> {
        Integrand::polynomial(self.origin.into(), &self.terms).map_err(|error| error.to_string())
    }

    fn value(&self, x: DVec3) -> f64 {
        let y = x - self.origin;
        let term = |(powers, c): &([u32; 3], f64)| (0..3).fold(*c, |t, k| t * y[k].powi(powers[k] as i32));
        self.terms.iter().map(term).sum()
    }

    fn degree(&self, powers: &[u32; 3]) -> i32 {
        powers.iter().sum::<u32>() as i32
    }

    /// What it is nowhere larger than.
    fn size(&self) -> f64 {
        self.terms.iter().map(|(powers, c)| c.abs() * self.diagonal.powi(self.degree(powers))).sum()
    }

    /// How much it changes, at most, over a length.
    fn slope(&self) -> f64 {
        let slope = |powers| f64::from(self.degree(powers)) * self.diagonal.powi(self.degree(powers) - 1);
        self.terms.iter().map(|(powers, c)| c.abs() * slope(powers)).sum()
    }

    /// Its integral over a room, by tetrahedra over the surface's triangles with apex at the origin, and on them by the formula for products
    /// of barycentric coordinates: ∫ λ^i μ^j ν^k = 6V i! j! k! / (i + j + k + 3)!. It shares nothing with any quadrature rule.
    fn over(&self, room: &Room) -> f64 {
        let mesh = room.mesh();
        let mut sum = Sum::default();
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| DVec3::from(mesh.vertices[v as usize]) - self.origin);
            let sixfold = DMat3::from_cols(corners[0], corners[1], corners[2]).determinant();
            for (powers, c) in &self.terms {
                let axes: Vec<usize> = (0..3).flat_map(|k| vec![k; powers[k] as usize]).collect();
                sum.add(c * sixfold * expanded(&axes, corners, [0; 3]));
            }
        }
        sum.total()
    }
}

/// Each factor is a sum over the corners: all products, with how often each corner was chosen.
fn expanded(axes: &[usize], corners: [DVec3; 3], chosen: [u32; 3]) -> f64 {
    let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
    let Some((&axis, rest)) = axes.split_first() else {
        return chosen.map(factorial).iter().product::<f64>() / factorial(chosen.iter().sum::<u32>() + 3);
    };
    let with = |k: usize| {
        let mut chosen = chosen;
        chosen[k] += 1;
        corners[k][axis] * expanded(rest, corners, chosen)
    };
    (0..3).map(with).sum()
}
