//! Files that appear whole or not at all.

use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{folder_of, io_error, is_standard};
use crate::{Error, ErrorKind, Observer, Result};

/// Writes `path` through `body`: into a temporary file of the same folder, which is on the disk before it takes its name at the end, and
/// removed on failure, so that also where the power fails there is the old file or the new one, whole. A file that is there keeps its mode
/// (on Unix). A link is followed, also where what it names is still to be made; what exists and is no regular file (a pipe, `/dev/stdout`) is
/// written to as it is. `-` is standard output; where its reader has gone, nobody wants the rest, and that is no error.
///
/// # Errors
/// `Io`, where `body` or the operating system failed.
pub fn write_whole(path: &Path, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    write_whole_watched(path, &(), body)
}

/// The same, watched: the observer is asked at every quarter of a megabyte and before the file takes its name, and where it ends the writing, there
/// is the old file or none.
///
/// # Errors
/// As [`write_whole`]; `Interrupted` where the observer ends it.
pub fn write_whole_watched(
    path: &Path,
    observer: &dyn Observer,
    body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    let (name, written) = match is_standard(path) {
        true => (Path::new("standard output"), write_standard(observer, body)),
        false => (path, try_write_whole(path, observer, body)),
    };
    written.map_err(|e| {
        let was_ended = |error: &Error| error.kind() == ErrorKind::Interrupted;
        let inner = e.get_ref().and_then(|inner| inner.downcast_ref::<Error>());
        if inner.is_some_and(was_ended) { Error::interrupted() } else { io_error(name, "write", e) }
    })
}

/// Asks an observer before everything that is written.
struct Watched<'a, W> {
    to: W,
    observer: &'a dyn Observer,
}

impl<W: Write> Write for Watched<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Not of the kind `Interrupted`, after which writers try again.
        self.observer.tell(0).map_err(io::Error::other)?;
        self.to.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// Checks that a file could be written to `path`, by making the temporary file of [`write_whole`] and removing it again.
///
/// # Errors
/// `Io`, with what the operating system said.
pub(super) fn check_writable(path: &Path) -> Result<()> {
    let check = || match Place::of(path)? {
        // Opening a pipe would wait for its reader.
        Place::AsItIs => Ok(()),
        Place::File(target, old) => Temporary::beside(&target, old.as_ref()).map(drop),
    };
    check().map_err(|e| io_error(path, "write", e))
}

/// The file that writing to `path` makes or replaces: `path` itself, or what it leads to where it is a link, be that there or not.
///
/// # Errors
/// Where links lead in a circle, or cannot be read.
pub fn destination(path: &Path) -> io::Result<PathBuf> {
    if let Ok(target) = fs::canonicalize(path) {
        return Ok(target);
    }
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        if !fs::symlink_metadata(&target).is_ok_and(|found| found.is_symlink()) {
            return Ok(target);
        }
        // What a link says is relative to where it stands.
        target = folder_of(&target).join(fs::read_link(&target)?);
    }
    Err(io::Error::other("its links lead in a circle"))
}

/// Links that lead from one to the next, at most: as many as Linux follows.
const MOST_LINKS: usize = 40;

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

fn try_write_whole(
    path: &Path,
    observer: &dyn Observer,
    body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let (target, old) = match Place::of(path)? {
        Place::AsItIs => {
            let to = File::options().write(true).open(path)?;
            let mut writer = BufWriter::new(Watched { to, observer });
            body(&mut writer)?;
            return writer.flush();
        }
        Place::File(target, old) => (target, old),
    };
    let (temporary, to) = Temporary::beside(&target, old.as_ref())?;
    let mut writer = BufWriter::with_capacity(BUFFER, Watched { to, observer });
    body(&mut writer)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?.to;
    where_known(file.sync_all())?;
    drop(file);
    temporary.rename(&target)?;
    sync_folder(&folder_of(&target))
}

/// Bytes that are written at once.
const BUFFER: usize = 1 << 18;

fn write_standard(observer: &dyn Observer, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::with_capacity(BUFFER, Watched { to: io::stdout().lock(), observer });
    let written = body(&mut writer).and_then(|()| writer.flush());
    // What is left would be written when this is dropped.
    drop(writer.into_parts());
    match written {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// Where a path leads.
enum Place {
    /// To what is there and is no regular file.
    AsItIs,
    /// To a file, and what is known of it if it is there.
    File(PathBuf, Option<Metadata>),
}

impl Place {
    fn of(path: &Path) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => Err(io::Error::other("it is a folder; name a file")),
            Ok(found) if !found.is_file() => Ok(Self::AsItIs),
            // A rename would put the file in place of a link; what the link names is meant.
            found => Ok(Self::File(destination(path)?, found.ok())),
        }
    }
}

/// Sees to it that the names in a folder are on the disk. A folder that may not be read cannot be asked.
fn sync_folder(folder: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        // The names are those of a journal there.
        return Ok(());
    }
    File::open(folder).map_or(Ok(()), |folder| where_known(folder.sync_all()))
}

