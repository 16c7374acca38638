//! The arithmetic of the coder: states of 32 bits that give and take 16 of them (`format/SPEC.md`, section 6.7).

use super::frequencies::{Frequencies, LOG_TOTAL, TOTAL};

/// States that take turns, symbol by symbol.
pub(super) const NUM_STATES: usize = 2;
/// The least state, with which encoders begin and decoders end.
pub(super) const LEAST: u32 = 1 << 16;

/// What a decoder finds below each value of a state's low bits.
#[derive(Clone, Copy)]
pub(super) struct Slot(u32);

impl Slot {
    fn new(symbol: usize, frequency: u32, offset: u32) -> Self {
        Self((symbol as u32) << 24 | frequency << 12 | offset)
    }

    #[inline(always)]
    pub(super) fn symbol(self) -> u8 {
        (self.0 >> 24) as u8
    }

    /// The state after this symbol, before it takes bits.
    #[inline(always)]
    pub(super) fn advance(self, state: u32) -> u32 {
        (self.0 >> 12 & 0xfff) * (state >> LOG_TOTAL) + (self.0 & 0xfff)
    }
}

/// Appends the slots of a table, [`TOTAL`] of them.
pub(super) fn append_slots(slots: &mut Vec<Slot>, table: &Frequencies) {
    for (symbol, &frequency) in table.0.iter().enumerate() {
        let frequency = u32::from(frequency);
        slots.extend((0..frequency).map(|offset| Slot::new(symbol, frequency, offset)));
    }
    debug_assert!(slots.len().is_multiple_of(TOTAL as usize));
}

/// The state before a symbol of this frequency, whose first slot is `start`; `words` gets the bits that it gives away.
#[cfg(any(feature = "encoder", test))]
pub(super) fn retreat(state: u32, start: u32, frequency: u32, words: &mut Vec<u16>) -> u32 {
    let mut state = state;
    if u64::from(state) >= u64::from(frequency) << (32 - LOG_TOTAL) {
        words.push(state as u16);
        state >>= 16;
    }
    ((state / frequency) << LOG_TOTAL) + start + state % frequency
}
