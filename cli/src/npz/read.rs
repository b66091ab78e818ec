//! Results in `.npz`, whoever wrote them, as `verify` reads them; and sites.

use std::borrow::Cow;
use std::fs;
use std::io::Read;
use std::path::Path;

use flate2::bufread::DeflateDecoder;
use laguerre::engine::memory;
use laguerre::io::{self, CellRow, CellsFile, FacetRow, SitesFile};
use laguerre::{CellStatus, Error, ErrorKind, Result};
use rawzip::{CompressionMethod, ZipArchive, ZipSliceArchive};

use super::{ENDING, with_npz};

/// Reads cells by the file's ending: see [`io::read_cells`] and, for `.npz`, [`super::write_cells`].
///
/// # Errors
/// `Io` where the file cannot be read; `Input` where it is no such file.
pub(crate) fn read_cells(path: &Path) -> Result<CellsFile> {
    match io::ending(path, &with_npz(io::CELLS_ENDINGS))? {
        ENDING => read(path).and_then(|bytes| cells(&bytes)).map_err(|e| e.at(path.display())),
        _ => io::read_cells(path),
    }
}

/// Reads facets by the file's ending: see [`io::read_facets`] and, for `.npz`, [`super::write_facets`].
///
/// # Errors
/// As [`read_cells`].
pub(crate) fn read_facets(path: &Path) -> Result<Vec<FacetRow>> {
    match io::ending(path, &with_npz(io::FACETS_ENDINGS))? {
        ENDING => read(path).and_then(|bytes| facets(&bytes)).map_err(|e| e.at(path.display())),
        _ => io::read_facets(path),
    }
}

/// Names of the array of positions, the last that of the only array of `np.savez(file, array)`.
const POSITIONS: [&str; 4] = ["positions", "points", "sites", "arr_0"];
const WEIGHTS: [&str; 2] = ["weights", "weight"];

/// Reads sites by the file's ending: see [`io::read_sites`]; of an `.npz` an array of positions (N, 3), and one of weights (N) if there is one.
///
/// # Errors
/// As [`read_cells`].
pub(crate) fn read_sites(path: &Path) -> Result<SitesFile> {
    // Standard input is text.
    if path.as_os_str() == "-" || io::input_ending(path, &with_npz(io::SITES_INPUT_ENDINGS))? != ENDING {
        return io::read_sites(path);
    }
    read(path).and_then(|bytes| sites(&bytes)).map_err(|e| e.at(path.display()))
}

fn sites(bytes: &[u8]) -> Result<SitesFile> {
    let archive = ZipArchive::from_slice(bytes).map_err(strange)?;
    let first = |names: &[&'static str], columns: usize| {
        let mut found = names.iter().filter_map(|name| Some((name, array(&archive, name, columns).transpose()?)));
        match (found.next(), found.next()) {
            (Some((one, _)), Some((other, _))) => {
                Err(Error::input(format!("there are both '{one}' and '{other}' in it; keep the one that is meant")))
            }
            (one, _) => one.map(|(_, array)| array).transpose(),
        }
    };
    let missing = || Error::input(format!("there is none of the arrays {} in it", POSITIONS.join(", ")));
    let positions = first(&POSITIONS, 3)?.ok_or_else(missing)?;
    let weights = first(&WEIGHTS, 1)?.map(|a| a.of(positions.rows)).transpose()?;
    if positions.rows == 0 {
        return Err(Error::input("no sites in it; at least one is needed"));
    }
    let mut sites = SitesFile::default();
    sites.positions = memory::filled([0.0; 3], positions.rows, "sites")?;
    for (i, position) in sites.positions.iter_mut().enumerate() {
        *position = [positions.finite(i, 0)?, positions.finite(i, 1)?, positions.finite(i, 2)?];
    }
    if let Some(weights) = weights {
        sites.weights = memory::filled(0.0, weights.rows, "weights")?;
        for (i, weight) in sites.weights.iter_mut().enumerate() {
            *weight = weights.finite(i, 0)?;
        }
    }
    Ok(sites)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).map_err(|e| Error::new(ErrorKind::Io, format!("cannot open: {e}")))
}

