//! The first use of OpenCL in a process by several threads at once: a test program of its own, as only the first can go wrong.

use std::sync::Barrier;
use std::thread;

use laguerre_core::{Backend, DeviceChoice, Precision};
use laguerre_ocl::Ocl;

/// PoCL 3.1 crashes in that unless the backend lets them in one by one.
#[test]
fn threads_open_the_backend_at_once() {
    const THREADS: usize = 4;
    let barrier = Barrier::new(THREADS);
    let open = || {
        barrier.wait();
        let listed = laguerre_ocl::devices().map(|devices| devices.len());
        let opened = Ocl::new(&DeviceChoice::All, Precision::F64).map(|backend| backend.info().device);
        (listed.map_err(|e| e.to_string()), opened.map_err(|e| e.to_string()))
    };
    let opened: Vec<_> = thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|_| scope.spawn(open)).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    // All have the same devices, or the same reason why there are none.
    assert!(opened.windows(2).all(|pair| pair[0] == pair[1]), "{opened:?}");
}
