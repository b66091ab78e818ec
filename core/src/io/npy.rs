//! NumPy's `.npy`, through `npyz`, behind checks of what a header claims.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};

use npyz::{NpyFile, NpyHeader, Order, WriterBuilder};

use super::SitesFile;
use crate::{Error, ErrorKind, Result};

/// Longest header that is read; NumPy itself takes no longer ones.
const LONGEST_HEADER: usize = 10_000;
/// A header of numbers nests one dictionary and one tuple; brackets without end would exhaust the parser's stack.
const MOST_BRACKETS: usize = 16;
/// Sizes of so many digits in all have a product below 2⁶⁴; a longer shape is that of no file.
const MOST_DIGITS: usize = 18;

/// Reads an array of shape (N, 3) or (N, 4) as sites.
pub(super) fn read_sites(file: &File) -> Result<SitesFile> {
    let mut reader = BufReader::with_capacity(1 << 18, file);
    let (header, header_bytes) = read_header(&mut reader)?;
    let (rows, columns) = match *header.shape() {
        [rows, columns @ (3 | 4)] => (rows, columns as usize),
        ref shape => {
            return Err(Error::input(format!("shape {shape:?}; (N, 3), or (N, 4) with weights, is needed")));
        }
    };
    let descr = header.dtype().descr();
    let width: u64 = match descr.trim_matches('\'') {
        "<f8" | ">f8" => 8,
        "<f4" | ">f4" => 4,
        _ => return Err(Error::input(format!("type {descr}; 'f8' or 'f4' is needed (NumPy: a.astype('f8'))"))),
    };
    // The shape is held against the file before anything is allocated from it.
    let length = file.metadata().map_err(|e| cannot_read(&e))?.len();
    let held = length.saturating_sub(header_bytes);
    if header.len().checked_mul(width) != Some(held) {
        return Err(Error::input(format!(
            "{held} bytes of data, but shape ({rows}, {columns}) of {descr} needs other"
        )));
    }
    let order = header.order();
    let npy = NpyFile::with_header(header, reader);
    let mut sites = SitesFile { positions: vec![[0.0; 3]; rows as usize], weights: Vec::new() };
    if columns == 4 {
        sites.weights.resize(rows as usize, 0.0);
    }
    if width == 8 {
        fill(&mut sites, order, columns, npy.data::<f64>().map_err(|e| Error::input(e.to_string()))?)?;
    } else {
        let numbers = npy.data::<f32>().map_err(|e| Error::input(e.to_string()))?;
        fill(&mut sites, order, columns, numbers.map(|x| x.map(f64::from)))?;
    }
    Ok(sites)
}

/// Writes `rows` × `columns` numbers, given row by row, as little-endian `f64` in C order.
pub(super) fn write_rows(
    writer: &mut dyn Write,
    rows: usize,
    columns: usize,
    numbers: impl Iterator<Item = f64>,
) -> io::Result<()> {
    let shape = [rows as u64, columns as u64];
    let mut npy = npyz::WriteOptions::<f64>::new().default_dtype().shape(&shape).writer(writer).begin_nd()?;
    npy.extend(numbers)?;
    npy.finish()
}

/// Puts numbers that arrive in the file's order where they belong.
fn fill(
    sites: &mut SitesFile,
    order: Order,
    columns: usize,
    numbers: impl Iterator<Item = io::Result<f64>>,
) -> Result<()> {
    let rows = sites.positions.len();
    for (i, x) in numbers.enumerate() {
        let (row, column) = match order {
            Order::C => (i / columns, i % columns),
            Order::Fortran => (i % rows, i / rows),
        };
        let x = x.map_err(|e| cannot_read(&e))?;
        if !x.is_finite() {
            return Err(Error::input(format!("row {row}, column {column} (from 0): {x} is not finite")));
        }
        if column < 3 {
            sites.positions[row][column] = x;
        } else {
            sites.weights[row] = x;
        }
    }
    Ok(())
}

