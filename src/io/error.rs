//! Why a mesh file was not read or written.

use super::format::{Format, known_endings};
use crate::mesh::MeshError;
use std::{fmt, io};
use thiserror::Error;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, from 1. A statement over several lines counts as its first.
    Line(usize),
    /// A byte of a (decompressed) binary file, from 0.
    Byte(usize),
    /// An object of a structured file, such as `accessor` 3: what it is, and its number from 0.
    Part(&'static str, usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Part(what, index) => write!(f, "{what} {index}"),
        }
    }
}

/// Why a mesh file was not read. The message is one sentence with place and cause, without the file's name.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be read at all.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The zstd stream of a `.zst` file is damaged or cut short.
    #[error("cannot decompress: {0}")]
    Zstd(#[source] io::Error),
    /// The gzip stream of a `.gz` file is damaged or cut short.
    #[error("cannot decompress: {0}")]
    Gzip(#[source] io::Error),
    /// The ending of the file's name is not that of a format we know.
    #[error("unknown file ending; known are {}, each also with .gz or .zst", known_endings(|_| true))]
    UnknownEnding,
    /// The file breaks the rules of its format, ends early, or holds numbers no mesh can have.
    #[error("{place}: {message}")]
    Syntax {
        /// Where.
        place: Place,
        /// What is wrong there.
        message: String,
    },
    /// The file may be fine, but uses something this reader does not know.
    #[error("{place}: {message}")]
    Unsupported {
        /// Where.
        place: Place,
        /// What it uses.
        message: String,
    },
    /// The file, or the mesh in it, exceeds a limit.
    #[error("too large: {message}")]
    TooLarge {
        /// Which limit.
        message: String,
    },
    /// A `.gz` or `.zst` file unpacks to more than a file of its size may (see [`super::ReadOptions`]).
    #[error("too large: {packed} bytes unpack to more than {most}, which no mesh does")]
    Ratio {
        /// Bytes of the file that were read.
        packed: u64,
        /// Bytes that they may unpack to.
        most: u64,
    },
}

impl ReadError {
    pub(super) fn syntax(place: Place, message: impl Into<String>) -> Self {
        Self::Syntax { place, message: message.into() }
    }
}

impl From<MeshError> for ReadError {
    /// Readers check indices and coordinates where they can name the place, so this is about counts.
    fn from(error: MeshError) -> Self {
        Self::TooLarge { message: error.to_string() }
    }
}

/// Why a mesh file was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The file could not be written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The ending of the file's name is not that of a format we know.
    #[error(
        "unknown file ending; known are {}, each also with .gz or .zst",
        known_endings(Format::is_written)
    )]
    UnknownEnding,
    /// The format cannot hold this mesh.
    #[error("{message}")]
    Unrepresentable {
        /// What does not fit.
        message: String,
    },
}
