//! Meshes, and the domains made of them.

use std::io::BufRead;
use std::path::Path;

use super::{Form, MESH_ENDINGS, legacy_vtk, obj, off, open, ply, stl, vtp};
use crate::{Domain, Error, Result, memory};

/// A triangle mesh as a file holds it: not checked for anything but finite coordinates and indices that exist.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Mesh {
    /// Positions of the vertices.
    pub vertices: Vec<[f64; 3]>,
    /// Triangles, as indices into `vertices`. A polygon becomes a fan from its first corner, which keeps a closed mesh
    /// closed and encloses what the polygon encloses, convex or not, as long as it is flat.
    pub triangles: Vec<[u32; 3]>,
}

/// Reads a mesh by the file's ending: `.obj` (Wavefront), `.off` (text), `.ply` (text or binary), `.stl` (text or binary, three
/// vertices a triangle: [`Domain::new`] welds them), `.vtk` or `.vtp` (VTK's PolyData; the latter takes the feature `packed`); also with
/// `.gz` after it, packed by gzip (feature `packed`).
///
/// # Errors
/// `Io` where the file cannot be read; `Input`, with file and line (of binary files: vertex or face), where it is not what
/// its ending says.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<Mesh> {
    let path = path.as_ref();
    let form = Form::of(path, MESH_ENDINGS)?;
    let (reader, _) = open(path)?;
    parse(form.unpacked(reader), form.ending).map_err(|e| e.in_file(path))
}

/// Reads a mesh from the bytes of a file called `name`, as [`read_mesh`] does.
///
/// # Errors
/// `Input`, as [`read_mesh`].
pub fn parse_mesh(bytes: &[u8], name: impl AsRef<Path>) -> Result<Mesh> {
    let name = name.as_ref();
    let form = Form::of(name, MESH_ENDINGS)?;
    parse(form.unpacked(bytes), form.ending).map_err(|e| e.in_file(name))
}

fn parse(reader: impl BufRead, format: &str) -> Result<Mesh> {
    let mesh = match format {
        ".off" => off::parse_off(reader),
        ".ply" => ply::parse_mesh(reader),
        ".stl" => stl::parse_stl(reader),
        ".vtk" => legacy_vtk::parse(reader),
        ".vtp" => vtp::parse(reader),
        _ => obj::parse_obj(reader),
    }?;
    if mesh.triangles.is_empty() {
        return Err(Error::input("no faces in it; a closed triangle mesh is needed"));
    }
    Ok(mesh)
}

/// The triangles of a polygon: a fan from its first corner.
pub(super) fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]])
}

/// Adds a polygon whose corners are numbers of vertices, as VTK's files hold them.
///
/// # Errors
/// `Input` where they are none, or too few.
pub(super) fn add_polygon(mesh: &mut Mesh, corners: &[f64]) -> Result<()> {
    if corners.len() < 3 {
        return Err(Error::input(format!("{} corners; at least 3 are needed", corners.len())));
    }
    let count = mesh.vertices.len();
    let is_vertex = |x: f64| x >= 0.0 && x < count as f64 && x <= f64::from(u32::MAX) && x.fract() == 0.0;
    if let Some(x) = corners.iter().find(|&&x| !is_vertex(x)) {
        return Err(Error::input(format!("vertex {x} of {count} (from 0) does not exist")));
    }
    let corners: Vec<u32> = corners.iter().map(|&x| x as u32).collect();
    fan(&corners).try_for_each(|triangle| memory::push(&mut mesh.triangles, triangle, "triangles"))
}

impl Domain {
    /// Reads a domain from a closed triangle mesh by the file's ending, as [`read_mesh`] does, and validates it as
    /// [`Domain::new`] does.
    ///
    /// # Errors
    /// As [`read_mesh`], and `Input` where the mesh is not closed.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let mesh = read_mesh(path)?;
        Self::new(&mesh.vertices, &mesh.triangles).map_err(|e| e.in_file(path))
    }

    /// Reads a domain as [`Domain::load`] does, and orients it as [`Domain::oriented`] does.
    ///
    /// # Errors
    /// As [`Domain::load`].
    pub fn load_oriented(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let mesh = read_mesh(path)?;
        Self::oriented(&mesh.vertices, &mesh.triangles).map_err(|e| e.in_file(path))
    }

    /// Reads a domain from the text of an `.obj` file in memory.
    ///
    /// # Errors
    /// `Input`, with the line, where it is not one, and where the mesh is not closed.
    pub fn from_obj(text: &[u8]) -> Result<Self> {
        let mesh = obj::parse_obj(text)?;
        Self::new(&mesh.vertices, &mesh.triangles)
    }
}

#[cfg(test)]
mod tests {
    use super::super::scratch;
    use super::*;
    use crate::ErrorKind;

    #[test]
    fn errors_name_the_file() {
        let folder = scratch("mesh");
        let path = folder.join("m.off");
        assert_eq!(read_mesh(&path).unwrap_err().kind(), ErrorKind::Io);
        std::fs::write(&path, "OFF\n1 1 0\n").unwrap();
        let expected = format!("{}: line 3: the file ends after 0 of 1 vertices", path.display());
        assert_eq!(read_mesh(&path).unwrap_err().to_string(), expected);
        std::fs::write(&path, "OFF\n0 0 0\n").unwrap();
        assert!(read_mesh(&path).unwrap_err().to_string().starts_with(&format!("{}: no faces in it", path.display())));
        assert!(Domain::load(folder.join("m.3ds")).unwrap_err().to_string().contains("known here: .obj, .off"));
        // A folder with the ending of a mesh.
        std::fs::create_dir(folder.join("d.obj")).unwrap();
        assert!(
            read_mesh(folder.join("d.obj")).unwrap_err().to_string().ends_with("d.obj: it is a folder; name a file")
        );
    }

    #[test]
    fn a_file_and_its_text_are_the_same_domain() {
        let made = crate::shapes::swan();
        let mut text: String = made.vertices.iter().map(|[x, y, z]| format!("v {x:?} {y:?} {z:?}\n")).collect();
        text.extend(made.triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1)));
        let path = scratch("domain").join("swan.obj");
        std::fs::write(&path, &text).unwrap();
        for domain in [Domain::load(&path).unwrap(), Domain::from_obj(text.as_bytes()).unwrap()] {
            assert_eq!((domain.vertices().len(), domain.triangles().len()), (2018, 4032));
            assert_eq!(domain.volume(), made.domain().volume());
        }
    }
}
