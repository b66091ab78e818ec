//! Atoms as sites: the chemists' `.xyz` (a count, a comment, then rows `Fe x y z`) and LAMMPS's dumps as text.
//!
//! Both may hold a film; one frame is read, and a second one is an error, for none is the one that is meant.

use std::io::BufRead;

use super::SitesFile;
use super::lines::{Lines, finite, is_name, shown};
use crate::{Error, Result, memory};

/// What names the columns in the comment of an extended `.xyz`.
const PROPERTIES: &str = "Properties=";

/// Where in a row of an `.xyz` the position begins, and whether its comment says so, when there may be more columns: if the line after the count
/// is such a comment, or the first row is a name and three numbers.
///
/// # Errors
/// What is wrong with the comment.
pub(super) fn xyz_column(comment: &[u8], first: &[u8]) -> std::result::Result<Option<(usize, bool)>, String> {
    let comment = String::from_utf8_lossy(comment);
    if let Some((_, says)) = comment.split_once(PROPERTIES) {
        let says = says.trim_start_matches('"').split(['"', ' ', '\t']).next().unwrap_or_default();
        let fields: Vec<&str> = says.split(':').collect();
        let mut column = 0_usize;
        for field in fields.chunks(3) {
            match *field {
                ["pos", "R", "3"] => return Ok(Some((column, true))),
                [_, _, count] => column = column.saturating_add(count.parse().unwrap_or(usize::MAX)),
                _ => break,
            }
        }
        return Err(format!("no pos:R:3 in '{PROPERTIES}{}'; where are the positions?", shown(says)));
    }
    let first = String::from_utf8_lossy(first);
    let mut words = first.split_ascii_whitespace();
    let is_atom =
        words.next().is_some_and(is_name) && words.by_ref().take(3).filter(|word| finite(word).is_ok()).count() == 3;
    Ok(is_atom.then_some((1, false)))
}

/// Reads the rows of an `.xyz` whose line `counted` says that they are `count`, with positions as [`xyz_column`] found them.
///
/// # Errors
/// `Input`, by line, where there are fewer rows, or more, and where a position is none.
pub(super) fn parse_xyz(
    lines: &mut Lines<impl BufRead>,
    (counted, count): (usize, u64),
    (column, named): (usize, bool),
) -> Result<SitesFile> {
    let mut sites = SitesFile::default();
    while let Some(line) = lines.next_line()? {
        if sites.positions.len() as u64 == count {
            return Err(
                lines.wrong(format_args!("more rows than the {count} that line {counted} says; give one frame alone"))
            );
        }
        let columns = line.split_ascii_whitespace().count();
        let found = if named || columns == 4 {
            position(line, [0, 1, 2].map(|k| column.saturating_add(k)))
        } else {
            Err(format!(
                "{columns} columns; a name and x y z are needed, or the comment '{PROPERTIES}…' to tell the columns"
            ))
        };
        let found = found.map_err(|what| lines.wrong(what))?;
        memory::push(&mut sites.positions, found, "sites")?;
    }
    if sites.positions.len() as u64 == count {
        return Ok(sites);
    }
    let (line, found) = (counted + 1, sites.positions.len());
    Err(Error::input(format!("says {count} atoms, but {found} follow the comment of line {line}")).on_line(counted))
}

/// Whether a text that begins with this line is a dump of LAMMPS.
pub(super) fn is_dump(line: &str) -> bool {
    line.starts_with(ITEM)
}

const ITEM: &str = "ITEM:";
/// Names of the columns that positions are read from, the first that are there; the last two are shares of the box.
const COLUMNS: [[&str; 3]; 4] = [["x", "y", "z"], ["xu", "yu", "zu"], ["xs", "ys", "zs"], ["xsu", "ysu", "zsu"]];
const FIRST_SCALED: usize = 2;

/// Reads a dump whose first line is `first`, in the order of its rows.
///
/// # Errors
/// `Input`, by line, where it is none, or more than one snapshot.
pub(super) fn parse_dump(lines: &mut Lines<impl BufRead>, first: &str) -> Result<SitesFile> {
    let mut item = first.to_owned();
    let mut count: Option<(usize, u64)> = None;
    let mut bounds: Option<[[f64; 2]; 3]> = None;
    loop {
        let says = item.strip_prefix(ITEM).unwrap_or_default().trim().to_owned();
        if says == "NUMBER OF ATOMS" {
            let line = lines.next_line()?.unwrap_or_default();
            let number = line.parse().map_err(|_| format!("'{}' is no number of atoms", shown(line)));
            count = Some((lines.number(), number.map_err(|what| lines.wrong(what))?));
        } else if let Some(kind) = says.strip_prefix("BOX BOUNDS") {
            bounds = read_bounds(lines, kind)?;
        } else if let Some(names) = says.strip_prefix("ATOMS") {
            let Some(count) = count else {
                return Err(lines.wrong("atoms without 'ITEM: NUMBER OF ATOMS' before them"));
            };
            return read_atoms(lines, names, count, bounds);
        }
        // What else there is, is passed over.
        loop {
            match lines.next_line()? {
                Some(line) if is_dump(line) => break item = line.to_owned(),
                Some(_) => {}
                None => return Err(Error::input("no 'ITEM: ATOMS' in this dump")),
            }
        }
    }
}

