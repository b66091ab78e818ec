//! What stands in for `npy` where the feature of that name is off: [`ending`](super::ending) refuses such a file before it is opened.

use std::io::{self, BufRead, Write};

use super::NPY_IS_OFF;
use crate::{Error, Result};

/// An array in a file: there is none.
pub(super) struct Array {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) single: bool,
}

impl Array {
    pub(super) fn open(_: impl BufRead, _: u64, _: &str, _: impl Fn(&[u64]) -> Option<(u64, u64)>) -> Result<Self> {
        Err(Error::input(NPY_IS_OFF))
    }

    pub(super) fn for_each(self, _: impl FnMut(usize, usize, f64)) -> Result<()> {
        Err(Error::input(NPY_IS_OFF))
    }

    pub(super) fn for_each_number(self, _: impl FnMut(usize, usize, f64) -> Result<()>) -> Result<()> {
        Err(Error::input(NPY_IS_OFF))
    }
}

pub(super) fn write(_: &mut dyn Write, _: &[u64], _: impl Iterator<Item = f64>) -> io::Result<()> {
    Err(io::Error::other(NPY_IS_OFF))
}
