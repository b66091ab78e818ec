//! VTK's XML unstructured grids (`.vtu`) of polyhedra, for ParaView and PyVista. (The crate `vtkio` does not know the
//! faces of polyhedra.)

use std::io::{self, Write};
use std::path::Path;

use super::{atomic, ending, results};
use crate::{CellStatus, Error, Output, Result};

/// VTK's number for a polyhedron.
const VTK_POLYHEDRON: u8 = 42;

/// The geometry of one convex cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellMesh {
    /// The site whose cell it is.
    pub site: u32,
    /// Corners, in the caller's unit.
    pub points: Vec<[f64; 3]>,
    /// Faces, as indices into `points`, counterclockwise from outside.
    pub faces: Vec<Vec<u32>>,
}

/// Writes `cells` as polyhedra, with the integrals of their restricted cells as data: `site`, `volume`, `barycenter`,
/// `status` (0 complete, 1 empty, 2 uncertified), and `facets` (their number) where facets were asked for.
///
/// The geometry is that of the power cells, not yet cut by the domain; the integrals are of the cells cut by it. The file appears
/// whole or not at all. Its arrays stand behind the XML as raw little-endian numbers, so they are exact and fast to read.
///
/// # Errors
/// `Input` for another ending than `.vtu`, or where a cell names a site or point that is not there; `Io` where writing
/// failed.
pub fn write_vtu(path: impl AsRef<Path>, cells: &[CellMesh], output: &Output) -> Result<()> {
    let path = path.as_ref();
    ending(path, &[".vtu"])?;
    let sites = output.volume.len();
    for cell in cells {
        let i = cell.site as usize;
        if i >= sites || output.barycenter.len() != sites || output.status.len() != sites {
            return Err(Error::input(format!("cell of site {i}: the output has {sites} sites")));
        }
        if cell.faces.iter().flatten().any(|&p| p as usize >= cell.points.len()) {
            return Err(Error::input(format!("cell of site {i}: a face names a point that is not there")));
        }
    }
    let arrays = arrays(cells, output);
    atomic::write_whole(path, |w| {
        let mut offset = 0;
        writeln!(w, "<?xml version=\"1.0\"?>")?;
        writeln!(
            w,
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
        )?;
        let points: usize = cells.iter().map(|c| c.points.len()).sum();
        writeln!(w, "<UnstructuredGrid><Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{}\">", cells.len())?;
        for section in ["CellData", "Points", "Cells"] {
            writeln!(w, "<{section}>")?;
            for array in arrays.iter().filter(|a| a.section == section) {
                writeln!(
                    w,
                    "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{offset}\"/>",
                    array.kind, array.name, array.components
                )?;
                offset += 8 + array.bytes;
            }
            writeln!(w, "</{section}>")?;
        }
        // The blocks follow in the order in which the offsets were counted.
        writeln!(w, "</Piece></UnstructuredGrid>\n<AppendedData encoding=\"raw\">")?;
        w.write_all(b"_")?;
        for section in ["CellData", "Points", "Cells"] {
            for array in arrays.iter().filter(|a| a.section == section) {
                w.write_all(&array.bytes.to_le_bytes())?;
                (array.write)(w)?;
            }
        }
        writeln!(w, "\n</AppendedData>\n</VTKFile>")
    })
}

/// Writes the numbers of one array.
type WriteArray<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// One array of the file: what its XML says, how long it is, and how it is written.
struct Array<'a> {
    section: &'static str,
    name: &'static str,
    kind: &'static str,
    components: u32,
    bytes: u64,
    write: Box<WriteArray<'a>>,
}

