//! What an observer is told where an evaluation begins again: each cell once.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use laguerre_core::Observer;

/// An observer of an evaluation that may begin again.
pub(crate) struct Again<'a> {
    observer: &'a dyn Observer,
    /// Cells that were told.
    told: AtomicUsize,
    /// Cells that will be finished a second time.
    repeated: AtomicUsize,
}

impl<'a> Again<'a> {
    pub(crate) fn new(observer: &'a dyn Observer) -> Self {
        Self { observer, told: AtomicUsize::new(0), repeated: AtomicUsize::new(0) }
    }

    /// All cells are computed once more: as many as were told are not told again. No cell is being computed.
    pub(crate) fn begin_again(&self) {
        self.repeated.store(self.told.load(Ordering::Relaxed), Ordering::Relaxed);
    }
}

impl Observer for Again<'_> {
    fn advance(&self, cells: usize) -> ControlFlow<()> {
        let less = |repeated: usize| Some(repeated.saturating_sub(cells));
        let repeated = self.repeated.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).unwrap_or(0);
        let new = cells.saturating_sub(repeated);
        self.told.fetch_add(new, Ordering::Relaxed);
        self.observer.advance(new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Count(AtomicUsize);

    impl Observer for Count {
        fn advance(&self, cells: usize) -> ControlFlow<()> {
            let all = self.0.fetch_add(cells, Ordering::Relaxed) + cells;
            if all < 100 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        }
    }

    #[test]
    fn each_cell_is_told_once() {
        let count = Count::default();
        let again = Again::new(&count);
        for cells in [20, 0, 30] {
            assert!(again.advance(cells).is_continue());
        }
        // Twice, the second time in other portions, one of them across what was told.
        again.begin_again();
        assert!(again.advance(10).is_continue());
        again.begin_again();
        for cells in [45, 25, 10] {
            assert!(again.advance(cells).is_continue(), "who watches is told of each call");
        }
        assert_eq!(count.0.load(Ordering::Relaxed), 80);
        assert!(again.advance(20).is_break());
        assert_eq!(count.0.into_inner(), 100);
    }
}
