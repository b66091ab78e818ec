//! Results read back, whoever wrote them: cells and facets, each `.csv` or `.npy`, as [`write_cells`](super::write_cells) and
//! [`write_facets`](super::write_facets) describe them.

use std::io::BufRead;
use std::path::Path;

use super::lines::{Lines, finite, shown};
use super::npy::Array;
use super::{CELLS_ENDINGS, FACETS_ENDINGS, ending, open};
use crate::{CellStatus, Error, Result, memory};

/// What a file says of one cell. Numbers stand as they were found: they may be negative, infinite or NaN.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CellRow {
    /// The site whose cell it says it is.
    pub site: u64,
    /// Volume (length³).
    pub volume: f64,
    /// Barycenter.
    pub barycenter: [f64; 3],
    /// Number of facets, where the file says.
    pub facets: Option<u64>,
    /// How the cell ended, where the file says.
    pub status: Option<CellStatus>,
}

/// A file of cells.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CellsFile {
    /// The rows in the order of the file.
    pub rows: Vec<CellRow>,
    /// Whether the numbers went through 32-bit floats.
    pub single: bool,
}

/// What a file says of one facet. Numbers stand as they were found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FacetRow {
    /// The site on this side.
    pub site: u32,
    /// The site beyond it; `None` for the boundary.
    pub neighbor: Option<u32>,
    /// Area (length²).
    pub area: f64,
    /// Barycenter.
    pub barycenter: [f64; 3],
    /// Distance between the two sites; `None` where the field is empty or NaN.
    pub distance: Option<f64>,
    /// Its line in the file, or its row in an array, from 1.
    pub line: usize,
}

/// Reads a file of cells by its ending.
///
/// * `.csv`: header `site,volume,x,y,z,facets,status`, of which the last two may be missing; a row a cell. An empty field is NaN in
///   x, y, z, and "not said" in `facets` and `status`, as is NaN in `facets`. A status is 0, 1, 2 or `complete`, `empty`, `uncertified`.
/// * `.npy`: shape (N, 4), 32- or 64-bit floats: volume and barycenter.
///
/// # Errors
/// `Io` where the file cannot be read; `Input`, with file and line, where it is no such file.
pub fn read_cells(path: impl AsRef<Path>) -> Result<CellsFile> {
    let path = path.as_ref();
    let format = ending(path, CELLS_ENDINGS)?;
    let (reader, length) = open(path)?;
    cells(reader, length, format).map_err(|e| e.in_file(path))
}

/// Reads cells from the bytes of a file called `name`, as [`read_cells`] does.
///
/// # Errors
/// `Input`, as [`read_cells`].
pub fn parse_cells(bytes: &[u8], name: impl AsRef<Path>) -> Result<CellsFile> {
    let name = name.as_ref();
    cells(bytes, bytes.len() as u64, ending(name, CELLS_ENDINGS)?).map_err(|e| e.in_file(name))
}

/// Reads a file of facets by its ending: `.csv` with header `site,neighbor,area,x,y,z,distance`, or `.npy` of shape (M, 7) with those columns;
/// neighbor −1 for the boundary.
///
/// # Errors
/// `Io` where the file cannot be read; `Input`, with file and line, where it is no such file.
pub fn read_facets(path: impl AsRef<Path>) -> Result<Vec<FacetRow>> {
    let path = path.as_ref();
    let format = ending(path, FACETS_ENDINGS)?;
    let (reader, length) = open(path)?;
    facets(reader, length, format).map_err(|e| e.in_file(path))
}

/// Reads facets from the bytes of a file called `name`, as [`read_facets`] does.
///
/// # Errors
/// `Input`, as [`read_facets`].
pub fn parse_facets(bytes: &[u8], name: impl AsRef<Path>) -> Result<Vec<FacetRow>> {
    let name = name.as_ref();
    facets(bytes, bytes.len() as u64, ending(name, FACETS_ENDINGS)?).map_err(|e| e.in_file(name))
}

fn cells(reader: impl BufRead, length: u64, format: &str) -> Result<CellsFile> {
    match format {
        ".npy" => cells_npy(reader, length),
        _ => cells_csv(reader),
    }
}

