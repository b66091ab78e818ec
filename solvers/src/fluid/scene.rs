//! Fluids to begin with.

use std::f64::consts::{PI, TAU};

use laguerre_core::diagram::Container;

use super::{Gravity, Settings};
use crate::vectors::inner;

/// A fluid to begin with. Up is +y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// Heavy fluid over light, their border a wave: the heavy one sinks in plumes.
    RayleighTaylor,
    /// Heavy fluid held at one side of a box that is else filled with light fluid, and let go.
    DamBreak,
    /// The vortices of Taylor and Green, which break up into smaller ones: `u = (sin πx cos πy cos πz, −cos πx sin πy cos πz, 0)` in the unit
    /// cube, whose walls are planes of symmetry of the periodic flow.
    TaylorGreen,
    /// One steady vortex, `u = (−sin πx cos πy, cos πx sin πy, 0)` in the unit cube: Gallouët and Mérigot's Beltrami flow, the same at all
    /// heights. Its curl goes with its stream function, so the flow is a steady solution of Euler's equations, and tangent to the walls.
    Beltrami,
    /// Snow in a globe of any form that was just turned over, and is shaken: heavier particles among those of the upper half.
    SnowGlobe,
}

/// Particles to begin with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    /// Where they are.
    pub positions: Vec<[f64; 3]>,
    /// The velocity of each.
    pub velocities: Vec<[f64; 3]>,
    /// The density of each.
    pub densities: Vec<f64>,
}

/// Density of heavy fluid, and of snow; all other is 1.
const HEAVY: f64 = 3.0;
const SNOW: f64 = 2.0;
/// The share of the particles that is snow.
const SNOW_SHARE: f64 = 0.15;
/// Of so many particles in the upper part of the globe, one is a flake: each sinks by itself.
const SNOW_AMONG: usize = 3;
/// The wave of Rayleigh and Taylor's border, over the box's height.
const WAVE: f64 = 0.02;
/// Where the dam stands, over the box's length.
const DAM: f64 = 0.3;
/// How hard the globe is shaken, in units of gravity, and how often.
const SHAKE: f64 = 1.5;
const SWINGS: f64 = 2.0;
/// How far springs are stretched by the accelerations that are typical of a scene, in cell sizes. A larger share makes the fluid less
/// incompressible between cells, a smaller one asks for smaller time steps, and heats the particles more.
const STRETCH: f64 = 0.25;
/// The same where two densities meet: on softer springs particles slip through between the cells of the other fluid.
const STRETCH_OF_TWO: f64 = 0.08;

/// Which waves of the border between two densities grow fastest, in cell sizes: shorter ones would be of single particles.
const FASTEST_WAVE: f64 = 6.0;

