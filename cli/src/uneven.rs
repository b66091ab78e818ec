//! Uneven inputs: sites in the unit cube that are crowded in places, lie on surfaces, or have weights that move their cells elsewhere.

use std::f64::consts::TAU;

use laguerre::engine::memory;
use laguerre::{Domain, Result};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::domains;
use crate::sample::unit;

/// An input of the table.
#[derive(Debug)]
pub(crate) struct Uneven {
    pub(crate) name: &'static str,
    /// What it is, for the help.
    pub(crate) about: &'static str,
    /// The limit that this project has set: how much more time a site may take than one of white noise; none where there is none.
    pub(crate) limit: Option<f64>,
    /// Sites that `bench` takes at most, where time grows with their square or more.
    pub(crate) most: Option<u32>,
    make: fn(&mut Random, usize) -> Result<Cloud>,
}

/// All of them. What one of a name and seed gives is not to change: its times are compared over the years.
pub(crate) static INPUTS: [Uneven; 20] = [
    input("plummer", 3.0, plummer, "A Plummer sphere of radius 1e-3, cut off at 0.49"),
    input("clusters", 3.0, clusters, "200 Gaussian clusters, of sizes from 1e-4 to 0.1"),
    input("nfw", 3.0, nfw, "A halo (Navarro, Frenk, White) of concentration 10, cut off at 0.45"),
    input("soneira-peebles", 3.0, soneira_peebles, "A hierarchy of spheres, four in each, each 1.9 times smaller"),
    input("levy", 3.0, levy, "A Lévy flight, its steps with a tail of power 1.5, wrapped into the cube"),
    input("outlier", 3.0, outlier, "White in a corner of size 1e-3, and one site in the corner opposite"),
    input("two-clusters", 3.0, two_clusters, "Two Gaussian clusters, each of 1e-5 of their distance"),
    input("linear", 3.0, linear, "White, with weights 0.5 x"),
    input("quadratic-0.5", 3.0, quadratic_half, "White, with weights 0.5 |x|²"),
    input("quadratic-0.9", 3.0, quadratic_steep, "White, with weights 0.9 |x|²"),
    input("quadratic-minus-2", 3.0, quadratic_negative, "White, with weights -2 |x|²"),
    input("sinusoid", 3.0, sinusoid, "White, with weights 0.02 sin 6x cos 5y sin 4z"),
    input(
        "lognormal",
        3.0,
        lognormal,
        "White, with the squares of lognormal radii as weights, the median a tenth of the spacing",
    ),
    input("heavy", 3.0, heavy, "White, one site with the weight 0.09"),
    input("plane", 4.0, plane, "In the plane z = 0.5, off it by 1e-9"),
    input("line", 4.0, line, "On a line along x, off it by 1e-9"),
    input("bumpy", 12.0, bumpy, "On a bumpy closed surface"),
    input("scanned", 12.0, scanned, "On a scanned surface, the bunny's (in a checkout of the sources)"),
    input("jittered-sphere", 15.0, jittered_sphere, "On a sphere of radius 0.4, off it by a thousandth"),
    input("sphere", 15.0, sphere, "On a sphere of radius 0.4 exactly: all cells meet in the middle").without_limit(500),
];

/// An input with a limit, of any number of sites.
const fn input(
    name: &'static str,
    limit: f64,
    make: fn(&mut Random, usize) -> Result<Cloud>,
    about: &'static str,
) -> Uneven {
    Uneven { name, about, limit: Some(limit), most: None, make }
}

impl Uneven {
    /// The same without a limit of time, for up to `most` sites.
    const fn without_limit(self, most: u32) -> Self {
        Self { limit: None, most: Some(most), ..self }
    }

    /// `count` sites in the unit cube, and their weights where they have any; the same for a seed for ever.
    ///
    /// # Errors
    /// `Input` where there is no memory for so many.
    pub(crate) fn sites(&self, count: u32, seed: u64) -> Result<Cloud> {
        (self.make)(&mut Random(ChaCha8Rng::seed_from_u64(seed)), count as usize)
    }
}

/// The input of that name, for the command line.
pub(crate) fn named(name: &str) -> std::result::Result<&'static Uneven, String> {
    INPUTS.iter().find(|input| input.name == name).ok_or_else(|| {
        let known: Vec<&str> = INPUTS.iter().map(|input| input.name).collect();
        format!("not one of {}", known.join(", "))
    })
}

/// Sites, and a weight for each or none at all.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cloud {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) weights: Vec<f64>,
}

impl Cloud {
    /// `count` sites without weights.
    fn of(count: usize, mut site: impl FnMut() -> [f64; 3]) -> Result<Self> {
        let mut positions = memory::with_room(count, "sites")?;
        positions.extend((0..count).map(|_| site()));
        Ok(Self { positions, weights: Vec::new() })
    }

