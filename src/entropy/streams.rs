//! Payloads of the profile *fast* (`format/SPEC.md`, section 6.6): decisions and symbols, sorted into
//! streams by what is known of them, packed, and compressed all together.

use super::range_coder::BitCoder;
use crate::util::bytes::Reader;
#[cfg(any(feature = "encoder", test))]
use crate::util::bytes::write_varint;

/// What is one bit, by what it is and its context.
pub(crate) mod stream {
    /// Whatever is coded with a probability otherwise, and what is left of long symbols.
    pub(crate) const RAW: usize = 0;
    /// Whether a face is in a patch, and whether a patch grows.
    pub(crate) const IN_PATCH: usize = 1;
    pub(crate) const NUM_IN_PATCH: usize = 20;
    pub(crate) const GROW: usize = IN_PATCH + NUM_IN_PATCH;
    pub(crate) const NUM_GROW: usize = 24;
    /// Residuals, one byte per symbol.
    pub(crate) const SYMBOLS: usize = GROW + NUM_GROW;
    pub(crate) const NUM_SYMBOLS: usize = 24;
    pub(crate) const COUNT: usize = SYMBOLS + NUM_SYMBOLS;
}

/// Vertices of a pass from which on it has more streams: each costs some thirty bytes of statistics.
const SOME_VERTICES: u32 = 1000;
const MANY_VERTICES: u32 = 8000;

/// The stream that each stream shares in a pass that adds this many vertices.
fn merged(vertices: u32) -> [u8; stream::COUNT] {
    use stream::{GROW, IN_PATCH, SYMBOLS};
    std::array::from_fn(|i| {
        let to = match i {
            _ if vertices >= MANY_VERTICES => i,
            SYMBOLS.. if vertices >= SOME_VERTICES => SYMBOLS + (i - SYMBOLS) / 4 * 4 + (i - SYMBOLS) % 2,
            SYMBOLS.. => SYMBOLS + (i - SYMBOLS) % 2,
            // Six for each size of a patch, two for each valence.
            GROW.. if vertices >= SOME_VERTICES => {
                GROW + ((i - GROW) / 6).min(2) * 6 + (i - GROW) % 6 / 2 * 2
            }
            GROW.. => GROW + ((i - GROW) / 6).min(1) * 6,
            // Four for each valence.
            IN_PATCH.. if vertices >= SOME_VERTICES => IN_PATCH + (i - IN_PATCH) / 4 * 4,
            IN_PATCH.. => IN_PATCH,
            _ => i,
        };
        to as u8
    })
}

/// Numbers below this are symbols of their own.
const WHOLE: u32 = 16;
/// Largest number of bits of a residual, folded.
const MAX_BITS: u32 = 32;
/// Symbols for each number of bits above.
const PER_LENGTH: u32 = 4;

/// How the streams are kept in a payload.
const STORED: u8 = 0;
const PACKED: u8 = 1;

/// Bits or symbols in each byte: of decisions as many as can still be told apart by frequency.
fn elements_per_byte(stream: usize) -> u32 {
    match stream {
        stream::RAW => 8,
        stream::SYMBOLS.. => 1,
        _ => 4,
    }
}

/// Place in a stream: bits of decisions, bytes of symbols.
#[derive(Clone, Copy, Default)]
struct Cursor {
    next: u32,
    end: u32,
}

/// Reads what a [`StreamWriter`] wrote. Owns its bytes, so that it may rest.
pub(crate) struct StreamReader {
    merged: [u8; stream::COUNT],
    bytes: Vec<u8>,
    cursors: Vec<Cursor>,
    is_exhausted: bool,
}

impl StreamReader {
    /// Unpacks the payload of a pass that adds this many vertices; its streams may take `most` bytes. `None`
    /// if it is not such a payload.
    pub(crate) fn new(payload: &[u8], vertices: u32, most: u64) -> Option<Self> {
        let mut reader = Reader::new(payload);
        let (method, size) = (reader.u8()?, reader.varint()?);
        if u64::from(size) > most || size >= 1 << 28 {
            return None;
        }
        let size = size as usize;
        let bytes = match method {
            STORED => reader.take(size)?.to_vec(),
            PACKED => {
                let packed = reader.varint()? as usize;
                unpack(reader.take(packed)?, size)?
            }
            _ => return None,
        };
        let mut reader = Reader::new(&bytes);
        let mut lengths = [0; stream::COUNT];
        let merged = merged(vertices);
        for (_, length) in lengths.iter_mut().enumerate().filter(|(i, _)| usize::from(merged[*i]) == *i) {
            *length = reader.varint()?;
        }
        let mut start = (bytes.len() - reader.len()) as u32;
        let mut cursors = Vec::with_capacity(stream::COUNT);
        for (i, length) in lengths.into_iter().enumerate() {
            let end = start.checked_add(length).filter(|&end| end as usize <= bytes.len())?;
            let per_byte = elements_per_byte(i);
            cursors.push(Cursor { next: start * per_byte, end: end * per_byte });
            start = end;
        }
        (start as usize == bytes.len()).then_some(Self { merged, bytes, cursors, is_exhausted: false })
    }

