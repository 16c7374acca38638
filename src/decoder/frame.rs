//! From bytes to chunks.

use crate::bitstream::chunk::{self, Frame, NextPass};
use crate::error::DecodeError;
use crate::limits::Limits;

/// Reads chunks off the front of a growing buffer.
pub(super) struct FrameReader {
    buffer: Vec<u8>,
    /// Bytes of `buffer` that have been read.
    read: usize,
    /// Place of `buffer[read]` in the stream.
    offset: u64,
    has_signature: bool,
}

/// A chunk that is complete and intact.
pub(super) struct Chunk {
    pub(super) kind: u8,
    pub(super) offset: u64,
    /// Range in the reader's buffer, valid until the next `feed` that may move bytes.
    payload: std::ops::Range<usize>,
}

impl FrameReader {
    pub(super) fn new() -> Self {
        Self { buffer: Vec::new(), read: 0, offset: 0, has_signature: false }
    }

    /// Appends bytes. `may_move` must be false while a [`Chunk`] is kept: its payload is a range of this buffer.
    pub(super) fn feed(&mut self, bytes: &[u8], may_move: bool) {
        if may_move && self.read > 0 && self.read >= self.buffer.len() / 2 {
            self.buffer.drain(..self.read);
            self.read = 0;
        }
        let needed = self.buffer.len() + bytes.len();
        if needed > self.buffer.capacity() {
            self.buffer.reserve_exact(self.grown_for(needed) - self.buffer.len());
        }
        self.buffer.extend_from_slice(bytes);
    }

    /// Bytes of memory held.
    pub(super) fn memory(&self) -> u64 {
        self.buffer.capacity() as u64
    }

    /// The most bytes of memory held while that many more bytes come in: the buffer may move to a larger
    /// place.
    pub(super) fn memory_with(&self, more: usize) -> u64 {
        let needed = self.buffer.len().saturating_add(more);
        let moved = if needed > self.buffer.capacity() { self.grown_for(needed) } else { 0 };
        self.memory() + moved as u64
    }

    /// The place for `needed` bytes, with room for half as many more: few moves, and little that is unused.
    fn grown_for(&self, needed: usize) -> usize {
        if self.buffer.is_empty() { needed } else { needed.saturating_add(needed / 2) }
    }

    /// Position in the stream after the last chunk.
    pub(super) fn position(&self) -> u64 {
        self.offset
    }

    pub(super) fn payload(&self, chunk: &Chunk) -> &[u8] {
        &self.buffer[chunk.payload.clone()]
    }

    /// The next complete chunk, `None` while bytes are missing.
    pub(super) fn next_chunk(
        &mut self,
        limits: &Limits,
        next_pass: NextPass,
    ) -> Result<Option<Chunk>, DecodeError> {
        if !self.has_signature && !self.read_signature()? {
            return Ok(None);
        }
        match chunk::parse(&self.buffer[self.read..], next_pass) {
            Frame::Incomplete { needed } => {
                Limits::check("memory", needed as u64, limits.max_memory)?;
                Ok(None)
            }
            Frame::BadLength => {
                Err(DecodeError::Malformed { what: "the length of a chunk", offset: self.offset })
            }
            Frame::OutOfPlace => {
                Err(DecodeError::Malformed { what: "a pass out of order", offset: self.offset })
            }
            Frame::Chunk { kind, intact: false, .. } => {
                Err(DecodeError::Checksum { kind: printable(kind), offset: self.offset })
            }
            Frame::Chunk { kind, payload, size, .. } => {
                let start = self.read + chunk::payload_start(kind, payload.len());
                let chunk = Chunk { kind, offset: self.offset, payload: start..start + payload.len() };
                self.read += size;
                self.offset += size as u64;
                Ok(Some(chunk))
            }
        }
    }

    /// Kind and payload so far of the chunk that is not complete yet; of passes only of the next one.
    pub(super) fn cut_chunk(&self, next_pass: NextPass) -> Option<(u8, &[u8])> {
        chunk::parse_cut(&self.buffer[self.read..], next_pass)
    }

    fn read_signature(&mut self) -> Result<bool, DecodeError> {
        let there = self.buffer.len().min(chunk::SIGNATURE.len());
        if self.buffer[..there] != chunk::SIGNATURE[..there] {
            return Err(DecodeError::NotAStream);
        }
        let Some(&version) = self.buffer.get(chunk::SIGNATURE.len()) else {
            return Ok(false);
        };
        if version != chunk::VERSION {
            return Err(DecodeError::Unsupported(format!(
                "format version {version}, this decoder knows {}",
                chunk::VERSION
            )));
        }
        self.read = chunk::SIGNATURE.len() + 1;
        self.offset = self.read as u64;
        self.has_signature = true;
        Ok(true)
    }
}

pub(super) fn printable(kind: u8) -> char {
    if kind.is_ascii_graphic() { char::from(kind) } else { '?' }
}
