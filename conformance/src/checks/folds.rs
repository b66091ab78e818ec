//! Surfaces that fold over themselves nearly in a plane: around the slabs between the folds, thinner than rounding or thicker, they go −1, 0, 1
//! and 2 times side by side.

use laguerre_core::shapes::{Mesh, Section, folded_prism};
use laguerre_core::summation::Sum;
use laguerre_core::{Backend, Output, Request};

use crate::bounds::{NOTHING, SUM, of_digits};
use crate::domains::Room;
use crate::sites::Random;
use crate::{Scene, Verdict};

/// How far the corners of the caps are off their planes.
const OFF: [f64; 9] = [1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-7, 1e-5, 1e-3, 1e-2];

/// So many sites that many cells have nothing of the domain but a slab between folds.
const SITES: usize = 3000;

/// The volumes sum to the mesh's, also of cells of which no other has facets; and the cyclic permutations of the axes, which round nothing, change no status but of cells that are nothing, and
/// no volume by more. (One check, as the cells take longer than all else.)
pub fn prisms(backend: &dyn Backend) -> Verdict {
    each(backend, |scene, outputs, name| {
        fill(backend, scene, outputs).map_err(|reason| format!("{name}: {reason}"))?;
        are_alike(backend, scene, outputs).map_err(|reason| format!("{name}: {reason}"))
    })
}

fn fill(backend: &dyn Backend, scene: &Scene, outputs: &[Output; 3]) -> Verdict {
    for output in outputs {
        let mut sum = Sum::default();
        sum.extend(output.volume().iter().copied());
        let (total, volume) = (sum.total(), scene.room.volume());
        let off = (total - volume).abs();
        ensure!(off <= of_digits(backend) * SUM * volume, "the volumes sum to {total}, not {volume}: off by {off:e}");
    }
    Ok(())
}

fn are_alike(backend: &dyn Backend, scene: &Scene, [first, others @ ..]: &[Output; 3]) -> Verdict {
    let bound = NOTHING * scene.room.volume() / scene.len() as f64;
    let of_volume = of_digits(backend) * bound;
    for other in others {
        for i in 0..scene.len() {
            let (a, b) = (first.volume()[i], other.volume()[i]);
            let (s, t) = (first.status()[i], other.status()[i]);
            ensure!(
                (a - b).abs() <= of_volume,
                "site {i}: volumes {a:e} and {b:e}, {s:?} and {t:?}, bound {of_volume:e}"
            );
            ensure!(s == t || a.abs().max(b.abs()) <= bound, "site {i}: {s:?} and {t:?}, volumes {a:e} and {b:e}");
        }
    }
    Ok(())
}

/// Holds the outputs of each prism and the same sites in the three cyclic orders of the axes to `law`; the scene is that of the first.
fn each(backend: &dyn Backend, law: impl Fn(&Scene, &[Output; 3], &str) -> Verdict) -> Verdict {
    let mut negative = 0;
    for section in Section::ALL {
        for off in OFF {
            let mut random = Random::new(3007);
            let mesh = folded_prism(section, off);
            let place = |_| (random.point() * glam::DVec3::new(1.0, 1.0, 0.5)).into();
            let positions: Vec<[f64; 3]> = (0..SITES).map(place).collect();
            let turned = |first: usize| {
                let turn = |x: &[f64; 3]| [0, 1, 2].map(|k| x[(first + k) % 3]);
                let vertices = mesh.vertices.iter().map(turn).collect();
                let room = Room::of(Mesh { vertices, triangles: mesh.triangles.clone() });
                Scene { positions: positions.iter().map(turn).collect(), weights: Vec::new(), room }
            };
            let scenes = [0, 1, 2].map(turned);
            let evaluate = |k: usize| scenes[k].evaluate(backend, &Request::moments());
            let outputs = [evaluate(0)?, evaluate(1)?, evaluate(2)?];
            negative += outputs[0].volume().iter().filter(|v| **v < 0.0).count();
            law(&scenes[0], &outputs, &format!("{section:?}, {off:e} off its planes"))?;
        }
    }
    ensure!(negative > 300, "{negative} cells are negative: nothing was folded");
    Ok(())
}
