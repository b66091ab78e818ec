//! Sites and weights: text (`.xyz`, `.txt`, `.csv`), NumPy's `.npy`, the vertices of a `.ply`, LAMMPS's dumps and VTK's points.

use std::io::{self, BufRead, Write};
use std::path::Path;

use super::lines::{Lines, finite, is_name, shown};
use super::npy::{self, Array};
use super::{
    Columns, Form, SITES_ENDINGS, SITES_INPUT_ENDINGS, atomic, atoms, is_standard, legacy_vtk, open, output_ending,
    ply, vtp,
};
use crate::{Error, Result, memory};

/// What a file of sites holds. Every number is finite.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SitesFile {
    /// Positions of the sites.
    pub positions: Vec<[f64; 3]>,
    /// Weights (length²), one for each site; empty where the file has none.
    pub weights: Vec<f64>,
}

/// Reads sites by the file's ending; `-` is standard input, as text.
///
/// * `.xyz`, `.txt`, `.csv`: a site a line, 3 or 4 numbers parted by blanks, commas or semicolons, the fourth the weight (length²). The first
///   line may be the number of sites, or the names of the columns: with x, y and z among them, these are what [`Columns`] says, in any order. Blank lines and `#`
///   comments are skipped.
/// * The same as chemists have them: the number of atoms, a line of comment, then rows `Fe x y z`; of an extended `.xyz` the columns that
///   `Properties=` names.
/// * `.dump`, `.lammpstrj`, or one of the above: a snapshot that LAMMPS dumped as text, with columns `x y z`, `xu yu zu` or `xs ys zs`, in the order
///   of its rows.
/// * `.npy`: shape (N, 3) or (N, 4), 32- or 64-bit floats, C or Fortran order.
/// * `.ply`: the vertices, text or binary: properties `x`, `y`, `z`, and the weight if there is a property `w` or `weight`.
/// * `.vtk`, `.vtp`: the points of VTK's PolyData, as [`read_mesh`](super::read_mesh) reads them.
///
/// All but `.npy` also with `.gz` after the ending (feature `packed`).
///
/// # Errors
/// `Io` where the file cannot be read; `Input`, with file and line (or row), where a number is missing, is none, or is
/// not finite, where rows differ in length, where the count is wrong, and where there is no site.
pub fn read_sites(path: impl AsRef<Path>) -> Result<SitesFile> {
    read(path.as_ref(), None)
}

/// Reads sites from text, as [`read_sites`] does, whose columns are as the caller says; a first line of names is passed over.
///
/// # Errors
/// As [`read_sites`], and `Input` where the file is no text.
pub fn read_sites_by_columns(path: impl AsRef<Path>, columns: &Columns) -> Result<SitesFile> {
    read(path.as_ref(), Some(columns))
}

fn read(path: &Path, columns: Option<&Columns>) -> Result<SitesFile> {
    if is_standard(path) {
        let reader: Box<dyn BufRead> = Box::new(io::stdin().lock());
        return parse(reader, 0, ".txt", columns).map_err(|e| e.at("standard input"));
    }
    let form = Form::of(path, SITES_INPUT_ENDINGS)?;
    let (reader, length) = open(path)?;
    parse(form.unpacked(reader), length, form.ending, columns).map_err(|e| e.in_file(path))
}

/// Reads sites from the bytes of a file called `name`, as [`read_sites`] does.
///
/// # Errors
/// `Input`, as [`read_sites`].
pub fn parse_sites(bytes: &[u8], name: impl AsRef<Path>) -> Result<SitesFile> {
    parse_bytes(bytes, name.as_ref(), None)
}

/// Reads sites from the bytes of a text called `name`, as [`read_sites_by_columns`] does.
///
/// # Errors
/// `Input`, as [`read_sites_by_columns`].
pub fn parse_sites_by_columns(bytes: &[u8], name: impl AsRef<Path>, columns: &Columns) -> Result<SitesFile> {
    parse_bytes(bytes, name.as_ref(), Some(columns))
}

fn parse_bytes(bytes: &[u8], name: &Path, columns: Option<&Columns>) -> Result<SitesFile> {
    let form = Form::of(name, SITES_INPUT_ENDINGS)?;
    parse(form.unpacked(bytes), bytes.len() as u64, form.ending, columns).map_err(|e| e.in_file(name))
}

