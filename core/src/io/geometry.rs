//! The geometry of restricted cells as files: `.vtu` (solids, for ParaView and PyVista), `.vtp` and `.ply` (polygons), `.glb` (triangles, for viewers).

use std::io::{self, Write};
use std::path::Path;

use super::glb::Glb;
use super::polyhedra::Polyhedra;
use super::vtk::{Array, Put, array, write_xml};
use super::{GEOMETRY_ENDINGS, atomic, ending, results};
use crate::geometry::{Beyond, Face};
use crate::parallel;
use crate::{Error, Geometry, Observer, Output, PowerDiagram, Result};
use std::ops::Range;

/// VTK's number for a polyhedron.
const VTK_POLYHEDRON: u8 = 42;
/// And for a tetrahedron.
const VTK_TETRA: u8 = 10;

/// Writes the cells as the file's ending says, with the integrals of each as data: `site`, `volume`, `weight`, `barycenter`, `status` (0 complete,
/// 1 empty, 2 uncertified), and `facets` (their number) where facets were asked for. Comments in VTK's files say so, and the units.
///
/// `.vtu` has solids, which [`Request::with_solids`](crate::Request::with_solids) asks for: a cell that the domain's surface does not meet is a
/// polyhedron, any other stands as tetrahedra, of one `site`, numbered by `solid` from 0 on; the data of all are the cell's. So does one in some
/// thirty of the others, as VTK would lose a part of it as a polyhedron. (meshio reads no polyhedra.) Where the winding number of the domain is
/// two they stand twice, and where it is negative they are turned inside out: VTK's volume of such a tetrahedron is negative, and the sum of a
/// site's volumes is its `volume`. `.vtp` and `.ply` have the polygons of all cells, with `beyond`, the site on the other side: −1 where that is the outside of the domain,
/// −2 where it is that of the box. A polygon between two cells stands twice, once for each.
/// `.glb`, glTF 2.0, has them as triangles, with colours such that no two neighbours have the same, and the site as the attribute `_SITE`
/// (where there are up to 2²⁴); coordinates have 32 bits, from the middle of all, which is the node's translation. The mesh's `extras` have the units,
/// what a status means, and in `cells`, in the order of the triangles, how many each cell has, and its `site`, `volume`, `weight` and `status`.
///
/// The file appears whole or not at all.
///
/// # Errors
/// `Input` for another ending, where the output has no geometry of this diagram, or for `.vtu` where a cell has
/// too many parts for solids; where it is more than `.ply` or `.glb` can count; `Io` where writing failed.
pub fn write_geometry(path: impl AsRef<Path>, diagram: &PowerDiagram, output: &Output) -> Result<()> {
    write_geometry_watched(path, diagram, output, &())
}

/// The same, watched by `observer`, who is asked cell by cell while solids and triangles are made, and while the file is written.
///
/// # Errors
/// As [`write_geometry`]; `Interrupted` where the observer ends it, which leaves nothing.
pub fn write_geometry_watched(
    path: impl AsRef<Path>,
    diagram: &PowerDiagram,
    output: &Output,
    observer: &dyn Observer,
) -> Result<()> {
    let path = path.as_ref();
    let kind = ending(path, GEOMETRY_ENDINGS)?;
    let sites = diagram.positions().len();
    let Some(geometry) = output.geometry().filter(|g| g.sites() == sites) else {
        return Err(Error::input(
            "this output has no geometry of this diagram: ask for it with Request::with_geometry",
        ));
    };
    if kind == ".vtu" && !geometry.has_solids() {
        return Err(Error::input(
            "this output has no solids, which a .vtu consists of: ask for them with Request::with_solids",
        ));
    }
    let mut cells = Cells { diagram, output, geometry, observer, polyhedra: Vec::new() };
    match kind {
        ".vtu" => {
            cells.polyhedra = cells.find_polyhedra()?;
            cells.check_solids()?;
            atomic::write_whole_watched(path, observer, |w| cells.write_vtu(w))
        }
        ".glb" => {
            let glb = Glb::new(diagram, output, geometry, observer)?;
            let most = u32::MAX as usize;
            refuse_beyond(path, glb.bytes(), most, "bytes, and .glb has room for", ".vtu or .vtp")?;
            atomic::write_whole_watched(path, observer, |w| glb.write(geometry, w))
        }
        ".vtp" => atomic::write_whole_watched(path, observer, |w| cells.write_vtp(w)),
        _ => {
            let most = geometry.points().len().max(sites);
            refuse_beyond(path, most, i32::MAX as usize, "points, and .ply has numbers for", ".vtu or .vtp")?;
            atomic::write_whole_watched(path, observer, |w| cells.write_ply(w))
        }
    }
}

