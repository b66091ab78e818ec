//! The states of a run that a page shows over time: so many that the file stays of a size that a browser opens at once.

use std::sync::{Mutex, PoisonError};

use laguerre::algebra::Algebra;
use laguerre::{Backend, BackendInfo, Observer, Output, PowerDiagram, Request, Result};

/// Cells of all states together, and states: 170 to 280 bytes of the file a cell, so that it has 50 MB at most.
const MOST_CELLS: usize = 200_000;
const MOST_MOMENTS: usize = 100;

/// A state of a run.
#[derive(Clone, Debug)]
pub struct Moment {
    /// What it is called.
    pub label: String,
    /// Its row of the plot.
    pub row: usize,
    /// Its sites.
    pub positions: Vec<[f64; 3]>,
    /// Their weights; none where all are equal.
    pub weights: Vec<f64>,
    /// Numbers of each site, for the fields of the page beside volume and weight.
    pub values: Vec<Vec<f64>>,
}

/// States of a run, evenly spread over it: every one, or where those are too many every second, every fourth and so on; and the last.
#[derive(Debug)]
pub struct Timeline {
    most: usize,
    stride: usize,
    seen: usize,
    kept: Vec<(usize, Moment)>,
    last: Option<(usize, Moment)>,
}

impl Timeline {
    /// Of diagrams of so many sites.
    pub fn new(sites: usize) -> Self {
        let most = (MOST_CELLS / sites.max(1)).clamp(2, MOST_MOMENTS);
        Self { most, stride: 1, seen: 0, kept: Vec::new(), last: None }
    }

    /// One more state, if there is one.
    pub fn add(&mut self, moment: impl FnOnce() -> Option<Moment>) {
        let Some(moment) = moment() else { return };
        let number = self.seen;
        self.seen += 1;
        if !number.is_multiple_of(self.stride) {
            self.last = Some((number, moment));
            return;
        }
        self.last = None;
        self.kept.push((number, moment));
        // Room for the last.
        if self.kept.len() >= self.most {
            self.stride *= 2;
            let newest = self.kept.last().cloned();
            self.kept.retain(|(number, _)| number.is_multiple_of(self.stride));
            self.last = newest.filter(|(number, _)| !number.is_multiple_of(self.stride));
        }
    }

    /// The states, and in words which they are of how many.
    pub fn finish(self, what: &str) -> (Vec<Moment>, String) {
        let Self { stride, seen, kept, last, .. } = self;
        let moments: Vec<Moment> = kept.into_iter().chain(last).map(|(_, moment)| moment).collect();
        let shown = match stride {
            1 => format!("all {seen} {what}"),
            _ => format!(
                "{} of {seen} {what}: one in {stride}, and the last, so that the file stays small",
                moments.len()
            ),
        };
        (moments, shown)
    }
}

/// A backend that remembers the last diagram of all sites that it was asked for: a solver ends each iteration with that. (So no sites stay with the backend.)
pub struct Remembering<'a> {
    backend: &'a dyn Backend,
    sites: usize,
    last: Mutex<Option<PowerDiagram>>,
}

impl<'a> Remembering<'a> {
    /// Where to compute, and how many all sites are.
    pub fn new(backend: &'a dyn Backend, sites: usize) -> Self {
        Self { backend, sites, last: Mutex::new(None) }
    }

    /// That diagram's state.
    pub fn moment(&self, label: String, row: usize) -> Option<Moment> {
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let diagram = last.as_ref()?;
        let (positions, weights) = (diagram.positions().to_vec(), diagram.weights().to_vec());
        Some(Moment { label, row, positions, weights, values: Vec::new() })
    }
}

impl Backend for Remembering<'_> {
    fn info(&self) -> BackendInfo {
        self.backend.info()
    }

    fn algebra(&self) -> Option<&dyn Algebra> {
        self.backend.algebra()
    }

    fn evaluate_watched(&self, diagram: &PowerDiagram, request: &Request, observer: &dyn Observer) -> Result<Output> {
        let output = self.backend.evaluate_watched(diagram, request, observer)?;
        // Coarser ones, for first weights, have fewer.
        if diagram.positions().len() == self.sites {
            *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(diagram.clone());
        }
        Ok(output)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(row: usize) -> Option<Moment> {
        Some(Moment { label: String::new(), row, positions: Vec::new(), weights: Vec::new(), values: Vec::new() })
    }

    #[test]
    fn states_are_evenly_spread_with_the_first_and_the_last() {
        for sites in [1, 3000, 10_000, 60_000, 100_000, 1_000_000] {
            for seen in 1..260 {
                let mut timeline = Timeline::new(sites);
                let most = timeline.most;
                (0..seen).for_each(|row| timeline.add(|| moment(row)));
                let rows: Vec<usize> = timeline.finish("steps").0.iter().map(|moment| moment.row).collect();
                assert!(
                    rows.len() <= most && (rows[0], rows.last()) == (0, Some(&(seen - 1))),
                    "{sites} {seen}: {rows:?}"
                );
                let steps: Vec<usize> = rows.windows(2).map(|pair| pair[1] - pair[0]).collect();
                let (last, others) = steps.split_last().unwrap_or((&0, &[]));
                assert!(others.iter().all(|step| step == &others[0] && last <= step), "{sites} {seen}: {rows:?}");
                // No coarser than it must be.
                assert!(seen <= most.saturating_sub(1) || rows.len() > most / 2, "{sites} {seen}: {rows:?}");
            }
        }
    }

    #[test]
    fn what_is_shown_is_said() {
        let said = |seen: usize| {
            let mut timeline = Timeline::new(50_000);
            (0..seen).for_each(|row| timeline.add(|| moment(row)));
            timeline.finish("steps").1
        };
        assert_eq!(said(3), "all 3 steps");
        assert_eq!(said(6), "4 of 6 steps: one in 2, and the last, so that the file stays small");
    }
}
