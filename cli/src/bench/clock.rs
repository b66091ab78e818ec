//! How fast the processor's clock runs, without asking the processor: counters of cycles are for systems to read, and virtual machines seldom have them.

use std::hint::black_box;
use std::time::Instant;

/// Steps that each wait for the one before, some four milliseconds of them.
const STEPS: u32 = 1 << 22;

/// How often they are timed: the fastest is what no other work has disturbed.
const TIMES: u32 = 5;

/// Cycles of a step: an addition and an exclusive or of registers take one each on every processor of the last twenty years.
const CYCLES: f64 = 2.0;

/// Cycles of a second of one core, as it runs now. (Many at a time may run slower. A build that is not optimised says too few.)
pub(super) fn cycles_per_second() -> f64 {
    // (In registers: some processors add what stands in the instruction in no time.)
    let (add, flip) = (black_box(0x9e37_79b9_7f4a_7c15_u64), black_box(0xd1b5_4a32_d192_ed03_u64));
    let seconds = (0..TIMES).map(|_| {
        let start = Instant::now();
        let last = (0..STEPS).fold(black_box(1_u64), |x, _| x.wrapping_add(add) ^ flip);
        black_box(last);
        start.elapsed().as_secs_f64()
    });
    CYCLES * f64::from(STEPS) / seconds.fold(f64::INFINITY, f64::min)
}
