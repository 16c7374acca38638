//! What a decoder may be made to do by a stream it does not trust.

use crate::error::DecodeError;

/// Bounds on one decode, checked before memory is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most bytes of memory the decoder may hold, its buffer included. Default 4 GiB.
    pub max_memory: u64,
    /// Most vertices of the finest mesh decoded. Default 2²⁵, about 33 million.
    pub max_vertices: u32,
    /// Most levels. Default 128.
    pub max_levels: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self { max_memory: 4 << 30, max_vertices: 1 << 25, max_levels: 128 }
    }
}

impl Limits {
    /// Limits for streams from strangers on small machines: 256 MiB, a million vertices.
    pub fn small() -> Self {
        Self { max_memory: 256 << 20, max_vertices: 1 << 20, max_levels: 64 }
    }

    pub(crate) fn check(what: &'static str, needed: u64, allowed: u64) -> Result<(), DecodeError> {
        if needed > allowed { Err(DecodeError::Limit { what, needed, allowed }) } else { Ok(()) }
    }
}
