//! VTK's older files (`.vtk`) of PolyData, text or binary, as VTK, PyVista and ParaView write them: versions up to 5.1.
//!
//! `vtkio` reads them too, and brings 33 crates.

use std::io::BufRead;

use super::Mesh;
use super::lines::{Lines, finite, shown};
use super::mesh::add_polygon;
use crate::{Error, Result, memory};

/// The version from which cells are offsets and corners.
const FIRST_WITH_OFFSETS: f64 = 5.1;

/// Reads points and polygons; what else there is, is passed over.
///
/// # Errors
/// `Input`, with the line or the number of the value.
pub(super) fn parse(reader: impl BufRead) -> Result<Mesh> {
    let mut lines = Lines::new(reader);
    lines.read_raw()?;
    let first = String::from_utf8_lossy(lines.raw());
    let version = first.strip_prefix("# vtk DataFile Version").and_then(|version| version.trim().parse::<f64>().ok());
    let Some(version) = version else {
        return Err(lines.wrong("not a .vtk file: it should begin with '# vtk DataFile Version' and a number"));
    };
    // The title says nothing, and may begin with anything.
    lines.read_raw()?;
    let is_binary = match next(&mut lines)?.as_str() {
        "ASCII" => false,
        "BINARY" => true,
        other => return Err(lines.wrong(format_args!("'{}'; ASCII or BINARY is needed", shown(other)))),
    };
    let mut file = File { lines, is_binary, has_offsets: version >= FIRST_WITH_OFFSETS };
    let mut mesh = Mesh::default();
    loop {
        let line = next(&mut file.lines)?;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match *words.as_slice() {
            [] if file.lines.is_at_end() => return Ok(mesh),
            ["DATASET", "POLYDATA"] => {}
            ["DATASET", kind] => {
                return Err(file.lines.wrong(format_args!(
                    "a data set {}; POLYDATA is needed, a surface (PyVista: extract_surface)",
                    shown(kind)
                )));
            }
            ["POINTS", count, kind] => {
                let numbers = 3 * file.count(count)?;
                let mut point = [0.0; 3];
                file.values(numbers, kind, |k, x| {
                    if !x.is_finite() {
                        return Err(format!("point {}: {x} is not finite", k / 3));
                    }
                    point[(k % 3) as usize] = x;
                    if k % 3 == 2 { add(&mut mesh.vertices, point, "points") } else { Ok(()) }
                })?;
            }
            ["POLYGONS", count, numbers] => file.cells(count, numbers, |corners| add_polygon(&mut mesh, corners))?,
            ["VERTICES" | "LINES", count, numbers] => file.cells(count, numbers, |_| Ok(()))?,
            ["TRIANGLE_STRIPS", ..] => {
                return Err(file
                    .lines
                    .wrong("strips of triangles are not read; save it as polygons (PyVista: triangulate)"));
            }
            ["FIELD", _, arrays] => {
                for _ in 0..file.count(arrays)? {
                    file.pass_over_array()?;
                }
            }
            // Up to an empty line.
            ["METADATA"] => while file.lines.read_raw()? && !file.lines.raw().is_empty() {},
            // What is known of points and polygons comes after them.
            ["POINT_DATA" | "CELL_DATA", ..] => return Ok(mesh),
            _ => return Err(file.lines.wrong(format_args!("'{}' is no part of PolyData", shown(&line)))),
        }
    }
}

/// The next line that is not empty, or an empty one at the end.
fn next(lines: &mut Lines<impl BufRead>) -> Result<String> {
    while lines.read_raw()? {
        let line = String::from_utf8_lossy(lines.raw());
        if !line.trim().is_empty() {
            return Ok(line.trim().to_owned());
        }
    }
    Ok(String::new())
}

fn add<T>(list: &mut Vec<T>, value: T, what: &str) -> std::result::Result<(), String> {
    memory::push(list, value, what).map_err(|e| e.to_string())
}

struct File<R> {
    lines: Lines<R>,
    is_binary: bool,
    has_offsets: bool,
}

impl<R: BufRead> File<R> {
    fn count(&self, word: &str) -> Result<u64> {
        let count = word.parse().ok().filter(|&count: &u64| count < 1 << 40);
        count.ok_or_else(|| self.lines.wrong(format_args!("'{}' is no number of things", shown(word))))
    }

