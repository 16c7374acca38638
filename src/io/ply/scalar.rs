//! Types of numbers in a file.

use crate::mesh::{ComponentType, Values};

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Scalar {
    /// The type that values are kept in.
    pub kept: ComponentType,
    /// Whether the file has integers of 64 bits: if one does not fit `kept`, all are kept as float64.
    pub is_wide: bool,
}

impl Scalar {
    pub fn from_name(name: &[u8]) -> Option<Self> {
        let (kept, is_wide) = match name {
            b"char" | b"int8" => (ComponentType::I8, false),
            b"uchar" | b"uint8" => (ComponentType::U8, false),
            b"short" | b"int16" => (ComponentType::I16, false),
            b"ushort" | b"uint16" => (ComponentType::U16, false),
            b"int" | b"int32" => (ComponentType::I32, false),
            b"uint" | b"uint32" => (ComponentType::U32, false),
            b"int64" => (ComponentType::I32, true),
            b"uint64" => (ComponentType::U32, true),
            b"float" | b"float32" => (ComponentType::F32, false),
            b"double" | b"float64" => (ComponentType::F64, false),
            _ => return None,
        };
        Some(Self { kept, is_wide })
    }

    #[inline]
    pub fn num_bytes(self) -> usize {
        if self.is_wide { 8 } else { self.kept.num_bytes() }
    }

    pub fn is_integer(self) -> bool {
        self.kept.is_integer()
    }

    /// The number that is these bits in a binary file.
    pub fn value(self, bits: u64) -> f64 {
        match self.kept {
            ComponentType::I32 if self.is_wide => bits as i64 as f64,
            _ if self.is_wide => bits as f64,
            kept => kept.value(bits),
        }
    }

    /// A number of a text as the type has it: that of `float` is the float32 that has these digits. If none has, whoever
    /// wrote it had more than a float32, and it stays.
    #[inline]
    pub fn rounded(self, number: f64, word: &[u8]) -> f64 {
        let float = f64::from(number as f32);
        let is_other = self.kept == ComponentType::F32 && float != number;
        if is_other && (float - number).abs() <= 0.5 * unit_of(word) { float } else { number }
    }

    /// Whether an integer is one of the type it is kept in.
    #[inline]
    pub fn fits(self, number: f64) -> bool {
        let highest = self.kept.one();
        let is_signed = matches!(self.kept, ComponentType::I8 | ComponentType::I16 | ComponentType::I32);
        let lowest = if is_signed { -highest - 1.0 } else { 0.0 };
        lowest <= number && number <= highest
    }

    /// The bits of an integer that fits.
    #[inline]
    pub fn integer_bits(self, number: f64) -> u64 {
        number as i64 as u64 & (u64::MAX >> (64 - 8 * self.kept.num_bytes()))
    }
}

/// What a number of 1 in the last digit of a decimal stands for.
fn unit_of(word: &[u8]) -> f64 {
    let at = word.iter().position(|byte| matches!(byte, b'e' | b'E'));
    let (digits, exponent) = at.map_or((word, &[][..]), |at| (&word[..at], &word[at + 1..]));
    let point = digits.iter().position(|&byte| byte == b'.');
    let num_decimals = point.map_or(0, |point| digits.len() - point - 1);
    let exponent = std::str::from_utf8(exponent).ok().and_then(|text| text.parse::<i32>().ok()).unwrap_or(0);
    let num_decimals = i32::try_from(num_decimals).unwrap_or(i32::MAX);
    10f64.powi(exponent.saturating_sub(num_decimals))
}

/// Makes numbers float64.
pub(super) fn widen(values: &mut Values) {
    if values.component_type() != Some(ComponentType::F64) {
        *values = Values::F64((0..values.len()).filter_map(|k| values.number(k)).collect());
    }
}

/// Adds an integer of 64 bits.
pub(super) fn push_wide(values: &mut Values, scalar: Scalar, number: f64) {
    if values.component_type() != Some(ComponentType::F64) {
        if scalar.fits(number) {
            return values.push_bits(scalar.integer_bits(number));
        }
        let known = (0..values.len()).filter_map(|k| Some(scalar.kept.value(values.bits(k)?)));
        *values = Values::F64(known.collect());
    }
    values.push_bits(number.to_bits());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_of_float32_are_float32() {
        let float = Scalar::from_name(b"float").unwrap();
        let rounded = |text: &str| float.rounded(text.parse().unwrap(), text.as_bytes());
        for text in ["0.1", "-1.1e-3", "3.14159274", "1e10", "0.30000001"] {
            assert_eq!(rounded(text), f64::from(text.parse::<f32>().unwrap()), "{text}");
        }
        for text in ["5500000.001", "1e-300", "1e39", "0.1000000000", "16777217"] {
            assert_eq!(rounded(text), text.parse::<f64>().unwrap(), "{text}");
        }
        let double = Scalar::from_name(b"double").unwrap();
        assert_eq!(double.rounded(0.1, b"0.1"), 0.1);
    }
}
