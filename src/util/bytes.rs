//! Numbers in bytes, little-endian; variable-length ones as LEB128 (`format/SPEC.md`, section 2).

use super::budget::Budget;
use byteorder::{ByteOrder, LittleEndian};

/// Reads a payload front to back. `None` means that it ends too early or breaks a rule.
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    /// Bytes left.
    pub(crate) fn len(&self) -> usize {
        self.bytes.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    pub(crate) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(taken)
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.take(1).map(|b| b[0])
    }

    pub(crate) fn f32(&mut self) -> Option<f32> {
        self.take(4).map(LittleEndian::read_f32)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.take(8).map(LittleEndian::read_f64)
    }

    pub(crate) fn i64(&mut self) -> Option<i64> {
        self.take(8).map(LittleEndian::read_i64)
    }

    /// A number of 32 bits in one to five bytes, without superfluous ones.
    pub(crate) fn varint(&mut self) -> Option<u32> {
        let mut value = 0_u64;
        for shift in (0..35).step_by(7) {
            let byte = self.u8()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                let is_shortest = byte != 0 || shift == 0;
                return u32::try_from(value).ok().filter(|_| is_shortest);
            }
        }
        None
    }
}

impl Reader<'_> {
    /// A `varint` that counts things of which each takes `min_bytes` at least: no more than the rest could hold.
    pub(crate) fn count(&mut self, min_bytes: usize) -> Option<usize> {
        let count = self.varint()? as usize;
        (count <= self.len() / min_bytes).then_some(count)
    }

    /// A string, the memory for its bytes taken from `budget`.
    pub(crate) fn string(&mut self, budget: &mut Budget) -> Option<String> {
        let length = self.varint()? as usize;
        let text = std::str::from_utf8(self.take(length)?).ok()?;
        budget.take(length, 1)?;
        Some(text.to_owned())
    }

    /// So many strings, the memory for them taken from `budget`.
    pub(crate) fn strings(&mut self, count: usize, budget: &mut Budget) -> Option<Vec<String>> {
        budget.take(count.min(self.len()), size_of::<String>())?;
        let mut strings = Vec::with_capacity(count.min(self.len()));
        for _ in 0..count {
            strings.push(self.string(budget)?);
        }
        Some(strings)
    }
}

/// Appends `value` as LEB128.
#[cfg(any(feature = "encoder", test))]
pub(crate) fn write_varint(bytes: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn varints_return_and_are_unique() {
        for value in [0, 1, 127, 128, 300, 16_383, 16_384, u32::MAX - 1, u32::MAX] {
            let mut bytes = Vec::new();
            write_varint(&mut bytes, value);
            assert_eq!(Reader::new(&bytes).varint(), Some(value));
            assert_eq!(Reader::new(&bytes[..bytes.len() - 1]).varint(), None);
        }
        assert_eq!(Reader::new(&[0x80, 0x00]).varint(), None, "a superfluous byte");
        assert_eq!(Reader::new(&[0xff, 0xff, 0xff, 0xff, 0x1f]).varint(), None, "more than 32 bits");
        assert_eq!(Reader::new(&[0x80; 6]).varint(), None);
    }
}
