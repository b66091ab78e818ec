//! Stereolithography (`.stl`), text and binary.
//!
//! Not through `stl_io`: it ends at the first of several solids, rounds text to 32 bits, refuses normals that are not numbers (which
//! exporters write for triangles without area), takes a binary file whose header begins with "solid" for text, and names no line.

use std::io::BufRead;

use super::lines::{Lines, finite, shown};
use super::{Mesh, cannot_read};
use crate::{Error, Result};

/// Bytes before the triangles of a binary file: a header, and the number of triangles.
const HEADER: usize = 84;
/// Bytes of a triangle: normal, three corners, two bytes of attributes.
const TRIANGLE: usize = 50;

/// Reads the triangles, each with three vertices of its own. Normals and attributes are skipped: the order of the corners says
/// which side is out.
///
/// # Errors
/// `Input`, with the line or the number of the triangle.
pub(super) fn parse_stl(mut reader: impl BufRead) -> Result<Mesh> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(cannot_read)?;
    let announced = bytes.get(80..HEADER).map_or(0, |n| u64::from(u32::from_le_bytes([n[0], n[1], n[2], n[3]])));
    let needed = HEADER as u64 + TRIANGLE as u64 * announced;
    let whole = bytes.len() as u64 == needed && bytes.len() >= HEADER;
    // Headers of binary files begin with "solid" often enough; only a text has no zero byte there.
    let text = bytes.trim_ascii_start();
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let begins = text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    match () {
        () if whole => parse_binary(&bytes[HEADER..]),
        () if begins && !bytes.iter().take(HEADER).any(|&b| b == 0) => parse_text(&bytes),
        () if bytes.len() < HEADER => Err(Error::input("neither text that begins with 'solid' nor a binary STL file")),
        () => Err(Error::input(format!(
            "binary, and says {announced} triangles, which take {needed} bytes, but it has {}; is the file whole?",
            bytes.len()
        ))),
    }
}

fn parse_binary(triangles: &[u8]) -> Result<Mesh> {
    let mut mesh = Mesh::default();
    for (i, triangle) in triangles.as_chunks::<TRIANGLE>().0.iter().enumerate() {
        let (numbers, _) = triangle.as_chunks::<4>();
        let corners = [3, 6, 9].map(|at| [0, 1, 2].map(|k| f64::from(f32::from_le_bytes(numbers[at + k]))));
        if let Some(x) = corners.iter().flatten().find(|x| !x.is_finite()) {
            return Err(Error::input(format!("triangle {i} (from 0): coordinate {x} is not finite")).of_triangle(i));
        }
        push(&mut mesh, corners)?;
    }
    Ok(mesh)
}

fn parse_text(bytes: &[u8]) -> Result<Mesh> {
    let mut lines = Lines::new(bytes);
    let mut mesh = Mesh::default();
    let mut corners: Vec<[f64; 3]> = Vec::with_capacity(3);
    // What must come next; files of several solids are common.
    let mut inside = Inside::Nothing;
    while let Some(line) = lines.next_line()? {
        let mut words = line.split_ascii_whitespace();
        let keyword = words.next().unwrap_or_default().to_lowercase();
        let done = match (inside, keyword.as_str()) {
            (Inside::Nothing, "solid") => Ok(Inside::Solid),
            (Inside::Solid, "endsolid") => Ok(Inside::Nothing),
            (Inside::Solid, "facet") => Ok(Inside::Facet),
            (Inside::Facet, "outer") => {
                corners.clear();
                Ok(Inside::Loop)
            }
            (Inside::Loop, "vertex") => vertex(words).map(|corner| {
                corners.push(corner);
                Inside::Loop
            }),
            (Inside::Loop, "endloop") => match *corners.as_slice() {
                [a, b, c] => push(&mut mesh, [a, b, c]).map(|()| Inside::Facet).map_err(|e| e.to_string()),
                _ => Err(format!("a facet with {} corners; 3 are needed", corners.len())),
            },
            (Inside::Facet, "endfacet") => Ok(Inside::Solid),
            _ => Err(format!("'{}' does not belong here; {} is needed", shown(line), inside.needed())),
        };
        inside = done.map_err(|what| lines.wrong(what))?;
    }
    match inside {
        Inside::Nothing => Ok(mesh),
        _ => Err(lines.wrong(format_args!("the file ends, but {} is needed; is it whole?", inside.needed()))),
    }
}

