//! Domains that have a density, constant in each voxel of an image or in each tetrahedron.
//!
//! Such a density is a winding number times a unit: of the surface between all parts, each triangle as often as the density jumps there. So
//! cells are restricted to it as to any mesh, and all their integrals are exact.

use std::collections::BTreeMap;

use robust::{Coord3D, orient3d};

use super::{Domain, MOST_TRIANGLES};
use crate::{Error, Result};

/// Densities are kept as multiples of a power of two, of which the largest is no more than this.
const MOST_LEVELS: f64 = (1_u32 << 28) as f64;

impl Domain {
    /// A box of voxels, each with a density (mass per volume): the one at `(i, j, k)` is `values[(i·n_y + j)·n_z + k]` where `shape` is `[n_x, n_y, n_z]`.
    /// The box from `lo` to `hi` is divided evenly.
    ///
    /// Densities are kept as multiples of a power of two, at least 28 bits below the largest, with a note where that changes one; integers up to 2²⁸ are kept.
    /// Memory and, at first, time grow with the number of faces at which the density changes.
    ///
    /// # Errors
    /// `Input` where there is not one value for each voxel, one is not a number from 0, all are 0, the box has no volume, or there are
    /// more than 2²⁸ triangles.
    pub fn of_image(values: &[f64], shape: [usize; 3], lo: [f64; 3], hi: [f64; 3]) -> Result<Self> {
        let count = shape.iter().try_fold(1_usize, |n, &m| n.checked_mul(m));
        if count != Some(values.len()) || values.is_empty() {
            return Err(Error::input(format!(
                "the image has {} values for {} × {} × {} voxels: give one for each, and at least one",
                values.len(),
                shape[0],
                shape[1],
                shape[2]
            )));
        }
        if (0..3).any(|k| !(lo[k] < hi[k] && (hi[k] - lo[k]).is_finite())) {
            return Err(Error::input(format!(
                "the box of the image from {lo:?} to {hi:?} has no volume: give its minimum and its maximum corner"
            )));
        }
        let place = |i: usize| [i / (shape[1] * shape[2]), i / shape[2] % shape[1], i % shape[2]];
        let levels = Levels::of(values, |i| format!("voxel {:?} of the image", place(i)))?;
        let at = |voxel: [usize; 3]| levels.numbers[(voxel[0] * shape[1] + voxel[1]) * shape[2] + voxel[2]];
        let mut surface = Surface::default();
        let mut points = BTreeMap::new();
        let mut vertices: Vec<[f64; 3]> = Vec::new();
        let mut vertex = |point: [usize; 3]| {
            *points.entry(point).or_insert_with(|| {
                // The ends exactly.
                let along = |k: usize| {
                    let share = point[k] as f64 / shape[k] as f64;
                    if point[k] == shape[k] { hi[k] } else { lo[k] + (hi[k] - lo[k]) * share }
                };
                vertices.push([along(0), along(1), along(2)]);
                vertices.len() as u32 - 1
            })
        };
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut layers = shape;
            layers[axis] += 1;
            for i in 0..layers[0] * layers[1] * layers[2] {
                let upper = [i / (layers[1] * layers[2]), i / layers[2] % layers[1], i % layers[2]];
                let mut lower = upper;
                lower[axis] = upper[axis].wrapping_sub(1);
                let above = if upper[axis] < shape[axis] { at(upper) } else { 0 };
                let below = if upper[axis] > 0 { at(lower) } else { 0 };
                if below != above {
                    let corner = |a: usize, b: usize| {
                        let mut point = upper;
                        point[u] += a;
                        point[v] += b;
                        point
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)].map(&mut vertex);
                    surface.add([a, b, c], below - above)?;
                    surface.add([a, c, d], below - above)?;
                }
            }
        }
        let voxel: f64 = (0..3).map(|k| (hi[k] - lo[k]) / shape[k] as f64).product();
        let support = voxel * levels.numbers.iter().filter(|&&n| n > 0).count() as f64;
        surface.domain(&vertices, &levels, support)
    }

    /// Tetrahedra, each with a density (mass per volume) of its own; where some overlap, densities add up. Corners are indices into `vertices`, in any order; flat
    /// tetrahedra count for nothing. Densities are kept as those of [`Domain::of_image`].
    ///
    /// # Errors
    /// `Input` where there is not one value for each tetrahedron, one is not a number from 0, a corner is out of range, or nothing has a mass.
    pub fn of_tetrahedra(vertices: &[[f64; 3]], tetrahedra: &[[u32; 4]], values: &[f64]) -> Result<Self> {
        if values.len() != tetrahedra.len() || values.is_empty() {
            return Err(Error::input(format!(
                "{} densities for {} tetrahedra: give one for each, and at least one",
                values.len(),
                tetrahedra.len()
            )));
        }
        let levels = Levels::of(values, |i| format!("tetrahedron {i}"))?;
        let mut faces: BTreeMap<[u32; 3], i64> = BTreeMap::new();
        let mut support = 0.0;
        for (i, (corners, &level)) in tetrahedra.iter().zip(&levels.numbers).enumerate() {
            if let Some(corner) = corners.iter().find(|&&c| c as usize >= vertices.len()) {
                return Err(Error::input(format!(
                    "tetrahedron {i}: vertex index {corner} (counted from 0) is out of range; there are {} vertices",
                    vertices.len()
                )));
            }
            let points = corners.map(|c| vertices[c as usize]);
            let [p, q, r, s] = points.map(|[x, y, z]| Coord3D { x, y, z });
            let volume = orient3d(p, q, r, s);
            if !volume.is_finite() {
                return Err(Error::input(format!("tetrahedron {i}: a coordinate is not a number")));
            }
            if volume == 0.0 || level == 0 {
                continue;
            }
            support += volume.abs() / 6.0;
            let [a, b, c, d] = *corners;
            // `orient3d` is positive where d is below the triangle (a, b, c), counterclockwise from above.
            let outward = [[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
            for face in outward {
                let (sorted, is_even) = sorted(face);
                let sign = if is_even == (volume > 0.0) { 1 } else { -1 };
                *faces.entry(sorted).or_insert(0) += sign * i64::from(level);
            }
        }
        let mut surface = Surface::default();
        for (face, jump) in faces.into_iter().filter(|(_, jump)| *jump != 0) {
            let jump = i32::try_from(jump)
                .map_err(|_| Error::input("too many tetrahedra overlap: their densities do not add up"))?;
            surface.add(face, jump)?;
        }
        surface.domain(vertices, &levels, support)
    }
}

/// The corners in ascending order, and whether it takes an even number of exchanges.
fn sorted(face: [u32; 3]) -> ([u32; 3], bool) {
    let [mut a, mut b, mut c] = face;
    let mut is_even = true;
    let mut order = |x: &mut u32, y: &mut u32| {
        if x > y {
            std::mem::swap(x, y);
            is_even = !is_even;
        }
    };
    order(&mut a, &mut b);
    order(&mut b, &mut c);
    order(&mut a, &mut b);
    ([a, b, c], is_even)
}

/// Densities as multiples of a unit.
struct Levels {
    numbers: Vec<i32>,
    unit: f64,
    note: Option<String>,
}

impl Levels {
    fn of(values: &[f64], name: impl Fn(usize) -> String) -> Result<Self> {
        if let Some(i) = values.iter().position(|v| !(*v >= 0.0 && v.is_finite())) {
            return Err(Error::input(format!(
                "the density of {} is {}: a number from 0 is needed",
                name(i),
                values[i]
            )));
        }
        let largest = values.iter().copied().fold(0.0, f64::max);
        if !(f64::MIN_POSITIVE / f64::EPSILON..1e60).contains(&largest) {
            return Err(Error::input(format!(
                "the largest density is {largest:e}: it must be more than 0, and less than 1e60"
            )));
        }
        let unit = (largest / MOST_LEVELS).log2().ceil().exp2();
        let mut numbers: Vec<i32> = values.iter().map(|v| (v / unit).round() as i32).collect();
        let changed = values.iter().zip(&numbers).filter(|&(v, n)| f64::from(*n) * unit != *v).count();
        let note = (changed > 0)
            .then(|| format!("{changed} of {} densities were rounded to multiples of {unit:e}", values.len()));
        // As small as they can be: sums of them then round less.
        let shift = numbers.iter().filter(|&&n| n != 0).map(|n| n.trailing_zeros()).min().unwrap_or(0);
        numbers.iter_mut().for_each(|n| *n >>= shift);
        Ok(Self { numbers, unit: unit * f64::from(shift).exp2(), note })
    }
}

/// Triangles, and how much more there is behind them.
#[derive(Default)]
struct Surface {
    triangles: Vec<[u32; 3]>,
    times: Vec<i32>,
}

impl Surface {
    fn add(&mut self, triangle: [u32; 3], times: i32) -> Result<()> {
        if self.triangles.len() == MOST_TRIANGLES {
            return Err(Error::input(format!(
                "the density changes at more than {MOST_TRIANGLES} triangles: make it coarser"
            )));
        }
        self.triangles.push(triangle);
        self.times.push(times);
        Ok(())
    }

    fn domain(self, vertices: &[[f64; 3]], levels: &Levels, support: f64) -> Result<Domain> {
        Domain::of_density(vertices, &self.triangles, &self.times, levels.unit, support, levels.note.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::Naive;
    use crate::{Backend, Output, PowerDiagram, Request};

    fn fraction(i: usize, step: f64) -> f64 {
        (((i + 1) * (i + 1)) as f64 * step.sqrt()).fract()
    }

    fn evaluated(domain: &Domain, request: &Request) -> Output {
        let positions: Vec<[f64; 3]> = (0..40).map(|i| [2.0, 3.0, 5.0].map(|x| 1.2 * fraction(i, x) - 0.1)).collect();
        let weights: Vec<f64> = (0..40).map(|i| 0.05 * fraction(i, 7.0)).collect();
        let diagram = PowerDiagram::new(&positions, &weights).unwrap().restricted_to(domain);
        Naive::default().evaluate(&diagram, request).unwrap()
    }

    /// The same density, as voxels and as the six tetrahedra of each.
    #[test]
    fn tetrahedra_and_voxels_agree() {
        let values = [3.0, 0.0, 1.0, 7.0, 2.0, 2.0, 5.0, 0.25];
        let image = Domain::of_image(&values, [2; 3], [0.0; 3], [1.0; 3]).unwrap();
        let number = |i: usize, j: usize, k: usize| (9 * i + 3 * j + k) as u32;
        let vertices: Vec<[f64; 3]> = (0..27).map(|i| [i / 9, i / 3 % 3, i % 3].map(|x| x as f64 / 2.0)).collect();
        let (mut tetrahedra, mut densities) = (Vec::new(), Vec::new());
        for (voxel, value) in values.iter().enumerate() {
            let at = [voxel / 4, voxel / 2 % 2, voxel % 2];
            for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
                let mut corner = at;
                let mut path = vec![number(corner[0], corner[1], corner[2])];
                for axis in axes {
                    corner[axis] += 1;
                    path.push(number(corner[0], corner[1], corner[2]));
                }
                tetrahedra.push([path[0], path[1], path[2], path[3]]);
                densities.push(*value);
            }
        }
        let parts = Domain::of_tetrahedra(&vertices, &tetrahedra, &densities).unwrap();
        assert!((parts.volume() - values.iter().sum::<f64>() / 8.0).abs() < 1e-15);
        assert!((parts.mean_density() - parts.volume() / (7.0 / 8.0)).abs() < 1e-14);
        assert!(image.notes().is_empty() && parts.notes().is_empty());
        let request = Request::moments();
        let (one, other) = (evaluated(&image, &request), evaluated(&parts, &request));
        for (a, b) in one.volume().iter().zip(other.volume()) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
    }

    #[test]
    fn what_is_no_density_is_said() {
        let said = |values: &[f64], shape| Domain::of_image(values, shape, [0.0; 3], [1.0; 3]).unwrap_err().to_string();
        assert!(said(&[1.0; 3], [2, 2, 1]).contains("3 values for 2 × 2 × 1 voxels"));
        assert!(said(&[1.0, -1.0], [2, 1, 1]).contains("density of voxel [1, 0, 0] of the image is -1"));
        assert!(said(&[0.0; 2], [2, 1, 1]).contains("largest density is 0e0"));
        let flat = Domain::of_image(&[1.0], [1; 3], [0.0; 3], [1.0, 0.0, 1.0]).unwrap_err().to_string();
        assert!(flat.contains("has no volume"), "{flat}");
        let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let said = Domain::of_tetrahedra(&vertices, &[[0, 1, 2, 4]], &[1.0]).unwrap_err().to_string();
        assert!(said.contains("vertex index 4"), "{said}");
        let domain = Domain::of_image(&[1.0, 2.0], [2, 1, 1], [0.0; 3], [1.0; 3]).unwrap();
        let diagram = PowerDiagram::new(&[[0.5; 3]], &[]).unwrap().restricted_to(&domain);
        let said = Naive::default().evaluate(&diagram, &Request::moments().with_geometry()).unwrap_err().to_string();
        assert!(said.contains("cells of a domain with a density have none"), "{said}");
        let rounded = Domain::of_image(&[1.0, 1.0 / 3.0], [2, 1, 1], [0.0; 3], [1.0; 3]).unwrap();
        assert!(rounded.notes()[0].contains("1 of 2 densities were rounded"));
    }
}
