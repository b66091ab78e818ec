//! What every parser owes, whatever bytes it is given.

use std::alloc::System;
use std::path::Path;

use cap::Cap;
use laguerre_core::io::{parse_cells, parse_facets, parse_mesh, parse_sites, parse_weights};
use laguerre_core::{Error, ErrorKind};

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// Bytes that a parser may take whatever the file: its buffers and messages.
const AT_ALL: usize = 1 << 20;

/// Bytes that a parser may take for each byte of the file. A face of an `.obj` or `.off` may name a vertex with two
/// characters, for which a triangle of 12 bytes stands in the mesh and in what `tobj` keeps, in vectors that double.
const FOR_EACH: usize = 128;
/// The same of a `.vtp`: each byte may unpack to a thousand, each of them a number of 8 bytes.
const FOR_EACH_PACKED: usize = 20_000;

/// Longest message: a file's name, a place, what is there and what is needed.
const LONGEST_MESSAGE: usize = 500;

/// Reads `bytes` as a file of sites with the given ending.
///
/// # Panics
/// Where the parser breaks what it owes.
pub fn sites(ending: &str, bytes: &[u8]) {
    let Some(sites) = owed(ending, bytes, |name| parse_sites(bytes, name)) else { return };
    let count = sites.positions.len();
    assert!(count > 0, "no sites, and no error");
    assert!([0, count].contains(&sites.weights.len()), "{} weights for {count} sites", sites.weights.len());
    assert!(sites.positions.iter().flatten().chain(&sites.weights).all(|x| x.is_finite()), "a number is not finite");
}

/// Reads `bytes` as a file of weights with the given ending.
///
/// # Panics
/// Where the parser breaks what it owes.
pub fn weights(ending: &str, bytes: &[u8]) {
    let Some(weights) = owed(ending, bytes, |name| parse_weights(bytes, name)) else { return };
    assert!(!weights.is_empty(), "no weights, and no error");
    assert!(weights.iter().all(|x| x.is_finite()), "a weight is not finite");
}

/// Reads `bytes` as a mesh with the given ending.
///
/// # Panics
/// Where the parser breaks what it owes.
pub fn mesh(ending: &str, bytes: &[u8]) {
    let Some(mesh) = owed(ending, bytes, |name| parse_mesh(bytes, name)) else { return };
    assert!(!mesh.triangles.is_empty(), "no triangles, and no error");
    let count = mesh.vertices.len();
    assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < count), "an index beyond {count} vertices");
    assert!(mesh.vertices.iter().flatten().all(|x| x.is_finite()), "a coordinate is not finite");
}

/// Reads `bytes` as a file of cells with the given ending.
///
/// # Panics
/// Where the parser breaks what it owes.
pub fn cells(ending: &str, bytes: &[u8]) {
    // Its numbers stand as they are found, and it may be empty.
    owed(ending, bytes, |name| parse_cells(bytes, name));
}

/// Reads `bytes` as a file of facets with the given ending.
///
/// # Panics
/// Where the parser breaks what it owes.
pub fn facets(ending: &str, bytes: &[u8]) {
    owed(ending, bytes, |name| parse_facets(bytes, name));
}

/// Runs a parser within its memory; of an error, looks at the message.
fn owed<T>(ending: &str, bytes: &[u8], parse: impl FnOnce(&Path) -> Result<T, Error>) -> Option<T> {
    let name = format!("file{ending}");
    // Beyond the limit an allocation fails, which ends the process.
    let for_each = if ending == ".vtp" { FOR_EACH_PACKED } else { FOR_EACH };
    let limit = ALLOCATOR.allocated() + AT_ALL + for_each * bytes.len();
    ALLOCATOR.set_limit(limit).expect("more than what is allocated");
    let parsed = parse(Path::new(&name));
    ALLOCATOR.set_limit(usize::MAX).expect("more than what is allocated");
    match parsed {
        Ok(parsed) => Some(parsed),
        Err(error) => {
            let text = error.to_string();
            assert_eq!(error.kind(), ErrorKind::Input, "{text}");
            assert!(text.starts_with(&name), "the file is not named: {text:?}");
            assert!(!text.chars().any(char::is_control), "not one line: {text:?}");
            assert!(text.len() <= LONGEST_MESSAGE, "{} bytes: {text:?}", text.len());
            None
        }
    }
}
