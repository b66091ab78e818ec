//! Rows of numbers whose columns have names: text, or NumPy's `.npy`.

use std::io::BufRead;
use std::path::Path;

use super::columns::plain;
use super::lines::{Lines, finite, is_name, shown};
use super::npy::Array;
use super::{Form, WEIGHTS_ENDINGS, open};
use crate::{Error, Result, memory};

/// Reads rows of numbers by the file's ending, the columns of which are one of `forms`, each of another length: which of them, and the numbers row by row in its order.
///
/// * `.txt`, `.csv`: a row a line, numbers parted by blanks, commas or semicolons. The first line may name the columns, in any order. Blank lines and `#`
///   comments are skipped.
/// * `.npy`: shape (N, length of a form), 32- or 64-bit floats.
///
/// Text also with `.gz` after the ending (feature `packed`).
///
/// # Errors
/// `Io` where the file cannot be read; `Input`, with file and line (or row), where something is no finite number, or the columns are those of no form or not of
/// the same one, and where there is no row.
pub fn read_table(path: impl AsRef<Path>, forms: &[&[&str]]) -> Result<(usize, Vec<f64>)> {
    let path = path.as_ref();
    let form = Form::of(path, WEIGHTS_ENDINGS)?;
    let (reader, length) = open(path)?;
    parse(form.unpacked(reader), length, form.ending, forms).map_err(|e| e.in_file(path))
}

fn parse(reader: impl BufRead, length: u64, format: &str, forms: &[&[&str]]) -> Result<(usize, Vec<f64>)> {
    let found = match format {
        ".npy" => parse_npy(reader, length, forms),
        _ => parse_text(reader, forms),
    }?;
    if found.1.is_empty() {
        return Err(Error::input(format!("no rows in it; one at least of {} is needed", listed(forms))));
    }
    Ok(found)
}

fn listed(forms: &[&[&str]]) -> String {
    forms.iter().map(|form| form.join(",")).collect::<Vec<_>>().join(", or ")
}

fn parse_npy(reader: impl BufRead, length: u64, forms: &[&[&str]]) -> Result<(usize, Vec<f64>)> {
    let shapes: Vec<String> = forms.iter().map(|form| format!("(N, {})", form.len())).collect();
    let of = |columns: u64| forms.iter().position(|form| form.len() as u64 == columns);
    let needed = format!("{}, columns {},", shapes.join(" or "), listed(forms));
    let array = Array::open(reader, length, &needed, |shape| match *shape {
        [rows, columns] => of(columns).map(|_| (rows, columns)),
        _ => None,
    })?;
    let (form, columns) = (of(array.columns as u64).unwrap_or(0), array.columns);
    let mut numbers = memory::filled(0.0, array.rows * columns, "rows")?;
    array.for_each(|row, column, x| numbers[row * columns + column] = x)?;
    Ok((form, numbers))
}

fn parse_text(reader: impl BufRead, forms: &[&[&str]]) -> Result<(usize, Vec<f64>)> {
    let mut lines = Lines::new(reader);
    let mut numbers = Vec::new();
    // The form, and the place in it of each column.
    let mut columns: Option<(usize, Vec<usize>)> = None;
    while let Some(line) = lines.next_line()? {
        let between = [';', ','].into_iter().find(|&between| line.contains(between));
        let words: Vec<&str> = match between {
            Some(between) => line.split(between).map(str::trim).collect(),
            None => line.split_ascii_whitespace().collect(),
        };
        let row = match &columns {
            None if words.iter().all(|word| is_name(word)) => {
                match named(&words, forms) {
                    Some(found) => columns = Some(found),
                    None => {
                        let what = format!("columns '{}'; {} are needed", shown(&words.join(",")), listed(forms));
                        return Err(lines.wrong(what));
                    }
                }
                continue;
            }
            None => match forms.iter().position(|form| form.len() == words.len()) {
                Some(form) => {
                    let (_, places) = columns.insert((form, (0..words.len()).collect()));
                    read(&words, places)
                }
                None => Err(format!("{} columns; {} are needed", words.len(), listed(forms))),
            },
            Some((_, places)) => read(&words, places),
        };
        match row {
            Ok(row) => row.into_iter().try_for_each(|x| memory::push(&mut numbers, x, "rows"))?,
            Err(what) => return Err(lines.wrong(what)),
        }
    }
    Ok((columns.map_or(0, |(form, _)| form), numbers))
}