fn cells_npy(reader: impl BufRead, length: u64) -> Result<CellsFile> {
    let array = Array::open(reader, length, "(N, 4), volume and barycenter,", |shape| match *shape {
        [rows, 4] => Some((rows, 4)),
        _ => None,
    })?;
    let single = array.single;
    let mut rows = memory::filled(CellRow::default(), array.rows, "cells")?;
    array.for_each_number(|row, column, x| {
        rows[row].site = row as u64;
        match column {
            0 => rows[row].volume = x,
            _ => rows[row].barycenter[column - 1] = x,
        }
        Ok(())
    })?;
    Ok(CellsFile { rows, single })
}

fn cells_csv(reader: impl BufRead) -> Result<CellsFile> {
    const HEADER: [&str; 7] = ["site", "volume", "x", "y", "z", "facets", "status"];
    let mut lines = Lines::new(reader);
    let columns = header(&mut lines, &HEADER, 5)?;
    let mut rows = Vec::new();
    while let Some(line) = lines.next_line()? {
        let row = fields(line, columns).and_then(|f| {
            Ok(CellRow {
                site: whole(f[0])?,
                volume: number(f[1])?,
                barycenter: point(&f[2..5])?,
                facets: optional(f.get(5), count)?.flatten(),
                status: optional(f.get(6), status)?,
            })
        });
        memory::push(&mut rows, row.map_err(|what| lines.wrong(what))?, "cells")?;
    }
    Ok(CellsFile { rows, single: false })
}

fn facets(reader: impl BufRead, length: u64, format: &str) -> Result<Vec<FacetRow>> {
    match format {
        ".npy" => facets_npy(reader, length),
        _ => facets_csv(reader),
    }
}

fn facets_npy(reader: impl BufRead, length: u64) -> Result<Vec<FacetRow>> {
    let array = Array::open(reader, length, "(M, 7), the columns of .csv,", |shape| match *shape {
        [rows, 7] => Some((rows, 7)),
        _ => None,
    })?;
    let mut rows = memory::filled(FacetRow::default(), array.rows, "facets")?;
    array.for_each_number(|row, column, x| {
        let site = || {
            let is_site = x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0;
            let wrong = || Error::input(format!("row {row}, column {column} (from 0): {x} is no number of a site"));
            is_site.then_some(x as u32).ok_or_else(wrong)
        };
        let facet: &mut FacetRow = &mut rows[row];
        facet.line = row + 1;
        match column {
            0 => facet.site = site()?,
            1 => facet.neighbor = if x == -1.0 { None } else { Some(site()?) },
            2 => facet.area = x,
            6 => facet.distance = (!x.is_nan()).then_some(x),
            _ => facet.barycenter[column - 3] = x,
        }
        Ok(())
    })?;
    Ok(rows)
}

fn facets_csv(reader: impl BufRead) -> Result<Vec<FacetRow>> {
    const HEADER: [&str; 7] = ["site", "neighbor", "area", "x", "y", "z", "distance"];
    let mut lines = Lines::new(reader);
    let columns = header(&mut lines, &HEADER, HEADER.len())?;
    let mut rows = Vec::new();
    while let Some(line) = lines.next_line()? {
        let row = fields(line, columns).and_then(|f| {
            Ok(FacetRow {
                site: whole(f[0])?,
                neighbor: if f[1] == "-1" { None } else { Some(whole(f[1])?) },
                area: number(f[2])?,
                barycenter: point(&f[3..6])?,
                distance: optional(f.get(6), number)?.filter(|distance| !distance.is_nan()),
                line: 0,
            })
        });
        let line = lines.number();
        memory::push(&mut rows, FacetRow { line, ..row.map_err(|what| lines.wrong(what))? }, "facets")?;
    }
    Ok(rows)
}

/// Reads the header: the names in their order, at least the first `least`. Returns how many there are.
fn header(lines: &mut Lines<impl BufRead>, names: &[&str], least: usize) -> Result<usize> {
    let (needed, more) = names.split_at(least);
    let needed = match more {
        [] => format!("{} is needed", needed.join(",")),
        more => format!("{} is needed, and {} may follow", needed.join(","), more.join(",")),
    };
    let found: Vec<String> = match lines.next_line()? {
        Some(line) => line.split(',').map(|word| word.trim().trim_matches('"').to_string()).collect(),
        None => return Err(Error::input(format!("nothing in it; the header {needed}"))),
    };
    if found.len() < least || found.len() > names.len() || found.iter().zip(names).any(|(a, b)| a != b) {
        let found = shown(&found.join(","));
        return Err(lines.wrong(format_args!("header '{found}'; {needed}")));
    }
    Ok(found.len())
}

