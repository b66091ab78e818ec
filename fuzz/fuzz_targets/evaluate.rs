//! A structured case, on the CPU: see [`laguerre_fuzz::tied`].
#![no_main]

use std::sync::LazyLock;

use laguerre::Selection;
use laguerre_core::Backend;
use laguerre_fuzz::tied::Tied;

static BACKEND: LazyLock<Box<dyn Backend>> =
    LazyLock::new(|| laguerre::open(Selection::Cpu { threads: Some(1) }).expect("one thread"));

libfuzzer_sys::fuzz_target!(|case: Tied| {
    if let Err(reason) = case.holds(&**BACKEND) {
        panic!("{reason}\n    (\"…\", {:?}),", case.given());
    }
});
