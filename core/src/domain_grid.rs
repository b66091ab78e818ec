//! The grid over a domain: which triangles are where, and the winding number of each voxel's minimum corner.

mod lattice;
mod surface;
mod winding;

use crate::diagram::bounding_box;
use lattice::Lattice;

/// Voxels along the largest extent: at least, at most for many triangles, and at most.
const RESOLUTION: [f64; 3] = [12.0, 160.0, 250.0];
/// Voxels in all: at most, or twice as many as sites where that is more.
const MOST_VOXELS: usize = 2_000_000;
/// Length of the triangle lists for each triangle and voxel: at most (or else larger voxels are taken).
const MOST_ENTRIES: usize = 8;

/// Cubic voxels around a domain, in the coordinates of its frame.
///
/// Voxel `(i, j, k)` is half-open: the points with `corner(i) ≤ x < corner(i + 1)` on each axis. Every point of the domain
/// is in exactly one, and a triangle stands in the list of each that its bounding box meets, decided exactly.
///
/// No corner lies on a triangle, nor does a line of corners parallel to x meet an edge: the grid is shifted until so.
#[derive(Clone, Debug)]
pub struct DomainGrid {
    lattice: Lattice,
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 4]>,
    lowest_voxels: Vec<[u32; 3]>,
    offsets: Vec<u32>,
    entries: Vec<u32>,
    windings: Vec<i32>,
    surface_table: Vec<u32>,
}

impl DomainGrid {
    /// The grid over a closed mesh in the coordinates of its frame: its largest extent in (½, 1] and `|x| ≤ 2`. Each triangle stands so many times.
    ///
    /// There are about √(number of triangles) voxels along the largest extent, within 12 and 160, or more (up to 250) until there is one for
    /// each of so many sites; fewer where the lists would be longer than 8 entries a triangle and voxel.
    ///
    /// Cells near the surface cost several times what others do, and the grid decides which are near: at 10 million sites of a perturbed
    /// lattice, a sphere of 1,280 triangles costs 118 % over no domain with 36 voxels along its diameter, 28 % with 214 (one NVIDIA
    /// H200).
    pub fn new(vertices_in_frame: &[[f64; 3]], triangles: &[[u32; 3]], times: &[i32], sites: usize) -> Self {
        let vertices = vertices_in_frame;
        let used: Vec<[f64; 3]> = triangles.iter().flatten().map(|&i| vertices[i as usize]).collect();
        let (lo, hi) = bounding_box(&used);
        let extent: [f64; 3] = std::array::from_fn(|k| hi[k] - lo[k]);
        let spacing = (extent.iter().product::<f64>() / sites as f64).cbrt();
        let for_sites = (extent.iter().fold(0.0, |e: f64, &x| e.max(x)) / spacing).min(RESOLUTION[2]);
        let mut resolution = (triangles.len() as f64).sqrt().clamp(RESOLUTION[0], RESOLUTION[1]).max(for_sites);
        let most_voxels = MOST_VOXELS.max(2 * sites);
        let mut attempt = 0;
        loop {
            let lattice = Lattice::around(lo, hi, resolution, shift(attempt));
            let voxels = lattice.voxels();
            if voxels > most_voxels {
                resolution *= 0.99 * (most_voxels as f64 / voxels as f64).cbrt();
                continue;
            }
            let length: usize = triangles.iter().map(|t| volume_of_range(box_of_triangle(vertices, t, &lattice))).sum();
            // This ends: at resolution 1 there are 2 voxels along each axis, and 8 in all.
            if length > MOST_ENTRIES * (triangles.len() + voxels) {
                resolution *= 0.8;
                continue;
            }
            // (At the same time, 4 million voxels of a million sites in the bunny take 20 ms where they took 35, and new memory as long again; two cores.)
            let (windings, (lists, surface_table)) = rayon::join(
                || winding::windings(vertices, triangles, times, &lattice),
                || {
                    rayon::join(
                        || Lists::new(vertices, triangles, &lattice),
                        || surface::summed_table(vertices, triangles, &lattice),
                    )
                },
            );
            if let Some(windings) = windings {
                let with_times = |(&[a, b, c], &times): (&[u32; 3], &i32)| [a, b, c, times as u32];
                return Self {
                    lattice,
                    vertices: vertices.to_vec(),
                    triangles: triangles.iter().zip(times).map(with_times).collect(),
                    lowest_voxels: lists.lowest_voxels,
                    offsets: lists.offsets,
                    entries: lists.entries,
                    windings,
                    surface_table,
                };
            }
            attempt += 1;
        }
    }

    /// The number of voxels along each axis.
    pub fn dims(&self) -> [u32; 3] {
        self.lattice.dims
    }

    /// The minimum corner of a voxel, exactly `corner([0, 0, 0]) + voxel · voxel_width()`; valid up to `dims()`, the grid's
    /// own maximum corner.
    pub fn corner(&self, voxel: [u32; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.lattice.coordinate(k, voxel[k]))
    }

    /// The edge length of the voxels.
    pub fn voxel_width(&self) -> f64 {
        self.lattice.width
    }

    /// The largest `i < dims()[axis]` with `corner(i) ≤ x` on that axis, exactly; 0 where there is none.
    pub fn voxel_of(&self, axis: usize, x: f64) -> u32 {
        self.lattice.voxel_of(axis, x)
    }