    /// White sites.
    fn white(random: &mut Random, count: usize) -> Result<Self> {
        Self::of(count, || random.point())
    }

    /// The same sites with weights.
    fn weighted(mut self, mut weight: impl FnMut([f64; 3]) -> f64) -> Result<Self> {
        self.weights = memory::with_room(self.positions.len(), "weights")?;
        self.weights.extend(self.positions.iter().map(|&p| weight(p)));
        Ok(self)
    }
}

/// Random numbers, the same for a seed for ever.
struct Random(ChaCha8Rng);

impl Random {
    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        unit(&mut self.0)
    }

    /// Uniform in (0, 1].
    fn above_zero(&mut self) -> f64 {
        1.0 - self.unit()
    }

    /// Uniform in 0..n.
    fn below(&mut self, n: usize) -> usize {
        (self.0.next_u64() % n as u64) as usize
    }

    /// Uniform in the unit cube.
    fn point(&mut self) -> [f64; 3] {
        [self.unit(), self.unit(), self.unit()]
    }

    /// Normal, of variance 1 (Box and Muller).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.above_zero().ln()).sqrt();
        radius * (TAU * self.unit()).cos()
    }

    fn normals(&mut self) -> [f64; 3] {
        [self.normal(), self.normal(), self.normal()]
    }

    /// Uniform on the unit sphere.
    fn direction(&mut self) -> [f64; 3] {
        loop {
            let p = self.point().map(|x| 2.0 * x - 1.0);
            let square = squared(p);
            // Not too near the middle either, where few digits are left.
            if (0.01..=1.0).contains(&square) {
                return p.map(|x| x / square.sqrt());
            }
        }
    }

    /// Uniform in the unit ball.
    fn in_ball(&mut self) -> [f64; 3] {
        let radius = self.unit().cbrt();
        self.direction().map(|x| radius * x)
    }

    /// The first of `tries` that is in the unit cube.
    fn in_cube(&mut self, mut tries: impl FnMut(&mut Self) -> [f64; 3]) -> [f64; 3] {
        loop {
            let p = tries(self);
            if p.iter().all(|x| (0.0..=1.0).contains(x)) {
                return p;
            }
        }
    }
}

const MIDDLE: [f64; 3] = [0.5; 3];

fn squared(p: [f64; 3]) -> f64 {
    p[0] * p[0] + p[1] * p[1] + p[2] * p[2]
}

/// `p + r d`.
fn moved(p: [f64; 3], r: f64, d: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| p[k] + r * d[k])
}

fn wrapped(p: [f64; 3]) -> [f64; 3] {
    p.map(|x| x.rem_euclid(1.0))
}

fn plummer(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::of(count, || {
        let radius = loop {
            let radius = 1e-3 / (random.above_zero().powf(-2.0 / 3.0) - 1.0).sqrt();
            if radius <= 0.49 {
                break radius;
            }
        };
        moved(MIDDLE, radius, random.direction())
    })
}

fn clusters(random: &mut Random, count: usize) -> Result<Cloud> {
    let clusters: Vec<([f64; 3], f64)> =
        (0..200).map(|_| (random.point(), 10_f64.powf(-4.0 + 3.0 * random.unit()))).collect();
    Cloud::of(count, || {
        random.in_cube(|random| {
            let (middle, size) = clusters[random.below(clusters.len())];
            moved(middle, size, random.normals())
        })
    })
}

fn nfw(random: &mut Random, count: usize) -> Result<Cloud> {
    const CONCENTRATION: f64 = 10.0;
    const RADIUS: f64 = 0.45;
    // The mass within x scale radii, in units of its own.
    let mass = |x: f64| x.ln_1p() - x / (1.0 + x);
    Cloud::of(count, || {
        let wanted = random.unit() * mass(CONCENTRATION);
        let (mut lo, mut hi) = (0.0, CONCENTRATION);
        for _ in 0..52 {
            let x = 0.5 * (lo + hi);
            if mass(x) < wanted { lo = x } else { hi = x }
        }
        moved(MIDDLE, RADIUS / CONCENTRATION * 0.5 * (lo + hi), random.direction())
    })
}

fn soneira_peebles(random: &mut Random, count: usize) -> Result<Cloud> {
    let mut levels = 0;
    while CHILDREN.pow(levels) < count as u64 {
        levels += 1;
    }
    let mut hierarchy =
        Hierarchy { random, left: CHILDREN.pow(levels), wanted: count, chosen: memory::with_room(count, "sites")? };
    hierarchy.descend(MIDDLE, 0.4, levels);
    Ok(Cloud { positions: hierarchy.chosen, weights: Vec::new() })
}

