//! Which files may be written: none that is read, and none twice.

use std::path::{Path, PathBuf};

use laguerre::{Error, Result, io};

use crate::outcome::print_beside_results;
use crate::page;

/// Lets standard output have the results where an output is `-`: what is printed goes to standard error then.
///
/// # Errors
/// `Input` where more than one thing would be written there.
pub(crate) fn share_standard_output<'a>(outputs: impl IntoIterator<Item = &'a PathBuf>, json: bool) -> Result<()> {
    match outputs.into_iter().filter(|path| path.as_os_str() == "-").count() {
        0 => return Ok(()),
        1 if !json => {}
        1 => return Err(Error::input("-: --json prints to standard output, too; name a file for the results")),
        _ => return Err(Error::input("-: named for two outputs, but standard output is one; name a file")),
    }
    print_beside_results();
    Ok(())
}

/// Checks the page's name: a page's ending, and none of the `others`.
///
/// # Errors
/// `Input` for the ending or a name given twice, `Io` where the file could not be made.
pub(crate) fn check_page<'a>(page: Option<&PathBuf>, mut others: impl Iterator<Item = &'a PathBuf>) -> Result<()> {
    let Some(path) = page else { return Ok(()) };
    if path.as_os_str() == "-" {
        // Whether that is free is a matter of all outputs.
        return Ok(());
    }
    io::check_output(path, page::ENDINGS)?;
    if others.any(|other| names_same_file(other, path)) {
        return Err(Error::input(format!("{}: named for two outputs; give two files", path.display())));
    }
    Ok(())
}

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
    // A link is the file that it leads to, also where that is still to be made.
    let [one, other] = [one, other].map(|path| io::destination(path).unwrap_or_else(|_| path.to_path_buf()));
    let folder = |path: &Path| Path::new(".").join(path).parent().and_then(|folder| folder.canonicalize().ok());
    same_file(&one, &other) || (one.file_name() == other.file_name() && folder(&one) == folder(&other))
}

/// Whether two paths name one file that is there.
fn same_file(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}