/// The form that has these names, and their places in it.
fn named(words: &[&str], forms: &[&[&str]]) -> Option<(usize, Vec<usize>)> {
    forms.iter().enumerate().find_map(|(number, form)| {
        let place = |word: &&str| form.iter().position(|name| *name == plain(word));
        let places: Vec<usize> = words.iter().map(place).collect::<Option<_>>()?;
        let is_whole = words.len() == form.len() && (0..form.len()).all(|k| places.contains(&k));
        is_whole.then_some((number, places))
    })
}

/// A row in the order of its form.
fn read(words: &[&str], places: &[usize]) -> std::result::Result<Vec<f64>, String> {
    if words.len() != places.len() {
        return Err(format!("{} columns, but the first row has {}", words.len(), places.len()));
    }
    let mut row = vec![0.0; words.len()];
    for (word, &place) in words.iter().zip(places) {
        row[place] = finite(word)?;
    }
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMS: &[&[&str]] = &[&["x", "y", "mass"], &["x", "y", "xx", "mass"]];

    fn text(text: &str) -> std::result::Result<(usize, Vec<f64>), String> {
        parse(text.as_bytes(), text.len() as u64, ".csv", FORMS).map_err(|e| e.to_string())
    }

    #[test]
    fn columns_are_told_by_their_number_or_their_names() {
        let three = (0, vec![1.0, 2.0, 3.0, -4.0, 5e-3, 6.0]);
        for said in ["1,2,3\n-4,5e-3,6\n", "# a\n 1 2 3 # b\n\n-4 5e-3 6", "X;\"mass\";y\n1;3;2\n-4;6;5e-3\n"] {
            assert_eq!(text(said).unwrap(), three, "{said}");
        }
        assert_eq!(text("mass xx y x\n4 3 2 1\n").unwrap(), (1, vec![1.0, 2.0, 3.0, 4.0]));
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        let needed = "x,y,mass, or x,y,xx,mass";
        assert_eq!(text("1,2\n").unwrap_err(), format!("line 1: 2 columns; {needed} are needed"));
        assert_eq!(text("x,y,m\n").unwrap_err(), format!("line 1: columns 'x,y,m'; {needed} are needed"));
        assert_eq!(text("x,x,mass\n").unwrap_err(), format!("line 1: columns 'x,x,mass'; {needed} are needed"));
        assert_eq!(text("1,2,3\n1,2,3,4\n").unwrap_err(), "line 2: 4 columns, but the first row has 3");
        assert_eq!(text("1,2,3\nx,y,mass\n").unwrap_err(), "line 2: 'x' is not a number");
        assert_eq!(text("1,2,nan\n").unwrap_err(), "line 1: 'nan' is not finite");
        assert_eq!(text("1,,3\n").unwrap_err(), "line 1: '' is not a number");
        assert_eq!(text("x,y,mass\n").unwrap_err(), format!("no rows in it; one at least of {needed} is needed"));
    }

    #[cfg(feature = "npy")]
    #[test]
    fn arrays_are_rows() {
        let read = |shape: &[u64]| {
            let mut bytes = Vec::new();
            let count = shape.iter().product::<u64>();
            super::super::npy::write(&mut bytes, shape, (0..count).map(|x| x as f64)).unwrap();
            parse(bytes.as_slice(), bytes.len() as u64, ".npy", FORMS).map_err(|e| e.to_string())
        };
        assert_eq!(read(&[2, 4]).unwrap(), (1, (0..8).map(f64::from).collect()));
        let needed = "(N, 3) or (N, 4), columns x,y,mass, or x,y,xx,mass, is needed";
        assert_eq!(read(&[2, 5]).unwrap_err(), format!("shape [2, 5]; {needed}"));
        assert_eq!(read(&[3]).unwrap_err(), format!("shape [3]; {needed}"));
    }
}