/// The box along the axes; `None` where it is tilted.
fn read_bounds(lines: &mut Lines<impl BufRead>, kind: &str) -> Result<Option<[[f64; 2]; 3]>> {
    let is_tilted = kind.contains("xy") || kind.contains("abc");
    let mut bounds = [[0.0; 2]; 3];
    for axis in &mut bounds {
        let line = lines.next_line()?.unwrap_or_default();
        let mut words = line.split_ascii_whitespace();
        let mut next = || words.next().map_or_else(|| Err("the bounds of the box end early".to_owned()), finite);
        let ends = next().and_then(|lo| Ok([lo, next()?]));
        *axis = ends.map_err(|what| lines.wrong(what))?;
    }
    Ok(Some(bounds).filter(|_| !is_tilted))
}

fn read_atoms(
    lines: &mut Lines<impl BufRead>,
    names: &str,
    (counted, count): (usize, u64),
    bounds: Option<[[f64; 2]; 3]>,
) -> Result<SitesFile> {
    let names: Vec<&str> = names.split_ascii_whitespace().collect();
    let place = |wanted: &str| names.iter().position(|name| *name == wanted);
    let places = |wanted: [&str; 3]| Some([place(wanted[0])?, place(wanted[1])?, place(wanted[2])?]);
    let found = COLUMNS.iter().enumerate().find_map(|(form, &wanted)| places(wanted).map(|places| (form, places)));
    let Some((form, places)) = found else {
        let names = shown(&names.join(" "));
        return Err(lines.wrong(format_args!("columns '{names}'; x y z, xu yu zu or xs ys zs are needed")));
    };
    let scaled = form >= FIRST_SCALED;
    if scaled && bounds.is_none() {
        return Err(lines.wrong("shares of a box that is tilted or not there; dump x y z"));
    }
    let bounds = bounds.filter(|_| scaled).unwrap_or([[0.0, 1.0]; 3]);
    let mut sites = SitesFile::default();
    while let Some(line) = lines.next_line()? {
        if is_dump(line) || sites.positions.len() as u64 == count {
            break;
        }
        let found = position(line, places).map_err(|what| lines.wrong(what))?;
        let at = |k: usize| bounds[k][0] + found[k] * (bounds[k][1] - bounds[k][0]);
        let found = if scaled { std::array::from_fn(at) } else { found };
        memory::push(&mut sites.positions, found, "sites")?;
    }
    if sites.positions.len() as u64 != count {
        return Err(Error::input(format!("says {count} atoms, but {} follow", sites.positions.len())).on_line(counted));
    }
    if !lines.is_at_end() {
        return Err(lines.wrong("a second snapshot; give one alone"));
    }
    Ok(sites)
}

