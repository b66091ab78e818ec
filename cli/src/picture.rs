//! A picture of a diagram: a slice through the domain, each cell in a colour of its own.

use std::path::Path;

use kd_tree::KdMap;
use laguerre::{Domain, Error, Facets, Output, PowerDiagram, Result, io};
use rayon::prelude::*;
use tiny_skia::{Color, FillRule, LineJoin, Mask, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform};

use crate::slice::{SlicePlane, dot};

/// Sites that are compared at a pixel: those on whose borders it may lie, and some to spare.
const NEAREST: usize = 8;
/// Half the width of a cell's border, in pixels, and how dark it is at its middle.
const BORDER: f64 = 0.9;
const BORDER_DARKNESS: f64 = 0.62;
/// Width of the domain's outline, in pixels.
const OUTLINE: f32 = 5.0;
const INK: [u8; 3] = [0x23, 0x2b, 0x3b];
/// Empty space about the picture, as a share of its width.
const MARGIN: f64 = 0.025;
/// Bright colours of similar weight, that black lines stand out on.
const PALETTE: [[u8; 3]; 12] = [
    [0x8e, 0xca, 0xe6],
    [0xff, 0xd1, 0x66],
    [0xf2, 0x8f, 0x79],
    [0x9b, 0xd0, 0xa3],
    [0xc9, 0xb3, 0xe0],
    [0xf7, 0xb2, 0x67],
    [0x6f, 0xb3, 0xc8],
    [0xd9, 0xe2, 0x8b],
    [0xf4, 0xa9, 0xc0],
    [0xa3, 0xb8, 0xe8],
    [0xe8, 0xd3, 0xb0],
    [0x7f, 0xc8, 0xb6],
];

/// Draws where `plane` cuts the domain of `diagram` into a PNG of the given width in pixels.
///
/// # Errors
/// `Input` where there is no domain or the plane misses it; `Io` where writing failed.
pub(crate) fn draw(path: &Path, diagram: &PowerDiagram, output: &Output, plane: &SlicePlane, width: u32) -> Result<()> {
    let domain = diagram.domain().ok_or_else(|| Error::input("a picture needs a domain"))?;
    let colors = palette_indices(diagram.positions().len(), output.facets());
    let colors: Vec<[u8; 3]> = colors.into_iter().map(|c| PALETTE[usize::from(c)]).collect();
    save(path, &paint(domain, diagram, &colors, plane, width)?)
}

/// The cells of `diagram`, each in its colour, where `plane` cuts a domain; the given width in pixels.
///
/// # Errors
/// `Input` where the plane misses the domain, or the picture is too large.
pub(crate) fn paint(
    domain: &Domain,
    diagram: &PowerDiagram,
    colors: &[[u8; 3]],
    plane: &SlicePlane,
    width: u32,
) -> Result<Pixmap> {
    let view =
        View::of(domain, plane, width).ok_or_else(|| Error::input("the plane of the picture misses the domain"))?;
    view.paint(diagram, colors).ok_or_else(|| Error::input("the picture is too large"))
}

/// Writes a picture as PNG.
///
/// # Errors
/// `Io` where writing failed.
pub(crate) fn save(path: &Path, picture: &Pixmap) -> Result<()> {
    let png = picture.encode_png().map_err(|e| Error::input(format!("{}: cannot encode: {e}", path.display())))?;
    io::write_whole(path, |w| w.write_all(&png))
}

/// The slice on its way to pixels: `scale` pixels a unit of length, `corner` the plane's coordinates of the upper left corner.
struct View {
    plane: SlicePlane,
    curves: Vec<Vec<[f64; 2]>>,
    corner: [f64; 2],
    scale: f64,
    width: u32,
    height: u32,
}

impl View {
    fn of(domain: &Domain, plane: &SlicePlane, width: u32) -> Option<Self> {
        let curves = plane.curves(domain);
        let mut lo = [f64::INFINITY; 2];
        let mut hi = [f64::NEG_INFINITY; 2];
        for p in curves.iter().flatten() {
            for k in 0..2 {
                (lo[k], hi[k]) = (lo[k].min(p[k]), hi[k].max(p[k]));
            }
        }
        let margin = MARGIN * f64::from(width);
        let scale = (f64::from(width) - 2.0 * margin) / (hi[0] - lo[0]);
        let height = ((hi[1] - lo[1]) * scale + 2.0 * margin).ceil();
        let drawable = scale.is_finite() && scale > 0.0 && height < 20.0 * f64::from(width);
        let corner = [lo[0] - margin / scale, hi[1] + margin / scale];
        drawable.then_some(Self { plane: *plane, curves, corner, scale, width, height: height as u32 })
    }

    fn paint(&self, diagram: &PowerDiagram, colors: &[[u8; 3]]) -> Option<Pixmap> {
        let outline = self.outline()?;
        let mut mask = Mask::new(self.width, self.height)?;
        // Winding, as in the integrals: shells that overlap are all inside.
        mask.fill_path(&outline, FillRule::Winding, true, Transform::identity());
        let mut picture = Pixmap::new(self.width, self.height)?;
        picture.fill(Color::WHITE);

        let cells = Cells::new(diagram, colors);
        let width = self.width as usize;
        let rows = picture.pixels_mut().par_chunks_mut(width).zip(mask.data().par_chunks(width)).enumerate();
        rows.for_each(|(y, (pixels, mask))| {
            for (x, (pixel, &coverage)) in pixels.iter_mut().zip(mask).enumerate() {
                if coverage > 0 {
                    let at = [x as f64 + 0.5, y as f64 + 0.5];
                    let [r, g, b] = mixed([255; 3], cells.color(self, at), f64::from(coverage) / 255.0);
                    if let Some(color) = PremultipliedColorU8::from_rgba(r, g, b, 255) {
                        *pixel = color;
                    }
                }
            }
        });

        let mut ink = Paint { anti_alias: true, ..Paint::default() };
        ink.set_color_rgba8(INK[0], INK[1], INK[2], 255);
        let stroke = Stroke { width: OUTLINE, line_join: LineJoin::Round, ..Stroke::default() };
        picture.stroke_path(&outline, &ink, &stroke, Transform::identity(), None);
        Some(picture)
    }

