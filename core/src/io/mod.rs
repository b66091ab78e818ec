//! Files: sites, weights, meshes and results. Readers name file and line of what is wrong and never allocate from a number
//! that a file merely claims; writers leave nothing half-written under the final name, also where who watches one (`write_…_watched`) ends it.
//!
//! Whatever bytes they are given, [`parse_sites`], [`parse_weights`] and [`parse_mesh`] end with a value or one line of
//! error, with memory of the order of the bytes: each binary form is held against its length, each text form read line by line.
//!
//! NumPy's `.npy` takes the feature `npy`, and what is packed by gzip (`.obj.gz`) or in VTK's XML (`.vtp`, read) the feature `packed`; without them such a name
//! is refused, by a line that says so. What is packed may unpack to a thousand times its bytes.

mod atomic;
mod atoms;
mod columns;
mod form;
mod geometry;
mod glb;
#[cfg(feature = "npy")]
mod image;
mod legacy_vtk;
mod lines;
mod mesh;
#[cfg_attr(not(feature = "npy"), path = "npy_absent.rs")]
mod npy;
mod obj;
mod off;
mod ply;
mod polyhedra;
mod read_results;
mod results;
mod sites;
mod stl;
mod table;
mod vtk;
#[cfg_attr(not(feature = "packed"), path = "vtp_absent.rs")]
mod vtp;
mod weights;

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use crate::{Error, ErrorKind, Result, memory};

pub use atomic::{abandon_writing, destination, write_whole, write_whole_watched};
pub use columns::Columns;
use form::Form;
pub use geometry::{write_geometry, write_geometry_watched};
pub use mesh::{Mesh, parse_mesh, read_mesh};
pub use read_results::{CellRow, CellsFile, FacetRow, parse_cells, parse_facets, read_cells, read_facets};
pub use results::{
    FacetValues, facet_count, facet_rows, write_cells, write_cells_watched, write_facets, write_facets_watched,
};
pub use sites::{SitesFile, parse_sites, parse_sites_by_columns, read_sites, read_sites_by_columns, write_sites};
pub use table::read_table;
pub use weights::{parse_weights, read_weights, write_weights};

/// Endings that [`write_sites`] knows.
pub const SITES_ENDINGS: &[&str] = &[".xyz", ".txt", ".csv", ".npy", ".ply"];
/// Endings that [`read_sites`] knows.
pub const SITES_INPUT_ENDINGS: &[&str] =
    &[".xyz", ".txt", ".csv", ".npy", ".ply", ".dump", ".lammpstrj", ".vtk", ".vtp"];
/// Endings that [`read_weights`] and [`write_weights`] know.
pub const WEIGHTS_ENDINGS: &[&str] = &[".txt", ".csv", ".npy"];
/// Endings that [`Domain::load`](crate::Domain::load) knows.
pub const MESH_ENDINGS: &[&str] = &[".obj", ".off", ".ply", ".stl", ".vtk", ".vtp"];
/// Endings that [`write_cells`] knows.
pub const CELLS_ENDINGS: &[&str] = &[".csv", ".npy"];
/// Endings that [`write_geometry`] knows.
pub const GEOMETRY_ENDINGS: &[&str] = &[".vtu", ".vtp", ".ply", ".glb"];
/// Endings that [`write_facets`] knows.
pub const FACETS_ENDINGS: &[&str] = &[".csv", ".npy"];

/// What is said of NumPy's files where nothing reads or writes them.
const NPY_IS_OFF: &str = "NumPy's files are not part of this build: build with the feature `npy`";

