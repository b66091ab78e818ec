//! Files: sites, meshes and results. Readers name file and line of what is wrong and never allocate from a number that
//! a file merely claims; writers leave nothing half-written under the final name.

mod atomic;
mod geometry;
mod lines;
mod mesh;
mod npy;
mod obj;
mod off;
mod results;
mod sites;
mod vtu;

use std::path::{Path, PathBuf};

use crate::{Error, ErrorKind, Result};

pub use atomic::write_whole;
pub use geometry::cell_meshes;
pub use mesh::{Mesh, read_mesh};
pub use results::{write_cells, write_facets};
pub use sites::{SitesFile, read_sites, write_sites};
pub use vtu::{CellMesh, write_vtu};

/// Endings that [`read_sites`] knows.
pub const SITES_ENDINGS: &[&str] = &[".xyz", ".txt", ".npy"];
/// Endings that [`write_sites`] knows.
pub const SAMPLE_ENDINGS: &[&str] = &[".xyz", ".txt", ".npy"];
/// Endings that [`Domain::load`](crate::Domain::load) knows.
pub const MESH_ENDINGS: &[&str] = &[".obj", ".off"];
/// Endings that [`write_cells`] knows.
pub const CELLS_ENDINGS: &[&str] = &[".csv", ".npy"];
/// Endings that [`write_facets`] knows.
pub const FACETS_ENDINGS: &[&str] = &[".csv"];

/// The ending of `path`, with its dot, in lower case, if it is one of `known`.
///
/// # Errors
/// `Input`, listing what is known.
pub fn ending(path: &Path, known: &[&'static str]) -> Result<&'static str> {
    let found = path.extension().map(|e| format!(".{}", e.to_string_lossy().to_lowercase())).unwrap_or_default();
    known.iter().copied().find(|&k| k == found).ok_or_else(|| {
        let found = if found.is_empty() { "no ending".into() } else { format!("unknown ending '{found}'") };
        Error::input(format!("{}: {found}; known here: {}", path.display(), known.join(", ")))
    })
}

/// Checks, before hours of work, that a result could be written to `path`: its ending is one of `known` and its folder
/// exists.
///
/// # Errors
/// `Input` for the ending, `Io` for the folder.
pub fn check_output(path: &Path, known: &[&'static str]) -> Result<()> {
    ending(path, known)?;
    let folder = folder_of(path);
    if folder.is_dir() {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Io, format!("{}: there is no folder '{}'", path.display(), folder.display())))
}

/// The folder that `path` names a file in.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// What the operating system said about `path`.
fn io_error(path: &Path, what: &str, error: &std::io::Error) -> Error {
    Error::new(ErrorKind::Io, format!("{}: cannot {what}: {error}", path.display()))
}

/// A folder of its own for one test, emptied at the start.
#[cfg(test)]
fn scratch(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("laguerre-io-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_are_told_apart_without_regard_to_case() {
        assert_eq!(ending(Path::new("a.b/Bunny.OBJ"), MESH_ENDINGS).unwrap(), ".obj");
        let unknown = ending(Path::new("bunny.stl"), MESH_ENDINGS).unwrap_err();
        assert_eq!(unknown.to_string(), "bunny.stl: unknown ending '.stl'; known here: .obj, .off");
        let none = ending(Path::new("bunny"), MESH_ENDINGS).unwrap_err();
        assert_eq!(none.to_string(), "bunny: no ending; known here: .obj, .off");
    }

    #[test]
    fn a_missing_folder_is_found_before_the_work() {
        let folder = scratch("check-output");
        assert!(check_output(&folder.join("cells.csv"), CELLS_ENDINGS).is_ok());
        assert!(check_output(Path::new("cells.csv"), CELLS_ENDINGS).is_ok());
        let missing = check_output(&folder.join("nowhere/cells.csv"), CELLS_ENDINGS).unwrap_err();
        assert_eq!(missing.kind(), ErrorKind::Io);
        assert!(missing.to_string().contains("there is no folder"), "{missing}");
    }
}
