//! The outer loop of the scheduler (paper, Alg. 1), written once: capacities grow, failed cells alone are tried again.

use crate::output::PassReport;

/// Room that a pass has for one cell: half-spaces `P` and vertices `V`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacities {
    /// Half-spaces.
    pub planes: u32,
    /// Vertices.
    pub vertices: u32,
}

impl Capacities {
    /// The next pass has half as much room again (paper §1).
    fn grown(self) -> Self {
        let grow = |n: u32| n + n / 2;
        Self { planes: grow(self.planes), vertices: grow(self.vertices) }
    }
}

/// What one pass leaves behind.
#[derive(Clone, Debug, Default)]
pub struct PassOutcome {
    /// The cells that did not fit, in order.
    pub failed: Vec<u32>,
    /// Most neighbours that one cell visited.
    pub neighbors: u32,
    /// Most triangles that one cell visited.
    pub triangles: u32,
}

/// Runs `pass` over `cells`, then over what failed with grown capacities, until nothing fails.
///
/// # Errors
/// What `pass` returns.
pub fn run_passes<E>(
    first: Capacities,
    cells: Vec<u32>,
    mut pass: impl FnMut(Capacities, &[u32]) -> Result<PassOutcome, E>,
) -> Result<Vec<PassReport>, E> {
    let mut capacities = first;
    let mut cells = cells;
    let mut reports = Vec::new();
    while !cells.is_empty() {
        let outcome = pass(capacities, &cells)?;
        reports.push(PassReport {
            neighbors: outcome.neighbors,
            planes: capacities.planes,
            vertices: capacities.vertices,
            triangles: outcome.triangles,
            cells: cells.len(),
            failed: outcome.failed.len(),
        });
        cells = outcome.failed;
        capacities = capacities.grown();
    }
    Ok(reports)
}
