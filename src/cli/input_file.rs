//! What can be seen of an input before it is read.

use super::exit::Failure;
use super::output::has_ending;
use lwc::io::Format;
use lwc::{DecodeError, StreamInfo};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Whether it is standard input.
pub fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// Looks whether there is a file, without opening it: a pipe can be opened once. Standard input is there.
///
/// # Errors
/// If there is none, or it is a folder.
pub fn check(path: &Path) -> Result<(), Failure> {
    let refuse = |kind, what: &str| Err(Failure::Input(io::Error::new(kind, what)));
    if is_stdin(path) {
        return Ok(());
    }
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => refuse(io::ErrorKind::IsADirectory, "it is a folder"),
        Ok(_) => Ok(()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            refuse(error.kind(), "there is no such file")
        }
        Err(error) => Err(Failure::Input(error)),
    }
}

/// Whether it is to be taken for a stream: by its ending, or by its first bytes.
pub fn is_stream(path: &Path) -> bool {
    has_ending(path, "lwc") || holds_stream(path)
}

/// Whether it begins as a stream, and not by chance: the ending is not that of a mesh.
///
/// Pipes are not looked into: what is taken out of them is gone.
pub fn holds_stream(path: &Path) -> bool {
    let may_be = path.is_file() && Format::from_path(path).is_none();
    let mut head = Vec::new();
    let is_read = may_be && File::open(path).is_ok_and(|file| file.take(16).read_to_end(&mut head).is_ok());
    is_read && !head.is_empty() && !matches!(StreamInfo::read(&head), Err(DecodeError::NotAStream))
}