impl Scene {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::RayleighTaylor, Self::DamBreak, Self::TaylorGreen, Self::Beltrami, Self::SnowGlobe];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::RayleighTaylor => "rayleigh-taylor",
            Self::DamBreak => "dam-break",
            Self::TaylorGreen => "taylor-green",
            Self::Beltrami => "beltrami",
            Self::SnowGlobe => "snow-globe",
        }
    }

    /// The scene of a name, if there is one.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scene| scene.name() == name)
    }

    /// The box of the scene, from the origin; none for a globe, which has a mesh.
    pub fn extent(self) -> Option<[f64; 3]> {
        match self {
            Self::RayleighTaylor => Some([1.0, 2.0, 0.25]),
            Self::DamBreak => Some([2.0, 1.0, 0.25]),
            Self::TaylorGreen | Self::Beltrami => Some([1.0; 3]),
            Self::SnowGlobe => None,
        }
    }

    /// Whether fluids of two densities meet.
    pub fn has_two_densities(self) -> bool {
        !matches!(self, Self::TaylorGreen | Self::Beltrami)
    }

    /// The velocity at `x`.
    pub fn velocity(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let ((sx, cx), (sy, cy)) = ((PI * x).sin_cos(), (PI * y).sin_cos());
        match self {
            Self::TaylorGreen => {
                let cz = (PI * z).cos();
                [sx * cy * cz, -cx * sy * cz, 0.0]
            }
            Self::Beltrami => [-sx * cy, cx * sy, 0.0],
            _ => [0.0; 3],
        }
    }

    /// The acceleration at `x` at the start, `−∇` of the pressure that the velocities bring about.
    pub fn acceleration(self, x: [f64; 3]) -> [f64; 3] {
        let (s, c) = (x.map(|x| (TAU * x).sin()), x.map(|x| (TAU * x).cos()));
        match self {
            Self::TaylorGreen => {
                // The pressure is (cos 2πx + cos 2πy)(cos 2πz + 2)/16.
                let across = PI / 8.0 * (c[2] + 2.0);
                [across * s[0], across * s[1], PI / 8.0 * (c[0] + c[1]) * s[2]]
            }
            Self::Beltrami => [PI / 2.0 * s[0], PI / 2.0 * s[1], 0.0],
            _ => [0.0; 3],
        }
    }

    /// Densities of particles in cells about `centers`, in a container of minimum corner `lo` and maximum corner `hi`.
    pub fn densities(self, centers: &[[f64; 3]], lo: [f64; 3], hi: [f64; 3]) -> Vec<f64> {
        let share = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| (p[k] - lo[k]) / (hi[k] - lo[k])) };
        if self == Self::SnowGlobe {
            let snow = (SNOW_SHARE * centers.len() as f64) as usize;
            let mut order: Vec<usize> = (0..centers.len()).collect();
            order.sort_by(|&i, &j| centers[j][1].total_cmp(&centers[i][1]));
            let mut densities = vec![1.0; centers.len()];
            order[..SNOW_AMONG * snow].iter().step_by(SNOW_AMONG).for_each(|&i| densities[i] = SNOW);
            return densities;
        }
        centers.iter().map(|&p| if self.is_heavy(share(p)) { HEAVY } else { 1.0 }).collect()
    }

    /// Particles of such densities for cells about `centers`: each where its spring gives it the acceleration that the scene begins with. (From
    /// the centers themselves the springs would swing for ever.)
    pub fn start(self, centers: &[[f64; 3]], densities: Vec<f64>, settings: &Settings) -> Start {
        let mean = densities.iter().sum::<f64>() / densities.len() as f64;
        let gravity = settings.gravity.at(0.0);
        let place = |(&x, density): (&[f64; 3], &f64)| {
            let a = self.acceleration(x);
            let force = |k: usize| density * a[k] - (density - mean) * gravity[k];
            std::array::from_fn(|k| x[k] - settings.epsilon * settings.epsilon * force(k))
        };
        let positions = centers.iter().zip(&densities).map(place).collect();
        Start { positions, velocities: centers.iter().map(|&x| self.velocity(x)).collect(), densities }
    }

    /// Settings that suit the scene in such a container, for cells of size `h` (length) and particles of such densities: gravity by which a
    /// stone falls down half the container's height in one unit of time, and an `ε` by which the scene's accelerations stretch springs by a quarter
    /// of a cell, or by less where two densities meet; there with viscosity, so that a border breaks up into waves and not into
    /// particles; but snow does sink flake by flake.
    pub fn settings(self, densities: &[f64], lo: [f64; 3], hi: [f64; 3], h: f64, gravity: Option<f64>) -> Settings {
        let strength = gravity.unwrap_or(if self.has_two_densities() { hi[1] - lo[1] } else { 0.0 });
        let mut all = Gravity { steady: [0.0, -strength, 0.0], ..Gravity::default() };
        if self == Self::SnowGlobe {
            let fall = if strength == 0.0 { 1.0 } else { ((hi[1] - lo[1]) / strength.abs()).sqrt() };
            all = Gravity { shake: [SHAKE * strength, 0.0, 0.0], period: fall, swings: SWINGS, ..all };
        }
        // Vortices, in the unit cube, are as fast as 1.
        let speed = if self.has_two_densities() { 0.0 } else { 1.0 };
        let epsilon = suited(densities, speed, longest(lo, hi), h, &all);
        // With viscosity ν, waves of length 4π(ν²/(g·A))^⅓ grow fastest, A = (ρ − ρ')/(ρ + ρ') (Chandrasekhar 1961, §94).
        let (least, most) = densities.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &d| (a.min(d), b.max(d)));
        let driving = if self == Self::SnowGlobe { 0.0 } else { strength.abs() } * (most - least) / (most + least);
        let viscosity = (FASTEST_WAVE * h / (4.0 * PI)).powf(1.5) * driving.sqrt();
        Settings { epsilon, viscosity, gravity: all, time_step: None }
    }

    /// Whether the fluid at a point of the unit cube, that the box is mapped to, is heavy.
    fn is_heavy(self, [x, y, z]: [f64; 3]) -> bool {
        match self {
            Self::RayleighTaylor => {
                let wave = (2.0 * TAU * x).cos() + 0.5 * (TAU * x + 1.0).sin() * (1.0 + 0.5 * (PI * z).cos());
                y > 0.5 + WAVE * wave
            }
            Self::DamBreak => x < DAM,
            _ => false,
        }
    }
}

