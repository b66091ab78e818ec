//! Any bytes as `.vtp`: see [`laguerre_fuzz::files`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| laguerre_fuzz::files::mesh(".vtp", bytes));
