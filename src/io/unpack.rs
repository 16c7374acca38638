//! Files as they are read: unpacked if they are compressed, and never more than was allowed.

use super::counter::Counter;
use super::error::ReadError;
use super::foreign;
use super::format::{Compression, Format, format_and_compression};
use super::gzip::Members;
use super::source::Source;
use std::{
    fs::File,
    io::{self, BufReader, Read},
    path::Path,
};

/// The largest file that is read, in bytes after decompression: 16 GiB.
///
/// A mesh of a hundred million vertices is smaller in every format but the wordiest OBJ.
pub const MAX_FILE_BYTES: u64 = 16 << 30;

/// How much a file may unpack to; how files are read in [`crate::io`].
///
/// ```no_run
/// let file = lwc::io::ReadOptions::default().any_ratio().read("all-zero.ply.zst")?;
/// # Ok::<(), lwc::io::ReadError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// How many bytes each byte of a `.gz` or `.zst` file may unpack to, beyond [`ReadOptions::free_bytes`].
    /// Default: 1000. Meshes have 2 to 30, gzip goes up to 1,032 and zstd
    /// up to 32,768.
    pub max_ratio: u64,
    /// Bytes that any `.gz` or `.zst` file may unpack to. Default: 256 MiB.
    pub free_bytes: u64,
    /// Whether textures are read, also from files that a model names in its folder or below: `true` by default.
    pub textures: bool,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { max_ratio: 1000, free_bytes: 256 << 20, textures: true }
    }
}

impl ReadOptions {
    /// Lifts the limit on how much a small file may unpack to. [`MAX_FILE_BYTES`] holds.
    #[must_use]
    pub fn any_ratio(mut self) -> Self {
        self.max_ratio = u64::MAX;
        self
    }

    /// Leaves out textures. Colours and names of materials stay.
    #[must_use]
    pub fn without_textures(mut self) -> Self {
        self.textures = false;
        self
    }

    /// The (unpacked) bytes of a file, and what its ending says they are. Tells `progress` which share of them is read.
    ///
    /// # Errors
    /// If it cannot be opened, or is plainly something else.
    pub(super) fn open<'a>(
        &self,
        path: &Path,
        progress: &'a dyn Fn(f64),
    ) -> Result<(Source<'a>, Format), ReadError> {
        let (mut source, format) = self.open_any(path, progress)?;
        foreign::check(source.peek(foreign::HEAD_BYTES))?;
        Ok((source, format))
    }

    fn open_any<'a>(
        &self,
        path: &Path,
        progress: &'a dyn Fn(f64),
    ) -> Result<(Source<'a>, Format), ReadError> {
        let (format, compression) = format_and_compression(path).ok_or(ReadError::UnknownEnding)?;
        let file = File::open(path)?;
        // What is no regular file, such as a pipe, does not know how long it is.
        let metadata = file.metadata()?;
        let num_bytes = metadata.is_file().then_some(metadata.len());
        let share = if format.is_read_as_a_whole() { SHARE_OF_BYTES } else { 1.0 };
        let file = Counter::new(Box::new(file), num_bytes, share, progress);
        Ok((self.unpacked(file, num_bytes, compression)?, format))
    }

    /// As [`ReadOptions::open`], of bytes that come from elsewhere: packed if they look so.
    ///
    /// # Errors
    /// If they are plainly something else than a mesh.
    pub(super) fn open_reader<'a>(
        &self,
        mut reader: impl Read + 'a,
        progress: &'a dyn Fn(f64),
    ) -> Result<Source<'a>, ReadError> {
        let mut head = Vec::new();
        reader.by_ref().take(4).read_to_end(&mut head)?;
        let compression = Compression::from_head(&head);
        let all = Counter::new(Box::new(io::Cursor::new(head).chain(reader)), None, 1.0, progress);
        let mut source = self.unpacked(all, None, compression)?;
        foreign::check(source.peek(foreign::HEAD_BYTES))?;
        Ok(source)
    }

    fn unpacked<'a>(
        &self,
        file: Counter<'a>,
        num_bytes: Option<u64>,
        compression: Option<Compression>,
    ) -> Result<Source<'a>, ReadError> {
        if let Some(compression) = compression {
            return Ok(Source::new(Limited::new(Unpacker::new(file, compression, self)?), None));
        }
        if num_bytes.is_some_and(|num_bytes| num_bytes > MAX_FILE_BYTES) {
            return Err(too_large());
        }
        Ok(Source::new(Limited::new(file), num_bytes))
    }
}

/// What of the time it takes to read a file that comes into memory before it is looked at.
const SHARE_OF_BYTES: f64 = 0.3;

fn too_large() -> ReadError {
    ReadError::TooLarge { message: format!("more than {MAX_FILE_BYTES} bytes") }
}

/// Reads no more than [`MAX_FILE_BYTES`].
struct Limited<R> {
    reader: R,
    num_left: u64,
}

impl<R> Limited<R> {
    fn new(reader: R) -> Self {
        Self { reader, num_left: MAX_FILE_BYTES }
    }
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let num_read = self.reader.read(buffer)?;
        self.num_left =
            self.num_left.checked_sub(num_read as u64).ok_or_else(|| io::Error::other(too_large()))?;
        Ok(num_read)
    }
}

/// Unpacks a file while that is in proportion to its size.
struct Unpacker<'a> {
    decoder: Decoder<'a>,
    num_unpacked: u64,
    options: ReadOptions,
}

enum Decoder<'a> {
    Gzip(Box<Members<Counter<'a>>>),
    Zstd(zstd::Decoder<'static, BufReader<Counter<'a>>>),
}

impl Decoder<'_> {
    /// Bytes of the file that were read.
    fn num_packed(&self) -> u64 {
        match self {
            Self::Gzip(members) => members.get_ref().map_or(0, |file| file.num_bytes),
            Self::Zstd(decoder) => decoder.get_ref().get_ref().num_bytes,
        }
    }

    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let is_interruption = |error: &io::Error| error.kind() == io::ErrorKind::Interrupted;
        let named = |error: io::Error, name: fn(io::Error) -> ReadError| {
            if is_interruption(&error) { error } else { io::Error::other(name(error)) }
        };
        match self {
            Self::Gzip(decoder) => decoder.read(buffer).map_err(|error| named(error, ReadError::Gzip)),
            Self::Zstd(decoder) => decoder.read(buffer).map_err(|error| named(error, ReadError::Zstd)),
        }
    }
}

impl<'a> Unpacker<'a> {
    fn new(file: Counter<'a>, compression: Compression, options: &ReadOptions) -> io::Result<Self> {
        let decoder = match compression {
            Compression::Gzip => Decoder::Gzip(Box::new(Members::new(file))),
            Compression::Zstd => Decoder::Zstd(zstd::Decoder::new(file)?),
        };
        Ok(Self { decoder, num_unpacked: 0, options: options.clone() })
    }

    /// # Errors
    /// If more was unpacked than is allowed.
    fn check(&self) -> Result<(), ReadError> {
        let packed = self.decoder.num_packed();
        let most = packed.saturating_mul(self.options.max_ratio).max(self.options.free_bytes);
        if self.num_unpacked <= most { Ok(()) } else { Err(ReadError::Ratio { packed, most }) }
    }
}

impl Read for Unpacker<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let num_read = self.decoder.read(buffer)?;
        self.num_unpacked += num_read as u64;
        self.check().map_err(io::Error::other)?;
        Ok(num_read)
    }
}
