//! NumPy's `.npz`: a zip of named `.npy` arrays, none of them compressed. Other endings go to the library.

mod read;

use std::io::Write;
use std::path::Path;

use laguerre::io;
use laguerre::{CellStatus, Output, PowerDiagram, Result};
use rawzip::ZipArchiveWriter;

pub(crate) use read::{read_cells, read_facets, read_sites};

/// The ending of such files.
pub(crate) const ENDING: &str = ".npz";

/// Endings that the library knows, and this.
pub(crate) fn with_npz(known: &[&'static str]) -> Vec<&'static str> {
    known.iter().copied().chain([ENDING]).collect()
}

/// Writes cells: `volume` (N), `barycenter` (N, 3), `status` (N), and where the output has them `facets`, their number (N),
/// `integral` (N) and `second_moment` (N, 3, 3).
///
/// # Errors
/// `Io` where writing failed.
pub(crate) fn write_cells(path: &Path, output: &Output) -> Result<()> {
    let n = output.volume().len();
    io::write_whole(path, |w| {
        let mut npz = Npz::new(w);
        npz.add("volume", &[n], output.volume().iter().copied())?;
        npz.add("barycenter", &[n, 3], output.barycenter().iter().copied().flatten())?;
        npz.add("status", &[n], output.status().iter().copied().map(CellStatus::number))?;
        if output.facets().is_some() {
            npz.add("facets", &[n], (0..n).map(|i| io::facet_count(output, i).unwrap_or(0) as i64))?;
        }
        if let Some(integral) = output.integral() {
            npz.add("integral", &[n], integral.iter().copied())?;
        }
        if let Some(moments) = output.second_moment() {
            let matrix = |&[xx, yy, zz, xy, xz, yz]: &[f64; 6]| [xx, xy, xz, xy, yy, yz, xz, yz, zz];
            npz.add("second_moment", &[n, 3, 3], moments.iter().flat_map(matrix))?;
        }
        npz.finish()
    })
}

/// Writes facets by the file's ending; as `.npz` the rows of the other forms as arrays: `offsets` (N + 1; the rows of site i are from
/// `offsets[i]` to before `offsets[i + 1]`), `site`, `neighbor`, `area`, `distance` (M each), and `barycenter` (M, 3).
///
/// # Errors
/// As [`io::write_facets`].
pub(crate) fn write_facets(path: &Path, diagram: &PowerDiagram, output: &Output) -> Result<()> {
    if io::ending(path, &[ENDING]).is_err() {
        return io::write_facets(path, diagram, output);
    }
    let rows = || io::facet_rows(output);
    let mut offsets = vec![0_i64; output.volume().len() + 1];
    rows().for_each(|row| offsets[row.site + 1] += 1);
    (1..offsets.len()).for_each(|i| offsets[i] += offsets[i - 1]);
    let m = rows().count();
    io::write_whole(path, |w| {
        let mut npz = Npz::new(w);
        npz.add("offsets", &[offsets.len()], offsets.iter().copied())?;
        npz.add("site", &[m], rows().map(|row| row.site as i64))?;
        npz.add("neighbor", &[m], rows().map(|row| row.neighbor_number()))?;
        npz.add("area", &[m], rows().map(|row| row.area))?;
        npz.add("barycenter", &[m, 3], rows().flat_map(|row| row.barycenter))?;
        npz.add("distance", &[m], rows().map(|row| row.distance))?;
        npz.finish()
    })
}

/// A sparse matrix in compressed rows.
pub(crate) struct Csr<S, E> {
    pub(crate) shape: [usize; 2],
    /// How many entries there are.
    pub(crate) count: usize,
    /// Where each row starts, and where the last ends.
    pub(crate) starts: S,
    /// Makes the column and the number of each entry, row by row.
    pub(crate) entries: E,
}

/// Writes a sparse matrix for `scipy.sparse.load_npz`: `format`, `shape`, `data`, `indices`, `indptr`.
///
/// # Errors
/// `Io` where writing failed.
pub(crate) fn write_csr<S, F, E>(path: &Path, csr: Csr<S, F>) -> Result<()>
where
    S: Iterator<Item = usize>,
    F: Fn() -> E,
    E: Iterator<Item = (usize, f64)>,
{
    let Csr { shape: [rows, columns], count, starts, entries } = csr;
    // SciPy's direct solvers take no wider indices than these, where they suffice.
    let narrow = i32::try_from(count.max(rows).max(columns)).is_ok();
    let indices = entries().map(|(column, _)| column);
    io::write_whole(path, |w| {
        let mut npz = Npz::new(w);
        npz.add("format", &[], [*b"csr"].into_iter())?;
        npz.add("shape", &[2], [rows as i64, columns as i64].into_iter())?;
        npz.add("data", &[count], entries().map(|(_, x)| x))?;
        if narrow {
            npz.add("indices", &[count], indices.map(|i| i as i32))?;
            npz.add("indptr", &[rows + 1], starts.map(|i| i as i32))?;
        } else {
            npz.add("indices", &[count], indices.map(|i| i as i64))?;
            npz.add("indptr", &[rows + 1], starts.map(|i| i as i64))?;
        }
        npz.finish()
    })
}

/// Numbers that an array can be of.
trait Number {
    /// What NumPy calls them.
    const NAME: &str;
    type Bytes: AsRef<[u8]>;

    /// Little-endian.
    fn bytes(self) -> Self::Bytes;
}

macro_rules! number {
    ($($number:ty, $name:literal;)*) => {$(
        impl Number for $number {
            const NAME: &str = $name;
            type Bytes = [u8; size_of::<$number>()];

            fn bytes(self) -> Self::Bytes {
                self.to_le_bytes()
            }
        }
    )*};
}

number! {
    f64, "<f8";
    i64, "<i8";
    i32, "<i4";
    u8, "|u1";
    i8, "|i1";
}

/// A word, as an array of no dimension.
impl Number for [u8; 3] {
    const NAME: &str = "|S3";
    type Bytes = Self;

    fn bytes(self) -> Self {
        self
    }
}

/// What is being written.
struct Npz<W> {
    archive: ZipArchiveWriter<W>,
}

impl<W: Write> Npz<W> {
    fn new(writer: W) -> Self {
        Self { archive: ZipArchiveWriter::new(writer) }
    }

    /// An array in C order.
    fn add<T: Number>(
        &mut self,
        name: &str,
        shape: &[usize],
        mut numbers: impl Iterator<Item = T>,
    ) -> std::io::Result<()> {
        let name = format!("{name}.npy");
        let (mut entry, config) = self.archive.new_file(name.as_str()).start().map_err(as_io)?;
        let mut data = config.wrap(&mut entry);
        data.write_all(&header::<T>(shape))?;
        numbers.try_for_each(|number| data.write_all(number.bytes().as_ref()))?;
        let (_, descriptor) = data.finish().map_err(as_io)?;
        entry.finish(descriptor).map_err(as_io).map(drop)
    }

    fn finish(self) -> std::io::Result<()> {
        self.archive.finish().map_err(as_io).map(drop)
    }
}

/// The head of a `.npy` file, as long as a multiple of 64 bytes.
fn header<T: Number>(shape: &[usize]) -> Vec<u8> {
    let shape: String = shape.iter().map(|size| format!("{size}, ")).collect();
    let says = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", T::NAME, shape.trim_end());
    // Magic, version, length of the text; its last character is a line end.
    let length = (10 + says.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{says:<0$}\n", length - 1).bytes());
    bytes
}

/// What the operating system said stays as it is.
fn as_io(error: rawzip::Error) -> std::io::Error {
    match error.into_kind() {
        rawzip::ErrorKind::IO(error) => error,
        kind => std::io::Error::other(rawzip::Error::from(kind).to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_as_numpy_writes_them() {
        let text = |bytes: &[u8]| String::from_utf8(bytes[10..].to_vec()).unwrap();
        let [one, two] = [header::<f64>(&[7]), header::<i8>(&[7, 3])];
        assert!(
            text(&one).starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (7,), }  "),
            "{}",
            text(&one)
        );
        assert!(
            text(&two).starts_with("{'descr': '|i1', 'fortran_order': False, 'shape': (7, 3,), }"),
            "{}",
            text(&two)
        );
        for bytes in [one, two] {
            assert!(bytes.len() == 128 && bytes.ends_with(b" \n") && bytes[8..10] == [118, 0]);
        }
    }
}
