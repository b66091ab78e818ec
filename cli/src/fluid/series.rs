//! Which frame is of which time: `frames.pvd` beside the frames, for ParaView.

use std::fs;
use std::path::{Path, PathBuf};

use laguerre::{Result, io};

/// The frames of a folder that are `.vtu`, each with its step and its time.
pub(super) struct Series {
    path: PathBuf,
    frames: Vec<(u64, f64)>,
}

impl Series {
    /// A series in `folder`, empty, or where a motion goes on from step `resumed` with the frames up to it that the folder knows.
    pub(super) fn new(folder: &Path, resumed: Option<u64>) -> Self {
        let path = folder.join("frames.pvd");
        let known = resumed.and_then(|_| fs::read_to_string(&path).ok()).unwrap_or_default();
        let frames = known.lines().filter_map(parse).filter(|&(step, _)| resumed.is_some_and(|last| step <= last));
        Self { frames: frames.collect(), path }
    }

    /// The name of the frame of a step.
    pub(super) fn name(step: u64) -> String {
        format!("frame-{step:06}.vtu")
    }

    /// One more frame, and the file that lists all.
    ///
    /// # Errors
    /// `Io` where it cannot be written.
    pub(super) fn add(&mut self, step: u64, time: f64) -> Result<()> {
        self.frames.retain(|frame| frame.0 < step);
        self.frames.push((step, time));
        io::write_whole(&self.path, |w| {
            writeln!(w, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>")?;
            self.frames.iter().try_for_each(|&(step, time)| writeln!(w, "{}", line(step, time)))?;
            writeln!(w, "</Collection>\n</VTKFile>")
        })
    }
}

fn line(step: u64, time: f64) -> String {
    format!("<DataSet timestep=\"{time:?}\" file=\"{}\"/>", Series::name(step))
}

/// A line that [`line`] wrote.
fn parse(text: &str) -> Option<(u64, f64)> {
    let rest = text.strip_prefix("<DataSet timestep=\"")?;
    let (time, rest) = rest.split_once("\" file=\"frame-")?;
    let step = rest.strip_suffix(".vtu\"/>")?;
    Some((step.parse().ok()?, time.parse().ok().filter(|time: &f64| time.is_finite())?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_known_again() {
        let folder = tempfile::tempdir().unwrap();
        let mut series = Series::new(folder.path(), None);
        let frames = [(0, 0.0), (10, 0.1 + 0.2), (2_000_000, 7.5e-8)];
        frames.iter().for_each(|&(step, time)| series.add(step, time).unwrap());
        assert_eq!(Series::new(folder.path(), Some(u64::MAX)).frames, frames);
        // From an earlier step what came after it is another motion's.
        assert_eq!(Series::new(folder.path(), Some(10)).frames, frames[..2]);
        assert_eq!(Series::new(folder.path(), None).frames, []);
        let mut series = Series::new(folder.path(), Some(u64::MAX));
        series.add(10, 0.5).unwrap();
        assert_eq!(series.frames, [(0, 0.0), (10, 0.5)]);
        fs::write(folder.path().join("frames.pvd"), b"\xff<DataSet>").unwrap();
        assert_eq!(Series::new(folder.path(), Some(10)).frames, []);
    }
}