/// The ending of `path`, with its dot, in lower case, if it is one of `known`.
///
/// # Errors
/// `Input`, listing what is known; or saying that `.npy` takes the feature `npy`.
pub fn ending(path: &Path, known: &[&'static str]) -> Result<&'static str> {
    find_ending(path, known, false)
}

/// The same of an input, whose name may have a `.gz` behind its ending: that before it.
///
/// # Errors
/// As [`ending`]; and where the name takes a feature that is not built, or what is never packed would be.
pub fn input_ending(path: &Path, known: &[&'static str]) -> Result<&'static str> {
    Form::of(path, known).map(|form| form.ending)
}

fn find_ending(path: &Path, known: &[&'static str], is_input: bool) -> Result<&'static str> {
    let found = path.extension().map(|e| format!(".{}", e.to_string_lossy().to_lowercase())).unwrap_or_default();
    if cfg!(not(feature = "npy")) && found == ".npy" && known.contains(&".npy") {
        return Err(Error::input(format!("{}: {NPY_IS_OFF}", path.display())));
    }
    known.iter().copied().find(|&k| k == found).ok_or_else(|| {
        let found = if found.is_empty() { "no ending".into() } else { format!("unknown ending '{found}'") };
        let is_built = |known: &&str| match *known {
            ".npy" => cfg!(feature = "npy"),
            ".vtp" => cfg!(feature = "packed") || !is_input,
            _ => true,
        };
        let built: Vec<&str> = known.iter().copied().filter(is_built).collect();
        let packed = match built.first() {
            Some(first) if is_input && cfg!(feature = "packed") => format!("; also packed, as {first}.gz"),
            _ => String::new(),
        };
        Error::input(format!("{}: {found}; known here: {}{packed}", path.display(), built.join(", ")))
    })
}

/// The ending that decides how `path` is written: its own, as [`ending`] tells it, and `.csv` for `-`, standard output.
///
/// # Errors
/// `Input`, listing what is known.
pub fn output_ending(path: &Path, known: &[&'static str]) -> Result<&'static str> {
    let csv = known.iter().copied().find(|&k| k == ".csv");
    csv.filter(|_| is_standard(path)).map_or_else(|| ending(path, known), Ok)
}

/// Whether `path` is `-`, which is standard input or standard output.
pub(crate) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Checks, before hours of work, that a result could be written to `path`: its ending is one of `known`, its folder
/// exists, and a file can be made there. `-` is standard output where `.csv` is known.
///
/// # Errors
/// `Input` for the ending, `Io` for the folder.
pub fn check_output(path: &Path, known: &[&'static str]) -> Result<()> {
    output_ending(path, known)?;
    if is_standard(path) {
        return Ok(());
    }
    let folder = folder_of(path);
    if folder.is_dir() {
        return atomic::check_writable(path);
    }
    let missing = Error::new(ErrorKind::Io, format!("there is no folder '{}'; make it first", folder.display()));
    Err(missing.because(std::io::Error::from(std::io::ErrorKind::NotFound)).in_file(path))
}

/// Opens a file, and says how long it is.
fn open(path: &Path) -> Result<(BufReader<File>, u64)> {
    let failed = |e| io_error(path, "open", e);
    let file = File::open(path).map_err(failed)?;
    let found = file.metadata().map_err(failed)?;
    if found.is_dir() {
        return Err(Error::new(ErrorKind::Io, "it is a folder; name a file").in_file(path));
    }
    memory::spare("what it takes to read a file").map_err(|none| none.in_file(path))?;
    Ok((BufReader::with_capacity(1 << 18, file), found.len()))
}

/// What the operating system said in the midst of a file, or who unpacks it: that is wrong input.
fn cannot_read(error: std::io::Error) -> Error {
    use std::io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
    let is_of_file = matches!(error.kind(), InvalidData | InvalidInput | UnexpectedEof);
    let kind = if is_of_file { ErrorKind::Input } else { ErrorKind::Io };
    Error::new(kind, format!("cannot read: {error}")).because(error)
}

/// The folder that `path` names a file in.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// What the operating system said about `path`.
fn io_error(path: &Path, what: &str, error: std::io::Error) -> Error {
    Error::new(ErrorKind::Io, format!("cannot {what}: {error}")).because(error).in_file(path)
}

/// Those of some files' names that this build knows.
#[cfg(test)]
fn known<'a>(names: &[&'a str]) -> Vec<&'a str> {
    names.iter().copied().filter(|name| cfg!(feature = "npy") || !name.ends_with(".npy")).collect()
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
        let unknown = ending(Path::new("bunny.3ds"), MESH_ENDINGS).unwrap_err();
        assert_eq!(
            unknown.to_string(),
            "bunny.3ds: unknown ending '.3ds'; known here: .obj, .off, .ply, .stl, .vtk, .vtp"
        );
        let none = ending(Path::new("bunny"), MESH_ENDINGS).unwrap_err();
        assert_eq!(none.to_string(), "bunny: no ending; known here: .obj, .off, .ply, .stl, .vtk, .vtp");
    }

    #[test]
    fn what_cannot_be_written_is_found_before_the_work() {
        let folder = scratch("check-output");
        std::fs::create_dir(folder.join("d.csv")).unwrap();
        let taken = check_output(&folder.join("d.csv"), CELLS_ENDINGS).unwrap_err().to_string();
        assert!(taken.ends_with("d.csv: cannot write: it is a folder; name a file"), "{taken}");
        std::fs::remove_dir(folder.join("d.csv")).unwrap();
        assert!(check_output(&folder.join("cells.csv"), CELLS_ENDINGS).is_ok());
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0, "looking leaves nothing");
        assert!(check_output(Path::new("cells.csv"), CELLS_ENDINGS).is_ok());
        assert!(check_output(Path::new("-"), CELLS_ENDINGS).is_ok());
        assert!(check_output(Path::new("-"), MESH_ENDINGS).is_err(), "no csv");
        let missing = check_output(&folder.join("nowhere/cells.csv"), CELLS_ENDINGS).unwrap_err();
        assert_eq!(missing.kind(), ErrorKind::Io);
        assert!(missing.to_string().contains("there is no folder"), "{missing}");
    }

    /// A value or one line of error, for every file cut short, and with any one byte wrong.
    #[test]
    fn damaged_files_are_no_more_than_wrong() {
        let folder = scratch("damaged");
        let written = known(&["s.ply", "s.npy"]).into_iter().map(|name| {
            write_sites(folder.join(name), &[[0.5, 1.0, 2.0]; 2], &[0.25, 0.5]).unwrap();
            (name, std::fs::read(folder.join(name)).unwrap())
        });
        let written: Vec<(&str, Vec<u8>)> = written.collect();
        let mut stl = vec![b'x'; 84 + 2 * 50];
        stl[80..84].copy_from_slice(&[2, 0, 0, 0]);
        let ply =
            b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty char x\nproperty char y\nproperty char z\n\
            element face 2\nproperty list char int vertex_indices\nend_header\n\0\0\0\x01\0\0\0\x01\0\
            \x03\0\0\0\0\0\0\0\x01\0\0\0\x02\x03\0\0\0\x02\0\0\0\x01\0\0\0\0";
        let text_ply =
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_index\nend_header\n1 2 3\n3 0 0 0\n";
        let text_stl = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
        let dump = b"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 2\n0 3\n\
            ITEM: ATOMS id xs ys zs\n7 0.5 0.25 1\n";
        let vtk = b"# vtk DataFile Version 3.0\n\nBINARY\nDATASET POLYDATA\nPOINTS 1 float\n\0\0\0\0\0\0\0\0\0\0\0\0\n\
            POLYGONS 1 4\n\0\0\0\x03\0\0\0\0\0\0\0\0\0\0\0\0\n";
        let text_vtk =
            b"# vtk DataFile Version 5.1\n\nASCII\nDATASET POLYDATA\nFIELD f 1\na 1 1 string\nb\nPOINTS 1 int\n1 2 3\n\
            METADATA\n\nPOLYGONS 2 3\nOFFSETS long\n0 3\nCONNECTIVITY long\n0 0 0\nPOINT_DATA 1\n";
        let files: [(&str, &[u8]); 13] = [
            ("m.vtk", vtk),
            ("m.vtk", text_vtk),
            ("s.csv", b"id;x;y;z;r\n1;2;3;4;5\n"),
            ("s.dump", dump),
            ("s.xyz", b"2\nwater\nFe 1 2 3\nO 4 5 6\n"),
            ("s.xyz", b"1\nProperties=id:I:1:pos:R:3 a=1\n7 1 2 3\n"),
            ("s.xyz", b"# c\n2\nx y z w\n1 2 3 4\n-5e-1,6,7,8\n"),
            ("m.ply", ply),
            ("m.ply", text_ply),
            ("m.stl", &stl),
            ("m.stl", text_stl),
            ("m.obj", b"v 0 0 0\nv 1 0 0 2\nv 0 1 0\ng a\nf 1/1 2//3 \\\n-1\nf 1 2 3 1\n"),
            ("m.off", b"COFF\n3 2 0\n0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n4 0 1 2 1 255\n"),
        ];
        for (name, file) in files.into_iter().chain(written.iter().map(|(name, file)| (*name, &file[..]))) {
            let read = |bytes: &[u8]| {
                let error = match name.starts_with('s') {
                    true => parse_sites(bytes, name).err(),
                    false => parse_mesh(bytes, name).err(),
                };
                let line = error.map(|e| e.to_string()).unwrap_or_default();
                assert!(!line.contains('\n') && line.len() < 300, "{name}: {line}");
                line.is_empty()
            };
            assert!(read(file), "{name}");
            let damages = [0, b'\n', b' ', b'-', b'0', b'9', b'(', b'"', 0x7f, 0x80, 0xff];
            for at in 0..file.len() {
                read(&file[..at]);
                for byte in damages {
                    let mut damaged = file.to_vec();
                    damaged[at] = byte;
                    read(&damaged);
                }
            }
        }
    }
}