/// The header, and how many bytes of the file it takes.
fn read_header(reader: &mut impl Read) -> Result<(NpyHeader, u64)> {
    let none = |_| Error::input("not a .npy file: its first bytes are not NumPy's");
    let mut bytes = vec![0; 10];
    reader.read_exact(&mut bytes).map_err(none)?;
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err(none(io::ErrorKind::InvalidData.into()));
    }
    let text = match bytes[6] {
        1 => usize::from(u16::from_le_bytes([bytes[8], bytes[9]])),
        2 | 3 => {
            let mut upper = [0; 2];
            reader.read_exact(&mut upper).map_err(none)?;
            bytes.extend(upper);
            u32::from_le_bytes([bytes[8], bytes[9], upper[0], upper[1]]) as usize
        }
        version => return Err(Error::input(format!("version {version} of the .npy format; 1 to 3 are known"))),
    };
    let start = bytes.len();
    let strange = || Error::input("its .npy header is not that of an array of numbers");
    if text > LONGEST_HEADER {
        return Err(strange());
    }
    bytes.resize(start + text, 0);
    reader.read_exact(&mut bytes[start..]).map_err(none)?;
    let count = |of: fn(&u8) -> bool| bytes[start..].iter().filter(|&b| of(b)).count();
    if count(|b| b"([{".contains(b)) > MOST_BRACKETS || count(u8::is_ascii_digit) > MOST_DIGITS {
        return Err(strange());
    }
    let header = NpyHeader::from_reader(&bytes[..]).map_err(|e| Error::input(format!("its .npy header: {e}")))?;
    Ok((header, bytes.len() as u64))
}

fn cannot_read(error: &io::Error) -> Error {
    Error::new(ErrorKind::Io, format!("cannot read: {error}"))
}

#[cfg(test)]
mod tests {
    use super::super::{read_sites, scratch};
    use super::*;

    /// A file with the given header text and data.
    fn npy(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read(name: &str, bytes: &[u8]) -> std::result::Result<SitesFile, String> {
        let path = scratch(&format!("npy-{name}")).join("s.npy");
        std::fs::write(&path, bytes).unwrap();
        read_sites(&path).map_err(|e| e.to_string().replace(&format!("{}: ", path.display()), ""))
    }

    #[test]
    fn both_orders_widths_and_endiannesses_are_read() {
        let rows = [[1.0_f64, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.25], [7.0, 8.0, 9.0, 0.75]];
        let expected = SitesFile {
            positions: rows.iter().map(|r| [r[0], r[1], r[2]]).collect(),
            weights: rows.iter().map(|r| r[3]).collect(),
        };
        let c: Vec<f64> = rows.iter().flatten().copied().collect();
        let f: Vec<f64> = (0..12).map(|i| rows[i % 3][i / 3]).collect();
        for (fortran, numbers) in [("False", &c), ("True", &f)] {
            let variants: [(&str, Vec<u8>); 3] = [
                ("<f8", numbers.iter().flat_map(|x| x.to_le_bytes()).collect()),
                (">f8", numbers.iter().flat_map(|x| x.to_be_bytes()).collect()),
                ("<f4", numbers.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect()),
            ];
            for (kind, data) in variants {
                let header = format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': (3, 4), }}\n");
                assert_eq!(read("orders", &npy(&header, &data)).unwrap(), expected, "{kind} {fortran}");
            }
        }
    }

    #[test]
    fn headers_are_not_believed() {
        let header =
            |kind: &str, shape: &str| format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}}}\n");
        let wrong = |header: &str, data: &[u8]| read("wrong", &npy(header, data)).unwrap_err();
        assert_eq!(
            wrong(&header("<f8", "(1000000000000000, 3)"), &[0; 24]),
            "24 bytes of data, but shape (1000000000000000, 3) of '<f8' needs other"
        );
        assert!(wrong(&header("<f8", "(2, 3)"), &[0; 47]).starts_with("47 bytes of data"));
        assert_eq!(wrong(&header("<f8", "(5,)"), &[0; 40]), "shape [5]; (N, 3), or (N, 4) with weights, is needed");
        assert!(wrong(&header("<i8", "(1, 3)"), &[0; 24]).starts_with("type '<i8'; 'f8' or 'f4' is needed"));
        let strange = "its .npy header is not that of an array of numbers";
        assert_eq!(wrong(&header("<f8", "(99999999999999999999, 99999999999999999999)"), &[]), strange);
        assert_eq!(wrong(&header("<f8", &"(".repeat(5000)), &[]), strange);
        assert!(wrong("no dictionary", &[]).starts_with("its .npy header: "));
        assert!(read("magic", b"1 2 3\n").unwrap_err().starts_with("not a .npy file"));
        assert!(read("short", b"\x93NUMPY\x01\x00\xff\x00").unwrap_err().starts_with("not a .npy file"));
        let data: Vec<u8> = [1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(wrong(&header("<f8", "(2, 3)"), &data), "row 1, column 1 (from 0): NaN is not finite");
    }
}
