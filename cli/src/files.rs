//! Which files may be written: none that is read, and none twice.

use std::path::{Path, PathBuf};

use laguerre::{Error, Result};

/// Refuses an output that is also read.
pub(crate) fn refuse_inputs(output: &Path, inputs: &[Option<&PathBuf>]) -> Result<()> {
    if inputs.iter().flatten().any(|input| same_file(output, input)) {
        let name = output.display();
        return Err(Error::input(format!("{name}: would be written over, but is read; name another file")));
    }
    Ok(())
}

/// Whether two paths name one file, be it there or not.
pub(crate) fn names_same_file(one: &Path, other: &Path) -> bool {
    let folder = |path: &Path| Path::new(".").join(path).parent().and_then(|folder| folder.canonicalize().ok());
    same_file(one, other) || (one.file_name() == other.file_name() && folder(one) == folder(other))
}

/// Whether two paths name one file that is there.
fn same_file(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}
