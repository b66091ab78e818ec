//! VTK's XML files of PolyData (`.vtp`): arrays as text, as base64 or appended, packed by zlib or not, as VTK, PyVista and ParaView write them.

use std::io::{BufRead, Read};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use roxmltree::{Document, Node};

use super::legacy_vtk::within;
use super::lines::{finite, shown};
use super::mesh::add_polygon;
use super::{Mesh, cannot_read};
use crate::{Error, Result, memory};

/// What comes before the appended bytes, which are no XML.
const APPENDED: &[u8] = b"<AppendedData";

/// Reads points and polygons of all pieces; what else there is, is passed over.
///
/// # Errors
/// `Input`, naming the array.
pub(super) fn parse(mut reader: impl BufRead) -> Result<Mesh> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(cannot_read)?;
    let begin = bytes.windows(APPENDED.len()).position(|window| window == APPENDED);
    let (xml, appended) = bytes.split_at(begin.unwrap_or(bytes.len()));
    let text =
        |bytes| std::str::from_utf8(bytes).map_err(|_| Error::input("not text in UTF-8 before its appended data"));
    let mut text = text(xml)?.to_owned();
    if begin.is_some() {
        text.push_str("</VTKFile>");
    }
    let document = Document::parse(&text).map_err(|e| Error::input(format!("not XML: {}", shown(&e.to_string()))))?;
    let root = document.root_element();
    let file = File::of(root, appended)?;
    let mut mesh = Mesh::default();
    for piece in root.descendants().filter(|node| node.has_tag_name("Piece")) {
        if piece.attribute("NumberOfStrips").is_some_and(|count| count != "0") {
            return Err(Error::input("strips of triangles are not read; save it as polygons (PyVista: triangulate)"));
        }
        let points = child(piece, "Points").and_then(|points| child(points, "DataArray"));
        let Some(points) = points else { continue };
        let mut piece_mesh = Mesh::default();
        let numbers = file.numbers(points).map_err(|e| e.at("points"))?;
        if numbers.len() % 3 != 0 || numbers.iter().any(|x| !x.is_finite()) {
            return Err(Error::input("points: finite numbers are needed, three for each"));
        }
        piece_mesh.vertices.extend(numbers.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
        if let Some(polygons) = child(piece, "Polys") {
            let array = |name: &str| {
                let found = polygons.children().find(|node| node.attribute("Name") == Some(name));
                found.map_or_else(
                    || Ok(Vec::new()),
                    |node| file.numbers(node).map_err(|e| e.at(format_args!("polygons, {name}"))),
                )
            };
            let (corners, offsets) = (array("connectivity")?, array("offsets")?);
            let mut start = 0.0;
            for end in offsets {
                let wrong = || Error::input("the offsets of its polygons do not fit their corners");
                add_polygon(&mut piece_mesh, within(&corners, start, end).ok_or_else(wrong)?)?;
                start = end;
            }
        }
        let before = mesh.vertices.len() as u32;
        mesh.vertices.append(&mut piece_mesh.vertices);
        mesh.triangles.extend(piece_mesh.triangles.iter().map(|t| t.map(|i| i + before)));
    }
    Ok(mesh)
}

fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|node| node.has_tag_name(name))
}

struct File<'a> {
    is_big: bool,
    /// Bytes of a length before an array: 4 or 8.
    header: usize,
    is_packed: bool,
    appended: &'a [u8],
    /// Whether the appended bytes are base64, and where the arrays in them begin.
    is_text: bool,
    offsets: Vec<usize>,
}

impl<'a> File<'a> {
    fn of(root: Node<'_, '_>, appended: &'a [u8]) -> Result<Self> {
        if !root.has_tag_name("VTKFile") || root.attribute("type") != Some("PolyData") {
            let kind = shown(root.attribute("type").unwrap_or(root.tag_name().name()));
            return Err(Error::input(format!(
                "a file of {kind}; PolyData is needed, a surface (PyVista: extract_surface)"
            )));
        }
        let is_packed = match root.attribute("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => return Err(Error::input(format!("packed by {}; zlib is read, or none", shown(other)))),
        };
        let end = appended.iter().position(|&b| b == b'>').unwrap_or(appended.len());
        let (tag, rest) = appended.split_at(end);
        let begin = rest.iter().position(|&b| b == b'_').map_or(rest.len(), |k| k + 1);
        let offset = |node: Node<'_, '_>| node.attribute("offset").and_then(|offset| offset.parse().ok());
        Ok(Self {
            is_big: root.attribute("byte_order") == Some("BigEndian"),
            header: if root.attribute("header_type") == Some("UInt64") { 8 } else { 4 },
            is_packed,
            appended: &rest[begin..],
            is_text: tag.windows(8).any(|word| word == b"\"base64\""),
            offsets: root.descendants().filter_map(offset).collect(),
        })
    }

