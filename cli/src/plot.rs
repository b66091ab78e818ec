//! Histograms of what cells need, like the paper's Fig. 9: a panel for each count, a curve for each input.

use std::path::Path;

use laguerre::engine::capacities::{CellCounts, sufficient};
use laguerre::{Error, Result, io};
use plotters::prelude::*;

use crate::tune::{COUNTS, histogram};

/// Files that pictures are written to.
pub(crate) const ENDINGS: &[&str] = &[".svg"];

const SIZE: (u32, u32) = (1200, 860);
const FONT: &str = "sans-serif";
/// Colours that are told apart by those who do not see them all (after Okabe and Ito).
const COLORS: [RGBColor; 5] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0x66, 0x66, 0x66),
    RGBColor(0xcc, 0x79, 0xa7),
];
/// The share of the cells that a panel shows: the tail would leave no room for the rest.
const SHOWN: f64 = 0.998;
/// Height of the tick below a curve at the proposed capacity, as a share of the panel's.
const TICK: f64 = 0.08;

/// The counts of one input.
pub(crate) struct Curve {
    pub(crate) name: String,
    /// Index of its colour.
    pub(crate) color: usize,
    pub(crate) dashed: bool,
    pub(crate) counts: Vec<CellCounts>,
}

/// Draws the curves, with a tick where `share` of the cells have enough.
///
/// # Errors
/// `Io` where the file cannot be written.
pub(crate) fn draw(path: &Path, curves: &[Curve], share: f64) -> Result<()> {
    let mut svg = String::new();
    paint(&mut svg, curves, share).map_err(|e| Error::input(format!("{}: cannot draw: {e}", path.display())))?;
    io::write_whole(path, |w| w.write_all(svg.as_bytes()))
}

type Drawn = std::result::Result<(), Box<dyn std::error::Error>>;

fn paint(svg: &mut String, curves: &[Curve], share: f64) -> Drawn {
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    for (index, panel) in area.split_evenly((2, 2)).iter().enumerate() {
        paint_panel(panel, index, curves, share)?;
    }
    area.present()?;
    Ok(())
}

fn paint_panel(
    panel: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    index: usize,
    curves: &[Curve],
    share: f64,
) -> Drawn {
    let (letter, meaning, count) = COUNTS[index];
    let axis = AXES[index];
    // Most cells are far from the surface and try no triangle: the others are what is of interest.
    let near_surface = letter == "T";
    let note = if near_surface { ", where any are" } else { "" };
    let counts: Vec<Vec<CellCounts>> = curves
        .iter()
        .map(|curve| curve.counts.iter().filter(|&cell| !near_surface || count(cell) > 0).copied().collect())
        .collect();
    let shares: Vec<Vec<(f64, f64)>> = counts.iter().map(|counts| shares(counts, count, axis)).collect();
    let at = |counts: &[CellCounts], share: f64| axis.place(axis.bin(count(&sufficient(counts, share))));
    let filled = || counts.iter().filter(|counts| !counts.is_empty());
    let most = filled().map(|counts| at(counts, SHOWN)).fold(f64::NEG_INFINITY, f64::max);
    let least = shares.iter().flatten().map(|point| point.0).fold(f64::INFINITY, f64::min);
    if least > most {
        // No cell tries any triangle: there is no domain.
        return Ok(());
    }
    let highest = 1.08 * shares.iter().flatten().map(|point| point.1).fold(1.0, f64::max);
    let margin = axis.place(1) - axis.place(0);
    let mut chart = ChartBuilder::on(panel)
        .caption(format!("{letter}: {meaning}{note}"), (FONT, 20))
        .margin(14)
        .x_label_area_size(30)
        .y_label_area_size(52)
        .build_cartesian_2d(least - margin..most + margin, 0.0..highest)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_label_formatter(&|&x| format!("{:.0}", axis.value(x)))
        .y_label_formatter(&|y| format!("{y:.0}"))
        .y_desc("% of the cells")
        .label_style((FONT, 14))
        .draw()?;
    for ((curve, points), counts) in curves.iter().zip(&shares).zip(&counts) {
        let color = COLORS[curve.color % COLORS.len()];
        let style = color.stroke_width(2);
        let points = points.iter().copied().filter(|point| point.0 <= most);
        let width = if curve.dashed { 1 } else { 3 };
        let legend = move |(x, y): (i32, i32)| PathElement::new([(x, y), (x + 22, y)], color.stroke_width(width));
        if curve.dashed {
            let series = DashedLineSeries::new(points, 6, 4, style);
            chart.draw_series(series)?.label(curve.name.clone()).legend(legend);
        } else {
            chart.draw_series(LineSeries::new(points, style))?.label(curve.name.clone()).legend(legend);
        }
        if !counts.is_empty() {
            let proposed = at(counts, share);
            chart.draw_series([PathElement::new([(proposed, 0.0), (proposed, TICK * highest)], style)])?;
        }
    }
    if index == 0 {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .label_font((FONT, 15))
            .background_style(WHITE.mix(0.8))
            .draw()?;
    }
    Ok(())
}