    #[inline]
    fn bit(&mut self, stream: usize) -> bool {
        let stream = usize::from(self.merged[stream]);
        let cursor = &mut self.cursors[stream];
        if cursor.next == cursor.end {
            self.is_exhausted = true;
            return false;
        }
        let at = cursor.next;
        cursor.next += 1;
        if stream == stream::RAW {
            self.bytes[(at >> 3) as usize] >> (at & 7) & 1 == 1
        } else {
            self.bytes[(at >> 2) as usize] >> (at & 3) & 1 == 1
        }
    }

    #[inline]
    fn symbol(&mut self, stream: usize) -> u8 {
        let stream = usize::from(self.merged[stream]);
        let cursor = &mut self.cursors[stream];
        if cursor.next == cursor.end {
            self.is_exhausted = true;
            return 0;
        }
        cursor.next += 1;
        self.bytes[cursor.next as usize - 1]
    }
}

impl BitCoder for StreamReader {
    const HAS_STREAMS: bool = true;

    fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    #[inline]
    fn code(&mut self, _: bool, _: u32) -> bool {
        self.bit(stream::RAW)
    }

    #[inline]
    fn decide(&mut self, stream: usize, _: bool) -> bool {
        self.bit(stream)
    }

    #[inline]
    fn difference(&mut self, stream: usize, _: i32) -> Option<i32> {
        let symbol = u32::from(self.symbol(stream));
        let folded = if symbol < WHOLE {
            symbol
        } else {
            let length = (symbol - WHOLE) / PER_LENGTH + WHOLE.ilog2() + 1;
            if length > MAX_BITS {
                return None;
            }
            let head = PER_LENGTH + (symbol - WHOLE) % PER_LENGTH;
            let rest = length - PER_LENGTH.ilog2() - 1;
            (0..rest).fold(head, |n, _| n << 1 | u32::from(self.bit(stream::RAW)))
        };
        Some((folded >> 1) as i32 ^ -((folded & 1) as i32))
    }
}

/// Sorts decisions and symbols into streams.
#[cfg(any(feature = "encoder", test))]
pub(crate) struct StreamWriter {
    merged: [u8; stream::COUNT],
    streams: Vec<Vec<u8>>,
    /// Bits in each stream of decisions.
    counts: Vec<usize>,
}

#[cfg(any(feature = "encoder", test))]
impl StreamWriter {
    /// A payload of a pass that adds this many vertices.
    pub(crate) fn new(vertices: u32) -> Self {
        Self {
            merged: merged(vertices),
            streams: vec![Vec::new(); stream::COUNT],
            counts: vec![0; stream::COUNT],
        }
    }

    fn push(&mut self, stream: usize, bit: bool) {
        let stream = usize::from(self.merged[stream]);
        let count = &mut self.counts[stream];
        let bytes = &mut self.streams[stream];
        let place = *count % elements_per_byte(stream) as usize;
        if place == 0 {
            bytes.push(0);
        }
        if let Some(last) = bytes.last_mut() {
            *last |= u8::from(bit) << place;
        }
        *count += 1;
    }

    /// The payload.
    pub(crate) fn finish(self) -> Vec<u8> {
        let mut head = Vec::new();
        let kept = self.streams.iter().enumerate().filter(|(i, _)| usize::from(self.merged[*i]) == *i);
        kept.for_each(|(_, s)| write_varint(&mut head, s.len() as u32));
        let size = head.len() + self.streams.iter().map(Vec::len).sum::<usize>();
        let parts: Vec<&[u8]> = std::iter::once(&head).chain(&self.streams).map(Vec::as_slice).collect();
        let mut payload = Vec::new();
        match pack(&parts, size) {
            Some(packed) if packed.len() + 2 < size => {
                payload.push(PACKED);
                write_varint(&mut payload, size as u32);
                write_varint(&mut payload, packed.len() as u32);
                payload.extend(packed);
            }
            _ => {
                payload.push(STORED);
                write_varint(&mut payload, size as u32);
                parts.iter().for_each(|part| payload.extend_from_slice(part));
            }
        }
        payload
    }
}