    /// The place of a voxel in flat arrays: x fastest.
    pub fn voxel_index(&self, voxel: [u32; 3]) -> usize {
        self.lattice.voxel_index(voxel)
    }

    /// The triangles whose bounding box meets the voxel, in ascending order.
    #[cfg(test)]
    fn triangles_in(&self, voxel: [u32; 3]) -> &[u32] {
        let i = self.voxel_index(voxel);
        &self.entries[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// The componentwise lowest voxel that stands for triangle `t`. With it each triangle whose bounding box meets a box of
    /// voxels is found once: take it only in voxel `max(lowest_voxel(t), lowest voxel of the box)`, componentwise.
    pub fn lowest_voxel(&self, t: u32) -> [u32; 3] {
        self.lowest_voxels[t as usize]
    }

    /// The winding number of the voxel's minimum corner: how often the surface goes around it, 1 inside a simple one.
    pub fn winding(&self, voxel: [u32; 3]) -> i32 {
        self.windings[self.voxel_index(voxel)]
    }

    /// How many voxels of the inclusive range some triangle meets, by eight look-ups; 0 only where no triangle meets the
    /// box. Voxels that a triangle misses by a rounding may be counted.
    pub fn surface_voxels(&self, lo: [u32; 3], hi: [u32; 3]) -> u32 {
        surface::count(&self.surface_table, self.lattice.dims, lo, hi)
    }

    /// Where the list of each voxel begins in [`DomainGrid::entries`], by [`DomainGrid::voxel_index`]; one more at the end.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// The triangles of all voxels, one list after the other.
    pub fn entries(&self) -> &[u32] {
        &self.entries
    }

    /// [`DomainGrid::winding`] of all voxels.
    pub fn windings(&self) -> &[i32] {
        &self.windings
    }

    /// The summed-area table behind [`DomainGrid::surface_voxels`]: `dims() + 1` entries along each axis, x fastest, entry
    /// `(i, j, k)` counting the voxels below `i`, `j` and `k` that some triangle meets.
    pub fn surface_table(&self) -> &[u32] {
        &self.surface_table
    }

    /// [`DomainGrid::lowest_voxel`] of all triangles.
    pub fn lowest_voxels(&self) -> &[[u32; 3]] {
        &self.lowest_voxels
    }

    /// The domain's vertices, in the frame.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// The domain's triangles: corners, counterclockwise seen from outside, and the bits of how often it stands: by so much (`i32`) the winding number is
    /// larger behind it.
    pub fn triangles(&self) -> &[[u32; 4]] {
        &self.triangles
    }
}

/// Which triangles are where.
struct Lists {
    lowest_voxels: Vec<[u32; 3]>,
    offsets: Vec<u32>,
    entries: Vec<u32>,
}

impl Lists {
    fn new(vertices: &[[f64; 3]], triangles: &[[u32; 3]], lattice: &Lattice) -> Self {
        let ranges: Vec<_> = triangles.iter().map(|t| box_of_triangle(vertices, t, lattice)).collect();
        // Two places ahead the lengths of the lists, then one place ahead where the next entry of each goes: in the end where they begin.
        let mut offsets = vec![0_u32; lattice.voxels() + 2];
        for &(lo, hi) in &ranges {
            each_voxel(lo, hi, |voxel| offsets[lattice.voxel_index(voxel) + 2] += 1);
        }
        surface::sum_up(&mut offsets);
        let mut entries = vec![0; offsets[lattice.voxels() + 1] as usize];
        for (t, &(lo, hi)) in (0_u32..).zip(&ranges) {
            each_voxel(lo, hi, |voxel| {
                let slot = &mut offsets[lattice.voxel_index(voxel) + 1];
                entries[*slot as usize] = t;
                *slot += 1;
            });
        }
        offsets.truncate(lattice.voxels() + 1);
        Self { lowest_voxels: ranges.into_iter().map(|(lo, _)| lo).collect(), offsets, entries }
    }
}

/// The fractions by which the grid is shifted at an attempt: Roberts's sequence, which fills the cube evenly and never
/// repeats; `g⁴ = g + 1`.
fn shift(attempt: u32) -> [f64; 3] {
    const G: f64 = 1.220_744_084_605_759_5;
    [1, 2, 3].map(|k| (0.5 + f64::from(attempt + 1) * G.powi(-k)).fract())
}

/// The inclusive range of half-open voxels that the bounding box of a triangle meets.
fn box_of_triangle(vertices: &[[f64; 3]], triangle: &[u32; 3], lattice: &Lattice) -> ([u32; 3], [u32; 3]) {
    let [a, b, c] = triangle.map(|i| vertices[i as usize]);
    let lo = [0, 1, 2].map(|k| lattice.voxel_of(k, a[k].min(b[k]).min(c[k])));
    let hi = [0, 1, 2].map(|k| lattice.voxel_of(k, a[k].max(b[k]).max(c[k])));
    (lo, hi)
}

fn volume_of_range((lo, hi): ([u32; 3], [u32; 3])) -> usize {
    (0..3).map(|k| (hi[k] - lo[k] + 1) as usize).product()
}

fn each_voxel(lo: [u32; 3], hi: [u32; 3], mut f: impl FnMut([u32; 3])) {
    for k in lo[2]..=hi[2] {
        for j in lo[1]..=hi[1] {
            for i in lo[0]..=hi[0] {
                f([i, j, k]);
            }
        }
    }
}

#[cfg(test)]
mod tests;
