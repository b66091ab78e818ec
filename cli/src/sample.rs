//! `laguerre sample`: sites to compute with.

use clap::ValueEnum;
use laguerre::engine::inside::InsideTest;
use laguerre::engine::memory;
use laguerre::io::{self, SITES_ENDINGS};
use laguerre::solvers::lloyd::{Equalized, equalize};
use laguerre::{Backend, Domain, Error, PowerDiagram, Result};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::Serialize;

use crate::args::{Corners, Distribution, SampleArgs, Spread};
use crate::container::Container;
use crate::evaluate::open_for_samples;
use crate::files::{refuse_inputs, share_standard_output};
use crate::outcome::{Outcome, note, print_json};
use crate::solver::WithBar;
use crate::uneven::{Cloud, Uneven};

/// Blue noise: the volumes vary by less than this.
pub(crate) const BLUE_SPREAD: f64 = 0.1;
/// Lloyd steps after which blue noise is taken as it is; some 15 are usual.
pub(crate) const MOST_STEPS: usize = 40;
/// Tiles of a mirrored distribution along each axis.
const TILES: u32 = 5;
/// Points that are tried at most in search of those inside: more would seem to hang.
const MOST_TRIES: f64 = 1e10;

/// The object of `--json`.
#[derive(Serialize)]
struct Report {
    /// Sites that were made, and those asked for.
    sites: usize,
    asked: u32,
    distribution: String,
    seed: u64,
    /// The box that they fill, its minimum corner and its maximum corner.
    r#box: [[f64; 3]; 2],
    /// Whether they have weights.
    weights: bool,
    file: String,
}

impl Report {
    fn of(args: &SampleArgs, corners: &Corners, sites: usize, weights: bool) -> Self {
        let value = args.distribution.to_possible_value();
        Self {
            sites,
            asked: args.count,
            distribution: value.map(|value| value.get_name().to_owned()).unwrap_or_default(),
            seed: args.seed,
            r#box: [corners.lo, corners.hi],
            weights,
            file: args.output.display().to_string(),
        }
    }
}

pub(crate) fn run(args: &SampleArgs) -> Result<Outcome> {
    io::check_output(&args.output, SITES_ENDINGS)?;
    refuse_inputs(&args.output, &[args.container.file()])?;
    share_standard_output([&args.output], args.json)?;
    let distribution = match args.distribution {
        Spread::Filling(distribution) => distribution,
        Spread::Uneven(input) => return uneven(args, input),
    };
    let container = Container::read(&args.container)?;
    let corners = match &container {
        Container::Domain(domain) => {
            let (lo, hi) = domain.bounding_box();
            Corners { lo, hi }
        }
        Container::Box(corners) => *corners,
        Container::Default => Corners::UNIT_CUBE,
    };
    let domain = container.domain().filter(|_| args.inside);
    let mut sampler = Sampler::new(corners, domain, args.seed);
    let positions = sampler.sample(distribution, args.count)?;
    if positions.is_empty() {
        return Err(Error::input("none of the sites is inside the domain: ask for more of them"));
    }
    if positions.len() != args.count as usize {
        note(&format!("{} sites, as near to {} as this distribution comes", positions.len(), args.count));
    }
    io::write_sites(&args.output, &positions, &[])?;
    if args.json {
        print_json(&Report::of(args, &corners, positions.len(), false))?;
    }
    Ok(Outcome::Done)
}

/// Writes an uneven input, which is one of the unit cube, or as it is in a box.
fn uneven(args: &SampleArgs, input: &Uneven) -> Result<Outcome> {
    if args.container.file().is_some() {
        let option = if args.container.domain.is_some() { "--domain" } else { "--image" };
        return Err(Error::input(format!(
            "{option}: the sites of {} are in the unit cube, or in a --box; leave {option} out",
            input.name
        )));
    }
    let mut cloud = input.sites(args.count, args.seed)?;
    if let Some(corners) = &args.container.r#box {
        stretch(&mut cloud, corners);
    }
    io::write_sites(&args.output, &cloud.positions, &cloud.weights)?;
    if args.json {
        let corners = args.container.r#box.unwrap_or(Corners::UNIT_CUBE);
        print_json(&Report::of(args, &corners, cloud.positions.len(), !cloud.weights.is_empty()))?;
    }
    Ok(Outcome::Done)
}

/// Takes sites from the unit cube to a box, and their weights with the square of the mean distance of sites.
fn stretch(cloud: &mut Cloud, corners: &Corners) {
    let extent: [f64; 3] = std::array::from_fn(|k| corners.hi[k] - corners.lo[k]);
    let square = extent.iter().map(|e| e.cbrt()).product::<f64>().powi(2);
    for p in &mut cloud.positions {
        *p = std::array::from_fn(|k| (corners.lo[k] + p[k] * extent[k]).min(corners.hi[k]));
    }
    for w in &mut cloud.weights {
        *w *= square;
    }
}