/// Spheres in each sphere of the hierarchy.
const CHILDREN: u64 = 4;

/// A hierarchy whose smallest spheres are drawn from, as many as wanted and all with the same odds.
struct Hierarchy<'a> {
    random: &'a mut Random,
    /// Smallest spheres that are still to come.
    left: u64,
    wanted: usize,
    chosen: Vec<[f64; 3]>,
}

impl Hierarchy<'_> {
    fn descend(&mut self, middle: [f64; 3], radius: f64, levels: u32) {
        if levels == 0 {
            let missing = (self.wanted - self.chosen.len()) as f64;
            if self.random.unit() * (self.left as f64) < missing {
                self.chosen.push(wrapped(middle));
            }
            self.left -= 1;
            return;
        }
        for _ in 0..CHILDREN {
            let child = moved(middle, radius, self.random.in_ball());
            self.descend(child, radius / 1.9, levels - 1);
        }
    }
}

fn levy(random: &mut Random, count: usize) -> Result<Cloud> {
    const ALPHA: f64 = 1.5;
    // So short that the whole flight crosses the cube a few times, whatever the number of steps.
    let shortest = (count as f64).powf(-1.0 / ALPHA);
    let mut p = MIDDLE;
    Cloud::of(count, || {
        p = wrapped(moved(p, shortest * random.above_zero().powf(-1.0 / ALPHA), random.direction()));
        p
    })
}

fn outlier(random: &mut Random, count: usize) -> Result<Cloud> {
    let mut cloud = Cloud::of(count, || random.point().map(|x| 1e-3 * x))?;
    cloud.positions[0] = [1.0; 3];
    Ok(cloud)
}

fn two_clusters(random: &mut Random, count: usize) -> Result<Cloud> {
    let distance = 0.5 * 3_f64.sqrt();
    let mut first = true;
    Cloud::of(count, || {
        let middle = if first { [0.25; 3] } else { [0.75; 3] };
        first = !first;
        moved(middle, 1e-5 * distance, random.normals())
    })
}

fn linear(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::white(random, count)?.weighted(|p| 0.5 * p[0])
}

fn quadratic_half(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::white(random, count)?.weighted(|p| 0.5 * squared(p))
}

fn quadratic_steep(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::white(random, count)?.weighted(|p| 0.9 * squared(p))
}

fn quadratic_negative(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::white(random, count)?.weighted(|p| -2.0 * squared(p))
}

fn sinusoid(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::white(random, count)?.weighted(|[x, y, z]| 0.02 * (6.0 * x).sin() * (5.0 * y).cos() * (4.0 * z).sin())
}

fn lognormal(random: &mut Random, count: usize) -> Result<Cloud> {
    let spacing = (count as f64).cbrt().recip();
    Cloud::white(random, count)?.weighted(|_| (0.1 * spacing * random.normal().exp()).powi(2))
}

fn heavy(random: &mut Random, count: usize) -> Result<Cloud> {
    let mut cloud = Cloud::white(random, count)?.weighted(|_| 0.0)?;
    cloud.weights[0] = 0.09;
    Ok(cloud)
}

fn plane(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::of(count, || [random.unit(), random.unit(), 0.5 + 1e-9 * random.normal()])
}

fn line(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::of(count, || [random.unit(), 0.5 + 1e-9 * random.normal(), 0.5 + 1e-9 * random.normal()])
}

fn bumpy(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::of(count, || {
        let [x, y, z] = random.direction();
        let radius = 0.3 * (1.0 + 0.3 * (6.0 * x + 1.0).sin() * (4.0 * y).cos() + 0.1 * (9.0 * z).sin());
        moved(MIDDLE, radius, [x, 0.8 * y, 0.6 * z])
    })
}

fn scanned(random: &mut Random, count: usize) -> Result<Cloud> {
    on_surface(&domains::in_unit_cube(&domains::bunny()?)?, random, count)
}

/// As many on each part of the surface as its area says.
fn on_surface(domain: &Domain, random: &mut Random, count: usize) -> Result<Cloud> {
    let corners = |triangle: &[u32; 3]| triangle.map(|v| domain.vertices()[v as usize]);
    // The areas summed up to each triangle.
    let mut area = 0.0;
    let areas: Vec<f64> = domain
        .triangles()
        .iter()
        .map(|triangle| {
            let [a, b, c] = corners(triangle);
            let [u, v] = [moved(b, -1.0, a), moved(c, -1.0, a)];
            let normal = std::array::from_fn(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
            area += 0.5 * squared(normal).sqrt();
            area
        })
        .collect();
    Cloud::of(count, || {
        let at = random.unit() * area;
        let triangle = areas.partition_point(|&up_to| up_to <= at).min(areas.len() - 1);
        let [a, b, c] = corners(&domain.triangles()[triangle]);
        let (mut s, mut t) = (random.unit(), random.unit());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        std::array::from_fn(|k| (a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k])).clamp(0.0, 1.0))
    })
}