    /// The numbers of a data array.
    fn numbers(&self, array: Node<'_, '_>) -> Result<Vec<f64>> {
        let text = array.text().unwrap_or_default();
        let bytes = match array.attribute("format") {
            Some("ascii") | None => {
                // The text of a number of 32 bits has just as many digits as tell it from the next.
                let is_single = array.attribute("type") == Some("Float32");
                let number = |word| finite(word).map(|x| if is_single { f64::from(x as f32) } else { x });
                let numbers = text.split_ascii_whitespace().map(number).collect::<std::result::Result<_, _>>();
                return numbers.map_err(Error::input);
            }
            Some("binary") => self.unpacked(&decoded(text.as_bytes())?)?,
            Some("appended") => {
                let offset = array.attribute("offset").and_then(|offset| offset.parse::<usize>().ok());
                let from = offset.and_then(|offset| self.appended.get(offset..).map(|bytes| (offset, bytes)));
                let (offset, bytes) = from.ok_or_else(|| Error::input("it is not among the appended data"))?;
                let next = self.offsets.iter().copied().filter(|&other| other > offset).min();
                let bytes = next.and_then(|next| bytes.get(..next - offset)).unwrap_or(bytes);
                if self.is_text {
                    let end = bytes.iter().position(|&b| b == b'<').unwrap_or(bytes.len());
                    self.unpacked(&decoded(&bytes[..end])?)?
                } else {
                    self.unpacked(bytes)?
                }
            }
            Some(other) => return Err(Error::input(format!("format '{}' is not known", shown(other)))),
        };
        let kind = array.attribute("type").unwrap_or_default();
        let size = match kind {
            "Float64" | "Int64" | "UInt64" => 8,
            "Float32" | "Int32" | "UInt32" => 4,
            "Int16" | "UInt16" => 2,
            "Int8" | "UInt8" => 1,
            _ => return Err(Error::input(format!("numbers of type '{}' are not read", shown(kind)))),
        };
        let mut numbers = memory::filled(0.0, bytes.len() / size, "numbers")?;
        for (number, bytes) in numbers.iter_mut().zip(bytes.chunks_exact(size)) {
            let whole = self.whole(bytes);
            *number = match kind {
                "Float64" => f64::from_bits(whole),
                "Float32" => f64::from(f32::from_bits(whole as u32)),
                "Int64" => whole as i64 as f64,
                "Int32" => f64::from(whole as u32 as i32),
                "Int16" => f64::from(whole as u16 as i16),
                "Int8" => f64::from(whole as u8 as i8),
                _ => whole as f64,
            };
        }
        Ok(numbers)
    }

    /// The whole number of up to eight bytes.
    fn whole(&self, bytes: &[u8]) -> u64 {
        let add = |sum: u64, &byte: &u8| sum << 8 | u64::from(byte);
        if self.is_big { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) }
    }

    /// An array's bytes: after their number or, of blocks that are packed, after how many there are, of how many bytes, of how many the last if it is
    /// shorter, and how many each takes.
    fn unpacked(&self, bytes: &[u8]) -> Result<Vec<u8>> {
        let cut = || Error::input("the file ends within it");
        let word = |k: usize| Some(self.whole(bytes.get(k * self.header..(k + 1) * self.header)?));
        let first = word(0).ok_or_else(cut)? as usize;
        if !self.is_packed {
            let end = self.header.checked_add(first);
            return Ok(bytes.get(self.header..end.ok_or_else(cut)?).ok_or_else(cut)?.to_vec());
        }
        if first == 0 {
            return Ok(Vec::new());
        }
        let [full, last] = [word(1).ok_or_else(cut)?, word(2).ok_or_else(cut)?];
        let mut rest = first.checked_add(3).and_then(|n| bytes.get(n.checked_mul(self.header)?..)).ok_or_else(cut)?;
        let mut all = Vec::new();
        for block in 0..first {
            let size = word(3 + block).ok_or_else(cut)? as usize;
            let (packed, after) = rest.split_at_checked(size).ok_or_else(cut)?;
            let length = if block + 1 == first && last > 0 { last } else { full };
            let before = all.len() as u64;
            ZlibDecoder::new(packed).take(length).read_to_end(&mut all).map_err(cannot_read)?;
            if all.len() as u64 - before != length {
                return Err(cut());
            }
            rest = after;
        }
        Ok(all)
    }
}

