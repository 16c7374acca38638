//! Small numbers in few bits (`format/SPEC.md`, section 4.3): a bit string, the top bit of a byte first.

/// Longest prefix: it leads to numbers of 33 bits, all that is ever written.
const MAX_PREFIX: u32 = 32;

/// Bits that a number close to `expected` is coded with at least.
fn fixed_bits(expected: u32) -> u32 {
    (32 - expected.leading_zeros()).saturating_sub(4)
}

/// Reads a payload bit by bit. `None` means that it ends too early or breaks a rule.
pub(crate) struct BitReader<'a> {
    bytes: &'a [u8],
    next: usize,
}

impl<'a> BitReader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, next: 0 }
    }

    pub(crate) fn bit(&mut self) -> Option<bool> {
        let byte = *self.bytes.get(self.next / 8)?;
        self.next += 1;
        Some(byte >> (7 - (self.next - 1) % 8) & 1 == 1)
    }

    fn bits(&mut self, count: u32) -> Option<u64> {
        (0..count).try_fold(0, |value, _| Some(value << 1 | u64::from(self.bit()?)))
    }

    /// An Exp-Golomb number: the larger `fixed`, the cheaper large ones.
    fn long(&mut self, fixed: u32) -> Option<u64> {
        let mut prefix = 0;
        while self.bit()? {
            prefix += 1;
            if prefix > MAX_PREFIX {
                return None;
            }
        }
        Some((((1_u64 << prefix) - 1) << fixed) + self.bits(prefix + fixed)?)
    }

    /// A number of 32 bits, see [`BitWriter::number`].
    pub(crate) fn number(&mut self, fixed: u32) -> Option<u32> {
        self.long(fixed).and_then(|n| u32::try_from(n).ok())
    }

    /// A number of 32 bits, see [`BitWriter::near`].
    pub(crate) fn near(&mut self, expected: u32) -> Option<u32> {
        u32::try_from(i64::from(expected) + self.folded(fixed_bits(expected))?).ok()
    }

    /// A signed number, see [`BitWriter::signed`].
    pub(crate) fn signed(&mut self, fixed: u32) -> Option<i32> {
        self.folded(fixed).and_then(|n| i32::try_from(n).ok())
    }

    /// 0, −1, 1, −2, …
    fn folded(&mut self, fixed: u32) -> Option<i64> {
        let folded = self.long(fixed)?;
        let half = i64::try_from(folded >> 1).ok()?;
        Some(if folded & 1 == 0 { half } else { -half - 1 })
    }

    /// True if nothing but the zeros that fill the last byte is left.
    pub(crate) fn is_at_end(&self) -> bool {
        let is_zero = |i: usize| self.bytes[i / 8] >> (7 - i % 8) & 1 == 0;
        self.next.div_ceil(8) == self.bytes.len() && (self.next..8 * self.bytes.len()).all(is_zero)
    }
}

/// Writes what [`BitReader`] reads.
#[cfg(any(feature = "encoder", test))]
#[derive(Default)]
pub(crate) struct BitWriter {
    bytes: Vec<u8>,
    count: usize,
}

#[cfg(any(feature = "encoder", test))]
impl BitWriter {
    pub(crate) fn bit(&mut self, bit: bool) {
        if self.count.is_multiple_of(8) {
            self.bytes.push(0);
        }
        if let Some(last) = self.bytes.last_mut() {
            *last |= u8::from(bit) << (7 - self.count % 8);
        }
        self.count += 1;
    }

    fn bits(&mut self, value: u64, count: u32) {
        (0..count).rev().for_each(|shift| self.bit(value >> shift & 1 == 1));
    }

    fn long(&mut self, value: u64, fixed: u32) {
        // The prefix is the number of ones that precede the bits of value / 2^fixed + 1 but the first.
        let head = (value >> fixed) + 1;
        let prefix = head.ilog2();
        (0..prefix).for_each(|_| self.bit(true));
        self.bit(false);
        self.bits(value - (((1 << prefix) - 1) << fixed), prefix + fixed);
    }

    /// Appends a number that is rarely above 2^`fixed`.
    pub(crate) fn number(&mut self, value: u32, fixed: u32) {
        self.long(value.into(), fixed);
    }

    /// Appends a number that is mostly within an eighth of `expected`.
    pub(crate) fn near(&mut self, value: u32, expected: u32) {
        self.folded(i64::from(value) - i64::from(expected), fixed_bits(expected));
    }

    /// Appends a number that is rarely beyond 2^(`fixed` − 1) either way.
    pub(crate) fn signed(&mut self, value: i32, fixed: u32) {
        self.folded(value.into(), fixed);
    }

    fn folded(&mut self, value: i64, fixed: u32) {
        let folded = if value >= 0 { 2 * value } else { -2 * value - 1 };
        self.long(folded.unsigned_abs(), fixed);
    }

    /// The bytes, the last one filled with zeros.
    pub(crate) fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_return_and_likely_ones_are_short() {
        let numbers = [0, 1, 2, 7, 8, 255, 256, 70_000, u32::MAX - 1, u32::MAX];
        let mut writer = BitWriter::default();
        for value in numbers {
            writer.number(value, 0);
            writer.number(value, 7);
            numbers.iter().for_each(|&expected| writer.near(value, expected));
        }
        writer.bit(true);
        let bytes = writer.finish();
        let mut reader = BitReader::new(&bytes);
        for value in numbers {
            assert_eq!(reader.number(0), Some(value));
            assert_eq!(reader.number(7), Some(value));
            for expected in numbers {
                assert_eq!(reader.near(expected), Some(value), "{value} near {expected}");
            }
        }
        assert_eq!(reader.bit(), Some(true));
        assert!(reader.is_at_end());

        let mut writer = BitWriter::default();
        writer.near(1030, 1000);
        assert_eq!(writer.count, 7);
    }

    #[test]
    fn nonsense_is_refused() {
        assert_eq!(BitReader::new(&[0xff; 9]).number(0), None, "a prefix without end");
        assert_eq!(BitReader::new(&[]).near(5), None);
        // 33 bits, and a number below zero.
        let mut writer = BitWriter::default();
        writer.long(1 << 32, 0);
        writer.long(9, 0);
        let bytes = writer.finish();
        assert_eq!(BitReader::new(&bytes).number(0), None);
        let mut reader = BitReader::new(&bytes);
        assert_eq!((reader.long(0), reader.near(4)), (Some(1 << 32), None));
        // Bits set after the end, and a byte too many.
        for (bytes, is_over) in [(&[0b0100_0000][..], true), (&[0b0100_0001], false), (&[0x40, 0], false)] {
            let mut reader = BitReader::new(bytes);
            assert_eq!((reader.bit(), reader.bit()), (Some(false), Some(true)));
            assert_eq!(reader.is_at_end(), is_over, "{bytes:?}");
        }
    }
}
