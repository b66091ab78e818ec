//! Whether a device's driver compiles kernels, as the library tells a logger (`laguerre::kernels`): for the progress bar, which else stands still.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use log::{Level, LevelFilter, Log, Metadata, Record};

/// What takes less is not worth a word.
const WORTH_A_WORD: Duration = Duration::from_secs(1);

/// When compilations began that have not ended.
struct Kernels(Mutex<Vec<Instant>>);

static KERNELS: Kernels = Kernels(Mutex::new(Vec::new()));

impl Log for Kernels {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target() == "laguerre::kernels"
    }

    /// Compilations begin with a word of the level `Info`, and end with one of `Debug`.
    fn log(&self, record: &Record<'_>) {
        let (true, Ok(mut begun)) = (self.enabled(record.metadata()), self.0.lock()) else { return };
        match record.level() {
            Level::Info => begun.push(Instant::now()),
            _ => drop(begun.pop()),
        }
    }

    fn flush(&self) {}
}

/// Listens from now on.
pub(crate) fn listen() {
    // (Nobody else sets one.)
    if log::set_logger(&KERNELS).is_ok() {
        log::set_max_level(LevelFilter::Debug);
    }
}

/// Whether kernels have been compiled for a while.
pub(crate) fn are_compiled() -> bool {
    begun().is_some_and(|begun| begun.elapsed() > WORTH_A_WORD)
}

/// When the first of the compilations began that have not ended.
fn begun() -> Option<Instant> {
    KERNELS.0.lock().ok().and_then(|begun| begun.first().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_begun_and_not_ended_is_told() {
        listen();
        let tell = |level| log::log!(target: "laguerre::kernels", level, "of a test");
        tell(Level::Info);
        log::debug!(target: "another", "of a test");
        assert!(begun().is_some());
        tell(Level::Debug);
        assert!(begun().is_none() && !are_compiled());
    }
}
