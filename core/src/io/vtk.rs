//! VTK's XML files, whose arrays stand behind the XML as raw little-endian numbers: exact, and fast to read. (The crate `vtkio` does not know the
//! faces of polyhedra.)

use std::io::{self, Write};

/// Takes the bytes of one number.
pub(super) type Put<'w> = dyn FnMut(&[u8]) -> io::Result<()> + 'w;

/// Writes the numbers of one array.
type WriteArray<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// One array of a file: where it stands, what its XML says, how long it is, and how it is written.
pub(super) struct Array<'a> {
    section: &'static str,
    name: &'static str,
    kind: &'static str,
    components: u32,
    bytes: u64,
    write: Box<WriteArray<'a>>,
}

/// An array of so many numbers of VTK's type `kind`, a row of `components` after the other, which `numbers` puts.
pub(super) fn array<'a>(
    section: &'static str,
    name: &'static str,
    kind: &'static str,
    components: u32,
    count: usize,
    numbers: impl Fn(&mut Put<'_>) -> io::Result<()> + 'a,
) -> Array<'a> {
    let size = match kind {
        "UInt8" => 1,
        "Int32" => 4,
        _ => 8,
    };
    let write = Box::new(move |w: &mut dyn Write| numbers(&mut |number: &[u8]| w.write_all(number)));
    Array { section, name, kind, components, bytes: size * count as u64, write }
}

/// Writes a data set of VTK's type `set` with one piece, of which `counts` are the XML's attributes; `notes` are lines for who looks into
/// the file.
pub(super) fn write_xml(
    w: &mut dyn Write,
    set: &str,
    counts: &str,
    notes: &[String],
    sections: &[&str],
    arrays: &[Array<'_>],
) -> io::Result<()> {
    writeln!(w, "<?xml version=\"1.0\"?>")?;
    writeln!(w, "<VTKFile type=\"{set}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">")?;
    // Not as field data: meshio reads no file with strings.
    notes.iter().try_for_each(|line| writeln!(w, "<!-- {line} -->"))?;
    writeln!(w, "<{set}><Piece {counts}>")?;
    let mut offset = 0;
    for section in sections {
        writeln!(w, "<{section}>")?;
        for array in arrays.iter().filter(|a| a.section == *section) {
            let Array { kind, name, components, .. } = array;
            // meshio takes one component that is counted for a column.
            let shape = if *components == 1 { String::new() } else { format!("NumberOfComponents=\"{components}\" ") };
            writeln!(w, "<DataArray type=\"{kind}\" Name=\"{name}\" {shape}format=\"appended\" offset=\"{offset}\"/>")?;
            offset += 8 + array.bytes;
        }
        writeln!(w, "</{section}>")?;
    }
    // The blocks follow in the order in which the offsets were counted.
    writeln!(w, "</Piece></{set}>\n<AppendedData encoding=\"raw\">")?;
    w.write_all(b"_")?;
    for section in sections {
        for array in arrays.iter().filter(|a| a.section == *section) {
            w.write_all(&array.bytes.to_le_bytes())?;
            (array.write)(w)?;
        }
    }
    writeln!(w, "\n</AppendedData>\n</VTKFile>")
}