/// Refuses what a format cannot count.
fn refuse_beyond(path: &Path, count: usize, most: usize, what: &str, instead: &str) -> Result<()> {
    if count <= most {
        return Ok(());
    }
    Err(Error::input(format!("{}: it would have {count} {what} {most}; write {instead}", path.display())))
}

/// How much of its volume the tetrahedra of a cell may miss, as a share of the mean.
const FILLED: f64 = 1e-9;

/// Cells that one task looks at.
const CELLS_AT_ONCE: usize = 256;

/// What a cell consists of in a `.vtu`. Tetrahedra for all would be read by all, meshio too, but are 43 a cell: some 80 MB for 20,000 white cells,
/// against 26, and a picture of edges shows theirs.
enum Solid<'a> {
    /// A cell that the surface does not meet, and of which VTK keeps all.
    Polyhedron(Vec<Face<'a>>),
    /// A part of any other.
    Tetrahedron([u32; 4]),
}

struct Cells<'a> {
    diagram: &'a PowerDiagram,
    output: &'a Output,
    geometry: &'a Geometry,
    observer: &'a dyn Observer,
    /// Of each site whether its cell stands as a polyhedron; for `.vtu`.
    polyhedra: Vec<bool>,
}

impl Cells<'_> {
    /// The face of every cell, with its site.
    fn faces(&self) -> impl Iterator<Item = (usize, Face<'_>)> {
        (0..self.geometry.sites()).flat_map(|i| self.geometry.faces(i).map(move |face| (i, face)))
    }

    fn weight(&self, i: usize) -> f64 {
        self.diagram.weights().get(i).copied().unwrap_or(0.0)
    }

    /// The data of cells: one row for each of `rows`, which are sites.
    fn data<'b>(&'b self, rows: &'b [u32]) -> Vec<Array<'b>> {
        let (n, output) = (rows.len(), self.output);
        let sites = move || rows.iter().map(|&i| i as usize);
        let mut arrays = vec![
            array("CellData", "site", "Int64", 1, n, move |put| {
                rows.iter().try_for_each(|&i| put(&i64::from(i).to_le_bytes()))
            }),
            array("CellData", "volume", "Float64", 1, n, move |put| {
                sites().try_for_each(|i| put(&output.volume()[i].to_le_bytes()))
            }),
            array("CellData", "weight", "Float64", 1, n, move |put| {
                sites().try_for_each(|i| put(&self.weight(i).to_le_bytes()))
            }),
            array("CellData", "barycenter", "Float64", 3, 3 * n, move |put| {
                sites().flat_map(|i| output.barycenter()[i]).try_for_each(|x| put(&x.to_le_bytes()))
            }),
            array("CellData", "status", "UInt8", 1, n, move |put| {
                sites().try_for_each(|i| put(&[output.status()[i].number()]))
            }),
        ];
        if output.facets().is_some() {
            arrays.push(array("CellData", "facets", "Int64", 1, n, move |put| {
                sites().try_for_each(|i| put(&(results::facet_count(output, i).unwrap_or(0) as i64).to_le_bytes()))
            }));
        }
        arrays.push(array("Points", "Points", "Float64", 3, 3 * self.geometry.points().len(), |put| {
            self.geometry.points().iter().flatten().try_for_each(|x| put(&x.to_le_bytes()))
        }));
        arrays
    }

    fn notes(&self) -> [String; 3] {
        let container = match self.diagram.domain() {
            Some(domain) => format!("a mesh of {} triangles", domain.triangles().len()),
            None => "a box".into(),
        };
        [
            format!("laguerre {}: cells restricted to {container}", env!("CARGO_PKG_VERSION")),
            "data are those of the whole cell of a site; volume: length^3, weight: length^2, of the unit of the coordinates".into(),
            "status: 0 complete, 1 empty, 2 uncertified".into(),
        ]
    }

    /// Of each site whether its cell can stand as a polyhedron.
    fn find_polyhedra(&self) -> Result<Vec<bool>> {
        let is_one = |polyhedra: &mut Polyhedra, i: usize| -> Result<bool> {
            self.observer.tell(0)?;
            let faces = self.geometry.faces(i);
            let mut solids = self.geometry.solids(i);
            let is_itself = solids.next().is_some() && solids.next().is_none() && self.output.volume()[i] > 0.0;
            let meets_surface = faces.clone().any(|face| matches!(face.beyond, Beyond::Surface(_)));
            Ok(is_itself && !meets_surface && polyhedra.keeps(self.geometry.points(), faces))
        };
        let some = |range: Range<usize>| -> Result<Vec<bool>> {
            let mut polyhedra = Polyhedra::default();
            range.map(|i| is_one(&mut polyhedra, i)).collect()
        };
        let all: Result<Vec<_>> = parallel::chunks(self.geometry.sites(), CELLS_AT_ONCE, some).into_iter().collect();
        Ok(all?.concat())
    }

    /// The solids of the cell of site `i`.
    fn solids(&self, i: usize) -> Vec<Solid<'_>> {
        match self.polyhedra[i] {
            true => vec![Solid::Polyhedron(self.geometry.faces(i).collect())],
            false => self.geometry.solids(i).flat_map(|faces| self.tetrahedra(&faces)).collect(),
        }
    }

    /// A convex solid as tetrahedra, from one of its corners to the triangles of all faces that do not have it: those of the sign that the solid's
    /// volume has, as the others are rounding.
    fn tetrahedra(&self, faces: &[Face<'_>]) -> Vec<Solid<'static>> {
        let Some(top) = faces.first().map(|face| face.corners[0]) else { return Vec::new() };
        let others = faces.iter().map(|face| face.corners).filter(|corners| !corners.contains(&top));
        let fans = others.flat_map(|corners| corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
        let volumes: Vec<([u32; 3], f64)> = fans.map(|triangle| (triangle, self.volume_of(top, triangle))).collect();
        let volume: f64 = volumes.iter().map(|(_, volume)| volume).sum();
        let kept = volumes.into_iter().filter(|&(_, v)| v != 0.0 && (v > 0.0) == (volume > 0.0));
        kept.map(|([a, b, c], _)| Solid::Tetrahedron([a, c, b, top])).collect()
    }

    /// Refuses cells that their tetrahedra do not fill.
    fn check_solids(&self) -> Result<()> {
        let mean = self.output.volume().iter().map(|v| v.abs()).sum::<f64>() / self.output.volume().len().max(1) as f64;
        let failed = |i: usize| {
            if let Err(ended) = self.observer.tell(0) {
                return Some(ended);
            }
            let volume = |solid| match solid {
                Solid::Polyhedron(_) => self.output.volume()[i],
                Solid::Tetrahedron([a, c, b, top]) => self.volume_of(top, [a, b, c]),
            };
            let expected = self.output.volume()[i];
            let sum: f64 = self.solids(i).into_iter().map(volume).sum();
            let is_off = self.geometry.faces(i).len() > 0 && (sum - expected).abs() > FILLED * mean.max(expected.abs());
            is_off.then(|| {
                Error::input(format!(
                    "the cell of site {i} cannot be written as solids, which fill {sum:e} of {expected:e}: it has too many \
                     parts; write .vtp or .ply, or take more sites"
                ))
            })
        };
        let first = |range: Range<usize>| range.filter(|&i| !self.polyhedra[i]).find_map(failed).map_or(Ok(()), Err);
        parallel::chunks(self.geometry.sites(), CELLS_AT_ONCE, first).into_iter().collect()
    }

    /// The volume of a tetrahedron, of which the triangle is counterclockwise from outside.
    fn volume_of(&self, top: u32, corners: [u32; 3]) -> f64 {
        let at = |i: u32| self.geometry.points()[i as usize];
        let [a, b, c] = corners.map(|i| -> [f64; 3] { std::array::from_fn(|k| at(i)[k] - at(top)[k]) });
        let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
        (a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)) / 6.0
    }

    /// Polyhedra and tetrahedra.
    fn write_vtu(&self, w: &mut dyn Write) -> io::Result<()> {
        let geometry = self.geometry;
        let (mut sites, mut solids): (Vec<u32>, Vec<u32>) = (Vec::new(), Vec::new());
        // Of each solid its points, each once; and of each polyhedron where the numbers end that say its faces.
        let (mut points, mut point_ends): (Vec<u32>, Vec<usize>) = (Vec::new(), Vec::new());
        let (mut words, mut word_ends): (usize, Vec<Option<usize>>) = (0, Vec::new());
        for i in 0..geometry.sites() {
            self.observer.tell(0).map_err(io::Error::other)?;
            for (k, solid) in self.solids(i).into_iter().enumerate() {
                match solid {
                    Solid::Polyhedron(faces) => {
                        let mut corners: Vec<u32> = faces.iter().flat_map(|face| face.corners).copied().collect();
                        words += 1 + faces.len() + corners.len();
                        word_ends.push(Some(words));
                        corners.sort_unstable();
                        corners.dedup();
                        points.extend(corners);
                    }
                    Solid::Tetrahedron(corners) => {
                        word_ends.push(None);
                        points.extend(corners);
                    }
                }
                point_ends.push(points.len());
                sites.push(i as u32);
                solids.push(k as u32);
            }
        }
        let kind = |end: &Option<usize>| if end.is_some() { VTK_POLYHEDRON } else { VTK_TETRA };
        let n = sites.len();
        let mut arrays = self.data(&sites);
        arrays.push(array("CellData", "solid", "Int32", 1, n, |put| {
            solids.iter().try_for_each(|k| put(&k.to_le_bytes()))
        }));
        arrays.extend([
            array("Cells", "connectivity", "Int64", 1, points.len(), |put| {
                points.iter().try_for_each(|&p| put(&i64::from(p).to_le_bytes()))
            }),
            array("Cells", "offsets", "Int64", 1, n, |put| {
                point_ends.iter().try_for_each(|&end| put(&(end as i64).to_le_bytes()))
            }),
            array("Cells", "types", "UInt8", 1, n, |put| word_ends.iter().try_for_each(|end| put(&[kind(end)]))),
        ]);
        if words > 0 {
            arrays.extend([
                // Of each polyhedron: number of faces; then of each face its number of corners and the corners.
                array("Cells", "faces", "Int64", 1, words, |put| {
                    let mut all = (0..geometry.sites()).filter(|&i| self.polyhedra[i]).map(|i| geometry.faces(i));
                    all.try_for_each(|mut faces| {
                        put(&(faces.len() as i64).to_le_bytes())?;
                        faces.try_for_each(|face| put_corners(&face, put))
                    })
                }),
                array("Cells", "faceoffsets", "Int64", 1, n, |put| {
                    word_ends.iter().try_for_each(|end| put(&end.map_or(-1, |end| end as i64).to_le_bytes()))
                }),
            ]);
        }
        let counts = format!("NumberOfPoints=\"{}\" NumberOfCells=\"{n}\"", geometry.points().len());
        write_xml(w, "UnstructuredGrid", &counts, &self.notes(), &["CellData", "Points", "Cells"], &arrays)
    }

    /// Polygons.
    fn write_vtp(&self, w: &mut dyn Write) -> io::Result<()> {
        let sites: Vec<u32> = self.faces().map(|(i, _)| i as u32).collect();
        let n = sites.len();
        let corners: usize = self.faces().map(|(_, face)| face.corners.len()).sum();
        let mut arrays = self.data(&sites);
        arrays.extend([
            array("CellData", "beyond", "Int64", 1, n, |put| {
                self.faces().try_for_each(|(_, face)| put(&i64::from(number_of(face.beyond)).to_le_bytes()))
            }),
            array("Polys", "connectivity", "Int64", 1, corners, |put| {
                let all = self.faces().flat_map(|(_, face)| face.corners);
                all.into_iter().try_for_each(|&p| put(&i64::from(p).to_le_bytes()))
            }),
            array("Polys", "offsets", "Int64", 1, n, |put| {
                let mut end = 0;
                self.faces().try_for_each(|(_, face)| {
                    end += face.corners.len() as i64;
                    put(&end.to_le_bytes())
                })
            }),
        ]);
        let counts = format!(
            "NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{n}\"",
            self.geometry.points().len()
        );
        write_xml(w, "PolyData", &counts, &self.notes(), &["CellData", "Points", "Polys"], &arrays)
    }

    /// Polygons, binary.
    fn write_ply(&self, w: &mut dyn Write) -> io::Result<()> {
        writeln!(w, "ply\nformat binary_little_endian 1.0\nelement vertex {}", self.geometry.points().len())?;
        writeln!(w, "property double x\nproperty double y\nproperty double z\nelement face {}", self.faces().count())?;
        writeln!(
            w,
            "property list int int vertex_indices\nproperty int site\nproperty int beyond\nproperty double volume"
        )?;
        writeln!(w, "end_header")?;
        self.geometry.points().iter().flatten().try_for_each(|x| w.write_all(&x.to_le_bytes()))?;
        self.faces().try_for_each(|(i, face)| {
            w.write_all(&(face.corners.len() as u32).to_le_bytes())?;
            face.corners.iter().try_for_each(|p| w.write_all(&p.to_le_bytes()))?;
            w.write_all(&(i as u32).to_le_bytes())?;
            w.write_all(&number_of(face.beyond).to_le_bytes())?;
            w.write_all(&self.output.volume()[i].to_le_bytes())
        })
    }
}

/// The site on the other side, or −1 for the outside of the domain, −2 for that of the box.
fn number_of(beyond: Beyond) -> i32 {
    match beyond {
        Beyond::Site(i) => i as i32,
        Beyond::Surface(_) | Beyond::Nothing => -1,
        Beyond::Box(_) => -2,
    }
}

fn put_corners(face: &Face<'_>, put: &mut Put<'_>) -> io::Result<()> {
    put(&(face.corners.len() as i64).to_le_bytes())?;
    face.corners.iter().try_for_each(|&p| put(&i64::from(p).to_le_bytes()))
}

#[cfg(test)]
mod tests {
    use super::super::scratch;
    use super::*;
    use crate::oracle::Naive;
    use crate::{Backend, CellStatus, Domain, OutputArrays, Request, shapes};

    /// Two sites in a tetrahedron's box, the second with a weight that leaves the other nothing in a third case.
    fn case(weight: f64) -> (PowerDiagram, Output) {
        let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let domain = Domain::new(&vertices, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
        let diagram =
            PowerDiagram::new(&[[0.25; 3], [0.75, 0.25, 0.25]], &[0.0, weight]).unwrap().restricted_to(&domain);
        let output = Naive::default().evaluate(&diagram, &Request::moments().with_facets().with_solids()).unwrap();
        (diagram, output)
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
        let folder = scratch("geometry");
        let (diagram, output) = case(0.0);
        for name in ["cells.vtu", "cells.vtp"] {
            write_geometry(folder.join(name), &diagram, &output).unwrap();
            let arrays = announced(&std::fs::read(folder.join(name)).unwrap());
            let bytes = |name: &str| &arrays.iter().find(|(n, _)| n == name).unwrap().1;
            let floats = |name: &str| -> Vec<f64> {
                bytes(name).as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
            };
            let integers = |name: &str| -> Vec<i64> {
                bytes(name).as_chunks::<8>().0.iter().map(|b| i64::from_le_bytes(*b)).collect()
            };
            // A tetrahedron cut in two: a frustum of five faces, and a tetrahedron; the cut's three corners are shared.
            assert_eq!(floats("Points").len(), 3 * 7);
            if name == "cells.vtu" {
                assert_eq!(integers("site"), [0, 0, 0, 1]);
                assert_eq!(&floats("volume")[2..], output.volume());
                assert_eq!(floats("barycenter")[9..], output.barycenter()[1]);
                assert_eq!(integers("facets"), [2; 4], "one to each other, and the boundary");
                assert_eq!(bytes("status"), &[0; 4]);
                assert_eq!(bytes("types"), &[10; 4]);
                assert_eq!(integers("offsets"), [4, 8, 12, 16]);
                assert_eq!(bytes("solid").len(), 4 * 4);
            } else {
                assert_eq!(integers("site"), [0, 0, 0, 0, 0, 1, 1, 1, 1]);
                let beyond = integers("beyond");
                assert_eq!(beyond.iter().filter(|&&b| b == -1).count(), 7);
                assert_eq!(beyond.iter().filter(|&&b| b >= 0).copied().collect::<Vec<_>>(), [1, 0]);
                assert_eq!(integers("offsets").last(), Some(&30));
            }
        }
        let boxed = PowerDiagram::new(diagram.positions(), &[]).unwrap().in_box([0.0; 3], [1.0; 3]).unwrap();
        let output_in_box = Naive::default().evaluate(&boxed, &Request::moments().with_solids()).unwrap();
        write_geometry(folder.join("box.vtu"), &boxed, &output_in_box).unwrap();
        let arrays = announced(&std::fs::read(folder.join("box.vtu")).unwrap());
        let bytes = |name: &str| &arrays.iter().find(|(n, _)| n == name).unwrap().1;
        let integers = |name: &str| -> Vec<i64> {
            bytes(name).as_chunks::<8>().0.iter().map(|b| i64::from_le_bytes(*b)).collect()
        };
        assert_eq!((bytes("types"), integers("offsets")), (&vec![42, 42], vec![8, 16]));
        assert_eq!((integers("faceoffsets"), integers("faces")[0]), (vec![31, 62], 6));
        write_geometry(folder.join("cells.ply"), &diagram, &output).unwrap();
        let mesh = super::super::read_mesh(folder.join("cells.ply")).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (7, 2 * 6));
    }

    /// The sum of a `.vtu`'s tetrahedra, as VTK has their volumes.
    #[test]
    fn tetrahedra_are_turned_where_the_winding_number_is_negative() {
        let path = scratch("geometry-turned").join("cells.vtu");
        let bar = shapes::cuboid([0.5, 0.2, 0.3], [2.0, 0.8, 0.7]).flipped();
        let domain = shapes::cuboid([0.0; 3], [1.0; 3]).merged(&bar).domain();
        let sites = [[0.2, 0.5, 0.5], [0.9, 0.6, 0.4], [1.7, 0.4, 0.6]];
        let diagram = PowerDiagram::new(&sites, &[]).unwrap().restricted_to(&domain);
        let output = Naive::default().evaluate(&diagram, &Request::moments().with_solids()).unwrap();
        write_geometry(&path, &diagram, &output).unwrap();
        let arrays = announced(&std::fs::read(&path).unwrap());
        let words = |name: &str| arrays.iter().find(|(n, _)| n == name).unwrap().1.as_chunks::<8>().0;
        let points: Vec<f64> = words("Points").iter().map(|b| f64::from_le_bytes(*b)).collect();
        assert_eq!(arrays.iter().find(|(n, _)| n == "types").unwrap().1, vec![VTK_TETRA; words("site").len()]);
        let mut volumes = [0.0; 3];
        for (site, corners) in words("site").iter().zip(words("connectivity").as_chunks::<4>().0) {
            let [p, a, b, c] = corners.map(|i| &points[3 * i64::from_le_bytes(i) as usize..][..3]);
            let [a, b, c] = [a, b, c].map(|x| [0, 1, 2].map(|k| x[k] - p[k]));
            let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
            let volume = (a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)) / 6.0;
            volumes[i64::from_le_bytes(*site) as usize] += volume;
        }
        for (volume, expected) in volumes.iter().zip(output.volume()) {
            assert!((volume - expected).abs() < 1e-13, "{volumes:?} for {:?}", output.volume());
        }
        assert!(volumes[2] < -0.1);
    }

    #[test]
    fn empty_cells_have_no_faces() {
        let path = scratch("geometry-empty").join("cells.vtu");
        let (diagram, output) = case(10.0);
        assert_eq!(output.status()[0], CellStatus::Empty);
        write_geometry(&path, &diagram, &output).unwrap();
        let arrays = announced(&std::fs::read(&path).unwrap());
        assert_eq!(arrays.iter().find(|(n, _)| n == "site").unwrap().1, 1_i64.to_le_bytes());
    }

    #[test]
    fn what_does_not_fit_leaves_nothing() {
        let folder = scratch("geometry-misfit");
        let (diagram, output) = case(0.0);
        let other = PowerDiagram::new(&[[0.5; 3]], &[]).unwrap();
        assert!(write_geometry(folder.join("cells.vtk"), &diagram, &output).is_err());
        assert!(write_geometry(folder.join("cells.vtu"), &other, &output).is_err());
        let polygons = Naive::default().evaluate(&diagram, &Request::moments().with_geometry()).unwrap();
        let error = write_geometry(folder.join("cells.vtu"), &diagram, &polygons).unwrap_err().to_string();
        assert!(error.contains("with_solids"), "{error}");
        let path = Path::new("cells.glb");
        assert!(refuse_beyond(path, 7, 7, "bytes, and .glb has room for", ".vtp").is_ok());
        let error = refuse_beyond(path, 8, 7, "bytes, and .glb has room for", ".vtp").unwrap_err().to_string();
        assert_eq!(error, "cells.glb: it would have 8 bytes, and .glb has room for 7; write .vtp");
        let without = Output::new(OutputArrays { geometry: None, ..output.into_arrays() }).unwrap();
        let error = write_geometry(folder.join("cells.vtu"), &diagram, &without).unwrap_err().to_string();
        assert!(error.contains("with_geometry"), "{error}");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
    }
}
