//! Binary range coder (`format/SPEC.md`, section 6.1): carry propagation as in LZMA, 16-bit
//! probabilities, no terminator: a decoder reads zeros past the end of the payload.

/// Total of a probability: `p / 65536` is the chance of a one.
pub(crate) const PROBABILITY_ONE: u32 = 1 << 16;
const RENORMALISE_BELOW: u32 = 1 << 24;
/// Zeros after a payload that a decoder may read: encoders leave out no more.
const MAX_MISSING_ZEROS: usize = 8;

/// One side of the coder. Passes are written once over this trait: the encoder returns the bit it
/// was given, the decoder ignores its argument and returns the bit it read.
pub(crate) trait BitCoder {
    /// Codes one bit, `p1` = probability of a one in 1/65536, within 1..=65535.
    fn code(&mut self, bit: bool, p1: u32) -> bool;

    /// Whether [`decide`](Self::decide) is what codes, not probabilities.
    const HAS_STREAMS: bool = false;

    /// Codes one bit as an element of a stream, where there are streams.
    fn decide(&mut self, _stream: usize, bit: bool) -> bool {
        self.code(bit, PROBABILITY_ONE / 2)
    }

    /// Codes a difference as a symbol of a stream, where there are streams; `None` if what is read names
    /// one beyond 32 bits.
    fn difference(&mut self, _stream: usize, _value: i32) -> Option<i32> {
        None
    }

    /// True if what is read was not written: a payload ends too early.
    fn is_exhausted(&self) -> bool {
        false
    }

    /// True if a payload was cut and bits are predictions from here on.
    fn is_guessing(&self) -> bool {
        false
    }

    /// Codes the lowest `count` bits of `value`, most significant first, each with probability ½.
    fn code_raw(&mut self, value: u32, count: u32) -> u32 {
        (0..count).rev().fold(0, |read, shift| {
            read << 1 | u32::from(self.code(value >> shift & 1 == 1, PROBABILITY_ONE / 2))
        })
    }
}

/// Writes bits into a growing buffer.
#[cfg(any(feature = "encoder", test))]
pub(crate) struct RangeEncoder {
    low: u64,
    range: u32,
    cache: Option<u8>,
    pending: usize,
    bytes: Vec<u8>,
}

#[cfg(any(feature = "encoder", test))]
impl RangeEncoder {
    pub(crate) fn new() -> Self {
        Self { low: 0, range: u32::MAX, cache: None, pending: 0, bytes: Vec::new() }
    }

    /// Ends the payload with the fewest bytes that still name a number inside the final interval.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        // What a decoder reads: four bytes at first, then one where the encoder gave one.
        let read = 4 + self.bytes.len() + self.pending + usize::from(self.cache.is_some());
        let top = self.low + u64::from(self.range) - 1;
        let value = (0..=32).rev().map(|bits| top >> bits << bits).find(|&v| v >= self.low);
        self.low = value.unwrap_or(self.low);
        for _ in 0..5 {
            self.shift_low();
        }
        while self.bytes.last() == Some(&0) {
            self.bytes.pop();
        }
        // Improbable ones may leave nothing but zeros, however many.
        self.bytes.resize(self.bytes.len().max(read.saturating_sub(MAX_MISSING_ZEROS)), 0);
        self.bytes
    }

    fn shift_low(&mut self) {
        let carry = (self.low >> 32) as u8;
        let top = (self.low >> 24) as u8;
        if carry == 1 || top != 0xff {
            if let Some(cache) = self.cache {
                self.bytes.push(cache.wrapping_add(carry));
            }
            for _ in 0..self.pending {
                self.bytes.push(0xff_u8.wrapping_add(carry));
            }
            self.pending = 0;
            self.cache = Some(top);
        } else {
            self.pending += 1;
        }
        self.low = (self.low & 0x00ff_ffff) << 8;
    }
}

#[cfg(any(feature = "encoder", test))]
impl BitCoder for RangeEncoder {
    #[inline]
    fn code(&mut self, bit: bool, p1: u32) -> bool {
        let bound = split(self.range, p1);
        if bit {
            self.range = bound;
        } else {
            self.low += u64::from(bound);
            self.range -= bound;
        }
        while self.range < RENORMALISE_BELOW {
            self.range <<= 8;
            self.shift_low();
        }
        bit
    }
}

/// The position of a decoder in its payload.
#[derive(Clone)]
pub(crate) struct RangeState {
    code: u32,
    range: u32,
    next: usize,
}

/// Reads bits from one payload.
pub(crate) struct RangeDecoder<'a> {
    code: u32,
    range: u32,
    bytes: &'a [u8],
    next: usize,
    /// Bytes that may be read.
    end: usize,
    is_cut: bool,
}