/// The bytes of base64: of one text or, as VTK writes lengths and data, of several, each of which ends by `=` where it does not by itself.
fn decoded(text: &[u8]) -> Result<Vec<u8>> {
    let text: Vec<u8> = text.iter().copied().filter(|b| !b.is_ascii_whitespace()).collect();
    let mut bytes = Vec::new();
    // Its quarters of four letters: after one with a `=` another text begins.
    for part in text.chunks(4).collect::<Vec<_>>().split_inclusive(|letters| letters.ends_with(b"=")) {
        let part: Vec<u8> = part.concat();
        STANDARD.decode_vec(part, &mut bytes).map_err(|e| Error::input(format!("no base64: {e}")))?;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;
    use crate::io::{parse_mesh, parse_sites};

    const VERTICES: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]];
    const CORNERS: [i32; 7] = [0, 2, 1, 0, 1, 2, 3];
    const ENDS: [i32; 2] = [3, 7];

    #[derive(Clone, Copy, PartialEq)]
    enum How {
        Text,
        Inline,
        Appended,
        AppendedText,
    }

    /// A file of one piece, as VTK writes it.
    fn file(how: How, packed: bool, wide: bool) -> Vec<u8> {
        let length =
            |n: usize| if wide { (n as u64).to_le_bytes().to_vec() } else { (n as u32).to_le_bytes().to_vec() };
        let mut appended = Vec::new();
        let mut array = |attributes: &str, bytes: Vec<u8>, text: String| {
            let (head, body) = if packed {
                // Blocks of 16 bytes.
                let blocks: Vec<Vec<u8>> = bytes
                    .chunks(16)
                    .map(|block| {
                        let mut writer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
                        writer.write_all(block).unwrap();
                        writer.finish().unwrap()
                    })
                    .collect();
                let sizes = [blocks.len(), 16, bytes.len() % 16].into_iter().chain(blocks.iter().map(Vec::len));
                (sizes.flat_map(length).collect::<Vec<u8>>(), blocks.concat())
            } else {
                (length(bytes.len()), bytes)
            };
            let encoded = STANDARD.encode(&head) + &STANDARD.encode(&body);
            let begin = appended.len();
            match how {
                How::Text => format!("<DataArray {attributes} format=\"ascii\">{text}</DataArray>"),
                How::Inline => format!("<DataArray {attributes} format=\"binary\">\n  {encoded}\n</DataArray>"),
                How::Appended | How::AppendedText => {
                    let bytes = if how == How::Appended { [head, body].concat() } else { encoded.into_bytes() };
                    appended.extend(bytes);
                    format!("<DataArray {attributes} format=\"appended\" offset=\"{begin}\"/>")
                }
            }
        };
        let points = VERTICES.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let words = |numbers: &[i32]| numbers.iter().map(|x| format!("{x} ")).collect::<String>();
        let whole = |numbers: &[i32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let points = array(
            "type=\"Float64\" NumberOfComponents=\"3\"",
            points,
            VERTICES.map(|v| format!("{} {} {} ", v[0], v[1], v[2])).concat(),
        );
        let corners = array("type=\"Int32\" Name=\"connectivity\"", whole(&CORNERS), words(&CORNERS));
        let ends = array("type=\"Int32\" Name=\"offsets\"", whole(&ENDS), words(&ENDS));
        let compressor = if packed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
        let header = if wide { "UInt64" } else { "UInt32" };
        let mut file = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"{header}\"{compressor}>\n\
             <PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\"><Points>{points}</Points><Polys>{corners}{ends}</Polys></Piece></PolyData>\n"
        )
        .into_bytes();
        if how == How::Appended || how == How::AppendedText {
            let encoding = if how == How::Appended { "raw" } else { "base64" };
            file.extend(format!("<AppendedData encoding=\"{encoding}\">\n   _").bytes());
            file.append(&mut appended);
            file.extend(b"\n  </AppendedData>\n");
        }
        file.extend(b"</VTKFile>\n");
        file
    }

    #[test]
    fn each_way_to_write_it_is_one_mesh() {
        for how in [How::Text, How::Inline, How::Appended, How::AppendedText] {
            for (packed, wide) in [(false, false), (true, false), (false, true), (true, true)] {
                let file = file(how, packed, wide);
                let mesh = parse_mesh(&file, "m.vtp").unwrap();
                assert_eq!(mesh.vertices, VERTICES);
                assert_eq!(mesh.triangles, [[0, 2, 1], [0, 1, 2], [0, 2, 3]]);
                assert_eq!(parse_sites(&file, "m.vtp").unwrap().positions, VERTICES);
                // Cut short, or with a wrong byte: a value or a line.
                for at in 0..file.len() {
                    let mut damaged = file.clone();
                    damaged[at] = b'7';
                    for bytes in [&file[..at], &damaged] {
                        let error = parse_mesh(bytes, "m.vtp").err();
                        assert!(error.as_ref().is_none_or(|e| e.kind() == crate::ErrorKind::Input), "{error:?}");
                        let line = error.map(|e| e.to_string()).unwrap_or_default();
                        assert!(!line.contains('\n') && line.len() < 300, "{line}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_something_else_is_said() {
        let wrong = |from: &str, to: &str| {
            let text = String::from_utf8(file(How::Text, false, false)).unwrap();
            assert!(text.contains(from));
            parse_mesh(text.replace(from, to).as_bytes(), "m.vtp").unwrap_err().to_string().replace("m.vtp: ", "")
        };
        assert!(wrong("\"PolyData\"", "\"ImageData\"").starts_with("a file of ImageData; PolyData is needed"));
        assert!(
            wrong("header_type", "compressor=\"vtkLZ4DataCompressor\" a")
                .starts_with("packed by vtkLZ4DataCompressor; zlib")
        );
        assert_eq!(wrong("3 7 ", "3 8 "), "the offsets of its polygons do not fit their corners");
        assert_eq!(wrong("1 2 3 <", "1 2 9 <"), "vertex 9 of 4 (from 0) does not exist");
        assert_eq!(wrong("1.5", "nan"), "points: 'nan' is not finite");
        assert!(wrong("</Piece>", "").starts_with("not XML: "));
    }
}
