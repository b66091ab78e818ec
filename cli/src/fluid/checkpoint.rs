//! Checkpoints: all that a fluid goes on from, to the last bit.
//!
//! A file is one line of JSON with names and counts, then numbers, little-endian: 64-bit floats in the order of [`Checkpoint::write`], and the
//! domain's triangles as 32-bit indices, and at the end a checksum of all before it.

use std::fs;
use std::path::Path;

use laguerre::Container;
use laguerre::solvers::fluid::{Fluid, Scene, Settings, State};
use laguerre::{Backend, Domain, Error, ErrorKind, Result, io};
use serde::{Deserialize, Serialize};

/// The ending of a checkpoint's name.
pub(super) const ENDING: &str = ".fluid";

/// The first line.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    laguerre_fluid: u32,
    scene: String,
    steps: u64,
    particles: usize,
    /// 0 for a box.
    vertices: usize,
    triangles: usize,
}

/// Version of the form.
const VERSION: u32 = 1;
/// Single numbers before the arrays.
const SCALARS: usize = 14;
/// Bytes of the checksum.
const CHECKSUM: usize = size_of::<u64>();

/// What a file holds.
pub(super) struct Checkpoint {
    scene: Scene,
    container: Container,
    state: State,
    settings: Settings,
}

/// Writes the checkpoint of a fluid, whole or not at all.
///
/// # Errors
/// `Io` where writing failed.
pub(super) fn write(path: &Path, scene: Scene, container: &Container, fluid: &Fluid) -> Result<()> {
    let (state, settings) = (fluid.state(), fluid.settings());
    let (vertices, triangles): (&[[f64; 3]], &[[u32; 3]]) = match container {
        Container::Domain(domain) => (domain.vertices(), domain.triangles()),
        Container::Box(..) => (&[], &[]),
    };
    let header = Header {
        laguerre_fluid: VERSION,
        scene: scene.name().into(),
        steps: state.steps,
        particles: state.positions.len(),
        vertices: vertices.len(),
        triangles: triangles.len(),
    };
    let header = serde_json::to_string(&header).map_err(|e| Error::input(format!("{}: {e}", path.display())))?;
    let gravity = settings.gravity;
    let mut numbers = vec![
        state.time,
        state.hamiltonian_at_start,
        state.brought_in,
        settings.epsilon,
        settings.viscosity,
        // 0 stands for none.
        settings.time_step.unwrap_or(0.0),
        gravity.period,
        gravity.swings,
    ];
    numbers.extend(gravity.steady.iter().chain(&gravity.shake));
    match container {
        Container::Box(lo, hi) => numbers.extend(lo.iter().chain(hi)),
        Container::Domain(_) => numbers.extend(vertices.as_flattened()),
    }
    for vectors in [&state.positions, &state.velocities] {
        numbers.extend(vectors.as_flattened());
    }
    for column in [&state.densities, &state.weights, &state.weight_rates] {
        numbers.extend(column);
    }
    let mut bytes = header.into_bytes();
    bytes.push(b'\n');
    bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(triangles.as_flattened().iter().flat_map(|i| i.to_le_bytes()));
    let sum = checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    io::write_whole(path, |w| w.write_all(&bytes))
}

impl Checkpoint {
    /// Reads a file.
    ///
    /// # Errors
    /// `Io` where it cannot be read, `Input` where it is no checkpoint, or a damaged one.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let failed = |e| Error::new(ErrorKind::Io, format!("{}: cannot read: {e}", path.display()));
        let bytes = fs::read(path).map_err(failed)?;
        Self::parse(&bytes).map_err(|e| e.at(path.display()))
    }

    fn parse(bytes: &[u8]) -> Result<Self> {
        let no = || Error::input("is no checkpoint of laguerre fluid");
        let end = bytes.iter().position(|&b| b == b'\n').ok_or_else(no)?;
        let header: Header = serde_json::from_slice(&bytes[..end]).map_err(|_| no())?;
        if header.laguerre_fluid != VERSION {
            return Err(Error::input(format!(
                "is a checkpoint of form {}; this program knows {VERSION}",
                header.laguerre_fluid
            )));
        }
        let scene = Scene::named(&header.scene).ok_or_else(no)?;
        let Header { particles: n, vertices, triangles, .. } = header;
        let corners = if vertices == 0 { 6 } else { vertices.saturating_mul(3) };
        let floats = n.saturating_mul(9).saturating_add(corners).saturating_add(SCALARS);
        let length = floats.saturating_mul(8).saturating_add(triangles.saturating_mul(12));
        let length = length.saturating_add(end + 1 + CHECKSUM);
        if bytes.len() != length {
            return Err(Error::input(format!(
                "is damaged: it has {} bytes, not {length}; go on from another checkpoint",
                bytes.len()
            )));
        }
        let (whole, sum) = bytes.split_at(length - CHECKSUM);
        if checksum(whole).to_le_bytes() != sum {
            return Err(Error::input("is damaged: its checksum is wrong; go on from another checkpoint"));
        }
        let (floats, indices) = whole[end + 1..].split_at(8 * floats);
        let floats: Vec<f64> = floats.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        let mut rest = floats.as_slice();
        let mut take = |count: usize| {
            let (taken, others) = rest.split_at(count);
            rest = others;
            taken
        };
        let scalars = take(SCALARS);
        let three = |x: &[f64]| -> [f64; 3] { std::array::from_fn(|k| x[k]) };
        let place = take(corners);
        let container = if vertices == 0 {
            Container::Box(three(place), three(&place[3..]))
        } else {
            let indices: Vec<u32> = indices.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
            Container::Domain(Domain::new(place.as_chunks().0, indices.as_chunks().0)?)
        };
        let mut vectors = || take(3 * n).as_chunks().0.to_vec();
        let (positions, velocities) = (vectors(), vectors());
        let mut state = State::default();
        (state.steps, state.time) = (header.steps, scalars[0]);
        (state.hamiltonian_at_start, state.brought_in) = (scalars[1], scalars[2]);
        (state.positions, state.velocities) = (positions, velocities);
        (state.densities, state.weights, state.weight_rates) = (take(n).to_vec(), take(n).to_vec(), take(n).to_vec());
        let mut settings = Settings::new(scalars[3]);
        (settings.viscosity, settings.time_step) = (scalars[4], Some(scalars[5]).filter(|&h| h != 0.0));
        (settings.gravity.period, settings.gravity.swings) = (scalars[6], scalars[7]);
        (settings.gravity.steady, settings.gravity.shake) = (three(&scalars[8..]), three(&scalars[11..]));
        Ok(Self { scene, container, state, settings })
    }

    /// The fluid.
    ///
    /// # Errors
    /// `Input` where what it goes on from cannot be.
    pub(super) fn fluid(self, backend: &dyn Backend) -> Result<(Scene, Container, Fluid)> {
        let fluid = Fluid::resume(backend, &self.container, self.state, self.settings)?;
        Ok((self.scene, self.container, fluid))
    }
}

/// FNV-1a (Fowler, Noll, Vo) of 64 bits: a byte that is not as it was always changes it.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}
