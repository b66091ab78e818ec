//! Running a law over generated cases.

use laguerre_core::Backend;
use proptest::test_runner::{Config, FileFailurePersistence, RngSeed, TestCaseError, TestError, TestRunner};

use crate::{Case, case};

/// Fulfilled, or in one sentence what is wrong.
pub type Verdict = Result<(), String>;

/// What must be true of a backend on every case.
pub type Law = fn(&dyn Backend, &Case) -> Verdict;

/// Tries `law`, which stands in the source file `file`, on `PROPTEST_CASES` generated cases (256 unless set). They are the
/// same in every run and on every machine, unless `PROPTEST_RNG_SEED` is set; those that once failed are kept beside
/// `file` and tried first.
///
/// # Errors
/// The smallest case found that breaks the law, as a line of [`crate::regressions`], and what is wrong with it.
pub fn hold(file: &'static str, name: &str, backend: &dyn Backend, law: Law) -> Verdict {
    let mut config = Config {
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        max_shrink_iters: 400,
        ..Config::with_source_file(file)
    };
    if backend.info().backend == "ocl-single" {
        // Most of what it does `ocl-sharing` does, too.
        config.cases = config.cases.div_ceil(4);
    }
    if matches!(config.rng_seed, RngSeed::Random) {
        config.rng_seed = RngSeed::Fixed(seed_of(name));
    }
    let mut runner = TestRunner::new(config);
    let outcome = runner.run(&case::any(), |case| law(backend, &case).map_err(TestCaseError::fail));
    outcome.map_err(|error| match error {
        TestError::Fail(reason, case) => {
            format!("{reason}\nto keep this case, add to regressions.rs:\n    (\"…\", {name}, {case:?}),")
        }
        TestError::Abort(reason) => format!("no verdict: {reason}"),
    })
}

/// FNV-1a: a seed for each law, so that different laws meet different cases.
fn seed_of(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}
