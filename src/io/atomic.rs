//! Files that appear complete or not at all.

use std::{
    fs::{self, File, Permissions},
    io::{self, BufWriter, Write},
    path::Path,
};

/// Bytes gathered before a write reaches the system.
const BUFFER_BYTES: usize = 1 << 18;

/// Writes the file `path` with `write`: into a temporary file beside it, renamed to `path` at the end.
///
/// If anything fails, the temporary file is removed and what was at `path` before is still there. A replaced
/// file keeps its permissions, a symbolic link keeps pointing to the file that is replaced. What is there
/// and is not a regular file, such as `/dev/stdout` or a pipe, is written to directly.
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
        Ok(metadata) => Some((fs::canonicalize(path)?, metadata.permissions())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error.into()),
    };
    let target = existing.as_ref().map_or(path, |(real_path, _)| real_path);
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };

    let mut builder = tempfile::Builder::new();
    builder.prefix(".lwc-");
    if let Some(permissions) = new_file_permissions() {
        builder.permissions(permissions);
    }
    let mut out = BufWriter::with_capacity(BUFFER_BYTES, builder.tempfile_in(directory)?);
    write(&mut out)?;
    let temporary = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Some((_, permissions)) = &existing {
        temporary.as_file().set_permissions(permissions.clone())?;
    }
    temporary.persist(target).map_err(|failed| failed.error)?;
    Ok(())
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
