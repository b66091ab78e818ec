//! The outer loop of the scheduler (paper, Alg. 1), written once: capacities grow, failed cells alone are tried again.

use crate::output::{PassReport, Substep};
use std::time::Instant;

/// Room that a pass has for one cell: half-spaces `P` and vertices `V`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Capacities {
    /// Half-spaces.
    pub planes: u32,
    /// Vertices.
    pub vertices: u32,
}

impl Capacities {
    /// Room of a first pass: half-spaces and vertices of nearly every cell of random sites, with its four cone planes.
    pub const FIRST: Self = Self { planes: 64, vertices: 128 };

    /// The next pass has half as much room again (paper §1).
    #[must_use]
    pub fn grown(self) -> Self {
        let grow = |n: u32| n + n / 2;
        Self { planes: grow(self.planes), vertices: grow(self.vertices) }
    }

    /// The same for a host with so many cells left: room for a few costs little, and each pass computes them anew. (The cell of a heavy site among a million, of 11,000
    /// half-spaces, takes 0.19 s in three passes so, 0.29 in five with four times the room each. Of more than that a pass has four times as much: a million half-spaces would take 325 MB a thread.)
    #[must_use]
    pub fn grown_for(self, cells: usize) -> Self {
        let times = if self.planes <= SMALL_ROOM { 16 } else { 4 };
        let wider = Self { planes: self.planes.saturating_mul(times), vertices: self.vertices.saturating_mul(times) };
        if cells <= FEW_CELLS { wider } else { self.grown() }
    }
}

/// So many cells are few.
pub const FEW_CELLS: usize = 64;

/// Half-spaces of a room that is small.
const SMALL_ROOM: u32 = 1024;

/// Cells that a pass is to compute: a list of sorted sites, or what stands for one where they are on a device.
pub trait Cells {
    /// How many they are.
    fn count(&self) -> usize;
}

impl Cells for Vec<u32> {
    fn count(&self) -> usize {
        self.len()
    }
}

/// What one pass leaves behind.
#[derive(Clone, Debug, Default)]
pub struct PassOutcome<C = Vec<u32>> {
    /// The cells that did not fit, in order.
    pub failed: C,
    /// Most neighbours that one cell visited.
    pub neighbors: u32,
    /// Most triangles that one cell visited.
    pub triangles: u32,
    /// What a device's kernels took, all of the pass; 0 where there is none but the host.
    pub device_seconds: f64,
    /// The second substep (paper §1), where the backend parts the pass: cells near the surface.
    pub second: Substep,
}

/// Runs `pass` over `cells`, then over what failed with the capacities that `grow` makes of the last and of how many those are, until nothing fails.
///
/// # Errors
/// What `pass` returns.
pub fn run_passes<C: Cells, E>(
    first: Capacities,
    cells: C,
    grow: impl Fn(Capacities, usize) -> Capacities,
    mut pass: impl FnMut(Capacities, &C) -> Result<PassOutcome<C>, E>,
) -> Result<Vec<PassReport>, E> {
    let mut capacities = first;
    let mut cells = cells;
    let mut reports = Vec::new();
    while cells.count() > 0 {
        let begin = Instant::now();
        let outcome = pass(capacities, &cells)?;
        reports.push(PassReport {
            neighbors: outcome.neighbors,
            planes: capacities.planes,
            vertices: capacities.vertices,
            triangles: outcome.triangles,
            cells: cells.count(),
            failed: outcome.failed.count(),
            seconds: begin.elapsed().as_secs_f64(),
            device_seconds: outcome.device_seconds,
            second: outcome.second,
        });
        cells = outcome.failed;
        capacities = grow(capacities, cells.count());
    }
    Ok(reports)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn few_cells_get_much_more_room() {
        let room = |planes, vertices| Capacities { planes, vertices };
        assert_eq!(room(64, 128).grown_for(FEW_CELLS), room(1024, 2048));
        assert_eq!(room(4096, 8192).grown_for(FEW_CELLS), room(16384, 32768));
        assert_eq!(room(64, 128).grown_for(FEW_CELLS + 1), room(96, 192));
    }

    #[test]
    fn failed_cells_alone_come_again_with_more_room() {
        const WAIT: Duration = Duration::from_millis(2);
        let mut tried = Vec::new();
        let first = Capacities { planes: 10, vertices: 16 };
        let grow = |room: Capacities, _| room.grown();
        let reports = run_passes(first, vec![3, 5, 8, 9], grow, |room, cells: &Vec<u32>| {
            tried.push((room, cells.clone()));
            std::thread::sleep(WAIT);
            let failed = cells.iter().copied().filter(|&cell| cell > room.planes / 2).collect();
            let second = Substep { cells: 1, seconds: 0.25 };
            Ok::<_, ()>(PassOutcome {
                failed,
                neighbors: room.planes,
                device_seconds: 0.5,
                second,
                ..PassOutcome::default()
            })
        });
        let reports = reports.unwrap();
        let room = |planes, vertices| Capacities { planes, vertices };
        assert_eq!(tried, [(room(10, 16), vec![3, 5, 8, 9]), (room(15, 24), vec![8, 9]), (room(22, 36), vec![8, 9])]);
        assert_eq!(reports.iter().map(|pass| (pass.cells, pass.failed)).collect::<Vec<_>>(), [(4, 2), (2, 2), (2, 0)]);
        assert!(reports.iter().all(|pass| pass.seconds >= WAIT.as_secs_f64() && pass.device_seconds == 0.5));
        assert!(reports.iter().all(|pass| pass.second == Substep { cells: 1, seconds: 0.25 }));
    }
}
