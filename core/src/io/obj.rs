//! Wavefront OBJ, through `tobj`.

use std::io::{self, BufRead, Read};

use tobj::{LoadError, LoadOptions};

use super::Mesh;
use super::lines::{Lines, finite};
use crate::{Error, Result};

/// Reads vertices, and faces cut into fans of triangles; groups, materials, normals and textures are skipped.
///
/// # Errors
/// `Input`, with the line.
pub(super) fn parse_obj(reader: impl BufRead) -> Result<Mesh> {
    let mut geometry = Geometry::new(reader);
    let options = LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..LoadOptions::default() };
    let loaded = tobj::load_obj_buf(&mut geometry, &options, |_| Ok(Default::default()));
    let (models, _) = match loaded {
        Ok(loaded) => loaded,
        Err(error) => return Err(geometry.explain(error)),
    };
    let mut mesh = Mesh::default();
    for model in models {
        // `tobj` numbers the vertices of each model anew.
        let base = mesh.vertices.len() as u32;
        mesh.vertices.extend(model.mesh.positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
        let (triangles, _) = model.mesh.indices.as_chunks::<3>();
        mesh.triangles.extend(triangles.iter().map(|t| t.map(|i| base + i)));
    }
    Ok(mesh)
}

/// The lines of an OBJ file that say geometry, as `tobj` reads them without a fault of its own: it takes comments that
/// are not UTF-8 for read errors, refuses a mesh for an index of a texture or a normal, computes with such indices unchecked,
/// and wants colours on all vertices or on none.
struct Geometry<R> {
    lines: Lines<R>,
    /// The line being handed on, and how much of it is.
    buffer: Vec<u8>,
    taken: usize,
    vertices: i64,
    /// Largest index of a face so far, and its line: `tobj` looks at indices only at the end.
    largest: (i64, usize),
    error: Option<Error>,
}

impl<R: BufRead> Geometry<R> {
    fn new(reader: R) -> Self {
        Self { lines: Lines::new(reader), buffer: Vec::new(), taken: 0, vertices: 0, largest: (0, 0), error: None }
    }

    /// Makes the buffer the next line of geometry, or empty at the end.
    fn advance(&mut self) -> Result<()> {
        self.buffer.clear();
        self.taken = 0;
        let mut statement = Vec::new();
        while self.lines.read_raw()? {
            statement.extend_from_slice(self.lines.raw());
            if statement.last() == Some(&b'\\') {
                // The statement goes on in the next line.
                statement.pop();
                continue;
            }
            self.take_statement(&statement)?;
            if !self.buffer.is_empty() {
                return Ok(());
            }
            statement.clear();
        }
        Ok(())
    }

    /// Puts what a statement says of geometry into the buffer; leaves it empty if it says none.
    fn take_statement(&mut self, statement: &[u8]) -> Result<()> {
        let mut words = statement.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        let keyword = match words.next() {
            Some(b"v") => b'v',
            Some(b"f") => b'f',
            _ => return Ok(()),
        };
        let words: Vec<&[u8]> = words.take_while(|w| !w.starts_with(b"#")).collect();
        self.buffer.push(keyword);
        if keyword == b'v' {
            self.vertices += 1;
            // x y z, or x y z w; a colour follows three coordinates.
            let coordinates = if words.len() == 4 { 4 } else { 3 };
            if words.len() < 3 {
                return Err(self.lines.wrong(format_args!("a vertex with {} coordinates; 3 are needed", words.len())));
            }
            for word in words.iter().take(coordinates) {
                // Here, since `tobj` takes `nan` and `inf` for numbers.
                let number = std::str::from_utf8(word).map_err(|_| "not text".to_owned()).and_then(finite);
                number.map_err(|what| self.lines.wrong(what))?;
                self.buffer.push(b' ');
                self.buffer.extend_from_slice(word);
            }
        } else {
            if words.len() < 3 {
                return Err(self
                    .lines
                    .wrong(format_args!("a face with {} corners; at least 3 are needed", words.len())));
            }
            for word in words {
                let vertex = word.split(|&b| b == b'/').next().unwrap_or_default();
                let index = std::str::from_utf8(vertex).ok().and_then(|v| v.parse::<i64>().ok());
                match index {
                    Some(0) => return Err(self.lines.wrong("vertex 0: OBJ counts from 1")),
                    Some(i) if i < -self.vertices => {
                        let count = self.vertices;
                        return Err(self.lines.wrong(format_args!("vertex {i} of the {count} so far does not exist")));
                    }
                    Some(i) if i > self.largest.0 => self.largest = (i, self.lines.number()),
                    // What is no number `tobj` will say.
                    _ => {}
                }
                self.buffer.push(b' ');
                self.buffer.extend_from_slice(vertex);
            }
        }
        self.buffer.push(b'\n');
        Ok(())
    }