/// Where sites are wanted, and the random numbers to put them there.
pub(crate) struct Sampler<'a> {
    corners: Corners,
    extent: [f64; 3],
    /// Where the sites must be inside the domain.
    inside: Option<(&'a Domain, InsideTest<'a>)>,
    random: ChaCha8Rng,
    /// What relaxes sites; the CPU where there is none.
    backend: Option<&'a dyn Backend>,
}

impl<'a> Sampler<'a> {
    /// Sites in a box, and inside `domain` where there is one.
    pub(crate) fn new(corners: Corners, domain: Option<&'a Domain>, seed: u64) -> Self {
        Self {
            corners,
            extent: std::array::from_fn(|k| corners.hi[k] - corners.lo[k]),
            inside: domain.map(|d| (d, InsideTest::new(d.vertices(), d.triangles()))),
            random: ChaCha8Rng::seed_from_u64(seed),
            backend: None,
        }
    }

    /// Lets `backend` relax the sites, where that is needed.
    pub(crate) fn relaxed_by(self, backend: &'a dyn Backend) -> Self {
        Self { backend: Some(backend), ..self }
    }

    /// About `count` sites.
    pub(crate) fn sample(&mut self, distribution: Distribution, count: u32) -> Result<Vec<[f64; 3]>> {
        if f64::from(count) / self.share_inside() > MOST_TRIES {
            return Err(Error::input(format!(
                "--inside: the domain fills {:.0e} of its box, too little to find {count} sites in it: ask for fewer, or leave --inside out",
                self.share_inside()
            )));
        }
        match distribution {
            Distribution::White => self.white(count),
            Distribution::Blue => {
                let (positions, done) = self.blue(count, BLUE_SPREAD, MOST_STEPS)?;
                note(&format!("{} Lloyd steps; the volumes vary by {:.1} %", done.steps, 100.0 * done.spread));
                Ok(positions)
            }
            Distribution::Lattice => self.lattice(count, 0.0),
            Distribution::Perturbed => self.lattice(count, 0.5),
            Distribution::Mirrored => self.mirrored(count),
        }
    }

    /// Independent and uniform.
    pub(crate) fn white(&mut self, count: u32) -> Result<Vec<[f64; 3]>> {
        let mut positions = memory::with_room(count as usize, "sites")?;
        while positions.len() < count as usize {
            let p = std::array::from_fn(|k| self.corners.lo[k] + self.unit() * self.extent[k]);
            if self.accepts(p) {
                positions.push(p);
            }
        }
        Ok(positions)
    }

    /// White, relaxed by Lloyd's algorithm until the volumes vary by less than `spread`.
    pub(crate) fn blue(&mut self, count: u32, spread: f64, most_steps: usize) -> Result<(Vec<[f64; 3]>, Equalized)> {
        let white = self.white(count)?;
        let diagram = PowerDiagram::new(&white, &[])?;
        let mut diagram = match &self.inside {
            Some((domain, _)) => diagram.restricted_to(domain),
            None => diagram.in_box(self.corners.lo, self.corners.hi)?,
        };
        let accepts = |p: [f64; 3]| self.accepts(p);
        let accept = self.inside.is_some().then_some(&accepts as &(dyn Fn([f64; 3]) -> bool + Sync));
        let done = match self.backend {
            Some(backend) => equalize(&WithBar(backend), &mut diagram, spread, most_steps, accept)?,
            None => equalize(&WithBar(open_for_samples()?.as_ref()), &mut diagram, spread, most_steps, accept)?,
        };
        Ok((diagram.positions().to_vec(), done))
    }

    /// The centres of a grid's voxels, x fastest, each moved at random by up to half of `jitter` voxels along each axis.
    fn lattice(&mut self, count: u32, jitter: f64) -> Result<Vec<[f64; 3]>> {
        let dims = voxels(self.extent, f64::from(count) / self.share_inside());
        let mut positions = memory::with_room(count as usize, "sites")?;
        for (k, j, i) in grid(dims) {
            let p = std::array::from_fn(|axis| {
                let offset = if jitter == 0.0 { 0.5 } else { 0.5 + jitter * (self.unit() - 0.5) };
                let at = (f64::from([i, j, k][axis]) + offset) / f64::from(dims[axis]);
                self.corners.lo[axis] + at * self.extent[axis]
            });
            if self.accepts(p) {
                memory::push(&mut positions, p, "sites")?;
            }
        }
        Ok(positions)
    }