fn arrays<'a>(cells: &'a [CellMesh], output: &'a Output) -> Vec<Array<'a>> {
    let n = cells.len() as u64;
    let points: u64 = cells.iter().map(|c| c.points.len() as u64).sum();
    let mut arrays = vec![
        array("CellData", "site", "Int64", 1, 8 * n, move |put| {
            cells.iter().try_for_each(|c| put(&i64::from(c.site).to_le_bytes()))
        }),
        array("CellData", "volume", "Float64", 1, 8 * n, move |put| {
            cells.iter().try_for_each(|c| put(&output.volume[c.site as usize].to_le_bytes()))
        }),
        array("CellData", "barycenter", "Float64", 3, 24 * n, move |put| {
            let coordinates = cells.iter().flat_map(|c| output.barycenter[c.site as usize]);
            coordinates.into_iter().try_for_each(|x| put(&x.to_le_bytes()))
        }),
        array("CellData", "status", "UInt8", 1, n, move |put| {
            cells.iter().try_for_each(|c| {
                put(&[match output.status[c.site as usize] {
                    CellStatus::Complete => 0,
                    CellStatus::Empty => 1,
                    CellStatus::Uncertified => 2,
                }])
            })
        }),
    ];
    let sites = output.volume.len();
    let boundary_fits = output.boundary.as_ref().is_none_or(|b| b.len() == sites);
    if boundary_fits && output.facets.as_ref().is_some_and(|f| f.offsets.len() == sites + 1) {
        arrays.push(array("CellData", "facets", "Int64", 1, 8 * n, move |put| {
            cells.iter().try_for_each(|c| {
                let count = results::facet_count(output, c.site as usize).unwrap_or(0);
                put(&(count as i64).to_le_bytes())
            })
        }));
    }
    let face_words = |c: &CellMesh| 1 + c.faces.iter().map(|f| 1 + f.len()).sum::<usize>();
    let words: u64 = cells.iter().map(|c| face_words(c) as u64).sum();
    arrays.extend([
        array("Points", "Points", "Float64", 3, 24 * points, move |put| {
            cells.iter().flat_map(|c| &c.points).flatten().try_for_each(|x| put(&x.to_le_bytes()))
        }),
        // Cells share no points, so the corners of all cells are simply counted on.
        array("Cells", "connectivity", "Int64", 1, 8 * points, move |put| {
            (0..points as i64).try_for_each(|i| put(&i.to_le_bytes()))
        }),
        array("Cells", "offsets", "Int64", 1, 8 * n, move |put| ends(cells, |c| c.points.len(), put)),
        array("Cells", "types", "UInt8", 1, n, move |put| (0..n).try_for_each(|_| put(&[VTK_POLYHEDRON]))),
        // Of each cell: number of faces; then of each face its number of corners and the corners.
        array("Cells", "faces", "Int64", 1, 8 * words, move |put| {
            let mut first = 0_i64;
            for cell in cells {
                put(&(cell.faces.len() as i64).to_le_bytes())?;
                for face in &cell.faces {
                    put(&(face.len() as i64).to_le_bytes())?;
                    face.iter().try_for_each(|&p| put(&(first + i64::from(p)).to_le_bytes()))?;
                }
                first += cell.points.len() as i64;
            }
            Ok(())
        }),
        array("Cells", "faceoffsets", "Int64", 1, 8 * n, move |put| ends(cells, face_words, put)),
    ]);
    arrays
}

/// Takes the bytes of one number.
type Put<'w> = dyn FnMut(&[u8]) -> io::Result<()> + 'w;

fn array<'a>(
    section: &'static str,
    name: &'static str,
    kind: &'static str,
    components: u32,
    bytes: u64,
    numbers: impl Fn(&mut Put<'_>) -> io::Result<()> + 'a,
) -> Array<'a> {
    let write = Box::new(move |w: &mut dyn Write| numbers(&mut |number: &[u8]| w.write_all(number)));
    Array { section, name, kind, components, bytes, write }
}

/// Puts, for each cell, where what it has `size` of ends.
fn ends(cells: &[CellMesh], size: impl Fn(&CellMesh) -> usize, put: &mut Put<'_>) -> io::Result<()> {
    let mut end = 0_i64;
    cells.iter().try_for_each(|cell| {
        end += size(cell) as i64;
        put(&end.to_le_bytes())
    })
}

