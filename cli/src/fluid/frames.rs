//! Frames of a fluid, and the film of them.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use gif::{Encoder, Frame, Repeat};
use laguerre::Container;
use laguerre::solvers::fluid::{Fluid, Scene, State};
use laguerre::{Domain, Error, ErrorKind, Result, io};
use tiny_skia::Pixmap;

use super::series::Series;
use super::{FluidArgs, extents};
use crate::picture::{mixed, paint, save};
use crate::slice::SlicePlane;

/// Forms of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FrameKind {
    /// Particles, for ParaView
    Vtu,
    /// Particles, as a point cloud
    Ply,
    /// A slice through the cells
    Png,
}

/// Where along z the slice is: not in the middle, where cells of a lattice meet.
const SLICE_AT: f64 = 0.46;
/// Hundredths of a second that a frame of the film is seen.
const FRAME_TIME: u16 = 6;
/// Time that the encoder takes to choose 256 colours, from 1 (best) to 30.
const COLOR_SPEED: i32 = 10;

const LIGHT: [u8; 3] = [0xfa, 0xe3, 0xb4];
const HEAVY: [u8; 3] = [0x1f, 0x5f, 0x8b];
const WATER: [u8; 3] = [0x3f, 0x84, 0xb0];
const SNOW: [u8; 3] = [0xf4, 0xf8, 0xfc];
/// From rest to the fastest; the lightness grows evenly.
const SPEEDS: [[u8; 3]; 5] =
    [[0x2a, 0x18, 0x58], [0x7b, 0x2a, 0x7b], [0xc9, 0x4a, 0x5f], [0xf0, 0x8c, 0x3c], [0xfb, 0xe5, 0x6e]];
/// How much white the fastest particles have where colours show densities.
const GLOW: f64 = 0.45;

/// Writes frames.
pub(super) struct Frames {
    folder: Option<PathBuf>,
    kinds: Vec<FrameKind>,
    scene: Scene,
    /// What pictures show the outline of.
    domain: Domain,
    plane: SlicePlane,
    /// Of pictures, in pixels.
    width: u32,
    film: Option<Film>,
    /// The times of the frames that are `.vtu`, where there are any.
    series: Option<Series>,
}

struct Film {
    path: PathBuf,
    encoder: Option<Encoder<Vec<u8>>>,
}

impl Frames {
    /// Makes the folder. Frames follow those up to step `resumed` there, if the motion goes on.
    ///
    /// # Errors
    /// `Io` where it cannot.
    pub(super) fn new(args: &FluidArgs, scene: Scene, container: &Container, resumed: Option<u64>) -> Result<Self> {
        let folder = args.out_dir.as_deref();
        if let Some(folder) = folder {
            let failed = |e| Error::new(ErrorKind::Io, format!("{}: cannot make this folder: {e}", folder.display()));
            fs::create_dir_all(folder).map_err(failed)?;
        }
        let (lo, hi, _) = extents(container);
        let domain = match container {
            Container::Domain(domain) => domain.clone(),
            Container::Box(..) => cuboid(lo, hi)?,
        };
        let origin = [0.0, 0.0, lo[2] + SLICE_AT * (hi[2] - lo[2])];
        let has_series = args.frames.contains(&FrameKind::Vtu);
        Ok(Self {
            series: folder.filter(|_| has_series).map(|folder| Series::new(folder, resumed)),
            folder: folder.map(Path::to_path_buf),
            kinds: args.frames.clone(),
            scene,
            domain,
            plane: SlicePlane { origin, u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0] },
            width: args.width,
            film: args.film.clone().map(|path| Film { path, encoder: None }),
        })
    }

    /// A frame of the film, and files in the folder, if `in_folder`.
    ///
    /// # Errors
    /// `Io` where writing failed.
    pub(super) fn add(&mut self, fluid: &Fluid, in_folder: bool) -> Result<()> {
        let folder = self.folder.as_ref().filter(|_| in_folder);
        let is_drawn = self.film.is_some() || (folder.is_some() && self.kinds.contains(&FrameKind::Png));
        let picture = is_drawn
            .then(|| paint(&self.domain, fluid.diagram(), &colors(self.scene, fluid), &self.plane, self.width))
            .transpose()?;
        if let Some(folder) = folder {
            let State { steps, time, .. } = *fluid.state();
            let name = |ending: &str| folder.join(format!("frame-{steps:06}.{ending}"));
            for kind in &self.kinds {
                match (kind, &picture) {
                    (FrameKind::Vtu, _) => {
                        write_vtu(&folder.join(Series::name(steps)), fluid)?;
                        self.series.iter_mut().try_for_each(|series| series.add(steps, time))?;
                    }
                    (FrameKind::Ply, _) => write_ply(&name("ply"), fluid)?,
                    (FrameKind::Png, Some(picture)) => save(&name("png"), picture)?,
                    (FrameKind::Png, None) => {}
                }
            }
        }
        if let (Some(film), Some(picture)) = (&mut self.film, &picture) {
            film.add(picture).map_err(|e| Error::new(ErrorKind::Io, format!("{}: {e}", film.path.display())))?;
        }
        Ok(())
    }

    /// Writes the film.
    ///
    /// # Errors
    /// `Io` where that failed.
    pub(super) fn finish(self) -> Result<()> {
        let Some(Film { path, encoder: Some(encoder) }) = self.film else { return Ok(()) };
        let bytes = encoder.into_inner().map_err(|e| Error::new(ErrorKind::Io, format!("{}: {e}", path.display())))?;
        io::write_whole(&path, |w| w.write_all(&bytes))
    }
}