/// Writes sites by the file's ending, as [`read_sites`] reads them back, to the last bit; without weights where `weights`
/// is empty. `-` is standard output, as `.csv`.
///
/// # Errors
/// `Input` for an unknown ending, or where weights are given but not one for each site; `Io` where writing failed
/// (nothing is left then).
pub fn write_sites(path: impl AsRef<Path>, positions: &[[f64; 3]], weights: &[f64]) -> Result<()> {
    let path = path.as_ref();
    if !weights.is_empty() && weights.len() != positions.len() {
        return Err(Error::input(format!("{} weights for {} sites", weights.len(), positions.len())));
    }
    let format = output_ending(path, SITES_ENDINGS)?;
    let rows = positions.iter().enumerate().map(|(i, &[x, y, z])| ([x, y, z, 0.0], weights.get(i)));
    let columns = if weights.is_empty() { 3 } else { 4 };
    let mut rows = rows.map(|(row, weight)| weight.map_or(row, |&w| [row[0], row[1], row[2], w]));
    atomic::write_whole(path, |w| match format {
        ".npy" => {
            let shape = [positions.len() as u64, columns as u64];
            npy::write(w, &shape, rows.flat_map(|row| row.into_iter().take(columns)))
        }
        ".ply" => ply::write_vertices(w, positions.len(), &["x", "y", "z", "w"][..columns], rows),
        ".csv" => {
            writeln!(w, "{}", ["x", "y", "z", "weight"][..columns].join(","))?;
            rows.try_for_each(|row| write_row(w, &row[..columns], ","))
        }
        _ => rows.try_for_each(|row| write_row(w, &row[..columns], " ")),
    })
}

fn write_row(w: &mut dyn Write, row: &[f64], between: &str) -> io::Result<()> {
    for (k, x) in row.iter().enumerate() {
        // `{:?}` is the shortest text that reads back to the same number.
        write!(w, "{}{x:?}", if k == 0 { "" } else { between })?;
    }
    writeln!(w)
}

/// Reads `format` from what is `length` bytes long.
fn parse(reader: impl BufRead, length: u64, format: &str, columns: Option<&Columns>) -> Result<SitesFile> {
    let sites = match format {
        ".npy" | ".ply" | ".vtk" | ".vtp" if columns.is_some() => {
            Err(Error::input("columns have names in text alone (.xyz, .txt, .csv)"))
        }
        ".npy" => parse_npy(reader, length),
        ".ply" => ply::parse_sites(reader),
        ".vtk" => legacy_vtk::parse(reader).map(|mesh| SitesFile { positions: mesh.vertices, weights: Vec::new() }),
        ".vtp" => vtp::parse(reader).map(|mesh| SitesFile { positions: mesh.vertices, weights: Vec::new() }),
        _ => parse_text(reader, columns),
    }?;
    if sites.positions.is_empty() {
        return Err(Error::input("no sites in it; at least one is needed"));
    }
    Ok(sites)
}

fn parse_npy(reader: impl BufRead, length: u64) -> Result<SitesFile> {
    let array = Array::open(reader, length, "(N, 3), or (N, 4) with weights,", |shape| match *shape {
        [rows, columns @ (3 | 4)] => Some((rows, columns)),
        _ => None,
    })?;
    let mut sites = SitesFile { positions: memory::filled([0.0; 3], array.rows, "sites")?, weights: Vec::new() };
    if array.columns == 4 {
        sites.weights = memory::filled(0.0, array.rows, "weights")?;
    }
    array.for_each(|row, column, x| match column {
        3 => sites.weights[row] = x,
        _ => sites.positions[row][column] = x,
    })?;
    Ok(sites)
}

