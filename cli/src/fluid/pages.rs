//! The page of a fluid: its cells at the times of the frames.

use std::path::{Path, PathBuf};

use laguerre::solvers::fluid::{Fluid, Scene, State};
use laguerre::{Backend, Result};

use super::report::Report;
use crate::page::{self, Moment, Page, Timeline};
use crate::report::grouped;

/// What the page will show.
pub(super) struct Pages {
    path: Option<PathBuf>,
    scene: Scene,
    timeline: Timeline,
    first: u64,
    last: Option<u64>,
}

impl Pages {
    /// Of a motion that begins, or goes on, with `fluid` as it is; nothing where there is no path.
    pub(super) fn new(path: Option<&Path>, scene: Scene, fluid: &Fluid) -> Self {
        let State { steps, positions, .. } = fluid.state();
        Self {
            path: path.map(Path::to_path_buf),
            scene,
            timeline: Timeline::new(positions.len()),
            first: *steps,
            last: None,
        }
    }

    /// The fluid as it is now.
    pub(super) fn add(&mut self, fluid: &Fluid) {
        let State { steps, time, velocities, densities, .. } = fluid.state();
        if self.path.is_none() || self.last == Some(*steps) {
            return;
        }
        self.last = Some(*steps);
        let speeds = velocities.iter().map(|v| v[0].hypot(v[1]).hypot(v[2])).collect();
        self.timeline.add(|| {
            Some(Moment {
                label: format!("step {steps}, time {time:.4}"),
                row: (steps - self.first) as usize,
                positions: fluid.diagram().positions().to_vec(),
                weights: fluid.diagram().weights().to_vec(),
                values: vec![speeds, densities.clone()],
            })
        });
    }

    /// Writes the page, with the fluid as it is at the end.
    ///
    /// # Errors
    /// As [`page::write_run`].
    pub(super) fn finish(mut self, fluid: &Fluid, backend: &dyn Backend, report: &Report) -> Result<()> {
        self.add(fluid);
        let Some(path) = self.path else { return Ok(()) };
        let (moments, shown) = self.timeline.finish("frames");
        let page = Page {
            title: format!("{}, a fluid of {} cells", self.scene.name(), grouped(fluid.state().positions.len() as u64)),
            facts: report.facts(),
            shown,
            plot: report.plot(),
            fields: vec![("speed", "length/time"), ("density", "")],
            first_field: Some(if self.scene.has_two_densities() { "density" } else { "speed" }),
        };
        page::write_run(&path, &page, backend, fluid.diagram(), &moments)
    }
}
