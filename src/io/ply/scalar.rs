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

    /// A number of a text as the type has it: that of `float` is a float32, if it is not beyond all of them.
    #[inline]
    pub fn rounded(self, number: f64) -> f64 {
        let float = number as f32;
        if self.kept == ComponentType::F32 && float.is_finite() { f64::from(float) } else { number }
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