#[derive(Clone, Copy)]
enum Inside {
    Nothing,
    Solid,
    Facet,
    Loop,
}

impl Inside {
    fn needed(self) -> &'static str {
        match self {
            Self::Nothing => "'solid'",
            Self::Solid => "'facet' or 'endsolid'",
            Self::Facet => "'outer loop' or 'endfacet'",
            Self::Loop => "'vertex' or 'endloop'",
        }
    }
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> std::result::Result<[f64; 3], String> {
    let mut next = || finite(words.next().ok_or("a vertex needs three numbers")?);
    let corner = [next()?, next()?, next()?];
    if words.next().is_some() { Err("a vertex needs three numbers".into()) } else { Ok(corner) }
}

fn push(mesh: &mut Mesh, corners: [[f64; 3]; 3]) -> Result<()> {
    let first = u32::try_from(mesh.vertices.len() + 2).map_err(|_| Error::input("more than 2^32 corners"))? - 2;
    mesh.vertices.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Domain;

    /// A tetrahedron, its corners exact in 32 bits.
    const CORNERS: [[[f32; 3]; 3]; 4] = [
        [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    ];

    fn text(corners: &[[[f32; 3]; 3]]) -> String {
        let facet = |c: &[[f32; 3]; 3]| {
            let [a, b, c] = c.map(|p| format!("vertex {:?} {} {:e}", p[0], p[1], p[2]));
            format!(
                "  facet normal nan nan nan\n    outer loop\n      {a}\n      {b}\n      {c}\n    endloop\n  endfacet\n"
            )
        };
        format!("solid\n{}endsolid\n", corners.iter().map(facet).collect::<String>())
    }

    fn binary(header: &[u8], corners: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, 0);
        bytes.extend((corners.len() as u32).to_le_bytes());
        for corner in corners {
            bytes.extend([0; 12]);
            bytes.extend(corner.iter().flatten().flat_map(|x| x.to_le_bytes()));
            bytes.extend([7, 7]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_are_the_same_mesh() {
        let plain = parse_stl(text(&CORNERS).as_bytes()).unwrap();
        assert_eq!((plain.vertices.len(), plain.triangles.len()), (12, 4));
        assert!((Domain::new(&plain.vertices, &plain.triangles).unwrap().volume() - 1.0 / 6.0).abs() < 1e-16);
        let two = text(&CORNERS[..2]) + "\n" + &text(&CORNERS[2..]);
        assert_eq!(parse_stl(two.as_bytes()).unwrap(), plain, "two solids in one file");
        let loud = text(&CORNERS).to_uppercase().replace('\n', "\r\n");
        assert_eq!(parse_stl(loud.as_bytes()).unwrap(), plain);
        for header in
            [&b""[..], b"solid", b"solid made by hand, all eighty bytes of it filled with words as in a text file ."]
        {
            assert_eq!(parse_stl(&binary(header, &CORNERS)[..]).unwrap(), plain);
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let wrong = |bytes: &[u8]| parse_stl(bytes).unwrap_err().to_string();
        let whole = text(&CORNERS);
        assert_eq!(
            wrong(whole.replacen("endloop", "ende", 1).as_bytes()),
            "line 7: 'ende' does not belong here; 'vertex' or 'endloop' is needed"
        );
        let some: String = whole.lines().take(8).map(|line| format!("{line}\n")).collect();
        assert_eq!(wrong(some.as_bytes()), "line 9: the file ends, but 'facet' or 'endsolid' is needed; is it whole?");
        assert_eq!(wrong(b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n"), "line 4: 'nan' is not finite");
        assert_eq!(wrong(b"solid\nfacet\nouter loop\nvertex 0 0\n"), "line 4: a vertex needs three numbers");
        assert_eq!(wrong(b"solid\nfacet\nouter loop\nendloop\n"), "line 4: a facet with 0 corners; 3 are needed");
        assert_eq!(wrong(b"v 0 0 0\n"), "neither text that begins with 'solid' nor a binary STL file");
        let mut bytes = binary(b"solid", &CORNERS);
        bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(
            wrong(&bytes),
            "binary, and says 4294967295 triangles, which take 214748364834 bytes, but it has 284; is the file whole?"
        );
        let mut bytes = binary(b"", &CORNERS);
        bytes[84 + 50 + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
        assert_eq!(wrong(&bytes), "triangle 1 (from 0): coordinate inf is not finite");
    }
}
