//! The one error type: what is wrong, where, and what to do, in one line.

use std::error::Error as StdError;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What kind of thing went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The input is wrong: a file, a site, a face, an option.
    Input,
    /// The backend or device asked for is not there.
    Unavailable,
    /// Device, driver or memory failed while running.
    Device,
    /// Reading or writing failed in the operating system.
    Io,
    /// An [`Observer`](crate::Observer) ended the work. A solver ends with what it has then.
    Interrupted,
}

/// Where an error is, as far as that is known; the message says it, too.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Place {
    /// The file.
    pub file: Option<PathBuf>,
    /// Its line, the first is 1.
    pub line: Option<usize>,
    /// The site, by the caller's index.
    pub site: Option<usize>,
    /// The triangle of the mesh, from 0.
    pub triangle: Option<usize>,
}

/// An error in one line: what, where ([`Place`]) and what to do. The error of another library or the operating system that led to it is its
/// [`source`](StdError::source).
#[derive(Clone, Debug)]
pub struct Error(Box<Inner>);

#[derive(Clone, Debug)]
struct Inner {
    kind: ErrorKind,
    message: String,
    place: Place,
    source: Option<Arc<dyn StdError + Send + Sync>>,
}

/// `Result` with [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error of the given kind; `message` is one line without a final period.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self(Box::new(Inner { kind, message: message.into(), place: Place::default(), source: None }))
    }

    /// Wrong input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Input, message)
    }

    /// The end that an observer wanted.
    pub fn interrupted() -> Self {
        Self::new(ErrorKind::Interrupted, "interrupted before there was a result")
    }

    /// What cannot happen while the signs are exact, said instead of a panic: the cell of a site, or its geometry, has no answer.
    #[doc(hidden)]
    pub fn undecided(what: &str, site: u32) -> Self {
        let message = format!("the {what} of site {site} could not be decided; please report its input");
        Self::new(ErrorKind::Device, message).of_site(site as usize)
    }

    /// What kind of thing went wrong.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// Where it is, as far as that is known.
    pub fn place(&self) -> &Place {
        &self.0.place
    }

    /// The same error with "`place`: " before its message, for callers that know more of where it is.
    #[must_use]
    pub fn at(mut self, place: impl fmt::Display) -> Self {
        self.0.message = format!("{place}: {}", self.0.message);
        self
    }

    /// The same error with the file before its message and as its place.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
        let mut error = self.at(path.display());
        error.0.place.file = Some(path.to_path_buf());
        error
    }

    /// The same error with the line (the first is 1) before its message and as its place.
    #[must_use]
    pub fn on_line(self, line: usize) -> Self {
        let mut error = self.at(format_args!("line {line}"));
        error.0.place.line = Some(line);
        error
    }

    /// The same error with a site as its place, which the message names.
    #[must_use]
    pub fn of_site(mut self, site: usize) -> Self {
        self.0.place.site = Some(site);
        self
    }

    /// The same error with a triangle as its place, which the message names.
    #[must_use]
    pub fn of_triangle(mut self, triangle: usize) -> Self {
        self.0.place.triangle = Some(triangle);
        self
    }

    /// The same error with what led to it, which the message tells.
    #[must_use]
    pub fn because(mut self, source: impl StdError + Send + Sync + 'static) -> Self {
        self.0.source = Some(Arc::new(source));
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.message)
    }
}

impl StdError for Error {
    fn source(&self) -> Option<&(dyn StdError + 'static)> {
        self.0.source.as_deref().map(|source| source as &(dyn StdError + 'static))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_words_and_values() {
        let system = std::io::Error::other("the disk is full");
        let error = Error::input("no number").of_site(4).because(system).on_line(3).in_file(Path::new("a.csv"));
        assert_eq!(error.to_string(), "a.csv: line 3: no number");
        let place = Place { file: Some("a.csv".into()), line: Some(3), site: Some(4), triangle: None };
        assert_eq!(*error.place(), place);
        assert_eq!(error.source().unwrap().to_string(), "the disk is full");
    }
}
