//! NumPy's `.npy`, through `npyz`, behind checks of what a header claims.

use std::io::{self, BufRead, Read, Write};

use npyz::{NpyFile, NpyHeader, Order, WriterBuilder};

use super::cannot_read;
use super::lines::shown;
use crate::{Error, Result};

/// Longest header that is read; NumPy itself takes no longer ones.
const LONGEST_HEADER: usize = 10_000;
/// A header of numbers has one dictionary and one tuple. The library's parser takes three times as long for each brace more.
const MOST_BRACKETS: usize = 4;
/// Sizes of so many digits in all have a product below 2⁶⁴; a longer shape is that of no file.
const MOST_DIGITS: usize = 18;

/// An array of floats in a file, its header read and held against the file's length.
pub(super) struct Array<R> {
    pub(super) rows: usize,
    pub(super) columns: usize,
    header: NpyHeader,
    /// Whether they are 32-bit floats.
    pub(super) single: bool,
    reader: R,
}

impl<R: BufRead> Array<R> {
    /// Reads the header. `length` is that of the whole file; `shape` says what is a shape of rows and columns, `needed` which are.
    pub(super) fn open(
        mut reader: R,
        length: u64,
        needed: &str,
        shape: impl Fn(&[u64]) -> Option<(u64, u64)>,
    ) -> Result<Self> {
        let (header, header_bytes) = read_header(&mut reader)?;
        let found = header.shape();
        let Some((rows, columns)) = shape(found) else {
            return Err(Error::input(format!("shape {found:?}; {needed} is needed")));
        };
        let descr = header.dtype().descr();
        let single = match descr.trim_matches('\'') {
            "<f8" | ">f8" => false,
            "<f4" | ">f4" => true,
            _ => {
                return Err(Error::input(format!(
                    "type {}; 'f8' or 'f4' is needed (NumPy: a.astype('f8'))",
                    shown(&descr)
                )));
            }
        };
        // Before anything is allocated from the shape.
        let held = length.saturating_sub(header_bytes);
        if header.len().checked_mul(if single { 4 } else { 8 }) != Some(held) {
            return Err(Error::input(format!(
                "{held} bytes of data, but shape {found:?} of {descr} needs other; is the file whole?"
            )));
        }
        Ok(Self { rows: rows as usize, columns: columns as usize, header, single, reader })
    }

    /// The shape as it stands in the header.
    pub(super) fn shape(&self) -> &[u64] {
        self.header.shape()
    }

    /// Whether the first index is the fastest.
    pub(super) fn is_fortran(&self) -> bool {
        self.header.order() == Order::Fortran
    }

    /// Hands every number on as (row, column, number), in the order of the file; one that is not finite is an error.
    pub(super) fn for_each(self, mut put: impl FnMut(usize, usize, f64)) -> Result<()> {
        self.for_each_number(|row, column, x| {
            if !x.is_finite() {
                return Err(Error::input(format!("row {row}, column {column} (from 0): {x} is not finite")));
            }
            put(row, column, x);
            Ok(())
        })
    }

    /// Hands every number on as (row, column, number), in the order of the file, whatever it is.
    pub(super) fn for_each_number(self, mut put: impl FnMut(usize, usize, f64) -> Result<()>) -> Result<()> {
        let Self { rows, columns, .. } = self;
        let order = self.header.order();
        let mut take = |(i, x): (usize, io::Result<f64>)| {
            let (row, column) = match order {
                Order::C => (i / columns, i % columns),
                Order::Fortran => (i % rows, i / rows),
            };
            put(row, column, x.map_err(cannot_read)?)
        };
        let npy = NpyFile::with_header(self.header, self.reader);
        let strange = |e: npyz::DTypeError| Error::input(e.to_string());
        if self.single {
            let numbers = npy.data::<f32>().map_err(strange)?;
            numbers.map(|x| x.map(f64::from)).enumerate().try_for_each(&mut take)
        } else {
            npy.data::<f64>().map_err(strange)?.enumerate().try_for_each(&mut take)
        }
    }
}

/// Writes an array of the given shape, its numbers in C order, as little-endian `f64`.
pub(super) fn write(writer: &mut dyn Write, shape: &[u64], numbers: impl Iterator<Item = f64>) -> io::Result<()> {
    let mut npy = npyz::WriteOptions::<f64>::new().default_dtype().shape(shape).writer(writer).begin_nd()?;
    npy.extend(numbers)?;
    npy.finish()
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
    // What the library says of a header takes several lines.
    let header = NpyHeader::from_reader(&bytes[..]).map_err(|_| strange())?;
    Ok((header, bytes.len() as u64))
}

#[cfg(test)]
mod tests {
    use super::super::{SitesFile, parse_sites};

    /// A file with the given header text and data.
    fn npy(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read(bytes: &[u8]) -> std::result::Result<SitesFile, String> {
        parse_sites(bytes, "s.npy").map_err(|e| e.to_string().replace("s.npy: ", ""))
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
                assert_eq!(read(&npy(&header, &data)).unwrap(), expected, "{kind} {fortran}");
            }
        }
    }

    #[test]
    fn headers_are_not_believed() {
        let header =
            |kind: &str, shape: &str| format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}}}\n");
        let wrong = |header: &str, data: &[u8]| read(&npy(header, data)).unwrap_err();
        assert_eq!(
            wrong(&header("<f8", "(1000000000000000, 3)"), &[0; 24]),
            "24 bytes of data, but shape [1000000000000000, 3] of '<f8' needs other; is the file whole?"
        );
        assert!(wrong(&header("<f8", "(2, 3)"), &[0; 47]).starts_with("47 bytes of data"));
        assert_eq!(wrong(&header("<f8", "(5,)"), &[0; 40]), "shape [5]; (N, 3), or (N, 4) with weights, is needed");
        assert!(wrong(&header("<i8", "(1, 3)"), &[0; 24]).starts_with("type '<i8'; 'f8' or 'f4' is needed"));
        let strange = "its .npy header is not that of an array of numbers";
        assert_eq!(wrong(&header("<f8", "(99999999999999999999, 99999999999999999999)"), &[]), strange);
        assert_eq!(wrong(&header("<f8", &"(".repeat(5000)), &[]), strange);
        assert_eq!(wrong("no dictionary", &[]), strange);
        assert!(read(b"1 2 3\n").unwrap_err().starts_with("not a .npy file"));
        assert!(read(b"\x93NUMPY\x01\x00\xff\x00").unwrap_err().starts_with("not a .npy file"));
        let data: Vec<u8> = [1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(wrong(&header("<f8", "(2, 3)"), &data), "row 1, column 1 (from 0): NaN is not finite");
    }
}
