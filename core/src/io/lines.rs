//! Text read line by line, each with its number, so that errors can name it.

use std::collections::VecDeque;
use std::io::{BufRead, Read};

use super::cannot_read;
use crate::{Error, Result};

/// Longest line that is read: a file of another kind, given by mistake, must not be drawn into memory in search of
/// its first line end.
const LONGEST_LINE: u64 = 1 << 16;

/// The lines of a text that say something: comments (`#` to the line's end) and surrounding blanks cut off.
pub(super) struct Lines<R> {
    reader: R,
    number: usize,
    buffer: Vec<u8>,
    /// Lines that were read, and are to be read again.
    again: VecDeque<Vec<u8>>,
    at_end: bool,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, number: 0, buffer: Vec::new(), again: VecDeque::new(), at_end: false }
    }

    /// Number of the line that was read last, from 1.
    pub(super) fn number(&self) -> usize {
        self.number
    }

    /// Whether there was no further line when one was wanted last.
    pub(super) fn is_at_end(&self) -> bool {
        self.at_end
    }

    /// The same lines once more, after line `number`, which they follow.
    pub(super) fn read_again(&mut self, number: usize, lines: impl IntoIterator<Item = Vec<u8>>) {
        self.number = number;
        self.again.extend(lines);
    }

    /// An `Input` error about the line that was read last.
    pub(super) fn wrong(&self, what: impl std::fmt::Display) -> Error {
        Error::input(what.to_string()).on_line(self.number)
    }

    /// The next line that is not blank, or `None` at the end.
    pub(super) fn next_line(&mut self) -> Result<Option<&str>> {
        loop {
            if !self.read_raw()? {
                return Ok(None);
            }
            let content = self.buffer.iter().position(|&b| b == b'#').unwrap_or(self.buffer.len());
            // Comments may be in any encoding; only what is read must be text.
            if self.buffer[..content].iter().any(|b| !b.is_ascii_whitespace()) {
                return match std::str::from_utf8(&self.buffer[..content]) {
                    Ok(text) => Ok(Some(text.trim())),
                    Err(_) => Err(self.wrong("not text in UTF-8")),
                };
            }
        }
    }

    /// Fills the buffer with the next line as it stands, its end and a byte order mark cut off; false at the end.
    pub(super) fn read_raw(&mut self) -> Result<bool> {
        self.number += 1;
        if let Some(line) = self.again.pop_front() {
            self.buffer = line;
            return Ok(true);
        }
        self.buffer.clear();
        let read = Read::take(&mut self.reader, LONGEST_LINE).read_until(b'\n', &mut self.buffer);
        let read = read.map_err(|e| cannot_read(e).on_line(self.number))?;
        if read as u64 == LONGEST_LINE && self.buffer.last() != Some(&b'\n') {
            return Err(self.wrong(format_args!("longer than {LONGEST_LINE} bytes; is this a text file?")));
        }
        if self.number == 1 && self.buffer.starts_with(b"\xef\xbb\xbf") {
            self.buffer.drain(..3);
        }
        while matches!(self.buffer.last(), Some(b'\n' | b'\r')) {
            self.buffer.pop();
        }
        self.at_end = read == 0;
        Ok(read > 0)
    }

    /// What follows the lines read so far.
    pub(super) fn rest(&mut self) -> &mut R {
        &mut self.reader
    }

    /// The line as [`Lines::read_raw`] left it.
    pub(super) fn raw(&self) -> &[u8] {
        &self.buffer
    }
}

/// A finite number, also with the exponent of Fortran's doubles, as in `1.5D-03`.
///
/// # Errors
/// The reason alone, for the caller to add the place.
pub(super) fn finite(word: &str) -> std::result::Result<f64, String> {
    let fortran = |error| match word.split_once(['d', 'D']) {
        Some((mantissa, exponent)) => format!("{mantissa}e{exponent}").parse(),
        None => Err(error),
    };
    match word.parse::<f64>().or_else(fortran) {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(format!("'{}' is not finite", shown(word))),
        Err(_) => Err(format!("'{}' is not a number", shown(word))),
    }
}

/// Whether `word` can be the name of a column: `x`, `"x"`, `weight`, but not `nan`, which is a wrong number.
pub(super) fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '"' || c == '_') && word.parse::<f64>().is_err()
}

/// The beginning of `word`, without control characters: what goes into a one-line message.
pub(super) fn shown(word: &str) -> String {
    let mut text: String = word.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect();
    if word.chars().count() > 40 {
        text.push('…');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_fortran_too() {
        assert_eq!(finite("1.5D-03"), Ok(1.5e-3));
        assert_eq!(finite("-2d+02"), Ok(-2e2));
        for wrong in ["d5", "1d", "1dd2", "1d2e3", "D", "1.0D+999"] {
            assert!(finite(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn comments_blanks_and_line_ends_are_no_matter() {
        let text = b"\xef\xbb\xbf# caf\xe9\r\n\n  1 2 3 # three\r\n\t\n4".as_slice();
        let mut lines = Lines::new(text);
        assert_eq!(lines.next_line().unwrap(), Some("1 2 3"));
        assert_eq!(lines.number(), 3);
        assert_eq!(lines.next_line().unwrap(), Some("4"));
        assert_eq!(lines.number(), 5);
        assert_eq!(lines.next_line().unwrap(), None);
    }

    #[test]
    fn what_is_no_text_is_refused_by_line() {
        let wrong = |text: &[u8]| Lines::new(text).next_line().unwrap_err().to_string();
        assert_eq!(wrong(b"\n\xff\xfe\n"), "line 2: not text in UTF-8");
        assert!(wrong(&vec![b'7'; 1 << 20]).starts_with("line 1: longer than 65536 bytes"));
    }
}
