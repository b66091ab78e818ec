//! Sites and weights: text (`.xyz`, `.txt`) and NumPy's `.npy`.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use super::lines::{Lines, finite, shown};
use super::{SAMPLE_ENDINGS, SITES_ENDINGS, atomic, ending, io_error, npy};
use crate::{Error, Result};

/// What a file of sites holds. Every number is finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SitesFile {
    /// Positions of the sites.
    pub positions: Vec<[f64; 3]>,
    /// Weights (length²), one for each site; empty where the file has none.
    pub weights: Vec<f64>,
}

/// Reads sites by the file's ending.
///
/// * `.xyz`, `.txt`: a site a line, 3 or 4 numbers parted by blanks or by commas, the fourth the weight (length²). The first line
///   may be the number of sites. Blank lines and `#` comments are skipped.
/// * `.npy`: shape (N, 3) or (N, 4), 32- or 64-bit floats, C or Fortran order.
///
/// # Errors
/// `Io` where the file cannot be read; `Input`, with file and line (or row), where a number is missing, is none, or is
/// not finite, where rows differ in length, where the count is wrong, and where there is no site.
pub fn read_sites(path: impl AsRef<Path>) -> Result<SitesFile> {
    let path = path.as_ref();
    let format = ending(path, SITES_ENDINGS)?;
    let file = File::open(path).map_err(|e| io_error(path, "open", &e))?;
    let sites = match format {
        ".npy" => npy::read_sites(&file),
        _ => parse_text(BufReader::with_capacity(1 << 18, &file)),
    };
    let sites = sites.map_err(|e| e.at(path.display()))?;
    if sites.positions.is_empty() {
        return Err(Error::input(format!("{}: no sites in it", path.display())));
    }
    Ok(sites)
}

/// Writes sites by the file's ending, as [`read_sites`] reads them back, to the last bit; without weights where `weights`
/// is empty.
///
/// # Errors
/// `Input` for an unknown ending, or where weights are given but not one for each site; `Io` where writing failed
/// (nothing is left then).
pub fn write_sites(path: impl AsRef<Path>, positions: &[[f64; 3]], weights: &[f64]) -> Result<()> {
    let path = path.as_ref();
    if !weights.is_empty() && weights.len() != positions.len() {
        return Err(Error::input(format!("{} weights for {} sites", weights.len(), positions.len())));
    }
    match ending(path, SAMPLE_ENDINGS)? {
        ".npy" => {
            let columns = if weights.is_empty() { 3 } else { 4 };
            let numbers =
                positions.iter().enumerate().flat_map(|(i, p)| p.iter().copied().chain(weights.get(i).copied()));
            atomic::write_whole(path, |w| npy::write_rows(w, positions.len(), columns, numbers))
        }
        _ => atomic::write_whole(path, |w| {
            for (i, [x, y, z]) in positions.iter().enumerate() {
                // `{:?}` is the shortest text that reads back to the same number.
                match weights.get(i) {
                    Some(weight) => writeln!(w, "{x:?} {y:?} {z:?} {weight:?}")?,
                    None => writeln!(w, "{x:?} {y:?} {z:?}")?,
                }
            }
            Ok(())
        }),
    }
}