    /// What went wrong, with its line.
    fn explain(self, error: LoadError) -> Error {
        if let Some(error) = self.error {
            return error;
        }
        let (index, line) = self.largest;
        match error {
            LoadError::FaceVertexOutOfBounds if index > self.vertices => {
                Error::input(format!("vertex {index} of {} does not exist", self.vertices)).on_line(line)
            }
            LoadError::PositionParseError => self.lines.wrong("a vertex needs three numbers"),
            LoadError::ScalingByZeroError => self.lines.wrong("the fourth coordinate of a vertex is 0"),
            LoadError::FaceParseError => self.lines.wrong("a face needs the numbers of its vertices"),
            other => self.lines.wrong(other),
        }
    }
}

impl<R: BufRead> BufRead for Geometry<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.taken == self.buffer.len()
            && let Err(error) = self.advance()
        {
            let told = super::atomic::as_io(&error);
            self.error = Some(error);
            return Err(told);
        }
        Ok(&self.buffer[self.taken..])
    }

    fn consume(&mut self, amount: usize) {
        self.taken += amount;
    }
}

impl<R: BufRead> Read for Geometry<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let amount = self.fill_buf()?.read(out)?;
        self.consume(amount);
        Ok(amount)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_materials_textures_and_comments_do_not_matter() {
        let plain =
            parse_obj(&b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"[..]).unwrap();
        assert_eq!(plain.triangles.len(), 4);
        let dressed = b"# caf\xe9\nmtllib none.mtl\no a\nv 0 0 0 1 0 0\nv 2 0 0 2\nvt 0 0\nv 0 1 0\nv 0 0 1 # top\n\
            g one\nusemtl red\nf 1/1 3/9/9 2//7\ng two\nf -4 -3 \\\n -1\ns off\nusemtl blue\nf 2 3 4\nl 1 2\np 1\nf 3/-99 1 4\n";
        assert_eq!(parse_obj(&dressed[..]).unwrap(), plain);
        let quad = parse_obj(&b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\nf 1 2 3 4 5\n"[..]).unwrap();
        assert_eq!(quad.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        let wrong = |text: &str| parse_obj(text.as_bytes()).unwrap_err().to_string();
        assert_eq!(wrong("v 0 0 0\n\nv 0 x 0\n"), "line 3: 'x' is not a number");
        assert_eq!(wrong("v 0 0 nan\n"), "line 1: 'nan' is not finite");
        assert_eq!(wrong("v 0 0\n"), "line 1: a vertex with 2 coordinates; 3 are needed");
        assert_eq!(wrong("v 0 0 0 0\n"), "line 1: the fourth coordinate of a vertex is 0");
        assert_eq!(wrong("v 0 0 0\nf 1 1\n"), "line 2: a face with 2 corners; at least 3 are needed");
        assert_eq!(wrong("v 0 0 0\nf 1 a 1\n"), "line 2: a face needs the numbers of its vertices");
        assert_eq!(wrong("v 0 0 0\nf 1 1 7\nv 1 1 1\n"), "line 2: vertex 7 of 2 does not exist");
        assert_eq!(wrong("v 0 0 0\nf 1 1 -2\n"), "line 2: vertex -2 of the 1 so far does not exist");
        assert_eq!(wrong("v 0 0 0\nf 0 1 1\n"), "line 2: vertex 0: OBJ counts from 1");
        assert!(wrong("f 9223372036854775807 -9223372036854775808 1\n").contains("does not exist"));
    }
}