impl Film {
    fn add(&mut self, picture: &Pixmap) -> std::result::Result<(), gif::EncodingError> {
        // The slice of one container is always of one size, no more than 20 times as high as it is wide: fewer than 65,536 pixels.
        let [width, height] = [picture.width(), picture.height()].map(|x| u16::try_from(x).unwrap_or(u16::MAX));
        let encoder = match &mut self.encoder {
            Some(encoder) => encoder,
            none => {
                let mut encoder = Encoder::new(Vec::new(), width, height, &[])?;
                encoder.set_repeat(Repeat::Infinite)?;
                none.insert(encoder)
            }
        };
        let mut pixels = picture.data().to_vec();
        let mut frame = Frame::from_rgba_speed(width, height, &mut pixels, COLOR_SPEED);
        frame.delay = FRAME_TIME;
        encoder.write_frame(&frame)
    }
}

/// The colour of each particle's cell: by density, lighter where it is fast; where there is one density, by speed.
fn colors(scene: Scene, fluid: &Fluid) -> Vec<[u8; 3]> {
    let state = fluid.state();
    let (lo, hi) = laguerre::engine::diagram::bounding_box(&state.positions);
    let gravity = fluid.settings().gravity.steady[1].abs();
    // The vortices' largest speed is 1, and what falls comes near to that of half the height.
    let fastest = if scene.has_two_densities() { (gravity * (hi[1] - lo[1])).sqrt() } else { 1.0 };
    let densest = state.densities.iter().copied().fold(0.0, f64::max);
    let (light, heavy) = if scene == Scene::SnowGlobe { (WATER, SNOW) } else { (LIGHT, HEAVY) };
    let each = state.velocities.iter().zip(&state.densities);
    each.map(|(v, &density)| {
        let speed = (v[0].hypot(v[1]).hypot(v[2]) / fastest.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        if scene.has_two_densities() {
            mixed(if density == densest { heavy } else { light }, [255; 3], GLOW * speed)
        } else {
            let at = speed * (SPEEDS.len() - 1) as f64;
            let below = (at as usize).min(SPEEDS.len() - 2);
            mixed(SPEEDS[below], SPEEDS[below + 1], at - below as f64)
        }
    })
    .collect()
}

/// A box as a mesh.
fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Result<Domain> {
    let corner = |c: usize| std::array::from_fn(|k| if c >> k & 1 == 1 { hi[k] } else { lo[k] });
    let vertices: Vec<[f64; 3]> = (0..8).map(corner).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Domain::new(&vertices, &triangles)
}

/// Particles as the vertices of a binary `.ply`, with velocity, density and weight.
fn write_ply(path: &Path, fluid: &Fluid) -> Result<()> {
    io::write_whole(path, |w| {
        let state = fluid.state();
        write!(w, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", state.positions.len())?;
        for name in ["x", "y", "z", "vx", "vy", "vz", "density", "weight"] {
            writeln!(w, "property double {name}")?;
        }
        writeln!(w, "end_header")?;
        for i in 0..state.positions.len() {
            let numbers = state.positions[i].iter().chain(&state.velocities[i]);
            put(w, numbers.chain([&state.densities[i], &state.weights[i]]))?;
        }
        Ok(())
    })
}

/// Particles as the points of a `.vtu`, with velocity, density and weight; its arrays stand behind the XML as raw numbers.
fn write_vtu(path: &Path, fluid: &Fluid) -> Result<()> {
    let state = fluid.state();
    let n = state.positions.len();
    let points = [
        ("PointData", "velocity", 3, state.velocities.as_flattened()),
        ("PointData", "density", 1, &state.densities),
        ("PointData", "weight", 1, &state.weights),
        ("Points", "Points", 3, state.positions.as_flattened()),
    ];
    io::write_whole(path, |w| {
        let open =
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">";
        writeln!(w, "<?xml version=\"1.0\"?>\n{open}\n<UnstructuredGrid>")?;
        writeln!(w, "<Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{n}\">")?;
        let mut offset = 0;
        let mut array = |w: &mut dyn Write, kind: &str, name: &str, components: usize, bytes: usize| {
            let at = offset;
            offset += 8 + bytes;
            writeln!(
                w,
                "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{at}\"/>"
            )
        };
        for section in ["PointData", "Points"] {
            writeln!(w, "<{section}>")?;
            for (_, name, components, numbers) in points.iter().filter(|p| p.0 == section) {
                array(w, "Float64", name, *components, size_of_val(*numbers))?;
            }
            writeln!(w, "</{section}>")?;
        }
        writeln!(w, "<Cells>")?;
        array(w, "Int64", "connectivity", 1, 8 * n)?;
        array(w, "Int64", "offsets", 1, 8 * n)?;
        array(w, "UInt8", "types", 1, n)?;
        writeln!(w, "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">")?;
        w.write_all(b"_")?;
        for (.., numbers) in points {
            w.write_all(&(size_of_val(numbers) as u64).to_le_bytes())?;
            put(w, numbers)?;
        }
        // Each point is a cell of its own.
        for first in [0, 1] {
            w.write_all(&(8 * n as u64).to_le_bytes())?;
            (0..n as i64).try_for_each(|i| w.write_all(&(i + first).to_le_bytes()))?;
        }
        w.write_all(&(n as u64).to_le_bytes())?;
        (0..n).try_for_each(|_| w.write_all(&[VTK_VERTEX]))?;
        writeln!(w, "\n</AppendedData>\n</VTKFile>")
    })
}

/// VTK's number for a point as a cell.
const VTK_VERTEX: u8 = 1;

fn put<'a>(w: &mut dyn Write, numbers: impl IntoIterator<Item = &'a f64>) -> std::io::Result<()> {
    numbers.into_iter().try_for_each(|x| w.write_all(&x.to_le_bytes()))
}