impl Start {
    /// An `ε` that suits such particles in a container, as [`Scene::settings`] has it: by which gravity on the largest excess of density, and the
    /// acceleration `πv²/2L` of the fastest particle's speed `v` in a container as long as `L`, on the heaviest, stretch springs by a quarter of a cell, or by
    /// less where two densities meet.
    pub fn epsilon(&self, container: &Container, gravity: &Gravity) -> f64 {
        let (lo, hi) = match container {
            Container::Domain(domain) => domain.bounding_box(),
            Container::Box(lo, hi) => (*lo, *hi),
        };
        let fastest = self.velocities.iter().map(|&v| inner(v, v)).fold(0.0, f64::max).sqrt();
        let h = (container.volume() / container.mean_density() / self.positions.len() as f64).cbrt();
        suited(&self.densities, fastest, longest(lo, hi), h, gravity)
    }
}

fn longest(lo: [f64; 3], hi: [f64; 3]) -> f64 {
    (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max)
}

/// The `ε` by which springs are stretched as the constants above say, for cells of size `h` in a container of some length.
fn suited(densities: &[f64], speed: f64, length: f64, h: f64, gravity: &Gravity) -> f64 {
    let mean = densities.iter().sum::<f64>() / densities.len() as f64;
    let heaviest = densities.iter().copied().fold(0.0, f64::max);
    let are_alike = densities.iter().all(|&d| d == heaviest);
    // (The mean of those that are alike is rounded.)
    let excess = if are_alike { 0.0 } else { densities.iter().map(|d| (d - mean).abs()).fold(0.0, f64::max) };
    let [steady, shake] = [gravity.steady, gravity.shake].map(|g| inner(g, g).sqrt());
    // Of the vortices the acceleration u·∇u is π/2 at most.
    let acceleration = (excess * steady.hypot(shake)).max(heaviest * PI / 2.0 * speed * speed / length);
    // At rest for want of gravity: any will do.
    let stretched = if acceleration > 0.0 { acceleration } else { h };
    let stretch = if excess > 0.0 { STRETCH_OF_TWO } else { STRETCH };
    (stretch * h / stretched).sqrt()
}

/// About `count` sites in a box from the origin: the centres of the voxels of a grid, nearly cubic, the first axis fastest.
pub fn lattice(extent: [f64; 3], count: usize) -> Vec<[f64; 3]> {
    let size = (extent.iter().product::<f64>() / count as f64).cbrt();
    let dims = extent.map(|e| (e / size).round().max(1.0) as usize);
    let voxel = |i: usize| [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]];
    let center = |i: usize| std::array::from_fn(|k| (voxel(i)[k] as f64 + 0.5) * extent[k] / dims[k] as f64);
    (0..dims.iter().product()).map(center).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Springs stretch alike whatever the unit of mass is; densities that are alike are no two, though their mean is rounded.
    #[test]
    fn epsilon_goes_with_the_density() {
        let gravity = Gravity { steady: [0.0, -9.81, 0.0], ..Gravity::default() };
        let moving = |density: f64| suited(&[density; 1000], 2.0, 1.0, 0.1, &gravity) * density.sqrt();
        for density in [0.1, 1.2, 998.2] {
            assert!((moving(density) / moving(1.0) - 1.0).abs() < 1e-12, "{density}");
            assert_eq!(suited(&[density; 1000], 0.0, 1.0, 0.1, &gravity), STRETCH.sqrt());
        }
        let two = |density: f64| suited(&[density, 2.0 * density], 0.0, 1.0, 0.1, &gravity) * density.sqrt();
        assert!((two(998.2) / two(1.0) - 1.0).abs() < 1e-12);
    }
}
