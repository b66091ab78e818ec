//! Object File Format (`.off`), text form, as Geomview defines it and CGAL and MeshLab write it.

use std::io::BufRead;

use super::Mesh;
use super::lines::{Lines, finite, shown};
use super::mesh::fan;
use crate::{Result, memory};

/// Reads vertices, and faces cut into fans of triangles; colours and normals are skipped.
///
/// # Errors
/// `Input`, with the line.
pub(super) fn parse_off(reader: impl BufRead) -> Result<Mesh> {
    let mut lines = Lines::new(reader);
    let (vertices, faces) = counts(&mut lines)?;
    // The counts are only believed as far as lines follow: nothing is allocated from them.
    let mut mesh = Mesh::default();
    for i in 0..vertices {
        let Some(line) = lines.next_line()? else {
            return Err(lines.wrong(format_args!("the file ends after {i} of {vertices} vertices")));
        };
        let parsed = vertex(line);
        let vertex = parsed.map_err(|what| lines.wrong(format_args!("vertex {i}: {what}")))?;
        memory::push(&mut mesh.vertices, vertex, "vertices")?;
    }
    for i in 0..faces {
        let Some(line) = lines.next_line()? else {
            return Err(lines.wrong(format_args!("the file ends after {i} of {faces} faces")));
        };
        let parsed = face(line, vertices, &mut mesh.triangles);
        parsed.map_err(|what| lines.wrong(format_args!("face {i}: {what}")))?;
    }
    Ok(mesh)
}

/// Reads the header: the word `OFF`, by now often missing, and the numbers of vertices, faces and edges.
fn counts(lines: &mut Lines<impl BufRead>) -> Result<(u32, u32)> {
    let mut line = lines.next_line()?.unwrap_or("");
    let word = line.split_ascii_whitespace().next().unwrap_or("");
    if word.parse::<u32>().is_err() {
        // `CNOFF` and the like: vertices are followed by normals or colours. `4OFF` and `nOFF` have other dimensions.
        if !word.ends_with("OFF") || !word[..word.len() - 3].chars().all(|c| "STCN".contains(c)) {
            return Err(lines.wrong("not a three-dimensional OFF file: it should begin with the word OFF"));
        }
        let rest = line[word.len()..].trim();
        line = if rest.is_empty() { lines.next_line()?.unwrap_or("") } else { rest };
        if line.starts_with("BINARY") {
            return Err(lines.wrong("binary OFF is not read; save it as text"));
        }
    }
    let mut numbers = line.split_ascii_whitespace().map(str::parse::<u32>);
    match (numbers.next(), numbers.next()) {
        (Some(Ok(vertices)), Some(Ok(faces))) => Ok((vertices, faces)),
        _ => {
            let what = format!("'{}' should be the numbers of vertices, faces and edges", shown(line));
            Err(lines.wrong(what))
        }
    }
}

fn vertex(line: &str) -> std::result::Result<[f64; 3], String> {
    let mut words = line.split_ascii_whitespace();
    let mut next = || finite(words.next().ok_or("three coordinates are needed")?);
    Ok([next()?, next()?, next()?])
}

/// Adds the triangles of one face.
fn face(line: &str, vertices: u32, triangles: &mut Vec<[u32; 3]>) -> std::result::Result<(), String> {
    let mut words = line.split_ascii_whitespace();
    let mut next = || {
        let word = words.next().ok_or("an index is missing")?;
        word.parse::<u32>().map_err(|_| format!("'{}' is not an index", shown(word)))
    };
    let corners = next()?;
    if corners < 3 {
        return Err(format!("{corners} corners; at least 3 are needed"));
    }
    // As many as there are; the number is not believed.
    let mut indices = Vec::new();
    for _ in 0..corners {
        let i = next()?;
        if i >= vertices {
            return Err(format!("vertex {i} of {vertices} (from 0) does not exist"));
        }
        indices.push(i);
    }
    triangles.extend(fan(&indices));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PYRAMID: &str =
        "0 0 0\n1 0 0\n1 1 0 255 0 0\n0 1 0\n.5 .5 1\n4 3 2 1 0\n3 0 1 4 0.5 0.5 0.5\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";

    #[test]
    fn polygons_become_fans_whatever_the_header() {
        let read = |header: &str| parse_off(format!("{header}{PYRAMID}").as_bytes());
        let expected = read("OFF\n5 5 8\n").unwrap();
        assert_eq!(expected.vertices.len(), 5);
        let triangles = [[3, 2, 1], [3, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        assert_eq!(expected.triangles, triangles);
        for header in ["OFF 5 5 8\n", "# made by hand\nOFF\n\n5 5 0 # no edges\n", "5 5 8\n", "COFF\r\n5 5\r\n"] {
            assert_eq!(read(header).unwrap(), expected, "{header:?}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        let wrong = |text: &str| parse_off(text.as_bytes()).unwrap_err().to_string();
        assert!(wrong("solid cube\n").starts_with("line 1: not a three-dimensional OFF file"));
        assert!(wrong("4OFF\n1 1 1\n").starts_with("line 1: not a three-dimensional OFF file"));
        assert!(wrong("OFF BINARY\n").contains("binary OFF is not read"));
        assert_eq!(wrong("OFF\nx 1\n"), "line 2: 'x 1' should be the numbers of vertices, faces and edges");
        assert_eq!(wrong("OFF\n2 1 0\n0 0 0\n"), "line 4: the file ends after 1 of 2 vertices");
        assert_eq!(wrong("OFF\n4294967295 4294967295 0\n"), "line 3: the file ends after 0 of 4294967295 vertices");
        assert_eq!(wrong("OFF\n1 0 0\n0 nan 0\n"), "line 3: vertex 0: 'nan' is not finite");
        assert_eq!(wrong("OFF\n1 0 0\n0 0\n"), "line 3: vertex 0: three coordinates are needed");
        assert_eq!(wrong("OFF\n1 1 0\n0 0 0\n3 0 0 1\n"), "line 4: face 0: vertex 1 of 1 (from 0) does not exist");
        assert_eq!(wrong("OFF\n1 1 0\n0 0 0\n3 0 0\n"), "line 4: face 0: an index is missing");
        assert_eq!(wrong("OFF\n1 1 0\n0 0 0\n2 0 0\n"), "line 4: face 0: 2 corners; at least 3 are needed");
        assert_eq!(wrong("OFF\n1 1 0\n0 0 0\n4294967295 0 0\n"), "line 4: face 0: an index is missing");
        assert_eq!(wrong("OFF\n1 2 0\n0 0 0\n3 0 0 0\n"), "line 5: the file ends after 1 of 2 faces");
    }
}