/// Reads the text format, its columns as they are given or as its first line says; errors name the line.
fn parse_text(reader: impl BufRead, given: Option<&Columns>) -> Result<SitesFile> {
    let mut lines = Lines::new(reader);
    let first = lines.next_line()?.filter(|line| atoms::is_dump(line)).map(str::to_owned);
    if let Some(first) = first {
        if given.is_some() {
            return Err(Error::input("a dump of LAMMPS names its columns; read it as it is"));
        }
        return atoms::parse_dump(&mut lines, &first);
    }
    if !lines.is_at_end() {
        let line = lines.raw().to_vec();
        lines.read_again(lines.number() - 1, [line]);
    }
    let mut sites = SitesFile::default();
    // (number of its line, what it says); never used to allocate.
    let mut count: Option<(usize, u64)> = None;
    // (number of the first site's line, its columns).
    let mut shape: Option<(usize, usize)> = None;
    let mut columns = given.cloned();
    let mut named = false;
    while let Some(row) = lines.next_line()?.map(|line| parse_row(line, columns.as_ref())) {
        let number = lines.number();
        match row {
            Row::Count(n) if shape.is_none() && count.is_none() => {
                count = Some((number, n));
                if given.is_some() {
                    continue;
                }
                // Of chemists the next line is a comment, and the first row begins with a name.
                let mut next = Vec::new();
                while next.len() < 2 && lines.read_raw()? {
                    next.push(lines.raw().to_vec());
                }
                let [comment, first] = [0, 1].map(|k| next.get(k).map_or(&[][..], Vec::as_slice));
                let column = atoms::xyz_column(comment, first);
                let column = column.map_err(|what| Error::input(what).on_line(number + 1))?;
                if let Some(column) = column {
                    lines.read_again(number + 1, next.into_iter().skip(1));
                    return atoms::parse_xyz(&mut lines, (number, n), column);
                }
                lines.read_again(number, next);
            }
            Row::Names(found) if shape.is_none() && !named => {
                named = true;
                let found = found.map_err(|what| lines.wrong(what))?;
                columns = columns.or(found);
            }
            Row::Names(_) => return Err(lines.wrong("names where numbers are needed")),
            Row::Numbers(row, columns @ (3 | 4)) => {
                let (first, expected) = *shape.get_or_insert((number, columns));
                if columns != expected {
                    return Err(lines.wrong(format_args!("{columns} columns, but line {first} has {expected}")));
                }
                memory::push(&mut sites.positions, [row[0], row[1], row[2]], "sites")?;
                if columns == 4 {
                    memory::push(&mut sites.weights, row[3], "weights")?;
                }
            }
            Row::Count(_) | Row::Numbers(_, 1) => {
                return Err(lines.wrong("1 column; x y z, or x y z weight, are needed"));
            }
            Row::Numbers(_, columns) => {
                return Err(lines.wrong(format_args!(
                    "{columns} columns; x y z, or x y z weight, are needed, or a first line of their names, as 'id x y z r'"
                )));
            }
            Row::Wrong(what) => return Err(lines.wrong(what)),
        }
    }
    match count {
        Some((number, n)) if n != sites.positions.len() as u64 => {
            Err(Error::input(format!("says {n} sites, but {} follow", sites.positions.len())).on_line(number))
        }
        _ => Ok(sites),
    }
}

/// One line of the text format.
enum Row {
    /// The first so many of `0` are set; of a fifth column and more only the number is kept.
    Numbers([f64; 4], usize),
    /// A whole number alone.
    Count(u64),
    /// The names of the columns: what they are where these say it, or what is wrong with them.
    Names(std::result::Result<Option<Columns>, String>),
    Wrong(String),
}

fn parse_row(line: &str, columns: Option<&Columns>) -> Row {
    // With semicolons or commas, an empty field is a missing number, not a wider gap.
    match [';', ','].into_iter().find(|&between| line.contains(between)) {
        Some(between) => parse_words(line, columns, || line.split(between).map(str::trim)),
        None => parse_words(line, columns, || line.split_ascii_whitespace()),
    }
}

