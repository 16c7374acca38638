//! Numbers of the type that a file gave them, and names.

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ComponentType {
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 32 bits.
    I32,
    /// Unsigned, 32 bits.
    U32,
    /// IEEE 754, 32 bits.
    F32,
    /// IEEE 754, 64 bits.
    F64,
}

impl ComponentType {
    /// Name in reports, as in Rust.
    pub fn name(self) -> &'static str {
        match self {
            Self::I8 => "i8",
            Self::U8 => "u8",
            Self::I16 => "i16",
            Self::U16 => "u16",
            Self::I32 => "i32",
            Self::U32 => "u32",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// Every type, in the order of the variants.
    pub const ALL: [Self; 8] =
        [Self::I8, Self::U8, Self::I16, Self::U16, Self::I32, Self::U32, Self::F32, Self::F64];

    /// Bytes of one number, 1 to 8.
    pub fn num_bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Whether it has no fractions.
    pub fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// The number whose bits are the lowest of `bits`. Every type fits into a float64.
    pub fn value(self, bits: u64) -> f64 {
        match self {
            Self::I8 => f64::from(bits as i8),
            Self::U8 => f64::from(bits as u8),
            Self::I16 => f64::from(bits as i16),
            Self::U16 => f64::from(bits as u16),
            Self::I32 => f64::from(bits as i32),
            Self::U32 => f64::from(bits as u32),
            Self::F32 => f64::from(f32::from_bits(bits as u32)),
            Self::F64 => f64::from_bits(bits),
        }
    }

    /// The largest value of an integer type, which a normalised value of 1 is written as; 1 for floats.
    pub fn one(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::I32 => f64::from(i32::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 | Self::F64 => 1.0,
        }
    }
}

/// A flat array of numbers of one type, or of names.
///
/// Two are equal if they are equal bit for bit: NaN equals itself, 0 does not equal -0.
#[derive(Clone, Debug)]
#[allow(missing_docs)] // Each is what its name says.
pub enum Values {
    I8(Vec<i8>),
    U8(Vec<u8>),
    I16(Vec<i16>),
    U16(Vec<u16>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    F32(Vec<f32>),
    F64(Vec<f64>),
    /// Names of materials and groups.
    Names(Vec<String>),
}

/// `$body` with the vector of any variant as `$vector`.
macro_rules! with_vector {
    ($values:expr, $vector:ident => $body:expr) => {
        match $values {
            Values::I8($vector) => $body,
            Values::U8($vector) => $body,
            Values::I16($vector) => $body,
            Values::U16($vector) => $body,
            Values::I32($vector) => $body,
            Values::U32($vector) => $body,
            Values::F32($vector) => $body,
            Values::F64($vector) => $body,
            Values::Names($vector) => $body,
        }
    };
}

impl Values {
    /// An empty array of numbers.
    pub fn new(scalar: ComponentType) -> Self {
        match scalar {
            ComponentType::I8 => Self::I8(Vec::new()),
            ComponentType::U8 => Self::U8(Vec::new()),
            ComponentType::I16 => Self::I16(Vec::new()),
            ComponentType::U16 => Self::U16(Vec::new()),
            ComponentType::I32 => Self::I32(Vec::new()),
            ComponentType::U32 => Self::U32(Vec::new()),
            ComponentType::F32 => Self::F32(Vec::new()),
            ComponentType::F64 => Self::F64(Vec::new()),
        }
    }

    /// An empty array of the same type.
    pub fn emptied(&self) -> Self {
        self.component_type().map_or(Self::Names(Vec::new()), Self::new)
    }

    /// The type of the numbers, `None` if these are names.
    pub fn component_type(&self) -> Option<ComponentType> {
        match self {
            Self::I8(_) => Some(ComponentType::I8),
            Self::U8(_) => Some(ComponentType::U8),
            Self::I16(_) => Some(ComponentType::I16),
            Self::U16(_) => Some(ComponentType::U16),
            Self::I32(_) => Some(ComponentType::I32),
            Self::U32(_) => Some(ComponentType::U32),
            Self::F32(_) => Some(ComponentType::F32),
            Self::F64(_) => Some(ComponentType::F64),
            Self::Names(_) => None,
        }
    }

