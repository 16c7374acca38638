//! Whole numbers of any size in adaptive bits (`format/SPEC.md`, section 6.5).

use super::context_mixer::PlainBits;
use super::range_coder::BitCoder;

/// Largest number of digits of a number and one.
const MAX_DIGITS: usize = 48;
/// Digits after the first that have models.
const MODELLED: u32 = 3;
/// Bits of one context: a unary code of the digits, the modelled digits of each length, a sign.
const BITS: usize = MAX_DIGITS + (MAX_DIGITS << MODELLED) + 1;
const SIGN: usize = BITS - 1;

/// Adaptive numbers below 2⁴⁸ − 1, with or without sign.
pub(crate) struct Numbers {
    bits: PlainBits,
}

impl Numbers {
    pub(crate) fn new(num_contexts: usize) -> Self {
        Self { bits: PlainBits::new(num_contexts * BITS) }
    }

    /// Codes a number; a `context` is below the number of them.
    pub(crate) fn code<B: BitCoder>(&mut self, coder: &mut B, context: usize, value: u64) -> u64 {
        let first = context * BITS;
        let value = value + 1;
        let wanted = value.checked_ilog2().unwrap_or(0) as usize;
        let mut digits = 0;
        while digits + 1 < MAX_DIGITS && self.bits.code(coder, first + digits, wanted > digits) {
            digits += 1;
        }
        let mut read = 1_u64;
        for depth in 0..digits as u32 {
            let bit = value >> (digits as u32 - 1 - depth) & 1 == 1;
            let bit = if depth < MODELLED {
                let node = digits << MODELLED | (read as usize & ((1 << depth) - 1)) | 1 << depth;
                self.bits.code(coder, first + MAX_DIGITS + node, bit)
            } else {
                coder.code_raw(u32::from(bit), 1) == 1
            };
            read = read << 1 | u64::from(bit);
        }
        read - 1
    }

    /// Codes a number with a sign: its size, then the sign unless it is 0.
    pub(crate) fn code_signed<B: BitCoder>(&mut self, coder: &mut B, context: usize, value: i64) -> i64 {
        let size = self.code(coder, context, value.unsigned_abs()) as i64;
        if size != 0 && self.bits.code(coder, context * BITS + SIGN, value < 0) { -size } else { size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entropy::range_coder::{RangeDecoder, RangeEncoder};

    #[test]
    fn every_number_returns_and_frequent_ones_are_cheap() {
        let mut values: Vec<i64> = (-300..300).collect();
        values.extend((0..47).flat_map(|i| [1 << i, -(1 << i), (1 << i) - 1]));
        values.extend([3; 5000]);
        let mut encoder = RangeEncoder::new();
        let mut numbers = Numbers::new(2);
        values.iter().for_each(|&v| assert_eq!(numbers.code_signed(&mut encoder, 1, v), v));
        let bytes = encoder.finish();
        assert!(bytes.len() < 2000, "{}", bytes.len());
        let mut decoder = RangeDecoder::new(&bytes);
        let mut numbers = Numbers::new(2);
        values.iter().for_each(|&v| assert_eq!(numbers.code_signed(&mut decoder, 1, 0), v));
    }

    #[test]
    fn any_bytes_are_some_number() {
        for bytes in [&[0xff_u8; 40][..], &[0; 3], &[0x5a; 9]] {
            let mut numbers = Numbers::new(1);
            let mut decoder = RangeDecoder::new(bytes);
            assert!((0..20).all(|_| numbers.code(&mut decoder, 0, 0) < (1 << MAX_DIGITS) - 1));
        }
    }
}
