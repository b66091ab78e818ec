//! What a loop asks of an evaluation: a few sums over the cells.

use crate::summation::{Sum, chunks};
use crate::{CellStatus, Output, PowerDiagram};

/// Sums over the cells of a diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Totals {
    /// Cells that are not empty.
    pub cells: usize,
    /// Of all sites those whose cells are.
    pub empty: usize,
    /// Cells that are not certified.
    pub uncertified: usize,
    /// `Σ V_i` (length³).
    pub volume: f64,
    /// `Σ |V_i|` (length³).
    pub size: f64,
    /// Standard deviation of the volumes of all cells over their mean.
    pub spread: f64,
    /// `Σ ∫ (‖x − p_i‖² − w_i) dx` (length⁵); NaN where second moments are not asked for.
    pub energy: f64,
    /// `√(Σ |V_i| ‖p_i − b_i‖² / Σ |V_i|)` (length), how far sites are from the barycenters of their cells.
    pub displacement: f64,
}

impl Totals {
    /// The numbers of cells and what they sum to, in the order of the fields. For backends.
    #[doc(hidden)]
    pub fn new(
        [cells, empty, uncertified]: [usize; 3],
        [volume, size, spread, energy, displacement]: [f64; 5],
    ) -> Self {
        Self { cells, empty, uncertified, volume, size, spread, energy, displacement }
    }

    /// Of lengths in some `unit`, and masses of some density: in the caller's. For backends.
    #[doc(hidden)]
    #[must_use]
    pub fn in_units(self, density: f64, unit: f64) -> Self {
        let (volume, energy) = (density * unit.powi(3), density * unit.powi(5));
        Self {
            volume: self.volume * volume,
            size: self.size * volume,
            energy: self.energy * energy,
            displacement: self.displacement * unit,
            ..self
        }
    }

    /// Of a diagram from what came of its evaluation, compensated, on all threads.
    pub fn of(diagram: &PowerDiagram, output: &Output) -> Self {
        let (positions, weights, volumes) = (diagram.positions(), diagram.weights(), output.volume());
        let second = output.second_moment();
        // (Products of volumes and squares of tiny lengths may be below all numbers.)
        let largest = chunks(volumes.len(), |range| volumes[range].iter().fold(0.0, |a: f64, v| a.max(v.abs())));
        let largest = largest.into_iter().fold(0.0, f64::max);
        let parts = chunks(volumes.len(), |range| {
            let (mut cells, mut uncertified, mut part) = (0, 0, [Sum::default(); 4]);
            let [volume, negative, energy, displacement] = &mut part;
            for i in range.filter(|&i| output.status()[i] != CellStatus::Empty) {
                let (v, p, b) = (volumes[i], positions[i], output.barycenter()[i]);
                let off: f64 = (0..3).map(|k| (p[k] - b[k]) * (p[k] - b[k])).sum();
                cells += 1;
                uncertified += usize::from(output.status()[i] == CellStatus::Uncertified);
                volume.add(v);
                if v < 0.0 {
                    negative.add(v);
                }
                if let Some([xx, yy, zz, ..]) = second.map(|second| second[i]) {
                    let weight = weights.get(i).copied().unwrap_or(0.0);
                    energy.add((xx + yy + zz) + v * (off - weight));
                }
                displacement.add(v.abs() / largest * off);
            }
            (cells, uncertified, part)
        });
        let (mut cells, mut uncertified, mut all) = (0, 0, [Sum::default(); 4]);
        for (more, unsure, part) in parts {
            cells += more;
            uncertified += unsure;
            all.iter_mut().zip(part).for_each(|(sum, part)| sum.join(part));
        }
        let [volume, negative, energy, displacement] = all.map(|sum| sum.total());
        let size = volume - 2.0 * negative;
        Self {
            cells,
            empty: volumes.len() - cells,
            uncertified,
            volume,
            size,
            spread: relative_deviation(volumes),
            energy: if second.is_some() { energy } else { f64::NAN },
            displacement: (displacement / (size / largest)).sqrt(),
        }
    }
}

/// Standard deviation over mean. Two passes, so that plain sums suffice for a figure that is compared with a tenth, and nothing overflows.
pub fn relative_deviation(volumes: &[f64]) -> f64 {
    let n = volumes.len() as f64;
    let sum = |term: &(dyn Fn(f64) -> f64 + Sync)| -> f64 {
        chunks(volumes.len(), |range| volumes[range].iter().map(|&v| term(v)).sum::<f64>()).iter().sum()
    };
    let mean = sum(&|v| v) / n;
    (sum(&|v| (v / mean - 1.0).powi(2)) / n).sqrt()
}