    /// A blue tile, mirrored in planes. All coordinates are multiples of one power of two, so that the mirror images are exact
    /// and the cells do meet in degenerate vertices.
    fn mirrored(&mut self, count: u32) -> Result<Vec<[f64; 3]>> {
        let tiles = f64::from(TILES).powi(3);
        let in_tile = (f64::from(count) / self.share_inside() / tiles).round().max(1.0) as u32;
        let quantum = quantum(self.corners);
        let origin = self.corners.lo.map(|x| (x / quantum).ceil());
        let width: [f64; 3] =
            std::array::from_fn(|k| ((self.corners.hi[k] / quantum - origin[k]) / f64::from(TILES)).floor());
        if width.iter().any(|&w| w < 2.0) {
            return Err(Error::input(
                "the box is too flat to mirror a tile in, sites could not be told apart: give a box that is less flat, or another distribution",
            ));
        }
        let tile = Corners { lo: [0.0; 3], hi: width.map(|w| w * quantum) };
        let seed = self.random.next_u64();
        let mut sampler = Sampler { backend: self.backend, ..Sampler::new(tile, None, seed) };
        let (blue, _) = sampler.blue(in_tile, BLUE_SPREAD, MOST_STEPS)?;
        let mut positions = memory::with_room(count as usize, "sites")?;
        for (c, b, a) in grid([TILES; 3]) {
            for site in &blue {
                let p = std::array::from_fn(|k| {
                    let (tile, u) = ([a, b, c][k], (site[k] / quantum).round().clamp(1.0, width[k] - 1.0));
                    let (n, w) = (f64::from(tile), width[k]);
                    let at = if tile % 2 == 0 { n * w + u } else { (n + 1.0) * w - u };
                    (origin[k] + at) * quantum
                });
                if self.accepts(p) {
                    memory::push(&mut positions, p, "sites")?;
                }
            }
        }
        Ok(positions)
    }

    fn accepts(&self, p: [f64; 3]) -> bool {
        self.inside.as_ref().is_none_or(|(_, test)| test.contains(p))
    }

    /// The share of the box where sites are wanted, below by a rounding what a thin domain leaves of 0.
    fn share_inside(&self) -> f64 {
        let share = self.inside.as_ref().map_or(1.0, |(domain, _)| {
            let [x, y, z] = self.extent;
            domain.volume() / x / y / z
        });
        share.clamp(f64::MIN_POSITIVE, 1.0)
    }

    fn unit(&mut self) -> f64 {
        unit(&mut self.random)
    }
}

/// Uniform in [0, 1): 53 random bits.
pub(crate) fn unit(random: &mut ChaCha8Rng) -> f64 {
    const ULP: f64 = 1.0 / (1_u64 << 53) as f64;
    (random.next_u64() >> 11) as f64 * ULP
}

/// All voxels of a grid as (k, j, i), the last index fastest.
fn grid(dims: [u32; 3]) -> impl Iterator<Item = (u32, u32, u32)> {
    (0..dims[2]).flat_map(move |k| (0..dims[1]).flat_map(move |j| (0..dims[0]).map(move |i| (k, j, i))))
}

/// Numbers of voxels along the axes of a box: nearly cubic ones, nearly `count` in all, at least one along each axis.
fn voxels(extent: [f64; 3], count: f64) -> [u32; 3] {
    let mut flat = [false; 3];
    loop {
        // Axes thinner than a voxel have one; the others share what is left.
        let free: Vec<f64> = (0..3).filter(|&k| !flat[k]).map(|k| extent[k]).collect();
        let root = 1.0 / free.len() as f64;
        let width = free.iter().map(|e| e.powf(root)).product::<f64>() / count.powf(root);
        match (0..3).find(|&k| !flat[k] && extent[k] < 0.5 * width && free.len() > 1) {
            Some(k) => flat[k] = true,
            None => {
                return std::array::from_fn(|k| if flat[k] { 1 } else { (extent[k] / width).round().max(1.0) as u32 });
            }
        }
    }
}