    /// How many numbers or names there are.
    pub fn len(&self) -> usize {
        with_vector!(self, v => v.len())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The names, `None` if these are numbers.
    pub fn names(&self) -> Option<&[String]> {
        if let Self::Names(names) = self { Some(names) } else { None }
    }

    /// The bits of the number at `index`, in the lowest [`ComponentType::num_bytes`] bytes, the others 0.
    /// `None` beyond the end, and of names.
    pub fn bits(&self, index: usize) -> Option<u64> {
        Some(match self {
            Self::I8(v) => u64::from(*v.get(index)? as u8),
            Self::U8(v) => u64::from(*v.get(index)?),
            Self::I16(v) => u64::from(*v.get(index)? as u16),
            Self::U16(v) => u64::from(*v.get(index)?),
            Self::I32(v) => u64::from(*v.get(index)? as u32),
            Self::U32(v) => u64::from(*v.get(index)?),
            Self::F32(v) => u64::from(v.get(index)?.to_bits()),
            Self::F64(v) => v.get(index)?.to_bits(),
            Self::Names(_) => return None,
        })
    }

    /// The number at `index` as it is, not normalised. `None` beyond the end, and of names.
    pub fn number(&self, index: usize) -> Option<f64> {
        Some(self.component_type()?.value(self.bits(index)?))
    }

    /// Appends the number that has these bits (see [`Self::bits`]). Does nothing to names.
    pub fn push_bits(&mut self, bits: u64) {
        match self {
            Self::I8(v) => v.push(bits as i8),
            Self::U8(v) => v.push(bits as u8),
            Self::I16(v) => v.push(bits as i16),
            Self::U16(v) => v.push(bits as u16),
            Self::I32(v) => v.push(bits as i32),
            Self::U32(v) => v.push(bits as u32),
            Self::F32(v) => v.push(f32::from_bits(bits as u32)),
            Self::F64(v) => v.push(f64::from_bits(bits)),
            Self::Names(_) => {}
        }
    }

    /// Appends the numbers or names of an array of the same type. Does nothing if the types differ.
    pub fn append(&mut self, other: Self) {
        match (self, other) {
            (Self::I8(v), Self::I8(w)) => v.extend(w),
            (Self::U8(v), Self::U8(w)) => v.extend(w),
            (Self::I16(v), Self::I16(w)) => v.extend(w),
            (Self::U16(v), Self::U16(w)) => v.extend(w),
            (Self::I32(v), Self::I32(w)) => v.extend(w),
            (Self::U32(v), Self::U32(w)) => v.extend(w),
            (Self::F32(v), Self::F32(w)) => v.extend(w),
            (Self::F64(v), Self::F64(w)) => v.extend(w),
            (Self::Names(v), Self::Names(w)) => v.extend(w),
            _ => {}
        }
    }

    /// Replaces the number at `index` by the one that has these bits. Does nothing beyond the end or to names.
    pub fn set_bits(&mut self, index: usize, bits: u64) {
        fn set<T>(vector: &mut [T], index: usize, value: T) {
            if let Some(old) = vector.get_mut(index) {
                *old = value;
            }
        }
        match self {
            Self::I8(v) => set(v, index, bits as i8),
            Self::U8(v) => set(v, index, bits as u8),
            Self::I16(v) => set(v, index, bits as i16),
            Self::U16(v) => set(v, index, bits as u16),
            Self::I32(v) => set(v, index, bits as i32),
            Self::U32(v) => set(v, index, bits as u32),
            Self::F32(v) => set(v, index, f32::from_bits(bits as u32)),
            Self::F64(v) => set(v, index, f64::from_bits(bits)),
            Self::Names(_) => {}
        }
    }

    /// Drops all beyond the first `len`.
    pub fn truncate(&mut self, len: usize) {
        with_vector!(self, v => v.truncate(len));
    }
}

impl PartialEq for Values {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Names(a), Self::Names(b)) => a == b,
            _ => {
                self.component_type() == other.component_type()
                    && self.len() == other.len()
                    && (0..self.len()).all(|k| self.bits(k) == other.bits(k))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_back_in_every_type() {
        for (scalar, bits, value) in [
            (ComponentType::I8, 0xff, -1.0),
            (ComponentType::U8, 0xff, 255.0),
            (ComponentType::I16, 0x8000, -32768.0),
            (ComponentType::U16, 0x8000, 32768.0),
            (ComponentType::I32, 0xffff_fffe, -2.0),
            (ComponentType::U32, 0xffff_fffe, 4_294_967_294.0),
            (ComponentType::F32, u64::from(1.5f32.to_bits()), 1.5),
            (ComponentType::F64, (-0.0f64).to_bits(), -0.0),
        ] {
            let mut values = Values::new(scalar);
            values.push_bits(bits);
            assert_eq!((values.component_type(), values.len()), (Some(scalar), 1));
            assert_eq!((values.bits(0), values.number(0)), (Some(bits), Some(value)), "{scalar:?}");
            assert_eq!((values.bits(1), values.number(1)), (None, None));
            values.set_bits(0, 0);
            values.set_bits(1, 1);
            assert_eq!((values.bits(0), values.len()), (Some(0), 1));
        }
    }

    #[test]
    fn equal_is_bit_for_bit() {
        assert_eq!(Values::F32(vec![f32::NAN]), Values::F32(vec![f32::NAN]));
        assert_ne!(Values::F32(vec![0.0]), Values::F32(vec![-0.0]));
        assert_ne!(Values::I8(vec![1]), Values::U8(vec![1]));
        assert_ne!(Values::U8(vec![1]), Values::U8(vec![1, 1]));
        assert_ne!(Values::Names(vec![]), Values::U8(vec![]));
        assert_eq!(Values::Names(vec!["a".into()]), Values::Names(vec!["a".into()]));
    }
}
