//! Reads symbols (`format/SPEC.md`, section 6.7).

use super::coder::SymbolCoder;
use super::models::Models;
use super::raw::RawReader;
use super::states::{LEAST, NUM_STATES};
use super::token;
use crate::util::bytes::Reader;
use byteorder::{ByteOrder, LittleEndian};
use std::ops::Range;

/// Bytes that a state takes in at once.
const WORD: usize = 2;

/// Models and the place in a payload: a reader at rest.
pub(crate) struct PausedReader {
    models: Models,
    words: Range<usize>,
    raw_start: usize,
    place: Place,
}

#[derive(Clone, Copy)]
struct Place {
    states: [u32; NUM_STATES],
    /// Which of them has its turn.
    turn: usize,
    next: usize,
    is_exhausted: bool,
    raw: RawReader,
}

impl PausedReader {
    /// Begins behind what `reader`, which reads this payload, has read. `None` if it is too short.
    pub(crate) fn new(payload: &[u8], mut reader: Reader, models: Models) -> Option<Self> {
        let size = (reader.varint()? as usize).checked_mul(WORD)?;
        let mut states = [0; NUM_STATES];
        for state in &mut states {
            *state = reader.take(4).map(LittleEndian::read_u32).filter(|&state| state >= LEAST)?;
        }
        let start = payload.len() - reader.len();
        reader.take(size)?;
        let words = start..start + size;
        let place = Place { states, turn: 0, next: 0, is_exhausted: false, raw: RawReader::default() };
        Some(Self { models, raw_start: words.end, words, place })
    }

    /// The reader of this payload.
    pub(crate) fn resume<'a>(&'a mut self, payload: &'a [u8]) -> SymbolReader<'a> {
        let (words, raw) = (&payload[self.words.clone()], &payload[self.raw_start..]);
        SymbolReader { models: &self.models, words, raw, kept: &mut self.place }
    }
}

/// Reads the symbols of one payload.
pub(crate) struct SymbolReader<'a> {
    models: &'a Models,
    words: &'a [u8],
    raw: &'a [u8],
    kept: &'a mut Place,
}

impl SymbolReader<'_> {
    /// True if more was read than there is.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.kept.is_exhausted || self.kept.raw.is_exhausted
    }

    /// True if all has been read: a payload ends where it began, and zeros may follow.
    pub(crate) fn is_at_end(&self) -> bool {
        let Place { states, next, is_exhausted, raw, .. } = *self.kept;
        !is_exhausted && states == [LEAST; NUM_STATES] && next == self.words.len() && raw.is_at_end(self.raw)
    }
}

impl SymbolCoder for SymbolReader<'_> {
    #[inline(always)]
    fn symbol(&mut self, group: usize, context: usize, _: u8) -> u8 {
        let place = &mut *self.kept;
        let state = place.states[place.turn];
        let slot = self.models.slot(group, context, state);
        let mut state = slot.advance(state);
        if state < LEAST {
            let word = self.words.get(place.next..place.next + WORD).map(LittleEndian::read_u16);
            place.is_exhausted |= word.is_none();
            place.next += WORD;
            state = state << 16 | u32::from(word.unwrap_or(0));
        }
        place.states[place.turn] = state;
        place.turn = (place.turn + 1) % NUM_STATES;
        slot.symbol()
    }

    #[inline(always)]
    fn number(&mut self, group: usize, context: usize, _: u32) -> u32 {
        let symbol = self.symbol(group, context, 0);
        let count = token::rest_bits(symbol);
        let rest = if count == 0 { 0 } else { self.kept.raw.read(self.raw, count) };
        token::number(symbol, rest)
    }

    #[inline(always)]
    fn raw(&mut self, _: u32, count: u32) -> u32 {
        self.kept.raw.read(self.raw, count)
    }
}
