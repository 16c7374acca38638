//! What all payloads have in common.

use crate::passes::Malformed;

/// Pads a payload with zeros until it is long enough for a decoder to accept `count` elements.
pub(super) fn padded(mut payload: Vec<u8>, count: u64, most_per_byte: u64) -> Vec<u8> {
    let least = count.div_ceil(most_per_byte).saturating_sub(1);
    payload.resize(payload.len().max(least as usize), 0);
    payload
}

/// The codes fail on malformed payloads only, and an encoder reads none.
pub(super) fn expect_sound<T>(result: Result<T, Malformed>) -> T {
    result.unwrap_or_else(|e| unreachable!("the encoder made a stream it refuses: {}", e.0))
}
