//! Diagrams that tasks of a pool evaluate at the same time, as programs with many diagrams do.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;
use std::{process, thread};

use laguerre_core::{Backend, Request};

use crate::compare::identical;
use crate::domains::{Pose, Room, Shape};
use crate::sites::Sites;
use crate::weights::Weights;
use crate::{Case, Scene, Verdict};

/// Where none has ended for so long, tasks that take milliseconds wait for each other and always will. (A device that builds its kernels for other checks at the same time keeps one waiting for a
/// minute, and all of them for longer than this.)
const STUCK: Duration = Duration::from_secs(300);

/// Tasks of a pool that share a domain nobody has used before get what each gets alone. A backend whose task waits for other tasks of the pool while it
/// holds what a third one needs never ends this: the thread that waits takes up the third. (Geometry is what devices leave to the host's threads.)
pub fn tasks_of_a_pool(backend: &dyn Backend) -> Verdict {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().map_err(|error| error.to_string())?;
    let request = Request::moments().with_facets().with_geometry();
    let case = Case {
        seed: 1,
        count: 300,
        sites: Sites::White,
        weights: Weights::Mild,
        shape: Shape::Torus,
        pose: Pose::Plain,
    };
    until_stuck(|ended| {
        for _ in 0..8 {
            let room = Room::of((*case.scene().room.mesh()).clone());
            let scenes =
                [1, 2, 3, 4, 5, 6, 7, 8].map(|seed| Scene { room: room.clone(), ..Case { seed, ..case }.scene() });
            let mut outputs = scenes.each_ref().map(|_| Err(String::new()));
            // (From without, so that threads look for parts of what is begun before they begin another.)
            pool.in_place_scope(|scope| {
                for (scene, output) in scenes.iter().zip(&mut outputs) {
                    scope.spawn(|_| {
                        *output = scene.evaluate(backend, &request);
                        let _ = ended.send(());
                    });
                }
            });
            for (scene, output) in scenes.iter().zip(outputs) {
                identical(&scene.evaluate(backend, &request)?, &output?)?;
                let _ = ended.send(());
            }
        }
        Ok(())
    })
}

/// Ends the process where nothing of `work`, which says what has ended, does.
fn until_stuck(work: impl FnOnce(&Sender<()>) -> Verdict) -> Verdict {
    let (ended, has_ended) = channel();
    let watch = thread::spawn(move || {
        loop {
            match has_ended.recv_timeout(STUCK) {
                Ok(()) => {}
                Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => {
                    eprintln!("concurrent::tasks_of_a_pool: tasks wait for each other");
                    process::exit(1);
                }
            }
        }
    });
    let verdict = work(&ended);
    drop(ended);
    let _ = watch.join();
    verdict
}