/// Reads the text format; errors name the line.
fn parse_text(reader: impl BufRead) -> Result<SitesFile> {
    let mut lines = Lines::new(reader);
    let mut sites = SitesFile::default();
    // (number of its line, what it says); never used to allocate.
    let mut count: Option<(usize, u64)> = None;
    // (number of the first site's line, its columns).
    let mut shape: Option<(usize, usize)> = None;
    while let Some(row) = lines.next_line()?.map(parse_row) {
        let number = lines.number();
        match row {
            Row::Count(n) if shape.is_none() && count.is_none() => count = Some((number, n)),
            Row::Numbers(row, columns @ (3 | 4)) => {
                let (first, expected) = *shape.get_or_insert((number, columns));
                if columns != expected {
                    return Err(lines.wrong(format_args!("{columns} columns, but line {first} has {expected}")));
                }
                sites.positions.push([row[0], row[1], row[2]]);
                if columns == 4 {
                    sites.weights.push(row[3]);
                }
            }
            Row::Count(_) | Row::Numbers(_, 1) => {
                return Err(lines.wrong("1 column; x y z, or x y z weight, are needed"));
            }
            Row::Numbers(_, columns) => {
                return Err(lines.wrong(format_args!("{columns} columns; x y z, or x y z weight, are needed")));
            }
            Row::Wrong(what) => return Err(lines.wrong(what)),
        }
    }
    match count {
        Some((number, n)) if n != sites.positions.len() as u64 => {
            Err(Error::input(format!("line {number}: says {n} sites, but {} follow", sites.positions.len())))
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
    Wrong(String),
}

fn parse_row(line: &str) -> Row {
    let mut row = [0.0; 4];
    let mut columns = 0;
    let mut push = |word: &str| {
        let x = finite(word)?;
        if let Some(place) = row.get_mut(columns) {
            *place = x;
        }
        columns += 1;
        Ok(())
    };
    // With commas, an empty field is a missing number, not a wider gap.
    let done: std::result::Result<(), String> = if line.contains(',') {
        line.split(',').map(str::trim).try_for_each(|word| {
            if word.is_empty() { Err("a number is missing between commas".into()) } else { push(word) }
        })
    } else {
        line.split_ascii_whitespace().try_for_each(&mut push)
    };
    match done {
        Err(what) => Row::Wrong(what),
        Ok(()) if columns == 1 => match line.parse::<u64>() {
            Ok(n) => Row::Count(n),
            Err(_) => Row::Wrong(format!("only '{}'; x y z, or x y z weight, are needed", shown(line))),
        },
        Ok(()) => Row::Numbers(row, columns),
    }
}

#[cfg(test)]
mod tests {
    use super::super::scratch;
    use super::*;
    use crate::ErrorKind;

    fn wrong(text: &str) -> String {
        parse_text(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn blanks_commas_comments_and_count_are_read() {
        let three = SitesFile { positions: vec![[1.0, -2.0, 3e-5], [4.0, 5.0, 6.0]], weights: vec![] };
        for text in [
            "1 -2 3e-5\n4 5 6\n",
            "1,-2,3e-5\n4, 5 ,6",
            "2\n1\t-2  3e-5\r\n\r\n4 5 6\r\n",
            "# sites\n\n  2  # of them\n1 -2 3e-5 # first\n4 5 6",
        ] {
            assert_eq!(parse_text(text.as_bytes()).unwrap(), three, "{text:?}");
        }
        let four = parse_text(&b"1 2 3 0.5\n4 5 6 -0.25\n"[..]).unwrap();
        assert_eq!(four.weights, [0.5, -0.25]);
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        assert_eq!(wrong("1 2 3\n1 x 3\n"), "line 2: 'x' is not a number");
        assert_eq!(wrong("# c\n1 2 3\n\n1 2 nan\n"), "line 4: 'nan' is not finite");
        assert_eq!(wrong("1 2 inf"), "line 1: 'inf' is not finite");
        assert_eq!(wrong("1 2 1e999"), "line 1: '1e999' is not finite");
        assert_eq!(wrong("1 2 3\n1 2 3 4\n"), "line 2: 4 columns, but line 1 has 3");
        assert_eq!(wrong("1 2\n"), "line 1: 2 columns; x y z, or x y z weight, are needed");
        assert_eq!(wrong("1 2 3 4 5\n"), "line 1: 5 columns; x y z, or x y z weight, are needed");
        assert_eq!(wrong("1,,3\n"), "line 1: a number is missing between commas");
        assert_eq!(wrong("0.5\n1 2 3"), "line 1: only '0.5'; x y z, or x y z weight, are needed");
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
        assert_eq!(read_sites(&path).unwrap_err().to_string(), format!("{}: no sites in it", path.display()));
        std::fs::write(&path, "1 2 3\n4 5\n").unwrap();
        let expected = format!("{}: line 2: 2 columns; x y z, or x y z weight, are needed", path.display());
        assert_eq!(read_sites(&path).unwrap_err().to_string(), expected);
        assert!(read_sites(&folder).unwrap_err().to_string().contains("no ending"));
    }

    #[test]
    fn every_number_comes_back() {
        let folder = scratch("sites-round");
        let positions =
            [[0.1, 1.0 / 3.0, -1e-300], [f64::MAX, f64::MIN_POSITIVE, 5e-324], [-0.0, 123_456_789.123_456_79, 2.5e17]];
        for name in ["s.xyz", "s.txt", "s.npy"] {
            for weights in [&[][..], &[0.7, -1e-9, 1e22][..]] {
                let path = folder.join(name);
                write_sites(&path, &positions, weights).unwrap();
                let back = read_sites(&path).unwrap();
                let bits = |p: &[[f64; 3]]| p.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&back.positions), bits(&positions), "{name}");
                assert_eq!(back.weights, weights, "{name}");
            }
        }
        assert!(write_sites(folder.join("s.ply"), &positions, &[]).is_err());
        assert!(write_sites(folder.join("s.xyz"), &positions, &[1.0]).is_err());
    }
}