/// What the parsers of fields return: the reason alone, for the caller to add the place.
type Field<T> = std::result::Result<T, String>;

fn fields(line: &str, columns: usize) -> Field<Vec<&str>> {
    // One more than wanted is enough to know that there are too many.
    let fields: Vec<&str> = line.splitn(columns + 1, ',').map(str::trim).collect();
    match fields.len() == columns && !fields[columns - 1].contains(',') {
        true => Ok(fields),
        false => Err(format!("{} columns, but the header has {columns}", line.split(',').count())),
    }
}

fn number(word: &str) -> Field<f64> {
    word.parse().or_else(|_| finite(word))
}

fn point(words: &[&str]) -> Field<[f64; 3]> {
    let mut point = [f64::NAN; 3];
    for (x, word) in point.iter_mut().zip(words) {
        *x = optional(Some(word), number)?.unwrap_or(f64::NAN);
    }
    Ok(point)
}

fn whole<T: std::str::FromStr>(word: &str) -> Field<T> {
    word.parse().map_err(|_| format!("'{}' is no index or count", shown(word)))
}

/// A number of facets; `None` where it is NaN, which says that they were not counted.
fn count(word: &str) -> Field<Option<u64>> {
    if word.eq_ignore_ascii_case("nan") { Ok(None) } else { whole(word).map(Some) }
}

/// A number, or the word that older files have.
fn status(word: &str) -> Field<CellStatus> {
    let known = [CellStatus::Complete, CellStatus::Empty, CellStatus::Uncertified];
    known.into_iter().find(|s| s.word() == word || s.number().to_string() == word).ok_or_else(|| {
        let words = known.map(|s| format!("{} {}", s.number(), s.word())).join(", ");
        format!("status '{}'; known here: {words}", shown(word))
    })
}

/// The field, unless it is missing or empty.
fn optional<T>(word: Option<&&str>, parse: impl Fn(&str) -> Field<T>) -> Field<Option<T>> {
    word.filter(|word| !word.is_empty()).map(|word| parse(word)).transpose()
}

#[cfg(test)]
mod tests {
    use super::super::{known, scratch, write_cells, write_facets};
    use super::*;
    use crate::oracle::Naive;
    use crate::{Backend, PowerDiagram, Request};

    #[test]
    fn what_was_written_is_read_to_the_last_bit() {
        let positions: Vec<[f64; 3]> = (0..9).map(|i| [0.37, 0.61, 0.83].map(|a| (a * f64::from(i)).fract())).collect();
        let weights: Vec<f64> = (0..9).map(|i| if i == 4 { -0.5 } else { 0.0 }).collect();
        let diagram = PowerDiagram::new(&positions, &weights).unwrap();
        let output = Naive::default().evaluate(&diagram, &Request::moments().with_facets()).unwrap();
        let folder = scratch("read-results");
        for name in known(&["cells.csv", "cells.npy"]) {
            write_cells(folder.join(name), &diagram, &output).unwrap();
            let rows = read_cells(folder.join(name)).unwrap().rows;
            assert_eq!(rows.len(), 9);
            for (i, row) in rows.iter().enumerate() {
                let bits = |v: f64, b: [f64; 3]| [v, b[0], b[1], b[2]].map(f64::to_bits);
                assert_eq!(
                    bits(row.volume, row.barycenter),
                    bits(output.volume()[i], output.barycenter()[i]),
                    "{name} {i}"
                );
                assert_eq!(row.site, i as u64);
                assert_eq!(row.status, Some(output.status()[i]).filter(|_| name == "cells.csv"));
            }
        }
        let list = output.facets().unwrap();
        for name in known(&["facets.csv", "facets.npy"]) {
            let first = if name == "facets.csv" { 2 } else { 1 };
            write_facets(folder.join(name), &diagram, &output).unwrap();
            let facets = read_facets(folder.join(name)).unwrap();
            let inner: Vec<&FacetRow> = facets.iter().filter(|f| f.neighbor.is_some()).collect();
            assert_eq!(inner.len(), list.area().len());
            for (k, row) in inner.iter().enumerate() {
                assert_eq!((row.neighbor, row.area), (Some(list.neighbor()[k]), list.area()[k]));
                assert_eq!((row.barycenter, row.distance), (list.barycenter()[k], Some(list.distance()[k])));
            }
            assert!(facets.iter().any(|f| f.neighbor.is_none() && f.distance.is_none()));
            assert!(facets.iter().enumerate().all(|(k, row)| row.line == k + first));
        }
    }