    /// The curves in pixels.
    fn outline(&self) -> Option<tiny_skia::Path> {
        let mut path = PathBuilder::new();
        for curve in &self.curves {
            for (i, p) in curve.iter().enumerate() {
                let x = ((p[0] - self.corner[0]) * self.scale) as f32;
                let y = ((self.corner[1] - p[1]) * self.scale) as f32;
                if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
            }
            path.close();
        }
        path.finish()
    }
}

/// Who owns a point, and in which colour.
struct Cells<'a> {
    diagram: &'a PowerDiagram,
    /// Sites lifted to the height `√(W − w)`, `W` the largest weight: squared distances to points at height 0 are then power
    /// distances plus `W`.
    tree: KdMap<[f64; 4], u32>,
    /// The colour of each site's cell.
    colors: &'a [[u8; 3]],
}

impl<'a> Cells<'a> {
    fn new(diagram: &'a PowerDiagram, colors: &'a [[u8; 3]]) -> Self {
        let weights = diagram.weights();
        let largest = weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let lift = |i: usize| weights.get(i).map_or(0.0, |w| (largest - w).sqrt());
        let sites = diagram.positions().iter().enumerate();
        let lifted = sites.map(|(i, &[x, y, z])| ([x, y, z, lift(i)], i as u32)).collect();
        Self { diagram, tree: KdMap::build_by_ordered_float(lifted), colors }
    }

    /// The colour at a pixel: its cell's, darker within a border's half-width of the nearest border in the plane. The distance to
    /// a border is known exactly, which smooths the lines better than any number of samples would.
    fn color(&self, view: &View, [x, y]: [f64; 2]) -> [u8; 3] {
        let [a, b] = [view.corner[0] + x / view.scale, view.corner[1] - y / view.scale];
        let [px, py, pz] = view.plane.point([a, b]);
        let found = self.tree.nearests(&[px, py, pz, 0.0], NEAREST);
        let Some(owner) = found.first() else { return [255; 3] };
        let (p, at) = (self.diagram.positions()[owner.item.1 as usize], owner.squared_distance);
        let border = found[1..]
            .iter()
            .map(|other| {
                let q = self.diagram.positions()[other.item.1 as usize];
                let apart: [f64; 3] = std::array::from_fn(|k| q[k] - p[k]);
                // The power distances differ by this much a unit of length in the plane, twice.
                let slope = dot(apart, view.plane.u).hypot(dot(apart, view.plane.v));
                (other.squared_distance - at) / (2.0 * slope)
            })
            .fold(f64::INFINITY, f64::min);
        let line = (BORDER + 0.5 - border * view.scale).clamp(0.0, 1.0);
        mixed(self.colors[owner.item.1 as usize], INK, BORDER_DARKNESS * line)
    }
}

/// A colour for each cell that no neighbour of lower index has, from a start that its index alone decides; where neighbours are not
/// known or have all colours, that start.
fn palette_indices(sites: usize, facets: Option<&Facets>) -> Vec<u8> {
    let mut colors: Vec<u8> = Vec::with_capacity(sites);
    for i in 0..sites {
        // Fibonacci hashing: consecutive indices land far apart.
        let start = ((i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize;
        let mut taken = [false; PALETTE.len()];
        if let Some(facets) = facets {
            for facet in facets.of(i) {
                if let Some(&color) = colors.get(facet.neighbor) {
                    taken[usize::from(color)] = true;
                }
            }
        }
        let tries = (0..PALETTE.len()).map(|k| (start + k) % PALETTE.len());
        let color = tries.clone().find(|&c| !taken[c]).unwrap_or(start % PALETTE.len());
        colors.push(color as u8);
    }
    colors
}

/// `share` of `over` on the rest of `under`.
pub(crate) fn mixed(under: [u8; 3], over: [u8; 3], share: f64) -> [u8; 3] {
    std::array::from_fn(|k| (f64::from(under[k]) * (1.0 - share) + f64::from(over[k]) * share).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use laguerre::{Boundary, FacetArrays};

    #[test]
    fn neighbours_differ_in_colour() {
        // A ring of cells, each the neighbour of the next two.
        let n = 50;
        let mut facets = FacetArrays::default();
        facets.offsets.push(0);
        for i in 0..n {
            let mut row = [1, 2, n - 2, n - 1].map(|d| (i + d) % n);
            row.sort_unstable();
            facets.neighbor.extend(row);
            facets.offsets.push(facets.neighbor.len());
        }
        let count = facets.neighbor.len();
        (facets.area, facets.barycenter, facets.distance) = (vec![1.0; count], vec![[0.0; 3]; count], vec![1.0; count]);
        facets.boundary = vec![Boundary::default(); n as usize];
        let facets = Facets::new(facets).unwrap();
        let colors = palette_indices(n as usize, Some(&facets));
        assert!(
            (0..n as usize)
                .all(|i| colors[i] != colors[(i + 1) % n as usize] && colors[i] != colors[(i + 2) % n as usize])
        );
        assert!(palette_indices(100, None).iter().any(|&c| c != 0));
    }
}