/// How the values of a count are put into bins, and those along an axis.
#[derive(Clone, Copy)]
enum Axis {
    /// So many values a bin.
    Even(u32),
    /// Each bin wider than the one before by a constant factor, so many of them to a doubling.
    Doubling(u32),
}

/// Of K, which differs most between inputs; P; V, which is even, as a simple polytope's vertices are; T.
const AXES: [Axis; 4] = [Axis::Doubling(4), Axis::Even(1), Axis::Even(2), Axis::Even(2)];

impl Axis {
    /// The bin of a value.
    fn bin(self, value: u32) -> u32 {
        match self {
            Self::Even(width) => value / width,
            Self::Doubling(bins) => (f64::from(value.max(1)).log2() * f64::from(bins)) as u32,
        }
    }

    /// Where a bin stands.
    fn place(self, bin: u32) -> f64 {
        match self {
            Self::Even(width) => f64::from(bin * width),
            Self::Doubling(bins) => f64::from(bin) / f64::from(bins),
        }
    }

    /// The value at a place.
    fn value(self, place: f64) -> f64 {
        match self {
            Self::Even(_) => place,
            Self::Doubling(_) => place.exp2(),
        }
    }
}

/// Each bin from the first to the last that is not empty: its place, and its share of the cells in percent.
fn shares(counts: &[CellCounts], count: fn(&CellCounts) -> u32, axis: Axis) -> Vec<(f64, f64)> {
    let values = histogram(counts, count);
    let (Some(&(lo, _)), Some(&(hi, _))) = (values.first(), values.last()) else { return Vec::new() };
    let first = axis.bin(lo);
    let mut cells = vec![0_usize; (axis.bin(hi) - first) as usize + 1];
    values.iter().for_each(|&(value, number)| cells[(axis.bin(value) - first) as usize] += number);
    let percent = |number: usize| 100.0 * number as f64 / counts.len() as f64;
    (first..).zip(cells).map(|(bin, number)| (axis.place(bin), percent(number))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_is_in_one_bin() {
        let counts: Vec<CellCounts> = (1..300).map(|n| CellCounts { neighbors: n, ..CellCounts::default() }).collect();
        for axis in AXES {
            let shares = shares(&counts, |cell| cell.neighbors, axis);
            let total: f64 = shares.iter().map(|share| share.1).sum();
            assert!((total - 100.0).abs() < 1e-9, "{total}");
            assert!(shares.windows(2).all(|pair| pair[0].0 < pair[1].0));
            assert!(
                counts.iter().all(|cell| axis.value(axis.place(axis.bin(cell.neighbors))) <= f64::from(cell.neighbors))
            );
        }
    }
}