/// Some file systems do not know how to put on a disk what is in memory alone.
fn where_known(synced: io::Result<()>) -> io::Result<()> {
    match synced {
        Err(e) if matches!(e.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        synced => synced,
    }
}

/// Makes a file that nobody may open for more than `old` allows.
fn create_like(path: &Path, old: Option<&Metadata>) -> io::Result<File> {
    let mut options = File::options();
    options.write(true).create_new(true);
    #[cfg(unix)]
    if let Some(old) = old {
        use std::os::unix::fs::{OpenOptionsExt, PermissionsExt};
        let mode = old.permissions().mode() & 0o777;
        let file = options.mode(mode).open(path)?;
        // What the mask of the process took away is given back.
        return file.set_permissions(fs::Permissions::from_mode(mode)).map(|()| file);
    }
    let _ = old;
    options.open(path)
}

/// A file that is removed when this is dropped, unless it was renamed by then.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// A new file in the folder of `target`: only within one file system is renaming one step.
    /// Its mode is that of `old`.
    fn beside(target: &Path, old: Option<&Metadata>) -> io::Result<(Self, File)> {
        static SERIAL: AtomicU32 = AtomicU32::new(0);
        let name = target.file_name().ok_or_else(|| io::Error::other("it names no file"))?.to_string_lossy();
        let mut unfinished = unfinished();
        loop {
            let serial = SERIAL.fetch_add(1, Ordering::Relaxed);
            let path = folder_of(target).join(format!(".{name}.{}-{serial}.part", std::process::id()));
            match create_like(&path, old) {
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
    use std::ops::ControlFlow;

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

    /// Ends the writing when it is asked for the last of so many times.
    struct Patient(AtomicU32);

    impl Observer for Patient {
        fn advance(&self, cells: usize) -> ControlFlow<()> {
            assert_eq!(cells, 0);
            let left = self.0.load(Ordering::Relaxed);
            if left == 0 {
                return ControlFlow::Break(());
            }
            self.0.store(left - 1, Ordering::Relaxed);
            ControlFlow::Continue(())
        }
    }

    #[test]
    fn who_watches_may_end_it_and_nothing_is_left() {
        let folder = scratch("atomic-watched");
        let path = folder.join("cells.csv");
        let body = |w: &mut dyn Write| (0..40).try_for_each(|_| w.write_all(&[b'x'; BUFFER / 4]));
        let write = |times: u32| write_whole_watched(&path, &Patient(times.into()), body);
        for times in [0, 1, 5, 9] {
            assert_eq!(write(times).unwrap_err().kind(), ErrorKind::Interrupted, "{times}");
            assert!(names(&folder).is_empty(), "{times}");
        }
        write(1000).unwrap();
        assert_eq!(fs::read(&path).unwrap().len(), 10 * BUFFER);
        // What is written at once at the end, too, and over a file that stays.
        let small = write_whole_watched(&path, &Patient(0.into()), |w| w.write_all(b"new"));
        assert_eq!(small.unwrap_err().kind(), ErrorKind::Interrupted);
        assert_eq!(fs::read(&path).unwrap().len(), 10 * BUFFER);
        assert_eq!(names(&folder), ["cells.csv"]);
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

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_makes_what_it_names() {
        use std::os::unix::fs::symlink;
        let folder = scratch("atomic-dangling");
        fs::create_dir(folder.join("deep")).unwrap();
        // Relative to the link, by way of a second one.
        symlink("deep/second", folder.join("first")).unwrap();
        symlink("file", folder.join("deep/second")).unwrap();
        assert_eq!(destination(&folder.join("first")).unwrap(), folder.join("deep/file"));
        check_writable(&folder.join("first")).unwrap();
        assert_eq!(names(&folder.join("deep")), ["second"], "looking makes nothing");
        write_whole(&folder.join("first"), |w| w.write_all(b"new")).unwrap();
        assert_eq!(fs::read(folder.join("deep/file")).unwrap(), b"new");
        assert!(fs::symlink_metadata(folder.join("first")).unwrap().is_symlink());
        symlink("round", folder.join("round")).unwrap();
        let error = write_whole(&folder.join("round"), |_| Ok(())).unwrap_err().to_string();
        assert!(error.ends_with("round: cannot write: its links lead in a circle"), "{error}");
        symlink("nowhere/file", folder.join("lost")).unwrap();
        assert!(write_whole(&folder.join("lost"), |_| Ok(())).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_mode() {
        use std::os::unix::fs::PermissionsExt;
        let folder = scratch("atomic-mode");
        let path = folder.join("file");
        for mode in [0o600, 0o640, 0o666, 0o755] {
            fs::write(&path, b"old").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            write_whole(&path, |w| w.write_all(b"new")).unwrap();
            assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o7777, mode);
        }
        assert_eq!(names(&folder), ["file"]);
    }
}
