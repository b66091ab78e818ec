//! The one error type: what is wrong, where, and what to do, in one line.

use std::fmt;

/// What kind of thing went wrong; decides the program's exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The input is wrong: a file, a site, a face, an option. Exit code 2.
    Input,
    /// The backend or device asked for is not there. Exit code 3.
    Unavailable,
    /// Device, driver or memory failed while running.
    Device,
    /// Reading or writing failed in the operating system.
    Io,
    /// Someone wants the work to stop: said by a [`Backend`](crate::Backend) around another one, to a solver that then ends with what it has.
    /// Exit code 130.
    Interrupted,
}

/// An error in one line: what, where (file, line, face, site) and what to do.
#[derive(Clone, Debug)]
pub struct Error {
    kind: ErrorKind,
    message: String,
}

/// `Result` with [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error of the given kind; `message` is one line without a final period.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into() }
    }

    /// Wrong input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Input, message)
    }

    /// What kind of thing went wrong.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// The same error with "`place`: " before its message, for callers that know the file.
    #[must_use]
    pub fn at(self, place: impl fmt::Display) -> Self {
        Self { message: format!("{place}: {}", self.message), ..self }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}