fn cells(bytes: &[u8]) -> Result<CellsFile> {
    let archive = ZipArchive::from_slice(bytes).map_err(strange)?;
    let volume = needed(&archive, "volume", 1)?;
    let n = volume.rows;
    let barycenter = needed(&archive, "barycenter", 3)?.of(n)?;
    let facets = array(&archive, "facets", 1)?.map(|a| a.of(n)).transpose()?;
    let status = array(&archive, "status", 1)?.map(|a| a.of(n)).transpose()?;
    let mut file = CellsFile::default();
    file.single = volume.kind == "<f4" || barycenter.kind == "<f4";
    file.rows = memory::filled(CellRow::default(), n, "cells")?;
    for (i, row) in file.rows.iter_mut().enumerate() {
        row.site = i as u64;
        row.volume = volume.at(i, 0);
        row.barycenter = std::array::from_fn(|k| barycenter.at(i, k));
        row.facets = facets.as_ref().map(|a| a.whole(i, u64::MAX)).transpose()?;
        row.status = status.as_ref().map(|a| a.status(i)).transpose()?;
    }
    Ok(file)
}

fn facets(bytes: &[u8]) -> Result<Vec<FacetRow>> {
    let archive = ZipArchive::from_slice(bytes).map_err(strange)?;
    let site = needed(&archive, "site", 1)?;
    let m = site.rows;
    let neighbor = needed(&archive, "neighbor", 1)?.of(m)?;
    let area = needed(&archive, "area", 1)?.of(m)?;
    let barycenter = needed(&archive, "barycenter", 3)?.of(m)?;
    let distance = needed(&archive, "distance", 1)?.of(m)?;
    let mut rows = memory::filled(FacetRow::default(), m, "facets")?;
    for (k, row) in rows.iter_mut().enumerate() {
        let is_boundary = neighbor.at(k, 0) == -1.0;
        row.site = site.whole(k, u64::from(u32::MAX))? as u32;
        row.neighbor = if is_boundary { None } else { Some(neighbor.whole(k, u64::from(u32::MAX))? as u32) };
        row.area = area.at(k, 0);
        row.barycenter = std::array::from_fn(|axis| barycenter.at(k, axis));
        row.distance = Some(distance.at(k, 0)).filter(|d| !d.is_nan());
        row.line = k + 1;
    }
    Ok(rows)
}

type Archive<'a> = ZipSliceArchive<&'a [u8]>;

/// What the library has to say of a zip is more than a user wants to know.
fn strange(_: rawzip::Error) -> Error {
    Error::input("no .npz file, or not the whole of one")
}

/// An array of a file: rows of one number, or of some.
struct Array<'a> {
    name: &'static str,
    kind: &'static str,
    rows: usize,
    columns: usize,
    data: Cow<'a, [u8]>,
}

/// Kinds of numbers that are read, and how many bytes each takes.
const KINDS: [(&str, usize); 8] =
    [("<f8", 8), ("<f4", 4), ("<i8", 8), ("<i4", 4), ("<u8", 8), ("<u4", 4), ("|u1", 1), ("|i1", 1)];
/// Longest head of an array that is read; NumPy itself takes no longer ones.
const LONGEST_HEADER: usize = 10_000;

/// The array called `name`.
///
/// # Errors
/// `Input` where there is none, or [`array`] has one.
fn needed<'a>(archive: &'a Archive<'_>, name: &'static str, columns: usize) -> Result<Array<'a>> {
    array(archive, name, columns)?.ok_or_else(|| Error::input(format!("there is no array '{name}' in it")))
}

