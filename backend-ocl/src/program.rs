//! The kernels: their source, built for the room of a pass, and kept.

use crate::buffer::failed;
use laguerre_core::passes::Capacities;
use laguerre_core::{Error, ErrorKind, Result};
use opencl3::context::Context;
use opencl3::kernel::Kernel;
use opencl3::program::Program;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

const SOURCES: [&str; 6] = [
    include_str!("kernels/prelude.cl"),
    include_str!("kernels/cell_types.cl"),
    include_str!("kernels/store.cl"),
    include_str!("kernels/cell.cl"),
    include_str!("kernels/search.cl"),
    include_str!("kernels/evaluate.cl"),
];

/// Most half-spaces that a work-item has room for; what needs more is the host's.
pub(crate) const MOST_PLANES: u32 = 216;

/// One build, and its kernels.
pub(crate) struct Kernels {
    pub(crate) cells: Kernel,
    pub(crate) probe: Kernel,
}

/// All builds so far.
#[derive(Default)]
pub(crate) struct Programs {
    built: HashMap<(u32, u32, bool), Kernels>,
}

impl Programs {
    /// The kernels with room for `room`, built if they are not.
    pub(crate) fn get(&mut self, context: &Context, room: Capacities, facets: bool) -> Result<&Kernels> {
        let key = (room.planes, room.vertices, facets);
        match self.built.entry(key) {
            Entry::Occupied(built) => Ok(built.into_mut()),
            Entry::Vacant(place) => Ok(place.insert(build(context, room, facets)?)),
        }
    }
}

fn build(context: &Context, room: Capacities, facets: bool) -> Result<Kernels> {
    let Capacities { planes, vertices } = room;
    let options = format!("-D CAP_P={planes} -D CAP_V={vertices} -D WITH_FACETS={}", u32::from(facets));
    // As one string: given several, opencl3 0.12 passes their lengths wrongly.
    let program = Program::create_and_build_from_source(context, &SOURCES.concat(), &options)
        .map_err(|log| Error::new(ErrorKind::Device, format!("the kernels do not build: {}", one_line(&log))))?;
    let kernel = |name| Kernel::create(&program, name).map_err(|error| failed(&format!("creating {name}"), error));
    Ok(Kernels { cells: kernel("cells")?, probe: kernel("probe")? })
}

/// A build log as one line of a message.
fn one_line(log: &str) -> String {
    log.split_whitespace().collect::<Vec<_>>().join(" ")
}