    /// The corners of each cell, in the older form (their number before them) or, from version 5.1, as offsets and corners.
    fn cells(&mut self, count: &str, numbers: &str, mut put: impl FnMut(&[f64]) -> Result<()>) -> Result<()> {
        let (count, numbers) = (self.count(count)?, self.count(numbers)?);
        let mut all: Vec<f64> = Vec::new();
        if self.has_offsets {
            let mut offsets: Vec<f64> = Vec::new();
            let kind = self.kind_of("OFFSETS")?;
            self.values(count, &kind, |_, x| add(&mut offsets, x, "polygons"))?;
            let kind = self.kind_of("CONNECTIVITY")?;
            self.values(numbers, &kind, |_, x| add(&mut all, x, "corners"))?;
            let wrong = || Error::input("the offsets of its polygons do not fit their corners");
            return offsets.windows(2).try_for_each(|ends| put(within(&all, ends[0], ends[1]).ok_or_else(wrong)?));
        }
        self.values(numbers, "int", |_, x| add(&mut all, x, "corners"))?;
        let mut rest = all.as_slice();
        for i in 0..count {
            let cell = rest.split_first().and_then(|(&corners, after)| Some((within(after, 0.0, corners)?, after)));
            let (cell, after) = cell.ok_or_else(|| Error::input(format!("cell {i} of {count} is not whole")))?;
            put(cell)?;
            rest = &after[cell.len()..];
        }
        Ok(())
    }

    /// The type in a line of `name` and a type.
    fn kind_of(&mut self, name: &str) -> Result<String> {
        let line = next(&mut self.lines)?;
        let kind = line.strip_prefix(name).map(|kind| kind.trim().to_owned());
        kind.ok_or_else(|| self.lines.wrong(format_args!("'{}'; {name} and a type are needed", shown(&line))))
    }

    fn pass_over_array(&mut self) -> Result<()> {
        let mut line = next(&mut self.lines)?;
        if line == "METADATA" {
            while self.lines.read_raw()? && !self.lines.raw().is_empty() {}
            line = next(&mut self.lines)?;
        }
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let [_, components, rows, kind] = *words.as_slice() else {
            return Err(self.lines.wrong(format_args!("'{}' is no array of a field", shown(&line))));
        };
        let numbers = self.count(components)?.saturating_mul(self.count(rows)?);
        if kind == "string" {
            // One a line, its length before it where the file is binary, which is no line.
            if self.is_binary {
                return Err(self.lines.wrong("a field of words in a binary file is not read; save it without fields"));
            }
            for _ in 0..numbers {
                if !self.lines.read_raw()? {
                    break;
                }
            }
            return Ok(());
        }
        self.values(numbers, kind, |_, _| Ok(()))
    }

    /// Hands so many values on, each with its number.
    fn values(
        &mut self,
        count: u64,
        kind: &str,
        mut put: impl FnMut(u64, f64) -> std::result::Result<(), String>,
    ) -> Result<()> {
        let number = match kind {
            "float" => |b: &[u8; 8]| f64::from(f32::from_be_bytes([b[0], b[1], b[2], b[3]])),
            "double" => |b: &[u8; 8]| f64::from_be_bytes(*b),
            "int" | "vtkIdType" | "vtktypeint32" => {
                |b: &[u8; 8]| f64::from(i32::from_be_bytes([b[0], b[1], b[2], b[3]]))
            }
            "unsigned_int" => |b: &[u8; 8]| f64::from(u32::from_be_bytes([b[0], b[1], b[2], b[3]])),
            "long" | "unsigned_long" | "vtktypeint64" => |b: &[u8; 8]| i64::from_be_bytes(*b) as f64,
            "short" => |b: &[u8; 8]| f64::from(i16::from_be_bytes([b[0], b[1]])),
            "unsigned_short" => |b: &[u8; 8]| f64::from(u16::from_be_bytes([b[0], b[1]])),
            "char" => |b: &[u8; 8]| f64::from(b[0] as i8),
            "unsigned_char" => |b: &[u8; 8]| f64::from(b[0]),
            _ => return Err(self.lines.wrong(format_args!("numbers of type '{}' are not read", shown(kind)))),
        };
        let size = match kind {
            "double" | "long" | "unsigned_long" | "vtktypeint64" => 8,
            "short" | "unsigned_short" => 2,
            "char" | "unsigned_char" => 1,
            _ => 4,
        };
        let ends = |k: u64| Error::input(format!("the file ends after {k} of {count} numbers"));
        if self.is_binary {
            let at = self.lines.number();
            let mut bytes = [0; 8];
            for k in 0..count {
                self.lines.rest().read_exact(&mut bytes[..size]).map_err(|_| ends(k).on_line(at))?;
                put(k, number(&bytes)).map_err(|what| Error::input(what).on_line(at))?;
            }
            return Ok(());
        }
        let mut k = 0;
        while k < count {
            let Some(line) = self.lines.next_line()? else { return Err(ends(k)) };
            let mut found = Ok(());
            for word in line.split_ascii_whitespace() {
                found = if k == count {
                    Err(format!("more than {count} numbers"))
                } else {
                    finite(word).and_then(|x| put(k, if kind == "float" { f64::from(x as f32) } else { x }))
                };
                if found.is_err() {
                    break;
                }
                k += 1;
            }
            found.map_err(|what| self.lines.wrong(what))?;
        }
        Ok(())
    }
}

