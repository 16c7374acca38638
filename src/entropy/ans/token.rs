//! Numbers of any size as a symbol and bits that are not worth one (`format/SPEC.md`, section 6.7).

/// Numbers below this are symbols of their own.
const WHOLE: u32 = 16;
/// Symbols for each number of digits above.
const PER_OCTAVE: u32 = 4;
/// Symbols of all numbers of 32 bits.
pub(crate) const NUM_TOKENS: usize = (WHOLE + PER_OCTAVE * (32 - WHOLE.ilog2())) as usize;

/// A symbol and the lowest `count` bits of a number.
#[cfg(any(feature = "encoder", test))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub(super) symbol: u8,
    pub(super) rest: u32,
    pub(super) count: u32,
}

#[cfg(any(feature = "encoder", test))]
impl Token {
    pub(super) fn of(number: u32) -> Self {
        if number < WHOLE {
            return Self { symbol: number as u8, rest: 0, count: 0 };
        }
        let digits = number.ilog2();
        let count = digits - PER_OCTAVE.ilog2();
        let symbol = WHOLE + (digits - WHOLE.ilog2()) * PER_OCTAVE + (number >> count) % PER_OCTAVE;
        Self { symbol: symbol as u8, rest: number & ((1 << count) - 1), count }
    }
}

/// Bits that follow a symbol.
#[inline(always)]
pub(super) fn rest_bits(symbol: u8) -> u32 {
    let above = u32::from(symbol).saturating_sub(WHOLE);
    if u32::from(symbol) < WHOLE { 0 } else { above / PER_OCTAVE + WHOLE.ilog2() - PER_OCTAVE.ilog2() }
}

/// The number of a symbol below [`NUM_TOKENS`] and of the bits after it.
#[inline(always)]
pub(super) fn number(symbol: u8, rest: u32) -> u32 {
    let symbol = u32::from(symbol);
    if symbol < WHOLE { symbol } else { (PER_OCTAVE + symbol % PER_OCTAVE) << rest_bits(symbol as u8) | rest }
}

/// 0, −1, 1, −2, … as 0, 1, 2, 3, …
#[inline(always)]
pub(crate) fn fold(value: i32) -> u32 {
    (value << 1 ^ value >> 31) as u32
}

#[inline(always)]
pub(crate) fn unfold(folded: u32) -> i32 {
    (folded >> 1) as i32 ^ -((folded & 1) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_has_a_token() {
        for n in
            (0..5000).chain((12..32).flat_map(|i| [(1 << i) - 1, 1 << i, 3 << (i - 1)])).chain([u32::MAX])
        {
            let token = Token::of(n);
            assert_eq!((number(token.symbol, token.rest), rest_bits(token.symbol)), (n, token.count), "{n}");
        }
        assert!((0..5000).map(|n| Token::of(n).symbol).is_sorted());
        assert_eq!(usize::from(Token::of(u32::MAX).symbol), NUM_TOKENS - 1);
        for value in [0, 1, -1, 77, i32::MAX, i32::MIN] {
            assert_eq!(unfold(fold(value)), value);
        }
    }
}