/// The array called `name`, if there is one, in rows of `columns`.
///
/// # Errors
/// `Input` where the file is no zip, or the array of another form, or packed otherwise than by `np.savez_compressed`.
fn array<'a>(archive: &'a Archive<'_>, name: &'static str, columns: usize) -> Result<Option<Array<'a>>> {
    let file = format!("{name}.npy");
    let mut entries = archive.entries();
    while let Some(entry) = entries.next_entry().map_err(strange)? {
        if entry.file_path().as_ref() != file.as_bytes() {
            continue;
        }
        let data = archive.get_entry(entry.wayfinder()).map_err(strange)?.data();
        let data = match entry.compression_method() {
            CompressionMethod::STORE => Cow::Borrowed(data),
            CompressionMethod::DEFLATE => Cow::Owned(inflated(data, entry.uncompressed_size_hint())?),
            _ => return Err(Error::input(format!("array '{name}' is packed; write it by np.savez"))),
        };
        return parse(data, name, columns).map(Some).map_err(|e| e.at(format_args!("array '{name}'")));
    }
    Ok(None)
}

/// What was packed to `bytes`: as much as the file says, or the file is not whole.
fn inflated(bytes: &[u8], says: u64) -> Result<Vec<u8>> {
    let mut data = Vec::new();
    let read = DeflateDecoder::new(bytes).take(says.saturating_add(1)).read_to_end(&mut data);
    if read.is_ok_and(|read| read as u64 == says) {
        Ok(data)
    } else {
        Err(Error::input("no .npz file, or not the whole of one"))
    }
}

/// Reads the head of a `.npy`, and holds what it says against what is there.
fn parse<'a>(bytes: Cow<'a, [u8]>, name: &'static str, columns: usize) -> Result<Array<'a>> {
    let strange = || Error::input("no .npy file of numbers");
    let length = match *bytes {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([a, b]))),
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _, a, b, c, d, ..] => {
            (12, u32::from_le_bytes([a, b, c, d]) as usize)
        }
        _ => return Err(strange()),
    };
    let (start, text) = length;
    if text > LONGEST_HEADER || start + text > bytes.len() {
        return Err(strange());
    }
    let says = std::str::from_utf8(&bytes[start..start + text]).map_err(|_| strange())?;
    let rest = bytes.len() - start - text;
    let after = |key: &str| says.split_once(key).map(|(_, rest)| rest.trim_start_matches([':', ' ']));
    let kind = after("'descr'").and_then(|rest| rest.strip_prefix('\'')?.split('\'').next()).ok_or_else(strange)?;
    let Some((kind, size)) = KINDS.into_iter().find(|known| known.0 == kind) else {
        let kind: String = kind.chars().filter(|c| !c.is_control()).take(20).collect();
        return Err(Error::input(format!("type '{kind}'; whole numbers or floats of this machine's order are needed")));
    };
    if !after("'fortran_order'").ok_or_else(strange)?.starts_with("False") {
        return Err(Error::input("in Fortran's order; write it by np.ascontiguousarray"));
    }
    let shape = after("'shape'").and_then(|rest| rest.strip_prefix('(')?.split(')').next()).ok_or_else(strange)?;
    let sizes = shape.split(',').map(str::trim).filter(|size| !size.is_empty()).map(str::parse);
    let sizes: Vec<usize> = sizes.collect::<std::result::Result<_, _>>().map_err(|_| strange())?;
    let rows = match *sizes.as_slice() {
        [rows] if columns == 1 => rows,
        [rows, found] if found == columns => rows,
        _ => {
            let form = if columns == 1 { "(N,)".into() } else { format!("(N, {columns})") };
            return Err(Error::input(format!("shape {sizes:?}; {form} is needed")));
        }
    };
    if rows.checked_mul(columns).and_then(|count| count.checked_mul(size)) != Some(rest) {
        return Err(Error::input(format!("{rest} bytes of data, but shape {sizes:?} needs other")));
    }
    let data = match bytes {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[start + text..]),
        Cow::Owned(mut bytes) => Cow::Owned(bytes.split_off(start + text)),
    };
    Ok(Array { name, kind, rows, columns, data })
}