/// `all[start..end]`, if these are indices and in order.
pub(super) fn within(all: &[f64], start: f64, end: f64) -> Option<&[f64]> {
    let is_index = |x: f64| x >= 0.0 && x <= all.len() as f64 && x.fract() == 0.0;
    if is_index(start) && is_index(end) { all.get(start as usize..end as usize) } else { None }
}

#[cfg(test)]
mod tests {
    use super::super::{parse_mesh, parse_sites};

    const TEXT: &str = "# vtk DataFile Version 3.0\n# a title\nASCII\nDATASET POLYDATA\nFIELD FieldData 1\ntime 1 2 double\n0.5 1\n\
        POINTS 4 float\n0 0 0 1 0 0\n0 1 0 0\n0 1.5\nVERTICES 1 2\n1 0\nPOLYGONS 2 9\n3 0 2 1\n4 0 1 2 3\nPOINT_DATA 4\nSCALARS a float\n";

    const TRIANGLES: [[u32; 3]; 3] = [[0, 2, 1], [0, 1, 2], [0, 2, 3]];

    /// The same as version 5.1 has it, in big-endian numbers.
    fn binary() -> Vec<u8> {
        let mut file = b"# vtk DataFile Version 5.1\nvtk output\nBINARY\nDATASET POLYDATA\nPOINTS 4 double\n".to_vec();
        let numbers = [0.0_f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.5];
        file.extend(numbers.into_iter().flat_map(f64::to_be_bytes));
        file.extend(b"\nMETADATA\nINFORMATION 0\n\nPOLYGONS 3 7\nOFFSETS vtktypeint64\n");
        file.extend([0_i64, 3, 7].into_iter().flat_map(i64::to_be_bytes));
        file.extend(b"\nCONNECTIVITY vtktypeint64\n");
        file.extend([0_i64, 2, 1, 0, 1, 2, 3].into_iter().flat_map(i64::to_be_bytes));
        file.extend(b"\nCELL_DATA 2\n");
        file
    }

    #[test]
    fn text_and_binary_are_one_mesh() {
        for file in [TEXT.as_bytes(), &TEXT.replace('\n', "\r\n").into_bytes(), &binary()] {
            let mesh = parse_mesh(file, "m.vtk").unwrap();
            assert_eq!(mesh.vertices, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]]);
            assert_eq!(mesh.triangles, TRIANGLES);
            assert_eq!(parse_sites(file, "m.vtk").unwrap().positions, mesh.vertices);
        }
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        let wrong = |from: &str, to: &str| {
            assert!(TEXT.contains(from));
            parse_mesh(TEXT.replace(from, to).as_bytes(), "m.vtk").unwrap_err().to_string().replace("m.vtk: ", "")
        };
        assert!(wrong("# vtk", "vtk").starts_with("line 1: not a .vtk file"));
        assert_eq!(wrong("ASCII", "TEXT"), "line 3: 'TEXT'; ASCII or BINARY is needed");
        assert!(
            wrong("POLYDATA", "UNSTRUCTURED_GRID")
                .starts_with("line 4: a data set UNSTRUCTURED_GRID; POLYDATA is needed")
        );
        assert_eq!(wrong("0 1.5", "0 x"), "line 11: 'x' is not a number");
        assert_eq!(wrong("0 1.5", "0 1.5 7"), "line 11: more than 12 numbers");
        assert_eq!(wrong("POLYGONS 2 9", "POLYGONS 3 9"), "cell 2 of 3 is not whole");
        assert_eq!(wrong("4 0 1 2 3", "4 0 1 2 4"), "vertex 4 of 4 (from 0) does not exist");
        assert_eq!(wrong("3 0 2 1\n4 0 1 2 3\n", "2 0 2\n5 0 1 2 3 0\n"), "2 corners; at least 3 are needed");
        assert!(wrong("VERTICES 1 2", "TRIANGLE_STRIPS 1 2").starts_with("line 12: strips of triangles are not read"));
        let cut = &binary()[..150];
        assert_eq!(
            parse_mesh(cut, "m.vtk").unwrap_err().to_string(),
            "m.vtk: line 5: the file ends after 9 of 12 numbers"
        );
    }
}
