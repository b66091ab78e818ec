//! Polygon files (`.ply`), text and binary.
//!
//! Not through `ply-rs-bw`: an element without properties makes it count to whatever the header claims, keeping something for each; of
//! two properties or elements of one name it drops one and reads on at the wrong place; it refuses `nan` in properties that do not
//! matter, and says nothing of which vertex is wrong.

use std::io::{self, BufRead, Read, Write};

use super::lines::{Lines, shown};
use super::mesh::fan;
use super::{Mesh, SitesFile, cannot_read};
use crate::{Error, Result};

/// Reads the vertices as sites, with the property `w` or `weight` as weights if there is one.
///
/// # Errors
/// `Input`, with the line or the number of the vertex.
pub(super) fn parse_sites(reader: impl BufRead) -> Result<SitesFile> {
    let mut sites = SitesFile::default();
    let mut file = Ply::open(reader)?;
    let columns = file.coordinates()?;
    let vertices = &file.elements[file.find("vertex")?];
    let weight = vertices.properties.iter().position(|p| (p.name == "w" || p.name == "weight") && p.count.is_none());
    file.for_each(|element, row| {
        if element == "vertex" {
            sites.positions.push(point(row, columns)?);
            if let Some(k) = weight {
                sites.weights.push(number(row, k, "weight")?);
            }
        }
        Ok(())
    })?;
    Ok(sites)
}

