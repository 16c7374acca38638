//! Files that appear complete or not at all.

use std::{
    fs::{self, File, Permissions},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};
use tempfile::NamedTempFile;

/// Bytes gathered before a write reaches the system.
const BUFFER_BYTES: usize = 1 << 18;

/// Links to links that are followed before they are taken for a circle; Linux does the same.
const MAX_LINKS: usize = 40;

/// Writes the file `path` with `write`: into a temporary file next to it, renamed to `path` at the end.
///
/// If anything fails, the temporary file is removed and what was at `path` before is still there. The new file is
/// on the disk before it has its name, so that the name never leads to half a file, power cuts included. A
/// replaced file keeps its permissions, a symbolic link keeps pointing to the file that is replaced, or that
/// appears if there was none. What is there and is not a regular file, such as `/dev/stdout` or a pipe, is written
/// to directly.
///
/// # Errors
/// Those of `write`, and of the file system.
pub fn write_atomic<E: From<io::Error>>(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), E> {
    let path = path.as_ref();
    let existing = match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => {
            let mut out = BufWriter::with_capacity(BUFFER_BYTES, File::create(path)?);
            write(&mut out)?;
            return Ok(out.flush()?);
        }
        Ok(metadata) => Some(metadata.permissions()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error.into()),
    };
    let target = followed(path)?;
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut out = BufWriter::with_capacity(BUFFER_BYTES, Unfinished::new(directory)?);
    write(&mut out)?;
    let unfinished = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Some(permissions) = existing {
        unfinished.file.as_file().set_permissions(permissions)?;
    }
    unfinished.file.as_file().sync_all()?;
    unfinished.persist(&target)?;
    sync_directory(directory);
    Ok(())
}

/// Where symbolic links lead, be there a file or not.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        let is_link = fs::symlink_metadata(&path).is_ok_and(|metadata| metadata.is_symlink());
        if !is_link {
            return Ok(path);
        }
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        path = folder.join(fs::read_link(&path)?);
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Makes a new name durable. Not every system can, and the file itself is safe: callers need not know of an
/// error.
fn sync_directory(directory: &Path) {
    if cfg!(unix) {
        let _ = File::open(directory).and_then(|directory| directory.sync_all());
    }
}

/// Temporary files at work, which [`abandon_writes`] takes away.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of all [`write_atomic`] at work, then calls `end`, for programs that end early.
///
/// No file is begun and none gets its name before `end` returns: threads that want to do so wait.
pub fn abandon_writes<T>(end: impl FnOnce() -> T) -> T {
    let paths = unfinished();
    for path in paths.iter() {
        // What cannot be removed remains: there is nobody to tell.
        let _ = fs::remove_file(path);
    }
    end()
}

/// A temporary file that [`abandon_writes`] knows.
struct Unfinished {
    file: NamedTempFile,
    entry: Entry,
}

/// A path in the list, as long as this lives.
struct Entry(PathBuf);

impl Drop for Entry {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

impl Unfinished {
    fn new(directory: &Path) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".lwc-");
        if let Some(permissions) = new_file_permissions() {
            builder.permissions(permissions);
        }
        let mut paths = unfinished();
        let file = builder.tempfile_in(directory)?;
        paths.push(file.path().to_owned());
        let entry = Entry(file.path().to_owned());
        Ok(Self { file, entry })
    }

    /// Gives the file its name.
    fn persist(self, target: &Path) -> io::Result<()> {
        let Self { file, entry } = self;
        let held = unfinished();
        let persisted = file.persist(target);
        // The entry wants the list for itself.
        drop(held);
        drop(entry);
        persisted.map(drop).map_err(|failed| failed.error)
    }
}

impl Write for Unfinished {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.file.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Temporary files are private by default; ours becomes an ordinary file, for which the umask decides.
#[cfg(unix)]
fn new_file_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn new_file_permissions() -> Option<Permissions> {
    None
}
