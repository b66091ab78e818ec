//! One suite of laws that every backend is held to.
//!
//! A check is a function of a backend alone ([`CHECKS`]); the test target runs each for each backend that was built, as
//! `backend::area::check`. Most checks are *laws*: functions of a backend and a [`Case`], tried on generated cases that
//! favour trouble ([`law::hold`]). A case is a seed and a few words, so the one that fails is printed as it would stand in
//! [`regressions`].
//!
//! | variable | meaning |
//! |---|---|
//! | `LAGUERRE_REQUIRE=cpu,ocl` | these backends must be there, or the run fails |
//! | `PROPTEST_CASES=256` | cases of each law |
//! | `PROPTEST_RNG_SEED=1` | other cases than those that every run tries |
//! | `LAGUERRE_WORST=1` | the checks against CGAL print their largest errors and where they are |
#![forbid(unsafe_code)]

/// Returns from a check with the formatted reason unless the condition holds.
macro_rules! ensure {
    ($condition:expr, $($reason:tt)+) => {{
        // A comparison with NaN does not hold.
        let holds: bool = $condition;
        if !holds {
            return Err(format!($($reason)+));
        }
    }};
}

pub mod backends;
pub mod bounds;
pub mod case;
pub mod checks;
pub mod compare;
pub mod domains;
pub mod fixtures;
pub mod given;
pub mod law;
pub mod moments;
pub mod regressions;
pub mod sanity;
pub mod scene;
pub mod sites;
pub mod weights;

pub use backends::Check;
pub use case::Case;
pub use checks::CHECKS;
pub use given::Given;
pub use law::Verdict;
pub use sanity::sanity_check;
pub use scene::Scene;