#[cfg(any(feature = "encoder", test))]
impl BitCoder for StreamWriter {
    const HAS_STREAMS: bool = true;

    fn code(&mut self, bit: bool, _: u32) -> bool {
        self.push(stream::RAW, bit);
        bit
    }

    fn decide(&mut self, stream: usize, bit: bool) -> bool {
        self.push(stream, bit);
        bit
    }

    fn difference(&mut self, stream: usize, value: i32) -> Option<i32> {
        let folded = (value << 1 ^ value >> 31) as u32;
        let stream = usize::from(self.merged[stream]);
        if folded < WHOLE {
            self.streams[stream].push(folded as u8);
            return Some(value);
        }
        let length = 32 - folded.leading_zeros();
        let rest = length - PER_LENGTH.ilog2() - 1;
        let head = (folded >> rest) - PER_LENGTH;
        self.streams[stream].push((WHOLE + (length - WHOLE.ilog2() - 1) * PER_LENGTH + head) as u8);
        (0..rest).rev().for_each(|i| self.push(stream::RAW, folded >> i & 1 == 1));
        Some(value)
    }
}

/// Level of the compressor: payloads are small, and decoding is as fast for all.
#[cfg(all(feature = "fast", any(feature = "encoder", test)))]
const LEVEL: i32 = 19;
/// Parts from this size on get blocks of their own, with statistics of their own.
#[cfg(all(feature = "fast", any(feature = "encoder", test)))]
const OWN_BLOCK: usize = 256;

#[cfg(all(feature = "fast", any(feature = "encoder", test)))]
fn pack(parts: &[&[u8]], size: usize) -> Option<Vec<u8>> {
    use std::io::Write;
    let mut encoder = zstd::Encoder::new(Vec::new(), LEVEL).ok()?;
    // What looks like a repetition is mostly chance.
    encoder.set_parameter(zstd::zstd_safe::CParameter::MinMatch(7)).ok()?;
    encoder.include_contentsize(false).ok()?;
    encoder.include_checksum(false).ok()?;
    encoder.set_pledged_src_size(Some(size as u64)).ok()?;
    let mut is_open = false;
    for part in parts {
        let is_long = part.len() >= OWN_BLOCK;
        if is_long && is_open {
            encoder.flush().ok()?;
        }
        encoder.write_all(part).ok()?;
        is_open |= !part.is_empty();
        if is_long {
            encoder.flush().ok()?;
            is_open = false;
        }
    }
    encoder.finish().ok()
}

#[cfg(all(not(feature = "fast"), any(feature = "encoder", test)))]
fn pack(_: &[&[u8]], _: usize) -> Option<Vec<u8>> {
    None
}

#[cfg(feature = "fast")]
fn unpack(packed: &[u8], size: usize) -> Option<Vec<u8>> {
    zstd::bulk::decompress(packed, size).ok().filter(|bytes| bytes.len() == size)
}

#[cfg(not(feature = "fast"))]
fn unpack(_: &[u8], _: usize) -> Option<Vec<u8>> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_return() {
        let values = [0, 1, -1, 7, -8, 8, 100, -1000, i32::MAX, i32::MIN, 1 << 20];
        for repeat in [1, 200] {
            let mut writer = StreamWriter::new(if repeat > 1 { 5000 } else { 0 });
            for i in 0..repeat {
                for (k, &value) in values.iter().enumerate() {
                    writer.difference(stream::SYMBOLS + k % 3, value);
                    writer.decide(stream::GROW + k, i % 3 == 0);
                    writer.code(k % 2 == 0, 0);
                }
            }
            let payload = writer.finish();
            let mut reader = StreamReader::new(&payload, if repeat > 1 { 5000 } else { 0 }, 1 << 20).unwrap();
            for i in 0..repeat {
                for (k, &value) in values.iter().enumerate() {
                    assert_eq!(reader.difference(stream::SYMBOLS + k % 3, 0), Some(value));
                    assert_eq!(reader.decide(stream::GROW + k, false), i % 3 == 0);
                    assert_eq!(reader.code(false, 0), k % 2 == 0);
                }
            }
            assert!(!reader.is_exhausted());
            assert!(!reader.symbol(stream::SYMBOLS) > 0 && reader.is_exhausted());
            assert!(StreamReader::new(&payload, 0, 10).is_none(), "more than allowed");
            for cut in 0..payload.len() {
                assert!(
                    StreamReader::new(&payload[..cut], 0, 1 << 20).is_none(),
                    "{cut} of {}",
                    payload.len()
                );
            }
        }
    }
}
