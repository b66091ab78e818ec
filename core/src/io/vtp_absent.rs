//! What stands in for `vtp` where the feature `packed` is off: [`Form::of`](super::form::Form::of) refuses such a file before it is opened.

use std::io::BufRead;

use super::Mesh;
use crate::{Error, Result};

pub(super) fn parse(_: impl BufRead) -> Result<Mesh> {
    Err(Error::input(".vtp is not part of this build: build with the feature `packed`"))
}