fn jittered_sphere(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::of(count, || {
        let radius = 0.4 * (1.0 + 1e-3 * random.normal());
        moved(MIDDLE, radius, random.direction())
    })
}

fn sphere(random: &mut Random, count: usize) -> Result<Cloud> {
    Cloud::of(count, || moved(MIDDLE, 0.4, random.direction()))
}

#[cfg(test)]
mod tests {
    use clap::ValueEnum;

    use super::*;
    use crate::args::Distribution;

    #[test]
    fn a_seed_gives_the_same_sites_as_many_as_asked_for_all_in_the_cube() {
        // (Unit tests do not have the bunny's file, the tests of the program do.)
        for input in INPUTS.iter().filter(|input| input.name != "scanned") {
            for count in [1, 2, 1000, 1025] {
                let cloud = input.sites(count, 7).unwrap();
                assert_eq!(cloud.positions.len(), count as usize, "{}", input.name);
                assert!([0, count as usize].contains(&cloud.weights.len()), "{}", input.name);
                let inside = |p: &[f64; 3]| p.iter().all(|x| (0.0..=1.0).contains(x));
                assert!(cloud.positions.iter().all(inside), "{}", input.name);
                assert!(cloud.weights.iter().all(|w| w.is_finite()), "{}", input.name);
            }
            assert_eq!(input.sites(1000, 7).unwrap(), input.sites(1000, 7).unwrap(), "{}", input.name);
            assert_ne!(input.sites(1000, 7).unwrap(), input.sites(1000, 8).unwrap(), "{}", input.name);
        }
    }

    #[test]
    fn a_surface_has_sites_by_its_area() {
        let swan = domains::in_unit_cube(&domains::swan().unwrap()).unwrap();
        let sites = on_surface(&swan, &mut Random(ChaCha8Rng::seed_from_u64(1)), 4000).unwrap().positions;
        // Its mirror's plane is in the middle of the cube.
        let before = sites.iter().filter(|p| p[2] < 0.5).count();
        assert!((1900..2100).contains(&before), "{before}");
        assert!(sites.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
    }

    #[test]
    fn names_are_told_apart() {
        let mut names: Vec<&str> = INPUTS.iter().map(|input| input.name).collect();
        let filling: Vec<_> = Distribution::value_variants().iter().filter_map(ValueEnum::to_possible_value).collect();
        names.extend(filling.iter().map(|value| value.get_name()));
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
        assert_eq!(named("levy").unwrap().name, "levy");
        assert!(named("flat").unwrap_err().starts_with("not one of plummer, clusters"));
    }

    /// Of distances from the middle, the one that half of the sites are within.
    fn half_within(name: &str) -> f64 {
        let sites = named(name).unwrap().sites(10_000, 1).unwrap().positions;
        let mut distances: Vec<f64> = sites.iter().map(|&p| squared(moved(p, -1.0, MIDDLE)).sqrt()).collect();
        distances.sort_unstable_by(f64::total_cmp);
        assert!(distances[9_999] <= 0.49, "{name}: {}", distances[9_999]);
        distances[5_000]
    }

    #[test]
    fn halves_are_where_the_formulas_have_them() {
        // Plummer: a (2^(2/3) - 1)^(-1/2). The halo: x of half the mass within 10, m(3.6) = 0.5 m(10), over 10 of 0.45.
        assert!((half_within("plummer") / 1.305e-3 - 1.0).abs() < 0.03, "{}", half_within("plummer"));
        assert!((half_within("nfw") / 0.162 - 1.0).abs() < 0.03, "{}", half_within("nfw"));
        assert!((half_within("sphere") - 0.4).abs() < 1e-15);
        assert!((half_within("jittered-sphere") - 0.4).abs() < 1e-4);
    }

    #[test]
    fn weights_are_those_of_the_table() {
        for (name, c) in [("quadratic-0.5", 0.5), ("quadratic-0.9", 0.9), ("quadratic-minus-2", -2.0)] {
            let cloud = named(name).unwrap().sites(100, 1).unwrap();
            assert!(cloud.positions.iter().zip(&cloud.weights).all(|(&p, &w)| w == c * squared(p)), "{name}");
        }
        let heavy = named("heavy").unwrap().sites(100, 1).unwrap();
        assert_eq!((heavy.weights[0], heavy.weights[1..].iter().sum::<f64>()), (0.09, 0.0));
        assert_eq!(named("outlier").unwrap().sites(100, 1).unwrap().positions[0], [1.0; 3]);
    }
}