/// Reads vertices, and faces cut into fans of triangles; every other element and property is skipped.
///
/// # Errors
/// `Input`, with the line or the number of the vertex or face.
pub(super) fn parse_mesh(reader: impl BufRead) -> Result<Mesh> {
    let mut mesh = Mesh::default();
    let mut file = Ply::open(reader)?;
    let columns = file.coordinates()?;
    let vertices = file.elements[file.find("vertex")?].count;
    let faces = &file.elements[file.find("face")?];
    let named = |p: &Property| ["vertex_indices", "vertex_index"].contains(&p.name.as_str()) && p.count.is_some();
    let Some(list) = faces.properties.iter().position(named) else {
        return Err(Error::input("its faces have no list of vertex_indices; save it as a mesh of polygons"));
    };
    let mut corners = Vec::new();
    file.for_each(|element, row| {
        match element {
            "vertex" => mesh.vertices.push(point(row, columns)?),
            "face" => {
                corners.clear();
                for &i in row.list(list) {
                    // Indices of 32 bits at most: exact as `f64`.
                    if !(i >= 0.0 && i < vertices as f64 && i <= f64::from(u32::MAX) && i.fract() == 0.0) {
                        return Err(format!("vertex {i} of {vertices} (from 0) does not exist"));
                    }
                    corners.push(i as u32);
                }
                if corners.len() < 3 {
                    return Err(format!("{} corners; at least 3 are needed", corners.len()));
                }
                mesh.triangles.extend(fan(&corners));
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(mesh)
}

/// Writes `count` vertices with the properties `names`, the first so many of each row, as binary 64-bit floats.
pub(super) fn write_vertices(
    w: &mut dyn Write,
    count: usize,
    names: &[&str],
    mut rows: impl Iterator<Item = [f64; 4]>,
) -> io::Result<()> {
    write!(w, "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n")?;
    names.iter().try_for_each(|name| writeln!(w, "property double {name}"))?;
    writeln!(w, "end_header")?;
    rows.try_for_each(|row| row[..names.len()].iter().try_for_each(|x| w.write_all(&x.to_le_bytes())))
}

/// What may be wrong with a row, for the reader to add the place.
type Checked<T> = std::result::Result<T, String>;

fn point(row: &Row, columns: [usize; 3]) -> Checked<[f64; 3]> {
    let [x, y, z] = columns;
    Ok([number(row, x, "x")?, number(row, y, "y")?, number(row, z, "z")?])
}

fn number(row: &Row, property: usize, name: &str) -> Checked<f64> {
    match row.list(property) {
        [x] if x.is_finite() => Ok(*x),
        other => Err(format!("{name} is {}, which is not finite", other.first().copied().unwrap_or(f64::NAN))),
    }
}

/// The values of one element, as numbers: every type of the format is exact as `f64`.
#[derive(Default)]
struct Row {
    values: Vec<f64>,
    /// Where the values of each property end.
    ends: Vec<usize>,
}

impl Row {
    fn clear(&mut self) {
        self.values.clear();
        self.ends.clear();
    }

    /// The values of a property: one, or those of a list.
    fn list(&self, property: usize) -> &[f64] {
        let start = if property == 0 { 0 } else { self.ends[property - 1] };
        &self.values[start..self.ends[property]]
    }
}

struct Property {
    name: String,
    scalar: Scalar,
    /// Of a list, the type of the number of its values.
    count: Option<Scalar>,
}

struct Element {
    name: String,
    /// As the header claims; nothing is allocated from it.
    count: u64,
    properties: Vec<Property>,
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// A file whose header is read.
struct Ply<R> {
    lines: Lines<R>,
    encoding: Encoding,
    elements: Vec<Element>,
}

impl<R: BufRead> Ply<R> {
    fn open(reader: R) -> Result<Self> {
        let mut lines = Lines::new(reader);
        if !lines.read_raw()? || lines.raw().trim_ascii() != b"ply" {
            return Err(lines.wrong("not a PLY file: it should begin with the line 'ply'"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            if !lines.read_raw()? {
                return Err(lines.wrong("the file ends within the header"));
            }
            let line = String::from_utf8_lossy(lines.raw()).into_owned();
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                [] | ["comment" | "obj_info", ..] => {}
                ["end_header"] => break,
                ["format", "ascii", _] => encoding = Some(Encoding::Text),
                ["format", "binary_little_endian", _] => encoding = Some(Encoding::Little),
                ["format", "binary_big_endian", _] => encoding = Some(Encoding::Big),
                ["element", name, count] => match count.parse::<u64>() {
                    Ok(_) if elements.iter().any(|e| e.name == name) => {
                        return Err(lines.wrong(format_args!("element {} a second time", shown(name))));
                    }
                    Ok(count) => elements.push(Element { name: name.to_owned(), count, properties: Vec::new() }),
                    Err(_) => return Err(lines.wrong(format_args!("'{}' is not a number of elements", shown(count)))),
                },
                ["property", ref words @ ..] => {
                    let property = property(words);
                    let element = elements.last_mut().ok_or_else(|| "a property before any element".to_owned());
                    let added = property.and_then(|p| element.and_then(|e| add(e, p)));
                    added.map_err(|what| lines.wrong(what))?;
                }
                _ => return Err(lines.wrong(format_args!("'{}' is no line of a PLY header", shown(&line)))),
            }
        }
        let Some(encoding) = encoding else { return Err(Error::input("its header has no line 'format'")) };
        if let Some(bare) = elements.iter().find(|e| e.properties.is_empty() && e.count > 0) {
            return Err(Error::input(format!("its element {} has no properties", shown(&bare.name))));
        }
        Ok(Self { lines, encoding, elements })
    }

    /// The index of the element `name`.
    fn find(&self, name: &str) -> Result<usize> {
        let found = self.elements.iter().position(|e| e.name == name);
        found.ok_or_else(|| Error::input(format!("no element '{name}' in its header")))
    }

    /// Which properties of a vertex its coordinates are.
    fn coordinates(&self) -> Result<[usize; 3]> {
        let vertices = &self.elements[self.find("vertex")?];
        let mut columns = [0; 3];
        for (column, axis) in columns.iter_mut().zip(["x", "y", "z"]) {
            let found = vertices.properties.iter().position(|p| p.name == axis && p.count.is_none());
            *column = found.ok_or_else(|| Error::input(format!("its vertices have no property '{axis}'")))?;
        }
        Ok(columns)
    }

    /// Hands on every row of every element, with the element's name.
    fn for_each(&mut self, mut take: impl FnMut(&str, &Row) -> Checked<()>) -> Result<()> {
        let mut row = Row::default();
        for Element { name, count, properties } in &self.elements {
            for i in 0..*count {
                row.clear();
                let read = match self.encoding {
                    Encoding::Text => match self.lines.next_line()? {
                        Some(line) => text_row(line, properties, &mut row).map_err(Error::input),
                        None => Err(Error::input(format!("the file ends after {i} of {count}"))),
                    },
                    encoding => {
                        let file = self.lines.rest();
                        let read = properties.iter().try_for_each(|p| binary_property(file, encoding, p, &mut row));
                        read.map_err(|e| match e.kind() {
                            io::ErrorKind::UnexpectedEof => Error::input(format!("the file ends after {i} of {count}")),
                            io::ErrorKind::InvalidData => Error::input(e.to_string()),
                            _ => cannot_read(e),
                        })
                    }
                };
                let taken = read.and_then(|()| take(name, &row).map_err(Error::input));
                if let Err(error) = taken {
                    let at_element = error.at(format_args!("{} {i} (from 0)", shown(name)));
                    let line = self.lines.number();
                    return Err(if self.encoding == Encoding::Text { at_element.on_line(line) } else { at_element });
                }
            }
        }
        Ok(())
    }
}

/// A property from the words after the word `property`.
fn property(words: &[&str]) -> Checked<Property> {
    let scalar = |word: &str| Scalar::parse(word).ok_or_else(|| format!("'{}' is no type of a property", shown(word)));
    match *words {
        ["list", count, kind, name] => match scalar(count)? {
            Scalar::F32 | Scalar::F64 => Err("the number of a list's values must be whole".into()),
            count => Ok(Property { name: name.to_owned(), scalar: scalar(kind)?, count: Some(count) }),
        },
        [kind, name] => Ok(Property { name: name.to_owned(), scalar: scalar(kind)?, count: None }),
        _ => Err("a property is 'property TYPE NAME' or 'property list TYPE TYPE NAME'".into()),
    }
}

fn add(element: &mut Element, property: Property) -> Checked<()> {
    if element.properties.iter().any(|p| p.name == property.name) {
        return Err(format!("property {} a second time", shown(&property.name)));
    }
    element.properties.push(property);
    Ok(())
}

fn text_row(line: &str, properties: &[Property], row: &mut Row) -> Checked<()> {
    let mut words = line.split_ascii_whitespace();
    let mut next = |name: &str| {
        let word = words.next().ok_or_else(|| format!("{} is missing", shown(name)))?;
        word.parse::<f64>().map_err(|_| format!("'{}' is not a number", shown(word)))
    };
    for Property { name, count, .. } in properties {
        let values = match count {
            None => 1.0,
            Some(_) => next(name)?,
        };
        if !(values >= 0.0 && values.fract() == 0.0) {
            return Err(format!("{} cannot have {values} values", shown(name)));
        }
        // As many as the line has; the number is not believed.
        for _ in 0..values as u64 {
            row.values.push(next(name)?);
        }
        row.ends.push(row.values.len());
    }
    match words.next() {
        Some(word) => Err(format!("'{}' is more than the header announces", shown(word))),
        None => Ok(()),
    }
}

fn binary_property(file: &mut impl Read, encoding: Encoding, property: &Property, row: &mut Row) -> io::Result<()> {
    let values = match property.count {
        None => 1.0,
        Some(count) => count.read(file, encoding)?,
    };
    if values < 0.0 {
        return Err(io::Error::new(io::ErrorKind::InvalidData, format!("a list of {values} values")));
    }
    // As many as the file has; the number is not believed.
    for _ in 0..values as u64 {
        row.values.push(property.scalar.read(file, encoding)?);
    }
    row.ends.push(row.values.len());
    Ok(())
}

#[derive(Clone, Copy)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn read(self, file: &mut impl Read, encoding: Encoding) -> io::Result<f64> {
        let big = encoding == Encoding::Big;
        Ok(match self {
            Self::I8 => f64::from(i8::from_le_bytes(bytes(file, big)?)),
            Self::U8 => f64::from(u8::from_le_bytes(bytes(file, big)?)),
            Self::I16 => f64::from(i16::from_le_bytes(bytes(file, big)?)),
            Self::U16 => f64::from(u16::from_le_bytes(bytes(file, big)?)),
            Self::I32 => f64::from(i32::from_le_bytes(bytes(file, big)?)),
            Self::U32 => f64::from(u32::from_le_bytes(bytes(file, big)?)),
            Self::F32 => f64::from(f32::from_le_bytes(bytes(file, big)?)),
            Self::F64 => f64::from_le_bytes(bytes(file, big)?),
        })
    }
}

/// The next bytes, the lowest first.
fn bytes<const N: usize>(file: &mut impl Read, big: bool) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes)?;
    if big {
        bytes.reverse();
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests;
