//! Builds that will be needed soon, made by a thread of their own while the device computes. Even where the driver has kept what it compiled, a build takes
//! 10 to 24 ms, and a transport in a domain has seven: of a million white sites it takes 0.93 s so, and 1.02 without; in a box 0.645 and 0.69; a diagram
//! by itself 0.074 and 0.09 (one NVIDIA H100).

use crate::builds::{Asked, Way};
use crate::handle::Handle;
use crate::platform::DeviceId;
use crate::program::{Kernels, build};
use laguerre_core::Result;
use opencl3::context::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread::{Builder, JoinHandle};

/// A way to compute cells, and what for.
pub(crate) type Key = (Way, Asked);

/// Builds that are being made.
pub(crate) struct Ahead {
    /// Those that have not come yet, and those that have.
    awaited: Vec<Key>,
    come: Vec<(Key, Result<Kernels>)>,
    made: Receiver<(Key, Result<Kernels>)>,
    is_over: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl Ahead {
    /// Begins to make some; `None` where there is no thread to be had.
    pub(crate) fn begin(context: Arc<Handle<Context>>, device: DeviceId, keys: Vec<Key>) -> Option<Self> {
        let (sender, made) = channel();
        let is_over = Arc::new(AtomicBool::new(false));
        let (awaited, over) = (keys.clone(), is_over.clone());
        let make = move || {
            // (The whole of it, which may be sent to another thread.)
            let device = device;
            for key in keys {
                if over.load(Ordering::Relaxed) || sender.send((key, build(&context, device.0, key.0, key.1))).is_err()
                {
                    return;
                }
            }
        };
        let thread = Builder::new().name("builds".to_owned()).spawn(make).ok()?;
        Some(Self { awaited, come: Vec::new(), made, is_over, thread })
    }

    /// Takes one, for which it waits; `None` where it is not among them.
    pub(crate) fn take(&mut self, key: Key) -> Option<Result<Kernels>> {
        while self.awaited.contains(&key) {
            let Ok((other, built)) = self.made.recv() else {
                self.awaited.clear();
                break;
            };
            self.awaited.retain(|awaited| *awaited != other);
            self.come.push((other, built));
        }
        let at = self.come.iter().position(|(other, _)| *other == key)?;
        Some(self.come.swap_remove(at).1)
    }

    /// Begins no more; those that nobody has taken.
    pub(crate) fn end(self) -> impl Iterator<Item = (Key, Result<Kernels>)> {
        self.is_over.store(true, Ordering::Relaxed);
        // (Whatever it says if it panicked: those that are missing are built where they are needed.)
        let _ = self.thread.join();
        self.come.into_iter().chain(self.made)
    }
}