/// A power of two that divides a box finely enough for any sites (2⁻²⁴ of its extent), coarsely enough that every multiple of
/// it in the box is exact (2⁻⁵⁰ of its coordinates).
fn quantum(corners: Corners) -> f64 {
    let power_above = |x: f64| x.log2().ceil().exp2();
    let largest = |of: fn(&Corners, usize) -> f64| (0..3).map(|k| of(&corners, k)).fold(f64::MIN_POSITIVE, f64::max);
    let extent = power_above(largest(|c, k| c.hi[k] - c.lo[k]));
    let coordinate = power_above(largest(|c, k| c.lo[k].abs().max(c.hi[k].abs())));
    (extent * 24_f64.exp2().recip()).max(coordinate * 50_f64.exp2().recip())
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Corners = Corners { lo: [-1.0, 10.0, 0.1], hi: [1.0, 11.0, 0.7] };

    #[test]
    fn a_seed_gives_the_same_sites_for_ever() {
        let white = |seed| Sampler::new(BOX, None, seed).white(1000).unwrap();
        assert_eq!(white(7), white(7));
        assert_ne!(white(7), white(8));
        assert!(white(7).iter().all(|p| (0..3).all(|k| BOX.lo[k] <= p[k] && p[k] <= BOX.hi[k])));
        let mut unit = Sampler::new(Corners { lo: [0.0; 3], hi: [1.0; 3] }, None, 1);
        // The first numbers of ChaCha8 for this seed: files made once must be made again.
        let first = unit.white(1).unwrap()[0];
        assert_eq!(first, FIRST);
    }

    const FIRST: [f64; 3] = [0.40248566366484806, 0.08038370892978197, 0.5965601809348549];

    #[test]
    fn lattices_are_cubic_in_a_cube_and_as_near_as_they_come() {
        assert_eq!(voxels([1.0; 3], 64_000.0), [40; 3]);
        assert_eq!(voxels([1.0; 3], 100.0), [5; 3]);
        assert_eq!(voxels([4.0, 2.0, 1.0], 8000.0), [40, 20, 10]);
        assert_eq!(voxels([1.0, 1.0, 1e-9], 100.0), [10, 10, 1]);
        assert_eq!(voxels([1e-9, 1.0, 1e-9], 7.0), [1, 7, 1]);
        assert_eq!(voxels([1e100, 1e100, 1e100], 8.0), [2; 3]);
        let sites = Sampler::new(Corners { lo: [0.0; 3], hi: [1.0; 3] }, None, 1).lattice(8, 0.0).unwrap();
        assert_eq!(sites[..2], [[0.25, 0.25, 0.25], [0.75, 0.25, 0.25]]);
        let jittered = Sampler::new(BOX, None, 1).lattice(1000, 0.5).unwrap();
        let plain = Sampler::new(BOX, None, 1).lattice(1000, 0.0).unwrap();
        assert_eq!(jittered.len(), plain.len());
        assert!(jittered.iter().zip(&plain).all(|(a, b)| a != b && (0..3).all(|k| (a[k] - b[k]).abs() < 0.05)));
    }

    #[test]
    fn uneven_inputs_stretch_to_a_box() {
        let white = Cloud { positions: vec![[0.0; 3], [0.25, 0.5, 1.0]], weights: vec![0.0, 0.5] };
        let mut cloud = white.clone();
        stretch(&mut cloud, &Corners { lo: [0.0; 3], hi: [1.0; 3] });
        assert_eq!(cloud, white);
        stretch(&mut cloud, &Corners { lo: [-1.0, 10.0, 0.0], hi: [1.0, 12.0, 2.0] });
        assert_eq!(cloud.positions, [[-1.0, 10.0, 0.0], [-0.5, 11.0, 2.0]]);
        assert!((cloud.weights[1] - 2.0).abs() < 1e-14, "{:?}", cloud.weights);
    }

    #[test]
    fn mirror_images_are_exact() {
        for corners in [BOX, Corners { lo: [1e6; 3], hi: [1e6 + 1.0; 3] }] {
            let sites = Sampler::new(corners, None, 3).mirrored(125 * 4).unwrap();
            assert_eq!(sites.len(), 500);
            // Sites of the first two tiles along x stand symmetrically to the plane between them.
            let planes: Vec<f64> = (0..4).map(|i| sites[i][0] + sites[i + 4][0]).collect();
            assert!(planes.iter().all(|&x| x == planes[0]), "{planes:?}");
            assert!((0..4).all(|i| sites[i][1..] == sites[i + 4][1..]));
            assert!(sites.iter().all(|p| (0..3).all(|k| corners.lo[k] < p[k] && p[k] < corners.hi[k])));
        }
    }

    #[test]
    fn inside_means_inside_and_as_many_as_asked_for() {
        let domain = laguerre::shapes::swan().domain();
        let (lo, hi) = domain.bounding_box();
        let mut sampler = Sampler::new(Corners { lo, hi }, Some(&domain), 1);
        let white = sampler.white(500).unwrap();
        assert_eq!(white.len(), 500);
        assert!(white.iter().all(|&p| sampler.accepts(p)));
        let lattice = sampler.lattice(1000, 0.0).unwrap();
        assert!((900..1100).contains(&lattice.len()), "{}", lattice.len());
    }
}
