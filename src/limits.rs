//! What an untrusted stream may make a decoder do.

use crate::error::DecodeError;

/// Bounds on one decode, checked before memory or time is taken.
///
/// A stream beyond a limit ends in [`DecodeError::Limit`], which names the limit, what the stream asks for and what
/// is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most bytes of memory the decoder may hold, its buffer included. Default 4 GiB, 1 GiB where pointers
    /// have 32 bits. What callers take out of the
    /// decoder as a copy, such as [`Decoder::preview`](crate::Decoder::preview), is not counted.
    pub max_memory: u64,
    /// Most vertices of the finest mesh decoded. Default 2²⁵, about 33 million.
    pub max_vertices: u32,
    /// Most levels. Default 128.
    pub max_levels: u32,
    /// Most units of work, as [`Decoder::work_done`](crate::Decoder::work_done) counts them. Default `None`: in
    /// proportion to the bytes of the stream, 2¹⁸ units and 128 for each byte. Encoders keep to that.
    ///
    /// A unit is the work of one edge or triangle, about a tenth of a microsecond. What a stream may take is known
    /// from its table of passes (`format/SPEC.md`, section 10): one that asks for too much is refused before it begins.
    pub max_work: Option<u64>,
}

/// A process of 32 bits cannot hold 4 GiB: it would fail before the limit does.
const DEFAULT_MEMORY: u64 = if cfg!(target_pointer_width = "32") { 1 << 30 } else { 4 << 30 };

impl Default for Limits {
    fn default() -> Self {
        Self { max_memory: DEFAULT_MEMORY, max_vertices: 1 << 25, max_levels: 128, max_work: None }
    }
}

impl Limits {
    /// Limits for streams from strangers on small machines: 256 MiB, a million vertices.
    pub fn small() -> Self {
        Self { max_memory: 256 << 20, max_vertices: 1 << 20, max_levels: 64, max_work: None }
    }

    pub(crate) fn check(what: &'static str, needed: u64, allowed: u64) -> Result<(), DecodeError> {
        if needed > allowed { Err(DecodeError::Limit { what, needed, allowed }) } else { Ok(()) }
    }
}
