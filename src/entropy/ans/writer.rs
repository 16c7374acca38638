//! Writes symbols: all are kept until models have been fitted to them (`format/SPEC.md`, section 6.7).

use super::super::range_coder::RangeEncoder;
use super::coder::SymbolCoder;
use super::fit::fit;
use super::models::{Group, code_group};
use super::raw::RawWriter;
use super::states::{LEAST, NUM_STATES, retreat};
use super::token::Token;
use crate::util::bytes::write_varint;

#[derive(Clone, Copy)]
struct Symbol {
    group: u8,
    symbol: u8,
    context: u32,
}

/// Where a symbol lies among the slots of its table.
#[derive(Clone, Copy)]
struct Interval {
    start: u32,
    frequency: u32,
}

/// The symbols of a payload.
#[derive(Clone)]
pub(crate) struct SymbolWriter {
    groups: &'static [Group],
    symbols: Vec<Symbol>,
    raw: RawWriter,
}

impl SymbolWriter {
    pub(crate) fn new(groups: &'static [Group]) -> Self {
        Self { groups, symbols: Vec::new(), raw: RawWriter::default() }
    }

    /// The payload: its head, to which the models are added, then symbols and bits.
    pub(crate) fn finish(self, mut head: RangeEncoder) -> Vec<u8> {
        let mut intervals = Vec::new();
        for (index, group) in self.groups.iter().enumerate() {
            intervals.push(self.fit_group(&mut head, index, group));
        }
        let (states, words) = self.states_and_words(&intervals);
        let head = head.finish();
        let mut payload = Vec::new();
        write_varint(&mut payload, head.len() as u32);
        payload.extend(head);
        write_varint(&mut payload, words.len() as u32);
        states.iter().for_each(|state| payload.extend(state.to_le_bytes()));
        words.iter().rev().for_each(|word| payload.extend(word.to_le_bytes()));
        payload.extend(self.raw.finish());
        payload
    }

    /// Codes the models of a group. Returns for each leaf of its tree the intervals of symbols, and the leaf of each context.
    fn fit_group(
        &self,
        head: &mut RangeEncoder,
        index: usize,
        group: &Group,
    ) -> (Vec<u8>, Vec<Vec<Interval>>) {
        let of_group = self.symbols.iter().filter(|s| usize::from(s.group) == index);
        let mut symbols: Vec<(u32, u8)> = of_group.map(|s| (s.context, s.symbol)).collect();
        let model = fit(group, &mut symbols);
        let Some((leaves, tables)) = code_group(head, group, Some(&model)) else {
            unreachable!("the encoder made models it refuses")
        };
        let intervals = tables.iter().map(|table| {
            let frequencies = table.0.iter().map(|&f| u32::from(f));
            let interval = |start: &mut u32, frequency| {
                *start += frequency;
                Some(Interval { start: *start - frequency, frequency })
            };
            frequencies.scan(0, interval).collect()
        });
        (leaves.of_context, intervals.collect())
    }

    /// Symbols are coded from the last to the first, as a decoder reads them the other way.
    fn states_and_words(&self, groups: &[(Vec<u8>, Vec<Vec<Interval>>)]) -> ([u32; NUM_STATES], Vec<u16>) {
        let (mut states, mut words) = ([LEAST; NUM_STATES], Vec::new());
        for (i, symbol) in self.symbols.iter().enumerate().rev() {
            let (leaves, intervals) = &groups[usize::from(symbol.group)];
            let leaf = usize::from(leaves[symbol.context as usize]);
            let Interval { start, frequency } = intervals[leaf][usize::from(symbol.symbol)];
            let state = &mut states[i % NUM_STATES];
            *state = retreat(*state, start, frequency, &mut words);
        }
        (states, words)
    }
}

impl SymbolCoder for SymbolWriter {
    fn symbol(&mut self, group: usize, context: usize, symbol: u8) -> u8 {
        self.symbols.push(Symbol { group: group as u8, symbol, context: context as u32 });
        symbol
    }

    fn number(&mut self, group: usize, context: usize, number: u32) -> u32 {
        let token = Token::of(number);
        self.symbol(group, context, token.symbol);
        self.raw.write(token.rest, token.count);
        number
    }

    fn raw(&mut self, value: u32, count: u32) -> u32 {
        self.raw.write(value, count);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::super::models::Models;
    use super::super::reader::PausedReader;
    use super::super::token::NUM_TOKENS;
    use super::*;
    use crate::entropy::range_coder::RangeDecoder;
    use crate::util::bytes::Reader;

    const GROUPS: &[Group] = &[
        Group { alphabet: 5, attributes: &[4, 3], most_tables: 8 },
        Group { alphabet: NUM_TOKENS, attributes: &[2], most_tables: 2 },
    ];

    /// Codes so many of each; returns how many were as wanted.
    fn code(coder: &mut impl SymbolCoder, count: u32) -> u32 {
        let same = (0..count).map(|i| {
            let noise = i.wrapping_mul(2_654_435_761) >> 13;
            let symbol = (noise % 5).min(i % 4) as u8;
            let number = (noise % 100_000) >> (noise % 17);
            let is_symbol = coder.symbol(0, (i % 12) as usize, symbol) == symbol;
            let is_number = coder.number(1, (i % 2) as usize, number) == number;
            let is_raw = coder.raw(i % 8, 3) == i % 8;
            u32::from(is_symbol && is_number && is_raw)
        });
        same.sum()
    }

    fn write(count: u32) -> Vec<u8> {
        let mut writer = SymbolWriter::new(GROUPS);
        code(&mut writer, count);
        writer.finish(RangeEncoder::new())
    }

    fn open(payload: &[u8]) -> Option<PausedReader> {
        let mut reader = Reader::new(payload);
        let size = reader.varint()? as usize;
        let models = Models::read(&mut RangeDecoder::new(reader.take(size)?), GROUPS)?;
        PausedReader::new(payload, reader, models)
    }

    #[test]
    fn symbols_return_and_the_end_is_known() {
        for count in [0, 1, 2, 700, 9000] {
            let mut payload = write(count);
            for _ in 0..2 {
                let mut reader = open(&payload).unwrap();
                let mut coder = reader.resume(&payload);
                assert_eq!(code(&mut coder, count), count);
                assert!(coder.is_at_end() && !coder.is_exhausted());
                // Read further.
                code(&mut coder, 40);
                assert!(!coder.is_at_end());
                payload.extend([0; 3]);
            }
            payload.push(1);
            let mut reader = open(&payload).unwrap();
            let mut coder = reader.resume(&payload);
            assert_eq!(code(&mut coder, count), count);
            assert!(!coder.is_at_end(), "a byte too many");
        }
    }

    #[test]
    fn a_cut_payload_is_refused_or_exhausted() {
        let payload = write(700);
        for cut in 0..payload.len() {
            let Some(mut reader) = open(&payload[..cut]) else { continue };
            let mut coder = reader.resume(&payload[..cut]);
            code(&mut coder, 700);
            (0..700).for_each(|_| _ = coder.number(1, 0, 0));
            assert!(coder.is_exhausted() && !coder.is_at_end(), "{cut}");
        }
    }
}
