//! A diagram that is evaluated again and again while its sites move, and what a loop asks of it each time: a few numbers.

use rayon::prelude::*;

use crate::summation::{Sum, chunks};
use crate::{Backend, CellStatus, Output, PowerDiagram, Request, Result};

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
    /// `Σ |V_i| ‖p_i − b_i‖²` (length⁵), how far sites are from the barycenters of their cells.
    pub displacement: f64,
}

impl Totals {
    /// Of a diagram from what came of its evaluation, compensated, on all threads.
    pub fn of(diagram: &PowerDiagram, output: &Output) -> Self {
        let (positions, weights, volumes) = (diagram.positions(), diagram.weights(), output.volume());
        let second = output.second_moment();
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
                displacement.add(v.abs() * off);
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
        Self {
            cells,
            empty: volumes.len() - cells,
            uncertified,
            volume,
            size: volume - 2.0 * negative,
            spread: relative_deviation(volumes),
            energy: if second.is_some() { energy } else { f64::NAN },
            displacement,
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

/// What is known of the sites as they stand.
struct Evaluated {
    totals: Totals,
    output: Output,
}

/// The sites before they moved, with their weights where those changed too.
struct Before {
    positions: Vec<[f64; 3]>,
    weights: Option<Vec<f64>>,
    evaluated: Option<Evaluated>,
}

/// A diagram and a backend that evaluates it again and again: the sites are moved, by the caller or each to the barycenter of its cell, and evaluated where
/// they then are. A move that turns out badly, or whose evaluation fails, is undone by [`Session::step_back`].
pub struct Session<'a> {
    backend: &'a dyn Backend,
    diagram: &'a mut PowerDiagram,
    request: Request,
    here: Option<Evaluated>,
    before: Option<Before>,
}

impl<'a> Session<'a> {
    /// Of a diagram, for evaluations by `request`. A diagram without a domain or box keeps the bounding box that its sites have now.
    ///
    /// # Errors
    /// As [`PowerDiagram::container`].
    pub fn new(backend: &'a dyn Backend, diagram: &'a mut PowerDiagram, request: Request) -> Result<Self> {
        diagram.keep_container()?;
        Ok(Self { backend, diagram, request, here: None, before: None })
    }

    /// Evaluates the cells of the sites where they are, unless that is done.
    ///
    /// # Errors
    /// As [`Backend::evaluate`]; [`Session::step_back`] then leads to where all was well.
    pub fn evaluate(&mut self) -> Result<Totals> {
        let here = self.take()?;
        Ok(self.here.insert(here).totals)
    }

    /// What is known of the sites here, which then has to be put back.
    fn take(&mut self) -> Result<Evaluated> {
        match self.here.take() {
            Some(here) => Ok(here),
            None => {
                let output = self.backend.evaluate(self.diagram, &self.request)?;
                Ok(Evaluated { totals: Totals::of(self.diagram, &output), output })
            }
        }
    }

    /// Puts the sites elsewhere, with other weights where they are given.
    ///
    /// # Errors
    /// As [`PowerDiagram::set_sites`]; nothing is changed then.
    pub fn set_sites(&mut self, mut positions: Vec<[f64; 3]>, mut weights: Option<Vec<f64>>) -> Result<()> {
        self.diagram.exchange_sites(&mut positions, weights.as_mut())?;
        self.before = Some(Before { positions, weights, evaluated: self.here.take() });
        Ok(())
    }

    /// Moves each site to the barycenter of its cell; it stays where that is empty.
    ///
    /// # Errors
    /// As [`Session::evaluate`], where that was not done, and [`PowerDiagram::set_sites`].
    pub fn move_to_barycenters(&mut self) -> Result<()> {
        self.move_to_barycenters_in(&|_| true)
    }

    /// The same of those alone whose barycenter `accept` accepts; others stay too.
    ///
    /// # Errors
    /// As [`Session::move_to_barycenters`].
    pub fn move_to_barycenters_in(&mut self, accept: &(dyn Fn([f64; 3]) -> bool + Sync)) -> Result<()> {
        let (diagram, output) = self.read()?;
        let sites = diagram.positions().par_iter().zip(output.barycenter()).zip(output.status());
        let moved =
            sites.map(|((&old, &new), &status)| if status != CellStatus::Empty && accept(new) { new } else { old });
        let moved = moved.collect();
        self.set_sites(moved, None)
    }

    /// The sites are where they were before the last move, as if that had not been.
    pub fn step_back(&mut self) {
        if let Some(Before { mut positions, mut weights, evaluated }) = self.before.take() {
            // (They were accepted before.)
            let _ = self.diagram.exchange_sites(&mut positions, weights.as_mut());
            self.here = evaluated;
        }
    }

    /// The diagram as it is now, and what came of its evaluation, all of it.
    ///
    /// # Errors
    /// As [`Session::evaluate`], where that was not done.
    pub fn read(&mut self) -> Result<(&PowerDiagram, &Output)> {
        let here = self.take()?;
        Ok((self.diagram, &self.here.insert(here).output))
    }

    /// What came of the evaluation, at the end.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub fn finish(mut self) -> Result<Output> {
        Ok(self.take()?.output)
    }
}