impl<'a> RangeDecoder<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let end = bytes.len() + MAX_MISSING_ZEROS;
        let mut decoder = Self { code: 0, range: u32::MAX, bytes, next: 0, end, is_cut: false };
        for _ in 0..4 {
            decoder.code = decoder.code << 8 | decoder.next_byte();
        }
        decoder
    }

    /// Reads the beginning of a payload; bits that the missing bytes decide are the likelier ones.
    pub(crate) fn of_cut(bytes: &'a [u8]) -> Self {
        Self { end: bytes.len(), is_cut: true, ..Self::new(bytes) }
    }

    /// Goes on where a decoder of the same payload was.
    pub(crate) fn resume(bytes: &'a [u8], state: &RangeState) -> Self {
        let RangeState { code, range, next } = *state;
        Self { code, range, bytes, next, end: bytes.len() + MAX_MISSING_ZEROS, is_cut: false }
    }

    /// Bytes read, or asked for after the end.
    pub(crate) fn position(&self) -> usize {
        self.next
    }

    pub(crate) fn pause(&self) -> RangeState {
        RangeState { code: self.code, range: self.range, next: self.next }
    }

    #[inline]
    fn next_byte(&mut self) -> u32 {
        let byte = self.bytes.get(self.next).copied().unwrap_or(0);
        self.next += 1;
        u32::from(byte)
    }
}

impl BitCoder for RangeDecoder<'_> {
    fn is_exhausted(&self) -> bool {
        !self.is_cut && self.next > self.end
    }

    fn is_guessing(&self) -> bool {
        self.is_cut && self.next > self.end
    }

    #[inline]
    fn code(&mut self, _: bool, p1: u32) -> bool {
        if self.is_guessing() {
            return p1 > PROBABILITY_ONE / 2;
        }
        let bound = split(self.range, p1);
        let bit = self.code < bound;
        if bit {
            self.range = bound;
        } else {
            self.code -= bound;
            self.range -= bound;
        }
        while self.range < RENORMALISE_BELOW {
            self.range <<= 8;
            self.code = self.code << 8 | self.next_byte();
        }
        bit
    }
}

#[inline]
fn split(range: u32, p1: u32) -> u32 {
    ((u64::from(range) * u64::from(p1)) >> 16) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn returns_what_was_written_whatever_the_probabilities() {
        let mut seed = 1_u32;
        let mut next = move || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 8
        };
        for length in [0, 1, 2, 3, 7, 8, 9, 100, 5000] {
            let bits: Vec<(bool, u32)> = (0..length)
                .map(|_| {
                    let p1 = match next() % 3 {
                        0 => 1 + next() % 16,
                        1 => 65_535 - next() % 16,
                        _ => 1 + next() % 65_535,
                    };
                    (next() % 65_536 < p1, p1)
                })
                .collect();
            let mut encoder = RangeEncoder::new();
            for &(bit, p1) in &bits {
                encoder.code(bit, p1);
            }
            let bytes = encoder.finish();
            let mut decoder = RangeDecoder::new(&bytes);
            for (i, &(bit, p1)) in bits.iter().enumerate() {
                assert_eq!(decoder.code(false, p1), bit, "bit {i} of {length}");
            }
            assert!(!decoder.is_exhausted());
        }
    }

    #[test]
    fn carries_run_through_pending_bytes() {
        // Improbable ones and probable zeros push `low` against the top again and again.
        let bits: Vec<bool> = (0..4000).map(|i| i % 97 == 0).collect();
        let mut encoder = RangeEncoder::new();
        for &bit in &bits {
            encoder.code(bit, 3);
        }
        let bytes = encoder.finish();
        let mut decoder = RangeDecoder::new(&bytes);
        assert!(bits.iter().all(|&bit| decoder.code(false, 3) == bit));
    }

    #[test]
    fn a_payload_of_zeros_keeps_enough_of_them() {
        // Ones stay at the bottom of the interval: any number of them is the number zero.
        for count in [1, 8, 30, 63, 64, 65, 80, 1000] {
            for p1 in [1, 17, PROBABILITY_ONE / 2, PROBABILITY_ONE - 1] {
                let mut encoder = RangeEncoder::new();
                (0..count).for_each(|_| assert!(encoder.code(true, p1)));
                let bytes = encoder.finish();
                let mut decoder = RangeDecoder::new(&bytes);
                assert!((0..count).all(|_| decoder.code(false, p1)));
                assert!(!decoder.is_exhausted(), "{count} ones of probability {p1}");
            }
        }
    }

    #[test]
    fn size_is_the_information_content() {
        let mut encoder = RangeEncoder::new();
        for i in 0..80_000 {
            encoder.code(i % 8 == 0, PROBABILITY_ONE / 8);
        }
        let bits = 8 * encoder.finish().len();
        // 80,000 draws with p = 1/8 hold 43,485 bits.
        assert!((43_480..43_530).contains(&bits), "{bits} bits");
    }
}