#[cfg(test)]
mod tests {
    use super::super::scratch;
    use super::*;

    fn tetrahedron(site: u32) -> CellMesh {
        let s = f64::from(site);
        CellMesh {
            site,
            points: vec![[s, 0.0, 0.0], [s + 1.0, 0.0, 0.0], [s, 1.0, 0.0], [s, 0.0, 1.0]],
            faces: vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]],
        }
    }

    fn output() -> Output {
        Output {
            status: vec![CellStatus::Complete, CellStatus::Empty, CellStatus::Uncertified],
            volume: vec![1.0 / 6.0, 0.0, 0.125],
            barycenter: vec![[0.25; 3], [f64::NAN; 3], [2.25, 0.25, 0.25]],
            ..Output::default()
        }
    }

    /// Each array of the file as the XML announces it: name and bytes.
    fn announced(file: &[u8]) -> Vec<(String, Vec<u8>)> {
        let start = file.windows(2).position(|w| w == b"\n_").unwrap();
        let xml = std::str::from_utf8(&file[..start]).unwrap();
        let data = &file[start + 2..];
        let attribute = |line: &str, key: &str| {
            let from = line.find(&format!("{key}=\"")).unwrap() + key.len() + 2;
            line[from..].split('"').next().unwrap().to_string()
        };
        let arrays = xml.lines().filter(|l| l.starts_with("<DataArray")).map(|line| {
            let offset: usize = attribute(line, "offset").parse().unwrap();
            let length = u64::from_le_bytes(data[offset..offset + 8].try_into().unwrap()) as usize;
            (attribute(line, "Name"), data[offset + 8..offset + 8 + length].to_vec())
        });
        arrays.collect()
    }

    #[test]
    fn every_array_stands_where_the_xml_says() {
        let path = scratch("vtu").join("cells.vtu");
        write_vtu(&path, &[tetrahedron(0), tetrahedron(2)], &output()).unwrap();
        let arrays = announced(&std::fs::read(&path).unwrap());
        let bytes = |name: &str| &arrays.iter().find(|(n, _)| n == name).unwrap().1;
        let floats = |name: &str| -> Vec<f64> {
            bytes(name).as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
        };
        let integers = |name: &str| -> Vec<i64> {
            bytes(name).as_chunks::<8>().0.iter().map(|b| i64::from_le_bytes(*b)).collect()
        };
        assert_eq!(floats("volume"), [1.0 / 6.0, 0.125]);
        assert_eq!(floats("barycenter")[3..], [2.25, 0.25, 0.25]);
        assert_eq!(floats("Points").len(), 24);
        assert_eq!(integers("site"), [0, 2]);
        assert_eq!(bytes("status"), &[0, 2]);
        assert_eq!(bytes("types"), &[42, 42]);
        assert_eq!(integers("connectivity"), (0..8).collect::<Vec<_>>());
        assert_eq!(integers("offsets"), [4, 8]);
        assert_eq!(integers("faceoffsets"), [17, 34]);
        assert_eq!(integers("faces")[..5], [4, 3, 0, 2, 1]);
        assert_eq!(integers("faces")[17..22], [4, 3, 4, 6, 5]);
        assert!(arrays.iter().all(|(name, _)| name != "facets"));
    }

    #[test]
    fn cells_that_do_not_fit_leave_nothing() {
        let folder = scratch("vtu-misfit");
        let mut broken = tetrahedron(0);
        broken.faces[0][0] = 4;
        for cell in [tetrahedron(3), broken] {
            assert!(write_vtu(folder.join("cells.vtu"), &[cell], &output()).is_err());
        }
        assert!(write_vtu(folder.join("cells.vtk"), &[], &output()).is_err());
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
    }
}