impl Array<'_> {
    /// The same, if it has so many rows.
    fn of(self, rows: usize) -> Result<Self> {
        if self.rows == rows {
            return Ok(self);
        }
        Err(Error::input(format!("array '{}' has {} rows, another has {rows}", self.name, self.rows)))
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        let at = row * self.columns + column;
        match self.kind {
            "<f8" => f64::from_le_bytes(self.bytes(at)),
            "<f4" => f64::from(f32::from_le_bytes(self.bytes(at))),
            "<i8" => i64::from_le_bytes(self.bytes(at)) as f64,
            "<i4" => f64::from(i32::from_le_bytes(self.bytes(at))),
            "<u8" => u64::from_le_bytes(self.bytes(at)) as f64,
            "<u4" => f64::from(u32::from_le_bytes(self.bytes(at))),
            "|u1" => f64::from(self.data[at]),
            _ => f64::from(self.data[at] as i8),
        }
    }

    /// The bytes of a number, which are there: the head was held against the data.
    fn bytes<const SIZE: usize>(&self, at: usize) -> [u8; SIZE] {
        std::array::from_fn(|k| self.data[at * SIZE + k])
    }

    /// A finite number.
    fn finite(&self, row: usize, column: usize) -> Result<f64> {
        let x = self.at(row, column);
        let wrong =
            || Error::input(format!("array '{}', row {row}, column {column} (from 0): {x} is not finite", self.name));
        x.is_finite().then_some(x).ok_or_else(wrong)
    }

    /// A whole number.
    fn whole(&self, row: usize, most: u64) -> Result<u64> {
        let x = self.at(row, 0);
        let is_whole = x >= 0.0 && x <= most as f64 && x.fract() == 0.0;
        let wrong = || Error::input(format!("array '{}', row {row} (from 0): {x} is no index or count", self.name));
        is_whole.then_some(x as u64).ok_or_else(wrong)
    }

    fn status(&self, row: usize) -> Result<CellStatus> {
        let known = [CellStatus::Complete, CellStatus::Empty, CellStatus::Uncertified];
        let x = self.at(row, 0);
        let wrong = || Error::input(format!("array 'status', row {row} (from 0): {x}; 0, 1 and 2 are known"));
        known.into_iter().find(|status| f64::from(status.number()) == x).ok_or_else(wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Npz;
    use super::*;

    #[test]
    fn sites_are_read_by_the_names_of_their_arrays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.npz");
        let write = |arrays: &[(&str, &[usize], &[f64])]| {
            io::write_whole(&path, |w| {
                let mut npz = Npz::new(w);
                for (name, shape, numbers) in arrays {
                    npz.add(name, shape, numbers.iter().copied())?;
                }
                npz.finish()
            })
            .unwrap();
            read_sites(&path).map_err(|e| e.to_string().rsplit_once(".npz: ").unwrap().1.to_owned())
        };
        let six = [0.5, 1.0, 2.0, 3.0, 4.0, 5.0];
        let positions = vec![[0.5, 1.0, 2.0], [3.0, 4.0, 5.0]];
        for name in POSITIONS {
            let alone = write(&[("other", &[1], &[7.0]), (name, &[2, 3], &six)]).unwrap();
            assert_eq!((alone.positions, alone.weights), (positions.clone(), vec![]));
        }
        let both = write(&[("weights", &[2], &[7.0, 8.0]), ("points", &[2, 3], &six)]).unwrap();
        assert_eq!((both.positions, both.weights), (positions, vec![7.0, 8.0]));
        assert!(
            write(&[("x", &[2, 3], &six)]).unwrap_err().starts_with("there is none of the arrays positions, points")
        );
        let two = write(&[("points", &[2, 3], &six), ("sites", &[2, 3], &six)]).unwrap_err();
        assert_eq!(two, "there are both 'points' and 'sites' in it; keep the one that is meant");
        let other = write(&[("weight", &[3], &[7.0; 3]), ("points", &[2, 3], &six)]);
        assert_eq!(other.unwrap_err(), "array 'weight' has 3 rows, another has 2");
        let shape = write(&[("points", &[3, 2], &six)]).unwrap_err();
        assert_eq!(shape, "array 'points': shape [3, 2]; (N, 3) is needed");
        let nan = write(&[("points", &[1, 3], &[1.0, f64::NAN, 0.0])]).unwrap_err();
        assert_eq!(nan, "array 'points', row 0, column 1 (from 0): NaN is not finite");
        assert_eq!(write(&[("points", &[0, 3], &[])]).unwrap_err(), "no sites in it; at least one is needed");
    }
}
