//! From bytes to chunks: what a stream announces, and where its passes begin.

use crate::bitstream::chunk::{self, Frame, NextPass};
use crate::bitstream::header::{Action, Grid, Pass, Provenance};
use crate::bitstream::pass_table::{self, BadTable};
use crate::limits::Limits;
use crate::{DecodeError, Profile};

/// What a stream says of itself before its first pass.
#[derive(Clone, Debug)]
pub struct StreamInfo {
    pub(super) grid: Grid,
    pub(super) provenance: Option<Provenance>,
    pub(super) profile: Profile,
    pub(super) passes: Vec<PassInfo>,
}

/// Kind of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PassKind {
    /// The base mesh, level 0.
    Base,
    /// The odd vertices of one level.
    Split,
    /// One more bit of precision.
    Refine,
}

impl PassKind {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            PassKind::Base => "base",
            PassKind::Split => "split",
            PassKind::Refine => "refine",
        }
    }
}

/// One pass of a stream, and the mesh that stands after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassInfo {
    /// What the pass does.
    pub kind: PassKind,
    /// Level after the pass.
    pub level: u32,
    /// Bits per coordinate after the pass.
    pub precision: u32,
    /// Vertices after the pass.
    pub vertices: u32,
    /// Triangles after the pass.
    pub faces: u32,
    /// Bytes of its chunk: kind, payload and checksum.
    pub bytes: u64,
    /// Bytes of the stream up to the end of the pass.
    pub end: u64,
    pub(super) row: Pass,
}

impl PassInfo {
    /// What its chunk must be.
    pub(super) fn frame(&self) -> (u8, u32) {
        (self.row.action.kind(), self.row.bytes)
    }
}

impl StreamInfo {
    /// Reads what a stream, or its beginning, says of itself; `None` if the table of passes has not
    /// come yet. Nothing is decoded.
    ///
    /// # Errors
    /// If the bytes are no stream, or damaged before the table ends.
    pub fn read(bytes: &[u8]) -> Result<Option<Self>, DecodeError> {
        let mut decoder = super::Decoder::new(Limits::default());
        decoder.feed(bytes)?;
        decoder.read_info()?;
        Ok(decoder.info().cloned())
    }

    /// Bits per coordinate of the finest mesh.
    pub fn precision(&self) -> u32 {
        self.grid.precision
    }

    /// Smallest corner of the grid, model units.
    pub fn origin(&self) -> [f64; 3] {
        self.grid.origin
    }

    /// Side of the grid, model units: 2^precision − 1 steps.
    pub fn side(&self) -> f64 {
        self.grid.side
    }

    /// Finest level.
    pub fn finest_level(&self) -> u32 {
        self.passes.last().map_or(0, |p| p.level)
    }

    /// How it is coded.
    pub fn profile(&self) -> Profile {
        self.profile
    }

    /// All passes in order.
    pub fn passes(&self) -> &[PassInfo] {
        &self.passes
    }

    /// Bytes of the whole stream, skippable chunks between passes not counted.
    pub fn total_bytes(&self) -> u64 {
        self.passes.last().map_or(0, |p| p.end)
    }

    /// Number of the descriptor that chose the odd vertices (`format/SPEC.md`, section 4.2).
    pub fn descriptor_code(&self) -> Option<u8> {
        self.provenance.map(|p| p.descriptor)
    }

    /// Number of the partition.
    pub fn partition_code(&self) -> Option<u8> {
        self.provenance.map(|p| p.partition)
    }

    /// Window of the descriptor: rings, radius in mean edges at the finest level, growth per level.
    pub fn window(&self) -> Option<(u32, f64, f64)> {
        self.provenance.map(|p| (p.rings, p.radius, p.growth))
    }
}

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
    payload: std::ops::Range<usize>,
}

impl FrameReader {
    pub(super) fn new() -> Self {
        Self { buffer: Vec::new(), read: 0, offset: 0, has_signature: false }
    }

    /// Adds bytes behind those that are there, which move if they may.
    pub(super) fn feed(&mut self, bytes: &[u8], may_move: bool) {
        if may_move && self.read > 0 && self.read >= self.buffer.len() / 2 {
            self.buffer.drain(..self.read);
            self.read = 0;
        }
        self.buffer.extend_from_slice(bytes);
    }

    /// Bytes held.
    pub(super) fn buffered(&self) -> usize {
        self.buffer.len()
    }

    /// Place in the stream behind the last chunk.
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

    /// Payload so far of the next pass, if its chunk has begun but is not complete.
    pub(super) fn cut_pass(&self, next_pass: NextPass) -> Option<&[u8]> {
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

/// Turns the table of passes into running totals. `start` is where the first pass begins.
pub(super) fn list_passes(payload: &[u8], grid: &Grid, start: u64) -> Result<Vec<PassInfo>, BadTable> {
    let rows = pass_table::read_passes(payload, grid)?;
    let mut passes: Vec<PassInfo> = Vec::with_capacity(rows.len());
    for row in rows {
        let bytes = chunk::pass_size(row.bytes);
        let next = match (row.action, passes.last()) {
            (Action::Base { precision }, _) => PassInfo {
                kind: PassKind::Base,
                level: 0,
                precision,
                vertices: row.vertices,
                faces: row.faces,
                bytes,
                end: start + bytes,
                row,
            },
            (_, None) => return Err(BadTable("the first pass is no base mesh")),
            (action, Some(before)) => PassInfo {
                kind: if action == Action::Split { PassKind::Split } else { PassKind::Refine },
                level: before.level + u32::from(action == Action::Split),
                precision: before.precision + u32::from(action == Action::Refine),
                vertices: before.vertices + row.vertices,
                faces: before.faces + row.faces,
                bytes,
                end: before.end + bytes,
                row,
            },
        };
        passes.push(next);
    }
    Ok(passes)
}
