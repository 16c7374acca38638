//! What precedes the symbols of a base mesh in tables: weights, and the models of symbols.

use super::symbols::{GROUPS, RESIDUALS, ResidualContext};
use super::weights::Weights;
use crate::entropy::ans::models::Models;
use crate::entropy::ans::reader::PausedReader;
use crate::entropy::range_coder::{BitCoder, RangeDecoder};
use crate::util::bytes::Reader;

/// The head of a payload, and what reads the rest.
pub(super) struct Head {
    pub(super) weights: Weights,
    /// Whether contexts look for coordinates that repeat.
    pub(super) looks_for_repeated: bool,
    pub(super) reader: PausedReader,
}

impl Head {
    /// `None` if a payload has none.
    pub(super) fn read(payload: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(payload);
        let size = reader.varint()? as usize;
        let mut coder = RangeDecoder::new(reader.take(size)?);
        let weights = Weights::code(&mut coder, None)?;
        let models = Models::read(&mut coder, GROUPS)?;
        if coder.is_exhausted() {
            return None;
        }
        let looks_for_repeated =
            ResidualContext::OF_REPEATED.iter().any(|&attribute| models.looks_at(RESIDUALS, attribute));
        Some(Self { weights, looks_for_repeated, reader: PausedReader::new(payload, reader, models)? })
    }
}