fn parse_words<'a, I: Iterator<Item = &'a str>>(line: &str, columns: Option<&Columns>, words: impl Fn() -> I) -> Row {
    if let Some(columns) = columns {
        // Only what the caller names comes before names and a count.
        return match columns.read(words()) {
            Ok(row) => Row::Numbers(row, columns.numbers()),
            Err(_) if columns.count() == words().count() && words().all(|word| word.is_empty() || is_name(word)) => {
                Row::Names(Ok(None))
            }
            Err(what) => line.parse().map_or(Row::Wrong(what), Row::Count),
        };
    }
    let mut row = [0.0; 4];
    let mut found = 0;
    for word in words() {
        let x = match finite(word) {
            Ok(x) => x,
            Err(_) if words().all(|word| word.is_empty() || is_name(word)) && words().any(is_name) => {
                let names: Vec<&str> = words().collect();
                match (Columns::of_first_line(&names), names.len()) {
                    (Ok(None), 0..=2 | 5..) => return Row::Wrong(format!("'{}' is not a number", shown(names[0]))),
                    (found, _) => return Row::Names(found),
                }
            }
            Err(_) if word.is_empty() => {
                return Row::Wrong(format!(
                    "a number is missing between {}",
                    if line.contains(';') { "semicolons" } else { "commas" }
                ));
            }
            Err(what) => return Row::Wrong(what),
        };
        if let Some(place) = row.get_mut(found) {
            *place = x;
        }
        found += 1;
    }
    match line.parse::<u64>() {
        Ok(n) if found == 1 => Row::Count(n),
        Err(_) if found == 1 => Row::Wrong(format!("only '{}'; x y z, or x y z weight, are needed", shown(line))),
        _ => Row::Numbers(row, found),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{known, scratch};
    use super::*;
    use crate::ErrorKind;

    fn wrong(text: &str) -> String {
        parse_text(text.as_bytes(), None).unwrap_err().to_string()
    }

    #[test]
    fn blanks_commas_comments_and_count_are_read() {
        let three = SitesFile { positions: vec![[1.0, -2.0, 3e-5], [4.0, 5.0, 6.0]], weights: vec![] };
        for text in [
            "1 -2 3e-5\n4 5 6\n",
            "1,-2,3e-5\n4, 5 ,6",
            "1;-2;3e-5\n4; 5 ;6",
            "2\n1\t-2  3e-5\r\n\r\n4 5 6\r\n",
            "# sites\n\n  2  # of them\n1 -2 3e-5 # first\n4 5 6",
            "x,y,z\n1,-2,3e-5\n4,5,6\n",
            "\u{feff}\"X\", \"Y\", \"Z\"\r\n1,-2,3e-5\r\n4,5,6\r\n",
            "a b c\n1 -2 3e-5\n4 5 6\n",
        ] {
            assert_eq!(parse_text(text.as_bytes(), None).unwrap(), three, "{text:?}");
        }
        let four = parse_text(&b"1 2 3 0.5\n4 5 6 -0.25\n"[..], None).unwrap();
        assert_eq!(four.weights, [0.5, -0.25]);
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        assert_eq!(wrong("1 2 3\n1 x 3\n"), "line 2: 'x' is not a number");
        assert_eq!(wrong("# c\n1 2 3\n\n1 2 nan\n"), "line 4: 'nan' is not finite");
        assert_eq!(wrong("1 2 inf"), "line 1: 'inf' is not finite");
        assert_eq!(wrong("1 2 1e999"), "line 1: '1e999' is not finite");
        assert_eq!(wrong("1 2 3\n1 2 3 4\n"), "line 2: 4 columns, but line 1 has 3");
        assert_eq!(
            wrong("1 2\n"),
            "line 1: 2 columns; x y z, or x y z weight, are needed, or a first line of their names, as 'id x y z r'"
        );
        assert_eq!(
            wrong("1 2 3 4 5\n"),
            "line 1: 5 columns; x y z, or x y z weight, are needed, or a first line of their names, as 'id x y z r'"
        );
        assert_eq!(wrong("1,,3\n"), "line 1: a number is missing between commas");
        assert_eq!(wrong("0.5\n1 2 3"), "line 1: only '0.5'; x y z, or x y z weight, are needed");
        assert_eq!(wrong("x y z\nx y z\n"), "line 2: names where numbers are needed");
        assert_eq!(wrong("1 2 3\nx y z\n"), "line 2: names where numbers are needed");
        assert_eq!(wrong("nan inf nan\n1 2 3\n"), "line 1: 'nan' is not finite");
        assert_eq!(wrong("All work and no play\n"), "line 1: 'All' is not a number");
        assert_eq!(wrong("1 2 3\n7\n"), "line 2: 1 column; x y z, or x y z weight, are needed");
        assert_eq!(wrong("3\n1 2 3\n4 5 6\n"), "line 1: says 3 sites, but 2 follow");
        // A count is believed only after counting.
        assert_eq!(wrong("18446744073709551615\n1 2 3\n"), "line 1: says 18446744073709551615 sites, but 1 follow");
    }

    #[test]
    fn files_are_named_and_empty_ones_refused() {
        let folder = scratch("sites");
        let path = folder.join("none.xyz");
        assert_eq!(read_sites(&path).unwrap_err().kind(), ErrorKind::Io);
        std::fs::write(&path, "# nothing\n0\n").unwrap();
        assert!(read_sites(&path).unwrap_err().to_string().starts_with(&format!("{}: no sites in it", path.display())));
        std::fs::write(&path, "1 2 3\n4 5\n").unwrap();
        let expected = format!(
            "{}: line 2: 2 columns; x y z, or x y z weight, are needed, or a first line of their names, as 'id x y z r'",
            path.display()
        );
        assert_eq!(read_sites(&path).unwrap_err().to_string(), expected);
        assert!(read_sites(&folder).unwrap_err().to_string().contains("no ending"));
    }

    #[test]
    fn every_number_comes_back() {
        let folder = scratch("sites-round");
        let positions =
            [[0.1, 1.0 / 3.0, -1e-300], [f64::MAX, f64::MIN_POSITIVE, 5e-324], [-0.0, 123_456_789.123_456_79, 2.5e17]];
        for name in known(&["s.xyz", "s.txt", "s.csv", "s.npy", "s.ply"]) {
            for weights in [&[][..], &[0.7, -1e-9, 1e22][..]] {
                let path = folder.join(name);
                write_sites(&path, &positions, weights).unwrap();
                let back = read_sites(&path).unwrap();
                let bits = |p: &[[f64; 3]]| p.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&back.positions), bits(&positions), "{name}");
                assert_eq!(back.weights, weights, "{name}");
            }
        }
        assert!(write_sites(folder.join("s.obj"), &positions, &[]).is_err());
        assert!(write_sites(folder.join("s.xyz"), &positions, &[1.0]).is_err());
    }
}