/// The numbers at three places of a row.
fn position(line: &str, places: [usize; 3]) -> std::result::Result<[f64; 3], String> {
    let mut position = [None; 3];
    for (k, word) in line.split_ascii_whitespace().enumerate() {
        if let Some(axis) = places.iter().position(|&place| place == k) {
            position[axis] = Some(finite(word)?);
        }
    }
    match position {
        [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
        _ => Err(format!("{} columns, which is too few for a position", line.split_ascii_whitespace().count())),
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse_sites;

    fn read(text: &str) -> std::result::Result<Vec<[f64; 3]>, String> {
        let sites = parse_sites(text.as_bytes(), "a.xyz").map_err(|e| e.to_string().replace("a.xyz: ", ""))?;
        assert!(sites.weights.is_empty());
        Ok(sites.positions)
    }

    const TWO: [[f64; 3]; 2] = [[0.5, -1.0, 2e-3], [1.0, 2.0, 3.0]];

    #[test]
    fn names_stand_before_positions_or_a_comment_tells() {
        for text in [
            "2\nwater, frame 1\nFe 0.5 -1 2e-3\nO 1 2 3\n",
            "2\n\nFe 0.5 -1 2e-3\r\nO2 1 2 3\n",
            "  2\n# 7 8 9\nFe\t0.5 -1 2e-3\nH 1 2 3\n\n",
            "2\n1 2 3\nFe 0.5 -1 2e-3\nH 1 2 3\n",
            "2\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=species:S:1:pos:R:3:forces:R:3 energy=1\nFe 0.5 -1 2e-3 9 9 9\nO 1 2 3 9 9 9\n",
            "2\nProperties=\"id:I:1:species:S:1:pos:R:3\"\n1 Fe 0.5 -1 2e-3\n2 O 1 2 3\n",
            "2\nProperties=pos:R:3:mass:R:1\n0.5 -1 2e-3 9\n1 2 3 9\n",
        ] {
            assert_eq!(read(text), Ok(TWO.to_vec()), "{text}");
        }
        // Without names these are sites, as ever: the second line is one of them, or the columns' names.
        assert_eq!(read("2\n0.5 -1 2e-3\n1 2 3\n"), Ok(TWO.to_vec()));
        assert_eq!(read("2\nx y z\n0.5 -1 2e-3\n1 2 3\n"), Ok(TWO.to_vec()));
        assert_eq!(read("2\n\n# c\n0.5 -1 2e-3\n1 2 3\n"), Ok(TWO.to_vec()));
    }

    #[test]
    fn what_is_wrong_with_an_xyz_is_named_by_line() {
        let wrong = |text: &str| read(text).unwrap_err();
        assert_eq!(wrong("3\nc\nFe 1 2 3\nO 1 2 3\n"), "line 1: says 3 atoms, but 2 follow the comment of line 2");
        assert_eq!(
            wrong("1\nc\nFe 1 2 3\n1\nc\nFe 1 2 3\n"),
            "line 4: more rows than the 1 that line 1 says; give one frame alone"
        );
        assert_eq!(wrong("2\nc\nFe 1 2 3\nO 1 nan 3\n"), "line 4: 'nan' is not finite");
        assert_eq!(
            wrong("2\nc\nFe 1 2 3 4\nO 1 2 3 4\n"),
            "line 3: 5 columns; a name and x y z are needed, or the comment 'Properties=…' to tell the columns"
        );
        assert_eq!(
            wrong("1\nProperties=species:S:1:force:R:3\nFe 1 2 3\n"),
            "line 2: no pos:R:3 in 'Properties=species:S:1:force:R:3'; where are the positions?"
        );
        assert_eq!(wrong("1\nProperties=pos:R:3\n1 2\n"), "line 3: 2 columns, which is too few for a position");
        assert!(wrong("1\nProperties=a:R:99999999999999999999:pos:R:3\n1 2\n").starts_with("line 3: 2 columns"));
    }

    fn dump(columns: &str, rows: &str) -> String {
        format!(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n-1 1\n0 4e0\n2 3\nITEM: ATOMS {columns}\n{rows}"
        )
    }

    #[test]
    fn a_dump_names_its_columns() {
        for (columns, rows) in [
            ("id type x y z", "2 1 0.5 -1 2e-3\n1 1 1 2 3\n"),
            ("element xu yu zu vx", "Fe 0.5 -1 2e-3 7\nO 1 2 3 7\n"),
            ("z id x xs ys zs y", "2e-3 2 0.5 7 7 7 -1\n3 1 1 7 7 7 2\n"),
        ] {
            assert_eq!(read(&dump(columns, rows)), Ok(TWO.to_vec()), "{columns}");
        }
        let scaled = read(&dump("id xs ys zs", "1 0 0.5 1\n2 0.75 0.25 0.5\n"));
        assert_eq!(scaled, Ok(vec![[-1.0, 2.0, 3.0], [0.5, 1.0, 2.5]]));
        for name in ["a.dump", "a.lammpstrj", "a.txt"] {
            assert!(parse_sites(dump("x y z", "1 2 3\n4 5 6\n").as_bytes(), name).is_ok());
        }
    }

    #[test]
    fn what_is_wrong_with_a_dump_is_named_by_line() {
        let wrong = |columns: &str, rows: &str| read(&dump(columns, rows)).unwrap_err();
        let two = "1 2 3\n4 5 6\n";
        assert_eq!(wrong("x y", two), "line 9: columns 'x y'; x y z, xu yu zu or xs ys zs are needed");
        assert_eq!(wrong("x y z", "1 2 3\n"), "line 4: says 2 atoms, but 1 follow");
        assert_eq!(wrong("x y z", "1 2 3\n4 5\n"), "line 11: 2 columns, which is too few for a position");
        assert_eq!(wrong("x y z", "1 2 3\n4 5 x\n"), "line 11: 'x' is not a number");
        let film = format!("{two}ITEM: TIMESTEP\n1\n");
        assert_eq!(wrong("x y z", &film), "line 12: a second snapshot; give one alone");
        let tilted = dump("xs ys zs", two).replace("pp pp ff", "xy xz yz pp pp pp");
        assert_eq!(read(&tilted).unwrap_err(), "line 9: shares of a box that is tilted or not there; dump x y z");
        assert_eq!(read("ITEM: TIMESTEP\n0\n").unwrap_err(), "no 'ITEM: ATOMS' in this dump");
        assert!(read("ITEM: ATOMS x y z\n1 2 3\n").unwrap_err().starts_with("line 1: atoms without"));
        assert_eq!(read("ITEM: NUMBER OF ATOMS\n-2\n").unwrap_err(), "line 2: '-2' is no number of atoms");
        assert!(read("ITEM: BOX BOUNDS pp pp pp\n1\n").unwrap_err().starts_with("line 2: the bounds of the box end"));
    }
}
