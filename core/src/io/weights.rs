//! Weights in a file of their own: text, one a line, or NumPy's `.npy`.

use std::io::BufRead;
use std::path::Path;

use super::lines::{Lines, finite, is_name};
use super::npy::{self, Array};
use super::{Form, WEIGHTS_ENDINGS, atomic, open, output_ending};
use crate::{Error, Result, memory};

/// Reads weights (length²), one for each site and in the order of the sites, by the file's ending.
///
/// * `.txt`, `.csv`: one number a line. Blank lines and `#` comments are skipped, and a name in the first line.
/// * `.npy`: shape (N) or (N, 1), 32- or 64-bit floats.
///
/// Text also with `.gz` after the ending (feature `packed`).
///
/// # Errors
/// `Io` where the file cannot be read; `Input`, with file and line (or row), where something is no finite number, and where
/// there is none.
pub fn read_weights(path: impl AsRef<Path>) -> Result<Vec<f64>> {
    let path = path.as_ref();
    let form = Form::of(path, WEIGHTS_ENDINGS)?;
    let (reader, length) = open(path)?;
    parse(form.unpacked(reader), length, form.ending).map_err(|e| e.in_file(path))
}

/// Reads weights from the bytes of a file called `name`, as [`read_weights`] does.
///
/// # Errors
/// `Input`, as [`read_weights`].
pub fn parse_weights(bytes: &[u8], name: impl AsRef<Path>) -> Result<Vec<f64>> {
    let name = name.as_ref();
    let form = Form::of(name, WEIGHTS_ENDINGS)?;
    parse(form.unpacked(bytes), bytes.len() as u64, form.ending).map_err(|e| e.in_file(name))
}

/// Writes weights (length²), by the file's ending, so that [`read_weights`] reads the same numbers. `-` is standard output, as text.
///
/// # Errors
/// `Input` for an unknown ending; `Io` where writing failed (nothing is left then).
pub fn write_weights(path: impl AsRef<Path>, weights: &[f64]) -> Result<()> {
    let path = path.as_ref();
    let format = output_ending(path, WEIGHTS_ENDINGS)?;
    atomic::write_whole(path, |w| {
        if format == ".npy" {
            return npy::write(w, &[weights.len() as u64], weights.iter().copied());
        }
        // `{:?}` is the shortest text that reads back to the same number.
        weights.iter().try_for_each(|weight| writeln!(w, "{weight:?}"))
    })
}

fn parse(reader: impl BufRead, length: u64, format: &str) -> Result<Vec<f64>> {
    let weights = match format {
        ".npy" => parse_npy(reader, length),
        _ => parse_text(reader),
    }?;
    if weights.is_empty() {
        return Err(Error::input("no weights in it; one for each site is needed"));
    }
    Ok(weights)
}

fn parse_npy(reader: impl BufRead, length: u64) -> Result<Vec<f64>> {
    let array = Array::open(reader, length, "(N,)", |shape| match *shape {
        [rows] | [rows, 1] => Some((rows, 1)),
        _ => None,
    })?;
    let mut weights = memory::filled(0.0, array.rows, "weights")?;
    array.for_each(|row, _, w| weights[row] = w)?;
    Ok(weights)
}

fn parse_text(reader: impl BufRead) -> Result<Vec<f64>> {
    let mut lines = Lines::new(reader);
    let mut weights = Vec::new();
    let mut first = true;
    while let Some(line) = lines.next_line()? {
        let named = std::mem::take(&mut first) && is_name(line);
        let weight = if line.split([',', ' ', '\t']).nth(1).is_some() {
            Err("more than one column; one weight a line is needed".into())
        } else {
            finite(line)
        };
        match weight {
            Ok(weight) => memory::push(&mut weights, weight, "weights")?,
            Err(_) if named => {}
            Err(what) => return Err(lines.wrong(what)),
        }
    }
    Ok(weights)
}

#[cfg(test)]
mod tests {
    use super::super::known;
    use super::*;

    #[test]
    fn one_number_a_line() {
        for text in ["1\n-2.5\n3e-5\n", "# w\r\n 1 # one\r\n\r\n-2.5\r\n3e-5", "\u{feff}weight\n1\n-2.5\n3e-5\n"] {
            assert_eq!(parse_weights(text.as_bytes(), "w.txt").unwrap(), [1.0, -2.5, 3e-5], "{text:?}");
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = super::super::scratch("weights");
        let weights = [0.1 + 0.2, -1e-300, 5e59, 0.0];
        for name in known(&["w.txt", "w.csv", "w.npy"]) {
            write_weights(folder.join(name), &weights).unwrap();
            assert_eq!(read_weights(folder.join(name)).unwrap(), weights, "{name}");
        }
        assert!(
            write_weights(folder.join("w.xyz"), &weights).unwrap_err().to_string().contains("unknown ending '.xyz'")
        );
    }

    #[test]
    fn what_is_wrong_is_named_by_line() {
        let wrong = |text: &str| parse_weights(text.as_bytes(), "w.csv").unwrap_err().to_string();
        assert_eq!(wrong("1\nnan\n"), "w.csv: line 2: 'nan' is not finite");
        assert_eq!(wrong("nan\n1\n"), "w.csv: line 1: 'nan' is not finite");
        assert_eq!(wrong("1\nw\n"), "w.csv: line 2: 'w' is not a number");
        assert_eq!(wrong("1\n2 3\n"), "w.csv: line 2: more than one column; one weight a line is needed");
        assert_eq!(wrong("weight\n"), "w.csv: no weights in it; one for each site is needed");
    }

    #[cfg(feature = "npy")]
    #[test]
    fn arrays_are_vectors_or_columns() {
        for (shape, columns) in [(&[2_u64][..], 1), (&[2, 1][..], 1), (&[1, 2][..], 2)] {
            let mut bytes = Vec::new();
            let mut writer = {
                use npyz::WriterBuilder;
                npyz::WriteOptions::<f64>::new().default_dtype().shape(shape).writer(&mut bytes).begin_nd().unwrap()
            };
            writer.extend([0.5, -0.25]).unwrap();
            writer.finish().unwrap();
            let read = parse_weights(&bytes, "w.npy");
            if columns == 1 {
                assert_eq!(read.unwrap(), [0.5, -0.25]);
            } else {
                assert_eq!(read.unwrap_err().to_string(), "w.npy: shape [1, 2]; (N,) is needed");
            }
        }
    }
}
