//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{folder_of, io_error};
use crate::{Error, Result};

/// Writes `path` through `body`: into a temporary file of the same folder, renamed at the end and removed on failure.
/// A link is followed; what exists and is no regular file (a pipe, `/dev/stdout`) is written to as it is.
///
/// # Errors
/// `Io`, where `body` or the operating system failed.
pub fn write_whole(path: &Path, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    try_write_whole(path, body).map_err(|e| io_error(path, "write", &e))
}

/// Checks that a file could be written to `path`, by making the temporary file of [`write_whole`] and removing it again.
///
/// # Errors
/// `Io`, with what the operating system said.
pub(super) fn check_writable(path: &Path) -> Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    match fs::metadata(&target) {
        Ok(found) if found.is_dir() => Err(io::Error::other("it is a folder; name a file")),
        // Opening a pipe would wait for its reader.
        Ok(found) if !found.is_file() => Ok(()),
        _ => Temporary::beside(&target).map(drop),
    }
    .map_err(|e| io_error(path, "write", &e))
}

/// Removes every file that is half-written and stops all writing: for a program that a signal is about to end. Whoever writes
/// a file from now on waits forever.
pub fn abandon_writing() {
    let mut unfinished = unfinished();
    for path in unfinished.drain(..) {
        // There is nobody left to tell.
        let _ = fs::remove_file(path);
    }
    std::mem::forget(unfinished);
}

/// The temporary files that are there now. Held while one is made, removed or renamed, so that none is missed.
fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

fn try_write_whole(path: &Path, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    // A rename would put the file in place of a link; what the link names is meant.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    match fs::metadata(&target) {
        Ok(found) if found.is_dir() => return Err(io::Error::other("it is a folder; name a file")),
        Ok(found) if !found.is_file() => {
            let mut writer = BufWriter::new(File::options().write(true).open(&target)?);
            body(&mut writer)?;
            return writer.flush();
        }
        _ => {}
    }
    let (temporary, file) = Temporary::beside(&target)?;
    let mut writer = BufWriter::with_capacity(1 << 18, file);
    body(&mut writer)?;
    writer.flush()?;
    drop(writer);
    temporary.rename(&target)
}

/// A file that is removed when this is dropped, unless it was renamed by then.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// A new file in the folder of `target`: only within one file system is renaming one step.
    fn beside(target: &Path) -> io::Result<(Self, File)> {
        static SERIAL: AtomicU32 = AtomicU32::new(0);
        let name = target.file_name().ok_or_else(|| io::Error::other("it names no file"))?.to_string_lossy();
        let mut unfinished = unfinished();
        loop {
            let serial = SERIAL.fetch_add(1, Ordering::Relaxed);
            let path = folder_of(target).join(format!(".{name}.{}-{serial}.part", std::process::id()));
            match File::create_new(&path) {
                Ok(file) => {
                    unfinished.push(path.clone());
                    return Ok((Self { path }, file));
                }
                // Left by a process of the same number that was killed: take the next.
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
    }

    /// Makes it the file `target`.
    fn rename(&self, target: &Path) -> io::Result<()> {
        let _unfinished = unfinished();
        fs::rename(&self.path, target)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let mut unfinished = unfinished();
        // After the rename there is nothing to remove, and after a failure nothing more to say.
        let _ = fs::remove_file(&self.path);
        unfinished.retain(|path| *path != self.path);
    }
}

/// An [`Error`] on its way through a writer's `io::Result`.
pub(super) fn as_io(error: &Error) -> io::Error {
    io::Error::other(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::scratch;
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = scratch("atomic");
        let path = folder.join("cells.csv");
        write_whole(&path, |w| w.write_all(b"old")).unwrap();
        let failed = write_whole(&path, |w| {
            w.write_all(&[b'x'; 1 << 20])?;
            Err(io::Error::other("no space"))
        });
        assert_eq!(failed.unwrap_err().to_string(), format!("{}: cannot write: no space", path.display()));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(&folder), ["cells.csv"]);
        write_whole(&path, |w| w.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(&folder), ["cells.csv"]);
        assert!(write_whole(&folder, |_| Ok(())).is_err(), "a folder cannot be written over");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_a_device_stays_a_device() {
        let folder = scratch("atomic-link");
        let (file, link) = (folder.join("file"), folder.join("link"));
        fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, |w| w.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        write_whole(Path::new("/dev/null"), |w| w.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
