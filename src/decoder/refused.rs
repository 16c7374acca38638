//! Why a chunk is refused.

use super::frame::{self, Chunk};
use crate::bitstream::chunk::kind;
use crate::error::DecodeError;
use crate::passes::Malformed;

/// What is wrong with a payload, for the first byte of its chunk to be added.
pub(super) enum Refused {
    Malformed(Malformed),
    Limit(DecodeError),
}

impl Refused {
    pub(super) fn at(self, chunk: &Chunk) -> DecodeError {
        match self {
            Self::Malformed(Malformed(what)) => malformed(what, chunk),
            Self::Limit(error) => error,
        }
    }
}

impl From<Malformed> for Refused {
    fn from(malformed: Malformed) -> Self {
        Self::Malformed(malformed)
    }
}

impl From<DecodeError> for Refused {
    fn from(error: DecodeError) -> Self {
        Self::Limit(error)
    }
}

pub(super) fn malformed(what: &'static str, chunk: &Chunk) -> DecodeError {
    DecodeError::Malformed { what, offset: chunk.offset }
}

pub(super) fn out_of_order(chunk: &Chunk) -> DecodeError {
    malformed("a chunk out of order", chunk)
}

/// Passes over a chunk that may be skipped.
pub(super) fn skip(chunk: &Chunk) -> Result<(), DecodeError> {
    if !kind::is_critical(chunk.kind) {
        return Ok(());
    }
    let kind = frame::printable(chunk.kind);
    Err(DecodeError::Unsupported(format!("chunk '{kind}' at byte {}", chunk.offset)))
}
