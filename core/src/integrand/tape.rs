//! A function that is called with many places at once.
//!
//! The cell asks for it place by place (`cell/quadrature.rs`), in an order that follows from the cell alone. So a batch of cells is integrated twice: first
//! all that is asked for is noted, then the function is called, and the same cells take its answers in the same order. That costs the search and
//! the clipping once more, a few microseconds a cell, where a call of Python for each of its hundreds of places would cost as many
//! microseconds each; and nothing of the integration is written a second time.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{FramedIntegrand, rule};
use crate::cell::V3;
use crate::frame::Frame;
use crate::{Error, Result};

/// A function of the caller's, of many places at once: the values at the first, then at the second and so on.
pub type Batch = Arc<dyn Fn(&[[f64; 3]]) -> Result<Vec<f64>> + Send + Sync>;

/// Places that a batch of cells asks for at most where each has some fifty tetrahedra: some megabytes, and the overhead of a call is nothing.
const MOST_PLACES: usize = 100_000;
const TETRAHEDRA: usize = 50;

/// How many cells are to be a batch by a rule of so many nodes.
pub(super) fn cells_at_once(degree: u32) -> usize {
    (MOST_PLACES / (TETRAHEDRA * rule(degree).len())).max(1)
}

/// What a batch of cells asks of a function, and what they take.
#[derive(Default)]
struct Notes {
    places: Vec<[f64; 3]>,
    /// None while the places are noted.
    values: Option<Vec<f64>>,
    columns: usize,
    column: usize,
    next: usize,
}

/// The function of one batch of cells.
pub struct Tape {
    function: Batch,
    columns: usize,
    notes: Arc<Mutex<Notes>>,
}

impl Tape {
    /// The integrand of the cells of a batch, and who calls the function for them.
    pub(super) fn new(function: &Batch, columns: usize, degree: u32, frame: &Frame) -> (FramedIntegrand, Self) {
        let notes = Arc::new(Mutex::new(Notes { columns, ..Notes::default() }));
        let (taken, frame) = (Arc::clone(&notes), *frame);
        let value = move |x: V3| locked(&taken).value(frame.leave([x.x, x.y, x.z]));
        (FramedIntegrand::of_function(degree, Box::new(value)), Self { function: Arc::clone(function), columns, notes })
    }

    /// Calls the function with all places that were asked for.
    ///
    /// # Errors
    /// The function's own; `Input` where it has not as many values as it should.
    pub fn call(&self) -> Result<()> {
        let places = std::mem::take(&mut locked(&self.notes).places);
        let values = if places.is_empty() { Vec::new() } else { (self.function)(&places)? };
        check_values(&values, places.len(), self.columns)?;
        let mut notes = locked(&self.notes);
        (notes.places, notes.values) = (places, Some(values));
        Ok(())
    }

    /// The cells are integrated from the first on, and take some column of the values.
    pub fn turn_to(&self, column: usize) {
        let mut notes = locked(&self.notes);
        (notes.column, notes.next) = (column, 0);
    }
}

impl Notes {
    /// The function at `place`, once it has been called; what is asked for in another order is not a number.
    fn value(&mut self, place: [f64; 3]) -> f64 {
        let Some(values) = &self.values else {
            self.places.push(place);
            return 0.0;
        };
        let number = self.next;
        self.next += 1;
        if self.places.get(number) == Some(&place) { values[number * self.columns + self.column] } else { f64::NAN }
    }
}

/// Checks that there is a value for each place and column.
pub(super) fn check_values(values: &[f64], places: usize, columns: usize) -> Result<()> {
    if values.len() != places * columns {
        let message = format!("integrand: {} values for {places} points, {columns} for each are needed", values.len());
        return Err(Error::input(message));
    }
    Ok(())
}

fn locked(notes: &Mutex<Notes>) -> MutexGuard<'_, Notes> {
    notes.lock().unwrap_or_else(PoisonError::into_inner)
}