    #[test]
    fn a_status_is_a_number_or_a_word() {
        let numbers = "site,volume,x,y,z,facets,status\n0,1,2,3,4,NaN,0\n1,0,NaN,NaN,NaN,0,1\n2,1,2,3,4,5,2\n";
        let words =
            "site,volume,x,y,z,facets,status\n0,1,2,3,4,,complete\n1,0,NaN,NaN,NaN,0,empty\n2,1,2,3,4,5,uncertified\n";
        let said = |text: &str| {
            let rows = parse_cells(text.as_bytes(), "c.csv").unwrap().rows;
            rows.iter().map(|row| (row.facets, row.status)).collect::<Vec<_>>()
        };
        assert_eq!(said(numbers), said(words));
        let statuses = [CellStatus::Complete, CellStatus::Empty, CellStatus::Uncertified].map(Some);
        assert_eq!(said(numbers), [None, Some(0), Some(5)].into_iter().zip(statuses).collect::<Vec<_>>());
    }

    #[test]
    fn others_may_leave_out_what_they_do_not_know() {
        let file = parse_cells(b"\"site\",volume,x,y,z\r\n0, 1.5 ,1,2,3\r\n1,0,,,\r\n", "a.csv").unwrap();
        assert_eq!(file.rows[0].volume, 1.5);
        assert!(file.rows[1].barycenter.iter().all(|x| x.is_nan()) && file.rows[1].status.is_none());
        let file = parse_cells(b"site,volume,x,y,z,facets,status\n0,-inf,nan,0,0,,\n", "a.csv").unwrap();
        assert!(file.rows[0].volume == f64::NEG_INFINITY && file.rows[0].facets.is_none());
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        let wrong = |text: &str| parse_cells(text.as_bytes(), "c.csv").unwrap_err().to_string();
        let header = "site,volume,x,y,z,facets,status\n";
        let needed = "site,volume,x,y,z is needed, and facets,status may follow";
        assert_eq!(wrong(""), format!("c.csv: nothing in it; the header {needed}"));
        assert!(wrong("1 2 3\n").starts_with("c.csv: line 1: header '1 2 3'; site,volume"));
        assert!(wrong("site,volume,x,y\n").starts_with("c.csv: line 1: header"));
        assert_eq!(wrong(&format!("{header}0,1,2,3\n")), "c.csv: line 2: 4 columns, but the header has 7");
        assert_eq!(wrong(&format!("{header}0,1,2,3,4,5,empty,7\n")), "c.csv: line 2: 8 columns, but the header has 7");
        assert_eq!(wrong(&format!("{header}0,one,2,3,4,5,empty\n")), "c.csv: line 2: 'one' is not a number");
        assert_eq!(wrong(&format!("{header}-1,1,2,3,4,5,empty\n")), "c.csv: line 2: '-1' is no index or count");
        let known = "known here: 0 complete, 1 empty, 2 uncertified";
        assert_eq!(wrong(&format!("{header}0,1,2,3,4,5,fine\n")), format!("c.csv: line 2: status 'fine'; {known}"));
        let facets = "site,neighbor,area,x,y,z,distance\n0,-2,1,2,3,4,5\n";
        let error = parse_facets(facets.as_bytes(), "f.csv").unwrap_err().to_string();
        assert_eq!(error, "f.csv: line 2: '-2' is no index or count");
    }

    #[cfg(feature = "npy")]
    #[test]
    fn what_is_wrong_in_an_array_is_named_by_row() {
        assert!(parse_cells(b"junk", "c.npy").unwrap_err().to_string().starts_with("c.npy: not a .npy file"));
        assert!(parse_facets(b"", "f.npy").is_err());
        let folder = scratch("read-facets");
        let said = |numbers: [f64; 7]| {
            let path = folder.join("f.npy");
            super::super::write_whole(&path, |w| super::super::npy::write(w, &[1, 7], numbers.into_iter())).unwrap();
            read_facets(path).unwrap_err().to_string()
        };
        assert!(
            said([0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0]).ends_with("row 0, column 1 (from 0): 0.5 is no number of a site")
        );
        assert!(
            said([-1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0]).ends_with("row 0, column 0 (from 0): -1 is no number of a site")
        );
    }
}
