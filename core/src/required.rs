//! For tests of backends that may not be there.

use crate::{ErrorKind, Result};

/// What was opened, or `None` where it is not available and the test is not to run.
///
/// # Panics
/// With any other error; and where the backend is not available though `LAGUERRE_REQUIRE`, names with commas between, asks for it.
pub fn if_available<T>(backend: &str, opened: Result<T>) -> Option<T> {
    match opened {
        Ok(opened) => Some(opened),
        Err(error) if error.kind() == ErrorKind::Unavailable => {
            assert!(!is_required(backend), "{error}");
            eprintln!("not run: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Whether `LAGUERRE_REQUIRE` names a backend.
pub fn is_required(backend: &str) -> bool {
    std::env::var("LAGUERRE_REQUIRE").unwrap_or_default().split(',').any(|name| name.trim() == backend)
}
