//! A structured case, on the CPU: see [`laguerre_fuzz::tied`].
#![no_main]

use std::sync::LazyLock;

use arbitrary::Unstructured;
use laguerre::Selection;
use laguerre_core::Backend;
use laguerre_fuzz::tied::tied;

static BACKEND: LazyLock<Box<dyn Backend>> =
    LazyLock::new(|| laguerre::open(Selection::Cpu { threads: Some(1) }).expect("one thread"));

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(case) = tied(&mut Unstructured::new(bytes)) else { return };
    if let Err(reason) = case.holds(&**BACKEND) {
        panic!("{reason}\n    (\"…\", {:?}),", case.given());
    }
});
